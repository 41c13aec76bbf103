// A tree of axis-parallel boxes: which of many boxes overlap a given one, or hold the point closest to a given one.
//
// Built top-down: the boxes of a node are split at the median of their centres along the longest side of the node, so
// that the depth is log2 of their number. O(n log n) to build, O(log n) for a typical query.
#pragma once
#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include "base/small_matrix.hpp"

namespace almesh {

// In 2D the third interval is [0, 0].
struct Box {
    Vec<3> low{}, high{};

    void include(const Box& other) {
        for (int a = 0; a < 3; ++a) {
            low[a] = std::min(low[a], other.low[a]);
            high[a] = std::max(high[a], other.high[a]);
        }
    }

    int longest_side() const {
        const Vec<3> side = high - low;
        return static_cast<int>(std::max_element(side.begin(), side.end()) - side.begin());
    }
};

inline Box box_of(const std::vector<Vec<3>>& points) {
    Box box{points[0], points[0]};
    for (const Vec<3>& point : points) box.include({point, point});
    return box;
}

inline double squared_distance(const Box& box, const Vec<3>& point) {
    double sum = 0;
    for (int a = 0; a < 3; ++a) {
        const double d = std::max({box.low[a] - point[a], point[a] - box.high[a], 0.0});
        sum += d * d;
    }
    return sum;
}

// Touching boxes overlap. Branch-free: branches here are unpredictable.
inline bool overlap(const Box& a, const Box& b) {
    const auto in = [&](int k) { return int(a.low[k] <= b.high[k]) & int(b.low[k] <= a.high[k]); };
    return (in(0) & in(1) & in(2)) != 0;
}

class BoxTree {
public:
    std::vector<int> items;  // numbers of the boxes, those of each node side by side
    std::vector<Box> boxes;

    explicit BoxTree(std::vector<Box> boxes_) : items(boxes_.size()), boxes(std::move(boxes_)) {
        std::iota(items.begin(), items.end(), 0);
        nodes_.push_back({{}, 0, static_cast<int>(items.size()), 0});
        for (std::size_t k = 0; k < nodes_.size(); ++k) {
            const int begin = nodes_[k].begin, end = nodes_[k].end;
            if (begin < end) nodes_[k].box = boxes[items[begin]];
            for (int i = begin; i < end; ++i) nodes_[k].box.include(boxes[items[i]]);
            if (end - begin <= leaf_items) continue;
            const int side = nodes_[k].box.longest_side(), middle = (begin + end) / 2;
            std::nth_element(items.begin() + begin, items.begin() + middle, items.begin() + end, [&](int i, int j) {
                const double a = boxes[i].low[side] + boxes[i].high[side], b = boxes[j].low[side] + boxes[j].high[side];
                return a != b ? a < b : i < j;
            });
            nodes_[k].child = static_cast<int>(nodes_.size());
            nodes_.push_back({{}, begin, middle, 0});
            nodes_.push_back({{}, middle, end, 0});
        }
        in_order_.reserve(items.size());
        for (const int i : items) in_order_.push_back(boxes[i]);
    }

    // found(q, k) for every query q and every box items[k], k >= first, that overlap. All queries go down the tree
    // together, a node at a time, so that a node is loaded once for all and no branch waits for a comparison; a few
    // hundred that are not far from each other are a good number. What is found for a query comes in the same order
    // whatever others there are.
    template <class Found>
    void visit_overlapping(const std::vector<Box>& queries, const Found& found, int first = 0) const {
        std::vector<int> open(queries.size());
        std::iota(open.begin(), open.end(), 0);
        visit_overlapping(queries, found, first, 0, 0, open);
    }

    // Least value of squared(i) over all boxes i, where squared(i) is the squared distance of `point` to something
    // inside box i, or `best` if that is less (branch and bound, the nearer child first). Infinite for no boxes.
    template <class Squared>
    double nearest_squared(const Vec<3>& point, const Squared& squared,
                           double best = std::numeric_limits<double>::infinity(), int root = 0) const {
        const Node& node = nodes_[root];
        if (node.child > 0) {
            std::pair<double, int> near(squared_distance(nodes_[node.child].box, point), node.child);
            std::pair<double, int> far(squared_distance(nodes_[node.child + 1].box, point), node.child + 1);
            if (far.first < near.first) std::swap(near, far);
            for (const auto& [bound, child] : {near, far})
                if (bound < best) best = nearest_squared(point, squared, best, child);
            return best;
        }
        for (int k = node.begin; k < node.end; ++k)
            if (squared_distance(in_order_[k], point) < best) best = std::min(best, squared(items[k]));
        return best;
    }

private:
    static constexpr int leaf_items = 8;

    struct Node {
        Box box;
        int begin, end;  // its items
        int child;       // first of two consecutive nodes, 0 for a leaf
    };
    std::vector<Node> nodes_;    // the root first
    std::vector<Box> in_order_;  // of items

    // open: from `begin` on the queries that overlap the box of the parent of `root`; the same on return.
    template <class Found>
    void visit_overlapping(const std::vector<Box>& queries, const Found& found, int first, int root,
                           std::size_t begin, std::vector<int>& open) const {
        const Node& node = nodes_[root];
        const std::size_t end = open.size();
        if (node.end <= first) return;
        open.resize(2 * end - begin);
        std::size_t count = end;
        for (std::size_t k = begin; k < end; ++k) {
            open[count] = open[k];
            count += overlap(node.box, queries[open[k]]);
        }
        open.resize(count);
        if (count > end && node.child > 0)
            for (int child : {node.child + 1, node.child}) visit_overlapping(queries, found, first, child, end, open);
        else
            for (std::size_t k = end; k < count; ++k)
                for (int i = std::max(node.begin, first); i < node.end; ++i)
                    if (overlap(in_order_[i], queries[open[k]])) found(open[k], i);
        open.resize(end);
    }
};

}  // namespace almesh
