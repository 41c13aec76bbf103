// Lines of keywords, which begin with *, and lines of data after each. A set is resolved where it stands, after what it
// names; surfaces are once all is read.
#include <cctype>
#include <filesystem>
#include <map>
#include <set>

#include "base/files.hpp"
#include "io/foreign_cells.hpp"
#include "io/foreign_formats.hpp"
#include "io/named_groups.hpp"
#include "io/text_scanner.hpp"

namespace almesh {
namespace {

std::string capitals(std::string_view text) {
    std::string result;
    for (const char c : text)
        if (!std::isspace(static_cast<unsigned char>(c))) result += static_cast<char>(std::toupper(c));
    return result;
}

struct InpType {
    int dim = 0;  // of its family; 0: of no solids, shells or beams
    const CellType* cell = nullptr;
    int degree = 0, nodes = 0;
    bool is_shell = false;
    std::vector<int> order{};  // of its nodes, in those of Gmsh
};

// By its name in capitals: a family, the number of nodes, letters of the formulation.
InpType type_of(std::string_view name) {
    static const std::map<std::string_view, int> families = {
        {"C3D", 3}, {"DC3D", 3}, {"DCC3D", 3}, {"AC3D", 3}, {"F3D", 3}, {"SC", 3}, {"CPS", 2}, {"CPE", 2}, {"CPEG", 2},
        {"CAX", 2}, {"CGAX", 2}, {"DC2D", 2}, {"DCAX", 2}, {"AC2D", 2}, {"ACAX", 2}, {"S", 2}, {"STRI", 2}, {"DS", 2},
        {"M3D", 2}, {"SFM3D", 2}, {"R3D", 2}, {"T2D", 1}, {"T3D", 1}, {"B2", 1}, {"B3", 1}};
    const auto is_digit = [&](std::size_t k) { return k < name.size() && name[k] >= '0' && name[k] <= '9'; };
    for (const auto& [family, dim] : families) {
        if (!name.starts_with(family) || !is_digit(family.size())) continue;
        const bool two_digits = dim == 3 && is_digit(family.size() + 1);
        int nodes = *parse_int(name.substr(family.size(), two_digits ? 2 : 1));
        if (family[0] == 'B') nodes = nodes == 2 ? 3 : 2;
        InpType type{dim, nullptr, 1, nodes, dim == 2 && family.find('C') == family.npos};
        for (const CellType& cell : cell_types())
            for (const int degree : {1, 2})
                if (cell.dim == dim && cell.node_count(degree) == nodes && (degree == 1 || nodes < 11))
                    type.cell = &cell, type.degree = degree;
        for (const SerendipityCell& kind : serendipity_cells())
            if (kind.cell->dim == dim && kind.nodes() == nodes && (dim == 2 || nodes > 8))
                type.cell = kind.cell, type.degree = 2;
        if (name.find('V') != name.npos) type.cell = nullptr;  // with nodes in the middle of some faces
        if (type.cell) type.order = vtk_node_order(*type.cell, type.degree, type.cell == &prism());
        if (dim == 1 && nodes == 3) type.order = {0, 2, 1};
        return type;
    }
    return {};
}

// Where side S1, S2, ... of Abaqus is in CellType::faces; -1: there is none.
int side_of(const CellType& cell, int number) {
    static const std::map<const CellType*, std::vector<int>> sides = {
        {&simplex(2), {2, 0, 1}}, {&quadrilateral(), {0, 1, 2, 3}}, {&simplex(3), {3, 2, 0, 1}},
        {&hexahedron(), {0, 5, 1, 3, 4, 2}}, {&prism(), {0, 1, 2, 4, 3}}, {&pyramid(), {4, 0, 2, 3, 1}}};
    const std::vector<int>& of = sides.at(&cell);
    return number >= 1 && number <= static_cast<int>(of.size()) ? of[number - 1] : -1;
}

struct InpReader {
    // A file, the main one or an included one.
    struct File {
        std::string path;
        std::string_view text;
        bool is_main;
        int line = 0;

