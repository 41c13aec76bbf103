#include "check/proof.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "mesh/mesh.hpp"
#include "support/meshes.hpp"
#include "support/targets.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

int count_of(const std::string& lines, const std::string& word) {
    int count = 0;
    for (std::size_t at = 0; (at = lines.find(word, at)) != std::string::npos; ++at) ++count;
    return count;
}

}  // namespace

TEST_CASE("what the checker sees at once is not in a proof") {
    for (const Mesh& mesh : {square_mesh(3), cube_mesh(2), raise_degree(square_mesh(3), 3), raise_degree(cube_mesh(1), 2)}) {
        const Proof proof = make_proof(mesh, mesh.x);
        CHECK(proof.lines == "");
        CHECK(proof.missing == "");
    }
}

TEST_CASE("a bent element has bisections, an inverted one no proof") {
    const Mesh triangle = linear_mesh(2, {0, 0, 1, 0, 0, 1}, {0, 1, 2}, [](const double*) { return "rim"; });
    const auto bent = [&](double inward) {
        Mesh mesh = raise_degree(triangle, 2);
        for (int i = 0; i < mesh.nodes(); ++i) {
            double* const at = point(mesh.x, i, 2);
            if (at[0] == 0.5 && at[1] == 0) at[1] = inward;
            else if (at[0] == 0.5) at[0] = 35.0 / 64, at[1] = 42.0 / 64;
            else if (at[1] == 0.5) at[0] = 0.25, at[1] = 40.0 / 64;
        }
        return make_proof(mesh, mesh.x);
    };
    CHECK(count_of(bent(11.0 / 64).lines, "element 4 ") == 1);
    CHECK(bent(11.0 / 64).missing == "");
    CHECK(bent(0.4).missing == "element 4");
}

TEST_CASE("faces of a curved boundary that cross have no proof, and lines are the same for any number of threads") {
    Mesh mesh = raise_degree(cube_mesh(2), 3);
    mesh.x = wavy(mesh.x, 3, 0.08);
    const std::vector<std::string> lines = for_threads([&] { return make_proof(mesh, mesh.x).lines; });
    CHECK(std::all_of(lines.begin(), lines.end(), [&](const std::string& other) { return other == lines[0]; }));
    Mesh two = raise_degree(two_parts(square_mesh(1), 1, {0.999, 0.3, 0}), 2);
    CHECK(make_proof(two, two.x).missing.starts_with("pair "));
    two = raise_degree(two_parts(square_mesh(1), 1, {1.001, 0.3, 0}), 2);
    CHECK(make_proof(two, two.x).missing == "");
}

TEST_CASE("flat faces that touch are named") {
    const Mesh two = two_parts(square_mesh(1), 1, {1, 0.3, 0});
    CHECK(count_of(make_proof(two, two.x).lines, "touch ") == 3);  // two sides, and an end of each with another
    CHECK(make_proof(two, two.x).missing == "");
    const Mesh deeper = two_parts(square_mesh(1), 1, {1 - 1e-8, 0.3, 0});
    CHECK(make_proof(deeper, deeper.x).missing.starts_with("pair "));
}
