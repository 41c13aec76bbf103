#include "app/mending.hpp"

#include <algorithm>

#include "base/text.hpp"
#include "mesh/part.hpp"

namespace almesh {
namespace {

constexpr double worthwhile = 0.7;  // part of the mesh, beyond which it may as well move as a whole
constexpr const char* cut = "the rest of the mesh";  // name of the region's boundary to it

// The region's run: the settings are the deck's, and so is the unit of length.
Deck deck_of_region(Deck deck, double unit) {
    DeckBoundary all;
    all.name = "all";
    all.motion = parse_motion("fixed");
    all.where = deck.path;
    deck.boundaries = {all};
    deck.write_system = deck.iterates = 0;
    deck.wall.clear();
    deck.length_scale = unit;
    deck.region = Region::all;
    return deck;
}

std::vector<char> folded_elements(const Mesh& mesh, const CertificateParams& params) {
    constexpr double useless = 0.01;  // scaled Jacobian that leaves no element of any use
    const std::vector<double> bound = certify(mesh, mesh.x, params).lower_bound;
    std::vector<char> folded(bound.size());
    for (std::size_t e = 0; e < bound.size(); ++e) folded[e] = bound[e] < useless;
    return folded;
}

// mesh.x with the nodes of the chosen elements where the region's run has taken them; empty where it has moved one that
// others have too. found: of the region.
std::vector<double> with_region(const Mesh& mesh, const std::vector<char>& chosen, const Mesh& region,
                                const std::vector<double>& found) {
    const int dim = mesh.dim;
    std::vector<char> is_shared(region.nodes(), 0);
    for (std::size_t k = 0; k < region.faces.size(); ++k)
        is_shared[region.faces[k]] |= region.boundaries[region.face_boundary[k / region.face_nodes()]] == cut;
    std::vector<double> x = mesh.x;
    for (int e = 0, r = 0; e < mesh.element_count(); ++e) {
        if (!chosen[e]) continue;
        for (int k = 0; k < mesh.element_nodes(); ++k) {
            const int here = mesh.element(e)[k], there = region.element(r)[k];
            const double* const to = point(found, there, dim);
            if (is_shared[there] && !std::equal(to, to + dim, point(mesh.x, here, dim))) return {};
            std::copy_n(to, dim, point(x, here, dim));
        }
        ++r;
    }
    return x;
}

bool is_valid(const Mesh& mesh, const std::vector<double>& x, const CertificateParams& params) {
    const Certificate certificate = certify(mesh, x, params);
    return certificate.valid && certify_injective(mesh, x, certificate).certified;
}

}  // namespace

Solution mend(const Deck& deck, const Problem& problem, const Solve& solve, std::FILE* out) {
    Mesh mesh = problem.mesh();
    mesh.x = problem.file_x;
    std::vector<char> chosen = folded_elements(mesh, deck.certificate);
    const auto count = [&chosen] { return static_cast<int>(std::count(chosen.begin(), chosen.end(), 1)); };
    const int folded = count();
    Solution solution;
    solution.x = problem.mesh().x;
    bool is_mended = folded == 0;
    for (int layers = 2; !is_mended; ++layers) {
        for (int k = 0; k < layers; ++k) add_layer(mesh, chosen);
        if (count() > worthwhile * mesh.element_count()) return solve(deck, problem);
        std::fprintf(out, "%s folded in the file, of %d: %d around move\n", counted(folded, "element").c_str(),
                     mesh.element_count(), count());
        const Deck of_region = deck_of_region(deck, problem.frame.length);
        Problem region = make_problem(of_region, part_of(mesh, chosen, cut), problem.mesh_hash);
        region.run_id = problem.run_id;
        solution = solve(of_region, region);
        const std::vector<double> X =
            with_region(mesh, chosen, region.mesh(), final_positions(region, solution.x));
        solution.x = problem.ideal();
        if (solution.al.status == AlStatus::interrupted) break;
        if (solution.al.status != AlStatus::converged || X.empty()) continue;
        std::vector<double> x = problem.mesh().x;
        for (std::size_t i = 0; i < x.size(); ++i)
            if (X[i] != mesh.x[i]) x[i] = problem.frame.to_run(X[i], i, mesh.dim);
        is_mended = is_valid(problem.mesh(), x, deck.certificate);
        if (is_mended) solution.x = std::move(x);
    }
    set_functional(deck, problem, problem.target, problem.level_placed, *problem.level);
    solution.al.lambda.assign(problem.level->constraint->multipliers(), 0.0);  // the region has others
    solution.al.gradient.clear();
    const AlIteration now =
        measured(*problem.level->energy, *problem.level->constraint, solution.x, solution.al.distortion);
    if (folded == 0) {
        std::fprintf(out, "no element is folded in the file: nothing moves\n");
        solution.al.iterations.push_back(now);
        solution.al.iterations.back().gradient_norm = 0;
    }
    return solution;
}

}  // namespace almesh
