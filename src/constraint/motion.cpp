// The steps of a motion. Each kind of step is one row of the table `forms`: how it is written, what it takes, and how
// it moves a point. A step acts on d = x - c, c being its centre:
//
//   rotate      d -> d cos t + (u x d) sin t + u (u . d) (1 - cos t), u the unit axis (Rodrigues' formula)
//   projection  d -> d_axial + r d_radial / |d_radial|, the closest point at distance r from the centre or the axis
#include "constraint/motion_form.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

namespace almesh {
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

// Sine and cosine. Exactly 0 and +-1 at multiples of 90 degrees, so that a quarter turn leaves no 6e-17 behind.
std::pair<double, double> sine_cosine_of_degrees(double degrees) {
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
    const Vec<3> radial = d - axial;
    const double length = std::sqrt(dot(radial, radial));
    // Nearer than this, the direction is a rounding error of the point.
    if (!(length > 1e-12 * std::max(radius, std::sqrt(dot(d, d))))) return false;
    for (int i = 0; i < 3; ++i) d[i] = axial[i] + radius * (radial[i] / length);
    return true;
}

// Circle and sphere, centre and radius: the radius is the last number, as that of the cylinder.
bool project_from_centre(Step step, Vec<3>& d) { return project({}, step.numbers.back(), d); }

Vec<3> cylinder_axis(Step step) { return padded(std::span(step.numbers).subspan(3, 3)); }

const char* axis_fault(const Vec<3>& axis) { return axis == Vec<3>{} ? "the axis is zero" : ""; }

constexpr std::array<MotionForm, 14> forms = {{
    {.name = "fixed", .form = "fixed", .meaning = "the boundary stays as it is in the mesh file",
     .kind = NodeKind::fixed},
    {.name = "translate", .form = "translate DX DY [DZ]", .meaning = "shifts the boundary",
     .fewest = 2, .most = 3, .per_axis = true,
     .move = [](Step step, Vec<3>& d) {
         d = d + padded(step.numbers);
         return true;
     }},
    {.name = "rotate", .form = "rotate ANGLE [axis AX AY AZ] [about PX PY [PZ]]",
     .meaning = "turns it by degrees, right-handed; the axis in 3D only; default: about the origin",
     .fewest = 1, .most = 1, .axis = true, .about = true, .turns = true,
     .fault = [](Step step) { return step.axis.empty() ? "" : axis_fault(padded(step.axis)); },
     .move = [](Step step, Vec<3>& d) {
         rotate(step.axis.empty() ? Vec<3>{0, 0, 1} : unit(padded(step.axis)), step.numbers[0], d);
         return true;
     }},
    {.name = "twist", .form = "twist ANGLE-PER-LENGTH axis AX AY AZ [about PX PY PZ]",
     .meaning = "3D: turns each point by this angle in degrees times its distance along the axis from the origin, or "
                "from `about`; right-handed",
     .fewest = 1, .most = 1, .axis = true, .about = true, .twists = true, .affine = false,
     .fault = [](Step step) { return step.axis.empty() ? "it needs `axis`" : axis_fault(padded(step.axis)); },
     .move = [](Step step, Vec<3>& d) {
         const Vec<3> u = unit(padded(step.axis));
         rotate(u, step.numbers[0] * dot(u, d), d);
         return true;
     }},
    {.name = "expression", .form = "expression \"X\" \"Y\" [\"Z\"]",
     .meaning = "moves each point to these formulas of x, y, z, t: numbers, pi, + - * / ^, parentheses, sin cos tan "
                "asin acos atan sinh cosh tanh exp log sqrt abs, with two arguments atan2 min max hypot, and "
                "table(FILE) of rows `t value`",
     .formulas = true, .affine = false,
     .move = [](Step step, Vec<3>& d) {
         const Vec<3> x = d;
         for (std::size_t a = 0; a < step.formulas.size(); ++a) d[a] = step.formulas[a](x, step.t);
         return true;
     }},
    {.name = "file", .form = "file NAME [displacement] [else fixed|slide|free]",
     .meaning = "first step: the file has the positions (or displacements) of the boundary's nodes in rows "
                "`node-id x y [z]`, separated by blanks or commas; its path starts in the deck's folder; `-`: see the "
                "key frames. `else`: nodes that it leaves out stay where they are, slide along the boundary as the "
                "mesh has it, or are free",
     .file = true},
    {.name = "mesh", .form = "mesh NAME",
     .meaning = "first step: takes the positions from the nodes with the same ids in this mesh, such as the final.msh "
                "of another run; of degree 2 or more, the curved faces from those with the same vertices",
     .file = true, .mesh = true},
    {.name = "scale", .form = "scale S [about PX PY [PZ]]",
     .meaning = "scales it by one factor > 0, or by one per axis: SX SY [SZ]",
     .fewest = 1, .most = 3, .about = true, .per_axis = true,
     .fault = [](Step step) {
         const bool positive = *std::min_element(step.numbers.begin(), step.numbers.end()) > 0;
         return positive ? "" : "every factor must be > 0 (half a turn is `rotate 180`)";
     },
     .move = [](Step step, Vec<3>& d) {
         for (std::size_t i = 0; i < 3; ++i) d[i] *= step.numbers[std::min(i, step.numbers.size() - 1)];
         return true;
     }},
    {.name = "circle", .form = "circle CX CY R",
     .meaning = "2D: moves each point to the closest point of the circle",
     .fewest = 3, .most = 3, .affine = false, .projection_in = 2, .move = project_from_centre},
    {.name = "sphere", .form = "sphere CX CY CZ R",
     .meaning = "3D: moves each point to the closest point of the sphere",
     .fewest = 4, .most = 4, .affine = false, .projection_in = 3, .move = project_from_centre},
    {.name = "cylinder", .form = "cylinder PX PY PZ AX AY AZ R",
     .meaning = "3D: moves each point to the closest point of the cylinder about the axis through P along A",
     .fewest = 7, .most = 7, .affine = false, .projection_in = 3,
     .fault = [](Step step) { return axis_fault(cylinder_axis(step)); },
     .move = [](Step step, Vec<3>& d) {
         const Vec<3> u = unit(cylinder_axis(step));
         return project(dot(u, d) * u, step.numbers.back(), d);
     }},
    {.name = "slide", .form = "slide [along FILE [boundary NAME]]",
     .meaning = "last step: the nodes may move along the surface to which the steps before it take the boundary; with "
                "FILE along that mesh, STL or OBJ: its boundary NAME, else that of the same name, else its only one",
     .along = true, .kind = NodeKind::slides},
    {.name = "onto", .form = "onto FILE [boundary NAME]",
     .meaning = "draws the boundary onto a surface on which it does not lie yet, an STL, an OBJ or the boundary of a "
                "mesh, each node to a point of it; a step `file` before it has nodes whose positions are given",
     .along = true, .onto = true, .affine = false, .kind = NodeKind::slides},
    {.name = "free", .form = "free", .meaning = "the nodes may move anywhere", .kind = NodeKind::free},
}};

// Not among those that are written as text.
constexpr MotionForm by_function{.name = "position", .form = "position", .meaning = "", .turns = true, .affine = false,
                                 .move = [](Step step, Vec<3>& d) {
                                     d = (*step.position)(d, step.t);
                                     return true;
                                 }};

bool apply_step(Step step, Vec<3>& x) {
    const MotionForm& form = *step.form;
    if (!form.move) return true;
    const std::span numbers(step.numbers);
    const Vec<3> c = padded(form.projection_in ? numbers.first(form.projection_in) : std::span(step.about));
    Vec<3> d = x - c;
    if (!form.move(step, d)) return false;
    x = step.fraction < 1 ? x + step.fraction * (c + d - x) : c + d;
    return true;
}

}  // namespace

