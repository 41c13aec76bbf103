#include "method/eigenvalue_filtering.hpp"

#include <doctest/doctest.h>

using namespace almesh;

TEST_CASE("as much of the negative eigenvalues is kept as the Hessian bears") {
    EigenvalueFiltering part = EigenvalueFiltering::of_few_nodes();
    CHECK(part.kept == 1);
    part.after_step(1);
    CHECK(part.kept == 1);  // no more than all
    for (const double expected : {0.5, 0.25, 0.125, 0.1, 0.1}) {
        part.after_step(0.9);
        CHECK(part.kept == expected);
    }
    for (const double expected : {0.2, 0.4}) {
        part.after_step(2);  // a lengthened step is a full one
        CHECK(part.kept == expected);
    }
}

TEST_CASE("of the whole mesh none are kept until a step had to be lengthened, and never all") {
    EigenvalueFiltering part = EigenvalueFiltering::of_mesh();
    for (const double step_length : {1.0, 0.5, 1e-3}) {
        part.after_step(step_length);
        CHECK(part.kept == 0);
    }
    for (const double expected : {0.2, 0.4, 0.8, 0.9, 0.9}) {
        part.after_step(2);
        CHECK(part.kept == expected);
        part.after_step(1);
        CHECK(part.kept == expected);
    }
    for (const double expected : {0.45, 0.225, 0.1125, 0.0}) {
        EigenvalueFiltering weaker = part;
        weaker.weaken();
        CHECK(weaker.kept == expected);
        part.after_step(0.9);
        CHECK(part.kept == expected);
    }
}

TEST_CASE("a Hessian that gives no step is tried with less and less of them, at last with none") {
    EigenvalueFiltering part = EigenvalueFiltering::of_few_nodes();
    for (const double expected : {0.5, 0.25, 0.125, 0.0}) {
        part.weaken();
        CHECK(part.kept == expected);
    }
    for (const double step_length : {0.5, 1.0}) {  // not for long
        EigenvalueFiltering after = part;
        after.after_step(step_length);
        CHECK(after.kept == 0.1);
    }
}
