#include "app/problem.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "app/commands.hpp"
#include "app/deck_checks.hpp"
#include "app/folded_target.hpp"
#include "app/node_targets.hpp"
#include "app/other_surfaces.hpp"
#include "base/error.hpp"
#include "base/files.hpp"
#include "base/parallel.hpp"
#include "base/text.hpp"
#include "check/released_nodes.hpp"
#include "constraint/dirichlet.hpp"
#include "energy/vertex_interpolation.hpp"
#include "io/mesh_format.hpp"
#include "mesh/build.hpp"

namespace almesh {
namespace {

// The contents of a file that the deck names at `where`.
std::string read_named_file(const std::string& where, const std::string& path) {
    try {
        return read_file(path);
    } catch (const InputError& error) {
        throw InputError(where, ": ", error.what());
    }
}

RawMesh read_mesh_file(const Deck& deck, std::string& hash) {
    const std::string text = read_named_file(deck.given.at("mesh"), deck.mesh);
    RawMesh raw;
    parallel_invoke([&] { raw = parse_mesh(text, deck.mesh); }, [&] { hash = hash_of(text); });
    return raw;
}

// The motion, with `slide` last where it prescribes places.
Motion sliding(const Motion& motion) {
    if (hold_of(motion) != BoundaryHold::prescribed) return motion;
    const std::string steps = to_string(motion);
    return parse_motion(steps == "fixed" ? "slide" : steps + "; slide");
}

// One motion per boundary of the mesh; each must have one in the deck, `all` and `rest` stand for those not named.
std::vector<Motion> motions_of(const Deck& deck, const Mesh& mesh) {
    check_against_mesh(deck, mesh.dim, mesh.boundaries);
    std::vector<Motion> motions;
    std::vector<std::string> missing;
    for (const std::string& name : mesh.boundaries) {
        const DeckBoundary* const boundary = motion_for(deck, name);
        if (!boundary) missing.push_back(name);
        else if (deck.surface == SurfaceKind::slide) motions.push_back(sliding(boundary->motion));
        else motions.push_back(boundary->motion);
    }
    if (missing.empty()) return motions;
    std::string lines;
    for (const std::string& name : missing)
        lines += "\n  boundary " + quoted_where_needed(name, "#=\" \t") + " = fixed";
    throw UsageError(deck.path, ": ", counted(missing.size(), "boundary line"),
                     " missing; add `boundary rest = fixed`, or each of these with its motion:", lines);
}

// Wherever the results go, on however many threads, and in however many pieces.
std::string run_id(Deck deck, const std::string& mesh_hash) {
    const Deck defaults;
    deck.output = ".";
    deck.threads = defaults.threads;
    deck.max_seconds = defaults.max_seconds;
    deck.checkpoint = defaults.checkpoint;
    deck.resume = defaults.resume;
    return hash_of(resolved(deck) + mesh_hash);
}

Mesh discretised(const Mesh& base, int refinements, int degree) {
    const Mesh refined = refine(base, refinements);
    return degree == 1 ? linear_part(refined) : interpolated(refined, degree);
}

// The places on the level's mesh of those on the mesh `shape`, which has the same elements but for refinements: between
// its nodes as the elements have it.
std::vector<double> on_level(const Mesh& shape, std::vector<double> places, const Level& level) {
    if (level.mesh.element_count() != shape.element_count())
        return prolong(shape, straight_sided(shape), level.mesh, level.ideal, places);
    Mesh moved = shape;
    moved.x = std::move(places);
    moved = discretised(moved, 0, level.mesh.degree);
    places.resize(level.mesh.x.size());
    for (std::size_t k = 0; k < moved.elements.size(); ++k)
        std::copy_n(point(moved.x, moved.elements[k], moved.dim), moved.dim,
                    point(places, level.mesh.elements[k], moved.dim));
    return places;
}

// The base mesh, refined and of another degree, its ideal mesh and its target, in units of the file. placed: of the
// shape, on return of this mesh.
std::unique_ptr<Level> discretise(const Deck& deck, const Problem& problem, int refinements, int degree,
                                  PlacedNodes& placed, BoundaryTarget& target) {
    auto level = std::make_unique<Level>();
    level->mesh = discretised(problem.base, refinements, degree);
    level->ideal = straight_sided(level->mesh);
    for (std::vector<double>& of_boundary : placed)
        if (!of_boundary.empty()) of_boundary = on_level(problem.shape(), std::move(of_boundary), *level);
    target = make_target(level->mesh, motions_of(deck, level->mesh), placed);
    prescribe_shared_nodes(level->mesh, target);
    return level;
}

// Where the nodes are at a fraction of the way there from the ideal mesh.
PlacedNodes at_fraction(PlacedNodes placed, const std::vector<double>& ideal, double fraction) {
    for (std::vector<double>& of_boundary : placed)
        for (std::size_t i = 0; i < of_boundary.size(); ++i)
            of_boundary[i] = ideal[i] + fraction * (of_boundary[i] - ideal[i]);
    return placed;
}

// Of the run, in units of the file: what the deck says, or so that the mesh has the volume 1.
double unit_of_length(const Deck& deck, double volume, int dim) {
    constexpr double most = 1e50;  // a mesh of that size has volumes, and products of them, within the range of numbers
    const double size = std::pow(volume, 1.0 / dim), unit = deck.length_scale.value_or(size);
    if (size / unit >= 1 / most && size / unit <= most) return unit;
    throw UsageError(deck.given.at("length_scale"), ": in units of length_scale = ", unit, " the mesh is ",
                     size / unit, " long, beyond what can be computed with: leave it out");
}

// A mesh that is many times its size away from the origin of its file gets one of its own, in its middle.
Vec<3> local_origin(const Mesh& mesh) {
    constexpr double far = 16;
    Vec<3> low{}, high{}, middle{};
    for (int a = 0; a < mesh.dim; ++a) low[a] = high[a] = mesh.x[a];
    for (std::size_t k = 0; k < mesh.x.size(); ++k) {
        const auto a = static_cast<int>(k % mesh.dim);
        low[a] = std::min(low[a], mesh.x[k]);
        high[a] = std::max(high[a], mesh.x[k]);
    }
    for (int a = 0; a < mesh.dim; ++a) middle[a] = low[a] + 0.5 * (high[a] - low[a]);
    return length(middle) > far * length(high - low) ? middle : Vec<3>{};
}

// Boundaries along which nodes slide.
std::vector<char> slides(const Mesh& mesh, const BoundaryTarget& target) {
    std::vector<char> result(mesh.boundaries.size(), 0);
    for (int f = 0; f < mesh.face_count(); ++f)
        if (target.slides(mesh, f)) result[mesh.face_boundary[f]] = 1;
    return result;
}

// Null where no node slides. target: of the mesh `base`, in units of the file.
std::shared_ptr<SlidingSurfaces> sliding_surfaces(double feature_angle, const Mesh& base, const BoundaryTarget& target,
                                                  const std::vector<char>& slides, const Frame& frame,
                                                  const std::vector<OtherSurface>& other = {}) {
    if (std::count(slides.begin(), slides.end(), 1) == 0) return nullptr;
    return std::make_shared<SlidingSurfaces>(base, target.node, slides, feature_angle, frame, other);
}

// Takes back the release of nodes on boundaries whose surfaces are not known.
void keep_where_unknown(const Mesh& mesh, const SlidingSurfaces& sliding, BoundaryTarget& target) {
    for (int k = 0; k < static_cast<int>(mesh.faces.size()) && !target.released.empty(); ++k)
        if (!sliding.knows(mesh.face_boundary[k / mesh.face_nodes()])) target.released[mesh.faces[k]] = 0;
}

void note_surfaces(const Deck& deck, const Mesh& mesh, const SlidingSurfaces& sliding,
                   std::vector<std::string>& notes) {
    for (int b = 0; b < static_cast<int>(mesh.boundaries.size()); ++b) {
        std::map<std::string, int> count;
        for (int part = 0; part < sliding.parts(); ++part)
            if (sliding.boundary(part) == b) ++count[sliding.surface(part).name()];
        std::string text;
        for (const auto& [name, times] : count)
            text += (text.empty() ? "" : ", ") + (times > 1 ? std::to_string(times) + " of: " : std::string()) + name;
        const MotionStep* const other = surface_step(motion_for(deck, mesh.boundaries[b])->motion);
        const std::string along = other ? " along " + other->file + ": " : " along: ";
        if (!text.empty()) notes.push_back("boundary " + mesh.boundaries[b] + " slides" + along + text);
    }
}

void take_to_run(const Frame& frame, int dim, std::initializer_list<std::vector<double>*> positions) {
    for (std::vector<double>* const x : positions) frame.take_to_run(*x, dim);
}

void take_to_run(const Frame& frame, Level& level, BoundaryTarget& target) {
    take_to_run(frame, level.mesh.dim, {&level.mesh.x, &level.ideal, &target.node, &target.sample});
}

}  // namespace

DistortionParams distortion_of(const Deck& deck) {
    DistortionParams params = deck.distortion;
    const bool worst = params.objective == Objective::worst;
    const double usual = worst ? 0 : deck.method.algorithm == Algorithm::adaptive ? 0.5 : 1;
    params.weight_exponent = deck.weight_exponent.value_or(usual);
    if (!worst) params.power.p = deck.power.value_or(params.power.p);
    return params;
}

int increments_of(const Deck& deck) {
    return deck.increments.value_or(deck.method.moving == MovingMethod::incremental ? 10 : 1);
}

// The schedules of the paper do not follow the motion unless they are told to.
Follow followed(const Deck& deck) {
    const bool of_paper = deck.follow == Follow::automatic && deck.method.algorithm != Algorithm::adaptive;
    return of_paper ? Follow::never : deck.follow;
}

Problem make_problem(const Deck& deck) {
    check_start(deck);
    check_resume(deck);
    check_method(deck);
    check_region(deck);
    std::string mesh_hash;
    std::vector<std::string> notes;
    Mesh base = build_mesh(read_mesh_file(deck, mesh_hash), notes);
    return make_problem(deck, std::move(base), mesh_hash, std::move(notes));
}

Problem make_problem(const Deck& deck, Mesh base, const std::string& mesh_hash, std::vector<std::string> notes,
                     const SurfacesOfWhole& whole) {
    Problem problem;
    problem.base = std::move(base);
    problem.mesh_hash = mesh_hash;
    problem.notes = std::move(notes);
    check_quadrature(deck, std::max(deck.degree, problem.base.degree));
    const int degree = deck.degree ? deck.degree : problem.base.degree;
    check_final_degree(deck, degree);
    if (degree > 1 && problem.base.file.format.kind == FileFormat::Kind::su2)
        problem.notes.push_back("SU2 meshes are linear: the mesh of degree " + std::to_string(degree) +
                                " is written as final.msh");
    NodeTargets places = read_node_targets(problem.base, motions_of(deck, problem.base));
    problem.raised = std::move(places.raised);
    problem.placed = std::move(places.placed);
    PlacedNodes placed = problem.placed;
    problem.level = discretise(deck, problem, deck.refine, degree, placed, problem.target);
    problem.level_placed = std::move(placed);
    const Mesh& mesh = problem.mesh();
    check_final_ids(deck, mesh);
    problem.node_target = problem.target.node;
    if (deck.surface == SurfaceKind::straighten) straighten_folded(deck, problem);
    else release_folded(deck, problem);
    check_prescribed(deck, problem.target);
    problem.frame.origin = local_origin(problem.base);
    problem.frame.length = unit_of_length(deck, volume(mesh, problem.ideal()), mesh.dim);
    std::shared_ptr<SlidingSurfaces> sliding;
    if (!problem.target.prescribes_all()) {
        if (std::all_of(problem.target.hold.begin(), problem.target.hold.end(),
                        [](BoundaryHold hold) { return hold == BoundaryHold::free; }))
            throw UsageError(deck.path, ": all boundaries are free: give at least one of them a motion");
        if (whole.surfaces) {
            sliding = std::make_shared<SlidingSurfaces>(*whole.surfaces, whole.face, problem.base, problem.frame);
            keep_where_unknown(mesh, *sliding, problem.target);
        } else {
            const BoundaryTarget of_shape =
                make_target(problem.shape(), motions_of(deck, problem.base), problem.placed);
            const std::vector<OtherSurface> other = read_other_surfaces(deck, problem.base, problem.notes);
            sliding = sliding_surfaces(deck.feature_angle, problem.shape(), of_shape, slides(mesh, problem.target),
                                       problem.frame, other);
        }
        if (sliding) note_surfaces(deck, mesh, *sliding, problem.notes);
    }
    if (deck.region == Region::folded) problem.file_x = mesh.x;
    if (sliding) smooth_released(mesh, problem.target, *sliding);
    take_to_run(problem.frame, *problem.level, problem.target);
    problem.sliding = std::move(sliding);
    problem.run_id = run_id(deck, problem.mesh_hash);
    problem.level->mesh.file.comment = concat(version(), ", run ", problem.run_id);
    return problem;
}

void set_functional(const Deck& deck, const Problem& problem, const BoundaryTarget& target, const PlacedNodes& placed,
                    Level& level) {
    level.energy = make_energy(level.mesh, level.ideal, distortion_of(deck));
    level.energy->order_hessian([&](const BlockCsr& pattern) {
        return sweep_order(pattern, level.mesh.dim, deck.linear, vertex_interpolation(level.mesh));
    });
    const TargetKind kind = target.prescribes_all() ? deck.target : TargetKind::nodal;
    level.constraint = std::make_unique<Dirichlet>(level.mesh, level.ideal, target, kind, problem.sliding);
    std::vector<Motion> motions = motions_of(deck, level.mesh);
    for (Motion& motion : motions) {
        if (deck.follow != Follow::always) motion = shortest(std::move(motion));
        level.turn = std::max(level.turn, turn(motion));
    }
    const double angle = deck.feature_angle;
    level.constraint_at = [&problem, &level, motions, placed, kind, angle, released = target.released,
                           flat = target.straight](double fraction) {
        const Frame& frame = problem.frame;
        const int dim = level.mesh.dim;
        std::vector<Motion> parts;
        for (const Motion& motion : motions) parts.push_back(at_fraction(motion, fraction));
        Mesh in_file = level.mesh;  // curved by the same fraction, where the file is
        for (std::size_t i = 0; i < level.ideal.size(); ++i)
            in_file.x[i] = frame.to_file(level.ideal[i] + fraction * (level.mesh.x[i] - level.ideal[i]), i, dim);
        std::unique_ptr<Constraint> constraint;
        try {
            BoundaryTarget part =
                make_target(in_file, parts, at_fraction(placed, frame.to_file(level.ideal, dim), fraction));
            prescribe_shared_nodes(in_file, part);
            part.released = released;
            if (!flat.empty()) make_straight(in_file, flat, part);
            std::shared_ptr<SlidingSurfaces> sliding;
            if (problem.sliding) {
                Mesh shape = problem.shape();  // its surface as it is: but released nodes go with those that are not
                const std::vector<double> straight = straight_sided(shape);
                if (!released.empty())
                    for (std::size_t i = 0; i < straight.size(); ++i)
                        shape.x[i] = straight[i] + fraction * (shape.x[i] - straight[i]);
                const PlacedNodes shape_placed = at_fraction(problem.placed, straight, fraction);
                sliding = sliding_surfaces(angle, shape, make_target(shape, parts, shape_placed),
                                           slides(level.mesh, part), frame);  // of its own: another mesh's is the end
                if (sliding) smooth_released(level.mesh, part, *sliding);
            }
            take_to_run(frame, dim, {&part.node, &part.sample});
            constraint = std::make_unique<Dirichlet>(level.mesh, level.ideal, part, kind, sliding);
        } catch (const InputError&) {  // the motions of two boundaries agree at their ends only
        }
        return constraint;
    };
}

std::vector<CoarserMesh> coarser_meshes(const Deck& deck, const Problem& problem) {
    std::vector<CoarserMesh> coarser;
    for (int refinements = 0; refinements < deck.refine; ++refinements) coarser.push_back({refinements, 1});
    // The file's own curves are known from its degree on; but where nodes slide, they find their way at lower ones.
    const int of_file = problem.target.released.empty() ? problem.shape().degree : 1;
    for (int degree = 1; degree < problem.mesh().degree; degree = std::max(2 * degree, of_file))
        coarser.push_back({deck.refine, degree});
    return coarser;
}

std::unique_ptr<Level> coarser_level(const Deck& deck, const Problem& problem, const CoarserMesh& coarser) {
    BoundaryTarget target;
    PlacedNodes placed = problem.placed;
    std::unique_ptr<Level> level = discretise(deck, problem, coarser.refinements, coarser.degree, placed, target);
    if (level->mesh.degree > 1 && !problem.target.released.empty()) {
        const TargetFaults faults = find_faults(level->mesh, level->ideal, target);
        if (faults.may_be_mended()) target.released = released_nodes(level->mesh, target, faults);
        keep_where_unknown(level->mesh, *problem.sliding, target);
        level->is_worth_little = level->mesh.degree < problem.shape().degree;  // it has not the shape of the file
    }
    const bool has_faces = problem.target.straight.size() == static_cast<std::size_t>(level->mesh.face_count());
    if (level->mesh.degree > 1 && has_faces) make_straight(level->mesh, problem.target.straight, target);
    take_to_run(problem.frame, *level, target);
    Deck simpler = deck;
    if (level->mesh.degree < problem.mesh().degree) simpler.target = TargetKind::nodal;
    set_functional(simpler, problem, target, placed, *level);
    return level;
}

}  // namespace almesh
