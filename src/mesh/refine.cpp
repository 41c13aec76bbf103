// Raising the degree of a mesh, uniform refinement, and the prolongation of fields to the finer mesh.
//
// New nodes are numbered in the order in which the elements meet them. A node is identified by the vertices of the
// edge, face or element it lies in and its barycentric coordinates there, a midpoint by the two ends of its edge.
//
// Prolongation needs for each fine node: a fine element that has it, hence the coarse element around it; its reference
// coordinates there, rounded to the lattice on which they lie; the coarse basis at them.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <unordered_map>

#include "base/error.hpp"
#include "base/parallel.hpp"
#include "mesh/kept_cells.hpp"
#include "mesh/lagrange.hpp"
#include "mesh/mesh.hpp"
#include "mesh/node_key.hpp"
#include "mesh/sides.hpp"

namespace almesh {
namespace {

// A new degree or number of vertices: where the nodes of each group begin.
void start_groups(std::vector<ElementGroup>& groups, int degree) {
    std::size_t start = 0;
    for (ElementGroup& group : groups) {
        group.start = start;
        start += offset(group.count, group.cell->node_count(degree));
    }
}

// Refuses what int cannot number.
void check_size(double entries, const char* what) {
    if (entries < std::numeric_limits<int>::max()) return;
    throw InputError(what, ": the mesh would have ", static_cast<long long>(entries),
                     " element nodes, more than this program can number");
}

bool is_straight(const Mesh& mesh) {
    const std::vector<double> y = straight_sided(mesh);
    double size = 0, difference = 0;
    for (std::size_t i = 0; i < y.size(); ++i) {
        size = std::max(size, std::abs(y[i]));
        difference = std::max(difference, std::abs(y[i] - mesh.x[i]));
    }
    return difference <= 1e-12 * size;
}

// Midpoint nodes by edge, appended to x. The edges of a vertex that has the lower number of their two form a linked
// list: in most meshes a few of them, so that the search is faster than hashing.
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
        int high, next;  // higher vertex, -1: it is no edge; next edge with the same lower one, -1: none
    };
    int dim_, vertices_;
    std::vector<double>& x_;
    std::vector<int> first_;  // per vertex: its last edge
    std::vector<Edge> edges_;
};

// The children of a cell with the vertices v, appended to `out`. A quadrilateral gets a node in its middle. An
// octahedron is cut along the shortest of its three diagonals: on general tetrahedra this keeps the shapes better than
// Bey's fixed one.
void append_children(const CellType& cell, const int* v, Midpoints& midpoint, const std::vector<double>& x,
                     std::vector<int>& out) {
    std::array<int, 10> node;  // vertices, midpoints, the middle
    auto end = std::copy_n(v, cell.vertices, node.begin());
    for (const auto& [a, b] : cell.bisected) *end++ = midpoint(v[a], v[b]);
    if (!cell.is_simplex()) *end++ = midpoint.inside(v, cell.vertices);
    const auto append = [&](const std::array<int, 4>& local) {
        for (int i : std::span(local).first(cell.vertices)) out.push_back(node[i]);
    };
    for (const CellChild& c : cell.children) append({c[0], c[1], c[2], c[3]});
    if (cell.octahedra.empty()) return;
    const auto diagonal = [&](const CellOctahedron& o) {  // squared length
        double s = 0;
        for (int k = 0; k < 3; ++k) {
            const double d = x[offset(node[o[0]], 3, k)] - x[offset(node[o[1]], 3, k)];
            s += d * d;
        }
        return s;
    };
    const auto& o = *std::min_element(cell.octahedra.begin(), cell.octahedra.end(),
                                      [&](const auto& p, const auto& q) { return diagonal(p) < diagonal(q); });
    for (int k = 0; k < 4; ++k) append({o[0], o[1], o[2 + k], o[2 + (k + 1) % 4]});
}

template <class Values>
Values repeated(const Values& from, int times) {
    Values to;
    to.reserve(from.size() * times);
    for (const auto& value : from) to.insert(to.end(), times, value);
    return to;
}

