// Fiduccia-Mattheyses on vertex separators: a pass moves separator vertices to a side, the best gain first and uphill
// too, each at most once, and returns to the best state on the way.
#include "linalg/ordering/multilevel.hpp"

#include <algorithm>
#include <array>
#include <compare>
#include <numeric>
#include <random>
#include <utility>

namespace almesh {
namespace {

constexpr int coarsest_size = 50;     // vertices at which coarsening stops
constexpr int growings = 3;           // seeds tried on the coarsest graph
constexpr int branching_depth = 3;    // levels of coarsening before several ways are tried
constexpr int branches = 3;           // ways tried
constexpr double largest_side = 0.6;  // of the weight outside the separator

// A split under improvement. Moving v from the separator to side t pulls its neighbours on the other side into the
// separator; the move's gain is how much lighter the separator becomes.
class Split {
public:
    explicit Split(const WeightedGraph& graph)
        : graph_(graph), part_(graph.size(), right), last_pass_(graph.size(), 0) {
        for (int side : {left, right}) pull_[side].resize(graph.size()), version_[side].assign(graph.size(), 0);
    }

    void assign(std::vector<Part> part) {
        part_ = std::move(part);
        weigh();
    }
    const std::vector<Part>& part() const { return part_; }

    // Splits anew: the left side grows from the seed, always by the vertex of the largest gain, to half of the weight.
    void grow(std::minstd_rand& random) {
        std::fill(part_.begin(), part_.end(), right);
        weigh();
        start_pass(to_left);
        const long long total = weight_[right];
        const int n = graph_.size();
        while (2 * weight_[left] < total - weight_[separator]) {
            int v = best(left);
            if (v < 0) {  // the start, or a component is exhausted
                v = static_cast<int>(random() % n);
                for (int tried = 0; tried < n && part_[v] != right; ++tried) v = (v + 1) % n;
                if (part_[v] != right) break;
                put(v, separator);
                enter_separator(v);
            }
            move(v, left);
        }
    }

    // Passes that push the separator to one side sweep it through the graph, one in both directions smooths it. More of
    // them cost a quarter of the ordering and leave the fill as it is.
    void refine() {
        for (Direction direction : {to_left, to_right, both_ways}) pass(direction);
    }

    // Lexicographic, smaller is better: is a side too heavy, weight of the separator, difference of the sides.
    std::array<long long, 3> cost() const {
        const long long heavy = std::max(weight_[left], weight_[right]), sides = weight_[left] + weight_[right];
        const bool lopsided = weight_[left] == 0 || weight_[right] == 0 || heavy > largest_side * sides + slack_;
        return {lopsided ? 1 + heavy : 0, weight_[separator], 2 * heavy - sides};
    }

private:
    enum Direction { to_left, to_right, both_ways };
    struct Candidate {
        int gain, version, vertex;
        auto operator<=>(const Candidate&) const = default;
    };
    struct Move {
        int vertex;
        std::size_t pulled_end;  // pulled_ [previous end, this end): vertices pulled into the separator
    };

    static Part opposite(Part side) { return side == left ? right : left; }

    void weigh() {
        std::fill_n(weight_, 3, 0);
        slack_ = 0;
        for (int v = 0; v < graph_.size(); ++v) {
            weight_[part_[v]] += graph_.weight[v];
            slack_ = std::max(slack_, graph_.weight[v]);
        }
    }

    // Forgets the moves and candidates of the pass before; versions and pass numbers only grow, so old ones never
    // match.
    void start_pass(Direction direction) {
        open_[left] = direction != to_right;
        open_[right] = direction != to_left;
        queue_[left].clear();
        queue_[right].clear();
        moves_.clear();
        pulled_.clear();
        ++pass_;
    }

    void put(int v, Part part) {
        weight_[part_[v]] -= graph_.weight[v];
        weight_[part] += graph_.weight[v];
        part_[v] = part;
    }

    void push(int v, int side) {
        if (!open_[side] || last_pass_[v] == pass_) return;
        version_[side][v] = ++clock_;
        queue_[side].push_back({graph_.weight[v] - pull_[side][v], clock_, v});
        std::push_heap(queue_[side].begin(), queue_[side].end());
    }

    // Computes the gains of a vertex that has just become part of the separator.
    void enter_separator(int v) {
        pull_[left][v] = pull_[right][v] = 0;
        for (int u : graph_.neighbours(v))
            if (part_[u] != separator) pull_[1 - part_[u]][v] += graph_.weight[u];
        push(v, left);
        push(v, right);
    }

    // Vertex of the largest gain towards a side, -1 if there is none. A gain that has become smaller since the
    // candidate was pushed sends it back into the queue.
    int best(int side) {
        auto& queue = queue_[side];
        while (!queue.empty()) {
            const Candidate top = queue.front();
            const bool valid = version_[side][top.vertex] == top.version && part_[top.vertex] == separator;
            if (valid && top.gain == graph_.weight[top.vertex] - pull_[side][top.vertex]) return top.vertex;
            std::pop_heap(queue.begin(), queue.end());
            queue.pop_back();
            if (valid) push(top.vertex, side);
        }
        return -1;
    }

    void move(int v, Part side) {
        const Part other = opposite(side);
        put(v, side);
        last_pass_[v] = pass_;
        version_[left][v] = version_[right][v] = 0;
        for (int u : graph_.neighbours(v)) {
            if (part_[u] == separator) {
                pull_[other][u] += graph_.weight[v];  // a smaller gain, which best() notices
            } else if (part_[u] == other) {
                put(u, separator);
                pulled_.push_back(u);
                for (int w : graph_.neighbours(u)) {
                    if (part_[w] != separator || w == u) continue;
                    pull_[side][w] -= graph_.weight[u];
                    push(w, side);
                }
                enter_separator(u);
            }
        }
        moves_.push_back({v, pulled_.size()});
    }

