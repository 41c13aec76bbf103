// Bezier points from nodal positions, halves by de Casteljau, and the normal field as a product of polynomials:
//
//     dx/dxi_k = p sum_a (c_{a + e_{k+1}} - c_{a + e_0}) B_a,  |a| = p - 1      (Farin 2002, sec. 17.4)
//     B_a B_b = mult(a) mult(b) / mult(a + b) B_{a + b},  integral of B_a = (measure of the simplex) / count
#include "geometry/patch.hpp"

#include <algorithm>
#include <cmath>

#include "base/index.hpp"

namespace almesh {

PatchBasis::PatchBasis(int m, int degree)
    : bernstein(m, degree), to_bezier(bezier_of_lagrange(LagrangeBasis(m, degree))) {}

std::vector<double> face_positions(const Mesh& mesh, const std::vector<double>& x, int f) {
    std::vector<double> nodes;
    for (int i = 0; i < mesh.face_nodes(); ++i) {
        const double* const position = point(x, mesh.face(f)[i], mesh.dim);
        nodes.insert(nodes.end(), position, position + mesh.dim);
    }
    return nodes;
}

Patch make_patch(const PatchBasis& basis, const double* nodes, int dim) {
    const int count = basis.bernstein.count;
    Patch patch(count, Vec<3>{});
    for (int b = 0; b < count; ++b)
        for (int a = 0; a < dim; ++a) {
            if (b < dim) {  // one of the m + 1 = dim corners
                patch[b][a] = nodes[b * dim + a];
                continue;
            }
            for (int i = 0; i < count; ++i)  // relative to node 0: stretched faces may lie far from the origin
                patch[b][a] += basis.to_bezier[offset(b, count, i)] * (nodes[i * dim + a] - nodes[a]);
            patch[b][a] += nodes[a];
        }
    return patch;
}

std::array<int, 2> longest_side(const Patch& patch, int m) {
    std::array<int, 2> longest = {0, 1};
    double best = -1;
    for (int a = 0; a <= m; ++a)
        for (int b = a + 1; b <= m; ++b) {
            const Vec<3> d = patch[b] - patch[a];
            if (dot(d, d) > best) {
                best = dot(d, d);
                longest = {a, b};
            }
        }
    return longest;
}

double size_of(const Patch& patch, int m) {
    const auto [a, b] = longest_side(patch, m);
    const Vec<3> d = patch[b] - patch[a];
    return std::sqrt(dot(d, d));
}

Vec<3> side_tangent(const Bernstein& basis, const Patch& patch, int i, int j) {
    MultiIndex next{};
    next[i] = basis.degree - 1;
    ++next[j];
    return patch[basis.find(next)] - patch[i];
}

std::pair<Patch, Patch> bisect(const Bernstein& basis, const Patch& patch, int a, int b) {
    std::pair<Patch, Patch> halves{patch, patch};
    basis.bisect(a, b, patch.data(), halves.first.data(), halves.second.data());
    return halves;
}

double deviation(const Bernstein& basis, const Patch& patch) {
    double largest = 0;
    for (int i = basis.dim + 1; i < basis.count; ++i) {
        Vec<3> d = patch[i];
        for (int v = 0; v <= basis.dim; ++v)
            for (int a = 0; a < 3; ++a) d[a] -= patch[v][a] * basis.index[i][v] / basis.degree;
        largest = std::max(largest, dot(d, d));
    }
    return std::sqrt(largest);
}

// In 2D the normal is the product of the tangent and the constant e_z, a polynomial of degree 0.
PatchNormal::PatchNormal(int dim, int degree)
    : dim_(dim), position_(dim - 1, degree), gradient_(dim - 1, degree - 1),
      normal_(dim - 1, (dim - 1) * (degree - 1)), integrand_(dim - 1, degree + normal_.degree),
      tangent_tangent_(gradient_, dim == 2 ? Bernstein(1, 0) : gradient_, normal_),
      position_normal_(position_, normal_, integrand_), raised_(raised_places(dim - 1, degree - 1)) {}

std::vector<Vec<3>> PatchNormal::coefficients(const Patch& patch) const {
    std::vector<Vec<3>> tangent[2];  // scaled by the multinomials
    for (int k = 0; k < dim_ - 1; ++k)
        for (int a = 0; a < gradient_.count; ++a) {
            const Vec<3> difference = patch[raised_[a * dim_ + k + 1]] - patch[raised_[a * dim_]];
            tangent[k].push_back(gradient_.multinomial[a] * (position_.degree * difference));
        }
    if (dim_ == 2) tangent[1] = {{0, 0, 1}};
    std::vector<Vec<3>> n(normal_.count, Vec<3>{});
    auto place = tangent_tangent_.place.begin();
    for (const Vec<3>& t0 : tangent[0])
        for (const Vec<3>& t1 : tangent[1]) {
            n[*place] = n[*place] + cross(t0, t1);
            ++place;
        }
    for (int a = 0; a < normal_.count; ++a)
        for (double& component : n[a]) component /= normal_.multinomial[a];
    return n;
}

double PatchNormal::cone(const Patch& patch, const Vec<3>& apex) const {
    const std::vector<Vec<3>> n = coefficients(patch);
    double sum = 0;  // of the Bezier coefficients of (x - apex) . n
    auto place = position_normal_.place.begin();
    for (int a = 0; a < position_.count; ++a)
        for (int b = 0; b < normal_.count; ++b, ++place)
            sum += dot(patch[a] - apex, n[b]) * position_.multinomial[a] * normal_.multinomial[b] /
                   integrand_.multinomial[*place];
    const double mean = sum / integrand_.count, reference_measure = dim_ == 2 ? 1 : 0.5;
    return mean * reference_measure / dim_;
}

}  // namespace almesh
