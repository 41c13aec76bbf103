// What the program refuses before it solves anything: exit codes 1 and 2, with what, where and what to do.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "support/msh_formats.hpp"
#include "support/ring_deck.hpp"
#include "support/solids.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

void check_refused(const Outcome& outcome, int code, const std::vector<std::string>& parts) {
    CAPTURE(outcome.error);
    CHECK(outcome.code == code);
    CHECK(outcome.error.starts_with("almesh: "));
    CHECK(outcome.error.ends_with('\n'));
    for (const std::string& part : parts) {
        CAPTURE(part);
        CHECK(has(outcome.error, part));
    }
}

// A run of ring.deck on another mesh file.
Outcome run_on(const std::string& msh) {
    const RingDeck ring;
    ring.folder.write("ring.msh", msh);
    const Outcome outcome = ring.run();
    CHECK(!std::filesystem::exists(ring.output));
    return outcome;
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
    const auto at = text.find(from);
    REQUIRE(at != std::string::npos);
    return text.replace(at, from.size(), to);
}

// The square's corner (1, 0), where one triangle has both edges on the boundary, moved by 0.3 towards (0, 1): it is
// then wider than 180 degrees, which no element can be. size, origin: of the square.
struct DentedSquare {
    TemporaryFolder folder;
    std::string deck, output = folder.path("out");
    double size, origin;

    DentedSquare(const std::string& msh, double size_, double origin_) : size(size_), origin(origin_) {
        folder.write("square.msh", msh);
        const std::string X = concat("((x - ", origin, ")/", size, ")"), Y = concat("((y - ", origin, ")/", size, ")"),
                          by = concat(0.3 * size, "*", X, "^2*(1-", Y, ")^2\"");
        deck = folder.write("square.deck", "mesh = square.msh\nthreads = 1\noutput = " + output +
                                               "\nboundary rest = expression \"x - " + by + " \"y + " + by + "\n");
    }
    Outcome run(const std::vector<std::string>& settings = {}) const {
        std::vector<std::string> arguments = {deck};
        for (const std::string& setting : settings) arguments.push_back(setting);
        return almesh_with(arguments);
    }
};

Mesh square_at(double size, double origin) {
    Mesh mesh = square_mesh(4);
    for (double& v : mesh.x) v = origin + size * v;
    for (int i = 0; i < mesh.nodes(); ++i) mesh.file.node_id[i] = 500 - 3 * i;
    for (int e = 0; e < mesh.element_count(); ++e) mesh.file.element_id[e] = 1000 + 7 * e;
    return mesh;
}

std::string without_faces(const Mesh& mesh) {
    std::string text = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n" + std::to_string(mesh.nodes()) + "\n";
    for (int i = 0; i < mesh.nodes(); ++i)
        text += concat(mesh.file.node_id[i], " ", mesh.x[2 * i], " ", mesh.x[2 * i + 1], " 0\n");
    text += concat("$EndNodes\n$Elements\n", mesh.element_count(), "\n");
    for (int e = 0; e < mesh.element_count(); ++e) {
        text += concat(mesh.file.element_id[e], " 2 2 1 1");
        for (int k = 0; k < 3; ++k) text += concat(" ", mesh.file.node_id[mesh.element(e)[k]]);
        text += "\n";
    }
    return text + "$EndElements\n";
}

// What is told of one folded element.
struct FoldedElement {
    long long id = -1;
    std::vector<double> place;
    double scaled_determinant = 1;

    FoldedElement(const std::string& error, const std::string& cell) {
        const std::string start = "\n  " + cell + " ", middle = " at (",
                          end = "): its boundary nodes make its scaled determinant ";
        const auto at = error.find(start), coordinates = error.find(middle, at), value = error.find(end, coordinates);
        REQUIRE(value != std::string::npos);
        id = parse_int(error.substr(at + start.size(), coordinates - at - start.size())).value();
        const auto first = coordinates + middle.size();
        for (const std::string& number : pieces(error.substr(first, value - first), ','))
            place.push_back(parse_double(trim(number)).value());
        const auto number = value + end.size();
        scaled_determinant = parse_double(error.substr(number, error.find(',', number) - number)).value();
    }
};

}  // namespace

