// A line of text, then t and x of the last one or two.
#include "problem/frame_state.hpp"

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <string_view>

#include "base/version.hpp"
#include "deck/deck.hpp"
#include "problem/problem.hpp"
#include "base/error.hpp"
#include "base/files.hpp"

namespace almesh {
namespace {

std::string path_of(const Deck& deck) { return concat(deck.output, "/", frames_state); }

// What the file begins with, before the number of the frame.
std::string heading(const Problem& problem) {
    return concat("almesh frames, ", version(), " ", commit(), ", run ", problem.run_id, ", frame ");
}

}  // namespace

const Moment* FramesBefore::before(double t) const {
    const auto found = std::find_if(moments.rbegin(), moments.rend(), [t](const Moment& of) { return of.t < t; });
    return found == moments.rend() ? nullptr : &*found;
}

void FramesBefore::push(Moment moment) {
    if (!moments.empty() && moments.back().t == moment.t) moments.pop_back();
    if (moments.size() == 3) moments.erase(moments.begin());
    moments.push_back(std::move(moment));
}

void save_state(const Deck& deck, const Problem& problem, const FramesBefore& before, int number) {
    std::string state = concat(heading(problem), number, "\n");
    for (std::size_t k = std::max<std::size_t>(before.moments.size(), 2) - 2; k < before.moments.size(); ++k) {
        const auto& [t, x, motions] = before.moments[k];
        state.append(reinterpret_cast<const char*>(&t), sizeof t);
        state.append(reinterpret_cast<const char*>(x.data()), x.size() * sizeof(double));
    }
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
    for (; !bytes.empty(); bytes.remove_prefix(of_mesh)) {
        auto& [t, x, motions] = before.moments.emplace_back();
        x.resize(problem.mesh().x.size());
        std::memcpy(&t, bytes.data(), sizeof t);
        std::memcpy(x.data(), bytes.data() + sizeof t, of_mesh - sizeof t);
    }
    return *number;
}

}  // namespace almesh
