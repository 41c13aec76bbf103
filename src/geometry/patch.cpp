// Bezier points from nodal positions, halves by de Casteljau, and the normal field as a product of polynomials:
//
//     dx/dxi_k = p sum_a (c_{a + e_{k+1}} - c_{a + e_0}) B_a,  |a| = p - 1      (Farin 2002, sec. 17.4)
//     B_a B_b = mult(a) mult(b) / mult(a + b) B_{a + b},  integral of B_a = (measure of the simplex) / count
#include "geometry/patch.hpp"

#include <algorithm>
#include <numeric>

#include "mesh/lagrange.hpp"
#include "mesh/mesh.hpp"

namespace almesh {

std::vector<Vec<3>> positions(const Mesh& mesh, const std::vector<double>& x, const int* nodes, int count) {
    std::vector<Vec<3>> result(count, Vec<3>{});
    for (int i = 0; i < count; ++i)
        for (int a = 0; a < mesh.dim; ++a) result[i][a] = point(x, nodes[i], mesh.dim)[a];
    return result;
}

PatchBasis::PatchBasis(const CellType& cell, int degree)
    : bernstein(position_form(cell, degree)), nodes(cell.node_count(degree)), start_{0} {
    const std::vector<double> M = bezier_of_lagrange(LagrangeBasis(cell, degree));
    for (int b = 0; b < bernstein.count; ++b) {
        double sum = 0;
        for (int i = 0; i < nodes; ++i) {
            const double weight = M[offset(b, nodes, i)];
            sum += std::abs(weight);
            if (weight != 0) weights_.push_back({i, weight});
        }
        start_.push_back(static_cast<int>(weights_.size()));
        amplification = std::max(amplification, sum);
    }
}

Patch make_patch(const PatchBasis& basis, const std::vector<Vec<3>>& nodes) {
    // Relative to node 0: stretched faces may lie far from the origin.
    const auto relative = [&nodes](int i) { return nodes[i] - nodes[0]; };
    Patch patch;
    for (int b = 0; b < basis.bernstein.count; ++b)
        patch.push_back(basis.node(b) >= 0 ? nodes[basis.node(b)] : basis.point<Vec<3>>(b, relative) + nodes[0]);
    return patch;
}

double solid_angle(const Vec<3>& u, const Vec<3>& v, const Vec<3>& w) {
    const double a = length(u), b = length(v), c = length(w);
    return 2 * std::atan2(dot(u, cross(v, w)), a * b * c + dot(u, v) * c + dot(v, w) * a + dot(w, u) * b);
}

double size_of(const Patch& patch, int m) {
    const auto [a, b] = longest_edge(patch, {m, 0, 0});
    return length(patch[b] - patch[a]);
}

int next_to_corner(const Bernstein& basis, int i, int j) {
    MultiIndex next{};
    next[i] = basis.degree - 1;
    ++next[j];
    return basis.place(next);
}

Vec<3> edge_tangent(const Bernstein& basis, const Patch& patch, int i, int j) {
    return patch[next_to_corner(basis, i, j)] - patch[i];
}

std::pair<Patch, Patch> bisect(const Bernstein& basis, const Patch& patch, int a, int b) {
    std::pair<Patch, Patch> halves{patch, patch};
    basis.bisect(a, b, patch.data(), halves.first.data(), halves.second.data());
    return halves;
}

namespace {

// Measure of the simplex with these corners, of which the one numbered k is moved to the point.
double measure_with(const Patch& corner, int m, int k, const Vec<3>& point) {
    const auto at = [&](int i) { return i == k ? point : corner[i]; };
    const Vec<3> u = at(1) - at(0), v = at(2) - at(0);
    return m == 2 ? cross(u, v)[2] : dot(cross(u, v), at(3) - at(0));
}

// In the simplex with these corners: where none of them, moved to the point, turns it inside out.
bool flat_holds(const Patch& corner, int m, const Vec<3>& point) {
    constexpr double rounding = 1e-9;
    const double whole = measure_with(corner, m, 0, corner[0]);
    for (int k = 0; k <= m; ++k)
        if (measure_with(corner, m, k, point) / whole < -rounding) return false;
    return true;
}

// Relative to the point, so that halves of pieces are half as large, wherever the patch is. Products of simplices in
// units of their mean edges along each coordinate: a thin one is as thick as others then.
Patch seen_from(const Bernstein& basis, const Patch& patch, const Vec<3>& point) {
    Patch relative = patch;
    for (Vec<3>& b : relative) b = b - point;
    if (basis.factors[1] == 0) return relative;
    Mat<3> J{};
    J[2][2] = basis.dim == 2;
    for (const Bernstein::Corner& corner : basis.corners)
        for (int f = 0, first = 0, k = 0; f < static_cast<int>(corner.entries.size()); first += basis.entries(f++))
            for (int e = first + 1; e < first + basis.entries(f); ++e, ++k)
                for (int a = 0; a < 3; ++a)
                    J[a][k] += ((corner.entries[f] == e) - (corner.entries[f] == first)) * relative[corner.place][a];
    if (!(std::abs(determinant(J)) > 0)) return relative;
    const Mat<3> to_edges = inverse<3>(J);
    for (Vec<3>& b : relative) {
        const Vec<3> at = b;
        for (int a = 0; a < 3; ++a) b[a] = to_edges[a][0] * at[0] + to_edges[a][1] * at[1] + to_edges[a][2] * at[2];
    }
    return relative;
}

}  // namespace

CurvedEdge longest_curve(const Bernstein& basis, const Patch& patch) {
    CurvedEdge longest;
    for (const Bernstein::Corner& corner : basis.corners)
        for (int f = 0, first = 0; f < static_cast<int>(corner.entries.size()); first += basis.entries(f++))
            for (int a = corner.entries[f], b = a + 1; b < first + basis.entries(f); ++b) {
                double sum = 0;
                MultiIndex at = basis.index[corner.place];
                for (int last = corner.place; at[a] > 0;) {
                    --at[a];
                    ++at[b];
                    const int next = basis.place(at);
                    sum += length(patch[next] - patch[last]);
                    last = next;
                }
                if (sum > longest.length) longest = {a, b, sum};
            }
    return longest;
}

bool holds(const Bernstein& basis, const Patch& patch, const Vec<3>& point) {
    constexpr double resolution = 1e-9;
    constexpr int most_pieces = 200000;  // in layers 1:1000 and more a point takes some ten thousand
    if (basis.degree == 1 && basis.factors[1] == 0) return flat_holds(patch, basis.dim, point);
    std::vector<Patch> pieces = {seen_from(basis, patch, point)};
    double smallest = 0;
    for (const Bernstein::Corner& a : basis.corners)
        for (const Bernstein::Corner& b : basis.corners)
            smallest = std::max(smallest, resolution * length(pieces[0][a.place] - pieces[0][b.place]));
    for (int tested = 0; !pieces.empty(); ++tested) {
        if (tested == most_pieces) return true;
        const Patch piece = std::move(pieces.back());
        pieces.pop_back();
        if (squared_distance(box_of(piece), {}) > 0) continue;
        const CurvedEdge edge = longest_curve(basis, piece);
        if (edge.length <= smallest) return true;
        auto [near, far] = bisect(basis, piece, edge.a, edge.b);
        pieces.push_back(std::move(near));
        pieces.push_back(std::move(far));
    }
    return false;
}

double deviation(const Bernstein& basis, const Patch& patch) {
    double largest = 0;
    for (int i = basis.dim + 1; i < basis.count; ++i) {
        Vec<3> d = patch[i];
        for (int v = 0; v <= basis.dim; ++v) d = d - (1.0 * basis.index[i][v] / basis.degree) * patch[v];
        largest = std::max(largest, dot(d, d));
    }
    return std::sqrt(largest);
}

PatchNormal::PatchNormal(int m, int degree)
    : basis(m, std::min(m, 2) * (degree - 1)),
      tangent_tangent(Bernstein(m, degree - 1), Bernstein(m, m == 1 ? 0 : degree - 1), basis), m_(m), degree_(degree),
      position_normal_(Bernstein(m, degree), basis, Bernstein(m, degree + basis.degree)),
      raised_(raised_places(m, degree - 1)) {}

std::vector<Vec<3>> PatchNormal::tangent(const Patch& patch, int k) const {
    if (k == m_) return {{0, 0, 1}};
    std::vector<Vec<3>> tangent;
    tangent.reserve(raised_.size() / (m_ + 1));
    for (std::size_t a = 0; a < raised_.size(); a += m_ + 1)
        tangent.push_back(degree_ * (patch[raised_[a + k + 1]] - patch[raised_[a]]));
    return tangent;
}

std::vector<Vec<3>> PatchNormal::coefficients(const Patch& patch) const {
    return tangent_tangent.multiply(tangent(patch, 0), tangent(patch, 1), cross<double>);
}

double PatchNormal::cone(const Patch& patch, const Vec<3>& apex) const {
    Patch relative = patch;
    for (Vec<3>& point : relative) point = point - apex;
    const std::vector<double> integrand = position_normal_.multiply(relative, coefficients(patch), dot<double>);
    const double mean = std::accumulate(integrand.begin(), integrand.end(), 0.0) / integrand.size();
    return mean * simplex(m_).volume() / (m_ + 1);
}

}  // namespace almesh