TEST_CASE("faults of the deck: code 1 with file, line and advice, nothing written") {
    for (const auto& [lines, parts] : std::vector<std::pair<std::string, std::vector<std::string>>>{
             {"max_al_iteration = 3\n", {"ring.deck:6: ", "`max_al_iteration`", "did you mean `max_al_iterations`?"}},
             {"refine = 0\nrefine = 1\n", {"ring.deck:7: ", "`refine` is already set", "ring.deck:6"}},
             {"objective = cubed\n", {"ring.deck:6: ", "squared | deviation"}},
             {"refine = 9\n", {"ring.deck:6: ", "integer in 0..8"}},
             {"boundary wing = fixed\n", {"ring.deck:6: ", "\"wing\"", "\"inner\"", "\"outer\""}},
             {"boundary inner = fixed\n", {"ring.deck:6: ", "already set"}},
             {"wall = wing\n", {"ring.deck:6: ", "wall", "wing", "inner"}},
             {"expect quality >= 0.9\n", {"ring.deck:6: ", "`quality`", "did you mean"}},
             {"just some words\n", {"ring.deck:6: ", "key = value"}}}) {
        const RingDeck ring(ring_mesh(12, 3, 6), lines);
        check_refused(ring.run(), 1, parts);
        CHECK(!std::filesystem::exists(ring.output));
    }
}

TEST_CASE("a boundary without a motion, and motions of another dimension: code 1") {
    const RingDeck ring;
    ring.folder.write("ring.deck", "mesh = ring.msh\noutput = " + ring.output + "\nboundary inner = fixed\n");
    check_refused(ring.run(), 1,
                  {"ring.deck", "1 boundary line missing", "boundary rest = fixed", "\n  boundary outer = fixed"});
    check_refused(ring.run({"boundary outer=translate 1 0 0"}), 1, {"command line", "\"outer\"", "2 components in 2D"});
    check_refused(ring.run({"boundary outer=sphere 0 0 0 1"}), 1, {"command line", "use a circle"});
}

TEST_CASE("a deck that is not there, is a folder, a mesh, or names no mesh: code 1") {
    const RingDeck ring;
    check_refused(almesh_with({ring.folder.path("none.deck")}), 1, {"none.deck"});
    check_refused(almesh_with({ring.folder.path()}), 1, {"folder"});
    check_refused(almesh_with({ring.folder.path("ring.msh")}), 1, {"ring.msh: this is a mesh"});
    check_refused(almesh_with({ring.folder.write("empty.deck", "")}), 1, {"empty.deck", "mesh = FILE"});
}

TEST_CASE("mesh files that cannot be read: code 2, naming the file") {
    const RingDeck ring;
    std::filesystem::remove(ring.folder.path("ring.msh"));
    check_refused(ring.run(), 2, {ring.folder.path("ring.msh")});
    std::filesystem::create_directory(ring.folder.path("ring.msh"));
    check_refused(ring.run(), 2, {ring.folder.path("ring.msh")});
    check_refused(run_on(""), 2, {"ring.msh", "empty"});
    check_refused(run_on(std::string("$MeshFormat\n4.1 1 8\n\1\0\0\0", 24)), 2,
                  {"ring.msh: $MeshFormat, byte 24", "cut off"});
    check_refused(run_on("$MeshFormat\n4.1 1 8\n$EndMeshFormat\n"), 2,
                  {"ring.msh: $MeshFormat, byte 20", "order of bytes"});
    check_refused(run_on("$MeshFormat\n3.0 0 8\n$EndMeshFormat\n"), 2, {"ring.msh:2", "2.2, 4.0 and 4.1"});
    check_refused(run_on("solid cube\nfacet normal 0 0 1\n"), 2, {"ring.msh: STL", "gmsh -3"});
}

