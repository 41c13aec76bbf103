// L-BFGS: minimises a smooth function with the differences of its last gradients in place of a Hessian (Nocedal &
// Wright, Numerical Optimization, 2006, algorithms 7.4 and 7.5), with backtracking by the condition of Armijo.
//
// For sums of sharp exponentials: where the Hessian is worth little from step to step, a hundred cheap steps go farther
// than ten of Newton's method.
//
// Cost: a step is one value and gradient, more where it is cut, and 4 memory scalar products of vectors; memory: two
// vectors for each difference. Nothing is allocated between steps. Same bits for any number of threads.
#pragma once
#include <limits>
#include <vector>

namespace almesh {

struct SmoothFunction {
    virtual ~SmoothFunction() = default;

    // The value at z, infinite where it is not defined; where it is finite, g (the size of z) becomes the gradient,
    // along the surfaces that z has to stay on.
    virtual double value(const std::vector<double>& z, std::vector<double>& g) = 0;
    // Back to the surfaces that z has to stay on.
    virtual void retract(std::vector<double>& /*z*/) const {}
    // z: each iterate, of which value() was asked last. Whether to go on.
    virtual bool accept(const std::vector<double>& /*z*/) { return true; }
};

struct LbfgsParams {
    int memory = 10;
    int max_iterations = 150;
    int window = 10;           // iterations in which the value has to fall
    double least_fall = 1e-5;  // by this part of it
    double first_step = 0.05;  // largest entry of the first step,
    double largest_step = 0.5;  // and of each other one
};

// z: the first iterate, with a finite value; becomes the last one. Returns the number of iterations.
int minimise(SmoothFunction& f, const LbfgsParams& params, std::vector<double>& z);

}  // namespace almesh
