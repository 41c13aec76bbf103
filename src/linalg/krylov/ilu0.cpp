// Row i of A ~ C (I + L) (I + L') C', with T_ij = C_i L_ij:
//     T_ij = (A_ij - sum over k < j of T_ik L_jk' C_j') C_j^{-T},   C_i C_i' = A_ii - sum over k < i of T_ik T_ik'.
// A solve is (I + L) y = C^{-1} r by rows of L, then (I + L') w = y by columns of L', z = C^{-T} w; r'z = |y|^2.
#include "linalg/krylov/ilu0.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "base/index.hpp"
#include "base/lanes.hpp"
#include "base/large_array.hpp"
#include "base/parallel.hpp"

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
class Ilu0 final : public Preconditioner {
public:
    Ilu0(const BlockCsr& pattern, std::vector<int> start, std::vector<double> diagonal_shifts, Sweeps sweeps,
                 std::unique_ptr<CoarseCorrection> correction)
        : start_(std::move(start)),
          diagonal_shifts_(std::move(diagonal_shifts)),
          sweeps_(sweeps),
          correction_(std::move(correction)),
          C_inverse_(offset(pattern.n, block)),
          C_diagonal_(offset(pattern.n, d)),
          y_(pattern.n) {
        find_pattern(pattern);
        find_links();
    }

    FactorResult factor(const BlockCsr& A) override {
        FactorResult result{SolveStatus::indefinite_preconditioner};
        if (A.in_half()) L_ = A.below->data();
        if (A.in_half() && correction_) {
            parallel_tasks(domains(), true, [&](int k) { correction_->multiply_half(A, start_[k], start_[k + 1]); });
            correction_->multiply_half(A, start_.back(), rows());
        }
        const auto succeeds = [&](double diagonal_shift, bool ssor) {
            result.diagonal_shift = diagonal_shift;
            result.ssor = ssor;
            result.bad_row = factor_shifted(A, diagonal_shift, ssor);
            if (result.bad_row < 0) result.status = SolveStatus::success;
            keep_forward(ssor && result.bad_row < 0);
            return result.bad_row < 0;
        };
        if (sweeps_ != Sweeps::ssor)
            for (const double diagonal_shift : diagonal_shifts_)
                if (succeeds(diagonal_shift, false)) return result;
        if (sweeps_ != Sweeps::ilu0 && succeeds(0, true) && correction_)
            result.status = correction_->factor(A, C_inverse_.data()).status;
        return result;
    }

    double apply(const double* r, double* z) override { return sweep(Given{r}, z, nullptr).rz; }

    // SSOR has A = C (I + L + L') C', and with w = C'z, (I + L') w = y: z'A z = 2 w'y - w'w, A z = C (L w + y).
    bool puts_off_products() const override { return keeps_forward_; }

    Products apply_and_put_off(const double* r, double* z, double* Az) override { return sweep(Given{r}, z, Az); }

    Products advance(double alpha, double beta, double* q, double* r, double* z, double* Az) override {
        return sweep(Advanced{*this, alpha, beta, q, r, Az}, z, Az);
    }

private:
    static constexpr int block = d * d;
    static constexpr int prefetched = 1024;  // numbers ahead

    int rows() const { return static_cast<int>(row_.size()) - 1; }
    int domains() const { return static_cast<int>(start_.size()) - 1; }
    const float* L(int k) const { return L_ + offset(k, block); }
    const double* C_inverse(int i) const { return C_inverse_.data() + offset(i, block); }

