#include "app/commands.hpp"
#include "report/results.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <unordered_map>

#include "deck/deck.hpp"
#include "report/quality_change.hpp"
#include "base/files.hpp"
#include "base/parallel.hpp"
#include "check/boundary_distance.hpp"
#include "check/certificate.hpp"
#include "check/infeasible.hpp"
#include "check/injectivity.hpp"
#include "check/quality.hpp"
#include "io/mesh_format.hpp"
#include "mesh/build.hpp"

namespace almesh {
namespace {

void print_element(std::FILE* out, const Mesh& mesh, int element, const std::array<double, 3>& centre, double value) {
    std::fprintf(out, "  %lld  (", mesh.file.element_id[element]);
    for (int a = 0; a < mesh.dim; ++a) std::fprintf(out, "%s%.6g", a ? ", " : "", centre[a]);
    std::fprintf(out, ")  %s\n", rounded_down(value, 4).c_str());
}

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
    std::fprintf(out, "%s: %d nodes, %s of degree %d\n", deck.mesh.c_str(), mesh.nodes(),
                 mesh.elements_text().c_str(), mesh.degree);
    for (const std::string& note : notes) std::fprintf(out, "note: %s\n", note.c_str());

    const std::vector<double> came = before.empty() ? mesh.x : positions_before(before, mesh);

    const QualityStatistics shape = mesh_quality(mesh, mesh.x);
    std::fprintf(out, "\nshape quality 1/eta against the regular %s: min %.4g, mean %.4g; edges %.4g to %.4g\n%s",
                 mesh.is_simplicial() ? "simplex" : "cell", shape.min, shape.mean, shape.min_edge, shape.max_edge,
                 histogram_text(shape).c_str());
    std::fprintf(out, "\nworst elements (id, centre, quality):\n");
    for (const WorstElement& worst : shape.worst) print_element(out, mesh, worst.element, worst.centre, worst.quality);

    if (!before.empty()) {
        const std::vector<BoundaryDistance> distances = boundary_distances(mesh, came, mesh.x);
        std::fprintf(out, distances.empty() ? "\nall faces are where %s has them\n" : "\n", before.c_str());
        print_distances(out, mesh, distances, "those of " + before);
        std::fprintf(out, "\nbefore: %s\n", before.c_str());
        print_quality_change(out, quality_change(mesh, came, mesh.x));
    }

    const Certificate certificate = certify(mesh, mesh.x);
    std::fprintf(out, "\nscaled Jacobian >= %s everywhere", rounded_down(certificate.min_scaled_jacobian, 6).c_str());
    std::fprintf(out, certificate.valid ? ": all elements certified valid\n" : "\n");
    print_uncertified(out, mesh, mesh.x, certificate, deck.given.contains("output") ? deck.output : "");
    const Injectivity injectivity = certify_injective(mesh, mesh.x, certificate);
    if (injectivity.certified) std::fprintf(out, "certified injective: no two elements overlap\n");
    else if (certificate.valid)
        std::fprintf(out, "NOT certified injective: %s\n", overlap_text(mesh, injectivity).c_str());
    return injectivity.certified ? ExitCode::success : ExitCode::not_certified;
}

}  // namespace almesh
