// The patches are bisected into nearly flat pieces c(l), l >= 0 the barycentric coordinates. On each piece whose box is
// nearer to x than the best distance so far, |c(l) - x|^2 / 2 is minimised by Newton's method with the set of active
// bounds l_k = 0 (Nocedal & Wright, Numerical Optimization, 1999, ch. 16.4): with r = c - x and the derivatives c_i,
// c_ij of c along two free coordinates,
//
//     gradient g_i = c_i . r,   Hessian H_ij = c_i . c_j + r . c_ij,   its first term alone where it is not definite.
#include "geometry/closest_point.hpp"

#include <algorithm>
#include <cmath>

namespace almesh {

// A patch at l, expanded to second order by de Casteljau's algorithm, all steps but the last two at once:
//
//     c = sum_k l_k c_k,   c_k = sum_j l_j c_kj,   c_kj = sum_a B_a(l) b_{a + e_k + e_j},   |a| = p - 2.
//
// Differences of the c_k times p, and of the c_kj times p (p - 1), are derivatives of c. All relative to x, so that no
// digits are lost near the patch.
struct ClosestPoint::Expansion {
    Vec<3> r{}, first[3] = {}, second[3][3] = {};  // c - x, c_k - x, c_kj - x
};

struct ClosestPoint::SecondOrderForm {
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

namespace {

constexpr double flatness = 0.05;        // deviation of a patch over its size, below which it is not bisected
constexpr int max_depth = 8;             // bisections of a face
constexpr int max_trials = 200;          // Newton steps and halvings of them
constexpr double at_bound = 1e-12;       // barycentric coordinates below this are 0
constexpr double margin = 1e-8;          // of bounds of distances, relative,
constexpr double least_margin = 1e-12;   // and absolute, of the size of all patches
constexpr double regularisation = 1e-8;  // relative, of the diagonal of c_i . c_j, which is singular on flat triangles

}  // namespace

void ClosestPoint::append_nearly_flat(const Bernstein& basis, const Piece& piece, int depth) {
    if (depth == max_depth || deviation(basis, piece.patch) <= flatness * size_of(piece.patch, basis.dim)) {
        pieces_.push_back(piece);
        return;
    }
    const auto [a, b] = longest_edge(piece.patch, {basis.dim, 0, 0});
    auto [near_a, near_b] = bisect(basis, piece.patch, a, b);
    const Vec<3> middle = 0.5 * (piece.corner[a] + piece.corner[b]);
    Piece half = {std::move(near_a), piece.whole, piece.corner};
    half.corner[b] = middle;
    append_nearly_flat(basis, half, depth + 1);
    half = {std::move(near_b), piece.whole, piece.corner};
    half.corner[a] = middle;
    append_nearly_flat(basis, half, depth + 1);
}

// relative: the patch less x.
ClosestPoint::Expansion ClosestPoint::expand(const Patch& relative, const Vec<3>& l) const {
    const SecondOrderForm& form = *form_;
    const int corners = form.corners;
    const bool is_symmetric = form.degree > 1;  // c_kj = c_jk
    Expansion c;
    const int* to = form.place.data();
    for (int a = 0; a < form.basis.count; ++a) {
        double B = form.basis.multinomial[a];
        for (int k = 0; k < corners; ++k)
            for (int s = 0; s < form.basis.index[a][k]; ++s) B *= l[k];
        for (int k = 0; k < corners; ++k)
            for (int j = is_symmetric ? k : 0; j < corners; ++j)
                c.second[k][j] = c.second[k][j] + B * relative[to[k * corners + j]];
        to += corners * corners;
    }
    for (int k = 1; is_symmetric && k < corners; ++k)
        for (int j = 0; j < k; ++j) c.second[k][j] = c.second[j][k];
    for (int k = 0; k < corners; ++k) {
        for (int j = 0; j < corners; ++j) c.first[k] = c.first[k] + l[j] * c.second[k][j];
        c.r = c.r + l[k] * c.first[k];
    }
    return c;
}

// Change of the barycentric coordinates, up to where it leaves the patch; sums to zero. decrease: of |c - x|^2 / 2 by
// the whole step to first order; not a number where the patch is a point.
Vec<3> ClosestPoint::newton_step(const Expansion& c, const Vec<3>& l, double& decrease) const {
    const SecondOrderForm& form = *form_;
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

// Whether the patch is seen to be farther from x than `distance`, by more than rounding: all its Bezier points are, in
// the direction d.
bool ClosestPoint::is_farther(const Patch& patch, const Vec<3>& x, double distance, const Vec<3>& d) const {
    const double bound = ((1 + margin) * distance + margin_) * length(d);
    return std::all_of(patch.begin(), patch.end(), [&](const Vec<3>& b) { return dot(b - x, d) > bound; });
}

// By descent from the middle of the patch; given up where it is seen to be farther than the nearest point so far.
ClosestPoint::Nearest ClosestPoint::descend(const Patch& patch, const Vec<3>& x, const Nearest& so_far) const {
    const double least = std::sqrt(so_far.squared);
    Vec<3> to_corners{};
    for (int k = 0; k < form_->corners; ++k) to_corners = to_corners + (patch[k] - x);
    if (is_farther(patch, x, least, so_far.r) || is_farther(patch, x, least, to_corners)) return {};
    Patch relative = patch;
    for (Vec<3>& b : relative) b = b - x;
    Vec<3> l{};
    std::fill_n(l.begin(), form_->corners, 1.0 / form_->corners);
    Expansion c = expand(relative, l);
    double decrease;
    Vec<3> step = newton_step(c, l, decrease);
    for (int trial = 0; trial < max_trials; ++trial) {
        if (is_farther(patch, x, least, c.r)) return {};
        if (!(decrease > std::numeric_limits<double>::epsilon() * dot(c.r, c.r))) break;  // the rest is rounding
        Vec<3> next = l + step;
        for (double& l_k : next) l_k = l_k < at_bound ? 0 : l_k;
        const Expansion at_next = expand(relative, next);
        if (dot(at_next.r, at_next.r) < dot(c.r, c.r)) {
            l = next;
            c = at_next;
            step = newton_step(c, l, decrease);
        } else {
            step = 0.5 * step;
            decrease *= 0.5;
        }
    }
    return {dot(c.r, c.r), l, c.r};
}

ClosestPoint::ClosestPoint(const PatchBasis& basis, const std::vector<Patch>& patches)
    : form_(std::make_shared<SecondOrderForm>(basis.bernstein.dim, basis.bernstein.degree)) {
    constexpr std::array<Vec<3>, 3> corner = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    for (std::size_t f = 0; f < patches.size(); ++f)
        append_nearly_flat(basis.bernstein, {patches[f], static_cast<int>(f), corner}, 0);
    std::vector<Box> boxes;
    for (const Piece& piece : pieces_) boxes.push_back(box_of(piece.patch));
    Box whole = boxes[0];
    for (const Box& box : boxes) whole.include(box);
    margin_ = least_margin * length(whole.high - whole.low);
    tree_.emplace(std::move(boxes));
}

ClosestPoint::Place ClosestPoint::find(const Vec<3>& x, const std::function<bool(int patch)>& chosen) const {
    Place place;
    Nearest nearest;
    tree_->nearest_squared(x, [&](int k) {
        const Piece& piece = pieces_[k];
        if (chosen && !chosen(piece.whole)) return nearest.squared;
        const Nearest here = descend(piece.patch, x, nearest);
        if (here.squared < nearest.squared) {
            nearest = here;
            place = {piece.whole, {}, x + here.r, std::sqrt(here.squared)};
            for (int c = 0; c < form_->corners; ++c) place.at = place.at + here.l[c] * piece.corner[c];
        }
        return nearest.squared;
    });
    return place;
}

}  // namespace almesh
