#include <doctest/doctest.h>

#include <cmath>
#include <cstdint>
#include <numbers>

#include "base/bytes.hpp"
#include "support/meshes.hpp"
#include "support/program.hpp"
#include "support/solids.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

// The boundary of a mesh as text, quadrilaterals as two triangles.
std::string stl_of(const Mesh& mesh, double scale = 1) {
    std::string text = "solid\n";
    for (int f = 0; f < mesh.face_count(); ++f) {
        const std::span<const int> corner = mesh.face_vertices(f);
        for (std::size_t k = 1; k + 1 < corner.size(); ++k) {
            text += "facet normal 0 0 0\nouter loop\n";
            for (const int i : {corner[0], corner[k], corner[k + 1]}) {
                text += "vertex";
                for (int a = 0; a < 3; ++a) text += ' ' + to_text(scale * mesh.x[3 * static_cast<std::size_t>(i) + a]);
                text += '\n';
            }
            text += "endloop\nendfacet\n";
        }
    }
    return text + "endsolid\n";
}

// The unit cube about its centre, halfway to a ball, and long in z.
void blob(double* x) {
    const double y[3] = {x[0] - 0.5, x[1] - 0.5, x[2] - 0.5};
    const double most = std::max({std::abs(y[0]), std::abs(y[1]), std::abs(y[2])}), norm = std::hypot(y[0], y[1], y[2]);
    const double factor = most > 0 ? 0.3 + 0.7 * most / norm : 1;
    for (int a = 0; a < 3; ++a) x[a] = 0.5 + (a == 2 ? 1.5 : 1) * factor * y[a];
}

Mesh blob_mesh(int k) {
    Mesh mesh = solid_mesh(k, std::string(k, 'h'));
    for (int i = 0; i < mesh.nodes(); ++i) blob(&mesh.x[3 * static_cast<std::size_t>(i)]);
    return mesh;
}

struct Block {
    TemporaryFolder folder;
    std::string output = folder.path("out");

    Block() { folder.write("block.msh", msh_of(solid_mesh(3, "hhh"))); }
    Outcome run(const std::string& motion, const std::vector<std::string>& more = {}) const {
        std::vector<std::string> arguments = {folder.write("a.deck", "mesh = block.msh\nthreads = 1\noutput = " + output +
                                                                         "\nboundary all = " + motion + "\n")};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return almesh_bounded(arguments);
    }
};

}  // namespace

TEST_CASE("a cube of hexahedra is drawn onto a long rounded one, given as STL; the distances are told both ways") {
    const Block block;
    block.folder.write("blob.stl", stl_of(blob_mesh(9)));
    const Outcome outcome = block.run("onto blob.stl");
    CAPTURE(outcome.out);
    CAPTURE(outcome.error);
    REQUIRE(outcome.code == 0);
    CHECK(has(outcome.out, "blob.stl, and that within "));
    const Mesh mesh = mesh_of(block.output + "/final.msh");
    double low = 1, high = 0;
    for (std::size_t i = 2; i < mesh.x.size(); i += 3) low = std::min(low, mesh.x[i]), high = std::max(high, mesh.x[i]);
    CHECK(low < -0.2);  // of -0.25: from 0
    CHECK(high > 1.2);
}

TEST_CASE("a square is drawn onto a circle of lines, in an OBJ with indices from the end") {
    const TemporaryFolder folder;
    std::string text;
    for (int k = 0; k < 40; ++k) {
        const double angle = std::numbers::pi * k / 20;
        text += "v " + to_text(0.5 + 0.8 * std::cos(angle)) + ' ' + to_text(0.5 + 0.8 * std::sin(angle)) + " 0\n";
    }
    for (int k = 1; k <= 40; ++k) text += "l " + std::to_string(k) + ' ' + std::to_string(k < 40 ? k - 40 : 1) + '\n';
    folder.write("circle.obj", text);
    folder.write("square.msh", msh_of(quad_mesh(4)));
    const Outcome outcome = almesh_bounded(
        {folder.write("a.deck", "mesh = square.msh\noutput = " + folder.path("out") +
                                    "\nboundary all = onto circle.obj\n")});
    CAPTURE(outcome.out);
    CAPTURE(outcome.error);
    CHECK(outcome.code == 0);
    CHECK(has(outcome.out, "circle.obj, and that within "));
}

TEST_CASE("nodes that cannot come to the surface without inverting elements are told, and are no nodes at it") {
    const Block block;
    Mesh bend = solid_mesh(6, "hhhhhh");  // by 143 degrees
    for (std::size_t k = 0; k < bend.x.size(); k += 3) {
        const double r = 1.1 + bend.x[k], angle = 2.5 * bend.x[k + 2];
        bend.x[k] = r * std::cos(angle), bend.x[k + 2] = r * std::sin(angle);
    }
    block.folder.write("bend.stl", stl_of(bend));
    const Outcome outcome = block.run("onto bend.stl");
    CAPTURE(outcome.out);
    CAPTURE(outcome.error);
    CHECK(outcome.code == 0);
    CHECK(has(outcome.out, " boundary nodes stay off the surface: elements there would be inverted"));
    CHECK(has(outcome.out, " boundary nodes off their motions by at most "));
    CHECK_FALSE(has(outcome.out, "every boundary node is where its motion takes it"));
    CHECK(block.run("onto bend.stl\nexpect nodes_off_motion = 0").code == 5);
}