// The kept cells of a linear mesh split like its elements. Points stay.
void refine_kept_cells(const Mesh& mesh, Midpoints& midpoint, Mesh& fine) {
    const Subcells subcells(fine);
    for (const KeptCells& coarse : mesh.kept) {
        const CellType& cell = mesh.cell_of(coarse);
        if (cell.dim == 0) continue;
        KeptCells& kept = fine.kept[&coarse - mesh.kept.data()] = {};
        for (int c = 0; c < coarse.count(); ++c)
            append_children(cell, cell.dim == mesh.dim ? mesh.element(coarse.element[c])
                                                       : &coarse.nodes[offset(c, cell.vertices)],
                            midpoint, fine.x, kept.nodes);
        for (std::size_t k = 0; k < kept.nodes.size(); k += cell.vertices) {
            int e = coarse.element[(k / cell.vertices) >> cell.dim] << mesh.dim;
            while (!subcells.has(e, &kept.nodes[k], cell)) ++e;
            kept.element.push_back(e);
        }
        kept.physical = repeated(coarse.physical, 1 << cell.dim);
        kept.entity = repeated(coarse.entity, 1 << cell.dim);
        kept.id.resize(kept.physical.size());
    }
}

// 1, 2, ...: of faces, elements, kept cells.
void number_cells(Mesh& mesh) {
    long long next = 0;
    const auto number = [&next](std::vector<long long>& ids, int count) {
        ids.resize(count);
        for (long long& id : ids) id = ++next;
    };
    number(mesh.file.face_id, mesh.face_count());
    number(mesh.file.element_id, mesh.element_count());
    for (KeptCells& kept : mesh.kept) number(kept.id, kept.count());
}

Mesh refine_once(const Mesh& mesh) {
    const int dim = mesh.dim, children_count = 1 << dim, face_children = 1 << (dim - 1);
    Mesh fine = mesh;
    fine.elements.clear();
    fine.faces.clear();
    fine.face_element.clear();
    fine.elements.reserve(mesh.elements.size() * children_count);
    fine.x.reserve(mesh.x.size() << dim);
    Midpoints midpoint(dim, fine.x);
    const auto grow = [](std::vector<ElementGroup>& groups, int times) {
        for (ElementGroup& group : groups) {
            group.first *= times;
            group.count *= times;
            group.start *= times;
        }
    };
    grow(fine.groups, children_count);
    grow(fine.groups_of_faces, face_children);
    for (int e = 0; e < mesh.element_count(); ++e)
        append_children(mesh.cell(e), mesh.element(e), midpoint, fine.x, fine.elements);
    std::vector<int> pieces;
    for (int f = 0; f < mesh.face_count(); ++f) {
        pieces.clear();
        append_children(mesh.face_cell(f), mesh.face(f), midpoint, fine.x, pieces);
        const std::size_t vertices = mesh.face_cell(f).vertices;
        for (std::size_t first = 0; first < pieces.size(); first += vertices) {
            const std::span<const int> piece(&pieces[first], vertices);
            int e = mesh.face_element[f] * children_count;
            while (side_number(fine, e, piece) < 0) ++e;
            fine.face_element.push_back(e);
            const CellFace& local = fine.cell(e).faces[side_number(fine, e, piece)];
            for (std::size_t k = 0; k < vertices; ++k) fine.faces.push_back(fine.element(e)[local[k]]);
        }
    }
    fine.file.sections.clear();
    fine.file.element_winding.clear();
    fine.file.face_winding.clear();
    fine.face_boundary = repeated(mesh.face_boundary, face_children);
    fine.file.face_physical = repeated(mesh.file.face_physical, face_children);
    fine.file.face_entity = repeated(mesh.file.face_entity, face_children);
    fine.file.element_physical = repeated(mesh.file.element_physical, children_count);
    fine.file.element_entity = repeated(mesh.file.element_entity, children_count);
    refine_kept_cells(mesh, midpoint, fine);
    number_cells(fine);
    append_node_ids(mesh, fine);
    return fine;
}

