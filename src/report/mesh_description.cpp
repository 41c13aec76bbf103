#include "report/mesh_description.hpp"

#include <algorithm>
#include <filesystem>
#include <map>
#include <numeric>

#include "problem/base_mesh.hpp"
#include "base/index.hpp"
#include "base/table.hpp"
#include "check/certificate.hpp"
#include "check/injectivity.hpp"
#include "geometry/box_tree.hpp"
#include "geometry/patch.hpp"
#include "geometry/face_patches.hpp"
#include "io/mesh_format.hpp"
#include "mesh/inner_boundary.hpp"
#include "mesh/kept_cells.hpp"
#include "mesh/periodic.hpp"

namespace almesh {
namespace {

std::string box_text(const Mesh& mesh, const std::vector<int>& nodes) {
    const Box box = box_of(positions(mesh, mesh.x, nodes.data(), static_cast<int>(nodes.size())));
    return position_text(box.low.data(), mesh.dim) + " to " + position_text(box.high.data(), mesh.dim);
}

// The least coordinates of the nodes, and the largest ones.
Field json_box(const Mesh& mesh, const std::vector<int>& nodes) {
    const Box box = box_of(positions(mesh, mesh.x, nodes.data(), static_cast<int>(nodes.size())));
    Fields corners(box.low.begin(), box.low.begin() + mesh.dim);
    corners.insert(corners.end(), box.high.begin(), box.high.begin() + mesh.dim);
    return json(corners);
}

const char* measure(const Mesh& mesh) { return mesh.dim == 2 ? "area" : "volume"; }

// Points and curves, and faces of no group inside the mesh.
std::string kept_text(const Mesh& mesh) {
    std::string text;
    for (const KeptCells& kept : mesh.kept)
        if (const CellType& cell = mesh.cell_of(kept); kept.count() && cell.dim < mesh.dim)
            text += concat(text.empty() ? "" : ", ", counted(kept.count(), cell.name),
                           cell.dim == mesh.dim - 1 ? " inside the mesh, in no group or repeated" : "");
    if (const int count = mesh.file.loose)
        text += concat(text.empty() ? "" : ", ", counted(count, "node"), " without an element (not moved)");
    for (const std::string& section : mesh.file.sections) text += (text.empty() ? "" : ", ") + section;
    return text;
}

// Of cells, under a title that it shares with those beside it.
struct Group {
    const char* title;
    std::string name;
    std::size_t count;
    const char* cell;
    std::vector<int> nodes;
    double size = 0;  // of volumes
};

std::vector<Group> groups_with_motions(const Mesh& mesh, const std::vector<GroupCells>& inner,
                                       const std::vector<GroupCells>& volumes) {
    std::vector<Group> groups;
    for (const std::string& name : mesh.boundaries) groups.push_back({"Boundaries", name, 0, "face", {}});
    for (int f = 0; f < mesh.face_count(); ++f) {
        std::vector<int>& nodes = groups[mesh.face_boundary[f]].nodes;
        nodes.insert(nodes.end(), mesh.face(f), mesh.face(f) + mesh.face_nodes(f));
        ++groups[mesh.face_boundary[f]].count;
    }
    const std::vector<KeptFace> kept = kept_faces(mesh);
    for (const GroupCells& group : inner) {
        std::vector<int> nodes;
        for (const int c : group.cells)
            nodes.insert(nodes.end(), kept[c].nodes, kept[c].nodes + kept[c].cell->node_count(mesh.degree));
        groups.push_back({"Inside the mesh (free unless a line moves them)", group.name, group.cells.size(), "face",
                          nodes});
    }
    const std::vector<double> straight = straight_sided(mesh);
    for (const GroupCells& group : volumes) {
        std::vector<int> nodes;
        double size = 0;
        for (const int e : group.cells) {
            nodes.insert(nodes.end(), mesh.element(e), mesh.element(e) + mesh.element_nodes(e));
            size += volume(mesh, straight, e);
        }
        groups.push_back({"Volumes (free unless a line moves them)", group.name, group.cells.size(), "element", nodes,
                          size});
    }
    return groups;
}

// Of lower dimension than the faces.
void add_carried_groups(const Mesh& mesh, std::vector<Group>& groups) {
    for (int dim = 0; dim < mesh.dim - 1; ++dim) {
        const KeptCells& kept = mesh.kept[dim];
        const int width = kept.count() ? static_cast<int>(kept.nodes.size()) / kept.count() : 0;
        std::map<int, std::vector<int>> nodes;
        std::map<int, std::size_t> cells;
        for (int c = 0; c < kept.count(); ++c) {
            if (!kept.physical[c]) continue;
            ++cells[kept.physical[c]];
            for (int k = 0; k < width; ++k) nodes[kept.physical[c]].push_back(kept.nodes[offset(c, width, k)]);
        }
        for (const auto& [tag, count] : cells)
            groups.push_back({dim == 0 ? "Points (carried along)" : "Curves (carried along)",
                              group_name(mesh.file.groups, dim, tag), count, simplex(dim).name, nodes[tag]});
    }
}

void print_groups(const Mesh& mesh, const std::vector<GroupCells>& inner, const std::vector<GroupCells>& volumes,
                  const Output& out) {
    std::vector<Group> groups = groups_with_motions(mesh, inner, volumes);
    std::size_t width = 0;
    for (const Group& group : groups) width = std::max(width, group.name.size());
    add_carried_groups(mesh, groups);
    std::string title;
    Fields rows;
    for (auto& [of, name, count, cell, nodes, size] : groups) {
        if (title != of) print(out, "#\n# ", title = of, ":\n");
        std::sort(nodes.begin(), nodes.end());
        nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
        const bool has_size = std::string_view(cell) == "element";
        rows.push_back(json({{"kind", title.substr(0, title.find(" ("))}, {"group", name}, {"cells", count},
                             {"nodes", nodes.size()}, {"volume", has_size ? size : Field("")},
                             {"box", nodes.empty() ? "" : json_box(mesh, nodes)}}));
        print(out, "#   ", padded(name, -static_cast<int>(width)), "  ", counted(count, cell),
              has_size ? concat(", ", measure(mesh), " ", to_text(size, 6)) : "", ", ", nodes.size(), " nodes",
              nodes.empty() ? "" : ", " + box_text(mesh, nodes), "\n");
    }
    out.add({{"groups", json(rows)}});
}

// What a run does with a mesh that is not valid.
std::string what_a_run_does(const Deck& deck) try {
    std::vector<std::string> notes;
    build_base_mesh(read_mesh(deck.mesh), deck.ideal, notes);
    return "a run starts from the mesh with straight sides";
} catch (const InputError&) {
    return "a run refuses the mesh, almesh improve FILE may mend it";
}

std::string validity_of(const Deck& deck, const Mesh& mesh) {
    const Certificate certificate = certify(mesh, mesh.x);
    if (!certificate.valid)
        return concat(counted(certificate.uncertified.size(), "element"), " not certified valid (almesh quality FILE ",
                      "lists them); ", what_a_run_does(deck));
    const Injectivity injectivity = certify_injective(mesh, mesh.x, certificate);
    return injectivity.certified ? "all elements certified valid, none overlap"
                                 : "all elements certified valid, but " + injectivity.reason;
}

// For `select NAME = part NUMBER`.
void print_parts(const Deck& deck, const Mesh& mesh, std::FILE* out) {
    const std::vector<int> part = smooth_parts(mesh, deck.feature_angle);
    const int count = *std::max_element(part.begin(), part.end());
    print(out, "#\n# Smooth parts of the boundary, cut at angles above ", deck.feature_angle,
          " degrees (select NAME = part NUMBER):\n");
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
        std::string components;
        for (int a = 0; a < mesh.dim; ++a) components += (a == 0 ? "" : ", ") + fixed(normal[a] / faces, 3);
        print(out, "#   part ", k, "  ", counted(faces, "face"), ", ", box_text(mesh, nodes), ", mean normal (",
              components, ")\n");
    }
    if (count > most) print(out, "#   and ", count - most, " more: a larger feature_angle makes fewer\n");
}

void print_deck(const Deck& deck, const Mesh& mesh, const std::vector<GroupCells>& inner,
                const std::vector<GroupCells>& volumes, std::FILE* out) {
    const bool is_plane = mesh.dim == 2;
    const std::filesystem::path absolute = std::filesystem::absolute(deck.mesh).lexically_normal();
    const std::string output = deck.given.contains("output") ? deck.output : "outputs/" + absolute.stem().string();
    print(out, "#\n# This text is a deck. Change its motions, for instance to `translate ", is_plane ? "1 0" : "1 0 0",
          "`, `rotate 30", is_plane ? " about 0 0" : " axis 0 0 1", "` or\n",
          "# `slide`, and run it from any folder: almesh THIS-FILE. All motions and keys: almesh --keys.\nmesh = ",
          quoted_where_needed(absolute.string(), "#\""), "\noutput = ", quoted_where_needed(output, "#\""), "\n");
    for (const DeckKey& key : deck_keys())
        if (deck.given.contains(key.name) && key.name != "output")
            print(out, key.name, " = ", key.value.text(deck), "\n");
    // Of the line that was given, else a boundary that stays, as a comment where it may be free.
    const auto line = [out](const char* what, const std::string& name, const BoundaryMotion* given, bool may_be_free) {
        print(out, may_be_free && !given ? "# " : "", what, " ", quoted_where_needed(name, "#=\" \t"), " = ",
              given ? to_string(given->motion) : "fixed", "\n");
    };
    const std::vector<char> periodic = periodic_boundaries(mesh, std::vector<char>(mesh.boundaries.size(), 1));
    for (std::size_t b = 0; b < periodic.size(); ++b)
        line("boundary", mesh.boundaries[b], motion_for(deck, mesh.boundaries[b]), periodic[b]);
    for (const GroupCells& group : inner) line("boundary", group.name, find_row(deck.boundaries, group.name), true);
    for (const GroupCells& group : volumes) {
        const BoundaryMotion* const given = find_row(deck.boundaries, volume_group(group.name));
        if (given || volumes.size() > 1) line("volume", group.name, given, true);
    }
}

}  // namespace

