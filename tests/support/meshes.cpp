#include "support/meshes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <set>

#include "mesh/lagrange.hpp"

namespace almesh::test {

namespace {

std::string side_of_square(const double* p) {
    return p[0] == 0 ? "left" : p[0] == 1 ? "right" : p[1] == 0 ? "bottom" : "top";
}

// Columns of cells from `split` on are cut into triangles.
Mesh mesh_of_square(int k, int split, double amplitude) {
    std::vector<double> x;
    for (int j = 0; j <= k; ++j)
        for (int i = 0; i <= k; ++i) {
            const double a = static_cast<double>(i) / k, b = static_cast<double>(j) / k;
            const double moved = i % k == 0 || j % k == 0 ? 0 : amplitude / k;
            x.insert(x.end(), {a + moved * std::sin(3 + 7.0 * i + 4 * j), b + moved * std::sin(5.0 * i + 11 * j)});
        }
    std::vector<int> triangles, squares;
    for (int j = 0; j < k; ++j)
        for (int i = 0; i < k; ++i) {
            const int a = j * (k + 1) + i, b = a + 1, c = a + k + 2, d = a + k + 1;
            if (i < split) squares.insert(squares.end(), {a, b, c, d});
            else triangles.insert(triangles.end(), {a, b, c, a, c, d});
        }
    const int count = static_cast<int>(triangles.size()) / 3;
    std::vector<ElementGroup> groups;
    if (count > 0) groups.push_back({&simplex(2), 0, count, 0});
    groups.push_back({&quadrilateral(), count, static_cast<int>(squares.size()) / 4, triangles.size()});
    triangles.insert(triangles.end(), squares.begin(), squares.end());
    return linear_mesh(2, x, triangles, side_of_square, groups);
}

}  // namespace

Mesh quad_mesh(int k, double amplitude) { return mesh_of_square(k, k, amplitude); }

Mesh mixed_mesh(int k, double amplitude) { return mesh_of_square(k, k / 2, amplitude); }

Mesh linear_mesh(int dim, std::vector<double> x, std::vector<int> elements, const BoundaryName& name,
                 std::vector<ElementGroup> groups) {
    Mesh mesh;
    mesh.dim = dim;
    mesh.degree = 1;
    mesh.x = std::move(x);
    mesh.elements = std::move(elements);
    mesh.groups = std::move(groups);
    std::map<std::set<int>, std::vector<std::pair<int, int>>> uses;  // face vertices -> (element, face of it)
    for (int e = 0; e < mesh.element_count(); ++e)
        for (std::size_t f = 0; f < mesh.cell(e).faces.size(); ++f) {
            std::set<int> face;
            for (int k = 0; k < dim; ++k) face.insert(mesh.element(e)[mesh.cell(e).faces[f][k]]);
            uses[face].push_back({e, static_cast<int>(f)});
        }
    for (const auto& [vertices, use] : uses) {
        if (use.size() != 1) continue;
        const auto [e, v] = use[0];
        const CellFace& local = mesh.cell(e).faces[v];
        std::vector<double> centre(dim, 0.0);
        for (int k = 0; k < dim; ++k) {
            const int node = mesh.element(e)[local[k]];
            mesh.faces.push_back(node);
            for (int a = 0; a < dim; ++a) centre[a] += mesh.x[node * dim + a] / dim;
        }
        mesh.face_element.push_back(e);
        const std::string boundary = name(centre.data());
        if (mesh.boundary_index(boundary) < 0) {
            add_boundary(mesh, {boundary});
            mesh.file.groups.push_back({dim - 1, static_cast<int>(mesh.boundaries.size()), boundary});
        }
        mesh.face_boundary.push_back(mesh.boundary_index(boundary));
        mesh.file.face_physical.push_back(mesh.face_boundary.back() + 1);
        mesh.file.face_entity.push_back(mesh.face_boundary.back() + 1);
        mesh.file.face_id.push_back(static_cast<long long>(mesh.file.face_id.size()) + 1);
    }
    for (int i = 0; i < mesh.nodes(); ++i) mesh.file.node_id.push_back(i + 1);
    for (int e = 0; e < mesh.element_count(); ++e)
        mesh.file.element_id.push_back(static_cast<long long>(mesh.file.face_id.size()) + e + 1);
    mesh.file.element_physical.assign(mesh.element_count(), 100);
    mesh.file.element_entity.assign(mesh.element_count(), 1);
    mesh.file.groups.push_back({dim, 100, "domain"});
    return mesh;
}

Mesh square_mesh(int k) {
    std::vector<double> x;
    for (int j = 0; j <= k; ++j)
        for (int i = 0; i <= k; ++i) x.insert(x.end(), {static_cast<double>(i) / k, static_cast<double>(j) / k});
    std::vector<int> elements;
    for (int j = 0; j < k; ++j)
        for (int i = 0; i < k; ++i) {
            const int a = j * (k + 1) + i, b = a + 1, c = a + k + 2, d = a + k + 1;
            elements.insert(elements.end(), {a, b, c, a, c, d});
        }
    return linear_mesh(2, x, elements, side_of_square);
}

Mesh cube_mesh(int k, int cubes) {
    const int length = cubes * k;
    std::vector<double> x;
    for (int l = 0; l <= k; ++l)
        for (int j = 0; j <= k; ++j)
            for (int i = 0; i <= length; ++i)
                x.insert(x.end(), {static_cast<double>(i) / k, static_cast<double>(j) / k, static_cast<double>(l) / k});
    // Kuhn's six tetrahedra: the paths from corner 0 to corner 7 along the axes.
    constexpr int paths[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {1, 0, 2}, {0, 2, 1}, {2, 1, 0}};
    const int step[3] = {1, length + 1, (length + 1) * (k + 1)};
    std::vector<int> elements;
    for (int l = 0; l < k; ++l)
        for (int j = 0; j < k; ++j)
            for (int i = 0; i < length; ++i)
                for (int path = 0; path < 6; ++path) {
                    int node = l * step[2] + j * step[1] + i;
                    std::array<int, 4> t = {node, 0, 0, 0};
                    for (int s = 0; s < 3; ++s) t[s + 1] = node += step[paths[path][s]];
                    if (path >= 3) std::swap(t[2], t[3]);  // odd paths are negatively oriented
                    elements.insert(elements.end(), t.begin(), t.end());
                }
    return linear_mesh(3, x, elements, [](const double* p) -> std::string {
        return p[2] == 0 ? "bottom" : p[2] == 1 ? "top" : "sides";
    });
}

Mesh ring_mesh(int around, int layers, double outer) {
    std::vector<double> x;
    for (int l = 0; l <= layers; ++l)
        for (int i = 0; i < around; ++i) {
            const double r = std::pow(outer, static_cast<double>(l) / layers),
                         angle = 2 * std::numbers::pi * i / around;
            x.insert(x.end(), {r * std::cos(angle), r * std::sin(angle)});
        }
    std::vector<int> elements;
    for (int l = 0; l < layers; ++l)
        for (int i = 0; i < around; ++i) {
            const int a = l * around + i, b = l * around + (i + 1) % around, c = b + around, d = a + around;
            elements.insert(elements.end(), {a, d, c, a, c, b});
        }
    const double middle = 0.5 * (1 + outer);
    return linear_mesh(2, x, elements, [middle](const double* p) -> std::string {
        return std::hypot(p[0], p[1]) < middle ? "inner" : "outer";
    });
}

Mesh two_parts(const Mesh& mesh, double scale, const std::array<double, 3>& shift) {
    std::vector<double> x = mesh.x;
    for (int i = 0; i < mesh.nodes(); ++i)
        for (int a = 0; a < mesh.dim; ++a) x.push_back(scale * mesh.x[offset(i, mesh.dim, a)] + shift[a]);
    std::vector<int> elements = mesh.elements;
    for (const int i : mesh.elements) elements.push_back(i + mesh.nodes());
    return linear_mesh(mesh.dim, x, elements, [](const double*) { return "rim"; });
}

int face_near(const Mesh& mesh, int boundary, const std::array<double, 3>& x) {
    int nearest = -1;
    double least = std::numeric_limits<double>::infinity();
    for (int f = 0; f < mesh.face_count(); ++f) {
        const std::array<double, 3> centre = centroid(mesh, mesh.x, mesh.face(f), mesh.dim);
        const double distance = std::hypot(centre[0] - x[0], centre[1] - x[1], centre[2] - x[2]);
        if (mesh.face_boundary[f] != boundary || distance >= least) continue;
        nearest = f;
        least = distance;
    }
    return nearest;
}

std::vector<double> wavy(const std::vector<double>& x, int dim, double amplitude) {
    std::vector<double> y = x;
    for (std::size_t i = 0; i < x.size(); i += dim)
        for (int a = 0; a < dim; ++a) {
            double phase = a;
            for (int b = 0; b < dim; ++b) phase += (2 + a + 2 * b) * x[i + b];
            y[i + a] += amplitude * std::sin(phase);
        }
    return y;
}

}  // namespace almesh::test
