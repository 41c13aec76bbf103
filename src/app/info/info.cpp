#include <algorithm>
#include <filesystem>
#include <map>
#include <numeric>
#include <sstream>

#include "problem/base_mesh.hpp"
#include "app/commands.hpp"
#include "deck/deck.hpp"
#include "base/index.hpp"
#include "base/parallel.hpp"
#include "base/text.hpp"
#include "check/certificate.hpp"
#include "check/injectivity.hpp"
#include "geometry/box_tree.hpp"
#include "geometry/patch.hpp"
#include "geometry/face_patches.hpp"
#include "io/mesh_format.hpp"
#include "mesh/build.hpp"
#include "mesh/inner_boundary.hpp"
#include "mesh/kept_cells.hpp"

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

// Points and curves, and faces of no group inside the mesh.
std::string kept_text(const Mesh& mesh) {
    std::string text;
    for (const KeptCells& kept : mesh.kept)
        if (const CellType& cell = mesh.cell_of(kept); kept.count() && cell.dim < mesh.dim)
            text += concat(text.empty() ? "" : ", ", counted(kept.count(), cell.name),
                           cell.dim == mesh.dim - 1 ? " inside the mesh, in no group or repeated" : "");
    if (const auto count = mesh.file.loose.size())
        text += concat(text.empty() ? "" : ", ", counted(count, "node"), " without an element");
    for (const FileSection& section : mesh.file.sections) text += (text.empty() ? "" : ", ") + section.name;
    return text;
}

// A line for each group: what, its number of cells, its number of nodes and their box.
class GroupTable {
public:
    GroupTable(const Mesh& mesh, std::FILE* out) : mesh_(mesh), out_(out) {}

    void print(const char* title, const std::string& name, const std::string& cells, std::vector<int> nodes) {
        if (title != title_) std::fprintf(out_, "#\n# %s:\n", title_ = title);
        std::sort(nodes.begin(), nodes.end());
        nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
        const auto count = static_cast<int>(nodes.size());
        std::string box;
        if (count) box = ", " + box_text(box_of(positions(mesh_, mesh_.x, nodes.data(), count)), mesh_.dim);
        std::fprintf(out_, "#   %-*s  %s, %d nodes%s\n", width, name.c_str(), cells.c_str(), count, box.c_str());
    }

    int width = 0;  // of the names

private:
    const Mesh& mesh_;
    std::FILE* out_;
    const char* title_ = "";
};

// Of lower dimension than the faces: they are carried along.
void print_other_groups(const Mesh& mesh, GroupTable& table) {
    for (int dim = 0; dim < mesh.dim - 1; ++dim) {
        const KeptCells& kept = mesh.kept[dim];
        const int width = kept.count() ? static_cast<int>(kept.nodes.size()) / kept.count() : 0;
        std::map<int, std::vector<int>> nodes;
        std::map<int, int> cells;
        for (int c = 0; c < kept.count(); ++c) {
            if (!kept.physical[c]) continue;
            ++cells[kept.physical[c]];
            for (int k = 0; k < width; ++k)
                if (const int node = kept.nodes[offset(c, width, k)]; node >= 0)
                    nodes[kept.physical[c]].push_back(node);
        }
        for (const auto& [tag, count] : cells)
            table.print(dim == 0 ? "Points (carried along)" : "Curves (carried along)",
                        group_name(mesh.file.groups, dim, tag), counted(count, simplex(dim).name), nodes[tag]);
    }
}

// What a run does with a mesh that is not valid.
std::string what_a_run_does(const Deck& deck, const RawMesh& raw) try {
    std::vector<std::string> notes;
    build_base_mesh(raw, deck.ideal, notes);
    return "a run starts from the mesh with straight sides";
} catch (const InputError&) {
    return "a run refuses the mesh, almesh improve FILE may mend it";
}

