// Elements are the same where the ids of their nodes are, in whatever order.
#include "problem/start_mesh.hpp"

#include <algorithm>
#include <set>
#include <unordered_map>

#include "base/error.hpp"
#include "check/certificate.hpp"
#include "io/mesh_format.hpp"

namespace almesh {

std::vector<double> read_positions(const Deck& deck, const std::string& key, const std::string& path,
                                   const Mesh& mesh, const Frame& frame) try {
    const RawMesh raw = read_mesh(path);
    std::set<std::vector<long long>> elements;  // their ids, ascending
    for (const RawElement& element : raw.elements) {
        std::vector<long long> ids;
        for (int i = 0; i < element.node_count(); ++i)
            ids.push_back(raw.nodes[raw.element_nodes[element.first + i]].id);
        std::sort(ids.begin(), ids.end());
        if (element.dim == mesh.dim) elements.insert(std::move(ids));
    }
    const auto count = static_cast<std::size_t>(mesh.element_count());
    if (elements.size() != count)
        throw InputError("it has ", counted(elements.size(), "element"), ", the mesh of the run ", count);
    for (int e = 0; e < mesh.element_count(); ++e) {
        std::vector<long long> ids;
        for (int i = 0; i < mesh.element_nodes(e); ++i) ids.push_back(mesh.file.node_id[mesh.element(e)[i]]);
        std::sort(ids.begin(), ids.end());
        if (!elements.contains(ids))
            throw InputError("it has no element of the nodes of element ", mesh.file.element_id[e], " of the run");
    }
    std::unordered_map<long long, const RawNode*> node;
    for (const RawNode& each : raw.nodes) node[each.id] = &each;
    std::vector<double> x(mesh.x.size());
    for (int i = 0; i < mesh.nodes(); ++i)
        std::copy_n(node.at(mesh.file.node_id[i])->x, mesh.dim, point(x, i, mesh.dim));
    frame.take_to_run(x, mesh.dim);
    const std::vector<double> bound = certify(mesh, x).lower_bound;
    const auto worst = std::min_element(bound.begin(), bound.end());
    if (*worst > 0) return x;
    throw InputError("it is not certified valid: the lower bound for the scaled Jacobian of element ",
                     mesh.file.element_id[worst - bound.begin()], " is ", rounded_down(*worst, 3));
} catch (const InputError& error) {
    throw InputError(deck.given.at(key), ": ", key, " = ", key == "start" ? "" : "mesh ", path, ": ", error.what());
}

}  // namespace almesh
