// Boxes of n x m (x l) cells with periodic sides around a hole of 2 x 2 (x 2) cells in their middle, as MSH files,
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "base/small_matrix.hpp"
#include "base/error.hpp"
#include "base/text.hpp"

namespace almesh::test {

struct PeriodicBox {
    std::array<int, 3> cells{8, 4, 0};  // no third: of quadrilaterals or triangles
    bool simplices = true;
    int directions = 1;  // in which it is periodic
    std::function<Vec<3>(Vec<3>)> map = [](Vec<3> x) { return x; };  // of [0, 2] x [0, 1] x [0, 1]
    std::string sides = "left right bottom top front back body";

    int dim() const { return cells[2] ? 3 : 2; }

    std::string msh() const {
        using Corner = std::array<int, 3>;
        std::map<Corner, int> id;
        std::string nodes, elements;
        int count = 0;
        const auto node = [&](const Corner& at) {
            const auto [found, is_new] = id.try_emplace(at, static_cast<int>(id.size()) + 1);
            if (!is_new) return found->second;
            Vec<3> x{};
            for (int a = 0; a < dim(); ++a) x[a] = (a ? 1.0 : 2.0) * at[a] / cells[a];
            x = map(x);
            nodes += concat(found->second, " ", x[0], " ", x[1], " ", x[2], "\n");
            return found->second;
        };
        const auto add = [&](int type, int tag, const std::vector<int>& of) {
            elements += concat(++count, " ", type, " 2 ", tag, " ", tag);
            for (const int i : of) elements += " " + std::to_string(i);
            elements += "\n";
        };
        const auto is_cell = [&](const Corner& c) {
            bool inside = true, in_hole = true;
            for (int a = 0; a < dim(); ++a) {
                inside = inside && c[a] >= 0 && c[a] < cells[a];
                in_hole = in_hole && c[a] >= cells[a] / 2 - 1 && c[a] < cells[a] / 2 + 1;
            }
            return inside && !in_hole;
        };
        // The corners of a cell or of one of its sides, the axis `without`, in the order of their bits.
        const auto corner = [&](Corner c, int bits) {
            for (int a = 0; a < dim(); ++a) c[a] += bits >> a & 1;
            return node(c);
        };
        for (int k = 0; k < std::max(1, cells[2]); ++k)
            for (int j = 0; j < cells[1]; ++j)
                for (int i = 0; i < cells[0]; ++i) {
                    const Corner c = {i, j, k};
                    if (!is_cell(c)) continue;
                    if (simplices) {  // along the diagonal, in the order of the axes: Kuhn's
                        std::array<int, 3> axes = {0, 1, 2};
                        do {
                            std::vector<int> path = {corner(c, 0)};
                            for (int a = 0, bits = 0; a < dim(); ++a) path.push_back(corner(c, bits |= 1 << axes[a]));
                            add(dim() == 2 ? 2 : 4, 10, path);
                        } while (std::next_permutation(axes.begin(), axes.begin() + dim()));
                    } else if (dim() == 2) {
                        add(3, 10, {corner(c, 0), corner(c, 1), corner(c, 3), corner(c, 2)});
                    } else {
                        add(5, 10, {corner(c, 0), corner(c, 1), corner(c, 3), corner(c, 2), corner(c, 4), corner(c, 5),
                                    corner(c, 7), corner(c, 6)});
                    }
                    for (int a = 0; a < dim(); ++a)
                        for (const int end : {0, 1}) {
                            Corner beside = c;
                            beside[a] += end ? 1 : -1;
                            if (is_cell(beside)) continue;
                            const bool is_outer = beside[a] < 0 || beside[a] >= cells[a];
                            const int tag = is_outer ? 2 * a + 1 + end : 7, b = (a + 1) % dim(), d = (a + 2) % dim();
                            const int first = end << a, last = first | 1 << b | (dim() == 3 ? 1 << d : 0);
                            if (dim() == 2) add(1, tag, {corner(c, first), corner(c, last)});
                            else if (!simplices)
                                add(3, tag, {corner(c, first), corner(c, first | 1 << b), corner(c, last),
                                             corner(c, first | 1 << d)});
                            else
                                for (const int way : {b, d})
                                    add(2, tag, {corner(c, first), corner(c, first | 1 << way), corner(c, last)});
                        }
                }
        std::string periodic = concat("$Periodic\n", directions, "\n"), names;
        for (int a = 0; a < directions; ++a) {
            std::string pairs;
            int number = 0;
            for (const auto& [at, master] : id) {
                Corner other = at;
                other[a] = cells[a];
                if (at[a] == 0) pairs += concat(id.at(other), " ", master, "\n"), ++number;
            }
            periodic += concat(dim() - 1, " ", 2 * a + 2, " ", 2 * a + 1, "\n", number, "\n", pairs);
        }
        int tag = 0;
        for (const std::string_view name : words(sides)) names += concat(dim() - 1, " ", ++tag, " \"", name, "\"\n");
        return concat("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n8\n", names, dim(), " 10 \"fluid\"\n",
                      "$EndPhysicalNames\n$Nodes\n", id.size(), "\n", nodes, "$EndNodes\n$Elements\n", count, "\n",
                      elements, "$EndElements\n", periodic, "$EndPeriodic\n");
    }
};

// To a sector of `degrees` between the radii 1 and 2 around z, `left` at the angle 0.
inline std::function<Vec<3>(Vec<3>)> to_sector(double degrees) {
    return [degrees](Vec<3> x) {
        const double angle = degrees * std::acos(-1.0) / 180 * x[0] / 2, r = 2 - x[1];
        return Vec<3>{r * std::cos(angle), r * std::sin(angle), x[2]};
    };
}

}  // namespace almesh::test
