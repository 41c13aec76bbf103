#include "deck/so_far.hpp"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "base/error.hpp"
#include "base/files.hpp"
#include "base/text.hpp"
#include "check/certificate.hpp"
#include "deck/deck.hpp"
#include "io/msh.hpp"
#include "problem/problem.hpp"
#include "problem/solution.hpp"

namespace almesh {
namespace {

constexpr std::string_view heading = "the mesh so far, on the way ";

// A field of the standing, one number or several, as numbers.
template <class Field>
std::vector<double> numbers_of(const Field& field) {
    if constexpr (std::is_arithmetic_v<Field>) return {static_cast<double>(field)};
    else return {field.begin(), field.end()};
}

template <class Field>
bool read(std::string_view text, Field& field) {
    std::vector<double> numbers;
    for (const std::string_view word : words(text)) numbers.push_back(parse_double(word).value_or(NAN));
    if constexpr (std::is_arithmetic_v<Field>) {
        if (numbers.size() != 1 || !(numbers[0] >= -1)) return false;
        field = static_cast<Field>(numbers[0]);
    } else {
        field.assign(numbers.begin(), numbers.end());
    }
    return numbers_of(field) == numbers;  // a field of whole numbers holds no others, and none is nan
}

// visit(name, field) for all that there is.
template <class Visit>
void for_fields(Standing& standing, const Visit& visit) {
    visit("fraction ", standing.fraction);
    visit("power ", standing.power);
    visit("is_last_power ", standing.is_last_power);
    visit("eta_before ", standing.eta_before);
    visit("mu ", standing.mu);
    visit("lambda ", standing.lambda);
    visit("attempt ", standing.attempt);
    visit("gradient_norm ", standing.gradient_norm);
    visit("straight ", standing.straight);
    visit("freed ", standing.freed);
}

std::string text_of(Standing standing, const std::string& way) {
    std::string text = concat(heading, way);
    for_fields(standing, [&](const char* name, const auto& field) {
        text += concat("\n", name);
        for (const double number : numbers_of(field)) text += to_text(number) + " ";
    });
    return text;
}

bool is_sound(const Standing& at, const Mesh& mesh) {
    const auto nodes = static_cast<std::size_t>(mesh.nodes()), elements = static_cast<std::size_t>(mesh.element_count());
    return at.fraction >= 0 && at.power >= 0 && at.mu >= 0 &&
           (at.attempt < 0 || (at.freed.size() == nodes && at.straight.size() == elements));
}

}  // namespace

std::string path_so_far(const Deck& deck) { return deck.output + "/so-far.msh"; }

std::string command_to_go_on(const Deck& deck) {
    return concat("almesh ", is_improved(deck.ideal) && deck.path == deck.mesh ? "improve " : "", deck.path, " start=",
                  path_so_far(deck), " with the other settings of this run, which goes on from where it stood");
}

std::string way_of(const Deck& deck, const Problem& problem) {
    std::string text = problem.mesh_hash;
    for (const Constant& constant : deck.constants) text += concat(constant.name, "=", constant.text, "\n");
    for (const BoundaryMotion& boundary : deck.boundaries)
        text += concat(boundary.name, "=", to_string(boundary.motion), "\n");
    const std::vector<double>& target = problem.node_target;
    text.append(reinterpret_cast<const char*>(target.data()), target.size() * sizeof(double));
    return hash_of(text);
}

std::optional<Standing> read_standing(const Deck& deck, Problem& problem) try {
    const std::string text = read_file(deck.start_file), any = concat("\n", heading), own = any + problem.way + "\n";
    const auto at = text.find(own);
    if (at == std::string::npos && text.find(any) != std::string::npos)
        problem.notes.push_back(concat(deck.start_file, " was written on the way to another target or by another "
                                       "motion: only the positions of its nodes are taken"));
    if (at == std::string::npos) return std::nullopt;
    std::string_view rest = std::string_view(text).substr(at + own.size());
    Standing standing;
    bool is_whole = true;
    for_fields(standing, [&](std::string_view name, auto& field) {
        const std::string_view line = rest.substr(0, rest.find('\n'));
        is_whole = is_whole && line.starts_with(name) && read(line.substr(name.size()), field);
        rest.remove_prefix(std::min(rest.size(), line.size() + 1));
    });
    if (is_whole && is_sound(standing, problem.mesh())) return standing;
    throw InputError("where its run stood is damaged");
} catch (const InputError& error) {
    throw InputError(deck.given.at("start"), ": start = ", deck.start_file, ": ", error.what());
}

void WrittenMeshSoFar::keep(const Level& level, const std::vector<double>& x) {
    const bool is_stopped = &level != problem_.level.get() && interrupted();  // on its own level more may come
    if (is_stopped || std::chrono::duration<double>(Clock::now() - written_).count() >= seconds_) write(level, x);
    if (observe_) observe_();
}

void WrittenMeshSoFar::write(const Level& level, const std::vector<double>& x) {
    written_ = Clock::now();
    const Mesh& mesh = problem_.mesh();
    std::vector<double> positions = standing->x.empty() ? x : standing->x;
    if (&level != problem_.level.get()) {
        for (std::size_t i = 0; i < positions.size(); ++i) positions[i] -= level.ideal[i];
        positions = prolong(level.mesh, level.ideal, mesh, problem_.ideal(), positions);
        for (std::size_t i = 0; i < positions.size(); ++i) positions[i] += problem_.ideal()[i];
    }
    if (positions == problem_.ideal() || !certify(mesh, positions).valid) return;
    Mesh in_file = mesh;
    const Standing stands = is_improved(deck_.ideal) ? Standing() : *standing;  // it has many solutions
    in_file.file.comment += "\n" + text_of(stands, problem_.way);
    try {
        write_msh(path_so_far(deck_), in_file, final_positions(problem_, positions));
    } catch (const InputError& failed) {
        if (!has_failed_) std::fprintf(out_, "note: the mesh so far cannot be kept: %s\n", failed.what());
        has_failed_ = true;
    }
}

}  // namespace almesh