// For each node the last one of the elements that have it.
std::vector<int> element_of_nodes(const Mesh& mesh) {
    std::vector<int> element(mesh.nodes());
    for (const ElementGroup& group : mesh.element_groups())
        for (int e = group.first; e < group.first + group.count; ++e)
            for (int i = 0; i < group.cell->node_count(mesh.degree); ++i) element[mesh.element(e)[i]] = e;
    return element;
}

// Reference coordinates of the point y in the straight-sided element with the given vertices, on the lattice of
// 1/steps; in a quadrilateral by Newton's method.
template <int n>
Vec<n> reference_point(const CellType& cell, const int* vertex, const std::vector<double>& ideal, const double* y,
                       double steps) {
    constexpr int newton_steps = 20;
    const double small = 1e-3 / steps;
    Vec<n> xi{};
    for (int step = 0; step < (cell.is_simplex() ? 1 : newton_steps); ++step) {
        const Vec<n> before = xi;
        Mat<n> A = straight_jacobian<n>(vertex, ideal);
        Vec<n> rest;
        for (int a = 0; a < n; ++a) rest[a] = y[a] - point(ideal, vertex[0], n)[a];
        if (!cell.is_simplex()) {
            for (int a = 0; a < n; ++a) {  // of x_0 + xi u + eta v + xi eta w
                const double x0 = point(ideal, vertex[0], n)[a];
                const auto from_first = [&](int k) { return point(ideal, vertex[k], n)[a] - x0; };
                const double u = from_first(1), v = from_first(3), w = from_first(2) - u - v;
                A[a][0] = u + xi[1] * w;
                A[a][1] = v + xi[0] * w;
                rest[a] -= xi[0] * u + xi[1] * v + xi[0] * xi[1] * w;
            }
        }
        const Mat<n> inverse_A = inverse<n>(A);
        for (int k = 0; k < n; ++k)
            for (int a = 0; a < n; ++a) xi[k] += inverse_A[k][a] * rest[a];
        if (std::abs(xi[0] - before[0]) + std::abs(xi[1] - before[1]) < small) break;
    }
    for (double& coordinate : xi) coordinate = std::round(coordinate * steps) / steps;
    return xi;
}

}  // namespace

Mesh linear_part(const Mesh& mesh) {
    Mesh linear = mesh;
    linear.degree = 1;
    if (mesh.degree > 1) linear.file.sections.clear();
    linear.x.clear();
    linear.file.node_id.clear();
    linear.file.node_entity.clear();
    std::vector<int> index(mesh.nodes(), -1);
    for (int e = 0; e < mesh.element_count(); ++e)
        for (int v = 0; v < mesh.cell(e).vertices; ++v) index[mesh.element(e)[v]] = 0;
    int count = 0;
    for (int i = 0; i < mesh.nodes(); ++i) {
        if (index[i] < 0) continue;
        index[i] = count++;
        linear.file.node_id.push_back(mesh.file.node_id[i]);
        if (i < static_cast<int>(mesh.file.node_entity.size()))
            linear.file.node_entity.push_back(mesh.file.node_entity[i]);
        for (int a = 0; a < mesh.dim; ++a) linear.x.push_back(mesh.x[offset(i, mesh.dim, a)]);
    }
    linear.elements.clear();
    for (int e = 0; e < mesh.element_count(); ++e)
        for (int v = 0; v < mesh.cell(e).vertices; ++v) linear.elements.push_back(index[mesh.element(e)[v]]);
    start_groups(linear.groups, 1);
    start_groups(linear.groups_of_faces, 1);
    linear.faces.clear();
    for (int f = 0; f < mesh.face_count(); ++f)
        for (const int node : mesh.face_vertices(f)) linear.faces.push_back(index[node]);
    restrict_kept_cells(mesh, index, linear);
    return linear;
}

Mesh raise_degree(const Mesh& mesh, int degree) {
    if (degree < mesh.degree)
        throw InputError("cannot lower the degree of the mesh from ", mesh.degree, " to ", degree);
    return interpolated(mesh, degree);
}

