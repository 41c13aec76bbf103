// A mesh in memory with the settings of a deck, run after run: what the libraries for C++ (almesh.hpp) and C (almesh.h)
// are made of.
//
// Settings are those of the program's command line, read by the same parser: each is a text. A run is the program's,
// from make_problem() to examine(), so that the same input gives the same bits; it prints nothing and writes no files.
#pragma once
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "almesh.hpp"
#include "deck/make_problem.hpp"
#include "library/mesh_view.hpp"
#include "problem/frame_solver.hpp"
#include "problem/solve.hpp"

namespace almesh {

// All that deck() reads.
struct SessionSettings {
    std::string text, path;  // of the deck; of no deck "" and the mesh's
    std::vector<std::pair<std::string, std::string>> lines;          // KEY = VALUE
    std::map<std::string, std::function<Motion(double t)>> motions;  // of boundaries, in place of texts
};

class Session {
public:
    SessionSettings settings;
    Observer observe;             // null: nobody
    std::function<bool()> stops;  // asked at times whether the run is to end; null: it is not

    std::string notes, ending;  // what the program prints of the mesh and of the last run, but the table of iterations

    const MeshSource source;
    const Mesh base;  // as it was read

    // Results of the last run, in the run's frame but for the view.
    MeshView view;
    std::unique_ptr<Problem> problem;  // null: there was no run
    bool is_at_solution = false;       // whether its target is that of the solution
    Deck run;                          // its settings
    Solution solution;
    Summary summary;
    FramesBefore before;        // from which the next frame may start

    // name: of the mesh, "" where it is that of the settings' deck.
    Session(MeshSource mesh, std::string name, SessionSettings settings = {});
    static Session of_deck(const std::string& path);

    const Mesh& mesh() const { return problem ? problem->mesh() : base; }
    std::vector<double> positions() const { return view.to_mesh(view.x.data()); }  // of the mesh, in units of the file

    // more: lines after the text. Throws UsageError.
    Deck deck(double t = 1, const std::string& more = "") const;
    ExitCode move(const Deck& deck);
    ExitCode frame(double t);
    Deck set_time(double t);  // as a frame does before it is solved

    // As if a frame had ended there, or would start from there alone. x: positions.
    void set_solution(double t, std::vector<double> x);
    void set_start(double t, std::vector<double> x);

    // Of positions; and why they are not certified, "" where they are.
    std::pair<Certificate, Injectivity> certify(std::vector<double> x) const;
    std::string reason(const Certificate& certificate, const Injectivity& injectivity) const;

    // Derivatives by boundary nodes, or velocities of all by those of these, at the mesh of the last run, which is
    // polished first. Nodes x dim of the view. Throws Error.
    std::vector<double> differentiate(bool adjoint, const double* values);

private:
    struct Running;

    const std::string name_;
    std::unique_ptr<FrameSolver> solver_;  // null where the last run was no frame
    std::string way_;                      // all that the problem of frames is made for, but numbers of motions
    int frames_ = 0;                       // since then

    ExitCode keep(const Deck& deck, Solution found, const Running& running);
};

}  // namespace almesh
