// The table of the deck's keys. A row gives name, member of the Deck (and with it type and default), legal values and
// meaning; text<>(), number<>() and choice<>() make the functions that read and print the value.
#include "app/deck.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>
#include <utility>

#include "app/report.hpp"
#include "base/error.hpp"
#include "base/text.hpp"

namespace almesh {
namespace {

using Hint = std::optional<std::string>;  // nothing where a value is legal

// path: a member of Deck, or one of Deck and one of that.
template <auto... path>
auto& field(auto& deck) {
    return (deck .* ... .* path);
}

template <auto member>
DeckValue text(const char* what) {
    const auto set = [](Deck& deck, std::string_view written) -> Hint {
        const auto value = without_quotes(written);
        if (written.empty()) return " (nothing is written \"\")";
        if (!value) return " (double quotes stand around the whole value only)";
        deck.*member = *value;
        return std::nullopt;
    };
    return {what, set, [](const Deck& deck) { return quoted_where_needed(deck.*member, "#\""); }};
}

// An enum; enumerator i is written names[i].
template <auto... path>
DeckValue choice(const std::vector<std::string>& names, std::string legal) {
    const auto set = [names](Deck& deck, std::string_view written) -> Hint {
        const auto it = std::find(names.begin(), names.end(), written);
        if (it == names.end()) return did_you_mean(written, names);
        auto& value = field<path...>(deck);
        value = static_cast<std::remove_reference_t<decltype(value)>>(it - names.begin());
        return std::nullopt;
    };
    return {legal, set, [names](const Deck& deck) { return names[static_cast<int>(field<path...>(deck))]; }};
}

template <auto... path>
DeckValue choice(const std::vector<std::string>& names) {
    std::string legal;
    for (const std::string& name : names) legal += (legal.empty() ? "" : " | ") + name;
    return choice<path...>(names, legal);
}

struct Range {
    double lowest, highest = std::numeric_limits<double>::infinity();
    bool open = false;  // lowest itself is not legal

