// Right-looking blocked Cholesky: factor a block of columns, solve the rows below, update what is to the right. The
// update, a symmetric rank-k product, is where the time goes: tiles of C stay in registers while the columns of L pass
// by, packed where the front is large (Goto & van de Geijn, ACM Trans. Math. Softw. 34, 2008).
#include "linalg/direct/dense_kernels.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/index.hpp"
#include "base/lanes.hpp"
#include "base/parallel.hpp"

namespace almesh {
namespace {

// A tile of rows x columns accumulators must fit the registers: 32 of 8 doubles (AVX-512), or 16 of 4 or 2.
constexpr int tile_columns = lanes == 8 ? 8 : 4;
constexpr int grid = 8;                           // rows and columns of tiles start at multiples of this
constexpr int packs = lanes == 2 ? 2 : 3;         // registers per column of the largest tile

constexpr int block_columns = 128;                // columns eliminated before the rest of a large front is updated
constexpr int block_rows = 192;                   // rows and columns of the pieces that are shared among threads
constexpr int short_front = 300;                  // rows up to which solves go column by column: in the cache
constexpr int solve_columns = 64;                 // columns solved for before the rest of a right-hand side is updated
constexpr int solve_rows = 512;                   // rows of it that one thread updates at a time
constexpr int solve_parallel = 1500;              // fewer rows than this are not worth a team
constexpr int packing_size = 160;                 // fronts of more rows are worth copying operands into packed form

// Operand of a tile: entry (row r, column k) at data[k * ld + r].
struct Operand {
    const double* data;
    std::size_t ld;
};

// sum = A B', `rows` lanes-wide packs x tile_columns, over `depth` columns of A and B.
template <int rows>
inline __attribute__((always_inline)) void accumulate(Operand a, Operand b, int depth,
                                                      Lanes (&sum)[tile_columns][rows]) {
#pragma GCC unroll 8
    for (int c = 0; c < tile_columns; ++c)
#pragma GCC unroll 3
        for (int r = 0; r < rows; ++r) sum[c][r] = Lanes{};
    const double *pa = a.data, *pb = b.data;
    for (int k = 0; k < depth; ++k, pa += a.ld, pb += b.ld) {
        Lanes column[rows];
#pragma GCC unroll 3
        for (int r = 0; r < rows; ++r) column[r] = load(pa + r * lanes);
#pragma GCC unroll 8
        for (int c = 0; c < tile_columns; ++c)
#pragma GCC unroll 3
            for (int r = 0; r < rows; ++r) sum[c][r] += column[r] * pb[c];
    }
}

enum class Store { negative, subtract };

// C <- -A B' or C <- C - A B' in the columns [c_begin, c_end) of the tile.
template <int rows>
void multiply_tile(Operand a, Operand b, int depth, double* C, std::size_t ldc, int c_begin, int c_end, Store how) {
    Lanes sum[tile_columns][rows];
    accumulate<rows>(a, b, depth, sum);
#pragma GCC unroll 8
    for (int c = 0; c < tile_columns; ++c) {
        if (c < c_begin || c >= c_end) continue;
#pragma GCC unroll 3
        for (int r = 0; r < rows; ++r) {
            double* const target = C + c * ldc + r * lanes;
            store(how == Store::negative ? -sum[c][r] : load(target) - sum[c][r], target);
        }
    }
}

// The same for any number of rows that is a multiple of `lanes`; step: distance from one row tile of A to the next.
void multiply_strip(int row_count, Operand a, std::size_t step, Operand b, int depth, double* C, std::size_t ldc,
                    int c_begin, int c_end, Store how) {
    constexpr int full = packs * lanes;
    int r = 0;
    for (; r + full <= row_count; r += full, a.data += step)
        multiply_tile<packs>(a, b, depth, C + r, ldc, c_begin, c_end, how);
    for (; r + lanes <= row_count; r += lanes, a.data += lanes)
        multiply_tile<1>(a, b, depth, C + r, ldc, c_begin, c_end, how);
}

// Cholesky of w <= grid columns of `grid` rows, lower triangle. Returns -1 or the bad column.
int factor_corner(int w, double* A, std::size_t ld, const double* smallest) {
    for (int j = 0; j < w; ++j) {
        double* const column = A + j * ld;
        if (!(column[j] > smallest[j]) || !std::isfinite(column[j])) return j;
        column[j] = std::sqrt(column[j]);
        const double inverse = 1 / column[j];
        for (int i = j + 1; i < grid; ++i) column[i] *= inverse;
        for (int c = j + 1; c < w; ++c)
            for (int i = c; i < grid; ++i) A[c * ld + i] -= column[i] * column[c];
    }
    return -1;
}

// X <- X L^{-T} for `row_count` rows (a multiple of lanes) of w columns, L the w x w corner factored above.
inline __attribute__((always_inline)) void solve_corner(int w, const double* L, std::size_t ldl, double* X,
                                                        int row_count, std::size_t ldx) {
    double inverse[grid];
    for (int j = 0; j < w; ++j) inverse[j] = 1 / L[j * ldl + j];
    for (int r = 0; r < row_count; r += lanes) {
        Lanes x[grid] = {};
#pragma GCC unroll 8
        for (int j = 0; j < w; ++j) x[j] = load(X + j * ldx + r);
#pragma GCC unroll 8
        for (int j = 0; j < w; ++j) {
            x[j] *= inverse[j];
#pragma GCC unroll 8
            for (int c = j + 1; c < w; ++c) x[c] -= x[j] * L[j * ldl + c];
        }
#pragma GCC unroll 8
        for (int j = 0; j < w; ++j) store(x[j], X + j * ldx + r);
    }
}

// Columns [j0, j1) of the panel in rows [row_begin, row_end), which lie on the grid: takes off what the columns from
// j0 on contribute, column strip by strip. With diagonal: the rows start at j0 and the corners are factored on the way;
// otherwise they are taken as they stand in rows j0 .. j1-1.
int factor_columns(double* panel, std::size_t ld, int j0, int j1, int row_begin, int row_end, bool diagonal,
                   const double* smallest) {
    for (int j = j0; j < j1; j += grid) {
        const int w = std::min(grid, j1 - j), first = diagonal ? j : row_begin;
        double* const strip = panel + j * ld;
        if (j > j0)
            for (int c = 0; c < w; c += tile_columns)
                multiply_strip(row_end - first, {panel + j0 * ld + first, ld}, packs * lanes,
                               {panel + j0 * ld + j + c, ld}, j - j0, strip + c * ld + first, ld, 0,
                               std::min(tile_columns, w - c), Store::subtract);
        const int below = diagonal ? j + grid : row_begin;
        if (diagonal) {
            const int bad = factor_corner(w, strip + j, ld, smallest + j);
            if (bad >= 0) return j + bad;
        }
        if (w == grid) solve_corner(grid, strip + j, ld, strip + below, row_end - below, ld);  // w known when compiled
        else solve_corner(w, strip + j, ld, strip + below, row_end - below, ld);
    }
    return -1;
}

// Copies `count` rows of `depth` columns into tiles of `tile` rows, each contiguous.
template <int tile>
void pack_rows(const double* from, std::size_t ld, int count, int depth, double* to) {
    for (int r = 0; r < count; r += tile) {
        const int height = std::min(tile, count - r);
        for (int k = 0; k < depth; ++k, to += tile) {
            if (height == tile) std::copy_n(from + k * ld + r, tile, to);
            else std::copy_n(from + k * ld + r, height, to);
        }
    }
}

// Part of a lower triangle to update: columns [c_begin, c_end) and rows [r_begin, r_end) of the front, on the grid
// except for the outer edges of the columns.
struct Piece {
    int c_begin, c_end, r_begin, r_end;
};

// C <- C - L L' or -L L' in one piece; L: columns [j0, j1) of the panel, C(i, j) at C[j * ldc + i].
void update_piece(const double* L, std::size_t ld, int depth, const Piece& piece, double* C, std::size_t ldc,
                  bool pack, Store how) {
    thread_local std::vector<double> packed_rows, packed_columns;  // scratch, kept between calls
    constexpr int full = packs * lanes;
    const int c_grid = piece.c_begin / grid * grid, c_count = piece.c_end - c_grid, rows = piece.r_end - piece.r_begin;
    if (pack) {
        packed_rows.resize(offset(block_rows, depth));
        packed_columns.resize(offset(block_rows, depth));
        pack_rows<full>(L + piece.r_begin, ld, rows, depth, packed_rows.data());
        pack_rows<tile_columns>(L + c_grid, ld, (c_count + grid - 1) / grid * grid, depth, packed_columns.data());
    }
    for (int c = 0; c < c_count; c += tile_columns) {
        const int column = c_grid + c;
        const int c_begin = std::max(0, piece.c_begin - column), c_end = std::min(tile_columns, piece.c_end - column);
        if (c_end <= c_begin) continue;
        const Operand b = pack ? Operand{packed_columns.data() + offset(c, depth), tile_columns}
                               : Operand{L + column, ld};
        // Rows above the diagonal are left out by whole tiles.
        const int skip = std::max(0, column / grid * grid - piece.r_begin) / full * full;
        double* const target = C + column * ldc + piece.r_begin;
        for (int r = skip; r < rows; r += full) {
            const int height = std::min(full, rows - r);
            const Operand a = pack ? Operand{packed_rows.data() + offset(r, depth), full}
                                   : Operand{L + piece.r_begin + r, ld};
            multiply_strip(height, a, full, b, depth, target + r, ldc, c_begin, c_end, how);
        }
    }
}

// The lower triangle of columns [c_begin, c_end) down to row_end, cut into pieces.
void update_lower(const double* L, std::size_t ld, int depth, int c_begin, int c_end, int row_end, double* C,
                  std::size_t ldc, bool parallel, Store how) {
    const int first = c_begin / grid * grid, size = row_end - first;
    if (size <= packing_size) return update_piece(L, ld, depth, {c_begin, c_end, first, row_end}, C, ldc, false, how);
    const int column_pieces = (c_end - first + block_rows - 1) / block_rows;
    const int row_pieces = (size + block_rows - 1) / block_rows;
    parallel_tasks(column_pieces * row_pieces, parallel && size > 2 * block_rows, [&](int i) {
        const int c = i % column_pieces, r = i / column_pieces;
        if (r < c) return;
        const int c0 = first + c * block_rows, r0 = first + r * block_rows;
        update_piece(L, ld, depth,
                     {std::max(c_begin, c0), std::min(c_end, c0 + block_rows), r0, std::min(row_end, r0 + block_rows)},
                     C, ldc, true, how);
    });
}

// w[i] -= L(i, j0 .. j1-1) x in rows [begin, end), x = w[j0 .. j1-1]. Four columns at a time: w is read and written
// once for four entries of L, which then come at the speed of memory.
void subtract_columns(const double* panel, std::size_t ld, int j0, int j1, int begin, int end, double* w) {
    int j = j0;
    for (; j + 4 <= j1; j += 4) {
        const double *const a = panel + j * ld, *const b = a + ld, *const c = b + ld, *const d = c + ld;
        const double x[4] = {w[j], w[j + 1], w[j + 2], w[j + 3]};
        for (int i = begin; i < end; ++i) w[i] -= (a[i] * x[0] + b[i] * x[1]) + (c[i] * x[2] + d[i] * x[3]);
    }
    for (; j < j1; ++j) {
        const double* const a = panel + j * ld;
        const double x = w[j];
        for (int i = begin; i < end; ++i) w[i] -= a[i] * x;
    }
}

// w[j] -= L(begin .. m-1, j)' w for `count` columns from j on.
template <int count>
void subtract_products(const double* panel, std::size_t ld, int j, int begin, int m, double* w) {
    const double* const columns = panel + j * ld;
    Lanes sum[batches_per_row][count] = {};
    int i = begin;
    for (; i + most_lanes <= m; i += most_lanes)
#pragma GCC unroll 4
        for (int part = 0; part < batches_per_row; ++part) {
            const Lanes y = load(w + i + part * lanes);
#pragma GCC unroll 4
            for (int c = 0; c < count; ++c) sum[part][c] += load(columns + c * ld + i + part * lanes) * y;
        }
    for (int c = 0; c < count; ++c) {
        double total = 0;
        for (int r = i; r < m; ++r) total += columns[c * ld + r] * w[r];
        for (int part = 0; part < batches_per_row; ++part) total = sum_of_lanes(sum[part][c], total);
        w[j + c] -= total;
    }
}

}  // namespace

int factor_front(const Front& front, const double* smallest, bool parallel) {
    const int m = front.m, k = front.k, rows = front_ld(m);
    const std::size_t ld = rows;
    for (int j0 = 0; j0 < k; j0 += block_columns) {
        const int j1 = std::min(k, j0 + block_columns);
        // The diagonal block first, then the rows below it in independent pieces, then the columns still to come.
        const int diagonal_end = std::min(rows, front_ld(j1));
        const int bad = factor_columns(front.panel, ld, j0, j1, j0, diagonal_end, true, smallest);
        if (bad >= 0) return bad;
        const int pieces = (rows - diagonal_end + block_rows - 1) / block_rows;
        parallel_tasks(pieces, parallel, [&](int i) {
            const int begin = diagonal_end + i * block_rows;
            factor_columns(front.panel, ld, j0, j1, begin, std::min(rows, begin + block_rows), false, nullptr);
        });
        if (j1 < k)
            update_lower(front.panel + j0 * ld, ld, j1 - j0, j1, k, rows, front.panel, ld, parallel, Store::subtract);
    }
    if (m == k) return -1;
    const std::size_t ldc = update_ld(m, k);
    // C(i, j) = update[(j - k) ldc + i - update_row(k)]
    double* const C = front.update - static_cast<std::ptrdiff_t>(k * ldc) - update_row(k);
    for (int j0 = 0; j0 < k; j0 += block_columns)
        update_lower(front.panel + j0 * ld, ld, std::min(block_columns, k - j0), k, m, rows, C, ldc, parallel,
                     j0 == 0 ? Store::negative : Store::subtract);
    return -1;
}

void solve_forward(const Front& front, double* w, bool parallel) {
    const std::size_t ld = front_ld(front.m);
    const bool is_short = front.m <= short_front;
    for (int j0 = 0, j1; j0 < front.k; j0 = j1) {
        j1 = is_short ? front.k : std::min(front.k, j0 + solve_columns);
        const int end = is_short ? front.m : j1;
        for (int j = j0; j < j1; ++j) {
            const double* const column = front.panel + j * ld;
            const double x = w[j] /= column[j];
            for (int i = j + 1; i < end; ++i) w[i] -= column[i] * x;
        }
        const int rows = front.m - end, pieces = (rows + solve_rows - 1) / solve_rows;
        parallel_tasks(pieces, parallel && rows > solve_parallel, [&](int i) {
            const int begin = j1 + i * solve_rows;
            subtract_columns(front.panel, ld, j0, j1, begin, std::min(front.m, begin + solve_rows), w);
        });
    }
}

void solve_backward(const Front& front, double* w, bool parallel) {
    const std::size_t ld = front_ld(front.m);
    const bool is_short = front.m <= short_front;
    for (int j = front.k - 1; j >= 0 && is_short; --j) {
        subtract_products<1>(front.panel, ld, j, j + 1, front.m, w);
        w[j] /= front.panel[j * ld + j];
    }
    if (is_short) return;
    for (int j1 = front.k, j0; j1 > 0; j1 = j0) {
        j0 = (j1 - 1) / solve_columns * solve_columns;
        parallel_tasks((j1 - j0) / 4, parallel && front.m - j1 > solve_parallel,
                  [&](int i) { subtract_products<4>(front.panel, ld, j0 + 4 * i, j1, front.m, w); });
        for (int j = j0 + (j1 - j0) / 4 * 4; j < j1; ++j) subtract_products<1>(front.panel, ld, j, j1, front.m, w);
        for (int j = j1 - 1; j >= j0; --j) {
            const double* const column = front.panel + j * ld;
            double rest = w[j];
            for (int i = j + 1; i < j1; ++i) rest -= column[i] * w[i];
            w[j] = rest / column[j];
        }
    }
}

}  // namespace almesh
