// Runs on hexahedra, prisms, pyramids and tetrahedra, with what simplices have: objectives, methods, files, refusals.
#include <doctest/doctest.h>

#include <string>

#include "support/program.hpp"
#include "support/solids.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

// All types with every kind of face between them; the top is lifted and turned, the sides follow.
struct Block {
    TemporaryFolder folder;
    std::string output = folder.path("out"), deck;

    explicit Block(const std::string& layers = "hdpuh", const std::string& sides = "") {
        folder.write("block.msh", msh_of(solid_mesh(2, layers, 0.1)));
        const std::string motion = sides.empty() ? "twist 15 about 0.5 0.5 0 axis 0 0 1" : sides;
        deck = folder.write("block.deck", "mesh = block.msh\noutput = " + output +
                                              "\nboundary bottom = fixed\nboundary top = rotate " +
                                              std::to_string(15 * layers.size() / 2.0) +
                                              " about 0.5 0.5 0 axis 0 0 1\nboundary sides = " + motion + "\n");
    }
    Outcome run(std::vector<std::string> settings = {}) const {
        settings.insert(settings.begin(), deck);
        return almesh_bounded(settings);
    }
    std::string of(const std::string& key) const { return summary_of(output).at(key); }
};

void check_certified(const Block& block, const std::vector<std::string>& settings) {
    const Outcome run = block.run(settings);
    CAPTURE(settings.empty() ? "" : settings[0]);
    CAPTURE(run.out + run.error);
    CHECK(run.code == 0);
    CHECK(has(run.out, "certified valid and injective"));
}

}  // namespace

TEST_CASE("a block of all solid cells is turned with every objective, method, degree and refinement") {
    const Block block;
    const std::vector<std::vector<std::string>> all = {
        {}, {"objective=squared"}, {"objective=size_shape"}, {"objective=minimax"},
        {"algorithm=adaptive"}, {"continuation=always"}, {"refine=1"}, {"degree=2"}, {"degree=2", "start=identity"},
        {"degree=2", "refine=1", "threads=3"}, {"degree=3"}, {"weight_exponent=0.3"}};
    for (const std::vector<std::string>& settings : all) check_certified(block, settings);
}

TEST_CASE("sides of solid cells slide and are free") {
    check_certified(Block("hh", "slide"), {"degree=2"});
    check_certified(Block("hdpuh", "free"), {});
}

TEST_CASE("the result of solid cells is the same in every format, and a target for another run") {
    for (const std::string degree : {"1", "2"})
        for (const std::string final_format : {"msh", "su2"}) {
            const Block block, again;
            check_certified(block, {"degree=" + degree, "final=" + final_format});
            const bool is_su2 = final_format == "su2";
            const Mesh result = mesh_of(block.output + (is_su2 ? "/final.su2" : "/final.msh"));
            CHECK(result.element_count() == 72);
            CHECK(result.groups.size() == 4);
            if (is_su2) continue;
            const std::string deck =
                again.folder.write("again.deck", "mesh = block.msh\noutput = " + again.output +
                                                     "\nboundary all = mesh " + block.output + "/final.msh\n");
            const Outcome run = almesh_bounded({deck, "degree=" + degree});
            CAPTURE(run.out + run.error);
            CHECK(run.code == 0);
            CHECK(std::stod(again.of("relative_quality")) ==
                  doctest::Approx(std::stod(block.of("relative_quality"))).epsilon(1e-6));
        }
}

TEST_CASE("what solid cells cannot have is refused with a sentence that says what is") {
    const Outcome split = Block().run({"split=auto"});
    CHECK(split.code == 1);
    CHECK(has(split.error, "split divides triangles and tetrahedra, but the mesh has 16 tetrahedra, 8 hexahedra"));
    RawMesh raw = solid_block(1, "h");
    raw.nodes[7].x[0] = raw.nodes[7].x[1] = raw.nodes[7].x[2] = 0.2;
    std::vector<std::string> notes;
    const TemporaryFolder folder;
    folder.write("pushed.msh", msh_of(build_mesh(raw, notes)));
    const std::string deck =
        folder.write("pushed.deck", "mesh = pushed.msh\nboundary all = fixed\noutput = " + folder.path("out"));
    const Outcome run = almesh_with({deck});
    CHECK(run.code == 2);
    CHECK(has(run.error, "1 element with straight sides"));
}
