// The sides of all elements, the boundary faces and the wanted kept faces are sorted by their vertices; those with the
// same vertices are one face, whose groups are those of all of them.
#include "mesh/inner_boundary.hpp"

#include <algorithm>
#include <map>
#include <set>

#include "base/text.hpp"
#include "mesh/kept_cells.hpp"
#include "mesh/raw_mesh.hpp"
#include "mesh/sides.hpp"

namespace almesh {
namespace {

using Names = std::vector<std::string>;

bool has(const Names& names, const std::string& name) {
    return std::find(names.begin(), names.end(), name) != names.end();
}

// Of a cell of the file: of its entity, or its own.
Names groups_of(const FileTags& file, int dim, int physical, int entity) {
    Names names;
    const FileEntity* const listed = find_entity(file.entities, dim, entity);
    const std::vector<int> own = {physical};
    for (const int tag : listed && !listed->physical.empty() ? listed->physical : own)
        if (tag > 0) names.push_back(group_name(file.groups, dim, tag));
    return names;
}

// Sorts cells of one dimension into their groups; the names are looked up once for each pair of tags.
class GroupList {
public:
    GroupList(const FileTags& file, int dim) : file_(file), dim_(dim) {}

    void add(int physical, int entity, int cell) {
        const auto [known, is_new] = of_tags_.try_emplace({physical, entity});
        if (is_new)
            for (const std::string& name : groups_of(file_, dim_, physical, entity))
                known->second.push_back(index(name));
        for (const int g : known->second) groups[g].cells.push_back(cell);
    }

    std::vector<GroupCells> groups;

private:
    const FileTags& file_;
    int dim_;
    std::map<std::array<int, 2>, std::vector<int>> of_tags_;

    int index(const std::string& name) {
        const GroupCells* const same = find_row(groups, name);
        if (!same) groups.push_back({name, {}});
        return static_cast<int>((same ? same : &groups.back()) - groups.data());
    }
};

struct InnerFace {
    std::array<int, 2> side;  // element * most_sides + local number, of the one that it belongs to and of the other
    Names groups;
    int kept;  // among the kept faces; -1: not in the file
};

struct InnerBuilder {
    Mesh& mesh;
    const Names& groups;
    const Names& volumes;
    const bool between_groups;
    const int dim = mesh.dim, most_sides = mesh.most_sides();
    const std::vector<KeptFace> kept = kept_faces(mesh);
    const SideNodes side_nodes{dim, mesh.degree};
    std::vector<Names> volumes_of{};  // per element: of those wanted
    Names region{};                   // per element, where the sides between regions are wanted
    std::vector<InnerFace> inner{};
    std::set<std::pair<const CellType*, int>> taken{};  // kept faces that are boundary faces now: KeptFace::place

    void find_volumes() {
        volumes_of.resize(mesh.element_count());
        for (const GroupCells& group : volume_groups(mesh))
            for (const int e : group.cells)
                if (has(volumes, group.name)) volumes_of[e].push_back(volume_group(group.name));
    }

    void find_regions() {
        if (!between_groups) return;
        region.resize(mesh.element_count());
        for (const GroupCells& group : volume_groups(mesh))
            for (const int e : group.cells) region[e] += (region[e].empty() ? "" : " + ") + group.name;
        for (std::string& name : region)
            if (name.empty()) name = "the rest";
    }

    // Of the elements on both sides of a face; none where they are of the same region.
    Names between(const std::array<int, 2>& side) const {
        if (!between_groups || side[1] < 0) return {};
        const auto [first, last] = std::minmax(region[side[0] / most_sides], region[side[1] / most_sides]);
        if (first == last) return {};
        return {"between " + first + " and " + last};
    }

