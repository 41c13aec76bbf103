#include "mesh/build_boundary.hpp"

#include <algorithm>
#include <array>
#include <cstddef>

#include "base/files.hpp"
#include "base/parallel.hpp"
#include "mesh/build_messages.hpp"
#include "mesh/lagrange.hpp"

namespace almesh {
namespace {

// A face by its vertices in ascending order (-1: none), whose it is, the element's vertex opposite to it (-1: no
// element), and whether ascending is an even permutation of the order in which the vertices were given. Two elements on
// opposite sides of a face see them in opposite senses.
struct Side {
    std::array<int, 3> vertex;
    int owner;
    int opposite;
    bool even;

    // Asked for millions of times: the comparisons of std::array are calls.
    bool has_vertices_of(const Side& other) const {
        return vertex[0] == other.vertex[0] && vertex[1] == other.vertex[1] && vertex[2] == other.vertex[2];
    }
    bool operator<(const Side& other) const {
        for (int k = 0; k < 3; ++k)
            if (vertex[k] != other.vertex[k]) return vertex[k] < other.vertex[k];
        return owner < other.owner;
    }
};

Side side_of(const int* vertex, int count, int owner, int opposite) {
    Side side{{-1, -1, -1}, owner, opposite, true};
    auto& v = side.vertex;
    std::copy_n(vertex, count, v.begin());
    const auto order = [&](int a, int b) {
        if (v[a] <= v[b]) return;
        std::swap(v[a], v[b]);
        side.even = !side.even;
    };
    order(0, 1);
    if (count == 3) order(1, 2);
    if (count == 3) order(0, 1);
    return side;
}

// The sides of elements by their smallest vertex: owner[start[v]] .. owner[start[v + 1] - 1] for vertex v.
// owner: element * (dim + 1) + local vertex opposite the face.
struct SidesOfVertices {
    std::vector<int> start, owner;
};

// add(smallest vertex, owner) for every side: the smallest vertex of the element is that of all its sides but the one
// opposite to it.
template <class Add>
void for_all_sides(const Mesh& mesh, const Add& add) {
    const int corners = mesh.dim + 1;
    for (int e = 0; e < mesh.element_count(); ++e) {
        const int* const node = mesh.element(e);
        const int least = static_cast<int>(std::min_element(node, node + corners) - node);
        int second = node[least == 0];
        for (int v = 0; v < corners; ++v)
            if (v != least) second = std::min(second, node[v]);
        for (int v = 0; v < corners; ++v) add(v == least ? second : node[least], e * corners + v);
    }
}

SidesOfVertices sides_of_vertices(const Mesh& mesh) {
    SidesOfVertices sides{std::vector<int>(mesh.nodes() + 2, 0),
                          std::vector<int>(static_cast<std::size_t>(mesh.element_count()) * (mesh.dim + 1))};
    for_all_sides(mesh, [&](int vertex, int) { ++sides.start[vertex + 2]; });
    for (int i = 0; i < mesh.nodes(); ++i) sides.start[i + 2] += sides.start[i + 1];
    for_all_sides(mesh, [&](int vertex, int owner) { sides.owner[sides.start[vertex + 1]++] = owner; });
    return sides;
}

// Those of one vertex, ascending.
void sort_sides(const Mesh& mesh, const SidesOfVertices& sides, int vertex, std::vector<Side>& sorted) {
    const int corners = mesh.dim + 1;
    sorted.clear();
    for (int k = sides.start[vertex]; k < sides.start[vertex + 1]; ++k) {
        const int owner = sides.owner[k];
        const int* const node = mesh.element(owner / corners);
        const std::array<int, 3> local = outward_face(mesh.dim, owner % corners);
        int face[3];
        for (int i = 0; i < mesh.dim; ++i) face[i] = node[local[i]];
        sorted.push_back(side_of(face, mesh.dim, owner, node[owner % corners]));
    }
    std::sort(sorted.begin(), sorted.end());
}

// Ascending. owner: index into chosen.faces. A vertex without element has the node index -1.
std::vector<Side> tagged_sides(const RawMesh& raw, const Selection& chosen, const std::vector<int>& index) {
    std::vector<Side> sides;
    for (std::size_t f = 0; f < chosen.faces.size(); ++f) {
        const int* const node = &raw.element_nodes[raw.elements[chosen.faces[f]].first];
        int vertex[3];
        for (int k = 0; k < chosen.dim; ++k) vertex[k] = index[node[k]];
        sides.push_back(side_of(vertex, chosen.dim, static_cast<int>(f), -1));
    }
    std::sort(sides.begin(), sides.end());
    return sides;
}

// What the sides of some vertices hold.
struct Matched {
    std::vector<int> untagged;       // sides of elements
    int inside = 0, repeated = 0;    // tagged faces dropped
    FoldedPairs folded;
};

// Finds the boundary faces and their tags.
struct BoundaryMatcher {
    const RawMesh& raw;
    const Selection& chosen;
    const std::vector<int>& index;  // node of the mesh by raw node
    const Mesh& mesh;
    std::vector<std::vector<int>> face_nodes;  // by opposite vertex: local nodes of the element's face
    std::vector<int> side_of_face;             // by index into chosen.faces: side of an element, -1: dropped
    Matched all;

