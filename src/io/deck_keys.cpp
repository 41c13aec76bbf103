#include "io/deck_keys.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.hpp"
#include "base/text.hpp"

namespace almesh {

namespace {

template <class Enum, Enum Deck::*member>
ChoiceField choice(std::vector<std::string> names) {
    return {std::move(names), [](const Deck& deck) { return static_cast<int>(deck.*member); },
            [](Deck& deck, int value) { deck.*member = static_cast<Enum>(value); }};
}

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr NumberRange no_range, positive = {0, infinity, true}, not_negative = {0, infinity, false};

std::vector<DeckKey> make_table() {
    return {
        {"mesh", TextField{&Deck::mesh, "file"}, no_range,
         "Mesh to move; its path starts in the deck's folder, on the command line in the current one. Required."},
        {"output", TextField{&Deck::output, "folder"}, no_range,
         "Folder of the results, from the current one. Where not given: outputs/ and the deck's name."},
        {"title", TextField{&Deck::title, "text"}, no_range, "Title of the report and of the result files."},
        {"degree", &Deck::degree, {0, 7}, "Degree of the elements; 0: that of the mesh file."},
        {"refine", &Deck::refine, {0, 8}, "Uniform refinements of the mesh before the run."},
        {"target", choice<TargetKind, &Deck::target>({"exact", "nodal"}), no_range,
         "Boundary target: the motion of every boundary point, or its interpolation at the nodes."},
        {"objective", choice<Objective, &Deck::objective>({"squared", "deviation"}), no_range,
         "Integral of eta^2 (the tables of the paper) or of (eta - 1)^2 (its Eq. 5)."},
        {"delta", &Deck::delta, not_negative, "Regularisation of det F in the distortion (Eq. 3), without unit; 0: none. Above 0 inverted elements have finite energy, and a step may invert one."},
        {"weight_exponent", &Deck::weight_exponent, {0, 1},
         "alpha: an element weighs |e|^alpha in the integral; 1: the paper's, 0: all elements alike."},
        {"algorithm", choice<Algorithm, &Deck::algorithm>({"adaptive", "paper", "literal"}), no_range,
         "Augmented Lagrangian schedule: multipliers at every step, Algorithm 1 as corrected, or as printed."},
        {"start", choice<Start, &Deck::start>({"auto", "identity", "coarse"}), no_range,
         "First iterate: the ideal mesh, or with refine > 0 the solution on the mesh refined less, found the same way; "
         "auto: coarse with algorithm = adaptive, else identity."},
        {"mu0", &Deck::mu0, positive, "Algorithms paper and literal: first penalty mu, in units of |1|^2, the sum of |f|/h over the boundary faces."},
        {"omega0", &Deck::omega0, positive, "Algorithms paper and literal: tolerance of the gradient norm |grad E| in the first subproblem."},
        {"epsilon0", &Deck::epsilon0, positive, "Algorithms paper and literal: first tolerance of the squared constraint norm: above it Algorithm 1 raises mu, below it updates lambda."},
        {"omega_star", &Deck::omega_star, positive, "Final tolerance of the gradient norm."},
        {"epsilon_star", &Deck::epsilon_star, positive, "Final tolerance of the squared constraint norm."},
        {"length_scale", &Deck::length_scale, positive,
         "Length by which positions are divided in all tolerances; auto: |domain|^(1/n), 1: absolute values as in the "
         "paper."},
        {"max_al_iterations", &Deck::max_al_iterations, {1, 1000}, "Augmented Lagrangian iterations at most."},
        {"max_newton_iterations", &Deck::max_newton_iterations, {1, 100000}, "Newton steps at most, per subproblem."},
        {"solver", choice<SolverKind, &Deck::solver>({"auto", "cg", "gmres", "cholesky"}), no_range,
         "Linear solver; auto: Cholesky in 2D and for small meshes, conjugate gradients for large ones in 3D."},
        {"forcing", choice<Forcing, &Deck::forcing>({"auto", "fixed"}), no_range,
         "Residual at which cg and gmres stop; auto: after full steps as exact as the model deserves (Eisenstat-Walker), fixed: linear_tolerance."},
        {"linear_tolerance", &Deck::linear_tolerance, {1e-15, 0.5}, "Relative residual at which cg and gmres stop; with forcing = auto the smallest one."},
        {"gmres_restart", &Deck::gmres_restart, {1, 1000}, "GMRES iterations between restarts."},
        {"gmres_max_iterations", &Deck::gmres_max_iterations, {1, 100000}, "Iterations of cg or gmres at most, per system."},
        {"quadrature", &Deck::quadrature, {0, 40}, "Polynomial degree integrated exactly; 0: chosen by the degree."},
        {"certificate_bisections", &Deck::certificate_bisections, {0, 1000000},
         "Bisections at most to certify an element valid."},
        {"write_system", &Deck::write_system, {0, 1000000},
         "Newton step, counted from 1 over all subproblems, whose linear system is written as A.mtx and b.mtx; 0: none."},
        {"vtk", choice<VtkOutput, &Deck::vtk>({"ascii", "binary", "none"}), no_range,
         "Format of the VTK files: text, or binary, which is faster to write and read; or none of them."},
        {"wall", TextField{&Deck::wall, "boundary name"}, no_range,
         "Boundary whose distance is written with the results; \"\": none."},
        {"threads", &Deck::threads, {0, 1024}, "Threads; 0: all, or what OMP_NUM_THREADS says."},
    };
}

std::string range_text(const NumberRange& range) {
    if (range.highest < infinity) return "in " + to_text(range.lowest) + ".." + to_text(range.highest);
    return (range.open ? "> " : ">= ") + to_text(range.lowest);
}

bool contains(const NumberRange& range, double value) {
    return value >= range.lowest && value <= range.highest && !(range.open && value == range.lowest);
}

[[noreturn]] void refuse(const DeckKey& key, std::string_view text, const std::string& hint = "") {
    throw UsageError(key.name + " = " + std::string(text) + ": expected " + legal_values(key) + hint);
}

std::string joined(const std::vector<std::string>& names) {
    std::string text;
    for (const std::string& name : names) text += (text.empty() ? "" : " | ") + name;
    return text;
}

double number_in_range(const DeckKey& key, std::string_view text) {
    const auto value = parse_double(text);
    if (!value || !contains(key.range, *value)) refuse(key, text);
    return *value;
}

// One visitor per use of a field: what is legal, setting, printing.
struct LegalValues {
    const DeckKey& key;
    std::string operator()(const TextField& field) const { return field.what; }
    std::string operator()(const ChoiceField& field) const { return joined(field.words); }
    std::string operator()(int Deck::*) const {
        const int lowest = static_cast<int>(key.range.lowest), highest = static_cast<int>(key.range.highest);
        return "integer in " + std::to_string(lowest) + ".." + std::to_string(highest);
    }
    std::string operator()(double Deck::*) const { return "number " + range_text(key.range); }
    std::string operator()(std::optional<double> Deck::*) const { return "auto or number " + range_text(key.range); }
};

struct SetValue {
    Deck& deck;
    const DeckKey& key;
    std::string_view text;

