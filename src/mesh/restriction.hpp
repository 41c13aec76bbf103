// Some nodes of a mesh move, all others stay where they are: the elements with a node that moves, and the nodes of these
// with numbers of their own. An energy and a constraint that are restricted to them have these numbers.
#pragma once
#include <vector>

namespace almesh {

struct Mesh;

struct Restriction {
    int moving = 0;             // how many nodes move,
    std::vector<int> node;      // here -> mesh: the first ones
    std::vector<int> element;   // here -> mesh, ascending
    std::vector<int> elements;  // the nodes of each element, numbers of here

    // Positions of nodes, of these from and to those of the mesh (nodes x dim each): of all, and of those that move.
    std::vector<double> all(const std::vector<double>& x, int dim) const;
    std::vector<double> read(const std::vector<double>& x, int dim) const;
    void write(const std::vector<double>& y, int dim, std::vector<double>& x) const;
};

// Elements of one type: count x m node numbers.
struct CellNodes {
    const int* elements;
    int count, m;
};

// types: the elements of the mesh, one type after the other. moves: per node of the mesh.
Restriction restriction_to(const std::vector<char>& moves, const std::vector<CellNodes>& types);
Restriction restriction_to(const std::vector<char>& moves, const Mesh& mesh);

}  // namespace almesh
