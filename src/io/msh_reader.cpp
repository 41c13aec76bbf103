// Section by section; each announces the number of its records, and every record is checked to be there. What a count
// allocates is bounded by the length of the rest of the file.
#include <algorithm>
#include <climits>
#include <optional>
#include <set>
#include <utility>

#include "io/foreign_cells.hpp"
#include "io/msh.hpp"
#include "io/msh_scanner.hpp"

namespace almesh {
namespace {

struct MshReader {
    MshScanner in;
    RawMesh mesh{};
    IdIndex node_index{}, element_index{};
    MshType type{0};  // of the element or block being read
    ForeignMshElements foreign{};
    bool has_dimensions = true;  // of groups beside their names, which MSH 2.0 may not have: a name is for all then
    std::optional<MshScanner> at_periodic{};  // where $Periodic is

    bool in_blocks() const { return in.version >= 40; }
    int line() const { return in.binary ? 0 : in.line; }

    RawMesh read() {
        while (in.next_line()) section();
        in.part = "the end";
        if (!in.version) in.fail("not a Gmsh mesh file: there is no $MeshFormat section");
        if (mesh.nodes.empty()) in.fail("there is no $Nodes section");
        if (mesh.elements.empty()) in.fail("there is no $Elements section");
        if (in.binary) mesh.coordinates.form = CoordinateFields::Form::float64;
        mesh.coordinates.order = in.order;
        name_entities();
        if (at_periodic) read_periodic(*at_periodic, node_index, mesh);
        mesh.format = {".msh", in.version, in.binary};
        return std::move(mesh);
    }

    void section() {
        const int first_line = in.line;
        const std::string name(in.rest_of_line()), rest = name.substr(std::min<std::size_t>(1, name.size()));
        if (name == "$NOD" && !in.version) in.version = 10;
        const std::string end = (in.version == 10 ? "$END" : "$End") + rest;
        if (!in.version && name != "$MeshFormat" && name != "$Comments")
            in.fail("not a Gmsh mesh file of version 1, 2.2, 4.0 or 4.1: it has to begin with $MeshFormat or $NOD");
        if (rest.empty() || name[0] != '$' || rest.starts_with("End") || rest.starts_with("END") ||
            rest.find('\0') != rest.npos)
            in.fail("expected a section such as $Nodes, got ", in_backquotes(name));
        in.part = name;
        if (name == "$MeshFormat") format();
        else if (name == "$PhysicalNames") physical_names();
        else if (name == "$Entities") entities();
        else if (name == "$Nodes" || name == "$ParametricNodes" || name == "$NOD") nodes(name);
        else if (name == "$Elements" || name == "$ELM") elements();
        else if (name == "$PartitionedEntities") partitioned_entities();
        else {
            if (name == "$Periodic") at_periodic.emplace(in);
            skip_section(end);
        }
        if (!in.next_line()) {
            const std::string message = concat("the file is cut off: ", name, " has no ", end);
            in.binary ? in.fail(message) : in.fail_at(first_line, message);
        }
        if (in.rest_of_line() != end) in.fail("expected ", end, ": ", name, " holds more than it announces");
        static const std::set<std::string> of_mesh = {"$MeshFormat", "$PhysicalNames", "$Entities", "$Comments", "$NOD",
                                                      "$Nodes", "$ParametricNodes", "$Elements", "$ELM"};
        if (!of_mesh.contains(name)) mesh.sections.push_back(name);
    }

