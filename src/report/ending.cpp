// How a run ended, for its user: whether it converged and what is certified, and of any other ending what held it up
// (check/diagnosis.hpp), at which boundary, node and element, and what to try against that. Places and lengths are in
// the unit of the mesh file, ids those of final.msh.
#include "report/terminal.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "deck/deck_checks.hpp"
#include "deck/so_far.hpp"
#include "base/interrupt.hpp"
#include "base/table.hpp"
#include "problem/drawing.hpp"

namespace almesh {
namespace {

std::string shown(double value, int digits = 4) { return to_text(value, digits); }

std::string headline(Status status) {
    const bool late = status == Status::interrupted && out_of_time();
    return status_row(status).ending + std::string(late ? ": max_seconds have passed" : "");
}

std::string quality_of_element(const Solution& solution, int element) {
    return "eta " + shown(solution.al.distortion.element_max[element]) +
           ", certified bound " + rounded_down(solution.certificate.certified_bound[element], 4);
}

std::string name_of(const Mesh& mesh, const Diagnosis& diagnosis) {
    const bool is_node = diagnosis.node >= 0;
    return concat(is_node ? "node " : "element ",
                  is_node ? mesh.file.node_id[diagnosis.node] : mesh.file.element_id[diagnosis.element],
                  !diagnosis.on_boundary ? ", nearest to" : is_node ? " of" : " beside", " boundary ",
                  mesh.boundaries[diagnosis.boundary]);
}

std::string text_of_way(double way) {
    if (std::isnan(way)) return "";
    if (way < 0) return "; it was nearer at the start";
    return "; it has gone " + (way > 0.9999 ? "more than 99.99" : shown(100 * way)) + " % of its way";
}

// "node 107 of boundary inner at (0.9, 0.1) is 0.137 from its target (0.72, 0.28), 0.55 of the height of its cells"
std::string description(const Problem& problem, const Solution& solution) {
    const Mesh& mesh = problem.mesh();
    const Diagnosis& at = solution.diagnosis;
    if (at.kind == DiagnosisKind::none) return "";
    const auto position = [&](const std::array<double, 3>& x) {
        return position_text(problem.frame.to_file(x).data(), mesh.dim);
    };
    const std::string name = name_of(mesh, at), subject = name + " at " + position(at.position);
    switch (at.kind) {
        case DiagnosisKind::off_target:
            return subject + " is " + shown(at.distance * problem.frame.length) + " from its target " +
                   position(at.target) + ", " + shown(at.heights, 2) + " of the height of its cells" +
                   text_of_way(at.way);
        case DiagnosisKind::unbalanced:
            return subject + " has the largest part of |grad E|, " + shown(100 * at.share, 2) + " %";
        case DiagnosisKind::distorted:
            return subject + " is the most distorted: " + quality_of_element(solution, at.element);
        case DiagnosisKind::invalid:
            return subject + " has the least certified bound: " + quality_of_element(solution, at.element);
        default: return overlap_text(mesh, solution.injectivity, problem.frame) + ": " + name;
    }
}

std::string less_motion(const Solution& solution) {
    return "a smaller motion" +
           (solution.reached > 0 ? " (" + shown(solution.reached) + " of this one was reached)" : "");
}

// "boundary wall = slide or free": more freedom than the deck gives the boundary, as far as it accepts it; else "". A node
// that another boundary moves cannot slide, and one boundary has to remain that is not free.
std::string more_freedom(const Deck& deck, const Problem& problem, int b) {
    const Mesh& mesh = problem.mesh();
    const auto motion = [&](int of) {
        const BoundaryMotion* const line = motion_for(deck, mesh.boundaries[of]);
        return line ? line->motion : problem.motions[of];
    };
    std::vector<char> moved(mesh.nodes(), 0);
    bool may_slide = is_fixed(motion(b)), may_be_free = false;
    for_face_nodes(mesh, [&](int f, std::size_t k) {
        const int of = mesh.face_boundary[f];
        if (of == b) return;
        may_be_free = may_be_free || kind_of(motion(of)) != NodeKind::free;
        moved[mesh.faces[k]] |= kind_of(motion(of)) == NodeKind::target;
    });
    for_face_nodes(mesh, [&](int f, std::size_t k) {
        may_slide = may_slide && !(mesh.face_boundary[f] == b && moved[mesh.faces[k]]);
    });
    may_be_free = may_be_free && kind_of(motion(b)) != NodeKind::free;
    if (!may_slide && !may_be_free) return "";
    return concat("boundary ", quoted_where_needed(mesh.boundaries[b], "#=\" \t"), " = ", may_slide ? "slide" : "",
                  may_slide && may_be_free ? " or " : "", may_be_free ? "free" : "", ", if its nodes need not ",
                  kind_of(motion(b)) == NodeKind::slides ? "stay on its surface; " : "keep their positions; ");
}

// Against elements that are invalid by what their boundaries hold (check/infeasible.hpp).
std::string against_infeasible(const Deck& deck, const Problem& problem) {
    const Mesh& mesh = problem.mesh();
    std::vector<char> at(mesh.nodes(), 0), beside(mesh.boundaries.size(), 0);
    for (std::size_t e = 0; e < problem.infeasible.size(); ++e)
        for (int k = 0; k < mesh.element_nodes(static_cast<int>(e)) && !problem.infeasible[e].empty(); ++k)
            at[mesh.element(static_cast<int>(e))[k]] = 1;
    for_face_nodes(mesh, [&](int f, std::size_t k) { beside[mesh.face_boundary[f]] |= at[mesh.faces[k]]; });
    std::string to_try;
    for (std::size_t b = 0; b < beside.size(); ++b)
        if (beside[b]) to_try += more_freedom(deck, problem, static_cast<int>(b));
    return to_try + "a mesh file in which these elements are divided or left out";
}

// Against a target that is too far: what the run has not done yet.
std::string against_distance(const Deck& deck, const Problem& problem, const Solution& solution) {
    const double alpha = distortion_of(deck).weight_exponent;
    const Diagnosis& at = solution.diagnosis;
    const bool fixed = at.kind == DiagnosisKind::off_target && at.distance > 0 && std::isnan(at.way) &&
                       prescribed_nodes(problem.mesh(), problem.target)[at.node];
    std::string to_try;
    if (fixed) to_try += more_freedom(deck, problem, at.boundary);
    if (alpha > 0.5) to_try += "weight_exponent = 0.5 or 0; ";
    if (deck.target == TargetKind::least_squares && !problem.target.in_trace_space) to_try += "target = nodal; ";
    if (problem.base.degree == 1 && deck.refine < most_refinements) to_try += concat("refine = ", deck.refine + 1, "; ");
    if (continuation_of(deck) == Continuation::never) to_try += "continuation = always; ";
    return to_try + less_motion(solution);
}

std::string against_iterations(const Deck& deck, const Problem& problem, const Solution& solution) {
    const std::vector<AlIteration>& rows = solution.al.iterations;
    const double before = rows[rows.size() - 2].projected_constraint_norm, last = rows.back().projected_constraint_norm;
    if (last > 0.5 * before) return against_distance(deck, problem, solution);
    return concat("max_al_iterations = ", 2 * deck.method.max_iterations, ": |P c_D| fell from ",
                  shown(before * problem.frame.length, 3), " to ", shown(last * problem.frame.length, 3),
                  " in the last iteration");
}

std::string against_uncertified(const Deck& deck, const Problem& problem, const Solution& solution) {
    if (deck.distortion.delta > 0) return "delta = 0, with which no step inverts an element";
    if (solution.certificate.undecided > 0)
        return "smaller elements there: whether the undecided ones are valid is too close to tell";
    if (problem.target.frees())
        return "a finer mesh of the surface there: its faces are too large for its curvature";
    if (!problem.target.prescribes_all()) return "a motion without slide or free for the boundary there";
    const Injectivity& found = solution.injectivity;
    if (found.other_face < 0)
        return "another mesh file, where elements of this one lie over each other (almesh quality FILE); " +
               less_motion(solution);
    const Mesh& mesh = problem.mesh();
    const std::string a = mesh.boundaries[mesh.face_boundary[found.face]];
    const std::string b = mesh.boundaries[mesh.face_boundary[found.other_face]];
    return concat("contact = ", a, a == b ? "" : ", " + b,
                  ", where two sides lie on each other and do not match; else another mesh file");
}

// |grad E| is rounded in proportion to the penalty, which algorithm = adaptive chooses by itself.
std::string against_accuracy(const Deck& deck, const Solution& solution) {
    if (deck.method.moving == MovingMethod::penalty || deck.method.algorithm != Algorithm::adaptive)
        return "a smaller mu0, such as " + shown(1e-3 * deck.method.mu0) + ", or a larger omega0";
    return "a larger omega_star, such as " + shown(2 * solution.al.iterations.back().gradient_norm, 2);
}

std::string against_cause(const Deck& deck, const Problem& problem, const Solution& solution) {
    switch (solution.al.status) {
        case Status::converged: return against_uncertified(deck, problem, solution);
        case Status::stalled:
        case Status::line_search_failed: return against_distance(deck, problem, solution);
        case Status::overflow: return "a smaller mu0, such as " + shown(AugmentedLagrangianParams().mu0);
        case Status::attainable_accuracy:
        case Status::no_visible_gain: return against_accuracy(deck, solution);
        case Status::ended_as_printed: return "algorithm = paper, which goes on until both tests are met";
        case Status::max_al_iterations: return against_iterations(deck, problem, solution);
        case Status::max_newton_iterations:
            return concat("max_newton_iterations = ", 2 * deck.method.max_newton_iterations, "; ",
                          against_distance(deck, problem, solution));
        case Status::interrupted:
            if (std::filesystem::exists(path_so_far(deck))) return command_to_go_on(deck);
            return out_of_time() ? concat("max_seconds = ", 4 * deck.max_seconds)
                                 : "the run again: it starts from the mesh file";
        case Status::linear_solver_failed:
            if (solution.refused_bytes > 0) return "solver = cg, or a coarser mesh";
            if (deck.linear.kind != SolverKind::cholesky) return "solver = cholesky";
            return against_distance(deck, problem, solution);
        case Status::inverted:
        case Status::invalid_start: return against_infeasible(deck, problem);
        case Status::off_surface:
            return "a larger surface_tolerance: no valid mesh was found with the boundary of the file";
    }
    return "";
}

// What to try, the most promising first.
std::string remedies(const Deck& deck, const Problem& problem, const Solution& solution) {
    std::string to_try = against_cause(deck, problem, solution);
    if (problem.split_elements > 0 && deck.split == Split::automatic) to_try = "split = around; " + to_try;
    if (!problem.target.frees() || problem.curves_in_place || problem.mesh().degree > 1) return to_try;
    const bool can_split = problem.base.is_simplicial() && accepts(deck, "split", "auto");
    return can_split ? to_try + "; split = auto, so that no nodes slide" : to_try;
}

void print_diagnosis(std::FILE* out, const Deck& deck, const Problem& problem, const Solution& solution) {
    if (solution.al.status == Status::converged && solution.injectivity.certified) return;
    const Diagnosis& at = solution.diagnosis;
    std::string text = description(problem, solution);
    if (!text.empty()) text += "\n";
    if (at.node >= 0)
        text += concat("the most distorted element at the node, ", problem.mesh().file.element_id[at.element], ", has ",
                       quality_of_element(solution, at.element), "\n");
    print(out, text, "try ", remedies(deck, problem, solution), "\n");
}

std::string judgement(const Problem& problem, const Solution& solution) {
    if (const double overlap = solution.injectivity.overlap * problem.frame.length; solution.injectivity.certified)
        return concat("certified valid and injective",
                      overlap > 0 ? ", but that boundaries in contact overlap by " + shown(overlap) : "");
    if (!solution.certificate.valid) return "NOT certified valid (" + counts_of(solution.certificate) + ")";
    const bool told = solution.diagnosis.kind == DiagnosisKind::overlap;
    return "all elements valid, but NOT certified injective" +
           (told ? "" : ": " + overlap_text(problem.mesh(), solution.injectivity, problem.frame));
}

// Where the boundary is, beside where the deck's motions take it.
void print_boundary(std::FILE* out, const Deck& deck, const Problem& problem, const Solution& solution) {
    const BoundaryTarget& target = problem.target;
    const AlIteration& last = solution.al.iterations.back();
    const double error = solution.max_boundary_error * problem.frame.length;
    const std::string apart = distances_text(deck, problem, final_positions(problem, solution.x));
    const bool is_fit = deck.target == TargetKind::least_squares && target.prescribes_all() && !target.in_trace_space;
    if (solution.nodes_off_target > 0 && last.relative_boundary_error == 0)  // that was before round_as_file()
        print(out, counted(solution.nodes_off_target, "boundary node"), solution.nodes_off_target == 1 ? " is" : " are",
              " at the nearest position that the numbers of the mesh file can have; largest boundary error ",
              shown(error, 3), "\n");
    else if (solution.nodes_off_target > 0)
        print(out, "|c_D| = ", shown(last.constraint_norm * problem.frame.length, 3), "; ",
              counted(solution.nodes_off_target, "boundary node"), " off their targets, by at most ",
              shown(last.relative_boundary_error, 2), " of a cell's height; largest boundary error ", shown(error, 3),
              "\n");
    else if (solution.off_motion.nodes == 0 && !may_stay(deck, problem.motions))
        print(out, "every boundary node is where its motion takes it to the last bit",
              problem.sliding ? ", or on the surface along which it slides" : "",
              apart.empty() ? "; between the nodes the boundary is within " + shown(error, 3) + " of its motion" : "",
              "\n");
    if (solution.off_motion.nodes > 0 && (is_fit || solution.nodes_off_target == 0))
        print(out, is_fit ? "target = least_squares fits the boundary to its motion in the mean: " : "",
              counted(solution.off_motion.nodes, "boundary node"), " off their motions by at most ",
              shown(solution.off_motion.largest, 3), ", ",
              is_fit ? "between the nodes by at most " + shown(error, 3)
                     : "all others where their motions take them to the last bit", "\n");
    if (solution.freed_nodes)
        print(out, solution.freed_nodes, " nodes slid along the surface, by at most ",
              shown(solution.off_motion.largest_slide, 3), "; their faces are within ",
              shown(solution.surface_distance * problem.frame.length, 3), " of the surface\n");
    if (solution.straight_faces)
        print(out, solution.straight_faces, " of ", problem.mesh().face_count(),
              " faces were made flat, or flatter than in the file\n");
    print(out, moved_nodes_text(problem.mesh(), solution.off_motion.moved),
          distance_table(problem.mesh(), solution.distances, "the target as it came"), apart);
}

}  // namespace

void print_ending(std::FILE* out, const Deck& deck, const Problem& problem, const Solution& solution, int fallbacks) {
    std::string others;
    if (const int steps = solution.coarse_newton_iterations) others = concat(steps, " more on coarser meshes");
    if (const int steps = solution.al.earlier_newton_iterations)
        others += concat(others.empty() ? "" : ", ", steps,
                         problem.curves_in_place                           ? " more in other parts and attempts"
                         : is_improved(deck.ideal)                         ? " more in other attempts"
                         : deck.distortion.objective == Objective::minimax ? " more with earlier powers"
                                                                           : " more in earlier load increments");
    const bool in_place = may_stay(deck, problem.motions) && solution.al.status == Status::converged;
    if (!in_place || deck.needs_objective)
        print(out, headline(outcome(solution.al)), ": ", solution.al.iterations.size() - 1, " AL and ",
              solution.al.newton_iterations, " Newton iterations", others.empty() ? "" : " (" + others + ")", " in ",
              fixed(solution.time.total, 2), " s\n");
    print_diagnosis(out, deck, problem, solution);
    print_boundary(out, deck, problem, solution);
    if (solution.al.iterations.back().newton_status == Status::attainable_accuracy)
        print(out, "|grad E| stays above omega_star: what steps would gain is below the rounding of E\n");
    if (fallbacks)
        print(out, "the iterative solver failed in ", counted(fallbacks, "Newton step"),
              "; Cholesky solved them (why: history.csv)\n");
    if (solution.refused_bytes > 0)
        print(out, "the Cholesky factor takes ", shown(solution.refused_bytes / 1e9, 3),
              " GB, more than this machine's memory\n");
    const bool shows = solution.diagnosis.kind != DiagnosisKind::none && deck.vtk != VtkOutput::none;
    print(out, judgement(problem, solution), ": certified bound ",
          rounded_down(solution.certificate.min_certified_bound, 4),
          in_place ? "; in " + fixed(solution.time.total, 2) + " s" : "",
          deck.output.empty() ? "" : "; results in " + deck.output,
          shows ? ", the elements around it in stop.vtk" : "", "\n");
}

}  // namespace almesh
