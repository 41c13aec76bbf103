// The steps of a motion. Each kind of step is one row of the table `forms`: how it is written, what its numbers mean,
// which dimensions it fits, and how it moves a point. A step acts on d = x - c, c being its centre:
//
//   rotate      d -> d cos t + (u x d) sin t + u (u . d) (1 - cos t), u the unit axis (Rodrigues' formula)
//   projection  d -> d_axial + r d_radial / |d_radial|, the closest point at distance r from the centre or the axis
#include "constraint/motion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>

#include "base/error.hpp"
#include "base/small_matrix.hpp"
#include "base/text.hpp"

namespace almesh {

struct MotionForm {
    const char* name;
    const char* form;  // as it is written
    const char* meaning;
    std::size_t fewest = 0, most = 0;  // numbers after the name
    bool axis = false, about = false;  // whether these clauses may follow
    std::size_t centre = 0;            // so many leading numbers are the centre; 0: `about`, or else the origin
    bool affine = true;
    // Why its numbers make no sense, whatever the dimension; "" where they do.
    const char* (*fault)(const MotionStep&) = [](const MotionStep&) { return ""; };
    // Why it does not fit `dim` dimensions, to stand after the text of the step; "" where it does.
    std::string (*misfit)(const MotionStep&, int dim) = [](const MotionStep&, int) { return std::string(); };
    // Moves a point given relative to the centre; false where its image is undefined. nullptr: every point stays.
    bool (*move)(const MotionStep&, Vec<3>& d) = nullptr;
};

namespace {

Vec<3> padded(std::span<const double> v) {
    Vec<3> result{};
    std::copy(v.begin(), v.end(), result.begin());
    return result;
}

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

// About the unit axis u.
void rotate(const Vec<3>& u, double degrees, Vec<3>& d) {
    const auto [s, c] = sine_cosine_of_degrees(degrees);
    const Vec<3> normal = cross(u, d);
    const double along = dot(u, d) * (1 - c);
    for (int i = 0; i < 3; ++i) d[i] = d[i] * c + normal[i] * s + u[i] * along;
}

// Gives the part of d other than `axial` the length `radius`.
bool project(const Vec<3>& axial, double radius, Vec<3>& d) {
    const Vec<3> radial = {d[0] - axial[0], d[1] - axial[1], d[2] - axial[2]};
    const double length = std::hypot(radial[0], radial[1], radial[2]);
    // Nearer than this, the direction is a rounding error of the point.
    if (!(length > 1e-12 * std::max(radius, std::hypot(d[0], d[1], d[2])))) return false;
    for (int i = 0; i < 3; ++i) d[i] = axial[i] + radius * (radial[i] / length);
    return true;
}

// Circle and sphere, centre and radius: the radius is the last number, as that of the cylinder.
bool project_from_centre(const MotionStep& step, Vec<3>& d) { return project({}, step.numbers.back(), d); }

const char* radius_fault(const MotionStep& step) { return step.numbers.back() > 0 ? "" : "the radius must be > 0"; }

const char* axis_fault(std::span<const double> axis) {
    return padded(axis) == Vec<3>{} ? "the axis is zero" : "";
}

std::string in_dimensions(int dim) { return " in " + std::to_string(dim) + "D"; }

std::string planar_only(const MotionStep&, int dim) {
    return dim == 2 ? "" : " does not act" + in_dimensions(dim) + ": use a sphere or a cylinder";
}

std::string spatial_only(const MotionStep&, int dim) {
    return dim == 3 ? "" : " does not act" + in_dimensions(dim) + ": use a circle";
}

constexpr std::array<MotionForm, 7> forms = {{
    {.name = "fixed", .form = "fixed", .meaning = "stays where the mesh file has it"},

    {.name = "translate", .form = "translate DX DY [DZ]", .meaning = "shift", .fewest = 2, .most = 3,
     .misfit = [](const MotionStep& step, int dim) -> std::string {
         if (static_cast<int>(step.numbers.size()) == dim) return "";
         return " needs " + std::to_string(dim) + " components" + in_dimensions(dim);
     },
     .move = [](const MotionStep& step, Vec<3>& d) {
         for (std::size_t i = 0; i < step.numbers.size(); ++i) d[i] += step.numbers[i];
         return true;
     }},

    {.name = "rotate", .form = "rotate ANGLE [axis AX AY AZ] [about PX PY [PZ]]",
     .meaning = "degrees, right-handed; the axis in 3D only; about the origin if not said",
     .fewest = 1, .most = 1, .axis = true, .about = true,
     .fault = [](const MotionStep& step) { return step.axis.empty() ? "" : axis_fault(step.axis); },
     .misfit = [](const MotionStep& step, int dim) -> std::string {
         if (step.axis.empty() == (dim == 2)) return "";
         return (dim == 3 ? " needs `axis AX AY AZ`" : " must not have an axis") + in_dimensions(dim);
     },
     .move = [](const MotionStep& step, Vec<3>& d) {
         rotate(step.axis.empty() ? Vec<3>{0, 0, 1} : unit(padded(step.axis)), step.numbers[0], d);
         return true;
     }},

    {.name = "scale", .form = "scale S [about PX PY [PZ]]",
     .meaning = "one factor > 0, or one per axis: SX SY [SZ]", .fewest = 1, .most = 3, .about = true,
     .fault = [](const MotionStep& step) {
         const bool positive = *std::min_element(step.numbers.begin(), step.numbers.end()) > 0;
         return positive ? "" : "every factor must be > 0 (half a turn is `rotate 180`)";
     },
     .misfit = [](const MotionStep& step, int dim) -> std::string {
         if (step.numbers.size() == 1 || static_cast<int>(step.numbers.size()) == dim) return "";
         return " needs one factor or " + std::to_string(dim) + in_dimensions(dim);
     },
     .move = [](const MotionStep& step, Vec<3>& d) {
         for (std::size_t i = 0; i < 3; ++i) d[i] *= step.numbers[std::min(i, step.numbers.size() - 1)];
         return true;
     }},

    {.name = "circle", .form = "circle CX CY R", .meaning = "2D: to the closest point of the circle",
     .fewest = 3, .most = 3, .centre = 2, .affine = false,
     .fault = radius_fault, .misfit = planar_only, .move = project_from_centre},

    {.name = "sphere", .form = "sphere CX CY CZ R", .meaning = "3D: to the closest point of the sphere",
     .fewest = 4, .most = 4, .centre = 3, .affine = false,
     .fault = radius_fault, .misfit = spatial_only, .move = project_from_centre},

    {.name = "cylinder", .form = "cylinder PX PY PZ AX AY AZ R",
     .meaning = "3D: to the closest point at distance R from the axis through P along A",
     .fewest = 7, .most = 7, .centre = 3, .affine = false,
     .fault = [](const MotionStep& step) {
         const char* const axis = axis_fault(std::span(step.numbers).subspan(3, 3));
         return *axis ? axis : radius_fault(step);
     },
     .misfit = spatial_only,
     .move = [](const MotionStep& step, Vec<3>& d) {
         const Vec<3> u = unit(padded(std::span(step.numbers).subspan(3, 3)));
         const double along = dot(u, d);
         return project({along * u[0], along * u[1], along * u[2]}, step.numbers.back(), d);
     }},
}};

const MotionForm& find_form(std::string_view name) {
    std::vector<std::string> names;
    for (const MotionForm& form : forms) {
        if (name == form.name) return form;
        names.push_back(form.name);
    }
    throw UsageError("unknown motion " + in_backquotes(name) + did_you_mean(name, names));
}

[[noreturn]] void refuse(const MotionForm& form, const std::string& why) {
    throw UsageError(in_backquotes(form.name) + ": " + why + "; expected " + form.form);
}

void check_counts(const MotionForm& form, const MotionStep& step) {
    const std::size_t count = step.numbers.size();
    if (count < form.fewest || count > form.most)
        refuse(form, std::to_string(count) + (count == 1 ? " number" : " numbers"));
    if (!step.axis.empty() && step.axis.size() != 3) refuse(form, "`axis` needs 3 numbers");
    if (!step.about.empty() && step.about.size() != 2 && step.about.size() != 3)
        refuse(form, "`about` needs 2 numbers, or 3 in 3D");
}

MotionStep parse_step(std::string_view text) {
    const auto written = words(text);
    if (written.empty()) throw UsageError("a step of the motion is empty: put a step on both sides of every `;`");
    const MotionForm& form = find_form(written[0]);
    MotionStep step{&form, {}, {}, {}};
    std::vector<double>* clause = &step.numbers;
    for (std::size_t i = 1; i < written.size(); ++i) {
        const auto number = parse_double(written[i]);
        const bool axis = form.axis && written[i] == "axis", about = form.about && written[i] == "about";
        if (number) {
            clause->push_back(*number);
        } else if (axis || about) {
            clause = axis ? &step.axis : &step.about;
            const bool empty = i + 1 == written.size() || !parse_double(written[i + 1]);
            if (empty) refuse(form, in_backquotes(written[i]) + " needs numbers");
            if (!clause->empty()) refuse(form, in_backquotes(written[i]) + " stands twice");
        } else {
            refuse(form, in_backquotes(written[i]) + " is not a number (separate numbers by blanks)");
        }
    }
    check_counts(form, step);
    if (const std::string why = form.fault(step); !why.empty()) refuse(form, why);
    return step;
}

std::string to_string(const std::vector<double>& numbers) {
    std::string text;
    for (double v : numbers) text += ' ' + to_text(v);
    return text;
}

std::string to_string(const MotionStep& step) {
    std::string text = step.form->name + to_string(step.numbers);
    if (!step.axis.empty()) text += " axis" + to_string(step.axis);
    if (!step.about.empty()) text += " about" + to_string(step.about);
    return text;
}

// Why the first step that does not fit `dim` dimensions does not; "" where all do.
std::string misfit(const Motion& motion, int dim) {
    for (const MotionStep& step : motion.steps) {
        std::string why = step.form->misfit(step, dim);
        if (why.empty() && !step.about.empty() && static_cast<int>(step.about.size()) != dim)
            why = " needs " + std::to_string(dim) + " numbers after `about`" + in_dimensions(dim);
        if (!why.empty()) return in_backquotes(to_string(step)) + why;
    }
    return "";
}

bool apply_step(const MotionStep& step, Vec<3>& x) {
    const MotionForm& form = *step.form;
    if (!form.move) return true;
    const Vec<3> c = form.centre > 0 ? padded(std::span(step.numbers).first(form.centre)) : padded(step.about);
    Vec<3> d = {x[0] - c[0], x[1] - c[1], x[2] - c[2]};
    if (!form.move(step, d)) return false;
    for (int i = 0; i < 3; ++i) x[i] = c[i] + d[i];
    return true;
}

}  // namespace

Motion parse_motion(std::string_view text) {
    Motion motion;
    for (const std::string_view piece : split(text, ';')) motion.steps.push_back(parse_step(piece));
    const auto is_fixed = [](const MotionStep& step) { return !step.form->move; };
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
    return std::all_of(motion.steps.begin(), motion.steps.end(), [](const MotionStep& s) { return s.form->affine; });
}

std::string to_string(const Motion& motion) {
    std::string text;
    for (const MotionStep& step : motion.steps) text += (text.empty() ? "" : "; ") + to_string(step);
    return text;
}

std::string motion_forms() {
    std::string text;
    for (const MotionForm& form : forms) text += table_row({form.form, form.meaning}, {50, 50});
    return text;
}

}  // namespace almesh
