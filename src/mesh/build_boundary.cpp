// The faces of all elements and the tagged faces of the file, both called sides here, are sorted by their vertices, for
// each lowest vertex separately. Sides of equal vertices are then neighbours: two elements on opposite sides of a face
// inside the mesh, or one element and a tagged face (or several of one tag) on the boundary. All else is an error.
#include "mesh/build_boundary.hpp"

#include <algorithm>
#include <map>

#include "base/files.hpp"
#include "base/parallel.hpp"
#include "mesh/lagrange.hpp"

namespace almesh {
namespace {

struct Side {
    std::array<int, 3> vertex;  // ascending; 2D: then -1
    int number;                 // e * (dim + 1) + k: face k of element e; tagged faces are numbered after these
    bool even;                  // whether sorting was an even permutation: elements on opposite sides of a face differ

    // Called in inner loops, where the comparisons of std::array are function calls.
    bool has_vertices_of(const Side& other) const {
        return vertex[0] == other.vertex[0] && vertex[1] == other.vertex[1] && vertex[2] == other.vertex[2];
    }
    bool operator<(const Side& other) const {
        for (int k = 0; k < 3; ++k)
            if (vertex[k] != other.vertex[k]) return vertex[k] < other.vertex[k];
        return number < other.number;
    }
};

// What the sides of some vertices amount to.
struct Matched {
    std::vector<int> untagged;               // numbers of boundary sides without a tagged face
    std::vector<std::array<int, 2>> folded;  // elements on the same side of their common face
    int inside = 0, repeated = 0;            // tagged faces dropped
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

    Side side(int number) const {
        Side result{{-1, -1, -1}, number, true};
        auto& v = result.vertex;
        if (number < first_tagged) {
            const int* const node = mesh.element(number / corners);
            const CellFace& local = mesh.cell().faces[number % corners];
            for (int k = 0; k < dim; ++k) v[k] = node[local[k]];
        } else {
            const int* const node = &build.raw.element_nodes[build.face(number - first_tagged).first];
            for (int k = 0; k < dim; ++k) v[k] = build.node[node[k]];
        }
        const auto order = [&](int a, int b) {
            if (v[a] <= v[b]) return;
            std::swap(v[a], v[b]);
            result.even = !result.even;
        };
        order(0, 1);
        if (dim == 3) order(1, 2);
        if (dim == 3) order(0, 1);
        return result;
    }

    // All nodes of a side, ascending.
    std::vector<int> nodes_of(int number) const {
        std::vector<int> nodes;
        if (number < first_tagged) {
            for (int k : face_nodes[number % corners]) nodes.push_back(mesh.element(number / corners)[k]);
        } else {
            const std::size_t first = build.face(number - first_tagged).first;
            for (int k = 0; k < mesh.face_nodes(); ++k) nodes.push_back(build.node[build.raw.element_nodes[first + k]]);
        }
        std::sort(nodes.begin(), nodes.end());
        return nodes;
    }

    // Elements' sides [begin, end) have the same vertices.
    void check_elements(const Side* begin, const Side* end) const {
        const Side* const third = begin + std::min<std::ptrdiff_t>(end - begin, 3);  // a bad mesh may have thousands
        for (const Side* a = begin; a != third; ++a)
            for (const Side* b = a + 1; b != third; ++b)
                if (opposite_vertex(*a) == opposite_vertex(*b))
                    refuse(build.raw, element_of(*b),
                           "has the vertices of " + name_of(element_of(*a)) + ": an element may be in one " +
                               entity_kind(dim) + " and one physical group only");
        if (end - begin > 2)
            refuse(build.raw, element_of(begin[2]),
                   "is the third at the face with the nodes " + build.node_ids(begin->vertex.data(), dim) + ", after " +
                       name_of(element_of(begin[0])) + " and " + name_of(element_of(begin[1])));
        if (end - begin == 2 && mesh.degree > 1 && nodes_of(begin[0].number) != nodes_of(begin[1].number))
            refuse(build.raw, element_of(begin[1]), "and " + name_of(element_of(begin[0])) +
                                                        " share the vertices of a face, but not its other nodes");
    }

