// Some elements of a mesh, curved as a separate problem: nodes that they share with others are fixed.
#pragma once
#include <vector>

#include "check/certificate.hpp"
#include "mesh/part.hpp"
#include "problem/problem.hpp"
#include "check/infeasible.hpp"

namespace almesh {

double work_of(const Mesh& mesh, int e);  // blocks of the element's Hessian

// Divides the chosen elements into sets connected by vertices, each of at most `at_once` elements and with the work of
// at most so many tetrahedra of degree 3.
std::vector<std::vector<int>> places_of(const Mesh& mesh, const std::vector<char>& chosen, std::size_t at_once);

struct CurvedPart : MeshPart {  // in the run's frame; x: the straight-sided form
    // Nodes x dim: as in the file, at present, and with the boundary on its target.
    std::vector<double> in_file, start, curved;
    std::vector<char> freed;  // per node: whether it slides along the whole's surfaces; empty: none

    // chosen: per element of the whole, at x now. to: of the whole's boundary.
    CurvedPart(const Problem& whole, const std::vector<char>& chosen, const std::vector<double>& at,
               const std::vector<double>& to);

    // All boundaries fixed at these positions, but for nodes that are freed.
    BoundaryTarget fixed_at(const std::vector<double>& positions) const;

    // What is infeasible with the positions `curved` of nodes that are not freed. bound: as of the mesh.
    Infeasible find_infeasible(double bound) const;

    // Per node: whether it is on a face of an infeasible element; around: or on a face beside these, as nodes_to_free()
    // of a mesh has it. Nodes on the cut are excluded by free_nodes() only.
    std::vector<char> nodes_to_free(const Infeasible& infeasible, bool around) const;

    // Frees the chosen nodes that are not on the cut. Their target is their position in the file: at others, their
    // surfaces may fix them.
    void free_nodes(std::vector<char> chosen);

    // The same of boundary nodes chosen among those of the whole.
    void free_nodes_in(const std::vector<char>& of_whole, bool vertices_too);

    // Moves `curved` towards the straight-sided form until it makes no element invalid by itself.
    void flatten(double bound);
};


struct CurvedPartResult {
    std::vector<double> x;  // nodes x dim of the part
    AlResult al;
    // Valid only where it is injective too, and every node of the boundary in its place or on its surfaces.
    Certificate certificate;
};

// surfaces: of the whole, along which freed nodes slide; may be null where there are none. The part is given up where
// its boundary is not near its target after the first Newton steps, with a small penalty.
CurvedPartResult curve(const ProblemOptions& options, const CurvedPart& part, const SlidingSurfaces* surfaces,
                       int first_steps);

}  // namespace almesh
