// Section by section; each announces the number of its records, and every record is checked to be there. What a count
// allocates is bounded by the length of the rest of the text.
#include <algorithm>
#include <array>
#include <climits>
#include <cstdlib>
#include <utility>

#include "io/msh.hpp"
#include "io/text_scanner.hpp"

namespace almesh {
namespace {

struct ElementType {
    int number;
    int dim = -1;  // 0 to 3; -1: not a complete simplex of a degree up to max_degree
    int degree = 0, nodes = 0;
};

ElementType element_type(int number) {
    for (int dim = 0; dim <= 3; ++dim)
        for (int degree = 1; degree <= max_degree; ++degree)
            if (simplex(dim).msh_types[degree - 1] == number)
                return {number, dim, degree, simplex_node_count(dim, degree)};
    return {number};
}

// Element types that are not read, with what to do about them, by their numbers (GmshDefines.h).
const char* foreign_name(int type) {
    static const std::vector<std::pair<const char*, std::vector<std::array<int, 2>>>> foreign = {
        {"quadrangles (mesh without Recombine)", {{3, 3}, {10, 10}, {16, 16}, {36, 41}, {47, 51}, {57, 61}}},
        {"hexahedra (mesh without Recombine)", {{5, 5}, {12, 12}, {17, 17}, {92, 105}}},
        {"prisms (mesh without Recombine)", {{6, 6}, {13, 13}, {18, 18}, {90, 91}, {106, 117}}},
        {"pyramids (mesh without Recombine)", {{7, 7}, {14, 14}, {19, 19}, {118, 132}}},
        {"incomplete triangles (mesh with Mesh.SecondOrderIncomplete = 0)", {{20, 20}, {22, 22}, {24, 24}, {52, 56}}},
        {"incomplete tetrahedra (mesh with Mesh.SecondOrderIncomplete = 0)", {{79, 83}}},
        {"simplices of a degree above 7 (mesh with a lower Mesh.ElementOrder)", {{44, 46}, {64, 66}, {73, 75}}},
        {"elements of degree 0 (mesh with Mesh.ElementOrder = 1)", {{84, 89}}}};
    for (const auto& [name, ranges] : foreign)
        for (const auto& [first, last] : ranges)
            if (first <= type && type <= last) return name;
    return "elements of an unknown kind";
}

struct ForeignElements {
    int type, line;
    long long count;
};

struct MshReader {
    TextScanner in;
    RawMesh mesh;  // msh_version 0: not known yet
    IdIndex node_index{}, element_index{};
    ElementType type{0};  // of the element or block being read
    std::vector<ForeignElements> foreign{};

    bool in_blocks() const { return mesh.msh_version == 41; }

    RawMesh read() {
        while (in.next_line()) section();
        if (!mesh.msh_version) in.fail("not a Gmsh mesh file: there is no $MeshFormat section");
        if (mesh.nodes.empty()) in.fail("there is no $Nodes section");
        if (mesh.elements.empty()) in.fail("there is no $Elements section");
        return std::move(mesh);
    }

    void section() {
        const int line = in.line;
        const std::string name(in.rest_of_line()), end = "$End" + name.substr(std::min<std::size_t>(1, name.size()));
        if (!mesh.msh_version && name != "$MeshFormat" && name != "$Comments")
            in.fail("not a Gmsh mesh file of version 2.2 or 4.1: it has to begin with $MeshFormat");
        if (name.size() < 2 || name[0] != '$' || name.starts_with("$End"))
            in.fail("expected a section such as $Nodes, got `", name.substr(0, 40), "`");
        if (name == "$MeshFormat") format();
        else if (name == "$PhysicalNames") physical_names();
        else if (name == "$Entities") entities();
        else if (name == "$Nodes") nodes();
        else if (name == "$Elements") elements();
        else if (name == "$PartitionedEntities") in.fail("a partitioned mesh is not read: save it in one part");
        else if (name == "$ParametricNodes")
            in.fail("parametric nodes are not read: save the mesh without -parametric");
        else skip_section(end);
        if (!in.next_line()) in.fail_at(line, "the file is cut off: ", name, " has no ", end);
        if (in.rest_of_line() != end) in.fail("expected ", end, ": ", name, " holds more than it announces");
    }

    // Goes to the last line of the section, or the end of the file.
    void skip_section(const std::string& end) {
        while (in.next_line()) {
            const char* const begin = in.at;
            if (in.rest_of_line() != end) continue;
            in.at = begin;
            return;
        }
    }

