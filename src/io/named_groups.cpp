#include "io/named_groups.hpp"

#include <algorithm>
#include <set>

namespace almesh {

void NamedGroups::add(std::string name, int element) {
    std::replace_if(name.begin(), name.end(), [](unsigned char c) { return c < 0x20; }, '_');
    const int dim = mesh_.elements[element].dim;
    const auto [known, is_new] = tags_.try_emplace({dim, name}, static_cast<int>(mesh_.groups.size()) + 1);
    if (is_new) mesh_.groups.push_back({dim, known->second, name});
    of_.resize(std::max(of_.size(), mesh_.elements.size()));
    std::vector<int>& tags = of_[element];
    if (std::find(tags.begin(), tags.end(), known->second) == tags.end()) tags.push_back(known->second);
}

std::vector<int> NamedGroups::nodes_of_side(ElementSide side) {
    const RawElement& of = mesh_.elements[side[0]];
    const SideNodes& local = side_nodes_.try_emplace({of.dim, of.degree}, of.dim, of.degree).first->second;
    std::vector<int> nodes = local.of(of.cell(), side[1]);
    for (int& node : nodes) node = mesh_.element_nodes[of.first + node];
    return nodes;
}

void NamedGroups::add_side(const std::string& name, int element, int k) {
    const auto [known, is_new] = sides_.try_emplace({element, k}, static_cast<int>(mesh_.elements.size()));
    if (is_new) {
        const std::vector<int> nodes = nodes_of_side({element, k});
        const RawElement of = mesh_.elements[element];
        const CellType& cell = of.cell().face_type(k);
        const std::set<int> vertices(nodes.begin(), nodes.begin() + cell.vertices);
        if (static_cast<int>(vertices.size()) < cell.vertices) return void(sides_.erase(known));
        if (last_id_ == 0)
            for (const RawElement& other : mesh_.elements) last_id_ = std::max(last_id_, other.id);
        mesh_.elements.push_back(
            {++last_id_, mesh_.element_nodes.size(), of.line, of.dim - 1, of.degree, 0, 0, &cell});
        mesh_.element_nodes.insert(mesh_.element_nodes.end(), nodes.begin(), nodes.end());
    }
    add(name, known->second);
}

void NamedGroups::add_outer_sides(const std::string& name, int element) {
    const std::vector<ElementSide>& outer = outer_sides();
    for (auto at = std::lower_bound(outer.begin(), outer.end(), ElementSide{element, 0});
         at != outer.end() && (*at)[0] == element; ++at)
        add_side(name, element, (*at)[1]);
}

void NamedGroups::add_sides(const NodeSets& sets, std::size_t count) {
    std::vector<std::vector<int>> sets_of(count);  // by node, ascending
    for (std::size_t s = 0; s < sets.size(); ++s)
        for (const int node : sets[s].second)
            if (std::vector<int>& of = sets_of[node]; of.empty() || of.back() != static_cast<int>(s))
                of.push_back(static_cast<int>(s));
    std::vector<std::vector<ElementSide>> sides(sets.size());
    for (const ElementSide side : outer_sides()) {
        std::vector<int> nodes = nodes_of_side(side);
        std::erase_if(nodes, [count](int node) { return node >= static_cast<int>(count); });
        for (const int s : sets_of[nodes[0]])
            if (std::all_of(nodes.begin(), nodes.end(), [&](int node) {
                    return std::binary_search(sets_of[node].begin(), sets_of[node].end(), s);
                }))
                sides[s].push_back(side);
    }
    for (std::size_t s = 0; s < sets.size(); ++s)
        for (const auto [element, k] : sides[s])
            if (sides[s].size() < outer_.size()) add_side(sets[s].first, element, k);
}

const std::vector<NamedGroups::ElementSide>& NamedGroups::outer_sides() {
    if (!outer_.empty()) return outer_;
    constexpr int most = 6;
    const int dim = dim_of(mesh_);
    std::vector<Side> sides;
    for (std::size_t e = 0; e < mesh_.elements.size(); ++e)
        if (const RawElement& element = mesh_.elements[e]; element.dim == dim)
            for (std::size_t k = 0; k < element.cell().faces.size(); ++k)
                sides.push_back(side_of_cell(element.cell(), &mesh_.element_nodes[element.first], static_cast<int>(k),
                                             static_cast<int>(most * e + k)));
    for_equal_sides(sides, [&](std::span<const Side> equal) {
        if (equal.size() == 1) outer_.push_back({equal[0].number / most, equal[0].number % most});
    });
    std::sort(outer_.begin(), outer_.end());
    return outer_;
}

void NamedGroups::finish() {
    std::map<std::pair<int, std::vector<int>>, int> entities;  // by dimension and groups
    for (std::size_t e = 0; e < of_.size(); ++e) {
        if (of_[e].empty()) continue;
        std::sort(of_[e].begin(), of_[e].end());
        RawElement& element = mesh_.elements[e];
        const auto [known, is_new] = entities.try_emplace({element.dim, of_[e]}, static_cast<int>(entities.size()) + 1);
        if (is_new) mesh_.entities.push_back({{element.dim, known->second}, of_[e]});
        element.entity = known->second;
        element.physical = of_[e].front();
    }
    std::sort(mesh_.entities.begin(), mesh_.entities.end(), is_before);
}

}  // namespace almesh
