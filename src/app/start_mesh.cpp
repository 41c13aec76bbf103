// Elements are the same where the ids of their nodes are, in whatever order.
#include "app/start_mesh.hpp"

#include <algorithm>
#include <unordered_map>

#include "base/error.hpp"
#include "check/certificate.hpp"
#include "io/mesh_format.hpp"

namespace almesh {
namespace {

using Ids = std::vector<long long>;

std::vector<Ids> sorted(std::vector<Ids> elements) {
    for (Ids& ids : elements) std::sort(ids.begin(), ids.end());
    std::sort(elements.begin(), elements.end());
    return elements;
}

std::vector<Ids> elements_of(const Mesh& mesh) {
    std::vector<Ids> elements(mesh.element_count());
    for (int e = 0; e < mesh.element_count(); ++e)
        for (int i = 0; i < mesh.cell(e).node_count(mesh.degree); ++i)
            elements[e].push_back(mesh.file.node_id[mesh.element(e)[i]]);
    return sorted(std::move(elements));
}

std::vector<Ids> elements_of(const RawMesh& raw, int dim) {
    std::vector<Ids> elements;
    for (const RawElement& element : raw.elements) {
        if (element.dim != dim) continue;
        Ids& ids = elements.emplace_back();
        for (int i = 0; i < element.node_count(); ++i)
            ids.push_back(raw.nodes[raw.element_nodes[element.first + i]].id);
    }
    return sorted(std::move(elements));
}

std::string text_of(const Ids& ids) {
    std::string text;
    for (const long long id : ids) text += (text.empty() ? "" : ", ") + std::to_string(id);
    return text;
}

}  // namespace

std::vector<double> read_start(const Deck& deck, const Mesh& mesh, const Frame& frame) {
    const std::string where = concat(deck.given.at("start"), ": start = ", deck.start_file, ": ");
    const RawMesh raw = [&] {
        try {
            return read_mesh(deck.start_file);
        } catch (const InputError& error) {
            throw InputError(deck.given.at("start"), ": start: ", error.what());
        }
    }();
    const std::vector<Ids> own = elements_of(mesh), other = elements_of(raw, mesh.dim);
    if (own.size() != other.size())
        throw InputError(where, "the file has ", counted(other.size(), "element"), ", the mesh of the run ", own.size());
    if (const auto [a, b] = std::mismatch(own.begin(), own.end(), other.begin()); a != own.end())
        throw InputError(where, "not the elements of the mesh of the run: it has one of the nodes ", text_of(*a),
                         ", the file of the nodes ", text_of(*b));
    std::unordered_map<long long, const RawNode*> node;
    for (const RawNode& each : raw.nodes) node[each.id] = &each;
    std::vector<double> x(mesh.x.size());
    for (int i = 0; i < mesh.nodes(); ++i)
        std::copy_n(node.at(mesh.file.node_id[i])->x, mesh.dim, point(x, i, mesh.dim));
    frame.take_to_run(x, mesh.dim);
    const Certificate certificate = certify(mesh, x, deck.certificate);
    if (certificate.valid) return x;
    const auto& bound = certificate.lower_bound;
    const auto worst = std::min_element(bound.begin(), bound.end()) - bound.begin();
    throw InputError(where, "no valid mesh to start from, the worst element is ", mesh.file.element_id[worst],
                     ", with a scaled Jacobian >= ", rounded_down(bound[worst], 3));
}

}  // namespace almesh
