// Formulas of a motion, such as "x + 0.1*sin(pi*y)": numbers, x, y, z, t, pi, + - * / ^, parentheses, functions; and
// conditions that select faces, such as "z > 0.99 and nz > 0.9".
#pragma once
#include <array>
#include <functional>
#include <string>
#include <string_view>

#include "base/small_matrix.hpp"

namespace almesh {

// What a formula may name: x, y, z, of a motion the time t, of a condition nx, ny, nz.
using FormulaPoint = std::array<double, 6>;

class Expression {
public:
    // Throws UsageError, without file and line, that names the column (from 1) and what was expected there.
    explicit Expression(std::string_view text);

    double operator()(const Vec<3>& x, double t = 0) const { return value_({x[0], x[1], x[2], t, 0, 0}); }
    const std::string& text() const { return text_; }
    bool names_point() const { return names_point_; }  // x, y or z
    bool names_time() const { return names_time_; }
    bool operator==(const Expression& other) const { return text_ == other.text_; }

private:
    std::string text_;
    bool names_point_ = false, names_time_ = false;
    std::function<double(const FormulaPoint&)> value_;
};

// Comparisons of formulas, < <= > >=, joined by `and` and `or`, of which `and` binds first.
class Condition {
public:
    explicit Condition(std::string_view text);  // throws as Expression does

    // At a point of a face with this unit normal.
    bool operator()(const Vec<3>& x, const Vec<3>& normal) const {
        return holds_({x[0], x[1], x[2], normal[0], normal[1], normal[2]});
    }

private:
    std::function<bool(const FormulaPoint&)> holds_;
};

}  // namespace almesh
