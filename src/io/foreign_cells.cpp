#include "io/foreign_cells.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <set>
#include <utility>

#include "base/error.hpp"
#include "base/text.hpp"
#include "mesh/lagrange.hpp"

namespace almesh {
namespace {

// VTK's edges and faces, each face from the vertex at which its nodes begin (vtkLagrangeTetra,
// vtkHigherOrderQuadrilateral, vtkHigherOrderHexahedron, vtkHigherOrderWedge, vtkQuadraticPyramid). Its lines and
// triangles have Gmsh's order.
constexpr std::array<CellEdge, 6> tetrahedron_edges = {{{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}}};
constexpr std::array<CellFace, 4> tetrahedron_faces = {
    {{0, 1, 3, -1}, {2, 3, 1, -1}, {0, 3, 2, -1}, {0, 2, 1, -1}}};
constexpr std::array<CellEdge, 12> hexahedron_edges = {
    {{0, 1}, {1, 2}, {3, 2}, {0, 3}, {4, 5}, {5, 6}, {7, 6}, {4, 7}, {0, 4}, {1, 5}, {2, 6}, {3, 7}}};
constexpr std::array<CellFace, 6> hexahedron_faces = {
    {{0, 3, 7, 4}, {1, 2, 6, 5}, {0, 1, 5, 4}, {3, 2, 6, 7}, {0, 1, 2, 3}, {4, 5, 6, 7}}};
constexpr std::array<CellEdge, 9> prism_edges = {
    {{0, 1}, {1, 2}, {2, 0}, {3, 4}, {4, 5}, {5, 3}, {0, 3}, {1, 4}, {2, 5}}};
constexpr std::array<CellFace, 5> prism_faces = {
    {{0, 1, 2, -1}, {3, 4, 5, -1}, {0, 1, 4, 3}, {1, 2, 5, 4}, {2, 0, 3, 5}}};
constexpr std::array<CellEdge, 8> pyramid_edges = {{{0, 1}, {1, 2}, {2, 3}, {3, 0}, {0, 4}, {1, 4}, {2, 4}, {3, 4}}};

struct VtkCell {
    std::vector<CellEdge> edges;
    std::span<const CellFace> faces;
};

VtkCell vtk_cell(const CellType& cell, bool is_lagrange) {
    if (&cell == &prism()) return {{prism_edges.begin(), prism_edges.end()}, prism_faces};
    if (cell.is_collapsed) return {{pyramid_edges.begin(), pyramid_edges.end()}, {}};
    VtkCell vtk = {{hexahedron_edges.begin(), hexahedron_edges.end()}, hexahedron_faces};
    if (&cell == &quadrilateral()) vtk = {{vtk.edges.begin(), vtk.edges.begin() + 4}, {}};
    else if (is_lagrange) std::swap(vtk.edges[10], vtk.edges[11]);  // those of VTK 8, in files before version 5
    return vtk;
}

std::vector<int> lexicographic_order(const CellType& cell, int degree) {
    const LagrangeBasis gmsh(cell, degree);
    std::vector<int> order(gmsh.count);
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(), [&](int i, int j) {
        const std::array<double, 3> a = gmsh.point(i), b = gmsh.point(j);
        return std::lexicographical_compare(a.rbegin(), a.rend(), b.rbegin(), b.rend());
    });
    return order;
}

// Gives cells of degree 2 the nodes that they lack: those in the middle of quadrilaterals, and of hexahedra.
class Completion {
public:
    explicit Completion(RawMesh& mesh) : mesh_(mesh) {
        for (const RawNode& node : mesh.nodes) last_id_ = std::max(last_id_, node.id);
    }

    void complete(const RawElement& element) {
        const CellType& cell = element.cell();
        constexpr std::array<CellFace, 1> itself = {{{0, 1, 2, 3}}};
        const bool is_plane = &cell == &quadrilateral();
        int* node = &mesh_.element_nodes[element.first];
        int* next = node + cell.vertices + cell.edges.size();
        for (const CellFace& face : is_plane ? std::span<const CellFace>(itself) : cell.interior_faces)
            if (face[3] >= 0) middle_of_face(element, node, face, *next++);
        if (&cell == &hexahedron()) place(element, cell, {node, 8}, {node + 8, 12}, *next);
    }

private:
    RawMesh& mesh_;
    long long last_id_ = 0;
    std::map<std::array<int, 4>, int> middle_{};  // of quadrilaterals by their vertices, ascending

