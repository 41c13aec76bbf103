#include "io/msh_reader.hpp"

#include <algorithm>
#include <climits>
#include <cstdlib>
#include <utility>

#include "base/files.hpp"
#include "io/id_index.hpp"
#include "io/msh_types.hpp"
#include "io/text_scanner.hpp"

namespace almesh {
namespace {

struct ForeignElements {
    int type, line;
    long long count;
};

struct MshReader {
    TextScanner in;
    RawMesh mesh;
    IdIndex index;  // of the nodes
    std::vector<ForeignElements> foreign;
    bool version_known = false;

    RawMesh read();
    void section();
    void skip_section(const std::string& name);
    void format();
    void physical_names();
    void entities();
    void nodes();
    void nodes_2_2(long long count);
    void nodes_4_1(long long blocks, long long count);
    void elements();
    void elements_2_2(long long count);
    void elements_4_1(long long blocks, long long count);

    void begin_record(const char* section, const char* what, long long done, long long count);
    int physical_of(int dim, int entity) const;
    bool is_simplex(int type, const SimplexType& simplex, long long count);
    [[noreturn]] void refuse_foreign() const;
    void element_node_ids(int count);
    template <class Item>
    void refuse_repeated(const char* what, const std::vector<IdAndIndex>& sorted, const std::vector<Item>& items) const;

