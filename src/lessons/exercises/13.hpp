// Exercises of lesson 13: a checker that trusts nobody. Answers go into 13.cpp; `make check-lesson-13` says which hold.
#pragma once
#include <array>
#include <string>
#include <vector>

namespace almesh::lessons {

// Coordinates are whole numbers, at most 2^60 by absolute value: binary fractions times a power of two. A Wide has 128
// bits; both compilers have it on machines of 64 bits.
__extension__ typedef __int128 Wide;
using Point = std::array<long long, 2>;
using Segment = std::array<Point, 2>;
using Edge = std::array<int, 2>;  // two nodes
using Triangle = std::array<int, 3>;

// 13.1 The sign of det(b - a, c - a), exactly: 1 where a, b, c go around counter-clockwise, -1 clockwise, 0 where they
// lie on a line.
int orientation(const Point& a, const Point& b, const Point& c);

// 13.2 Whether two segments, with their ends, have a point in common. They may touch or lie on a line, and the two ends
// of a segment may be the same point.
bool have_common_point(const Segment& s, const Segment& t);

// 13.3 The edges of the boundary of a triangulation whose triangles all go around counter-clockwise, in any order, each
// from its first node to its second with the triangle on the left. Empty where more than two triangles have an edge, or
// two lie on the same side of it. Numbers of nodes are not negative, and may be as large as an int. A mesh may have
// many thousand triangles.
std::vector<Edge> boundary_edges(const std::vector<Triangle>& triangles);

// 13.4 How often the point y is covered by a mesh whose boundary is given, every edge with its triangle on the left. y
// is not on the boundary. The edges are in any order.
int cover_number(const std::vector<Segment>& boundary, const Point& y);

struct Triangulation {
    std::vector<Point> x;  // of the nodes, at most 2^58 by absolute value; a node need not be in any triangle
    std::vector<Triangle> triangles;
};

// 13.5 The certificate of a mesh. True where all of this holds, false where any of it does not:
//   - the nodes of each triangle go around counter-clockwise, none is flat;
//   - no edge has more than two triangles, or two on the same side;
//   - two edges of the boundary have no point in common but nodes (numbers, not places) that belong to both;
//   - just inside of each edge of the boundary, points are covered once.
bool proved_injective(const Triangulation& mesh);

// 13.6 A triangle of degree 2, as in exercise 9.6: vertices 0, 1, 2, then the nodes of its edges 01, 12, 20. Coordinates
// are at most 2^30 by absolute value.
using QuadraticTriangle = std::array<Point, 6>;

// Whether `tree` proves det J > 0 on all of the triangle. "." claims that all six Bernstein coefficients are positive.
// "ab" and two trees, without blanks: the piece is bisected at the edge between its corners a and b (0, 1 or 2), and
// the trees are those of the half that keeps a, then of the half that keeps b; the middle of the edge takes the place
// of the other corner. False for what is no tree, and for one with more than 25 bisections one inside the other.
bool proves_positive(const QuadraticTriangle& x, const std::string& tree);

struct CurvedMesh {
    std::string text;  // of the file
    std::vector<long long> id;
    std::vector<QuadraticTriangle> elements;
};

// Whether the proof, the text of a file, proves det J > 0 in every element of this mesh. Its lines, each with a newline
// at its end, words separated by one blank: "almesh proof 1", "version " and anything, "hash H", "elements N", then
// lines "element ID TREE" in any order, then "end L". H is the hash of mesh.text: h = 14695981039346656037, then for
// each byte h = (h xor byte) * 1099511628211 modulo 2^64, written with 16 digits 0 to 9, a to f. N is the number of
// elements, L that of all lines. An element without a line has the tree ".". A proof with other lines, with two for an
// element or one for an element that is not there proves nothing.
bool accepts(const CurvedMesh& mesh, const std::string& proof);

}  // namespace almesh::lessons
