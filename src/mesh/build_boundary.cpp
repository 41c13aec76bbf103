// The faces of all elements and the tagged faces of the file, both called sides here, are sorted by their vertices, for
// each lowest vertex separately. Sides of equal vertices are then neighbours: two elements on opposite sides of a face
// inside the mesh, or one element and its tagged faces on the boundary. A boundary of the mesh is the faces that have
// the same groups. Side::number: e * Mesh::most_sides() + k for side k of element e; tagged faces are numbered after
// these.
#include "mesh/build_boundary.hpp"

#include <algorithm>
#include <map>
#include <set>

#include "base/disjoint_sets.hpp"
#include "base/files.hpp"
#include "base/parallel.hpp"
#include "linalg/ordering/graph.hpp"
#include "mesh/sides.hpp"

namespace almesh {
namespace {

// What the sides of some vertices amount to.
struct Matched {
    std::vector<std::array<int, 2>> untagged;  // boundary sides in no group, and the face that the file has there or -1
    std::vector<std::array<int, 2>> folded;  // elements on the same side of their common face
    std::vector<int> inside;                 // faces of the file inside the mesh, and those in no group that fit none
    std::vector<int> loose;                  // tagged faces that are the face of no element
    std::vector<int> repeated;               // elements that have the vertices of one with a lower id
    std::vector<std::array<int, 2>> copies;  // tagged faces on the boundary: that with the lowest id, and another one

    void append(const Matched& other) {
        const auto add = [](auto& all, const auto& some) { all.insert(all.end(), some.begin(), some.end()); };
        add(untagged, other.untagged);
        add(folded, other.folded);
        add(inside, other.inside);
        add(loose, other.loose);
        add(repeated, other.repeated);
        add(copies, other.copies);
    }
};

struct BoundaryMatcher {
    explicit BoundaryMatcher(const MeshBuild& of) : build(of), side_of_face(of.faces.size(), -1) {}

    const MeshBuild& build;
    const Mesh& mesh = build.mesh;
    const int dim = mesh.dim, most_sides = mesh.most_sides(), first_tagged = mesh.element_count() * most_sides;
    const SideNodes side_nodes{dim, mesh.degree};
    std::vector<int> side_of_face;  // by tagged face: number of its element's side, -1: dropped, or in no group

    const RawElement& element_of(const Side& side) const { return build.element(side.number / most_sides); }
    const RawElement& tagged_face(const Side& side) const { return build.face(side.number - first_tagged); }

    // Whether two elements have the same vertices.
    bool are_copies(int e, int f) const {
        const std::span a(mesh.element(e), mesh.cell(e).vertices), b(mesh.element(f), mesh.cell(f).vertices);
        return a.size() == b.size() && std::all_of(a.begin(), a.end(), [&](int v) {
            return std::find(b.begin(), b.end(), v) != b.end();
        });
    }

    const CellType& cell_of(int number) const {
        if (number >= first_tagged) return build.face(number - first_tagged).cell();
        return mesh.cell(number / most_sides).face_type(number % most_sides);
    }

    // Node k of a side in Gmsh's order; -1 where a tagged face has a node that no element has.
    int node_of(int number, int k) const {
        const int e = number / most_sides;
        if (number < first_tagged) return mesh.element(e)[side_nodes.of(mesh.cell(e), number % most_sides)[k]];
        return build.node[build.raw.element_nodes[build.face(number - first_tagged).first + k]];
    }

    Side side(int number) const {
        if (number < first_tagged) return side_of_element(mesh, number / most_sides, number % most_sides, number);
        std::array<int, 4> vertex{};
        const int count = cell_of(number).vertices;
        for (int k = 0; k < count; ++k) vertex[k] = node_of(number, k);
        return {std::span(vertex).first(count), number};
    }

    // All nodes of a side, ascending.
    std::vector<int> nodes_of(int number) const {
        std::vector<int> nodes;
        for (int k = 0; k < cell_of(number).node_count(mesh.degree); ++k) nodes.push_back(node_of(number, k));
        std::sort(nodes.begin(), nodes.end());
        return nodes;
    }

