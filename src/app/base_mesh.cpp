#include "app/base_mesh.hpp"

#include <utility>

#include "base/error.hpp"
#include "base/text.hpp"
#include "mesh/build.hpp"

namespace almesh {

namespace {

// That of simplices is valid where it does not fold; other cells with straight sides may be inverted at a corner.
void check_straight(const Mesh& mesh, const CertificateParams& params) {
    if (mesh.is_simplicial()) return;
    const std::vector<double> y = straight_sided(mesh);
    const Certificate certificate = certify(mesh, y, params);
    if (certificate.valid) return;
    const int e = certificate.uncertified[0];
    throw InputError(mesh.cell(e).name, " ", mesh.file.element_id[e], " at ",
                     position_text(element_centre(mesh, y, e).data(), mesh.dim), " is inverted with straight sides: ",
                     counts_of(certificate));
}

}  // namespace

BaseMesh build_base_mesh(const RawMesh& raw, IdealKind ideal, const CertificateParams& params,
                         std::vector<std::string>& notes) {
    const std::size_t told = notes.size();
    std::string against_straight;
    if (ideal != IdealKind::given) {
        try {
            Mesh mesh = build_mesh(raw, notes);
            check_straight(mesh, params);
            return {std::move(mesh)};
        } catch (const InputError& error) {
            if (ideal == IdealKind::straight) throw;
            against_straight = error.what();
        }
        notes.resize(told);
    }
    BaseMesh base{build_mesh(raw, notes, Folds::keep), true};
    if (base.mesh.degree == 1) {
        check_straight(base.mesh, params);
        return {build_mesh(raw, notes)};
    }
    const Certificate certificate = certify(base.mesh, base.mesh.x, params);
    if (!certificate.valid)
        throw InputError(against_straight.empty() ? raw.path + ": " : against_straight + "; ",
                         "as it is in the file, the mesh is not certified valid: ", counts_of(certificate),
                         ", the worst is element ", base.mesh.file.element_id[certificate.uncertified[0]]);
    return base;
}

}  // namespace almesh
