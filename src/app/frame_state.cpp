// A line of text, then t, x, and where there is one before that, its t and x.
#include "app/frame_state.hpp"

#include <cstring>
#include <filesystem>
#include <string_view>

#include "app/commands.hpp"
#include "app/deck.hpp"
#include "app/problem.hpp"
#include "base/error.hpp"
#include "base/files.hpp"

namespace almesh {
namespace {

std::string path_of(const Deck& deck) { return concat(deck.output, "/", frames_state); }

// What the file begins with, before the number of the frame.
std::string heading(const Problem& problem) {
    return concat("almesh frames, ", version(), " ", commit(), ", run ", problem.run_id, ", frame ");
}

void append_bytes(std::string& text, double t, const std::vector<double>& x) {
    text.append(reinterpret_cast<const char*>(&t), sizeof t);
    text.append(reinterpret_cast<const char*>(x.data()), x.size() * sizeof(double));
}

// x has its size.
void take_bytes(std::string_view& bytes, double& t, std::vector<double>& x) {
    std::memcpy(&t, bytes.data(), sizeof t);
    std::memcpy(x.data(), bytes.data() + sizeof t, x.size() * sizeof(double));
    bytes.remove_prefix(sizeof t + x.size() * sizeof(double));
}

}  // namespace

void FramesBefore::push(const std::vector<double>& mesh, double time, const std::vector<Motion>& of_mesh) {
    if (!x.empty() && time != t) {
        earlier.swap(x);
        earlier_t = t;
    }
    x = mesh;
    t = time;
    motions = of_mesh;
}

void save_state(const Deck& deck, const Problem& problem, const FramesBefore& before, int number) {
    std::string state = concat(heading(problem), number, "\n");
    append_bytes(state, before.t, before.x);
    if (!before.earlier.empty()) append_bytes(state, before.earlier_t, before.earlier);
    write_file(path_of(deck), state);
}

int read_state(const Deck& deck, const Problem& problem, FramesBefore& before) {
    std::error_code error;
    if (!std::filesystem::exists(path_of(deck), error)) return 0;
    const std::string text = read_file(path_of(deck)), first = text.substr(0, text.find('\n'));
    std::string_view bytes = std::string_view(text).substr(std::min(text.size(), first.size() + 1));
    const std::size_t of_mesh = (problem.mesh().x.size() + 1) * sizeof(double);
    const auto number = parse_int(first.substr(first.rfind(' ') + 1), 1);
    if (!first.starts_with(heading(problem)) || !number || (bytes.size() != of_mesh && bytes.size() != 2 * of_mesh))
        throw UsageError("cannot resume: ", path_of(deck), " is of another run or program; without resume=1 this run ",
                         "starts from the beginning and removes it");
    before.x.resize(problem.mesh().x.size());
    before.earlier.resize(bytes.size() > of_mesh ? before.x.size() : 0);
    take_bytes(bytes, before.t, before.x);
    if (!before.earlier.empty()) take_bytes(bytes, before.earlier_t, before.earlier);
    return *number;
}

}  // namespace almesh
