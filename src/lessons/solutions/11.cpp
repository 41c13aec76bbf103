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

double predicted_entries(int dim, double n_1, double entries_1, double n_2, double entries_2, double n) {
    const auto law = [dim](double m) { return dim == 2 ? std::log(m) : std::cbrt(m); };  // entries = n (a law(n) + b)
    const double each_1 = entries_1 / n_1, each_2 = entries_2 / n_2;
    return n * (each_1 + (each_2 - each_1) * (law(n) - law(n_1)) / (law(n_2) - law(n_1)));
}

double sum_in_pieces(const std::vector<double>& v, int block) {
    std::vector<double> sums;
    for (std::size_t first = 0; first < v.size(); first += block) {
        double piece = 0;  // a thread may compute it alone
        for (std::size_t i = first; i < std::min(v.size(), first + block); ++i) piece += v[i];
        sums.push_back(piece);
    }
    for (std::size_t count = sums.size(); count > 1; count = (count + 1) / 2)
        for (std::size_t i = 0; i < (count + 1) / 2; ++i)
            sums[i] = 2 * i + 1 < count ? sums[2 * i] + sums[2 * i + 1] : sums[2 * i];
    return sums.empty() ? 0 : sums[0];
}

double crossover(double a, double b, double c, int count) {
    return b > c ? std::pow(count * (b - c) / a, 1.5) : 0;  // a n^2 + count c n^{4/3} = count b n^{4/3}
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
