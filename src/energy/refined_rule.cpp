// A piece is bisected `dim` times across its longest edge, each time the half that has the place.
#include "energy/refined_rule.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace almesh {
namespace {

double barrier_weight(double volume, int dim) { return dim == 3 ? std::pow(volume, 4.0 / 9) : volume; }

// Barycentric coordinates of `at` with respect to a piece that was made by bisections: the least of them, which is
// negative outside. Solves sum_k c_k corner_k = at by Gaussian elimination; the entries are small binary fractions.
double inside(const std::array<Barycentric, 4>& corner, int dim, const Barycentric& at) {
    double A[4][5];
    for (int i = 0; i <= dim; ++i) {
        for (int k = 0; k <= dim; ++k) A[i][k] = corner[k][i];
        A[i][dim + 1] = at[i];
    }
    for (int k = 0; k <= dim; ++k) {
        int pivot = k;
        for (int i = k + 1; i <= dim; ++i)
            if (std::abs(A[i][k]) > std::abs(A[pivot][k])) pivot = i;
        std::swap(A[k], A[pivot]);
        for (int i = 0; i <= dim; ++i) {
            if (i == k) continue;
            const double factor = A[i][k] / A[k][k];
            for (int j = k; j <= dim + 1; ++j) A[i][j] -= factor * A[k][j];
        }
    }
    double least = std::numeric_limits<double>::infinity();
    for (int k = 0; k <= dim; ++k) least = std::min(least, A[k][dim + 1] / A[k][k]);
    return least;
}

}  // namespace

RefinedRule::RefinedRule(int dim) : dim_(dim), pieces_{{{}, 1}} {
    for (int k = 0; k <= dim; ++k) pieces_[0].corner[k][k] = 1;
}

// The first of those.
RefinedRule::Piece* RefinedRule::smallest_around(const Barycentric& at) {
    constexpr double on_side = -1e-9;
    Piece* smallest = nullptr;
    for (Piece& piece : pieces_)
        if ((!smallest || piece.volume < smallest->volume) && inside(piece.corner, dim_, at) >= on_side)
            smallest = &piece;
    return smallest;
}

bool RefinedRule::refine(const Barycentric& at, double size) {
    bool changed = false;
    while (static_cast<int>(pieces_.size()) + dim_ <= most_pieces) {
        Piece* const around = smallest_around(at);
        if (!around || (size > 0 && std::pow(around->volume, 1.0 / dim_) <= size)) break;
        Piece half = *around;
        std::vector<Piece> others;
        for (int times = 0; times < dim_; ++times) {
            Piece other = half;
            const auto [a, b] = longest_edge(half.corner, dim_);
            for (int k = 0; k <= dim_; ++k)
                half.corner[b][k] = other.corner[a][k] = 0.5 * (half.corner[a][k] + half.corner[b][k]);
            half.volume = other.volume = 0.5 * half.volume;
            if (inside(other.corner, dim_, at) > inside(half.corner, dim_, at)) std::swap(half, other);
            others.push_back(other);
        }
        *around = half;
        pieces_.insert(pieces_.end(), others.begin(), others.end());
        changed = true;
        if (size == 0) break;
    }
    return changed;
}

ReferenceElement RefinedRule::element(int degree, const Quadrature& rule) const {
    Quadrature all{dim_, 0, {}, {}};
    for (const Piece& piece : pieces_) {
        const double weight = barrier_weight(piece.volume, dim_);
        for (int q = 0; q < rule.count; ++q) {
            double rest = 1;
            for (int k = 0; k < dim_; ++k) rest -= rule.xi[q * dim_ + k];
            for (int i = 1; i <= dim_; ++i) {
                double xi = rest * piece.corner[0][i];
                for (int k = 0; k < dim_; ++k) xi += rule.xi[q * dim_ + k] * piece.corner[k + 1][i];
                all.xi.push_back(xi);
            }
            all.weight.push_back(weight * rule.weight[q]);
            ++all.count;
        }
    }
    return reference_element(degree, all);
}

std::vector<double> RefinedRule::volumes(const Quadrature& rule) const {
    std::vector<double> volumes;
    for (const Piece& piece : pieces_)
        for (const double weight : rule.weight) volumes.push_back(piece.volume * weight);
    return volumes;
}

}  // namespace almesh