    // Counts may lie, but a record takes four characters at least.
    std::size_t room_for(long long count) const {
        return static_cast<std::size_t>(std::min<long long>(count, (in.end - in.at) / 4));
    }
};

RawMesh MshReader::read() {
    while (in.next_line()) section();
    if (!version_known) in.fail("not a Gmsh mesh file: there is no $MeshFormat section");
    if (mesh.nodes.empty()) in.fail("there is no $Nodes section");
    if (mesh.elements.empty()) in.fail("there is no $Elements section");
    return std::move(mesh);
}

void MshReader::section() {
    const int line = in.line;
    const std::string name(in.rest_of_line());
    if (!version_known && name != "$MeshFormat" && name != "$Comments")
        in.fail("not a Gmsh mesh file of version 2.2 or 4.1: it has to begin with $MeshFormat");
    if (name.size() < 2 || name[0] != '$' || name.starts_with("$End"))
        in.fail("expected a section such as $Nodes, got `" + name.substr(0, 40) + "`");
    if (name == "$MeshFormat") format();
    else if (name == "$PhysicalNames") physical_names();
    else if (name == "$Entities") entities();
    else if (name == "$Nodes") nodes();
    else if (name == "$Elements") elements();
    else if (name == "$PartitionedEntities") in.fail("a partitioned mesh is not read: save it in one part");
    else if (name == "$ParametricNodes") in.fail("parametric nodes are not read: save the mesh without -parametric");
    else skip_section(name);
    const std::string last = "$End" + name.substr(1);
    if (!in.next_line()) in.fail(line, "the file is cut off: " + name + " has no " + last);
    if (in.rest_of_line() != last) in.fail("expected " + last + ": " + name + " holds more than it announces");
}

// To the section's $End line, or the end of the file.
void MshReader::skip_section(const std::string& name) {
    const std::string last = "$End" + name.substr(1);
    while (in.next_line()) {
        const char* const begin = in.at;
        if (in.rest_of_line() != last) continue;
        in.at = begin;
        return;
    }
}

// To record `done` (from 0) of `count`.
void MshReader::begin_record(const char* section, const char* what, long long done, long long count) {
    if (in.next_line() && *in.at != '$') return;
    const std::string where = in.at == in.end ? "the file is cut off" : in.word() + " comes too early";
    in.fail(where + ": " + section + " announces " + std::to_string(count) + " " + what + ", only " +
            std::to_string(done) + " are there");
}

void MshReader::format() {
    if (version_known) in.fail("a second $MeshFormat section");
    if (!in.next_line()) in.fail("the file is cut off after $MeshFormat");
    const std::string shown = in.word();
    const double version = in.real("the format version");
    if (version != 2.2 && version != 4.1)
        in.fail("format version " + shown + ": only 2.2 and 4.1 are read (gmsh -0 IN.msh -format msh41 -o OUT.msh)");
    mesh.msh_version = version == 2.2 ? 22 : 41;
    if (in.small_integer("0 (ASCII)") != 0) in.fail("a binary mesh is not read: save it in ASCII (gmsh without -bin)");
    in.small_integer("the size of a number");
    in.end_of_line();
    version_known = true;
}

void MshReader::physical_names() {
    in.next_line();
    const long long count = in.integer("the number of physical names", 0, LLONG_MAX);
    in.end_of_line();
    for (long long i = 0; i < count; ++i) {
        begin_record("$PhysicalNames", "names", i, count);
        PhysicalGroup group;
        group.dim = static_cast<int>(in.integer("the dimension of the physical group", 0, 3));
        group.tag = std::abs(in.small_integer("the tag of the physical group"));
        std::string_view name = in.rest_of_line();
        if (name.size() >= 2 && name.front() == '"' && name.back() == '"') name = name.substr(1, name.size() - 2);
        group.name = name;
        if (name.empty()) in.fail("physical group " + std::to_string(group.tag) + " has an empty name");
        mesh.groups.push_back(std::move(group));
    }
}

// Of MSH 4.1: only the physical groups matter here, not the bounding boxes and bounding entities.
void MshReader::entities() {
    if (!mesh.elements.empty()) in.fail("$Entities after $Elements");
    long long count[4] = {};
    in.next_line();
    for (long long& c : count) c = in.integer("the number of entities", 0, LLONG_MAX);
    in.end_of_line();
    for (int dim = 0; dim <= 3; ++dim)
        for (long long i = 0; i < count[dim]; ++i) {
            begin_record("$Entities", "entities of this dimension", i, count[dim]);
            RawEntity entity{dim, in.small_integer("the entity tag"), {}};
            for (int k = 0; k < (dim ? 6 : 3); ++k) in.real("a coordinate");
            const long long groups = in.integer("the number of physical tags", 0, LLONG_MAX);
            for (long long k = 0; k < groups; ++k)
                entity.physical.push_back(std::abs(in.small_integer("a physical tag")));
            in.rest_of_line();
            mesh.entities.push_back(std::move(entity));
        }
    std::stable_sort(mesh.entities.begin(), mesh.entities.end(), [](const RawEntity& a, const RawEntity& b) {
        return std::pair(a.dim, a.tag) < std::pair(b.dim, b.tag);
    });
}

int MshReader::physical_of(int dim, int entity) const {
    const RawEntity* found = find_entity(mesh, dim, entity);
    return found && !found->physical.empty() ? found->physical.front() : 0;
}

// `sorted` belongs to `items` (RawNode or RawElement).
template <class Item>
void MshReader::refuse_repeated(const char* what, const std::vector<IdAndIndex>& sorted,
                                const std::vector<Item>& items) const {
    const auto same_id = [](const IdAndIndex& a, const IdAndIndex& b) { return a.first == b.first; };
    const auto twice = std::adjacent_find(sorted.begin(), sorted.end(), same_id);
    if (twice != sorted.end())
        in.fail(items[twice[1].second].line, std::string(what) + " id " + std::to_string(twice->first) +
                                                 " is there twice, first in line " +
                                                 std::to_string(items[twice->second].line));
}

void MshReader::nodes() {
    if (!mesh.nodes.empty()) in.fail("a second $Nodes section");
    in.next_line();
    const long long blocks = mesh.msh_version == 41 ? in.integer("the number of blocks", 0, LLONG_MAX) : 1;
    const long long count = in.integer("the number of nodes", 1, INT_MAX);
    if (mesh.msh_version == 22) in.end_of_line();
    else in.rest_of_line();
    mesh.nodes.reserve(room_for(count));
    if (mesh.msh_version == 22) nodes_2_2(count);
    else nodes_4_1(blocks, count);
    std::vector<IdAndIndex> sorted = sorted_ids(mesh.nodes);
    refuse_repeated("node", sorted, mesh.nodes);
    index = IdIndex(std::move(sorted));
}

void MshReader::nodes_2_2(long long count) {
    for (long long i = 0; i < count; ++i) {
        begin_record("$Nodes", "nodes", i, count);
        RawNode node{in.integer("a node id", 1, LLONG_MAX), {}, in.line};
        for (double& x : node.x) x = in.real("a coordinate");
        in.end_of_line();
        mesh.nodes.push_back(node);
    }
}

void MshReader::nodes_4_1(long long blocks, long long count) {
    for (long long b = 0; b < blocks; ++b) {
        begin_record("$Nodes", "blocks", b, blocks);
        in.integer("the dimension of the entity", 0, 3);
        in.small_integer("the entity tag");
        const bool parametric = in.integer("0 or 1 (parametric)", 0, 1) == 1;
        const std::size_t begin = mesh.nodes.size();
        const auto in_block = static_cast<std::size_t>(
            in.integer("the number of nodes of this block", 0, count - static_cast<long long>(begin)));
        in.end_of_line();
        for (std::size_t i = 0; i < in_block; ++i) {
            begin_record("$Nodes", "nodes", static_cast<long long>(mesh.nodes.size()), count);
            mesh.nodes.push_back({in.integer("a node id", 1, LLONG_MAX), {}, in.line});
            in.end_of_line();
        }
        for (std::size_t i = begin; i < begin + in_block; ++i) {
            begin_record("$Nodes", "nodes with coordinates", static_cast<long long>(i), count);
            for (double& x : mesh.nodes[i].x) x = in.real("a coordinate");
            mesh.nodes[i].line = in.line;
            if (parametric) in.rest_of_line();
            in.end_of_line();
        }
    }
    if (static_cast<long long>(mesh.nodes.size()) != count)
        in.fail("$Nodes announces " + std::to_string(count) + " nodes, its blocks hold " +
                std::to_string(mesh.nodes.size()));
}

void MshReader::elements() {
    if (!mesh.elements.empty()) in.fail("a second $Elements section");
    if (mesh.nodes.empty()) in.fail("$Elements before $Nodes");
    in.next_line();
    const long long blocks = mesh.msh_version == 41 ? in.integer("the number of blocks", 0, LLONG_MAX) : 1;
    const long long count = in.integer("the number of elements", 1, INT_MAX);
    if (mesh.msh_version == 22) in.end_of_line();
    else in.rest_of_line();
    mesh.elements.reserve(room_for(count));
    if (mesh.msh_version == 22) elements_2_2(count);
    else elements_4_1(blocks, count);
    if (!foreign.empty()) refuse_foreign();
    refuse_repeated("element", sorted_ids(mesh.elements), mesh.elements);
}

// Counts what is none, to be refused together.
bool MshReader::is_simplex(int type, const SimplexType& simplex, long long count) {
    if (simplex.dim >= 0) return true;
    const auto same = std::find_if(foreign.begin(), foreign.end(), [&](const auto& f) { return f.type == type; });
    if (same == foreign.end()) foreign.push_back({type, in.line, count});
    else same->count += count;
    return false;
}

void MshReader::refuse_foreign() const {
    std::string what;
    for (const ForeignElements& f : foreign)
        what += (what.empty() ? "" : "; ") + std::to_string(f.count) + " " + foreign_type_name(f.type) + " of type " +
                std::to_string(f.type) + ", the first in line " + std::to_string(f.line);
    in.fail(foreign[0].line, what + ": only complete simplices of degree 1 to 7 are read");
}

void MshReader::element_node_ids(int count) {
    for (int k = 0; k < count; ++k) {
        const long long id = in.integer("a node id", 1, LLONG_MAX);
        const int node = index.find(id);
        if (node < 0) in.fail("the element has node " + std::to_string(id) + ", which is not in $Nodes");
        mesh.element_nodes.push_back(node);
    }
    in.end_of_line();
}

void MshReader::elements_2_2(long long count) {
    for (long long i = 0; i < count; ++i) {
        begin_record("$Elements", "elements", i, count);
        RawElement element{in.integer("an element id", 1, LLONG_MAX), mesh.element_nodes.size(), in.line, 0, 0, 0, 0};
        const int type = in.small_integer("an element type", 1);
        const SimplexType simplex = simplex_type(type);
        if (!is_simplex(type, simplex, 1)) {
            in.rest_of_line();
            continue;
        }
        element.dim = simplex.dim;
        element.degree = simplex.degree;
        const long long tags = in.integer("the number of tags", 0, INT_MAX);
        for (long long k = 0; k < tags; ++k) {
            const int tag = in.small_integer("a tag");
            if (k == 0) element.physical = std::abs(tag);
            if (k == 1) element.entity = tag;
        }
        element_node_ids(simplex.nodes);
        mesh.elements.push_back(element);
    }
}

void MshReader::elements_4_1(long long blocks, long long count) {
    long long done = 0;
    for (long long b = 0; b < blocks; ++b) {
        begin_record("$Elements", "blocks", b, blocks);
        const int dim = static_cast<int>(in.integer("the dimension of the entity", 0, 3));
        const int entity = in.small_integer("the entity tag");
        const int type = in.small_integer("an element type", 1);
        const SimplexType simplex = simplex_type(type);
        const long long in_block = in.integer("the number of elements of this block", 0, count - done);
        in.end_of_line();
        const bool wanted = is_simplex(type, simplex, in_block);
        if (wanted && simplex.dim != dim)
            in.fail("element type " + std::to_string(type) + " in an entity of dimension " + std::to_string(dim));
        const int physical = physical_of(dim, entity);
        for (long long i = 0; i < in_block; ++i, ++done) {
            begin_record("$Elements", "elements", done, count);
            if (!wanted) {
                in.rest_of_line();
                continue;
            }
            const long long id = in.integer("an element id", 1, LLONG_MAX);
            mesh.elements.push_back({id, mesh.element_nodes.size(), in.line, dim, simplex.degree, physical, entity});
            element_node_ids(simplex.nodes);
        }
    }
    if (done != count)
        in.fail("$Elements announces " + std::to_string(count) + " elements, its blocks hold " + std::to_string(done));
}

}  // namespace

RawMesh parse_msh(std::string_view text, const std::string& path) {
    MshReader reader{TextScanner(text, path), {}, {}, {}, false};
    reader.mesh.path = path;
    return reader.read();
}

RawMesh read_msh(const std::string& path) { return parse_msh(read_text_file(path), path); }

}  // namespace almesh
