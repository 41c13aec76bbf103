#include "deck/deck_checks.hpp"

#include <algorithm>

#include "deck/frame_times.hpp"
#include "deck/so_far.hpp"
#include "io/mesh_format.hpp"

namespace almesh {
namespace {

// The rest of the mesh stays as it is in the file.
void check_local_repair(const Deck& deck) {
    if (deck.local_repair != LocalRepair::yes) return;
    constexpr const char* why = " does not go with local_repair = 1, which leaves the mesh as it is in the file but for "
                                "inverted elements and those around them";
    for (const BoundaryMotion& boundary : deck.boundaries)
        if (!is_fixed(boundary.motion)) throw UsageError(boundary.where, ": a boundary that is not fixed", why);
    for (const char* key : {"refine", "degree", "frames"})
        if (deck.given.contains(key)) throw SettingError(key, key, why);
    if (deck.surface == SurfaceKind::keep || deck.surface == SurfaceKind::slide)
        throw SettingError("surface", "surface = keep or slide", why);
    if (deck.distortion.delta > 0) throw SettingError("delta", "delta", why);
    if (deck.split != Split::never) throw SettingError("split", "split", why);
}

void check_improve(const Deck& deck) {
    if (!is_improved(deck.ideal)) return;
    for (const auto& [key, is_set] : {std::pair("frames", !deck.frames.empty()), {"start", deck.start == Start::coarse},
                                      {"local_repair", deck.local_repair == LocalRepair::yes},
                                      {"split", deck.split != Split::never}})
        if (is_set) throw SettingError(key, key, " does not go with ideal = regular, size or mesh: leave it out");
}

}  // namespace

std::vector<FileFormat> final_formats(FinalFormat wanted, const Mesh& mesh) {
    const FileFormat msh, su2 = {".su2"};
    if (wanted == FinalFormat::msh) return {msh};
    if (wanted == FinalFormat::su2) return {su2};
    if (wanted == FinalFormat::both) return {msh, su2};
    return {mesh.file.can_be_patched() ? mesh.file.format : written_anew(mesh.file.format)};
}

std::string su2_losses(const Deck& deck, const Mesh& mesh) {
    const FileFormat format = final_formats(deck.final_format, mesh).back();
    if (format.ending != ".su2") return "";
    std::string text;
    if (mesh.degree > 1)
        text = concat("final.su2 has elements of degree ", mesh.degree,
                      ", which of SU2 only the high-order solver reads; final = msh writes final.msh");
    std::size_t unmarked = 0;
    for (int f = 0; f < mesh.face_count(); ++f) unmarked += !mesh.is_inner(f) && mesh.file.face_physical[f] <= 0;
    if (unmarked == 0 || (format == mesh.file.format && mesh.file.can_be_patched())) return text;
    return concat(text, text.empty() ? "" : "; ", counted(unmarked, "face"), " of the boundary ",
                  unmarked == 1 ? "is" : "are", " in no marker of final.su2, as in no group of the mesh file");
}

UsageError with_line(const Deck& deck, const SettingError& error) {
    const auto where = deck.given.find(error.key);
    return UsageError(where == deck.given.end() ? deck.path : where->second, ": ", error.what());
}

// Formulas of t without frames, and what frames do not go with.
void check_times(const Deck& deck) try {
    for (const BoundaryMotion& boundary : deck.boundaries)
        if (deck.frames.empty() && depends_on_time(boundary.motion))
            throw UsageError(boundary.where, ": boundary ", boundary.name, " moves with the time t: ",
                             "give the times, such as `frames = 0 : 0.1 : 1`");
    if (files_in_line(deck) > 0 && !is_coupled(deck.frames))
        throw SettingError("", "a step `file -` takes the file that standard input names with each time, which needs "
                           "`frames = -`");
    if (is_coupled(deck.frames) && deck.resume)
        throw SettingError("resume", "resume does not go with frames = -: start the run again and send the last times "
                           "again");
    if (deck.velocity != Velocity::no && deck.frames.empty())
        throw SettingError("velocity", "velocity needs frames, the times of a motion");
    for (const auto& [key, is_set] : {std::pair("split", deck.split != Split::never),
                                      {"surface", deck.surface == SurfaceKind::straighten},
                                      {"iterates", deck.iterates > 0}})
        if (is_set && !deck.frames.empty())
            throw SettingError(key, key, " does not go with frames: leave it out");
} catch (const SettingError& error) {
    throw with_line(deck, error);
}

void check_keys(const Deck& deck) try {
    // Algorithm 1 as printed weighs the penalty mu^2: the mu of a coarser mesh would mean something else.
    if (deck.start == Start::coarse && deck.method.algorithm == Algorithm::literal)
        throw SettingError("start", "start = coarse does not go with algorithm = literal; take start = identity");
    if (deck.resume && deck.frames.empty())
        throw SettingError("resume", "resume is for frames; try ", command_to_go_on(deck));
    check_times(deck);
    if (deck.method.moving != MovingMethod::augmented_lagrangian && deck.distortion.objective == Objective::minimax)
        throw SettingError("method", "objective = minimax does not go with this method: take method = "
                           "augmented_lagrangian");
    check_local_repair(deck);
    check_improve(deck);
} catch (const SettingError& error) {
    throw with_line(deck, error);
}

bool accepts(Deck deck, const std::string& key, const std::string& value) try {
    const DeckKey& row = *find_row(deck_keys(), key);
    const std::string before = row.value.text(deck);
    set_value(deck, row, value);
    if (row.value.text(deck) == before) return false;
    check_keys(deck);
    return true;
} catch (const UsageError&) {
    return false;
}

std::string set_patched(const Deck& deck, Mesh& mesh) {
    const std::vector<FileFormat> formats = final_formats(deck.final_format, mesh);
    if (std::find(formats.begin(), formats.end(), mesh.file.format) == formats.end()) mesh.file.leave_file();
    if (mesh.file.can_be_patched()) return "";
    std::string names;
    for (const std::string& name : mesh.file.sections) names += (names.empty() ? "" : ", ") + name;
    if (const int loose = mesh.file.loose)
        names += concat(names.empty() ? "" : ", ", counted(loose, "node"), " without an element");
    return names.empty() ? "" : "not in the final mesh, which is written anew: " + names;
}

}  // namespace almesh
