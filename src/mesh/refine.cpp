// Raising the degree of a mesh and splitting its elements.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <unordered_map>

#include "base/error.hpp"
#include "mesh/lagrange.hpp"
#include "mesh/mesh.hpp"
#include "mesh/straight_jacobian.hpp"

namespace almesh {
namespace {

// Sizes and indices are int.
void check_size(double entries, const char* what) {
    if (entries < std::numeric_limits<int>::max()) return;
    throw InputError(std::string(what) + ": the mesh would have " + std::to_string(static_cast<long long>(entries)) +
                     " element nodes, more than this program can number");
}

// A lattice node by the vertices it lies between: (vertex, barycentric entry) for each non-zero entry, by vertex.
// Two elements that share a face find the same key for each node on it.
using NodeKey = std::array<int, 8>;

struct NodeKeyHash {
    std::size_t operator()(const NodeKey& key) const {
        std::size_t h = 14695981039346656037u;  // as FNV-1a, by whole ints
        for (int k : key) h = (h ^ static_cast<std::size_t>(k)) * 1099511628211u;
        return h;
    }
};

NodeKey key_of(const MultiIndex& a, const int* vertex, int dim) {
    NodeKey key;
    key.fill(-1);
    int count = 0;
    for (int k = 0; k <= dim; ++k) {
        if (!a[k]) continue;
        int place = 2 * count++;  // insertion by vertex
        for (; place > 0 && key[place - 2] > vertex[k]; place -= 2) {
            key[place] = key[place - 2];
            key[place + 1] = key[place - 1];
        }
        key[place] = vertex[k];
        key[place + 1] = a[k];
    }
    return key;
}

// Local vertex of element e opposite its face f.
int opposite_vertex(const Mesh& mesh, int f) {
    const int* node = mesh.element(mesh.face_element[f]);
    const int* face = mesh.face(f);
    for (int v = 0; v <= mesh.dim; ++v)
        if (std::find(face, face + mesh.dim, node[v]) == face + mesh.dim) return v;
    return -1;
}

// New nodes get the ids after the largest one of the mesh they come from.
void append_node_ids(const Mesh& from, Mesh& mesh) {
    const std::vector<long long>& known = from.file.node_id;
    long long next = known.empty() ? 0 : *std::max_element(known.begin(), known.end());
    while (static_cast<int>(mesh.file.node_id.size()) < mesh.nodes()) mesh.file.node_id.push_back(++next);
}

// Linear mesh on the vertices of `mesh`.
Mesh linear_part(const Mesh& mesh) {
    Mesh linear = mesh;
    linear.degree = 1;
    linear.x.clear();
    linear.file.node_id.clear();
    std::vector<int> index(mesh.nodes(), -1);
    for (int e = 0; e < mesh.element_count(); ++e)
        for (int v = 0; v <= mesh.dim; ++v) index[mesh.element(e)[v]] = 0;
    int count = 0;
    for (int i = 0; i < mesh.nodes(); ++i) {
        if (index[i] < 0) continue;
        index[i] = count++;
        linear.file.node_id.push_back(mesh.file.node_id[i]);
        for (int a = 0; a < mesh.dim; ++a) linear.x.push_back(mesh.x[static_cast<std::size_t>(i) * mesh.dim + a]);
    }
    linear.elements.clear();
    for (int e = 0; e < mesh.element_count(); ++e)
        for (int v = 0; v <= mesh.dim; ++v) linear.elements.push_back(index[mesh.element(e)[v]]);
    linear.faces.clear();
    for (int f = 0; f < mesh.face_count(); ++f)
        for (int v = 0; v < mesh.dim; ++v) linear.faces.push_back(index[mesh.face(f)[v]]);
    return linear;
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

// Midpoint nodes by edge, appended to x. The edges hang in a chain on the lower one of their two vertices, which in
// most meshes has a handful: found in a few steps, without hashing.
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
        for (int k = 0; k < dim_; ++k)
            x_.push_back(0.5 * (coordinate(a, k) + coordinate(b, k)));
        return vertices_ + first_[low];
    }

private:
    struct Edge {
        int high, next;  // higher vertex; next edge with the same lower one, -1: none
    };
    int dim_, vertices_;
    std::vector<double>& x_;
    std::vector<int> first_;  // per vertex: its last edge
    std::vector<Edge> edges_;

