// A piece is bisected `dim` times across its longest edge, each time the half that has the position.
#include "energy/refined_rule.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/bezier.hpp"
#include "linalg/dense_solve.hpp"
#include "mesh/sub_simplices.hpp"

namespace almesh {
namespace {

double barrier_weight(double volume, int dim) { return dim == 3 ? std::pow(volume, 4.0 / 9) : volume; }

// The least of the barycentric coordinates c of `at` with respect to a piece that was made by bisections, which is
// negative outside: sum_k c_k corner_k = at. The first dim + 1 entries determine it, which are 1 - x, x, 1 - y in a
// quadrilateral. 0 for one so small that its corners are one point to rounding.
double inside(const std::array<CellPoint, 4>& corner, int dim, const CellPoint& at) {
    std::vector<double> A, c;
    for (int i = 0; i <= dim; ++i)
        for (int k = 0; k <= dim; ++k) A.push_back(corner[k][i]);
    const bool solved = solve_dense(std::move(A), {at.begin(), at.begin() + dim + 1}, c, 0);
    return solved ? *std::min_element(c.begin(), c.end()) : 0;
}

}  // namespace

RefinedRule::RefinedRule(const CellType& cell) : cell_(&cell), dim_(cell.dim) {
    const SubSimplices parts(cell, 1);
    const std::vector<MultiIndex> vertices = gmsh_node_order(cell, 1);
    for (const CellChild& of_part : parts.vertices) {
        Piece& piece = pieces_.emplace_back(Piece{{}, 1.0 / parts.count()});
        for (int k = 0; k <= dim_; ++k) std::copy_n(vertices[of_part[k]].begin(), 4, piece.corner[k].begin());
    }
}

// Of quadrilaterals: with points at their nodes, and at p = 1, where triangles have none, at those of degree 2; exact
// to a total degree of 4 p, since |F|^2 has 4 p - 2.
Quadrature RefinedRule::of_pieces(const CellType& cell, int degree, int exactness) {
    if (cell.is_simplex()) return element_quadrature(cell, degree, exactness);
    return element_quadrature(simplex(cell.dim), std::max(degree, 2), exactness == 0 ? 4 * degree : exactness);
}

// The first of those.
RefinedRule::Piece* RefinedRule::smallest_around(const CellPoint& at) {
    constexpr double on_side = -1e-9;
    Piece* smallest = nullptr;
    for (Piece& piece : pieces_)
        if ((!smallest || piece.volume < smallest->volume) && inside(piece.corner, dim_, at) >= on_side)
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
            const auto [a, b] = longest_edge(half.corner, dim_);
            for (int k = 0; k < 4; ++k)
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
    const double unit = cell_->volume() / simplex(dim_).volume();
    for (const Piece& piece : pieces_) {
        const double weight = unit * barrier_weight(piece.volume, dim_);
        for (int q = 0; q < rule.count; ++q) {
            double rest = 1;
            for (int k = 0; k < dim_; ++k) rest -= rule.xi[q * dim_ + k];
            for (int i = 1; i <= dim_; ++i) {
                const int entry = cell_->is_simplex() ? i : 2 * i - 1;
                double xi = rest * piece.corner[0][entry];
                for (int k = 0; k < dim_; ++k) xi += rule.xi[q * dim_ + k] * piece.corner[k + 1][entry];
                all.xi.push_back(xi);
            }
            all.weight.push_back(weight * rule.weight[q]);
            volume.push_back(unit * piece.volume * rule.weight[q]);
            ++all.count;
        }
    }
    return {reference_element(*cell_, degree, all), std::move(volume)};
}

}  // namespace almesh