    // Of the elements and their faces, where the file has no physical group of their dimension.
    void name_entities() {
        constexpr const char* kinds[] = {"point", "curve", "surface", "volume"};
        std::array<bool, 4> has_groups{};
        int top = 0;
        std::set<std::array<int, 2>> tags, groups;  // dimension and tag
        for (const RawElement& element : mesh.elements) {
            if (element.physical) groups.insert({element.dim, element.physical});
            top = std::max(top, element.dim);
        }
        if (!has_dimensions)
            std::erase_if(mesh.groups, [&](const auto& group) { return !groups.contains({group.dim, group.tag}); });
        for (const PhysicalGroup& group : mesh.groups) groups.insert({group.dim, group.tag});
        for (const auto& [dim, tag] : groups) has_groups[dim] = true;
        for (RawElement& element : mesh.elements)
            if (!has_groups[element.dim] && element.dim >= std::max(top - 1, 1) && element.entity > 0)
                tags.insert({element.dim, element.physical = element.entity});
        for (const auto& [dim, tag] : tags) mesh.groups.push_back({dim, tag, concat(kinds[dim], " ", tag), true});
    }

    // Goes to the last line of the section, or the end of the file.
    void skip_section(const std::string& end) {
        if (in.binary) return in.find_line(end);
        while (in.next_line()) {
            const char* const begin = in.at;
            if (in.rest_of_line() != end) continue;
            in.at = begin;
            return;
        }
    }

    // Goes to record `done` (from 0) of `count`, which in a binary file follows at once.
    void begin_record(const char* what, long long done, long long count) {
        if (!in.binary) begin_line(what, done, count);
    }

    void begin_line(const char* what, long long done, long long count) {
        if (in.next_line() && *in.at != '$') return;
        const std::string where = in.at == in.end ? "the file is cut off" : in.word() + " comes too early";
        in.fail(where, ": ", in.part, " announces ", count, " ", what, ", only ", done, " are there");
    }

    void check_total(const char* what, long long found, long long count) const {
        if (found != count) in.fail(in.part, " announces ", count, " ", what, ", its blocks hold ", found);
    }

    void format() {
        if (in.version) in.fail("a second $MeshFormat section");
        if (!in.next_line()) in.fail("the file is cut off after $MeshFormat");
        const std::string shown = in.word();
        const double version = in.text().real("the format version");
        if (version != 2 && version != 2.1 && version != 2.2 && version != 4.0 && version != 4.1)
            in.fail("format version ", shown,
                    ": only 1, 2 to 2.2, 4.0 and 4.1 are read (gmsh -0 IN.msh -format msh41 -o OUT.msh)");
        in.version = version < 4 ? 22 : version == 4.0 ? 40 : 41;
        const bool binary = in.integer("0 (ASCII) or 1 (binary)", 0, 1) == 1;
        const int bytes = in.integer("the size of a number");
        in.end_of_line();
        if (!binary) return;
        if (bytes != 8 && (bytes != 4 || in.version < 41))
            in.fail("numbers of ", bytes, " bytes: only those of 8 are read, in MSH 4.1 also of 4");
        in.size_bytes = bytes;
        in.binary = true;
        in.begin_numbers();
        find_byte_order();
    }

    // A 1 as int stands in the file for that.
    void find_byte_order() {
        const char* const begin = in.at;
        for (const std::endian order : {std::endian::little, std::endian::big}) {
            in.at = begin;
            in.order = order;
            if (in.integer("the number 1") == 1) return;
        }
        in.at = begin;
        in.fail("expected the number 1 in four bytes, by which the order of bytes is told");
    }

    void physical_names() {  // text in every file
        in.next_line();
        const long long count = in.text().integer("the number of physical names", 0, LLONG_MAX);
        in.end_of_line();
        for (long long i = 0; i < count; ++i) {
            begin_line("names", i, count);
            const char* const row = in.at;
            in.small_integer("the dimension of the physical group");
            const bool has_dimension = in.at_line_end() || *in.at != '"';
            in.at = row;
            const int dim = has_dimension ? in.small_integer("the dimension of the physical group", 0, 3) : 0;
            const int tag = std::abs(in.small_integer("the tag of the physical group"));
            std::string_view name = in.rest_as_name();
            if (name.size() >= 2 && name.front() == '"' && name.back() == '"') name = name.substr(1, name.size() - 2);
            if (name.empty()) in.fail("physical group ", tag, " has an empty name");
            for (int d = dim; d <= (has_dimension ? dim : 3); ++d) mesh.groups.push_back({d, tag, std::string(name)});
            has_dimensions = has_dimensions && has_dimension;
        }
    }

