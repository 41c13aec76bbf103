// The faces of the wall are bisected into nearly flat patches c(l), l >= 0 the barycentric coordinates. On each patch
// whose box is nearer to x than the best distance so far, |c(l) - x|^2 / 2 is minimised by Newton's method with the
// set of active bounds l_k = 0 (Nocedal & Wright, Numerical Optimization, 1999, ch. 16.4): with r = c - x and the
// derivatives c_i, c_ij of c along two free coordinates,
//
//     gradient g_i = c_i . r,   Hessian H_ij = c_i . c_j + r . c_ij,   its first term alone where it is not definite.
#include "check/wall_distance.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.hpp"
#include "base/parallel.hpp"
#include "geometry/patch.hpp"

namespace almesh {
namespace {

constexpr double flatness = 0.05;        // deviation of a patch over its size, below which it is not bisected
constexpr int max_depth = 8;             // bisections of a face
constexpr int max_trials = 200;          // Newton steps and halvings of them
constexpr double at_bound = 1e-12;       // barycentric coordinates below this are 0
constexpr double regularisation = 1e-8;  // relative, of the diagonal of c_i . c_j, which is singular on flat triangles
constexpr double node_work = 1e3;        // simple operations to find the distance of one node, at least

void append_nearly_flat(const Bernstein& basis, const Patch& patch, int depth, std::vector<Patch>& patches) {
    if (depth == max_depth || deviation(basis, patch) <= flatness * size_of(patch, basis.dim)) {
        patches.push_back(patch);
        return;
    }
    const auto [a, b] = longest_edge(patch, basis.dim);
    const auto [near_a, near_b] = bisect(basis, patch, a, b);
    append_nearly_flat(basis, near_a, depth + 1, patches);
    append_nearly_flat(basis, near_b, depth + 1, patches);
}

// A patch at l, expanded to second order by de Casteljau's algorithm, all steps but the last two at once:
//
//     c = sum_k l_k c_k,   c_k = sum_j l_j c_kj,   c_kj = sum_a B_a(l) b_{a + e_k + e_j},   |a| = p - 2.
//
// Differences of the c_k times p, and of the c_kj times p (p - 1), are derivatives of c. All relative to x, so that no
// digits are lost near the wall.
struct Expansion {
    Vec<3> r{}, first[3] = {}, second[3][3] = {};  // c - x, c_k - x, c_kj - x
};

struct SecondOrderForm {
    int corners, degree;
    Bernstein basis;         // of degree p - 2
    std::vector<int> place;  // basis.count x corners x corners: of a + e_k + e_j among the indices of degree p

