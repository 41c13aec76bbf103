// The faces of all elements and the tagged faces of the file, both called sides here, are sorted by their vertices, for
// each lowest vertex separately. Sides of equal vertices are then neighbours: two elements on opposite sides of a face
// inside the mesh, or one element and a tagged face (or several of one tag) on the boundary. All else is an error.
// Side::number: e * (dim + 1) + k for face k of element e; tagged faces are numbered after these.
#include "mesh/build_boundary.hpp"

#include <algorithm>
#include <map>
#include <set>

#include "base/disjoint_sets.hpp"
#include "base/files.hpp"
#include "base/parallel.hpp"
#include "linalg/ordering/graph.hpp"
#include "mesh/lagrange.hpp"
#include "mesh/sides.hpp"
#include "mesh/unused_ids.hpp"

namespace almesh {
namespace {

// What the sides of some vertices amount to.
struct Matched {
    std::vector<int> untagged;               // numbers of boundary sides without a tagged face
    std::vector<std::array<int, 2>> folded;  // elements on the same side of their common face
    std::vector<int> inside;                 // tagged faces inside the mesh
    int repeated = 0;                        // tagged faces dropped
};

struct BoundaryMatcher {
    explicit BoundaryMatcher(const MeshBuild& of) : build(of), side_of_face(of.faces.size(), -1) {}

    const MeshBuild& build;
    const Mesh& mesh = build.mesh;
    const int dim = mesh.dim, corners = dim + 1, first_tagged = mesh.element_count() * corners;
    const std::vector<std::vector<int>> face_nodes = LagrangeBasis(dim, mesh.degree).face_nodes();
    std::vector<int> side_of_face;  // by tagged face: number of its element's side, -1: dropped

    const RawElement& element_of(const Side& side) const { return build.element(side.number / corners); }
    const RawElement& tagged_face(const Side& side) const { return build.face(side.number - first_tagged); }
    int opposite_vertex(const Side& side) const { return mesh.element(side.number / corners)[side.number % corners]; }

    // Node k of a side in Gmsh's order; -1 where a tagged face has a node that no element has.
    int node_of(int number, int k) const {
        if (number < first_tagged) return mesh.element(number / corners)[face_nodes[number % corners][k]];
        return build.node[build.raw.element_nodes[build.face(number - first_tagged).first + k]];
    }

    Side side(int number) const {
        if (number < first_tagged)
            return side_of_simplex(dim, mesh.element(number / corners), number % corners, number);
        std::array<int, 3> vertex{};
        for (int k = 0; k < dim; ++k) vertex[k] = node_of(number, k);
        return {std::span(vertex).first(dim), number};
    }

    // All nodes of a side, ascending.
    std::vector<int> nodes_of(int number) const {
        std::vector<int> nodes;
        for (int k = 0; k < mesh.face_nodes(); ++k) nodes.push_back(node_of(number, k));
        std::sort(nodes.begin(), nodes.end());
        return nodes;
    }

    // Sides of elements that have the same vertices.
    void check_elements(std::span<const Side> equal) const {
        const std::size_t checked = std::min<std::size_t>(equal.size(), 3);  // a bad mesh may have thousands
        for (std::size_t a = 0; a < checked; ++a)
            for (std::size_t b = a + 1; b < checked; ++b)
                if (opposite_vertex(equal[a]) == opposite_vertex(equal[b]))
                    build.refuse(element_of(equal[b]), "has the vertices of ", name_of(element_of(equal[a])),
                                 ": an element may be in one ", entity_kind(dim), " and one physical group only");
        if (equal.size() > 2)
            build.refuse(element_of(equal[2]), "is the third at the face with the nodes ",
                         build.node_ids(equal[0].vertex.data(), dim), ", after ", name_of(element_of(equal[0])),
                         " and ", name_of(element_of(equal[1])));
        if (equal.size() == 2 && mesh.degree > 1 && nodes_of(equal[0].number) != nodes_of(equal[1].number))
            build.refuse(element_of(equal[1]), "and ", name_of(element_of(equal[0])),
                         " share the vertices of a face, but not its other nodes");
    }

