// The restriction of a mesh to some nodes that move: the elements with such a node, and the nodes of these elements in
// a numbering of their own, which restricted energies and constraints use.
#pragma once
#include <span>
#include <vector>

namespace almesh {

struct Mesh;

struct Restriction {
    int moving = 0;             // how many nodes move,
    std::vector<int> node;      // here -> mesh: the first ones
    std::vector<int> element;   // here -> mesh, ascending
    std::vector<int> elements;  // the nodes of each element, numbers of here

    // Positions of the nodes that move, from and to those of the mesh, nodes x dim each.
    std::vector<double> read(const std::vector<double>& x, int dim) const;
    void write(const std::vector<double>& y, int dim, std::vector<double>& x) const;
};

// The rows of `field` (nodes x dim) of these nodes.
std::vector<double> at_nodes(std::span<const int> nodes, const std::vector<double>& field, int dim);

// Elements of one type: count x m node numbers.
struct CellNodes {
    const int* elements;
    int count, m;
};

// types: the elements of the mesh, one type after the other. moves: per node of the mesh.
Restriction restriction_to(const std::vector<char>& moves, const std::vector<CellNodes>& types);
Restriction restriction_to(const std::vector<char>& moves, const Mesh& mesh);

}  // namespace almesh
