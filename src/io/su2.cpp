// KEYWORD= VALUE lines: NDIME, then in any order NELEM, NPOIN and NMARK, each with its records after it. An element is
// its VTK type, its nodes, and a number of its own that may be left out; a point its coordinates and its number, too.
#include "io/su2.hpp"

#include <algorithm>
#include <climits>

#include "base/files.hpp"
#include "io/text_scanner.hpp"

namespace almesh {
namespace {

constexpr int vtk_type[] = {1, 3, 5, 10};  // of a simplex by its dimension

const char* name_of(int type) {
    switch (type) {
        case 9: return "quadrilaterals";
        case 12: return "hexahedra";
        case 13: return "prisms";
        case 14: return "pyramids";
        default: return "elements of this type";
    }
}

struct Su2Reader {
    TextScanner in;
    RawMesh mesh{};
    int dim = 0;
    std::vector<std::string> sections{};  // those that were there

    RawMesh read() {
        while (next_line()) {
            const std::string keyword = take_keyword();
            check_repeat(keyword);
            if (keyword == "NDIME") dim = in.small_integer("2 or 3", 2, 3);
            else if (keyword == "NZONE" && in.small_integer("the number of zones") != 1)
                in.fail("several zones: give them in a file each");
            else if (keyword == "NELEM") elements(need_dimension(), 0);
            else if (keyword == "NPOIN") points();
            else if (keyword == "NMARK") markers();
            else in.rest_of_line();
        }
        if (mesh.nodes.empty()) in.fail("there is no NPOIN");
        if (mesh.elements.empty()) in.fail("there is no NELEM");
        check_nodes();
        return std::move(mesh);
    }

    bool next_line() {
        while (in.next_line()) {
            if (*in.at != '%') return true;
            in.rest_of_line();
        }
        return false;
    }

    // Up to `=`.
    std::string take_keyword() {
        const char* const begin = in.at;
        while (in.at != in.end && *in.at != '=' && *in.at != '\n') ++in.at;
        const std::string keyword(trim(std::string_view(begin, static_cast<std::size_t>(in.at - begin))));
        if (in.at == in.end || *in.at != '=') in.fail("expected `KEYWORD= VALUE`, got `", keyword.substr(0, 40), "`");
        ++in.at;
        return keyword;
    }

    void check_repeat(const std::string& keyword) {
        if (keyword != "NDIME" && keyword != "NELEM" && keyword != "NPOIN" && keyword != "NMARK") return;
        if (std::find(sections.begin(), sections.end(), keyword) != sections.end()) in.fail(keyword, " is there twice");
        sections.push_back(keyword);
    }

    int need_dimension() const {
        if (dim == 0) in.fail("NDIME has to come first");
        return dim;
    }

    void begin_record(const char* what, long long done, long long count) {
        if (!next_line()) in.fail("the file is cut off: ", count, " ", what, " announced, only ", done, " are there");
    }

    void points() {
        const int n = need_dimension();
        const long long count = in.integer("the number of points", 1, INT_MAX);
        in.rest_of_line();  // the number of points without ghosts may follow
        for (long long k = 0; k < count; ++k) {
            begin_record("points", k, count);
            RawNode node{k + 1, {}, in.line};
            for (int a = 0; a < n; ++a) node.x[a] = in.real("a coordinate");
            if (!in.at_line_end() && in.integer("the number of the point", 0, INT_MAX) != k)
                in.fail("points have to be numbered 0, 1, 2, ... in their order");
            in.end_of_line();
            mesh.nodes.push_back(node);
        }
    }

    // Of dimension n; physical: the tag of their marker.
    void elements(int n, int physical) {
        const long long count = in.integer("the number of elements", 0, INT_MAX);
        in.end_of_line();
        for (long long k = 0; k < count; ++k) {
            begin_record("elements", k, count);
            const int type = in.small_integer("the type of an element");
            if (type != vtk_type[n])
                in.fail(name_of(type), " (type ", type, ") are not read: only ", simplex(n).plural, ", type ",
                        vtk_type[n]);
            const long long id = static_cast<long long>(mesh.elements.size()) + 1;
            mesh.elements.push_back({id, mesh.element_nodes.size(), in.line, n, 1, physical, physical});
            for (int i = 0; i <= n; ++i) mesh.element_nodes.push_back(in.small_integer("the number of a node", 0));
            in.rest_of_line();
        }
    }

