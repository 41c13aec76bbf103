// bezier_of_lagrange: N_i = prod_k prod_{j < a_k} (p l_k - j) / (j + 1) (Silvester), each factor made homogeneous with
// l_0 + ... + l_m = 1, is expanded into monomials of degree p, which are the B_a over their multinomials.
// bounded_minimum: branch and bound; lower bound of a piece: its least coefficient, upper: its least corner value.
#include "geometry/bezier.hpp"

#include <cmath>
#include <functional>
#include <utility>

#include "base/index.hpp"
#include "mesh/lagrange.hpp"

namespace almesh {
namespace {

double factorial(int n) { return n < 2 ? 1 : n * factorial(n - 1); }
double binomial(int n, int k) { return k < 0 || k > n ? 0 : factorial(n) / (factorial(k) * factorial(n - k)); }

// `count` entries from number `first` on, as an index of their own.
MultiIndex part_of(const MultiIndex& a, int first, int count) {
    MultiIndex part{};
    std::copy_n(&a[first], count, part.begin());
    return part;
}

// The parts of the domain of one search: the corners of each factor in barycentric coordinates, in which the whole
// simplex is regular, the coefficients, and those not yet bisected as a heap of the lower bounds, of equal ones the
// oldest first.
using PieceCorners = std::array<Barycentric, 6>;
struct Pieces {
    std::vector<PieceCorners> corner;
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
    PieceCorners corner{};
    for (int f = 0, first = 0; f < 3; first += basis.entries(f++))  // a factor of degree 0 is a point: not bisected
        for (int k = 0; k < basis.entries(f); ++k) corner[first + k][first + (basis.degrees[f] > 0 ? k : 0)] = 1;
    PolynomialMinimum minimum{*std::min_element(c, c + basis.count), INFINITY, false, {}};
    const auto look_at_corners = [&](const PieceCorners& corners, const double* values) {
        for (const Bernstein::Corner& of_whole : basis.corners) {
            if (!(values[of_whole.place] < minimum.upper)) continue;
            minimum.upper = values[of_whole.place];
            minimum.at = {};
            for (const int entry : of_whole.entries)
                for (std::size_t k = 0; k < minimum.at.size(); ++k) minimum.at[k] += corners[entry][k];
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
        const auto [a, b] = longest_edge(pieces.corner[near_a], basis.factors);
        pieces.corner.push_back(pieces.corner[near_a]);
        for (std::size_t k = 0; k < corner.size(); ++k)
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

// On a simplex.
std::vector<double> expanded_lagrange(const LagrangeBasis& basis) {
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

// On a product of simplices.
std::vector<double> product_of_lagrange(const Bernstein& form, const LagrangeBasis& basis) {
    std::vector<double> M(offset(form.count, basis.count), 1.0);
    for (int f = 0, first = 0; f < 3 && form.entries(f) > 0; first += form.entries(f++)) {
        const int entries = form.entries(f);
        const Bernstein own(form.factors[f], form.degrees[f]);
        const std::vector<double> of_factor = expanded_lagrange(LagrangeBasis(own.dim, own.degree));
        for (int a = 0; a < form.count; ++a)
            for (int i = 0; i < basis.count; ++i)
                M[offset(a, basis.count, i)] *= of_factor[offset(own.place(part_of(form.index[a], first, entries)),
                                                                 own.count,
                                                                 own.place(part_of(basis.nodes[i], first, entries)))];
    }
    return M;
}

// On a pyramid. Entries that are 0 or 1 are so to the last bit.
std::vector<double> raised_layers(const Bernstein& form, const LagrangeBasis& basis) {
    const int p = basis.degree;
    const auto raised = [p](int m, int i, int j) { return binomial(m, i) * binomial(p - m, j - i) / binomial(p, j); };
    std::vector<double> M(offset(form.count, basis.count));
    for (int a = 0; a < form.count; ++a) {
        const MultiIndex& j = form.index[a];
        double* const row = &M[offset(a, basis.count)];
        for (int b = 0; b < basis.count; ++b) {
            const MultiIndex& i = basis.nodes[b];
            if (i[4] != j[5]) continue;
            const double share = raised(p - i[4], i[1], j[1]) * raised(p - i[4], i[3], j[3]);
            for (int node = 0; node < basis.count; ++node)
                row[node] += share * basis.to_bernstein()[offset(b, basis.count, node)];
        }
        for (int node = 0; node < basis.count; ++node)
            if (std::abs(row[node] - std::round(row[node])) < 1e-12) row[node] = std::round(row[node]);
    }
    return M;
}

}  // namespace

Bernstein::Bernstein(int dim_, int degree_)
    : Bernstein(std::array{dim_, 0, 0}, std::array{degree_, 0, 0}) {}

Bernstein::Bernstein(const std::array<int, 3>& factors_, const std::array<int, 3>& degrees_)
    : dim(0), degree(0), factors(factors_), degrees(degrees_), index(1), multinomial(1, 1.0), corners(1) {
    for (int f = 0, first = 0; f < 3 && entries(f) > 0; first += entries(f++)) {
        dim += factors[f];
        degree = std::max(degree, degrees[f]);
        const std::vector<MultiIndex> own = gmsh_node_order(factors[f], degrees[f]);
        std::vector<MultiIndex> longer;
        std::vector<double> product;
        std::vector<Corner> more;
        for (std::size_t i = 0; i < index.size(); ++i)
            for (const MultiIndex& a : own) {
                double value = factorial(degrees[f]);
                for (int k = 0; k < entries(f); ++k) value /= factorial(a[k]);
                product.push_back(multinomial[i] * value);
                longer.push_back(index[i]);
                std::copy_n(a.begin(), entries(f), &longer.back()[first]);
            }
        for (const Corner& before : corners)
            for (int k = 0; k < (degrees[f] > 0 ? entries(f) : 1); ++k) {
                more.push_back({before.place * static_cast<int>(own.size()) + k, before.entries});
                more.back().entries.push_back(first + k);
            }
        index = longer, multinomial = product, corners = more;
        std::vector<int>& places = place_in_factor_[f];
        places.resize(static_cast<std::size_t>(std::pow(degrees[f] + 1, factors[f]) + 0.5));
        for (std::size_t i = 0; i < own.size(); ++i) places[key(f, own[i].data())] = static_cast<int>(i);
    }
    count = static_cast<int>(index.size());
    rows_.resize(edge(1, 0) * edge(1, 0));
    for (int f = 0, first = 0; f < 3; first += entries(f++))
        for (int a = first; a < first + entries(f); ++a)
            for (int b = a + 1; b < first + entries(f); ++b)
                for (MultiIndex at : index) {
                    if (at[b] != 0 || at[a] == 0) continue;  // every row once, from its end near corner a
                    std::vector<int> row;
                    for (; at[a] >= 0; --at[a], ++at[b]) row.push_back(place(at));
                    rows_[edge(a, b)].push_back(row);
                }
}

int Bernstein::key(int factor, const int* a) const {
    int value = 0;
    for (int k = factors[factor]; k > 0; --k) value = value * (degrees[factor] + 1) + a[k];
    return value;
}

int Bernstein::place(const MultiIndex& a) const {
    int place = 0;
    for (int f = 0, first = 0; f < 3 && entries(f) > 0; first += entries(f++))
        place = place * simplex_node_count(factors[f], degrees[f]) + place_in_factor_[f][key(f, &a[first])];
    return place;
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

Bernstein position_form(const CellType& cell, int degree) {
    return {cell.factors, {degree, cell.factors[1] > 0 ? degree : 0, cell.factors[2] > 0 ? degree : 0}};
}

std::vector<double> bezier_of_lagrange(const LagrangeBasis& basis) {
    if (basis.cell.is_simplex()) return expanded_lagrange(basis);
    const Bernstein form = position_form(basis.cell, basis.degree);
    return basis.cell.is_collapsed ? raised_layers(form, basis) : product_of_lagrange(form, basis);
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
