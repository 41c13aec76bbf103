#include "problem/base_mesh.hpp"

#include "base/error.hpp"
#include "base/text.hpp"
#include "check/certificate.hpp"
#include "geometry/patch.hpp"
#include "mesh/build.hpp"

namespace almesh {
namespace {

// Simplices with straight sides are valid where they do not fold; other cells may be inverted at a corner.
Mesh straight_mesh(const RawMesh& raw, std::vector<std::string>& notes) {
    Mesh mesh = build_mesh(raw, notes);
    if (mesh.is_simplicial()) return mesh;
    const std::vector<double> y = straight_sided(mesh);
    const Certificate certificate = certify(mesh, y);
    if (certificate.valid) return mesh;
    throw InvalidMesh(list_elements(mesh, certificate.uncertified, y, certificate.certified_bound), raw.path, ": ",
                      counted(certificate.uncertified.size(), "element"), " with straight sides",
                      mesh.dim == 2 ? " and a corner of 180 degrees or more" : " inverted inside or at a corner");
}

}  // namespace

BaseMesh build_base_mesh(const RawMesh& raw, IdealKind ideal, std::vector<std::string>& notes) {
    if (is_improved(ideal)) return {build_mesh(raw, notes, Folds::keep), true, raw.path};
    const std::size_t told = notes.size();
    const bool is_linear = degree_of(raw) == 1;
    std::string against_straight;
    if (ideal != IdealKind::given || is_linear) {
        try {
            return {straight_mesh(raw, notes), false, raw.path};
        } catch (const InputError& error) {
            if (ideal == IdealKind::straight || is_linear) throw;
            against_straight = concat(error.what(), dynamic_cast<const InvalidMesh*>(&error) ? "\n" : "; ");
        }
        notes.resize(told);
    }
    BaseMesh base{build_mesh(raw, notes, Folds::keep), true, raw.path};
    const Certificate certificate = certify(base.mesh, base.mesh.x);
    if (!certificate.valid)
        throw InvalidMesh(list_elements(base.mesh, certificate.uncertified, base.mesh.x, certificate.certified_bound),
                          against_straight.empty() ? raw.path + ": " : against_straight,
                          "as it is in the file, the mesh is not certified valid: ", counts_of(certificate));
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