    double coordinate(int node, int k) const { return x_[static_cast<std::size_t>(node) * dim_ + k]; }
};

double distance_squared(const std::vector<double>& x, int a, int b, int dim) {
    double s = 0;
    for (int k = 0; k < dim; ++k) {
        const double d = x[static_cast<std::size_t>(a) * dim + k] - x[static_cast<std::size_t>(b) * dim + k];
        s += d * d;
    }
    return s;
}

using Child = std::array<int, 4>;  // vertices of a child element

std::vector<Child> split_triangle(const int* v, Midpoints& mid) {
    const int m01 = mid(v[0], v[1]), m12 = mid(v[1], v[2]), m20 = mid(v[2], v[0]);
    return {{v[0], m01, m20}, {m01, v[1], m12}, {m20, m12, v[2]}, {m01, m12, m20}};
}

// Four corner tetrahedra and an octahedron, cut along the shortest of its three diagonals (Bey, Computing 55, 1995,
// cuts along a fixed one; the shortest keeps the shapes better on general tetrahedra).
std::vector<Child> split_tetrahedron(const int* v, Midpoints& mid, const std::vector<double>& x) {
    const int m01 = mid(v[0], v[1]), m02 = mid(v[0], v[2]), m03 = mid(v[0], v[3]), m12 = mid(v[1], v[2]),
              m13 = mid(v[1], v[3]), m23 = mid(v[2], v[3]);
    std::vector<Child> child = {
        {v[0], m01, m02, m03}, {m01, v[1], m12, m13}, {m02, m12, v[2], m23}, {m03, m13, m23, v[3]}};
    // Each diagonal (a, b) with the ring of the other four midpoints around it, positively oriented.
    const std::array<std::array<int, 6>, 3> octahedron = {
        {{m01, m23, m02, m03, m13, m12}, {m02, m13, m01, m12, m23, m03}, {m03, m12, m01, m02, m23, m13}}};
    const auto length = [&](const auto& o) { return distance_squared(x, o[0], o[1], 3); };
    const auto& o = *std::min_element(octahedron.begin(), octahedron.end(),
                                      [&](const auto& p, const auto& q) { return length(p) < length(q); });
    for (int k = 0; k < 4; ++k) child.push_back({o[0], o[1], o[2 + k], o[2 + (k + 1) % 4]});
    return child;
}

void orient(Child& c, int dim, const std::vector<double>& x) {
    with_dimension(dim, [&](auto dimension) {
        constexpr int n = dimension;
        if (determinant(straight_jacobian<n>(c.data(), x)) < 0) std::swap(c[n - 1], c[n]);
    });
}

// Child of the element that has the face (all its vertices), by search among its children.
int child_with_face(const std::vector<Child>& children, const int* face, int dim) {
    for (int c = 0; c < static_cast<int>(children.size()); ++c) {
        int found = 0;
        for (int v = 0; v < dim; ++v) found += std::count(children[c].begin(), children[c].begin() + dim + 1, face[v]);
        if (found == dim) return c;
    }
    return -1;
}

Mesh refine_once(const Mesh& mesh) {
    const int dim = mesh.dim, children_count = 1 << dim, face_children = 1 << (dim - 1);
    Mesh fine = mesh;
    fine.elements.clear();
    fine.faces.clear();
    fine.face_element.clear();
    fine.elements.reserve(mesh.elements.size() * children_count);
    fine.x.reserve(mesh.x.size() << dim);
    Midpoints mid(dim, fine.x);
    const auto repeat = [](const auto& from, int times) {
        std::decay_t<decltype(from)> to;
        to.reserve(from.size() * times);
        for (const auto& value : from) to.insert(to.end(), times, value);
        return to;
    };
    for (int e = 0; e < mesh.element_count(); ++e) {
        const int* v = mesh.element(e);
        for (Child c : dim == 2 ? split_triangle(v, mid) : split_tetrahedron(v, mid, fine.x)) {
            orient(c, dim, fine.x);
            fine.elements.insert(fine.elements.end(), c.begin(), c.begin() + dim + 1);
        }
    }
    for (int f = 0; f < mesh.face_count(); ++f) {
        const int* v = mesh.face(f);
        std::vector<Child> pieces;
        if (dim == 2) {
            const int m = mid(v[0], v[1]);
            pieces = {{v[0], m}, {m, v[1]}};
        } else {
            pieces = split_triangle(v, mid);
        }
        const int e = mesh.face_element[f];
        std::vector<Child> children(children_count);
        for (int c = 0; c < children_count; ++c)
            std::copy_n(fine.element(e * children_count + c), dim + 1, children[c].begin());
        for (const Child& piece : pieces) {
            const int c = child_with_face(children, piece.data(), dim);
            fine.face_element.push_back(e * children_count + c);
            // The face in the order that LagrangeBasis::face_nodes gives it.
            for (int opposite = 0; opposite <= dim; ++opposite) {
                if (std::count(piece.begin(), piece.begin() + dim, children[c][opposite])) continue;
                const std::array<int, 3> local = outward_face(dim, opposite);
                for (int k = 0; k < dim; ++k) fine.faces.push_back(children[c][local[k]]);
            }
        }
    }
    fine.face_boundary = repeat(mesh.face_boundary, face_children);
    fine.file.face_physical = repeat(mesh.file.face_physical, face_children);
    fine.file.face_entity = repeat(mesh.file.face_entity, face_children);
    fine.file.element_physical = repeat(mesh.file.element_physical, children_count);
    fine.file.element_entity = repeat(mesh.file.element_entity, children_count);
    long long id = 0;
    fine.file.face_id.resize(fine.face_element.size());
    for (long long& face_id : fine.file.face_id) face_id = ++id;
    fine.file.element_id.resize(fine.element_count());
    for (long long& element_id : fine.file.element_id) element_id = ++id;
    append_node_ids(mesh, fine);
    return fine;
}

}  // namespace

