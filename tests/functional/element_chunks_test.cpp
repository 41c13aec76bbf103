#include "functional/element_chunks.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <set>

#include "base/lanes.hpp"
#include "support/meshes.hpp"

using namespace almesh;
using namespace almesh::test;

TEST_CASE("chunks hold every element once, and those of one colour share no node") {
    for (const Mesh& mesh : {square_mesh(1), square_mesh(40), cube_mesh(6), raise_degree(ring_mesh(20, 5, 9), 3)}) {
        const ElementChunks chunks = chunk_elements(mesh);
        CHECK(chunks.size % lanes == 0);
        CHECK(chunks.count() == (mesh.element_count() + chunks.size - 1) / chunks.size);
        CHECK(std::set<int>(chunks.order.begin(), chunks.order.end()).size() ==
              static_cast<std::size_t>(mesh.element_count()));
        CHECK(std::set<int>(chunks.coloured.begin(), chunks.coloured.end()).size() == chunks.coloured.size());
        CHECK(chunks.colour_start.back() == chunks.count());
        for (int colour = 0; colour < chunks.colours(); ++colour) {
            std::vector<int> chunk_of(mesh.nodes(), -1);
            bool apart = true;
            for (int c = chunks.colour_start[colour]; c < chunks.colour_start[colour + 1]; ++c) {
                const int chunk = chunks.coloured[c], end = std::min(mesh.element_count(), (chunk + 1) * chunks.size);
                for (int k = chunk * chunks.size; k < end; ++k)
                    for (int i = 0; i < mesh.element_nodes(); ++i) {
                        int& owner = chunk_of[mesh.element(chunks.order[k])[i]];
                        apart = apart && (owner == -1 || owner == chunk);
                        owner = chunk;
                    }
            }
            CHECK(apart);
        }
    }
}

TEST_CASE("a mesh of some size has chunks for many threads") {
    const ElementChunks chunks = chunk_elements(square_mesh(40));  // 3200 triangles
    CHECK(chunks.count() >= 100);
    CHECK(chunks.colours() <= 8);
}

TEST_CASE("elements in an order without rhyme are put into one where chunks have few neighbours") {
    for (Mesh mesh : {square_mesh(40), cube_mesh(10)}) {
        const std::vector<int> ordered = mesh.elements;
        const int m = mesh.element_nodes(), count = mesh.element_count();
        for (int e = 0; e < count; ++e)  // 1009 and the number of elements have no common divisor
            std::copy_n(&ordered[static_cast<long long>(e) * 1009 % count * m], m, &mesh.elements[e * m]);
        const ElementChunks chunks = chunk_elements(mesh);
        CHECK(chunks.count() >= 100);
        CHECK(chunks.colours() <= (mesh.dim == 2 ? 12 : 40));
        CHECK(std::set<int>(chunks.order.begin(), chunks.order.end()).size() == static_cast<std::size_t>(count));
    }
}
