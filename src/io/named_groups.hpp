// Groups of cells by name, of which a cell may have several: what sets, surfaces and regions of files become.
#pragma once
#include <array>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "mesh/raw_mesh.hpp"
#include "mesh/sides.hpp"

namespace almesh {

class NamedGroups {
public:
    explicit NamedGroups(RawMesh& mesh) : mesh_(mesh) {}

    // element: an index into RawMesh::elements. Control characters in names, which decks cannot have, become _.
    void add(std::string name, int element);

    // Side k of an element (CellType::faces) becomes a face of its own, but where two of its vertices are one node.
    // Call these once serendipity cells are complete.
    void add_side(const std::string& name, int element, int k);
    void add_outer_sides(const std::string& name, int element);  // those that no other element has

    // Each set of nodes has as sides those outer ones of whose nodes below `count` it has all, but not where these are
    // all outer sides of the mesh. Cost: a sort of all sides.
    using NodeSets = std::vector<std::pair<std::string, std::vector<int>>>;
    void add_sides(const NodeSets& sets, std::size_t count);

    // The physical groups and entities of the mesh: an entity for all cells that are in the same groups.
    void finish();

private:
    using ElementSide = std::array<int, 2>;
    std::vector<int> nodes_of_side(ElementSide side);
    const std::vector<ElementSide>& outer_sides();

    RawMesh& mesh_;
    long long last_id_ = 0;
    std::vector<std::vector<int>> of_;                       // by element: tags of its groups
    std::map<std::pair<int, std::string>, int> tags_;        // by dimension and name
    std::map<ElementSide, int> sides_;                       // the faces that are sides
    std::vector<ElementSide> outer_;
    std::map<std::pair<int, int>, SideNodes> side_nodes_;    // by dimension and degree
};

}  // namespace almesh
