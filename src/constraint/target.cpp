// g_D of a point x of a boundary is its motion applied to x, at the nodes and at the quadrature points of every face.
#include "constraint/target.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "base/error.hpp"
#include "base/parallel.hpp"
#include "base/table.hpp"
#include "constraint/sliding_nodes.hpp"
#include "constraint/surface.hpp"
#include "linalg/vector_ops.hpp"
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

// The weighted mean of the vertices at a node of a face; the weights add up to `degree`.
double on_flat_face(const double* vertices, const std::vector<double>& weight, int degree, int dim, int a) {
    double position = 0;
    for (std::size_t v = 0; v < weight.size(); ++v) position += weight[v] * vertices[v * dim + a];
    return position / degree;
}

// The positions of nodes to which two boundaries give positions that differ by more than a small fraction of the faces
// there. x: positions of the mesh. Throws if the rule is `refuse`.
std::map<int, Vec<3>> settled_positions(const Mesh& mesh, const std::vector<double>& x, const BoundaryTarget& target,
                                        const SharedNodes& shared) {
    const int dim = mesh.dim;
    const double rounding = 1e-14 * norm_inf(x);
    struct Place {
        int face;
        std::size_t k;  // in `faces`
    };
    std::vector<Place> first(mesh.nodes(), {-1, 0});  // that gave the target
    std::map<int, std::map<std::pair<int, int>, std::size_t>> claims;  // node -> rank, boundary -> place in `faces`
    for_face_nodes(mesh, [&](int f, std::size_t k) {
        if (!is_prescribed(target.kind[k])) return;
        Place& seen = first[mesh.faces[k]];
        if (seen.face < 0) seen = {f, k};
        const double *const a = &target.node[seen.k * dim], *const b = &target.node[k * dim];
        const Vec<3> way = in_space(b, dim) - in_space(a, dim);
        const double most = std::max({std::abs(way[0]), std::abs(way[1]), std::abs(way[2])});
        if (most <= rounding) return;
        if (most <= 1e-6 * std::min(face_size(mesh, x, seen.face), face_size(mesh, x, f)) + rounding) return;
        claims[mesh.faces[k]];
        if (shared.rule != SharedNodes::refuse) return;
        throw InputError("node ", mesh.file.node_id[mesh.faces[k]], " lies on two boundaries whose motions disagree: ",
                         mesh.boundaries[mesh.face_boundary[seen.face]], " takes it to ", position_text(a, dim), ", ",
                         mesh.boundaries[mesh.face_boundary[f]], " to ", position_text(b, dim), ", ",
                         to_text(length(way), 4), " apart; if one of them is a wall along which the other moves, let "
                         "it `slide`; else say who has the node, `shared_nodes = first` or `mean`");
    });
    for_face_nodes(mesh, [&](int f, std::size_t k) {
        const auto claim = claims.find(mesh.faces[k]);
        const int b = mesh.face_boundary[f];
        if (claim != claims.end() && is_prescribed(target.kind[k]))
            claim->second.try_emplace({shared.rank.empty() ? b : shared.rank[b], b}, k);
    });
    std::map<int, Vec<3>> positions;
    for (const auto& [node, places] : claims) {
        const std::size_t count = shared.rule == SharedNodes::first ? 1 : places.size();
        auto place = places.begin();
        for (std::size_t i = 0; i < count; ++i, ++place)
            for (int a = 0; a < dim; ++a)
                positions[node][a] += target.node[place->second * dim + a] / static_cast<double>(count);
    }
    return positions;
}

