// Blocks of elements along Morton's space-filling curve, and their schedule.
#include "energy/element_blocks.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numeric>
#include <utility>

#include "base/lanes.hpp"

namespace almesh {
namespace {

// A block fits a core's cache; there are some per thread; larger ones share fewer nodes.
constexpr int largest_block = 256, wanted_blocks = 128;

constexpr int streams = 16;    // sequences of consecutive blocks that are interleaved
constexpr int separation = 8;  // slots between two adjacent blocks, if possible
constexpr int window = 64;     // next blocks that are looked at for one whose neighbours are far enough back

// A mesh whose own order shares fewer nodes than this keeps it: refined meshes are in good order, and their nodes too.
constexpr double well_ordered = 1.5;  // blocks per node

int block_size(int elements) {
    const int size = std::clamp(elements / wanted_blocks, 1, largest_block);
    return (size + most_lanes - 1) / most_lanes * most_lanes;
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
            for (int i = 0; i <= n; ++i) sum += mesh.x[offset(mesh.element(e)[i], n, a)] - least[a];
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
    parallel_invoke([&] { std::sort(places.begin(), middle); }, [&] { std::sort(middle, places.end()); },
                    50.0 * static_cast<double>(places.size()));
    std::inplace_merge(places.begin(), middle, places.end());
    std::transform(places.begin(), places.end(), order.begin(), [](const auto& place) { return place.second; });
}

// In how many blocks a node is, on average.
double blocks_per_node(const Mesh& mesh, const ElementBlocks& blocks) {
    const int m = mesh.element_nodes();
    std::vector<int> last_block(mesh.nodes(), -1);
    double touched = 0;
    for (int k = 0; k < mesh.element_count(); ++k)
        for (int i = 0; i < m; ++i) {
            int& last = last_block[mesh.element(blocks.order[k])[i]];
            touched += last != k / blocks.size;
            last = k / blocks.size;
        }
    return touched / std::max(mesh.nodes(), 1);
}

// The blocks that share a node with each block.
std::vector<std::vector<int>> neighbours_of_blocks(const Mesh& mesh, const ElementBlocks& blocks) {
    struct Visit {
        int block, before;  // before: an earlier visit of the same node, or -1
    };
    const int m = mesh.element_nodes(), count = (mesh.element_count() + blocks.size - 1) / blocks.size;
    std::vector<Visit> visits;
    std::vector<int> last_visit(mesh.nodes(), -1), seen(count, -1);
    std::vector<std::vector<int>> neighbours(count);
    for (int k = 0; k < mesh.element_count(); ++k)
        for (int i = 0; i < m; ++i) {
            const int block = k / blocks.size;
            int& last = last_visit[mesh.element(blocks.order[k])[i]];
            if (last >= 0 && visits[last].block == block) continue;
            for (int visit = last; visit >= 0; visit = visits[visit].before)
                if (const int other = visits[visit].block; std::exchange(seen[other], block) != block) {
                    neighbours[block].push_back(other);
                    neighbours[other].push_back(block);
                }
            visits.push_back({block, std::exchange(last, static_cast<int>(visits.size()))});
        }
    return neighbours;
}

// The blocks in `streams` interleaved sequences.
std::vector<int> interleaved(int count) {
    std::vector<int> blocks;
    for (int step = 0; static_cast<int>(blocks.size()) < count; ++step)
        for (long long s = 0; s < streams; ++s)
            if (const long long block = count * s / streams + step; block < count * (s + 1) / streams)
                blocks.push_back(static_cast<int>(block));
    return blocks;
}

// In interleaved order, but where a neighbour stands less than `separation` slots back, the one of the next blocks
// whose last neighbour stands furthest back comes first.
void fill_schedule(const std::vector<std::vector<int>>& neighbours, ElementBlocks& blocks) {
    const int count = static_cast<int>(neighbours.size());
    std::vector<int> to_come = interleaved(count), slot_of(count, -1), last_slot(count, -separation);  // of a neighbour
    std::reverse(to_come.begin(), to_come.end());  // to be taken from the end
    blocks.wait_start = {0};
    for (int slot = 0; slot < count; ++slot) {
        const auto first = to_come.end() - std::min<std::ptrdiff_t>(window, to_come.end() - to_come.begin());
        auto best = to_come.end() - 1;
        for (auto it = best; it != first && last_slot[*best] > slot - separation; --it)
            if (last_slot[it[-1]] < last_slot[*best]) best = it - 1;
        const int block = *best;
        to_come.erase(best);
        blocks.schedule.push_back(block);
        slot_of[block] = slot;
        for (const int other : neighbours[block]) {
            last_slot[other] = slot;
            if (slot_of[other] >= 0) blocks.wait_for.push_back(slot_of[other]);
        }
        blocks.wait_start.push_back(static_cast<int>(blocks.wait_for.size()));
    }
}

}  // namespace

ElementBlocks schedule_elements(const Mesh& mesh) {
    ElementBlocks blocks;
    blocks.size = block_size(mesh.element_count());
    blocks.order.resize(mesh.element_count());
    std::iota(blocks.order.begin(), blocks.order.end(), 0);
    if (blocks_per_node(mesh, blocks) > well_ordered) sort_along_curve(mesh, blocks.order);
    fill_schedule(neighbours_of_blocks(mesh, blocks), blocks);
    return blocks;
}

}  // namespace almesh
