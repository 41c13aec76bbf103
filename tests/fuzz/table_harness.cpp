// Files of times, and of rows of a node and its vector: those of derivatives, of targets and of velocities.
#include "deck/deck.hpp"
#include "deck/frame_times.hpp"
#include "problem/node_targets.hpp"
#include "fuzz/harness.hpp"
#include "support/meshes.hpp"

namespace almesh::fuzz {
namespace {

template <class Read>
bool reads(const Read& read) {
    try {
        read();
        return true;
    } catch (const Error& error) {
        const std::string what = error.what();
        demand(!what.empty() && what.size() < 1000, "a file is refused in ", what.size(), " characters");
        return false;
    }
}

}  // namespace

void fuzz_frames(std::string_view bytes) {
    const std::string path = work_folder().write("times.txt", std::string(bytes));
    const Deck deck = parse_deck(concat("mesh = none.msh\nframes = ", path, "\n"), "a.deck");
    std::vector<double> times;
    if (!reads([&] { times = frame_times(deck); })) return;
    demand(!times.empty(), "a run of no frames");
    for (std::size_t k = 1; k < times.size(); ++k) demand(times[k] > times[k - 1], "frame ", k + 1, " is not later");
}

void fuzz_rows(std::string_view bytes) {
    static const Mesh mesh = test::square_mesh(2);
    std::unordered_map<long long, int> nodes;
    for (int i = 0; i < mesh.nodes(); ++i) nodes[mesh.file.node_id[i]] = i;
    const std::string path = work_folder().write("rows.csv", std::string(bytes));
    std::vector<double> value(mesh.x.size(), -1.0);
    std::vector<char> known;
    if (!reads([&] { read_node_rows(mesh, path, nodes, "in the mesh", value, known); })) return;
    for (int i = 0; i < mesh.nodes(); ++i)
        demand(known[i] || value[offset(i, mesh.dim)] == -1, "a node without a row has a value");
}

}  // namespace almesh::fuzz