// Takes disputed nodes to one position, and the faces at them along.
void share_nodes(const Mesh& mesh, const std::vector<double>& x, const SharedNodes& shared, BoundaryTarget& target) {
    const std::map<int, Vec<3>> positions = settled_positions(mesh, x, target, shared);
    const std::vector<NodeKind> boundary = kinds_of_boundaries(mesh, target.kind);
    const int dim = mesh.dim;
    for (std::size_t g = 0; g < target.rules.size() && !positions.empty(); ++g) {
        const FaceRule& rule = target.rules[g];
        const LagrangeBasis basis(*rule.faces.cell, mesh.degree);
        for (int f = rule.faces.first; f < rule.faces.first + rule.faces.count; ++f) {
            if (!is_prescribed(boundary[mesh.face_boundary[f]])) continue;
            double* const node = &target.node[mesh.face_start(f) * dim];
            std::vector<double> shift(basis.count * dim, 0.0);
            for (int i = 0; i < basis.count; ++i) {
                const auto found = positions.find(mesh.face(f)[i]);
                const std::vector<double> weight = basis.vertex_weights(i);
                for (int a = 0; a < dim; ++a) {
                    double& by = shift[i * dim + a];
                    if (found != positions.end()) by = found->second[a] - node[i * dim + a];
                    else if (i >= basis.cell.vertices) by = on_flat_face(shift.data(), weight, mesh.degree, dim, a);
                    node[i * dim + a] = found != positions.end() ? found->second[a] : node[i * dim + a] + by;
                }
            }
            for (int q = 0; q < rule.quadrature.count; ++q)
                for (int i = 0; i < basis.count; ++i)
                    for (int a = 0; a < dim; ++a)
                        target.sample[rule.sample(f, q) * dim + a] +=
                            rule.values[offset(q, basis.count, i)] * shift[i * dim + a];
        }
    }
}

// Face x face node.
std::vector<NodeKind> kinds_of_nodes(const Mesh& mesh, const std::vector<Motion>& motion, const PlacedNodes& placed) {
    constexpr double rounding = 1e-9;  // of what is interpolated between 0 and 1
    std::vector<NodeKind> kind;
    for_face_nodes(mesh, [&](int f, std::size_t k) {
        const int b = mesh.face_boundary[f];
        const bool is_left_out = !placed.empty() && !placed[b].left_out.empty() &&
                                 std::abs(placed[b].left_out[offset(mesh.faces[k], mesh.dim)]) > rounding;
        kind.push_back(is_left_out ? kind_of_rest(motion[b]) : kind_of(motion[b]));
    });
    return kind;
}

std::vector<FaceRule> rules_of(const Mesh& mesh, int exactness) {
    std::vector<FaceRule> rules;
    std::size_t first = 0;
    for (const ElementGroup& group : mesh.face_groups()) {
        const Quadrature quadrature = cell_quadrature(*group.cell, exactness);
        const LagrangeBasis basis(*group.cell, mesh.degree);
        std::vector<double> N(offset(quadrature.count, basis.count));
        for (int q = 0; q < quadrature.count; ++q)
            basis.values(&quadrature.xi[q * basis.dim], &N[offset(q, basis.count)]);
        rules.push_back({group, quadrature, std::move(N), first});
        first += offset(group.count, quadrature.count);
    }
    return rules;
}

}  // namespace

double face_size(const Mesh& mesh, const std::vector<double>& x, int f) {
    return extent(positions(mesh, x, mesh.face(f), mesh.face_cell(f).vertices));
}

BoundaryTarget make_target(const Mesh& mesh, const std::vector<double>& at, const std::vector<Motion>& motion,
                           const PlacedNodes& placed, const SharedNodes& shared) {
    const int dim = mesh.dim;
    for (const Motion& each : motion) check_dimension(each, dim);
    BoundaryTarget target;
    target.kind = target.written_kind = kinds_of_nodes(mesh, motion, placed);
    target.in_trace_space = std::all_of(motion.begin(), motion.end(), is_affine);
    // Exact for N_i N_j. A g_D beyond the trace space needs far more to be integrated to rounding on a fair mesh.
    target.rules = rules_of(mesh, 2 * mesh.degree + (target.in_trace_space ? 0 : 10));
    target.node.resize(mesh.faces.size() * dim);
    const FaceRule& last = target.rules.back();
    target.sample.resize(last.sample(last.faces.first + last.faces.count, 0) * dim);
    for (const FaceRule& rule : target.rules) {
        const int m = rule.faces.cell->node_count(mesh.degree), points = rule.quadrature.count;
        parallel_for_throwing(rule.faces.count, [&](int k) {
            const int f = rule.faces.first + k, boundary = mesh.face_boundary[f];
            const bool from_file = !placed.empty() && !placed[boundary].x.empty();
            const std::vector<double>& from = from_file ? placed[boundary].x : at;
            const auto node_position = [&](int i) { return point(from, mesh.face(f)[i], dim); };
            for (int i = 0; i < m; ++i) {
                double* const x = &target.node[(mesh.face_start(f) + i) * dim];
                std::copy_n(node_position(i), dim, x);
                move(motion[boundary], mesh, boundary, x);
            }
            for (int q = 0; q < points; ++q) {
                double* const x = &target.sample[rule.sample(f, q) * dim];
                for (int i = 0; i < m; ++i)
                    for (int a = 0; a < dim; ++a) x[a] += rule.values[offset(q, m, i)] * node_position(i)[a];
                move(motion[boundary], mesh, boundary, x);
            }
        }, move_work * (m + points));
    }
    target.written = target.node;
    share_nodes(mesh, at, shared, target);
    return target;
}

