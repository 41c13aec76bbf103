#include "mesh/periodic.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "mesh/mesh.hpp"

namespace almesh {
namespace {

constexpr double of_size = 1e-6;  // of a mesh or a side: how far nodes are apart that are images of each other

using Pair = PeriodicPairs::Pair;

double length(const Vec<3>& v) { return std::sqrt(dot(v, v)); }

Vec<3> at_node(const std::vector<double>& x, int i, int dim) {
    Vec<3> v{};
    std::copy_n(point(x, i, dim), dim, v.begin());
    return v;
}

bool equal(const Mat<3>& A, const Mat<3>& B) {
    double squared = 0;
    for (int i = 0; i < 3; ++i) squared += dot(A[i] - B[i], A[i] - B[i]);
    return squared <= of_size * of_size;
}

constexpr Mat<3> one = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};

// Its rows are orthonormal, the first two in the directions of u and v.
Mat<3> frame_of(const Vec<3>& u, const Vec<3>& v) {
    const Vec<3> w = cross(u, v), across = cross(w, u);
    return {1 / length(u) * u, 1 / length(across) * across, 1 / length(w) * w};
}

PeriodicSides inverse(PeriodicSides by) {
    by.R = transpose<3>(by.R);
    by.t = Vec<3>{} - (by.image(by.t) - by.t);
    return by;
}

PeriodicSides after(const PeriodicSides& first, PeriodicSides then) {
    then.t = then.image(first.t);
    then.R = multiply<3>(then.R, first.R);
    return then;
}

// A direction along which hardly two nodes of a mesh are side by side; nodes by their places on it.
constexpr Vec<3> direction = {0.5377, 0.6542, 0.5319};
using NodesAlong = std::set<std::pair<double, int>>;

// -1 where there is none.
int nearest(const Vec<3>& at, const NodesAlong& nodes, const Mesh& mesh, double tolerance) {
    int found = -1;
    const double place = dot(direction, at), last = place + tolerance;
    for (auto node = nodes.lower_bound({place - tolerance, 0}); node != nodes.end() && node->first <= last; ++node)
        if (const double distance = length(at_node(mesh.x, node->second, mesh.dim) - at); distance < tolerance)
            tolerance = distance, found = node->second;
    return found;
}

// matched: per face, whether it has an image or is one.
std::vector<Pair> links_of(const Mesh& mesh, const std::vector<char>& boundaries, std::vector<char>& matched) {
    std::vector<Pair> links;
    matched.assign(mesh.face_count(), 0);
    const double size = mesh.file.periodic.empty() ? 0 : size_of(mesh);
    for (const PeriodicSides& by : mesh.file.periodic) {
        if (by.dim != mesh.dim - 1 || (equal(by.R, one) && length(by.t) <= of_size * size)) continue;
        const int tag[] = {by.master, by.slave};
        const auto is_of = [&](int f, int side) {
            return boundaries[mesh.face_boundary[f]] && (tag[side] == 0 || tag[side] == mesh.file.face_entity[f]);
        };
        NodesAlong slaves;
        std::set<int> masters, linked[2];
        for_face_nodes(mesh, [&](int f, std::size_t k) {
            const int i = mesh.faces[k];
            if (is_of(f, 0)) masters.insert(i);
            if (is_of(f, 1)) slaves.emplace(dot(direction, at_node(mesh.x, i, mesh.dim)), i);
        });
        for (const int i : masters) {
            const int image = nearest(by.image(at_node(mesh.x, i, mesh.dim)), slaves, mesh, of_size * size);
            if (image < 0) continue;
            links.push_back({image, i, by});
            linked[0].insert(i);
            linked[1].insert(image);
        }
        for (int f = 0; f < mesh.face_count(); ++f)
            for (const int side : {0, 1})
                if (is_of(f, side) && std::all_of(mesh.face(f), mesh.face(f) + mesh.face_nodes(f),
                                                  [&](int i) { return linked[side].contains(i); }))
                    matched[f] = 1;
    }
    return links;
}

}  // namespace

