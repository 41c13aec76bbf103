// The order in which threads go through the elements: chunks of consecutive elements, which come one after the other
// and are one thread's work each. A chunk waits until the earlier ones that share a node with it are done; the order
// keeps such neighbours some turns apart, so that they nearly always are. Every entry of the gradient and of the
// Hessian is summed in the same order whatever the number of threads, and a chunk's part of the Hessian stays in the
// cache of its thread. Where the mesh's own order is a poor one, chunks are cut along a space-filling curve.
#pragma once
#include <atomic>
#include <vector>

#include "base/parallel.hpp"
#include "mesh/mesh.hpp"

namespace almesh {

struct ElementChunks {
    int size = 0;                 // elements of a chunk, a multiple of the lanes; the last chunk may have fewer
    std::vector<int> order;       // element at each position; chunk c: positions c size, c size + 1, ...
    std::vector<int> turn;        // chunk of each turn
    std::vector<int> wait_start;  // turns + 1 offsets into wait_for
    std::vector<int> wait_for;    // earlier turns whose chunks share a node with that of this turn

    int count() const { return static_cast<int>(turn.size()); }

    // body(chunk) for all chunks, in turn, by many threads if asked for. One call at a time.
    template <class Body>
    void in_turn([[maybe_unused]] bool parallel, const Body& body) const {
        ++rounds_;
        done_.resize(turn.size(), 0);
        // A turn waits for earlier ones only, and threads take them in order: the earliest one at work never waits.
#pragma omp parallel for schedule(monotonic : dynamic, 1) if (parallel)
        for (int t = 0; t < count(); ++t) {
            for (int k = wait_start[t]; k < wait_start[t + 1]; ++k)
                spin_wait([&] { return std::atomic_ref(done_[wait_for[k]]).load() == rounds_; });
            body(turn[t]);
            std::atomic_ref(done_[t]).store(rounds_);
        }
    }

private:
    mutable std::vector<int> done_;  // per turn: the round in which it was done last
    mutable int rounds_ = 0;         // calls of in_turn()
};

// Depends on the mesh alone. Cost: linear in the number of elements times their nodes, sorting them, and for each node
// the square of the number of chunks around it.
ElementChunks chunk_elements(const Mesh& mesh);

}  // namespace almesh
