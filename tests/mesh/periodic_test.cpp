#include "mesh/periodic.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "energy/distortion_energy.hpp"
#include "io/msh.hpp"
#include "io/su2.hpp"
#include "linalg/vector_ops.hpp"
#include "method/fixed_nodes.hpp"
#include "mesh/build.hpp"
#include "support/periodic_box.hpp"
#include "support/program.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

Mesh mesh_from(const PeriodicBox& box) {
    std::vector<std::string> notes;
    return build_mesh(parse_msh(box.msh(), "a.msh"), notes);
}

PeriodicPairs pairs_of(const Mesh& mesh, int most = 1, const std::vector<int>& hold = {}) {
    const std::vector<char> all(mesh.boundaries.size(), 1);
    return periodic_pairs(mesh, periodic_boundaries(mesh, all), hold.empty() ? std::vector<int>(mesh.nodes(), 0) : hold,
                          most);
}

double wave(std::size_t k) { return std::sin(1.0 + 3.7 * static_cast<double>(k)); }

// E(z) with slaves placed by their masters.
struct Folded {
    const Mesh& mesh;
    const PeriodicPairs pairs = pairs_of(mesh);
    std::unique_ptr<DistortionEnergy> energy = make_energy(mesh, mesh.x, {});

    explicit Folded(const Mesh& of) : mesh(of) { energy->set_pairs(pairs); }
    std::vector<double> moved(double by) const {
        std::vector<double> x = mesh.x, d = x;
        for (std::size_t k = 0; k < x.size(); ++k) d[k] = wave(k);
        pairs.spread(d);
        axpy(by, d, x);
        return x;
    }
    std::vector<double> gradient(const std::vector<double>& x) const {
        std::vector<double> g(x.size(), 0.0);
        energy->add_gradient(x, g);
        pairs.fold(g);
        return g;
    }
};

}  // namespace

TEST_CASE("a rotation and translation is fitted to pairs of points; a mirror image or a larger one is not") {
    const double c = std::cos(0.5), s = std::sin(0.5);
    const std::vector<Vec<3>> points = {{1, 2, 3}, {2, 2, 3}, {1, 5, 3}, {1, 2, 8}, {4, 5, 6}};
    std::vector<std::pair<Vec<3>, Vec<3>>> turned, mirrored, scaled;
    for (const Vec<3>& x : points) {
        turned.push_back({x, {c * x[0] - s * x[1] + 7, s * x[0] + c * x[1], x[2] - 1}});
        mirrored.push_back({x, {-x[0], x[1], x[2]}});
        scaled.push_back({x, 1.001 * x});
    }
    PeriodicSides sides{2, 1, 2, {}, {}};
    REQUIRE(fit(turned, sides));
    CHECK(std::abs(sides.R[0][1] + s) < 1e-14);
    CHECK(std::abs(sides.t[0] - 7) < 1e-14);
    CHECK(!fit(mirrored, sides));
    CHECK(!fit(scaled, sides));
    CHECK(!fit({}, sides));
    CHECK(!fit({turned.begin(), turned.begin() + 2}, sides));  // a line in space
    sides.dim = 1;
    CHECK(fit({{{0, 0, 0}, {3, 0, 0}}, {{0, 1, 0}, {3, 1, 0}}}, sides));
    CHECK(sides.R == Mat<3>{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}});
    CHECK(sides.t == Vec<3>{3, 0, 0});
}

TEST_CASE("pairs of nodes are found in every degree and refinement, with one master for the corners of a box") {
    for (const bool simplices : {true, false})
        for (const int dim : {2, 3})
            for (const int directions : {1, 2, 3})
                for (const int degree : {1, 2, 3}) {
                    if (directions > dim || (dim == 3 && degree == 3)) continue;
                    CAPTURE(simplices); CAPTURE(dim); CAPTURE(directions); CAPTURE(degree);
                    const Mesh coarse = mesh_from({{4, 4, dim == 3 ? 4 : 0}, simplices, directions});
                    const Mesh mesh = raise_degree(dim == 2 ? refine(coarse, 1) : coarse, degree);
                    const PeriodicPairs pairs = pairs_of(mesh);
                    const int n = (dim == 2 ? 8 : 4) * degree + 1, side = dim == 2 ? n : n * n;
                    const int expected = directions == 1 ? side
                                         : directions == 3 ? n * n * n - (n - 1) * (n - 1) * (n - 1)
                                         : dim == 2 ? 2 * n - 1 : (2 * n - 1) * n;
                    CHECK(static_cast<int>(pairs.pairs.size()) == expected);
                    CHECK(pairs.mismatch(mesh.x) < 1e-14);
                    CHECK(pairs.centres.empty());
                    for (const PeriodicPairs::Pair& pair : pairs.pairs) CHECK(pairs.of_node[pair.master] < 0);
                    CHECK(pairs_of(mesh, 0).held.size() == pairs.pairs.size());
                }
}

