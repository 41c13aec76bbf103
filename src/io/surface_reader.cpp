// Surfaces of triangles: STL (3D Systems, StereoLithography Interface Specification, 1988) and OBJ (Wavefront, Advanced
// Visualizer manual, appendix B1). A group of OBJ, and a named solid of STL as text, is a physical group.
#include <array>
#include <cmath>
#include <cstdint>

#include "base/bytes.hpp"
#include "io/foreign_formats.hpp"
#include "io/text_scanner.hpp"

namespace almesh {
namespace {

constexpr std::size_t head = 84, facet = 50;  // bytes of a binary STL, and of a triangle there

std::size_t length_of_stl(std::string_view text) {  // 0: it has no head
    return text.size() < head ? 0 : head + facet * from_bytes<std::uint32_t>(&text[80], std::endian::little);
}

struct SurfaceBuild {
    RawMesh mesh;
    int group[3] = {};  // of the next elements, by their dimension

    explicit SurfaceBuild(const std::string& path) { mesh.path = path; }

    int add_node(const Vec<3>& x, int line) {
        const int index = static_cast<int>(mesh.nodes.size());
        mesh.nodes.push_back({index + 1, {x[0], x[1], x[2]}, line});
        return index;
    }
    // A line of two nodes, or a polygon as triangles around its first node.
    void add(std::span<const int> nodes, int line) {
        const int dim = nodes.size() == 2 ? 1 : 2;
        for (std::size_t k = 1; k + dim <= nodes.size(); ++k) {
            mesh.elements.push_back({static_cast<long long>(mesh.elements.size()) + 1, mesh.element_nodes.size(), line,
                                     dim, 1, group[dim], 0});
            mesh.element_nodes.push_back(nodes[0]);
            for (int i = 0; i < dim; ++i) mesh.element_nodes.push_back(nodes[k + i]);
        }
    }
    void begin_group(std::string_view name) {
        for (int dim = 1; dim <= 2; ++dim) {
            const auto has_name = [&](const PhysicalGroup& one) { return one.dim == dim && one.name == name; };
            const auto at = std::find_if(mesh.groups.begin(), mesh.groups.end(), has_name);
            group[dim] = at == mesh.groups.end() ? static_cast<int>(mesh.groups.size()) + 1 : at->tag;
            if (at == mesh.groups.end()) mesh.groups.push_back({dim, group[dim], std::string(name)});
        }
    }
};

bool begins_with(const TextScanner& in, std::string_view word) {
    return std::string_view(in.at, static_cast<std::size_t>(in.end - in.at)).starts_with(word);
}

Vec<3> point_of(TextScanner& in) {
    return {in.real("a coordinate"), in.real("a coordinate"), in.real("a coordinate")};
}

RawMesh parse_stl_text(std::string_view text, const std::string& path) {
    SurfaceBuild build(path);
    TextScanner in(text, path);
    std::vector<int> corners;
    bool ends = false;
    for (; in.next_line(); in.rest_of_line()) {
        if (begins_with(in, "vertex")) {
            in.at += 6;
            corners.push_back(build.add_node(point_of(in), in.line));
        } else if (begins_with(in, "endfacet")) {
            if (corners.size() != 3) in.fail("a facet with ", corners.size(), " vertices in place of 3");
            build.add(corners, in.line);
            corners.clear();
        } else if (begins_with(in, "solid")) {
            in.at += 5;
            if (const std::string_view name = in.rest_as_name(); !name.empty()) build.begin_group(name);
        }
        ends = begins_with(in, "endsolid");
    }
    if (!ends) in.fail("the file ends without `endsolid`: it is cut off");
    return std::move(build.mesh);
}

}  // namespace

bool looks_like_stl(std::string_view text) {
    if (const std::size_t length = length_of_stl(text); length > head && length == text.size()) return true;
    return trim(text.substr(0, head)).starts_with("solid") && text.find("facet") != text.npos;
}

RawMesh parse_stl(std::string_view text, const std::string& path) {
    const std::size_t length = length_of_stl(text);
    const bool is_text = trim(text.substr(0, head)).starts_with("solid") && text.find('\0') == text.npos;
    if (is_text && length != text.size()) return parse_stl_text(text, path);
    if (length == 0) throw InputError(path, ": ", counted(text.size(), "byte"), ", too few for an STL");
    if (length > text.size())
        throw InputError(path, ": a binary STL of ", (length - head) / facet, " triangles, as its head says, has ",
                         length, " bytes, this file ", text.size(), ": it is cut off, or no STL");
    SurfaceBuild build(path);
    for (std::size_t first = head; first < length; first += facet) {
        int corner[3];
        for (int k = 0; k < 3; ++k) {
            Vec<3> x;
            const char* const at = &text[first + 12 * (k + 1)];
            for (int a = 0; a < 3; ++a) x[a] = from_bytes<float>(at + 4 * a, std::endian::little);
            if (!std::isfinite(x[0] + x[1] + x[2]))
                throw InputError(path, ": triangle ", (first - head) / facet + 1, 
                                 " has a coordinate that is no number");
            corner[k] = build.add_node(x, 0);
        }
        build.add(corner, 0);
    }
    return std::move(build.mesh);
}

bool looks_like_obj(std::string_view text) {
    return text.find("\nf ") != text.npos || (text.find("v ") != text.npos && text.find("\nl ") != text.npos);
}

RawMesh parse_obj(std::string_view text, const std::string& path) {
    SurfaceBuild build(path);
    TextScanner in(text, path);
    for (; in.next_line(); in.rest_of_line()) {
        if (begins_with(in, "v ") || begins_with(in, "v\t")) {
            ++in.at;
            build.add_node(point_of(in), in.line);
        } else if (begins_with(in, "g ") || begins_with(in, "o ")) {
            ++in.at;
            build.begin_group(in.rest_as_name());
        } else if (begins_with(in, "f ") || begins_with(in, "l ")) {
            const bool is_face = *in.at++ == 'f';
            const int count = static_cast<int>(build.mesh.nodes.size());
            std::vector<int> nodes;
            for (const std::string_view word : words(in.rest_of_line())) {  // vertex/texture/normal
                const auto index = parse_int(word.substr(0, word.find('/')), -count, count);
                if (!index || *index == 0)
                    in.fail(in_backquotes(word), " is none of the ", count, " vertices so far");
                nodes.push_back(*index > 0 ? *index - 1 : count + *index);
            }
            if (nodes.size() < (is_face ? 3 : 2)) in.fail(is_face ? "a face" : "a line", " with too few vertices");
            if (is_face) build.add(nodes, in.line);
            for (std::size_t k = 1; k < nodes.size() && !is_face; ++k)
                build.add(std::span(nodes).subspan(k - 1, 2), in.line);
        }
    }
    return std::move(build.mesh);
}

}  // namespace almesh
