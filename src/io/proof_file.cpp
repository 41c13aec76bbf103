#include "io/proof_file.hpp"

#include <algorithm>
#include <map>

#include "base/files.hpp"
#include "base/text.hpp"
#include "base/version.hpp"
#include "check/proof.hpp"
#include "io/mesh_format.hpp"

namespace almesh {
namespace {

// The elements whose nodes the file has in another order than the mesh; false where it has others.
bool find_turned(const RawMesh& raw, const Mesh& mesh, std::string& lines) {
    std::map<long long, const RawElement*> of_id;
    for (const RawElement& element : raw.elements)
        if (element.dim == mesh.dim) of_id[element.id] = &element;
    if (static_cast<int>(of_id.size()) != mesh.element_count()) return false;
    for (int e = 0; e < mesh.element_count(); ++e) {
        const auto at = of_id.find(mesh.file.element_id[e]);
        if (at == of_id.end() || at->second->node_count() != mesh.element_nodes(e)) return false;
        const auto* const own = &raw.element_nodes[at->second->first];
        const auto is_same = [&](int k) { return raw.nodes[own[k]].id == mesh.file.node_id[mesh.element(e)[k]]; };
        int k = 0;
        while (k < mesh.element_nodes(e) && is_same(k)) ++k;
        if (k < mesh.element_nodes(e)) lines += concat("turned ", at->first, " 1\n");
    }
    return true;
}

}  // namespace

ProofFile write_proof(const std::string& path, const std::string& proof) {
    std::string mesh_path = path, text = read_file(path), turned;
    const RawMesh raw = parse_mesh(text, path);
    const FileFormat& format = raw.format;
    std::vector<std::string> notes;
    Mesh mesh = build_mesh(raw, notes, Folds::keep);
    if (mesh.degree > 4) return {false, "no proof: it is of degree 4 at most"};
    const bool is_msh = format.ending == ".msh" && (format.msh_version == 22 || format.msh_version == 41);
    const bool is_readable = format.ending == ".su2" || (is_msh && !format.binary);
    if (!is_readable || !find_turned(raw, mesh, turned)) {
        mesh_path = proof + ".msh";
        text = msh_text(mesh, mesh.x);
        write_file(mesh_path, text);
        mesh = build_mesh(parse_mesh(text, mesh_path), notes, Folds::keep);
        turned.clear();
    }
    const Proof found = make_proof(mesh, mesh.x);
    if (!found.missing.empty())
        return {false, concat("no proof: ", found.missing, " is too close to the limit to tell, or faces touch there")};
    std::string lines = concat("almesh proof 1\nversion ", version(), "\nhash ", hash_of(text), "\nelements ",
                               mesh.element_count(), "\n", turned, found.lines);
    lines += concat("end ", std::count(lines.begin(), lines.end(), '\n') + 1, "\n");
    write_file(proof, lines);
    return {true, concat("proof: ", proof, " of ", mesh_path, ", ", lines.size(), " bytes")};
}

}  // namespace almesh
