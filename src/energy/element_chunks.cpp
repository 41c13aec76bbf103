#include "energy/element_chunks.hpp"

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

// Small enough for a core's cache and for some chunks per thread, large enough to share few nodes.
constexpr int largest_chunk = 256, wanted_chunks = 128;

constexpr int walks = 16;   // through the mesh at the same time
constexpr int apart = 8;    // turns between two neighbours, if possible
constexpr int window = 64;  // next chunks that are looked at for one without a neighbour

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
    parallel_invoke([&] { std::sort(places.begin(), middle); }, [&] { std::sort(middle, places.end()); });
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

// The chunks that share a node with each chunk.
std::vector<std::vector<int>> neighbours_of_chunks(const Mesh& mesh, const ElementChunks& chunks) {
    struct Visit {
        int chunk, before;  // before: an earlier visit of the same node, or -1
    };
    const int m = mesh.element_nodes(), count = (mesh.element_count() + chunks.size - 1) / chunks.size;
    std::vector<Visit> visits;
    std::vector<int> last_visit(mesh.nodes(), -1), seen(count, -1);
    std::vector<std::vector<int>> neighbours(count);
    for (int k = 0; k < mesh.element_count(); ++k)
        for (int i = 0; i < m; ++i) {
            const int chunk = k / chunks.size;
            int& last = last_visit[mesh.element(chunks.order[k])[i]];
            if (last >= 0 && visits[last].chunk == chunk) continue;
            for (int visit = last; visit >= 0; visit = visits[visit].before)
                if (const int other = visits[visit].chunk; std::exchange(seen[other], chunk) != chunk) {
                    neighbours[chunk].push_back(other);
                    neighbours[other].push_back(chunk);
                }
            visits.push_back({chunk, std::exchange(last, static_cast<int>(visits.size()))});
        }
    return neighbours;
}

// Chunk after chunk from several places on, equally far apart.
std::vector<int> walk(int count) {
    std::vector<int> chunks;
    for (int step = 0; static_cast<int>(chunks.size()) < count; ++step)
        for (long long w = 0; w < walks; ++w)
            if (const long long chunk = count * w / walks + step; chunk < count * (w + 1) / walks)
                chunks.push_back(static_cast<int>(chunk));
    return chunks;
}

// As they come on the walk, but where a neighbour has just had its turn, one of the next few chunks comes first.
void take_turns(const std::vector<std::vector<int>>& neighbours, ElementChunks& chunks) {
    const int count = static_cast<int>(neighbours.size());
    std::vector<int> to_come = walk(count), turn_of(count, -1), last_turn(count, -apart);  // last_turn: of a neighbour
    std::reverse(to_come.begin(), to_come.end());                                          // to be taken from the end
    chunks.wait_start = {0};
    for (int turn = 0; turn < count; ++turn) {
        const auto first = to_come.end() - std::min<std::ptrdiff_t>(window, to_come.end() - to_come.begin());
        auto best = to_come.end() - 1;
        for (auto it = best; it != first && last_turn[*best] > turn - apart; --it)
            if (last_turn[it[-1]] < last_turn[*best]) best = it - 1;
        const int chunk = *best;
        to_come.erase(best);
        chunks.turn.push_back(chunk);
        turn_of[chunk] = turn;
        for (const int other : neighbours[chunk]) {
            last_turn[other] = turn;
            if (turn_of[other] >= 0) chunks.wait_for.push_back(turn_of[other]);
        }
        chunks.wait_start.push_back(static_cast<int>(chunks.wait_for.size()));
    }
}

}  // namespace

ElementChunks chunk_elements(const Mesh& mesh) {
    ElementChunks chunks;
    chunks.size = chunk_size(mesh.element_count());
    chunks.order.resize(mesh.element_count());
    std::iota(chunks.order.begin(), chunks.order.end(), 0);
    if (chunks_per_node(mesh, chunks) > well_ordered) sort_along_curve(mesh, chunks.order);
    take_turns(neighbours_of_chunks(mesh, chunks), chunks);
    return chunks;
}

}  // namespace almesh
