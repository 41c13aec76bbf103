// Long texts of rows, such as the nodes of a mesh: the rows are formatted in parallel, block by block, and joined in
// their order, so that the text is the same for any number of threads.
#pragma once
#include <algorithm>
#include <string>
#include <vector>

#include "base/parallel.hpp"

namespace almesh {

// Appends rows 0 .. count - 1 to the text; row(part, i) appends row i to `part`.
template <class Row>
void append_rows(std::string& text, int count, const Row& row) {
    constexpr int block = 4096, at_once = 64;
    const int blocks = (count + block - 1) / block;
    std::vector<std::string> parts(std::min(blocks, at_once));
    for (int first = 0; first < blocks; first += at_once) {
        const int here = std::min(at_once, blocks - first);
        parallel_for(here, [&](int b) {
            parts[b].clear();
            const int begin = (first + b) * block, end = std::min(count, begin + block);
            for (int i = begin; i < end; ++i) row(parts[b], i);
        }, 100.0 * std::min(count, block));
        for (int b = 0; b < here; ++b) text += parts[b];
    }
}

}  // namespace almesh
