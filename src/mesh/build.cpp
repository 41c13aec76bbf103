#include "mesh/build.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/small_matrix.hpp"
#include "base/text.hpp"
#include "mesh/build_boundary.hpp"
#include "mesh/build_messages.hpp"
#include "mesh/lagrange.hpp"

namespace almesh {
namespace {

Selection select(const RawMesh& raw) {
    Selection chosen;
    for (const RawElement& element : raw.elements) chosen.dim = std::max(chosen.dim, element.dim);
    if (chosen.dim < 2) refuse(raw, "the mesh has no triangles or tetrahedra");
    const RawElement* first = nullptr;
    for (int i = 0; i < static_cast<int>(raw.elements.size()); ++i) {
        const RawElement& element = raw.elements[i];
        const bool is_face = element.dim == chosen.dim - 1 && element.physical != 0;
        if (element.dim != chosen.dim && !is_face) continue;
        if (!first) first = &element;
        if (element.degree != first->degree)
            refuse(raw, element,
                   "has degree " + std::to_string(element.degree) + ", " + name_of(*first) + " has degree " +
                       std::to_string(first->degree) + ": all elements and boundary faces need the same one");
        (is_face ? chosen.faces : chosen.elements).push_back(i);
    }
    chosen.degree = first->degree;
    return chosen;
}

// Fills x and node_id with the nodes of the elements, in file order. Returns the node index in the mesh of each raw
// node, -1 for those without element.
std::vector<int> number_nodes(const RawMesh& raw, const Selection& chosen, Mesh& mesh,
                              std::vector<std::string>& notes) {
    std::vector<int> index(raw.nodes.size(), -1);
    const int count = mesh.element_nodes();
    for (int i : chosen.elements)
        for (int k = 0; k < count; ++k) index[raw.element_nodes[raw.elements[i].first + k]] = 0;
    long long first_unused = 0;
    int next = 0;
    for (std::size_t i = 0; i < raw.nodes.size(); ++i) {
        const RawNode& node = raw.nodes[i];
        if (index[i] < 0) {
            if (!first_unused) first_unused = node.id;
            continue;
        }
        index[i] = next++;
        mesh.file.node_id.push_back(node.id);
        mesh.x.insert(mesh.x.end(), node.x, node.x + mesh.dim);
    }
    if (first_unused)
        notes.push_back(counted(raw.nodes.size() - mesh.file.node_id.size(), "node") +
                        " without an element dropped, the first with id " + std::to_string(first_unused));
    return index;
}

// A 2D mesh has to lie in a plane z = constant, up to rounding.
void check_flat(const RawMesh& raw, const std::vector<int>& index, std::vector<std::string>& notes) {
    const RawNode *low = nullptr, *high = nullptr;
    double size = 0;
    for (std::size_t i = 0; i < raw.nodes.size(); ++i) {
        if (index[i] < 0) continue;
        const RawNode& node = raw.nodes[i];
        if (!low || node.x[2] < low->x[2]) low = &node;
        if (!high || node.x[2] > high->x[2]) high = &node;
        for (double x : node.x) size = std::max(size, std::abs(x));
    }
    if (high->x[2] - low->x[2] > 1e-12 * size)
        refuse(raw, "the triangles form a surface in space, z goes from " + to_text(low->x[2]) + " (node " +
                        std::to_string(low->id) + ") to " + to_text(high->x[2]) + " (node " + std::to_string(high->id) +
                        "): a 2D mesh lies in a plane z = constant, a 3D mesh has tetrahedra");
    if (std::abs(low->x[2]) > 1e-12 * size)
        notes.push_back("the mesh lies in the plane z = " + to_text(low->x[2]) + ", results are written at z = 0");
}

// Orientation of the straight-sided element: 1, -1, or 0 where its volume is within the rounding of its coordinates.
template <int n>
int orientation(const Mesh& mesh, const int* node) {
    double size = 0, length = 0;
    Mat<n> edges;
    for (int v = 0; v <= n; ++v)
        for (int k = 0; k < n; ++k) {
            const double x = mesh.x[static_cast<std::size_t>(node[v]) * n + k];
            size = std::max(size, std::abs(x));
            if (v > 0) edges[v - 1][k] = x - mesh.x[static_cast<std::size_t>(node[0]) * n + k];
        }
    for (const Vec<n>& edge : edges)
        for (double d : edge) length = std::max(length, std::abs(d));
    const double volume = determinant(edges);
    const double rounding = 8 * std::numeric_limits<double>::epsilon() * (size + length) * std::pow(length, n - 1);
    if (!(std::abs(volume) > rounding)) return 0;
    return volume > 0 ? 1 : -1;
}

// Swaps the last two vertices of the given elements, with all nodes that belong to them.
void turn(Mesh& mesh, const std::vector<int>& turned) {
    const LagrangeBasis basis(mesh.dim, mesh.degree);
    MultiIndex swap = {0, 1, 2, 3};
    std::swap(swap[mesh.dim - 1], swap[mesh.dim]);
    std::vector<int> from(basis.count), before(basis.count);
    for (int i = 0; i < basis.count; ++i) from[i] = basis.permuted_node(i, swap);
    for (int e : turned) {
        int* const node = mesh.elements.data() + static_cast<std::size_t>(e) * basis.count;
        std::copy_n(node, basis.count, before.begin());
        for (int i = 0; i < basis.count; ++i) node[i] = before[from[i]];
    }
}

// Elements whose straight-sided form is negatively oriented. Refuses those without volume.
template <int n>
std::vector<int> negative_elements(const RawMesh& raw, const Selection& chosen, const Mesh& mesh) {
    std::vector<int> flat, negative;
    for (int e = 0; e < mesh.element_count(); ++e) {
        const int sign = orientation<n>(mesh, mesh.element(e));
        if (sign == 0) flat.push_back(e);
        if (sign < 0) negative.push_back(e);
    }
    if (!flat.empty())
        refuse(raw, raw.elements[chosen.elements[flat[0]]],
               "with the vertices " + node_ids(mesh, mesh.element(flat[0]), n + 1) + " has no volume, the first of " +
                   counted(flat.size(), "such element"));
    return negative;
}

void fill_elements(const RawMesh& raw, const Selection& chosen, const std::vector<int>& index, Mesh& mesh) {
    const int count = mesh.element_nodes();
    mesh.elements.reserve(chosen.elements.size() * count);
    for (int i : chosen.elements) {
        const RawElement& element = raw.elements[i];
        for (int k = 0; k < count; ++k) mesh.elements.push_back(index[raw.element_nodes[element.first + k]]);
        mesh.file.element_id.push_back(element.id);
        mesh.file.element_physical.push_back(element.physical);
        mesh.file.element_entity.push_back(element.entity);
    }
}

// The given elements, or all others, whichever are fewer.
std::vector<int> minority(const Mesh& mesh, const std::vector<int>& elements) {
    if (2 * static_cast<int>(elements.size()) <= mesh.element_count()) return elements;
    std::vector<int> others;
    for (int e = 0, k = 0; e < mesh.element_count(); ++e) {
        if (k < static_cast<int>(elements.size()) && elements[k] == e) ++k;
        else others.push_back(e);
    }
    return others;
}

// An element of a Mesh has one physical tag.
void note_shared_entities(const RawMesh& raw, int dim, std::vector<std::string>& notes) {
    for (const RawEntity& entity : raw.entities)
        if (entity.dim == dim && entity.physical.size() > 1)
            notes.push_back(dimension_name(dim) + " " + std::to_string(entity.tag) + " is in " +
                            counted(entity.physical.size(), "physical group") + ", its elements keep the first, tag " +
                            std::to_string(entity.physical[0]));
}

}  // namespace

Mesh build_mesh(const RawMesh& raw, std::vector<std::string>& notes, Folds folds) {
    const Selection chosen = select(raw);
    Mesh mesh;
    mesh.dim = chosen.dim;
    mesh.degree = chosen.degree;
    mesh.file.groups = raw.groups;
    mesh.file.msh_version = raw.version;
    const std::vector<int> index = number_nodes(raw, chosen, mesh, notes);
    if (mesh.dim == 2) check_flat(raw, index, notes);
    fill_elements(raw, chosen, index, mesh);
    note_shared_entities(raw, mesh.dim, notes);
    std::vector<int> turned;
    with_dimension(mesh.dim, [&](auto n) { turned = negative_elements<n>(raw, chosen, mesh); });
    turn(mesh, turned);
    const FoldedPairs folded = fill_boundary(raw, chosen, index, mesh, notes);
    if (folded.count && folds == Folds::refuse)
        refuse(raw, raw.elements[chosen.elements[folded.second]],
               "lies on the same side of their common face as " + name_of(raw.elements[chosen.elements[folded.first]]) +
                   ", the first of " + counted(folded.count, "such pair") +
                   ": the mesh folds over itself; `almesh quality` lists its inverted elements");
    if (folded.count) turn(mesh, minority(mesh, turned));
    else if (!turned.empty())
        notes.push_back(counted(turned.size(), "element") + " with negative orientation turned, the first is element " +
                        std::to_string(mesh.file.element_id[turned[0]]));
    return mesh;
}

}  // namespace almesh
