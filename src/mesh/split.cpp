#include "mesh/split.hpp"

#include <algorithm>
#include <map>
#include <numeric>
#include <span>

#include "mesh/kept_cells.hpp"
#include "mesh/lagrange.hpp"
#include "mesh/node_key.hpp"
#include "mesh/sides.hpp"

namespace almesh {
namespace {

// Those of `parts` of the cell with these vertices, `count` vertices each.
template <class Part>
std::vector<Simplex> subsimplices(std::span<const Part> parts, int count, const int* vertex) {
    std::vector<Simplex> result;
    for (const Part& part : parts) {
        Simplex simplex;
        for (int k = 0; k < count; ++k) simplex.push_back(vertex[part[k]]);
        std::sort(simplex.begin(), simplex.end());
        result.push_back(std::move(simplex));
    }
    return result;
}

bool has(std::span<const int> vertices, const Simplex& s) {
    const auto is_vertex = [&](int v) { return std::find(vertices.begin(), vertices.end(), v) != vertices.end(); };
    return std::all_of(s.begin(), s.end(), is_vertex);
}

std::vector<long long> all_ids(const Mesh& mesh) {
    std::vector<long long> ids = mesh.file.element_id;
    ids.insert(ids.end(), mesh.file.face_id.begin(), mesh.file.face_id.end());
    for (const KeptCells& kept : mesh.kept) ids.insert(ids.end(), kept.id.begin(), kept.id.end());
    return ids;
}

class Splitting {
public:
    Splitting(Mesh& mesh, const std::vector<Simplex>& at)
        : mesh_(mesh), basis_(mesh.dim, mesh.degree), ids_(all_ids(mesh)), whole_(mesh.element_count()) {
        std::iota(whole_.begin(), whole_.end(), 0);
        for (const Simplex& s : at) around_[s[0]];
        for (const int e : whole_) remember(e);
    }

    void divide(const Simplex& s) {
        std::map<NodeKey, int> node_of;
        const std::vector<int> candidates = around_[s[0]];
        for (const int e : candidates)
            if (has(vertices(e), s)) divide_element(e, s, node_of);
        const int dim_of_s = static_cast<int>(s.size()) - 1;
        MultiIndex middle{};
        std::fill_n(middle.begin(), s.size(), mesh_.degree);
        for (int dim = dim_of_s; dim <= mesh_.dim; ++dim)
            divide_kept(mesh_.kept[dim], dim, s, node_of.at(key_of(middle, s.data(), dim_of_s)));
    }

    // What refers to elements, which are in parts now.
    void finish() {
        const Subcells subcells(mesh_);
        for (int f = 0; f < mesh_.face_count(); ++f)
            mesh_.face_element[f] = part_of(mesh_.face_element[f], [&](int e) {
                return side_number(mesh_, e, mesh_.face_vertices(f)) >= 0;
            });
        for (int dim = 1; dim <= mesh_.dim; ++dim) {
            KeptCells& kept = mesh_.kept[dim];
            const int width = simplex_node_count(dim, mesh_.degree);
            for (int c = 0; c < kept.count(); ++c) {
                if (!parts_.contains(kept.element[c])) continue;
                int* const node = &kept.nodes[offset(c, width)];
                kept.element[c] = part_of(kept.element[c], [&](int e) { return subcells.has(e, node, simplex(dim)); });
                const std::vector<int> nodes = subcells.nodes(kept.element[c], node, simplex(dim));
                std::copy(nodes.begin(), nodes.end(), node);
            }
        }
        append_node_ids(mesh_, mesh_);
        mesh_.file.leave_file();
    }

private:
    Mesh& mesh_;
    const LagrangeBasis basis_;
    UnusedIds<long long> ids_;
    std::vector<int> whole_;                  // per element: of which one it is a part
    std::map<int, std::vector<int>> parts_;   // of elements that are divided: the others
    std::map<int, std::vector<int>> around_;  // elements at the first vertices of all simplices

    std::span<const int> vertices(int e) const { return {mesh_.element(e), static_cast<std::size_t>(mesh_.dim) + 1}; }

    void remember(int e) {
        for (const int v : vertices(e))
            if (const auto at = around_.find(v); at != around_.end()) at->second.push_back(e);
    }

    template <class Test>
    int part_of(int e, const Test& test) const {
        const auto others = parts_.find(e);
        if (others == parts_.end() || test(e)) return e;
        return *std::find_if(others->second.begin(), others->second.end(), test);
    }

    int append_part(int e) {
        const int part = mesh_.element_count();
        mesh_.elements.resize(mesh_.elements.size() + basis_.count);
        mesh_.file.element_id.push_back(ids_.next());
        for (std::vector<int>* const of : {&mesh_.file.element_physical, &mesh_.file.element_entity, &whole_})
            if (!of->empty()) of->push_back((*of)[e]);
        parts_[whole_[e]].push_back(part);
        return part;
    }

