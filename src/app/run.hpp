// One run of a deck: from the mesh file to the files of results.
#pragma once
#include <cstdio>

#include "base/error.hpp"
#include "app/deck.hpp"

namespace almesh {

// Prints the table of the run to `out`. Throws Error for what the user can mend before anything is solved.
ExitCode run(const Deck& deck, std::FILE* out);

}  // namespace almesh
