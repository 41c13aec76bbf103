#include "app/commands.hpp"

#include <array>

#include "app/deck.hpp"
#include "base/parallel.hpp"
#include "check/certificate.hpp"
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

}  // namespace

ExitCode quality(const Deck& deck, std::FILE* out) {
    set_threads(deck.threads);
    std::vector<std::string> notes = deck.notes;
    const Mesh mesh = build_mesh(read_mesh(deck.mesh), notes, Folds::keep);
    std::fprintf(out, "%s: %d nodes, %s of degree %d\n", deck.mesh.c_str(), mesh.nodes(),
                 mesh.elements_text().c_str(), mesh.degree);
    for (const std::string& note : notes) std::fprintf(out, "note: %s\n", note.c_str());

    const QualityStatistics shape = mesh_quality(mesh, mesh.x);
    std::fprintf(out, "\nshape quality 1/eta against the regular %s: min %.4g, mean %.4g; edges %.4g to %.4g\n%s",
                 mesh.is_simplicial() ? "simplex" : "cell", shape.min, shape.mean, shape.min_edge, shape.max_edge,
                 histogram_text(shape).c_str());
    std::fprintf(out, "\nworst elements (id, centre, quality):\n");
    for (const WorstElement& worst : shape.worst) print_element(out, mesh, worst.element, worst.centre, worst.quality);

    const Certificate certificate = certify(mesh, mesh.x, deck.certificate);
    std::fprintf(out, "\nscaled Jacobian >= %s everywhere", rounded_down(certificate.min_scaled_jacobian, 6).c_str());
    std::fprintf(out, certificate.valid ? ": all elements certified valid\n" : "\n");
    print_uncertified(out, mesh, mesh.x, {}, certificate);
    const Injectivity injectivity = certify_injective(mesh, mesh.x, certificate);
    if (injectivity.certified) std::fprintf(out, "certified injective: no two elements overlap\n");
    else if (certificate.valid)
        std::fprintf(out, "NOT certified injective: %s\n", overlap_text(mesh, injectivity).c_str());
    return injectivity.certified ? ExitCode::success : ExitCode::not_certified;
}

void print_uncertified(std::FILE* out, const Mesh& mesh, const std::vector<double>& x, const Frame& frame,
                       const Certificate& certificate) {
    constexpr std::size_t shown = 10;
    const std::vector<int>& bad = certificate.uncertified;
    if (bad.empty()) return;
    std::fprintf(out, "NOT certified valid: %s; the worst (id, centre, scaled Jacobian >=):\n",
                 counts_of(certificate).c_str());
    for (std::size_t k = 0; k < bad.size() && k < shown; ++k) {
        const std::array<double, 3> centre = frame.to_file(element_centre(mesh, x, bad[k]));
        print_element(out, mesh, bad[k], centre, certificate.lower_bound[bad[k]]);
    }
}

}  // namespace almesh
