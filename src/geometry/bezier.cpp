// bezier_of_lagrange: N_i = prod_k prod_{j < a_k} (p l_k - j) / (j + 1) (Silvester), each factor made homogeneous with
// l_0 + ... + l_m = 1, is expanded into monomials of degree p, which are the B_a over their multinomials.
// bounded_minimum: branch and bound; lower bound of a piece: its least coefficient, upper: its least corner value.
#include "geometry/bezier.hpp"

#include <algorithm>
#include <functional>
#include <utility>

#include "base/index.hpp"

namespace almesh {
namespace {

double factorial(int n) { return n < 2 ? 1 : n * factorial(n - 1); }

// The parts of the simplex of one search: the corners of each in barycentric coordinates, in which the whole simplex is
// regular, its coefficients, and those not yet bisected as a heap of the lower bounds, of equal ones the oldest first.
struct Pieces {
    std::vector<std::array<Barycentric, 4>> corner;
    std::vector<double> c;  // pieces x count
    std::vector<std::pair<double, int>> queue;

    void push(double lower, int piece) {
        queue.push_back({lower, piece});
        std::push_heap(queue.begin(), queue.end(), std::greater<>());
    }
    int pop() {
        std::pop_heap(queue.begin(), queue.end(), std::greater<>());
        const int piece = queue.back().second;
        queue.pop_back();
        return piece;
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
    thread_local Pieces pieces;  // scratch, kept between calls
    thread_local std::vector<double> whole;
    pieces.corner.assign(1, corner);
    pieces.c.assign(c, c + basis.count);
    pieces.queue.clear();
    pieces.push(minimum.lower, 0);
    for (int bisections = 0; bisections < max_bisections && !enough(minimum.lower, minimum.upper); ++bisections) {
        const int near_a = pieces.pop(), near_b = bisections + 1;  // the half near corner a takes the place of both
        const auto [a, b] = longest_edge(pieces.corner[near_a], basis.dim);
        pieces.corner.push_back(pieces.corner[near_a]);
        for (int k = 0; k <= basis.dim; ++k)
            pieces.corner[near_a][b][k] = pieces.corner[near_b][a][k] =
                0.5 * (pieces.corner[near_a][a][k] + pieces.corner[near_a][b][k]);
        whole.assign(pieces.c.begin() + static_cast<std::ptrdiff_t>(offset(near_a, basis.count)),
                     pieces.c.begin() + static_cast<std::ptrdiff_t>(offset(near_a + 1, basis.count)));
        pieces.c.resize(offset(near_b + 1, basis.count));
        basis.bisect(a, b, whole.data(), &pieces.c[offset(near_a, basis.count)],
                     &pieces.c[offset(near_b, basis.count)]);
        for (const int half : {near_a, near_b}) {
            const double* const of_half = &pieces.c[offset(half, basis.count)];
            look_at_corners(pieces.corner[half], of_half);
            pieces.push(*std::min_element(of_half, of_half + basis.count), half);
        }
        minimum.lower = pieces.queue.front().first;
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
            MultiIndex sum{};
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
