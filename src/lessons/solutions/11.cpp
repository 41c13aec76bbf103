// Solutions of the exercises of lesson 11.
#include <algorithm>
#include <cmath>

#include "lessons/exercises/11.hpp"

namespace almesh::lessons {

double growth_exponent(double n_1, double t_1, double n_2, double t_2) {
    return std::log(t_2 / t_1) / std::log(n_2 / n_1);
}

double predicted_entries(int dim, double n_0, double entries_0, double n) {
    const auto law = [dim](double m) { return dim == 2 ? m * std::log(m) : m * std::cbrt(m); };
    return entries_0 * law(n) / law(n_0);
}

double sum_in_pieces(const std::vector<double>& v, int block) {
    double total = 0;
    for (std::size_t first = 0; first < v.size(); first += block) {
        double piece = 0;  // a thread may compute it alone
        for (std::size_t i = first; i < std::min(v.size(), first + block); ++i) piece += v[i];
        total += piece;
    }
    return total;
}

double crossover(double a, double b) {
    return std::pow(b / a, 1.5);  // a n^2 = b n^{4/3}
}

}  // namespace almesh::lessons
