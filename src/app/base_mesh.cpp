#include "app/base_mesh.hpp"

#include "base/error.hpp"
#include "base/text.hpp"
#include "geometry/patch.hpp"
#include "mesh/build.hpp"

namespace almesh {
namespace {

// Simplices with straight sides are valid where they do not fold; other cells may be inverted at a corner.
Mesh straight_mesh(const RawMesh& raw, const CertificateParams& params, std::vector<std::string>& notes) {
    Mesh mesh = build_mesh(raw, notes);
    if (mesh.is_simplicial()) return mesh;
    const std::vector<double> y = straight_sided(mesh);
    const Certificate certificate = certify(mesh, y, params);
    if (certificate.valid) return mesh;
    const int e = certificate.uncertified[0];
    throw InputError(raw.path, ": ", mesh.cell(e).name, " ", mesh.file.element_id[e], " at ",
                     position_text(element_centre(mesh, y, e).data(), mesh.dim),
                     mesh.dim == 2 ? " has with straight sides a corner of 180 degrees or more"
                                   : " is with straight sides inverted inside or at a corner",
                     ", the worst of ", counted(certificate.uncertified.size(), "such element"),
                     ": it has to be divided, or its nodes moved");
}

}  // namespace

BaseMesh build_base_mesh(const RawMesh& raw, IdealKind ideal, const CertificateParams& params,
                         std::vector<std::string>& notes) {
    if (is_improved(ideal)) return {build_mesh(raw, notes, Folds::keep), true};
    const std::size_t told = notes.size();
    const bool is_linear = degree_of(raw) == 1;
    std::string against_straight;
    if (ideal != IdealKind::given || is_linear) {
        try {
            return {straight_mesh(raw, params, notes)};
        } catch (const InputError& error) {
            if (ideal == IdealKind::straight || is_linear) throw;
            against_straight = concat(error.what(), "; ");
        }
        notes.resize(told);
    }
    BaseMesh base{build_mesh(raw, notes, Folds::keep), true};
    const Certificate certificate = certify(base.mesh, base.mesh.x, params);
    if (!certificate.valid)
        throw InputError(against_straight.empty() ? raw.path + ": " : against_straight,
                         "as it is in the file, the mesh is not certified valid: ", counts_of(certificate),
                         ", the worst is element ", base.mesh.file.element_id[certificate.uncertified[0]]);
    return base;
}

Vec<3> local_origin(const Mesh& mesh) {
    constexpr double far = 16;
    Vec<3> low{}, high{}, middle{};
    for (int a = 0; a < mesh.dim; ++a) low[a] = high[a] = mesh.x[a];
    for (std::size_t k = 0; k < mesh.x.size(); ++k) {
        const auto a = static_cast<int>(k % mesh.dim);
        low[a] = std::min(low[a], mesh.x[k]);
        high[a] = std::max(high[a], mesh.x[k]);
    }
    for (int a = 0; a < mesh.dim; ++a) middle[a] = low[a] + 0.5 * (high[a] - low[a]);
    return length(middle) > far * length(high - low) ? middle : Vec<3>{};
}

}  // namespace almesh
