#include "problem/node_targets.hpp"

#include <algorithm>
#include <map>
#include <numeric>
#include <set>

#include "base/error.hpp"
#include "base/files.hpp"
#include "base/index.hpp"
#include "base/text.hpp"
#include "io/mesh_format.hpp"
#include "io/text_scanner.hpp"
#include "problem/base_mesh.hpp"
#include "mesh/inner_boundary.hpp"
#include "mesh/lagrange.hpp"
#include "mesh/sides.hpp"
#include "mesh/surface_mesh.hpp"

namespace almesh {
namespace {

// Calls visit(nodes, basis) for the faces of the boundary, which may be outer and inner ones, and for the elements of
// the volume that it stands for.
template <class Visit>
void for_cells(const Mesh& mesh, int boundary, const Visit& visit) {
    const std::vector<LagrangeBasis> of_face = bases_of(mesh.face_groups(), mesh.degree),
                                     of_element = bases_of(mesh.element_groups(), mesh.degree);
    for (int f = 0; f < mesh.face_count(); ++f)
        if (mesh.boundaries[mesh.face_boundary[f]] == mesh.boundaries[boundary])
            visit(mesh.face(f), of_face[mesh.face_group_number(f)]);
    for (const GroupCells& volume : volume_groups(mesh))
        if (volume_group(volume.name) == mesh.boundaries[boundary])
            for (const int e : volume.cells) visit(mesh.element(e), of_element[mesh.group_number(e)]);
}

std::unordered_map<long long, int> nodes_by_id(const Mesh& mesh, int boundary) {
    std::unordered_map<long long, int> nodes;
    for_cells(mesh, boundary, [&](const int* node, const LagrangeBasis& basis) {
        for (int i = 0; i < basis.count; ++i) nodes[mesh.file.node_id[node[i]]] = node[i];
    });
    return nodes;
}

void refuse_missing(const Mesh& mesh, int boundary, const std::string& path, const std::vector<char>& known,
                    const std::unordered_map<long long, int>& nodes, const std::string& advice = "") {
    std::vector<long long> missing;
    for (const auto& [id, node] : nodes)
        if (!known[node]) missing.push_back(id);
    if (missing.empty()) return;
    std::sort(missing.begin(), missing.end());
    throw InputError(path, ": ", counted(missing.size(), "node"), " of boundary ", mesh.boundaries[boundary],
                     " missing, the first with id ", missing.front(), advice);
}

// Commas separate like blanks; `#` starts a comment; a first line of words is a heading.
std::string without_commas(std::string text) {
    bool comment = false;
    for (char& c : text) {
        comment = c == '#' || (comment && c != '\n');
        if (c == ',' || c == ';' || comment) c = ' ';
    }
    return text;
}

// Nodes between vertices, on edges and in faces of a curved mesh, that the file leaves out: they move by the mean of
// the vertices' displacements, by their barycentric coordinates, and are known then. all: or else only between vertices
// that the file has.
void follow_vertices(const Mesh& mesh, int boundary, bool all, std::vector<char>& known,
                     std::vector<double>& positions) {
    for_cells(mesh, boundary, [&](const int* node, const LagrangeBasis& basis) {
        for (int i = basis.cell.vertices; i < basis.count; ++i) {
            double* const x = point(positions, node[i], mesh.dim);
            const std::vector<double> weight = basis.vertex_weights(i);
            bool follows = !known[node[i]];
            for (int v = 0; v < basis.cell.vertices; ++v)
                follows = follows && (all || known[node[v]] || weight[v] == 0);
            for (int v = 0; v < basis.cell.vertices && follows; ++v)
                for (int a = 0; a < mesh.dim; ++a) {
                    const std::size_t at = offset(node[v], mesh.dim, a);
                    x[a] += weight[v] * (positions[at] - mesh.x[at]) / mesh.degree;
                }
            if (follows) known[node[i]] = 1;
        }
    });
}

// positions, left_out: of the nodes of the mesh, x dim; left_out is set to 1 at those that slide or are free.
void read_places(const Mesh& mesh, int boundary, const Motion& motion, std::vector<double>& positions,
                 std::vector<double>& left_out) {
    const MotionStep& step = *file_step(motion);
    const auto nodes = nodes_by_id(mesh, boundary);
    std::vector<char> known;
    const bool leaves_out = step.rest || goes_onto(motion);
    std::unordered_map<long long, int> of_file = nodes;  // with `else` one of several boundaries may serve each of them
    for (int i = 0; i < mesh.nodes() && leaves_out; ++i) of_file.try_emplace(mesh.file.node_id[i], i);
    read_node_rows(mesh, step.file, of_file,
                   leaves_out ? "in the mesh" : "on boundary " + mesh.boundaries[boundary], positions, known);
    for (std::size_t k = 0; k < positions.size() && step.displacement; ++k)
        if (known[k / mesh.dim]) positions[k] += mesh.x[k];
    if (!leaves_out)
        refuse_missing(mesh, boundary, step.file, known, nodes,
                       "; to move only those that it has: `file NAME else fixed`, `else slide` or `else free`");
    const bool is_fixed = kind_of_rest(motion) == kind_of(motion);
    follow_vertices(mesh, boundary, is_fixed, known, positions);
    for (const auto& [id, node] : nodes)
        for (int a = 0; a < mesh.dim && !known[node] && !is_fixed; ++a) left_out[offset(node, mesh.dim, a)] = 1;
}

void read_places_of_mesh(const Mesh& mesh, int boundary, const RawMesh& other, std::vector<double>& positions) {
    const auto nodes = nodes_by_id(mesh, boundary);
    std::vector<char> known(mesh.nodes(), 0);
    for (const RawNode& node : other.nodes) {
        const auto found = nodes.find(node.id);
        if (found == nodes.end()) continue;
        known[found->second] = 1;
        std::copy_n(node.x, mesh.dim, point(positions, found->second, mesh.dim));
    }
    refuse_missing(mesh, boundary, other.path, known, nodes);
}

using VertexIds = std::vector<long long>;

// A face by the ids of its vertices, in any order around it: ascending, of a quadrilateral then that across the first.
VertexIds face_key(const VertexIds& around) {
    VertexIds key = around;
    std::sort(key.begin(), key.end());
    const auto first = std::find(around.begin(), around.end(), key[0]) - around.begin();
    if (around.size() == 4) key.push_back(around[(first + 2) % 4]);
    return key;
}

// The faces of another mesh all of whose vertices are among those of a boundary: their keys -> nodes in Gmsh's order.
std::map<VertexIds, std::vector<int>> faces_of(const RawMesh& other, int dim, int degree,
                                               const std::unordered_map<long long, int>& of_boundary) {
    std::map<VertexIds, std::vector<int>> faces;
    const auto add = [&](const CellType& cell, const int* node, const std::vector<int>& local) {
        VertexIds ids;
        for (int k = 0; k < cell.vertices; ++k) ids.push_back(other.nodes[node[local[k]]].id);
        if (!std::all_of(ids.begin(), ids.end(), [&](long long id) { return of_boundary.contains(id); })) return;
        std::vector<int>& nodes = faces[face_key(ids)];
        nodes.clear();
        for (const int k : local) nodes.push_back(node[k]);
    };
    const SideNodes side_nodes(dim, degree);
    for (const RawElement& element : other.elements) {
        if (element.degree != degree) continue;
        const int* const node = &other.element_nodes[element.first];
        std::vector<int> all(element.node_count());
        std::iota(all.begin(), all.end(), 0);
        if (element.dim == dim - 1) add(element.cell(), node, all);
        for (int k = 0; k < static_cast<int>(element.cell().faces.size()) && element.dim == dim; ++k)
            add(element.cell().face_type(k), node, side_nodes.of(element.cell(), k));
    }
    return faces;
}

// The positions of the nodes of a face in the other mesh's face with the same vertices: its polynomial there.
void place_face(const Mesh& mesh, int f, const LagrangeBasis& own, const RawMesh& other,
                const std::vector<int>& other_face, const LagrangeBasis& of_other, std::vector<double>& positions) {
    std::array<int, 4> vertex{};  // of the other face, by the vertices of this one
    for (int k = 0; k < own.cell.vertices; ++k)
        while (other.nodes[other_face[vertex[k]]].id != mesh.file.node_id[mesh.face(f)[k]]) ++vertex[k];
    std::vector<double> N(of_other.count);
    for (int i = 0; i < own.count; ++i) {
        const std::vector<double> weight = own.vertex_weights(i);
        std::array<double, 3> xi{};
        for (int k = 0; k < own.cell.vertices; ++k)
            for (int a = 0; a < own.dim; ++a) xi[a] += weight[k] / own.degree * of_other.point(vertex[k])[a];
        of_other.values(xi.data(), N.data());
        if (own.degree == of_other.degree) {  // one of its nodes, to the last bit
            std::fill(N.begin(), N.end(), 0.0);
            N[of_other.find(of_other.mean(vertex_weights(own.cell, own.nodes[i]), vertex.data()))] = 1;
        }
        double* const x = point(positions, mesh.face(f)[i], mesh.dim);
        std::fill_n(x, mesh.dim, 0.0);
        for (int j = 0; j < of_other.count; ++j)
            for (int a = 0; a < mesh.dim; ++a) x[a] += N[j] * other.nodes[other_face[j]].x[a];
    }
}

void read_faces_of_mesh(const Mesh& mesh, int boundary, const RawMesh& other, std::vector<double>& positions) {
    const int degree = degree_of(other);
    const std::vector<LagrangeBasis> own = bases_of(mesh.face_groups(), mesh.degree);
    std::vector<LagrangeBasis> of_other;
    for (const LagrangeBasis& basis : own) of_other.emplace_back(basis.cell, degree);
    const auto faces = faces_of(other, mesh.dim, degree, nodes_by_id(mesh, boundary));
    std::size_t missing = 0;
    std::string first;
    for (int f = 0; f < mesh.face_count(); ++f) {
        if (mesh.face_boundary[f] != boundary) continue;
        VertexIds ids;
        for (const int node : mesh.face_vertices(f)) ids.push_back(mesh.file.node_id[node]);
        if (const auto found = faces.find(face_key(ids)); found != faces.end())
            place_face(mesh, f, own[mesh.face_group_number(f)], other, found->second,
                       of_other[mesh.face_group_number(f)], positions);
        else if (missing++ == 0)
            for (const long long id : std::set<long long>(ids.begin(), ids.end()))
                first += (first.empty() ? "" : ", ") + std::to_string(id);
    }
    if (missing)
        throw InputError(other.path, ": ", counted(missing, "face"), " of boundary ", mesh.boundaries[boundary],
                         " missing, the first with the vertices ", first);
}

std::shared_ptr<const Mesh> read(const std::string& path, int dim, std::vector<std::string>& notes) {
    std::vector<std::string> of_file;
    const RawMesh raw = read_surface(path);
    const auto mesh = std::make_shared<const Mesh>(
        dim_of(raw) == dim - 1 || raw.elements.empty()
            ? surface_mesh(raw, dim, of_file)
            : build_base_mesh(raw, IdealKind::automatic, of_file).mesh);
    if (mesh->dim != dim)
        throw InputError(path, ": a mesh in ", mesh->dim, " dimensions, the one that moves has ", dim);
    for (const std::string& note : of_file) notes.push_back(path + ": " + note);
    return mesh;
}

std::vector<char> boundaries_of(const Mesh& other, const MotionStep& step, const std::string& own_name) {
    const bool is_alone = other.boundaries.size() == 1 || other.element_count() == 0;
    const std::string& name = step.boundary.empty() ? own_name : step.boundary;
    const std::vector<char> found = step.boundary.empty() && is_alone ? std::vector<char>(other.boundaries.size(), 1)
                                                                      : other.boundaries_in(name);
    if (std::count(found.begin(), found.end(), 1) > 0) return found;
    std::string list;
    for (const std::string& each : other.boundaries) list += (list.empty() ? "" : ", ") + with_quotes(each);
    throw InputError(step.file, ": no boundary ", with_quotes(name), " there, only ", list,
                     "; say which one: slide along FILE boundary NAME");
}

}  // namespace

void read_node_rows(const Mesh& mesh, const std::string& path, const std::unordered_map<long long, int>& nodes,
                    const std::string& place, std::vector<double>& value, std::vector<char>& known) {
    const std::string text = without_commas(read_text_file(path));
    TextScanner in(text, path);
    std::vector<int> line(mesh.nodes(), 0);
    known.assign(mesh.nodes(), 0);
    if (in.next_line() && std::isalpha(static_cast<unsigned char>(*in.at))) in.rest_of_line();
    while (in.next_line()) {
        const long long id = in.integer("a node id", std::numeric_limits<long long>::min(),
                                        std::numeric_limits<long long>::max());
        const auto found = nodes.find(id);
        if (found == nodes.end()) in.fail("node ", id, " is not ", place);
        const int node = found->second;
        for (int a = 0; a < mesh.dim; ++a) {
            const double here = in.real("a coordinate");
            double& v = value[offset(node, mesh.dim, a)];
            if (known[node] && here != v) in.fail("node ", id, " has other numbers in line ", line[node]);
            v = here;
        }
        if (!known[node]) line[node] = in.line;
        known[node] = 1;
        if (mesh.dim == 2 && in.at != in.end && *in.at != '\n') {
            const std::string rest(in.rest_of_line());
            if (!rest.empty() && parse_double(rest) != 0.0)
                in.fail("expected the end of the line, or a third coordinate of 0, got ", in_backquotes(rest));
        }
        in.end_of_line();
    }
}

NodeTargets read_node_targets(const Mesh& mesh, const std::vector<Motion>& motions) {
    NodeTargets targets;
    std::map<int, RawMesh> other;  // of boundaries
    int degree = mesh.degree;
    for (int b = 0; b < static_cast<int>(motions.size()); ++b) {
        const MotionStep* const step = file_step(motions[b]);
        if (!step) continue;
        targets.placed.resize(motions.size());
        if (is_of_mesh(*step)) degree = std::max(degree, degree_of(other[b] = read_mesh(step->file, mesh.file.format)));
    }
    if (degree > mesh.degree) targets.raised = raise_degree(mesh, degree);
    const Mesh& raised = targets.raised ? *targets.raised : mesh;
    for (int b = 0; b < static_cast<int>(targets.placed.size()); ++b) {
        const MotionStep* const step = file_step(motions[b]);
        if (!step) continue;
        if (other.contains(b) && degree > 1) {
            targets.placed[b].x = raised.x;
            read_faces_of_mesh(raised, b, other[b], targets.placed[b].x);
            continue;
        }
        Mesh moved = mesh, left_out = mesh;
        std::fill(left_out.x.begin(), left_out.x.end(), 0.0);
        if (step->places) std::copy(step->places->begin(), step->places->end(), moved.x.begin());  // split adds others
        else if (other.contains(b)) read_places_of_mesh(mesh, b, other[b], moved.x);
        else read_places(mesh, b, motions[b], moved.x, left_out.x);
        targets.placed[b].x = raise_degree(moved, degree).x;
        if (std::count(left_out.x.begin(), left_out.x.end(), 1.0))
            targets.placed[b].left_out = raise_degree(left_out, degree).x;
    }
    return targets;
}

std::vector<OtherSurface> read_other_surfaces(const ProblemSetup& setup, const Mesh& mesh,
                                              std::vector<std::string>& notes) {
    std::vector<OtherSurface> surfaces;
    std::map<std::string, std::shared_ptr<const Mesh>> of_path;
    for (int b = 0; b < static_cast<int>(mesh.boundaries.size()); ++b) {
        const std::string& name = mesh.boundaries[b];
        const BoundaryMotion* const line = motion_for(setup, name);
        const MotionStep* const step = line ? surface_step(line->motion) : nullptr;
        if (!step) continue;
        try {
            std::shared_ptr<const Mesh>& other = of_path[step->file];
            if (!other) other = read(step->file, mesh.dim, notes);
            surfaces.resize(mesh.boundaries.size());
            surfaces[b] = {other, boundaries_of(*other, *step, name)};
        } catch (const InputError& error) {
            throw InputError(line->where, ": boundary ", with_quotes(name), ": ", error.what());
        }
    }
    return surfaces;
}

}  // namespace almesh
