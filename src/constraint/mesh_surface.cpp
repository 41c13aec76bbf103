// The faces of a mesh as a surface. With X the map of a face from its reference triangle (2D: interval) and n the
// interpolated normal, not normalised, the closest-point projection of x is the root of
//
//     X(xi) + d n(xi) = x
//
// by Newton's method from the closest point of the faces; where xi leaves its face, in the neighbour on that side.
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "base/index.hpp"
#include "constraint/surface.hpp"
#include "geometry/closest_point.hpp"
#include "mesh/lagrange.hpp"
#include "mesh/sides.hpp"

namespace almesh {
namespace {

Vec<3> value(const Bernstein& basis, const std::vector<Vec<3>>& c, const Barycentric& l) {
    Vec<3> sum{};
    for (int a = 0; a < basis.count; ++a) {
        double B = basis.multinomial[a];
        for (int k = 0; k <= basis.dim; ++k) B *= std::pow(l[k], basis.index[a][k]);
        sum = sum + B * c[a];
    }
    return sum;
}

// In 3D cubic faces in place of flat ones, through the same corners and there perpendicular to the mean normals n, so
// that they meet smoothly, or nearly so: flat ones would hold up nodes at the edges between them (A. Vlachos,
// J. Peters, C. Boyd, J. L. Mitchell, Curved PN triangles, I3D 2001). The edge to x_j leaves x_i along v - (v . n_i) n_i,
// v = x_j - x_i.
struct CubicFaces {
    std::vector<Patch> patches;
    std::vector<std::vector<int>> node;

    CubicFaces(const Bernstein& cubic, const std::vector<Patch>& flat, const std::vector<std::vector<int>>& corner) {
        const int m = cubic.dim;
        std::map<int, Vec<3>> normal;
        for (std::size_t f = 0; f < flat.size(); ++f)
            for (const int i : corner[f]) normal[i] = normal[i] + unit(flat_normal(flat[f], m));
        std::map<std::array<int, 2>, int> on_edge;  // nodes: near the first of its ends
        int next = normal.rbegin()->first + 1;
        for (std::size_t f = 0; f < flat.size(); ++f) {
            Patch patch(cubic.count, Vec<3>{});
            std::vector<int> nodes(cubic.count);
            Vec<3> edges{}, corners{};
            for (int a = 0; a <= m; ++a) {
                patch[a] = flat[f][a];
                nodes[a] = corner[f][a];
                corners = corners + 1.0 / (m + 1) * patch[a];
                const Vec<3> n = unit(normal[nodes[a]]);
                for (int b = 0; b <= m; ++b) {
                    if (a == b) continue;
                    MultiIndex index{};
                    index[a] = 2, index[b] = 1;
                    const int place = cubic.place(index);
                    const Vec<3> along = flat[f][b] - flat[f][a];
                    patch[place] = patch[a] + 1.0 / 3 * (along - dot(along, n) * n);
                    edges = edges + 1.0 / 6 * patch[place];
                    const auto [at, is_new] = on_edge.insert({{nodes[a], corner[f][b]}, next});
                    nodes[place] = at->second;
                    next += is_new;
                }
            }
            patch[cubic.place({1, 1, 1, 0})] = edges + 0.5 * (edges - corners);
            nodes[cubic.place({1, 1, 1, 0})] = next++;
            patches.push_back(std::move(patch));
            node.push_back(std::move(nodes));
        }
    }
};

// In 2D cubic splines in place of flat faces: through the same corners, with s the length along the chords h, and
// continuous second derivatives M = X_ss, so that Newton's method sees one smooth curve,
//
//     h_f M_f + 2 (h_f + h_g) M + h_g M_g = 6 ((X_f - X) / h_f + (X_g - X) / h_g)
//
// at the corner X of the faces f and g, M_f and X_f at the other end of f; solved by the Gauss-Seidel method. Where a
// curve ends, or has a kink, M is that of the face's other end.
struct SplineFaces {
    std::vector<Patch> patches;
    std::vector<double> chord;

