// A surface and the boundaries of a mesh that go onto it (drawing.hpp), in one frame: closest points both ways, and the
// edges and corners of the surface.
#pragma once
#include <array>
#include <list>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "base/frame.hpp"
#include "constraint/sliding.hpp"
#include "geometry/closest_point.hpp"
#include "geometry/face_patches.hpp"
#include "problem/problem.hpp"

namespace almesh {

// The faces of the chosen boundaries with nodes at x, in patches.
struct PatchedFaces {
    FacePatches patches;
    std::vector<int> number;     // of each patch among those of the mesh
    std::vector<Patch> patch;
    std::vector<Vec<3>> normal;  // of each patch, as long as its area, in 3D twice as long
    ClosestPoint points;

    PatchedFaces(const Mesh& mesh, const std::vector<double>& x, const std::vector<char>& chosen)
        : patches(mesh), points(patches.basis, find(x, chosen)) {}

    int face(std::size_t k) const { return patches.face[number[k]]; }  // of patch k
    Vec<3> centre(std::size_t k) const;
    std::vector<Vec<3>> normals_at_nodes() const;  // per node of the mesh: the sum of those of its patches

    // The closest point among those where the angle of the normal from n has a larger cosine; patch -1: there is none.
    ClosestPoint::Place facing(const Vec<3>& x, const Vec<3>& n, double cosine = 0) const {
        return points.find(x, [&](int k) { return dot(normal[k], n) > cosine * length(normal[k]) * length(n); });
    }

private:
    const std::vector<Patch>& find(const std::vector<double>& x, const std::vector<char>& chosen);
};

class SurfacePairing {
public:
    struct Sample {
        Vec<3> x, normal;  // as long as its share of the area
    };

    std::string file;             // of the surface
    std::vector<char> own;        // per boundary of the mesh: whether it goes there
    Mesh surface;
    PatchedFaces faces;           // of the surface
    std::vector<Sample> samples;  // its nodes, at most a few for each face of the mesh

    SurfacePairing(const Mesh& mesh, std::string file, std::vector<char> own, const OtherSurface& other,
                   const Frame& frame, double feature_angle);
    SurfacePairing(const SurfacePairing&) = delete;  // the faces are those of its surface

    // Per node of the mesh on an edge of these boundaries, where smooth parts meet: the smooth parts of the surface at
    // the faces there, each that of most of the smooth part of the face, if there is one. Empty for others. side: -1
    // where the surface is turned inward.
    std::vector<std::set<int>> parts_at_edges(const PatchedFaces& boundary, double side) const;

    // The closest point to x of the edge or corner where these parts of the surface meet: how far it is, and the
    // projector onto the directions that leave it. Both stay where there is none.
    void take_feature(const std::set<int>& parts, const Vec<3>& x, Vec<3>& move, Mat<3>& across) const;

    // Throws InputError where boundary, with the mesh at x, and surface are of other sizes, or far from each other.
    void check_place(const Mesh& mesh, const std::vector<double>& x) const;

    // How far boundary and surface are from each other, both ways, as a line.
    std::string distances(const PatchedFaces& boundary) const;

private:
    using Segment = std::array<Vec<3>, 2>;  // of a corner, and in 2D: twice the same point

    Frame frame_;
    std::vector<int> smooth_, part_;  // smooth parts of the faces of the mesh, and of the surface
    std::map<std::set<int>, std::vector<Segment>> features_;  // where these parts of the surface meet

    void find_features();
};

// One for each surface onto which boundaries go. mesh: of the problem, in the file's frame; frame: of the pairings.
std::list<SurfacePairing> surface_pairings(const ProblemOptions& options, const Problem& problem, const Mesh& mesh,
                                           const Frame& frame);

}  // namespace almesh
