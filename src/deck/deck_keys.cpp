// The table of the deck's keys. A row gives name, member of the Deck (and with it type and default), legal values and
// meaning; text<>(), number<>() and choice<>() make the functions that read and print the value.
#include "deck/deck.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>
#include <utility>

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

// An enum; enumerator i is written names[i]. legal: names with | between them where it is empty.
template <auto... path>
DeckValue choice(const std::vector<std::string>& names, std::string legal = "") {
    for (std::size_t k = 0; k < names.size() && (k > 0 || legal.empty()); ++k) legal += (k ? " | " : "") + names[k];
    const auto set = [names](Deck& deck, std::string_view written) -> Hint {
        const auto it = std::find(names.begin(), names.end(), written);
        if (it == names.end()) return did_you_mean(written, names);
        auto& value = field<path...>(deck);
        value = static_cast<std::remove_reference_t<decltype(value)>>(it - names.begin());
        return std::nullopt;
    };
    return {legal, set, [names](const Deck& deck) { return names[static_cast<int>(field<path...>(deck))]; }};
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

// One of these words, or a text of another form: `set` says whether it is one, and reads it; `text` is "" of a word.
DeckValue word_or(const DeckValue& words, const std::function<bool(Deck&, std::string_view)>& set,
                  const std::function<std::string(const Deck&)>& text) {
    return {words.legal,
            [=](Deck& deck, std::string_view written) { return set(deck, written) ? Hint() : words.set(deck, written); },
            [=](const Deck& deck) {
                const std::string other = text(deck);
                return other.empty() ? words.text(deck) : other;
            }};
}

// A mesh file is a name with a dot or a slash.
DeckValue start() {
    const auto set = [](Deck& deck, std::string_view written) {
        const auto file = without_quotes(written);
        if (!file || file->find_first_of("./") == std::string::npos) return false;
        deck.start = Start::file;
        deck.start_file = *file;
        return true;
    };
    return word_or(choice<&Deck::start>({"auto", "identity", "coarse"}, "auto | identity | coarse | mesh file"), set,
                   [](const Deck& deck) {
                       return deck.start == Start::file ? quoted_where_needed(deck.start_file, "#\"") : "";
                   });
}

DeckValue ideal() {
    const auto set = [](Deck& deck, std::string_view written) {
        const auto space = std::min(written.find_first_of(" \t"), written.size());
        const auto argument = without_quotes(trim(written.substr(space)));
        const bool is_size = written.starts_with("size "), is_mesh = written.starts_with("mesh ");
        deck.ideal_size.clear();
        deck.ideal_file.clear();
        if (space == written.size() || !argument || !(is_size || is_mesh)) return false;
        if (is_size && Expression(*argument, deck.constants).names_time())
            throw UsageError("ideal = ", written, ": the formula may name x, y, z, not the time");
        deck.ideal = is_size ? IdealKind::size : IdealKind::mesh;
        (is_size ? deck.ideal_size : deck.ideal_file) = *argument;
        return true;
    };
    return word_or(choice<&Deck::ideal>({"auto", "straight", "given", "regular"},
                                        "auto | straight | given | regular | size FORMULA | mesh FILE"), set,
                   [](const Deck& deck) -> std::string {
                       if (deck.ideal == IdealKind::size) return "size " + with_quotes(deck.ideal_size);
                       return deck.ideal == IdealKind::mesh ? "mesh " + with_quotes(deck.ideal_file) : "";
                   });
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
         "Folder of the results; its path starts in the current folder. Where not given: outputs/ and the deck's "
         "name."},
        {"title", text<&Deck::title>("text"), "Title of the report and of the result files."},
        {"degree", number<&Deck::degree>({0, 7}), "Degree of the elements; 0: as in the mesh file."},
        {"refine", number<&Deck::refine>({0, most_refinements}),
         "How many times every element is split uniformly before the run."},
        {"target", choice<&Deck::target>({"nodal", "least_squares"}),
         "Where a boundary goes. nodal: each of its nodes to where the motion takes it; least_squares, as in the paper: "
         "to the faces nearest to the motion in the mean over all their points, which nodes then miss. Nodes of fixed "
         "boundaries stay either way. With a boundary that slides or is free the target is always nodal."},
        {"shared_nodes", choice<&Deck::shared_nodes>({"refuse", "first", "mean"}),
         "A node of two boundaries whose motions disagree is refused, goes with the boundary whose line stands first, or "
         "to the mean of the positions."},
        {"objective",
         choice<&Deck::distortion, &Distortion::objective>({"squared", "deviation", "size_shape", "minimax"}),
         "What is minimised. squared: the integral of eta^2, as in the paper's tables; deviation: that of (eta - "
         "1)^2, its Eq. 5; size_shape: as deviation with eta (sigma + 1/sigma)/2 in place of eta, sigma = det F, so "
         "that elements keep their sizes too; minimax: powers of eta - 1 that rise in the run, for the best worst "
         "element. Where it is given, almesh improve minimises it; else it raises the least scaled Jacobian."},
        {"power", number<&Deck::power>({2, 128}),
         "Exponent of eta (objective = squared) or of eta - 1; auto: 2. With objective = minimax it is the last "
         "exponent; auto: 64, or less where the largest eta no longer decreases."},
        {"delta", number<&Deck::distortion, &Distortion::delta>(not_negative),
         "Regularisation of det F in the distortion (Eq. 3), without unit; 0: none. Above 0, inverted elements have "
         "finite energy, and a step may invert an element."},
        {"weight_exponent", number<&Deck::weight_exponent>({0, 1}),
         "alpha: the integral over an element e counts as |e|^alpha. 1: as in the paper; 0: all elements count alike; "
         "auto: 0 with objective = minimax, else 0.5 with algorithm = adaptive, so that small elements keep their "
         "shape, else 1."},
        {"method", choice<&Deck::method, &Method::moving>({"augmented_lagrangian", "penalty"}),
         "How the mesh is moved. penalty, there for comparison: without multipliers, the penalty grows tenfold after "
         "every minimisation."},
        {"algorithm", choice<&Deck::method, &Method::algorithm>({"adaptive", "paper", "literal"}),
         "Schedule of the augmented Lagrangian method. adaptive: the multipliers are updated after every "
         "minimisation; paper: Algorithm 1 as corrected; literal: Algorithm 1 as printed."},
        {"ideal", ideal(),
         "Ideal mesh, whose elements have no distortion. straight: the mesh of the file with straight sides, as in the "
         "paper; given: as it is in the file, curved elements included; auto: straight, but given where the mesh folds "
         "with straight sides and is valid with curved ones. With the others the mesh of the file may have inverted "
         "elements, which are made valid first. regular: regular cells, of the size of the elements around; size: with "
         "edges of the length that a formula of x, y, z gives at the element; mesh: the elements of the same nodes, by "
         "their ids, in another file."},
        {"start", start(),
         "First iterate. identity: the ideal mesh; coarse: the solution on the mesh refined less, or of lower degree, "
         "which is found the same way; auto: coarse with algorithm = adaptive, else identity. A file: the positions "
         "of its nodes, by their ids, in a mesh with the same elements; the ideal mesh stays that of mesh. With "
         "so-far.msh, which a run writes in the folder of its results once a minute and when it is stopped, it goes on "
         "from there."},
        {"continuation", choice<&Deck::continuation>({"auto", "never", "always"}),
         "Whether the motion is done in load increments. never: at once; always: every turn as it is written, also "
         "beyond 180 degrees, so that the mesh turns as often as the boundary does; auto: with algorithm = adaptive, "
         "turns above 90 degrees, by the shorter way, and any motion that fails at once."},
        {"local_repair", choice<&Deck::local_repair>({"auto", "0", "1"}),
         "Curved meshes whose boundaries are all fixed. 1: only the nodes of elements that are invalid in the mesh file "
         "move, and those of as many elements around them as a valid mesh needs; 0: all nodes; auto: 0 for a small "
         "mesh, else 1."},
        {"min_certified_bound", number<&Deck::min_certified_bound>({0, 0.5}),
         "Curved meshes whose boundaries are all fixed: an element whose certified bound is not above this counts as "
         "invalid."},
        {"feature_angle", number<&Deck::feature_angle>({1, 180}),
         "Angle in degrees. Neighbouring faces of a sliding boundary at this angle or more belong to different "
         "surfaces: nodes slide along the edge between them, and corners do not slide."},
        {"surface_tolerance", number<&Deck::surface_tolerance>(not_negative),
         "ideal = regular, size or mesh: boundaries that only slide, and surfaces between regions, stay within this "
         "distance, in units of the local edge, of where the file has them. Nodes of faces that would be farther off "
         "stay where they are. A run that leaves the surface by more, since no valid mesh was found on it, has not "
         "converged where this key is given."},
        {"stop", choice<&Deck::stops_valid>({"best", "valid"}),
         "ideal = regular, size or mesh. valid: the run ends when the mesh is valid; best: it makes it better then."},
        {"guard", choice<&Deck::guard>({"auto", "scaled_jacobian", "certified_bound"}),
         "ideal = regular: which least value of a mesh may not fall when it is made better; auto: the certified bound of "
         "curved cells, the scaled Jacobian of straight ones."},
        {"size_change", number<&Deck::size_change>({0, 10}),
         "ideal = regular: the part by which sizes of elements and wall spacings may change once the mesh is valid; 0: "
         "they are free; auto: 0.2 where boundaries have layers of flat cells, else 0."},
        {"surface", choice<&Deck::surface>({"auto", "keep", "slide", "straighten"}),
         "What is done where no valid mesh has the target as its boundary. auto: the boundary nodes there slide along "
         "the surface, and of fixed boundaries faces become flatter where that does not help; keep: the run is refused; "
         "slide: all prescribed boundary nodes slide; straighten, with all boundaries fixed: none slides, and faces "
         "become flatter, as few as a valid mesh needs."},
        {"split", choice<&Deck::split>({"never", "auto", "around"}),
         "auto: triangles and tetrahedra that the target inverts, wherever the nodes inside are, are divided by nodes "
         "inside; all others stay as they are, and so do the boundaries; around: so are those that share an edge with "
         "them and have one between boundary nodes. What is left is left to surface."},
        {"mu0", number<&Deck::method, &Method::mu0>(positive),
         "First penalty mu of algorithms paper and literal and of method penalty, in units of |1|^2, the sum of |f|/h "
         "over the boundary faces."},
        {"omega0", number<&Deck::method, &Method::omega0>(positive),
         "Algorithms paper and literal: tolerance of the gradient norm |grad E| in the first minimisation."},
        {"epsilon0", number<&Deck::method, &Method::epsilon0>(positive),
         "Algorithms paper and literal: first tolerance of the squared constraint norm. Where the norm is above it, "
         "Algorithm 1 raises mu; where it is below, it updates lambda."},
        {"omega_star", number<&Deck::method, &Method::omega_star>(positive), "Final tolerance of the gradient norm."},
        {"epsilon_star", number<&Deck::method, &Method::epsilon_star>(positive),
         "Final tolerance of the squared constraint norm."},
        {"wall_tolerance", number<&Deck::method, &Method::wall_tolerance>(positive),
         "Algorithm adaptive: final tolerance of the distance of every boundary node from its target, in heights of "
         "the cells at the node."},
        {"length_scale", number<&Deck::length_scale>(positive),
         "Unit of length of all tolerances; auto: |domain|^(1/n); 1: absolute values as in the paper."},
        {"max_al_iterations", number<&Deck::method, &Method::max_iterations>({1, 1000}),
         "Largest number of augmented Lagrangian iterations."},
        {"max_newton_iterations", number<&Deck::method, &Method::max_newton_iterations>({1, 100000}),
         "Largest number of Newton steps of one minimisation."},
        {"solver", choice<&Deck::linear, &Linear::kind>({"auto", "cg", "gmres", "cholesky"}),
         "Linear solver; auto: Cholesky in 2D and for small meshes in 3D, conjugate gradients for large ones."},
        {"preconditioner", choice<&Deck::linear, &Linear::preconditioner>({"auto", "ilu0", "ssor", "pmg"}),
         "Preconditioner of cg. pmg: ssor with a correction of degree 1; auto: pmg for degrees above 1, ssor for "
         "linear tetrahedra, ilu0 for other linear cells unless it meets bad pivots."},
        {"forcing", choice<&Deck::forcing>({"auto", "fixed"}),
         "Which relative residual ends cg and gmres. auto: after full steps, that of the rule of Eisenstat and "
         "Walker, smaller where steps invert thin cells; fixed: 1e-10."},
        {"quadrature", number<&Deck::distortion, &Distortion::exactness>({0, 40}),
         "The quadrature is exact for polynomials up to this degree, of cells but simplices in each factor; 0: chosen "
         "by the degree of the elements. Linear triangles and tetrahedra ignore the key."},
        {"iterates", number<&Deck::iterates>({0, 1000000}),
         "After every so many Newton steps the mesh is written as iterate-0000.vtk, ..., and listed in "
         "iterates.vtk.series, which ParaView plays. Steps on coarser meshes are not counted. 0: never."},
        {"vtk", choice<&Deck::vtk>({"ascii", "binary", "none"}),
         "Format of the VTK files. ascii: text; binary: faster to write and read; none: no VTK files."},
        {"proof", choice<&Deck::proof>({"no", "yes"}),
         "also write a proof that the final mesh, and that of each frame, is valid and injective, for tests/verify.py."},
        {"final", choice<&Deck::final_format>({"input", "msh", "su2", "both"}),
         "Format of the final mesh. input: that of the mesh file, with nothing changed but the coordinates; with other "
         "nodes (degree, refine, split) written anew, in MSH 2.2 or SU2; msh: MSH 2.2; su2: SU2; both: these two."},
        {"contact", text<&Deck::contact>("NAME, NAME [; NAME, NAME ...]"),
         "Boundaries that lie on each other, curved or faceted, and do not match, so that they overlap a little: the "
         "mesh is certified but for that, and the overlap is measured. One name: a boundary and itself. Faces that "
         "match, and plane ones, touch without this key."},
        {"wall", text<&Deck::wall>("boundary name"),
         "Boundary from which the distance of every node is written to the VTK files; \"\": none."},
        {"max_seconds", number<&Deck::max_seconds>({0, 1e9}),
         "The run ends as `interrupted` after the Newton step in which so many seconds have passed. Its results are "
         "written. 0: never."},
        {"resume", number<&Deck::resume>({0, 1}),
         "1: a run of frames that was interrupted or killed goes on after its last frame. It ends with the same bits "
         "as a run without the interruption. Others go on with start = so-far.msh."},
        {"frames", text<&Deck::frames>("FROM : STEP : TO, times, file or -"),
         "Times t of a motion whose numbers and formulas name t, one mesh for each: 0 : 0.02 : 1, or 0, 0.1, 0.5, or a "
         "file of times. \"\": one mesh, without time. -: a line of standard input for each, `T` or `T FILE`, the file "
         "that a step `file - displacement` takes; its answer is a line of standard output, `T converged MESH` or `T "
         "STATUS SENTENCE`. The same T again replaces the mesh."},
        {"keep_going", choice<&Deck::keep_going>({"no", "yes"}),
         "Whether frames go on after one that fails; it stands in frames.csv."},
        {"velocity", choice<&Deck::velocity>({"no", "nodes", "faces"}),
         "What is written of the motion of the mesh, with frames. nodes: displacement from the mesh file, and the "
         "velocity by differences in t of first and second order, in frame-0001-velocity.csv and the VTK file, 0 in "
         "the first frame; faces: also the volume that each face has swept since the frame before, in "
         "frame-0002-swept.csv, > 0 from `element` to `neighbour`: an element gains what its faces sweep."},
        {"threads", number<&Deck::threads>({0, 1024}),
         "Number of threads; 0: all, or OMP_NUM_THREADS where that is set."},
    };
    return table;
}

