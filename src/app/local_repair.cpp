#include "app/local_repair.hpp"

#include <algorithm>
#include <limits>
#include <optional>

#include "base/error.hpp"
#include "base/text.hpp"
#include "mesh/part.hpp"

namespace almesh {
namespace {

constexpr double first_reach = 0.5;  // around an inverted element, in units of its longest edge
constexpr int most_newton_steps = 30;  // of a subproblem: a part that needs more is too small
constexpr double worthwhile = 0.7;  // part of the connected elements, beyond which the mesh may as well move as a whole

// The part's run: the settings are the deck's, and so is the unit of length.
Deck deck_of_part(Deck deck, double unit) {
    DeckBoundary all;
    all.name = "all";
    all.motion = parse_motion("fixed");
    all.where = deck.path;
    deck.boundaries = {all};
    deck.write_system = deck.iterates = 0;
    deck.wall.clear();
    deck.length_scale = unit;
    deck.local_repair = 0;
    deck.method.max_newton_iterations = std::min(deck.method.max_newton_iterations, most_newton_steps);
    return deck;
}

std::vector<char> inverted_elements(const Mesh& mesh, const CertificateParams& params) {
    constexpr double useless = 0.01;  // scaled Jacobian that leaves no element of any use
    const std::vector<double> bound = certify(mesh, mesh.x, params).lower_bound;
    std::vector<char> inverted(bound.size());
    for (std::size_t e = 0; e < bound.size(); ++e) inverted[e] = bound[e] < useless;
    return inverted;
}

// mesh.x with the nodes of the chosen elements where the part's run has taken them; empty where it has moved one that
// others have too. found: of the part.
std::vector<double> with_part(const Mesh& mesh, const std::vector<char>& chosen, const Mesh& part,
                                const std::vector<double>& found) {
    const int dim = mesh.dim;
    std::vector<char> is_shared(part.nodes(), 0);
    for_face_nodes(part, [&](int f, std::size_t k) { is_shared[part.faces[k]] |= part.face_boundary[f] == part.cut; });
    std::vector<double> x = mesh.x;
    for (int e = 0, r = 0; e < mesh.element_count(); ++e) {
        if (!chosen[e]) continue;
        for (int k = 0; k < mesh.element_nodes(e); ++k) {
            const int here = mesh.element(e)[k], there = part.element(r)[k];
            const double* const to = point(found, there, dim);
            if (is_shared[there] && !std::equal(to, to + dim, point(mesh.x, here, dim))) return {};
            std::copy_n(to, dim, point(x, here, dim));
        }
        ++r;
    }
    return x;
}

std::vector<int> boundary_faces(const Mesh& mesh, const std::vector<char>& chosen) {
    std::vector<int> faces;
    for (int f = 0; f < mesh.face_count(); ++f)
        if (chosen[mesh.face_element[f]]) faces.push_back(f);
    return faces;
}

// Nodes that are not where the mesh has them.
std::vector<char> moved_nodes(const Mesh& mesh, const std::vector<double>& x) {
    std::vector<char> moved(mesh.nodes());
    for (int i = 0; i < mesh.nodes(); ++i) {
        const double* const to = point(x, i, mesh.dim);
        moved[i] = !std::equal(to, to + mesh.dim, point(mesh.x, i, mesh.dim));
    }
    return moved;
}

bool is_valid(const Mesh& mesh, const std::vector<double>& x, const CertificateParams& params) {
    const Certificate certificate = certify(mesh, x, params);
    return certificate.valid && certify_injective(mesh, x, certificate).certified;
}

}  // namespace

Solution repair_locally(const Deck& deck, Problem& problem, const Solve& solve, std::FILE* out) {
    Mesh mesh = problem.mesh();
    mesh.x = problem.file_x;
    const std::vector<char> is_inverted = inverted_elements(mesh, deck.certificate);
    const auto count = [](const std::vector<char>& some) {
        return static_cast<int>(std::count(some.begin(), some.end(), 1));
    };
    const int inverted = problem.is_own_ideal ? 0 : count(is_inverted);  // that mesh is certified
    const std::vector<char> is_prescribed = prescribed_nodes(mesh, problem.target);
    Solution solution;
    solution.x = problem.mesh().x;
    bool is_repaired = inverted == 0;
    const double most = worthwhile * count(surroundings(mesh, is_inverted, std::numeric_limits<double>::infinity()));
    for (double reach = first_reach; !is_repaired; reach *= 2) {
        const std::vector<char> chosen = surroundings(mesh, is_inverted, reach);
        if (count(chosen) > most) return solve(deck, problem);
        std::fprintf(out, "%d of %d elements inverted in the file: the %d at and around them move\n", inverted,
                     mesh.element_count(), count(chosen));
        const Deck of_part = deck_of_part(deck, problem.frame.length);
        std::optional<Problem> part;
        try {
            part = make_problem(of_part, BaseMesh{part_of(mesh, chosen, "the rest of the mesh")}, problem.mesh_hash, {},
                                  {problem.sliding.get(), boundary_faces(mesh, chosen)});
        } catch (const InputError&) {  // what stays of its boundary folds elements, or surfaces are not known there
            continue;
        }
        part->run_id = problem.run_id;
        solution = solve(of_part, *part);
        const std::vector<double> X =
            with_part(mesh, chosen, part->mesh(), final_positions(*part, solution.x));
        solution.x = problem.ideal();
        if (solution.al.status == Status::interrupted) break;
        if (solution.al.status != Status::converged || X.empty()) continue;
        std::vector<double> x = problem.mesh().x;
        for (std::size_t i = 0; i < x.size(); ++i)
            if (X[i] != mesh.x[i]) x[i] = problem.frame.to_run(X[i], i, mesh.dim);
        const std::vector<char> moved = moved_nodes(mesh, X);
        bool keeps_boundary = true;  // but for what the target frees to slide
        for (int i = 0; i < mesh.nodes(); ++i) keeps_boundary = keeps_boundary && !(moved[i] && is_prescribed[i]);
        is_repaired = keeps_boundary && is_valid(problem.mesh(), x, deck.certificate);
        if (!is_repaired) continue;
        solution.x = std::move(x);
        for (std::size_t i = 0; i < problem.target.freed.size(); ++i) problem.target.freed[i] &= moved[i];
    }
    set_functional(deck, problem);
    solution.al.lambda.assign(problem.level->constraint->multipliers(), 0.0);  // the part has others
    solution.al.gradient.clear();
    const AlIteration now =
        measured(*problem.level->energy, *problem.level->constraint, solution.x, solution.al.distortion);
    if (inverted == 0) {
        std::fprintf(out, "no element is inverted in the file: nothing moves\n");
        solution.al.iterations.push_back(now);
        solution.al.iterations.back().gradient_norm = 0;
    }
    return solution;
}

}  // namespace almesh
