#include "problem/surface_pairing.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/error.hpp"
#include "base/table.hpp"
#include "constraint/sliding_nodes.hpp"
#include "geometry/box_tree.hpp"
#include "mesh/sides.hpp"

namespace almesh {
namespace {

Mesh in(const Frame& frame, Mesh mesh) {
    frame.take_to_run(mesh.x, mesh.dim);
    return mesh;
}

}  // namespace

const std::vector<Patch>& PatchedFaces::find(const std::vector<double>& x, const std::vector<char>& chosen) {
    for (int k = 0; k < patches.count(); ++k) {
        const int f = patches.face[k];
        if (!chosen[patches.mesh.face_boundary[f]]) continue;
        number.push_back(k);
        patch.push_back(patches.of(f, x)[patches.part(k)]);
        normal.push_back(flat_normal(patch.back(), patches.mesh.dim - 1));
    }
    return patch;
}

Vec<3> PatchedFaces::centre(std::size_t k) const {
    Vec<3> sum{};
    for (int v = 0; v < patches.mesh.dim; ++v) sum = sum + 1.0 / patches.mesh.dim * patch[k][v];
    return sum;
}

std::vector<Vec<3>> PatchedFaces::normals_at_nodes() const {
    const Mesh& mesh = patches.mesh;
    std::vector<Vec<3>> sum(mesh.nodes(), Vec<3>{});
    for (std::size_t k = 0; k < patch.size(); ++k)
        for (int i = 0; i < mesh.face_nodes(face(k)); ++i) {
            Vec<3>& n = sum[mesh.face(face(k))[i]];
            n = n + 1.0 / mesh.face_nodes(face(k)) * normal[k];
        }
    return sum;
}

SurfacePairing::SurfacePairing(const Mesh& mesh, std::string file_, std::vector<char> own_, const OtherSurface& other,
                               const Frame& frame, double feature_angle)
    : file(std::move(file_)), own(std::move(own_)), surface(in(frame, *other.mesh)),
      faces(surface, surface.x, other.boundaries), frame_(frame), smooth_(smooth_parts(mesh, feature_angle)),
      part_(smooth_parts(surface, feature_angle)) {
    constexpr int samples_of_face = 4;
    const std::vector<Vec<3>> normal = faces.normals_at_nodes();
    for (int i = 0; i < surface.nodes(); ++i)
        if (normal[i] != Vec<3>{}) samples.push_back({at_node(surface.x, i, surface.dim), normal[i]});
    const std::size_t stride = samples.size() / (samples_of_face * static_cast<std::size_t>(mesh.face_count())) + 1;
    for (std::size_t k = 0; k * stride < samples.size(); ++k) samples[k] = samples[k * stride];
    samples.resize((samples.size() + stride - 1) / stride);
    find_features();
}

void SurfacePairing::find_features() {
    std::vector<Side> sides;
    std::map<int, std::set<int>> of_node;
    for (std::size_t k = 0; k < faces.patch.size(); ++k) {
        const int f = faces.face(k);
        if (faces.patches.part(faces.number[k]) == 0) append_sides_of_face(surface, f, f, sides);
        for (const int i : surface.face_vertices(f)) of_node[i].insert(part_[f]);
    }
    const auto add = [&](const std::set<int>& parts, int i, int j) {
        features_[parts].push_back({at_node(surface.x, i, surface.dim), at_node(surface.x, j, surface.dim)});
    };
    for_equal_sides(sides, [&](std::span<const Side> equal) {
        const std::set<int> parts = {part_[equal.front().number], part_[equal.back().number]};
        if (parts.size() == 2) add(parts, equal[0].vertex[0], equal[0].vertex[surface.dim - 2]);
    });
    for (const auto& [i, parts] : of_node)
        if (parts.size() > 2) add(parts, i, i);
}

std::vector<std::set<int>> SurfacePairing::parts_at_edges(const PatchedFaces& boundary, double side) const {
    constexpr double same_way = 0.5, most = 0.6;
    const Mesh& mesh = boundary.patches.mesh;
    std::vector<std::set<int>> parts(mesh.nodes()), smooth(mesh.nodes());
    if (features_.empty()) return parts;
    std::vector<int> part;
    std::map<int, std::map<int, double>> area;  // of a smooth part, on a part of the surface
    std::map<int, double> whole;
    for (std::size_t k = 0; k < boundary.patch.size(); ++k) {
        const int nearest = faces.facing(boundary.centre(k), side * boundary.normal[k], same_way).patch;
        part.push_back(nearest < 0 ? -1 : part_[faces.face(nearest)]);
        const int own_part = smooth_[boundary.face(k)];
        area[own_part][part[k]] += length(boundary.normal[k]);
        whole[own_part] += length(boundary.normal[k]);
    }
    for (std::size_t k = 0; k < boundary.patch.size(); ++k) {
        const int f = boundary.face(k), own_part = smooth_[f];
        for (const auto& [other, share] : area[own_part])
            if (share > most * whole[own_part]) part[k] = other;
        for (int i = 0; i < mesh.face_nodes(f); ++i) {
            parts[mesh.face(f)[i]].insert(part[k]);
            smooth[mesh.face(f)[i]].insert(own_part);
        }
    }
    for (int i = 0; i < mesh.nodes(); ++i)
        if (smooth[i].size() < 2) parts[i].clear();
    return parts;
}

void SurfacePairing::take_feature(const std::set<int>& parts, const Vec<3>& x, Vec<3>& move, Mat<3>& across) const {
    const auto found = features_.find(parts);
    if (found == features_.end()) return;
    double least = std::numeric_limits<double>::infinity();
    for (const auto& [a, b] : found->second) {
        const double squared = dot(b - a, b - a);
        const Vec<3> to = a + (squared > 0 ? std::clamp(dot(x - a, b - a) / squared, 0.0, 1.0) : 0) * (b - a) - x;
        if (length(to) >= least) continue;
        least = length(to);
        move = to;
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j)
                across[i][j] = (i == j) - (squared > 0 ? (b[i] - a[i]) * (b[j] - a[j]) / squared : 0);
    }
}

