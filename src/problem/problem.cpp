#include "problem/problem.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "problem/base_mesh.hpp"
#include "problem/drawing.hpp"
#include "problem/infeasible_target.hpp"
#include "problem/memory.hpp"
#include "problem/node_targets.hpp"
#include "base/error.hpp"
#include "base/physical_memory.hpp"
#include "base/text.hpp"
#include "check/certificate.hpp"
#include "constraint/sliding_boundary.hpp"
#include "constraint/sliding_nodes.hpp"
#include "energy/mixed_energy.hpp"
#include "energy/vertex_interpolation.hpp"
#include "geometry/patch.hpp"

namespace almesh {
namespace {

Mesh discretised(const Mesh& base, int refinements, int degree) {
    const Mesh refined = refine(base, refinements);
    return degree == 1 ? linear_part(refined) : interpolated(refined, degree);
}

// x + fraction (X - x), which at the fraction 1 is X to the last bit.
std::vector<double> between(const std::vector<double>& x, std::vector<double> X, double fraction) {
    for (std::size_t i = 0; i < X.size() && fraction < 1; ++i) X[i] = x[i] + fraction * (X[i] - x[i]);
    return X;
}

// The target of a mesh in the file's frame at a fraction of the motions, from where its ideal mesh has the boundary to
// where they take that of the mesh; x: its nodes, curved by the same fraction. placed: by files, at the end of the
// motion. Throws InputError where boundaries that share nodes do not agree there.
BoundaryTarget target_at(double fraction, const Mesh& mesh, const std::vector<double>& x,
                         const std::vector<double>& ideal, std::vector<Motion> motions, PlacedNodes placed,
                         const SharedNodes& shared) {
    for (Motion& motion : motions)
        if (fraction < 1) motion = at_fraction(motion, fraction);
    for (PlacedBoundary& boundary : placed) boundary.x = between(ideal, std::move(boundary.x), fraction);
    return make_target(mesh, x, motions, placed, shared);
}

// The pairs of nodes on periodic sides of a mesh in the file's frame. Slaves follow their masters, whatever boundaries
// they are on. Throws InputError where the images of a node are to go to different places.
PeriodicPairs pair_nodes(const std::vector<char>& periodic, const Mesh& mesh, BoundaryTarget& target) {
    if (std::count(periodic.begin(), periodic.end(), 1) == 0) return {};
    const char* const advice = " give the sides lines of their own, as `boundary NAME = fixed`";
    if (periodic_boundaries(mesh, periodic) != periodic)
        throw InputError("periodic sides cannot move as one: their faces do not correspond, so that in degree ",
                         mesh.degree, ", or refined, nodes are without an image:", advice);
    enum Hold { nothing, surface, position };
    std::vector<int> hold(mesh.nodes(), nothing), boundary(mesh.nodes(), 0);
    std::vector<double> at = mesh.x;
    for_face_nodes(mesh, [&](int f, std::size_t k) {
        const NodeKind kind = target.kind[k];
        const int i = mesh.faces[k];
        const int held = is_prescribed(kind) ? position : kind == NodeKind::slides ? surface : nothing;
        if (held < hold[i]) return;
        hold[i] = held;
        boundary[i] = mesh.face_boundary[f];
        if (held == position) std::copy_n(&target.node[k * mesh.dim], mesh.dim, point(at, i, mesh.dim));
    });
    const PeriodicPairs pairs = periodic_pairs(mesh, periodic, hold, position);
    const auto told = [&](int i) {
        return concat("node ", mesh.file.node_id[i], " of boundary ", mesh.boundaries[boundary[i]], " ",
                      hold[i] == position ? "to " + position_text(point(at, i, mesh.dim), mesh.dim) : "anywhere");
    };
    const double rounding = 1e-9 * size_of(mesh);
    for (const PeriodicPairs::Pair& pair : pairs.held)
        if (hold[pair.slave] != position ||
            pair.mismatch(at, mesh.dim) > rounding + 2 * pair.mismatch(mesh.x, mesh.dim))
            throw InputError("periodic sides cannot move as one: ", told(pair.master), ", but its image, ",
                             told(pair.slave), ": let both move alike there, or", advice);
    std::vector<char> is_slave(mesh.nodes(), 0), stays(mesh.nodes(), 0);
    for (const PeriodicPairs::Pair& pair : pairs.pairs) is_slave[pair.slave] = 1;
    for (const int i : pairs.centres) stays[i] = hold[i] != position;
    for (std::size_t k = 0; k < mesh.faces.size(); ++k) {
        if (is_slave[mesh.faces[k]]) target.kind[k] = NodeKind::free;
        if (stays[mesh.faces[k]]) target.kind[k] = NodeKind::fixed;
    }
    return pairs;
}

// The target of the level, which is in the file's frame. placed: as below.
BoundaryTarget target_on(const Problem& problem, const Level& level, PlacedNodes& placed) {
    for (PlacedBoundary& boundary : placed)
        for (std::vector<double>* const field : {&boundary.x, &boundary.left_out})
            if (!field->empty()) *field = on_level(problem.shape(), std::move(*field), level);
    const Mesh& mesh = level.mesh;
    BoundaryTarget target = target_at(1, mesh, mesh.x, level.ideal, problem.motions, placed, problem.shared);
    prescribe_shared_nodes(mesh, target);
    return target;
}

}  // namespace

std::vector<double> on_level(const Mesh& shape, std::vector<double> positions, const Level& level) {
    if (level.mesh.element_count() != shape.element_count())
        return prolong(shape, straight_sided(shape), level.mesh, level.ideal, positions);
    Mesh moved = shape;
    moved.x = std::move(positions);
    moved = discretised(moved, 0, level.mesh.degree);
    positions.resize(level.mesh.x.size());
    for (std::size_t k = 0; k < moved.elements.size(); ++k)
        std::copy_n(point(moved.x, moved.elements[k], moved.dim), moved.dim,
                    point(positions, level.mesh.elements[k], moved.dim));
    return positions;
}

std::unique_ptr<Level> discretise(const Problem& problem, int refinements, int degree, PlacedNodes& placed,
                                  BoundaryTarget& target) {
    auto level = std::make_unique<Level>();
    level->mesh = discretised(problem.base, refinements, degree);
    level->ideal = problem.ideal_of(level->mesh);
    target = target_on(problem, *level, placed);
    level->pairs = pair_nodes(problem.periodic, level->mesh, target);
    return level;
}

namespace {

// Of the run, in units of the file: what the options say, or so that the mesh has the volume 1.
double unit_of_length(const ProblemOptions& options, const std::string& name, double volume, int dim) {
    if (volume == 0)
        throw InputError(name, ": the volumes of its elements add up to 0, as where all nodes are in one place, "
                         "on a line or in a plane: no mesh can be made of it");
    constexpr double most = 1e50;  // a mesh of that size has volumes, and products of them, within the range of numbers
    const double size = std::pow(std::abs(volume), 1.0 / dim), unit = options.length_scale.value_or(size);
    if (size / unit >= 1 / most && size / unit <= most) return unit;
    throw SettingError("length_scale", "in units of length_scale = ", unit, " the mesh is ",
                       size / unit, " long, which is beyond the range of numbers: leave the key out");
}

// Boundaries along which nodes slide.
std::vector<char> slides(const Mesh& mesh, const BoundaryTarget& target) {
    std::vector<char> result(mesh.boundaries.size(), 0);
    for (int f = 0; f < mesh.face_count(); ++f)
        if (target.slides(mesh, f)) result[mesh.face_boundary[f]] = 1;
    return result;
}

// The surfaces along which nodes slide at a fraction of the motions: those of the file's mesh or, if the target frees
// nodes, of this mesh curved by the fraction. Null if no node slides. target: of the mesh.
std::shared_ptr<SlidingSurfaces> surfaces_at(double fraction, const ProblemOptions& options, const Problem& problem,
                                             const Mesh& mesh, const BoundaryTarget& target,
                                             const std::vector<Motion>& motions,
                                             const std::vector<OtherSurface>& other = {}) {
    const std::vector<char> sliding = slides(mesh, target);
    if (std::count(sliding.begin(), sliding.end(), 1) == 0) return nullptr;
    Mesh shape = problem.shape();
    const std::vector<double> ideal = problem.ideal_of(shape);
    if (target.frees()) shape.x = between(ideal, std::move(shape.x), fraction);
    PlacedNodes placed = problem.placed;
    for (PlacedBoundary& boundary : placed)  // nodes that a file leaves out slide along the boundary as the mesh has it
        if (!boundary.left_out.empty()) boundary = {{}, std::vector<double>(shape.x.size(), 1.0)};
    const BoundaryTarget of_shape =
        target_at(fraction, shape, shape.x, ideal, motions, std::move(placed), problem.shared);
    return std::make_shared<SlidingSurfaces>(shape, of_shape.node, sliding, options.feature_angle, problem.frame,
                                             other);
}

// From the file's frame to the run's.
void take_to_run(const Frame& frame, int dim, BoundaryTarget& target) {
    frame.take_to_run(target.node, dim);
    frame.take_to_run(target.sample, dim);
}

// One for each boundary; of a mesh that is improved, one for all.
void note_surfaces(const SlidingSurfaces& sliding, bool together, Problem& problem) {
    const Mesh& mesh = problem.mesh();
    std::map<std::string, int> count;
    const auto note = [&](const std::string& subject) {
        std::string text;
        for (const auto& [name, times] : count)
            text += (text.empty() ? "" : ", ") + name +
                    (times > 1 ? concat(" (", times, " parts)") : std::string());
        if (!text.empty()) problem.notes.push_back(subject + text);
        count.clear();
    };
    for (int b = 0; b < static_cast<int>(mesh.boundaries.size()); ++b) {
        for (int part = 0; part < sliding.parts(); ++part)
            if (sliding.boundary(part) == b) ++count[sliding.surface(part).name()];
        const MotionStep* const other = surface_step(problem.motions[b]);
        const std::string along = other ? " along " + other->file + ": " : " along: ";
        if (!together || other) note("boundary " + mesh.boundaries[b] + " slides" + along);
    }
    note("boundary nodes slide along: ");
}

void note_pairs(Problem& problem) {
    std::string sides;
    for (std::size_t b = 0; b < problem.periodic.size(); ++b)
        if (problem.periodic[b]) sides += (sides.empty() ? "" : ", ") + with_quotes(problem.base.boundaries[b]);
    if (!sides.empty())
        problem.notes.push_back(concat("periodic sides that move as one: ", sides, ", ",
                                       counted(problem.pairs.count(), "pair"),
                                       " of nodes; a line of its own for a side ends that"));
    else if (!problem.base.file.periodic.empty())
        problem.notes.push_back(concat("no periodic sides move as one here: ", without_motion));
}

void take_to_run(const Frame& frame, Level& level) {
    level.mesh.rounding = 16 * std::numeric_limits<double>::epsilon() * length(frame.origin) / frame.length;
    frame.take_to_run(level.mesh.x, level.mesh.dim);
    frame.take_to_run(level.ideal, level.mesh.dim);
    level.pairs = level.pairs.in(frame);
}

// Whether a curved mesh is only to be made valid, with what may be done to its boundary (curving.hpp).
bool curves_in_place(const ProblemOptions& options, const Problem& problem) {
    return (problem.mesh().degree > 1 || options.local_repair == LocalRepair::yes) && options.distortion.delta == 0 &&
           !options.in_time && (options.start != Start::file || problem.standing) && !is_improved(options.ideal) &&
           (!problem.is_own_ideal || options.local_repair == LocalRepair::yes) && options.split == Split::never &&
           options.method.moving == MovingMethod::augmented_lagrangian &&
           (options.surface == SurfaceKind::automatic || options.surface == SurfaceKind::straighten) &&
           std::all_of(problem.motions.begin(), problem.motions.end(), is_fixed);
}

void read_motions(const ProblemSetup& setup, Problem& problem) {
    problem.motions = motions_of(setup, problem.base, &problem.periodic);
    problem.shared = {setup.shared_nodes, {}};
    for (const std::string& name : problem.base.boundaries) {
        const BoundaryMotion* const line = motion_for(setup, name);
        const std::ptrdiff_t last = std::ssize(setup.boundaries);
        problem.shared.rank.push_back(static_cast<int>(line ? line - setup.boundaries.data() : last));
    }
    NodeTargets targets = read_node_targets(problem.base, problem.motions);
    problem.raised = std::move(targets.raised);
    problem.placed = problem.level_placed = std::move(targets.placed);
}

void check_split(const ProblemOptions& options, const Mesh& mesh) {
    if (options.split != Split::never && !mesh.is_simplicial())
        throw SettingError("split", "split divides triangles and tetrahedra, but the mesh has ", mesh.elements_text(),
                           ": leave it out");
}

// With fewer points than |F|^2 needs, the energy does not see some motions of the nodes inside an element.
void check_quadrature(int exactness, const Mesh& mesh, int degree) {
    const int least = mesh.is_simplicial() ? 2 * (degree - 1) : 2 * degree;
    if (exactness != 0 && exactness < least)
        throw SettingError("quadrature", "quadrature = ", exactness, " is too low for elements of degree ", degree,
                           ": take at least ", least, ", or 0");
}

// A mesh that is its own ideal mesh has no coarser one, and one of lower degree has another shape.
void check_curved_ideal(const ProblemOptions& options, const Mesh& in_file, const Mesh& of_run) {
    if (options.start == Start::coarse)
        throw SettingError("start", "start = coarse needs a straight-sided ideal mesh; with ideal = given take start = "
                           "identity");
    if (of_run.degree < in_file.degree && !certify(of_run, of_run.x).valid)
        throw SettingError("degree", "in degree ", of_run.degree, " the curved mesh, which is the ideal mesh with "
                           "ideal = given, is not valid: take degree = ", in_file.degree);
}

// The mesh as the method sees it, and where its boundary is to go.
void discretise(const ProblemSetup& setup, Problem& problem) {
    check_split(setup, problem.base);
    const int degree = setup.degree ? setup.degree : problem.base.degree;
    check_quadrature(setup.distortion.exactness, problem.base, std::max(degree, problem.base.degree));
    check_memory(problem.base, degree, setup.refine, linear_of(setup, {}), available_memory());
    read_motions(setup, problem);
    problem.level = discretise(problem, setup.refine, degree, problem.level_placed, problem.target);
    problem.pairs = problem.level->pairs;
    if (problem.is_own_ideal) check_curved_ideal(setup, problem.base, problem.mesh());
    problem.node_target = problem.target.node;
}

// Along what nodes slide; null where none does.
std::shared_ptr<SlidingSurfaces> make_surfaces(const ProblemSetup& setup, Problem& problem) {
    BoundaryTarget& target = problem.target;
    problem.other = read_other_surfaces(setup, problem.base, problem.notes);
    draw_onto(setup, problem);
    if (target.prescribes_all()) return nullptr;
    const auto is_free = [](const Motion& motion) { return kind_of(motion) == NodeKind::free; };
    if (std::all_of(problem.motions.begin(), problem.motions.end(), is_free))
        throw SettingError("", "all boundaries are free: give at least one of them a motion");
    const auto sliding = surfaces_at(1, setup, problem, problem.mesh(), target, problem.motions, problem.other);
    if (sliding) note_surfaces(*sliding, is_improved(setup.ideal), problem);
    return sliding;
}

// target: in the run's frame, placed: in the file's.
void set_constraint(const ProblemOptions& options, const Problem& problem, const BoundaryTarget& target,
                    const PlacedNodes& placed, Level& level) {
    const bool is_coarser = level.mesh.degree < problem.mesh().degree;
    const TargetKind kind = is_coarser ? TargetKind::nodal : options.target;
    level.constraint = make_constraint(level.mesh, level.ideal, target, kind, problem.sliding);
    std::vector<Motion> motions = problem.motions;
    level.turn = 0;
    for (Motion& motion : motions) {
        if (options.continuation != Continuation::always) motion = shortest(std::move(motion));
        level.turn = std::max(level.turn, turn(motion));
    }
    level.constraint_at = [&problem, &level, options, of_whole = target.kind, kind, motions,
                           placed](double fraction) -> std::unique_ptr<Constraint> {
        const Frame& frame = problem.frame;
        const int dim = level.mesh.dim;
        const std::vector<double> in_file = frame.to_file(between(level.ideal, level.mesh.x, fraction), dim);
        try {
            BoundaryTarget part = target_at(fraction, level.mesh, in_file, frame.to_file(level.ideal, dim), motions,
                                            placed, problem.shared);
            prescribe_shared_nodes(level.mesh, part);
            part.kind = of_whole;
            std::shared_ptr<SlidingSurfaces> sliding;  // of its own: another mesh's is where the motion ends
            if (problem.sliding) sliding = surfaces_at(fraction, options, problem, level.mesh, part, motions);
            take_to_run(frame, dim, part);
            return make_constraint(level.mesh, level.ideal, part, kind, sliding);
        } catch (const InputError&) {  // the motions of two boundaries agree at their ends only
            return nullptr;
        }
    };
}

void set_functional(const ProblemOptions& options, const Problem& problem, const BoundaryTarget& target,
                    const PlacedNodes& placed, Level& level) {
    DistortionParams distortion = distortion_of(options);
    distortion.curved_ideal = problem.is_own_ideal;
    distortion.regular = problem.regular;
    level.energy = make_energy(problem, level, distortion);
    level.energy->order_hessian([&](const BlockCsr& pattern) {
        return sweep_order(pattern, level.mesh.dim, linear_of(options, level.pairs), vertex_interpolation(level.mesh));
    });
    set_constraint(options, problem, target, placed, level);
}

}  // namespace

void move_target(const ProblemSetup& setup, Problem& problem) {
    std::vector<double> ideal;  // in the file's frame, as file_x is
    const auto swap_frames = [&](Problem* of) {
        of->level->mesh.x.swap(of->file_x);
        if (ideal.empty()) ideal = of->ideal_of(of->mesh());
        of->level->ideal.swap(ideal);
    };
    swap_frames(&problem);
    const std::unique_ptr<Problem, decltype(swap_frames)&> swap_back(&problem, swap_frames);
    read_motions(setup, problem);
    problem.target = target_on(problem, *problem.level, problem.level_placed);
    pair_nodes(problem.periodic, problem.mesh(), problem.target);
    problem.node_target = problem.target.node;
    free_infeasible(setup, problem);
    problem.sliding = make_surfaces(setup, problem);
    take_to_run(problem.frame, problem.mesh().dim, problem.target);
}

Problem begin_problem(const ProblemSetup& setup, BaseMesh base, std::vector<std::string> notes) {
    Problem problem;
    problem.base = std::move(base.mesh);
    problem.name = std::move(base.name);
    problem.is_own_ideal = base.is_own_ideal;
    problem.notes = std::move(notes);
    discretise(setup, problem);
    while (const int count = split_infeasible(setup, problem)) {
        problem.split_elements += count;
        discretise(setup, problem);
    }
    return problem;
}

void complete(const ProblemSetup& setup, Problem& problem) {
    if (setup.start == Start::file && !problem.standing && setup.local_repair == LocalRepair::yes)
        throw SettingError("start", "start = FILE does not go with local_repair = 1, but for so-far.msh of the same "
                           "run");
    problem.curves_in_place = curves_in_place(setup, problem);
    if (!problem.curves_in_place) {
        if (setup.surface == SurfaceKind::straighten)
            throw SettingError("surface", "surface = straighten is for a curved mesh that is made valid where it is, "
                               "with all boundaries fixed: else surface is auto, slide or keep");
        free_infeasible(setup, problem);
    }
    const Mesh& mesh = problem.mesh();
    note_pairs(problem);
    problem.frame.origin = local_origin(problem.base);
    problem.frame.length = unit_of_length(setup, problem.name, volume(mesh, problem.ideal()), mesh.dim);
    problem.sliding = make_surfaces(setup, problem);
    problem.file_x = mesh.x;
    take_to_run(problem.frame, mesh.dim, problem.target);
    take_to_run(problem.frame, *problem.level);
    hold_off_surface(problem);
}

Problem make_problem(const ProblemSetup& setup, BaseMesh base, std::vector<std::string> notes) {
    Problem problem = begin_problem(setup, std::move(base), std::move(notes));
    complete(setup, problem);
    return problem;
}

std::unique_ptr<DistortionEnergy> make_energy(const Problem& problem, const Level& level,
                                              const DistortionParams& params) {
    std::vector<char> infeasible;
    for (const std::string& why : problem.infeasible) infeasible.push_back(!why.empty());
    auto energy = infeasible.empty() ? make_energy(level.mesh, level.ideal, params)
                                     : std::make_unique<MixedEnergy>(level.mesh, level.ideal, params, infeasible);
    energy->set_pairs(level.pairs);
    return energy;
}

std::shared_ptr<SlidingSurfaces> surfaces_in_place(const ProblemOptions& options, const Problem& problem) {
    BoundaryTarget target = problem.target;
    free_nodes(problem.mesh(), std::vector<char>(problem.mesh().nodes(), 1), target);
    return surfaces_at(1, options, problem, problem.mesh(), target, problem.motions);
}

std::vector<char> straight_faces(const Problem& problem) {
    std::vector<char> straight(problem.mesh().face_count(), 0);
    for_face_nodes(problem.mesh(), [&](int f, std::size_t k) {
        const int dim = problem.mesh().dim;
        const double *const now = &problem.node_target[k * dim], *const in_file = &problem.target.written[k * dim];
        if (problem.curves_in_place && !std::equal(now, now + dim, in_file)) straight[f] = 1;
    });
    return straight;
}

void set_functional(const ProblemOptions& options, const Problem& problem) {
    set_functional(options, problem, problem.target, problem.level_placed, *problem.level);
}

void set_constraint(const ProblemOptions& options, const Problem& problem) {
    set_constraint(options, problem, problem.target, problem.level_placed, *problem.level);
}

std::unique_ptr<Level> coarser_level(const ProblemOptions& options, const Problem& problem,
                                     const CoarserMesh& coarser) {
    BoundaryTarget target;
    PlacedNodes placed = problem.placed;
    std::unique_ptr<Level> level = discretise(problem, coarser.refinements, coarser.degree, placed, target);
    if (problem.target.frees()) {
        const Infeasible infeasible = find_infeasible(level->mesh, level->ideal, target);
        if (infeasible.sliding_may_help()) {
            std::vector<char> freed = nodes_to_free(level->mesh, target, infeasible);
            for_face_nodes(level->mesh, [&](int f, std::size_t k) {
                if (!problem.sliding->knows(level->mesh.face_boundary[f])) freed[level->mesh.faces[k]] = 0;
            });
            level->pairs.keep(freed);
            free_nodes(level->mesh, freed, target);
        }
        // Its degree is too low for the shape.
        level->is_worth_little = level->mesh.degree > 1 && level->mesh.degree < problem.shape().degree;
    }
    take_to_run(problem.frame, level->mesh.dim, target);
    take_to_run(problem.frame, *level);
    set_functional(options, problem, target, placed, *level);
    return level;
}

}  // namespace almesh
