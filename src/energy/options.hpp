// The choices that a deck and Newton's method make for the energy.
#pragma once
#include <vector>

namespace almesh {

enum class Objective {
    squared,     // eta^2: the tables of the paper
    deviation,   // (eta - 1)^2: its Eq. 5
    size_shape,  // (eta - 1)^2 of the distortion of shape and size
    minimax,     // powers of eta - 1 that are raised in the run (method/p_norm.hpp)
    tangled      // eta^2 of a measure for meshes with inverted elements (problem/untangling.hpp), not in decks
};

// The density M^2 (s^p + kappa s^2), s = (eta - 1) / M or eta / M; as it stands here, the square.
struct PowerParams {
    int p = 2;
    double M = 1, kappa = 0;
};

struct DistortionParams {
    Objective objective = Objective::deviation;
    double delta = 0;            // Eq. 3
    double weight_exponent = 1;  // alpha
    int exactness = 0;           // of the quadrature for p > 1; 0: default_exactness(degree)
    PowerParams power = {};
    bool curved_ideal = false;  // A varies over the ideal element
    // Per element the volume of its ideal element, which then is the regular cell of its type, not the element of the
    // ideal mesh; or dim x dim numbers, the map to it from the regular cell that has the volume of the reference cell;
    // empty: elements of the ideal mesh.
    std::vector<double> regular = {};
};

enum class HessianKind {
    full,       // second derivative of the objective
    projected,  // its positive semidefinite part, point by point, with damping
    damping     // the damping alone: the Hessian of Eq. 5 vanishes at the identity
};

struct Projection {
    double damping = 0;        // t, see distortion_energy.hpp
    double kept_negative = 0;  // by which negative eigenvalues are multiplied
    bool is_full() const { return damping == 0 && kept_negative == 1; }  // nothing is projected
};

}  // namespace almesh
