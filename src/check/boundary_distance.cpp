#include "check/boundary_distance.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <utility>

#include "base/parallel.hpp"
#include "geometry/closest_point.hpp"
#include "geometry/face_patches.hpp"

namespace almesh {
namespace {

constexpr double face_work = 1e5;  // simple operations for one face that has moved
constexpr double rounding_of_edges = 1e-12, rounding_of_positions = 64 * std::numeric_limits<double>::epsilon();

// A simplex cut into equal ones. Degree p: so finely that there are two parts or more for each part between nodes.
struct Grid {
    std::vector<std::vector<double>> values;    // of each point: the Bernstein polynomials of degree p
    std::vector<std::array<int, 3>> simplices;  // their points

    explicit Grid(const Bernstein& form) {
        const int m = form.dim, cuts = 6 * ((form.degree + 2) / 3);
        const Bernstein points(m, cuts);
        for (const MultiIndex& a : points.index) {
            std::vector<double>& B = values.emplace_back(form.multinomial);
            for (int b = 0; b < form.count; ++b)
                for (int k = 0; k <= m; ++k) B[b] *= std::pow(static_cast<double>(a[k]) / cuts, form.index[b][k]);
        }
        const auto place = [&](int i, int j) { return points.place({cuts - i - j, i, j}); };
        for (int j = 0; j < (m == 1 ? 1 : cuts); ++j)
            for (int i = 0; i + j < cuts; ++i) {
                simplices.push_back({place(i, j), place(i + 1, j), m == 1 ? 0 : place(i, j + 1)});
                if (m == 2 && i + j < cuts - 1)
                    simplices.push_back({place(i + 1, j), place(i + 1, j + 1), place(i, j + 1)});
            }
    }

    std::vector<Vec<3>> points_of(const Patch& patch) const {
        std::vector<Vec<3>> points;
        for (const std::vector<double>& B : values) {
            Vec<3>& y = points.emplace_back();
            for (std::size_t b = 0; b < B.size(); ++b) y = y + B[b] * patch[b];
        }
        return points;
    }
};

// Integrals over one face, in units of a simplex of measure 1 / m!.
struct OfFace {
    double area = 0, squared = 0, largest = 0, edge = 0;  // squared: of d^2
    bool moved = false;
};

class Boundary {
public:
    Boundary(const FacePatches& faces, const Grid& grid, const std::vector<int>& of, const std::vector<double>& came)
        : faces_(faces), grid_(grid), came_(came), surface_(faces.basis, patches_of(faces, of, came)) {}

    OfFace measure(int f, const std::vector<double>& x, bool is_moved) const {
        const Mesh& mesh = faces_.mesh;
        OfFace face;
        const std::vector<Vec<3>> corner = positions(mesh, came_, mesh.face(f), mesh.face_cell(f).vertices);
        for (std::size_t i = 0; i < corner.size(); ++i)  // around a quadrilateral
            face.edge = std::max(face.edge, length(corner[(i + 1) % corner.size()] - corner[i]));
        for (const Patch& patch : faces_.of(f, x)) add(grid_.points_of(patch), is_moved, face);
        const double rounding = rounding_of_edges * face.edge + rounding_of_positions * length(corner[0]);
        face.moved = face.largest > rounding;
        return face;
    }

private:
    const FacePatches& faces_;
    const Grid& grid_;
    const std::vector<double>& came_;
    const ClosestPoint surface_;

    static std::vector<Patch> patches_of(const FacePatches& faces, const std::vector<int>& of,
                                         const std::vector<double>& came) {
        std::vector<Patch> patches;
        for (const int f : of)
            for (Patch& patch : faces.of(f, came)) patches.push_back(std::move(patch));
        return patches;
    }