TEST_CASE("a unit of length in which the mesh has no volume that is a number") {
    for (const char* unit : {"1e-300", "1e300", "1e-60"}) {
        const RingDeck ring;
        check_refused(ring.run({concat("length_scale=", unit)}), 1,
                      {"command line: in units of length_scale = ", "leave"});
    }
    const RingDeck ring;
    CHECK(ring.run({"length_scale=0.1"}).code == 0);
}

TEST_CASE("meshes without volume, and in units in which volumes are no numbers: a sentence") {
    const TemporaryFolder folder;
    const auto run = [&](const std::string& command, const Mesh& mesh, const auto& place) {
        Mesh moved = mesh;
        for (std::size_t k = 0; k < moved.x.size(); ++k) moved.x[k] = place(k, moved.x[k]);
        const std::string path = folder.write("mesh.msh", msh_of(moved));
        return almesh_with({command, path, "threads=1", "output=" + folder.path("results")});
    };
    std::vector<Mesh> meshes = {square_mesh(3), quad_mesh(3), cube_mesh(2), solid_mesh(2, "hh"), solid_mesh(2, "pp")};
    for (const Mesh& any : {meshes[0], meshes[1], meshes[2]}) meshes.push_back(raise_degree(any, 2));
    for (const Mesh& mesh : meshes) {
        CAPTURE(mesh.elements_text());
        const auto last = static_cast<std::size_t>(mesh.dim - 1);
        const auto in_point = [](std::size_t, double) { return 1.0; };
        const auto flat = [&](std::size_t k, double x) { return k % mesh.dim == last ? 0 : x; };
        check_refused(run("improve", mesh, in_point), 2, {"mesh.msh: the volumes of its elements add up to 0"});
        check_refused(run("improve", mesh, flat), 2, {"mesh.msh: the volumes of its elements add up to 0"});
        for (const double unit : {1e-48, 1e48}) {
            const Outcome judged = run("quality", mesh, [&](std::size_t, double x) { return unit * x; });
            CHECK(judged.code == 0);
        }
        for (const std::string command : {"quality", "improve"}) {
            for (const double unit : {1e51, 1e150, 1e300})
                check_refused(run(command, mesh, [&](std::size_t, double x) { return unit * (1 + x); }), 2,
                              {"mesh.msh: node ", "take a larger unit of length"});
            for (const double unit : {1e-52, 1e-150, 1e-300})
                check_refused(run(command, mesh, [&](std::size_t, double x) { return unit * x; }), 2,
                              {"mesh.msh:", " long, ", "take a smaller unit of length"});
            for (const std::size_t k : {std::size_t{0}, mesh.x.size() - 1})
                check_refused(run(command, mesh, [&](std::size_t l, double x) { return l == k ? 1e200 : x; }), 2,
                              {"mesh.msh: node ", "1e+200"});
        }
    }
}

TEST_CASE("a mesh in thousands of parts, and long words: messages of a few lines") {
    const TemporaryFolder folder;
    std::vector<double> x;
    std::vector<int> elements;
    for (int k = 0; k < 1000; ++k) {
        x.insert(x.end(), {2.0 * k, 0, 2.0 * k + 1, 0, 2.0 * k, 1});
        elements.insert(elements.end(), {3 * k, 3 * k + 1, 3 * k + 2});
    }
    Mesh mesh = linear_mesh(2, x, elements, [](const double*) { return "rim"; });
    std::string text = msh_of(mesh);
    text.erase(text.find("$PhysicalNames"), text.find("$Nodes") - text.find("$PhysicalNames"));
    const std::string file = folder.write("a.msh", text), word(40000, 'x');
    for (const std::vector<std::string>& command :
         {std::vector<std::string>{folder.write("a.deck", "mesh = a.msh\nboundary nowhere = fixed\n")},
          {folder.write("b.deck", "mesh = a.msh\nframes = t.txt\nboundary all = fixed\n")},
          {"quality", folder.write("a.vtk", "# vtk DataFile Version 3.0\n\n" + word)},
          {"quality", folder.write("b.vtk", "# vtk DataFile Version 3.0\n\nASCII\nDATASET UNSTRUCTURED_GRID\n"
                                            "FIELD a 1\nb 2000000000 2000000000 string\n")}}) {
        folder.write("t.txt", word);
        const Outcome outcome = almesh_with(command);
        CHECK((outcome.code == 1 || outcome.code == 2));
        CHECK(outcome.error.size() < 2000);
    }
}

