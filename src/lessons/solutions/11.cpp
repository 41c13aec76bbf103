// Solutions of the exercises of lesson 11.
#include <algorithm>
#include <cmath>
#include <list>
#include <unordered_map>

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

long lines_loaded(const std::vector<int>& columns, int capacity) {
    std::list<int> lines;  // those in the cache, the last used first
    std::unordered_map<int, std::list<int>::iterator> place;
    long loaded = 0;
    for (const int column : columns) {
        const int line = column / 8;
        if (const auto found = place.find(line); found != place.end()) {
            lines.splice(lines.begin(), lines, found->second);
            continue;
        }
        ++loaded;
        if (static_cast<int>(lines.size()) == capacity) {
            place.erase(lines.back());
            lines.pop_back();
        }
        lines.push_front(line);
        place[line] = lines.begin();
    }
    return loaded;
}

double product_rate(const SparseProduct& product, double peak, double bandwidth) {
    const double numbers = product.blocks * product.block * product.block, flops = 2 * numbers;
    const double bytes = 8 * numbers + 4 * (product.blocks + product.rows) + 64 * product.lines +
                         8 * product.rows * product.block;
    return std::min(peak, bandwidth * flops / bytes);
}

}  // namespace almesh::lessons
