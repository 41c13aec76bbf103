// The interface for C: the same bits as the program, every wrong use, two meshes in two threads, a run that is stopped.
#include "almesh.h"

#include <doctest/doctest.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <thread>

#include "library/c_client.h"
#include "base/parallel.hpp"
#include "support/program.hpp"

namespace {

struct Freed {
    void operator()(almesh_mesh* mesh) const { almesh_free(mesh); }
};
using Handle = std::unique_ptr<almesh_mesh, Freed>;

Handle read(const std::string& path) {
    almesh_mesh* mesh = nullptr;
    const int code = path.ends_with(".deck") ? almesh_read_deck(path.c_str(), &mesh) : almesh_read(path.c_str(), &mesh);
    INFO(almesh_error());
    CHECK(code == ALMESH_OK);
    return Handle(mesh);
}

std::size_t numbers_of(almesh_mesh* mesh) {
    almesh_sizes sizes;
    REQUIRE(almesh_sizes_of(mesh, &sizes) == ALMESH_OK);
    return static_cast<std::size_t>(sizes.nodes) * sizes.dim;
}

std::vector<double> positions(almesh_mesh* mesh) {
    const double* const x = almesh_positions(mesh);
    return {x, x + numbers_of(mesh)};
}

Handle ring() {
    Handle mesh = read("inputs/meshes/circle.msh");
    CHECK(almesh_set_boundary(mesh.get(), "inner", "translate \"8*t\" 0") == ALMESH_OK);
    CHECK(almesh_set_boundary(mesh.get(), "outer", "fixed") == ALMESH_OK);
    return mesh;
}

// The sentence of a call that is refused by this code.
std::string refusal(int code, int expected) {
    CHECK(code == expected);
    return code ? almesh_error() : "";
}

bool is_of_machine(const std::string& quantity) {
    return quantity.starts_with("time_") || quantity.ends_with("_mb") || quantity == "run" || quantity == "threads";
}

}  // namespace

TEST_CASE("a client in C99 has every function") { CHECK(c_client() == 0); }

TEST_CASE("a deck, a mesh to be improved and frames end with the bits and the quantities of the program") {
    const almesh::test::TemporaryFolder folder;
    const auto check_same = [&](almesh_mesh* mesh, const std::string& results, const std::string& name) {
        const std::string saved = folder.path(name);
        CHECK(almesh_save(mesh, saved.c_str()) == ALMESH_OK);
        CHECK(almesh::test::text_of(saved) == almesh::test::text_of(results + "/" + name));
    };
    for (const std::string deck : {"circle", "cells/circle", "targets/flap"}) {
        CAPTURE(deck);
        const std::string path = "inputs/" + deck + ".deck", results = folder.path("results");
        CHECK(almesh::test::almesh_with({path, "output=" + results}).code == 0);
        const Handle mesh = read(path);
        CHECK(almesh_move(mesh.get()) == ALMESH_OK);
        check_same(mesh.get(), results, "final.msh");
        for (const auto& [quantity, value] : almesh::test::summary_lines(results))
            if (!is_of_machine(quantity)) CHECK(almesh_word(mesh.get(), quantity.c_str()) == value);
    }
    const std::string mesh_file = "inputs/meshes/kinds.msh", results = folder.path("improved");
    CHECK(almesh::test::almesh_with({"improve", mesh_file, "output=" + results}).code == 0);
    const Handle improved = read(mesh_file);
    CHECK(almesh_improve(improved.get()) == ALMESH_OK);
    check_same(improved.get(), results, "final.msh");

    const std::string deck = "inputs/frames/pitch.deck", frames = folder.path("frames"), times = "0 : 0.0625 : 0.125";
    CHECK(almesh::test::almesh_with({deck, "frames=" + times, "output=" + frames}).code == 0);
    const Handle mesh = read(deck);
    CHECK(almesh_set(mesh.get(), "frames", times.c_str()) == ALMESH_OK);
    for (int k = 0; k < 3; ++k) {
        CHECK(almesh_frame(mesh.get(), 0.0625 * k) == ALMESH_OK);
        check_same(mesh.get(), frames, "frame-000" + std::to_string(k + 1) + ".msh");
    }
}