TEST_CASE("a mesh file that is not there: where it is named") {
    const RingDeck ring;
    check_refused(ring.run({"mesh=missing.msh"}), 2, {"command line: cannot read missing.msh: No such file"});
    std::filesystem::remove(ring.folder.path("ring.msh"));
    check_refused(ring.run(), 2, {"ring.deck:2: cannot read ", "ring.msh: No such file"});
}

TEST_CASE("mesh files whose contents cannot be meant: code 2 with file and line") {
    for (int version : {22, 41}) {
        const Mesh mesh = ring_mesh(8, 1, 2);
        const std::string good = msh_text(mesh, mesh.x, {.msh_version = version});
        check_refused(run_on(good.substr(0, good.size() / 2)), 2, {"ring.msh:"});
        check_refused(run_on(good.substr(0, good.find("$Elements"))), 2, {"ring.msh", "$Elements"});
    }
    const std::string good = msh_of(ring_mesh(8, 1, 2)), nodes = "$Nodes\n16\n", first = nodes + "1 1 0 0\n";
    check_refused(run_on(replaced(good, nodes, "$Nodes\n2000000000\n")), 2,
                  {"ring.msh:", "announces 2000000000 nodes, only 16"});
    check_refused(run_on(replaced(good, nodes, "$Nodes\n15\n")), 2,
                  {"ring.msh:", "$Nodes holds more than it announces"});
    check_refused(run_on(replaced(good, first, nodes + "2 1 0 0\n")), 2, {"ring.msh:", "node id 2 is there twice"});
    check_refused(run_on(replaced(good, first, nodes + "1 nan 0 0\n")), 2, {"ring.msh:"});
    check_refused(run_on(replaced(good, first, nodes + "99 1 0 0\n")), 2,
                  {"ring.msh:", "node 1, which is not in $Nodes"});
    check_refused(
        run_on("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n$EndNodes\n"
               "$Elements\n2\n1 4 2 1 1 1 2 3 4\n2 99 2 1 1 1 2 3 4\n$EndElements\n"),
        2, {"ring.msh:14: ", "1 element of type 99, ", "mesh with Mesh.SecondOrderIncomplete = 0"});
}

TEST_CASE("a quadrature that cannot see the nodes inside an element: code 1, naming the line") {
    const RingDeck ring(ring_mesh(8, 2, 4));
    check_refused(ring.run({"degree=3", "quadrature=1"}), 1,
                  {"command line: quadrature = 1", "degree 3", "at least 4"});
}

// All boundary nodes are where they should be, but an inner one lies outside its neighbours.
TEST_CASE("a mesh that is tangled from the start: code 2, naming an element") {
    Mesh mesh = ring_mesh(12, 3, 6);
    mesh.x[2 * 12] += 3;
    check_refused(run_on(msh_of(mesh)), 2, {"ring.msh", "element "});
}

TEST_CASE("targets that make the boundary itself invalid: code 2, naming faces before anything is solved") {
    // In a curved file, the middle node of an edge far from its middle.
    Mesh folded = raise_degree(ring_mesh(6, 2, 4), 2);
    int bad = -1;
    for (int f = 0; f < folded.face_count(); ++f)
        if (folded.boundaries[folded.face_boundary[f]] == "inner") bad = f;
    double* const middle = &folded.x[2 * folded.face(bad)[2]];
    const double* const end = &folded.x[2 * folded.face(bad)[0]];
    for (int a = 0; a < 2; ++a) middle[a] = 0.05 * middle[a] + 0.95 * end[a];
    const RingDeck ring(folded);
    check_refused(ring.run({"surface=keep"}), 2,
                  {"the target makes the boundary itself invalid at 1 face", "folds the face back",
                   "face " + std::to_string(folded.file.face_id[bad]) + " of inner", "try surface = auto"});
    CHECK(!std::filesystem::exists(ring.output));

    // Onto the closest points of a circle elsewhere: the whole inner boundary falls on one side of that.
    const RingDeck far;
    check_refused(far.run({"boundary inner=circle 9 0 1"}), 2,
                  {"the target makes the boundary itself invalid", "of inner at ("});
}

