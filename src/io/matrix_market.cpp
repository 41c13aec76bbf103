#include "io/matrix_market.hpp"

#include "base/files.hpp"
#include "base/text.hpp"

namespace almesh {

std::string matrix_market_text(const BlockCsr& A) {
    std::string entries;
    long long count = 0;
    for (int i = 0; i < A.n; ++i)
        for (int r = 0; r < A.d; ++r)
            for (int k = A.row[i]; k < A.row[i + 1] && A.col[k] <= i; ++k)
                for (int c = 0, columns = A.col[k] < i ? A.d : r + 1; c < columns; ++c, ++count) {
                    append(entries, static_cast<long long>(i) * A.d + r + 1);
                    append(entries += ' ', static_cast<long long>(A.col[k]) * A.d + c + 1);
                    append(entries += ' ', A.block(k)[r * A.d + c], 17);
                    entries += '\n';
                }
    return concat("%%MatrixMarket matrix coordinate real symmetric\n", A.size(), " ", A.size(), " ", count, "\n") +
           entries;
}

std::string matrix_market_text(const std::vector<double>& b) {
    std::string text = concat("%%MatrixMarket matrix array real general\n", b.size(), " 1\n");
    for (double value : b) {
        append(text, value, 17);
        text += '\n';
    }
    return text;
}

}  // namespace almesh
