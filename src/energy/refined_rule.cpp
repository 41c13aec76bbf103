// A piece is bisected `dim` times across its longest edge, each time the half that has the position.
#include "energy/refined_rule.hpp"

#include <algorithm>
#include <cmath>

#include "linalg/dense_solve.hpp"

namespace almesh {
namespace {

double barrier_weight(double volume, int dim) { return dim == 3 ? std::pow(volume, 4.0 / 9) : volume; }

// The least of the barycentric coordinates c of `at` with respect to a piece that was made by bisections, which is
// negative outside: sum_k c_k corner_k = at. 0 for one so small that its corners are one point to rounding.
double inside(const std::array<Barycentric, 4>& corner, int dim, const Barycentric& at) {
    std::vector<double> A, c;
    for (int i = 0; i <= dim; ++i)
        for (int k = 0; k <= dim; ++k) A.push_back(corner[k][i]);
    const bool solved = solve_dense(std::move(A), {at.begin(), at.begin() + dim + 1}, c, 0);
    return solved ? *std::min_element(c.begin(), c.end()) : 0;
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

ElementRule RefinedRule::element(int degree, const Quadrature& rule) const {
    Quadrature all{dim_, 0, {}, {}};
    std::vector<double> volume;
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
            volume.push_back(piece.volume * rule.weight[q]);
            ++all.count;
        }
    }
    return {reference_element(degree, all), std::move(volume)};
}

}  // namespace almesh