Mesh raise_degree(const Mesh& mesh, int degree) {
    if (degree == mesh.degree) return mesh;
    if (degree < mesh.degree)
        throw InputError("cannot lower the degree of the mesh from " + std::to_string(mesh.degree) + " to " +
                         std::to_string(degree));
    const int dim = mesh.dim;
    const LagrangeBasis coarse(dim, mesh.degree), fine(dim, degree);
    check_size(static_cast<double>(mesh.element_count()) * fine.count, "degree");
    std::vector<double> N(static_cast<std::size_t>(fine.count) * coarse.count);  // coarse basis at the fine nodes
    for (int i = 0; i < fine.count; ++i) {
        double xi[3] = {0, 0, 0};
        for (int k = 0; k < dim; ++k) xi[k] = static_cast<double>(fine.nodes[i][k + 1]) / degree;
        coarse.values(xi, &N[static_cast<std::size_t>(i) * coarse.count]);
    }

    Mesh raised = linear_part(mesh);
    const std::vector<int> vertices = raised.elements;  // element_count x (dim + 1), in the new numbering
    raised.degree = degree;
    raised.elements.clear();
    std::unordered_map<NodeKey, int, NodeKeyHash> node_of;
    for (int e = 0; e < mesh.element_count(); ++e) {
        const int* vertex = &vertices[static_cast<std::size_t>(e) * (dim + 1)];
        for (int i = 0; i < fine.count; ++i) {
            if (i <= dim) {
                raised.elements.push_back(vertex[i]);
                continue;
            }
            const auto [it, is_new] = node_of.try_emplace(key_of(fine.nodes[i], vertex, dim), raised.nodes());
            raised.elements.push_back(it->second);
            if (!is_new) continue;
            for (int a = 0; a < dim; ++a) {
                double position = 0;
                for (int j = 0; j < coarse.count; ++j)
                    position += N[static_cast<std::size_t>(i) * coarse.count + j] *
                                mesh.x[static_cast<std::size_t>(mesh.element(e)[j]) * dim + a];
                raised.x.push_back(position);
            }
        }
    }
    raised.faces.clear();
    for (int f = 0; f < mesh.face_count(); ++f)
        for (int local : fine.face_nodes(opposite_vertex(mesh, f)))
            raised.faces.push_back(raised.element(mesh.face_element[f])[local]);
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

}  // namespace almesh
