// Row i of A ~ C (I + L) (I + L') C', with T_ij = C_i L_ij:
//     T_ij = (A_ij - sum over k < j of T_ik L_jk' C_j') C_j^{-T},   C_i C_i' = A_ii - sum over k < i of T_ik T_ik'.
// A solve is (I + L) y = C^{-1} r by rows of L, then (I + L') w = y by columns of L', z = C^{-T} w; r'z = |y|^2.
#include "linalg/krylov/ilu0.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <utility>

#include "base/index.hpp"

namespace almesh {

namespace {

// T -= A B'
template <int d, class Number>
void subtract_product_transposed(const double* A, const Number* B, double* T) {
    for (int r = 0; r < d; ++r)
        for (int c = 0; c < d; ++c)
            for (int k = 0; k < d; ++k) T[r * d + c] -= A[r * d + k] * static_cast<double>(B[c * d + k]);
}

// inverse <- C^{-1} where D = C C', C lower triangular. False if D is not positive definite or not finite.
template <int d>
bool inverse_of_cholesky(const double* D, double* inverse) {
    double C[d * d] = {};
    for (int j = 0; j < d; ++j)
        for (int i = j; i < d; ++i) {
            double sum = D[i * d + j];
            for (int k = 0; k < j; ++k) sum -= C[i * d + k] * C[j * d + k];
            // A pivot below this part of its diagonal entry is rounding.
            if (i == j && !(sum > 1e-14 * D[i * d + i] && std::isfinite(sum))) return false;
            C[i * d + j] = i == j ? std::sqrt(sum) : sum / C[j * d + j];
        }
    std::fill_n(inverse, d * d, 0.0);
    for (int j = 0; j < d; ++j)
        for (int i = j; i < d; ++i) {
            double sum = i == j;
            for (int k = j; k < i; ++k) sum -= C[i * d + k] * inverse[k * d + j];
            inverse[i * d + j] = sum / C[i * d + i];
        }
    return std::isfinite(inverse[(d - 1) * d]);
}

}  // namespace

Ilu0::Ilu0(const BlockCsr& pattern) : Ilu0(pattern, {0, pattern.n}) {}

Ilu0::Ilu0(const BlockCsr& pattern, std::vector<int> start, std::vector<double> diagonal_shifts)
    : d_(pattern.d), start_(std::move(start)), diagonal_shifts_(std::move(diagonal_shifts)) {
    for (int i = 0; i < pattern.n; ++i) {
        for (int k = pattern.row[i]; pattern.col[k] < i; ++k) col_.push_back(pattern.col[k]);
        row_.push_back(static_cast<int>(col_.size()));
        longest_ = std::max(longest_, row_[i + 1] - row_[i]);
        for (int k = row_[i]; k < row_[i + 1]; ++k) {
            for (int a = row_[i], b = row_[col_[k]]; a < k && b < row_[col_[k] + 1];) {
                const int left = col_[a], right = col_[b];
                if (left == right) term_.push_back({a - row_[i], b});
                a += left <= right;
                b += right <= left;
            }
            term_start_.push_back(term_.size());
        }
    }
    const int n = pattern.n, block = d_ * d_;
    L_.resize(col_.size() * block + 3, 0.0f);  // load() of a row reads beyond the last block
    C_inverse_.resize(offset(n, block));
    y_.resize(n);
    row_of_.resize(start_.size() * longest_ * block);
    squares_.resize(start_.size());
    bad_.resize(domains());
    find_links();
}

void Ilu0::find_links() {
    const int first = start_.back();
    std::vector<std::vector<Link>> of_domain(domains());
    std::vector<int> domain_of_link;
    for (int i = first; i < rows(); ++i) {
        int k = row_[i];
        separator_row_.push_back({static_cast<int>(domain_of_link.size()), k});
        for (int domain = 0; domain < domains(); ++domain) {
            const int begin = k;
            while (k < row_[i + 1] && col_[k] < start_[domain + 1]) ++k;
            if (k == begin) continue;
            link_of_row_.push_back(static_cast<int>(of_domain[domain].size()));
            domain_of_link.push_back(domain);
            of_domain[domain].push_back({i, begin, k});
        }
        separator_row_.back().begin = k;
    }
    separator_row_.push_back({static_cast<int>(domain_of_link.size()), 0});
    for (const std::vector<Link>& links : of_domain) {
        link_.insert(link_.end(), links.begin(), links.end());
        link_start_.push_back(static_cast<int>(link_.size()));
    }
    for (std::size_t l = 0; l < link_of_row_.size(); ++l) link_of_row_[l] += link_start_[domain_of_link[l]];
    link_product_.resize(link_.size());
}

// Rows begin .. end-1, whose columns must be done or among them. T: one row of blocks. Returns the bad row, or -1.
template <int d>
int Ilu0::factor_rows(const BlockCsr& A, double diagonal_shift, int begin, int end, double* T) {
    constexpr int block = d * d;
    for (int i = begin; i < end; ++i) {
        const double* const Ai = A.block(A.row[i]);  // as many blocks as L has in this row, then the diagonal one
        // T_ij = C_i L_ij, from A_ij = sum over k < j of T_ik L_jk' C_j' + T_ij C_j'
        for (int k = row_[i]; k < row_[i + 1]; ++k) {
            const int j = col_[k];
            double Tj[block] = {};
            subtract_product_transposed<d>(Ai + (k - row_[i]) * block,
                                           C_inverse_.data() + offset(j, block), Tj);
            for (int e = 0; e < block; ++e) Tj[e] = -Tj[e];
            for (std::size_t t = term_start_[k]; t < term_start_[k + 1]; ++t)
                subtract_product_transposed<d>(T + term_[t].left * block,
                                               L_.data() + offset(term_[t].right, block), Tj);
            std::copy_n(Tj, block, T + (k - row_[i]) * block);
        }
        double D[block];
        std::copy_n(Ai + (row_[i + 1] - row_[i]) * block, block, D);
        for (double& entry : D) entry *= 1 + diagonal_shift;
        for (int k = 0; k < row_[i + 1] - row_[i]; ++k)
            subtract_product_transposed<d>(T + k * block, T + k * block, D);
        double* const C_inverse = C_inverse_.data() + offset(i, block);
        if (!inverse_of_cholesky<d>(D, C_inverse)) return i;
        for (int k = row_[i]; k < row_[i + 1]; ++k) {
            double Lk[block] = {};
            for (int r = 0; r < d; ++r)
                for (int s = 0; s <= r; ++s)
                    for (int c = 0; c < d; ++c)
                        Lk[r * d + c] += C_inverse[r * d + s] * T[(k - row_[i]) * block + s * d + c];
            std::copy_n(Lk, block, L_.data() + offset(k, block));
        }
    }
    return -1;
}

// Returns the first bad row, or -1.
template <int d>
int Ilu0::factor_blocks(const BlockCsr& A, double diagonal_shift) {
    const auto rows_of_blocks = [&](int domain) { return row_of_.data() + offset(domain, longest_ * d * d); };
#pragma omp parallel for schedule(dynamic, 1) if (domains() > 1)
    for (int k = 0; k < domains(); ++k)
        bad_[k] = factor_rows<d>(A, diagonal_shift, start_[k], start_[k + 1], rows_of_blocks(k));
    for (int bad : bad_)
        if (bad >= 0) return bad;
    return factor_rows<d>(A, diagonal_shift, start_.back(), rows(), rows_of_blocks(domains()));
}

FactorResult Ilu0::factor(const BlockCsr& A) {
    FactorResult result{SolveStatus::indefinite_preconditioner};
    for (const double diagonal_shift : diagonal_shifts_) {
        result.diagonal_shift = diagonal_shift;
        result.bad_row = d_ == 1   ? factor_blocks<1>(A, diagonal_shift)
                         : d_ == 2 ? factor_blocks<2>(A, diagonal_shift)
                                   : factor_blocks<3>(A, diagonal_shift);
        if (result.bad_row >= 0) continue;
        result.status = SolveStatus::success;
        break;
    }
    return result;
}

// The four kernels below run for every row and are inlined. Registers go in and out of them by reference: see lanes.hpp.

// product <- the sum of L_ij y_j over the blocks begin .. end-1. Row r of a block is read with what comes after it,
// which is multiplied by the zero pads of y_j.
template <int d>
[[gnu::always_inline]] inline void Ilu0::multiply_row(int begin, int end, Four& product) const {
    Four products[d] = {};
    for (int k = begin; k < end; ++k) {
        const float* const L = L_.data() + offset(k, d * d);
        const Four y = y_[col_[k]];
        for (int a = 0; a < d; ++a) {
            Four row;
            load(L + a * d, row);
            products[a] += row * y;
        }
    }
    product = Four{};
    for (int a = 0; a < d; ++a)
        for (int b = 0; b < d; ++b) product[a] += products[a][b];
}

// y_i = C_i^{-1} r_i - sum; returns its squared norm.
template <int d>
[[gnu::always_inline]] inline double Ilu0::solve_row(int i, const double* r, const Four& sum) {
    const double* const C_inverse = C_inverse_.data() + offset(i, d * d);
    const double* const ri = r + offset(i, d);
    Four y{};
    double square = 0;
    for (int a = 0; a < d; ++a) {
        for (int b = 0; b <= a; ++b) y[a] += C_inverse[a * d + b] * ri[b];
        y[a] -= sum[a];
        square += y[a] * y[a];
    }
    y_[i] = y;
    return square;
}

// y_j -= L_ij' y over the blocks begin .. end-1. The pads of y_j, entries d and up, lose their zeros.
template <int d>
[[gnu::always_inline]] inline void Ilu0::subtract_transposed(int begin, int end, const Four& y) {
    Four entry[d];
    for (int a = 0; a < d; ++a) entry[a] = Four{} + y[a];
    for (int k = begin; k < end; ++k) {
        const float* const L = L_.data() + offset(k, d * d);
        Four row, product;
        load(L, row);
        product = row * entry[0];
        for (int a = 1; a < d; ++a) {
            load(L + a * d, row);
            product += row * entry[a];
        }
        y_[col_[k]] -= product;
    }
}

// z_i = C_i^{-T} y_i
template <int d>
[[gnu::always_inline]] inline void Ilu0::finish_row(int i, double* z) const {
    const double* const C_inverse = C_inverse_.data() + offset(i, d * d);
    for (int b = 0; b < d; ++b) {
        double sum = 0;
        for (int a = b; a < d; ++a) sum += C_inverse[a * d + b] * y_[i][a];
        z[offset(i, d, b)] = sum;
    }
}

// (I + L) y = C^{-1} r: in a domain, and what it adds to the rows of the separators.
template <int d>
double Ilu0::sweep_forward(int domain, const double* r) {
    double squares = 0;
    Four product;
    for (int i = start_[domain]; i < start_[domain + 1]; ++i) {
        multiply_row<d>(row_[i], row_[i + 1], product);
        squares += solve_row<d>(i, r, product);
    }
    for (int l = link_start_[domain]; l < link_start_[domain + 1]; ++l)
        multiply_row<d>(link_[l].begin, link_[l].end, link_product_[l]);
    return squares;
}

// Forward and back through the separators.
template <int d>
double Ilu0::sweep_separators(const double* r, double* z) {
    double squares = 0;
    const int first = start_.back();
    Four sum;
    for (int i = first; i < rows(); ++i) {
        const SeparatorRow& own = separator_row_[i - first];
        multiply_row<d>(own.begin, row_[i + 1], sum);
        for (int l = own.first_link; l < separator_row_[i - first + 1].first_link; ++l)
            sum += link_product_[link_of_row_[l]];
        squares += solve_row<d>(i, r, sum);
    }
    for (int i = rows() - 1; i >= first; --i) {
        subtract_transposed<d>(separator_row_[i - first].begin, row_[i + 1], y_[i]);
        finish_row<d>(i, z);
    }
    return squares;
}

// (I + L') w = y, z = C^{-T} w: by columns of L', as they become known.
template <int d>
void Ilu0::sweep_backward(int domain, double* z) {
    for (int l = link_start_[domain]; l < link_start_[domain + 1]; ++l)
        subtract_transposed<d>(link_[l].begin, link_[l].end, y_[link_[l].row]);
    for (int i = start_[domain + 1] - 1; i >= start_[domain]; --i) {
        subtract_transposed<d>(row_[i], row_[i + 1], y_[i]);
        finish_row<d>(i, z);
    }
}

template <int d>
double Ilu0::sweep(const double* r, double* z) {
#pragma omp for schedule(dynamic, 1)
    for (int k = 0; k < domains(); ++k) squares_[k] = sweep_forward<d>(k, r);
#pragma omp single
    squares_.back() = sweep_separators<d>(r, z);
    const double rz = std::accumulate(squares_.begin(), squares_.end(), 0.0);
#pragma omp for schedule(dynamic, 1)
    for (int k = 0; k < domains(); ++k) sweep_backward<d>(k, z);
    return rz;
}

double Ilu0::apply(const double* r, double* z) {
    if (d_ == 1) return sweep<1>(r, z);
    if (d_ == 2) return sweep<2>(r, z);
    return sweep<3>(r, z);
}

}  // namespace almesh