void set_value(Deck& deck, const DeckKey& key, std::string_view text) {
    if (const auto hint = key.value.set(deck, text))
        throw UsageError(key.name, " = ", text, ": expected ", key.value.legal, *hint);
}

namespace {

// What else a deck may have: how it is written, what stands after =, its meaning.
constexpr const char* other_lines[][3] = {
    {"boundary NAME", "STEP [; STEP ...]",
     "Motion of a boundary: its steps, in this order. Each boundary of the mesh has a line; a line `boundary rest` is "
     "for all that have none. With frames, a number of a step may be a formula of t in double quotes, and %04d in the "
     "name of a file is the number of the frame."},
    {"volume NAME", "STEP [; STEP ...]", "Motion of all nodes of a physical group of elements."},
    {"select NAME", "CONDITION | part NUMBER ...",
     "Makes a boundary of outer faces, by a condition on x, y, z of their centres and nx, ny, nz of their normals, or "
     "by the numbers of smooth parts, which almesh info shows."},
    {"let NAME", "NUMBER",
     "A constant that formulas and numbers of steps may name: `translate NAME 0`, `rotate \"30*NAME\"`. A number, or "
     "a formula of the constants before it."},
    {"expect QUANTITY", "<= | >= | = VALUE",
     "What a quantity of the summary has to be at the end of the run, else the exit code is 5. A decimal number after "
     "= needs `+- TOLERANCE`."},
    {"sweep KEY", "VALUE, VALUE, ... | FROM:STEP:TO",
     "Values of a key for almesh sweep DECK, which runs all combinations of the lines of this kind, each in a folder "
     "named by its values, and makes a table of them, sweep.csv."},
};

}  // namespace

std::string keys_table(const std::vector<Named>& history) {
    const std::vector<std::size_t> width = {23, 11, 33, 33};
    const Deck defaults;
    std::string text = table_row({"KEY", "DEFAULT", "LEGAL VALUES", "MEANING"}, width);
    for (const DeckKey& key : deck_keys()) {
        const std::string value = key.value.text(defaults);
        text += table_row({key.name, value == "\"\"" ? "-" : value, key.value.legal, key.meaning}, width);
    }
    for (const auto& [written, legal, meaning] : other_lines) text += table_row({written, "", legal, meaning}, width);
    const auto list = [&text](const char* title, const std::vector<Named>& rows, std::size_t name_width) {
        text += std::string("\n") + title + ":\n";
        for (const Named& row : rows) text += table_row({row.name, row.meaning}, {name_width, 100 - name_width});
    };
    list("Steps of a motion", motion_forms(), 50);
    list("Quantities of the summary", summary_quantities(), 27);
    list("Columns of history.csv", history, 27);
    return text;
}

}  // namespace almesh