    void entities() {  // MSH 4
        if (!mesh.elements.empty()) in.fail("$Entities after $Elements");
        in.begin_numbers();
        read_entities(false);
    }

    void read_entities(bool are_partitioned) {
        long long count[4] = {};
        for (long long& c : count) c = in.size("the number of entities", 0, LLONG_MAX);
        in.end_of_record();
        for (int dim = 0; dim <= 3; ++dim)
            for (long long i = 0; i < count[dim]; ++i) {
                begin_record("entities of this dimension", i, count[dim]);
                mesh.entities.push_back(entity(dim, are_partitioned));
            }
        std::stable_sort(mesh.entities.begin(), mesh.entities.end(), is_before);
    }

    // MSH 4: the pieces of entities that a partition has, with the physical groups of these.
    void partitioned_entities() {
        if (!in_blocks() || !mesh.elements.empty()) in.fail("it belongs into MSH 4, before $Nodes");
        in.begin_numbers();
        in.size("the number of partitions", 0, LLONG_MAX);
        in.end_of_record();
        begin_record("ghost entities", 0, 1);
        const long long ghosts = in.size("the number of ghost entities", 0, LLONG_MAX);
        in.end_of_record();
        for (long long k = 0; k < ghosts; ++k) {
            begin_record("ghost entities", k, ghosts);
            in.integer("the tag of a ghost entity");
            in.integer("a partition");
            in.end_of_record();
        }
        begin_record("entities", 0, 1);
        read_entities(true);
    }

    // A point has a box from version 4.1 on no more.
    FileEntity entity(int dim, bool is_partitioned) {
        FileEntity entity{{dim, in.integer("the entity tag")}};
        if (is_partitioned) {
            in.integer("the dimension of the parent");
            in.integer("the tag of the parent");
            const long long partitions = in.size("the number of partitions", 0, LLONG_MAX);
            for (long long k = 0; k < partitions; ++k) in.integer("a partition");
        }
        for (int k = 0; k < (dim == 0 && in.version == 41 ? 3 : 6); ++k) in.real("a coordinate");
        const long long groups = in.size("the number of physical tags", 0, LLONG_MAX);
        for (long long k = 0; k < groups; ++k) entity.physical.push_back(std::abs(in.integer("a physical tag")));
        if (dim > 0 && (in.binary || !in.at_line_end())) {
            const long long bounds = in.size("the number of bounding entities", 0, LLONG_MAX);
            for (long long k = 0; k < bounds; ++k) in.integer("a bounding entity");
        }
        if (!in.binary) in.rest_of_line();
        return entity;
    }

    // Begins $Nodes or $Elements: returns the numbers of blocks and of items. MSH 2.2 has no blocks: all are in one.
    // bytes: of an item at least.
    template <class Item>
    std::pair<long long, long long> begin_items(std::vector<Item>& items, IdIndex& index, const char* what, int bytes) {
        if (!items.empty()) in.fail("a second ", in.part, " section");
        long long blocks = 1, count = 0;
        const std::string number = concat("the number of ", what);
        if (in_blocks()) {
            in.begin_numbers();
            blocks = in.size("the number of blocks", 0, LLONG_MAX);
            count = in.size(number.c_str(), 1, INT_MAX);
            for (int k = 0; in.binary && in.version == 41 && k < 2; ++k) in.size("a least or largest id", 0, LLONG_MAX);
            if (!in.binary) in.rest_of_line();
        } else {
            in.next_line();
            count = in.text().integer(number.c_str(), 1, INT_MAX);
            in.end_of_line();
            if (in.binary) in.begin_numbers();
        }
        const long long room = (in.end - in.at) / bytes;
        if (in.binary && room < count)
            in.fail("the file is cut off: ", in.part, " announces ", count, " ", what, " of at least ", bytes,
                    " bytes, ", in.end - in.at, " bytes are left");
        items.reserve(static_cast<std::size_t>(std::min(count, room)));
        index = IdIndex(items.capacity());
        return {blocks, count};
    }

