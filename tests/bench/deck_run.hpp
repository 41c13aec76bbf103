// Runs of ./almesh as processes of their own, so that each tells its own peak memory.
#pragma once
#include <map>
#include <string>
#include <vector>

namespace almesh::bench {

struct DeckRun {
    int exit_code = -1;
    double wall = 0;       // seconds, from start to end of the process
    double peak_memory = 0;  // bytes
    std::map<std::string, double> summary;  // the numbers of summary.txt
};

// name: of a deck in inputs/; settings replace its own. Results go to a temporary folder.
DeckRun run_deck(const std::string& name, std::vector<std::string> settings);

}  // namespace almesh::bench
