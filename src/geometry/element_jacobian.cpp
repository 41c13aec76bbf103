#include "geometry/element_jacobian.hpp"
#include "mesh/lagrange.hpp"

namespace almesh {
namespace {

// Of polynomials of these degrees in the same factors.
Bernstein product_form(const Bernstein& a, const Bernstein& b) {
    std::array<int, 3> degrees = a.degrees;
    for (int f = 0; f < 3; ++f) degrees[f] += b.degrees[f];
    return {a.factors, degrees};
}

Bernstein tangent_form(const CellType& cell, const Bernstein& position, int factor) {
    std::array<int, 3> degrees = position.degrees;
    --degrees[factor];
    if (cell.is_collapsed && factor < 2) --degrees[2];
    return {position.factors, degrees};
}

std::vector<TangentBasis> tangents(const CellType& cell, const Bernstein& position) {
    std::vector<TangentBasis> by_coordinate;
    for (int k = 0; k < cell.dim; ++k) by_coordinate.emplace_back(cell, position, k);
    return by_coordinate;
}

}  // namespace

TangentBasis::TangentBasis(const CellType& cell, const Bernstein& position, int number)
    : form(tangent_form(cell, position, cell.coordinate(number).factor)) {
    const Coordinate along = cell.coordinate(number);
    const double p = position.degree;
    for (MultiIndex a : form.index) {
        double factor = p;
        if (cell.is_collapsed && along.factor < 2) factor *= p / ++a[4];
        MultiIndex from = a;
        ++from[along.from];
        ++a[along.to];
        differences.push_back({position.place(from), position.place(a), factor});
    }
}

JacobianBasis::JacobianBasis(const CellType& type, int p)
    : cell(type),
      dim(type.dim),
      degree(p),
      position(type, p),
      tangent(tangents(type, position.bernstein)),
      normal(product_form(tangent[0].form, tangent[1].form)),
      jacobian(dim == 2 ? normal : product_form(normal, tangent[2].form)),
      tangent_tangent(tangent[0].form, tangent[1].form, normal),
      normal_tangent(dim == 2 ? Bernstein(2, 0) : normal, dim == 2 ? Bernstein(2, 0) : tangent[2].form,
                     dim == 2 ? Bernstein(2, 0) : jacobian) {
    double middle[3];
    double* next = middle;
    for (const int m : cell.factors) next = std::fill_n(next, m, 1.0 / (m + 1));
    centre.resize(offset(position.nodes, dim));
    LagrangeBasis(cell, p).gradients(middle, centre.data());
    for (const TangentBasis& t : tangent)
        for (const TangentBasis::Difference& d : t.differences) steepness = std::max(steepness, d.factor);
}

}  // namespace almesh