    SplineFaces(const std::vector<Patch>& flat, const std::vector<std::vector<int>>& corner) {
        constexpr int sweeps = 60;  // each of which halves the error, or more
        constexpr double kink = 0.5;  // cosine of the angle
        struct End { int face, corner; };
        std::map<int, std::vector<End>> ends;  // of faces at a node
        for (int f = 0; f < static_cast<int>(flat.size()); ++f) {
            chord.push_back(length(flat[f][1] - flat[f][0]));
            for (const int end : {0, 1}) ends[corner[f][end]].push_back({f, end});
        }
        std::vector<std::array<Vec<3>, 2>> M(flat.size());
        const auto to_other = [&](const End& at) { return flat[at.face][1 - at.corner] - flat[at.face][at.corner]; };
        for (int sweep = 0; sweep < sweeps; ++sweep)
            for (const auto& [node, at] : ends) {
                for (const End& end : at) M[end.face][end.corner] = M[end.face][1 - end.corner];
                if (at.size() != 2) continue;
                const Vec<3> to_f = to_other(at[0]), to_g = to_other(at[1]);
                const double f = length(to_f), g = length(to_g);
                if (-dot(to_f, to_g) <= kink * f * g) continue;
                M[at[0].face][at[0].corner] = M[at[1].face][at[1].corner] =
                    0.5 / (f + g) * (6 / f * to_f + 6 / g * to_g - f * M[at[0].face][1 - at[0].corner] -
                                     g * M[at[1].face][1 - at[1].corner]);
            }
        for (std::size_t f = 0; f < flat.size(); ++f) {
            const Vec<3>&X = flat[f][0], &Y = flat[f][1];
            const double c = chord[f] * chord[f] / 18;
            patches.push_back({X, Y, X + 1.0 / 3 * (Y - X) - c * (2 * M[f][0] + M[f][1]),
                               Y - 1.0 / 3 * (Y - X) - c * (M[f][0] + 2 * M[f][1])});
        }
    }
};

class MeshSurface final : public Surface {
public:
    // chord: of splines, per patch; or empty.
    MeshSurface(const PatchBasis& basis, const std::vector<Patch>& patches, const std::vector<std::vector<int>>& node,
                const std::vector<double>& chord = {})
        : m_(basis.bernstein.dim), closest_(basis, patches), lagrange_(m_, basis.bernstein.degree) {
        for (std::size_t f = 0; f < patches.size(); ++f) {
            std::array<int, 3> corners{-1, -1, -1};
            std::copy_n(node[f].begin(), m_ + 1, corners.begin());
            corner_.push_back(corners);
        }
        const PatchNormal normal(m_, basis.bernstein.degree);
        for (std::size_t f = 0; f < patches.size(); ++f)
            for (const MultiIndex& index : lagrange_.nodes) {
                Barycentric l{};
                for (int k = 0; k <= m_; ++k) l[k] = static_cast<double>(index[k]) / lagrange_.degree;
                position_.push_back(value(basis.bernstein, patches[f], l));
                if (!chord.empty())
                    normal_.push_back(1 / chord[f] * value(normal.basis, normal.coefficients(patches[f]), l));
            }
        if (chord.empty()) average_normals(normal, patches, node);
        find_neighbours();
    }

    SurfacePoint closest(const Vec<3>& x) const override {
        constexpr int most_faces = 12;
        constexpr double beyond_rim = 1;  // xi may go on by that much where the surface ends
        const ClosestPoint::Place closest = closest_.find(x);
        int patch = closest.patch;
        Root start{{closest.at[1], m_ == 2 ? closest.at[2] : 0}, 0};
        const Expansion there = expand(patch, start.xi);
        start.d = dot(x - there.X, there.n) / std::max(dot(there.n, there.n), 1e-30);
        for (int faces = 0; faces < most_faces; ++faces) {
            const std::optional<Root> root = solve(patch, x, start);
            if (!root) break;
            const int side = left_through(*root);
            const int next = side < 0 ? -1 : neighbour_[patch][side];
            const bool near = std::abs(root->xi[0]) + std::abs(root->xi[1]) < 1 + beyond_rim;
            if (next < 0 && near) return projection_at(patch, *root);
            if (next < 0) break;
            start = *root;
            enter(patch, next, start);
            patch = next;
        }
        // No normal leads there: beyond the rim, or from far away. The closest point.
        const Vec<3> n = unit(length(x - closest.position) > 0 ? x - closest.position : there.n);
        return almesh::projection_at(x, closest.position, n, {});
    }

