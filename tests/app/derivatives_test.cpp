// The commands adjoint and tangent, against differences of whole runs.
#include <doctest/doctest.h>

#include <cmath>
#include <sstream>

#include "linalg/vector_ops.hpp"
#include "support/ring_deck.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

using Values = std::vector<double>;

// Rows of `node,x,y[,z]` as one vector.
Values values_in(const std::string& path) {
    Values values;
    for (const auto& row : csv_rows(text_of(path)))
        for (std::size_t k = 1; k < row.size(); ++k)
            if (const auto value = parse_double(row[k])) values.push_back(*value);
    return values;
}

// Rows for the nodes that a file has, or all of the mesh; of numbers between -1 and 1.
std::string rows_for(const Mesh& mesh, const std::vector<std::string>& ids = {}) {
    std::ostringstream out;
    out.precision(17);
    for (int i = 0; i < (ids.empty() ? mesh.nodes() : static_cast<int>(ids.size())); ++i) {
        out << (ids.empty() ? std::to_string(mesh.file.node_id[i]) : ids[i]);
        for (int a = 0; a < mesh.dim; ++a) out << ',' << std::sin(1.0 + 3.7 * i + a);
        out << '\n';
    }
    return out.str();
}

struct Case {
    const RingDeck& deck;
    std::vector<std::string> settings;

    Outcome run(const std::string& command, std::vector<std::string> more) const {
        std::vector<std::string> arguments = {command, deck.deck};
        arguments.insert(arguments.end(), settings.begin(), settings.end());
        arguments.insert(arguments.end(), more.begin(), more.end());
        return almesh_with(arguments);
    }

    // Of tangent-a.csv, from differences of the fourth order; that of the adjoint is the same. a = 1.
    void check(double tolerance, double h = 1e-3) const {
        REQUIRE(run("tangent", {}).error == "");
        const Mesh mesh = mesh_of(deck.output + "/final.msh");
        const Values tangent = values_in(deck.output + "/tangent-a.csv");
        REQUIRE(tangent.size() == mesh.x.size());
        Values error = tangent;
        for (const int k : {-2, -1, 1, 2}) {
            REQUIRE(run("tangent", {concat("let a=", 1 + k * h)}).error == "");
            const Mesh there = mesh_of(deck.output + "/final.msh");
            axpy((k == -2 ? -1 : k == -1 ? 8 : k == 1 ? -8 : 1) / (12 * h), there.x, error);
        }
        CHECK(norm_inf(error) < tolerance * norm_inf(tangent));

        const std::string rows = rows_for(mesh);
        const std::string J = deck.folder.write("J.csv", rows), K = deck.folder.write("K.csv", rows);
        const Outcome outcome = run("adjoint", {J, K});
        REQUIRE(outcome.error == "");
        CHECK(has(outcome.out, "d J / d a = "));
        const auto table = csv_rows(text_of(deck.output + "/adjoint-constants.csv"));
        CHECK(table.at(0) == std::vector<std::string>{"constant", "value", "J", "K"});
        const double expected = dot(values_in(J), tangent), size = norm_2(values_in(J)) * norm_2(tangent);
        CHECK(std::abs(parse_double(table.at(1).at(2)).value() - expected) < 1e-12 * size);
        CHECK(table[1][2] == table[1][3]);

        const std::string by_node = text_of(deck.output + "/adjoint-J.csv");
        std::vector<std::string> ids;
        for (const auto& row : csv_rows(by_node))
            if (row[0] != "node") ids.push_back(row[0]);
        const Values gradient = values_in(deck.output + "/adjoint-J.csv");
        const std::string g = deck.folder.write("g.csv", rows_for(mesh, ids));
        REQUIRE(run("tangent", {g}).error == "");
        const Values dx = values_in(deck.output + "/tangent-g.csv");
        CHECK(std::abs(dot(values_in(J), dx) - dot(gradient, values_in(g))) <
              1e-12 * norm_2(values_in(J)) * norm_2(dx));
    }
};

}  // namespace

