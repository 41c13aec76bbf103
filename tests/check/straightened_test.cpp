#include "check/straightened.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "support/meshes.hpp"
#include "support/solids.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

// The mesh in degree 3, with a bump of this height on top of it that goes down fast to its inside.
std::vector<double> with_bump(const Mesh& mesh, double height) {
    std::vector<double> x = mesh.x;
    const int last = mesh.dim - 1;
    std::vector<char> is_vertex(mesh.nodes(), 0);
    for (int e = 0; e < mesh.element_count(); ++e)
        for (int k = 0; k < mesh.cell(e).vertices; ++k) is_vertex[mesh.element(e)[k]] = 1;
    for (const int i : mesh.faces) {
        double* const at = point(x, i, mesh.dim);
        if (!is_vertex[i] && point(mesh.x, i, mesh.dim)[last] > 1 - 1e-9)
            at[last] -= height * std::exp(-60 * std::pow(point(mesh.x, i, mesh.dim)[0] - 0.5, 2));
    }
    return x;
}

}  // namespace

TEST_CASE("elements that are not valid are straightened, by as little as that needs; all others keep their bits") {
    const std::vector<std::pair<Mesh, double>> bumps = {
        {square_mesh(6), 0.1}, {cube_mesh(3), 0.3}, {solid_mesh(3, "hhh"), 0.3}};
    for (const auto& [base, height] : bumps) {
        const Mesh mesh = raise_degree(base, 3);
        const std::vector<double> straight = mesh.x, curved = with_bump(mesh, height);
        CAPTURE(mesh.elements_text());
        REQUIRE(!certify(mesh, curved).valid);
        const StraightenedMesh found = straighten_invalid(mesh, straight, curved, 0.05);
        CHECK(found.certificate.valid);
        CHECK(found.certificate.min_certified_bound > 0.05);
        CHECK(found.injectivity.certified);
        CHECK(certify(mesh, found.x).valid);
        int moved = 0, partly = 0;
        for (std::size_t k = 0; k < curved.size(); ++k) {
            if (found.x[k] == curved[k]) continue;
            ++moved;
            const double part = (found.x[k] - straight[k]) / (curved[k] - straight[k]);
            CHECK(std::abs(4 * part - std::round(4 * part)) < 1e-9);
            partly += part > 0.1;
        }
        CHECK(moved > 0);
        CHECK(partly > 0);
        CHECK(moved < static_cast<int>(curved.size()) / 3);
        int at_fault = 0;
        for (const char was : found.was_at_fault) at_fault += was != 0;
        CHECK(at_fault > 0);
        CHECK(at_fault < mesh.element_count() / 2);
    }
}

TEST_CASE("a mesh that is certified keeps its bits, and so does a straight one") {
    const Mesh mesh = raise_degree(square_mesh(6), 3);
    for (const double height : {0.0, 0.02}) {
        const std::vector<double> curved = with_bump(mesh, height);
        REQUIRE(certify(mesh, curved).valid);
        const StraightenedMesh found = straighten_invalid(mesh, mesh.x, curved, 0);
        CHECK(found.x == curved);
        CHECK(found.injectivity.certified);
    }
}

TEST_CASE("valid elements whose boundary crosses another one are straightened until it does not") {
    // Two squares above each other with a gap: the upper edge of the lower one bends into the upper one.
    const Mesh lower = square_mesh(3);
    Mesh linear = two_parts(lower, 1, {0, 1.1, 0});
    Mesh mesh = raise_degree(linear, 2);
    std::vector<double> curved = mesh.x;
    for (int i = linear.nodes(); i < mesh.nodes(); ++i) {
        double* const x = point(curved, i, 2);
        if (std::abs(x[1] - 1) < 1e-9) x[1] += 0.12;
    }
    REQUIRE(certify(mesh, curved).valid);
    REQUIRE(!certify_injective(mesh, curved, certify(mesh, curved)).certified);
    const StraightenedMesh found = straighten_invalid(mesh, mesh.x, curved, 0);
    CHECK(found.injectivity.certified);
    CHECK(found.x != curved);
}