    // node_of: nodes by |s| times their barycentric entries.
    void divide_element(int e, const Simplex& s, std::map<NodeKey, int>& node_of) {
        const int dim = mesh_.dim, count = static_cast<int>(s.size());
        const std::vector<int> old(mesh_.element(e), mesh_.element(e) + basis_.count);
        std::vector<MultiIndex> scaled = basis_.nodes;
        for (int i = 0; i < basis_.count; ++i) {
            for (int& entry : scaled[i]) entry *= count;
            node_of.try_emplace(key_of(scaled[i], old.data(), dim), old[i]);
        }
        for (int k = 0; k < count; ++k) {  // the part without vertex k of s
            const int part = k == 0 ? e : append_part(e);
            const auto local = std::find(old.begin(), old.begin() + dim + 1, s[k]) - old.begin();
            for (int i = 0; i < basis_.count; ++i) {
                MultiIndex at = scaled[i];
                at[local] = 0;
                for (int j = 0; j <= dim; ++j)
                    if (std::find(s.begin(), s.end(), old[j]) != s.end()) at[j] += basis_.nodes[i][local];
                const auto [node, is_new] = node_of.try_emplace(key_of(at, old.data(), dim), mesh_.nodes());
                if (is_new) append_node(old, at, count);
                mesh_.elements[offset(part, basis_.count, i)] = node->second;
            }
            remember(part);
        }
    }

    void append_node(const std::vector<int>& old, const MultiIndex& at, int count) {
        double xi[3], N[simplex_node_count(3, max_degree)];
        for (int k = 0; k < mesh_.dim; ++k) xi[k] = static_cast<double>(at[k + 1]) / (count * mesh_.degree);
        basis_.values(xi, N);
        for (int a = 0; a < mesh_.dim; ++a) {
            double x = 0;
            for (int j = 0; j < basis_.count; ++j) x += N[j] * mesh_.x[offset(old[j], mesh_.dim, a)];
            mesh_.x.push_back(x);
        }
    }

    // By their vertices; finish() tells the other nodes.
    void divide_kept(KeptCells& kept, int dim, const Simplex& s, int middle) {
        const int width = simplex_node_count(dim, mesh_.degree), count = kept.count();
        for (int c = 0; c < count; ++c) {
            const std::vector<int> old(&kept.nodes[offset(c, width)], &kept.nodes[offset(c, width)] + width);
            if (!has(std::span(old).first(dim + 1), s)) continue;
            for (std::size_t k = 0; k < s.size(); ++k) {
                const int part = k == 0 ? c : kept.count();
                if (k > 0) {
                    kept.nodes.insert(kept.nodes.end(), old.begin(), old.end());
                    append_tags(kept, c, kept);
                    kept.id.back() = ids_.next();
                }
                int* const vertex = &kept.nodes[offset(part, width)];
                std::replace(vertex, vertex + dim + 1, s[k], middle);
            }
        }
    }
};

}  // namespace

std::vector<std::vector<Simplex>> inner_simplices(const Mesh& mesh, const std::vector<int>& elements,
                                                  const std::vector<char>& boundaries) {
    std::map<int, std::vector<int>> faces_at;  // vertices of the elements
    for (const int e : elements)
        for (int k = 0; k <= mesh.dim; ++k) faces_at[mesh.element(e)[k]];
    for (int f = 0; f < mesh.face_count() && !elements.empty(); ++f) {
        if (!boundaries.empty() && !boundaries[mesh.face_boundary[f]]) continue;
        for (const int node : mesh.face_vertices(f))
            if (const auto at = faces_at.find(node); at != faces_at.end()) at->second.push_back(f);
    }
    const auto is_none = [&](const Simplex& s) {  // on a face, or with a vertex that is on none
        const auto has_s = [&](int f) { return has(mesh.face_vertices(f), s); };
        const std::vector<int>& faces = faces_at.at(s[0]);
        return std::any_of(faces.begin(), faces.end(), has_s) ||
               std::any_of(s.begin(), s.end(), [&](int v) { return faces_at.at(v).empty(); });
    };
    std::vector<std::vector<Simplex>> inner;
    for (const int e : elements) {
        inner.push_back(subsimplices(mesh.cell().edges, 2, mesh.element(e)));
        std::erase_if(inner.back(), is_none);
        if (!inner.back().empty() || mesh.dim == 2) continue;
        inner.back() = subsimplices(mesh.cell().faces, 3, mesh.element(e));
        std::erase_if(inner.back(), is_none);
    }
    return inner;
}

Mesh split(Mesh mesh, const std::vector<Simplex>& at) {
    Splitting splitting(mesh, at);
    for (const Simplex& s : at) splitting.divide(s);
    splitting.finish();
    return mesh;
}

}  // namespace almesh
