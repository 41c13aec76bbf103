#include "mesh/surface_mesh.hpp"

#include <map>
#include <set>

#include "base/error.hpp"
#include "base/text.hpp"
#include "mesh/sides.hpp"

namespace almesh {
namespace {

// In 3D, how much of a space around c a face and c enclose; in 2D of the plane.
double volume_from(const Mesh& mesh, int f, const Vec<3>& c) {
    Mat<3> X{{{}, {}, {0, 0, 1}}};
    for (int i = 0; i < mesh.dim; ++i)
        for (int a = 0; a < mesh.dim; ++a) X[i][a] = mesh.x[offset(mesh.face(f)[i], mesh.dim, a)] - c[a];
    return determinant(X);
}

// Turns faces so that neighbours go the same way around and what hangs together outward.
int turn_outward(Mesh& mesh, std::vector<Side>& sides) {
    Vec<3> centre{};
    for (std::size_t k = 0; k < mesh.x.size(); ++k) centre[k % mesh.dim] += mesh.x[k] / mesh.nodes();
    const std::vector<char> turned = turned_by_neighbours(
        mesh.face_count(), sides, 1, [&](int f) { return volume_from(mesh, f, centre); });
    for (int f = 0; f < mesh.face_count(); ++f)
        if (turned[f]) std::swap(mesh.faces[offset(f, mesh.dim)], mesh.faces[offset(f, mesh.dim, 1)]);
    return static_cast<int>(std::count(turned.begin(), turned.end(), 1));
}

struct LeftOut {
    int flat = 0, doubled = 0;
};

// The faces of the highest dimension below dim, polygons as triangles around their first vertex.
LeftOut fill(const RawMesh& raw, Mesh& mesh) {
    std::map<std::array<float, 3>, int> node;  // the corners of an STL are in single precision
    std::map<int, int> boundary;  // by physical group
    std::set<std::set<int>> known;
    LeftOut left_out;
    for (const RawElement& element : raw.elements) {
        if (element.dim != mesh.dim - 1) continue;
        for (int k = 1; k + mesh.dim - 1 <= element.cell().vertices; ++k) {
            std::vector<int> corner;
            for (int i = 0; i < mesh.dim; ++i) {
                const double* const x = raw.nodes[raw.element_nodes[element.first + (i ? k + i - 1 : 0)]].x;
                const std::array<float, 3> key = {float(x[0]), float(x[1]), float(x[2])};
                const auto [at, is_new] = node.try_emplace(key, mesh.nodes());
                if (is_new) mesh.x.insert(mesh.x.end(), x, x + mesh.dim);
                if (mesh.dim == 2 && x[2] != 0) throw InputError(raw.path, ": a line off the plane z = 0 of the mesh");
                corner.push_back(at->second);
            }
            const std::set<int> corners(corner.begin(), corner.end());
            if (static_cast<int>(corners.size()) < mesh.dim) {
                ++left_out.flat;
            } else if (!known.insert(corners).second) {
                ++left_out.doubled;
            } else {
                mesh.faces.insert(mesh.faces.end(), corner.begin(), corner.end());
                const auto [at, is_new] = boundary.try_emplace(element.physical, static_cast<int>(boundary.size()));
                if (is_new)
                    mesh.boundaries.push_back(
                        element.physical ? group_name(raw.groups, mesh.dim - 1, element.physical) : "surface");
                mesh.face_boundary.push_back(at->second);
            }
        }
    }
    return left_out;
}

}  // namespace

Mesh surface_mesh(const RawMesh& raw, int dim, std::vector<std::string>& notes) {
    Mesh mesh;
    mesh.dim = dim;
    const LeftOut left_out = fill(raw, mesh);
    if (mesh.faces.empty()) throw InputError(raw.path, ": a surface without ", dim == 2 ? "lines" : "triangles");
    mesh.face_element.assign(mesh.face_count(), -1);
    for (const std::string& name : mesh.boundaries) mesh.boundary_groups.push_back({name});
    std::vector<Side> sides;
    for (int f = 0; f < mesh.face_count(); ++f) append_sides_of_face(mesh, f, f, sides);
    if (dim == 2)  // ends of lines
        for (std::size_t k = 0; k < sides.size(); ++k) sides[k].even = k % 2 == 0;
    int open = 0, branching = 0;
    std::string where;
    const int turned = turn_outward(mesh, sides);
    for_equal_sides(sides, [&](std::span<const Side> equal) {
        branching += equal.size() > 2;
        if (equal.size() == 1 && open++ == 0) where = position_text(&mesh.x[offset(equal[0].vertex[0], dim)], dim);
    });
    const auto note = [&](int count, const char* noun, const std::string& what) {
        if (count) notes.push_back(concat(counted(count, noun), what));
    };
    note(left_out.flat, "face", " without area left out");
    note(left_out.doubled, "doubled face", " left out");
    note(turned, "face", " turned over, unlike their neighbours or inward");
    note(branching, "edge", " with more than two faces");
    note(open, "open edge", concat(", the first at ", where, ": nodes near there go to the rim"));
    return mesh;
}

}  // namespace almesh
