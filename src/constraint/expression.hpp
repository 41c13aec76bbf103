// Formulas of a motion, such as "x + 0.1*sin(pi*y)": numbers, x, y, z, t, pi, + - * / ^, parentheses, functions, the
// deck's constants; and conditions that select faces, such as "z > 0.99 and nz > 0.9".
#pragma once
#include <array>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "base/small_matrix.hpp"

namespace almesh {

// What a formula may name: x, y, z, of a motion the time t, of a condition nx, ny, nz.
using FormulaPoint = std::array<double, 6>;

// A number with a name, which formulas may use: `let height = 0.3`.
struct Constant {
    std::string name, text;  // text: as written, a formula of the constants before it
    std::string where;       // "circle.deck:12" or "command line"
    double value = 0;
};

using Constants = std::vector<Constant>;

// Throws UsageError for a name that is no word of letters, digits and _, or has a meaning in formulas already.
void check_constant_name(std::string_view name);

class Expression {
public:
    // Throws UsageError, without file and line, that names the column (from 1) and what was expected there.
    explicit Expression(std::string_view text, const Constants& constants = {});

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
    explicit Condition(std::string_view text, const Constants& constants = {});  // throws as Expression does

    // At a point of a face with this unit normal.
    bool operator()(const Vec<3>& x, const Vec<3>& normal) const {
        return holds_({x[0], x[1], x[2], normal[0], normal[1], normal[2]});
    }

private:
    std::function<bool(const FormulaPoint&)> holds_;
};

}  // namespace almesh
