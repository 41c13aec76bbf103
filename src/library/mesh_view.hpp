// A mesh as its caller has it (almesh.h): nodes and elements in ascending order of their ids in the file or in the
// arrays, nodes of no element included, and then the nodes that the file does not have.
#pragma once
#include <string>
#include <vector>

#include "mesh/inner_boundary.hpp"
#include "mesh/raw_mesh.hpp"

namespace almesh {

// Cell k has the nodes node[offset[k]] ... node[offset[k + 1] - 1].
struct CellList {
    std::vector<int> type, offset = {0}, node;  // type: of Cell in almesh.hpp

    void add(const CellType& cell, const int* nodes, const std::vector<int>& place, int degree);
};

struct MeshView {
    int dim = 0, degree = 0;
    std::vector<double> x, first;  // nodes x dim in units of the file: as they are, and as they were read
    std::vector<long long> node_id, element_id;
    std::vector<int> node, element;  // of the mesh's, their places here
    CellList elements;
    std::vector<std::string> boundary_names;
    std::vector<CellList> boundaries;
    std::vector<GroupCells> volumes;

    MeshView() = default;
    // base: the mesh of `raw`, of which this one is made; first_x: of its own nodes.
    MeshView(const Mesh& mesh, const RawMesh& raw, const Mesh& base, const std::vector<double>& first_x);

    // Puts values in the mesh's order, `size` of each, at their places; and takes those of nodes from there.
    static void put(const std::vector<double>& values, int size, const std::vector<int>& place,
                    std::vector<double>& to);
    std::vector<double> to_mesh(const double* values) const;
};

}  // namespace almesh
