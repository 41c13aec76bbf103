#include "base/frame.hpp"

#include <doctest/doctest.h>

using namespace almesh;

TEST_CASE("a frame takes places to the run and back, points and arrays of them alike") {
    const Frame frame = {{1000, -2000, 30}, 4};
    CHECK(frame.to_run(Vec<3>{1004, -2008, 31}) == Vec<3>{1, -2, 0.25});
    CHECK(frame.to_file(Vec<3>{1, -2, 0.25}) == Vec<3>{1004, -2008, 31});
    std::vector<double> X = {1004, -2008, 1000, -1996};
    frame.take_to_run(X, 2);
    CHECK(X == std::vector<double>{1, -2, 0, 1});
    CHECK(frame.to_file(X, 2) == std::vector<double>{1004, -2008, 1000, -1996});
}