        template <class... Parts>
        [[noreturn]] void fail(const Parts&... message) const {
            throw InputError(path, ":", line, ": ", message...);
        }
    };
    // Named in any case, spelled as at first. ids: numbers in the file.
    struct Set {
        std::string name;
        std::vector<int> ids{};
    };
    struct Surface {
        std::string name, label, where;
        std::vector<int> ids;
    };
    using Sets = std::map<std::string, Set>;  // by name in capitals

    RawMesh mesh{};
    IdIndex nodes, elements{};
    std::vector<std::string> open{};  // files that are being read
    Sets node_sets{}, element_sets{};
    std::vector<Surface> surfaces{};
    std::set<std::string> types{}, passed_over{}, refused{};  // of elements
    std::map<std::string, std::string> parameters{};  // of the keyword, names in capitals
    std::string keyword{};                            // "" where its data are passed over
    InpType type{};                                   // of the keyword
    Set* set = nullptr;                               // of the keyword
    int missing = 0;                                  // nodes of the last element that are in further lines
    int parts = 0, instances = 0, depth = 0;          // depth: inside of a part or an instance
    std::set<int> shells{};                           // numbers of elements
    int largest_id = 0;                               // of nodes and elements
    bool includes_nodes = false;
    int longest = 0;                                  // characters of a coordinate
    int left_out = 3;                                 // first coordinate that some node does not have

    RawMesh read(std::string_view text, const std::string& path) {
        mesh.path = path;
        read_lines({path, text, true});
        if (!refused.empty())
            throw InputError(path, ": elements of type ", list_of(refused), ": only ", readable_cells(), " of 3, 4, 6, "
                             "8 or 9 nodes in the plane and of 4, 5, 6, 8, 10, 15 or 20 in space are read");
        const int dim = select();
        const std::size_t file_nodes = mesh.nodes.size();
        complete_serendipity(mesh);
        NamedGroups groups(mesh);
        for (const auto& [key, of] : element_sets)
            for (const int id : of.ids)
                if (const int e = elements.find(id); e >= 0) groups.add(of.name, e);
        for (const Surface& surface : surfaces) add_surface(surface, dim, groups);
        NamedGroups::NodeSets by_nodes;
        for (const auto& [key, of] : node_sets) {
            by_nodes.push_back({of.name, {}});
            for (const int id : of.ids)
                if (const int node = nodes.find(id); node >= 0) by_nodes.back().second.push_back(node);
        }
        if (std::all_of(mesh.groups.begin(), mesh.groups.end(), [dim](const auto& group) { return group.dim == dim; }))
            groups.add_sides(by_nodes, file_nodes);
        groups.finish();
        constexpr int most = 20;  // characters of a number that both programs read
        if (longest <= most) mesh.coordinates.most = most;
        else mesh.notes.push_back("coordinates have more than 20 characters: Abaqus and CalculiX read the first ones");
        if (includes_nodes || left_out < dim) {
            mesh.coordinates.first.clear();
            mesh.notes.push_back(includes_nodes ? "its nodes are in included files, which are not written again: give "
                                                  "the file of the nodes itself"
                                                : "coordinates that are left out as 0 cannot be written as others");
        }
        if (!passed_over.empty())
            mesh.notes.push_back("elements of type " + list_of(passed_over) + " are passed over: their nodes move "
                                 "where other elements have them, and nothing is said of their shape");
        return std::move(mesh);
    }

    static std::string list_of(const std::set<std::string>& names) {
        std::string list;
        for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
        return list;
    }

    void read_lines(File file) {
        open.push_back(std::filesystem::weakly_canonical(file.path).string());
        std::string_view rest = without_mark(file.text);
        std::string text;  // of a keyword with the lines that continue it
        for (keyword.clear(); !rest.empty();) {
            const std::size_t size = rest.find('\n');
            const std::string_view line = trim(rest.substr(0, size));
            rest.remove_prefix(size == rest.npos ? rest.size() : size + 1);
            ++file.line;
            if (line.empty() || line.starts_with("**")) continue;
            if (line[0] != '*' && text.empty()) {
                data(line, file);
                continue;
            }
            text += line;
            if (text.back() != ',' || trim(rest).starts_with('*')) begin(std::exchange(text, ""), file);
        }
        if (missing > 0) file.fail("the file ends within the nodes of an element");
        open.pop_back();
    }