    // Finds elements that have the vertices of others with a lower id among sides that have the same vertices.
    bool has_repeated(std::span<const Side> equal, std::vector<int>& repeated) const {
        const std::size_t before = repeated.size();
        for (std::size_t b = 1; b < equal.size(); ++b)
            for (std::size_t a = 0; a < b; ++a)
                if (const int e = equal[a].number / most_sides, f = equal[b].number / most_sides; are_copies(e, f))
                    repeated.push_back(build.element(e).id < build.element(f).id ? f : e);
        return repeated.size() > before;
    }

    void check_elements(std::span<const Side> equal) const {
        if (equal.size() > 2)
            build.refuse(element_of(equal[2]), "is the third at the face with the nodes ",
                         build.node_ids(equal[0].vertex.data(), cell_of(equal[0].number).vertices), ", after ",
                         name_of(element_of(equal[0])), " and ", name_of(element_of(equal[1])));
        if (equal.size() == 2 && equal[0].opposite != equal[1].opposite)
            build.refuse(element_of(equal[1]), "and ", name_of(element_of(equal[0])), " have the vertices ",
                         build.node_ids(equal[0].vertex.data(), 4), " of a common face in different orders around it");
        if (equal.size() == 2 && mesh.degree > 1 && nodes_of(equal[0].number) != nodes_of(equal[1].number))
            build.refuse(element_of(equal[1]), "and ", name_of(element_of(equal[0])),
                         " share the vertices of a face, but not its other nodes");
    }

    // Whether the two have the same nodes, which is refused of faces in a group that do not.
    bool is_face(const Side& element, const Side& tagged) const {
        const bool other_order = tagged.opposite != element.opposite;
        if (!other_order && nodes_of(tagged.number) == nodes_of(element.number)) return true;
        if (tagged_face(tagged).physical == 0) return false;
        build.refuse(tagged_face(tagged), "has the vertices of a face of ", name_of(element_of(element)),
                     other_order ? ", but in another order around it" : ", but not its other nodes");
    }

    // Of sides in no group: tells that some lie on each other, as where parts of a mesh were never joined; else "".
    std::string doubled_text(const std::vector<std::array<int, 2>>& untagged) const {
        const auto is_before = [&](int i, int j) {
            const double *const a = point(mesh.x, i, dim), *const b = point(mesh.x, j, dim);
            return std::lexicographical_compare(a, a + dim, b, b + dim);
        };
        using Vertices = std::vector<int>;  // in the order of their positions, then of their numbers
        const auto lies_before = [&](const Vertices& f, const Vertices& g) {
            return std::lexicographical_compare(f.begin(), f.end(), g.begin(), g.end(), is_before);
        };
        std::vector<Vertices> faces;
        for (const auto& [side, face] : untagged) {
            Vertices& v = faces.emplace_back();
            for (int k = 0; k < cell_of(side).vertices; ++k) v.push_back(node_of(side, k));
            std::sort(v.begin(), v.end(), is_before);
        }
        std::stable_sort(faces.begin(), faces.end(), lies_before);
        std::size_t pairs = 0;
        std::array<int, 2> nodes{};  // of the first pair, at one point
        for (std::size_t f = 1; f < faces.size(); ++f) {
            const Vertices &a = faces[f - 1], &b = faces[f];
            if (lies_before(a, b) || ++pairs > 1) continue;
            const auto [i, j] = std::mismatch(a.begin(), a.end(), b.begin());
            if (i != a.end()) nodes = {*i, *j};
        }
        if (pairs == 0) return "";
        return concat(counted(pairs, "pair"), pairs == 1 ? " lies" : " lie", " on each other, as nodes ",
                      build.node_ids(nodes.data(), 2), " are at one point: unless the mesh is to be cut there, "
                      "join such nodes (in gmsh: Coherence Mesh)");
    }

    // "4 boundary faces without a physical curve are the boundary ...".
    std::string untagged_text(const std::vector<std::array<int, 2>>& untagged, const std::string& name) const {
        const int first = (*std::min_element(untagged.begin(), untagged.end()))[0], count = cell_of(first).vertices;
        int vertex[4];
        for (int k = 0; k < count; ++k) vertex[k] = node_of(first, k);
        const std::array<double, 3> mean = centroid(mesh, mesh.x, vertex, count);
        return concat(counted(untagged.size(), "boundary face"), " in no group ", untagged.size() == 1 ? "is" : "are",
                      " the boundary ", with_quotes(name), ", the first has the nodes ", build.node_ids(vertex, count),
                      " and the centre ", position_text(mean.data(), dim));
    }

