#include "app/commands.hpp"
#include "report/results.hpp"

#include <algorithm>
#include <unordered_map>

#include "deck/deck.hpp"
#include "report/quality_change.hpp"
#include "base/parallel.hpp"
#include "base/table.hpp"
#include "check/boundary_distance.hpp"
#include "check/certificate.hpp"
#include "check/infeasible.hpp"
#include "check/injectivity.hpp"
#include "check/quality.hpp"
#include "io/mesh_format.hpp"
#include "mesh/build.hpp"

namespace almesh {
namespace {

// Of each element, by its id: that id, and those of its nodes, ascending.
std::vector<std::vector<long long>> ids_of(const Mesh& mesh) {
    std::vector<std::vector<long long>> ids;
    for (int e = 0; e < mesh.element_count(); ++e) {
        std::vector<long long>& of = ids.emplace_back(1, mesh.file.element_id[e]);
        for (int k = 0; k < mesh.element_nodes(e); ++k) of.push_back(mesh.file.node_id[mesh.element(e)[k]]);
        std::sort(of.begin() + 1, of.end());
    }
    std::sort(ids.begin(), ids.end());
    return ids;
}

// Where another file has the nodes of the mesh: node_count x dim. One of a lower degree is raised.
std::vector<double> positions_before(const std::string& path, const Mesh& mesh) {
    std::vector<std::string> notes;
    Mesh other = build_mesh(read_mesh(path), notes, Folds::keep);
    if (other.degree < mesh.degree) other = raise_degree(other, mesh.degree);
    if (other.dim != mesh.dim || ids_of(other) != ids_of(mesh))
        throw InputError(path, ": this is not the same mesh as it was before: its elements or their nodes have other "
                         "ids (refine and split change them)");
    std::unordered_map<long long, int> node;
    for (int i = 0; i < other.nodes(); ++i) node[other.file.node_id[i]] = i;
    std::vector<double> x = mesh.x;
    for (int i = 0; i < mesh.nodes(); ++i)
        if (const auto at = node.find(mesh.file.node_id[i]); at != node.end())
            std::copy_n(point(other.x, at->second, mesh.dim), mesh.dim, point(x, i, mesh.dim));
    return x;
}

}  // namespace

ExitCode quality(const Deck& deck, const std::string& before, std::FILE* out) {
    set_threads(deck.threads);
    std::vector<std::string> notes;
    const Mesh mesh = build_mesh(read_mesh(deck.mesh), notes, Folds::keep);
    print(out, deck.mesh, ": ", mesh.nodes(), " nodes, ", mesh.elements_text(), " of degree ", mesh.degree, "\n");
    for (const std::string& note : notes) print(out, "note: ", note, "\n");

    const std::vector<double> came = before.empty() ? mesh.x : positions_before(before, mesh);
    const QualityStatistics shape = mesh_quality(mesh, mesh.x);
    print(out, "\nshape quality 1/eta against the regular ", mesh.is_simplicial() ? "simplex" : "cell", ": min ",
          to_text(shape.min, 4), ", mean ", to_text(shape.mean, 4), "; edges ", to_text(shape.min_edge, 4), " to ",
          to_text(shape.max_edge, 4), "\n", histogram_text(shape), "\nworst elements (id, centre, quality):",
          list_invalid(mesh, shape.worst, mesh.x, shape.quality).first, "\n");

    if (!before.empty()) {
        const std::vector<BoundaryDistance> distances = boundary_distances(mesh, came, mesh.x);
        if (distances.empty()) print(out, "\nall faces are where ", before, " has them\n");
        else print(out, "\n", distance_table(mesh, distances, "those of " + before));
        print(out, "\nbefore: ", before, "\n", quality_table(quality_change(mesh, came, mesh.x)));
    }

    const Certificate certificate = certify(mesh, mesh.x);
    print(out, "\nscaled Jacobian >= ", rounded_down(certificate.min_scaled_jacobian, 6), " everywhere",
          certificate.valid ? ": all elements certified valid\n" : "\n");
    print_uncertified(out, mesh, mesh.x, certificate, deck.given.contains("output") ? deck.output : "");
    const Injectivity injectivity = certify_injective(mesh, mesh.x, certificate);
    if (injectivity.certified) print(out, "certified injective: no two elements overlap\n");
    else if (certificate.valid) print(out, "NOT certified injective: ", overlap_text(mesh, injectivity), "\n");
    return injectivity.certified ? ExitCode::success : ExitCode::not_certified;
}

}  // namespace almesh
