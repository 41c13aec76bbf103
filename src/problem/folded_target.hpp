// Targets that fold elements by themselves, whatever the nodes inside do: faces of the boundary that are invalid or
// cross, elements whose nodes are all on it. Found and dealt with before solving, as the key `surface` says.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "deck/deck.hpp"
#include "check/freed_nodes.hpp"
#include "constraint/target.hpp"

namespace almesh {

// A target, on its mesh and to be changed.
struct CheckedTarget {
    const Deck& deck;
    int file_degree;  // of the elements in the mesh file
    const Mesh& mesh;
    const std::vector<double>& ideal;  // nodes x dim
    BoundaryTarget& target;
    std::vector<double>& node_target;  // its nodes in units of the file, which change with it
    std::function<bool()> folds_when_refined;  // whether it folds anything still on the mesh refined once more
    bool is_own_ideal;  // the mesh, whose elements are then as good as they need to be
};

// With split = auto, divides elements of the base mesh that the target folds by nodes inside. Returns how many, and
// adds a note; 0 where there are none. The mesh and the target are to be made again from the base.
int split_folded(const CheckedTarget& checked, Mesh& base, std::vector<std::string>& notes);

// Frees the nodes around faces and elements that the target folds to slide along its surface. Returns a note, empty
// where it folds none. Throws InputError where that cannot help, or the deck keeps the surface.
std::string free_folded(const CheckedTarget& checked);

}  // namespace almesh