TEST_CASE("a corner that the target folds: code 2, whatever unit, origin, degree, schedule, refinement and surface") {
    for (const auto& [size, origin] : {std::pair(1.0, 0.0), std::pair(1e-3, 5.0), std::pair(1e4, -3e4)})
        for (const std::string setting :
             {"degree=1", "degree=2", "degree=3", "target=nodal", "algorithm=paper", "refine=1", "surface=keep"}) {
            CAPTURE(setting);
            const Mesh mesh = square_at(size, origin);
            const DentedSquare square(msh_of(mesh), size, origin);
            const Outcome outcome = square.run({setting});
            check_refused(outcome, 2, {"no valid mesh reaches the target: it inverts 1 element:",
                                       "try split = auto (just these are divided, with the elements at the same edges) "
                                       "or targets that do not invert them\n"});
            CHECK(!std::filesystem::exists(square.output));
            const FoldedElement folded(outcome.error, "triangle");
            CHECK(folded.scaled_determinant < 0);
            const double h = setting == "refine=1" ? 0.125 : 0.25, rounding = 1e-5 * (std::abs(origin) + size);
            REQUIRE(folded.place.size() == 2);
            const Outcome split = square.run({setting, "split=auto"});
            CAPTURE(split.error);
            CHECK(split.code == 0);
            CHECK(summary_of(square.output).at("split_elements") == "1");
            std::filesystem::remove_all(square.output);
            CHECK(std::abs(folded.place[0] - origin - size * (1 - h / 3)) < rounding);
            CHECK(std::abs(folded.place[1] - origin - size * h / 3) < rounding);
            if (setting == "refine=1") continue;
            const int e = static_cast<int>(folded.id - 1000) / 7;
            CHECK(mesh.file.element_id.at(e) == folded.id);
            CHECK(std::count(mesh.element(e), mesh.element(e) + 3, 4) == 1);  // the node in that corner
        }
}

TEST_CASE("a corner that the target folds in a mesh without boundary elements: code 2") {
    const Mesh mesh = square_at(1, 0);
    const DentedSquare square(without_faces(mesh), 1, 0);
    const Outcome outcome = square.run();
    check_refused(outcome, 2, {"it inverts 1 element:"});
    CHECK(FoldedElement(outcome.error, "triangle").id == 1000 + 7 * 6);
}

TEST_CASE("a corner of a cube that is pushed through its element: code 2, naming that") {
    const TemporaryFolder folder;
    const Mesh mesh = cube_mesh(2);
    folder.write("cube.msh", msh_of(mesh));
    const std::string by = "*exp(-400*((x-1)^2+y^2+z^2))\"";
    const std::string deck = folder.write(
        "cube.deck", "mesh = cube.msh\noutput = " + folder.path("out") + "\nboundary all = expression \"x - 0.4" + by +
                         " \"y + 0.35" + by + " \"z + 0.3" + by + "\n");
    const Outcome outcome = almesh_with({deck});
    check_refused(outcome, 2, {"it inverts 2 elements:", "try split = auto"});
    CHECK(almesh_with({deck, "split=auto"}).code == 0);
    CHECK(number(summary_of(folder.path("out")), "split_elements") == 2);
    const FoldedElement folded(outcome.error, "tetrahedron");
    CHECK(folded.place.size() == 3);
    const auto e = folded.id - mesh.file.element_id[0];
    const int* const node = mesh.element(static_cast<int>(e));
    CHECK(std::count(node, node + 4, 2) == 1);  // at (1, 0, 0)
}

