#include "method/status.hpp"

#include <doctest/doctest.h>

#include <string>

using namespace almesh;

TEST_CASE("every status has a name of its own") {
    CHECK(std::string(to_string(Status::converged)) == "converged");
    CHECK(std::string(to_string(Status::stalled)) == "stalled");
    CHECK(std::string(to_string(Status::attainable_accuracy)) == "attainable_accuracy");
    CHECK(std::string(to_string(Status::no_visible_gain)) == "no_visible_gain");
    CHECK(std::string(to_string(Status::ended_as_printed)) == "ended_as_printed");
    CHECK(std::string(to_string(Status::max_al_iterations)) == "max_al_iterations");
    CHECK(std::string(to_string(Status::max_newton_iterations)) == "max_newton_iterations");
    CHECK(std::string(to_string(Status::line_search_failed)) == "line_search_failed");
    CHECK(std::string(to_string(Status::linear_solver_failed)) == "linear_solver_failed");
    CHECK(std::string(to_string(Status::overflow)) == "overflow");
    CHECK(std::string(to_string(Status::interrupted)) == "interrupted");
    CHECK(std::string(to_string(Status::inverted)) == "inverted");
    CHECK(std::string(to_string(Status::invalid_start)) == "invalid_start");
}