    // Goes to record `done` (from 0) of `count`.
    void begin_record(const char* section, const char* what, long long done, long long count) {
        if (in.next_line() && *in.at != '$') return;
        const std::string where = in.at == in.end ? "the file is cut off" : in.word() + " comes too early";
        in.fail(where, ": ", section, " announces ", count, " ", what, ", only ", done, " are there");
    }

    void check_total(const std::string& section, const char* what, long long found, long long count) const {
        if (found != count) in.fail(section, " announces ", count, " ", what, ", its blocks hold ", found);
    }

    void format() {
        if (mesh.msh_version) in.fail("a second $MeshFormat section");
        if (!in.next_line()) in.fail("the file is cut off after $MeshFormat");
        const std::string shown = in.word();
        const double version = in.real("the format version");
        if (version != 2.2 && version != 4.1)
            in.fail("format version ", shown, ": only 2.2 and 4.1 are read (gmsh -0 IN.msh -format msh41 -o OUT.msh)");
        mesh.msh_version = version == 2.2 ? 22 : 41;
        if (in.small_integer("0 (ASCII)") != 0)
            in.fail("a binary mesh is not read: save it in ASCII (gmsh without -bin)");
        in.small_integer("the size of a number");
        in.end_of_line();
    }

    void physical_names() {
        in.next_line();
        const long long count = in.integer("the number of physical names", 0, LLONG_MAX);
        in.end_of_line();
        for (long long i = 0; i < count; ++i) {
            begin_record("$PhysicalNames", "names", i, count);
            PhysicalGroup group;
            group.dim = in.small_integer("the dimension of the physical group", 0, 3);
            group.tag = std::abs(in.small_integer("the tag of the physical group"));
            std::string_view name = in.rest_of_line();
            if (name.size() >= 2 && name.front() == '"' && name.back() == '"') name = name.substr(1, name.size() - 2);
            group.name = name;
            if (name.empty()) in.fail("physical group ", group.tag, " has an empty name");
            mesh.groups.push_back(std::move(group));
        }
    }

    // MSH 4.1 only. The physical groups are kept, not the bounding boxes and bounding entities.
    void entities() {
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
        std::ranges::stable_sort(mesh.entities, {}, [](const RawEntity& e) { return std::pair(e.dim, e.tag); });
    }

    // Begins $Nodes or $Elements: returns the numbers of blocks and of items. MSH 2.2 has no blocks: all are in one.
    template <class Item>
    std::pair<long long, long long> begin_items(std::vector<Item>& items, IdIndex& index, const std::string& section,
                                                const char* what) {
        if (!items.empty()) in.fail("a second ", section, " section");
        in.next_line();
        const long long blocks = in_blocks() ? in.integer("the number of blocks", 0, LLONG_MAX) : 1;
        const long long count = in.integer(what, 1, INT_MAX);
        if (in_blocks()) in.rest_of_line();
        else in.end_of_line();
        // The count may be wrong: a record has at least four characters.
        const auto room = static_cast<std::size_t>(std::min<long long>(count, (in.end - in.at) / 4));
        items.reserve(room);
        index = IdIndex(room);
        return {blocks, count};
    }

    template <class Item>  // RawNode or RawElement
    void append(std::vector<Item>& items, IdIndex& index, const char* what, const Item& item) {
        const int earlier = index.insert(item.id, static_cast<int>(items.size()));
        if (earlier >= 0) in.fail(what, " id ", item.id, " is there twice, first in line ", items[earlier].line);
        items.push_back(item);
    }

    void nodes() {
        const auto [blocks, count] = begin_items(mesh.nodes, node_index, "$Nodes", "the number of nodes");
        for (long long b = 0; b < blocks; ++b) {
            const auto begin = static_cast<long long>(mesh.nodes.size());
            long long end = count;
            bool parametric = false;
            if (in_blocks()) {
                begin_record("$Nodes", "blocks", b, blocks);
                in.integer("the dimension of the entity", 0, 3);
                in.small_integer("the entity tag");
                parametric = in.integer("0 or 1 (parametric)", 0, 1) == 1;
                end = begin + in.integer("the number of nodes of this block", 0, count - begin);
                in.end_of_line();
            }
            for (long long i = begin; i < end; ++i) {
                begin_record("$Nodes", "nodes", i, count);
                append(mesh.nodes, node_index, "node", {in.integer("a node id", 1, LLONG_MAX), {}, in.line});
                if (!in_blocks()) read_position(mesh.nodes.back());
                in.end_of_line();
            }
            for (long long i = begin; in_blocks() && i < end; ++i) {  // the positions follow all ids of the block
                begin_record("$Nodes", "nodes with coordinates", i, count);
                read_position(mesh.nodes[i]);
                if (parametric) in.rest_of_line();
                in.end_of_line();
            }
        }
        check_total("$Nodes", "nodes", static_cast<long long>(mesh.nodes.size()), count);
    }

