#include "deck/make_problem.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>
#include <unordered_map>

#include "deck/deck_checks.hpp"
#include "deck/so_far.hpp"
#include "problem/base_mesh.hpp"
#include "problem/infeasible_target.hpp"
#include "problem/improve.hpp"
#include "problem/kept_surface.hpp"
#include "base/files.hpp"
#include "base/parallel.hpp"
#include "base/version.hpp"
#include "check/certificate.hpp"
#include "geometry/face_patches.hpp"
#include "io/mesh_format.hpp"
#include "mesh/inner_boundary.hpp"
#include "mesh/regular_cell.hpp"

namespace almesh {
namespace {

// The faces that a selection takes become a boundary of its name alone.
void select_faces(const Deck& deck, Mesh& mesh) {
    std::vector<int> part;
    for (const FaceSelection& selection : deck.selections) {
        if (!selection.condition && part.empty()) part = smooth_parts(mesh, deck.feature_angle);
        const auto is_chosen = [&](int f) {
            if (!selection.condition)
                return std::find(selection.parts.begin(), selection.parts.end(), part[f]) != selection.parts.end();
            return (*selection.condition)(centroid(mesh, mesh.x, mesh.face(f), mesh.face_cell(f).vertices),
                                           unit_normal(mesh, f));
        };
        std::vector<int> chosen;
        for (int f = 0; f < mesh.face_count(); ++f)
            if (is_chosen(f)) chosen.push_back(f);
        if (chosen.empty())
            throw UsageError(selection.where, ": select ", with_quotes(selection.name),
                             " takes no face of the boundary: almesh info ", deck.mesh,
                             selection.condition
                                 ? " shows the boxes of its boundaries"
                                 : " feature_angle=" + to_text(deck.feature_angle) + " numbers its parts");
        const std::vector<char> known = mesh.boundaries_in(selection.name);
        if (std::count(known.begin(), known.end(), 1) > 0)
            throw UsageError(selection.where, ": select ", with_quotes(selection.name),
                             ": the mesh has a boundary of this name already");
        const int boundary = add_boundary(mesh, {selection.name});
        for (const int f : chosen) mesh.face_boundary[f] = boundary;
    }
    drop_empty_boundaries(mesh);
}

// Of the regular cells with edges as long as the formula has it at the middle of the elements.
std::vector<double> volumes_by_size(const Deck& deck, const Problem& problem) {
    const Mesh& mesh = problem.mesh();
    const Expression size(deck.ideal_size, deck.constants);
    std::vector<double> volumes;
    for (int e = 0; e < mesh.element_count(); ++e) {
        const Vec<3> at = problem.frame.to_file(element_centre(mesh, mesh.x, e));
        const double length = size(at);
        if (!(length > 0) || !std::isfinite(length))
            throw UsageError(deck.given.at("ideal"), ": ideal = size: `", deck.ideal_size, "` is ", length,
                             " at element ", mesh.file.element_id[e], " at ", position_text(at.data(), mesh.dim),
                             ": it has to be a positive length everywhere");
        double volume = std::pow(length / problem.frame.length, mesh.dim);
        with_dimension(mesh.dim, [&](auto n) { volume *= regular_volume<n()>(mesh.cell(e)); });
        volumes.push_back(volume);
    }
    return volumes;
}

// The positions of the nodes of the file `path`, which `key` names, that have the ids of those of the problem's mesh,
// in the run's frame. Elements are the same where the ids of their nodes are, in whatever order. Throws InputError where
// its elements are not those of the mesh, and where one is not valid.
std::vector<double> read_positions(const Deck& deck, const std::string& key, const std::string& path,
                                   const Problem& problem) try {
    const Mesh& mesh = problem.mesh();
    const RawMesh raw = read_mesh(path, mesh.file.format);
    std::set<std::vector<long long>> elements;  // their ids, ascending
    for (const RawElement& element : raw.elements) {
        std::vector<long long> ids;
        for (int i = 0; i < element.node_count(); ++i)
            ids.push_back(raw.nodes[raw.element_nodes[element.first + i]].id);
        std::sort(ids.begin(), ids.end());
        if (element.dim == mesh.dim) elements.insert(std::move(ids));
    }
    const auto count = static_cast<std::size_t>(mesh.element_count());
    if (elements.size() != count)
        throw InputError("it has ", counted(elements.size(), "element"), ", the mesh of the run ", count);
    for (int e = 0; e < mesh.element_count(); ++e) {
        std::vector<long long> ids;
        for (int i = 0; i < mesh.element_nodes(e); ++i) ids.push_back(mesh.file.node_id[mesh.element(e)[i]]);
        std::sort(ids.begin(), ids.end());
        if (!elements.contains(ids))
            throw InputError("it has no element of the nodes of element ", mesh.file.element_id[e], " of the run");
    }
    std::unordered_map<long long, const RawNode*> node;
    for (const RawNode& each : raw.nodes) node[each.id] = &each;
    std::vector<double> x(mesh.x.size());
    for (int i = 0; i < mesh.nodes(); ++i)
        std::copy_n(node.at(mesh.file.node_id[i])->x, mesh.dim, point(x, i, mesh.dim));
    problem.frame.take_to_run(x, mesh.dim);
    const std::vector<double> bound = certify(mesh, x).certified_bound;
    const auto worst = std::min_element(bound.begin(), bound.end());
    if (*worst > 0) return x;
    throw InputError("it is not certified valid: the certified bound of element ",
                     mesh.file.element_id[worst - bound.begin()], " is ", rounded_down(*worst, 3));
} catch (const InputError& error) {
    throw InputError(deck.given.at(key), ": ", key, " = ", key == "start" ? "" : "mesh ", path, ": ", error.what());
}

// "\ntry A, B or C": what helps, or may.
std::string advice(const Deck& deck, const InfeasibleTarget& infeasible) {
    std::vector<std::string> to_try;
    if (deck.surface == SurfaceKind::keep && infeasible.sliding_may_help && accepts(deck, "surface", "auto"))
        to_try.push_back("surface = auto (nodes slide along the surface there)");
    if (infeasible.is_of_elements) {
        if (deck.split == Split::never && infeasible.division_helps && infeasible.is_simplicial &&
            accepts(deck, "split", "auto"))
            to_try.push_back("split = auto (just these are divided, with the elements at the same edges)");
        if (infeasible.refining_helps)
            to_try.push_back(concat("refine = ", deck.refine + 1, " (all elements are divided)"));
        if (!infeasible.is_simplicial) to_try.push_back("a mesh with more elements there");
        else if (!infeasible.division_helps)
            to_try.push_back("a mesh in which each of these has an edge that is on no boundary");
        to_try.push_back("targets that do not invert them");
    }
    std::string text;
    for (std::size_t k = 0; k < to_try.size(); ++k)
        text += (k == 0 ? "\ntry " : k + 1 < to_try.size() ? ", " : " or ") + to_try[k];
    return text;
}

// Throws the error that is being handled as the user of the deck is to read it.
[[noreturn]] void tell(const Deck& deck) try {
    throw;
} catch (const SettingError& error) {
    throw with_line(deck, error);
} catch (const InvalidMesh& error) {
    const std::string in_run = ", or ideal = regular, which does so in this run and lists those that stay invalid";
    throw InputError(error.what(), write_invalid(error.list, deck.output), "\ntry almesh improve ", deck.mesh,
                     ", which makes those valid whose boundary lets them be",
                     accepts(deck, "ideal", "regular") ? in_run : "");
} catch (const InfeasibleTarget& error) {
    throw InputError(error.what(), write_invalid(error.list, deck.output), advice(deck, error));
}

// Of the level of a problem that is improved.
void set_ideal_elements(const Deck& deck, Problem& problem) {
    if (deck.ideal == IdealKind::mesh)
        problem.level->ideal = read_positions(deck, "ideal", deck.ideal_file, problem);
    else if (deck.ideal == IdealKind::size) problem.regular = volumes_by_size(deck, problem);
    else set_regular_elements(problem);
}

void note(Problem& problem, const std::string& text) {
    if (!text.empty()) problem.notes.push_back(text);
}

}  // namespace

MeshSource read_source(const Deck& deck) {
    MeshSource source;
    try {
        source.text = read_file(deck.mesh);
    } catch (const InputError& error) {
        throw InputError(deck.given.at("mesh"), ": ", error.what());
    }
    parallel_invoke([&] { source.raw = parse_mesh(source.text, deck.mesh); },
                    [&] { source.hash = hash_of(source.text); });
    return source;
}

void assign_boundaries(const Deck& deck, Mesh& mesh, std::vector<std::string>& notes) try {
    if (!deck.selections.empty()) select_faces(deck, mesh);
    assign_boundaries(static_cast<const ProblemSetup&>(deck), mesh, notes);
} catch (const SettingError&) {
    tell(deck);
}

void move_target(const Deck& deck, Problem& problem) try {
    move_target(static_cast<const ProblemSetup&>(deck), problem);
} catch (const Error&) {
    tell(deck);
}

Problem make_problem(const Deck& deck, const MeshSource* given) try {
    check_keys(deck);
    MeshSource own;
    if (!given) own = read_source(deck);
    std::vector<std::string> notes;
    BaseMesh base = build_base_mesh(given ? given->raw : own.raw, deck.ideal, notes);
    own.raw = {};
    if (base.is_own_ideal && deck.ideal == IdealKind::automatic)
        notes.push_back("the straight-sided form of the mesh folds over itself: the curved mesh of the file is the "
                        "ideal mesh (ideal = given)");
    assign_boundaries(deck, base.mesh, notes);
    Problem problem = begin_problem(deck, std::move(base), std::move(notes));
    problem.mesh_hash = given ? given->hash : own.hash;
    note(problem, set_patched(deck, problem.level->mesh));
    note(problem, su2_losses(deck, problem.mesh()));
    if (problem.mesh().file.can_be_patched()) problem.mesh_text = given ? given->text : std::move(own.text);
    problem.way = way_of(deck, problem);
    if (deck.start == Start::file && deck.frames.empty()) problem.standing = read_standing(deck, problem);
    complete(deck, problem);
    if (deck.vtk != VtkOutput::none) note(problem, vtk_loss(problem.mesh().groups, problem.mesh().degree));
    identify(deck, problem);
    if (is_improved(deck.ideal)) {
        set_ideal_elements(deck, problem);
        hold_surface(deck, problem);
    }
    if (deck.start == Start::file) problem.start = read_positions(deck, "start", deck.start_file, problem);
    return problem;
} catch (const Error&) {
    tell(deck);
}

std::string run_id(Deck deck, FileHashes& known) {
    std::vector<std::string> files = {deck.mesh, deck.start_file, deck.ideal_file};
    for (const BoundaryMotion& boundary : deck.boundaries)
        for (const MotionStep& step : boundary.motion.steps) files.push_back(step.file);
    std::string hashes;
    for (const std::string& file : files) {
        std::error_code error;
        std::string& hash = known[file];
        if (hash.empty() && std::filesystem::is_regular_file(file, error)) hash = hash_of(read_file(file));
        hashes += hash;
    }
    const Deck defaults;
    deck.output = ".";
    deck.threads = defaults.threads;
    deck.max_seconds = defaults.max_seconds;
    deck.resume = defaults.resume;
    return hash_of(resolved(deck) + hashes);
}

void identify(const Deck& deck, Problem& problem) {
    FileHashes known = {{deck.mesh, problem.mesh_hash}};
    problem.run_id = run_id(deck, known);
    problem.level->mesh.file.comment = concat(version(), ", run ", problem.run_id);
}

std::string write_invalid(const ElementList& list, const std::string& folder) {
    constexpr int shown = 10;
    if (list.count <= shown) return "";
    if (folder.empty()) return "\n  ... (output=FOLDER lists all in FOLDER/invalid.csv)";
    std::error_code failed;  // of which the next line tells
    std::filesystem::create_directories(folder, failed);
    write_file(folder + "/invalid.csv", list.csv);
    return concat("\n  all ", list.count, " are listed in ", folder, "/invalid.csv");
}

}  // namespace almesh
