// The displacement of a boundary, extended into the mesh by one linear system: as a harmonic function, or as that of an
// elastic solid. With g_i = grad N_i on the mesh as it is, and the displacement of the boundary nodes given,
//
//     sum_j K_ij u_j = 0 for all nodes i inside,
//     K_ij = integral of  a (g_i . g_j) I + b g_j g_i^T + c g_i g_j^T
//
// with the numbers a, b, c of a Stiffness. Nothing here keeps an element from being inverted. Cost: one assembly and
// one linear solve.
#pragma once
#include <vector>

#include "energy/element_blocks.hpp"
#include "linalg/linear_solver.hpp"
#include "mesh/mesh.hpp"
#include "mesh/quadrature.hpp"

namespace almesh {

struct Stiffness {
    double a = 0, b = 0, c = 0;
};

// At a point of an element whose map has the determinant `jacobian` > 0 there: n! times the volume of a straight one.
using StiffnessAt = Stiffness (*)(double jacobian);

// Of the Laplace equation for each coordinate of the displacement. The maximum principle keeps the displacement within
// that of the boundary, not the mesh valid.
Stiffness harmonic_stiffness(double jacobian);

// Of a linear elastic solid,
//
//     integral of  2 m e(u) : e(v) + l div u div v = 0,   e(u) the symmetric gradient,
//     l = E v / ((1 + v) (1 - 2 v)),   m = E / (2 (1 + v)),   v = 0.3,
//
// whose modulus E is the reciprocal of the element's volume (of the Jacobian's determinant at a point of a curved one):
// the Jacobian-based stiffening with the exponent 1 of Stein, Tezduyar, Benney (J. Appl. Mech. 70, 2003), which leaves
// the determinant out of the integral over an element. Small elements then move almost as rigid bodies, and large ones
// take the deformation.
Stiffness elastic_stiffness(double jacobian);

class LinearExtension {
public:
    // pattern: of the Hessian of the mesh's energy.
    LinearExtension(const Mesh& mesh, BlockCsr pattern, const LinearSolverParams& linear);

    // u: node_count x dim, on entry the displacement of the fixed nodes, zero at all others, on return of all nodes.
    // x: node_count x dim, the mesh on which K is. Same bits for any number of threads.
    SolveResult extend(StiffnessAt stiffness, const std::vector<double>& x, const std::vector<char>& fixed,
                       std::vector<double>& u);

private:
    struct Group {  // elements of one type
        Mesh mesh;
        ReferenceElement reference;
        ElementBlocks blocks;
    };
    const int dim_;
    std::vector<Group> groups_;
    BlockCsr K_;
    LinearSolver solver_;

    template <int n>
    void add_element(const Group& of, StiffnessAt stiffness, const std::vector<double>& x, int e);
};

}  // namespace almesh
