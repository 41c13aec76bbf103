#include "mesh/winding.hpp"

#include <doctest/doctest.h>

#include "mesh/build.hpp"
#include "support/sample_mesh.hpp"

using namespace almesh;

TEST_CASE("elements and faces that were turned have the file's order of nodes again") {
    for (const int dim : {2, 3})
        for (int degree = 1; degree <= 4; ++degree)
            for (const bool turned : {false, true}) {
                CAPTURE(dim);
                CAPTURE(degree);
                const RawMesh raw = SampleMesh(dim, degree, 2, turned).raw;
                std::vector<std::string> notes;
                const Mesh mesh = build_mesh(raw, notes), in_file = as_in_file(mesh);
                CHECK((mesh.elements == in_file.elements) == !turned);
                std::vector<int> nodes = in_file.faces;
                nodes.insert(nodes.end(), in_file.elements.begin(), in_file.elements.end());
                CHECK(nodes == raw.element_nodes);  // faces stand first there
                const Mesh fine = refine(mesh, 1);
                CHECK(as_in_file(fine).elements == fine.elements);
                const Mesh other = interpolated(mesh, degree == 1 ? 2 : 1), other_in_file = as_in_file(other);
                for (int e = 0; e < mesh.element_count(); ++e)
                    for (int v = 0; v <= dim; ++v)
                        CHECK(other_in_file.file.node_id[other_in_file.element(e)[v]] ==
                              mesh.file.node_id[in_file.element(e)[v]]);
            }
}