TEST_CASE("a side is periodic as a whole, with another one that may be") {
    const Mesh mesh = mesh_from({});
    using Flags = std::vector<char>;
    Flags expected(mesh.boundaries.size(), 0), all(mesh.boundaries.size(), 1);
    CHECK(periodic_boundaries(mesh, expected) == expected);
    for (const char* name : {"left", "right"}) expected[mesh.boundary_index(name)] = 1;
    CHECK(periodic_boundaries(mesh, all) == expected);
    all[mesh.boundary_index("left")] = 0;
    CHECK(periodic_boundaries(mesh, all) == Flags(all.size(), 0));
    Mesh other = mesh;
    other.x[1] += 0.01;  // a corner
    CHECK(periodic_boundaries(other, Flags(all.size(), 1)) == Flags(all.size(), 0));
    other = mesh;
    other.face_boundary[mesh.face_count() - 1] = mesh.boundary_index("left");  // a face more that is no image
    CHECK(periodic_boundaries(other, Flags(all.size(), 1)) == Flags(all.size(), 0));
}

TEST_CASE("nodes on the axis of a sector are their own images") {
    PeriodicBox box{{4, 4, 0}, true, 1};
    box.map = [](Vec<3> x) {  // a sector of 40 degrees, its tip cut into one node by a map that is 0 there
        const double angle = 0.7 * x[0] / 2;
        return Vec<3>{(2 - x[1]) * std::cos(angle), (2 - x[1]) * std::sin(angle), 0};
    };
    Mesh mesh = mesh_from(box);
    CHECK(pairs_of(mesh).centres.empty());
    PeriodicSides& by = mesh.file.periodic.at(0);
    by.slave = by.master = 3;  // the outer arc: an image of itself by no such rotation
    CHECK(pairs_of(mesh).pairs.empty());
}

TEST_CASE("gradient and Hessian of what is eliminated: differences converge with their order") {
    for (const int dim : {2, 3})
        for (const int directions : {1, 2})
            for (const bool is_sector : {false, true}) {
                if (is_sector && directions == 2) continue;
                CAPTURE(dim); CAPTURE(directions); CAPTURE(is_sector);
                PeriodicBox box{{4, 4, dim == 3 ? 4 : 0}, dim == 3, directions};
                if (is_sector) box.map = to_sector(30);
                const Mesh mesh = raise_degree(mesh_from(box), dim == 2 ? 2 : 1);
                const Folded of(mesh);
                const double start = 0.01;
                const std::vector<double> x = of.moved(start), g = of.gradient(x);
                std::vector<double> d(x.size());
                for (std::size_t k = 0; k < d.size(); ++k) d[k] = wave(k);
                of.pairs.spread(d);
                std::vector<double> z = d;  // P z = d
                for (const PeriodicPairs::Pair& pair : of.pairs.pairs) std::fill_n(point(z, pair.slave, dim), dim, 0.0);
                BlockCsr H = of.energy->hessian_pattern();
                of.energy->add_hessian(x, HessianKind::full, H);
                of.pairs.fold(H);
                const std::vector<double> Hz = times_at_nodes(H, z);
                double error[2][2];
                for (const int fine : {0, 1}) {
                    const double h = fine ? 1e-4 : 2e-4;
                    const std::vector<double> after = of.moved(start + h), before = of.moved(start - h);
                    const double difference = of.energy->energy(after) - of.energy->energy(before);
                    error[0][fine] = std::abs(difference / (2 * h) - dot(g, z));
                    std::vector<double> slope = of.gradient(after);
                    axpy(-1, of.gradient(before), slope);
                    for (std::size_t k = 0; k < slope.size(); ++k) slope[k] = slope[k] / (2 * h) - Hz[k];
                    error[1][fine] = norm_inf(slope);
                }
                for (const auto& of_order : error) {
                    CHECK(std::log2(of_order[0] / of_order[1]) > 1.8);
                    CHECK(std::log2(of_order[0] / of_order[1]) < 2.2);
                }
                for (const PeriodicPairs::Pair& pair : of.pairs.pairs)
                    CHECK(H.block(H.find(pair.slave, pair.slave))[0] > 0);
            }
}