    // Tagged faces [begin, end) have the same vertices.
    void check_tags(const Side* begin, const Side* end) const {
        for (const Side* other = begin; other != end; ++other)
            if (tagged_face(*other).physical != tagged_face(*begin).physical)
                refuse(build.raw, tagged_face(*other),
                       "with tag " + std::to_string(tagged_face(*other).physical) + " has the vertices of " +
                           name_of(tagged_face(*begin)) + " with tag " + std::to_string(tagged_face(*begin).physical) +
                           ": a boundary face needs exactly one tag");
    }

    void check_face(const Side& element, const Side& tagged) const {
        const RawElement& face = tagged_face(tagged);
        const RawEntity* entity = find_entity(build.raw, face.dim, face.entity);
        if (entity && entity->physical.size() > 1)
            refuse(build.raw, face,
                   "lies on " + entity_kind(face.dim) + " " + std::to_string(entity->tag) + ", which has the tags " +
                       std::to_string(entity->physical[0]) + " and " + std::to_string(entity->physical[1]) +
                       ": a boundary face needs exactly one tag");
        if (nodes_of(tagged.number) != nodes_of(element.number))
            refuse(build.raw, face,
                   "has the vertices of a face of " + name_of(element_of(element)) + ", but not its other nodes");
    }

    void refuse_without_element(const RawElement& face) const {
        refuse(build.raw, face, "with tag " + std::to_string(face.physical) + " is the face of no " + mesh.cell().name +
                                    ": take it out of its physical group");
    }

    void refuse_untagged(const std::vector<int>& untagged) const {
        const int first = *std::min_element(untagged.begin(), untagged.end());
        const CellFace& local = mesh.cell().faces[first % corners];
        int vertex[3];
        for (int k = 0; k < dim; ++k) vertex[k] = mesh.element(first / corners)[local[k]];
        std::string centre;
        for (int a = 0; a < dim; ++a) {
            double sum = 0;
            for (int k = 0; k < dim; ++k) sum += mesh.x[offset(vertex[k], dim, a)];
            append(centre += a ? ", " : "", sum / dim, 6);
        }
        const std::string what = entity_kind(dim - 1);
        refuse(build.raw, "an untagged boundary: " + counted(untagged.size(), "boundary face") +
                              " without a physical " + what + ", the first has the nodes " +
                              build.node_ids(vertex, dim) + " and the centre (" + centre + "); put every boundary " +
                              what + " into a Physical " + (dim == 2 ? "Curve" : "Surface") +
                              " of the .geo file and mesh again, without -save_all");
    }

    // Compares the runs of equal vertices. sides: those of one lowest vertex, ascending.
    void match_vertex(const std::vector<Side>& sides, Matched& found) {
        const Side* const last = sides.data() + sides.size();
        for (const Side *begin = sides.data(), *end; begin != last; begin = end) {
            end = std::find_if(begin, last, [&](const Side& s) { return !s.has_vertices_of(*begin); });
            const auto is_tagged = [&](const Side& s) { return s.number >= first_tagged; };
            const Side* const tagged = std::find_if(begin, end, is_tagged);
            if (tagged == begin) refuse_without_element(tagged_face(*tagged));
            check_elements(begin, tagged);
            check_tags(tagged, end);
            const int tags = static_cast<int>(end - tagged);
            if (tagged - begin == 2) {
                found.inside += tags;
                if (begin[0].even == begin[1].even)
                    found.folded.push_back({begin[0].number / corners, begin[1].number / corners});
            } else if (tags == 0) {
                found.untagged.push_back(begin->number);
            } else {
                check_face(*begin, *tagged);
                side_of_face[tagged->number - first_tagged] = begin->number;
                found.repeated += tags - 1;
            }
        }
    }