    // Tagged faces that have the same vertices.
    void check_tags(std::span<const Side> equal) const {
        for (const Side& other : equal) {
            const RawElement &face = tagged_face(other), &first = tagged_face(equal[0]);
            if (face.physical != first.physical)
                build.refuse(face, "with tag ", face.physical, " has the vertices of ", name_of(first), " with tag ",
                             first.physical, ": a boundary face needs exactly one tag");
        }
    }

    void check_face(const Side& element, const Side& tagged) const {
        const RawElement& face = tagged_face(tagged);
        const FileEntity* entity = find_entity(build.raw.entities, face.dim, face.entity);
        if (entity && entity->physical.size() > 1)
            build.refuse(face, "lies on ", entity_kind(face.dim), " ", entity->key.tag, ", which has the tags ",
                         entity->physical[0], " and ", entity->physical[1], ": a boundary face needs exactly one tag");
        if (nodes_of(tagged.number) != nodes_of(element.number))
            build.refuse(face, "has the vertices of a face of ", name_of(element_of(element)),
                         ", but not its other nodes");
    }

    void refuse_without_element(const RawElement& face) const {
        build.refuse(face, "with tag ", face.physical, " is the face of no ", mesh.cell().name,
                     ": take it out of its physical group");
    }

    // Of sides without a tagged face: tells that some lie on each other, as where parts of a mesh were never joined;
    // else "".
    std::string doubled_text(const std::vector<int>& untagged) const {
        const auto is_before = [&](int i, int j) {
            const double *const a = point(mesh.x, i, dim), *const b = point(mesh.x, j, dim);
            return std::lexicographical_compare(a, a + dim, b, b + dim);
        };
        using Vertices = std::array<int, 3>;  // in the order of their positions, then of their numbers
        const auto lies_before = [&](const Vertices& f, const Vertices& g) {
            return std::lexicographical_compare(f.begin(), f.begin() + dim, g.begin(), g.begin() + dim, is_before);
        };
        std::vector<Vertices> faces;
        for (const int side : untagged) {
            Vertices& v = faces.emplace_back();
            for (int k = 0; k < dim; ++k) v[k] = node_of(side, k);
            std::sort(v.begin(), v.begin() + dim, is_before);
        }
        std::stable_sort(faces.begin(), faces.end(), lies_before);
        std::size_t pairs = 0;
        std::array<int, 2> nodes{};  // of the first pair, at one point
        for (std::size_t f = 1; f < faces.size(); ++f) {
            const Vertices &a = faces[f - 1], &b = faces[f];
            if (lies_before(a, b) || ++pairs > 1) continue;
            const auto [i, j] = std::mismatch(a.begin(), a.begin() + dim, b.begin());
            if (i != a.begin() + dim) nodes = {*i, *j};
        }
        if (pairs == 0) return "";
        return concat(counted(pairs, "pair"), pairs == 1 ? " lies" : " lie", " on each other, as nodes ",
                      build.node_ids(nodes.data(), 2), " are at one point: unless the mesh is to be cut there, "
                      "join such nodes (in gmsh: Coherence Mesh)");
    }

    void refuse_untagged(const std::vector<int>& untagged) const {
        int vertex[3];
        for (int k = 0; k < dim; ++k) vertex[k] = node_of(*std::min_element(untagged.begin(), untagged.end()), k);
        const std::array<double, 3> mean = centroid(mesh, mesh.x, vertex, dim);
        std::string centre;
        for (int a = 0; a < dim; ++a) append(centre += a ? ", " : "", mean[a], 6);
        const std::string what = entity_kind(dim - 1), doubled = doubled_text(untagged);
        build.refuse("an untagged boundary: ", counted(untagged.size(), "boundary face"), " without a physical ", what,
                     ", the first has the nodes ", build.node_ids(vertex, dim), " and the centre (", centre,
                     "); ", doubled.empty() ? "" : doubled + "; else ", "put every boundary ", what,
                     " into a Physical ", (dim == 2 ? "Curve" : "Surface"),
                     " of the .geo file and mesh again, without -save_all");
    }