void describe_mesh(const Output& out, const Deck& deck, const Mesh& mesh, const std::vector<std::string>& notes) {
    std::vector<int> all(mesh.nodes());
    std::iota(all.begin(), all.end(), 0);
    const double size = volume(mesh, straight_sided(mesh));
    const std::string kept = kept_text(mesh), validity = validity_of(deck, mesh);
    out.add({{"volume", size}, {"box", json_box(mesh, all)}, {"carried_along", kept}, {"validity", validity}});
    print(out, "# ", deck.mesh, ", ", to_string(mesh.file.format), ": ", mesh.nodes(), " nodes, ",
          mesh.elements_text(), " of degree ", mesh.degree, "\n# ", box_text(mesh, all), ", ", measure(mesh), " ",
          to_text(size, 6), " with straight sides\n");
    if (!kept.empty()) print(out, "# carried along with the mesh: ", kept, "\n");
    for (const std::string& note : notes) print(out, "# note: ", note, "\n");
    print(out, "# ", validity, "\n");

    const std::vector<GroupCells> inner = inner_groups(mesh), volumes = volume_groups(mesh);
    print_groups(mesh, inner, volumes, out);
    const auto tells_of_none = [](const std::string& note) { return note.starts_with("no tagged"); };
    if (std::any_of(notes.begin(), notes.end(), tells_of_none) || deck.given.contains("feature_angle"))
        print_parts(deck, mesh, out);
    print_deck(deck, mesh, inner, volumes, out);
}

}  // namespace almesh