    void begin(const std::string& text, const File& file) {
        if (missing > 0) file.fail("expected ", missing, " more nodes of the element before, got a keyword");
        const std::vector<std::string_view> words = split(text, ',');
        parameters.clear();
        for (const std::string_view word : words) {
            const std::size_t equals = std::min(word.find('='), word.size() - 1);
            std::string value(trim(word.substr(std::min(equals + 1, word.size()))));
            std::erase(value, '"');
            if (!word.empty()) parameters[capitals(word.substr(0, equals + (word[equals] != '=')))] = value;
        }
        keyword = capitals(words[0]);
        static const std::set<std::string> generators = {"*NGEN", "*NFILL", "*NCOPY", "*NMAP", "*ELGEN", "*ELCOPY",
                                                         "*SYSTEM"};
        static const std::set<std::string> known = {"*NODE", "*ELEMENT", "*NSET", "*ELSET", "*SURFACE", "*INCLUDE"};
        std::vector<std::string>& others = mesh.sections;
        if (!known.contains(keyword) && !keyword.starts_with("*END") &&
            std::find(others.begin(), others.end(), keyword) == others.end())
            others.push_back(keyword);
        if (generators.contains(keyword))
            file.fail(keyword, ": nodes and elements have to be listed; write the file with them by the program that "
                      "made it");
        if (keyword == "*PART" || keyword == "*INSTANCE") {
            ++depth;
            if (++(keyword == "*PART" ? parts : instances) > 1)
                file.fail("a second ", keyword, ": only a file with one part is read");
        }
        if (keyword == "*ENDPART" || keyword == "*ENDINSTANCE") --depth;
        if (keyword == "*INCLUDE") return include(file);
        // Beside a part are its reference points, which have numbers of their own.
        const bool is_beside = parts > 0 && depth == 0 && !parameters.contains("INSTANCE") && keyword != "*SURFACE";
        if (is_beside || parameters.contains("COMBINE")) keyword.clear();
        if (keyword == "*SURFACE" && capitals(parameters["TYPE"]) == "NODE")
            keyword = "*NSET", parameters["NSET"] = parameters["NAME"];
        const bool of_nodes = keyword == "*NODE" || keyword == "*NSET";
        const std::string name = parameters[of_nodes ? "NSET" : "ELSET"];
        set = nullptr;
        if (!name.empty() && (of_nodes || keyword == "*ELEMENT" || keyword == "*ELSET"))
            set = &(of_nodes ? node_sets : element_sets).try_emplace(capitals(name), Set{name}).first->second;
        if (!set && (keyword == "*NSET" || keyword == "*ELSET")) file.fail("a set without a name");
        if (keyword == "*NODE" && parameters.contains("SYSTEM") && capitals(parameters["SYSTEM"]) != "R")
            file.fail("nodes in the coordinates SYSTEM=", parameters["SYSTEM"], ": only rectangular ones are read");
        if (keyword != "*ELEMENT") return;
        const std::string of = capitals(parameters["TYPE"]);
        type = type_of(of);
        types.insert(of);
        if (!type.cell) (type.dim > 1 ? refused : passed_over).insert(of);
    }

    void include(const File& from) {
        namespace fs = std::filesystem;
        const std::string input = parameters["INPUT"];
        const std::string path = (fs::path(open.front()).parent_path() / input).lexically_normal().string();
        if (input.empty()) from.fail("*INCLUDE without INPUT=FILE");
        if (std::find(open.begin(), open.end(), fs::weakly_canonical(path).string()) != open.end())
            from.fail("the file includes itself");
        std::string text;
        try {
            text = read_text_file(path);
        } catch (const InputError& error) {
            from.fail("*INCLUDE: ", error.what());
        }
        read_lines({path, text, false});
        keyword.clear();
    }