TEST_CASE("$Periodic of MSH 2.2 and 4.1, with and without the affine line, and what is wrong in it") {
    const std::string text = PeriodicBox{}.msh();
    const auto sides = [](const std::string& of) { return parse_msh(of, "a.msh").periodic; };
    REQUIRE(sides(text).size() == 1);
    CHECK(sides(text)[0].t == Vec<3>{2, 0, 0});
    std::string affine = text;
    affine.replace(affine.find("1 2 1\n"), 6, "1 2 1\nAffine 1 0 0 2 0 1 0 0 0 0 1 0 0 0 0 1\n");
    CHECK(sides(affine)[0].t == Vec<3>{2, 0, 0});

    std::string noisy = text;
    noisy.replace(noisy.find(" 2 0 0\n"), 7, " 2.001 0 0\n");
    CHECK(sides(noisy).empty());
    CHECK(parse_msh(noisy, "a.msh").notes.at(0).ends_with("entity 2 are not those of its master 1 rotated and moved"));

    const std::string in_4_1 =
        "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 4 1 4\n2 1 0 4\n1\n2\n3\n4\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n"
        "$EndNodes\n"
        "$Elements\n1 1 1 1\n2 1 3 1\n1 1 2 3 4\n$EndElements\n";
    CHECK(sides(in_4_1 + "$Periodic\n1\n1 2 4\n0\n2\n2 1\n3 4\n$EndPeriodic\n").at(0).master == 4);
    const std::string with_map = "$Periodic\n1\n1 2 4\n16 1 0 0 1 0 1 0 0 0 0 1 0 0 0 0 1\n2\n2 1\n3 4\n$EndPeriodic\n";
    CHECK(sides(in_4_1 + with_map).at(0).t == Vec<3>{1, 0, 0});
    for (const char* wrong : {"1\n1 2 4\n0\n2\n2 1\n", "-1\n", "1\n1 2\n", "x\n", "1\n1 2 4\n0\n99999\n2 1\n", ""}) {
        const RawMesh mesh = parse_msh(in_4_1 + "$Periodic\n" + wrong + "$EndPeriodic\n", "a.msh");
        CHECK(mesh.periodic.empty());
        REQUIRE(mesh.notes.size() == 1);
        CHECK(mesh.notes[0].starts_with("periodic sides are not known: a.msh:"));
    }
}

TEST_CASE("NPERIODIC of SU2: centre, angles in radians, translation") {
    const std::string square =
        "NDIME= 2\nNELEM= 1\n9 0 1 2 3\nNPOIN= 4\n0 0\n1 0\n1 1\n0 1\n"
        "NMARK= 4\nMARKER_TAG= left\nMARKER_ELEMS= 1\n3 3 0\n"
        "MARKER_TAG= right\nMARKER_ELEMS= 1\n3 1 2\nMARKER_TAG= bottom\nMARKER_ELEMS= 1\n3 0 1\n"
        "MARKER_TAG= top\nMARKER_ELEMS= 1\n3 2 3\nNPERIODIC= 2\n";
    const auto transformation = [](const std::string& centre, const std::string& angles, const std::string& by) {
        return "PERIODIC_INDEX= 1\nPERIODIC_CENTER= " + centre + "\nPERIODIC_ROTATION= " + angles +
               "\nPERIODIC_TRANSLATE= " + by + "\n";
    };
    const auto periodic = [&](const std::string& text) {
        std::vector<std::string> notes;
        const std::string all = square + transformation("0 0 0", "0 0 0", "0 0 0") + text;
        const Mesh mesh = build_mesh(parse_su2(all, "a.su2"), notes);
        std::string names;
        const std::vector<char> found = periodic_boundaries(mesh, std::vector<char>(mesh.boundaries.size(), 1));
        for (std::size_t b = 0; b < found.size(); ++b)
            if (found[b]) names += mesh.boundaries[b] + " ";
        return names;
    };
    CHECK(periodic("") == "");
    CHECK(periodic(transformation("0 0 0", "0 0 0", "1 0 0")) == "left right ");
    CHECK(periodic(transformation("0 0 0", "0 0 0", "0 -1 0")) == "bottom top ");
    CHECK(periodic(transformation("1 0 0", "0 0 1.5707963267948966", "0 0 0")) == "right bottom ");
}