std::vector<double> at_target(const Mesh& mesh, const BoundaryTarget& target, std::vector<double> x) {
    for (std::size_t k = mesh.faces.size(); k-- > 0;)
        std::copy_n(&target.node[k * mesh.dim], mesh.dim, point(x, mesh.faces[k], mesh.dim));
    return x;
}

void prescribe_shared_nodes(const Mesh& mesh, BoundaryTarget& target) {
    const int dim = mesh.dim;
    std::vector<long long> decides(mesh.nodes(), -1);  // place in `faces`
    for (const NodeKind kind : {NodeKind::fixed, NodeKind::target})
        for (std::size_t k = 0; k < mesh.faces.size(); ++k)
            if (long long& known = decides[mesh.faces[k]]; known < 0 && target.kind[k] == kind)
                known = static_cast<long long>(k);
    for (std::size_t k = 0; k < mesh.faces.size(); ++k)
        if (const long long known = decides[mesh.faces[k]]; known >= 0)
            std::copy_n(&target.node[known * dim], dim, &target.node[k * dim]);
}

std::vector<NodeKind> kinds_of_boundaries(const Mesh& mesh, const std::vector<NodeKind>& kind) {
    std::vector<NodeKind> least(mesh.boundaries.size(), NodeKind::free);
    for_face_nodes(mesh, [&](int f, std::size_t k) {
        least[mesh.face_boundary[f]] = std::min(least[mesh.face_boundary[f]], kind[k]);
    });
    return least;
}

std::vector<char> prescribed_nodes(const Mesh& mesh, const BoundaryTarget& target) {
    return nodes_with(mesh, [&](int, std::size_t k) { return is_prescribed(target.kind[k]); });
}

std::vector<char> held_nodes(const Mesh& mesh, const BoundaryTarget& target) {
    return nodes_with(mesh, [&](int, std::size_t k) { return target.kind[k] != NodeKind::free; });
}

std::vector<char> freed_nodes(const Mesh& mesh, const BoundaryTarget& target) {
    return nodes_with(mesh, [&](int, std::size_t k) { return target.is_freed(k); });
}

void free_nodes(const Mesh& mesh, const std::vector<char>& chosen, BoundaryTarget& target) {
    for (std::size_t k = 0; k < mesh.faces.size(); ++k)
        if (chosen[mesh.faces[k]] && is_prescribed(target.kind[k])) target.kind[k] = NodeKind::slides;
}

bool BoundaryTarget::frees() const {
    for (std::size_t k = 0; k < kind.size(); ++k)
        if (is_freed(k)) return true;
    return false;
}

bool BoundaryTarget::slides(const Mesh& mesh, int f) const {
    const auto first = kind.begin() + mesh.face_start(f);
    return std::find(first, first + mesh.face_nodes(f), NodeKind::slides) != first + mesh.face_nodes(f);
}

bool BoundaryTarget::prescribes(const Mesh& mesh, int f) const {
    const auto first = kind.begin() + mesh.face_start(f);
    return std::all_of(first, first + mesh.face_nodes(f), is_prescribed);
}

bool BoundaryTarget::prescribes_all() const { return std::all_of(kind.begin(), kind.end(), is_prescribed); }

}  // namespace almesh
