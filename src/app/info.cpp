#include <algorithm>
#include <filesystem>
#include <sstream>

#include "app/commands.hpp"
#include "base/index.hpp"
#include "base/text.hpp"
#include "check/certificate.hpp"
#include "check/injectivity.hpp"
#include "geometry/box_tree.hpp"
#include "geometry/patch.hpp"
#include "io/mesh_format.hpp"
#include "mesh/build.hpp"

namespace almesh {
namespace {

std::string box_text(const Box& box, int dim) {
    std::ostringstream out;
    for (const Vec<3>* corner : {&box.low, &box.high}) {
        out << (corner == &box.low ? "(" : " to (");
        for (int a = 0; a < dim; ++a) out << (a ? ", " : "") << (*corner)[a];
        out << ')';
    }
    return out.str();
}

struct BoundaryPart {
    int faces = 0;
    std::vector<int> nodes;
};

std::vector<BoundaryPart> parts_of(const Mesh& mesh) {
    std::vector<BoundaryPart> parts(mesh.boundaries.size());
    for (int f = 0; f < mesh.face_count(); ++f) {
        BoundaryPart& part = parts[mesh.face_boundary[f]];
        ++part.faces;
        part.nodes.insert(part.nodes.end(), mesh.face(f), mesh.face(f) + mesh.face_nodes());
    }
    for (BoundaryPart& part : parts) {
        std::sort(part.nodes.begin(), part.nodes.end());
        part.nodes.erase(std::unique(part.nodes.begin(), part.nodes.end()), part.nodes.end());
    }
    return parts;
}

std::string kept_text(const Mesh& mesh) {
    std::string text;
    for (int dim = 0; dim < mesh.dim; ++dim)
        if (const int count = mesh.kept[dim].count())
            text += concat(text.empty() ? "" : ", ", counted(count, simplex(dim).name),
                           dim == mesh.dim - 1 ? " inside or without a physical group" : "");
    return text;
}

std::string validity_of(const Mesh& mesh) {
    const Certificate certificate = certify(mesh, mesh.x);
    if (!certificate.valid)
        return counted(certificate.uncertified.size(), "element") + " not certified valid (almesh quality FILE lists "
               "them); a run straightens the mesh first";
    const Injectivity injectivity = certify_injective(mesh, mesh.x, certificate);
    return injectivity.certified ? "all elements certified valid, none overlap"
                                 : "all elements certified valid, but " + injectivity.reason;
}

}  // namespace

ExitCode info(const std::string& mesh_path, std::FILE* out) {
    std::vector<std::string> notes;
    const Mesh mesh = build_mesh(read_mesh(mesh_path), notes, Folds::keep);
    std::vector<int> all(mesh.nodes());
    for (int i = 0; i < mesh.nodes(); ++i) all[i] = i;
    const auto box_of_nodes = [&](const std::vector<int>& nodes) {
        return box_text(box_of(positions(mesh, mesh.x, nodes.data(), static_cast<int>(nodes.size()))), mesh.dim);
    };
    const char* const measure = mesh.dim == 2 ? "area" : "volume";
    std::fprintf(out, "# %s, %s: %d nodes, %d %s of degree %d\n", mesh_path.c_str(),
                 to_string(mesh.file.format).c_str(), mesh.nodes(), mesh.element_count(), mesh.cell().plural,
                 mesh.degree);
    std::fprintf(out, "# %s, %s %.6g with straight sides\n", box_of_nodes(all).c_str(), measure,
                 volume(mesh, straight_sided(mesh)));
    if (const std::string kept = kept_text(mesh); !kept.empty())
        std::fprintf(out, "# carried along with the mesh: %s\n", kept.c_str());
    for (const std::string& note : notes) std::fprintf(out, "# note: %s\n", note.c_str());
    std::fprintf(out, "# %s\n#\n# Boundaries:\n", validity_of(mesh).c_str());
    const std::vector<BoundaryPart> parts = parts_of(mesh);
    std::size_t width = 0;
    for (const std::string& name : mesh.boundaries) width = std::max(width, name.size());
    for (std::size_t b = 0; b < parts.size(); ++b)
        std::fprintf(out, "#   %-*s  %d faces, %zu nodes, %s\n", static_cast<int>(width), mesh.boundaries[b].c_str(),
                     parts[b].faces, parts[b].nodes.size(), box_of_nodes(parts[b].nodes).c_str());
    const std::filesystem::path absolute = std::filesystem::absolute(mesh_path).lexically_normal();
    const std::string stem = absolute.stem().string();
    std::fprintf(out,
                 "#\n# This text is a deck. Change its motions, for instance to `translate %s`, `rotate 30%s` or\n"
                 "# `slide`, and run it from any folder: almesh THIS-FILE. All motions and keys: almesh --keys.\n"
                 "mesh = %s\noutput = %s\n",
                 mesh.dim == 2 ? "1 0" : "1 0 0", mesh.dim == 2 ? " about 0 0" : " axis 0 0 1",
                 quoted_where_needed(absolute.string(), "#\"").c_str(),
                 quoted_where_needed("outputs/" + stem, "#\"").c_str());
    for (const std::string& name : mesh.boundaries)
        std::fprintf(out, "boundary %s = fixed\n", quoted_where_needed(name, "#=\" \t").c_str());
    return ExitCode::success;
}

}  // namespace almesh
