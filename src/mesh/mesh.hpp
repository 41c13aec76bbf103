// A mesh of degree p with its boundary: triangles, quadrilaterals; in 3D tetrahedra, hexahedra, prisms, pyramids.
//
// The mesh as read may be curved. The ideal mesh of the method is straight-sided: the same vertices, all other nodes
// at their affine positions (straight_sided()). Plain data: build_mesh() makes and checks it, raise_degree() and
// refine() make others of it, and prolong() carries fields over to those.
#pragma once
#include <array>
#include <span>
#include <string>
#include <vector>

#include "base/index.hpp"
#include "base/small_matrix.hpp"
#include "mesh/cells.hpp"
#include "mesh/file_tags.hpp"

namespace almesh {

// Elements of one type, or faces: consecutive ones, with their nodes from elements[start] or faces[start] on.
struct ElementGroup {
    const CellType* cell;
    int first, count;
    std::size_t start;
};

struct Mesh {
    int dim = 2;     // n, 2 or 3
    int degree = 1;  // p
    std::vector<double> x;             // node_count x dim positions, as read
    std::vector<int> elements;         // element_count x element_nodes(e) node indices, Gmsh order, det J > 0
    std::vector<ElementGroup> groups;  // of all elements, in their order; empty where all are simplices
    std::vector<int> faces;            // face_count x face_nodes(f): all boundary faces, Gmsh order, oriented outward
    std::vector<ElementGroup> groups_of_faces;  // of all faces, in their order; empty where all are simplices
    std::vector<int> face_element;     // element each face belongs to
    std::vector<int> face_boundary;    // index into boundaries
    std::vector<std::string> boundaries;  // physical names (or "tag 7" where the file names none), "inlet + hot" of two
    std::vector<std::vector<std::string>> boundary_groups;  // per boundary: each of these names
    std::vector<char> inner;  // per boundary: whether elements are on both sides (inner_boundary.hpp); empty: none
    std::vector<int> contact;  // per boundary: != 0: may overlap others of that number, if < 0 itself; empty: none may
    double rounding = 0;       // of x, beside that of its own digits: of coordinates far from the origin of the file
    std::vector<std::array<int, 2>> folded;  // neighbours on the same side of their common face: only of Folds::keep
    std::array<KeptCells, 5> kept{};  // simplices by dimension, up to that of the mesh, and in 3D quadrilaterals
    FileTags file;

    // In mesh.cpp, so that no other unit compiles what all of these take.
    Mesh();
    Mesh(const Mesh& other);
    Mesh(Mesh&& other) noexcept;
    Mesh& operator=(const Mesh& other);
    Mesh& operator=(Mesh&& other) noexcept;
    ~Mesh();

    bool is_simplicial() const { return groups.empty(); }
    const CellType& cell(int e) const { return groups.empty() ? simplex(dim) : *group_of(e).cell; }
    int nodes() const { return static_cast<int>(x.size()) / dim; }
    int element_nodes(int e = 0) const { return cell(e).node_count(degree); }
    int element_count() const {
        if (!groups.empty()) return groups.back().first + groups.back().count;
        return static_cast<int>(elements.size()) / simplex_node_count(dim, degree);
    }
    const int* element(int e) const {
        if (groups.empty()) return elements.data() + offset(e, simplex_node_count(dim, degree));
        const ElementGroup& group = group_of(e);
        return elements.data() + group.start + offset(e - group.first, group.cell->node_count(degree));
    }
    const ElementGroup& group_of(int e) const { return group_of(groups, e); }  // where there are any
    int group_number(int e) const { return groups.empty() ? 0 : static_cast<int>(&group_of(e) - groups.data()); }
    // All of them, also where they are simplices.
    std::vector<ElementGroup> element_groups() const {
        return groups.empty() ? std::vector{ElementGroup{&simplex(dim), 0, element_count(), 0}} : groups;
    }
    // The elements' common type where there is one; of several types, of the first elements.
    const CellType& cell() const { return cell(0); }
    std::string elements_text() const;  // "18042 triangles, 4800 quadrilaterals"
    int most_sides() const;  // of an element