    bool contains(double v) const { return v <= highest && (open ? v > lowest : v >= lowest); }
};

constexpr Range positive = {.lowest = 0, .open = true}, not_negative = {0};

// Of an int, a double or an optional one, which is `auto` where it is empty.
template <auto... path>
DeckValue number(Range range) {
    using T = std::remove_reference_t<decltype(field<path...>(std::declval<Deck&>()))>;
    constexpr bool whole = std::is_same_v<T, int> || std::is_same_v<T, std::optional<int>>;
    constexpr bool optional = !std::is_arithmetic_v<T>;
    const auto shown = [](double v) { return whole ? std::to_string(static_cast<int>(v)) : to_text(v); };
    const bool bounded = std::isfinite(range.highest);
    const std::string legal = (optional ? std::string("auto or ") : "") + (whole ? "integer " : "number ") +
                              (bounded ? "in " + shown(range.lowest) + ".." + shown(range.highest)
                                       : (range.open ? "> " : ">= ") + shown(range.lowest));
    const auto set = [range](Deck& deck, std::string_view written) -> Hint {
        const auto value = whole ? std::optional<double>(parse_int(written)) : parse_double(written);
        const bool automatic = optional && written == "auto";
        if (!automatic && (!value || !range.contains(*value))) return "";
        if (automatic) field<path...>(deck) = T();
        else if constexpr (whole) field<path...>(deck) = static_cast<int>(*value);
        else field<path...>(deck) = *value;
        return std::nullopt;
    };
    const auto text = [shown](const Deck& deck) -> std::string {
        const std::optional<double> value = field<path...>(deck);
        return value ? shown(*value) : "auto";
    };
    return {legal, set, text};
}

using Distortion = DistortionParams;
using Method = AugmentedLagrangianParams;
using Linear = LinearSolverParams;

}  // namespace

const std::vector<DeckKey>& deck_keys() {
    static const std::vector<DeckKey> table = {
        {"mesh", text<&Deck::mesh>("file"),
         "Mesh to move; its path starts in the deck's folder, on the command line in the current one. Required."},
        {"output", text<&Deck::output>("folder"),
         "Folder of the results, from the current one. Where not given: outputs/ and the deck's name."},
        {"title", text<&Deck::title>("text"), "Title of the report and of the result files."},
        {"degree", number<&Deck::degree>({0, 7}), "Degree of the elements; 0: that of the mesh file."},
        {"refine", number<&Deck::refine>({0, 8}), "Uniform refinements of the mesh before the run."},
        {"target", choice<&Deck::target>({"exact", "nodal"}),
         "Boundary target: the motion of every boundary point, or its interpolation at the nodes; the latter where a "
         "boundary slides or is free."},
        {"objective",
         choice<&Deck::distortion, &Distortion::objective>({"squared", "deviation", "size_shape", "minimax"}),
         "Integral of eta^2 (the tables of the paper), of (eta - 1)^2 (its Eq. 5), or of the latter with eta times "
         "(sigma + 1/sigma)/2, sigma = det F: elements keep their sizes too; minimax: powers of eta - 1 that rise in "
         "the run, for the best worst element."},
        {"power", number<&Deck::power>({2, 128}),
         "Power of eta, or of eta - 1, in the objective; auto: 2. With objective = minimax the last one; auto: 64, or "
         "where eta does not get smaller any more."},
        {"delta", number<&Deck::distortion, &Distortion::delta>(not_negative),
         "Regularisation of det F in the distortion (Eq. 3), without unit; 0: none. Above 0 inverted elements have "
         "finite energy, and a step may invert one."},
        {"weight_exponent", number<&Deck::weight_exponent>({0, 1}),
         "alpha: an element weighs |e|^alpha in the integral; 1: the paper's, 0: all elements alike; auto: 0.5 with "
         "algorithm = adaptive, which keeps small elements in shape, else 1; 0 with objective = minimax."},
        {"assembly", choice<&Deck::distortion, &Distortion::assembly>({"simd", "plain"}),
         "Assembly of the energy and its derivatives: one element per SIMD lane on all threads, or the textbook's, for "
         "study: ten to fifty times slower."},
        {"method",
         choice<&Deck::method, &Method::moving>({"augmented_lagrangian", "penalty", "elasticity", "harmonic",
                                                 "incremental", "untangle", "fixed_boundary"},
                                                "augmented_lagrangian | penalty | ..."),
         "How the mesh is moved. Others than augmented_lagrangian are there to be compared with it. penalty: without "
         "multipliers; elasticity, harmonic: the displacement of the boundary extended inside as that of a solid, "
         "stiffer where elements are small, or as a harmonic function; incremental, fixed_boundary: the boundary set "
         "on its target in parts or at once, and the distortion minimised inside; untangle: at once, with a "
         "regularised distortion first. All but penalty need the positions of all boundaries to be prescribed, and "
         "take no account of algorithm, start and continuation = auto."},
        {"increments", number<&Deck::increments>({1, 100000}),
         "Methods elasticity, harmonic and incremental: load increments, each from the mesh as moved so far; auto: "
         "1, and 10 with incremental, which halves a part that has no valid mesh to start from."},
        {"algorithm", choice<&Deck::method, &Method::algorithm>({"adaptive", "paper", "literal"}),
         "Augmented Lagrangian schedule: multipliers at every step, Algorithm 1 as corrected, or as printed."},
        {"start", choice<&Deck::start>({"auto", "identity", "coarse"}),
         "First iterate: the ideal mesh, or the solution on the mesh refined less or of lower degree, found so too; "
         "auto: coarse with algorithm = adaptive, else identity."},
        {"continuation", choice<&Deck::continuation>({"auto", "never", "always"}),
         "Load increments: the motion is increased in stages, so that the mesh turns as often as the boundary does; "
         "auto: with algorithm = adaptive, for turns above 90 degrees, by the shorter way, and where the whole motion "
         "fails at once; always: turns as they are written, also beyond 180 degrees."},
        {"snap", choice<&Deck::snap>({"auto", "0", "1"}),
         "1: in the end the nodes of the boundary are set to their targets, to the last bit, where elements stay "
         "valid; auto: 1 with algorithm = adaptive, else 0."},
        {"local_repair", number<&Deck::local_repair>({0, 1}),
         "1: where all boundaries are fixed, only the nodes of elements that are inverted in the mesh file move, and "
         "those of elements around them, as few as are needed for a valid mesh."},
        {"feature_angle", number<&Deck::feature_angle>({1, 180}),
         "Angle in degrees between neighbouring faces of a sliding boundary from which they belong to different "
         "surfaces: nodes slide along such an edge, and corners stay."},
        {"surface", choice<&Deck::surface>({"auto", "keep", "slide", "straighten"}),
         "Whether nodes keep the positions on the boundary that its motion gives them, or slide along the surface "
         "there; auto: they slide only where a valid mesh cannot keep them, because the target folds faces or elements; "
         "straighten: faces are made flat there instead, as many as it takes for a valid mesh."},
        {"mu0", number<&Deck::method, &Method::mu0>(positive),
         "Algorithms paper and literal, method penalty: first penalty mu, in units of |1|^2, the sum of |f|/h over the "
         "boundary faces."},
        {"omega0", number<&Deck::method, &Method::omega0>(positive),
         "Algorithms paper and literal: tolerance of the gradient norm |grad E| in the first subproblem."},
        {"epsilon0", number<&Deck::method, &Method::epsilon0>(positive),
         "Algorithms paper and literal: first tolerance of the squared constraint norm: above it Algorithm 1 raises "
         "mu, below it updates lambda."},
        {"omega_star", number<&Deck::method, &Method::omega_star>(positive), "Final tolerance of the gradient norm."},
        {"epsilon_star", number<&Deck::method, &Method::epsilon_star>(positive),
         "Final tolerance of the squared constraint norm."},
        {"wall_tolerance", number<&Deck::method, &Method::wall_tolerance>(positive),
         "Algorithm adaptive: final tolerance of the distance of every boundary node from its target, in heights of "
         "the cells at it."},
        {"length_scale", number<&Deck::length_scale>(positive),
         "Length by which positions are divided in all tolerances; auto: |domain|^(1/n), 1: absolute values as in the "
         "paper."},
        {"max_al_iterations", number<&Deck::method, &Method::max_iterations>({1, 1000}),
         "Augmented Lagrangian iterations at most."},
        {"max_newton_iterations", number<&Deck::method, &Method::max_newton_iterations>({1, 100000}),
         "Newton steps at most, per subproblem."},
        {"solver", choice<&Deck::linear, &Linear::kind>({"auto", "cg", "gmres", "cholesky"}),
         "Linear solver; auto: Cholesky in 2D and for small meshes in 3D, conjugate gradients for large ones."},
        {"preconditioner", choice<&Deck::linear, &Linear::preconditioner>({"auto", "ilu0", "ssor", "pmg"}),
         "Of cg; pmg: ssor with a correction of degree 1. auto: pmg for degrees above 1, ssor for linear tetrahedra, "
         "ilu0 for linear triangles unless it meets bad pivots."},
        {"forcing", choice<&Deck::forcing>({"auto", "fixed"}),
         "Residual at which cg and gmres stop; auto: after full steps by the rule of Eisenstat and Walker, fixed: "
         "linear_tolerance."},
        {"linear_tolerance", number<&Deck::linear, &Linear::tolerance>({1e-15, 0.5}),
         "Relative residual at which cg and gmres stop; with forcing = auto the smallest one."},
        {"gmres_restart", number<&Deck::linear, &Linear::restart>({1, 1000}), "GMRES iterations between restarts."},
        {"gmres_max_iterations", number<&Deck::linear, &Linear::max_iterations>({1, 100000}),
         "Iterations of cg or gmres at most, per system."},
        {"quadrature", number<&Deck::distortion, &Distortion::exactness>({0, 40}),
         "Polynomial degree integrated exactly; 0: chosen by the degree, as always for linear elements."},
        {"certificate_bisections", number<&Deck::certificate, &CertificateParams::max_bisections>({0, 1000000}),
         "Bisections at most to certify an element valid."},
        {"write_system", number<&Deck::write_system>({0, 1000000}),
         "Newton step, counted from 1 over all subproblems, whose linear system is written as A.mtx and b.mtx; 0: "
         "none."},
        {"iterates", number<&Deck::iterates>({0, 1000000}),
         "Every how many Newton steps on the deck's own mesh it is written as iterate-0000.vtk, ..., with "
         "iterates.vtk.series, which ParaView plays; 0: never."},
        {"vtk", choice<&Deck::vtk>({"ascii", "binary", "none"}),
         "Format of the VTK files: text, or binary, which is faster to write and read; or none of them."},
        {"final",
         choice<&Deck::final_format>(
             {"input", "msh", "su2", "both", "msh22", "msh22-binary", "msh40", "msh40-binary", "msh41", "msh41-binary"},
             "input | msh | su2 | both | msh22, msh40, msh41 [-binary]"),
         "Format of the final mesh. input: that of the mesh file, in its version, text or binary, but final.msh where "
         "that is SU2 and the elements are not linear; msh: final.msh in the version of the mesh file, or 2.2; su2: "
         "final.su2 (linear meshes); both: these two; msh22, msh41-binary, ...: final.msh in that version."},
        {"wall", text<&Deck::wall>("boundary name"),
         "Boundary whose distance is written with the results; \"\": none."},
        {"max_seconds", number<&Deck::max_seconds>({0, 1e9}),
         "Seconds after which the run ends as `interrupted`, after the Newton step at hand, with its results written; "
         "0: never."},
        {"checkpoint", number<&Deck::checkpoint>({0, 1e9}),
         "After a minimisation the run's state is saved, where so many seconds have gone since it was saved last, in the "
         "folder checkpoint of its results, which goes when the run has come to its end; 0: never."},
        {"resume", number<&Deck::resume>({0, 1}),
         "1: the run goes on from its saved state, after it was interrupted or killed, and ends with the same bits as "
         "if it had not been."},
        {"threads", number<&Deck::threads>({0, 1024}), "Threads; 0: all, or what OMP_NUM_THREADS says."},
    };
    return table;
}

void set_value(Deck& deck, const DeckKey& key, std::string_view text) {
    if (const auto hint = key.value.set(deck, text))
        throw UsageError(key.name, " = ", text, ": expected ", key.value.legal, *hint);
}

std::string keys_table() {
    const std::vector<std::size_t> width = {23, 11, 33, 33};
    const Deck defaults;
    std::string text = table_row({"KEY", "DEFAULT", "LEGAL VALUES", "MEANING"}, width);
    for (const DeckKey& key : deck_keys()) {
        const std::string value = key.value.text(defaults);
        text += table_row({key.name, value == "\"\"" ? "-" : value, key.value.legal, key.meaning}, width);
    }
    text += table_row({"boundary NAME", "", "STEP [; STEP ...]",
                       "Motion of a boundary, its steps in the order written. One line for each boundary of the mesh."},
                      width);
    text += table_row({"expect QUANTITY", "", "<= | >= | = VALUE",
                       "Checked against the summary at the end of the run; "
                       "= takes `+- TOLERANCE`, a must for decimal numbers."},
                      width);
    const auto list = [&text](const char* title, const std::vector<Named>& rows, std::size_t name_width) {
        text += std::string("\n") + title + ":\n";
        for (const Named& row : rows) text += table_row({row.name, row.meaning}, {name_width, 100 - name_width});
    };
    list("Steps of a motion", motion_forms(), 50);
    list("Quantities of the summary", summary_quantities(), 27);
    list("Columns of history.csv", history_columns(), 27);
    return text;
}

}  // namespace almesh
