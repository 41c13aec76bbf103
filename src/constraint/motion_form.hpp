// A kind of step of a motion: how it is written, what it takes, and how it moves a point. The table of them is in
// motion.cpp.
#pragma once
#include <span>

#include "base/small_matrix.hpp"
#include "constraint/motion.hpp"

namespace almesh {

using Step = const MotionStep&;

struct MotionForm {
    const char* name;
    const char* form;  // as it is written
    const char* meaning;
    std::size_t fewest = 0, most = 0;  // numbers after the name
    bool axis = false, about = false;  // whether these clauses may follow
    bool per_axis = false;             // its numbers are one for each axis, or a single one where that is allowed
    bool turns = false;                // its first number is an angle in degrees
    bool twists = false;               // its first number is a rate, a part of which is a part of the motion
    bool file = false;                 // the name of a file comes first
    bool mesh = false;                 // which is a mesh
    bool along = false;                // a mesh and one of its boundaries may be named
    bool onto = false;                 // whose file comes first, on which the nodes do not lie yet
    bool formulas = false;             // formulas in double quotes, one for each axis, in place of numbers
    bool affine = true;                // it takes polynomials to polynomials of the same degree
    int projection_in = 0;             // the dimension a projection acts in; so many leading numbers are its centre
    NodeKind kind = NodeKind::target;  // of the nodes, by the last step of a motion
    // Why its numbers make no sense, whatever the dimension; "" where they do.
    const char* (*fault)(Step) = [](Step) { return ""; };
    // Moves a point given relative to the centre; false where its image is undefined. nullptr: every point stays.
    bool (*move)(Step, Vec<3>& d) = nullptr;
};

extern const std::span<const MotionForm> form_table;

}  // namespace almesh
