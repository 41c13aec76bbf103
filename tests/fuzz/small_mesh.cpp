#include "fuzz/small_mesh.hpp"

#include "fuzz/harness.hpp"
#include "io/su2.hpp"
#include "support/meshes.hpp"
#include "support/msh_formats.hpp"

namespace almesh::fuzz {
namespace {

Mesh straight_mesh(int kind) {
    switch (kind) {
        case 0: return test::ring_mesh(3, 2, 3);
        case 1: return test::square_mesh(1);
        case 2: return test::two_parts(test::square_mesh(1), 1, {1.5, 0, 0});
        case 3: return test::ring_mesh(4, 1, 1.25);
        case 4: return test::cube_mesh(1);
        default: return test::square_mesh(2);
    }
}

// Once more, as large or smaller, beside, over, inside or in contact with itself.
Mesh doubled(const Mesh& mesh, Choices& choose) {
    constexpr double scales[] = {1, 0.5, 0.125}, shifts[] = {0, 0.5, 1, 0.25, 0.875, 3};
    const double scale = choose.of(scales), dx = choose.of(shifts), dy = choose.of(shifts), dz = choose.of(shifts);
    return test::two_parts(mesh, scale, {dx, dy, dz});
}

void move_nodes(Mesh& mesh, Choices& choose) {
    for (int moves = choose.below(4); moves > 0; --moves) {
        double* const x = &mesh.x[offset(choose.below(mesh.nodes()), mesh.dim)];
        for (int a = 0; a < mesh.dim; ++a) x[a] += 0.5 * choose.fraction();
    }
}

// The line after the place, removed or repeated.
void change_line(std::string& text, int place, bool repeat) {
    const auto from = text.find('\n', place);
    if (from == text.npos) return;
    const std::string line = text.substr(from, text.find('\n', from + 1) - from);
    if (repeat) text.insert(from, line);
    else text.erase(from, line.size());
}

}  // namespace

Mesh small_mesh(Choices& choose) {
    const int kind = choose.byte();
    Mesh mesh = straight_mesh(kind % 6);
    if (kind >= 224) mesh = doubled(mesh, choose);
    const int degree = 1 + choose.below(3);
    if (degree > 1) mesh = raise_degree(mesh, degree);
    const int amplitude = choose.below(4);
    if (amplitude > 0) mesh.x = test::wavy(mesh.x, mesh.dim, 0.03 * amplitude);
    move_nodes(mesh, choose);
    constexpr double sizes[] = {1, 1e-3, 1e4, 1e-12, 1e12}, origins[] = {0, 1, -3, 1e3, 1e6};
    const double size = choose.of(sizes), origin = size * choose.of(origins);
    for (double& x : mesh.x) x = size * x + origin;
    constexpr FileFormat formats[] = {{".msh", 22, false}, {".msh", 41, false},
                                      {".msh", 40, false}, {".msh", 22, true},
                                      {".msh", 40, true},  {".msh", 41, true},
                                      {".su2", 0, false}};
    mesh.file.format = choose.of(formats);
    if (mesh.degree > 1 && mesh.file.format.ending == ".su2") mesh.file.format = formats[0];
    return mesh;
}

std::string text_of_mesh(const Mesh& mesh) {
    const auto& [ending, version, binary] = mesh.file.format;
    if (ending == ".msh") return test::msh_text(mesh, mesh.x, {ending, version < 40 ? 22 : 41, binary});
    const std::string path = work_folder().path("undamaged.su2");
    write_su2(path, mesh, mesh.x);
    return test::text_of(path);
}

std::string damaged(std::string text, Choices& choose) {
    for (int faults = choose.below(4); faults > 0 && !text.empty(); --faults) {
        const int kind = choose.below(4), place = choose.below(static_cast<int>(text.size()));
        switch (kind) {
            case 0: text[place] = static_cast<char>(choose.byte()); break;
            case 1: text[place] = static_cast<char>('0' + choose.below(10)); break;
            case 2: change_line(text, place, choose.yes()); break;
            default: text.resize(place);
        }
    }
    return text;
}

}  // namespace almesh::fuzz