TEST_CASE("an element that no node inside can divide, as its third edge is on an inner boundary: code 2, saying so") {
    const TemporaryFolder folder;
    folder.write("square.msh",
                 "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n1 1 \"rim\"\n1 2 \"rib\"\n$EndPhysicalNames\n"
                 "$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n$EndNodes\n$Elements\n7\n1 1 2 1 1 1 2\n"
                 "2 1 2 1 1 2 3\n3 1 2 1 1 3 4\n4 1 2 1 1 4 1\n5 1 2 2 2 1 3\n6 2 2 9 9 1 2 3\n7 2 2 9 9 1 3 4\n"
                 "$EndElements\n");
    const std::string deck = folder.write(
        "square.deck", "mesh = square.msh\noutput = " + folder.path("out") +
                           "\nboundary rim = expression \"x - 0.6*x*(1 - y)\" \"y + 0.6*x*(1 - y)\"\n");
    for (const std::string setting : {"split=never", "split=auto"})
        check_refused(almesh_with({deck, setting, "boundary rib=fixed"}), 2,
                      {"it inverts 1 element:\n  triangle 6 at ",
                       "\ntry a mesh in which each of these has an edge that is on no boundary or targets that do not"});
    CHECK(almesh_with({deck, "split=auto"}).code == 0);  // the rib is inside, divided like the elements beside it
}

TEST_CASE("a layer of one element that the target winds too far: code 2, and what is advised succeeds") {
    const RingDeck ring(ring_mesh(16, 1, 3));
    check_refused(ring.run({"boundary inner=rotate 120", "surface=keep"}), 2,
                  {"it inverts 16 elements:", "\n  ...\n",
                   "try surface = auto (nodes slide along the surface there), split = auto (just these are divided, "
                   "with the elements at the same edges), refine = 1 (all elements are divided) or targets that do "});
    for (const std::string setting : {"surface=auto", "split=auto", "refine=1"}) {
        CAPTURE(setting);
        CHECK(ring.run({"boundary inner=rotate 120", setting}).code == 0);
    }
}

TEST_CASE("a corner that only the coarse faces fold: code 2, and the refinement that is advised succeeds") {
    const TemporaryFolder folder;
    folder.write("square.msh", msh_of(square_mesh(4)));
    const std::string deck =
        folder.write("square.deck", "mesh = square.msh\noutput = " + folder.path("out") +
                                        "\nboundary all = expression \"x + 0.3*exp(-100*(y - 0.25)^2)*x^4\""
                                        " \"y - 0.3*exp(-100*(x - 0.75)^2)*(1 - y)^4\"\n");
    check_refused(almesh_with({deck}), 2, {"it inverts 1 element:", "try split = auto (", ", refine = 1 (all "});
    for (const std::string setting : {"split=auto", "refine=1"}) CHECK(almesh_with({deck, setting}).code == 0);
}

TEST_CASE("a projection that is not defined, or boundaries that are torn apart: code 2") {
    const RingDeck ring;
    check_refused(ring.run({"boundary inner=circle 1 0 1"}), 2, {"boundary inner", "(1, 0)", "not defined"});
    const TemporaryFolder folder;
    folder.write("square.msh", msh_of(square_mesh(2)));
    const std::string deck =
        folder.write("square.deck", "mesh = square.msh\noutput = " + folder.path("out") +
                                        "\nboundary left = translate -1 0\nboundary right = fixed\n"
                                        "boundary top = fixed\nboundary bottom = fixed\n");
    check_refused(
        almesh_with({deck}), 2,
        {"node 1 lies on two boundaries whose motions disagree", "left to (-1, 0)", "bottom takes it to (0, 0)"});
}

TEST_CASE("an output folder that cannot be made: code 2, before anything is solved") {
    const RingDeck ring;
    const std::string file = ring.folder.write("a_file", "not a folder\n");
    const Outcome outcome = ring.run({"output=" + file + "/results"});
    check_refused(outcome, 2, {file});
    CHECK(outcome.out.empty());
    check_refused(ring.run({"output=" + file}), 2, {file});
    CHECK(text_of(file) == "not a folder\n");
}
