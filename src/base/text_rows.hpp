// Long texts of rows, such as the nodes of a mesh: the rows are formatted in parallel, block by block, and each block
// goes where the text goes while the next ones are formatted, in their order: the same text for any number of threads,
// and no more of it in memory than a block per thread.
#pragma once
#include <algorithm>
#include <string>

#include "base/files.hpp"
#include "base/parallel.hpp"

namespace almesh {

// Rows 0 .. count - 1 go to the sink; row(part, i) appends row i to `part`.
template <class Row>
void append_rows(const TextSink& sink, int count, const Row& row) {
    constexpr int block = 4096;
    const int blocks = (count + block - 1) / block;
#pragma omp parallel if (blocks > 1)
    {
        std::string part;
#pragma omp for ordered schedule(static, 1)
        for (int b = 0; b < blocks; ++b) {
            part.clear();
            for (int i = b * block, end = std::min(count, i + block); i < end; ++i) row(part, i);
#pragma omp ordered
            sink(part);
        }
    }
}

}  // namespace almesh
