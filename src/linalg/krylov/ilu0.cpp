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
#include "base/lanes.hpp"
#include "base/large_array.hpp"

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

template <int d>
class Ilu0OfBlocks final : public Preconditioner {
public:
    Ilu0OfBlocks(const BlockCsr& pattern, std::vector<int> start, std::vector<double> diagonal_shifts, Sweeps sweeps)
        : start_(std::move(start)),
          diagonal_shifts_(std::move(diagonal_shifts)),
          sweeps_(sweeps),
          C_inverse_(offset(pattern.n, block)),
          y_(pattern.n),
          squares_(start_.size()),
          bad_(domains()) {
        find_pattern(pattern);
        find_links();
    }

    FactorResult factor(const BlockCsr& A) override {
        FactorResult result{SolveStatus::indefinite_preconditioner};
        const auto succeeds = [&](double diagonal_shift, bool ssor) {
            result.diagonal_shift = diagonal_shift;
            result.ssor = ssor;
            result.bad_row = factor_shifted(A, diagonal_shift, ssor);
            if (result.bad_row < 0) result.status = SolveStatus::success;
            keeps_forward_ = ssor && result.bad_row < 0;
            if (keeps_forward_) forward_.resize(rows());
            return result.bad_row < 0;
        };
        if (sweeps_ != Sweeps::ssor)
            for (const double diagonal_shift : diagonal_shifts_)
                if (succeeds(diagonal_shift, false)) return result;
        if (sweeps_ != Sweeps::ilu0) succeeds(0, true);
        return result;
    }

    // SSOR has A = C (I + L + L') C', and with w = C'z, (I + L') w = y, A z = C (L w + y).
    double apply_and_multiply(const BlockCsr& A, const double* r, double* z, double* Az) override {
        if (!keeps_forward_) return Preconditioner::apply_and_multiply(A, r, z, Az);
        const double rz = apply(r, z);
#pragma omp for schedule(static)
        for (int i = 0; i < rows(); ++i) {
            Four sum;
            multiply_row(row_[i], row_[i + 1], sum);
            sum += forward_[i];
            multiply_by_C(i, sum, Az);
        }
        return rz;
    }

    double apply(const double* r, double* z) override {
#pragma omp for schedule(dynamic, 1)
        for (int k = 0; k < domains(); ++k) squares_[k] = sweep_forward(k, r);
#pragma omp single
        squares_.back() = sweep_separators(r, z);
        const double rz = std::accumulate(squares_.begin(), squares_.end(), 0.0);
#pragma omp for schedule(dynamic, 1)
        for (int k = 0; k < domains(); ++k) sweep_backward(k, z);
        return rz;
    }

private:
    static constexpr int block = d * d;
    static constexpr int prefetched = 1024;  // numbers ahead

    int rows() const { return static_cast<int>(row_.size()) - 1; }
    int domains() const { return static_cast<int>(start_.size()) - 1; }
    const float* L(int k) const { return L_.data() + offset(k, block); }
    const double* C_inverse(int i) const { return C_inverse_.data() + offset(i, block); }

    void find_pattern(const BlockCsr& pattern) {
        for (int i = 0; i < pattern.n; ++i) {
            for (int k = pattern.row[i]; pattern.col[k] < i; ++k) col_.push_back(pattern.col[k]);
            row_.push_back(static_cast<int>(col_.size()));
            longest_ = std::max(longest_, row_[i + 1] - row_[i]);
            for (int k = row_[i]; sweeps_ != Sweeps::ssor && k < row_[i + 1]; ++k) {
                for (int a = row_[i], b = row_[col_[k]]; a < k && b < row_[col_[k] + 1];) {
                    const int left = col_[a], right = col_[b];
                    if (left == right) term_.push_back({a - row_[i], b});
                    a += left <= right;
                    b += right <= left;
                }
                term_start_.push_back(term_.size());
            }
        }
        L_.resize(col_.size() * block + 3, 0.0f);  // load() of a row reads beyond the last block
        T_.resize(start_.size() * longest_ * block);
    }

    void find_links() {
        links_of_domain_.resize(domains());
        for (int i = start_.back(); i < rows(); ++i) {
            int k = row_[i];
            separator_row_.push_back({static_cast<int>(link_.size()), k});
            for (int domain = 0; domain < domains(); ++domain) {
                const int begin = k;
                while (k < row_[i + 1] && col_[k] < start_[domain + 1]) ++k;
                if (k == begin) continue;
                links_of_domain_[domain].push_back(static_cast<int>(link_.size()));
                link_.push_back(Link{i, begin, k, Four{}});
            }
            separator_row_.back().begin = k;
        }
        separator_row_.push_back({static_cast<int>(link_.size()), 0});
    }

