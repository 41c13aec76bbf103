// A folder with ring.msh and ring.deck, a small run of the program.
#pragma once
#include <string>
#include <vector>

#include "support/meshes.hpp"
#include "support/program.hpp"

namespace almesh::test {

struct RingDeck {
    TemporaryFolder folder;
    std::string deck, output;

    explicit RingDeck(const Mesh& mesh = ring_mesh(12, 3, 6), const std::string& more = "threads = 1\n") {
        output = folder.path("results");
        folder.write("ring.msh", msh_of(mesh));
        deck = folder.write("ring.deck", "title = A ring\nmesh = ring.msh\noutput = " + output +
                                             "\nboundary inner = translate 2 0\nboundary outer = fixed\n" + more);
    }

    Outcome run(const std::vector<std::string>& settings = {}) const {
        std::vector<std::string> arguments = {deck};
        for (const std::string& setting : settings) arguments.push_back(setting);
        return almesh_with(arguments);
    }
};

}  // namespace almesh::test