std::string validity_of(const Deck& deck, const RawMesh& raw, const Mesh& mesh) {
    const Certificate certificate = certify(mesh, mesh.x);
    if (!certificate.valid)
        return concat(counted(certificate.uncertified.size(), "element"), " not certified valid (almesh quality FILE ",
                      "lists them); ", what_a_run_does(deck, raw));
    const Injectivity injectivity = certify_injective(mesh, mesh.x, certificate);
    return injectivity.certified ? "all elements certified valid, none overlap"
                                 : "all elements certified valid, but " + injectivity.reason;
}

// For `select NAME = part NUMBER`.
void print_parts(const Deck& deck, const Mesh& mesh, std::FILE* out) {
    const std::vector<int> part = smooth_parts(mesh, deck.feature_angle);
    const int count = *std::max_element(part.begin(), part.end());
    std::fprintf(out,
                 "#\n# Smooth parts of the boundary, cut at angles above %s degrees (select NAME = part NUMBER):\n",
                 to_text(deck.feature_angle).c_str());
    constexpr int most = 60;
    for (int k = 1; k <= std::min(count, most); ++k) {
        std::vector<int> nodes;
        Vec<3> normal{};
        int faces = 0;
        for (int f = 0; f < mesh.face_count(); ++f) {
            if (part[f] != k) continue;
            ++faces;
            nodes.insert(nodes.end(), mesh.face(f), mesh.face(f) + mesh.face_nodes(f));
            normal = normal + unit_normal(mesh, f);
        }
        std::fprintf(out, "#   part %d  %s, %s, mean normal (%.3f, %.3f", k, counted(faces, "face").c_str(),
                     box_text(box_of(positions(mesh, mesh.x, nodes.data(), static_cast<int>(nodes.size()))), mesh.dim)
                         .c_str(),
                     normal[0] / faces, normal[1] / faces);
        if (mesh.dim == 3) std::fprintf(out, ", %.3f", normal[2] / faces);
        std::fprintf(out, ")\n");
    }
    if (count > most) std::fprintf(out, "#   and %d more: a larger feature_angle makes fewer\n", count - most);
}

void print_deck(const Deck& deck, const Mesh& mesh, const std::vector<GroupCells>& inner,
                const std::vector<GroupCells>& volumes, std::FILE* out) {
    const std::filesystem::path absolute = std::filesystem::absolute(deck.mesh).lexically_normal();
    const std::string output = deck.given.contains("output") ? deck.output : "outputs/" + absolute.stem().string();
    std::fprintf(out,
                 "#\n# This text is a deck. Change its motions, for instance to `translate %s`, `rotate 30%s` or\n"
                 "# `slide`, and run it from any folder: almesh THIS-FILE. All motions and keys: almesh --keys.\n"
                 "mesh = %s\noutput = %s\n",
                 mesh.dim == 2 ? "1 0" : "1 0 0", mesh.dim == 2 ? " about 0 0" : " axis 0 0 1",
                 quoted_where_needed(absolute.string(), "#\"").c_str(), quoted_where_needed(output, "#\"").c_str());
    for (const DeckKey& key : deck_keys())
        if (deck.given.contains(key.name) && key.name != "output")
            std::fprintf(out, "%s = %s\n", key.name.c_str(), key.value.text(deck).c_str());
    // Of the line that was given, else a boundary that stays, as a comment where it may be free.
    const auto line = [out](const char* what, const std::string& name, const DeckBoundary* given, bool may_be_free) {
        std::fprintf(out, "%s%s %s = %s\n", may_be_free && !given ? "# " : "", what,
                     quoted_where_needed(name, "#=\" \t").c_str(),
                     given ? to_string(given->motion).c_str() : "fixed");
    };
    for (const std::string& name : mesh.boundaries) line("boundary", name, motion_for(deck, name), false);
    for (const GroupCells& group : inner) line("boundary", group.name, find_row(deck.boundaries, group.name), true);
    for (const GroupCells& group : volumes) {
        const DeckBoundary* const given = find_row(deck.boundaries, volume_group(group.name));
        if (given || volumes.size() > 1) line("volume", group.name, given, true);
    }
}

}  // namespace

