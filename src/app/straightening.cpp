#include "app/straightening.hpp"

#include <algorithm>

#include "base/error.hpp"
#include "base/text.hpp"

namespace almesh {
namespace {

constexpr int most_al_iterations = 6, most_newton_steps = 20;  // where more are needed faces hold it up
constexpr double of_largest_error = 0.1;  // a node that is so far from its target holds up the others
constexpr double jammed = 20;             // eta of an element that does

// Vertices of the boundary where the run has not come to an end.
std::vector<char> around_diagnosis(const Problem& problem, const Solution& solution, const Certificate& certificate,
                          const Injectivity& injectivity) {
    const Mesh& mesh = problem.mesh();
    const Constraint& constraint = *problem.level->constraint;
    std::vector<char> at(mesh.nodes(), 0);
    const auto choose_element = [&](int e) {
        for (int i = 0; i < mesh.element_nodes(e); ++i) at[mesh.element(e)[i]] = 1;
    };
    for (const int e : certificate.uncertified) choose_element(e);
    if (injectivity.node >= 0) at[injectivity.node] = 1;
    if (injectivity.face >= 0) choose_element(mesh.face_element[injectivity.face]);
    if (solution.al.status == Status::converged) return at;
    const std::vector<double>& eta = solution.al.distortion.element_max;
    for (int e = 0; e < mesh.element_count(); ++e)
        if (!(eta[e] < jammed)) choose_element(e);
    const std::vector<double> error = constraint.relative_errors(solution.x);
    const double largest = error.empty() ? 0 : *std::max_element(error.begin(), error.end());
    for (std::size_t k = 0; k < error.size(); ++k)
        if (largest > 0 && error[k] >= of_largest_error * largest) at[constraint.nodes()[k]] = 1;
    return at;
}

// Faces with a node that is chosen and is not flat yet, those beside the flat ones where there is none, else all.
std::vector<char> more_faces(const Mesh& mesh, const BoundaryTarget& target, std::vector<char> node) {
    std::vector<char> flat = target.straight;
    flat.resize(mesh.face_count(), 0);
    const auto faces = [&] {
        std::vector<char> chosen(mesh.face_count(), 0);
        for (int f = 0; f < mesh.face_count(); ++f)
            chosen[f] = !flat[f] && target.hold_of_face(mesh, f) == BoundaryHold::prescribed &&
                        std::any_of(mesh.face(f), mesh.face(f) + mesh.face_nodes(f), [&](int i) { return node[i]; });
        return chosen;
    };
    const auto are_some = [](const std::vector<char>& chosen) {
        return std::count(chosen.begin(), chosen.end(), 1) > 0;
    };
    std::vector<char> chosen = faces();
    if (are_some(chosen)) return chosen;
    for (int f = 0; f < mesh.face_count(); ++f)
        for (const int i : mesh.face_vertices(f)) node[i] |= flat[f];
    chosen = faces();
    if (are_some(chosen)) return chosen;
    node.assign(mesh.nodes(), 1);
    return faces();
}

}  // namespace

Solution solve_straightening(const Deck& deck, Problem& problem, const Solve& solve, std::FILE* out) {
    const Mesh& mesh = problem.mesh();
    Deck impatient = deck;
    impatient.method.max_iterations = std::min(deck.method.max_iterations, most_al_iterations);
    impatient.method.max_newton_iterations = std::min(deck.method.max_newton_iterations, most_newton_steps);
    const auto turns_far = [](const DeckBoundary& boundary) { return turn(boundary.motion) > 90; };
    const bool turns = std::any_of(deck.boundaries.begin(), deck.boundaries.end(), turns_far);
    if (deck.continuation == Continuation::automatic && !turns) impatient.continuation = Continuation::never;
    for (;;) {
        const auto flat = std::count(problem.target.straight.begin(), problem.target.straight.end(), 1);
        const bool all = mesh.degree == 1 || flat == mesh.face_count();
        Solution solution = solve(all ? deck : impatient, problem);
        if (all || solution.al.status == Status::interrupted) return solution;
        const Certificate certificate = certify(mesh, solution.x, deck.certificate);
        const Injectivity injectivity = certify_injective(mesh, solution.x, certificate);
        const bool converged = solution.al.status == Status::converged;
        if (converged && injectivity.certified) return solution;
        // With the boundary on its target and the mesh certified it was a limit that ended the run, no face.
        const bool on_target = problem.level->constraint->relative_error(solution.x) <= deck.method.wall_tolerance;
        if (on_target && injectivity.certified) return solve(deck, problem);
        const std::vector<char> chosen =
            more_faces(mesh, problem.target, around_diagnosis(problem, solution, certificate, injectivity));
        const auto more = std::count(chosen.begin(), chosen.end(), 1);
        if (more == 0) return solve(deck, problem);
        std::fprintf(out, "%s to be made flat, in addition to %d: %s\n", counted(more, "face").c_str(),
                     static_cast<int>(flat),
                     injectivity.certified ? to_string(solution.al.status) : "no valid mesh yet");
        const BoundaryTarget target = problem.target;
        const std::vector<double> node_target = problem.node_target, curved_target = problem.curved_target;
        try {
            if (curved_target.empty()) problem.curved_target = node_target;
            straighten_target(checked_target(deck, problem), chosen);
        } catch (const InputError& error) {  // flat they would cross: with the target as it was until the deck's limits
            std::fprintf(out, "these faces stay as they are: %s\n", error.what());
            problem.target = target;
            problem.node_target = node_target;
            problem.curved_target = curved_target;
            return solve(deck, problem);
        }
    }
}

}  // namespace almesh