double size_of(const Mesh& mesh) {
    double size = 0;
    for (int i = 0; i < mesh.nodes(); ++i)
        size = std::max(size, length(at_node(mesh.x, i, mesh.dim) - at_node(mesh.x, 0, mesh.dim)));
    return size;
}

bool fit(const std::vector<std::pair<Vec<3>, Vec<3>>>& points, PeriodicSides& sides) {
    if (points.empty()) return false;
    const auto& [a, b] = points[0];
    Vec<3> along[2] = {}, across[2] = {};  // to the point that is farthest from a, and to that farthest from this line
    for (const auto& [p, q] : points)
        if (length(p - a) > length(along[0])) along[0] = p - a, along[1] = q - b;
    for (const auto& [p, q] : points)
        if (length(cross(along[0], p - a)) > length(cross(along[0], across[0]))) across[0] = p - a, across[1] = q - b;
    for (int k = 0; k < 2 && sides.dim == 1; ++k) across[k] = {-along[k][1], along[k][0], 0};
    sides.R = multiply<3>(transpose<3>(frame_of(along[1], across[1])), frame_of(along[0], across[0]));
    if (equal(sides.R, one)) sides.R = one;
    sides.t = {};
    Vec<3> sum{};
    for (const auto& [p, q] : points) sum = sum + (q - sides.image(p));
    sides.t = 1.0 / static_cast<double>(points.size()) * sum;
    return std::all_of(points.begin(), points.end(), [&](const auto& pair) {
        return length(pair.second - sides.image(pair.first)) <= of_size * length(along[0]);
    });
}

std::vector<char> periodic_boundaries(const Mesh& mesh, std::vector<char> candidates) {
    for (std::vector<char> before; before != candidates;) {
        before = candidates;
        std::vector<char> matched;
        links_of(mesh, before, matched);
        for (int f = 0; f < mesh.face_count(); ++f)
            if (!matched[f]) candidates[mesh.face_boundary[f]] = 0;
    }
    return candidates;
}

PeriodicPairs periodic_pairs(const Mesh& mesh, const std::vector<char>& boundaries, const std::vector<int>& hold,
                             int most) {
    PeriodicPairs found{.dim = mesh.dim};
    std::vector<char> matched;
    std::map<int, std::vector<Pair>> from;  // by the master
    for (const Pair& link : links_of(mesh, boundaries, matched)) {
        from[link.master].push_back(link);
        from[link.slave].push_back({link.master, link.slave, inverse(link.by)});
    }
    std::vector<int> roots;
    for (const auto& [node, links] : from) roots.push_back(node);
    std::stable_sort(roots.begin(), roots.end(), [&](int i, int j) { return hold[i] > hold[j]; });
    std::map<int, PeriodicSides> reached;
    for (const int root : roots) {
        std::vector<Pair> all = {{root, root, {mesh.dim - 1, 0, 0, one, {}}}};
        if (!reached.try_emplace(root, all[0].by).second) continue;
        bool turns = false;  // one comes back to a node turned: it is its own image
        for (std::size_t k = 0; k < all.size(); ++k)
            for (const Pair& link : from[all[k].slave]) {
                const PeriodicSides by = after(all[k].by, link.by);
                const auto [place, is_new] = reached.try_emplace(link.slave, by);
                if (is_new) all.push_back({link.slave, root, by});
                else turns = turns || !equal(place->second.R, by.R);
            }
        if (turns)
            for (const auto& pair : all) found.centres.push_back(pair.slave);
        auto& list = hold[root] >= most ? found.held : found.pairs;
        if (!turns || hold[root] >= most) list.insert(list.end(), all.begin() + 1, all.end());
    }
    found.of_node.assign(mesh.nodes(), -1);
    for (std::size_t k = 0; k < found.pairs.size(); ++k) found.of_node[found.pairs[k].slave] = static_cast<int>(k);
    return found;
}

void PeriodicPairs::keep(std::vector<char>& chosen) const {
    for (const int i : centres) chosen[i] = 0;
    for (const Pair& pair : held) chosen[pair.slave] = chosen[pair.master] = 0;
}

