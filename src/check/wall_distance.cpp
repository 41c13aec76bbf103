#include "check/wall_distance.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.hpp"
#include "base/parallel.hpp"
#include "geometry/closest_point.hpp"

namespace almesh {
namespace {

constexpr double flatness = 0.05;  // deviation of a piece over its size, below which the distance has one minimum on it
constexpr int max_depth = 8;       // bisections of a face
constexpr int block_nodes = 256;   // nodes that share one workspace
constexpr double node_work = 1e3;  // simple operations to find the distance of one node, at least

// A nearly flat part of a face. The descent over the whole face starts from its corners or its centre, whichever is
// closest.
struct Piece {
    int face;                          // number within the wall
    std::array<Barycentric, 4> start;  // m + 2 parameter points
    std::array<Vec<3>, 4> at;           // where they lie, relative to the origin of the face
};

struct Wall {
    int dim;
    FaceProjector projector;
    std::vector<Vec<3>> origin;   // per face: its first vertex
    std::vector<Vec<3>> control;  // per face: projector.count() Bezier points relative to the origin
    std::vector<Piece> pieces;
    std::vector<Box> boxes;      // per piece
};

void append_pieces(const Bernstein& basis, const Patch& patch, int face, const std::array<Barycentric, 3>& corner,
                   int depth, Wall& wall) {
    const int m = basis.dim;
    if (depth < max_depth && deviation(basis, patch) > flatness * size_of(patch, m)) {
        const auto [a, b] = longest_side(patch, m);
        Barycentric middle;
        for (int k = 0; k < 3; ++k) middle[k] = 0.5 * (corner[a][k] + corner[b][k]);
        const std::pair<Patch, Patch> halves = bisect(basis, patch, a, b);
        std::array<Barycentric, 3> near_a = corner, near_b = corner;
        near_a[b] = near_b[a] = middle;
        append_pieces(basis, halves.first, face, near_a, depth + 1, wall);
        append_pieces(basis, halves.second, face, near_b, depth + 1, wall);
        return;
    }
    Piece piece{face, {}, {}};
    for (int v = 0; v <= m; ++v) {
        piece.start[v] = corner[v];
        piece.at[v] = patch[v] - wall.origin[face];
        for (int k = 0; k < 3; ++k) {  // the centre lies where it would on the flat piece, as near as a start needs
            piece.start[m + 1][k] += corner[v][k] / (m + 1);
            piece.at[m + 1][k] += piece.at[v][k] / (m + 1);
        }
    }
    wall.pieces.push_back(piece);
    wall.boxes.push_back(box_of(patch));
}

Wall make_wall(const Mesh& mesh, const std::vector<double>& x, const std::vector<int>& faces) {
    const int dim = mesh.dim, m = dim - 1;
    const PatchBasis basis(m, mesh.degree);
    Wall wall{dim, FaceProjector(m, mesh.degree), {}, {}, {}, {}};
    std::vector<double> nodes;
    for (int f : faces) {
        nodes.clear();
        for (int i = 0; i < mesh.face_nodes(); ++i) {
            const double* const position = &x[static_cast<std::size_t>(mesh.face(f)[i]) * dim];
            nodes.insert(nodes.end(), position, position + dim);
        }
        const Patch patch = make_patch(basis, nodes.data(), dim);
        wall.origin.push_back(patch[0]);
        for (int k = dim * mesh.face_nodes() - 1; k >= 0; --k) nodes[k] -= nodes[k % dim];
        const Patch local = make_patch(basis, nodes.data(), dim);  // exact differences, not those of Bezier points
        for (int k = 0; k < mesh.face_nodes(); ++k) wall.control.push_back(local[k]);
        const int face = static_cast<int>(wall.origin.size()) - 1;
        append_pieces(basis.bernstein, patch, face, {{{1, 0, 0}, {0, 1, 0}, {0, 0, m - 1.0}}}, 0, wall);
    }
    return wall;
}

double squared_distance(const Wall& wall, const Piece& piece, const double* x, std::vector<Vec<3>>& work) {
    Vec<3> local{};
    for (int a = 0; a < wall.dim; ++a) local[a] = x[a] - wall.origin[piece.face][a];
    int closest = 0;
    double best = std::numeric_limits<double>::max();
    for (int s = 0; s <= wall.dim; ++s) {
        const Vec<3> d = piece.at[s] - local;
        if (dot(d, d) < best) {
            best = dot(d, d);
            closest = s;
        }
    }
    const Vec<3>* const control = &wall.control[static_cast<std::size_t>(piece.face) * wall.projector.count()];
    return wall.projector.squared_distance(control, local, piece.start[closest], work);
}

}  // namespace

std::vector<double> wall_distance(const Mesh& mesh, const std::vector<double>& x, int boundary) {
    std::vector<int> faces;
    for (int f = 0; f < mesh.face_count(); ++f)
        if (mesh.face_boundary[f] == boundary) faces.push_back(f);
    if (faces.empty())
        throw InputError("wall distance: boundary " + mesh.boundaries[boundary] + " has no faces; name another one");
    const Wall wall = make_wall(mesh, x, faces);
    const BoxTree tree(wall.boxes);
    std::vector<char> on_wall(mesh.nodes(), 0);
    for (int f : faces)
        for (int i = 0; i < mesh.face_nodes(); ++i) on_wall[mesh.face(f)[i]] = 1;

    const int count = mesh.nodes();
    std::vector<double> distance(count, 0.0);
    parallel_for((count + block_nodes - 1) / block_nodes, [&](int block) {
        std::vector<Vec<3>> work(2 * static_cast<std::size_t>(wall.projector.count()));
        for (int i = block * block_nodes; i < std::min(count, (block + 1) * block_nodes); ++i) {
            if (on_wall[i]) continue;
            const double* const point = &x[static_cast<std::size_t>(i) * mesh.dim];
            const auto to_piece = [&](int k) { return squared_distance(wall, wall.pieces[k], point, work); };
            const double far = std::numeric_limits<double>::max();
            distance[i] = std::sqrt(tree.nearest_squared(point, mesh.dim, far, to_piece));
        }
    }, node_work * block_nodes);
    return distance;
}

}  // namespace almesh
