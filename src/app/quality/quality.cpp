// What is told of a mesh file, as it is: `almesh info` and `almesh quality`.
#include <algorithm>
#include <unordered_map>

#include "app/commands.hpp"
#include "deck/deck.hpp"
#include "report/mesh_description.hpp"
#include "report/mesh_quality.hpp"
#include "base/parallel.hpp"
#include "base/table.hpp"
#include "io/mesh_format.hpp"
#include "io/proof_file.hpp"

namespace almesh {
namespace {

// Of each element, by its id: that id, and those of its nodes, ascending.
std::vector<std::vector<long long>> ids_of(const Mesh& mesh) {
    std::vector<std::vector<long long>> ids;
    for (int e = 0; e < mesh.element_count(); ++e) {
        std::vector<long long>& of = ids.emplace_back(1, mesh.file.element_id[e]);
        for (int k = 0; k < mesh.element_nodes(e); ++k) of.push_back(mesh.file.node_id[mesh.element(e)[k]]);
        std::sort(of.begin() + 1, of.end());
    }
    std::sort(ids.begin(), ids.end());
    return ids;
}

// Where another file has the nodes of the mesh: node_count x dim. One of a lower degree is raised.
std::vector<double> positions_before(const std::string& path, const Mesh& mesh) {
    std::vector<std::string> notes;
    Mesh other = build_mesh(read_mesh(path, mesh.file.format), notes, Folds::keep);
    if (other.degree < mesh.degree) other = raise_degree(other, mesh.degree);
    if (other.dim != mesh.dim || ids_of(other) != ids_of(mesh))
        throw InputError(path, ": this is not the same mesh as it was before: its elements or their nodes have other "
                         "ids (refine and split change them)");
    std::unordered_map<long long, int> node;
    for (int i = 0; i < other.nodes(); ++i) node[other.file.node_id[i]] = i;
    std::vector<double> x = mesh.x;
    for (int i = 0; i < mesh.nodes(); ++i)
        if (const auto at = node.find(mesh.file.node_id[i]); at != node.end())
            std::copy_n(point(other.x, at->second, mesh.dim), mesh.dim, point(x, i, mesh.dim));
    return x;
}

// The mesh as it is, told in JSON.
Mesh read_and_tell(const Deck& deck, std::vector<std::string>& notes, const Output& out) {
    set_threads(deck.threads);
    Mesh mesh = read_as_it_is(deck.mesh, notes);
    out.add({{"mesh", deck.mesh}, {"format", to_string(mesh.file.format)}, {"dimension", mesh.dim},
             {"degree", mesh.degree}, {"nodes", mesh.nodes()}, {"elements", mesh.element_count()},
             {"notes", json({notes.begin(), notes.end()})}});
    return mesh;
}

}  // namespace

ExitCode info(const Deck& deck, const Output& out) {
    std::vector<std::string> notes;
    const Mesh mesh = read_and_tell(deck, notes, out);
    describe_mesh(out, deck, mesh, notes);
    return ExitCode::success;
}

ExitCode quality(const Deck& deck, const QualityFiles& files, const Output& out) {
    std::vector<std::string> notes;
    const Mesh mesh = read_and_tell(deck, notes, out);
    print(out, deck.mesh, ": ", mesh.nodes(), " nodes, ", mesh.elements_text(), " of degree ", mesh.degree, "\n");
    for (const std::string& note : notes) print(out, "note: ", note, "\n");

    const std::string& before = files.before;
    const std::vector<double> came = before.empty() ? std::vector<double>() : positions_before(before, mesh);
    const bool is_certified = print_quality(out, mesh, before, came, deck.given.contains("output") ? deck.output : "");
    if (!is_certified) return ExitCode::not_certified;
    if (files.proof.empty()) return ExitCode::success;
    const ProofFile proof = write_proof(mesh, deck.mesh, files.proof);
    print(out, proof.told, "\n");
    out.add({{"proof", proof.is_written ? files.proof : "none"}});
    return proof.is_written ? ExitCode::success : ExitCode::not_certified;
}

}  // namespace almesh