ExitCode info(const Deck& deck, std::FILE* out) {
    set_threads(deck.threads);
    std::vector<std::string> notes;
    const RawMesh raw = read_mesh(deck.mesh);
    const Mesh mesh = build_mesh(raw, notes, Folds::keep);
    std::vector<int> all(mesh.nodes());
    std::iota(all.begin(), all.end(), 0);
    const char* const measure = mesh.dim == 2 ? "area" : "volume";
    const std::vector<double> straight = straight_sided(mesh);
    std::fprintf(out, "# %s, %s: %d nodes, %s of degree %d\n", deck.mesh.c_str(),
                 to_string(mesh.file.format).c_str(), mesh.nodes(), mesh.elements_text().c_str(),
                 mesh.degree);
    std::fprintf(out, "# %s, %s %.6g with straight sides\n",
                 box_text(box_of(positions(mesh, mesh.x, all.data(), mesh.nodes())), mesh.dim).c_str(), measure,
                 volume(mesh, straight));
    if (const std::string kept = kept_text(mesh); !kept.empty())
        std::fprintf(out, "# carried along with the mesh: %s\n", kept.c_str());
    for (const std::string& note : notes) std::fprintf(out, "# note: %s\n", note.c_str());
    std::fprintf(out, "# %s\n", validity_of(deck, raw, mesh).c_str());

    const std::vector<GroupCells> inner = inner_groups(mesh), volumes = volume_groups(mesh);
    const std::vector<KeptFace> kept = kept_faces(mesh);
    GroupTable table(mesh, out);
    const auto widen = [&table](const std::string& name) {
        table.width = std::max(table.width, static_cast<int>(name.size()));
    };
    for (const std::string& name : mesh.boundaries) widen(name);
    for (const GroupCells& group : inner) widen(group.name);
    for (const GroupCells& group : volumes) widen(group.name);
    std::vector<int> faces(mesh.boundaries.size(), 0);
    std::vector<std::vector<int>> nodes_of(mesh.boundaries.size());
    for (int f = 0; f < mesh.face_count(); ++f) {
        const int b = mesh.face_boundary[f];
        ++faces[b];
        nodes_of[b].insert(nodes_of[b].end(), mesh.face(f), mesh.face(f) + mesh.face_nodes(f));
    }
    for (std::size_t b = 0; b < faces.size(); ++b)
        table.print("Boundaries", mesh.boundaries[b], counted(faces[b], "face"), nodes_of[b]);
    for (const GroupCells& group : inner) {
        std::vector<int> nodes;
        for (const int c : group.cells)
            nodes.insert(nodes.end(), kept[c].nodes, kept[c].nodes + kept[c].cell->node_count(mesh.degree));
        table.print("Inside the mesh (free unless a line moves them)", group.name,
                    counted(group.cells.size(), "face"), nodes);
    }
    for (const GroupCells& group : volumes) {
        std::vector<int> nodes;
        double size = 0;
        for (const int e : group.cells) {
            nodes.insert(nodes.end(), mesh.element(e), mesh.element(e) + mesh.element_nodes(e));
            size += volume(mesh, straight, e);
        }
        std::string cells = concat(counted(group.cells.size(), "element"), ", ", measure, " ");
        append(cells, size, 6);
        table.print("Volumes (free unless a line moves them)", group.name, cells, nodes);
    }
    print_other_groups(mesh, table);
    const bool has_names = std::none_of(notes.begin(), notes.end(),
                                        [](const std::string& note) { return note.starts_with("no tagged"); });
    if (!has_names || deck.given.contains("feature_angle")) print_parts(deck, mesh, out);
    print_deck(deck, mesh, inner, volumes, out);
    return ExitCode::success;
}

}  // namespace almesh