    // Returns the first bad row, or -1.
    int factor_shifted(const BlockCsr& A, double diagonal_shift, bool ssor) {
        const auto T = [&](int domain) { return T_.data() + offset(domain, longest_ * block); };
#pragma omp parallel for schedule(dynamic, 1) if (domains() > 1)
        for (int k = 0; k < domains(); ++k)
            bad_[k] = factor_rows(A, diagonal_shift, ssor, start_[k], start_[k + 1], T(k));
        for (int bad : bad_)
            if (bad >= 0) return bad;
        return factor_rows(A, diagonal_shift, ssor, start_.back(), rows(), T(domains()));
    }

    // Rows begin .. end-1; the rows that their columns name are done or among them. T: one row of blocks. Returns the
    // first bad row, or -1.
    int factor_rows(const BlockCsr& A, double diagonal_shift, bool ssor, int begin, int end, double* T) {
        for (int i = begin; i < end; ++i) {
            const double* const Ai = A.block(A.row[i]);  // as many blocks as L has in this row, then the diagonal one
            const int first = row_[i], count = row_[i + 1] - first;
            // T_ij = C_i L_ij, from A_ij = sum over k < j of T_ik L_jk' C_j' + T_ij C_j'
            for (int k = 0; k < count; ++k) {
                double Tj[block] = {};
                subtract_product_transposed<d>(Ai + k * block, C_inverse(col_[first + k]), Tj);
                for (double& entry : Tj) entry = -entry;
                if (!ssor)
                    for (std::size_t t = term_start_[first + k]; t < term_start_[first + k + 1]; ++t)
                        subtract_product_transposed<d>(T + term_[t].left * block, L(term_[t].right), Tj);
                std::copy_n(Tj, block, T + k * block);
            }
            double D[block];
            for (int e = 0; e < block; ++e) D[e] = Ai[count * block + e] * (1 + diagonal_shift);
            for (int k = 0; k < count && !ssor; ++k) subtract_product_transposed<d>(T + k * block, T + k * block, D);
            double* const inverse = C_inverse_.data() + offset(i, block);
            if (!inverse_of_cholesky<d>(D, inverse)) return i;
            for (int k = 0; k < count; ++k) {
                double Lk[block] = {};
                for (int r = 0; r < d; ++r)
                    for (int s = 0; s <= r; ++s)
                        for (int c = 0; c < d; ++c) Lk[r * d + c] += inverse[r * d + s] * T[k * block + s * d + c];
                std::copy_n(Lk, block, L_.data() + offset(first + k, block));
            }
        }
        return -1;
    }

    // The four kernels below run for every row and are inlined. Registers go by reference: see lanes.hpp.

    // product <- the sum of L_ij y_j over the blocks begin .. end-1. Row r of a block is read with what comes after it,
    // which is multiplied by the zero pads of y_j.
    [[gnu::always_inline]] inline void multiply_row(int begin, int end, Four& product) const {
        Four products[d] = {};
        for (int k = begin; k < end; ++k) {
            const Four y = y_[col_[k]];
            for (int a = 0; a < d; ++a) {
                Four row;
                load(L(k) + a * d, row);
                products[a] += row * y;
            }
        }
        product = Four{};
        for (int a = 0; a < d; ++a)
            for (int b = 0; b < d; ++b) product[a] += products[a][b];
    }

    // y_i = C_i^{-1} r_i - sum; returns its squared norm.
    [[gnu::always_inline]] inline double solve_row(int i, const double* r, const Four& sum) {
        const double *const inverse = C_inverse(i), *const ri = r + offset(i, d);
        Four y{};
        double square = 0;
        for (int a = 0; a < d; ++a) {
            for (int b = 0; b <= a; ++b) y[a] += inverse[a * d + b] * ri[b];
            y[a] -= sum[a];
            square += y[a] * y[a];
        }
        y_[i] = y;
        if (keeps_forward_) forward_[i] = y;
        return square;
    }

    // y_j -= L_ij' y over the blocks begin .. end-1. The pads of y_j, entries d and up, lose their zeros.
    [[gnu::always_inline]] inline void subtract_transposed(int begin, int end, const Four& y) {
        Four entry[d];
        for (int a = 0; a < d; ++a) entry[a] = Four{} + y[a];
        for (int k = begin; k < end; ++k) {
            __builtin_prefetch(L(k) - prefetched);  // rows go backwards, which the hardware does not foresee
            __builtin_prefetch(col_.data() + k - prefetched / block);
            Four row, product;
            load(L(k), row);
            product = row * entry[0];
            for (int a = 1; a < d; ++a) {
                load(L(k) + a * d, row);
                product += row * entry[a];
            }
            y_[col_[k]] -= product;
        }
    }