    void data(std::string_view line, const File& file) {
        std::vector<std::string_view> fields = split(line, ',');
        if (keyword == "*NODE") return node(fields, file);
        while (!fields.empty() && fields.back().empty()) fields.pop_back();
        if (fields.empty()) return;
        if (keyword == "*ELEMENT" && type.cell) element(fields, file);
        if (keyword == "*NSET") members(*set, fields, node_sets, file);
        if (keyword == "*ELSET") members(*set, fields, element_sets, file);
        if (keyword != "*SURFACE") return;
        Set of;
        members(of, {fields[0]}, element_sets, file);
        surfaces.push_back({parameters["NAME"], fields.size() > 1 ? capitals(fields[1]) : "",
                            concat(file.path, ":", file.line, ": "), std::move(of.ids)});
    }

    // Of numbers, FIRST, LAST, STEP, or other sets. A number that is not there is passed over later.
    void members(Set& of, const std::vector<std::string_view>& fields, const Sets& sets, const File& file) {
        if (parameters.contains("GENERATE") && keyword != "*SURFACE") {
            std::vector<int> range;
            for (const std::string_view field : fields) range.push_back(number(field, "a number", file, 0));
            if (range.size() == 2) range.push_back(1);
            if (range.size() != 3 || range[2] < 1) file.fail("expected FIRST, LAST, STEP");
            const bool is_huge = (range[1] - range[0]) / range[2] > 10'000'000;  // as 1, 999999999: all that is there
            for (long long id = range[0]; id <= (is_huge ? std::min(range[1], largest_id) : range[1]); id += range[2])
                of.ids.push_back(static_cast<int>(id));
            return;
        }
        for (const std::string_view field : fields) {
            if (const auto id = parse_int(field, 0)) {
                of.ids.push_back(*id);
                continue;
            }
            auto known = sets.find(capitals(field));
            if (known == sets.end()) known = sets.find(capitals(field.substr(field.find('.') + 1)));  // of a part
            if (known == sets.end()) file.fail("there is no set ", in_backquotes(field), " before");
            const std::vector<int> ids = known->second.ids;
            of.ids.insert(of.ids.end(), ids.begin(), ids.end());
        }
    }

    static int number(std::string_view text, const char* what, const File& file, int lowest = 1) {
        if (const auto value = parse_int(text, lowest)) return *value;
        file.fail("expected ", what, ", got ", in_backquotes(text));
    }

    void node(const std::vector<std::string_view>& fields, const File& file) {
        RawNode node{number(fields[0], "the number of a node", file), {}, file.is_main ? file.line : 0};
        const int before = nodes.insert(node.id, static_cast<int>(mesh.nodes.size()));
        const std::size_t index = before < 0 ? mesh.nodes.size() : before;  // the last one of a number is taken
        if (before < 0) mesh.nodes.push_back(node);
        largest_id = std::max(largest_id, static_cast<int>(node.id));
        mesh.coordinates.first.resize(3 * mesh.nodes.size());
        for (std::size_t a = 0; a < 3; ++a) {
            const std::string_view field = a + 1 < fields.size() ? fields[a + 1] : "";
            const auto value = field.empty() ? 0.0 : parse_double(field);
            if (!value) file.fail("expected a coordinate, got ", in_backquotes(field));
            node.x[a] = *value;
            longest = std::max(longest, static_cast<int>(field.size()));
            if (field.empty()) left_out = std::min(left_out, static_cast<int>(a));
            else mesh.coordinates.first[3 * index + a] = field.data() - file.text.data();
        }
        includes_nodes |= !file.is_main;
        mesh.nodes[index] = node;
        if (set) set->ids.push_back(static_cast<int>(node.id));
    }

