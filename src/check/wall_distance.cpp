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
#include "base/index.hpp"
#include "base/parallel.hpp"
#include "geometry/patch.hpp"

namespace almesh {
namespace {

constexpr double flatness = 0.05;        // deviation of a patch over its size, below which it is not bisected
constexpr int max_depth = 8;             // bisections of a face
constexpr int max_newton_steps = 50;
constexpr int max_halvings = 30;         // of a step, until the distance decreases
constexpr double at_bound = 1e-12;       // barycentric coordinates below this are 0
constexpr double regularisation = 1e-8;  // relative, of the diagonal of c_i . c_j, which is singular on flat triangles
constexpr double node_work = 1e3;        // simple operations to find the distance of one node, at least

void append_nearly_flat(const Bernstein& basis, const Patch& patch, int depth, std::vector<Patch>& patches) {
    if (depth == max_depth || deviation(basis, patch) <= flatness * size_of(patch, basis.dim)) {
        patches.push_back(patch);
        return;
    }
    const auto [a, b] = longest_side(patch, basis.dim);
    const auto [near_a, near_b] = bisect(basis, patch, a, b);
    append_nearly_flat(basis, near_a, depth + 1, patches);
    append_nearly_flat(basis, near_b, depth + 1, patches);
}

// Patches of degree p, expanded to second order by de Casteljau's algorithm, all steps but the last two at once:
//
//     c = sum_k l_k c_k,   c_k = sum_j l_j c_kj,   c_kj = sum_a B_a(l) b_{a + e_k + e_j},   |a| = p - 2.
//
// Differences of the c_k times p, and of the c_kj times p (p - 1), are derivatives of c. For p = 1, c_kj = b_{e_k}.
struct DeCasteljau {
    int corners, degree;
    Bernstein basis;         // of degree p - 2
    std::vector<int> place;  // basis.count x corners x corners: of a + e_k + e_j among the indices of degree p

    DeCasteljau(int m, int p) : corners(m + 1), degree(p), basis(m, std::max(p - 2, 0)) {
        const Bernstein all(m, p);
        for (const MultiIndex& a : basis.index)
            for (int k = 0; k < corners; ++k)
                for (int j = 0; j < corners; ++j) {
                    MultiIndex b = a;
                    ++b[k];
                    if (p > 1) ++b[j];
                    place.push_back(all.find(b));
                }
    }
};

// Of c - x rather than c, so that no digits are lost near the wall.
struct Levels {
    Vec<3> r{}, first[3] = {}, second[3][3] = {};  // c - x, c_k - x, c_kj - x
};

Levels evaluate(const DeCasteljau& form, const Patch& patch, const Vec<3>& x, const Vec<3>& l) {
    Levels c;
    const int* place = form.place.data();
    for (int a = 0; a < form.basis.count; ++a) {
        double B = form.basis.multinomial[a];
        for (int k = 0; k < form.corners; ++k)
            for (int s = 0; s < form.basis.index[a][k]; ++s) B *= l[k];
        for (int k = 0; k < form.corners; ++k)
            for (int j = 0; j < form.corners; ++j) c.second[k][j] = c.second[k][j] + B * (patch[*place++] - x);
    }
    for (int k = 0; k < form.corners; ++k) {
        for (int j = 0; j < form.corners; ++j) c.first[k] = c.first[k] + l[j] * c.second[k][j];
        c.r = c.r + l[k] * c.first[k];
    }
    return c;
}

struct NewtonStep {
    Vec<3> dl{};          // of the barycentric coordinates, sums to zero; does not leave the patch at once
    double decrease = 0;  // of |c - x|^2 / 2 to first order; not a number where the patch is a point
};

NewtonStep newton_step(const DeCasteljau& form, const Levels& c, const Vec<3>& l) {
    // The largest coordinate, o, is one minus the others, v. On a curve v[1] is o again, and does not move.
    const int n = form.corners, p = form.degree;
    const int o = static_cast<int>(std::max_element(l.begin(), l.end()) - l.begin());
    const int v[2] = {(o + 1) % n, (o + 2) % n};
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
    NewtonStep step;
    for (int i = 0; i < 2; ++i) {
        const double d = -(inverse_H[i][0] * g[0] + inverse_H[i][1] * g[1]);
        step.dl[v[i]] += d;
        step.dl[o] -= d;
        step.decrease -= g[i] * d;
    }
    return step;
}

// By descent from the middle of the patch.
double squared_distance(const DeCasteljau& form, const Patch& patch, const Vec<3>& x) {
    Vec<3> l{};
    std::fill_n(l.begin(), form.corners, 1.0 / form.corners);
    Levels c = evaluate(form, patch, x, l);
    for (int newton = 0; newton < max_newton_steps; ++newton) {
        const NewtonStep step = newton_step(form, c, l);
        if (!(step.decrease > std::numeric_limits<double>::epsilon() * dot(c.r, c.r))) break;  // the rest is rounding
        double length = 1;  // up to where the step leaves the patch
        for (int k = 0; k < 3; ++k)
            if (l[k] + step.dl[k] < 0) length = std::min(length, -l[k] / step.dl[k]);
        Levels trial;
        Vec<3> next;
        bool decreased = false;
        for (int halving = 0; !decreased && halving < max_halvings; ++halving, length *= 0.5) {
            next = l + length * step.dl;
            for (double& l_k : next) l_k = l_k < at_bound ? 0 : l_k;
            trial = evaluate(form, patch, x, next);
            decreased = dot(trial.r, trial.r) < dot(c.r, c.r);
        }
        if (!decreased) break;
        l = next;
        c = trial;
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
        const Patch face = make_patch(basis, face_positions(mesh, x, f).data(), mesh.dim);
        append_nearly_flat(basis.bernstein, face, 0, patches);
        for (int i = 0; i < mesh.face_nodes(); ++i) on_wall[mesh.face(f)[i]] = 1;
    }
    if (patches.empty())
        throw InputError("wall distance: boundary " + mesh.boundaries[boundary] + " has no faces; name another one");
    std::vector<Box> boxes;
    for (const Patch& patch : patches) boxes.push_back(box_of(patch));
    const BoxTree tree(boxes);
    const DeCasteljau form(m, mesh.degree);

    std::vector<double> distance(mesh.nodes(), 0.0);
    parallel_for(mesh.nodes(), [&](int i) {
        if (on_wall[i]) return;
        Vec<3> position{};
        std::copy_n(point(x, i, mesh.dim), mesh.dim, position.begin());
        const auto squared = [&](int k) { return squared_distance(form, patches[k], position); };
        distance[i] = std::sqrt(tree.nearest_squared(position.data(), mesh.dim, squared));
    }, node_work);
    return distance;
}

}  // namespace almesh