    void middle_of_face(const RawElement& element, const int* node, const CellFace& face, int& middle) {
        const CellType& cell = element.cell();
        std::array<int, 4> vertices, edges;
        for (int k = 0; k < 4; ++k) {
            vertices[k] = node[face[k]];
            const auto edge = std::find_if(cell.edges.begin(), cell.edges.end(), [&](const CellEdge& e) {
                return std::minmax(e[0], e[1]) == std::minmax(face[k], face[(k + 1) % 4]);
            });
            edges[k] = node[cell.vertices + (edge - cell.edges.begin())];
        }
        std::array<int, 4> key = vertices;
        std::sort(key.begin(), key.end());
        if (const auto known = middle_.find(key); known != middle_.end() && middle < 0) middle = known->second;
        place(element, quadrilateral(), vertices, edges, middle);
        middle_.emplace(key, middle);
    }

    // At the centre of the serendipity map: on a quadrilateral half the nodes of the edges less a quarter of the
    // vertices, in a hexahedron a quarter of each.
    void place(const RawElement& element, const CellType& cell, std::span<const int> vertices,
               std::span<const int> edges, int& middle) {
        if (middle >= 0) return;
        middle = static_cast<int>(mesh_.nodes.size());
        RawNode centre{++last_id_, {}, element.line};
        ImpliedNode implied{middle, {}};
        for (const int i : edges) implied.terms.emplace_back(i, cell.dim == 2 ? 0.5 : 0.25);
        for (const int i : vertices) implied.terms.emplace_back(i, -0.25);
        for (const auto& [i, weight] : implied.terms)
            for (int a = 0; a < 3; ++a) centre.x[a] += weight * mesh_.nodes[i].x[a];
        mesh_.implied.push_back(std::move(implied));
        mesh_.nodes.push_back(centre);
    }
};

// The node that is at two vertices of a cell that is no simplex, or -1.
int repeated_vertex(const RawMesh& mesh, const RawElement& element) {
    const int* const node = &mesh.element_nodes[element.first];
    for (int v = 1; v < element.cell().vertices && !element.cell().is_simplex(); ++v)
        if (std::find(node, node + v, node[v]) != node + v) return node[v];
    return -1;
}

// The faces of a cell with these nodes at its vertices, seen from outside, a node once in each; a cell in the plane is
// its only face.
std::vector<std::vector<int>> distinct_faces(const CellType& cell, const int* node) {
    std::vector<std::vector<int>> faces;
    const auto add = [&](const CellFace& face) {
        std::vector<int>& nodes = faces.emplace_back();
        for (const int v : face)
            if (v >= 0 && std::find(nodes.begin(), nodes.end(), node[v]) == nodes.end()) nodes.push_back(node[v]);
    };
    if (cell.dim == 2) add({0, 1, 2, 3});
    else std::for_each(cell.faces.begin(), cell.faces.end(), add);
    std::erase_if(faces, [](const auto& face) { return face.size() < 3; });
    std::stable_sort(faces.begin(), faces.end(), [](const auto& f, const auto& g) { return f.size() < g.size(); });
    return faces;
}

// Makes the linear cell the triangle, tetrahedron, pyramid or prism that its faces are; false where they are none.
bool simplify(RawElement& element, int* node) {
    const std::vector<std::vector<int>> faces = distinct_faces(element.cell(), node);
    const std::set<int> vertices(node, node + element.cell().vertices);
    const auto triangles = std::count_if(faces.begin(), faces.end(), [](const auto& f) { return f.size() == 3; });
    const auto becomes = [&](const CellType& type, const std::vector<int>& nodes) {
        element.type = &type;
        std::copy(nodes.begin(), nodes.end(), node);
        return true;
    };
    const auto outside = [&](const std::vector<int>& face) {  // the first vertex that is not on it
        return *std::find_if(vertices.begin(), vertices.end(),
                             [&](int v) { return std::find(face.begin(), face.end(), v) == face.end(); });
    };
    if (element.degree > 1 || triangles == 0) return false;
    const std::vector<int>&first = faces.front(), &last = faces.back();
    const std::array<std::size_t, 3> kind = {vertices.size(), static_cast<std::size_t>(triangles), faces.size()};
    if (kind == std::array<std::size_t, 3>{3, 1, 1}) return becomes(simplex(2), first);
    if (kind == std::array<std::size_t, 3>{4, 4, 4})
        return becomes(simplex(3), {first[0], first[2], first[1], outside(first)});
    if (kind == std::array<std::size_t, 3>{5, 4, 5})
        return becomes(pyramid(), {last[0], last[3], last[2], last[1], outside(last)});
    if (kind != std::array<std::size_t, 3>{6, 2, 5}) return false;
    std::vector<int> nodes = {first[0], first[2], first[1]};
    for (int k = 0; k < 3; ++k)  // on a quadrilateral beside it, and not on the triangle
        for (const std::vector<int>& face : {faces[2], faces[3], faces[4]}) {
            const auto at = std::find(face.begin(), face.end(), nodes[k]) - face.begin();
            for (const auto next : {(at + 1) % 4, (at + 3) % 4})
                if (at < 4 && static_cast<int>(nodes.size()) == 3 + k &&
                    std::find(first.begin(), first.end(), face[next]) == first.end())
                    nodes.push_back(face[next]);
        }
    return becomes(prism(), nodes);
}

}  // namespace

