#include "problem/improvement_guard.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "base/table.hpp"
#include "check/certificate.hpp"
#include "check/scaled_jacobian.hpp"
#include "constraint/sliding_nodes.hpp"
#include "geometry/face_patches.hpp"
#include "geometry/patch.hpp"
#include "problem/corner_smoothing.hpp"
#include "problem/kept_surface.hpp"

namespace almesh {
namespace {

constexpr double usual_change = 0.2;  // of sizes that are meant
constexpr double flat_simplex = 0.2;  // part of the size of a regular one with its longest edge
constexpr double as_bad = 0.02;  // more than the least
constexpr int attempts = 20;

double area(const Mesh& mesh, const std::vector<double>& x, int f) {
    const int vertices = mesh.face_cell(f).vertices;
    const double twice = length(flat_normal(positions(mesh, x, mesh.face(f), vertices), mesh.dim - 1, vertices));
    return mesh.dim == 2 ? twice : 0.5 * twice;
}

// As a factor, of the largest change either way.
double largest_factor(const std::vector<double>& before, const std::vector<double>& after) {
    double largest = 1;
    for (std::size_t k = 0; k < before.size(); ++k)
        if (before[k] > 0 && after[k] > 0)
            largest = std::max({largest, before[k] / after[k], after[k] / before[k]});
    return largest;
}

std::string factor_text(double factor) {
    return factor < 1.995 ? to_text(std::round(100 * (factor - 1)), 3) + " %" : "a factor of " + to_text(factor, 2);
}

}  // namespace

ImprovementGuard::ImprovementGuard(const ProblemOptions& options, const Problem& problem, const std::vector<double>& x)
    : options_(options), problem_(problem), mesh_(problem.mesh()), size_(element_sizes(mesh_, x)), height_(heights(x)),
      least_(std::numeric_limits<double>::infinity()) {
    const std::vector<double> values = guarded(x, certify(mesh_, x).certified_bound);
    for (int e = 0; e < mesh_.element_count(); ++e)
        if (problem_.is_feasible(e)) least_ = std::min(least_, values[e]);
    if (x != mesh_.x) most_off_ = std::max(most_off_, surface_distance(problem, x));
    find_layers();
    for (int e = 0; e < mesh_.element_count(); ++e) {
        double longest = 0;
        for (const auto& [i, j] : mesh_.cell(e).edges)
            longest = std::max(longest, length(at_node(x, mesh_.element(e)[i], mesh_.dim) -
                                               at_node(x, mesh_.element(e)[j], mesh_.dim)));
        is_flat_.push_back(mesh_.cell(e).is_simplex() && size_[e] < flat_simplex * std::pow(longest, mesh_.dim));
    }
    const bool has_layers = std::find(has_layers_.begin(), has_layers_.end(), 1) != has_layers_.end();
    size_change_ = options.size_change.value_or(has_layers ? usual_change : 0);
    if (size_change_ == 0) has_layers_.assign(has_layers_.size(), 0);
}

std::vector<double> ImprovementGuard::guarded(const std::vector<double>& x, const std::vector<double>& bound) const {
    const bool corners = options_.guard == Guard::scaled_jacobian ||
                         (options_.guard == Guard::automatic && mesh_.degree == 1);
    return corners ? corner_jacobians(mesh_, x) : bound;
}

std::vector<double> ImprovementGuard::heights(const std::vector<double>& x) const {
    std::vector<double> result;
    for (int f = 0; f < mesh_.face_count(); ++f)
        result.push_back(volume(mesh_, x, mesh_.face_element[f]) / area(mesh_, x, f));
    return result;
}

void ImprovementGuard::find_layers() {
    constexpr int fewest_faces = 3;
    const std::vector<double> height = heights(mesh_.x), bound = certify(mesh_, mesh_.x).certified_bound;
    std::vector<double> flatness;
    for (int f = 0; f < mesh_.face_count(); ++f) {
        const double of_face = std::pow(area(mesh_, mesh_.x, f), 1.0 / (mesh_.dim - 1));
        flatness.push_back(bound[mesh_.face_element[f]] > 0 && !mesh_.is_inner(f) ? height[f] / of_face : 1);
    }
    has_layers_.assign(mesh_.face_count(), 0);
    for (const std::vector<int>& part : {mesh_.face_boundary, smooth_parts(mesh_, options_.feature_angle)}) {
        std::map<int, std::vector<double>> of_part;
        for (int f = 0; f < mesh_.face_count(); ++f) of_part[part[f]].push_back(flatness[f]);
        for (auto& [number, values] : of_part) {
            const auto middle = values.begin() + std::ssize(values) / 2;
            std::nth_element(values.begin(), middle, values.end());
            for (int f = 0; f < mesh_.face_count() && *middle < flat_cells && std::ssize(values) >= fewest_faces; ++f)
                if (part[f] == number) has_layers_[f] = 1;
        }
    }
}

std::vector<char> ImprovementGuard::on_layers() const {
    std::vector<char> on =
        nodes_with(mesh_, [&](int f, std::size_t) { return size_change_ > 0 && has_layers_[f]; });
    for (bool grows = size_change_ > 0; grows;) {
        grows = false;
        for (int e = 0; e < mesh_.element_count(); ++e) {
            const int *const nodes = mesh_.element(e), *const end = nodes + mesh_.element_nodes(e);
            const auto is_on = [&](int i) { return on[i] != 0; };
            if (!is_flat_[e] || std::none_of(nodes, end, is_on) || std::all_of(nodes, end, is_on)) continue;
            std::for_each(nodes, end, [&](int i) { on[i] = 1; });
            grows = true;
        }
    }
    return on;
}

bool ImprovementGuard::take(const std::vector<double>& from, std::vector<double>& to,
                            std::optional<double>* distance) const {
    const double most = std::log1p(size_change_) * (1 + 1e-9);
    for (int attempt = 0; attempt < attempts && to != from; ++attempt) {
        const std::vector<double> bound = certify(mesh_, to).certified_bound, value = guarded(to, bound),
                                  size = element_sizes(mesh_, to);
        std::vector<double> off;
        if (distance) off = distances_from_surface(problem_, to);
        std::vector<char> back(mesh_.nodes(), 0);
        const auto put_back = [&](const int* nodes, int count) {
            for (int k = 0; k < count; ++k) back[nodes[k]] = 1;
        };
        for (int e = 0; e < mesh_.element_count(); ++e) {
            const bool is_resized = size_change_ > 0 && !(std::abs(std::log(size[e] / size_[e])) <= most);
            if (problem_.is_feasible(e) && (bound[e] <= 0 || value[e] < least_ || is_resized))
                put_back(mesh_.element(e), mesh_.element_nodes(e));
        }
        for (std::size_t k = 0; k < off.size(); ++k)
            if (const int f = static_cast<int>(k); off[k] > most_off_)
                put_back(mesh_.face(f), mesh_.face_nodes(f));
        if (std::find(back.begin(), back.end(), 1) == back.end()) {
            if (distance) *distance = off.empty() ? 0 : *std::max_element(off.begin(), off.end());
            return true;
        }
        for (int i = 0; i < mesh_.nodes(); ++i)
            if (back[i]) std::copy_n(point(from, i, mesh_.dim), mesh_.dim, point(to, i, mesh_.dim));
        problem_.level->pairs.settle(from, to);
    }
    return false;
}

std::string ImprovementGuard::sizes_text(const std::vector<double>& x) const {
    std::set<std::string> names;
    for (int f = 0; f < mesh_.face_count(); ++f)
        if (has_layers_[f]) names.insert(mesh_.boundaries[mesh_.face_boundary[f]]);
    std::string layers;
    for (const std::string& name : names) layers += (layers.empty() ? "" : ", ") + name;
    const std::string why = options_.size_change ? "size_change" : layers.empty() ? "no layers of flat cells"
                                                                                  : "layers of flat cells at " + layers;
    return concat("sizes changed by up to ", factor_text(largest_factor(size_, element_sizes(mesh_, x))),
                  ", heights of cells at the boundary by ", factor_text(largest_factor(height_, heights(x))), " (",
                  size_change_ > 0 ? "kept within " + factor_text(1 + size_change_) : "free", ": ", why, ")");
}

std::string ImprovementGuard::least_text(const std::vector<double>& from, const std::vector<double>& x,
                                         const std::vector<char>& moves, int steps) const {
    const std::vector<double> before = corner_jacobians(mesh_, from), s = corner_jacobians(mesh_, x);
    const auto moving_nodes = [&](int e) {
        const int* const nodes = mesh_.element(e);
        return static_cast<int>(std::count_if(nodes, nodes + mesh_.cell(e).vertices, [&](int i) { return moves[i]; }));
    };
    double least_before = std::numeric_limits<double>::infinity();
    int least = -1, held = -1;
    for (int e = 0; e < mesh_.element_count(); ++e) {
        if (!problem_.is_feasible(e)) continue;
        int& of_kind = moving_nodes(e) > 0 ? least : held;
        if (of_kind < 0 || s[e] < s[of_kind]) of_kind = e;
        if (moving_nodes(e) > 0) least_before = std::min(least_before, before[e]);
    }
    const auto element = [&](int e) {
        const Vec<3> centre = problem_.frame.to_file(element_centre(mesh_, x, e));
        return concat("element ", mesh_.file.element_id[e], " at ", position_text(centre.data(), mesh_.dim));
    };
    std::string text;
    if (least >= 0) {
        const std::string was = rounded_down(least_before, 4), is = rounded_down(s[least], 4);
        const int count = mesh_.cell(least).vertices - moving_nodes(least), others = beside(least, s, moves);
        text = concat("least scaled Jacobian ", was == is ? "not raised from " : "raised from ", was,
                      was == is ? "" : " to " + is, " in ", counted(steps, "step"), "; ", element(least), " has it");
        if (count > 0)
            text += concat(", ", count, " of its nodes ", count == 1 ? "is" : "are", " held", places_of(least, moves));
        if (others > 0)
            text += concat(", ", counted(others, "element"), " at its nodes ", others == 1 ? "is" : "are", " within ",
                           as_bad, " of it");
    }
    if (held >= 0 && (least < 0 || s[held] < s[least]))
        text += concat(text.empty() ? "" : "; ", rounded_down(s[held], 4), " in ", element(held),
                       ", all of whose nodes are held", places_of(held, moves));
    return text;
}

// " at wall, inlet": of the nodes of the element that do not move.
std::string ImprovementGuard::places_of(int e, const std::vector<char>& moves) const {
    const int *const nodes = mesh_.element(e), *const end = nodes + mesh_.cell(e).vertices;
    std::set<std::string> names;
    for_face_nodes(mesh_, [&](int f, std::size_t k) {
        if (!moves[mesh_.faces[k]] && std::find(nodes, end, mesh_.faces[k]) != end)
            names.insert(mesh_.boundaries[mesh_.face_boundary[f]]);
    });
    std::string text;
    for (const std::string& name : names) text += (text.empty() ? " at " : ", ") + name;
    return text;
}

// Elements that are as bad but for a little, at nodes of this one that move.
int ImprovementGuard::beside(int e, const std::vector<double>& s, const std::vector<char>& moves) const {
    std::vector<char> near(mesh_.nodes(), 0);
    for (int k = 0; k < mesh_.cell(e).vertices; ++k) near[mesh_.element(e)[k]] = moves[mesh_.element(e)[k]];
    int count = 0;
    for (int other = 0; other < mesh_.element_count(); ++other) {
        const int* const nodes = mesh_.element(other);
        count += other != e && s[other] < s[e] + as_bad &&
                 std::any_of(nodes, nodes + mesh_.cell(other).vertices, [&](int i) { return near[i]; });
    }
    return count;
}

}  // namespace almesh