Mesh interpolated(const Mesh& mesh, int degree) {
    if (degree == mesh.degree) return mesh;
    const int dim = mesh.dim;
    const CellType& largest = mesh.cell(mesh.element_count() - 1);
    check_size(static_cast<double>(mesh.element_count()) * largest.node_count(degree), "degree");
    const Mesh linear = linear_part(mesh);
    Mesh raised = linear;
    if (degree > mesh.degree) raised.file.sections = mesh.file.sections;
    raised.degree = degree;
    raised.elements.clear();
    std::unordered_map<NodeKey, int, NodeKeyHash> node_of;
    for (const ElementGroup& group : mesh.element_groups()) {
        const CellType& cell = *group.cell;
        const LagrangeBasis coarse(cell, mesh.degree), fine(cell, degree);
        std::vector<double> N(offset(fine.count, coarse.count));  // coarse basis at the fine nodes
        for (int i = 0; i < fine.count; ++i) coarse.values(fine.point(i).data(), &N[offset(i, coarse.count)]);
        for (int e = group.first; e < group.first + group.count; ++e) {
            const int* vertex = linear.element(e);  // in the new numbering
            for (int i = 0; i < fine.count; ++i) {
                if (i < cell.vertices) {
                    raised.elements.push_back(vertex[i]);
                    continue;
                }
                const NodeKey key = cell.is_simplex() ? key_of(fine.nodes[i], vertex, dim)
                                                      : key_in_quadrilateral(fine.nodes[i], vertex);
                const auto [it, is_new] = node_of.try_emplace(key, raised.nodes());
                raised.elements.push_back(it->second);
                if (!is_new) continue;
                for (int a = 0; a < dim; ++a) {
                    double position = 0;
                    for (int j = 0; j < coarse.count; ++j)
                        position += N[offset(i, coarse.count, j)] * mesh.x[offset(mesh.element(e)[j], dim, a)];
                    raised.x.push_back(position);
                }
            }
        }
    }
    start_groups(raised.groups, degree);
    start_groups(raised.groups_of_faces, degree);
    raised.faces.clear();
    const SideNodes side_nodes(dim, degree);
    for (int f = 0; f < mesh.face_count(); ++f) {
        const int e = mesh.face_element[f];
        for (int k : side_nodes.of(mesh.cell(e), side_number(mesh, e, mesh.face_vertices(f))))
            raised.faces.push_back(raised.element(e)[k]);
    }
    raise_kept_cells(raised);
    append_node_ids(mesh, raised);
    return raised;
}

Mesh refine(const Mesh& mesh, int times) {
    if (times == 0) return mesh;
    if (!is_straight(mesh))
        throw InputError("refine: the mesh is curved; only straight-sided meshes are refined (drop `refine` or give "
                         "the linear mesh)");
    check_size(mesh.element_count() * std::pow(1 << mesh.dim, times) * mesh.element_nodes(), "refine");
    Mesh fine = linear_part(mesh);
    for (int k = 0; k < times; ++k) fine = refine_once(fine);
    return raise_degree(fine, mesh.degree);
}

std::vector<double> prolong(const Mesh& coarse, const std::vector<double>& coarse_ideal, const Mesh& fine,
                            const std::vector<double>& fine_ideal, const std::vector<double>& field) {
    const std::vector<LagrangeBasis> bases = bases_of(coarse);
    const std::vector<int> element = element_of_nodes(fine);
    const int children = fine.element_count() / coarse.element_count();  // those of e are numbered from e * children
    const double steps = std::round(std::pow(children, 1.0 / coarse.dim)) * fine.degree;
    std::vector<double> result(fine_ideal.size());
    with_dimension(coarse.dim, [&](auto dimension) {
        constexpr int n = dimension;
        parallel_for(fine.nodes(), [&](int i) {
            const int e = element[i] / children;
            const int* const node = coarse.element(e);
            const LagrangeBasis& basis = bases[coarse.group_number(e)];
            const std::size_t at = offset(i, n);
            const Vec<n> xi = reference_point<n>(basis.cell, node, coarse_ideal, &fine_ideal[at], steps);
            double N[most_element_nodes];
            basis.values(xi.data(), N);
            for (int j = 0; j < basis.count; ++j)
                for (int a = 0; a < n; ++a) result[at + a] += N[j] * field[offset(node[j], n, a)];
        });
    });
    return result;
}

}  // namespace almesh
