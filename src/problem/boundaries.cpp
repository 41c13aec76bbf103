#include "problem/boundaries.hpp"

#include <algorithm>
#include <map>

#include "base/error.hpp"
#include "base/text.hpp"
#include "mesh/inner_boundary.hpp"
#include "mesh/periodic.hpp"

namespace almesh {
namespace {

using Names = std::vector<std::string>;

bool has(const Names& names, const std::string& name) {
    return std::find(names.begin(), names.end(), name) != names.end();
}

std::string list_of(const Names& names) {
    constexpr std::size_t most = 20;
    std::string list;
    for (std::size_t k = 0; k < names.size() && k < most; ++k) list += (k ? ", " : "") + with_quotes(names[k]);
    return names.size() > most ? concat(list, " and ", names.size() - most, " more") : list;
}

std::string plain_name(const BoundaryMotion& line) {
    return line.is_volume ? line.name.substr(volume_group("").size()) : line.name;
}

// As it stands in a deck.
std::string shown(const BoundaryMotion& line) {
    return (line.is_volume ? "volume " : "boundary ") + with_quotes(plain_name(line));
}

// Names of the groups of the mesh: of outer faces, of inner faces, and of elements.
struct MeshGroups {
    Names outer, inner, volumes;

    explicit MeshGroups(const Mesh& mesh)
        : inner(names_of(inner_groups(mesh))), volumes(names_of(volume_groups(mesh))) {
        for (const Names& of_boundary : mesh.boundary_groups) add(of_boundary, outer);
    }