std::vector<int> vtk_node_order(const CellType& cell, int degree, bool is_lagrange) {
    const LagrangeBasis gmsh(cell, degree);
    std::vector<int> order;
    if (cell.is_simplex()) {
        for (const MultiIndex& a :
             cell.dim == 3 ? lattice_nodes(cell, degree, tetrahedron_edges, tetrahedron_faces) : gmsh.nodes)
            order.push_back(gmsh.find(a));
        return order;
    }
    // The faces of VTK's prisms but Lagrange ones are oriented outward where vertices 1 and 2 change places.
    constexpr std::array<int, 8> same = {0, 1, 2, 3, 4, 5, 6, 7}, mirrored = {0, 2, 1, 3, 5, 4};
    const std::array<int, 8>& vertex = &cell == &prism() && !is_lagrange ? mirrored : same;
    const auto append = [&](int a, int b, int c, int u, int v) {  // a + (u (b - a) + v (c - a)) / degree
        MultiIndex index{};
        for (std::size_t k = 0; k < index.size(); ++k)
            index[k] = (degree - u - v) * cell.corners[vertex[a]][k] + u * cell.corners[vertex[b]][k] +
                       v * cell.corners[vertex[c]][k];
        order.push_back(gmsh.find(index));
    };
    const VtkCell vtk = vtk_cell(cell, is_lagrange);
    for (int v = 0; v < cell.vertices; ++v) append(v, v, v, 0, 0);
    for (const auto& [from, to] : vtk.edges)
        for (int u = 1; u < degree; ++u) append(from, to, to, u, 0);
    for (const CellFace& face : vtk.faces)  // row by row
        for (int v = 1; v < degree; ++v)
            for (int u = 1; u < (face[3] < 0 ? degree - v : degree); ++u)
                append(face[0], face[1], face[face[3] < 0 ? 2 : 3], u, v);
    std::vector<bool> is_there(gmsh.count);
    for (const int i : order) is_there[i] = true;
    const std::vector<int> all = lexicographic_order(cell, degree);
    std::copy_if(all.begin(), all.end(), std::back_inserter(order), [&](int i) { return !is_there[i]; });
    return order;
}

std::vector<int> su2_node_order(const CellType& cell, int degree) {
    return degree == 1 ? vtk_node_order(cell, 1) : lexicographic_order(cell, degree);
}

