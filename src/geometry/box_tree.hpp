// A tree of axis-parallel boxes: which of many boxes overlap a given one, or hold the point closest to a given one.
//
// Built by halving at the median centre along the longest side; O(n log n) to build, O(log n) for a typical query.
#pragma once
#include <algorithm>
#include <array>
#include <limits>
#include <vector>

namespace almesh {

// In 2D the third interval is [0, 0].
struct Box {
    std::array<double, 3> low{}, high{};
};

Box box_of_points(const double* points, int count, int dim);  // points: count x dim, count > 0

double squared_distance(const Box& box, const double* point, int dim);

// Touching boxes overlap. Branch-free: branches here are unpredictable.
inline bool overlap(const Box& a, const Box& b) {
    bool apart = false;
    for (int k = 0; k < 3; ++k) {
        apart |= a.high[k] < b.low[k];
        apart |= b.high[k] < a.low[k];
    }
    return !apart;
}

struct BoxTree {
    struct Node {
        Box box;
        int begin, end;  // its items
        int child;       // first of two consecutive nodes, 0 for a leaf
    };
    std::vector<Node> nodes;  // the root first; empty for no boxes
    std::vector<int> items;   // numbers of the boxes
    std::vector<Box> boxes;

    explicit BoxTree(std::vector<Box> boxes);

    // found(i) for every box i that overlaps `box`, among items[first], items[first + 1], .... Called with the box of
    // items[k] and first = k + 1 for every k, it finds each pair of overlapping boxes once.
    template <class Found>
    void visit_overlapping(const Box& box, const Found& found, int first = 0) const {
        std::array<int, 64> stack;  // depth of a tree that halves 2^31 items at most
        int top = 0;
        if (!nodes.empty()) stack[top++] = 0;
        while (top > 0) {
            const Node& node = nodes[stack[--top]];
            if (node.end <= first || !overlap(node.box, box)) continue;
            if (node.child > 0) {
                stack[top++] = node.child;
                stack[top++] = node.child + 1;
                continue;
            }
            for (int k = std::max(node.begin, first); k < node.end; ++k)
                if (overlap(boxes[items[k]], box)) found(items[k]);
        }
    }

    // Least value of squared(i) over all boxes i, where squared(i) is the squared distance of `point` to something
    // inside box i (branch and bound, the nearer child first). Infinite for no boxes.
    template <class Squared>
    double nearest_squared(const double* point, int dim, const Squared& squared) const {
        double best = std::numeric_limits<double>::infinity();
        struct Entry {
            double bound;
            int node;
        };
        std::array<Entry, 64> stack;
        int top = 0;
        const auto entry = [&](int k) { return Entry{squared_distance(nodes[k].box, point, dim), k}; };
        if (!nodes.empty()) stack[top++] = entry(0);
        while (top > 0) {
            const Entry at = stack[--top];
            if (at.bound >= best) continue;
            const Node& node = nodes[at.node];
            if (node.child > 0) {
                Entry near = entry(node.child), far = entry(node.child + 1);
                if (far.bound < near.bound) std::swap(near, far);
                stack[top++] = far;
                stack[top++] = near;
                continue;
            }
            for (int k = node.begin; k < node.end; ++k)
                if (squared_distance(boxes[items[k]], point, dim) < best) best = std::min(best, squared(items[k]));
        }
        return best;
    }
};

}  // namespace almesh