    void find_faces() {
        std::vector<Side> sides;
        const int first_face = mesh.element_count() * most_sides, first_kept = first_face + mesh.face_count();
        for_sides(mesh, [&](int e, int k, int number) { sides.push_back(side_of_element(mesh, e, k, number)); });
        for (int f = 0; f < mesh.face_count(); ++f) sides.emplace_back(mesh.face_vertices(f), first_face + f);
        for (const KeptFace& face : kept)
            sides.emplace_back(face.vertices(), first_kept + static_cast<int>(&face - kept.data()));
        for_equal_sides(sides, [&](std::span<const Side> equal) {
            InnerFace found{{-1, -1}, {}, -1};
            int face = -1, elements = 0;
            for (const Side& side : equal) {
                if (side.number < first_face) {
                    if (elements < 2) found.side[elements++] = side.number;
                    for (const std::string& name : volumes_of[side.number / most_sides])
                        if (!has(found.groups, name)) found.groups.push_back(name);
                } else if (side.number < first_kept) {
                    face = side.number - first_face;
                } else {
                    const int c = side.number - first_kept;
                    for (const std::string& name : groups_of(mesh.file, dim - 1, kept[c].physical, kept[c].entity)) {
                        if (!has(groups, name) || has(found.groups, name)) continue;
                        found.groups.push_back(name);
                        if (found.kept < 0) found.kept = c;
                    }
                }
            }
            if (found.groups.empty()) found.groups = between(found.side);
            if (found.groups.empty()) return;
            if (face >= 0) add_groups(face, found.groups);
            else if (elements == 2) inner.push_back(std::move(found));
        });
    }

    int boundary_with(const Names& of, bool is_inner) {
        for (std::size_t b = 0; b < mesh.boundaries.size(); ++b)
            if (mesh.boundary_groups[b] == of && (mesh.inner[b] != 0) == is_inner) return static_cast<int>(b);
        mesh.inner.push_back(is_inner);
        return add_boundary(mesh, of);
    }

    void add_groups(int face, const Names& more) {
        Names of = mesh.boundary_groups[mesh.face_boundary[face]];
        for (const std::string& name : more)
            if (!has(of, name)) of.push_back(name);
        mesh.face_boundary[face] = boundary_with(of, mesh.is_inner(face));
    }

    // Neighbours of the same groups alike: along the side that they share one goes the other way.
    void orient() {
        constexpr int most = 4;  // sides of a face
        std::vector<Side> sides;
        for (int f = 0; f < static_cast<int>(inner.size()); ++f) {
            const int e = inner[f].side[0] / most_sides, side = inner[f].side[0] % most_sides;
            const CellType& cell = mesh.cell(e).face_type(side);
            int vertices[most];
            for (int k = 0; k < cell.vertices; ++k) vertices[k] = mesh.element(e)[mesh.cell(e).faces[side][k]];
            for (int k = 0; k < static_cast<int>(cell.faces.size()); ++k)
                sides.push_back(side_of_cell(cell, vertices, k, f * most + k));
        }
        std::vector<std::vector<std::pair<int, bool>>> neighbours(inner.size());  // and whether they are alike
        for_equal_sides(sides, [&](std::span<const Side> equal) {
            if (equal.size() != 2) return;
            const auto direction = [&](const Side& s) { return dim == 2 ? s.number % most == 0 : s.even; };
            const int f = equal[0].number / most, g = equal[1].number / most;
            if (inner[f].groups != inner[g].groups) return;
            const bool alike = direction(equal[0]) != direction(equal[1]);
            neighbours[f].push_back({g, alike});
            neighbours[g].push_back({f, alike});
        });
        std::vector<int> turned(inner.size(), -1);  // -1: not known yet
        for (int first = 0; first < static_cast<int>(inner.size()); ++first) {
            if (turned[first] >= 0) continue;
            turned[first] = 0;
            for (std::vector<int> front = {first}; !front.empty();) {
                const int f = front.back();
                front.pop_back();
                for (const auto& [g, alike] : neighbours[f]) {
                    if (turned[g] >= 0) continue;
                    turned[g] = alike ? turned[f] : !turned[f];
                    front.push_back(g);
                }
            }
        }
        for (std::size_t f = 0; f < inner.size(); ++f)
            if (turned[f]) std::swap(inner[f].side[0], inner[f].side[1]);
    }