    SecondOrderForm(int m, int p) : corners(m + 1), degree(p), basis(m, std::max(p - 2, 0)) {
        const std::vector<int> raised_twice = raised_places(m, p - 1);
        for (int i : raised_places(m, basis.degree))
            for (int j = 0; j < corners; ++j)  // c_kj = b_{e_k} on flat patches
                place.push_back(p == 1 ? i : raised_twice[i * corners + j]);
    }
};

Expansion expand(const SecondOrderForm& form, const Patch& patch, const Vec<3>& x, const Vec<3>& l) {
    const int corners = form.corners;
    Expansion c;
    const int* to = form.place.data();
    for (int a = 0; a < form.basis.count; ++a) {
        double B = form.basis.multinomial[a];
        for (int k = 0; k < corners; ++k)
            for (int s = 0; s < form.basis.index[a][k]; ++s) B *= l[k];
        for (int k = 0; k < corners; ++k)
            for (int j = 0; j < corners; ++j) c.second[k][j] = c.second[k][j] + B * (patch[*to++] - x);
    }
    for (int k = 0; k < corners; ++k) {
        for (int j = 0; j < corners; ++j) c.first[k] = c.first[k] + l[j] * c.second[k][j];
        c.r = c.r + l[k] * c.first[k];
    }
    return c;
}

// Change of the barycentric coordinates, up to where it leaves the patch; sums to zero. decrease: of |c - x|^2 / 2 by
// the whole step to first order; not a number where the patch is a point.
Vec<3> newton_step(const SecondOrderForm& form, const Expansion& c, const Vec<3>& l, double& decrease) {
    // The largest coordinate, o, is one minus the others, v. On a curve v[1] is o again, and does not move.
    const int p = form.degree, o = static_cast<int>(std::max_element(l.begin(), l.end()) - l.begin());
    const int v[2] = {(o + 1) % form.corners, (o + 2) % form.corners};
    const Vec<3> tangent[2] = {p * (c.first[v[0]] - c.first[o]), p * (c.first[v[1]] - c.first[o])};
    Vec<2> g = {dot(tangent[0], c.r), dot(tangent[1], c.r)};
    Mat<2> H{}, gauss_newton{};
    for (int i = 0; i < 2; ++i)
        for (int j = 0; j < 2; ++j) {
            // At a bound the two coordinates step independently: neither makes the other leave the patch.
            if (i != j && (l[v[0]] == 0 || l[v[1]] == 0)) continue;
            const Vec<3> second = c.second[v[i]][v[j]] - c.second[v[i]][o] - (c.second[o][v[j]] - c.second[o][o]);
            gauss_newton[i][j] = dot(tangent[i], tangent[j]);
            H[i][j] = gauss_newton[i][j] + p * (p - 1) * dot(c.r, second);
        }
    for (int i = 0; i < 2; ++i) {
        gauss_newton[i][i] *= 1 + regularisation;
        if (v[i] != o && (l[v[i]] > 0 || g[i] < 0)) continue;
        g[i] = 0;  // active: stays where it is
        H[i][i] = gauss_newton[i][i] = 1;
    }
    const Mat<2> inverse_H = inverse<2>(H[0][0] > 0 && determinant(H) > 0 ? H : gauss_newton);
    Vec<3> step{};
    decrease = 0;
    for (int i = 0; i < 2; ++i) {
        const double d = -(inverse_H[i][0] * g[0] + inverse_H[i][1] * g[1]);
        step[v[i]] += d;
        step[o] -= d;
        decrease -= g[i] * d;
    }
    double inside = 1;  // part of the step inside the patch
    for (int k = 0; k < 3; ++k)
        if (l[k] + step[k] < 0) inside = std::min(inside, -l[k] / step[k]);
    return inside * step;
}

// By descent from the middle of the patch.
double squared_distance(const SecondOrderForm& form, const Patch& patch, const Vec<3>& x) {
    Vec<3> l{};
    std::fill_n(l.begin(), form.corners, 1.0 / form.corners);
    Expansion c = expand(form, patch, x, l);
    double decrease;
    Vec<3> step = newton_step(form, c, l, decrease);
    for (int trial = 0; trial < max_trials; ++trial) {
        if (!(decrease > std::numeric_limits<double>::epsilon() * dot(c.r, c.r))) break;  // the rest is rounding
        Vec<3> next = l + step;
        for (double& l_k : next) l_k = l_k < at_bound ? 0 : l_k;
        const Expansion at_next = expand(form, patch, x, next);
        if (dot(at_next.r, at_next.r) < dot(c.r, c.r)) {
            l = next;
            c = at_next;
            step = newton_step(form, c, l, decrease);
        } else {
            step = 0.5 * step;
            decrease *= 0.5;
        }
    }
    return dot(c.r, c.r);
}

}  // namespace

std::vector<double> wall_distance(const Mesh& mesh, const std::vector<double>& x, int boundary) {
    const int m = mesh.dim - 1;
    const PatchBasis basis(m, mesh.degree);
    std::vector<Patch> patches;
    std::vector<char> on_wall(mesh.nodes(), 0);
    for (int f = 0; f < mesh.face_count(); ++f) {
        if (mesh.face_boundary[f] != boundary) continue;
        append_nearly_flat(basis.bernstein, face_patch(basis, mesh, x, f), 0, patches);
        for (int i = 0; i < mesh.face_nodes(); ++i) on_wall[mesh.face(f)[i]] = 1;
    }
    if (patches.empty())
        throw InputError("wall distance: boundary ", mesh.boundaries[boundary], " has no faces; name another one");
    const BoxTree tree = tree_of_boxes(patches);
    const SecondOrderForm form(m, mesh.degree);

    std::vector<double> distance(mesh.nodes(), 0.0);
    parallel_for(mesh.nodes(), [&](int i) {
        if (on_wall[i]) return;
        const Vec<3> position = positions(mesh, x, &i, 1)[0];
        distance[i] = std::sqrt(tree.nearest_squared(
            position, [&](int k) { return squared_distance(form, patches[k], position); }));
    }, node_work);
    return distance;
}

}  // namespace almesh