    void find_pattern(const BlockCsr& pattern) {
        for (int i = 0; i < pattern.n; ++i) {
            int end = pattern.row[i];
            for (; end < pattern.row[i + 1] && pattern.col[end] < i; ++end)
                if (!pattern.in_half()) own_col_.push_back(pattern.col[end]);
            row_.push_back(row_.back() + end - pattern.row[i]);
            col_ = pattern.in_half() ? pattern.col.data() : own_col_.data();
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
        own_L_.resize(own_col_.size() * block + 3, 0.0f);  // load() of a row reads beyond the last block
        L_ = own_L_.data();
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
                link_.push_back(Link{i, begin, k, {}});
            }
            separator_row_.back().begin = k;
        }
        separator_row_.push_back({static_cast<int>(link_.size()), 0});
    }

    // Returns the first bad row, or -1.
    int factor_shifted(const BlockCsr& A, double diagonal_shift, bool ssor) {
        const auto T = [&](int domain) { return T_.data() + offset(domain, longest_ * block); };
        parallel_tasks(domains(), true, [&](int k) {
            bad_[k] = factor_rows(A, diagonal_shift, ssor, start_[k], start_[k + 1], T(k));
        });
        for (int bad : bad_)
            if (bad >= 0) return bad;
        return factor_rows(A, diagonal_shift, ssor, start_.back(), rows(), T(domains()));
    }

    // Rows begin .. end-1; the rows that their columns name are done or among them. T: one row of blocks. Returns the
    // first bad row, or -1.
    int factor_rows(const BlockCsr& A, double diagonal_shift, bool ssor, int begin, int end, double* T) {
        for (int i = begin; i < end; ++i) {
            const int first = row_[i], count = row_[i + 1] - first;
            if (A.in_half()) std::copy_n(L(first), count * block, T);
            const double* const Ai = A.in_half() ? T : A.block(A.row[i]);  // as many blocks as L has in this row,
            const double* const Aii = A.in_half() ? A.diagonal(i) : Ai + count * block;  // then the diagonal one
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
            for (int e = 0; e < block; ++e) D[e] = Aii[e] * (1 + diagonal_shift);
            for (int k = 0; k < count && !ssor; ++k) subtract_product_transposed<d>(T + k * block, T + k * block, D);
            double* const inverse = C_inverse_.data() + offset(i, block);
            if (!inverse_of_cholesky<d>(D, inverse)) return i;
            for (int a = 0; a < d; ++a) C_diagonal_[offset(i, d, a)] = 1 / inverse[a * d + a];
            for (int k = 0; k < count; ++k) {
                double Lk[block] = {};
                for (int r = 0; r < d; ++r)
                    for (int s = 0; s <= r; ++s)
                        for (int c = 0; c < d; ++c) Lk[r * d + c] += inverse[r * d + s] * T[k * block + s * d + c];
                std::copy_n(Lk, block, L_ + offset(first + k, block));
            }
        }
        return -1;
    }

    // The kernels below run for every row and are inlined. Registers go by reference: see lanes.hpp.

    // L y and, where the residual advances, L w of a row.
    struct RowProduct {
        Four y, w;
    };

    // product <- the sum of L_ij y_j over the blocks begin .. end-1. Row r of a block is read with what comes after it,
    // which is multiplied by the zero pads of y_j.
    template <bool with_w>
    [[gnu::always_inline]] inline void multiply_row(int begin, int end, RowProduct& product) const {
        Four with_y[d] = {}, with[d] = {};
        for (int k = begin; k < end; ++k) {
            const Four y = y_[col_[k]];
            Four w;
            if constexpr (with_w) w = w_[col_[k]];
            for (int a = 0; a < d; ++a) {
                Four row;
                load(L(k) + a * d, row);
                with_y[a] += row * y;
                if constexpr (with_w) with[a] += row * w;
            }
        }
        product = RowProduct{};
        for (int a = 0; a < d; ++a)
            for (int b = 0; b < d; ++b) {
                product.y[a] += with_y[a][b];
                if constexpr (with_w) product.w[a] += with[a][b];
            }
    }

    // The right-hand side of a sweep: r as it is,
    struct Given {
        static constexpr bool advances = false;
        const double* r;
        const double* of_row(int i, const RowProduct&, Products&) const { return r + offset(i, d); }
    };
    // or q = A z + beta q, r -= alpha q first. y_i is still that of z.
    struct Advanced {
        static constexpr bool advances = true;
        const Ilu0& M;
        double alpha, beta;
        double *q, *r;
        const double* Az;
        [[gnu::always_inline]] inline const double* of_row(int i, const RowProduct& product, Products& sums) const {
            double Azi[d];
            M.multiply_by_C(i, product.w + M.y_[i], Azi);
            double *const qi = q + offset(i, d), *const ri = r + offset(i, d);
            for (int a = 0; a < d; ++a) {
                qi[a] = Azi[a] + Az[offset(i, d, a)] + beta * qi[a];
                ri[a] -= alpha * qi[a];
                sums.rr += ri[a] * ri[a];
            }
            return ri;
        }
    };

    // y_i = C_i^{-1} r_i - L y.
    template <class Residual>
    [[gnu::always_inline]] inline void solve_row(int i, const Residual& residual, const RowProduct& product,
                                                 Products& sums) {
        const double *const inverse = C_inverse(i), *const ri = residual.of_row(i, product, sums);
        Four y{};
        for (int a = 0; a < d; ++a) {
            for (int b = 0; b <= a; ++b) y[a] += inverse[a * d + b] * ri[b];
            y[a] -= product.y[a];
            sums.rz += y[a] * y[a];
        }
        y_[i] = y;
    }

    // w_j -= L_ij' w over the blocks begin .. end-1. The pads of w_j, entries d and up, lose their zeros.
    [[gnu::always_inline]] inline void subtract_transposed(int begin, int end, const Four& w) {
        Four entry[d];
        for (int a = 0; a < d; ++a) entry[a] = Four{} + w[a];
        for (int k = begin; k < end; ++k) {
            __builtin_prefetch(L(k) - prefetched);  // rows go backwards, which the hardware does not foresee
            __builtin_prefetch(col_ + k - prefetched / block);
            Four row, product;
            load(L(k), row);
            product = row * entry[0];
            for (int a = 1; a < d; ++a) {
                load(L(k) + a * d, row);
                product += row * entry[a];
            }
            w_[col_[k]] -= product;
        }
    }

    // z_i = C_i^{-T} w_i, and zeros in the pads of w_i and in Az.
    [[gnu::always_inline]] inline void finish_row(int i, double* z, double* Az, Products& sums) {
        for (int a = d; a < 4; ++a) w_[i][a] = 0;
        const double* const inverse = C_inverse(i);
        for (int b = 0; b < d; ++b) {
            double sum = 0;
            for (int a = b; a < d; ++a) sum += inverse[a * d + b] * w_[i][a];
            z[offset(i, d, b)] = sum;
        }
        for (int a = 0; Az && a < d; ++a) {
            sums.zAz += w_[i][a] * (2 * y_[i][a] - w_[i][a]);
            Az[offset(i, d, a)] = 0;
        }
    }

    // Cv = C_i v, from C_i^{-1} Cv = v.
    [[gnu::always_inline]] inline void multiply_by_C(int i, const Four& v, double* Cv) const {
        const double *const inverse = C_inverse(i), *const diagonal = &C_diagonal_[offset(i, d)];
        for (int a = 0; a < d; ++a) {
            double sum = v[a];
            for (int b = 0; b < a; ++b) sum -= inverse[a * d + b] * Cv[b];
            Cv[a] = sum * diagonal[a];
        }
    }

    // Az: null where z'A z is not asked for.
    template <class Residual>
    Products sweep(const Residual& residual, double* z, double* Az) {
#pragma omp for schedule(dynamic, 1)
        for (int k = 0; k < domains(); ++k) forward_[k] = sweep_forward(k, residual);
#pragma omp single
        forward_.back() = sweep_separators_forward(residual);
        Products sum;
        if (correction_) sum = correction_->correct(residual.r, y_.data(), w_);
        for (const Products& part : forward_) {
            sum.rr += part.rr;
            sum.rz += part.rz;
        }
#pragma omp single
        backward_.back() = sweep_separators_backward(z, Az);
#pragma omp for schedule(dynamic, 1)
        for (int k = 0; k < domains(); ++k) backward_[k] = sweep_backward(k, z, Az);
        for (const Products& part : backward_) sum.zAz += part.zAz;
        if (correction_) correction_->add_to(z);
        return sum;
    }

    // (I + L) y = C^{-1} r: in a domain, and what it adds to the rows of the separators.
    template <class Residual>
    Products sweep_forward(int domain, const Residual& residual) {
        Products sums;
        RowProduct product;
        for (int i = start_[domain]; i < start_[domain + 1]; ++i) {
            multiply_row<Residual::advances>(row_[i], row_[i + 1], product);
            solve_row(i, residual, product, sums);
        }
        for (int l : links_of_domain_[domain])
            multiply_row<Residual::advances>(link_[l].begin, link_[l].end, link_[l].product);
        return sums;
    }

    template <class Residual>
    Products sweep_separators_forward(const Residual& residual) {
        Products sums;
        const int first = start_.back();
        RowProduct product;
        for (int i = first; i < rows(); ++i) {
            const SeparatorRow& own = separator_row_[i - first];
            multiply_row<Residual::advances>(own.begin, row_[i + 1], product);
            for (int l = own.first_link; l < separator_row_[i - first + 1].first_link; ++l) {
                product.y += link_[l].product.y;
                product.w += link_[l].product.w;
            }
            solve_row(i, residual, product, sums);
        }
        return sums;
    }

    Products sweep_separators_backward(double* z, double* Az) {
        Products sums;
        const int first = start_.back();
        start_backward(first, rows());
        for (int i = rows() - 1; i >= first; --i) {
            subtract_transposed(separator_row_[i - first].begin, row_[i + 1], w_[i]);
            finish_row(i, z, Az, sums);
        }
        return sums;
    }

    // (I + L') w = y, z = C^{-T} w: by columns of L', as they become known.
    Products sweep_backward(int domain, double* z, double* Az) {
        Products sums;
        start_backward(start_[domain], start_[domain + 1]);
        for (int l : links_of_domain_[domain]) subtract_transposed(link_[l].begin, link_[l].end, w_[link_[l].row]);
        for (int i = start_[domain + 1] - 1; i >= start_[domain]; --i) {
            subtract_transposed(row_[i], row_[i + 1], w_[i]);
            finish_row(i, z, Az, sums);
        }
        return sums;
    }

    void start_backward(int begin, int end) {
        if (keeps_forward_ && !correction_) std::copy(y_.begin() + begin, y_.begin() + end, w_ + begin);
    }

    // SSOR keeps y beside w; else w takes its place.
    void keep_forward(bool keeps) {
        keeps_forward_ = keeps;
        if (keeps) kept_.resize(rows());
        w_ = keeps ? kept_.data() : y_.data();
    }

    std::vector<int> start_;
    std::vector<double> diagonal_shifts_;
    Sweeps sweeps_;
    std::unique_ptr<CoarseCorrection> correction_;
    std::vector<int> row_{0};                 // n + 1 offsets into col_
    std::vector<int> own_col_;
    const int* col_ = nullptr;                // block columns of L, ascending in a row: the first of the row of A
    struct Term {
        int left, right;                      // of a product T_ij' L_kj': its block of the row of T, from 0, and of L
    };
    std::vector<std::size_t> term_start_{0};  // the terms of block k: term_start_[k] .. term_start_[k+1]
    std::vector<Term> term_;
    struct Link {                             // the blocks begin .. end-1 of a separator's row in a domain's columns
        int row, begin, end;
        RowProduct product;
    };
    std::vector<Link> link_;                  // by rows, then domains
    std::vector<std::vector<int>> links_of_domain_;
    struct SeparatorRow {
        int first_link;                       // its links: up to those of the next row
        int begin;                            // its blocks in columns of separators: up to the next row
    };
    std::vector<SeparatorRow> separator_row_; // one more than rows
    LargeVector<float> own_L_;
    float* L_ = nullptr;                      // d*d per block, row-major; col_ and L_ are A's where half is stored
    std::vector<double> C_inverse_;           // d*d per row, lower triangular
    std::vector<double> C_diagonal_;          // d per row
    std::vector<Four> y_;                     // n: (I + L) y = C^{-1} r, d entries each and zeros
    std::vector<Four> kept_;                  // n, or none
    Four* w_ = y_.data();                     // n: (I + L') w = y, in kept_ or in the place of y
    bool keeps_forward_ = false;
    std::vector<double> T_;                   // d*d per block of the longest row, for each domain and the separators
    // The sums over each domain, and the separators, of the sweep forward and of that back.
    std::vector<Products> forward_ = std::vector<Products>(start_.size()), backward_ = forward_;
    std::vector<int> bad_ = std::vector<int>(domains());  // first bad row of each domain, or -1
    int longest_ = 0;                         // blocks of the longest row
};

}  // namespace

std::unique_ptr<Preconditioner> make_ilu0(const BlockCsr& pattern, std::vector<int> start,
                                          std::vector<double> diagonal_shifts, Sweeps sweeps,
                                          std::unique_ptr<CoarseCorrection> correction) {
    if (start.empty()) start = {0, pattern.n};
    std::unique_ptr<Preconditioner> made;
    with_block_size(pattern.d, [&](auto d) {
        made = std::make_unique<Ilu0<d>>(pattern, std::move(start), std::move(diagonal_shifts), sweeps,
                                         std::move(correction));
    });
    return made;
}

}  // namespace almesh
