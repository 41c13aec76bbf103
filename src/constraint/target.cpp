// g_D of a point x of a boundary is its motion applied to x, at the nodes and at the quadrature points of every face.
#include "constraint/target.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.hpp"
#include "base/index.hpp"
#include "base/parallel.hpp"
#include "base/text.hpp"
#include "geometry/patch.hpp"
#include "mesh/lagrange.hpp"

namespace almesh {
namespace {

constexpr double move_work = 50;  // simple operations that moving a point takes

void move(const Motion& motion, const Mesh& mesh, int boundary, double* x) {
    std::array<double, 3> before{};
    std::copy_n(x, mesh.dim, before.begin());
    if (!apply(motion, mesh.dim, x))
        throw InputError("boundary ", mesh.boundaries[boundary], ": the closest point to ",
                         position_text(before.data(), mesh.dim), " is not defined (it is the centre or on the axis)");
    for (int a = 0; a < mesh.dim; ++a)
        if (!std::isfinite(x[a]))
            throw InputError("boundary ", mesh.boundaries[boundary], ": the motion takes ",
                             position_text(before.data(), mesh.dim), " to a position that is not finite");
}

double extent(const Mesh& mesh) {
    double size = 0;
    for (double v : mesh.x) size = std::max(size, std::abs(v));
    return size;
}

double face_size(const Mesh& mesh, int f) {
    const std::vector<Vec<3>> vertex = positions(mesh, mesh.x, mesh.face(f), mesh.dim);
    double longest = 0;
    for (const Vec<3>& v : vertex) longest = std::max(longest, length(v - vertex[0]));
    return longest;
}

// Of the basis functions at the points of the rule: points x nodes.
std::vector<double> values_at(const LagrangeBasis& basis, const Quadrature& rule) {
    std::vector<double> N(offset(rule.count, basis.count));
    for (int q = 0; q < rule.count; ++q) basis.values(&rule.xi[q * basis.dim], &N[offset(q, basis.count)]);
    return N;
}

// Of a face's node, given by its multi-index: the mean of the vertices by its barycentric coordinates.
double on_flat_face(const double* vertices, const MultiIndex& node, int degree, int dim, int a) {
    double position = 0;
    for (int v = 0; v < dim; ++v) position += node[v] * vertices[v * dim + a];
    return position / degree;
}

// Number of vertices of the edge or face that the node is inside of.
int vertices_of(const MultiIndex& node, int dim) {
    return static_cast<int>(std::count_if(node.begin(), node.begin() + dim, [](int k) { return k > 0; }));
}

// Of a shift of an edge's node k in that of node i inside the face: 4 l_a l_b of the middle of the edge between the
// vertices a and b, which a parabola through it has 3 p / (2 (p + 1)) times as high as its p - 1 nodes on average.
double share_of_edge(const MultiIndex& i, const MultiIndex& k, int p, int dim) {
    if (vertices_of(k, dim) != 2) return 0;
    double share = 6.0 * p / (p * p - 1);
    for (int v = 0; v < dim; ++v)
        if (k[v] > 0) share *= static_cast<double>(i[v]) / p;
    return share;
}

// A node on two boundaries must have one target, to a small part of the faces around it.
void check_shared_nodes(const Mesh& mesh, const BoundaryTarget& target) {
    const int dim = mesh.dim, m = mesh.face_nodes();
    const double rounding = 1e-14 * extent(mesh);
    std::vector<double> size(mesh.face_count());
    parallel_for(mesh.face_count(), [&](int f) { size[f] = face_size(mesh, f); });
    std::vector<int> first(mesh.nodes(), -1);  // face * m + local node that first gave the target
    for (int k = 0; k < static_cast<int>(mesh.faces.size()); ++k) {
        if (target.hold_of_node(mesh, k) != BoundaryHold::prescribed) continue;
        int& seen = first[mesh.faces[k]];
        if (seen < 0) seen = k;
        const double* a = &target.node[offset(seen, dim)];
        const double* b = &target.node[offset(k, dim)];
        double difference = 0;
        for (int c = 0; c < dim; ++c) difference = std::max(difference, std::abs(a[c] - b[c]));
        const double tolerance = 1e-6 * std::min(size[seen / m], size[k / m]);
        if (difference <= tolerance + rounding) continue;
        throw InputError("node ", mesh.file.node_id[mesh.faces[k]], " lies on two boundaries whose motions disagree: ",
                         mesh.boundaries[mesh.face_boundary[seen / m]], " takes it to ", position_text(a, dim), ", ",
                         mesh.boundaries[mesh.face_boundary[k / m]], " to ", position_text(b, dim),
                         "; if one of them is a wall along which the other moves, let it `slide`");
    }
}

// Face x face node; empty where no file leaves nodes out to slide or to be free.
std::vector<BoundaryHold> hold_of_nodes(const Mesh& mesh, const std::vector<Motion>& motion,
                                        const PlacedNodes& placed) {
    constexpr double rounding = 1e-9;  // of what is interpolated between 0 and 1
    const auto is_complete = [](const PlacedBoundary& boundary) { return boundary.left_out.empty(); };
    if (std::all_of(placed.begin(), placed.end(), is_complete)) return {};
    std::vector<BoundaryHold> hold;
    for (int k = 0; k < static_cast<int>(mesh.faces.size()); ++k) {
        const int b = mesh.face_boundary[k / mesh.face_nodes()];
        const bool is_left_out = !is_complete(placed[b]) &&
                                 std::abs(placed[b].left_out[offset(mesh.faces[k], mesh.dim)]) > rounding;
        hold.push_back(is_left_out ? hold_of_rest(motion[b]) : hold_of(motion[b]));
    }
    return hold;
}

}  // namespace

BoundaryTarget make_target(const Mesh& mesh, const std::vector<Motion>& motion, const PlacedNodes& placed) {
    const int dim = mesh.dim, m = mesh.face_nodes();
    for (const Motion& each : motion) check_dimension(each, dim);
    const LagrangeBasis basis(dim - 1, mesh.degree);
    BoundaryTarget target;
    for (const Motion& each : motion) target.hold.push_back(hold_of(each));
    target.hold_of_nodes = hold_of_nodes(mesh, motion, placed);
    target.in_trace_space = std::all_of(motion.begin(), motion.end(), is_affine);
    // Exact for N_i N_j. A g_D beyond the trace space needs far more to be integrated to rounding on a fair mesh.
    target.quadrature = simplex_quadrature(dim - 1, 2 * mesh.degree + (target.in_trace_space ? 0 : 10));
    const int points = target.quadrature.count;
    const std::vector<double> N = values_at(basis, target.quadrature);

    target.node.resize(mesh.faces.size() * dim);
    target.sample.resize(offset(mesh.face_count(), points * dim));
    parallel_for_throwing(mesh.face_count(), [&](int f) {
        const int boundary = mesh.face_boundary[f];
        const bool from_file = !placed.empty() && !placed[boundary].x.empty();
        const std::vector<double>& from = from_file ? placed[boundary].x : mesh.x;
        const auto node_position = [&](int i) { return point(from, mesh.face(f)[i], dim); };
        for (int i = 0; i < m; ++i) {
            double* const x = &target.node[offset(offset(f, m, i), dim)];
            std::copy_n(node_position(i), dim, x);
            move(motion[boundary], mesh, boundary, x);
        }
        for (int q = 0; q < points; ++q) {
            double* const x = &target.sample[offset(offset(f, points, q), dim)];
            for (int i = 0; i < m; ++i)
                for (int a = 0; a < dim; ++a) x[a] += N[offset(q, m, i)] * node_position(i)[a];
            move(motion[boundary], mesh, boundary, x);
        }
    }, move_work * (m + points));
    check_shared_nodes(mesh, target);
    return target;
}

std::vector<double> at_target(const Mesh& mesh, const BoundaryTarget& target, std::vector<double> x) {
    for (std::size_t k = mesh.faces.size(); k-- > 0;)
        std::copy_n(&target.node[k * mesh.dim], mesh.dim, point(x, mesh.faces[k], mesh.dim));
    return x;
}

void make_straight(const Mesh& mesh, const std::vector<char>& chosen, BoundaryTarget& target) {
    const int dim = mesh.dim, m = mesh.face_nodes(), p = mesh.degree;
    const LagrangeBasis basis(dim - 1, p);
    target.straight.resize(mesh.face_count(), 0);
    for (int f = 0; f < mesh.face_count(); ++f)
        if (chosen[f] && target.hold_of_face(mesh, f) == BoundaryHold::prescribed) target.straight[f] = 1;
    std::vector<double> flat(mesh.x.size()), shift(mesh.x.size(), 0.0);  // of the nodes of straight faces
    std::vector<char> moves(mesh.nodes(), 0);
    for (int f = 0; f < mesh.face_count(); ++f) {
        if (!target.straight[f]) continue;
        const double* const of_face = &target.node[offset(f, m * dim)];
        for (int i = dim; i < m; ++i) {
            const int node = mesh.face(f)[i];
            for (int a = 0; a < dim && !moves[node]; ++a) {
                point(flat, node, dim)[a] = on_flat_face(of_face, basis.nodes[i], p, dim, a);
                point(shift, node, dim)[a] = point(flat, node, dim)[a] - of_face[i * dim + a];
            }
            moves[node] = 1;
        }
    }
    const int points = target.quadrature.count;
    const std::vector<double> N = values_at(basis, target.quadrature);
    for (int f = 0; f < mesh.face_count(); ++f) {
        const int* const node = mesh.face(f);
        if (std::none_of(node + dim, node + m, [&](int i) { return moves[i]; })) continue;
        double* const of_face = &target.node[offset(f, m * dim)];
        for (int i = dim; i < m; ++i) {
            if (moves[node[i]]) std::copy_n(point(flat, node[i], dim), dim, &of_face[i * dim]);
            else if (vertices_of(basis.nodes[i], dim) == dim)
                for (int k = dim; k < m; ++k)
                    for (int a = 0; a < dim && moves[node[k]]; ++a)
                        of_face[i * dim + a] +=
                            share_of_edge(basis.nodes[i], basis.nodes[k], p, dim) * point(shift, node[k], dim)[a];
        }
        for (int q = 0; q < points; ++q)
            for (int a = 0; a < dim; ++a) {
                double& x = target.sample[offset(offset(f, points, q), dim, a)];
                x = 0;
                for (int i = 0; i < m; ++i) x += N[offset(q, m, i)] * of_face[i * dim + a];
            }
    }
}

void prescribe_shared_nodes(const Mesh& mesh, BoundaryTarget& target) {
    const int dim = mesh.dim;
    std::vector<int> first(mesh.nodes(), -1);
    for (int pass = 0; pass < 2; ++pass)
        for (int k = 0; k < static_cast<int>(mesh.faces.size()); ++k) {
            const bool prescribed = target.hold_of_node(mesh, k) == BoundaryHold::prescribed;
            int& known = first[mesh.faces[k]];
            if (pass == 0 && prescribed && known < 0) known = k;
            if (pass == 1 && !prescribed && known >= 0)
                std::copy_n(&target.node[offset(known, dim)], dim, &target.node[offset(k, dim)]);
        }
}

std::vector<char> prescribed_nodes(const Mesh& mesh, const BoundaryTarget& target) {
    std::vector<char> prescribed(mesh.nodes(), 0);
    for (int k = 0; k < static_cast<int>(mesh.faces.size()); ++k)
        if (target.hold_of_node(mesh, k) == BoundaryHold::prescribed) prescribed[mesh.faces[k]] = 1;
    return prescribed;
}

BoundaryHold BoundaryTarget::hold_of_node(const Mesh& mesh, int k) const {
    const BoundaryHold written = hold_of_nodes.empty() ? hold_of_face(mesh, k / mesh.face_nodes()) : hold_of_nodes[k];
    return written == BoundaryHold::prescribed && is_freed(mesh.faces[k]) ? BoundaryHold::slides : written;
}

bool BoundaryTarget::slides(const Mesh& mesh, int f) const {
    for (int k = f * mesh.face_nodes(); k < (f + 1) * mesh.face_nodes(); ++k)
        if (hold_of_node(mesh, k) == BoundaryHold::slides) return true;
    return false;
}

bool BoundaryTarget::prescribes_all() const {
    return freed.empty() && hold_of_nodes.empty() &&
           std::all_of(hold.begin(), hold.end(), [](BoundaryHold h) { return h == BoundaryHold::prescribed; });
}

}  // namespace almesh