TEST_CASE("derivatives by constants and by positions are those of runs") {
    const RingDeck ring(ring_mesh(12, 3, 6), "let a = 1\nthreads = 1\nvtk = none\nobjective = squared\n");
    const std::string inner = "boundary inner=rotate \"10*a\" about 0.5 0; translate \"2*a^2\" a";
    for (const std::string degree : {"degree=1", "degree=2"}) {
        CAPTURE(degree);
        Case{ring, {inner, degree}}.check(1e-9);
        Case{ring, {inner, degree, "objective=size_shape", "weight_exponent=1", "length_scale=0.1"}}.check(1e-9);
        Case{ring, {inner, degree, "boundary outer=slide"}}.check(1e-9);
        Case{ring, {inner, degree, "boundary outer=scale \"a^2\" a; slide"}}.check(1e-9);
        Case{ring, {inner, degree, "boundary outer=rotate \"20*a\" about a 0; slide"}}.check(1e-9);
        Case{ring, {inner, degree, "boundary outer=free"}}.check(1e-9);
    }
    Case{ring, {"boundary inner=expression \"x + a*sin(y)\" \"y*a^0.5\"", "degree=3"}}.check(1e-9);
}

TEST_CASE("derivatives with objective = minimax are those of runs, too") {
    const RingDeck ring(ring_mesh(12, 3, 6), "let a = 1\nthreads = 1\nvtk = none\nobjective = minimax\n");
    const std::string inner = "boundary inner=rotate \"10*a\" about 0.5 0; translate \"2*a^2\" a";
    for (const std::string power : {"power=3", "power=8", "power=auto"}) {
        CAPTURE(power);
        Case{ring, {inner, power}}.check(1e-7, 3e-5);
        Case{ring, {inner, power, "boundary outer=scale \"a^2\" a; slide"}}.check(1e-7, 3e-5);
    }
    Case{ring, {inner, "power=8", "degree=2"}}.check(1e-7, 3e-5);
    Case{ring, {inner, "power=4", "degree=3"}}.check(1e-7, 3e-5);
    const RingDeck cube(cube_mesh(2));
    cube.folder.write("ring.deck", "mesh = ring.msh\noutput = " + cube.output +
                                       "\nlet a = 1\nthreads = 1\nvtk = none\nobjective = minimax\npower = 8\n"
                                       "boundary top = translate 0 0.1 \"0.2*a^3\"\n"
                                       "boundary sides = free\nboundary bottom = fixed\n");
    Case{cube, {}}.check(1e-7, 3e-5);
}

TEST_CASE("derivatives in three dimensions, along planes, edges and a moving surface") {
    const RingDeck cube(cube_mesh(2));
    cube.folder.write("ring.deck", "mesh = ring.msh\noutput = " + cube.output +
                                       "\nlet a = 1\nthreads = 1\nvtk = none\nobjective = squared\n"
                                       "boundary top = expression \"x + 0.1*a*x*y\" \"y\" \"z + 0.2*a\"\n"
                                       "boundary sides = slide\nboundary bottom = fixed\n");
    Case{cube, {"boundary top=translate 0 0 \"0.2*a^3\""}}.check(1e-8);
    Case{cube, {"boundary top=translate 0 0 \"0.2*a^3\"", "boundary sides=scale a \"a^2\" 1; slide",
                "boundary bottom=slide"}}.check(1e-8);
    Case{cube, {"boundary sides=free"}}.check(1e-8);
}

TEST_CASE("a derivative by a length is the same in every unit of the mesh") {
    Values tangent[2];
    for (const bool small : {false, true}) {
        Mesh mesh = ring_mesh(12, 3, 6);
        for (double& x : mesh.x) x *= small ? 1e-9 : 1;
        const RingDeck ring(mesh, concat("vtk = none\nlet a = ", small ? 1e-9 : 1.0, "\n"));
        const std::string way = small ? "a*cos(a*1e9)" : "a*cos(a)";
        REQUIRE(Case{ring, {"boundary inner=translate \"" + way + "\" 0"}}.run("tangent", {}).error == "");
        tangent[small] = values_in(ring.output + "/tangent-a.csv");
    }
    axpy(-1, tangent[0], tangent[1]);
    CHECK(norm_inf(tangent[1]) < 1e-9 * norm_inf(tangent[0]));
}

