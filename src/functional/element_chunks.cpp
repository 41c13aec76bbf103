#include "functional/element_chunks.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numeric>
#include <utility>

#include "base/lanes.hpp"
#include "base/parallel.hpp"

namespace almesh {
namespace {

// Small enough for a core's cache and for some chunks per thread and colour, large enough to share few nodes.
constexpr int largest_chunk = 256, wanted_chunks = 128;

// A mesh whose own order shares fewer nodes than this keeps it: refined meshes are in good order, and their nodes too.
constexpr double well_ordered = 1.5;  // chunks per node

int chunk_size(int elements) {
    const int size = std::clamp(elements / wanted_chunks, 1, largest_chunk);
    return (size + lanes - 1) / lanes * lanes;
}

// Place of each element's centre on Morton's curve: the bits of its coordinates, cut to 2^21 cells per direction of the
// box around the mesh, in turn. Near on the curve is near in space, whatever the numbering of the mesh.
std::vector<std::pair<std::uint64_t, int>> places_on_curve(const Mesh& mesh) {
    constexpr int bits = 21;
    const int n = mesh.dim;
    std::vector<double> least(n, std::numeric_limits<double>::max()), most(n, std::numeric_limits<double>::lowest());
    for (std::size_t i = 0; i < mesh.x.size(); ++i) {
        least[i % n] = std::min(least[i % n], mesh.x[i]);
        most[i % n] = std::max(most[i % n], mesh.x[i]);
    }
    double width = 0;
    for (int a = 0; a < n; ++a) width = std::max(width, most[a] - least[a]);
    const double cells = width > 0 ? ((1 << bits) - 1) / (width * (n + 1)) : 0;  // per sum of n + 1 coordinates

    std::vector<std::pair<std::uint64_t, int>> places(mesh.element_count());
    parallel_for(mesh.element_count(), [&](int e) {
        std::uint64_t place = 0;
        for (int a = 0; a < n; ++a) {
            double sum = 0;
            for (int i = 0; i <= n; ++i) sum += mesh.x[static_cast<std::size_t>(mesh.element(e)[i]) * n + a] - least[a];
            const auto cell = static_cast<std::uint64_t>(sum * cells);
            for (int bit = 0; bit < bits; ++bit) place |= (cell >> bit & 1) << (bit * n + a);
        }
        places[e] = {place, e};
    }, 100);
    return places;
}

void sort_along_curve(const Mesh& mesh, std::vector<int>& order) {
    std::vector<std::pair<std::uint64_t, int>> places = places_on_curve(mesh);
    const auto middle = places.begin() + static_cast<std::ptrdiff_t>(places.size() / 2);
    at_once([&] { std::sort(places.begin(), middle); }, [&] { std::sort(middle, places.end()); });
    std::inplace_merge(places.begin(), middle, places.end());
    std::transform(places.begin(), places.end(), order.begin(), [](const auto& place) { return place.second; });
}

// In how many chunks a node is, on average.
double chunks_per_node(const Mesh& mesh, const ElementChunks& chunks) {
    const int m = mesh.element_nodes();
    std::vector<int> last_chunk(mesh.nodes(), -1);
    double touched = 0;
    for (int k = 0; k < mesh.element_count(); ++k)
        for (int i = 0; i < m; ++i) {
            int& last = last_chunk[mesh.element(chunks.order[k])[i]];
            touched += last != k / chunks.size;
            last = k / chunks.size;
        }
    return touched / std::max(mesh.nodes(), 1);
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
    if (chunks_per_node(mesh, chunks) > well_ordered) sort_along_curve(mesh, chunks.order);
    colour_chunks(mesh, chunks);
    return chunks;
}

}  // namespace almesh
