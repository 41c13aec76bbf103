#include "check/boundary_distance.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>
#include <utility>

#include "base/error.hpp"
#include "base/parallel.hpp"
#include "base/table.hpp"
#include "constraint/sliding.hpp"
#include "constraint/sliding_nodes.hpp"
#include "constraint/target.hpp"
#include "geometry/face_patches.hpp"

namespace almesh {
namespace {

constexpr double face_work = 1e5;  // simple operations for one face,
constexpr double node_work = 1e3;  // to find the distance of one node, at least
constexpr double rounding_of_edges = 1e-12, rounding_of_positions = 64 * std::numeric_limits<double>::epsilon();

// Integrals over one face, in units of a simplex of measure 1 / m!.
struct OfFace {
    double area = 0, squared = 0, largest = 0;  // squared: of d^2
};

// The patches of faces, each with a grid that cuts it into equal simplices.
struct SampledFaces {
    const FacePatches faces;
    std::vector<std::vector<double>> values;    // of each point: the Bernstein polynomials of the patches
    std::vector<std::array<int, 3>> simplices;  // their points

    SampledFaces(const Mesh& mesh, int cuts) : faces(mesh) {  // cuts: parts of an edge
        const Bernstein &form = faces.basis.bernstein, grid(form.dim, cuts);
        const int m = form.dim;
        for (const MultiIndex& a : grid.index) {
            std::vector<double>& B = values.emplace_back(form.multinomial);
            for (int b = 0; b < form.count; ++b)
                for (int k = 0; k <= m; ++k) B[b] *= std::pow(static_cast<double>(a[k]) / cuts, form.index[b][k]);
        }
        const auto place = [&](int i, int j) { return grid.place({cuts - i - j, i, j}); };
        for (int j = 0; j < (m == 1 ? 1 : cuts); ++j)
            for (int i = 0; i + j < cuts; ++i) {
                simplices.push_back({place(i, j), place(i + 1, j), m == 1 ? 0 : place(i, j + 1)});
                if (m == 2 && i + j < cuts - 1)
                    simplices.push_back({place(i + 1, j), place(i + 1, j + 1), place(i, j + 1)});
            }
    }