    // Takes the last move back; gains are not restored.
    void undo() {
        const int v = moves_.back().vertex;
        moves_.pop_back();
        const std::size_t begin = moves_.empty() ? 0 : moves_.back().pulled_end;
        for (; pulled_.size() > begin; pulled_.pop_back()) put(pulled_.back(), opposite(part_[v]));
        put(v, separator);
    }

    // Side of the next move, -1 if there is none: the one of the larger gain if both are open and it does not grow too
    // heavy, the lighter one among equals.
    int choose() {
        const bool open[2] = {best(left) >= 0, best(right) >= 0};
        if (!open[left] && !open[right]) return -1;
        int side = weight_[left] <= weight_[right] ? left : right;
        const int other = 1 - side;
        if (!open[side] || (open[other] && queue_[other].front().gain > queue_[side].front().gain)) {
            const long long heavy = weight_[other] + graph_.weight[queue_[other].front().vertex];
            if (heavy <= largest_side * (weight_[left] + weight_[right])) return other;
        }
        return open[side] ? side : -1;
    }

    // One pass: every vertex moves at most once, uphill too, and the best state on the way is kept.
    void pass(Direction direction) {
        start_pass(direction);
        std::size_t boundary = 0;  // vertices of the separator
        for (int v = 0; v < graph_.size(); ++v)
            if (part_[v] == separator) {
                enter_separator(v);
                ++boundary;
            }
        auto best_cost = cost();
        std::size_t best_moves = 0;
        const std::size_t patience = std::min<std::size_t>(300, boundary + 20);
        while (moves_.size() < best_moves + patience) {
            const int side = choose();
            if (side < 0) break;
            move(queue_[side].front().vertex, static_cast<Part>(side));
            if (cost() < best_cost) {
                best_cost = cost();
                best_moves = moves_.size();
            }
        }
        while (moves_.size() > best_moves) undo();
    }

    const WeightedGraph& graph_;
    std::vector<Part> part_;
    std::vector<int> last_pass_;              // in which the vertex moved; not again in the same one
    std::vector<int> pull_[2];                // weight pulled in when the vertex moves to each side
    std::vector<int> version_[2];             // of the only valid candidate of the vertex; 0: none
    std::vector<Candidate> queue_[2];         // heaps by gain, the newest first among equals; outdated ones are skipped
    int clock_ = 0, pass_ = 0;
    bool open_[2] = {true, true};             // sides to which this pass moves vertices
    long long weight_[3] = {0, 0, 0};
    int slack_ = 0;                           // weight of the heaviest vertex: the balance cannot be better than that
    std::vector<Move> moves_;
    std::vector<int> pulled_;
};

// The split of least cost among several tries.
template <class Try>
std::vector<Part> best_of(int tries, Split& split, const Try& try_number) {
    std::vector<Part> best;
    std::array<long long, 3> best_cost;
    for (int t = 0; t < tries; ++t) {
        try_number(t);
        if (t > 0 && !(split.cost() < best_cost)) continue;
        best_cost = split.cost();
        best = split.part();
    }
    return best;
}

std::vector<Part> split_coarsest(const WeightedGraph& graph, std::uint64_t seed) {
    std::minstd_rand random(static_cast<unsigned>(seed % 2147483646u + 1));
    Split split(graph);
    return best_of(growings, split, [&](int) {
        split.grow(random);
        split.refine();
    });
}

// The split of a coarser graph becomes that of this one, and is improved.
void project(const std::vector<Part>& coarse, const std::vector<int>& coarse_of, Split& split) {
    std::vector<Part> fine(coarse_of.size());
    for (std::size_t v = 0; v < fine.size(); ++v) fine[v] = coarse[coarse_of[v]];
    split.assign(std::move(fine));
    split.refine();
}

// Separator of a graph that has been coarsened `depth` times. Some levels down, the graph is small enough to try
// several ways of coarsening it further; the best separator is carried on.
std::vector<Part> separate(const WeightedGraph& graph, int heaviest, int depth, std::uint64_t seed) {
    if (graph.size() <= coarsest_size) return split_coarsest(graph, seed);
    const Coarsening coarse = coarsen(graph, heaviest, seed);
    if (coarse.graph.size() > 0.95 * graph.size()) return split_coarsest(graph, seed);
    Split split(graph);
    return best_of(depth == branching_depth ? branches : 1, split, [&](int b) {
        project(separate(coarse.graph, heaviest, depth + 1, seed + 1 + 1000 * b), coarse.coarse_of, split);
    });
}

// Merged vertices may not weigh more, so that those of the coarsest graph stay comparable.
int heaviest_group(const WeightedGraph& graph) {
    const long long total = std::accumulate(graph.weight.begin(), graph.weight.end(), 0LL);
    return static_cast<int>(std::max<long long>(2, 3 * total / (2 * coarsest_size)));
}

}  // namespace

std::vector<Part> find_separator(const Hierarchy& graphs, std::uint64_t seed) {
    const int steps = static_cast<int>(graphs.coarser.size());
    std::vector<Part> part = separate(graphs.coarsest(), heaviest_group(graphs.finest), steps, seed);
    for (int k = steps - 1; k >= 0; --k) {
        Split split(k == 0 ? graphs.finest : graphs.coarser[k - 1].graph);
        project(part, graphs.coarser[k].coarse_of, split);
        part = split.part();
    }
    return part;
}

}  // namespace almesh