std::string readable_cells(int lowest, int highest) {
    std::vector<std::string> names;
    for (int dim = lowest; dim <= highest; ++dim)
        for (const CellType& cell : cell_types())
            if (cell.dim == dim) names.push_back(cell.plural);
    std::string text;
    for (std::size_t k = 0; k < names.size(); ++k)
        text += (k == 0 ? "" : k + 1 == names.size() ? " and " : ", ") + names[k];
    return text;
}

std::span<const SerendipityCell> serendipity_cells() {
    static const SerendipityCell cells[] = {
        {&quadrilateral(), 16, 23}, {&hexahedron(), 17, 25}, {&prism(), 18, 26}, {&pyramid(), 19, 27}};
    return cells;
}

void complete_serendipity(RawMesh& mesh) {
    const auto is_complete = [&](const RawElement& element) {
        return mesh.element_nodes[element.first + element.node_count() - 1] >= 0;
    };
    if (std::all_of(mesh.elements.begin(), mesh.elements.end(), is_complete)) return;
    Completion completion(mesh);
    std::vector<const RawElement*> elements, incomplete;
    for (const RawElement& element : mesh.elements)
        if (element.degree == 2) (is_complete(element) ? elements : incomplete).push_back(&element);
    // Nodes of the file first; on a boundary those of its faces.
    std::stable_sort(incomplete.begin(), incomplete.end(),
                     [](const RawElement* a, const RawElement* b) { return a->dim < b->dim; });
    elements.insert(elements.end(), incomplete.begin(), incomplete.end());
    for (const RawElement* element : elements) completion.complete(*element);
    for (const SerendipityCell& kind : serendipity_cells())
        if (const auto count = std::count_if(incomplete.begin(), incomplete.end(), [&](const RawElement* element) {
                return element->type == kind.cell;
            }))
            mesh.notes.push_back(concat(count, " ", count == 1 ? kind.cell->name : kind.cell->plural, " of ",
                                        kind.nodes(), " nodes: completed to ", kind.cell->node_count(2),
                                        " each, by nodes in the middle of faces and cells"));
}

void simplify_cells(RawMesh& mesh) {
    std::size_t simplified = 0;
    const RawElement* left = nullptr;
    std::string first;
    for (RawElement& element : mesh.elements) {
        if (repeated_vertex(mesh, element) < 0) continue;
        if (simplified == 0) first = concat(element.cell().name, " ", element.id);
        if (simplify(element, &mesh.element_nodes[element.first])) ++simplified;
        else if (!left) left = &element;
    }
    if (left)
        throw InputError(mesh.path, left->line ? concat(":", left->line) : "", ": ", left->cell().name, " ", left->id,
                         " has node ", mesh.nodes[repeated_vertex(mesh, *left)].id,
                         " at two of its vertices, and is no ",
                         left->dim == 2 ? "triangle" : "linear prism, pyramid or tetrahedron",
                         ": write it as what it is");
    if (simplified > 0)
        mesh.notes.push_back(concat(counted(simplified, "cell"), " with a node at two vertices read as the one with "
                                    "fewer vertices that it is, the first is ", first));
}

MshType msh_type(int number) {
    for (const CellType& cell : cell_types())
        for (int degree = 1; degree <= max_degree; ++degree)
            if (cell.msh_types[degree - 1] == number) return {number, &cell, degree, cell.node_count(degree)};
    for (const SerendipityCell& kind : serendipity_cells())
        if (kind.msh_type == number) return {number, kind.cell, 2, kind.nodes()};
    return {number};
}

void ForeignMshElements::add(int type, int line, long long count) {
    const auto same = std::find_if(kinds.begin(), kinds.end(), [type](const Kind& kind) { return kind.type == type; });
    if (same == kinds.end()) kinds.push_back({type, line, count});
    else same->count += count;
}

std::string ForeignMshElements::message() const {
    std::string what;
    for (const Kind& kind : kinds)
        what += concat(what.empty() ? "" : "; ", counted(kind.count, "element"), " of type ", kind.type,
                       kind.line ? concat(", the first in line ", kind.line) : "");
    return what + ": only " + readable_cells() + " of degree 1 to 7 with all their nodes are read (mesh with "
                  "Mesh.SecondOrderIncomplete = 0 and a Mesh.ElementOrder of at most 7)";
}

}  // namespace almesh
