// Pieces are cut until the tests of the checker hold in floating-point arithmetic by more than its errors.
#include "check/proof.hpp"

#include <algorithm>
#include <array>

#include "base/parallel.hpp"
#include "base/text.hpp"
#include "geometry/element_jacobian.hpp"

namespace almesh {
namespace {

constexpr int most_cuts = 40, most_pieces = 20000;  // one after another, of an element

// "0112.." is cut at the edge of corners 0 and 1, the first half at that of 1 and 2.
struct Cuts {
    const Bernstein& form;
    double rounding;
    int pieces = 0;
    std::string tree;

    bool divide(const std::vector<double>& c, const std::array<Barycentric, 6>& corner, int depth) {
        if (*std::min_element(c.begin(), c.end()) > rounding) {
            tree += '.';
            return true;
        }
        if (depth == most_cuts || ++pieces == most_pieces) return false;
        const auto [a, b] = longest_edge(corner, form.factors);
        std::vector<double> near_a(c.size()), near_b(c.size());
        form.bisect(a, b, c.data(), near_a.data(), near_b.data());
        auto at_a = corner, at_b = corner;
        for (std::size_t k = 0; k < corner[a].size(); ++k)
            at_a[b][k] = at_b[a][k] = 0.5 * (corner[a][k] + corner[b][k]);
        tree += concat(a, b);
        return divide(near_a, at_a, depth + 1) && divide(near_b, at_b, depth + 1);
    }
};

// tree: of each element; empty where all coefficients are positive, "-" where there is no proof.
template <int n>
void divide_elements(const Mesh& mesh, const std::vector<double>& x, const ElementGroup& group,
                     std::vector<std::string>& tree) {
    const JacobianBasis basis(*group.cell, mesh.degree);
    const Bernstein& form = basis.jacobian;
    std::array<Barycentric, 6> whole{};
    for (int f = 0, first = 0; f < 3; first += form.entries(f++))
        for (int k = 0; k < form.entries(f); ++k) whole[first + k][first + (form.degrees[f] > 0 ? k : 0)] = 1;
    parallel_for_uneven((group.count + lanes - 1) / lanes, [&](int batch) {
        const int first = group.first + batch * lanes, count = std::min(lanes, group.first + group.count - first);
        const int* node[lanes];
        for (int l = 0; l < lanes; ++l) node[l] = mesh.element(first + std::min(l, count - 1));
        ElementJacobian<n, Lanes> elements(basis);
        for (int i = 0; i < basis.position.nodes; ++i) elements.position(0)[i] = gathered<n>(node, i, x);
        elements.compute(1);
        const Lanes* const b = elements.coefficients(0);
        Lanes least = b[0];
        for (int a = 1; a < form.count; ++a) least = select(b[a] < least, b[a], least);
        const Lanes rounding = elements.rounding();
        for (int l = 0; l < count; ++l) {
            if (least[l] > rounding[l]) continue;
            std::vector<double> c;
            for (int a = 0; a < form.count; ++a) c.push_back(b[a][l]);
            Cuts cuts{form, rounding[l], 0, {}};
            tree[first + l] = cuts.divide(c, whole, 0) ? cuts.tree : "-";
        }
    }, 1e4);
}

}  // namespace

Proof make_proof(const Mesh& mesh, const std::vector<double>& x) {
    Proof proof;
    std::vector<std::string> tree(mesh.element_count());
    for (const ElementGroup& group : mesh.element_groups())
        if (mesh.degree > 1 || !group.cell->is_simplex())
            with_dimension(mesh.dim, [&](auto n) { divide_elements<n()>(mesh, x, group, tree); });
    for (int e = 0; e < mesh.element_count(); ++e) {
        const std::string line = concat("element ", mesh.file.element_id[e]);
        if (tree[e] == "-" && proof.missing.empty()) proof.missing = line;
        else if (!tree[e].empty()) proof.lines += line + " " + tree[e] + "\n";
    }
    prove_boundary(mesh, x, proof);
    return proof;
}

}  // namespace almesh
