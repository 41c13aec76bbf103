// A certificate that every element of the mesh is valid everywhere, not only at sample points.
//
// Let J_s be the Jacobian of the straight-sided element with the same vertices. The scaled determinant of a simplex is
// det J / |det J_s| (Toulorge et al., J. Comput. Phys. 254, 2013; exactly 1 if it is straight), that of other cells
// det J over the mean of det J_s: a polynomial (element_jacobian.hpp). Its Bezier coefficients, sharpened by bisection,
// give the certified bound. Straight-sided hexahedra, prisms and pyramids need it too: positive corners prove nothing.
//
// Cost: per element, one product with a matrix of nodes x nodes, and a cross and a dot product of polynomials with
// vectors as coefficients; few elements of a mesh of good quality need bisection.
#pragma once
#include <string>
#include <vector>

namespace almesh {

struct Mesh;

struct CertificateParams {
    double tolerance = 0.01;    // relative gap allowed between the lower bound and a value of the scaled determinant
    int max_bisections = 2000;  // per element
};

struct Certificate {
    double min_certified_bound = 0;   // the least of all elements
    bool valid = false;               // every element is certified valid: det J > 0 everywhere
    int undecided = 0;                // elements proved neither valid nor invalid
    std::vector<int> uncertified;     // elements that are invalid or undecided, lowest bound first
    // Per element, to the tolerance; 0 if its vertices span no volume or x is not finite. Not sharpened for cells other
    // than simplices if above 0.1 and above the least scaled determinant of all.
    std::vector<double> certified_bound;
};

// "3 elements proved invalid, 1 undecided"
std::string counts_of(const Certificate& certificate);

// x: node_count x dim positions. The bounds account for rounding. Same bits for any number of threads.
Certificate certify(const Mesh& mesh, const std::vector<double>& x, const CertificateParams& params = {});

}  // namespace almesh