    template <class Item>  // RawNode or RawElement
    void append(std::vector<Item>& items, IdIndex& index, const char* what, const Item& item) {
        const int earlier = index.insert(item.id, static_cast<int>(items.size()));
        if (earlier >= 0)
            in.fail(what, " id ", item.id, " is there twice",
                    in.binary ? "" : concat(", first in line ", items[earlier].line));
        items.push_back(item);
    }

    // $ParametricNodes is what MSH 2.2 calls $Nodes with parameters, of which the first two are the entity.
    void nodes(const std::string& section) {
        if (in_blocks() && section != "$Nodes") in.fail("parametric nodes of MSH 4 are in $Nodes");
        const auto [blocks, count] = begin_items(mesh.nodes, node_index, "nodes", in.id_bytes() + 3 * in.real_bytes());
        if (!in_blocks()) return nodes_with_ids(count, count, {section == "$ParametricNodes", -1});
        for (long long b = 0; b < blocks; ++b) {
            begin_record("blocks", b, blocks);
            node_block(count);
        }
        check_total("nodes", static_cast<long long>(mesh.nodes.size()), count);
    }

    void node_block(long long count) {
        const auto begin = static_cast<long long>(mesh.nodes.size());
        EntityKey entity;
        if (in.version == 40) entity.tag = in.integer("the entity tag");
        entity.dim = in.integer("the dimension of the entity", 0, 3);
        if (in.version == 41) entity.tag = in.integer("the entity tag");
        const Parameters parameters{in.integer("0 or 1 (parametric)", 0, 1) == 1, entity.dim};
        const long long end = begin + in.size("the number of nodes of this block", 0, count - begin);
        in.end_of_record();
        if (in.version == 40) return nodes_with_ids(end, count, parameters);
        for (long long i = begin; i < end; ++i) {
            begin_record("nodes", i, count);
            append(mesh.nodes, node_index, "node", {in.id("a node id"), {}, line()});
            in.end_of_record();
        }
        for (long long i = begin; i < end; ++i) {  // the positions follow all ids of the block
            begin_record("nodes with coordinates", i, count);
            read_position(mesh.nodes[i], parameters);
        }
    }

    // Of a node on its curve or surface: as many as the dimension; dim -1: the dimension stands with them. Not kept.
    struct Parameters {
        bool are_there;
        int dim;
    };

    // Up to node `end` of `count`, each id with its position.
    void nodes_with_ids(long long end, long long count, Parameters parameters) {
        for (auto i = static_cast<long long>(mesh.nodes.size()); i < end; ++i) {
            begin_record("nodes", i, count);
            append(mesh.nodes, node_index, "node", {in.id("a node id"), {}, line()});
            read_position(mesh.nodes.back(), parameters);
        }
    }

    void read_position(RawNode& node, Parameters parameters) {
        node.line = line();
        for (double& x : node.x) {
            mesh.coordinates.first.push_back(in.next_byte());
            x = in.real("a coordinate");
        }
        if (parameters.are_there && parameters.dim < 0) {
            parameters.dim = in.integer("the dimension of the entity", 0, 3) % 3;  // nodes of a volume have none
            in.integer("the entity tag");
        }
        if (parameters.are_there) in.skip_reals(parameters.dim);
        in.end_of_record();
    }

    void elements() {
        if (mesh.nodes.empty()) in.fail("$Elements before $Nodes");
        const auto [blocks, count] = begin_items(mesh.elements, element_index, "elements", 2 * in.id_bytes());
        long long done = 0;
        if (in_blocks()) {
            for (long long b = 0; b < blocks; ++b) {
                begin_record("blocks", b, blocks);
                element_block(done, count);
            }
            check_total("elements", done, count);
        } else if (in.binary) {
            while (done < count) element_run(done, count);
        } else {
            for (; done < count; ++done) element_line(done, count);
        }
        if (!foreign.kinds.empty()) in.fail_at(foreign.kinds[0].line, foreign.message());
    }