    // Sides that have the same vertices: those of elements first.
    void match_equal(std::span<const Side> equal, Matched& found) {
        const auto is_tagged = [&](const Side& s) { return s.number >= first_tagged; };
        const std::size_t count = std::find_if(equal.begin(), equal.end(), is_tagged) - equal.begin();
        const std::span<const Side> of_elements = equal.first(count), tagged = equal.subspan(count);
        if (count == 0) {
            for (const Side& s : tagged) found.loose.push_back(s.number - first_tagged);
            return;
        }
        if (count > 1 && has_repeated(of_elements, found.repeated)) return;
        check_elements(of_elements);
        if (count == 2) {
            for (const Side& s : tagged) found.inside.push_back(s.number - first_tagged);
            if (equal[0].even == equal[1].even)
                found.folded.push_back({equal[0].number / most_sides, equal[1].number / most_sides});
        } else {
            std::vector<int> faces;
            for (const Side& s : tagged) (is_face(equal[0], s) ? faces : found.inside).push_back(s.number - first_tagged);
            const auto rank = [this](int f) { return std::pair(build.face(f).physical == 0, build.face(f).id); };
            std::sort(faces.begin(), faces.end(), [&](int f, int g) { return rank(f) < rank(g); });
            for (std::size_t k = 1; k < faces.size(); ++k) found.copies.push_back({faces[0], faces[k]});
            const int face = faces.empty() ? -1 : faces[0];
            if (face < 0 || build.face(face).physical == 0) found.untagged.push_back({equal[0].number, face});
            else side_of_face[face] = equal[0].number;
        }
    }