    // The same of faces.
    const CellType& face_cell(int f) const {
        return groups_of_faces.empty() ? simplex(dim - 1) : *group_of(groups_of_faces, f).cell;
    }
    int face_nodes(int f) const { return face_cell(f).node_count(degree); }
    int face_count() const {
        if (!groups_of_faces.empty()) return groups_of_faces.back().first + groups_of_faces.back().count;
        return static_cast<int>(faces.size()) / simplex_node_count(dim - 1, degree);
    }
    std::size_t face_start(int f) const {  // of its nodes, in `faces`
        if (groups_of_faces.empty()) return offset(f, simplex_node_count(dim - 1, degree));
        const ElementGroup& group = group_of(groups_of_faces, f);
        return group.start + offset(f - group.first, group.cell->node_count(degree));
    }
    const int* face(int f) const { return faces.data() + face_start(f); }
    std::span<const int> face_vertices(int f) const {
        return {face(f), static_cast<std::size_t>(face_cell(f).vertices)};
    }
    int face_group_number(int f) const {
        return groups_of_faces.empty() ? 0
                                       : static_cast<int>(&group_of(groups_of_faces, f) - groups_of_faces.data());
    }
    std::vector<ElementGroup> face_groups() const {
        return groups_of_faces.empty() ? std::vector{ElementGroup{&simplex(dim - 1), 0, face_count(), 0}}
                                       : groups_of_faces;
    }
    const CellType& cell_of(const KeptCells& some) const { return cell_types()[&some - kept.data()]; }
    bool is_inner(int f) const { return !inner.empty() && inner[face_boundary[f]]; }
    int boundary_index(const std::string& name) const;  // -1 where there is none
    std::vector<char> boundaries_in(const std::string& group) const;  // per boundary: whether it is part of it

private:
    static const ElementGroup& group_of(const std::vector<ElementGroup>& of, int cell) {
        const ElementGroup* group = of.data();
        while (cell >= group->first + group->count) ++group;
        return *group;
    }
};

// Of elements of these types, in this order, those of one type together; empty where all are simplices. Degree p.
std::vector<ElementGroup> groups_of(const std::vector<const CellType*>& types, int degree);

// Calls body(f, k) for all nodes faces[k] of all faces f, k ascending.
template <class Body>
void for_face_nodes(const Mesh& mesh, const Body& body) {
    std::size_t k = 0;
    for (const ElementGroup& group : mesh.face_groups())
        for (int f = group.first; f < group.first + group.count; ++f)
            for (int i = 0; i < group.cell->node_count(mesh.degree); ++i, ++k) body(f, k);
}

// Where the faces have been appended in this order, with all that there is of each: brings those of one type together,
// of each type first those that the file has, in this order.
void group_faces(Mesh& mesh, const std::vector<const CellType*>& types);

std::string face_name(const Mesh& mesh, int f);  // "face 12 of wall", "a face of wall" where the file does not have it

// Appends a boundary with these groups; returns its index.
int add_boundary(Mesh& mesh, const std::vector<std::string>& groups);

// Node positions (node_count x dim) of the ideal mesh: vertices as in x, the others affine.
std::vector<double> straight_sided(const Mesh& mesh);

// Mean of the positions x (node_count x dim) of `count` nodes; in 2D the third coordinate is 0.
std::array<double, 3> centroid(const Mesh& mesh, const std::vector<double>& x, const int* nodes, int count);

std::array<double, 3> element_centre(const Mesh& mesh, const std::vector<double>& x, int e);  // of its vertices

// Jacobian A = dy / dxi of the affine map of a straight-sided simplex: column k is the edge from vertex 0 to vertex
// k + 1. vertex: n + 1 nodes, the first of an element of any degree. y: nodes x n.
template <int n>
Mat<n> straight_jacobian(const int* vertex, const std::vector<double>& y) {
    const double* const y0 = point(y, vertex[0], n);
    Mat<n> A;
    for (int a = 0; a < n; ++a)
        for (int k = 0; k < n; ++k) A[a][k] = y[offset(vertex[k + 1], n, a)] - y0[a];
    return A;
}

// Volume of the straight-sided mesh with the vertex positions y (node_count x dim), and of element e of it.
double volume(const Mesh& mesh, const std::vector<double>& y);
double volume(const Mesh& mesh, const std::vector<double>& y, int e);

// The linear mesh on the vertices, straight-sided.
Mesh linear_part(const Mesh& mesh);

// Raises the degree of the elements to `degree` >= mesh.degree. New nodes lie where the element's own map puts
// them, so a curved mesh keeps its shape. Vertices keep their ids, other nodes get ids after the largest one.
Mesh raise_degree(const Mesh& mesh, int degree);

// The same with any degree from 1 on: with a lower one a curved mesh changes its shape between the nodes.
Mesh interpolated(const Mesh& mesh, int degree);

// Splits every element uniformly `times` times into the children of its type (of a tetrahedron the inner octahedron is
// cut along its shortest diagonal; of a pyramid 6 are pyramids, 4 tetrahedra). Works on the straight-sided linear mesh;
// throws InputError for a mesh that is curved, and where the result is beyond the range of int. A mesh of degree p is
// refined as a linear one and raised to p again. Vertices keep their ids, elements and faces are numbered anew: of each
// type those that an element is split into lie together, in the order of the elements.
Mesh refine(const Mesh& mesh, int times);

// Prolongation of a field (coarse.nodes() x dim) to a mesh that comes from `coarse` by refine() or raise_degree(),
// or whose linear_part() `coarse` is:
// finite element interpolation. Each fine node lies in a coarse element, at a point xi of its reference simplex whose
// coordinates are multiples of 1 / (c p), where each edge of the coarse element was cut into c parts and p is the fine
// degree, and
//
//     u_fine = sum over the nodes j of that element of  N_j(xi) u_j.
//
// u is continuous, so any element that has the node gives the same value, and on the boundary only the values on the
// boundary count. The map phi = y + u of straight-sided elements keeps its D phi, so a valid map stays valid and keeps
// its distortion energy. Ideal positions: nodes x dim each. Returns fine.nodes() x dim. Cost: O(nodes * p^n).
std::vector<double> prolong(const Mesh& coarse, const std::vector<double>& coarse_ideal, const Mesh& fine,
                            const std::vector<double>& fine_ideal, const std::vector<double>& field);

}  // namespace almesh
