#include "app/quality.hpp"

#include "app/uncertified.hpp"
#include "check/certificate.hpp"
#include "check/quality.hpp"
#include "io/msh_reader.hpp"
#include "mesh/build.hpp"

namespace almesh {
namespace {

void print_centre(std::FILE* out, const WorstElement& worst, int dim) {
    for (int a = 0; a < dim; ++a) std::fprintf(out, "%s%.6g", a ? ", " : "", worst.centre[a]);
}

}  // namespace

ExitCode quality(const std::string& mesh_path, std::FILE* out) {
    std::vector<std::string> notes;
    const Mesh mesh = build_mesh(read_msh(mesh_path), notes, Folds::keep);
    std::fprintf(out, "%s: %d nodes, %d %s of degree %d\n", mesh_path.c_str(), mesh.nodes(), mesh.element_count(),
                 mesh.dim == 2 ? "triangles" : "tetrahedra", mesh.degree);
    for (const std::string& note : notes) std::fprintf(out, "note: %s\n", note.c_str());

    const QualityStatistics shape = mesh_quality(mesh, mesh.x);
    std::fprintf(out, "\nshape quality 1/eta against the regular simplex: min %.4g, mean %.4g; edges %.4g to %.4g\n%s",
                 shape.min, shape.mean, shape.min_edge, shape.max_edge, histogram_text(shape).c_str());
    std::fprintf(out, "\nworst elements (id, centre, quality):\n");
    for (const WorstElement& worst : shape.worst) {
        std::fprintf(out, "  %lld  (", mesh.element_id[worst.element]);
        print_centre(out, worst, mesh.dim);
        std::fprintf(out, ")  %.4g\n", worst.quality);
    }

    const Certificate certificate = certify(mesh, mesh.x);
    std::fprintf(out, "\nscaled Jacobian >= %.6g everywhere", certificate.min_scaled_jacobian);
    std::fprintf(out, certificate.valid ? ": all elements certified valid\n" : "\n");
    print_uncertified(out, mesh, mesh.x, 1, certificate);
    return certificate.valid ? ExitCode::success : ExitCode::not_certified;
}

}  // namespace almesh
