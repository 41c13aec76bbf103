// A P and E = P'(A P) row by row, V = C^{-1} A P; then in each iteration P'r - V'y, c, y - V c and z + P c. Sums over
// the rows are taken over fixed parts of them, each into numbers of its own for the few coarse unknowns it touches.
#include "linalg/krylov/coarse_correction.hpp"

#include <algorithm>
#include <utility>

#include "base/index.hpp"
#include "base/parallel.hpp"

namespace almesh {
namespace {

// Of the coarse solve, whichever comes first. A better one hardly saves iterations, and costs the more the lower the
// degree is.
constexpr int most_iterations = 4;
constexpr double coarse_tolerance = 0.1;

// The columns of each row of A P, ascending.
std::vector<std::vector<int>> product_pattern(const BlockCsr& A, const Interpolation& P) {
    std::vector<std::vector<int>> columns(A.n);
    const auto add = [&](int j, std::vector<int>& row) {
        for (int l = P.row[j]; l < P.row[j + 1]; ++l)
            if (std::find(row.begin(), row.end(), P.col[l]) == row.end()) row.push_back(P.col[l]);
    };
    for (int i = 0; i < A.n; ++i) {
        add(i, columns[i]);
        for (int k = A.row[i]; k < A.row[i + 1]; ++k) {
            add(A.col[k], columns[i]);
            if (A.in_half()) add(i, columns[A.col[k]]);
        }
    }
    for (std::vector<int>& row : columns) std::sort(row.begin(), row.end());
    return columns;
}

// Coarse unknowns are neighbours in E where rows that they interpolate to are in A.
BlockCsr coarse_pattern(const std::vector<std::vector<int>>& AP, const Interpolation& P, int d) {
    std::vector<int> pairs;
    for (int i = 0; i < P.rows(); ++i)
        for (int l = P.row[i]; l < P.row[i + 1]; ++l)
            for (const int column : AP[i])
                if (column > P.col[l]) pairs.insert(pairs.end(), {P.col[l], column});
    return matrix_of_cells(P.columns, d, pairs, 2);
}

// row += B P_j, B transposed or not; the block in column c is row[place_of(c) d d ...].
template <int d, class From, class PlaceOf, class To>
void add_product(const From* B, bool transposed, const Interpolation& P, int j, const PlaceOf& place_of, To* row) {
    for (int l = P.row[j]; l < P.row[j + 1]; ++l) {
        To* const to = row + offset(place_of(P.col[l]), d * d);
        const double weight = P.weight[l];
        for (int e = 0; e < d * d; ++e) to[e] += static_cast<To>(weight * B[transposed ? e % d * d + e / d : e]);
    }
}

}  // namespace

CoarseCorrection::CoarseCorrection(const BlockCsr& pattern, const Interpolation& P, const MakePreconditioner& make)
    : CoarseCorrection(product_pattern(pattern, P), P, pattern.d, make) {}

CoarseCorrection::CoarseCorrection(const Columns& AP, const Interpolation& P, int d, const MakePreconditioner& make)
    : P_(P), E_(coarse_pattern(AP, P_, d)), M_(make(E_)), iteration_(E_.size(), {most_iterations, coarse_tolerance}) {
    std::vector<int> local(P_.columns, -1);
    for (int part = 0; part < parts; ++part) {
        const int first = static_cast<int>(coarse_.size());
        const auto local_of = [&](int column) {
            if (local[column] < first) {
                local[column] = static_cast<int>(coarse_.size());
                coarse_.push_back(column);
            }
            return local[column] - first;
        };
        for (int i = begin_of(part); i < begin_of(part + 1); ++i) {
            for (int l = P_.row[i]; l < P_.row[i + 1]; ++l) P_local_.push_back(local_of(P_.col[l]));
            for (const int column : AP[i]) V_local_.push_back(local_of(column));
            V_row_.push_back(static_cast<int>(V_local_.size()));
        }
        touched_start_.push_back(static_cast<int>(coarse_.size()));
    }
    const int block = E_.d * E_.d;
    std::size_t size = 0;
    for (const int column : coarse_) {
        E_start_.push_back(size);
        size += offset(E_.row[column + 1] - E_.row[column], block);
    }
    E_part_.resize(size);
    V_.resize(V_local_.size() * block + 3, 0.0f);  // load() of a row reads beyond the last block
    touching_ = sorted_by_group(coarse_, P_.columns);
    sum_.resize(coarse_.size());
    c_part_.resize(coarse_.size());
}

// The rows of V and what they add to E.
template <int d>
void CoarseCorrection::multiply_out(const BlockCsr& A, const double* C_inverse, int part) {
    constexpr int block = d * d;
    const int* const coarse = coarse_.data() + touched_start_[part];
    thread_local std::vector<int> place;  // of a coarse unknown in the row
    thread_local std::vector<double> AP;  // the row; both kept between calls
    place.resize(P_.columns);
    for (int t = touched_start_[part]; t < touched_start_[part + 1]; ++t)
        std::fill_n(E_part_.data() + E_start_[t], offset(E_.row[coarse_[t] + 1] - E_.row[coarse_[t]], block), 0.0);
    for (int i = begin_of(part); i < begin_of(part + 1); ++i) {
        const int first = V_row_[i], count = V_row_[i + 1] - first;
        AP.assign(offset(count, block), 0.0);
        for (int k = 0; k < count; ++k) place[coarse[V_local_[first + k]]] = k;
        if (A.in_half()) std::copy_n(V_.data() + offset(first, block), AP.size(), AP.data());
        for (int k = A.row[i]; k < A.row[i + 1] && !A.in_half(); ++k)
            add_product<d>(A.block(k), false, P_, A.col[k], [](int column) { return place[column]; }, AP.data());
        for (int l = P_.row[i]; l < P_.row[i + 1]; ++l) {
            const int row = P_.col[l];
            double* const E_row = E_part_.data() + E_start_[touched_start_[part] + P_local_[l]];
            const double weight = P_.weight[l];
            for (int k = 0, at = E_.row[row]; k < count; ++k) {  // both in ascending columns
                while (E_.col[at] != coarse[V_local_[first + k]]) ++at;
                double* const to = E_row + offset(at - E_.row[row], block);
                for (int e = 0; e < block; ++e) to[e] += weight * AP[offset(k, block, e)];
            }
        }
        const double* const C = C_inverse + offset(i, block);
        for (int k = 0; k < count; ++k) {
            double V[block] = {};
            for (int a = 0; a < d; ++a)
                for (int b = 0; b <= a; ++b)
                    for (int c = 0; c < d; ++c) V[a * d + c] += C[a * d + b] * AP[offset(k, block, b * d + c)];
            std::copy_n(V, block, V_.data() + offset(first + k, block));
        }
    }
}

void CoarseCorrection::multiply_half(const BlockCsr& A, int begin, int end) {
    with_block_size(A.d, [&](auto d) {
        std::fill_n(V_.data() + offset(V_row_[begin], d * d), offset(V_row_[end] - V_row_[begin], d * d), 0.0f);
        const auto add = [&](const auto* B, int i, int part, int j, bool transposed) {
            const auto place_of = [&](int column) {
                int k = V_row_[i];
                while (coarse_[touched_start_[part] + V_local_[k]] != column) ++k;
                return k;
            };
            add_product<d>(B, transposed, P_, j, place_of, V_.data());
        };
        for (int i = begin, part = 0; i < end; ++i) {
            while (i >= begin_of(part + 1)) ++part;
            add(A.diagonal(i), i, part, i, false);
            for (int k = A.row[i], other = 0; k < A.row[i + 1]; ++k) {
                while (A.col[k] >= begin_of(other + 1)) ++other;
                add(A.block_below(k), i, part, A.col[k], false);
                add(A.block_below(k), A.col[k], other, i, true);
            }
        }
    });
}

template <int d>
void CoarseCorrection::add_up_coarse(int row) {
    double* const to = E_.block(E_.row[row]);
    const std::size_t size = offset(E_.row[row + 1] - E_.row[row], d * d);
    std::fill_n(to, size, 0.0);
    for (const int place : touching_.of(row))
        for (std::size_t e = 0; e < size; ++e) to[e] += E_part_[E_start_[place] + e];
}

FactorResult CoarseCorrection::factor(const BlockCsr& A, const double* C_inverse) {
    with_block_size(A.d, [&](auto d) {
        parallel_tasks(parts, A.size() >= parallel_work, [&](int part) { multiply_out<d>(A, C_inverse, part); });
        parallel_for(E_.n, [&](int row) { add_up_coarse<d>(row); }, 200);
    });
    const bool succeeds = M_->factor(E_).status == SolveStatus::success;
    return {succeeds ? SolveStatus::success : SolveStatus::not_positive_definite};
}

// sum_ = P'r - V'y of a part of the rows.
template <int d>
void CoarseCorrection::restrict_part(const double* r, const Four* y, int part) {
    Four* const sum = sum_.data() + touched_start_[part];
    std::fill_n(sum, touched(part), Four{});
    for (int i = begin_of(part); i < begin_of(part + 1); ++i) {
        for (int l = P_.row[i]; l < P_.row[i + 1]; ++l)
            for (int a = 0; a < d; ++a) sum[P_local_[l]][a] += P_.weight[l] * r[offset(i, d, a)];
        Four entry[d];
        for (int a = 0; a < d; ++a) entry[a] = Four{} + y[i][a];
        for (int k = V_row_[i]; k < V_row_[i + 1]; ++k) {
            Four row, product{};
            for (int a = 0; a < d; ++a) {  // what comes after the row ends in the pads
                load(V_.data() + offset(k, d * d, a * d), row);
                product += row * entry[a];
            }
            sum[V_local_[k]] -= product;
        }
    }
}

// w = y - V c of a part of the rows.
template <int d>
void CoarseCorrection::prolong_part(const Four* y, Four* w, int part) {
    const int* const coarse = coarse_.data() + touched_start_[part];
    Four* const c = c_part_.data() + touched_start_[part];
    for (int t = 0; t < touched(part); ++t) {
        c[t] = Four{};
        for (int a = 0; a < d; ++a) c[t][a] = c_[offset(coarse[t], d, a)];
    }
    for (int i = begin_of(part); i < begin_of(part + 1); ++i) {
        Four product[d] = {};
        for (int k = V_row_[i]; k < V_row_[i + 1]; ++k)
            for (int a = 0; a < d; ++a) {
                Four row;
                load(V_.data() + offset(k, d * d, a * d), row);
                product[a] += row * c[V_local_[k]];
            }
        Four sum = y[i];
        for (int a = 0; a < d; ++a)
            for (int b = 0; b < d; ++b) sum[a] -= product[a][b];
        w[i] = sum;
    }
}

Products CoarseCorrection::correct(const double* r, const Four* y, Four* w) {
    const int d = E_.d;
    with_block_size(d, [&](auto size) {
#pragma omp for schedule(dynamic, 1)
        for (int part = 0; part < parts; ++part) restrict_part<size>(r, y, part);
    });
#pragma omp for schedule(static)
    for (int row = 0; row < E_.n; ++row) {
        Four sum{};
        for (const int place : touching_.of(row)) sum += sum_[place];
        for (int a = 0; a < d; ++a) r_[offset(row, d, a)] = sum[a];
    }
    const KrylovResult solved = iteration_.solve_in_team(E_, *M_, r_.data(), c_.data());
    Products of_c;
    of_c.rz = rc_([&](int i, int count) { return dot_of_piece(count, r_.data() + i, c_.data() + i); });
    of_c.zAz = of_c.rz;  // what is left of the right-hand side is orthogonal to c
    of_c.is_indefinite = solved.status == SolveStatus::not_positive_definite;
    with_block_size(d, [&](auto size) {
#pragma omp for schedule(dynamic, 1)
        for (int part = 0; part < parts; ++part) prolong_part<size>(y, w, part);
    });
    return of_c;
}

void CoarseCorrection::add_to(double* z) const {
    const int d = E_.d;
#pragma omp for schedule(static)
    for (int part = 0; part < parts; ++part) {
        const Four* const c = c_part_.data() + touched_start_[part];
        for (int i = begin_of(part); i < begin_of(part + 1); ++i)
            for (int l = P_.row[i]; l < P_.row[i + 1]; ++l)
                for (int a = 0; a < d; ++a) z[offset(i, d, a)] += P_.weight[l] * c[P_local_[l]][a];
    }
}

}  // namespace almesh
