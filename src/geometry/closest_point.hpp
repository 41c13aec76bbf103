// The point closest to a given one on polynomial patches: curves in the plane or triangles in space, such as the faces
// of a boundary, curved as they are. The error is of the order of the rounding errors of the coordinates. Where a patch
// is curved so strongly that the distance has several minima on a nearly flat piece of it, the least one may be missed.
//
// Cost: O(log patches) boxes and a few Newton steps per point.
#pragma once
#include <array>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "geometry/box_tree.hpp"
#include "geometry/patch.hpp"

namespace almesh {

class ClosestPoint {
public:
    // patches: at least one, of the degree of the basis.
    ClosestPoint(const PatchBasis& basis, const std::vector<Patch>& patches);

    struct Place {
        int patch = -1;
        Vec<3> at{};  // barycentric coordinates in it; on a curve the third is 0
        Vec<3> position{};
        double distance = std::numeric_limits<double>::infinity();
    };

    // On those patches only for which `chosen` holds, if it is given; patch -1 where it holds for none.
    Place find(const Vec<3>& x, const std::function<bool(int patch)>& chosen = nullptr) const;

private:
    struct Piece {
        Patch patch;
        int whole;                     // the patch that it is a piece of,
        std::array<Vec<3>, 3> corner;  // and where its corners are there
    };
    struct Nearest {
        double squared = std::numeric_limits<double>::infinity();
        Vec<3> l{}, r{};  // barycentric coordinates in the piece, and from x to the point there
    };
    struct SecondOrderForm;
    struct Expansion;

    std::shared_ptr<const SecondOrderForm> form_;
    std::vector<Piece> pieces_;
    double margin_;
    std::optional<BoxTree> tree_;

    void append_nearly_flat(const Bernstein& basis, const Piece& piece, int depth);
    Expansion expand(const Patch& relative, const Vec<3>& l) const;
    Vec<3> newton_step(const Expansion& c, const Vec<3>& l, double& decrease) const;
    bool is_farther(const Patch& patch, const Vec<3>& x, double distance, const Vec<3>& d) const;
    Nearest descend(const Patch& patch, const Vec<3>& x, const Nearest& so_far) const;
};

}  // namespace almesh