TEST_CASE("a mesh from the arrays of another one moves to the same bits") {
    const Handle file = ring();
    almesh_sizes sizes;
    almesh_cells cells;
    REQUIRE(almesh_sizes_of(file.get(), &sizes) == ALMESH_OK);
    REQUIRE(almesh_elements(file.get(), &cells) == ALMESH_OK);
    std::vector<almesh_block> blocks = {{ALMESH_TRIANGLE, cells.count, cells.node, nullptr}};
    for (int b = 0; b < sizes.boundaries; ++b) {
        const char* name = nullptr;
        REQUIRE(almesh_boundary(file.get(), b, &name, &cells) == ALMESH_OK);
        blocks.push_back({ALMESH_LINE, cells.count, cells.node, name});
    }
    almesh_mesh* made = nullptr;
    REQUIRE(almesh_from_arrays(2, 1, sizes.nodes, almesh_positions(file.get()), static_cast<int>(blocks.size()),
                               blocks.data(), &made) == ALMESH_OK);
    const Handle arrays(made);
    for (almesh_mesh* mesh : {file.get(), made}) {
        CHECK(almesh_set_deck(mesh, "boundary inner = translate 8 0\nboundary outer = fixed\n") == ALMESH_OK);
        CHECK(almesh_move(mesh) == ALMESH_OK);
    }
    CHECK(positions(made) == positions(file.get()));
}

TEST_CASE("two meshes in two threads have their bits, and the caller its number of threads") {
    std::vector<double> alone, other_alone, together, other_together;
    const auto run = [](const char* motion, const char* threads, std::vector<double>& x) {
        const Handle mesh = ring();
        almesh_set_boundary(mesh.get(), "inner", motion);
        almesh_set(mesh.get(), "threads", threads);
        almesh_move(mesh.get());
        x = positions(mesh.get());
    };
    run("translate 8 0", "1", alone);
    run("rotate 45", "2", other_alone);
    const int before = almesh::max_threads();
    std::thread first(run, "translate 8 0", "2", std::ref(together));
    std::thread second(run, "rotate 45", "1", std::ref(other_together));
    first.join();
    second.join();
    CHECK(together == alone);
    CHECK(other_together == other_alone);
    run("rotate 45", "3", other_together);
    CHECK(almesh::max_threads() == before);
}

TEST_CASE("a callback sees the run, ends it with a valid mesh, and cannot use its mesh meanwhile") {
    struct Seen {
        almesh_mesh* mesh;
        int left, calls = 0, refused = 0;
    };
    const auto callback = [](void* user, const almesh_progress* progress) {
        Seen& seen = *static_cast<Seen*>(user);
        CHECK(progress->energy >= 0);
        ++seen.calls;
        seen.refused += almesh_positions(seen.mesh) == nullptr && almesh_error_code() == ALMESH_BUSY;
        std::thread([&seen] { seen.refused += almesh_move(seen.mesh) == ALMESH_BUSY; }).join();
        return static_cast<int>(seen.left-- <= 0);
    };
    const Handle mesh = ring(), whole = ring();
    Seen seen{mesh.get(), 3};
    CHECK(almesh_on_progress(mesh.get(), callback, &seen) == ALMESH_OK);
    for (almesh_mesh* of : {mesh.get(), whole.get()})
        CHECK(almesh_set_boundary(of, "inner", "translate 8 0") == ALMESH_OK);
    CHECK(refusal(almesh_move(mesh.get()), ALMESH_CANCELLED).starts_with("interrupted"));
    CHECK(seen.calls == 4);
    CHECK(seen.refused == 8);
    CHECK(almesh_word(mesh.get(), "status") == std::string("interrupted"));
    CHECK(positions(mesh.get()) != std::vector(almesh_first_positions(mesh.get()),
                                               almesh_first_positions(mesh.get()) + numbers_of(mesh.get())));
    CHECK(almesh_certify(mesh.get(), nullptr, 0) == ALMESH_OK);
    CHECK(almesh_on_progress(mesh.get(), nullptr, nullptr) == ALMESH_OK);
    CHECK(almesh_move(mesh.get()) == ALMESH_OK);
    CHECK(almesh_move(whole.get()) == ALMESH_OK);
    CHECK(positions(mesh.get()) == positions(whole.get()));
}

