#include "constraint/boundary_faces.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>

#include "base/disjoint_sets.hpp"
#include "mesh/sides.hpp"

namespace almesh {
namespace {

constexpr double turned_over = 179;  // degrees

}  // namespace

double angle(const Vec<3>& u, const Vec<3>& v) {
    return std::atan2(length(cross(u, v)), dot(u, v)) * 180 / std::numbers::pi;
}

BoundaryFaces::BoundaryFaces(const Mesh& mesh_, const std::vector<double>& node, const std::vector<char>& chosen)
    : mesh(mesh_), patches(mesh_), of_surface(mesh.degree == 1 ? FacePatches(mesh, 1) : patches) {
    const int dim = mesh.dim;
    const PatchNormal normal(dim - 1, patches.basis.bernstein.degree);
    for (int f = 0; f < mesh.face_count(); ++f) {
        if (!chosen[mesh.face_boundary[f]]) continue;
        std::vector<Vec<3>> moved(mesh.face_nodes(f), Vec<3>{});
        for (int i = 0; i < mesh.face_nodes(f); ++i)
            std::copy_n(&node[(mesh.face_start(f) + i) * dim], dim, moved[i].begin());
        face.push_back(f);
        position.push_back(std::move(moved));
        const Vec<3> flat = flat_of(static_cast<int>(face.size()) - 1);
        std::vector<Vec<3>> at_corner(mesh.face_cell(f).vertices, Vec<3>{});
        const std::vector<Patch> of_face = patches.of(f, position.back());
        for (std::size_t part = 0; part < of_face.size(); ++part) {
            const std::vector<Vec<3>> n = normal.coefficients(of_face[part]);  // corners first
            for (int k = 0; k < dim; ++k) {
                const Vec<3>& at = n[n.size() == 1 ? 0 : k];
                at_corner[patches.cut(f).vertices[part][k]] =
                    dot(at, flat) > 0 ? at : flat;  // of a face that is folded there
            }
        }
        corner_normal.push_back(std::move(at_corner));
        tangled.push_back(is_tangled(f));
    }
    find_sides();
}

Vec<3> BoundaryFaces::flat_of(int k) const {
    return flat_normal(position[k], mesh.dim - 1, mesh.face_cell(face[k]).vertices);
}

std::vector<Patch> BoundaryFaces::all_patches(std::vector<int>& of_face) const {
    std::vector<Patch> all;
    for (std::size_t k = 0; k < face.size(); ++k)
        for (Patch& patch : patches.of(face[k], position[k])) {
            all.push_back(std::move(patch));
            of_face.push_back(static_cast<int>(k));
        }
    return all;
}

bool BoundaryFaces::is_flat(const Vec<3>& normal, double size) const {
    constexpr double no_extent = 1e-12;
    return length(normal) <= no_extent * std::pow(size, mesh.dim - 1);
}

bool BoundaryFaces::is_tangled(int f) const {
    const int vertices = mesh.face_cell(f).vertices;
    const std::vector<Vec<3>> corner = positions(mesh, mesh.x, mesh.face(f), vertices);
    const Vec<3> n = flat_normal(corner, mesh.dim - 1, vertices);
    if (mesh.face_element[f] < 0) return false;  // of a surface alone
    const Vec<3> inward = element_centre(mesh, mesh.x, mesh.face_element[f]) - corner[0];
    return is_flat(n, length(inward)) || dot(n, inward) > 0;
}

// Whichever way they are turned where they are in one plane; a face without extent has no angle.
double BoundaryFaces::angle_when_tangled(int f, int g, double angle) const {
    for (const int k : {f, g})
        if (is_flat(flat_of(k), size_of(position[k], mesh.dim - 1))) return 90;
    return angle >= turned_over ? 0 : angle;
}

bool BoundaryFaces::has_edge(const std::vector<int>& faces, double limit) const {
    std::vector<char> chosen(face.size(), 0);
    for (const int k : faces) chosen[k] = 1;
    for (std::size_t s = 0; s < side.size(); ++s)
        if (side_angle[s] > limit && !is_tangled(side[s]) && chosen[side[s].first] && chosen[side[s].second])
            return true;
    return false;
}

bool BoundaryFaces::any_tangled(const std::vector<int>& faces) const {
    return std::any_of(faces.begin(), faces.end(), [&](int k) { return tangled[k] != 0; });
}

void BoundaryFaces::find_sides() {
    std::vector<Side> sides;
    for (int k = 0; k < static_cast<int>(face.size()); ++k)
        append_sides_of_face(mesh, face[k], k, sides);
    for_equal_sides(sides, [&](std::span<const Side> equal) {
        const int f = equal[0].number;
        for (const Side& other : equal.subspan(1)) {
            const int g = other.number;
            double largest = 0;
            for (int i = 0; i < mesh.dim - 1; ++i)
                largest = std::max(largest, angle(normal_at(f, other.vertex[i]), normal_at(g, other.vertex[i])));
            side.push_back({f, g});
            if (is_tangled(side.back())) largest = angle_when_tangled(f, g, largest);
            side_angle.push_back(largest);
        }
    });
}

Vec<3> BoundaryFaces::normal_at(int k, int node) const {
    const std::span<const int> corner = mesh.face_vertices(face[k]);
    return corner_normal[k][std::find(corner.begin(), corner.end(), node) - corner.begin()];
}

std::vector<std::vector<int>> BoundaryFaces::cut(const std::vector<int>& faces, double limit, double of_tangled) const {
    DisjointSets sets(static_cast<int>(face.size()));
    std::vector<char> chosen(face.size(), 0);
    for (const int k : faces) chosen[k] = 1;
    for (std::size_t s = 0; s < side.size(); ++s) {
        const auto [f, g] = side[s];
        const double most = is_tangled(side[s]) ? std::max(limit, of_tangled) : limit;
        if (chosen[f] && chosen[g] && side_angle[s] <= most) sets.join(f, g);
    }
    std::map<int, std::vector<int>> groups;
    for (const int k : faces) groups[sets.find(k)].push_back(k);
    std::vector<std::vector<int>> result;
    for (auto& [first, group] : groups) result.push_back(std::move(group));
    return result;
}

std::vector<Vec<3>> BoundaryFaces::points(const std::vector<int>& faces) const {
    std::map<int, Vec<3>> of_node;
    for (const int k : faces)
        for (int i = 0; i < mesh.face_nodes(face[k]); ++i) of_node[mesh.face(face[k])[i]] = position[k][i];
    std::vector<Vec<3>> result;
    for (const auto& [node, x] : of_node) result.push_back(x);
    return result;
}

std::unique_ptr<Surface> BoundaryFaces::fitted(const std::vector<int>& faces) const {
    Vec<3> normal{};
    for (const int k : faces)
        for (const Vec<3>& n : corner_normal[k]) normal = normal + n;
    return fit_surface(mesh.dim, points(faces), normal);
}

bool BoundaryFaces::on_one_quadric(const std::vector<int>& faces) const {
    constexpr double tolerance = 1e-8, least_cosine = 0.1;
    const auto quadric = fit_quadric(mesh.dim, points(faces), tolerance);
    return quadric && std::all_of(faces.begin(), faces.end(), [&](int k) {
        Vec<3> n{};
        for (int c = 0; c < mesh.face_cell(face[k]).vertices; ++c)
            n = n + quadric->closest(position[k][c]).normal;
        const Vec<3> flat = flat_of(k);
        return std::abs(dot(n, flat)) > least_cosine * length(n) * length(flat);
    });
}

std::vector<std::vector<int>> BoundaryFaces::cut_by_entity(const std::vector<int>& faces) const {
    std::map<int, std::vector<int>> groups;
    for (const int k : faces)
        groups[mesh.file.face_entity.empty() ? 0 : mesh.file.face_entity[face[k]]].push_back(k);
    std::vector<std::vector<int>> result;
    for (auto& [entity, group] : groups) result.push_back(std::move(group));
    return result;
}

std::unique_ptr<Surface> BoundaryFaces::own(const std::vector<int>& faces) const {
    std::vector<int> numbers;
    std::vector<Patch> all;
    for (const int k : faces) {
        numbers.push_back(face[k]);
        for (Patch& patch : of_surface.of(face[k], position[k])) all.push_back(std::move(patch));
    }
    return surface_of_faces(of_surface.basis, all, of_surface.nodes_of(numbers), mesh.element_count() > 0);
}

namespace {

// Where faces are tangled their surfaces become part of larger ones beside them on which all their nodes lie: of that
// with most common sides. Not of the other side of a slit.
void join_surfaces(const BoundaryFaces& faces, std::vector<SurfaceOfFaces>& found) {
    std::vector<int> owner(faces.face.size());
    std::vector<double> size;
    for (std::size_t k = 0; k < found.size(); ++k) {
        for (const int f : found[k].faces) owner[f] = static_cast<int>(k);
        size.push_back(extent(faces.points(found[k].faces)));
    }
    std::vector<std::pair<int, int>> between;
    for (std::size_t s = 0; s < faces.side.size(); ++s)
        if (owner[faces.side[s].first] != owner[faces.side[s].second] && faces.side_angle[s] < turned_over)
            between.push_back(faces.side[s]);
    const auto lies_on = [&](const std::vector<Vec<3>>& points, int b) {
        constexpr double tolerance = 1e-8;
        return std::all_of(points.begin(), points.end(), [&](const Vec<3>& x) {
            return length(found[b].surface->closest(x).position - x) <= tolerance * size[b];
        });
    };
    const auto best_for = [&](int a) {
        std::map<int, int> common;  // sides, by surface
        for (const auto& [f, g] : between)
            if ((owner[f] == a) != (owner[g] == a)) ++common[owner[f] == a ? owner[g] : owner[f]];
        const std::vector<Vec<3>> points = faces.points(found[a].faces);
        int best = -1;
        for (const auto& [b, sides] : common)
            if (!found[b].of_mesh && found[b].faces.size() >= found[a].faces.size() &&
                (best < 0 || sides > common[best]) && lies_on(points, b))
                best = b;
        return best;
    };
    for (bool again = true; again;) {
        again = false;
        for (int a = 0; a < static_cast<int>(found.size()); ++a) {
            const int b = found[a].faces.empty() ? -1 : best_for(a);
            if (b < 0) continue;
            for (const int f : found[a].faces) owner[f] = b;
            found[b].faces.insert(found[b].faces.end(), found[a].faces.begin(), found[a].faces.end());
            found[a].faces.clear();
            again = true;
        }
    }
    std::erase_if(found, [](const SurfaceOfFaces& surface) { return surface.faces.empty(); });
}

}  // namespace

std::vector<SurfaceOfFaces> surfaces_of(const BoundaryFaces& faces, double feature_angle) {
    std::vector<SurfaceOfFaces> result;
    const auto add = [&result](std::unique_ptr<Surface> surface, const std::vector<int>& of, bool of_mesh = false) {
        if (!surface) return false;
        result.push_back({std::move(surface), of, of_mesh});
        return true;
    };
    std::vector<int> all(faces.face.size());
    std::iota(all.begin(), all.end(), 0);
    const double sharp = std::max(surely_sharp, feature_angle);
    for (const std::vector<int>& connected : faces.cut(all, 180)) {
        if (faces.on_one_quadric(connected) && add(faces.fitted(connected), connected)) continue;
        std::vector<int> others;
        for (const std::vector<int>& tangled : faces.cut(connected, sharp, 180))
            if (!faces.any_tangled(tangled) || faces.has_edge(tangled, sharp) || !add(faces.fitted(tangled), tangled))
                others.insert(others.end(), tangled.begin(), tangled.end());
        for (const std::vector<int>& piece : faces.cut(others, sharp)) {
            if (add(faces.fitted(piece), piece)) continue;
            for (const std::vector<int>& smooth : faces.cut(piece, feature_angle)) {
                if (add(faces.fitted(smooth), smooth)) continue;
                std::vector<int> rest;
                const auto entities = faces.cut_by_entity(smooth);
                for (const std::vector<int>& entity : entities)
                    if (entities.size() == 1 || !add(faces.fitted(entity), entity))
                        rest.insert(rest.end(), entity.begin(), entity.end());
                if (!rest.empty()) add(faces.own(rest), rest, true);
            }
        }
    }
    if (faces.any_tangled(all)) join_surfaces(faces, result);
    return result;
}

}  // namespace almesh
