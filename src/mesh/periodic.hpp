// Nodes on periodic sides of a mesh, which move as one: x_slave = R x_master + t. Of several that belong together, as
// the corners of a box that is periodic in two directions, one is the master of all others.
//
// Slaves are eliminated: with x = P z + (0, t), P z being z at all nodes but slaves and R z_master there, a function
// E(x) has the gradient P' g and the Hessian P' H P.
#pragma once
#include <utility>
#include <vector>

#include "base/frame.hpp"
#include "linalg/block_csr.hpp"
#include "mesh/file_tags.hpp"

namespace almesh {

struct Mesh;

// Sets R and t by these points of the master and of the slave. False where no rotation and translation fits.
bool fit(const std::vector<std::pair<Vec<3>, Vec<3>>>& points, PeriodicSides& sides);

struct PeriodicPairs {
    struct Pair {
        int slave, master;
        PeriodicSides by;  // R and t

        double mismatch(const std::vector<double>& x, int n) const;  // n: dimension
    };
    int dim = 2;
    std::vector<Pair> pairs{};  // each node is a slave once at most, and no master then
    std::vector<Pair> held{};   // pairs whose nodes have to go somewhere, both: nothing is eliminated
    std::vector<int> of_node{};  // per node: which of the pairs it is the slave of, or -1
    std::vector<int> centres{};  // nodes that are their own images, on the axis of a rotation

    std::size_t count() const { return pairs.size() + held.size(); }
    // Takes nodes out of a choice that have to be where the image of another one is, or their own.
    void keep(std::vector<char>& chosen) const;
    // Slaves to their places; where the master is where it is in `from`, so is the slave.
    void settle(const std::vector<double>& from, std::vector<double>& x) const;
    void spread(std::vector<double>& d) const;  // P d
    void fold(std::vector<double>& g) const;    // P' g
    void fold(BlockCsr& H) const;               // P' H P, with a multiple of 1 in the diagonal blocks of slaves
    BlockCsr pattern(const BlockCsr& H) const;  // of the blocks that this adds to H

    double mismatch(const std::vector<double>& x) const;  // the largest, of all pairs
    PeriodicPairs in(const Frame& frame) const;           // of the run, from those of the file
};

double size_of(const Mesh& mesh);  // a length

// Boundaries among the candidates that are periodic as a whole, to others of these.
std::vector<char> periodic_boundaries(const Mesh& mesh, std::vector<char> candidates);

// The pairs of these boundaries. hold: per node, from 0. Of nodes that belong together the one with the most is the
// master; from `most` on all are `held`.
PeriodicPairs periodic_pairs(const Mesh& mesh, const std::vector<char>& boundaries, const std::vector<int>& hold,
                             int most);

}  // namespace almesh