    std::string name() const override { return "the mesh's own faces"; }

private:
    // At xi of a face: X, n and their derivatives.
    struct Expansion {
        Vec<3> X{}, n{}, X_xi[2] = {}, n_xi[2] = {};
    };
    struct Root {
        double xi[2];
        double d;
    };

    int m_;  // parameters of a face
    ClosestPoint closest_;
    LagrangeBasis lagrange_;
    std::vector<Vec<3>> position_, normal_;        // patch x node
    std::vector<std::array<int, 3>> corner_;       // per patch: numbers of its corners
    std::vector<std::array<int, 3>> neighbour_;    // per patch: across the side opposite to each corner; -1: none

    void average_normals(const PatchNormal& normal, const std::vector<Patch>& patches,
                         const std::vector<std::vector<int>>& node) {
        std::map<int, Vec<3>> mean;
        for (std::size_t f = 0; f < patches.size(); ++f) {
            const std::vector<Vec<3>> n = normal.coefficients(patches[f]);
            const Vec<3> flat = flat_normal(patches[f], m_);
            for (int i = 0; i < lagrange_.count; ++i) {
                Barycentric l{};
                for (int k = 0; k <= m_; ++k) l[k] = static_cast<double>(lagrange_.nodes[i][k]) / lagrange_.degree;
                Vec<3>& sum = mean[node[f][i]];
                const Vec<3> at = value(normal.basis, n, l);
                sum = sum + unit(dot(at, flat) > 0 ? at : flat);  // of a face that is folded there
            }
        }
        for (const std::vector<int>& of_face : node)
            for (const int i : of_face) normal_.push_back(unit(mean[i]));
    }

    void find_neighbours() {
        const int sides_of_face = m_ + 1;
        std::vector<Side> sides;
        for (int f = 0; f < static_cast<int>(corner_.size()); ++f)
            for (int opposite = 0; opposite <= m_; ++opposite)
                sides.push_back(side_of_cell(simplex(m_), corner_[f].data(), opposite, sides_of_face * f + opposite));
        neighbour_.assign(corner_.size(), {-1, -1, -1});
        for_equal_sides(sides, [&](std::span<const Side> equal) {
            const int first = equal[0].number;
            for (const Side& other : equal.subspan(1)) {
                neighbour_[other.number / sides_of_face][other.number % sides_of_face] = first / sides_of_face;
                neighbour_[first / sides_of_face][first % sides_of_face] = other.number / sides_of_face;
            }
        });
    }

    Expansion expand(int patch, const double* xi) const {
        constexpr int most = simplex_node_count(2, 2 * max_degree);
        double N[most], dN[2 * most];
        lagrange_.values(xi, N);
        lagrange_.gradients(xi, dN);
        Expansion at;
        for (int i = 0; i < lagrange_.count; ++i) {
            const std::size_t at_i = offset(patch, lagrange_.count, i);
            const Vec<3>&X = position_[at_i], &n = normal_[at_i];
            at.X = at.X + N[i] * X;
            at.n = at.n + N[i] * n;
            for (int k = 0; k < m_; ++k) {
                at.X_xi[k] = at.X_xi[k] + dN[i * m_ + k] * X;
                at.n_xi[k] = at.n_xi[k] + dN[i * m_ + k] * n;
            }
        }
        return at;
    }

    // Columns: the derivatives of X + d n with respect to xi and d; in 2D a third of e_z.
    Mat<3> jacobian(const Expansion& at, double d) const {
        Mat<3> J;
        const Vec<3> last = m_ == 1 ? Vec<3>{0, 0, 1} : at.n;
        for (int i = 0; i < 3; ++i) {
            J[i][0] = at.X_xi[0][i] + d * at.n_xi[0][i];
            J[i][1] = m_ == 1 ? at.n[i] : at.X_xi[1][i] + d * at.n_xi[1][i];
            J[i][2] = last[i];
        }
        return J;
    }