    void operator()(const TextField& field) const {
        const auto value = without_quotes(text);
        if (text.empty()) refuse(key, text, " (nothing is written \"\")");
        if (!value) refuse(key, text, " (double quotes stand around the whole value only)");
        deck.*field.member = *value;
    }
    void operator()(const ChoiceField& field) const {
        const auto it = std::find(field.words.begin(), field.words.end(), text);
        if (it == field.words.end())
            refuse(key, text, ": did you mean " + in_backquotes(nearest(text, field.words)) + "?");
        field.set(deck, static_cast<int>(it - field.words.begin()));
    }
    void operator()(int Deck::*member) const {
        const auto value = parse_int(text, static_cast<int>(key.range.lowest), static_cast<int>(key.range.highest));
        if (!value) refuse(key, text);
        deck.*member = *value;
    }
    void operator()(double Deck::*member) const { deck.*member = number_in_range(key, text); }
    void operator()(std::optional<double> Deck::*member) const {
        deck.*member = text == "auto" ? std::nullopt : std::optional(number_in_range(key, text));
    }
};

struct ValueText {
    const Deck& deck;

    std::string operator()(const TextField& field) const {
        const std::string& value = deck.*field.member;
        const bool bare = !value.empty() && trim(value) == value && value.find('#') == std::string::npos;
        return bare ? value : with_quotes(value);
    }
    std::string operator()(const ChoiceField& field) const { return field.words[field.get(deck)]; }
    std::string operator()(int Deck::*member) const { return std::to_string(deck.*member); }
    std::string operator()(double Deck::*member) const { return to_text(deck.*member); }
    std::string operator()(std::optional<double> Deck::*member) const {
        return deck.*member ? to_text(*(deck.*member)) : "auto";
    }
};

}  // namespace

const std::vector<DeckKey>& deck_keys() {
    static const std::vector<DeckKey> table = make_table();
    return table;
}

const DeckKey* find_key(std::string_view name) {
    for (const DeckKey& key : deck_keys())
        if (key.name == name) return &key;
    return nullptr;
}

std::string legal_values(const DeckKey& key) { return std::visit(LegalValues{key}, key.field); }

void set_value(Deck& deck, const DeckKey& key, std::string_view text) {
    std::visit(SetValue{deck, key, text}, key.field);
}

std::string value_text(const Deck& deck, const DeckKey& key) { return std::visit(ValueText{deck}, key.field); }

std::string keys_table() {
    const std::vector<std::size_t> width = {23, 11, 28, 38};
    const Deck defaults;
    std::string text = table_row({"KEY", "DEFAULT", "LEGAL VALUES", "MEANING"}, width);
    for (const DeckKey& key : deck_keys()) {
        const std::string value = value_text(defaults, key);
        text += table_row({key.name, value == "\"\"" ? "-" : value, legal_values(key), key.meaning}, width);
    }
    text += table_row({"boundary NAME", "", "STEP [; STEP ...]",
                       "Motion of a boundary, its steps in the order written. One line for each boundary of the mesh."},
                      width);
    text += table_row({"expect QUANTITY", "", "<= | >= | = VALUE",
                       "Checked against the summary at the end of the run; "
                       "= takes `+- TOLERANCE`, a must for decimal numbers."},
                      width);
    std::string names;
    for (const std::string& name : summary_quantities()) names += name + " ";
    text += "\nSteps of a motion:\n" + motion_forms() + "\nQuantities of the summary:\n";
    for (const std::string& line : wrap(names, 100)) text += line + "\n";
    return text;
}

}  // namespace almesh