    void markers() {
        const int n = need_dimension() - 1, count = in.small_integer("the number of markers", 0);
        in.end_of_line();
        for (int k = 0; k < count; ++k) {
            begin_record("markers", k, count);
            if (const std::string keyword = take_keyword(); keyword != "MARKER_TAG")
                in.fail("expected MARKER_TAG= NAME, got ", keyword);
            const std::string name(in.rest_as_name());
            if (name.empty()) in.fail("a marker without a name");
            begin_record("markers", k, count);
            if (const std::string keyword = take_keyword(); keyword != "MARKER_ELEMS")
                in.fail("expected MARKER_ELEMS= COUNT, got ", keyword);
            mesh.groups.push_back({n, k + 1, name});
            elements(n, k + 1);
        }
    }

    void check_nodes() const {
        for (const RawElement& element : mesh.elements)
            for (int i = 0; i <= element.dim; ++i)
                if (mesh.element_nodes[element.first + i] >= static_cast<int>(mesh.nodes.size()))
                    in.fail_at(element.line, "node ", mesh.element_nodes[element.first + i],
                               " is not there: the file has ", mesh.nodes.size());
    }
};

struct Marker {
    std::string name;
    std::vector<const int*> faces;  // their nodes
};

// The boundaries, and the tagged faces inside the mesh.
std::vector<Marker> markers_of(const Mesh& mesh) {
    std::vector<Marker> markers;
    for (const std::string& name : mesh.boundaries) markers.push_back({name, {}});
    for (int f = 0; f < mesh.face_count(); ++f) markers[mesh.face_boundary[f]].faces.push_back(mesh.face(f));
    const KeptCells& kept = mesh.kept[mesh.dim - 1];
    for (int c = 0; c < kept.count(); ++c) {
        if (!kept.physical[c]) continue;
        const std::string name = group_name(mesh.file.groups, mesh.dim - 1, kept.physical[c]);
        auto marker =
            std::find_if(markers.begin(), markers.end(), [&](const Marker& other) { return other.name == name; });
        if (marker == markers.end()) marker = markers.insert(markers.end(), {name, {}});
        marker->faces.push_back(&kept.nodes[offset(c, mesh.dim)]);
    }
    return markers;
}

}  // namespace

bool looks_like_su2(std::string_view text) {
    for (const std::string_view line : split(text.substr(0, 2000), '\n')) {
        if (line.empty() || line[0] == '%') continue;
        return line.starts_with("NDIME") || line.starts_with("NZONE") || line.starts_with("IZONE");
    }
    return false;
}

RawMesh parse_su2(std::string_view text, const std::string& path) {
    Su2Reader reader{TextScanner(text, path)};
    reader.mesh.path = path;
    reader.mesh.format.kind = FileFormat::Kind::su2;
    return reader.read();
}

void write_su2(const std::string& path, const Mesh& mesh, const std::vector<double>& x) {
    const int dim = mesh.dim;
    const auto append_element = [](std::string& text, int type, const int* node, int count) {
        append(text, static_cast<long long>(type));
        for (int i = 0; i < count; ++i) {
            text += ' ';
            append(text, static_cast<long long>(node[i]));
        }
    };
    write_file(path, [&](const TextSink& sink) {
        if (!mesh.file.comment.empty()) sink("% " + mesh.file.comment + "\n");
        sink(concat("NDIME= ", dim, "\nNELEM= ", mesh.element_count(), "\n"));
        append_rows(sink, mesh.element_count(), [&](std::string& text, int e) {
            append_element(text, vtk_type[dim], mesh.element(e), dim + 1);
            text += ' ';
            append(text, static_cast<long long>(e));
            text += '\n';
        });
        sink(concat("NPOIN= ", mesh.nodes(), "\n"));
        append_rows(sink, mesh.nodes(), [&](std::string& text, int i) {
            for (int a = 0; a < dim; ++a) {
                append(text, x[offset(i, dim, a)]);
                text += ' ';
            }
            append(text, static_cast<long long>(i));
            text += '\n';
        });
        const std::vector<Marker> markers = markers_of(mesh);
        sink(concat("NMARK= ", markers.size(), "\n"));
        for (const Marker& marker : markers) {
            sink(concat("MARKER_TAG= ", marker.name, "\nMARKER_ELEMS= ", marker.faces.size(), "\n"));
            append_rows(sink, static_cast<int>(marker.faces.size()), [&](std::string& text, int k) {
                append_element(text, vtk_type[dim - 1], marker.faces[k], dim);
                text += '\n';
            });
        }
    });
}

}  // namespace almesh