    // Newton's method; nothing where it does not converge, or only far outside the face.
    std::optional<Root> solve(int patch, const Vec<3>& x, Root root) const {
        constexpr int steps = 25;
        constexpr double longest_step = 0.5, farthest = 4, tolerance = 1e-14;
        for (int step = 0; step < steps; ++step) {
            const Expansion at = expand(patch, root.xi);
            const Mat<3> J = jacobian(at, root.d);
            if (!(std::abs(determinant(J)) > 0)) return std::nullopt;
            const Vec<3> change = times(inverse<3>(J), x - at.X - root.d * at.n);
            const double of_xi = std::max(std::abs(change[0]), m_ == 2 ? std::abs(change[1]) : 0);
            const double t = std::min(1.0, longest_step / std::max(of_xi, longest_step));
            for (int k = 0; k < m_; ++k) root.xi[k] += t * change[k];
            root.d += t * change[m_];
            if (!(std::abs(root.xi[0]) + std::abs(root.xi[1]) < farthest)) return std::nullopt;
            if (of_xi <= tolerance) return root;
        }
        return root;
    }

    // The corner opposite to the side through which xi has left the face; -1 where it is inside.
    int left_through(const Root& root) const {
        constexpr double tolerance = 1e-12;
        const double l[3] = {1 - root.xi[0] - (m_ == 2 ? root.xi[1] : 0), root.xi[0], m_ == 2 ? root.xi[1] : 1};
        const int least = static_cast<int>(std::min_element(l, l + m_ + 1) - l);
        return l[least] < -tolerance ? least : -1;
    }

    // xi at the middle of the face `patch`; where it has the corners of `from`, their coordinates.
    void enter(int from, int patch, Root& root) const {
        const double l[3] = {1 - root.xi[0] - (m_ == 2 ? root.xi[1] : 0), root.xi[0], m_ == 2 ? root.xi[1] : 0};
        double inside[3] = {0.05, 0.05, 0.05}, sum = 0;
        for (int k = 0; k <= m_; ++k) {
            for (int c = 0; c <= m_; ++c)
                if (corner_[patch][k] == corner_[from][c]) inside[k] = std::max(0.0, l[c]);
            sum += inside[k];
        }
        for (int k = 0; k < m_; ++k) root.xi[k] = inside[k + 1] / sum;
    }

    // Of the unit normal along the surface, symmetrised.
    Mat<3> curvature(const Expansion& at) const {
        const Vec<3> n = unit(at.n);
        Mat<3> frame = jacobian(at, 0);
        for (int i = 0; i < 3; ++i) frame[i][m_] = n[i];
        const Mat<3> dual = inverse<3>(frame);
        Mat<3> S{};
        for (int k = 0; k < m_; ++k) {
            const Vec<3> turn = 1 / length(at.n) * (at.n_xi[k] - dot(at.n_xi[k], n) * n);
            const Vec<3> along = dual[k] - dot(dual[k], n) * n;
            for (int i = 0; i < 3; ++i)
                for (int j = 0; j < 3; ++j) S[i][j] += 0.5 * (turn[i] * along[j] + along[i] * turn[j]);
        }
        return S;
    }

    SurfacePoint projection_at(int patch, const Root& root) const {
        const Expansion at = expand(patch, root.xi);
        const Mat<3> inverse_J = inverse<3>(jacobian(at, root.d));
        SurfacePoint projection{at.X, unit(at.n), {}, curvature(at)};
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) {
                projection.slope[i][j] = i == j;
                for (int k = 0; k < m_; ++k) projection.slope[i][j] -= at.X_xi[k][i] * inverse_J[k][j];
            }
        return projection;
    }
};

}  // namespace

std::unique_ptr<Surface> surface_of_faces(const PatchBasis& basis, const std::vector<Patch>& patches,
                                          const std::vector<std::vector<int>>& node, bool rounds) {
    if (basis.bernstein.degree > 1 || !rounds) return std::make_unique<MeshSurface>(basis, patches, node);
    const PatchBasis cubic(basis.bernstein.dim, 3);
    if (cubic.bernstein.dim == 1) {
        const SplineFaces faces(patches, node);
        return std::make_unique<MeshSurface>(cubic, faces.patches, node, faces.chord);
    }
    const CubicFaces faces(cubic.bernstein, patches, node);
    return std::make_unique<MeshSurface>(cubic, faces.patches, faces.node);
}

}  // namespace almesh
