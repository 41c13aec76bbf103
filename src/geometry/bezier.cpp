// bezier_of_lagrange: N_i = prod_k prod_{j < a_k} (p l_k - j) / (j + 1) (Silvester), each factor made homogeneous with
// l_0 + ... + l_m = 1, is expanded into monomials of degree p, which are the B_a over their multinomials.
// polynomial_minimum: branch and bound; lower bound of a piece: its least coefficient, upper: its least corner value.
#include "geometry/bezier.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <queue>
#include <tuple>

#include "base/index.hpp"

namespace almesh {
namespace {

double factorial(int n) { return n < 2 ? 1 : n * factorial(n - 1); }

using Terms = std::map<MultiIndex, double>;  // a homogeneous polynomial of the barycentric coordinates

// terms * (degree l_k - j (l_0 + ... + l_dim))
Terms times_factor(const Terms& terms, int dim, int degree, int k, int j) {
    Terms product;
    for (const auto& [a, coefficient] : terms)
        for (int m = 0; m <= dim; ++m) {
            MultiIndex b = a;
            ++b[m];
            product[b] += coefficient * ((m == k ? degree : 0) - j);
        }
    return product;
}

// Part of the simplex: its corners in barycentric coordinates, and the place of its coefficients in the pool.
struct Piece {
    double lower;
    int place;
    std::array<std::array<double, 4>, 4> corner;

    bool operator<(const Piece& other) const {  // the queue's top is the piece of the lowest bound
        return std::tie(lower, place) > std::tie(other.lower, other.place);
    }
};

// Edge of the piece that is longest when the whole simplex is regular.
std::array<int, 2> longest_edge(const Piece& piece, int dim) {
    std::array<int, 2> longest = {0, 1};
    double best = 0;
    for (int a = 0; a <= dim; ++a)
        for (int b = a + 1; b <= dim; ++b) {
            double squared = 0;
            for (int k = 0; k <= dim; ++k) {
                const double d = piece.corner[a][k] - piece.corner[b][k];
                squared += d * d;
            }
            if (squared > best) {
                best = squared;
                longest = {a, b};
            }
        }
    return longest;
}

}  // namespace

Bernstein::Bernstein(int dim_, int degree_)
    : dim(dim_), degree(degree_), count(simplex_node_count(dim_, degree_)), index(gmsh_node_order(dim_, degree_)) {
    for (const MultiIndex& a : index) {
        double value = factorial(degree);
        for (int k = 0; k <= dim; ++k) value /= factorial(a[k]);
        multinomial.push_back(value);
    }
    rows_.resize((dim + 1) * (dim + 1));
    for (int a = 0; a <= dim; ++a)
        for (int b = a + 1; b <= dim; ++b)
            for (MultiIndex at : index) {
                if (at[b] != 0 || at[a] == 0) continue;  // every row once, from its end near corner a
                std::vector<int> row;
                for (; at[a] >= 0; --at[a], ++at[b]) row.push_back(find(at));
                rows_[edge(a, b)].push_back(row);
            }
}

int Bernstein::find(const MultiIndex& a) const {
    const auto it = std::find(index.begin(), index.end(), a);
    return it == index.end() ? -1 : static_cast<int>(it - index.begin());
}

std::vector<int> raised_places(int dim, int degree) {
    const Bernstein upper(dim, degree + 1);
    std::vector<int> places;
    for (const MultiIndex& a : gmsh_node_order(dim, degree))
        for (int k = 0; k <= dim; ++k) {
            MultiIndex b = a;
            ++b[k];
            places.push_back(upper.find(b));
        }
    return places;
}

std::vector<double> bezier_of_lagrange(const LagrangeBasis& basis) {
    const Bernstein bernstein(basis.dim, basis.degree);
    std::vector<double> M(offset(basis.count, basis.count));
    for (int i = 0; i < basis.count; ++i) {
        Terms terms = {{MultiIndex{}, 1.0}};
        double denominator = 1;
        for (int k = 0; k <= basis.dim; ++k)
            for (int j = 0; j < basis.nodes[i][k]; ++j) {
                terms = times_factor(terms, basis.dim, basis.degree, k, j);
                denominator *= j + 1;
            }
        for (int a = 0; a < basis.count; ++a)
            M[offset(a, basis.count, i)] = terms[bernstein.index[a]] / (denominator * bernstein.multinomial[a]);
    }
    return M;
}

BezierProduct::BezierProduct(const Bernstein& a, const Bernstein& b, const Bernstein& product)
    : left(a.count), right(b.count) {
    for (const MultiIndex& i : a.index)
        for (const MultiIndex& j : b.index) {
            MultiIndex sum{};
            for (int k = 0; k < 4; ++k) sum[k] = i[k] + j[k];
            place.push_back(product.find(sum));
        }
}

void BezierProduct::add(double factor, const double* a, const double* b, double* out) const {
    for (int i = 0; i < left; ++i) {
        const int* const row = &place[offset(i, right)];
        const double ai = factor * a[i];
        for (int j = 0; j < right; ++j) out[row[j]] += ai * b[j];
    }
}

PolynomialMinimum polynomial_minimum(const Bernstein& basis, const double* c, double tolerance, int max_bisections) {
    const int corners = std::min(basis.count, basis.dim + 1);
    double lower = *std::min_element(c, c + basis.count);
    double upper = *std::min_element(c, c + corners);
    const auto tight = [&] {
        return upper - lower <= tolerance * (upper > 0 ? upper : std::max(1.0, -upper));
    };
    if (tight() || max_bisections == 0) return {lower, upper, tight()};

    std::vector<double> pool(c, c + basis.count);
    std::vector<double> parent(basis.count);
    std::priority_queue<Piece> queue;
    Piece whole{lower, 0, {}};
    for (int k = 0; k <= basis.dim; ++k) whole.corner[k][k] = 1;
    queue.push(whole);
    for (int bisections = 0; bisections < max_bisections && !tight(); ++bisections) {
        Piece piece = queue.top();
        queue.pop();
        const auto [a, b] = longest_edge(piece, basis.dim);
        Piece other = piece;  // its coefficients are appended to the pool; the piece keeps the place of the whole
        other.place = static_cast<int>(pool.size() / basis.count);
        for (int k = 0; k <= basis.dim; ++k)
            other.corner[a][k] = piece.corner[b][k] = 0.5 * (piece.corner[a][k] + piece.corner[b][k]);
        pool.resize(pool.size() + basis.count);
        double* const near_a = &pool[offset(piece.place, basis.count)];
        double* const near_b = &pool[offset(other.place, basis.count)];
        std::copy(near_a, near_a + basis.count, parent.begin());
        basis.bisect(a, b, parent.data(), near_a, near_b);
        for (Piece* half : {&piece, &other}) {
            const double* const coefficient = half == &piece ? near_a : near_b;
            half->lower = *std::min_element(coefficient, coefficient + basis.count);
            upper = std::min(upper, *std::min_element(coefficient, coefficient + corners));
            queue.push(*half);
        }
        lower = queue.top().lower;
    }
    return {lower, upper, tight()};
}

}  // namespace almesh
