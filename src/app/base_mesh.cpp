#include "app/base_mesh.hpp"

#include "base/error.hpp"
#include "mesh/build.hpp"

namespace almesh {

BaseMesh build_base_mesh(const RawMesh& raw, IdealKind ideal, const CertificateParams& params,
                         std::vector<std::string>& notes) {
    const std::size_t told = notes.size();
    std::string against_straight;
    if (ideal != IdealKind::given) {
        try {
            return {build_mesh(raw, notes)};
        } catch (const InputError& error) {
            if (ideal == IdealKind::straight) throw;
            against_straight = error.what();
        }
        notes.resize(told);
    }
    BaseMesh base{build_mesh(raw, notes, Folds::keep), true};
    if (base.mesh.degree == 1) return {build_mesh(raw, notes)};
    const Certificate certificate = certify(base.mesh, base.mesh.x, params);
    if (!certificate.valid)
        throw InputError(against_straight.empty() ? raw.path + ": " : against_straight + "; ",
                         "as it is in the file, the mesh is not certified valid: ", counts_of(certificate),
                         ", the worst is element ", base.mesh.file.element_id[certificate.uncertified[0]]);
    return base;
}

}  // namespace almesh
