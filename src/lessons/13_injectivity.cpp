// Lesson 13: meshes whose triangles are all valid and that cover points twice all the same; what their boundaries say
// of that; and signs that floating-point numbers get wrong.
//
// Each mesh is written to outputs/lessons/13-injectivity/NAME.msh, and the cover numbers of a grid of points to
// NAME.csv: how many triangles a point is in. With a number as its argument the program makes a strip of so many turns.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

namespace {

const std::string folder = "outputs/lessons/13-injectivity/";

using Point = std::array<double, 2>;

struct Mesh {
    std::string name;
    std::vector<Point> x;
    std::vector<std::array<int, 3>> triangles;  // counter-clockwise
    std::vector<std::array<int, 2>> boundary;   // its edges, with their triangles on the left
    std::vector<int> inner;                     // nodes inside
};

Point on_circle(double radius, double turns) {
    const double angle = 2 * std::numbers::pi * turns;
    return {radius * std::cos(angle), radius * std::sin(angle)};
}

// A closed strip of 2 m triangles between the circles of radius 1 and 2.
Mesh strip(int m, int turns, const std::string& name) {
    Mesh mesh{name, {}, {}, {}, {}};
    for (int i = 0; i < m; ++i) {
        const int a = 2 * i, b = a + 1, c = 2 * ((i + 1) % m), d = c + 1;  // b and d on the outer circle
        mesh.x.push_back(on_circle(1, double(turns) * i / m));
        mesh.x.push_back(on_circle(2, double(turns) * i / m));
        mesh.triangles.insert(mesh.triangles.end(), {{a, b, d}, {a, d, c}});
        mesh.boundary.insert(mesh.boundary.end(), {{b, d}, {c, a}});
    }
    return mesh;
}

// m triangles around a node.
Mesh fan(int m, int turns, double radius, const std::string& name) {
    Mesh mesh{name, {{0, 0}}, {}, {}, {0}};
    for (int i = 0; i < m; ++i) {
        mesh.x.push_back(on_circle(radius, double(turns) * i / m));
        mesh.triangles.push_back({0, 1 + i, 1 + (i + 1) % m});
        mesh.boundary.push_back({1 + i, 1 + (i + 1) % m});
    }
    return mesh;
}

Mesh together(Mesh one, const Mesh& other, const std::string& name) {
    const int first = static_cast<int>(one.x.size());
    one.name = name;
    one.x.insert(one.x.end(), other.x.begin(), other.x.end());
    for (const auto& [i, j, k] : other.triangles) one.triangles.push_back({first + i, first + j, first + k});
    for (const auto& [i, j] : other.boundary) one.boundary.push_back({first + i, first + j});
    for (const int i : other.inner) one.inner.push_back(first + i);
    return one;
}

// Two octagons over each other, both cut from node 0 to node 1 by way of node 2 and of node 3, and joined again
// crosswise: the upper half of one octagon and the lower half of the other have node 2.
Mesh sheets() {
    Mesh mesh{"sheets", {{-0.5, 0}, {0.5, 0}, {0, 0.1}, {0, -0.1}}, {}, {}, {0, 1, 2, 3}};
    for (const int above : {2, 3}) {
        const int below = 5 - above, first = static_cast<int>(mesh.x.size());
        const int centre[9] = {1, above, above, 0, 0, below, below, 1, 1};  // of the side from k to k + 1
        for (int k = 0; k < 8; ++k) {
            const int i = first + k, j = first + (k + 1) % 8;
            mesh.x.push_back(on_circle(above == 2 ? 2 : 1.2, k / 8.0));
            mesh.triangles.push_back({centre[k], i, j});
            if (centre[k] != centre[k + 1]) mesh.triangles.push_back({centre[k], j, centre[k + 1]});
            mesh.boundary.push_back({i, j});
        }
    }
    return mesh;
}

// det(b - a, c - a): twice the area of a triangle, negative where it is inverted.
double det(const Point& a, const Point& b, const Point& c) {
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

double least_det(const Mesh& mesh) {
    double least = std::numeric_limits<double>::infinity();
    for (const auto& [i, j, k] : mesh.triangles) least = std::min(least, det(mesh.x[i], mesh.x[j], mesh.x[k]));
    return least;
}

// The largest sum of angles at a node inside, in full turns.
double most_turns(const Mesh& mesh) {
    std::vector<double> turns(mesh.x.size());
    for (const auto& t : mesh.triangles)
        for (int k = 0; k < 3; ++k) {
            const Point &a = mesh.x[t[k]], &b = mesh.x[t[(k + 1) % 3]], &c = mesh.x[t[(k + 2) % 3]];
            const double dot = (b[0] - a[0]) * (c[0] - a[0]) + (b[1] - a[1]) * (c[1] - a[1]);
            turns[t[k]] += std::atan2(det(a, b, c), dot) / (2 * std::numbers::pi);
        }
    double most = 0;
    for (const int i : mesh.inner) most = std::max(most, turns[i]);
    return most;
}

// Pairs of edges of the boundary, each with the ends of the other on both sides.
int crossings(const Mesh& mesh) {
    const auto parts = [&](const std::array<int, 2>& e, const std::array<int, 2>& f) {
        const auto side = [&](int i) { return det(mesh.x[e[0]], mesh.x[e[1]], mesh.x[i]); };
        return side(f[0]) * side(f[1]) < -1e-9;
    };
    int count = 0;
    for (std::size_t i = 0; i < mesh.boundary.size(); ++i)
        for (std::size_t j = 0; j < i; ++j)
            count += parts(mesh.boundary[i], mesh.boundary[j]) && parts(mesh.boundary[j], mesh.boundary[i]);
    return count;
}

int cover_number(const Mesh& mesh, const Point& y) {
    return static_cast<int>(std::count_if(mesh.triangles.begin(), mesh.triangles.end(), [&](const auto& t) {
        const Point &a = mesh.x[t[0]], &b = mesh.x[t[1]], &c = mesh.x[t[2]];
        return det(a, b, y) > 0 && det(b, c, y) > 0 && det(c, a, y) > 0;
    }));
}

// How many of 160 x 160 points are covered 0, 1, 2, ... times; each in a table for the picture.
std::array<int, 5> cover_numbers(const Mesh& mesh) {
    std::FILE* const file = std::fopen((folder + mesh.name + ".csv").c_str(), "w");
    std::fprintf(file, "x,y,number\n");
    std::array<int, 5> points{};
    for (int j = 0; j < 160; ++j)
        for (int i = 0; i < 160; ++i) {
            const Point y = {0.0271 * (i - 79.6), 0.0271 * (j - 79.3)};
            const int number = cover_number(mesh, y);
            ++points[number];
            std::fprintf(file, "%.4f,%.4f,%d\n", y[0], y[1], number);
        }
    std::fclose(file);
    return points;
}

void write(const Mesh& mesh) {
    std::FILE* const file = std::fopen((folder + mesh.name + ".msh").c_str(), "w");
    std::fprintf(file, "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n%zu\n", mesh.x.size());
    for (std::size_t i = 0; i < mesh.x.size(); ++i)
        std::fprintf(file, "%zu %.17g %.17g 0\n", i + 1, mesh.x[i][0], mesh.x[i][1]);
    std::fprintf(file, "$EndNodes\n$Elements\n%zu\n", mesh.triangles.size());
    for (std::size_t e = 0; e < mesh.triangles.size(); ++e)
        std::fprintf(file, "%zu 2 2 1 1 %d %d %d\n", e + 1, mesh.triangles[e][0] + 1, mesh.triangles[e][1] + 1,
                     mesh.triangles[e][2] + 1);
    std::fprintf(file, "$EndElements\n");
    std::fclose(file);
}

// Cover numbers on the line y = 0.3 from left to right, and what the boundary does where they change.
void walk(const Mesh& mesh) {
    const double height = 0.3;
    std::vector<std::array<double, 2>> steps;  // where an edge crosses the line, and 1 where it goes down
    for (const auto& [i, j] : mesh.boundary) {
        const Point &a = mesh.x[i], &b = mesh.x[j];
        if ((a[1] < height) != (b[1] < height))
            steps.push_back({a[0] + (height - a[1]) / (b[1] - a[1]) * (b[0] - a[0]), a[1] < height ? -1.0 : 1.0});
    }
    std::sort(steps.begin(), steps.end());
    std::printf("%s along y = %.1f: 0", mesh.name.c_str(), height);
    for (std::size_t k = 0; k < steps.size(); ++k) {
        const double next = k + 1 < steps.size() ? steps[k + 1][0] : steps[k][0] + 1;
        std::printf(" | %s at %.3f | %d", steps[k][1] > 0 ? "down" : "up", steps[k][0],
                    cover_number(mesh, {0.5 * (steps[k][0] + next), height}));
    }
    std::printf("\n");
}

// The orientation of p, (12, 12) and (24, 24) for p = (1/2 + i u, 1/2 + j u), u = 2^-53: its sign is that of j - i.
void signs() {
    std::FILE* const file = std::fopen((folder + "signs.csv").c_str(), "w");
    std::fprintf(file, "i,j,sign\n");
    int zero = 0, opposite = 0;
    for (int j = 0; j < 256; ++j)
        for (int i = 0; i < 256; ++i) {
            const double u = 0x1p-53, found = det({0.5 + i * u, 0.5 + j * u}, {12, 12}, {24, 24});
            const int sign = (found > 0) - (found < 0), exact = (j > i) - (j < i);
            zero += sign == 0 && exact != 0;
            opposite += sign * exact < 0;
            std::fprintf(file, "%d,%d,%d\n", i, j, sign);
        }
    std::fclose(file);
    std::printf("65280 points beside a line: %d on it by their signs, %d on its other side\n", zero, opposite);
}

void show(const Mesh& mesh) {
    const auto points = cover_numbers(mesh);
    std::printf("%-8s %9zu %10.4f ", mesh.name.c_str(), mesh.triangles.size(), least_det(mesh));
    if (mesh.inner.empty()) std::printf("     -");
    else std::printf("%6.2f", most_turns(mesh));
    std::printf(" %10d  ", crossings(mesh));
    for (const int count : points) std::printf(" %5d", count);
    std::printf("\n");
    write(mesh);
}

}  // namespace

int main(int count, char** argument) {
    std::filesystem::create_directories(folder);
    std::printf("mesh     triangles  least det  turns  crossings   points covered 0, 1, 2, 3, 4 times\n");
    if (count > 1) {
        const int turns = std::clamp(std::atoi(argument[1]), 1, 4);
        const Mesh mesh = strip(12 * turns + 1, turns, "strip-" + std::to_string(turns));
        show(mesh);
        return walk(mesh), 0;
    }
    const Mesh ring = strip(12, 1, "ring"), twice = strip(25, 2, "strip"), small = fan(12, 1, 0.9, "");
    for (const Mesh& mesh : {ring, twice, fan(13, 2, 2, "fan"), together(ring, small, "nested"),
                             together(fan(12, 1, 2, ""), small, "bodies"), sheets()})
        show(mesh);
    walk(twice);
    signs();
}
