#include <set>

#include "deck/deck.hpp"
#include "fuzz/harness.hpp"
#include "io/mesh_format.hpp"
#include "io/patch.hpp"

namespace almesh::fuzz {
namespace {

// The mesh, or nothing where the program refuses it.
template <class Make>
std::optional<Mesh> mesh_or_refusal(const Make& make) {
    try {
        std::vector<std::string> notes;
        return build_mesh(make(), notes, Folds::keep);
    } catch (const InputError& error) {
        demand(error.what()[0] != '\0', "a mesh is refused without a word");
        return std::nullopt;
    }
}

// What is the same in any order of nodes, elements and faces, which MSH 4 sorts by their entities.
struct Contents {
    std::map<long long, std::vector<double>> position;      // by node id, from the first of its format on
    std::map<long long, std::vector<long long>> element;    // by its id: node ids
    std::multimap<std::vector<long long>, std::string> face;  // by node ids: boundary
    std::set<std::vector<long long>> kept;  // once each: MSH 2.2 has those of several groups as often

    explicit Contents(const Mesh& mesh) {
        const long long first = mesh.file.format.first_id();
        const auto ids = [&](const int* node, int count) {
            std::vector<long long> list;
            for (int k = 0; k < count; ++k) list.push_back(mesh.file.node_id[node[k]] - first);
            return list;
        };
        for (int i = 0; i < mesh.nodes(); ++i)
            position[mesh.file.node_id[i] - first] = {point(mesh.x, i, mesh.dim), point(mesh.x, i, mesh.dim) + mesh.dim};
        for (int e = 0; e < mesh.element_count(); ++e)
            element[mesh.file.element_id[e] - first] = ids(mesh.element(e), mesh.element_nodes(e));
        std::set<std::multiset<long long>> faces;
        for (int f = 0; f < mesh.face_count(); ++f) {
            const std::vector<long long> nodes = ids(mesh.face(f), mesh.face_nodes(f));
            face.emplace(nodes, mesh.boundaries[mesh.face_boundary[f]]);
            faces.emplace(nodes.begin(), nodes.end());
        }
        for (const KeptCells& cells : mesh.kept) {
            const CellType& cell = mesh.cell_of(cells);
            const int count = cell.dim == 0 ? 1 : cell.node_count(mesh.degree);
            for (int k = 0; k < cells.count() && cell.dim < mesh.dim; ++k) {
                const std::vector<long long> nodes = ids(cells.nodes.data() + offset(k, count), count);
                if (!faces.contains({nodes.begin(), nodes.end()})) kept.insert(nodes);  // else a face given again
            }
        }
    }
};

void check_same(const Mesh& mesh, const Mesh& again, const std::string& name) {
    demand(again.dim == mesh.dim && again.degree == mesh.degree, name, ": another kind of mesh");
    const Contents a(mesh), b(again);
    demand(a.position == b.position, name, ": other positions");
    demand(a.element == b.element, name, ": other elements");
    demand(a.face == b.face, name, ": other boundaries");
    demand(a.kept == b.kept, name, ": other cells inside");
}

void check_mesh(const Mesh& mesh) {
    demand(mesh.element_count() > 0 && mesh.nodes() > 0, "a mesh of nothing");
    const auto again = mesh_or_refusal([&] { return parse_msh(msh_text(mesh, mesh.x), "again.msh"); });
    demand(again.has_value(), "written anew it is refused");
    check_same(mesh, *again, "written anew");
}

// A file with the coordinates that it has is the same file, where it can be written again.
void check_patched(std::string_view bytes, const Mesh& mesh) {
    demand(mesh.file.coordinates.first.empty() || patched(bytes, mesh.file.coordinates, mesh.x) == bytes,
           "with its own coordinates it is another file");
}

void check_info(std::string_view bytes, const std::string& name) {
    const std::string path = work_folder().write(name, std::string(bytes));
    const test::Outcome outcome = outcome_of({"info", path});
    if (outcome.code != 0) return;
    try {
        parse_deck(outcome.out, "a.deck");
    } catch (const UsageError& error) {
        throw Violation(concat("info prints no deck: ", error.what(), "\n", outcome.out));
    }
}

// Of the format with this ending.
void fuzz_format(std::string_view bytes, const std::string& ending) {
    const auto format = std::find_if(std::begin(mesh_formats), std::end(mesh_formats),
                                     [&](const MeshFormat& row) { return row.ending == ending; });
    const auto mesh = mesh_or_refusal([&] { return parse_mesh(bytes, "fuzz" + ending, *format); });
    if (!mesh) return;
    check_mesh(*mesh);
    check_patched(bytes, *mesh);
    check_info(bytes, "fuzz" + ending);
}

}  // namespace

void fuzz_msh(std::string_view bytes) { fuzz_format(bytes, ".msh"); }
void fuzz_vtk(std::string_view bytes) { fuzz_format(bytes, ".vtk"); }
void fuzz_inp(std::string_view bytes) { fuzz_format(bytes, ".inp"); }
void fuzz_vtu(std::string_view bytes) { fuzz_format(bytes, ".vtu"); }

void fuzz_su2(std::string_view bytes) {
    const auto mesh = mesh_or_refusal([&] { return parse_su2(bytes, "fuzz.su2"); });
    if (!mesh) return;
    check_mesh(*mesh);
    check_patched(bytes, *mesh);
    const std::string path = work_folder().path("again.su2");
    write_su2(path, *mesh, mesh->x);
    const auto again = mesh_or_refusal([&] { return parse_su2(test::text_of(path), path); });
    demand(again && again->x == mesh->x && again->elements == mesh->elements, "written as SU2 it is another mesh");
    check_info(bytes, "fuzz.su2");
}

}  // namespace almesh::fuzz