constinit const std::span<const MotionForm> form_table = forms;

bool apply(const Motion& motion, int dim, double* x) {
    Vec<3> y{};
    std::copy(x, x + dim, y.begin());
    for (const MotionStep& step : motion.steps)
        if (!apply_step(step, y)) return false;
    std::copy(y.begin(), y.begin() + dim, x);
    return true;
}

Motion at_fraction(Motion motion, double fraction) {
    for (MotionStep& step : motion.steps) {
        (step.form->turns || step.form->twists ? step.numbers[0] : step.fraction) *= fraction;
        if (step.position) step.t *= fraction;
    }
    return motion;
}

Motion given_by(PositionAt position, double t, double degrees) {
    MotionStep step;
    step.form = &by_function;
    step.numbers = {degrees};
    step.t = t;
    step.position = std::make_shared<const PositionAt>(std::move(position));
    return {{step}};
}

Motion given_by(std::vector<double> places) {
    MotionStep step;
    step.form = &*std::find_if(forms.begin(), forms.end(), [](const MotionForm& form) { return form.file; });
    step.places = std::make_shared<const std::vector<double>>(std::move(places));
    return {{step}};
}

Motion shortest(Motion motion) {
    for (MotionStep& step : motion.steps)
        if (step.form->turns) step.numbers[0] = std::remainder(step.numbers[0], 360.0);
    return motion;
}

