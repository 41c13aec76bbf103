// The order in which threads go through the elements: blocks of consecutive elements, scheduled so that blocks that
// share a node are at least some slots apart, where possible. The block of a slot waits until those of earlier slots
// that share a node with it are done, which they nearly always are. So every entry of the gradient and of the Hessian
// is summed in the same order whatever the number of threads, without colouring, and a block's part of the Hessian
// stays in the cache of its thread. Where the mesh's own order is a poor one, blocks are cut along a space-filling
// curve.
#pragma once
#include <vector>

#include "base/parallel.hpp"
#include "mesh/mesh.hpp"

namespace almesh {

struct ElementBlocks {
    int size = 0;                 // elements of a block, a multiple of most_lanes; the last block may have fewer
    std::vector<int> order;       // element at each place; block b: places b size, b size + 1, ...
    std::vector<int> schedule;    // block of each slot
    std::vector<int> wait_start;  // slots + 1 offsets into wait_for
    std::vector<int> wait_for;    // earlier slots whose blocks share a node with that of this slot

    int count() const { return static_cast<int>(schedule.size()); }

    // body(block) for all blocks, in schedule order, by many threads if asked for. One call at a time.
    template <class Body>
    void in_schedule(bool parallel, const Body& body) {
        ++rounds_;
        done_.resize(schedule.size(), 0);
        // A slot waits for earlier ones only, and threads take them in order: the earliest one at work never waits.
        parallel_tasks(count(), parallel, [&](int t) {
            for (int k = wait_start[t]; k < wait_start[t + 1]; ++k)
                spin_wait([&] { return atomic_value(done_[wait_for[k]]) == rounds_; });
            body(schedule[t]);
            set_atomic(done_[t], rounds_);
        });
    }

private:
    std::vector<int> done_;  // per slot: the round in which it was done last
    int rounds_ = 0;         // calls of in_schedule()
};

// Depends on the mesh alone. Cost: linear in the number of elements times their nodes, sorting them, and for each node
// the square of the number of blocks around it.
ElementBlocks schedule_elements(const Mesh& mesh);

}  // namespace almesh