TEST_CASE("landmarks are where their file has them, other nodes on the surface; a mesh serves as one") {
    const Block block;
    block.folder.write("blob.msh", msh_of(blob_mesh(9)));
    block.folder.write("landmarks.csv", "id,x,y,z\n1,-0.2,-0.1,-0.35\n");
    const Outcome outcome = block.run("file landmarks.csv; onto blob.msh");
    CAPTURE(outcome.out);
    CAPTURE(outcome.error);
    REQUIRE(outcome.code == 0);
    const Mesh mesh = mesh_of(block.output + "/final.msh");
    CHECK(std::vector<double>(mesh.x.begin(), mesh.x.begin() + 3) == std::vector<double>{-0.2, -0.1, -0.35});
}

TEST_CASE("in a mesh that is improved the nodes slide along the surface onto which they were drawn") {
    const Block block;
    block.folder.write("blob.stl", stl_of(blob_mesh(9)));
    const Outcome outcome = almesh_bounded({"improve", block.folder.path("block.msh"), "threads=1",
                                            "boundary all=onto " + block.folder.path("blob.stl"),
                                            "output=" + block.output});
    CAPTURE(outcome.out);
    CAPTURE(outcome.error);
    REQUIRE(outcome.code == 0);
    CHECK(has(outcome.out, "least scaled Jacobian raised from "));
    CHECK(has(outcome.out, "blob.stl, and that within "));
}

TEST_CASE("a cube is drawn onto a turned and larger one: edges go to edges, corners to corners") {
    const Block block;
    Mesh cube = solid_mesh(4, "hhhh");
    for (int i = 0; i < cube.nodes(); ++i) {
        double* const x = &cube.x[3 * static_cast<std::size_t>(i)];
        const double y[3] = {x[0] - 0.5, x[1] - 0.5, x[2] - 0.5}, c = std::cos(0.2), s = std::sin(0.2);
        x[0] = 0.6 + 1.2 * (c * y[0] - s * y[1]), x[1] = 0.5 + 1.2 * (s * y[0] + c * y[1]), x[2] = 0.5 + 1.2 * y[2];
    }
    block.folder.write("cube.stl", stl_of(cube));
    const Outcome outcome = block.run("onto cube.stl");
    CAPTURE(outcome.out);
    CAPTURE(outcome.error);
    REQUIRE(outcome.code == 0);
    const Mesh mesh = mesh_of(block.output + "/final.msh");
    double off = 0;
    for (int i = 0; i < cube.nodes(); ++i) {  // corners of the one
        const double* const x = &cube.x[3 * static_cast<std::size_t>(i)];
        if (std::abs(std::hypot(x[0] - 0.6, x[1] - 0.5, x[2] - 0.5) - 0.6 * std::sqrt(3.0)) > 1e-9) continue;
        double least = 1;
        for (std::size_t k = 0; k < mesh.x.size(); k += 3)
            least = std::min(least, std::hypot(mesh.x[k] - x[0], mesh.x[k + 1] - x[1], mesh.x[k + 2] - x[2]));
        off = std::max(off, least);
    }
    CHECK(off < 1e-6);
}

TEST_CASE("what is corrected in a surface is told, and frames are refused") {
    const Block block;
    std::string text = stl_of(blob_mesh(4));
    const std::size_t first = text.find("facet"), second = text.find("facet", text.find("endfacet") + 8);
    const std::string facet = text.substr(first, second - first);
    std::string turned = facet;  // its first two corners exchanged
    const std::size_t a = turned.find("vertex"), b = turned.find("vertex", a + 1), c = turned.find("vertex", b + 1);
    turned = turned.substr(0, a) + turned.substr(b, c - b) + turned.substr(a, b - a) + turned.substr(c);
    text.replace(first, facet.size(), turned + facet);
    block.folder.write("blob.stl", text);
    const Outcome outcome = block.run("onto blob.stl");
    CAPTURE(outcome.out);
    CHECK(outcome.code == 0);
    CHECK(has(outcome.out, "1 doubled face left out"));
    CHECK(has(outcome.out, "1 face turned over"));
    const std::string hole = stl_of(blob_mesh(4));
    block.folder.write("blob.stl", hole.substr(0, first) + hole.substr(second));
    CHECK(has(block.run("onto blob.stl").out, "3 open edges, the first at "));
    CHECK(has(block.run("onto blob.stl\nframes = 0, 1").error, "`onto` has no frames"));
}

TEST_CASE("surfaces that are bad: a sentence says what, where and what to do") {
    const Block block;
    const auto refused = [&](const std::string& name, const std::string& text, const std::string& why) {
        block.folder.write(name, text);
        const Outcome outcome = block.run("onto " + name);
        CAPTURE(outcome.error);
        CHECK(outcome.code == 2);
        CHECK(has(outcome.error, why));
    };
    const std::string good = stl_of(blob_mesh(2));
    refused("a.stl", "", "a.stl");
    refused("a.stl", good.substr(0, good.size() - 9), "the file ends without `endsolid`: it is cut off");
    std::string text = good;
    text.replace(text.find("vertex") + 7, 1, "nan");
    refused("a.stl", text, "a.stl:4: ");
    std::string binary = "solid, but binary" + std::string(63, ' ');
    append_bytes(binary, std::uint32_t{1}, std::endian::little);
    refused("a.stl", binary + std::string(40, '\0'), "a binary STL of 1 triangles, as its head says, has 134 bytes");
    binary += std::string(50, '\0');
    refused("a.stl", binary, "a surface without triangles");
    refused("a.obj", "v 0 0 0\nv 1 0 0\nf 1/1 2//2 4\n", "a.obj:3: `4` is none of the 2 vertices so far");
    refused("a.stl", stl_of(blob_mesh(2), 1000), "they differ in unit or place");
    CHECK(has(block.run("onto").error, "the name of the file is missing"));
}
