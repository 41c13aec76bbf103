// Uniform refinement, and the prolongation of fields to the finer mesh.
//
// New nodes are numbered in the order in which the elements meet them; a midpoint is identified by the two ends of its
// edge.
//
// Prolongation needs for each fine node: a fine element that has it, hence the coarse element around it; its reference
// coordinates there, rounded to the lattice on which they lie; the coarse basis at them.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include "base/parallel.hpp"
#include "linalg/ordering/graph.hpp"
#include "mesh/kept_cells.hpp"
#include "mesh/lagrange.hpp"
#include "mesh/node_key.hpp"
#include "mesh/sides.hpp"

namespace almesh {
namespace {

bool is_straight(const Mesh& mesh) {
    const std::vector<double> y = straight_sided(mesh);
    double size = 0, difference = 0;
    for (std::size_t i = 0; i < y.size(); ++i) {
        size = std::max(size, std::abs(y[i]));
        difference = std::max(difference, std::abs(y[i] - mesh.x[i]));
    }
    return difference <= 1e-12 * size;
}

// Middles of edges, quadrilaterals and hexahedra, appended to x. The edges of a vertex that has the lower number of
// their two form a linked list: in most meshes a few of them, so that the search is faster than hashing.
class Midpoints {
public:
    Midpoints(int dim, std::vector<double>& x)
        : dim_(dim), vertices_(static_cast<int>(x.size()) / dim), x_(x), first_(vertices_, -1) {}

    int operator()(int a, int b) {
        const int low = std::min(a, b), high = std::max(a, b);
        for (int k = first_[low]; k >= 0; k = edges_[k].next)
            if (edges_[k].high == high) return vertices_ + k;
        edges_.push_back({high, first_[low]});
        first_[low] = static_cast<int>(edges_.size()) - 1;
        for (int k = 0; k < dim_; ++k) x_.push_back(0.5 * (x_[offset(a, dim_, k)] + x_[offset(b, dim_, k)]));
        return vertices_ + first_[low];
    }

    // Of a quadrilateral, found again from its other side: by its lowest vertex and the one opposite.
    int of_quadrilateral(const std::array<int, 4>& v) {
        const auto low = static_cast<int>(std::min_element(v.begin(), v.end()) - v.begin());
        const int marked = -2 - v[(low + 2) % 4];
        for (int k = first_[v[low]]; k >= 0; k = edges_[k].next)
            if (edges_[k].high == marked) return vertices_ + k;
        const int middle = inside(v.data(), 4);
        edges_.back() = {marked, first_[v[low]]};
        first_[v[low]] = middle - vertices_;
        return middle;
    }

    // A new node in the middle of a cell.
    int inside(const int* vertex, int count) {
        for (int k = 0; k < dim_; ++k) {
            double sum = 0;
            for (int v = 0; v < count; ++v) sum += x_[offset(vertex[v], dim_, k)];
            x_.push_back(sum / count);
        }
        edges_.push_back({-1, -1});
        return vertices_ + static_cast<int>(edges_.size()) - 1;
    }

private:
    struct Edge {
        int high, next;  // higher vertex, below 0: it is no edge; next edge with the same lower one, -1: none
    };
    int dim_, vertices_;
    std::vector<double>& x_;
    std::vector<int> first_;  // per vertex: its last edge
    std::vector<Edge> edges_;
};

// Calls child(type, vertices) for the children of a cell with the vertices v. An octahedron is cut along the shortest
// of its three diagonals: on general tetrahedra this keeps the shapes better than Bey's fixed one.
template <class Child>
void for_children(const CellType& cell, const int* v, Midpoints& midpoint, const std::vector<double>& x,
                  const Child& child) {
    std::array<int, 27> node;  // vertices, midpoints, middles
    auto end = std::copy_n(v, cell.vertices, node.begin());
    for (const auto& [a, b] : cell.bisected) *end++ = midpoint(v[a], v[b]);
    const auto middle_of = [&](const CellFace& face) {
        return midpoint.of_quadrilateral({v[face[0]], v[face[1]], v[face[2]], v[face[3]]});
    };
    for (const CellFace& face : cell.faces)
        if (face[3] >= 0) *end++ = middle_of(face);
    if (&cell == &quadrilateral()) *end++ = middle_of({0, 1, 2, 3});
    if (&cell == &hexahedron()) *end++ = midpoint.inside(v, cell.vertices);
    const auto append = [&](const CellChild& local) {
        const CellType& type = cell.child_type(local);
        std::array<int, 8> vertex;
        for (int k = 0; k < type.vertices; ++k) vertex[k] = node[local[k]];
        child(type, vertex.data());
    };
    for (const CellChild& of_child : cell.children) append(of_child);
    if (cell.octahedra.empty()) return;
    const auto diagonal = [&](const CellOctahedron& o) {  // squared length
        double s = 0;
        for (int k = 0; k < 3; ++k) {
            const double d = x[offset(node[o[0]], 3, k)] - x[offset(node[o[1]], 3, k)];
            s += d * d;
        }
        return s;
    };
    const auto is_shorter = [&](const auto& a, const auto& b) { return diagonal(a) < diagonal(b); };
    const auto& o = *std::min_element(cell.octahedra.begin(), cell.octahedra.end(), is_shorter);
    for (int k = 0; k < 4; ++k) append({o[0], o[1], o[2 + k], o[2 + (k + 1) % 4]});
}

// The elements after refining some once: of each type those of the elements in their order, those of one together.
struct RefinedElements {
    std::vector<ElementGroup> groups;
    std::vector<int> parent;           // per new element

