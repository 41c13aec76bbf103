// What must not be lost where a valid mesh is made better: validity, the least of the measure that is guarded, the
// surface of the file and, where they are meant, the sizes of elements.
//
// Sizes are meant where a boundary, or a smooth part of one, has layers of flat cells in the file: in the middle
// (median) over its faces, the cell behind is valid, and its volume over the area of the face is below flat_cells of the
// face's own size. Nodes of such a boundary stay, and of layers of triangles and tetrahedra.
#pragma once
#include <string>
#include <vector>

#include "problem/problem.hpp"

namespace almesh {

constexpr double flat_cells = 0.15;  // 1 / 7 of a cube; a regular tetrahedron has 0.41

class ImprovementGuard {
public:
    // x: node_count x dim, of the problem's mesh; what is valid there stays so.
    ImprovementGuard(const ProblemOptions& options, const Problem& problem, const std::vector<double>& x);

    // The nodes of elements and faces that fail go back from `to` to where `from` has them, until none fails. Whether
    // anything is left; then all that is guarded is kept. The surface takes as long to measure as a hundred steps.
    // distance: of what is left; null: not measured.
    bool take(const std::vector<double>& from, std::vector<double>& to, std::optional<double>* distance) const;
    // Per node: whether it is on a face with layers, or of flat triangles or tetrahedra on these, which are as they
    // are meant to be although their scaled Jacobian is small.
    std::vector<char> on_layers() const;
    double size_change() const { return size_change_; }  // 0: sizes are free

    // For users: how far sizes have changed at x, whether they were free to, and why; how the least scaled Jacobian was
    // raised from that at x, which element has it now, and what keeps it from being better. moves: per node.
    std::string sizes_text(const std::vector<double>& x) const;
    std::string least_text(const std::vector<double>& from, const std::vector<double>& x, const std::vector<char>& moves,
                           int steps) const;

private:
    const ProblemOptions& options_;
    const Problem& problem_;
    const Mesh& mesh_;
    std::vector<double> size_, height_;  // of elements, and of those at faces
    std::vector<char> has_layers_;       // per face
    std::vector<char> is_flat_;          // per element: a flat triangle or tetrahedron
    double size_change_ = 0, most_off_ = options_.surface_tolerance, least_;

    std::string places_of(int e, const std::vector<char>& moves) const;
    int beside(int e, const std::vector<double>& s, const std::vector<char>& moves) const;
    std::vector<double> guarded(const std::vector<double>& x, const std::vector<double>& bound) const;
    std::vector<double> heights(const std::vector<double>& x) const;
    std::vector<double> face_sizes() const;
    void find_layers();
};

}  // namespace almesh