    void read_position(RawNode& node) {
        node.line = in.line;
        for (double& x : node.x) x = in.real("a coordinate");
    }

    void elements() {
        if (mesh.nodes.empty()) in.fail("$Elements before $Nodes");
        const auto [blocks, count] = begin_items(mesh.elements, element_index, "$Elements", "the number of elements");
        long long done = 0;
        for (long long b = 0; b < blocks; ++b) {
            RawElement element{};
            long long end = count;
            if (in_blocks()) {
                begin_record("$Elements", "blocks", b, blocks);
                end = done + begin_element_block(element, count - done);
            }
            for (; done < end; ++done) {
                begin_record("$Elements", "elements", done, count);
                element.line = in.line;
                element.id = in.integer("an element id", 1, LLONG_MAX);
                if (!in_blocks()) read_type_and_tags(element);
                if (type.dim < 0) {
                    in.rest_of_line();
                    continue;
                }
                element.first = mesh.element_nodes.size();
                element.dim = type.dim;
                element.degree = type.degree;
                append(mesh.elements, element_index, "element", element);
                for (int k = 0; k < type.nodes; ++k) mesh.element_nodes.push_back(read_node_of_element());
                in.end_of_line();
            }
        }
        check_total("$Elements", "elements", done, count);
        if (!foreign.empty()) refuse_foreign();
    }

    // MSH 4.1: what the elements of a block share. Returns their number.
    long long begin_element_block(RawElement& element, long long most) {
        const int dim = in.small_integer("the dimension of the entity", 0, 3);
        element.entity = in.small_integer("the entity tag");
        read_element_type();
        const long long count = in.integer("the number of elements of this block", 0, most);
        in.end_of_line();
        if (type.dim < 0) add_foreign(count);
        else if (type.dim != dim) in.fail("element type ", type.number, " in an entity of dimension ", dim);
        const RawEntity* const listed = find_entity(mesh, dim, element.entity);
        if (listed && !listed->physical.empty()) element.physical = listed->physical.front();
        return count;
    }

    // MSH 2.2: the tags of an element are those of its physical group, of its entity, and others.
    void read_type_and_tags(RawElement& element) {
        read_element_type();
        if (type.dim < 0) return add_foreign(1);
        element.physical = element.entity = 0;
        const long long tags = in.integer("the number of tags", 0, INT_MAX);
        for (long long k = 0; k < tags; ++k) {
            const int tag = in.small_integer("a tag");
            if (k == 0) element.physical = std::abs(tag);
            if (k == 1) element.entity = tag;
        }
    }

    // Most elements have the type of the one before.
    void read_element_type() {
        const int number = in.small_integer("an element type", 1);
        if (number != type.number) type = element_type(number);
    }

    int read_node_of_element() {
        const long long id = in.integer("a node id", 1, LLONG_MAX);
        const int node = node_index.find(id);
        if (node < 0) in.fail("the element has node ", id, ", which is not in $Nodes");
        return node;
    }

    // Elements of other types are counted, to be refused all together.
    void add_foreign(long long count) {
        const auto same = std::ranges::find(foreign, type.number, &ForeignElements::type);
        if (same == foreign.end()) foreign.push_back({type.number, in.line, count});
        else same->count += count;
    }

    void refuse_foreign() const {
        std::string what;
        for (const ForeignElements& f : foreign)
            what += concat(what.empty() ? "" : "; ", f.count, " ", foreign_name(f.type), " of type ", f.type,
                           ", the first in line ", f.line);
        in.fail_at(foreign[0].line, what, ": only complete simplices of degree 1 to 7 are read");
    }
};

}  // namespace

bool looks_like_msh(std::string_view text) {
    text.remove_prefix(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
    return text.starts_with("$MeshFormat") || text.starts_with("$Comments");
}

RawMesh parse_msh(std::string_view text, const std::string& path) {
    MshReader reader{TextScanner(text, path), {}};
    reader.mesh.path = path;
    reader.mesh.msh_version = 0;
    return reader.read();
}

}  // namespace almesh