    // MSH 4: elements of an entity and of one type. done: of all `count` elements.
    void element_block(long long& done, long long count) {
        RawElement element{};
        int dim = 0;
        if (in.version == 40) element.entity = in.integer("the entity tag");
        dim = in.integer("the dimension of the entity", 0, 3);
        if (in.version == 41) element.entity = in.integer("the entity tag");
        read_element_type();
        const long long end = done + in.size("the number of elements of this block", 0, count - done);
        in.end_of_record();
        if (!type.cell) add_foreign(end - done);
        else if (type.cell->dim != dim) in.fail("element type ", type.number, " in an entity of dimension ", dim);
        const FileEntity* const listed = find_entity(mesh.entities, dim, element.entity);
        if (listed && !listed->physical.empty()) element.physical = listed->physical.front();
        for (; done < end; ++done) {
            begin_record("elements", done, count);
            element.line = line();
            element.id = in.id("an element id");
            finish_element(element);
        }
    }

    // MSH 2.2, binary: elements of one type with the same number of tags.
    void element_run(long long& done, long long count) {
        read_element_type();
        const int size = in.integer("the number of elements of this type", 1, static_cast<int>(count - done));
        const int tags = in.integer("the number of tags", 0);
        if (!type.cell) add_foreign(size);
        for (const long long end = done + size; done < end; ++done) {
            RawElement element{};
            element.id = in.id("an element id");
            read_tags(element, tags);
            finish_element(element);
        }
    }

    // MSH 1 and 2.2, ASCII.
    void element_line(long long done, long long count) {
        begin_record("elements", done, count);
        RawElement element{};
        element.line = line();
        element.id = in.id("an element id");
        read_element_type();
        if (!type.cell) add_foreign(1);
        else if (in.version > 10) read_tags(element, in.integer("the number of tags", 0));
        else {
            read_tags(element, 2);
            if (in.integer("the number of nodes") != type.nodes)
                in.fail("an element of this type has ", type.nodes, " nodes");
        }
        finish_element(element);
    }

    // MSH 2.2: the tags of an element are those of its physical group, of its entity, and others.
    void read_tags(RawElement& element, int count) {
        for (int k = 0; k < count; ++k) {
            const int tag = in.integer("a tag");
            if (k == 0) element.physical = std::abs(tag);
            if (k == 1) element.entity = tag;
        }
    }

    void finish_element(RawElement& element) {
        if (!type.cell) {
            in.rest_of_line();
            return;
        }
        element.first = mesh.element_nodes.size();
        element.dim = type.cell->dim;
        element.type = type.cell;
        element.degree = type.degree;
        append(mesh.elements, element_index, "element", element);
        for (int k = 0; k < type.nodes; ++k) {
            const long long id = in.id("a node id");
            mesh.element_nodes.push_back(node_index.find(id));
            if (mesh.element_nodes.back() < 0) in.fail("the element has node ", id, ", which is not in $Nodes");
        }
        mesh.element_nodes.resize(element.first + element.node_count(), -1);
        in.end_of_record();
    }

    // Most elements have the type of the one before.
    void read_element_type() {
        const int number = in.integer("an element type", 1);
        if (number != type.number) type = msh_type(number);
    }

    // To be refused all together; in a binary file at once, as their length is not known.
    void add_foreign(long long count) {
        foreign.add(type.number, line(), count);
        if (in.binary) in.fail(foreign.message());
    }
};

}  // namespace

bool looks_like_msh(std::string_view text) {
    text.remove_prefix(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
    return text.starts_with("$MeshFormat") || text.starts_with("$Comments") || text.starts_with("$NOD");
}

RawMesh parse_msh(std::string_view text, const std::string& path) {
    MshReader reader{MshScanner(text, path)};
    reader.mesh.path = path;
    return reader.read();
}

}  // namespace almesh
