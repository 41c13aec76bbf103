#include "check/straightened.hpp"

#include <algorithm>
#include <optional>

#include "base/index.hpp"
#include "check/target_check.hpp"

namespace almesh {
namespace {

constexpr char steps = 4;  // from curved to straight

// Elements at which a mesh that is valid overlaps itself, x being neither of the two forms.
std::vector<int> overlapping(const Mesh& mesh, const std::vector<double>& x, const Injectivity& found) {
    std::vector<int> elements;
    const TargetReport report = check_target(mesh, x, {}, FaceBend::of_valid);
    for (const TargetReport::Fault& fault : report.faults) elements.push_back(mesh.face_element[fault.face]);
    for (const auto& pair : report.crossing)
        for (const int f : pair) elements.push_back(mesh.face_element[f]);
    for (int e = 0; e < mesh.element_count() && found.node >= 0; ++e) {
        const int *const node = mesh.element(e), *const end = node + mesh.element_nodes(e);
        if (std::find(node, end, found.node) != end) elements.push_back(e);
    }
    std::sort(elements.begin(), elements.end());
    elements.erase(std::unique(elements.begin(), elements.end()), elements.end());
    return elements;
}

}  // namespace

std::vector<double> straightened(const Mesh& mesh, const std::vector<double>& straight,
                                 const std::vector<double>& curved, const ElementsAtFault& at_fault,
                                 std::vector<char>* was_at_fault) {
    std::vector<double> x = curved;
    std::vector<char> step(mesh.element_count(), 0), of_node(mesh.nodes(), 0);
    for (bool changes = true; changes;) {
        changes = false;
        for (const int e : at_fault(x)) {
            if (step[e] == steps) continue;
            ++step[e];
            changes = true;
            for (int k = 0; k < mesh.element_nodes(e); ++k) {
                const int i = mesh.element(e)[k];
                if (of_node[i] >= step[e]) continue;
                of_node[i] = step[e];
                for (std::size_t c = offset(i, mesh.dim); c < offset(i + 1, mesh.dim); ++c)
                    x[c] = straight[c] + (1 - double(step[e]) / steps) * (curved[c] - straight[c]);
            }
        }
    }
    if (!was_at_fault) return x;
    was_at_fault->assign(mesh.element_count(), 0);
    for (int e = 0; e < mesh.element_count(); ++e)
        for (int k = 0; k < mesh.element_nodes(e) && step[e] > 0; ++k) {
            const double* const at = point(x, mesh.element(e)[k], mesh.dim);
            if (!std::equal(at, at + mesh.dim, point(curved, mesh.element(e)[k], mesh.dim))) (*was_at_fault)[e] = 1;
        }
    return x;
}

Injectivity certify_curved(Mesh& mesh, const std::vector<double>& straight, const std::vector<double>& curved,
                           const std::vector<double>& x, const Certificate& certificate) {
    Injectivity found;
    for (const std::vector<double>* const before : {&curved, &straight}) {
        mesh.x = *before;
        found = certify_injective(mesh, x, certificate);
        if (found.certified || !certificate.valid) break;
    }
    return found;
}

StraightenedMesh straighten_invalid(Mesh mesh, const std::vector<double>& straight, const std::vector<double>& curved,
                                    double bound) {
    StraightenedMesh found;
    std::optional<bool> helps;  // whether the straight-sided form does not overlap itself
    found.x = straightened(mesh, straight, curved, [&](const std::vector<double>& x) {
        found.certificate = certify(mesh, x);
        std::vector<int> at_fault;
        for (int e = 0; e < mesh.element_count(); ++e)
            if (found.certificate.lower_bound[e] <= bound) at_fault.push_back(e);
        if (!at_fault.empty() && !found.certificate.valid) return at_fault;
        found.injectivity = certify_curved(mesh, straight, curved, x, found.certificate);
        if (found.injectivity.certified) return at_fault;
        if (!helps) {
            mesh.x = straight;
            helps = certify_injective(mesh, straight, certify(mesh, straight)).certified;
        }
        if (*helps)
            for (const int e : overlapping(mesh, x, found.injectivity)) at_fault.push_back(e);
        return at_fault;
    }, &found.was_at_fault);
    return found;
}

}  // namespace almesh
