#include "report/mesh_velocity.hpp"

#include <cmath>

#include "problem/frame_solver.hpp"
#include "base/files.hpp"
#include "base/text.hpp"

namespace almesh {
namespace {

std::vector<double> velocity(const std::vector<Moment>& moments, int order, double length) {
    const std::size_t last = moments.size() - 1;
    const auto slope = [&](std::size_t k, std::size_t i) {
        return length * (moments[k].x[i] - moments[k - 1].x[i]) / (moments[k].t - moments[k - 1].t);
    };
    std::vector<double> v(moments[last].x.size(), 0.0);
    for (std::size_t i = 0; i < v.size() && last > 0; ++i) v[i] = slope(last, i);
    if (order == 1 || last < 2) return v;
    const double share = (moments[last].t - moments[last - 1].t) / (moments[last].t - moments[last - 2].t);
    for (std::size_t i = 0; i < v.size(); ++i) v[i] += share * (v[i] - slope(last - 1, i));
    return v;
}

void write_swept(const Problem& problem, const std::vector<Moment>& moments, const std::vector<MeshFace>& faces,
                 const std::string& path) {
    const Mesh& mesh = problem.mesh();
    const SideNodes local(mesh.dim, mesh.degree);
    const std::vector<double> volume = swept_volumes(mesh, faces, moments[moments.size() - 2].x, moments.back().x);
    const double unit = std::pow(problem.frame.length, mesh.dim);
    const std::size_t most = mesh.dim == 2 ? 2 : 4;
    write_file(path, [&](const TextSink& sink) {
        sink(most == 2 ? "element,neighbour,volume,node_1,node_2\n"
                       : "element,neighbour,volume,node_1,node_2,node_3,node_4\n");
        append_rows(sink, static_cast<int>(faces.size()), [&](std::string& row, int f) {
            const MeshFace& face = faces[f];
            append(row, mesh.file.element_id[face.element]);
            append(row += ',', face.neighbour < 0 ? -1 : mesh.file.element_id[face.neighbour]);
            append(row += ',', unit * volume[f]);
            const std::vector<int> node = nodes_of(mesh, local, face);
            const std::size_t corners = mesh.cell(face.element).face_type(face.side).vertices;
            for (std::size_t k = 0; k < most; ++k)
                append(row += ',', k < corners ? mesh.file.node_id[node[k]] : -1);
            row += '\n';
        });
    });
}

}  // namespace

std::vector<VtkArray> velocities(const Deck& deck, const Problem& problem, const std::vector<Moment>& moments) {
    if (deck.velocity == Velocity::no) return {};
    const int dim = problem.mesh().dim;
    const double length = problem.frame.length;
    std::vector<double> moved = final_positions(problem, moments.back().x);
    for (std::size_t i = 0; i < moved.size(); ++i) moved[i] -= problem.file_x[i];
    return {{"displacement", dim, std::move(moved)},
            {"velocity_1", dim, velocity(moments, 1, length)},
            {"velocity_2", dim, velocity(moments, 2, length)}};
}

void write_velocities(const Deck& deck, const Problem& problem, const std::vector<Moment>& moments,
                      const std::vector<VtkArray>& columns, const std::string& base, std::vector<MeshFace>& faces) {
    if (columns.empty()) return;
    const Mesh& mesh = problem.mesh();
    write_file(base + "-velocity.csv", [&](const TextSink& sink) {
        std::string heading = "node";
        for (const VtkArray& column : columns)
            for (int a = 0; a < mesh.dim; ++a) heading += concat(",", column.name, "_", std::string(1, "xyz"[a]));
        sink(heading + "\n");
        append_rows(sink, mesh.nodes(), [&](std::string& row, int i) {
            append(row, mesh.file.node_id[i]);
            for (const VtkArray& column : columns)
                for (int a = 0; a < mesh.dim; ++a) append(row += ',', column.value[offset(i, mesh.dim, a)]);
            row += '\n';
        });
    });
    if (deck.velocity != Velocity::faces || moments.size() < 2) return;
    if (faces.empty()) faces = mesh_faces(mesh);
    write_swept(problem, moments, faces, base + "-swept.csv");
}

}  // namespace almesh