    // Sides that have the same vertices: those of elements first.
    void match_equal(std::span<const Side> equal, Matched& found) {
        const auto is_tagged = [&](const Side& s) { return s.number >= first_tagged; };
        const std::size_t count = std::find_if(equal.begin(), equal.end(), is_tagged) - equal.begin();
        const std::span<const Side> of_elements = equal.first(count), tagged = equal.subspan(count);
        if (count == 0) refuse_without_element(tagged_face(tagged[0]));
        check_elements(of_elements);
        check_tags(tagged);
        if (count == 2) {
            for (const Side& s : tagged) found.inside.push_back(s.number - first_tagged);
            if (equal[0].even == equal[1].even)
                found.folded.push_back({equal[0].number / corners, equal[1].number / corners});
        } else if (tagged.empty()) {
            found.untagged.push_back(equal[0].number);
        } else {
            check_face(equal[0], tagged[0]);
            side_of_face[tagged[0].number - first_tagged] = equal[0].number;
            found.repeated += static_cast<int>(tagged.size()) - 1;
        }
    }

    // The sides go to their lowest vertices by a counting sort, then blocks of vertices are matched in parallel.
    Matched match() {
        constexpr int block = 256;
        const int count = first_tagged + static_cast<int>(build.faces.size());
        std::vector<int> lowest(count);
        parallel_for(count, [&](int s) { lowest[s] = side(s).vertex[0]; });
        for (int s = first_tagged; s < count; ++s)
            if (lowest[s] < 0) refuse_without_element(build.face(s - first_tagged));
        const Groups sorted = sorted_by_group(lowest, mesh.nodes());

        std::vector<Matched> found((mesh.nodes() + block - 1) / block);
        parallel_for_throwing(static_cast<int>(found.size()), [&](int b) {
            std::vector<Side> sides;
            for (int v = b * block, end = std::min(mesh.nodes(), v + block); v < end; ++v) {
                sides.clear();
                for (int s : sorted.of(v)) sides.push_back(side(s));
                for_equal_sides(sides, [&](std::span<const Side> equal) { match_equal(equal, found[b]); });
            }
        }, 1000.0 * block);
        Matched all;
        for (const Matched& part : found) {
            all.untagged.insert(all.untagged.end(), part.untagged.begin(), part.untagged.end());
            all.folded.insert(all.folded.end(), part.folded.begin(), part.folded.end());
            all.inside.insert(all.inside.end(), part.inside.begin(), part.inside.end());
            all.repeated += part.repeated;
        }
        if (!all.untagged.empty() && !build.faces.empty()) refuse_untagged(all.untagged);
        return all;
    }
};

// The boundary faces in file order, with their nodes as their elements see them.
void fill_faces(const BoundaryMatcher& matcher, const RawMesh& raw, Mesh& mesh) {
    std::map<int, int> boundary_of;  // by physical tag
    for (std::size_t f = 0; f < matcher.side_of_face.size(); ++f) {
        const int side = matcher.side_of_face[f];
        if (side < 0) continue;
        const RawElement& face = matcher.build.face(static_cast<int>(f));
        for (int k = 0; k < mesh.face_nodes(); ++k) mesh.faces.push_back(matcher.node_of(side, k));
        const auto [boundary, is_new] = boundary_of.try_emplace(face.physical, -1);
        if (is_new) {
            const std::string name = group_name(raw.groups, face.dim, face.physical);
            if (mesh.boundary_index(name) < 0) mesh.boundaries.push_back(name);
            boundary->second = mesh.boundary_index(name);
        }
        mesh.face_element.push_back(side / matcher.corners);
        mesh.face_boundary.push_back(boundary->second);
        mesh.file.face_id.push_back(face.id);
        mesh.file.face_physical.push_back(face.physical);
        mesh.file.face_entity.push_back(face.entity);
    }
}

// The file's untagged faces by their nodes, ascending.
std::map<std::vector<int>, int> untagged_faces(const MeshBuild& build) {
    std::map<std::vector<int>, int> faces;
    for (const int i : build.kept) {
        const RawElement& face = build.raw.elements[i];
        if (face.dim != build.mesh.dim - 1 || face.degree != build.mesh.degree) continue;
        std::vector<int> nodes;
        for (int k = 0; k < build.mesh.face_nodes(); ++k)
            nodes.push_back(build.node[build.raw.element_nodes[face.first + k]]);
        std::sort(nodes.begin(), nodes.end());
        faces.emplace(std::move(nodes), i);
    }
    return faces;
}

// The boundary of a mesh without tagged faces: its parts that hang together by vertices, numbered by their lowest
// nodes.
void fill_untagged(const BoundaryMatcher& matcher, const std::vector<int>& sides, MeshBuild& build) {
    Mesh& mesh = build.mesh;
    const int dim = mesh.dim;
    DisjointSets connected(mesh.nodes());
    for (const int side : sides)
        for (int k = 1; k < dim; ++k) connected.join(matcher.node_of(side, 0), matcher.node_of(side, k));
    std::map<int, std::vector<int>> parts;  // by lowest node
    for (const int side : sides) parts[connected.find(matcher.node_of(side, 0))].push_back(side);
    std::vector<long long> ids;
    for (const RawElement& element : build.raw.elements) ids.push_back(element.id);
    UnusedIds<long long> unused_id(std::move(ids));
    const std::map<std::vector<int>, int> of_file = untagged_faces(build);
    std::set<int> taken;
    std::vector<int> tags;
    for (const PhysicalGroup& group : mesh.file.groups) tags.push_back(group.tag);
    UnusedIds<int> unused_tag(std::move(tags));
    std::string note;
    for (const auto& [lowest, of_part] : parts) {
        const int boundary = static_cast<int>(mesh.boundaries.size());
        mesh.boundaries.push_back(parts.size() == 1 ? "boundary" : concat("boundary-", boundary + 1));
        const int tag = unused_tag.next();
        mesh.file.groups.push_back({dim - 1, tag, mesh.boundaries.back()});
        note += concat(note.empty() ? "" : ", ", mesh.boundaries.back(), " (", counted(of_part.size(), "face"), ")");
        for (const int side : of_part) {
            for (int k = 0; k < mesh.face_nodes(); ++k) mesh.faces.push_back(matcher.node_of(side, k));
            mesh.face_element.push_back(side / matcher.corners);
            mesh.face_boundary.push_back(boundary);
            const auto found = of_file.find(matcher.nodes_of(side));
            const RawElement* const own = found == of_file.end() ? nullptr : &build.raw.elements[found->second];
            mesh.file.face_id.push_back(own ? own->id : unused_id.next());
            mesh.file.face_physical.push_back(tag);
            mesh.file.face_entity.push_back(own ? own->entity : tag);
            if (own) taken.insert(found->second);
        }
    }
    std::erase_if(build.kept, [&](int i) { return taken.contains(i); });
    build.notes.push_back("no tagged boundary faces: the boundary is that of the elements, in parts: " + note);
    if (const std::string doubled = matcher.doubled_text(sides); !doubled.empty())
        build.notes.push_back("of the boundary's faces, " + doubled);
}

}  // namespace

std::string MeshBuild::node_ids(const int* nodes, int count) const {
    std::string text;
    for (int k = 0; k < count; ++k) text += (k ? ", " : "") + std::to_string(mesh.file.node_id[nodes[k]]);
    return text;
}

EntityKey MeshBuild::entity_of(std::size_t raw_node) const {
    const auto next = std::upper_bound(raw.node_blocks.begin(), raw.node_blocks.end(), raw_node,
                                       [](std::size_t at, const RawNodeBlock& block) { return at < block.first; });
    return next == raw.node_blocks.begin() ? EntityKey{} : std::prev(next)->entity;
}

std::string name_of(const RawElement& element) {
    return concat("element ", element.id, element.line ? concat(" (line ", element.line, ")") : "");
}

std::string entity_kind(int dim) { return dim == 1 ? "curve" : dim == 2 ? "surface" : "volume"; }

std::vector<std::array<int, 2>> fill_boundary(MeshBuild& build) {
    BoundaryMatcher matcher(build);
    Matched all = matcher.match();
    for (const int f : all.inside) build.kept.push_back(build.faces[f]);
    if (all.repeated) build.notes.push_back(counted(all.repeated, "repeated boundary face") + " dropped");
    if (build.faces.empty()) fill_untagged(matcher, all.untagged, build);
    else fill_faces(matcher, build.raw, build.mesh);
    return std::move(all.folded);
}

}  // namespace almesh
