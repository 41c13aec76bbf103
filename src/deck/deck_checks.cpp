#include "deck/deck_checks.hpp"

#include <algorithm>

#include "check/certificate.hpp"
#include "deck/frame_times.hpp"
#include "problem/improve.hpp"
#include "problem/so_far.hpp"
#include "report/results.hpp"
#include "base/error.hpp"
#include "io/msh.hpp"

namespace almesh {
namespace {

// The rest of the mesh stays as it is in the file.
void check_local_repair(const Deck& deck) {
    if (deck.local_repair != LocalRepair::yes) return;
    const auto refuse = [&](const std::string& where, const char* what) {
        throw UsageError(where, ": ", what, " does not go with local_repair = 1, which leaves the mesh as it is in ",
                         "the file but for inverted elements and those around them");
    };
    for (const DeckBoundary& boundary : deck.boundaries)
        if (!is_fixed(boundary.motion)) refuse(boundary.where, "a boundary that is not fixed");
    for (const char* key : {"refine", "degree", "frames"})
        if (deck.given.contains(key)) refuse(deck.given.at(key), key);
    if (deck.surface == SurfaceKind::keep || deck.surface == SurfaceKind::slide)
        refuse(deck.given.at("surface"), "surface = keep or slide");
    if (deck.distortion.delta > 0) refuse(deck.given.at("delta"), "delta");
    if (deck.split != Split::never) refuse(deck.given.at("split"), "split");
}

// Algorithm 1 as printed weighs the penalty mu^2: the mu of a coarser mesh would mean something else.
void check_start(const Deck& deck) {
    if (deck.start != Start::coarse || deck.method.algorithm != Algorithm::literal) return;
    throw UsageError(deck.given.at("start"),
                     ": start = coarse does not go with algorithm = literal; take start = identity");
}

void check_resume(const Deck& deck) {
    if (!deck.resume || !deck.frames.empty()) return;
    throw UsageError(deck.given.at("resume"), ": resume is for frames; try ", command_to_go_on(deck));
}

void check_method(const Deck& deck) {
    if (deck.method.moving == MovingMethod::augmented_lagrangian || deck.distortion.objective != Objective::minimax)
        return;
    throw UsageError(deck.given.at("method"),
                     ": objective = minimax does not go with this method: take method = augmented_lagrangian");
}

}  // namespace

// With fewer points than |F|^2 needs, the energy does not see some motions of the nodes inside an element.
void check_quadrature(const Deck& deck, const Mesh& mesh, int degree) {
    const int least = mesh.is_simplicial() ? 2 * (degree - 1) : 2 * degree, exactness = deck.distortion.exactness;
    if (exactness == 0 || exactness >= least) return;
    throw UsageError(deck.given.at("quadrature"), ": quadrature = ", exactness, " is too low for elements of degree ",
                     degree, ": take at least ", least, ", or 0");
}

std::string curved_su2(const Deck& deck, const Mesh& mesh) {
    if (mesh.degree == 1 || final_formats(deck.final_format, mesh).back().kind != FileFormat::Kind::su2) return "";
    return concat("final.su2 has elements of degree ", mesh.degree,
                  ", which of SU2 only the high-order solver reads; final = msh writes final.msh");
}

// Before a run rather than after it.
void check_final_ids(const Deck& deck, const Mesh& mesh) {
    for (const FileFormat& format : final_formats(deck.final_format, mesh)) check_ids_fit(mesh, format);
}

void check_split(const Deck& deck, const Mesh& mesh) {
    if (deck.split == Split::never || mesh.is_simplicial()) return;
    throw UsageError(deck.given.at("split"), ": split divides triangles and tetrahedra, but the mesh has ",
                     mesh.elements_text(), ": leave it out");
}

// A mesh that is its own ideal mesh has no coarser one, and one of lower degree has another shape.
void check_curved_ideal(const Deck& deck, const Mesh& in_file, const Mesh& of_run) {
    if (deck.start == Start::coarse)
        throw UsageError(deck.given.at("start"), ": start = coarse needs a straight-sided ideal mesh; with ideal = "
                         "given take start = identity");
    if (of_run.degree < in_file.degree && !certify(of_run, of_run.x).valid)
        throw UsageError(deck.given.at("degree"), ": in degree ", of_run.degree, " the curved mesh, which is the "
                         "ideal mesh with ideal = given, is not valid: take degree = ", in_file.degree);
}

// Formulas of t without frames, and what frames do not go with.
void check_times(const Deck& deck) {
    for (const DeckBoundary& boundary : deck.boundaries)
        if (deck.frames.empty() && depends_on_time(boundary.motion))
            throw UsageError(boundary.where, ": boundary ", boundary.name, " moves with the time t: ",
                             "give the times, such as `frames = 0 : 0.1 : 1`");
    if (files_in_line(deck) > 0 && !is_coupled(deck.frames))
        throw UsageError(deck.path, ": a step `file -` takes the file that standard input names with each time, which "
                         "needs `frames = -`");
    if (is_coupled(deck.frames) && deck.resume)
        throw UsageError(deck.given.at("resume"), ": resume does not go with frames = -: start the run again and send "
                         "the last times again");
    if (deck.velocity != Velocity::no && deck.frames.empty())
        throw UsageError(deck.given.at("velocity"), ": velocity needs frames, the times of a motion");
    for (const auto& [key, is_set] : {std::pair("split", deck.split != Split::never),
                                      std::pair("surface", deck.surface == SurfaceKind::straighten),
                                      std::pair("iterates", deck.iterates > 0)})
        if (is_set && !deck.frames.empty())
            throw UsageError(deck.given.at(key), ": ", key, " does not go with frames: leave it out");
}

void check_keys(const Deck& deck) {
    check_start(deck);
    check_resume(deck);
    check_times(deck);
    check_method(deck);
    check_local_repair(deck);
    check_improve(deck);
}

bool accepts(Deck deck, const Mesh& mesh, const std::string& key, const std::string& value) try {
    for (const DeckKey& row : deck_keys()) {
        if (row.name != key) continue;
        const std::string before = row.value.text(deck);
        set_value(deck, row, value);
        if (row.value.text(deck) == before) return false;
    }
    deck.given[key] = key;
    check_keys(deck);
    check_split(deck, mesh);
    return true;
} catch (const UsageError&) {
    return false;
}

std::string left_out_sections(const Deck& deck, const Mesh& in_file, const Mesh& of_run) {
    const std::vector<FileFormat> formats = final_formats(deck.final_format, of_run);
    const bool same_format = std::find(formats.begin(), formats.end(), in_file.file.format) != formats.end();
    if (same_format && of_run.file.sections.size() == in_file.file.sections.size()) return "";
    std::string names;
    for (const FileSection& section : in_file.file.sections) names += (names.empty() ? "" : ", ") + section.name;
    if (names.empty()) return "";
    return concat("not in the final mesh, as its ", same_format ? "elements are not those" : "format is not that",
                  " of the file: ",
                  names);
}

}  // namespace almesh
