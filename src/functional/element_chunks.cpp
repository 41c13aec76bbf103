#include "functional/element_chunks.hpp"

#include <algorithm>
#include <numeric>

#include "base/lanes.hpp"

namespace almesh {
namespace {

// Small enough for a core's cache and for some chunks per thread and colour, large enough to share few nodes.
constexpr int largest_chunk = 256, wanted_chunks = 128;

int chunk_size(int elements) {
    const int size = std::clamp(elements / wanted_chunks, 1, largest_chunk);
    return (size + lanes - 1) / lanes * lanes;
}

// First fit, colour after colour: a chunk takes the colour if none of its nodes has it yet.
void colour_chunks(const Mesh& mesh, ElementChunks& chunks) {
    const int elements = mesh.element_count(), m = mesh.element_nodes();
    std::vector<int> rest((elements + chunks.size - 1) / chunks.size), later, last_colour(mesh.nodes(), -1);
    std::iota(rest.begin(), rest.end(), 0);
    const auto every_node = [&](int chunk, const auto& test) {
        for (int k = chunk * chunks.size, end = std::min(elements, k + chunks.size); k < end; ++k) {
            const int* const node = mesh.element(chunks.order[k]);
            if (!std::all_of(node, node + m, test)) return false;
        }
        return true;
    };
    chunks.colour_start = {0};
    for (int colour = 0; !rest.empty(); ++colour) {
        later.clear();
        for (const int chunk : rest) {
            const bool free = every_node(chunk, [&](int i) { return last_colour[i] != colour; });
            (free ? chunks.coloured : later).push_back(chunk);
            if (free)
                every_node(chunk, [&](int i) {
                    last_colour[i] = colour;
                    return true;
                });
        }
        chunks.colour_start.push_back(static_cast<int>(chunks.coloured.size()));
        rest.swap(later);
    }
}

}  // namespace

ElementChunks chunk_elements(const Mesh& mesh) {
    ElementChunks chunks;
    chunks.size = chunk_size(mesh.element_count());
    chunks.order.resize(mesh.element_count());
    std::iota(chunks.order.begin(), chunks.order.end(), 0);
    colour_chunks(mesh, chunks);
    return chunks;
}

}  // namespace almesh
