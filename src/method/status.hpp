// How a minimisation, Algorithm 1, or another method ended: its name, and what held it up.
#pragma once

namespace almesh {

enum class Status {
    converged,
    stalled,                // the constraint stopped falling while the penalty grew, or all energy is penalty
    attainable_accuracy,    // |grad E| falls no further by rounding; of a run: constraint holds, |grad E| > omega0
    no_visible_gain,        // nodes slide, and steps hardly decreased E; of a run: see outcome()
    ended_as_printed,       // literal: the loop as printed ends when one of its two tests holds, and only one did
    max_al_iterations,
    max_newton_iterations,
    line_search_failed,
    linear_solver_failed,
    overflow,               // numbers beyond double precision, as with a huge penalty
    interrupted,            // by a signal
    inverted,               // of a mesh that is improved: elements that can be valid are not
    invalid_start,          // with the boundary on its target no valid mesh to start from (set_boundary.hpp)
    off_surface             // of a mesh that is improved: farther than the deck allows (problem/kept_surface.hpp)
};

// Whether rounding or sliding ended a minimisation although |grad E| is above its tolerance.
inline bool at_floor(Status status) {
    return status == Status::attainable_accuracy || status == Status::no_visible_gain;
}

// What held up a run, and where (check/diagnosis.hpp).
enum class Cause {
    validity,             // elements that are not valid, or else overlap
    gradient,             // the node with most of |grad E|
    distortion,           // the most distorted element
    boundary,             // the boundary node farthest from its target
    boundary_or_gradient  // this, unless the constraint holds
};

struct StatusRow {
    const char* name;    // in summary.txt and history.csv
    const char* ending;  // what a run's report says
    Cause cause;
};

inline constexpr StatusRow status_rows[] = {  // in the order of the statuses
    {"converged", "converged", Cause::validity},
    {"stalled", "stalled: the boundary comes no nearer to its target", Cause::boundary},
    {"attainable_accuracy", "not converged: |grad E| ended at its attainable accuracy, above omega0", Cause::gradient},
    {"no_visible_gain", "settled: the last steps gained next to nothing, with |grad E| above omega_star",
     Cause::gradient},
    {"ended_as_printed", "not converged: the loop as printed ended with one of its two tests met",
     Cause::boundary_or_gradient},
    {"max_al_iterations", "not converged: max_al_iterations reached", Cause::boundary_or_gradient},
    {"max_newton_iterations", "not converged: max_newton_iterations reached in a subproblem", Cause::gradient},
    {"line_search_failed", "not converged: no step decreases the energy and keeps all elements valid",
     Cause::distortion},
    {"linear_solver_failed", "not converged: no linear solver gave a descent direction", Cause::gradient},
    {"overflow", "not converged: numbers grew beyond the range of double precision", Cause::boundary},
    {"interrupted", "interrupted", Cause::boundary_or_gradient},
    {"inverted", "inverted: the method leaves elements that are not valid", Cause::validity},
    {"invalid_start", "not converged: with the boundary set, no valid mesh to start from", Cause::validity},
    {"off_surface", "not converged: the boundary left the surface by more than surface_tolerance", Cause::validity},
};

inline const StatusRow& status_row(Status status) { return status_rows[static_cast<int>(status)]; }
inline const char* to_string(Status status) { return status_row(status).name; }

}  // namespace almesh
