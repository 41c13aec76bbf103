#include "check/straightened.hpp"

#include <algorithm>
#include <optional>

#include "check/infeasible.hpp"
#include "mesh/part.hpp"

namespace almesh {
namespace {

constexpr char steps = 4;  // from curved to straight

// Elements at which a mesh that is valid overlaps itself, x being neither of the two forms.
std::vector<int> overlapping(const Mesh& mesh, const std::vector<double>& x, const Injectivity& found) {
    std::vector<int> elements = elements_of(mesh, {check_target(mesh, x, {}, FaceBend::of_valid), {}});
    for (int e = 0; e < mesh.element_count() && found.node >= 0; ++e) {
        const int *const node = mesh.element(e), *const end = node + mesh.element_nodes(e);
        if (std::find(node, end, found.node) != end) elements.push_back(e);
    }
    std::sort(elements.begin(), elements.end());
    elements.erase(std::unique(elements.begin(), elements.end()), elements.end());
    return elements;
}

}  // namespace

Straightened straightened(const Mesh& mesh, const std::vector<double>& straight, const std::vector<double>& curved,
                          const ElementsAtFault& at_fault) {
    Straightened found = {curved, std::vector<char>(mesh.element_count(), 0)};
    std::vector<char> step(mesh.element_count(), 0), of_node(mesh.nodes(), 0);
    for (bool changes = true; changes;) {
        changes = false;
        for (const int e : at_fault(found.x)) {
            if (step[e] == steps) continue;
            ++step[e];
            changes = true;
            for (int k = 0; k < mesh.element_nodes(e); ++k) {
                const int i = mesh.element(e)[k];
                const bool goes_on = of_node[i] < step[e];
                of_node[i] = std::max(of_node[i], step[e]);
                for (std::size_t c = offset(i, mesh.dim); c < offset(i + 1, mesh.dim); ++c) {
                    if (straight[c] != curved[c]) found.was_at_fault[e] = 1;
                    if (goes_on) found.x[c] = straight[c] + (1 - double(step[e]) / steps) * (curved[c] - straight[c]);
                }
            }
        }
    }
    return found;
}

Injectivity certify_curved(Mesh mesh, const std::vector<double>& straight, const std::vector<double>& curved,
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
    static_cast<Straightened&>(found) = straightened(mesh, straight, curved, [&](const std::vector<double>& x) {
        found.certificate = certify(mesh, x);
        std::vector<int> at_fault;
        for (int e = 0; e < mesh.element_count(); ++e)
            if (found.certificate.certified_bound[e] <= bound) at_fault.push_back(e);
        if (!at_fault.empty() && !found.certificate.valid) return at_fault;
        found.injectivity = certify_curved(mesh, straight, curved, x, found.certificate);
        if (found.injectivity.certified) return at_fault;
        mesh.x = straight;
        if (!helps) helps = certify_injective(mesh, straight, certify(mesh, straight)).certified;
        if (*helps)
            for (const int e : overlapping(mesh, x, found.injectivity)) at_fault.push_back(e);
        return at_fault;
    });
    return found;
}

}  // namespace almesh
