// Builds a mesh in steps: select the elements of the highest dimension and the tagged faces, number their nodes in file
// order, make all elements positively oriented, match the boundary faces (build_boundary.cpp).
#include "mesh/build.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "base/text.hpp"
#include "mesh/build_boundary.hpp"
#include "mesh/lagrange.hpp"
#include "mesh/sides.hpp"

namespace almesh {
namespace {

// repeated: indices into raw.elements, ascending.
void select(MeshBuild& build, const std::vector<int>& repeated) {
    const RawMesh& raw = build.raw;
    int dim = 0, degree = 0;
    for (const RawElement& element : raw.elements)
        if (element.dim > dim) dim = element.dim, degree = element.degree;
    if (dim < 2) build.refuse("the mesh has no elements of dimension 2 or 3");
    const RawElement* first = nullptr;
    for (int i = 0; i < static_cast<int>(raw.elements.size()); ++i) {
        const RawElement& element = raw.elements[i];
        const bool is_face = element.dim == dim - 1 && (element.physical != 0 || element.degree == degree);
        const bool is_repeated = std::binary_search(repeated.begin(), repeated.end(), i);
        if (is_repeated || (element.dim != dim && !is_face)) {
            build.kept.push_back(i);
            continue;
        }
        if (!first) first = &element;
        if (element.degree != first->degree)
            build.refuse(element, "has degree ", element.degree, ", ", name_of(*first), " has degree ", first->degree,
                         ": all elements and boundary faces need the same one");
        (is_face ? build.faces : build.elements).push_back(i);
    }
    build.mesh.dim = dim;
    build.mesh.degree = first->degree;
    const auto type = [&](int i) { return &raw.elements[i].cell(); };
    std::stable_sort(build.elements.begin(), build.elements.end(),  // those of one type in file order
                     [&](int i, int j) { return type(i) < type(j); });
    std::vector<const CellType*> types;
    for (const int i : build.elements) types.push_back(type(i));
    build.mesh.groups = groups_of(types, build.mesh.degree);
}

// Lengths from 1 / longest to it have volumes, and products of them, within the range of numbers.
constexpr double longest = 1e50;

// The nodes of the elements, in file order.
void number_nodes(MeshBuild& build) {
    const RawMesh& raw = build.raw;
    Mesh& mesh = build.mesh;
    const CoordinateFields& all = raw.coordinates;
    CoordinateFields& fields = mesh.file.coordinates = {all.form, all.order, mesh.dim, all.width, all.most, all.rewritten};
    build.node.assign(raw.nodes.size(), -1);
    for (int i : build.elements)
        for (int k = 0; k < raw.elements[i].node_count(); ++k)
            build.node[raw.element_nodes[raw.elements[i].first + k]] = 0;
    int next = 0;
    for (std::size_t i = 0; i < raw.nodes.size(); ++i) {
        const RawNode& node = raw.nodes[i];
        if (build.node[i] < 0) {
            ++mesh.file.loose;
            continue;
        }
        if (!std::all_of(node.x, node.x + 3, [](double x) { return std::isfinite(x); }))
            build.refuse("node ", node.id, " is at ", position_text(node.x, 3), ", which is no point");
        if (!std::all_of(node.x, node.x + 3, [](double x) { return std::abs(x) <= longest; }))
            build.refuse("node ", node.id, " is at ", position_text(node.x, 3), ", farther than ", longest,
                         ", where volumes are no numbers: take a larger unit of length");
        build.node[i] = next++;
        mesh.file.node_id.push_back(node.id);
        mesh.x.insert(mesh.x.end(), node.x, node.x + mesh.dim);
        for (int a = 0; a < mesh.dim && offset(i, all.dim) < all.first.size(); ++a)
            fields.first.push_back(all.first[offset(i, all.dim, a)]);
    }
    for (ImpliedNode implied : raw.implied) {
        if (build.node[implied.node] < 0) continue;
        implied.node = build.node[implied.node];
        for (auto& [node, weight] : implied.terms) node = build.node[node];
        mesh.file.implied.push_back(std::move(implied));
    }
}

// A 2D mesh has to lie in a plane z = constant, up to rounding.
void check_flat(MeshBuild& build) {
    const RawNode *low = nullptr, *high = nullptr;
    double size = 0;
    for (std::size_t i = 0; i < build.raw.nodes.size(); ++i) {
        if (build.node[i] < 0) continue;
        const RawNode& node = build.raw.nodes[i];
        if (!low || node.x[2] < low->x[2]) low = &node;
        if (!high || node.x[2] > high->x[2]) high = &node;
        for (double x : node.x) size = std::max(size, std::abs(x));
    }
    if (high->x[2] - low->x[2] > 1e-12 * size)
        build.refuse("the elements form a surface in space, z goes from ", low->x[2], " (node ", low->id, ") to ",
                     high->x[2], " (node ", high->id,
                     "): a 2D mesh lies in a plane z = constant; a 3D mesh has elements of dimension 3",
                     build.raw.format.ending == ".msh" ? " (Gmsh writes them only if their volume is in a physical "
                                                         "group, or if there are no groups)" : "");
    build.mesh.file.z = low->x[2];
}

void fill_elements(MeshBuild& build) {
    Mesh& mesh = build.mesh;
    mesh.elements.reserve(build.elements.size() * build.element(0).node_count());
    for (int i : build.elements) {
        const RawElement& element = build.raw.elements[i];
        for (int k = 0; k < element.node_count(); ++k)
            mesh.elements.push_back(build.node[build.raw.element_nodes[element.first + k]]);
        mesh.file.element_id.push_back(element.id);
        mesh.file.element_physical.push_back(element.physical);
        mesh.file.element_entity.push_back(element.entity);
    }
}

// Orientation of the straight-sided element: 1, -1, or 0 where its volume is within the rounding of its coordinates.
template <int n>
int orientation(const MeshBuild& build, int e) {
    const Mesh& mesh = build.mesh;
    const int* const vertex = mesh.element(e);
    double size = 0, length = 0;
    for (int v = 0; v < mesh.cell(e).vertices; ++v)
        for (int a = 0; a < n; ++a) {
            const double x = mesh.x[offset(vertex[v], n, a)];
            size = std::max(size, std::abs(x));
            length = std::max(length, std::abs(x - mesh.x[offset(vertex[0], n, a)]));
        }
    if (length > 0 && length < 1 / longest)
        build.refuse(build.element(e), "is ", length, " long, too little for a volume: take a smaller unit of length");
    const double volume = almesh::volume(mesh, mesh.x, e) * mesh.cell(e).inverse_volume;
    const double rounding = 8 * std::numeric_limits<double>::epsilon() * (size + length) * std::pow(length, n - 1);
    if (!(std::abs(volume) > rounding)) return 0;
    return volume > 0 ? 1 : -1;
}

// Turns the given elements over, with all their nodes: by the last two vertices of their triangles or tetrahedra, or
// two lines as their factors, exchanged.
void reverse(Mesh& mesh, const std::vector<int>& elements) {
    for (const ElementGroup& group : mesh.element_groups()) {
        const LagrangeBasis basis(*group.cell, mesh.degree);
        MultiIndex swap = {0, 1, 2, 3, 4, 5};
        const int first = group.cell->factors[0];
        if (first > 1) std::swap(swap[first - 1], swap[first]);
        else swap = {2, 3, 0, 1, 4, 5};
        std::vector<int> from(basis.count), before(basis.count);
        for (int i = 0; i < basis.count; ++i) from[i] = basis.permuted_node(i, swap);
        for (const int e : elements) {
            if (e < group.first || e >= group.first + group.count) continue;
            int* const node = mesh.elements.data() + (mesh.element(e) - mesh.elements.data());
            std::copy_n(node, basis.count, before.begin());
            for (int i = 0; i < basis.count; ++i) node[i] = before[from[i]];
        }
    }
}

// Of some elements the one that comes first in the file.
int first_in_file(const MeshBuild& build, const std::vector<int>& elements) {
    return *std::min_element(elements.begin(), elements.end(),
                             [&](int e, int f) { return build.elements[e] < build.elements[f]; });
}

// Elements whose straight-sided form is negatively oriented. Refuses those without volume; with Folds::keep
// only those that have a vertex twice.
std::vector<int> negative_elements(const MeshBuild& build, Folds folds) {
    const Mesh& mesh = build.mesh;
    std::vector<int> flat, negative;
    with_dimension(mesh.dim, [&](auto n) {
        for (int e = 0; e < mesh.element_count(); ++e) {
            const int sign = orientation<n>(build, e);
            if (sign == 0) flat.push_back(e);
            if (sign < 0) negative.push_back(e);
        }
    });
    const auto has_vertex_twice = [&mesh](int e) {
        const int* const vertex = mesh.element(e);
        const int count = mesh.cell(e).vertices;
        return std::set<int>(vertex, vertex + count).size() < static_cast<std::size_t>(count);
    };
    if (folds == Folds::keep) std::erase_if(flat, [&](int e) { return !has_vertex_twice(e); });
    if (flat.empty()) return negative;
    const int first = first_in_file(build, flat);
    build.refuse(build.element(first), "with the vertices ",
                 build.node_ids(mesh.element(first), mesh.cell(first).vertices), " has no volume, the first of ",
                 counted(flat.size(), "such element"),
                 folds == Folds::refuse ? "; `almesh improve` gives them one, or lists those whose boundary does not" : "");
}

// The elements to turn by their neighbours. Single elements of a group (below 1 %) stay: they are inverted for whoever
// reads the file.
std::vector<int> turned_by_neighbours(const Mesh& mesh) {
    std::vector<Side> sides;
    for_sides(mesh, [&](int e, int k, int number) { sides.push_back(side_of_element(mesh, e, k, number)); });
    bool all_positive = true;
    const std::vector<char> is_turned =
        turned_by_neighbours(mesh.element_count(), sides, mesh.most_sides(), [&](int e) {
            const double v = volume(mesh, mesh.x, e);
            all_positive = all_positive && v > 0;
            return v;
        });
    std::vector<int> turned;
    if (all_positive) return turned;  // folded, not tangled
    std::map<int, int> of_group, turned_of_group;
    for (int e = 0; e < mesh.element_count(); ++e) {
        ++of_group[mesh.file.element_physical[e]];
        if (!is_turned[e]) continue;
        turned.push_back(e);
        ++turned_of_group[mesh.file.element_physical[e]];
    }
    std::erase_if(turned, [&](int e) {
        const int group = mesh.file.element_physical[e];
        return 100 * turned_of_group[group] < of_group[group];
    });
    return turned;
}

enum class Orientation {
    of_vertices,   // every element so that its straight-sided form has a positive volume
    of_neighbours  // so that neighbours agree
};

// The mesh, or where elements are folded and oriented by their vertices, no more than its elements and their folds.
// repeated: elements of the file that have the vertices of earlier ones, as far as they are known.
Mesh oriented_mesh(const RawMesh& raw, std::vector<std::string>& notes, Folds folds, Orientation orientation,
                   const std::vector<int>& repeated = {}) {
    const std::size_t told = notes.size();
    MeshBuild build{raw, notes, {}, {}, {}, {}, {}};
    Mesh& mesh = build.mesh;
    mesh.file.groups = raw.groups;
    mesh.file.format = raw.format;
    mesh.file.zones = raw.zones;
    mesh.file.entities = raw.entities;
    mesh.file.sections = raw.sections;
    mesh.file.periodic = raw.periodic;
    select(build, repeated);
    number_nodes(build);
    if (mesh.dim == 2) check_flat(build);
    fill_elements(build);
    std::vector<int> turned = negative_elements(build, folds);
    if (orientation == Orientation::of_neighbours) turned = turned_by_neighbours(mesh);
    reverse(mesh, turned);
    mesh.file.turned = turned;
    mesh.file.has_elements = raw.notes.empty() && repeated.empty();
    mesh.folded = fill_boundary(build);
    if (!build.repeated.empty()) {
        notes.resize(told);
        return oriented_mesh(raw, notes, folds, orientation, build.repeated);
    }
    if (!repeated.empty())
        notes.push_back(concat(counted(repeated.size(), "element"), " given more than once, the first is ",
                               name_of(raw.elements[repeated[0]])));
    if (!mesh.folded.empty() && folds == Folds::refuse)
        build.refuse(build.element(mesh.folded[0][1]), "lies on the same side of their common face as ",
                     name_of(build.element(mesh.folded[0][0])), ", the first of ",
                     counted(mesh.folded.size(), "such pair"),
                     mesh.degree == 1
                         ? ": the mesh folds over itself; `almesh quality` tells where, `almesh improve` mends it"
                         : " without their curves: the straight form of the mesh folds over itself");
    if (!mesh.folded.empty() && orientation == Orientation::of_vertices) return std::move(build.mesh);
    if (!turned.empty())
        notes.push_back(concat(counted(turned.size(), "element"),
                               " with negative orientation turned, the first is element ",
                               mesh.file.element_id[first_in_file(build, turned)]));
    fill_kept(build);
    return std::move(build.mesh);
}

}  // namespace

// Elements that are folded by their vertices may be curved so that they are not: their neighbours tell then.
Mesh build_mesh(const RawMesh& raw, std::vector<std::string>& notes, Folds folds) {
    notes.insert(notes.end(), raw.notes.begin(), raw.notes.end());
    const std::size_t told = notes.size();
    Mesh mesh = oriented_mesh(raw, notes, folds, Orientation::of_vertices);
    if (mesh.folded.empty()) return mesh;
    notes.resize(told);
    return oriented_mesh(raw, notes, folds, Orientation::of_neighbours);
}

}  // namespace almesh