    // The integral over a simplex T of the square of a linear d with the values d_i at its m + 1 corners is
    // |T| / ((m + 1) (m + 2)) (sum of d_i^2 + (sum of d_i)^2).
    void add(const std::vector<Vec<3>>& points, bool is_moved, OfFace& face) const {
        const int m = faces_.mesh.dim - 1;
        std::vector<double> d(points.size(), 0.0);
        for (std::size_t q = 0; q < d.size() && is_moved; ++q) {
            d[q] = std::sqrt(surface_.squared_distance(points[q]));
            face.largest = std::max(face.largest, d[q]);
        }
        for (const std::array<int, 3>& simplex : grid_.simplices) {
            const std::array<Vec<3>, 3> corner = {points[simplex[0]], points[simplex[1]], points[simplex[2]]};
            const double area = length(flat_normal(corner, m));
            double sum = 0, squares = 0;
            for (int k = 0; k <= m; ++k) {
                sum += d[simplex[k]];
                squares += d[simplex[k]] * d[simplex[k]];
            }
            face.area += area;
            face.squared += area * (squares + sum * sum) / ((m + 1) * (m + 2));
        }
    }
};

bool has_moved(const Mesh& mesh, int f, const std::vector<double>& came, const std::vector<double>& x) {
    return std::any_of(mesh.face(f), mesh.face(f) + mesh.face_nodes(f), [&](int i) {
        return !std::equal(point(x, i, mesh.dim), point(x, i, mesh.dim) + mesh.dim, point(came, i, mesh.dim));
    });
}

BoundaryDistance sum_of(int boundary, const std::vector<OfFace>& faces) {
    BoundaryDistance sum = {.boundary = boundary, .faces = static_cast<int>(faces.size())};
    double area = 0;
    for (const OfFace& face : faces) {
        area += face.area;
        if (!face.moved) continue;
        ++sum.moved;
        sum.moved_area += face.area;
        sum.largest = std::max(sum.largest, face.largest);
        sum.relative_largest = std::max(sum.relative_largest, face.largest / face.edge);
        sum.rms += face.squared;
        sum.relative_rms += face.squared / (face.edge * face.edge);
    }
    sum.moved_area /= area;
    sum.rms = std::sqrt(sum.rms / area);
    sum.relative_rms = std::sqrt(sum.relative_rms / area);
    return sum;
}

}  // namespace

std::vector<BoundaryDistance> boundary_distances(const Mesh& mesh, const std::vector<double>& came,
                                                 const std::vector<double>& x, const std::vector<char>& measured) {
    std::vector<char> moved(mesh.face_count());
    std::vector<std::vector<int>> faces_of(mesh.boundaries.size());
    std::vector<char> has_any(mesh.boundaries.size(), 0);
    for (int f = 0; f < mesh.face_count(); ++f) {
        const int b = mesh.face_boundary[f];
        if (!measured.empty() && !measured[b]) continue;
        faces_of[b].push_back(f);
        moved[f] = has_moved(mesh, f, came, x);
        has_any[b] |= moved[f];
    }
    std::vector<BoundaryDistance> distances;
    if (std::count(has_any.begin(), has_any.end(), 1) == 0) return distances;
    const FacePatches faces(mesh);
    const Grid grid(faces.basis.bernstein);
    for (std::size_t b = 0; b < faces_of.size(); ++b) {
        if (!has_any[b]) continue;
        const std::vector<int>& of = faces_of[b];
        const Boundary boundary(faces, grid, of, came);
        std::vector<OfFace> found(of.size());
        parallel_for_uneven(static_cast<int>(of.size()), [&](int k) {
            found[k] = boundary.measure(of[k], x, moved[of[k]]);
        }, face_work);
        const BoundaryDistance sum = sum_of(static_cast<int>(b), found);
        if (sum.moved > 0) distances.push_back(sum);
    }
    return distances;
}

std::string table_of(const Mesh& mesh, const std::vector<BoundaryDistance>& distances, const std::string& from) {
    std::size_t width = 8;
    for (const BoundaryDistance& of : distances) width = std::max(width, mesh.boundaries[of.boundary].size());
    const auto padded = [width](const std::string& name) { return name + std::string(width - name.size(), ' '); };
    std::string text = "distance of the faces from " + from + " (edge: the longest of the face):\n" +
                       padded("boundary") + "   faces   moved     area    largest        RMS  largest/edge   RMS/edge\n";
    for (const BoundaryDistance& of : distances) {
        char cells[128];
        std::snprintf(cells, sizeof cells, "  %6d  %6d  %5.1f %%  %9.3g  %9.3g  %12.3g  %9.3g\n", of.faces, of.moved,
                      100 * of.moved_area, of.largest, of.rms, of.relative_largest, of.relative_rms);
        text += padded(mesh.boundaries[of.boundary]) + cells;
    }
    return distances.empty() ? "" : text;
}

}  // namespace almesh