    explicit RefinedElements(const std::vector<ElementGroup>& of) {
        std::vector<const CellType*> types;
        for (const CellType& type : cell_types())
            for (const ElementGroup& group : of) {
                const int count = children_of(*group.cell, type);
                types.insert(types.end(), offset(group.count, count), &type);
                for (int e = group.first; e < group.first + group.count; ++e) parent.insert(parent.end(), count, e);
            }
        groups = groups_of(types, 1);
        if (groups.empty()) groups = {{types[0], 0, static_cast<int>(types.size()), 0}};
    }

private:
    static int children_of(const CellType& cell, const CellType& type) {
        const auto is_of_type = [&](const CellChild& child) { return &cell.child_type(child) == &type; };
        const int inside_octahedron = cell.octahedra.empty() || &cell != &type ? 0 : 4;
        return inside_octahedron +
               static_cast<int>(std::count_if(cell.children.begin(), cell.children.end(), is_of_type));
    }
};

template <class Values>
Values repeated(const Values& from, int times) {
    Values to;
    to.reserve(from.size() * times);
    for (const auto& value : from) to.insert(to.end(), times, value);
    return to;
}

// The kept cells of a linear mesh split like its elements. Points stay.
void refine_kept_cells(const Mesh& mesh, const Groups& children, Midpoints& midpoint, Mesh& fine) {
    const Subcells subcells(fine);
    for (const KeptCells& coarse : mesh.kept) {
        const CellType& cell = mesh.cell_of(coarse);
        if (cell.dim == 0) continue;
        KeptCells& kept = fine.kept[&coarse - mesh.kept.data()] = {};
        const auto append = [&](const CellType& type, const int* vertex) {  // of the children of its own type
            if (&type == &cell) kept.nodes.insert(kept.nodes.end(), vertex, vertex + type.vertices);
        };
        for (int c = 0; c < coarse.count(); ++c)
            for_children(cell, cell.dim == mesh.dim ? mesh.element(coarse.element[c])
                                                    : &coarse.nodes[offset(c, cell.vertices)],
                         midpoint, fine.x, append);
        for (std::size_t k = 0; k < kept.nodes.size(); k += cell.vertices) {
            const auto of = children.of(coarse.element[(k / cell.vertices) >> cell.dim]);
            const auto has_it = [&](int e) { return subcells.has(e, &kept.nodes[k], cell); };
            kept.element.push_back(*std::find_if(of.begin(), of.end(), has_it));
        }
        kept.physical = repeated(coarse.physical, 1 << cell.dim);
        kept.entity = repeated(coarse.entity, 1 << cell.dim);
        kept.id.resize(kept.physical.size());
    }
}

// In the order of faces, elements, kept cells; in SU2, which numbers elements alone, these come first.
void number_cells(Mesh& mesh) {
    long long next = mesh.file.format.first_id();
    const auto number = [&next](std::vector<long long>& ids, int count) {
        ids.resize(count);
        for (long long& id : ids) id = next++;
    };
    if (next == 0) number(mesh.file.element_id, mesh.element_count());
    number(mesh.file.face_id, mesh.face_count());
    if (mesh.file.format.first_id() == 1) number(mesh.file.element_id, mesh.element_count());
    for (KeptCells& kept : mesh.kept) number(kept.id, kept.count());
}

Mesh refine_once(const Mesh& mesh) {
    const int dim = mesh.dim, face_children = 1 << (dim - 1);
    const RefinedElements refined(mesh.element_groups());
    const Groups children = sorted_by_group(refined.parent, mesh.element_count());
    Mesh fine = mesh;
    if (!mesh.is_simplicial()) fine.groups = refined.groups;
    fine.elements.clear();
    fine.faces.clear();
    fine.face_element.clear();
    fine.elements.reserve(mesh.elements.size() << dim);
    fine.x.reserve(mesh.x.size() << dim);
    Midpoints midpoint(dim, fine.x);
    for (ElementGroup& group : fine.groups_of_faces) {
        group.first *= face_children;
        group.count *= face_children;
        group.start *= face_children;
    }
    std::map<const CellType*, std::vector<int>> of_type;  // tetrahedra among the children of pyramids
    for (int e = 0; e < mesh.element_count(); ++e)
        for_children(mesh.cell(e), mesh.element(e), midpoint, fine.x, [&](const CellType& type, const int* vertex) {
            std::vector<int>& elements = fine.groups.size() < 2 ? fine.elements : of_type[&type];
            elements.insert(elements.end(), vertex, vertex + type.vertices);
        });
    for (const ElementGroup& group : fine.groups) {
        const std::vector<int>& elements = of_type[group.cell];
        fine.elements.insert(fine.elements.end(), elements.begin(), elements.end());
    }
    for (int f = 0; f < mesh.face_count(); ++f) {
        const auto candidates = children.of(mesh.face_element[f]);
        for_children(mesh.face_cell(f), mesh.face(f), midpoint, fine.x, [&](const CellType& type, const int* vertex) {
            const std::span<const int> piece(vertex, type.vertices);
            const int e = *std::find_if(candidates.begin(), candidates.end(),
                                        [&](int child) { return side_number(fine, child, piece) >= 0; });
            const CellFace& local = fine.cell(e).faces[side_number(fine, e, piece)];
            fine.face_element.push_back(e);
            for (int k = 0; k < type.vertices; ++k) fine.faces.push_back(fine.element(e)[local[k]]);
        });
    }
    fine.file.leave_file();
    fine.face_boundary = repeated(mesh.face_boundary, face_children);
    fine.file.face_physical = repeated(mesh.file.face_physical, face_children);
    fine.file.face_entity = repeated(mesh.file.face_entity, face_children);
    for (std::vector<int>* const tags : {&fine.file.element_physical, &fine.file.element_entity}) {
        const std::vector<int> coarse = std::exchange(*tags, {});
        for (const int e : refined.parent)
            if (!coarse.empty()) tags->push_back(coarse[e]);
    }
    refine_kept_cells(mesh, children, midpoint, fine);
    number_cells(fine);
    append_node_ids(mesh, fine);
    return fine;
}

// Reference coordinates of the point y in the straight-sided element with the given vertices, on the lattice of
// 1/steps; where that is no simplex by Newton's method, on a pyramid for a (1 - c), b (1 - c) and c, and not on the
// lattice, since the children of one whose base is no parallelogram are not its images of their place in it.
template <int n>
Vec<n> reference_point(const LagrangeBasis& linear, const int* vertex, const std::vector<double>& ideal, const double* y,
                       double steps) {
    constexpr int newton_steps = 20;
    const CellType& cell = linear.cell;
    const double small = cell.is_collapsed ? 1e-13 : 1e-3 / steps;
    double N[8], dN[8 * n];
    Vec<n> at{}, xi{};
    for (int step = 0; step < (cell.is_simplex() ? 1 : newton_steps); ++step) {
        Mat<n> A = straight_jacobian<n>(vertex, ideal);
        Vec<n> rest;
        for (int a = 0; a < n; ++a) rest[a] = y[a] - point(ideal, vertex[0], n)[a];
        if (!cell.is_simplex()) {
            linear.values(xi.data(), N);
            linear.gradients(xi.data(), dN);
            A = {};
            for (int v = 1; v < cell.vertices; ++v)
                for (int a = 0; a < n; ++a) {
                    const double from_first = point(ideal, vertex[v], n)[a] - point(ideal, vertex[0], n)[a];
                    rest[a] -= N[v] * from_first;
                    for (int k = 0; k < n; ++k) A[a][k] += dN[v * n + k] * from_first;
                }
        }
        const Mat<n> inverse_A = inverse<n>(A);
        Vec<n> change{};
        for (int k = 0; k < n; ++k)
            for (int a = 0; a < n; ++a) change[k] += inverse_A[k][a] * rest[a];
        if (cell.is_collapsed)
            for (int k = 0; k < 2; ++k) change[k] -= xi[k] * change[n - 1];
        double length = 0;
        for (int k = 0; k < n; ++k) {
            at[k] += change[k];
            length += std::abs(change[k]);
        }
        xi = at;
        if (cell.is_collapsed)
            for (int k = 0; k < 2; ++k) xi[k] = std::clamp(at[k] / std::max(1 - at[n - 1], small), 0.0, 1.0);
        if (length < small) break;
    }
    if (cell.is_collapsed) return xi;
    for (double& coordinate : xi) coordinate = std::round(coordinate * steps) / steps;
    return xi;
}

}  // namespace

Mesh refine(const Mesh& mesh, int times) {
    if (times == 0) return mesh;
    if (!is_straight(mesh))
        throw InputError("refine: the mesh is curved; only straight-sided meshes are refined (drop `refine` or give "
                         "the linear mesh)");
    check_size(mesh, mesh.degree, std::pow(1 << mesh.dim, times), "refine");
    Mesh fine = linear_part(mesh);
    for (int k = 0; k < times; ++k) fine = refine_once(fine);
    return raise_degree(fine, mesh.degree);
}

std::vector<double> prolong(const Mesh& coarse, const std::vector<double>& coarse_ideal, const Mesh& fine,
                            const std::vector<double>& fine_ideal, const std::vector<double>& field) {
    const std::vector<LagrangeBasis> bases = bases_of(coarse.element_groups(), coarse.degree),
                                     linear = bases_of(coarse.element_groups(), 1);
    std::vector<int> element(fine.nodes());  // the last one of those that have the node
    for (int e = 0; e < fine.element_count(); ++e)
        for (int i = 0; i < fine.element_nodes(e); ++i) element[fine.element(e)[i]] = e;
    std::vector<int> parent(coarse.element_count());  // element of `coarse` that each one of `fine` is in
    std::iota(parent.begin(), parent.end(), 0);
    double steps = fine.degree;
    for (auto groups = coarse.element_groups(); static_cast<int>(parent.size()) < fine.element_count(); steps *= 2) {
        RefinedElements refined(groups);
        for (int& e : refined.parent) e = parent[e];
        parent = std::move(refined.parent);
        groups = std::move(refined.groups);
    }
    std::vector<double> result(fine_ideal.size());
    with_dimension(coarse.dim, [&](auto dimension) {
        constexpr int n = dimension;
        parallel_for(fine.nodes(), [&](int i) {
            const int e = parent[element[i]];
            const int* const node = coarse.element(e);
            const int group = coarse.group_number(e);
            const LagrangeBasis& basis = bases[group];
            const std::size_t at = offset(i, n);
            const Vec<n> xi = reference_point<n>(linear[group], node, coarse_ideal, &fine_ideal[at], steps);
            double N[most_element_nodes];
            basis.values(xi.data(), N);
            for (int j = 0; j < basis.count; ++j)
                for (int a = 0; a < n; ++a) result[at + a] += N[j] * field[offset(node[j], n, a)];
        });
    });
    return result;
}

}  // namespace almesh
