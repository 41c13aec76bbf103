#include "app/uncertified.hpp"

namespace almesh {

void print_uncertified(std::FILE* out, const Mesh& mesh, const std::vector<double>& x, double length,
                       const Certificate& certificate) {
    constexpr std::size_t shown = 10;
    const std::vector<int>& bad = certificate.uncertified;
    if (bad.empty()) return;
    std::fprintf(out, "%zu elements NOT certified valid; the worst (id, centre, scaled Jacobian >=):\n", bad.size());
    for (std::size_t k = 0; k < bad.size() && k < shown; ++k) {
        std::fprintf(out, "  %lld  (", mesh.element_id[bad[k]]);
        for (int a = 0; a < mesh.dim; ++a) {
            double centre = 0;
            for (int v = 0; v <= mesh.dim; ++v)
                centre += x[static_cast<std::size_t>(mesh.element(bad[k])[v]) * mesh.dim + a] / (mesh.dim + 1);
            std::fprintf(out, "%s%.6g", a ? ", " : "", centre * length);
        }
        std::fprintf(out, ")  %.4g\n", certificate.lower_bound[bad[k]]);
    }
}

}  // namespace almesh
