// The state of a run, saved while it goes on: after a crash another process goes on from there and ends with the same
// bits.
//
// A run is a sequence of minimisations by Newton's method. All that happens between them, multipliers, schedules, parts
// of the motion, powers, finer meshes, is cheap and follows from their results. So these are what is saved: a file for
// every minimisation, numbered in their order, with its end or, of the last, how far it has come. Who resumes starts
// from the beginning, takes the ends that were saved instead of computing them, and goes on inside the minimisation
// that had none.
//
// A file is written whole or not at all, and ends with the hash of what is before it, so that neither a process that
// was killed nor a full disk nor a power failure leaves a state that is wrong.
#pragma once
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/interrupt.hpp"
#include "energy/distortion_energy.hpp"
#include "linalg/linear_solver.hpp"
#include "method/newton.hpp"

namespace almesh {

// One minimisation between two of its steps, or at its end: all that its next steps depend on, and what of it the next
// minimisations depend on.
struct NewtonState {
    std::string start;  // a hash of x where it began, E there, |grad E|, and the tolerance
    bool has_ended = false;
    NewtonResult at;
    HessianKind hessian = HessianKind::projected;  // of the next step
    double forcing = 0, damping = 0, negative_part = 0;
    LocalElimination::State elimination;
    LinearSolverState solver;
    QuadratureState quadrature;
    std::vector<double> x;
    std::vector<NewtonStep> steps;  // for those who follow the run
};

class Checkpoint {
public:
    using Tell = std::function<void(const std::string& note)>;

    // folder: of the files, made when the first one is written. run: its id and the program's, which must be the same
    // to resume. seconds: between two savings. tell: what the user should know. Throws UsageError where `resume` is
    // wanted and the folder has the state of another run.
    Checkpoint(std::string folder, std::string run, double seconds, bool resume, Tell tell);

    int minimisations() const { return last_; }  // that were saved, of which the last may not be at its end

    // The next minimisation begins. Returns what was saved of it; start: what tells it from others.
    std::optional<NewtonState> next(const std::string& start);

    bool is_due() const { return std::chrono::duration<double>(Clock::now() - saved_).count() >= seconds_; }

    // Of the minimisation that was begun last. Without an end it is written at once, with one when the next is due. A
    // file that cannot be written is told of once, and tried again with the next.
    void save(NewtonState state);

    // Removes the files, and the folder where it has no others.
    static void remove(const std::string& folder);

private:
    std::string folder_, run_;
    double seconds_;
    Tell tell_;
    int number_ = 0, last_ = 0;  // of the minimisation at hand, and of the last that is read
    bool is_over_ = false;       // the run has been interrupted: nothing from here on is part of it
    bool has_failed_ = false;    // to write a file
    Clock::time_point saved_ = Clock::now();
    std::vector<std::pair<int, NewtonState>> unwritten_;  // by number

    std::string path(int number) const;
    std::string contents(NewtonState& state) const;
    std::optional<NewtonState> read(int number) const;
    void write();
};

}  // namespace almesh