    static void add(const Names& more, Names& names) {
        for (const std::string& name : more)
            if (!has(names, name)) names.push_back(name);
    }
};

void check_names(const ProblemSetup& setup, const Mesh& mesh, const MeshGroups& groups) {
    Names faces = groups.outer;
    MeshGroups::add(groups.inner, faces);
    MeshGroups::add(mesh.boundaries, faces);
    const auto no_such = [](const char* kind, const std::string& name, const Names& names) {
        return concat(": the mesh has no ", kind, " ", with_quotes(name),
                      names.empty() ? "" : ", only " + list_of(names));
    };
    for (const BoundaryMotion& line : setup.boundaries) {
        const Names& names = line.is_volume ? groups.volumes : faces;
        if (!has(names, plain_name(line)) && line.name != "all" && line.name != "rest")
            throw UsageError(line.where,
                             no_such(line.is_volume ? "volume" : "boundary", plain_name(line), names));
        try {
            check_dimension(line.motion, mesh.dim);
        } catch (const UsageError& error) {
            throw UsageError(line.where, ": ", shown(line), ": ", error.what());
        }
    }
    if (!setup.wall.empty() && !has(groups.outer, setup.wall))
        throw SettingError("wall", "wall", no_such("boundary", setup.wall, groups.outer));
}

// The line that names a boundary, else one of its groups; null where none does.
const BoundaryMotion* line_of(const ProblemSetup& setup, const Mesh& mesh, int boundary) {
    const BoundaryMotion* found = find_row(setup.boundaries, mesh.boundaries[boundary]);
    if (found) return found;
    for (const BoundaryMotion& line : setup.boundaries) {
        if (!has(mesh.boundary_groups[boundary], line.name)) continue;
        if (found && found->motion != line.motion) {
            const auto face = std::find(mesh.face_boundary.begin(), mesh.face_boundary.end(), boundary);
            throw UsageError(line.where, ": ", shown(line), " and ", shown(*found), " (", found->where,
                             ") have faces in common, the first with id ",
                             mesh.file.face_id[face - mesh.face_boundary.begin()], ", and their motions disagree");
        }
        if (!found) found = &line;
    }
    return found;
}

// Boundary b becomes number[b]; several become one, with the groups of all, and of those below 0 nothing is left.
void renumber_boundaries(Mesh& mesh, const std::vector<int>& number) {
    Mesh renumbered;
    for (std::size_t b = 0; b < number.size(); ++b) {
        if (number[b] < 0) continue;
        if (number[b] == static_cast<int>(renumbered.boundaries.size())) {
            renumbered.boundaries.push_back(mesh.boundaries[b]);
            renumbered.boundary_groups.emplace_back();
            if (!mesh.inner.empty()) renumbered.inner.push_back(mesh.inner[b]);
        }
        MeshGroups::add(mesh.boundary_groups[b], renumbered.boundary_groups[number[b]]);
    }
    mesh.boundaries = std::move(renumbered.boundaries);
    mesh.boundary_groups = std::move(renumbered.boundary_groups);
    mesh.inner = std::move(renumbered.inner);
    for (int& boundary : mesh.face_boundary) boundary = number[boundary];
}

// Boundaries that one line moves become one, of its name.
void merge_boundaries(const ProblemSetup& setup, Mesh& mesh) {
    std::map<std::pair<std::string, bool>, int> known;  // by name, and whether it is an inner one
    std::vector<int> number;
    for (int b = 0; b < static_cast<int>(mesh.boundaries.size()); ++b) {
        if (const BoundaryMotion* const line = line_of(setup, mesh, b)) mesh.boundaries[b] = line->name;
        const bool is_inner = !mesh.inner.empty() && mesh.inner[b];
        const int next = static_cast<int>(known.size());
        number.push_back(known.try_emplace({mesh.boundaries[b], is_inner}, next).first->second);
    }
    renumber_boundaries(mesh, number);
}

// The motion, with `slide` last where it prescribes positions.
Motion sliding(const Motion& motion) {
    if (!is_prescribed(kind_of(motion))) return motion;
    Motion with = is_fixed(motion) ? Motion{} : motion;
    with.steps.push_back(motion_of(NodeKind::slides).steps.front());
    return with;
}

// `contact = A, B; C`: 1 for A and B, -2 for C.
void set_contacts(const ProblemSetup& setup, Mesh& mesh) {
    if (setup.contact.empty()) return;
    const auto refuse = [](std::string_view name, const char* why) {
        throw SettingError("contact", "contact: ", in_backquotes(name), why);
    };
    mesh.contact.assign(mesh.boundaries.size(), 0);
    int number = 0;
    for (const std::string_view list : split(setup.contact, ';')) {
        const std::vector<std::string_view> names = split(list, ',');
        ++number;
        for (const std::string_view name : names) {
            bool is_known = false;
            for (std::size_t b = 0; b < mesh.boundaries.size(); ++b) {
                if (mesh.boundaries[b] != name && !has(mesh.boundary_groups[b], std::string(name))) continue;
                if (mesh.contact[b] != 0) refuse(name, " stands twice");
                mesh.contact[b] = names.size() == 1 ? -number : number;
                is_known = true;
            }
            if (!is_known) refuse(name, " is no boundary of the mesh");
        }
    }
}

}  // namespace

bool stays_on_surface(const Motion& motion) { return is_fixed(motion) || motion == motion_of(NodeKind::slides); }

const char* const without_motion =
    "sides that are periodic in the file move as one where no line names them, something else moves, both are sides of "
    "the mesh, and the nodes of one are those of the other rotated and moved";

const BoundaryMotion* motion_for(const ProblemSetup& setup, const std::string& boundary) {
    for (const std::string& name : {boundary, std::string("rest"), std::string("all")})
        if (const BoundaryMotion* const found = find_row(setup.boundaries, name)) return found;
    return nullptr;
}

void drop_empty_boundaries(Mesh& mesh) {
    std::vector<int> number(mesh.boundaries.size(), -1);
    for (const int boundary : mesh.face_boundary) number[boundary] = 0;
    int next = 0;
    for (int& boundary : number)
        if (boundary == 0) boundary = next++;
    renumber_boundaries(mesh, number);
}

void assign_boundaries(const ProblemSetup& setup, Mesh& mesh, std::vector<std::string>& notes) {
    const MeshGroups groups(mesh);
    const bool keeps_inner = is_improved(setup.ideal) && motion_for(setup, "rest");
    Names inner, volumes;
    for (const BoundaryMotion& line : setup.boundaries) {
        if (line.is_volume) volumes.push_back(plain_name(line));
        else if (has(groups.inner, line.name)) inner.push_back(line.name);
    }
    if (keeps_inner) inner = groups.inner;
    if (!inner.empty() || !volumes.empty() || keeps_inner) {
        make_inner_boundaries(mesh, inner, volumes, keeps_inner);
        drop_empty_boundaries(mesh);
    }
    check_names(setup, mesh, groups);
    const Names free = names_of(inner_groups(mesh));
    if (!free.empty()) notes.push_back("inside the mesh, and free as the deck has no line for them: " + list_of(free));
    merge_boundaries(setup, mesh);
    set_contacts(setup, mesh);
}

std::vector<Motion> motions_of(const ProblemSetup& setup, const Mesh& mesh, std::vector<char>* of_one) {
    std::vector<Motion> motions;
    std::vector<char> periodic;
    Names missing;
    for (std::size_t b = 0; b < mesh.boundaries.size(); ++b) {
        const BoundaryMotion* const line = motion_for(setup, mesh.boundaries[b]);
        const bool slides = setup.surface == SurfaceKind::slide && line && !line->is_volume;
        motions.push_back(!line ? motion_of(NodeKind::fixed) : slides ? sliding(line->motion) : line->motion);
        const bool is_inner = !mesh.inner.empty() && mesh.inner[b];
        periodic.push_back(stays_on_surface(motions[b]) && !is_inner &&
                           !find_row(setup.boundaries, mesh.boundaries[b]));
    }
    periodic = periodic_boundaries(mesh, periodic);
    for (std::size_t b = 0; b < motions.size(); ++b)
        if (!periodic[b] && !motion_for(setup, mesh.boundaries[b])) missing.push_back(mesh.boundaries[b]);
    if (std::all_of(motions.begin(), motions.end(), is_fixed)) periodic.assign(motions.size(), 0);
    for (std::size_t b = 0; b < motions.size(); ++b)
        if (periodic[b] && is_fixed(motions[b])) motions[b] = motion_of(NodeKind::free);
    if (of_one) *of_one = std::move(periodic);
    if (missing.empty()) return motions;
    std::string lines;
    for (const std::string& name : missing)
        lines += "\n  boundary " + quoted_where_needed(name, "#=\" \t") + " = fixed";
    throw SettingError("", counted(missing.size(), "boundary line"),
                     " missing; add `boundary rest = fixed`, or each of these with its motion:", lines,
                     mesh.file.periodic.empty() ? "" : concat("\n", without_motion));
}

bool may_stay(const ProblemOptions& options, const std::vector<Motion>& motions) {
    return options.ideal == IdealKind::regular && std::all_of(motions.begin(), motions.end(), [](const Motion& motion) {
               return stays_on_surface(motion) || goes_onto(motion);
           });
}

}  // namespace almesh
