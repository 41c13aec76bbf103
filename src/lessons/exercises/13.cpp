// Answers to the exercises of lesson 13: change the lines marked ANSWER.
#include "lessons/exercises/13.hpp"

namespace almesh::lessons {

int orientation(const Point& a, const Point& b, const Point& c) {
    const double u = double(b[0] - a[0]), v = double(b[1] - a[1]);
    return u * double(c[1] - a[1]) > v * double(c[0] - a[0]) ? 1 : -1;  // ANSWER 13.1
}

bool have_common_point(const Segment& /*s*/, const Segment& /*t*/) {
    return false;  // ANSWER 13.2
}

std::vector<Edge> boundary_edges(const std::vector<Triangle>& /*triangles*/) {
    return {};  // ANSWER 13.3
}

int cover_number(const std::vector<Segment>& /*boundary*/, const Point& /*y*/) {
    return 1;  // ANSWER 13.4
}

bool proved_injective(const Triangulation& mesh) {
    for (const auto& [i, j, k] : mesh.triangles)
        if (orientation(mesh.x[i], mesh.x[j], mesh.x[k]) <= 0) return false;
    return true;  // ANSWER 13.5: what else?
}

bool proves_positive(const QuadraticTriangle& /*x*/, const std::string& tree) {
    return tree == ".";  // ANSWER 13.6: the tree
}

bool accepts(const CurvedMesh& mesh, const std::string& /*proof*/) {
    return !mesh.elements.empty();  // ANSWER 13.6: the file
}

}  // namespace almesh::lessons