    // d = distance(point). Over a simplex T with the values d_i at its m + 1 corners the integral of d^2, d linear, is
    // |T| / ((m + 1) (m + 2)) (sum of d_i^2 + (sum of d_i)^2).
    template <class Distance>
    OfFace measure(int f, const std::vector<double>& x, const Distance& distance) const {
        const int m = faces.mesh.dim - 1;
        OfFace face;
        for (const Patch& patch : faces.of(f, x)) {
            std::vector<Vec<3>> y(values.size());
            std::vector<double> d;
            for (std::size_t q = 0; q < y.size(); ++q) {
                for (std::size_t b = 0; b < patch.size(); ++b) y[q] = y[q] + values[q][b] * patch[b];
                d.push_back(distance(y[q]));
                face.largest = std::max(face.largest, d[q]);
            }
            for (const std::array<int, 3>& at : simplices) {
                const double area = length(flat_normal(std::array{y[at[0]], y[at[1]], y[at[2]]}, m));
                double sum = 0, squares = 0;
                for (int k = 0; k <= m; ++k) sum += d[at[k]], squares += d[at[k]] * d[at[k]];
                face.area += area;
                face.squared += area * (squares + sum * sum) / ((m + 1) * (m + 2));
            }
        }
        return face;
    }
};

double longest_edge(const Mesh& mesh, const std::vector<double>& x, int f) {
    const std::vector<Vec<3>> corner = positions(mesh, x, mesh.face(f), mesh.face_cell(f).vertices);
    double edge = 0;
    for (std::size_t i = 0; i < corner.size(); ++i)  // around a quadrilateral
        edge = std::max(edge, length(corner[(i + 1) % corner.size()] - corner[i]));
    return edge;
}

bool is_rounding(const Mesh& mesh, const std::vector<double>& original, int f, double edge, double distance) {
    const Vec<3> at = positions(mesh, original, mesh.face(f), 1)[0];
    return distance <= rounding_of_edges * edge + rounding_of_positions * length(at);
}

// faces: what was found for the faces `numbers` of the mesh.
BoundaryDistance sum_of(const Mesh& mesh, const std::vector<double>& original, const std::vector<int>& numbers,
                        const std::vector<OfFace>& faces) {
    BoundaryDistance sum = {.boundary = mesh.face_boundary[numbers[0]], .faces = static_cast<int>(numbers.size())};
    double area = 0;
    for (std::size_t k = 0; k < numbers.size(); ++k) {
        const OfFace& face = faces[k];
        area += face.area;
        const double edge = longest_edge(mesh, original, numbers[k]);
        if (is_rounding(mesh, original, numbers[k], edge, face.largest)) continue;
        ++sum.moved;
        sum.moved_area += face.area;
        sum.largest = std::max(sum.largest, face.largest);
        sum.relative_largest = std::max(sum.relative_largest, face.largest / edge);
        sum.rms += face.squared;
        sum.relative_rms += face.squared / (edge * edge);
    }
    sum.moved_area /= area;
    sum.rms = std::sqrt(sum.rms / area);
    sum.relative_rms = std::sqrt(sum.relative_rms / area);
    return sum;
}

// Of each boundary that is measured and has moved faces: body(its faces, what was found of each).
template <class Body>
void for_moved_boundaries(const Mesh& mesh, const std::vector<double>& original, const std::vector<double>& x,
                          const std::vector<char>& measured, const Body& body) {
    std::vector<std::vector<int>> faces_of(mesh.boundaries.size());
    for (int f = 0; f < mesh.face_count(); ++f)
        if (measured.empty() || measured[mesh.face_boundary[f]]) faces_of[mesh.face_boundary[f]].push_back(f);
    const auto has_moved = [&](int f) {
        return std::any_of(mesh.face(f), mesh.face(f) + mesh.face_nodes(f), [&](int i) {
            return !std::equal(point(x, i, mesh.dim), point(x, i, mesh.dim) + mesh.dim, point(original, i, mesh.dim));
        });
    };
    const SampledFaces sampled(mesh, 6 * ((mesh.degree + 2) / 3));  // with the middles of edges and of triangles
    for (const std::vector<int>& of : faces_of) {
        if (std::none_of(of.begin(), of.end(), has_moved)) continue;
        std::vector<Patch> patches;
        for (const int f : of)
            for (Patch& patch : sampled.faces.of(f, original)) patches.push_back(std::move(patch));
        const ClosestPoint surface(sampled.faces.basis, patches);
        std::vector<OfFace> found(of.size());
        parallel_for_uneven(static_cast<int>(of.size()), [&](int k) {
            found[k] = sampled.measure(of[k], x, [&, moved = has_moved(of[k])](const Vec<3>& y) {
                return moved ? surface.find(y).distance : 0.0;
            });
        }, face_work);
        body(of, found);
    }
}

}  // namespace

std::vector<BoundaryDistance> boundary_distances(const Mesh& mesh, const std::vector<double>& original,
                                                 const std::vector<double>& x, const std::vector<char>& measured) {
    std::vector<BoundaryDistance> distances;
    for_moved_boundaries(mesh, original, x, measured, [&](const std::vector<int>& of, const auto& found) {
        const BoundaryDistance sum = sum_of(mesh, original, of, found);
        if (sum.moved > 0) distances.push_back(sum);
    });
    return distances;
}

std::vector<double> relative_face_distances(const Mesh& mesh, const std::vector<double>& original,
                                            const std::vector<double>& x, const std::vector<char>& measured) {
    std::vector<double> relative(mesh.face_count(), 0.0);
    for (const auto& [from, to] : {std::tie(original, x), std::tie(x, original)})
        for_moved_boundaries(mesh, from, to, measured, [&](const std::vector<int>& of, const auto& found) {
            for (std::size_t k = 0; k < of.size(); ++k) {
                const double edge = std::min(longest_edge(mesh, original, of[k]), longest_edge(mesh, x, of[k]));
                if (!is_rounding(mesh, original, of[k], edge, found[k].largest))
                    relative[of[k]] = std::max(relative[of[k]], found[k].largest / edge);
            }
        });
    return relative;
}

std::string distance_table(const Mesh& mesh, const std::vector<BoundaryDistance>& distances, const std::string& from) {
    if (distances.empty()) return "";
    std::vector<Fields> rows;
    for (const BoundaryDistance& of : distances)
        rows.push_back({mesh.boundaries[of.boundary], of.faces, of.moved, fixed(100 * of.moved_area, 1) + " %",
                        to_text(of.largest, 3), to_text(of.rms, 3), to_text(of.relative_largest, 3),
                        to_text(of.relative_rms, 3)});
    const TextTable table{{{"boundary", -8}, {"faces", 6}, {"moved", 6}, {"area", 7}, {"largest", 9}, {"RMS", 9},
                           {"largest/edge", 12}, {"RMS/edge", 9}}};
    return "distance of the faces from " + from + " (edge: the longest of the face):\n" + table.text(rows);
}

namespace {

std::vector<double> distances_from_surfaces(const Mesh& mesh, const BoundaryTarget& target,
                                            const SlidingSurfaces& sliding, const std::vector<double>& x) {
    const SampledFaces sampled(mesh, 2 * mesh.degree);
    std::vector<double> distance(mesh.face_count(), 0.0);
    parallel_for(mesh.face_count(), [&](int f) {
        if (!target.slides(mesh, f)) return;
        const std::vector<int> part = {sliding.part(mesh, f)};
        const auto from_surface = [&](const Vec<3>& y) { return length(y - on_surfaces(sliding, part, y)); };
        distance[f] = sampled.measure(f, x, from_surface).largest;
    }, face_work);
    return distance;
}

}  // namespace

double distance_from_surfaces(const Mesh& mesh, const BoundaryTarget& target, const SlidingSurfaces& sliding,
                              const std::vector<double>& x) {
    const std::vector<double> distance = distances_from_surfaces(mesh, target, sliding, x);
    return distance.empty() ? 0 : *std::max_element(distance.begin(), distance.end());
}

std::vector<char> curved_faces(const Mesh& mesh, const BoundaryTarget& target, const SlidingSurfaces& sliding,
                               const std::vector<double>& x, double tolerance) {
    const std::vector<double> distance = distances_from_surfaces(mesh, target, sliding, x);
    std::vector<char> curved(mesh.face_count(), 0);
    for (int f = 0; f < mesh.face_count(); ++f) curved[f] = distance[f] > tolerance * longest_edge(mesh, x, f);
    return curved;
}

OffMotion off_motion(const Mesh& mesh, const BoundaryTarget& target, const SlidingSurfaces* sliding,
                     const std::vector<double>& now, const std::vector<double>& x) {
    double rounding = 0;
    for (const double at : x) rounding = std::max(rounding, 4 * std::numeric_limits<double>::epsilon() * std::abs(at));
    OffMotion off;
    std::vector<char> is_off(mesh.nodes(), 0);
    std::map<int, MovedNode> moved;
    for_face_nodes(mesh, [&](int f, std::size_t k) {
        const int i = mesh.faces[k], dim = mesh.dim;
        const double *const from = &target.written[k * dim], *const to = point(x, i, dim);
        if (!is_prescribed(target.written_kind[k]) || std::equal(to, to + dim, from)) return;
        const bool is_fixed = target.written_kind[k] == NodeKind::fixed, slides = target.is_freed(k);
        const double distance = length(in_space(to, dim) - in_space(from, dim));
        if (is_fixed || distance > rounding) {
            is_off[i] = 1;
            off.largest = std::max(off.largest, distance);
        }
        if (!slides && (!is_fixed || std::equal(from, from + dim, &now[k * dim]))) return;
        MovedNode& node = moved.try_emplace(i, MovedNode{i, mesh.face_boundary[f], distance, ""}).first->second;
        if (!slides) return;
        off.largest_slide = std::max(off.largest_slide, node.distance);
        const std::string name = sliding->surface(sliding->part(mesh, f)).name();
        if (node.along.find(name) == std::string::npos) node.along += (node.along.empty() ? "" : " and ") + name;
    });
    off.nodes = static_cast<int>(std::count(is_off.begin(), is_off.end(), 1));
    for (auto& [i, node] : moved) off.moved.push_back(std::move(node));
    return off;
}

std::string moved_nodes_csv(const Mesh& mesh, const std::vector<MovedNode>& nodes) {
    std::string text = "node,boundary,distance,along\n";
    for (const MovedNode& of : nodes)
        text += csv_row({mesh.file.node_id[of.node], mesh.boundaries[of.boundary], of.distance, of.along});
    return text;
}

std::string moved_nodes_text(const Mesh& mesh, const std::vector<MovedNode>& nodes) {
    constexpr std::size_t most = 10;
    if (nodes.empty()) return "";
    const auto how = [](const std::string& along) { return along.empty() ? "off the surface" : "along: " + along; };
    std::map<std::string, std::size_t> counts;
    for (const MovedNode& of : nodes) ++counts[how(of.along)];
    std::string text;
    for (const auto& [along, times] : counts) text += concat(text.empty() ? "" : "; ", times, " ", along);
    text = concat(counted(nodes.size(), "boundary node"), " gave way (", text, "):\n");
    for (std::size_t k = 0; k < std::min(most, nodes.size()); ++k)
        text += concat("  ", mesh.file.node_id[nodes[k].node], " of ", mesh.boundaries[nodes[k].boundary], " by ",
                       to_text(nodes[k].distance, 3), ", ", how(nodes[k].along), "\n");
    return text + (nodes.size() > most ? "  ..., all of them in moved-nodes.csv\n" : "");
}

std::vector<double> wall_distance(const Mesh& mesh, const std::vector<double>& x, const std::vector<char>& is_wall) {
    const FacePatches faces(mesh);
    std::vector<Patch> patches;
    std::vector<char> on_wall(mesh.nodes(), 0);
    for (int f = 0; f < mesh.face_count(); ++f) {
        if (!is_wall[mesh.face_boundary[f]]) continue;
        for (Patch& patch : faces.of(f, x)) patches.push_back(std::move(patch));
        for (int i = 0; i < mesh.face_nodes(f); ++i) on_wall[mesh.face(f)[i]] = 1;
    }
    if (patches.empty())
        throw InputError("wall distance: the boundary has no faces; name another one");
    const ClosestPoint wall(faces.basis, patches);
    std::vector<double> distance(mesh.nodes(), 0.0);
    parallel_for(mesh.nodes(), [&](int i) {
        if (!on_wall[i]) distance[i] = wall.find(positions(mesh, x, &i, 1)[0]).distance;
    }, node_work);
    return distance;
}

}  // namespace almesh
