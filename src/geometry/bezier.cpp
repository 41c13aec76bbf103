// bezier_of_lagrange: N_i = prod_k prod_{j < a_k} (p l_k - j) / (j + 1) (Silvester), each factor made homogeneous with
// l_0 + ... + l_m = 1, is expanded into monomials of degree p, which are the B_a over their multinomials.
// bounded_minimum: branch and bound; lower bound of a piece: its least coefficient, upper: its least corner value.
#include "geometry/bezier.hpp"

#include <algorithm>
#include <functional>
#include <limits>
#include <queue>
#include <tuple>
#include <utility>

#include "base/index.hpp"

namespace almesh {
namespace {

double factorial(int n) { return n < 2 ? 1 : n * factorial(n - 1); }

// Part of the simplex: its corners in barycentric coordinates, in which the whole simplex is regular, and its
// coefficients.
struct Piece {
    double lower;  // bound
    int number;
    std::array<Barycentric, 4> corner;
    std::vector<double> c;

    bool operator<(const Piece& other) const {  // the queue's top is the piece of the lowest bound
        return std::tie(lower, number) > std::tie(other.lower, other.number);
    }
};

// Until enough(lower, upper) or max_bisections.
template <class Enough>
PolynomialMinimum bounded_minimum(const Bernstein& basis, const double* c, int max_bisections, const Enough& enough) {
    std::array<Barycentric, 4> corner{};
    for (int k = 0; k <= basis.dim; ++k) corner[k][k] = 1;
    PolynomialMinimum minimum{*std::min_element(c, c + basis.count), c[0], false, corner[0]};
    const auto look_at_corners = [&](const std::array<Barycentric, 4>& corners, const double* values) {
        for (int k = 0; k < std::min(basis.count, basis.dim + 1); ++k)
            if (values[k] < minimum.upper) {
                minimum.upper = values[k];
                minimum.at = corners[k];
            }
    };
    look_at_corners(corner, c);
    if (enough(minimum.lower, minimum.upper)) return minimum;
    std::priority_queue<Piece> queue;
    queue.push({minimum.lower, 0, corner, std::vector<double>(c, c + basis.count)});
    for (int bisections = 0; bisections < max_bisections && !enough(minimum.lower, minimum.upper); ++bisections) {
        const Piece piece = queue.top();
        queue.pop();
        const auto [a, b] = longest_edge(piece.corner, basis.dim);
        Piece near_a = piece, near_b = piece;
        near_b.number = bisections + 1;
        for (int k = 0; k <= basis.dim; ++k)
            near_b.corner[a][k] = near_a.corner[b][k] = 0.5 * (piece.corner[a][k] + piece.corner[b][k]);
        basis.bisect(a, b, piece.c.data(), near_a.c.data(), near_b.c.data());
        for (Piece* half : {&near_a, &near_b}) {
            half->lower = *std::min_element(half->c.begin(), half->c.end());
            look_at_corners(half->corner, half->c.data());
            queue.push(std::move(*half));
        }
        minimum.lower = queue.top().lower;
    }
    return minimum;
}

}  // namespace

Bernstein::Bernstein(int dim_, int degree_)
    : dim(dim_), degree(degree_), count(simplex_node_count(dim_, degree_)), index(gmsh_node_order(dim_, degree_)) {
    for (const MultiIndex& a : index) {
        double value = factorial(degree);
        for (int k = 0; k <= dim; ++k) value /= factorial(a[k]);
        multinomial.push_back(value);
        place_.insert({a, static_cast<int>(place_.size())});
    }
    rows_.resize((dim + 1) * (dim + 1));
    for (int a = 0; a <= dim; ++a)
        for (int b = a + 1; b <= dim; ++b)
            for (MultiIndex at : index) {
                if (at[b] != 0 || at[a] == 0) continue;  // every row once, from its end near corner a
                std::vector<int> row;
                for (; at[a] >= 0; --at[a], ++at[b]) row.push_back(place(at));
                rows_[edge(a, b)].push_back(row);
            }
}

std::vector<int> raised_places(int dim, int degree) {
    const Bernstein upper(dim, degree + 1);
    std::vector<int> places;
    for (const MultiIndex& a : gmsh_node_order(dim, degree))
        for (int k = 0; k <= dim; ++k) {
            MultiIndex b = a;
            ++b[k];
            places.push_back(upper.place(b));
        }
    return places;
}

std::vector<double> bezier_of_lagrange(const LagrangeBasis& basis) {
    const Bernstein bernstein(basis.dim, basis.degree);
    std::vector<std::vector<int>> raised;  // by degree
    for (int d = 0; d < basis.degree; ++d) raised.push_back(raised_places(basis.dim, d));
    std::vector<double> M(offset(basis.count, basis.count));
    for (int i = 0; i < basis.count; ++i) {
        std::vector<double> product = {1};  // of the factors so far, in monomials l^a
        double denominator = 1;
        int d = 0;
        for (int k = 0; k <= basis.dim; ++k)
            for (int j = 0; j < basis.nodes[i][k]; ++j, ++d) {
                std::vector<double> next(simplex_node_count(basis.dim, d + 1));
                for (std::size_t t = 0; t < raised[d].size(); ++t) {
                    const int a = t / (basis.dim + 1), m = t % (basis.dim + 1);
                    next[raised[d][t]] += product[a] * ((m == k ? basis.degree : 0) - j);
                }
                product = next;
                denominator *= j + 1;
            }
        for (int a = 0; a < basis.count; ++a)
            M[offset(a, basis.count, i)] = product[a] / (denominator * bernstein.multinomial[a]);
    }
    return M;
}

BezierProduct::BezierProduct(const Bernstein& a, const Bernstein& b, const Bernstein& product)
    : left(a.multinomial), right(b.multinomial), result(product.multinomial) {
    for (const MultiIndex& i : a.index)
        for (const MultiIndex& j : b.index) {
            MultiIndex sum;
            std::transform(i.begin(), i.end(), j.begin(), sum.begin(), std::plus<>());
            place.push_back(product.place(sum));
        }
}

PolynomialMinimum polynomial_minimum(const Bernstein& basis, const double* c, double tolerance, int max_bisections) {
    const auto tight = [tolerance](double lower, double upper) {
        return upper - lower <= tolerance * (upper > 0 ? upper : std::max(1.0, -upper));
    };
    PolynomialMinimum minimum = bounded_minimum(basis, c, max_bisections, tight);
    minimum.tight = tight(minimum.lower, minimum.upper);
    return minimum;
}

PolynomialMinimum compare_with(const Bernstein& basis, const double* c, double bound, int max_bisections) {
    const auto decided = [bound](double lower, double upper) { return lower > bound || upper <= bound; };
    return bounded_minimum(basis, c, max_bisections, decided);
}

}  // namespace almesh
