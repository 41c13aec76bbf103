// Top-down, breadth first: each node's items are split at the median of their centres along the longest side of its box
// (nth_element), so that the depth is log2 of the number of boxes.
#include "geometry/box_tree.hpp"

#include <numeric>
#include <utility>

namespace almesh {
namespace {

constexpr int leaf_items = 2;

void include(Box& box, const Box& other) {
    for (int a = 0; a < 3; ++a) {
        box.low[a] = std::min(box.low[a], other.low[a]);
        box.high[a] = std::max(box.high[a], other.high[a]);
    }
}

int longest_side(const Box& box) {
    int longest = 0;
    for (int a = 1; a < 3; ++a)
        if (box.high[a] - box.low[a] > box.high[longest] - box.low[longest]) longest = a;
    return longest;
}

}  // namespace

Box box_of_points(const double* points, int count, int dim) {
    Box box;
    for (int a = 0; a < dim; ++a) {
        box.low[a] = box.high[a] = points[a];
        for (int i = 1; i < count; ++i) {
            box.low[a] = std::min(box.low[a], points[i * dim + a]);
            box.high[a] = std::max(box.high[a], points[i * dim + a]);
        }
    }
    return box;
}

double squared_distance(const Box& box, const double* point, int dim) {
    double sum = 0;
    for (int a = 0; a < dim; ++a) {
        const double d = std::max({box.low[a] - point[a], point[a] - box.high[a], 0.0});
        sum += d * d;
    }
    return sum;
}

BoxTree::BoxTree(std::vector<Box> boxes_) : boxes(std::move(boxes_)) {
    const int count = static_cast<int>(boxes.size());
    items.resize(count);
    std::iota(items.begin(), items.end(), 0);
    if (count > 0) nodes.push_back({{}, 0, count, 0});
    for (std::size_t k = 0; k < nodes.size(); ++k) {
        const int begin = nodes[k].begin, end = nodes[k].end;
        Box box = boxes[items[begin]];
        for (int i = begin + 1; i < end; ++i) include(box, boxes[items[i]]);
        nodes[k].box = box;
        if (end - begin <= leaf_items) continue;
        const int side = longest_side(box), middle = (begin + end) / 2;
        std::nth_element(items.begin() + begin, items.begin() + middle, items.begin() + end, [&](int i, int j) {
            const double a = boxes[i].low[side] + boxes[i].high[side], b = boxes[j].low[side] + boxes[j].high[side];
            return a != b ? a < b : i < j;
        });
        nodes[k].child = static_cast<int>(nodes.size());
        nodes.push_back({{}, begin, middle, 0});
        nodes.push_back({{}, middle, end, 0});
    }
}

}  // namespace almesh
