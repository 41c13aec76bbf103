// A piece is bisected `dim` times across its longest edge, each time the half that has the position.
#include "energy/refined_rule.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/bezier.hpp"
#include "linalg/dense_solve.hpp"

namespace almesh {
RefinedRule::RefinedRule(const CellType& cell) : cell_(&cell), dim_(cell.dim), pieces_{{{}, 1}} {
    for (std::size_t k = 0; k < pieces_[0].corner.size(); ++k) pieces_[0].corner[k][k] = 1;
}

Quadrature RefinedRule::of_pieces(const CellType& cell, int degree, int exactness) {
    if (!cell.is_collapsed) return element_quadrature(cell, degree, exactness);
    return element_quadrature(hexahedron(), degree, 2 + (exactness == 0 ? default_exactness(cell, degree) : exactness));
}

// The least of the barycentric coordinates of `at` with respect to a piece that was made by bisections, which is
// negative outside: sum_k c_k corner_k = at in each factor. 0 for one so small that its corners are one point to
// rounding.
double RefinedRule::inside(const Piece& piece, const CellPoint& at) const {
    double least = 1;
    int first = 0;
    for (const int m : cell_->factors) {
        if (m == 0) break;
        std::vector<double> A, c;
        for (int i = 0; i <= m; ++i)
            for (int k = 0; k <= m; ++k) A.push_back(piece.corner[first + k][first + i]);
        const bool solved = solve_dense(std::move(A), {&at[first], &at[first] + m + 1}, c, 0);
        least = std::min(least, solved ? *std::min_element(c.begin(), c.end()) : 0);
        first += m + 1;
    }
    return least;
}

// Of a pyramid: the mean of 3 (1 - c)^2, which is 1 for the whole.
double RefinedRule::mean_measure(const Piece& piece) const {
    if (!cell_->is_collapsed) return 1;
    const double a = 1 - piece.corner[4][5], b = 1 - piece.corner[5][5];
    return a * a + a * b + b * b;
}

// The first of those.
RefinedRule::Piece* RefinedRule::smallest_around(const CellPoint& at) {
    constexpr double on_side = -1e-9;
    Piece* smallest = nullptr;
    for (Piece& piece : pieces_)
        if ((!smallest || piece.volume < smallest->volume) && inside(piece, at) >= on_side)
            smallest = &piece;
    return smallest;
}

bool RefinedRule::refine(const CellPoint& at, double size) {
    bool changed = false;
    while (static_cast<int>(pieces_.size()) + dim_ <= most_pieces) {
        Piece* const around = smallest_around(at);
        if (!around || (size > 0 && std::pow(around->volume, 1.0 / dim_) <= size)) break;
        Piece half = *around;
        std::vector<Piece> others;
        for (int times = 0; times < dim_; ++times) {
            Piece other = half;
            const auto [a, b] = longest_edge(half.corner, cell_->factors);
            for (std::size_t k = 0; k < half.corner.size(); ++k)
                half.corner[b][k] = other.corner[a][k] = 0.5 * (half.corner[a][k] + half.corner[b][k]);
            half.volume = other.volume = 0.5 * half.volume;
            if (inside(other, at) > inside(half, at)) std::swap(half, other);
            others.push_back(other);
        }
        *around = half;
        pieces_.insert(pieces_.end(), others.begin(), others.end());
        changed = true;
        if (size == 0) break;
    }
    return changed;
}

// At the apex of a pyramid, where the measure is 0, a point weighs as much as on average.
ElementRule RefinedRule::element(int degree, const Quadrature& rule) const {
    Quadrature all{dim_, 0, {}, {}};
    std::vector<double> volume;
    for (const Piece& piece : pieces_) {
        const double mean = mean_measure(piece), part = mean * piece.volume;
        const double barrier = dim_ == 3 ? std::pow(part, 4.0 / 9) : part;
        for (int q = 0; q < rule.count; ++q) {
            const double* of_factor = &rule.xi[q * dim_];
            int first = 0;
            for (const int m : cell_->factors) {
                double rest = 1;
                for (int k = 0; k < m; ++k) rest -= of_factor[k];
                for (int i = first + 1; i <= first + m; ++i) {
                    double xi = rest * piece.corner[first][i];
                    for (int k = 0; k < m; ++k) xi += of_factor[k] * piece.corner[first + k + 1][i];
                    all.xi.push_back(xi);
                }
                of_factor += m;
                first += m + 1;
            }
            double weight = rule.weight[q];
            if (const double above = 1 - all.xi.back(); cell_->is_collapsed)
                weight *= cell_->volume() * (above > 0 ? 3 * above * above / mean : 1);
            all.weight.push_back(barrier * weight);
            volume.push_back(part * weight);
            ++all.count;
        }
    }
    return {reference_element(*cell_, degree, all), std::move(volume)};
}

}  // namespace almesh
