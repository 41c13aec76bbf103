// Formulas of a motion, such as "x + 0.1*sin(pi*y)": numbers, x, y, z, pi, + - * / ^, parentheses and functions.
#pragma once
#include <functional>
#include <string>
#include <string_view>

#include "base/small_matrix.hpp"

namespace almesh {

class Expression {
public:
    // Throws UsageError, without file and line, that names the column (from 1) and what was expected there.
    explicit Expression(std::string_view text);

    double operator()(const Vec<3>& x) const { return value_(x); }
    const std::string& text() const { return text_; }
    bool operator==(const Expression& other) const { return text_ == other.text_; }

private:
    std::string text_;
    std::function<double(const Vec<3>&)> value_;
};

}  // namespace almesh