    // z_i = C_i^{-T} y_i, and zeros in the pads of y_i.
    [[gnu::always_inline]] inline void finish_row(int i, double* z) {
        for (int a = d; a < 4; ++a) y_[i][a] = 0;
        const double* const inverse = C_inverse(i);
        for (int b = 0; b < d; ++b) {
            double sum = 0;
            for (int a = b; a < d; ++a) sum += inverse[a * d + b] * y_[i][a];
            z[offset(i, d, b)] = sum;
        }
    }

    // z_i = C_i v, from C_i^{-1} z_i = v.
    [[gnu::always_inline]] inline void multiply_by_C(int i, const Four& v, double* z) const {
        const double* const inverse = C_inverse(i);
        double* const zi = z + offset(i, d);
        for (int a = 0; a < d; ++a) {
            double sum = v[a];
            for (int b = 0; b < a; ++b) sum -= inverse[a * d + b] * zi[b];
            zi[a] = sum / inverse[a * d + a];
        }
    }

    // (I + L) y = C^{-1} r: in a domain, and what it adds to the rows of the separators.
    double sweep_forward(int domain, const double* r) {
        double squares = 0;
        Four product;
        for (int i = start_[domain]; i < start_[domain + 1]; ++i) {
            multiply_row(row_[i], row_[i + 1], product);
            squares += solve_row(i, r, product);
        }
        for (int l : links_of_domain_[domain]) multiply_row(link_[l].begin, link_[l].end, link_[l].product);
        return squares;
    }

    // Forward and back through the separators.
    double sweep_separators(const double* r, double* z) {
        double squares = 0;
        const int first = start_.back();
        Four sum;
        for (int i = first; i < rows(); ++i) {
            const SeparatorRow& own = separator_row_[i - first];
            multiply_row(own.begin, row_[i + 1], sum);
            for (int l = own.first_link; l < separator_row_[i - first + 1].first_link; ++l) sum += link_[l].product;
            squares += solve_row(i, r, sum);
        }
        for (int i = rows() - 1; i >= first; --i) {
            subtract_transposed(separator_row_[i - first].begin, row_[i + 1], y_[i]);
            finish_row(i, z);
        }
        return squares;
    }

    // (I + L') w = y, z = C^{-T} w: by columns of L', as they become known.
    void sweep_backward(int domain, double* z) {
        for (int l : links_of_domain_[domain]) subtract_transposed(link_[l].begin, link_[l].end, y_[link_[l].row]);
        for (int i = start_[domain + 1] - 1; i >= start_[domain]; --i) {
            subtract_transposed(row_[i], row_[i + 1], y_[i]);
            finish_row(i, z);
        }
    }

    std::vector<int> start_;
    std::vector<double> diagonal_shifts_;
    Sweeps sweeps_;
    std::vector<int> row_{0};                 // n + 1 offsets into col_
    std::vector<int> col_;                    // block columns of L, ascending in a row: the first of the row of A
    struct Term {
        int left, right;                      // of a product T_ij' L_kj': its block of the row of T, from 0, and of L
    };
    std::vector<std::size_t> term_start_{0};  // the terms of block k: term_start_[k] .. term_start_[k+1]
    std::vector<Term> term_;
    struct Link {                             // the blocks begin .. end-1 of a separator's row in a domain's columns
        int row, begin, end;
        Four product;                         // with y
    };
    std::vector<Link> link_;                  // by rows, then domains
    std::vector<std::vector<int>> links_of_domain_;
    struct SeparatorRow {
        int first_link;                       // its links: up to those of the next row
        int begin;                            // its blocks in columns of separators: up to the next row
    };
    std::vector<SeparatorRow> separator_row_; // one more than rows
    LargeVector<float> L_;                    // d*d per block, row-major
    std::vector<double> C_inverse_;           // d*d per row, lower triangular
    std::vector<Four> y_;                     // n: the vector between the sweeps, d entries each and zeros; then w
    std::vector<Four> forward_;               // n: SSOR keeps y beside w
    bool keeps_forward_ = false;
    std::vector<double> T_;                   // d*d per block of the longest row, for each domain and the separators
    std::vector<double> squares_;             // |y|^2 over each domain and the separators
    std::vector<int> bad_;                    // first bad row of each domain, or -1
    int longest_ = 0;                         // blocks of the longest row
};

}  // namespace

Ilu0::Ilu0(const BlockCsr& pattern, std::vector<int> start, std::vector<double> diagonal_shifts, Sweeps sweeps) {
    with_block_size(pattern.d, [&](auto d) {
        blocks_ = std::make_unique<Ilu0OfBlocks<d>>(pattern, std::move(start), std::move(diagonal_shifts), sweeps);
    });
}

Ilu0::Ilu0(const BlockCsr& pattern) : Ilu0(pattern, {0, pattern.n}) {}

}  // namespace almesh
