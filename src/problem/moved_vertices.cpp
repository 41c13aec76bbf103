#include "problem/moved_vertices.hpp"

#include <algorithm>

#include "problem/base_mesh.hpp"
#include "problem/improve.hpp"
#include "problem/kept_surface.hpp"
#include "base/error.hpp"

namespace almesh {

std::vector<double> moved_vertices(const ProblemSetup& setup, const Problem& problem,
                                   const std::function<Solution(const ProblemSetup&, Problem&)>& improve_straight) try {
    ProblemSetup linear = setup;
    linear.degree = 1;
    Problem straight = make_problem(linear, {linear_part(problem.base), true});
    set_regular_elements(straight);
    hold_surface(linear, straight);
    const Solution solution = improve_straight(linear, straight);
    if (solution.al.status != Status::converged) return {};

    const Mesh& mesh = problem.mesh();
    const int dim = mesh.dim;
    Mesh moved = mesh;
    std::vector<char> is_vertex(mesh.nodes(), 0);
    for (int e = 0; e < mesh.element_count(); ++e)
        for (int v = 0; v < mesh.cell(e).vertices; ++v) is_vertex[mesh.element(e)[v]] = 1;
    std::size_t from = 0;
    for (std::size_t k = 0; k < mesh.x.size(); ++k) {
        if (!is_vertex[k / dim]) continue;
        const double in_file = straight.frame.to_file(solution.x[from], from, dim);
        if (solution.x[from] != straight.mesh().x[from]) moved.x[k] = problem.frame.to_run(in_file, k, dim);
        ++from;
    }
    const std::vector<double> before = straight_sided(mesh), now = straight_sided(moved);
    std::vector<double> x = mesh.x;
    for (std::size_t k = 0; k < x.size(); ++k)
        if (now[k] != before[k]) x[k] = is_vertex[k / dim] ? now[k] : x[k] + (now[k] - before[k]);
    return surface_distance(problem, x) <= setup.surface_tolerance ? x : std::vector<double>();
} catch (const Error&) {
    return {};
}

}  // namespace almesh