TEST_CASE("a function of any size has its derivative, or none that is a number") {
    const RingDeck ring(ring_mesh(12, 3, 6), "let a = 0.5\nthreads = 1\nvtk = none\n");
    const Mesh mesh = ring_mesh(12, 3, 6);
    const auto by_a = [&](double size) {
        std::string rows;
        for (int i = 0; i < mesh.nodes(); ++i) rows += concat(mesh.file.node_id[i], ",", i == 20 ? size : 0.0, ",0\n");
        const Outcome outcome =
            almesh_with({"adjoint", ring.deck, ring.folder.write("J.csv", rows), "boundary inner=translate a 0"});
        CHECK(outcome.code == 0);
        return parse_double(csv_rows(text_of(ring.output + "/adjoint-constants.csv")).at(1).at(2)).value();
    };
    const double one = by_a(1);
    CHECK(std::abs(one) > 1e-3);
    for (const double size : {1e308, 1e-300}) CHECK(by_a(size) == doctest::Approx(one * size).epsilon(1e-12));
    std::string rows = "node,x,y\n";
    for (int i = 0; i < mesh.nodes(); ++i) rows += concat(mesh.file.node_id[i], ",1.7e308,0\n");
    const Outcome outcome =
        almesh_with({"adjoint", ring.deck, ring.folder.write("J.csv", rows), "boundary inner=translate a 0"});
    CHECK(outcome.code == 3);
    CHECK(has(outcome.error, "the derivative of J by "));
    CHECK(has(outcome.error, " is beyond the largest number, 1.79e+308"));
}

TEST_CASE("what cannot be differentiated is refused with a sentence") {
    const RingDeck ring(ring_mesh(12, 3, 6), "threads = 1\nvtk = none\n");
    const auto refusal = [&](std::vector<std::string> arguments, int code) {
        arguments.insert(arguments.begin() + 1, ring.deck);
        const Outcome outcome = almesh_with(arguments);
        CHECK(outcome.code == code);
        return outcome.error;
    };
    const Mesh mesh = ring_mesh(12, 3, 6);
    const std::string rows = rows_for(mesh), J = ring.folder.write("J.csv", rows);
    CHECK(refusal({"adjoint", J}, 0) == "");
    CHECK(has(refusal({"adjoint"}, 1), "adjoint takes a deck and files"));
    CHECK(has(refusal({"tangent"}, 1), "nothing to differentiate by"));
    CHECK(has(refusal({"adjoint", "none.csv"}, 2), "none.csv"));
    const auto with = [&](const std::string& text) { return ring.folder.write("wrong.csv", text); };
    CHECK(has(refusal({"adjoint", with(rows.substr(0, rows.rfind('\n', rows.size() - 2) + 1))}, 2), "has no row"));
    CHECK(has(refusal({"adjoint", with(rows + "999,0,0\n")}, 2), "node 999 is not in the mesh"));
    CHECK(has(refusal({"adjoint", with(rows + "1,0,0\n")}, 2), "node 1 has other numbers in line "));
    CHECK(has(refusal({"adjoint", with("1,nan,0\n")}, 2), "not a finite number"));
    CHECK(has(refusal({"adjoint", with("1,0\n")}, 2), "expected a coordinate"));
    CHECK(has(refusal({"tangent", J}, 2), "is not on a boundary"));
    CHECK(has(refusal({"adjoint", J, J}, 1), "has the name J"));
    CHECK(has(refusal({"adjoint", J, "let J=1"}, 1), "has the name J"));
    CHECK(has(refusal({"adjoint", J, "method=penalty"}, 1), "only meshes of method = augmented_lagrangian"));
    CHECK(has(refusal({"adjoint", J, "frames=0, 1"}, 1), "give the deck one time"));
    CHECK(has(refusal({"adjoint", J, "max_newton_iterations=1"}, 3), "no derivative: the run did not converge"));
    CHECK(has(refusal({"adjoint", J, "boundary inner=fixed", "objective=deviation"}, 3),
              "with objective = squared the mesh has a derivative"));
    CHECK(refusal({"adjoint", J, "boundary inner=fixed", "objective=squared"}, 0) == "");
    for (const std::string formula : {"abs(a)", "max(a, 2*a)", "sqrt(a)"}) {
        const std::string motion = "boundary inner=translate \"" + formula + "\" 0";
        const std::string why = refusal({"tangent", "let a=0", "objective=squared", motion}, 3);
        CHECK(has(why, "no derivative by a: "));
        CHECK(has(why, formula == "sqrt(a)" ? "not finite" : "is not smooth there"));
    }
}
