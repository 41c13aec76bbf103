#include "problem/kept_surface.hpp"

#include <algorithm>

#include "base/table.hpp"
#include "check/boundary_distance.hpp"
#include "check/certificate.hpp"
#include "check/swept_volumes.hpp"
#include "mesh/inner_boundary.hpp"
#include "mesh/kept_cells.hpp"

namespace almesh {
namespace {

// Per boundary: whether it stays where the file has it, but for nodes that slide.
std::vector<char> kept_boundaries(const Problem& problem) {
    std::vector<char> kept;
    for (const Motion& motion : problem.motions) kept.push_back(stays_on_surface(motion));
    return kept;
}

std::vector<char> nodes_of_faces(const Mesh& mesh, const std::vector<char>& chosen) {
    return nodes_with(mesh, [&](int f, std::size_t) { return chosen[f]; });
}

// Fixes those of the nodes that slide on boundaries that stay. Returns their number.
int hold(Problem& problem, const std::vector<char>& nodes) {
    const Mesh& mesh = problem.mesh();
    const std::vector<char> kept = kept_boundaries(problem);
    BoundaryTarget& target = problem.target;
    std::vector<char> held(mesh.nodes(), 0);
    for_face_nodes(mesh, [&](int f, std::size_t k) {
        const int node = mesh.faces[k];
        if (target.kind[k] != NodeKind::slides || !nodes[node] || !kept[mesh.face_boundary[f]]) return;
        target.kind[k] = std::min(target.written_kind[k], NodeKind::target);
        held[node] = 1;
    });
    if (target.prescribes_all()) problem.sliding = nullptr;
    return static_cast<int>(std::count(held.begin(), held.end(), 1));
}

void note(Problem& problem, int count, const std::string& why) {
    if (count == 0) return;
    const std::string text = concat(counted(count, "boundary node"), count == 1 ? " stays" : " stay", why);
    if (problem.notes.empty() || problem.notes.back().find(" slide along: ") == std::string::npos)
        problem.notes.push_back(text);
    else problem.notes.back() += "; " + text;
}

// Changes of the volumes of the regions, relative to them: of curved elements too, by what their faces have swept.
std::string volume_changes(const Mesh& mesh, const std::vector<double>& x) {
    std::vector<GroupCells> regions = volume_groups(mesh);
    if (regions.empty()) {
        regions.push_back({"the mesh", {}});
        for (int e = 0; e < mesh.element_count(); ++e) regions[0].cells.push_back(e);
    }
    const std::vector<MeshFace> faces = mesh_faces(mesh);
    const std::vector<double> swept = swept_volumes(mesh, faces, mesh.x, x);
    std::string text;
    for (const GroupCells& region : regions) {
        std::vector<char> is_in(mesh.element_count(), 0);
        double before = 0, gained = 0;
        for (const int e : region.cells) {
            is_in[e] = 1;
            before += volume(mesh, mesh.x, e);
        }
        for (std::size_t k = 0; k < faces.size(); ++k) {
            const bool goes_out = is_in[faces[k].element];
            const bool goes_in = faces[k].neighbour >= 0 && is_in[faces[k].neighbour];
            if (goes_out != goes_in) gained += goes_out ? swept[k] : -swept[k];
        }
        text += concat(text.empty() ? "" : ", ", region.name, " ", to_text(gained / before, 2));
    }
    return concat("change of ", mesh.dim == 2 ? "area" : "volume", ": ", text);
}

}  // namespace

std::vector<double> distances_from_surface(const Problem& problem, const std::vector<double>& x) {
    return relative_face_distances(problem.mesh(), problem.mesh().x, x, kept_boundaries(problem));
}

void hold_curved_faces(const ProblemOptions& options, Problem& problem, const std::vector<double>& x) {
    if (!problem.sliding) return;
    const double tolerance = options.surface_tolerance;
    const std::vector<char> curved = curved_faces(problem.mesh(), problem.target, *problem.sliding, x, tolerance);
    note(problem, hold(problem, nodes_of_faces(problem.mesh(), curved)),
         concat(": if they slid, faces would leave the surface by more than surface_tolerance = ", tolerance,
                " of an edge"));
}

void hold_surface(const ProblemOptions& options, Problem& problem) {
    const Mesh& mesh = problem.mesh();
    if (certify(mesh, mesh.x).valid) hold_curved_faces(options, problem, mesh.x);
    if (problem.sliding) note(problem, hold(problem, nodes_of_features(mesh)), ", being on named points or curves");
}

void take_along_target(Problem& problem, const std::vector<double>& from, const std::vector<double>& x) {
    const Mesh& mesh = problem.mesh();
    for_face_nodes(mesh, [&](int, std::size_t k) {
        const double *const is = point(x, mesh.faces[k], mesh.dim), *const was = point(from, mesh.faces[k], mesh.dim);
        for (int a = 0; a < mesh.dim && !std::equal(is, is + mesh.dim, was); ++a) {
            problem.target.node[offset(k, mesh.dim, a)] = is[a];
            problem.node_target[offset(k, mesh.dim, a)] = problem.frame.to_file(is[a], a, mesh.dim);
        }
    });
}

void fix_boundary(Problem& problem, const std::vector<double>& x) {
    problem.motions.assign(problem.motions.size(), motion_of(NodeKind::fixed));
    BoundaryTarget fixed = make_target(problem.mesh(), x, problem.motions);
    fixed.written = std::move(problem.target.written);
    fixed.written_kind = std::move(problem.target.written_kind);
    problem.target = std::move(fixed);
    take_along_target(problem, problem.mesh().x, x);
    problem.sliding = nullptr;
}

double surface_distance(const Problem& problem, const std::vector<double>& x) {
    const std::vector<double> distances = distances_from_surface(problem, x);
    return distances.empty() ? 0 : *std::max_element(distances.begin(), distances.end());
}

void print_surface(std::FILE* out, const ProblemOptions& options, const Problem& problem,
                   const std::vector<double>& x, double distance, const std::string& more) {
    const std::vector<char> kept = kept_boundaries(problem);
    if (const auto count = std::count(kept.begin(), kept.end(), 1); count > 0)
        print(out, "distance of the boundary ", count < std::ssize(kept) ? "that stays " : "",
              "from that of the file: ",
              to_text(distance, 2), " of an edge, ", distance > options.surface_tolerance ? "NOT " : "",
              "within surface_tolerance = ", to_text(options.surface_tolerance, 6), "; ");
    print(out, volume_changes(problem.mesh(), x), more.empty() ? "" : "; ", more,
          "\n");
}

}  // namespace almesh
