#include "app/deck_keys.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>
#include <utility>

#include "base/error.hpp"
#include "base/text.hpp"

namespace almesh {

namespace {

// path: a member of Deck, or one of Deck and one of that.
template <auto... path>
auto& place_in(auto& deck) {
    return (deck .* ... .* path);
}

template <auto... path>
using FieldType = std::remove_reference_t<decltype(place_in<path...>(std::declval<Deck&>()))>;

template <auto... path>
NumberField<FieldType<path...>> number() {
    return {[](const Deck& deck) -> const auto& { return place_in<path...>(deck); },
            [](Deck& deck) -> auto& { return place_in<path...>(deck); }};
}

template <auto... path>
ChoiceField choice(std::vector<std::string> names) {
    return {std::move(names), [](const Deck& deck) { return static_cast<int>(place_in<path...>(deck)); },
            [](Deck& deck, int value) { place_in<path...>(deck) = static_cast<FieldType<path...>>(value); }};
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
        {"degree", number<&Deck::degree>(), {0, 7}, "Degree of the elements; 0: that of the mesh file."},
        {"refine", number<&Deck::refine>(), {0, 8}, "Uniform refinements of the mesh before the run."},
        {"target", choice<&Deck::target>({"exact", "nodal"}), no_range,
         "Boundary target: the motion of every boundary point, or its interpolation at the nodes."},
        {"objective", choice<&Deck::distortion, &DistortionParams::objective>({"squared", "deviation"}), no_range,
         "Integral of eta^2 (the tables of the paper) or of (eta - 1)^2 (its Eq. 5)."},
        {"delta", number<&Deck::distortion, &DistortionParams::delta>(), not_negative,
         "Regularisation of det F in the distortion (Eq. 3), without unit; 0: none. Above 0 inverted elements have "
         "finite energy, and a step may invert one."},
        {"weight_exponent", number<&Deck::distortion, &DistortionParams::weight_exponent>(), {0, 1},
         "alpha: an element weighs |e|^alpha in the integral; 1: the paper's, 0: all elements alike."},
        {"algorithm", choice<&Deck::method, &AugmentedLagrangianParams::algorithm>({"adaptive", "paper", "literal"}),
         no_range,
         "Augmented Lagrangian schedule: multipliers at every step, Algorithm 1 as corrected, or as printed."},
        {"start", choice<&Deck::start>({"auto", "identity", "coarse"}), no_range,
         "First iterate: the ideal mesh, or with refine > 0 the solution on the mesh refined less, found the same way; "
         "auto: coarse with algorithm = adaptive, else identity."},
        {"mu0", number<&Deck::method, &AugmentedLagrangianParams::mu0>(), positive,
         "Algorithms paper and literal: first penalty mu, in units of |1|^2, the sum of |f|/h over the boundary "
         "faces."},
        {"omega0", number<&Deck::method, &AugmentedLagrangianParams::omega0>(), positive,
         "Algorithms paper and literal: tolerance of the gradient norm |grad E| in the first subproblem."},
        {"epsilon0", number<&Deck::method, &AugmentedLagrangianParams::epsilon0>(), positive,
         "Algorithms paper and literal: first tolerance of the squared constraint norm: above it Algorithm 1 raises "
         "mu, below it updates lambda."},
        {"omega_star", number<&Deck::method, &AugmentedLagrangianParams::omega_star>(), positive,
         "Final tolerance of the gradient norm."},
        {"epsilon_star", number<&Deck::method, &AugmentedLagrangianParams::epsilon_star>(), positive,
         "Final tolerance of the squared constraint norm."},
        {"length_scale", number<&Deck::length_scale>(), positive,
         "Length by which positions are divided in all tolerances; auto: |domain|^(1/n), 1: absolute values as in the "
         "paper."},
        {"max_al_iterations", number<&Deck::method, &AugmentedLagrangianParams::max_iterations>(), {1, 1000},
         "Augmented Lagrangian iterations at most."},
        {"max_newton_iterations", number<&Deck::method, &AugmentedLagrangianParams::max_newton_iterations>(), {1,
         100000},
         "Newton steps at most, per subproblem."},
        {"solver", choice<&Deck::linear, &LinearSolverParams::kind>({"auto", "cg", "gmres", "cholesky"}), no_range,
         "Linear solver; auto: Cholesky in 2D and for small meshes, conjugate gradients for large ones in 3D."},
        {"forcing", choice<&Deck::forcing>({"auto", "fixed"}), no_range,
         "Residual at which cg and gmres stop; auto: after full steps as exact as the model deserves "
         "(Eisenstat-Walker), fixed: linear_tolerance."},
        {"linear_tolerance", number<&Deck::linear, &LinearSolverParams::tolerance>(), {1e-15, 0.5},
         "Relative residual at which cg and gmres stop; with forcing = auto the smallest one."},
        {"gmres_restart", number<&Deck::linear, &LinearSolverParams::restart>(), {1, 1000},
         "GMRES iterations between restarts."},
        {"gmres_max_iterations", number<&Deck::linear, &LinearSolverParams::max_iterations>(), {1, 100000},
         "Iterations of cg or gmres at most, per system."},
        {"quadrature", number<&Deck::distortion, &DistortionParams::exactness>(), {0, 40},
         "Polynomial degree integrated exactly; 0: chosen by the degree, as always for linear elements."},
        {"certificate_bisections", number<&Deck::certificate, &CertificateParams::max_bisections>(), {0, 1000000},
         "Bisections at most to certify an element valid."},
        {"write_system", number<&Deck::write_system>(), {0, 1000000},
         "Newton step, counted from 1 over all subproblems, whose linear system is written as A.mtx and b.mtx; 0: "
         "none."},
        {"vtk", choice<&Deck::vtk>({"ascii", "binary", "none"}), no_range,
         "Format of the VTK files: text, or binary, which is faster to write and read; or none of them."},
        {"wall", TextField{&Deck::wall, "boundary name"}, no_range,
         "Boundary whose distance is written with the results; \"\": none."},
        {"threads", number<&Deck::threads>(), {0, 1024}, "Threads; 0: all, or what OMP_NUM_THREADS says."},
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
    std::string operator()(const NumberField<int>&) const {
        const int lowest = static_cast<int>(key.range.lowest), highest = static_cast<int>(key.range.highest);
        return "integer in " + std::to_string(lowest) + ".." + std::to_string(highest);
    }
    std::string operator()(const NumberField<double>&) const { return "number " + range_text(key.range); }
    std::string operator()(const NumberField<std::optional<double>>&) const {
        return "auto or number " + range_text(key.range);
    }
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
    void operator()(const NumberField<int>& field) const {
        const auto value = parse_int(text, static_cast<int>(key.range.lowest), static_cast<int>(key.range.highest));
        if (!value) refuse(key, text);
        field.place(deck) = *value;
    }
    void operator()(const NumberField<double>& field) const { field.place(deck) = number_in_range(key, text); }
    void operator()(const NumberField<std::optional<double>>& field) const {
        field.place(deck) = text == "auto" ? std::nullopt : std::optional(number_in_range(key, text));
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
    std::string operator()(const NumberField<int>& field) const { return std::to_string(field.value(deck)); }
    std::string operator()(const NumberField<double>& field) const { return to_text(field.value(deck)); }
    std::string operator()(const NumberField<std::optional<double>>& field) const {
        return field.value(deck) ? to_text(*field.value(deck)) : "auto";
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
