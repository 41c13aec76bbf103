#include "geometry/closest_point.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace almesh {
namespace {

constexpr int max_newton_steps = 50;
constexpr int max_halvings = 30;
constexpr double epsilon = std::numeric_limits<double>::epsilon();

// Step along the direction e (in xi) to the minimum of the model.
double step_along(const std::array<double, 2>& g, const std::array<double, 3>& H, double e0, double e1) {
    const double curvature = e0 * e0 * H[0] + 2 * e0 * e1 * H[1] + e1 * e1 * H[2];
    return curvature > 0 ? -(e0 * g[0] + e1 * g[1]) / curvature : 0;
}

// Cuts the step where it leaves the face; the coordinate that ends it becomes zero exactly.
void keep_on_face(const Barycentric& l, Barycentric& step) {
    double length = 1;
    int hit = -1;
    for (int k = 0; k < 3; ++k)
        if (l[k] + length * step[k] < 0) {
            length = -l[k] / step[k];
            hit = k;
        }
    for (double& s : step) s *= length;
    if (hit >= 0) step[hit] = -l[hit];
}

}  // namespace

FaceProjector::FaceProjector(int m, int degree) : m_(m), degree_(degree), count_(simplex_node_count(m, degree)) {
    for (int d = 0; d < degree; ++d) raised_.push_back(raised_places(m, d));
}

// De Casteljau's averages; the last two levels before the value give the derivatives.
FaceProjector::Jet FaceProjector::evaluate(const Vec<3>* control, const Vec<3>& x, const Barycentric& l,
                                          std::vector<Vec<3>>& work) const {
    const int m = m_, p = degree_;
    const Vec<3>* at = control;  // the level of degree d
    Vec<3> *next = work.data(), *spare = work.data() + count_;
    Jet jet{};
    for (int d = p; d > 0; --d) {
        if (d == 2) {  // Gmsh order: corners 0, 1(, 2), then the edges 01(, 12, 20)
            const auto second = [&](int ab, int a, int b) {
                Vec<3> s;
                for (int c = 0; c < 3; ++c) s[c] = p * (p - 1) * (at[ab][c] - at[a][c] - at[b][c] + at[0][c]);
                return s;
            };
            if (m == 1) jet.second[0] = second(1, 2, 2);
            else jet.second = {second(1, 3, 3), second(4, 3, 5), second(2, 5, 5)};
        }
        if (d == 1)
            for (int k = 0; k < m; ++k)
                for (int c = 0; c < 3; ++c) jet.first[k][c] = p * (at[k + 1][c] - at[0][c]);
        const std::vector<int>& raised = raised_[d - 1];
        const int below = static_cast<int>(raised.size()) / (m + 1);
        for (int i = 0; i < below; ++i) {
            Vec<3> average{};
            for (int k = 0; k <= m; ++k)
                for (int c = 0; c < 3; ++c) average[c] += l[k] * at[raised[i * (m + 1) + k]][c];
            next[i] = average;
        }
        at = next;
        std::swap(next, spare);
    }
    jet.r = at[0] - x;
    jet.squared = dot(jet.r, jet.r);
    return jet;
}

FaceProjector::Model FaceProjector::model_of(const Jet& jet) const {
    Model model{{dot(jet.r, jet.first[0]), dot(jet.r, jet.first[1])},
                {dot(jet.first[0], jet.first[0]), dot(jet.first[0], jet.first[1]), dot(jet.first[1], jet.first[1])}};
    std::array<double, 3> full = model.H;
    for (int k = 0; k < 3; ++k) full[k] += dot(jet.r, jet.second[k]);
    const bool definite = full[0] > 0 && (m_ == 1 || full[0] * full[2] - full[1] * full[1] > 0);
    if (definite) model.H = full;
    return model;
}

// Step from l, its entries summing to zero, that does not leave the reference face at once; false at a minimum.
bool FaceProjector::feasible_step(const Model& model, const Barycentric& l, Barycentric& step) const {
    const auto leaves = [&](int k) { return l[k] == 0 && step[k] < 0; };
    if (m_ == 1) {
        const double d = step_along(model.g, model.H, 1, 0);
        step = {-d, d, 0};
        return d != 0 && !leaves(0) && !leaves(1);
    }
    const double det = model.H[0] * model.H[2] - model.H[1] * model.H[1];
    if (det > 0) {
        const double d0 = (model.H[1] * model.g[1] - model.H[2] * model.g[0]) / det;
        const double d1 = (model.H[1] * model.g[0] - model.H[0] * model.g[1]) / det;
        step = {-d0 - d1, d0, d1};
        if (!leaves(0) && !leaves(1) && !leaves(2)) return d0 != 0 || d1 != 0;
    }
    Barycentric best{};
    double gained = 0;
    for (int k = 0; k < 3; ++k) {  // along the sides that l lies on; all where the face is degenerate
        if (l[k] != 0 && det > 0) continue;
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        const double d = step_along(model.g, model.H, (j == 1) - (i == 1), (j == 2) - (i == 2));
        step = {};
        step[i] = -d;
        step[j] = d;
        const double gain = -(model.g[0] * step[1] + model.g[1] * step[2]);
        if (gain <= gained || leaves(i) || leaves(j)) continue;
        best = step;
        gained = gain;
    }
    step = best;
    return gained > 0;
}

double FaceProjector::squared_distance(const Vec<3>* control, const Vec<3>& x, Barycentric l,
                                       std::vector<Vec<3>>& work) const {
    Jet jet = evaluate(control, x, l, work);
    for (int newton = 0; newton < max_newton_steps; ++newton) {
        const Model model = model_of(jet);
        Barycentric step{};
        if (!feasible_step(model, l, step)) break;
        keep_on_face(l, step);
        const double slope = -(model.g[0] * step[1] + model.g[1] * step[2]);
        if (slope <= epsilon * jet.squared) break;  // what is left to gain is rounding
        bool decreased = false;
        for (int halving = 0; halving < max_halvings && !decreased; ++halving) {
            Barycentric next;
            for (int k = 0; k < 3; ++k) next[k] = std::max(0.0, l[k] + step[k]);
            const Jet trial = evaluate(control, x, next, work);
            decreased = trial.squared < jet.squared;
            if (decreased) {
                l = next;
                jet = trial;
            }
            for (double& s : step) s *= 0.5;
        }
        if (!decreased) break;
    }
    return jet.squared;
}

}  // namespace almesh