    // The sides go to their lowest vertices by a counting sort, then blocks of vertices are matched in parallel.
    Matched match() {
        constexpr int block = 256;
        const int count = first_tagged + static_cast<int>(build.faces.size());
        std::vector<int> lowest(count), start(mesh.nodes() + 2, 0), sorted(count);
        parallel_for(count, [&](int s) { lowest[s] = side(s).vertex[0]; });
        for (int s = first_tagged; s < count; ++s)
            if (lowest[s] < 0) refuse_without_element(build.face(s - first_tagged));
        for (int v : lowest) ++start[v + 2];
        for (int v = 0; v < mesh.nodes(); ++v) start[v + 2] += start[v + 1];
        for (int s = 0; s < count; ++s) sorted[start[lowest[s] + 1]++] = s;

        std::vector<Matched> found((mesh.nodes() + block - 1) / block);
        parallel_for_throwing(static_cast<int>(found.size()), [&](int b) {
            std::vector<Side> sides;
            for (int v = b * block, end = std::min(mesh.nodes(), v + block); v < end; ++v) {
                sides.clear();
                for (int k = start[v]; k < start[v + 1]; ++k) sides.push_back(side(sorted[k]));
                std::sort(sides.begin(), sides.end());
                match_vertex(sides, found[b]);
            }
        }, 1000.0 * block);
        Matched all;
        for (const Matched& part : found) {
            all.untagged.insert(all.untagged.end(), part.untagged.begin(), part.untagged.end());
            all.folded.insert(all.folded.end(), part.folded.begin(), part.folded.end());
            all.inside += part.inside;
            all.repeated += part.repeated;
        }
        if (!all.untagged.empty()) refuse_untagged(all.untagged);
        return all;
    }
};

std::string boundary_name(const RawMesh& raw, int dim, int tag) {
    for (const PhysicalGroup& group : raw.groups)
        if (group.dim == dim && group.tag == tag) return group.name;
    return "tag " + std::to_string(tag);
}

// The boundary faces in file order, with their nodes as their elements see them.
void fill_faces(const BoundaryMatcher& matcher, const RawMesh& raw, Mesh& mesh) {
    std::map<int, int> boundary_of;  // by physical tag
    for (std::size_t f = 0; f < matcher.side_of_face.size(); ++f) {
        const int side = matcher.side_of_face[f];
        if (side < 0) continue;
        const RawElement& face = matcher.build.face(static_cast<int>(f));
        const int e = side / matcher.corners;
        for (int local : matcher.face_nodes[side % matcher.corners]) mesh.faces.push_back(mesh.element(e)[local]);
        const auto [boundary, is_new] = boundary_of.try_emplace(face.physical, -1);
        if (is_new) {
            const std::string name = boundary_name(raw, face.dim, face.physical);
            if (mesh.boundary_index(name) < 0) mesh.boundaries.push_back(name);
            boundary->second = mesh.boundary_index(name);
        }
        mesh.face_element.push_back(e);
        mesh.face_boundary.push_back(boundary->second);
        mesh.file.face_id.push_back(face.id);
        mesh.file.face_physical.push_back(face.physical);
        mesh.file.face_entity.push_back(face.entity);
    }
}

}  // namespace

std::string MeshBuild::node_ids(const int* nodes, int count) const {
    std::string text;
    for (int k = 0; k < count; ++k) text += (k ? ", " : "") + std::to_string(mesh.file.node_id[nodes[k]]);
    return text;
}

std::string counted(std::size_t count, const std::string& noun) {
    return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
}

std::string entity_kind(int dim) { return dim == 1 ? "curve" : dim == 2 ? "surface" : "volume"; }

std::vector<std::array<int, 2>> fill_boundary(MeshBuild& build) {
    BoundaryMatcher matcher(build);
    Matched all = matcher.match();
    if (all.inside) build.notes.push_back(counted(all.inside, "tagged face") + " inside the mesh dropped");
    if (all.repeated) build.notes.push_back(counted(all.repeated, "repeated boundary face") + " dropped");
    fill_faces(matcher, build.raw, build.mesh);
    return std::move(all.folded);
}

}  // namespace almesh
