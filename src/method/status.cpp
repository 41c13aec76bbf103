#include "method/status.hpp"

#include <algorithm>
#include <iterator>

namespace almesh {
namespace {

using enum Status;

constexpr StatusRow rows[] = {
    {converged, "converged", "converged", Cause::validity},
    {stalled, "stalled", "stalled: the boundary comes no nearer to its target", Cause::boundary},
    {attainable_accuracy, "attainable_accuracy",
     "not converged: |grad E| ended at its attainable accuracy, above omega0", Cause::gradient},
    {no_visible_gain, "no_visible_gain",
     "settled: the last steps gained next to nothing, with |grad E| above omega_star", Cause::gradient},
    {ended_as_printed, "ended_as_printed", "not converged: the loop as printed ended with one of its two tests met",
     Cause::boundary_or_gradient},
    {max_al_iterations, "max_al_iterations", "not converged: max_al_iterations reached", Cause::boundary_or_gradient},
    {max_newton_iterations, "max_newton_iterations", "not converged: max_newton_iterations reached in a subproblem",
     Cause::gradient},
    {line_search_failed, "line_search_failed",
     "not converged: no step decreases the energy and keeps all elements valid", Cause::distortion},
    {linear_solver_failed, "linear_solver_failed", "not converged: no linear solver gave a descent direction",
     Cause::gradient},
    {overflow, "overflow", "not converged: numbers grew beyond the range of double precision", Cause::boundary},
    {interrupted, "interrupted", "interrupted", Cause::boundary_or_gradient},
    {inverted, "inverted", "inverted: the method leaves elements that are not valid", Cause::validity},
    {invalid_start, "invalid_start", "not converged: with the boundary set, no valid mesh to start from",
     Cause::validity},
    {off_surface, "off_surface", "not converged: the boundary left the surface by more than surface_tolerance",
     Cause::validity},
};

}  // namespace

const StatusRow& status_row(Status status) {
    return *std::find_if(std::begin(rows), std::end(rows), [&](const StatusRow& row) { return row.status == status; });
}

const char* to_string(Status status) { return status_row(status).name; }

}  // namespace almesh
