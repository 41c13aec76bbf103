// The order in which threads go through the elements: chunks of consecutive elements, coloured so that chunks of one
// colour share no node. A colour's chunks are assembled in parallel, the colours in order, and inside a chunk element
// after element: every entry of the gradient and of the Hessian is summed in the same order whatever the number of
// threads, and a chunk's part of the Hessian stays in the cache of its thread. Where the mesh's own order is a poor
// one, chunks are cut along a space-filling curve.
#pragma once
#include <vector>

#include "mesh/mesh.hpp"

namespace almesh {

struct ElementChunks {
    int size = 0;                   // elements of a chunk, a multiple of the lanes; the last chunk may have fewer
    std::vector<int> order;         // element at each position; chunk c: positions c size, c size + 1, ...
    std::vector<int> colour_start;  // colours + 1 offsets into coloured
    std::vector<int> coloured;      // chunks by colour

    int count() const { return static_cast<int>(coloured.size()); }
    int colours() const { return static_cast<int>(colour_start.size()) - 1; }
};

// Depends on the mesh alone. Cost: linear in the number of elements times their nodes, and sorting them.
ElementChunks chunk_elements(const Mesh& mesh);

}  // namespace almesh
