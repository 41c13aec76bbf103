// f(t) = (1 - s) f_k + s f_{k+1},   s = (t - t_k) / (t_{k+1} - t_k),   t_k <= t <= t_{k+1}
#include "constraint/time_table.hpp"

#include <algorithm>
#include <utility>

#include "base/error.hpp"
#include "base/files.hpp"
#include "base/text.hpp"

namespace almesh {

TimeTable::TimeTable(const std::string& path) try : path_(path) {
    const std::string text = read_text_file(path);
    int number = 0;
    bool is_first = true;
    for (const std::string_view line : split(text, '\n')) {
        ++number;
        std::string row(line.substr(0, line.find('#')));
        std::replace(row.begin(), row.end(), ',', ' ');
        const auto word = words(row);
        if (word.empty()) continue;
        const auto t = parse_double(word[0]), value = parse_double(word.back());
        if (std::exchange(is_first, false) && !t && !value) continue;
        if (word.size() != 2 || !t || !value)
            throw UsageError(path, ":", number, ": expected a row `t value` of two finite numbers");
        if (!t_.empty() && *t <= t_.back())
            throw UsageError(path, ":", number, ": the times run backwards, ", *t, " is after ", t_.back());
        t_.push_back(*t);
        value_.push_back(*value);
    }
    if (t_.empty()) throw UsageError(path, ": no rows `t value`");
} catch (const InputError& error) {
    throw UsageError(error.what());
}

double TimeTable::operator()(double t) const {
    if (!(t >= t_.front() && t <= t_.back()))
        throw UsageError("t = ", t, " is outside of the table ", path_, ", from ", t_.front(), " to ", t_.back());
    const std::size_t k = std::upper_bound(t_.begin(), t_.end(), t) - t_.begin() - 1;
    if (t == t_[k]) return value_[k];
    const double s = (t - t_[k]) / (t_[k + 1] - t_[k]);
    return (1 - s) * value_[k] + s * value_[k + 1];
}

}  // namespace almesh