    const RawElement& element_of(int side) const { return raw.elements[chosen.elements[side / (mesh.dim + 1)]]; }
    const RawElement& tagged_face(const Side& side) const { return raw.elements[chosen.faces[side.owner]]; }

    std::vector<int> nodes_of(int side) const {
        std::vector<int> nodes;
        for (int local : face_nodes[side % (mesh.dim + 1)]) nodes.push_back(mesh.element(side / (mesh.dim + 1))[local]);
        std::sort(nodes.begin(), nodes.end());
        return nodes;
    }

    void match();
    void match_vertex(const std::vector<Side>& sides, const Side* tagged, const Side* tagged_end, Matched& found);
    void gather(const Matched& found);
    void check_elements(const Side* begin, const Side* end) const;
    void check_tags(const Side* begin, const Side* end) const;
    void check_face(const Side& tagged, int side) const;
    [[noreturn]] void refuse_without_element(const Side& tagged) const;
    [[noreturn]] void refuse_untagged() const;
};

// Sides [begin, end) have the same vertices.
void BoundaryMatcher::check_elements(const Side* begin, const Side* end) const {
    const Side* const third = begin + std::min<std::ptrdiff_t>(end - begin, 3);  // a bad mesh may have thousands
    for (const Side* a = begin; a != third; ++a)
        for (const Side* b = a + 1; b != third; ++b)
            if (a->opposite == b->opposite)
                refuse(raw, element_of(b->owner),
                       "has the vertices of " + name_of(element_of(a->owner)) + ": an element may be in one " +
                           dimension_name(mesh.dim) + " and one physical group only");
    if (end - begin > 2)
        refuse(raw, element_of(begin[2].owner),
               "is the third at the face with the nodes " + node_ids(mesh, begin->vertex.data(), mesh.dim) +
                   ", after " + name_of(element_of(begin[0].owner)) + " and " + name_of(element_of(begin[1].owner)));
    if (end - begin == 2 && mesh.degree > 1 && nodes_of(begin[0].owner) != nodes_of(begin[1].owner))
        refuse(raw, element_of(begin[1].owner), "and " + name_of(element_of(begin[0].owner)) +
                                                    " share the vertices of a face, but not its other nodes");
}

// Tagged faces [begin, end) have the same vertices.
void BoundaryMatcher::check_tags(const Side* begin, const Side* end) const {
    for (const Side* other = begin + 1; other < end; ++other)
        if (tagged_face(*other).physical != tagged_face(*begin).physical)
            refuse(raw, tagged_face(*other),
                   "with tag " + std::to_string(tagged_face(*other).physical) + " has the vertices of " +
                       name_of(tagged_face(*begin)) + " with tag " + std::to_string(tagged_face(*begin).physical) +
                       ": a boundary face needs exactly one tag");
}

void BoundaryMatcher::check_face(const Side& tagged, int side) const {
    const RawElement& face = tagged_face(tagged);
    const RawEntity* entity = find_entity(raw, face.dim, face.entity);
    if (entity && entity->physical.size() > 1)
        refuse(raw, face, "lies on " + dimension_name(face.dim) + " " + std::to_string(entity->tag) +
                              ", which has the tags " + std::to_string(entity->physical[0]) + " and " +
                              std::to_string(entity->physical[1]) + ": a boundary face needs exactly one tag");
    std::vector<int> nodes;
    for (int k = 0; k < mesh.face_nodes(); ++k) nodes.push_back(index[raw.element_nodes[face.first + k]]);
    std::sort(nodes.begin(), nodes.end());
    if (nodes != nodes_of(side))
        refuse(raw, face, "has the vertices of a face of " + name_of(element_of(side)) + ", but not its other nodes");
}

void BoundaryMatcher::refuse_without_element(const Side& tagged) const {
    const RawElement& face = tagged_face(tagged);
    refuse(raw, face, "with tag " + std::to_string(face.physical) + " is the face of no " +
                          (mesh.dim == 2 ? "triangle" : "tetrahedron") + ": take it out of its physical group");
}

void BoundaryMatcher::refuse_untagged() const {
    const int corners = mesh.dim + 1, first = *std::min_element(all.untagged.begin(), all.untagged.end());
    const std::array<int, 3> local = outward_face(mesh.dim, first % corners);
    int vertex[3];
    std::string centre;
    for (int k = 0; k < mesh.dim; ++k) vertex[k] = mesh.element(first / corners)[local[k]];
    for (int a = 0; a < mesh.dim; ++a) {
        double sum = 0;
        for (int k = 0; k < mesh.dim; ++k) sum += mesh.x[static_cast<std::size_t>(vertex[k]) * mesh.dim + a];
        if (a) centre += ", ";
        append(centre, sum / mesh.dim, 6);
    }
    const std::string what = dimension_name(mesh.dim - 1);
    refuse(raw, "an untagged boundary: " + counted(all.untagged.size(), "boundary face") + " without a physical " +
                    what + ", the first has the nodes " + node_ids(mesh, vertex, mesh.dim) + " and the centre (" +
                    centre + "); put every boundary " + what + " into a Physical " +
                    (mesh.dim == 2 ? "Curve" : "Surface") + " of the .geo file and mesh again, without -save_all");
}

// Walks over the sides of elements and the tagged faces that have the same smallest vertex, both ascending.
void BoundaryMatcher::match_vertex(const std::vector<Side>& sides, const Side* t, const Side* t_last, Matched& found) {
    const auto run_end = [](const Side* s, const Side* last, const Side& side) {
        while (s != last && s->has_vertices_of(side)) ++s;
        return s;
    };
    const Side* const s_last = sides.data() + sides.size();
    for (const Side *s = sides.data(), *s_end; s != s_last; s = s_end) {
        s_end = run_end(s, s_last, *s);
        check_elements(s, s_end);
        if (t != t_last && t->vertex < s->vertex) refuse_without_element(*t);
        const Side* const t_end = run_end(t, t_last, *s);
        check_tags(t, t_end);
        const int tags = static_cast<int>(t_end - t);
        if (s_end - s == 2) {
            found.inside += tags;
            if (s[0].even == s[1].even && found.folded.count++ == 0) {
                found.folded.first = s[0].owner / (mesh.dim + 1);
                found.folded.second = s[1].owner / (mesh.dim + 1);
            }
        } else if (tags == 0) {
            found.untagged.push_back(s->owner);
        } else {
            check_face(*t, s->owner);
            side_of_face[t->owner] = s->owner;
            found.repeated += tags - 1;
        }
        t = t_end;
    }
    if (t != t_last) refuse_without_element(*t);
}

void BoundaryMatcher::gather(const Matched& found) {
    all.untagged.insert(all.untagged.end(), found.untagged.begin(), found.untagged.end());
    all.inside += found.inside;
    all.repeated += found.repeated;
    if (all.folded.count == 0) all.folded = found.folded;
    else all.folded.count += found.folded.count;
}

// Block by block of vertices.
void BoundaryMatcher::match() {
    constexpr int block = 256;
    const SidesOfVertices sides = sides_of_vertices(mesh);
    const std::vector<Side> tagged = tagged_sides(raw, chosen, index);
    if (!tagged.empty() && tagged[0].vertex[0] < 0) refuse_without_element(tagged[0]);
    side_of_face.assign(chosen.faces.size(), -1);
    const auto first_tagged = [&](int vertex) {
        const auto before = [](const Side& side, int v) { return side.vertex[0] < v; };
        return tagged.data() + (std::lower_bound(tagged.begin(), tagged.end(), vertex, before) - tagged.begin());
    };
    std::vector<Matched> found((mesh.nodes() + block - 1) / block);
    parallel_for_throwing(static_cast<int>(found.size()), [&](int b) {
        std::vector<Side> of_vertex;
        const Side* t = first_tagged(b * block);
        for (int v = b * block, end = std::min(mesh.nodes(), v + block); v < end; ++v) {
            sort_sides(mesh, sides, v, of_vertex);
            const Side* const t_begin = t;
            while (t != tagged.data() + tagged.size() && t->vertex[0] == v) ++t;
            match_vertex(of_vertex, t_begin, t, found[b]);
        }
    }, 1000.0 * block);
    for (const Matched& of_block : found) gather(of_block);
    if (!all.untagged.empty()) refuse_untagged();
}

std::string boundary_name(const RawMesh& raw, int dim, int tag) {
    for (const PhysicalGroup& group : raw.groups)
        if (group.dim == dim && group.tag == tag) return group.name;
    return "tag " + std::to_string(tag);
}

// The boundary faces in file order, as their elements see them.
void fill_faces(const BoundaryMatcher& matcher, Mesh& mesh) {
    std::vector<int> known;  // physical tags met, with the boundary of each
    std::vector<int> boundary_of;
    for (std::size_t f = 0; f < matcher.side_of_face.size(); ++f) {
        const int side = matcher.side_of_face[f];
        if (side < 0) continue;
        const RawElement& face = matcher.raw.elements[matcher.chosen.faces[f]];
        const int e = side / (mesh.dim + 1);
        for (int local : matcher.face_nodes[side % (mesh.dim + 1)]) mesh.faces.push_back(mesh.element(e)[local]);
        auto it = std::find(known.begin(), known.end(), face.physical);
        if (it == known.end()) {
            const std::string name = boundary_name(matcher.raw, face.dim, face.physical);
            if (mesh.boundary_index(name) < 0) mesh.boundaries.push_back(name);
            boundary_of.push_back(mesh.boundary_index(name));
            it = known.insert(known.end(), face.physical);
        }
        mesh.face_element.push_back(e);
        mesh.face_boundary.push_back(boundary_of[it - known.begin()]);
        mesh.file.face_id.push_back(face.id);
        mesh.file.face_physical.push_back(face.physical);
        mesh.file.face_entity.push_back(face.entity);
    }
}

}  // namespace

FoldedPairs fill_boundary(const RawMesh& raw, const Selection& chosen, const std::vector<int>& index, Mesh& mesh,
                          std::vector<std::string>& notes) {
    const LagrangeBasis basis(mesh.dim, mesh.degree);
    BoundaryMatcher matcher{raw, chosen, index, mesh, {}, {}, {}};
    for (int v = 0; v <= mesh.dim; ++v) matcher.face_nodes.push_back(basis.face_nodes(v));
    matcher.match();
    const Matched& all = matcher.all;
    if (all.inside) notes.push_back(counted(all.inside, "tagged face") + " inside the mesh dropped");
    if (all.repeated) notes.push_back(counted(all.repeated, "repeated boundary face") + " dropped");
    fill_faces(matcher, mesh);
    return all.folded;
}

}  // namespace almesh
