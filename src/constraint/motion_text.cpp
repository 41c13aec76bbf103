// A motion as it is written: its steps read and checked, its numbers at a time, and its text again.
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "base/error.hpp"
#include "constraint/motion_form.hpp"

namespace almesh {
namespace {

// By the `clause` of TimedNumber.
auto& numbers_of(auto& step, int clause) { return *std::array{&step.numbers, &step.axis, &step.about}[clause]; }

template <class... Parts>
[[noreturn]] void refuse(const MotionForm& form, const Parts&... why) {
    throw UsageError(in_backquotes(form.name), ": ", why..., "; expected ", form.form);
}

void check(const MotionForm& form, Step step) {
    const std::size_t count = step.numbers.size();
    if (count < form.fewest || count > form.most) refuse(form, counted(count, "number"));
    if (form.formulas && step.formulas.size() != 2 && step.formulas.size() != 3)
        refuse(form, counted(step.formulas.size(), "formula"), " in double quotes");
    if ((form.file || form.onto) && step.file.empty()) refuse(form, "the name of the file is missing");
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

// Takes the word number i of a step with a file, and the one that belongs to it. False where it is none of these.
bool take_file(const MotionForm& form, const std::vector<std::string_view>& written, std::size_t& i, MotionStep& step) {
    const std::string_view word = written[i];
    const bool is_last = i + 1 == written.size();
    if ((form.file || form.onto) && step.file.empty()) {
        step.file = without_quotes(word).value_or("");
    } else if (form.file && !form.mesh && word == "displacement" && !step.displacement) {
        step.displacement = true;
    } else if (form.file && !form.mesh && word == "else" && !step.rest) {
        step.rest = is_last ? nullptr : find_row(form_table, written[++i]);
        if (!step.rest || step.rest->move || step.rest->file)
            refuse(form, "`else` needs one of the words fixed, slide, free");
    } else if (form.along && (word == "along" || (word == "boundary" && !step.file.empty()))) {
        std::string& name = word == "along" ? step.file : step.boundary;
        if (!name.empty()) refuse(form, in_backquotes(word), " stands twice");
        if (!is_last) name = without_quotes(written[++i]).value_or("");
        if (name.empty()) refuse(form, "a name is missing after ", in_backquotes(word));
    } else {
        return false;
    }
    return true;
}

MotionStep parse_step(std::string_view text, const Constants& constants) {
    const auto written = quoted_words(text);
    if (written.empty()) throw UsageError("a step of the motion is empty: put a step on both sides of every `;`");
    MotionStep step;
    step.form = find_row(form_table, written[0]);
    if (!step.form)
        throw UsageError("unknown motion ", in_backquotes(written[0]), did_you_mean(written[0], names_of(form_table)),
                         " All motions: almesh --keys");
    const MotionForm& form = *step.form;
    const auto is_formula = [&](std::string_view word) { return word.starts_with('"') || find_row(constants, word); };
    int clause = 0;
    for (std::size_t i = 1; i < written.size(); ++i) {
        if (take_file(form, written, i, step)) continue;
        const std::string unquoted = without_quotes(written[i]).value_or("");
        std::vector<double>& numbers = numbers_of(step, clause);
        if (form.formulas && written[i].starts_with('"')) {
            step.formulas.emplace_back(unquoted, constants);
            continue;
        }
        if (const auto number = parse_double(written[i])) {
            numbers.push_back(*number);
            continue;
        }
        if (is_formula(written[i])) {
            step.timed.push_back({clause, numbers.size(), Expression(unquoted, constants)});
            const Expression& formula = step.timed.back().formula;
            if (formula.names_point())
                refuse(form, "the formula ", with_quotes(unquoted), " of a number may name t and constants alone");
            numbers.push_back(at_start(formula));
            continue;
        }
        const std::string word = in_backquotes(written[i]);
        const bool axis = form.axis && written[i] == "axis", about = form.about && written[i] == "about";
        if (!axis && !about) refuse(form, word, " is not a number (blanks separate numbers, formulas need quotes)");
        clause = axis ? 1 : 2;
        if (i + 1 == written.size() || (!parse_double(written[i + 1]) && !is_formula(written[i + 1])))
            refuse(form, word, " needs numbers");
        if (!numbers_of(step, clause).empty()) refuse(form, word, " stands twice");
    }
    check(form, step);
    if (!depends_on_time(step)) check_numbers(form, step);
    return step;
}

std::string to_string(Step step) {
    std::string text = step.form->name;
    if (step.form->along && !step.form->onto && !step.file.empty()) text += " along";
    if (!step.file.empty()) text += ' ' + quoted_where_needed(step.file, "#=;\" \t");
    if (!step.boundary.empty()) text += " boundary " + quoted_where_needed(step.boundary, "#=;\" \t");
    if (step.displacement) text += " displacement";
    if (step.rest) text += concat(" else ", step.rest->name);
    for (const Expression& formula : step.formulas) text += ' ' + with_quotes(formula.text());
    for (int clause = 0; clause < 3; ++clause) {
        std::vector<std::string> written;
        for (const double v : numbers_of(step, clause)) written.push_back(to_text(v));
        if (!written.empty()) text += std::array{"", " axis", " about"}[clause];
        for (const TimedNumber& timed : step.timed)
            if (timed.clause == clause) written[timed.place] = with_quotes(timed.formula.text());
        for (const std::string& number : written) text += ' ' + number;
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

}  // namespace

Motion parse_motion(std::string_view text, const Constants& constants) {
    Motion motion;
    for (const std::string_view piece : split(text, ';')) motion.steps.push_back(parse_step(piece, constants));
    const auto is_file = [](Step step) { return step.form->file; };
    if (std::any_of(motion.steps.begin() + 1, motion.steps.end(), is_file))
        throw UsageError("positions from a file must be the first step: they belong to nodes where the mesh has them");
    const auto is_alone = [](Step step) {
        return step.form->kind == NodeKind::fixed || step.form->kind == NodeKind::free;
    };
    const auto alone = std::find_if(motion.steps.begin(), motion.steps.end(), is_alone);
    if (motion.steps.size() > 1 && alone != motion.steps.end())
        throw UsageError(in_backquotes(alone->form->name), " beside other steps: a ", alone->form->name,
                         " boundary is not moved, remove one or the other");
    const auto slides = [](Step step) { return step.form->kind == NodeKind::slides; };
    const auto early = std::find_if(motion.steps.begin(), motion.steps.end() - 1, slides);
    if (early != motion.steps.end() - 1)
        throw UsageError(in_backquotes(early->form->name), " must be the last step, after those that move its surface");
    const bool has_landmarks = motion.steps.size() == 2 && file_step(motion) && !is_of_mesh(motion.steps[0]);
    if (goes_onto(motion) && motion.steps.size() > 1 && !has_landmarks)
        throw UsageError("before `onto` there can only be `file NODES.csv`: move the mesh near by a run of its own");
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
            numbers_of(step, timed.clause)[timed.place] = value;
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

std::string to_string(const Motion& motion) {
    std::string text;
    for (const MotionStep& step : motion.steps) text += (text.empty() ? "" : "; ") + to_string(step);
    return text;
}

}  // namespace almesh