void SurfacePairing::check_place(const Mesh& mesh, const std::vector<double>& x) const {
    constexpr double most_times = 20, farthest = 3;  // of the sizes of their boxes; of the larger one
    const auto box = [&](const Mesh& of, const std::vector<double>& at, const auto& is_chosen) {
        std::vector<Vec<3>> points;
        for_face_nodes(of, [&](int f, std::size_t k) {
            if (is_chosen(of.face_boundary[f])) points.push_back(frame_.to_file(at_node(at, of.faces[k], of.dim)));
        });
        return box_of(points);
    };
    const Box here = box(mesh, x, [&](int b) { return own[b] != 0; });
    const Box there = box(surface, surface.x, [](int) { return true; });
    const double size = length(here.high - here.low), other = length(there.high - there.low);
    const double apart = 0.5 * length(here.low + here.high - there.low - there.high);
    const double larger = std::max(size, other);
    if (larger <= most_times * std::min(size, other) && apart <= farthest * larger) return;
    const auto text = [&](const Box& of) {
        return position_text(of.low.data(), mesh.dim) + " to " + position_text(of.high.data(), mesh.dim);
    };
    throw InputError(file, ": the surface reaches from ", text(there), ", the boundary that goes onto it from ",
                     text(here), ": they differ in unit or place; move one of them there first, the mesh by a run with "
                     "`boundary all = scale 1000; translate 1 0 0`");
}

std::string SurfacePairing::distances(const PatchedFaces& boundary) const {
    double edge = 0;
    const int dim = surface.dim;
    std::vector<double> distance[2];  // of corners and centres of the boundary, of points of the surface
    for (std::size_t k = 0; k < boundary.patch.size(); ++k) {
        for (int v = 0; v < dim; ++v) distance[0].push_back(faces.points.find(boundary.patch[k][v]).distance);
        distance[0].push_back(faces.points.find(boundary.centre(k)).distance);
        edge += size_of(boundary.patch[k], dim - 1) / static_cast<double>(boundary.patch.size());
    }
    for (const Sample& sample : samples) distance[1].push_back(boundary.points.find(sample.x).distance);
    const auto told = [&](const std::vector<double>& d) {
        const double largest = *std::max_element(d.begin(), d.end());
        const double squares = std::inner_product(d.begin(), d.end(), d.begin(), 0.0);
        const double rms = std::sqrt(squares / static_cast<double>(d.size()));
        return concat(to_text(largest, 3), " (", to_text(largest / edge, 2), " of an edge), RMS ", to_text(rms, 3),
                      " (", to_text(rms / edge, 2), ")");
    };
    return concat("the boundary is within ", told(distance[0]), " of ", file, ", and that within ", told(distance[1]),
                  " of the boundary\n");
}

std::list<SurfacePairing> surface_pairings(const ProblemOptions& options, const Problem& problem, const Mesh& mesh,
                                           const Frame& frame) {
    std::list<SurfacePairing> found;
    std::vector<char> is_paired(problem.other.size(), 0);
    for (std::size_t b = 0; b < problem.other.size(); ++b) {
        if (is_paired[b] || !goes_onto(problem.motions[b])) continue;
        std::vector<char> own(problem.other.size(), 0);
        for (std::size_t c = b; c < own.size(); ++c)
            if (goes_onto(problem.motions[c]) && problem.other[c] == problem.other[b]) own[c] = is_paired[c] = 1;
        found.emplace_back(mesh, surface_step(problem.motions[b])->file, own, problem.other[b], frame,
                           options.feature_angle);
    }
    return found;
}

}  // namespace almesh
