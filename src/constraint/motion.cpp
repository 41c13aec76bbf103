#include "constraint/motion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "base/error.hpp"
#include "base/small_matrix.hpp"
#include "base/text.hpp"

namespace almesh {

namespace {

struct StepForm {
    MotionKind kind;
    const char* name;
    std::size_t fewest, most;  // numbers after the name
    bool axis, about;          // which clauses may follow
    const char* form;
    const char* meaning;
};

constexpr std::array<StepForm, 7> step_forms = {{
    {MotionKind::fixed, "fixed", 0, 0, false, false, "fixed", "stays where the mesh file has it"},
    {MotionKind::translate, "translate", 2, 3, false, false, "translate DX DY [DZ]", "shift"},
    {MotionKind::rotate, "rotate", 1, 1, true, true, "rotate ANGLE [axis AX AY AZ] [about PX PY [PZ]]",
     "degrees, right-handed; the axis in 3D only; about the origin if not said"},
    {MotionKind::scale, "scale", 1, 3, false, true, "scale S [about PX PY [PZ]]",
     "one factor > 0, or one per axis: SX SY [SZ]"},
    {MotionKind::circle, "circle", 3, 3, false, false, "circle CX CY R", "2D: to the closest point of the circle"},
    {MotionKind::sphere, "sphere", 4, 4, false, false, "sphere CX CY CZ R", "3D: to the closest point of the sphere"},
    {MotionKind::cylinder, "cylinder", 7, 7, false, false, "cylinder PX PY PZ AX AY AZ R",
     "3D: to the closest point at distance R from the axis through P along A"},
}};

const StepForm& form_of(MotionKind kind) { return step_forms[static_cast<std::size_t>(kind)]; }

const StepForm& find_form(std::string_view name) {
    std::vector<std::string> names;
    for (const StepForm& form : step_forms) {
        if (name == form.name) return form;
        names.push_back(form.name);
    }
    throw UsageError("unknown motion " + in_backquotes(name) + ": did you mean " + in_backquotes(nearest(name, names)) +
                     "?");
}

[[noreturn]] void refuse(const StepForm& form, const std::string& why) {
    throw UsageError(in_backquotes(form.name) + ": " + why + "; expected " + form.form);
}

// The numbers of a step, by the clause they stand in.
struct Numbers {
    std::vector<double> plain, axis, about;
};

Numbers read_numbers(const StepForm& form, const std::vector<std::string_view>& text) {
    Numbers numbers;
    std::vector<double>* clause = &numbers.plain;
    for (std::size_t i = 1; i < text.size(); ++i) {
        const bool axis = form.axis && text[i] == "axis", about = form.about && text[i] == "about";
        if (axis || about) {
            clause = axis ? &numbers.axis : &numbers.about;
            const bool empty = i + 1 == text.size() || !parse_double(text[i + 1]);
            if (!clause->empty() || empty)
                refuse(form, in_backquotes(text[i]) + (empty ? " needs numbers" : " stands twice"));
            continue;
        }
        const auto number = parse_double(text[i]);
        if (!number) refuse(form, in_backquotes(text[i]) + " is not a number (separate numbers by blanks)");
        clause->push_back(*number);
    }
    return numbers;
}

void check_counts(const StepForm& form, const Numbers& numbers) {
    const std::size_t count = numbers.plain.size();
    if (count < form.fewest || count > form.most)
        refuse(form, std::to_string(count) + (count == 1 ? " number" : " numbers"));
    if (!numbers.axis.empty() && numbers.axis.size() != 3) refuse(form, "`axis` needs 3 numbers");
    if (!numbers.about.empty() && numbers.about.size() != 2 && numbers.about.size() != 3)
        refuse(form, "`about` needs 2 numbers, or 3 in 3D");
}

void check_values(const StepForm& form, const MotionStep& step) {
    const auto zero = [](double v) { return v == 0; };
    const auto positive = [](double v) { return v > 0; };
    const bool has_axis =
        form.kind == MotionKind::cylinder || (form.kind == MotionKind::rotate && !step.vector.empty());
    if (has_axis && std::all_of(step.vector.begin(), step.vector.end(), zero)) refuse(form, "the axis is zero");
    if (form.kind >= MotionKind::circle && step.amount <= 0) refuse(form, "the radius must be > 0");
    if (form.kind == MotionKind::scale && !std::all_of(step.vector.begin(), step.vector.end(), positive))
        refuse(form, "every factor must be > 0 (half a turn is `rotate 180`)");
}

MotionStep parse_step(std::string_view text) {
    const auto text_words = words(text);
    if (text_words.empty()) throw UsageError("a step of the motion is empty: put a step on both sides of every `;`");
    const StepForm& form = find_form(text_words[0]);
    Numbers numbers = read_numbers(form, text_words);
    check_counts(form, numbers);

    MotionStep step;
    step.kind = form.kind;
    const auto& plain = numbers.plain;
    switch (form.kind) {
        case MotionKind::fixed: break;
        case MotionKind::translate: step.vector = plain; break;
        case MotionKind::scale:
            step.vector = plain;
            step.point = std::move(numbers.about);
            break;
        case MotionKind::rotate:
            step.amount = plain[0];
            step.vector = std::move(numbers.axis);
            step.point = std::move(numbers.about);
            break;
        case MotionKind::circle:
        case MotionKind::sphere:
            step.point.assign(plain.begin(), plain.end() - 1);
            step.amount = plain.back();
            break;
        case MotionKind::cylinder:
            step.point.assign(plain.begin(), plain.begin() + 3);
            step.vector.assign(plain.begin() + 3, plain.begin() + 6);
            step.amount = plain[6];
            break;
    }
    check_values(form, step);
    return step;
}

std::string to_string(const std::vector<double>& numbers) {
    std::string text;
    for (double v : numbers) text += ' ' + to_text(v);
    return text;
}

std::string to_string(const MotionStep& step) {
    const std::string amount = ' ' + to_text(step.amount), vector = to_string(step.vector),
                      point = to_string(step.point);
    const std::string about = point.empty() ? "" : " about" + point;
    const std::string name = form_of(step.kind).name;
    switch (step.kind) {
        case MotionKind::fixed: return name;
        case MotionKind::translate: return name + vector;
        case MotionKind::rotate: return name + amount + (vector.empty() ? "" : " axis" + vector) + about;
        case MotionKind::scale: return name + vector + about;
        case MotionKind::circle:
        case MotionKind::sphere:
        case MotionKind::cylinder: break;
    }
    return name + point + vector + amount;
}

// Why the step cannot act in `dim` dimensions; "" where it can.
std::string misfit(const MotionStep& step, int dim) {
    const std::size_t n = static_cast<std::size_t>(dim);
    const std::string mesh = std::to_string(dim) + "D", step_text = in_backquotes(to_string(step));
    if (step.kind == MotionKind::circle && dim != 2)
        return step_text + " does not act in " + mesh + ": use a sphere or a cylinder";
    const bool spatial = step.kind == MotionKind::sphere || step.kind == MotionKind::cylinder;
    if (spatial && dim != 3) return step_text + " does not act in " + mesh + ": use a circle";
    if (step.kind == MotionKind::rotate && (step.vector.size() == 3) != (dim == 3))
        return step_text + (dim == 3 ? " needs `axis AX AY AZ` in " : " must not have an axis in ") + mesh;
    if (step.kind == MotionKind::translate && step.vector.size() != n)
        return step_text + " needs " + std::to_string(dim) + " components in " + mesh;
    if (step.kind == MotionKind::scale && step.vector.size() != 1 && step.vector.size() != n)
        return step_text + " needs one factor or " + std::to_string(dim) + " in " + mesh;
    if (!step.point.empty() && step.point.size() != n)
        return step_text + " needs " + std::to_string(dim) + " numbers after `about` in " + mesh;
    return "";
}

std::string misfit(const Motion& motion, int dim) {
    for (const MotionStep& step : motion.steps)
        if (const std::string why = misfit(step, dim); !why.empty()) return why;
    return "";
}

Vec<3> padded(const std::vector<double>& v) {
    Vec<3> result{};
    std::copy(v.begin(), v.end(), result.begin());
    return result;
}

double dot(const Vec<3>& a, const Vec<3>& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

// v is not zero. Scaled first, so that no length overflows.
Vec<3> unit(const Vec<3>& v) {
    const double largest = std::max({std::abs(v[0]), std::abs(v[1]), std::abs(v[2])});
    const Vec<3> w = {v[0] / largest, v[1] / largest, v[2] / largest};
    const double length = std::sqrt(dot(w, w));
    return {w[0] / length, w[1] / length, w[2] / length};
}

struct SineCosine {
    double sine, cosine;
};

// Exactly 0 and +-1 at multiples of 90 degrees, so that a quarter turn leaves no 6e-17 behind.
SineCosine sine_cosine_of_degrees(double degrees) {
    int quarters = 0;
    const double rest = std::remquo(degrees, 90.0, &quarters) * (std::numbers::pi / 180);
    const double s = std::sin(rest), c = std::cos(rest);
    switch (quarters & 3) {
        case 1: return {c, -s};
        case 2: return {-s, -c};
        case 3: return {-c, s};
        default: return {s, c};
    }
}

// d -> d cos + (u x d) sin + u (u . d) (1 - cos), u the unit axis (Rodrigues); in 2D u is the normal of the plane.
void rotate(const MotionStep& step, Vec<3>& d) {
    const Vec<3> u = step.vector.empty() ? Vec<3>{0, 0, 1} : unit(padded(step.vector));
    const auto [s, c] = sine_cosine_of_degrees(step.amount);
    const Vec<3> cross = {u[1] * d[2] - u[2] * d[1], u[2] * d[0] - u[0] * d[2], u[0] * d[1] - u[1] * d[0]};
    const double along = dot(u, d) * (1 - c);
    for (int i = 0; i < 3; ++i) d[i] = d[i] * c + cross[i] * s + u[i] * along;
}

// Splits d into its part along the axis (none for circle and sphere) and the rest, which gets the length of the radius.
bool project(const MotionStep& step, Vec<3>& d) {
    Vec<3> axial{};
    if (!step.vector.empty()) {
        const Vec<3> u = unit(padded(step.vector));
        const double along = dot(u, d);
        for (int i = 0; i < 3; ++i) axial[i] = along * u[i];
    }
    const Vec<3> radial = {d[0] - axial[0], d[1] - axial[1], d[2] - axial[2]};
    const double length = std::hypot(radial[0], radial[1], radial[2]);
    // Nearer than this, the direction is a rounding error of the point.
    if (!(length > 1e-12 * std::max(step.amount, std::hypot(d[0], d[1], d[2])))) return false;
    for (int i = 0; i < 3; ++i) d[i] = axial[i] + step.amount * (radial[i] / length);
    return true;
}

bool apply_step(const MotionStep& step, Vec<3>& x) {
    const Vec<3> origin = padded(step.point);
    Vec<3> d = {x[0] - origin[0], x[1] - origin[1], x[2] - origin[2]};
    switch (step.kind) {
        case MotionKind::fixed: return true;
        case MotionKind::translate:
            for (std::size_t i = 0; i < step.vector.size(); ++i) d[i] += step.vector[i];
            break;
        case MotionKind::rotate: rotate(step, d); break;
        case MotionKind::scale:
            for (std::size_t i = 0; i < 3; ++i) d[i] *= step.vector[std::min(i, step.vector.size() - 1)];
            break;
        case MotionKind::circle:
        case MotionKind::sphere:
        case MotionKind::cylinder:
            if (!project(step, d)) return false;
            break;
    }
    for (int i = 0; i < 3; ++i) x[i] = origin[i] + d[i];
    return true;
}

}  // namespace

Motion parse_motion(std::string_view text) {
    Motion motion;
    for (const std::string_view piece : split(text, ';')) motion.steps.push_back(parse_step(piece));
    const auto is_fixed = [](const MotionStep& step) { return step.kind == MotionKind::fixed; };
    if (motion.steps.size() > 1 && std::any_of(motion.steps.begin(), motion.steps.end(), is_fixed))
        throw UsageError("`fixed` beside other steps: a fixed boundary does not move, remove one or the other");
    const std::string in_2d = misfit(motion, 2), in_3d = misfit(motion, 3);
    if (!in_2d.empty() && !in_3d.empty()) throw UsageError("fits no dimension: " + in_2d + "; " + in_3d);
    return motion;
}

void check_dimension(const Motion& motion, int dim) {
    if (const std::string why = misfit(motion, dim); !why.empty()) throw UsageError(why);
}

bool apply(const Motion& motion, int dim, double* x) {
    Vec<3> y{};
    std::copy(x, x + dim, y.begin());
    for (const MotionStep& step : motion.steps)
        if (!apply_step(step, y)) return false;
    std::copy(y.begin(), y.begin() + dim, x);
    return true;
}

bool is_affine(const Motion& motion) {
    return std::none_of(motion.steps.begin(), motion.steps.end(), [](const MotionStep& step) {
        return step.kind == MotionKind::circle || step.kind == MotionKind::sphere || step.kind == MotionKind::cylinder;
    });
}

std::string to_string(const Motion& motion) {
    std::string text;
    for (const MotionStep& step : motion.steps) text += (text.empty() ? "" : "; ") + to_string(step);
    return text;
}

std::string motion_forms() {
    std::string text;
    for (const StepForm& form : step_forms) text += table_row({form.form, form.meaning}, {50, 50});
    return text;
}

}  // namespace almesh