double turn(const Motion& motion) {
    double degrees = 0;
    for (Step step : motion.steps)
        if (step.form->turns) degrees += std::abs(step.numbers[0]);
    return degrees;
}

bool leads_to(const Motion& before, const Motion& now, bool as_written) {
    constexpr double half = 180, most = 90, rounding = 1e-6;
    for (std::size_t k = 0; k < now.steps.size(); ++k) {
        if (!now.steps[k].form->turns) continue;
        const double from = before.steps[k].numbers[0], by = now.steps[k].numbers[0] - from;
        const double short_from = std::remainder(from, 2 * half), short_by = std::remainder(by, 2 * half);
        if (std::abs(as_written ? by : short_by) > most) return false;
        if (as_written) continue;
        if (std::abs(short_from) > half - rounding || std::abs(short_from + short_by) > half + rounding) return false;
    }
    return true;
}

bool is_affine(const Motion& motion) {
    return std::all_of(motion.steps.begin(), motion.steps.end(), [](Step step) { return step.form->affine; });
}

const MotionStep* file_step(const Motion& motion) {
    return motion.steps.front().form->file ? &motion.steps.front() : nullptr;
}

const MotionStep* surface_step(const Motion& motion) {
    const MotionStep& last = motion.steps.back();
    return last.form->along && !last.file.empty() ? &last : nullptr;
}

bool goes_onto(const Motion& motion) { return motion.steps.back().form->onto; }

bool is_of_mesh(const MotionStep& file_step) { return file_step.form->mesh; }

NodeKind kind_of(const Motion& motion) {
    if (goes_onto(motion) && file_step(motion)) return NodeKind::target;  // landmarks
    const NodeKind last = motion.steps.back().form->kind;
    return last == NodeKind::fixed && motion.steps.size() > 1 ? NodeKind::target : last;
}

Motion motion_of(NodeKind kind) {
    const auto is_of_kind = [kind](const MotionForm& form) { return form.kind == kind; };
    Motion motion;
    motion.steps.emplace_back().form = &*std::find_if(forms.begin(), forms.end(), is_of_kind);
    return motion;
}

NodeKind kind_of_rest(const Motion& motion) {
    const MotionForm* const rest = goes_onto(motion) ? motion.steps.back().form : motion.steps.front().rest;
    const bool leaves_open = rest && is_prescribed(kind_of(motion)) && !is_prescribed(rest->kind);
    return leaves_open ? rest->kind : kind_of(motion);
}

std::vector<Named> motion_forms() {
    std::vector<Named> rows;
    for (const MotionForm& form : forms) rows.push_back({form.form, form.meaning});
    return rows;
}

}  // namespace almesh
