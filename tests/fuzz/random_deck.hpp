// Decks of random motions and of random legal values of the program's own table of keys.
#pragma once
#include <functional>
#include <map>
#include <string>

#include "fuzz/choices.hpp"
#include "fuzz/independent_check.hpp"

namespace almesh::fuzz {

struct RandomMotion {
    std::string text;
    // Where it takes a point; none where it does not prescribe that, or where the target is not affine.
    std::function<Point(Point)> place;
};

// By boundary, and for "rest". size: of the mesh; its boundaries: names.
std::map<std::string, RandomMotion> random_motions(Choices& choose, const Mesh& mesh);

// Key -> value as written. A key that makes even a small mesh large or slow stays within bounds of its own.
std::map<std::string, std::string> random_settings(Choices& choose, const Mesh& mesh);

}  // namespace almesh::fuzz