void PeriodicPairs::settle(const std::vector<double>& from, std::vector<double>& x) const {
    for (const auto& [slave, master, by] : pairs) {
        const bool stays = at_node(x, master, dim) == at_node(from, master, dim);
        const Vec<3> to = stays ? at_node(from, slave, dim) : by.image(at_node(x, master, dim));
        std::copy_n(to.begin(), dim, point(x, slave, dim));
    }
}

void PeriodicPairs::spread(std::vector<double>& d) const {
    for (const auto& [slave, master, by] : pairs)
        std::copy_n((by.image(at_node(d, master, dim)) - by.t).begin(), dim, point(d, slave, dim));
}

void PeriodicPairs::fold(std::vector<double>& g) const {
    for (const auto& [slave, master, by] : pairs)
        for (int a = 0; a < dim; ++a) {
            const double of_slave = std::exchange(point(g, slave, dim)[a], 0.0);
            for (int b = 0; b < dim; ++b) point(g, master, dim)[b] += by.R[a][b] * of_slave;
        }
}

// The blocks in the row and in the column of each slave go to those of its master.
void PeriodicPairs::fold(BlockCsr& H) const {
    const auto root = [&](int row) {  // of its node's master, and how that is turned
        const int k = of_node[H.node_of(row)];
        return k < 0 ? std::pair(row, one) : std::pair(H.row_of(pairs[k].master), pairs[k].by.R);
    };
    const auto move = [&](int i, int j, int k) {
        Mat<3> B{};
        for (int ab = 0; ab < dim * dim; ++ab) B[ab / dim][ab % dim] = std::exchange(H.block(k)[ab], 0.0);
        const auto [row, R] = root(i);
        const auto [column, S] = root(j);
        B = multiply<3>(multiply<3>(transpose<3>(R), B), S);
        double* const to = H.block(H.find(row, column));
        for (int ab = 0; ab < dim * dim; ++ab) to[ab] += B[ab / dim][ab % dim];
    };
    for (const Pair& pair : pairs) {
        const int i = H.row_of(pair.slave), diagonal = H.find(i, i);
        double trace = 0;
        for (int a = 0; a < dim; ++a) trace += std::abs(H.block(diagonal)[a * dim + a]);
        for (int k = H.row[i]; k < H.row[i + 1]; ++k) {
            const int j = H.col[k];
            move(i, j, k);
            if (root(j).first == j) move(j, i, H.find(j, i));
        }
        for (int a = 0; a < dim; ++a) H.block(diagonal)[a * dim + a] = trace > 0 ? trace / dim : 1;
    }
}

BlockCsr PeriodicPairs::pattern(const BlockCsr& H) const {
    std::vector<int> cells;
    for (const Pair& pair : pairs)
        for (int k = H.row[pair.slave]; k < H.row[pair.slave + 1]; ++k) {
            const int at = of_node[H.col[k]], other = at < 0 ? H.col[k] : pairs[at].master;
            if (other != pair.master) cells.insert(cells.end(), {pair.master, other});
        }
    return pattern_of_cells(H.n, H.d, cells, 2);
}

double PeriodicPairs::Pair::mismatch(const std::vector<double>& x, int n) const {
    return length(at_node(x, slave, n) - by.image(at_node(x, master, n)));
}

double PeriodicPairs::mismatch(const std::vector<double>& x) const {
    double largest = 0;
    for (const std::vector<Pair>* const list : {&pairs, &held})
        for (const Pair& pair : *list) largest = std::max(largest, pair.mismatch(x, dim));
    return largest;
}

PeriodicPairs PeriodicPairs::in(const Frame& frame) const {
    PeriodicPairs of_run = *this;
    for (std::vector<Pair>* const list : {&of_run.pairs, &of_run.held})
        for (Pair& pair : *list) pair.by.t = frame.to_run(pair.by.image(frame.origin));
    return of_run;
}

}  // namespace almesh
