// The steps of a motion. Each kind of step is one row of the table `forms`: how it is written, what it takes, and how
// it moves a point. A step acts on d = x - c, c being its centre:
//
//   rotate      d -> d cos t + (u x d) sin t + u (u . d) (1 - cos t), u the unit axis (Rodrigues' formula)
//   projection  d -> d_axial + r d_radial / |d_radial|, the closest point at distance r from the centre or the axis
#include "constraint/motion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>
#include <utility>

#include "base/error.hpp"
#include "base/small_matrix.hpp"

namespace almesh {

struct MotionForm {
    const char* name;
    const char* form;  // as it is written
    const char* meaning;
    std::size_t fewest = 0, most = 0;  // numbers after the name
    bool axis = false, about = false;  // whether these clauses may follow
    bool per_axis = false;             // its numbers are one for each axis, or a single one where that is allowed
    bool turns = false;                // its first number is an angle in degrees
    bool twists = false;               // its first number is a rate, a part of which is a part of the motion
    bool file = false;                 // the name of a file comes first
    bool mesh = false;                 // which is a mesh
    bool along = false;                // a mesh and one of its boundaries may be named
    bool formulas = false;             // formulas in double quotes, one for each axis, in place of numbers
    bool affine = true;                // false: targets are projected onto the trace space, not interpolated
    int projection_in = 0;             // the dimension a projection acts in; so many leading numbers are its centre
    BoundaryHold hold = BoundaryHold::prescribed;  // by the last step of a motion
    // Why its numbers make no sense, whatever the dimension; "" where they do.
    const char* (*fault)(const MotionStep&) = [](const MotionStep&) { return ""; };
    // Moves a point given relative to the centre; false where its image is undefined. nullptr: every point stays.
    bool (*move)(const MotionStep&, Vec<3>& d) = nullptr;
};

namespace {

using Step = const MotionStep&;

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

constexpr std::array<MotionForm, 13> forms = {{
    {.name = "fixed", .form = "fixed", .meaning = "the boundary stays as it is in the mesh file"},
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
     .meaning = "last step: the nodes may move along the surface to which the steps before it take the boundary. With "
                "FILE: along the boundary NAME of that mesh, else the one of the same name, else its only one",
     .along = true, .hold = BoundaryHold::slides},
    {.name = "free", .form = "free", .meaning = "the nodes may move anywhere", .hold = BoundaryHold::free},
}};

template <class... Parts>
[[noreturn]] void refuse(const MotionForm& form, const Parts&... why) {
    throw UsageError(in_backquotes(form.name), ": ", why..., "; expected ", form.form);
}

void check(const MotionForm& form, Step step) {
    const std::size_t count = step.numbers.size();
    if (count < form.fewest || count > form.most) refuse(form, counted(count, "number"));
    if (form.formulas && step.formulas.size() != 2 && step.formulas.size() != 3)
        refuse(form, counted(step.formulas.size(), "formula"), " in double quotes");
    if (form.file && step.file.empty()) refuse(form, "the name of the file is missing");
    if (!step.axis.empty() && step.axis.size() != 3) refuse(form, "`axis` needs 3 numbers");
    if (!step.about.empty() && step.about.size() != 2 && step.about.size() != 3)
        refuse(form, "`about` needs 2 numbers, or 3 in 3D");
}

// Of its numbers, which may be known only with the time.
void check_numbers(const MotionForm& form, Step step) {
    if (const std::string why = form.fault(step); !why.empty()) refuse(form, why);
    if (form.projection_in && step.numbers.back() <= 0) refuse(form, "the radius must be > 0");
}

bool depends_on_time(Step step) {
    const auto names_time = [](const Expression& formula) { return formula.names_time(); };
    return std::any_of(step.formulas.begin(), step.formulas.end(), names_time) ||
           std::any_of(step.timed.begin(), step.timed.end(), [](const auto& n) { return n.formula.names_time(); });
}

TimedNumber timed_number(const MotionForm& form, int clause, std::size_t place, std::string_view text,
                         const Constants& constants) {
    Expression formula(text, constants);
    if (formula.names_point())
        refuse(form, "the formula ", with_quotes(text), " of a number may name t and constants alone");
    return {clause, place, std::move(formula)};
}

// At t = 0, until the time is known; 0 where a table does not have it.
double at_start(const Expression& formula) {
    try {
        return formula({});
    } catch (const UsageError&) {
        return 0;
    }
}

// A file's name with the number in place of %d, or of %0Nd with at least N digits.
std::string numbered(const std::string& name, int number) {
    const std::size_t at = name.find('%'), end = at == std::string::npos ? at : name.find('d', at);
    if (end == std::string::npos) return name;
    const std::string width = name.substr(at + 1, end - at - 1), digits = std::to_string(number);
    const auto least = width.empty() ? std::optional<int>(0) : parse_int(width, 0, 20);
    if (!least) return name;
    const std::size_t zeros = digits.size() < std::size_t(*least) ? *least - digits.size() : 0;
    return name.substr(0, at) + std::string(zeros, '0') + digits + name.substr(end + 1);
}

// Words, and texts in double quotes with their quotes.
std::vector<std::string_view> quoted_words(std::string_view text) {
    std::vector<std::string_view> result;
    for (text = trim(text); !text.empty(); text = trim(text)) {
        const std::size_t close = text[0] == '"' ? closing_quote(text) : std::string_view::npos;
        const std::size_t end = std::min(close == std::string_view::npos ? text.find_first_of(" \t") : close + 1,
                                         text.size());
        result.push_back(text.substr(0, end));
        text.remove_prefix(end);
    }
    return result;
}

MotionStep parse_step(std::string_view text, const Constants& constants) {
    const auto written = quoted_words(text);
    if (written.empty()) throw UsageError("a step of the motion is empty: put a step on both sides of every `;`");
    const MotionForm* const found = find_row(forms, written[0]);
    if (!found)
        throw UsageError("unknown motion ", in_backquotes(written[0]), did_you_mean(written[0], names_of(forms)),
                         " All motions: almesh --keys");
    const MotionForm& form = *found;
    MotionStep step;
    step.form = &form;
    const auto clause_of = [&step](int k) { return std::array{&step.numbers, &step.axis, &step.about}[k]; };
    const auto is_formula = [&](std::string_view word) {
        return word.starts_with('"') || find_row(constants, word);
    };
    int clause = 0;
    for (std::size_t i = 1; i < written.size(); ++i) {
        if (form.file && step.file.empty()) {
            step.file = without_quotes(written[i]).value_or("");
            continue;
        }
        if (form.file && !form.mesh && written[i] == "displacement" && !step.displacement) {
            step.displacement = true;
            continue;
        }
        if (form.file && !form.mesh && written[i] == "else" && !step.rest) {
            step.rest = i + 1 < written.size() ? find_row(forms, written[++i]) : nullptr;
            if (!step.rest || step.rest->move || step.rest->file)
                refuse(form, "`else` needs one of the words fixed, slide, free");
            continue;
        }
        if (form.along && (written[i] == "along" || (written[i] == "boundary" && !step.file.empty()))) {
            std::string& name = written[i] == "along" ? step.file : step.boundary;
            if (!name.empty()) refuse(form, in_backquotes(written[i]), " stands twice");
            if (i + 1 < written.size()) name = without_quotes(written[++i]).value_or("");
            if (name.empty()) refuse(form, "a name is missing after ", in_backquotes(written[i]));
            continue;
        }
        if (form.formulas && written[i].starts_with('"')) {
            step.formulas.emplace_back(without_quotes(written[i]).value_or(""), constants);
            continue;
        }
        if (const auto number = parse_double(written[i])) {
            clause_of(clause)->push_back(*number);
            continue;
        }
        if (is_formula(written[i])) {
            std::vector<double>& numbers = *clause_of(clause);
            step.timed.push_back(
                timed_number(form, clause, numbers.size(), without_quotes(written[i]).value_or(""), constants));
            numbers.push_back(at_start(step.timed.back().formula));
            continue;
        }
        const std::string word = in_backquotes(written[i]);
        const bool axis = form.axis && written[i] == "axis", about = form.about && written[i] == "about";
        if (!axis && !about) refuse(form, word, " is not a number (blanks separate numbers, formulas need quotes)");
        clause = axis ? 1 : 2;
        if (i + 1 == written.size() || (!parse_double(written[i + 1]) && !is_formula(written[i + 1])))
            refuse(form, word, " needs numbers");
        if (!clause_of(clause)->empty()) refuse(form, word, " stands twice");
    }
    check(form, step);
    if (!depends_on_time(step)) check_numbers(form, step);
    return step;
}

std::string to_string(Step step) {
    std::string text = step.form->name;
    if (step.form->along && !step.file.empty()) text += " along";
    if (!step.file.empty()) text += ' ' + quoted_where_needed(step.file, "#=;\" \t");
    if (!step.boundary.empty()) text += " boundary " + quoted_where_needed(step.boundary, "#=;\" \t");
    if (step.displacement) text += " displacement";
    if (step.rest) text += concat(" else ", step.rest->name);
    for (const Expression& formula : step.formulas) text += ' ' + with_quotes(formula.text());
    int clause = 0;
    for (const auto& [word, numbers] :
         {std::pair("", step.numbers), std::pair(" axis", step.axis), std::pair(" about", step.about)}) {
        if (!numbers.empty()) text += word;
        std::vector<std::string> written;
        for (const double v : numbers) written.push_back(to_text(v));
        for (const TimedNumber& timed : step.timed)
            if (timed.clause == clause) written[timed.place] = with_quotes(timed.formula.text());
        for (const std::string& number : written) text += ' ' + number;
        ++clause;
    }
    return text;
}

// Why the step does not fit `dim` dimensions; "" where it does.
std::string misfit(Step step, int dim) {
    const MotionForm& form = *step.form;
    const std::string n = std::to_string(dim), in_dimensions = " in " + n + "D";
    const std::size_t width = dim, count = step.numbers.size();
    std::string why;
    if (form.projection_in && form.projection_in != dim)
        why = " does not act" + in_dimensions + (dim == 3 ? ": use a sphere or a cylinder" : ": use a circle");
    else if (form.axis && step.axis.empty() != (dim == 2))
        why = (dim == 3 ? " needs `axis AX AY AZ`" : " must not have an axis") + in_dimensions;
    else if (form.per_axis && count != 1 && count != width)
        why = " needs " + (form.fewest == 1 ? "one factor or " + n : n + " components") + in_dimensions;
    else if (form.formulas && step.formulas.size() != width)
        why = " needs " + n + " formulas" + in_dimensions;
    else if (!step.about.empty() && step.about.size() != width)
        why = " needs " + n + " numbers after `about`" + in_dimensions;
    return why.empty() ? "" : in_backquotes(to_string(step)) + why;
}

// Of the first step that does not fit.
std::string misfit(const Motion& motion, int dim) {
    for (Step step : motion.steps)
        if (const std::string why = misfit(step, dim); !why.empty()) return why;
    return "";
}

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

Motion parse_motion(std::string_view text, const Constants& constants) {
    Motion motion;
    for (const std::string_view piece : split(text, ';')) motion.steps.push_back(parse_step(piece, constants));
    const auto is_file = [](Step step) { return step.form->file; };
    if (std::any_of(motion.steps.begin() + 1, motion.steps.end(), is_file))
        throw UsageError("positions from a file must be the first step: they belong to nodes where the mesh has them");
    const auto is_alone = [](Step step) {
        return !step.form->move && !step.form->file && step.form->hold != BoundaryHold::slides;
    };
    const auto alone = std::find_if(motion.steps.begin(), motion.steps.end(), is_alone);
    if (motion.steps.size() > 1 && alone != motion.steps.end())
        throw UsageError(in_backquotes(alone->form->name), " beside other steps: a ", alone->form->name,
                         " boundary is not moved, remove one or the other");
    const auto slides = [](Step step) { return step.form->hold == BoundaryHold::slides; };
    if (std::any_of(motion.steps.begin(), motion.steps.end() - 1, slides))
        throw UsageError("`slide` must be the last step: the steps before it move the surface along which nodes slide");
    const std::string in_2d = misfit(motion, 2), in_3d = misfit(motion, 3);
    if (!in_2d.empty() && !in_3d.empty()) throw UsageError("fits no dimension: ", in_2d, "; ", in_3d);
    return motion;
}

Motion at_time(Motion motion, double t, int frame) {
    for (MotionStep& step : motion.steps) {
        step.t = t;
        step.file = numbered(step.file, frame);
        for (const Expression& formula : step.formulas) formula({}, t);  // t is in the range of its tables
        for (const TimedNumber& timed : step.timed) {
            const double value = timed.formula({}, t);
            if (!std::isfinite(value))
                refuse(*step.form, with_quotes(timed.formula.text()), " is not finite at t = ", t);
            (timed.clause == 0 ? step.numbers : timed.clause == 1 ? step.axis : step.about)[timed.place] = value;
        }
        check_numbers(*step.form, step);
    }
    return motion;
}

bool depends_on_time(const Motion& motion) {
    return std::any_of(motion.steps.begin(), motion.steps.end(), [](Step step) { return depends_on_time(step); });
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

Motion at_fraction(Motion motion, double fraction) {
    for (MotionStep& step : motion.steps)
        (step.form->turns || step.form->twists ? step.numbers[0] : step.fraction) *= fraction;
    return motion;
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

bool is_of_mesh(const MotionStep& file_step) { return file_step.form->mesh; }

BoundaryHold hold_of(const Motion& motion) { return motion.steps.back().form->hold; }

BoundaryHold hold_of_rest(const Motion& motion) {
    const MotionForm* const rest = motion.steps.front().rest;
    return rest && hold_of(motion) == BoundaryHold::prescribed ? rest->hold : hold_of(motion);
}

std::string to_string(const Motion& motion) {
    std::string text;
    for (const MotionStep& step : motion.steps) text += (text.empty() ? "" : "; ") + to_string(step);
    return text;
}

std::vector<Named> motion_forms() {
    std::vector<Named> rows;
    for (const MotionForm& form : forms) rows.push_back({form.form, form.meaning});
    return rows;
}

}  // namespace almesh
