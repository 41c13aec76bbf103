#include "app/node_targets.hpp"

#include <algorithm>
#include <unordered_map>

#include "base/error.hpp"
#include "base/files.hpp"
#include "base/index.hpp"
#include "io/mesh_format.hpp"
#include "io/text_scanner.hpp"

namespace almesh {
namespace {

// id -> node, of the boundary.
std::unordered_map<long long, int> nodes_by_id(const Mesh& mesh, int boundary) {
    std::unordered_map<long long, int> nodes;
    for (int f = 0; f < mesh.face_count(); ++f)
        for (int i = 0; i < mesh.face_nodes() && mesh.face_boundary[f] == boundary; ++i)
            nodes[mesh.file.node_id[mesh.face(f)[i]]] = mesh.face(f)[i];
    return nodes;
}

void refuse_missing(const Mesh& mesh, int boundary, const std::string& path, const std::vector<char>& known,
                    const std::unordered_map<long long, int>& nodes) {
    std::vector<long long> missing;
    for (const auto& [id, node] : nodes)
        if (!known[node]) missing.push_back(id);
    if (missing.empty()) return;
    std::sort(missing.begin(), missing.end());
    throw InputError(path, ": ", counted(missing.size(), "node"), " of boundary ", mesh.boundaries[boundary],
                     " missing, the first with id ", missing.front());
}

// Commas separate like blanks; `#` starts a comment; a first line of words is a heading.
std::string without_commas(std::string text) {
    bool comment = false;
    for (char& c : text) {
        comment = c == '#' || (comment && c != '\n');
        if (c == ',' || c == ';' || comment) c = ' ';
    }
    return text;
}

void read_places(const Mesh& mesh, int boundary, const MotionStep& step, std::vector<double>& positions) {
    const auto nodes = nodes_by_id(mesh, boundary);
    const std::string text = without_commas(read_text_file(step.file));
    TextScanner in(text, step.file);
    std::vector<int> line(mesh.nodes(), 0);
    std::vector<char> known(mesh.nodes(), 0);
    if (in.next_line() && std::isalpha(static_cast<unsigned char>(*in.at))) in.rest_of_line();
    while (in.next_line()) {
        const long long id = in.integer("a node id", std::numeric_limits<long long>::min(),
                                        std::numeric_limits<long long>::max());
        const auto found = nodes.find(id);
        if (found == nodes.end()) in.fail("node ", id, " is not on boundary ", mesh.boundaries[boundary]);
        const int node = found->second;
        if (known[node]) in.fail("node ", id, " is here already, in line ", line[node]);
        known[node] = 1;
        line[node] = in.line;
        for (int a = 0; a < mesh.dim; ++a) {
            const double value = in.real("a coordinate");
            double& x = positions[offset(node, mesh.dim, a)];
            x = step.displacement ? mesh.x[offset(node, mesh.dim, a)] + value : value;
        }
        if (mesh.dim == 2 && in.at != in.end && *in.at != '\n') {
            const std::string rest(in.rest_of_line());
            if (!rest.empty() && parse_double(rest) != 0.0)
                in.fail("expected the end of the line, or a third coordinate of 0, got ", in_backquotes(rest));
        }
        in.end_of_line();
    }
    refuse_missing(mesh, boundary, step.file, known, nodes);
}

void read_places_of_mesh(const Mesh& mesh, int boundary, const MotionStep& step, std::vector<double>& positions) {
    const auto nodes = nodes_by_id(mesh, boundary);
    const RawMesh other = read_mesh(step.file);
    std::vector<char> known(mesh.nodes(), 0);
    for (const RawNode& node : other.nodes) {
        const auto found = nodes.find(node.id);
        if (found == nodes.end()) continue;
        known[found->second] = 1;
        std::copy_n(node.x, mesh.dim, point(positions, found->second, mesh.dim));
    }
    refuse_missing(mesh, boundary, step.file, known, nodes);
}

}  // namespace

std::vector<double> with_places_of_file(const Mesh& mesh, int boundary, const MotionStep& step,
                                        std::vector<double> positions) {
    if (is_of_mesh(step)) read_places_of_mesh(mesh, boundary, step, positions);
    else read_places(mesh, boundary, step, positions);
    return positions;
}

}  // namespace almesh