    void append() {
        std::stable_partition(inner.begin(), inner.end(), [](const InnerFace& face) { return face.kept >= 0; });
        std::vector<const CellType*> types;  // of all faces
        for (int f = 0; f < mesh.face_count(); ++f) types.push_back(&mesh.face_cell(f));
        for (const InnerFace& face : inner) {
            const int e = face.side[0] / most_sides, side = face.side[0] % most_sides, c = face.kept;
            const CellType& cell = mesh.cell(e).face_type(side);
            for (const int k : side_nodes.of(mesh.cell(e), side)) mesh.faces.push_back(mesh.element(e)[k]);
            types.push_back(&cell);
            mesh.face_element.push_back(e);
            mesh.face_boundary.push_back(boundary_with(face.groups, true));
            mesh.file.face_id.push_back(c < 0 ? 0 : kept[c].id);
            mesh.file.face_physical.push_back(c < 0 ? not_in_file : kept[c].physical);
            mesh.file.face_entity.push_back(c < 0 ? 0 : kept[c].entity);
            if (c >= 0) taken.insert({kept[c].cell, kept[c].place});
        }
        group_faces(mesh, types);
    }

    void take_out_of_kept() {
        for (KeptCells& rest : mesh.kept) {
            const CellType& cell = mesh.cell_of(rest);
            const KeptCells all = std::move(rest);
            rest = {};
            const int width = cell.node_count(mesh.degree);
            for (int c = 0; c < all.count(); ++c) {
                if (taken.contains({&cell, c})) continue;
                rest.nodes.insert(rest.nodes.end(), &all.nodes[offset(c, width)], &all.nodes[offset(c, width)] + width);
                append_tags(all, c, rest);
            }
        }
    }
};

}  // namespace

std::vector<GroupCells> inner_groups(const Mesh& mesh) {
    const std::vector<KeptFace> kept = kept_faces(mesh);
    std::vector<Side> sides;
    for (int f = 0; f < mesh.face_count() && !kept.empty(); ++f) sides.emplace_back(mesh.face_vertices(f), -1);
    for (const KeptFace& face : kept) sides.emplace_back(face.vertices(), static_cast<int>(&face - kept.data()));
    std::vector<int> inside;
    for_equal_sides(sides, [&](std::span<const Side> equal) {
        for (const Side& side : equal)
            if (equal[0].number >= 0) inside.push_back(side.number);
    });
    std::sort(inside.begin(), inside.end());
    GroupList list(mesh.file, mesh.dim - 1);
    for (const int c : inside) list.add(kept[c].physical, kept[c].entity, c);
    return std::move(list.groups);
}

std::vector<GroupCells> volume_groups(const Mesh& mesh) {
    GroupList list(mesh.file, mesh.dim);
    for (int e = 0; e < mesh.element_count(); ++e)
        list.add(mesh.file.element_physical[e], mesh.file.element_entity[e], e);
    const KeptCells& again = mesh.kept[mesh.dim];
    for (int c = 0; c < again.count(); ++c) list.add(again.physical[c], again.entity[c], again.element[c]);
    for (GroupCells& group : list.groups) {  // an element may be in a group twice
        std::sort(group.cells.begin(), group.cells.end());
        group.cells.erase(std::unique(group.cells.begin(), group.cells.end()), group.cells.end());
    }
    return std::move(list.groups);
}

void make_inner_boundaries(Mesh& mesh, const Names& groups, const Names& volumes, bool between_groups) {
    mesh.inner.assign(mesh.boundaries.size(), 0);
    InnerBuilder builder{mesh, groups, volumes, between_groups};
    builder.find_volumes();
    builder.find_regions();
    builder.find_faces();
    builder.orient();
    builder.append();
    builder.take_out_of_kept();
}

}  // namespace almesh
