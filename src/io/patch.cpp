#include "io/patch.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "base/bytes.hpp"
#include "base/decimal.hpp"
#include "base/files.hpp"
#include "base/index.hpp"
#include "base/text.hpp"

namespace almesh {
namespace {

// The number that a text holds between blanks, also with a plus sign.
double number_in(std::string_view text) {
    text.remove_prefix(std::min(text.find_first_not_of(" \t+"), text.size()));
    double value = 0;
    read_double(text.data(), text.data() + text.size(), value);
    return value;
}

// In columns, where a number without a point could be read as one with digits behind it, there is always one.
std::string in_columns(double value, int width) {
    std::string text;
    append(text, value);
    for (int digits = 17;; --digits) {
        const std::size_t exponent = std::min(text.find('e'), text.size());
        if (text.find('.') == text.npos) text.insert(exponent, 1, '.');
        std::replace(text.begin(), text.end(), 'e', 'E');
        const auto size = static_cast<int>(text.size());
        if (size <= width || digits == 0) return std::string(std::max(width - size, 0), ' ') + text;
        text.clear();
        append(text, value, digits);
    }
}

std::string in_text(double value, const CoordinateFields& fields) {
    if (fields.width > 0) return in_columns(value, fields.width);
    std::string text;
    append(text, value);
    if (fields.most == 0 || static_cast<int>(text.size()) <= fields.most) return text;
    return std::string(trim(in_columns(value, fields.most)));
}

struct Patch {
    std::string_view file;
    const CoordinateFields& fields;
    const std::vector<double>& x;

    std::size_t end_of(std::size_t first) const {
        if (fields.form == CoordinateFields::Form::float64) return first + sizeof(double);
        if (fields.form == CoordinateFields::Form::float32) return first + sizeof(float);
        if (fields.width > 0) return std::min({first + fields.width, file.find_first_of("\r\n", first), file.size()});
        return std::min(file.find_first_of(" \t\r\n,;()[]{}<>\"", first), file.size());
    }

    void append_number(std::string& text, std::size_t k) const {
        const std::size_t first = fields.first[k];
        if (fields.form == CoordinateFields::Form::float64) return append_bytes(text, x[k], fields.order);
        if (fields.form == CoordinateFields::Form::float32)
            return append_bytes(text, static_cast<float>(x[k]), fields.order);
        const std::string_view here = file.substr(first, end_of(first) - first);
        if (number_in(here) == x[k]) text += here;
        else text += in_text(x[k], fields);
    }
};

}  // namespace

std::string patched(std::string_view file, const CoordinateFields& fields, const std::vector<double>& x) {
    if (fields.rewritten) return fields.rewritten(file, fields, x);
    std::vector<std::size_t> order(fields.first.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    const auto is_before = [&](std::size_t k, std::size_t l) { return fields.first[k] < fields.first[l]; };
    if (!std::is_sorted(order.begin(), order.end(), is_before)) std::sort(order.begin(), order.end(), is_before);
    const Patch patch{file, fields, x};
    std::string text;
    append_rows([&](std::string_view part) { text += part; }, static_cast<int>(order.size()),
                [&](std::string& part, int i) {
                    const std::size_t begin = i == 0 ? 0 : patch.end_of(fields.first[order[i - 1]]);
                    part += file.substr(begin, fields.first[order[i]] - begin);
                    patch.append_number(part, order[i]);
                });
    if (!order.empty()) text += file.substr(patch.end_of(fields.first[order.back()]));
    return text;
}

std::vector<double> rounded_as(const CoordinateFields& fields, std::vector<double> x) {
    for (std::size_t k = 0; k < fields.first.size() && rounds(fields); ++k)
        x[k] = fields.form == CoordinateFields::Form::text ? number_in(in_text(x[k], fields))
                                                           : static_cast<float>(x[k]);
    return x;
}

std::vector<double> read_back(const FileTags& file, std::vector<double> x) {
    const int dim = file.coordinates.dim;
    x = rounded_as(file.coordinates, std::move(x));
    for (const ImpliedNode& implied : file.implied)
        for (int a = 0; a < dim; ++a) {
            double sum = 0;
            for (const auto& [node, weight] : implied.terms) sum += weight * x[offset(node, dim, a)];
            x[offset(implied.node, dim, a)] = sum;
        }
    return x;
}

}  // namespace almesh
