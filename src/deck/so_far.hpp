// The mesh so far: a run writes it once a minute and when it is stopped, with where it stands (Standing). `start = FILE`
// of the same run goes on from there, also after the run was killed.
//
// It is one file, so-far.msh in the folder of the results: the whole mesh as the run would write it in the end, which is
// certified valid, and a section $Comments with where the run stands. On a coarser mesh, or with a lower degree, it is
// the mesh of the run with the displacement interpolated. It is removed when the run ends by itself.
//
// Where a run stands means something on the same way alone: of the same mesh to the same target by the same motions,
// whose hash is in the file. Without one, and on another way, the file is a first iterate as any other mesh.
#pragma once
#include <cstdio>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/interrupt.hpp"  // Clock
#include "problem/solve.hpp"

namespace almesh {

struct Deck;
struct Problem;

std::string path_so_far(const Deck& deck);

// What to type, from the current folder.
std::string command_to_go_on(const Deck& deck);

// A hash of the mesh, the motions and the target, as the deck has them.
std::string way_of(const Deck& deck, const Problem& problem);

// Where the run of the mesh that the problem starts from stood when it wrote the file; none where the file is of another
// way, which is noted, or has none. Throws InputError where it is damaged.
std::optional<Standing> read_standing(const Deck& deck, Problem& problem);

class WrittenMeshSoFar : public MeshSoFar {
public:
    // seconds: between two writings. observe: called with every iterate. What cannot be written is told of once.
    WrittenMeshSoFar(const Deck& deck, const Problem& problem, double seconds, std::function<void()> observe,
                     std::FILE* out)
        : deck_(deck), problem_(problem), seconds_(seconds), observe_(std::move(observe)), out_(out) {}

    void keep(const Level& level, const std::vector<double>& x) override;
    void write(const Level& level, const std::vector<double>& x) override;

private:
    const Deck& deck_;
    const Problem& problem_;
    double seconds_;
    std::function<void()> observe_;
    std::FILE* out_;
    Clock::time_point written_ = Clock::now();
    bool has_failed_ = false;
};

}  // namespace almesh