TEST_CASE("derivatives of a moved mesh and of a frame are each other's transpose") {
    const Handle mesh = ring();
    for (const double t : {0.5, 0.75}) {
        CHECK(almesh_frame(mesh.get(), t) == ALMESH_OK);
        const std::size_t count = numbers_of(mesh.get());
        std::vector<double> dJ_dx(count), dJ_dg(count), dg(count), dx(count);
        for (std::size_t k = 0; k < count; ++k) dJ_dx[k] = std::sin(static_cast<double>(k)), dg[k] = std::cos(2.0 * k);
        CHECK(almesh_adjoint(mesh.get(), dJ_dx.data(), count, dJ_dg.data()) == ALMESH_OK);
        CHECK(almesh_tangent(mesh.get(), dg.data(), count, dx.data()) == ALMESH_OK);
        double by_adjoint = 0, by_tangent = 0;
        for (std::size_t k = 0; k < count; ++k) by_adjoint += dJ_dg[k] * dg[k], by_tangent += dJ_dx[k] * dx[k];
        CHECK(by_adjoint == doctest::Approx(by_tangent).epsilon(1e-9));
    }
}

TEST_CASE("wrong use is an error with a sentence, and changes nothing") {
    almesh_mesh *const none = nullptr, *made = nullptr;
    CHECK(refusal(almesh_move(none), ALMESH_HANDLE) == "the mesh is null");
    CHECK(almesh_positions(none) == nullptr);
    CHECK(almesh_free(none) == ALMESH_OK);
    CHECK(refusal(almesh_read("no-such.msh", &made), ALMESH_INPUT).find("no-such.msh") != std::string::npos);
    CHECK(refusal(almesh_read(nullptr, &made), ALMESH_USAGE) == "the path is null");
    CHECK(refusal(almesh_read("inputs/meshes/circle.msh", nullptr), ALMESH_USAGE) == "the address of the mesh is null");
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const double triangle[] = {0, 0, 1, 0, 0, 1}, bad[] = {0, 0, 1, nan, 0, 1};
    const int nodes[] = {0, 1, 2}, beyond[] = {0, 1, 3};
    const almesh_block good{ALMESH_TRIANGLE, 1, nodes, nullptr}, wrong{ALMESH_TRIANGLE, 1, beyond, nullptr},
        unknown{17, 1, nodes, nullptr}, missing{ALMESH_TRIANGLE, 1, nullptr, nullptr};
    const auto from = [&](int dim, int degree, int count, const double* x, const almesh_block* block) {
        return almesh_from_arrays(dim, degree, count, x, 1, block, &made);
    };
    CHECK(refusal(from(2, 1, 3, bad, &good), ALMESH_INPUT).find("node 1") != std::string::npos);
    CHECK(refusal(from(2, 1, 3, triangle, &wrong), ALMESH_USAGE).find("node 3, of 3") != std::string::npos);
    for (const int code : {from(4, 1, 3, triangle, &good), from(2, 9, 3, triangle, &good),
                           from(2, 1, -1, triangle, &good), from(2, 1, 3, nullptr, &good),
                           from(2, 1, 3, triangle, nullptr), from(2, 1, 3, triangle, &unknown),
                           from(2, 1, 3, triangle, &missing)})
        CHECK(code == ALMESH_USAGE);
    CHECK(made == nullptr);

    const Handle owner = ring();
    almesh_mesh* const mesh = owner.get();
    const auto has = almesh::test::has;
    CHECK(has(refusal(almesh_set(mesh, "omega_stra", "1"), ALMESH_USAGE), "did you mean `omega_star`"));
    CHECK(!has(refusal(almesh_set(mesh, "omega_star", "-1"), ALMESH_USAGE), "command line"));
    for (const char* key : {"mesh", "", "a=b", " degree", "no\nlines"})
        CHECK(almesh_set(mesh, key, "1") == ALMESH_USAGE);
    CHECK(almesh_set(mesh, nullptr, "1") == ALMESH_USAGE);
    CHECK(almesh_set(mesh, "title", "a\nmesh = b") == ALMESH_USAGE);
    CHECK(almesh_get(mesh, "omega_star") == std::string("1e-08"));
    CHECK(almesh_get(mesh, "omega_stra") == nullptr);
    CHECK(almesh_set_deck(mesh, "degree = many") == ALMESH_USAGE);
    CHECK(almesh_set_boundary(mesh, "inner", "translate far") == ALMESH_USAGE);
    CHECK(almesh_set_boundary(mesh, "in\"ner", "fixed") == ALMESH_USAGE);
    CHECK(almesh_number(mesh, "status", nullptr) == ALMESH_ORDER);
    CHECK(almesh_multipliers(mesh) == nullptr);
    CHECK(almesh_error_code() == ALMESH_ORDER);
    CHECK(almesh_element_values(mesh, "distortion") == nullptr);
    CHECK(almesh_element_values(mesh, "distorsion") == nullptr);
    CHECK(almesh_error_code() == ALMESH_USAGE);
    CHECK(almesh_boundary(mesh, 2, nullptr, nullptr) == ALMESH_USAGE);
    CHECK(almesh_boundary(mesh, -1, nullptr, nullptr) == ALMESH_USAGE);
    std::vector<double> x = positions(mesh);
    CHECK(almesh_adjoint(mesh, x.data(), x.size(), x.data()) == ALMESH_ORDER);
    CHECK(refusal(almesh_move(mesh), ALMESH_USAGE).find("frames") != std::string::npos);  // a motion with t
    CHECK(almesh_frame(mesh, nan) == ALMESH_USAGE);
    CHECK(almesh_frame(mesh, 0.25) == ALMESH_OK);
    const std::vector<double> moved = positions(mesh);
    CHECK(almesh_certify(mesh, x.data(), x.size() - 1) == ALMESH_USAGE);
    CHECK(almesh_certify(mesh, nullptr, 7) == ALMESH_USAGE);
    x[5] = nan;
    CHECK(refusal(almesh_set_boundary_positions(mesh, "inner", x.data(), x.size()), ALMESH_USAGE) ==
          "number 5 is not finite");
    CHECK(almesh_adjoint(mesh, x.data(), x.size(), x.data()) == ALMESH_USAGE);
    x[5] = 1e3;
    CHECK(refusal(almesh_certify(mesh, x.data(), x.size()), ALMESH_NOT_CERTIFIED) != "");
    CHECK(almesh_save(mesh, "/no/such/folder/x.msh") == ALMESH_INPUT);
    CHECK(almesh_save(mesh, "x.stl") == ALMESH_USAGE);
    CHECK(almesh_save_proof(mesh, "x.stl", "x.proof") == ALMESH_USAGE);
    CHECK(almesh_save_proof(mesh, "x.msh", nullptr) == ALMESH_USAGE);
    CHECK(almesh_number(mesh, "status", &x[0]) == ALMESH_USAGE);
    CHECK(almesh_word(mesh, "qualty") == nullptr);
    CHECK(almesh_set_boundary(mesh, "outre", "fixed") == ALMESH_OK);  // what the mesh has is known in the run
    CHECK(refusal(almesh_frame(mesh, 0.5), ALMESH_USAGE).find("outre") != std::string::npos);
    CHECK(positions(mesh) == moved);
    CHECK(almesh_set_boundary(mesh, "outre", nullptr) == ALMESH_OK);
    CHECK(almesh_set_boundary(mesh, "inner", "translate 80 0") == ALMESH_OK);
    CHECK(almesh_frame(mesh, 0.5) == ALMESH_INPUT);
    CHECK(positions(mesh) == moved);
    CHECK(almesh_adjoint(mesh, x.data(), x.size(), x.data()) == ALMESH_ORDER);  // whose target is another one now
    CHECK(almesh_free(mesh) == ALMESH_OK);
    CHECK(refusal(almesh_move(mesh), ALMESH_HANDLE) == "the mesh was freed, or is none");
    CHECK(almesh_free(mesh) == ALMESH_HANDLE);
    CHECK(almesh_key(-1, nullptr, nullptr, nullptr, nullptr) == ALMESH_USAGE);
    CHECK(almesh_quantity(1000, nullptr, nullptr) == ALMESH_USAGE);
}