    // Or further nodes of the last one. Numbers of nodes stand in the place of their indices until select().
    void element(const std::vector<std::string_view>& fields, const File& file) {
        const bool is_new = missing == 0;
        if (is_new) {
            const int id = number(fields[0], "the number of an element", file);
            largest_id = std::max(largest_id, id);
            if (elements.insert(id, 0) >= 0) file.fail("element ", id, " is there twice");
            mesh.elements.push_back({id, mesh.element_nodes.size(), file.is_main ? file.line : 0, type.dim, type.degree,
                                     0, 0, type.cell});
            mesh.element_nodes.resize(mesh.element_nodes.size() + type.cell->node_count(type.degree), -1);
            missing = type.nodes;
            if (set) set->ids.push_back(id);
            if (type.is_shell) shells.insert(id);
        }
        for (std::size_t k = is_new; k < fields.size() && missing > 0; ++k, --missing)  // CalculiX takes no more, too
            mesh.element_nodes[mesh.elements.back().first + type.order[type.nodes - missing]] =
                number(fields[k], "the number of a node", file);
    }

    // Keeps the elements of the highest dimension, and those of the one below that can be faces of theirs. Returns it.
    int select() {
        int dim = 0, degree = 0;
        for (const RawElement& element : mesh.elements)
            if (element.dim > dim) dim = element.dim, degree = element.degree;
        if (dim < 2 || mesh.nodes.empty())
            throw InputError(mesh.path, ": there are no solids (C3D4, ...) and no elements in the plane (CPS3, ...)",
                             types.empty() ? "" : ", only elements of type " + list_of(types));
        const auto dropped = std::erase_if(mesh.elements, [&](const RawElement& element) {
            return element.dim < dim - 1 || (element.dim < dim && element.degree != degree);
        });
        if (dropped > 0) passed_over.insert("beams, or shells of another degree than the solids");
        elements = IdIndex(mesh.elements.size());
        for (const RawElement& element : mesh.elements) {
            elements.insert(element.id, static_cast<int>(&element - mesh.elements.data()));
            for (int i = 0; i < element.node_count(); ++i) {
                int& node = mesh.element_nodes[element.first + i];
                const long long id = node;
                if (id >= 0 && (node = nodes.find(id)) < 0)
                    throw InputError(mesh.path, element.line ? concat(":", element.line) : "", ": element ", element.id,
                                     " has node ", id, ", which is not there");
            }
        }
        return dim;
    }

    // Label: S2 of a cell, S1 and S2 or SPOS and SNEG the whole of a shell, whose edges are S3, ... or E1, ...; "": all
    // outer sides.
    void add_surface(const Surface& surface, int dim, NamedGroups& groups) const {
        for (const int id : surface.ids) {
            const int e = elements.find(id);
            if (e < 0) continue;
            const CellType& cell = mesh.elements[e].cell();
            const bool is_edge = shells.contains(id) && surface.label.starts_with('S');
            const int number = parse_int(surface.label.substr(surface.label.size() > 1), 0).value_or(0);
            const int side = cell.dim == dim ? side_of(cell, is_edge ? std::max(number, 2) - 2 : number) : -1;
            if (cell.dim < dim) {
                if (!surface.label.starts_with('E')) groups.add(surface.name, e);
            } else if (surface.label.empty()) groups.add_outer_sides(surface.name, e);
            else if (side >= 0) groups.add_side(surface.name, e, side);
            else if (dim == 3)
                throw InputError(surface.where, "a ", cell.name, " has no side ", in_backquotes(surface.label));
        }
    }
};

}  // namespace

bool looks_like_inp(std::string_view text) {
    for (const std::string_view line : split(text.substr(0, 20000), '\n'))
        if (!line.empty() && !line.starts_with("**"))
            return line.size() > 1 && line[0] == '*' && std::isalpha(static_cast<unsigned char>(line[1]));
    return false;
}

RawMesh parse_inp(std::string_view text, const std::string& path) {
    return InpReader{.nodes = IdIndex(text.size() / 100)}.read(text, path);
}

}  // namespace almesh