    // The sides go to their lowest vertices by a counting sort, then blocks of vertices are matched in parallel.
    Matched match() {
        constexpr int block = 256;
        const int count = first_tagged + static_cast<int>(build.faces.size());
        std::vector<int> lowest(count);
        parallel_for(count, [&](int s) {
            const bool is_none = s < first_tagged &&  // of elements with fewer sides than others
                                 s % most_sides >= static_cast<int>(mesh.cell(s / most_sides).faces.size());
            lowest[s] = is_none ? mesh.nodes() : side(s).vertex[0];
        });
        Matched all;
        for (int s = first_tagged; s < count; ++s)
            if (lowest[s] < 0) {
                all.loose.push_back(s - first_tagged);
                lowest[s] = mesh.nodes();
            }
        const Groups sorted = sorted_by_group(lowest, mesh.nodes() + 1);

        std::vector<Matched> found((mesh.nodes() + block - 1) / block);
        parallel_for_throwing(static_cast<int>(found.size()), [&](int b) {
            std::vector<Side> sides;
            for (int v = b * block, end = std::min(mesh.nodes(), v + block); v < end; ++v) {
                sides.clear();
                for (int s : sorted.of(v)) sides.push_back(side(s));
                for_equal_sides(sides, [&](std::span<const Side> equal) { match_equal(equal, found[b]); });
            }
        }, 1000.0 * block);
        for (const Matched& part : found) all.append(part);
        std::sort(all.loose.begin(), all.loose.end());
        return all;
    }
};

// The side of an element as a face, as the file has it or not; the mesh's types of faces are those of group_faces().
void add_face(const BoundaryMatcher& matcher, int side, int boundary, const RawElement* in_file, Mesh& mesh,
              std::vector<const CellType*>& types) {
    const CellType& cell = matcher.cell_of(side);
    for (int k = 0; k < cell.node_count(mesh.degree); ++k) mesh.faces.push_back(matcher.node_of(side, k));
    types.push_back(&cell);
    mesh.face_element.push_back(side / matcher.most_sides);
    mesh.face_boundary.push_back(boundary);
    mesh.file.face_id.push_back(in_file ? in_file->id : 0);
    mesh.file.face_physical.push_back(in_file ? in_file->physical : not_in_file);
    mesh.file.face_entity.push_back(in_file ? in_file->entity : 0);
}

// Tags of the physical groups of a face: those of its entity, or its own.
const std::vector<int>& tags_of(const RawMesh& raw, const RawElement& face, std::vector<int>& own) {
    const FileEntity* const entity = find_entity(raw.entities, face.dim, face.entity);
    if (entity && !entity->physical.empty()) return entity->physical;
    return own = {face.physical};
}

// The index of the boundary with the given groups, made where there is none.
int boundary_of(const std::vector<int>& tags, int dim, Mesh& mesh) {
    std::vector<std::string> groups;
    for (const int tag : tags) {
        const std::string name = group_name(mesh.file.groups, dim, tag);
        if (std::find(groups.begin(), groups.end(), name) == groups.end()) groups.push_back(name);
    }
    const auto same = std::find(mesh.boundary_groups.begin(), mesh.boundary_groups.end(), groups);
    return same == mesh.boundary_groups.end() ? add_boundary(mesh, groups)
                                              : static_cast<int>(same - mesh.boundary_groups.begin());
}

// The boundary faces in file order, with their nodes as their elements see them.
void fill_faces(const BoundaryMatcher& matcher, const Matched& matched, const RawMesh& raw, Mesh& mesh,
                std::vector<const CellType*>& types) {
    std::map<int, std::vector<int>> more;  // copies by the first face
    for (const auto [first, copy] : matched.copies) more[first].push_back(copy);
    std::map<std::vector<int>, int> boundary_of_tags;
    std::vector<int> tags, own;
    for (int f = 0; f < static_cast<int>(matcher.side_of_face.size()); ++f) {
        const int side = matcher.side_of_face[f];
        if (side < 0) continue;
        const RawElement& face = matcher.build.face(f);
        tags = tags_of(raw, face, own);
        if (const auto copies = more.find(f); copies != more.end())
            for (const int copy : copies->second)
                for (const int tag : tags_of(raw, matcher.build.face(copy), own))
                    if (tag && std::find(tags.begin(), tags.end(), tag) == tags.end()) tags.push_back(tag);
        std::sort(tags.begin(), tags.end());
        const auto [boundary, is_new] = boundary_of_tags.try_emplace(tags, -1);
        if (is_new) boundary->second = boundary_of(tags, face.dim, mesh);
        add_face(matcher, side, boundary->second, &face, mesh, types);
    }
}

// Boundary faces in no group. Beside others that are in one: a boundary of their own. Where there are no others: their
// parts that hang together by vertices, numbered by their lowest nodes.
void fill_untagged(const BoundaryMatcher& matcher, const std::vector<std::array<int, 2>>& sides, MeshBuild& build,
                   std::vector<const CellType*>& types) {
    Mesh& mesh = build.mesh;
    const bool beside_others = !mesh.faces.empty();
    DisjointSets connected(mesh.nodes());
    for (const auto& [side, face] : sides)
        for (int k = 1; k < matcher.cell_of(side).vertices; ++k)
            connected.join(matcher.node_of(side, 0), matcher.node_of(side, k));
    std::map<int, std::vector<std::array<int, 2>>> parts;  // by lowest node
    for (const auto& side : sides)
        parts[beside_others ? 0 : connected.find(matcher.node_of(side[0], 0))].push_back(side);
    constexpr std::size_t most_told = 20;
    std::size_t told = 0;
    std::string note;
    for (const auto& [lowest, of_part] : parts) {
        std::string name = beside_others ? "untagged" : "boundary";
        if (parts.size() > 1) name += concat("-", mesh.boundaries.size() + 1);
        while (mesh.boundary_index(name) >= 0) name += "-2";
        const int boundary = add_boundary(mesh, {name});
        if (++told <= most_told)
            note += concat(note.empty() ? "" : ", ", name, " (", counted(of_part.size(), "face"), ")");
        else if (told == parts.size()) note += concat(" and ", told - most_told, " more");
        for (const auto& [side, face] : of_part)
            add_face(matcher, side, boundary, face < 0 ? nullptr : &build.face(face), mesh, types);
    }
    build.notes.push_back(beside_others
                              ? matcher.untagged_text(sides, mesh.boundaries.back())
                              : "no tagged boundary faces: the boundary is that of the elements, in parts: " + note);
    if (const std::string doubled = matcher.doubled_text(sides); !doubled.empty())
        build.notes.push_back("of the boundary's faces, " + doubled);
}

// Faces that do not match: throws InputError, naming both elements, where a boundary face is a triangle on three
// vertices of a quadrilateral one: the two sides of a face inside the domain, which seem to be boundaries as they do
// not match. Cost: O(faces log faces), none where all faces are of one type.
void refuse_hanging_faces(const MeshBuild& build) {
    const Mesh& mesh = build.mesh;
    if (mesh.face_groups().size() < 2) return;
    std::vector<Side> triples;  // the triangles, and those of the vertices of each quadrilateral
    for (int f = 0; f < mesh.face_count(); ++f) {
        const std::span<const int> vertex = mesh.face_vertices(f);
        for (std::size_t left_out = 0; vertex.size() == 4 && left_out < 4; ++left_out) {
            std::array<int, 3> triple{};
            std::copy_if(vertex.begin(), vertex.end(), triple.begin(), [&](int v) { return v != vertex[left_out]; });
            triples.emplace_back(triple, f);
        }
        if (vertex.size() == 3) triples.emplace_back(vertex, f);
    }
    for_equal_sides(triples, [&](std::span<const Side> equal) {
        const auto is_triangle = [&](const Side& side) { return mesh.face_cell(side.number).is_simplex(); };
        const auto triangle = std::find_if(equal.begin(), equal.end(), is_triangle);
        const auto other = std::find_if_not(equal.begin(), equal.end(), is_triangle);
        if (triangle == equal.end() || other == equal.end()) return;
        const auto nodes_of = [&](int f) { return build.node_ids(mesh.face(f), mesh.face_cell(f).vertices); };
        const int e = mesh.face_element[triangle->number], q = mesh.face_element[other->number];
        build.refuse(build.element(e), "has the face with the nodes ", nodes_of(triangle->number),
                     ", half of the face ", nodes_of(other->number), " of ", name_of(build.element(q)),
                     ": faces must match; put a pyramid on that one (gmsh does where tetrahedra meet recombined "
                     "surfaces), or cut its element into tetrahedra");
    });
}

}  // namespace

std::string MeshBuild::node_ids(const int* nodes, int count) const {
    std::string text;
    for (int k = 0; k < count; ++k) text += (k ? ", " : "") + std::to_string(mesh.file.node_id[nodes[k]]);
    return text;
}

std::string name_of(const RawElement& element) {
    return concat("element ", element.id, element.line ? concat(" (line ", element.line, ")") : "");
}

std::vector<std::array<int, 2>> fill_boundary(MeshBuild& build) {
    BoundaryMatcher matcher(build);
    Matched all = matcher.match();
    std::sort(all.repeated.begin(), all.repeated.end());
    all.repeated.erase(std::unique(all.repeated.begin(), all.repeated.end()), all.repeated.end());
    for (const int e : all.repeated) build.repeated.push_back(build.elements[e]);
    if (!all.repeated.empty()) return {};
    for (const int f : all.inside) build.kept.push_back(build.faces[f]);
    for (const auto [first, copy] : all.copies) build.kept.push_back(build.faces[copy]);
    if (!all.loose.empty())
        build.notes.push_back(concat(counted(all.loose.size(), "face"), " of the file ",
                                     all.loose.size() == 1 ? "is the face" : "are faces", " of no ",
                                     build.mesh.groups.size() > 1 ? "element" : build.mesh.cell().name,
                                     ", the first is ", name_of(build.face(all.loose[0])),
                                     ": left out"));
    std::vector<const CellType*> types;  // of the faces
    fill_faces(matcher, all, build.raw, build.mesh, types);
    if (!all.untagged.empty()) fill_untagged(matcher, all.untagged, build, types);
    group_faces(build.mesh, types);
    refuse_hanging_faces(build);
    return std::move(all.folded);
}

}  // namespace almesh
