// KEYWORD= VALUE lines: NDIME, then of each zone, in any order, NELEM, NPOIN and NMARK, each with its rows after it.
// An element is its VTK type and its nodes, a point its coordinates. What comes after these in a row, such as a number
// of its own, is not read: both are numbered by their order. Of degree p the type is greater by 100 (p - 1).
// IZONE begins a zone where NZONE announces several.
#include <algorithm>
#include <map>
#include <tuple>
#include <utility>

#include "io/foreign_cells.hpp"
#include "io/su2.hpp"
#include "io/text_scanner.hpp"

namespace almesh {
namespace {

struct Su2Reader {
    TextScanner in;  // of the text without comments
    RawMesh mesh{};
    int dim = 0, begun = 0;                         // begun: the zone of the last IZONE
    std::vector<std::string> keywords{};            // of this zone
    std::size_t first_node = 0, first_element = 0;  // of this zone
    long long next_id = 0;                          // of an element; faces, which SU2 does not number, come after all
    int row_line = 0;                               // where the row that is read begins
    std::map<std::pair<const CellType*, int>, std::vector<int>> orders{};  // of nodes, by cell and degree
    std::vector<int> zone_of_group{};
    Vec<3> centre{}, angles{};  // of a periodic transformation

    RawMesh read() {
        std::string last;  // keyword
        std::vector<std::string>& others = mesh.sections;
        while (in.next_line()) {
            const std::string keyword = take_keyword();
            if (keyword.empty() && (last.empty() || is_known(last)))
                in.fail("expected `KEYWORD= VALUE`, got ", in_backquotes(in.rest_of_line().substr(0, 40)),
                        last.starts_with("N") ? ": more rows than " + last + " announces" : "");
            if (!keyword.empty()) last = keyword;
            if (keyword.starts_with("PERIODIC_")) periodic(keyword);
            if (is_known(keyword)) known(keyword);
            else if (!keyword.empty() && std::find(others.begin(), others.end(), keyword) == others.end())
                others.push_back(keyword);
            in.rest_of_line();
        }
        if (begun < mesh.zones && mesh.zones > 1)
            in.fail("NZONE announces ", mesh.zones, " zones, only ", begun, " are there");
        end_zone();
        for (RawElement& face : mesh.elements)
            if (face.id < 0) face.id = next_id++;
        name_groups();
        mesh.coordinates.dim = dim;
        return std::move(mesh);
    }

    static bool is_known(std::string_view keyword) {
        constexpr std::string_view known[] = {"NDIME", "NZONE", "IZONE", "NELEM", "NPOIN", "NMARK"};
        return std::find(std::begin(known), std::end(known), keyword) != std::end(known) ||
               keyword.starts_with("MARKER_");
    }

    bool has(std::string_view keyword) const {
        return std::find(keywords.begin(), keywords.end(), keyword) != keywords.end();
    }

    void known(const std::string& keyword) {
        if (keyword == "IZONE") return begin_zone();
        if (keyword.starts_with("MARKER_")) in.fail(keyword, " outside of NMARK: are there more markers than it says?");
        if (has(keyword))
            in.fail(keyword, " is there twice", mesh.zones > 1 ? ": a zone begins with IZONE= NUMBER" : "");
        keywords.push_back(keyword);
        if (keyword == "NDIME") return dimension();
        if (keyword == "NZONE") {
            mesh.zones = in.small_integer("the number of zones", 1);
            if (mesh.zones > 1) mesh.sections.push_back(keyword);
            return;
        }
        if (dim == 0) in.fail("NDIME has to come first");
        if (mesh.zones > 1 && begun == 0) in.fail("of several zones each has to begin with IZONE= NUMBER");
        if (keyword == "NELEM")
            rows("elements", count_of("the number of elements", 0),
                 [&](int) { element(dim, mesh.zones > 1 ? begun : 0); });
        else if (keyword == "NPOIN") points();
        else markers();
    }

    // Of each transformation its centre, the angles about x, y and z in radians, and the translation, the last. What
    // is not that is passed over.
    void periodic(const std::string& keyword) {
        const auto numbers = words(std::string_view(in.at, std::find(in.at, in.end, '\n') - in.at));
        Vec<3> value{};
        for (std::size_t a = 0; a < std::min<std::size_t>(3, numbers.size()); ++a)
            value[a] = parse_double(numbers[a]).value_or(0);
        if (keyword == "PERIODIC_CENTER") centre = value;
        if (keyword == "PERIODIC_ROTATION") angles = value;
        if (!keyword.starts_with("PERIODIC_TRANSLAT")) return;
        PeriodicSides sides{dim - 1, 0, 0, {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}, {}};
        for (int a = 0; a < 3; ++a) {
            Mat<3> turn{};
            turn[a][a] = 1;
            const int b = (a + 1) % 3, c = (a + 2) % 3;
            turn[b][b] = turn[c][c] = std::cos(angles[a]);
            turn[b][c] = -(turn[c][b] = std::sin(angles[a]));
            sides.R = multiply<3>(turn, sides.R);
        }
        sides.t = value + centre - sides.image(centre);
        mesh.periodic.push_back(sides);
    }

    void dimension() {
        const int before = std::exchange(dim, in.small_integer("2 or 3", 2, 3));
        if (before && before != dim)
            in.fail("NDIME= ", dim, " after NDIME= ", before, ": put such zones in a file each");
    }

    void begin_zone() {
        const int number = in.small_integer("the number of the zone", 1);
        if (number != begun + 1 || number > mesh.zones || !(begun || (mesh.nodes.empty() && mesh.elements.empty())))
            in.fail("IZONE= ", number, " is out of order: NZONE= COUNT comes first, then the zones 1, 2, ... with all "
                    "of their mesh");
        if (begun) end_zone();
        begun = number;
        keywords.clear();
    }

    void end_zone() {
        for (const char* section : {"NPOIN", "NELEM"})
            if (!has(section)) in.fail("there is no ", section, mesh.zones > 1 ? concat(" in zone ", begun) : "");
        const int count = static_cast<int>(mesh.nodes.size() - first_node);
        for (; first_element < mesh.elements.size(); ++first_element) {
            const RawElement& element = mesh.elements[first_element];
            for (int i = 0; i < element.node_count(); ++i) {
                int& node = mesh.element_nodes[element.first + i];
                if (node >= count)
                    in.fail_at(element.line, "node ", node, " is not there: the ",
                               mesh.zones > 1 ? "zone" : "file", " has ", count);
                node += static_cast<int>(first_node);
            }
        }
        first_node = mesh.nodes.size();
    }

    // Markers of one name in several zones are told apart by the zone's number; each zone is a group of elements.
    void name_groups() {
        std::map<std::string, int> count;
        for (const PhysicalGroup& group : mesh.groups) ++count[group.name];
        for (std::size_t k = 0; k < mesh.groups.size(); ++k)
            if (std::string& name = mesh.groups[k].name; count[name] > 1) name = concat(zone_of_group[k], ":", name);
        for (int zone = 1; zone <= mesh.zones && mesh.zones > 1; ++zone)
            mesh.groups.push_back({dim, zone, concat("zone-", zone)});
    }

    // Up to `=`; "" where the line has none.
    std::string take_keyword() {
        const char* stop = in.at;
        while (stop != in.end && *stop != '=' && *stop != '\n') ++stop;
        if (stop == in.end || *stop != '=') return "";
        const std::string keyword(trim(std::string_view(in.at, stop - in.at)));
        in.at = stop + 1;
        return keyword;
    }

    // The next line's.
    void expect_keyword(const char* expected) {
        in.next_line();
        const char* const line = in.at;
        if (take_keyword() == expected) return;
        in.at = line;
        in.fail("expected `", expected, "= VALUE`, got ", in.word());
    }

    int count_of(const char* what, int lowest) {
        const int count = in.small_integer(what, lowest);
        in.rest_of_line();  // the number of points without ghosts may follow
        return count;
    }

    template <class Row>
    void rows(const char* what, int count, const Row& row) {
        for (int k = 0; k < count; ++k) {
            if (!in.next_line())
                in.fail("the file is cut off: ", count, " ", what, " announced, only ", k, " are there");
            row_line = in.line;
            row(k);
        }
    }

    // To the next number of a row that has `needed`, in the next line where this one ends before.
    void go_on(int done, int needed) {
        if (in.at_line_end() && !(in.next_line() && std::string_view("+-.0123456789").find(*in.at) < 13))
            fail_row(done, needed);
    }

    // A row that goes on in other lines ends there, with one number more at most.
    void end_row(int needed) {
        const std::string_view rest = in.rest_of_line();
        if (in.line != row_line && words(rest).size() > 1) fail_row(needed - 1, needed);
    }

    [[noreturn]] void fail_row(int done, int needed) const {
        in.fail_at(row_line, "a row of at least ", needed, " numbers has ", done,
                   " or less, and the next line does not complete it");
    }

    void points() {
        rows("points", count_of("the number of points", 1), [&](int) {
            RawNode node{static_cast<long long>(mesh.nodes.size()), {}, row_line};
            for (int a = 0; a < dim; ++a) {
                go_on(a, dim);
                mesh.coordinates.first.push_back(in.next_byte());
                node.x[a] = in.real("a coordinate");
            }
            end_row(dim);
            mesh.nodes.push_back(node);
        });
    }

    // Of dimension n; tag: of its zone or marker.
    void element(int n, int tag) {
        const int type = in.small_integer("the type of an element");
        const int degree = type / 100 + 1;
        const CellType* const cell = cell_of_vtk_type(type % 100);
        if (!cell || cell->dim != n || degree > max_degree || degree < 1)
            in.fail(cell ? cell->plural : "elements of this type", " (type ", type, ") are not read ",
                    n < dim ? "as faces: only " : "here: only ", readable_cells(n, n), " of degree 1 to 7");
        const std::size_t first = mesh.element_nodes.size();
        mesh.elements.push_back({n < dim ? -1 : next_id++, first, row_line, n, degree, tag, tag, cell});
        std::vector<int>& order = orders[{cell, degree}];
        if (order.empty()) order = su2_node_order(*cell, degree);
        const int nodes = static_cast<int>(order.size());
        mesh.element_nodes.resize(first + nodes);
        for (int i = 0; i < nodes; ++i) {
            go_on(i + 1, nodes + 1);
            mesh.element_nodes[first + order[i]] = in.small_integer("the number of a node", 0);
        }
        end_row(nodes + 1);
    }

    void markers() {
        const auto before = static_cast<std::ptrdiff_t>(mesh.groups.size());
        rows("markers", count_of("the number of markers", 0), [&](int) {
            expect_keyword("MARKER_TAG");
            const std::string name(in.rest_as_name());
            if (name.empty()) in.fail("a marker without a name");
            expect_keyword("MARKER_ELEMS");
            const auto same = std::find_if(mesh.groups.begin() + before, mesh.groups.end(),
                                           [&](const PhysicalGroup& group) { return group.name == name; });
            const int tag = static_cast<int>(same - mesh.groups.begin()) + 1;
            if (same == mesh.groups.end()) {
                mesh.groups.push_back({dim - 1, tag, name});
                zone_of_group.push_back(begun);
            }
            marker_rows(tag);
        });
    }

    // Faces; rows of points, and the key before these, are passed over.
    void marker_rows(int tag) {
        const int count = count_of("the number of elements", 0);
        std::pair end(in.at, in.line);  // of the last line taken
        for (; in.next_line() && std::string_view(in.at, in.end - in.at).starts_with("SEND_"); end = {in.at, in.line})
            in.rest_of_line();
        std::tie(in.at, in.line) = end;
        rows("elements", count, [&](int) {
            const char* const row = in.at;
            const bool is_point = in.small_integer("the type of an element") == simplex(0).vtk_types[0];
            in.at = row;
            is_point ? void(in.rest_of_line()) : element(dim - 1, tag);
        });
    }
};

// With blanks in the place of comments, which begin a line or come after a blank or `=`, and of a byte-order mark.
std::string without_comments(std::string_view text) {
    std::string plain(text);
    std::fill_n(plain.begin(), text.size() - without_mark(text).size(), ' ');
    for (std::size_t at = plain.find('%'); at != plain.npos; at = plain.find('%', at + 1))
        if (at == 0 || std::string_view(" \t\r\n=").find(plain[at - 1]) < 5)
            std::fill(plain.begin() + at, std::find(plain.begin() + at, plain.end(), '\n'), ' ');
    return plain;
}

}  // namespace

bool looks_like_su2(std::string_view text) {
    for (const std::string_view line : split(text.substr(0, 2000), '\n')) {
        if (line.empty() || line[0] == '%') continue;
        const std::string_view keyword = trim(line.substr(0, line.find('=')));
        if (keyword.size() == line.size()) return false;
        if (Su2Reader::is_known(keyword)) return true;
    }
    return false;
}

RawMesh parse_su2(std::string_view text, const std::string& path) {
    const std::string plain = without_comments(text);
    Su2Reader reader{TextScanner(plain, path)};
    reader.mesh.path = path;
    reader.mesh.format.ending = ".su2";
    return reader.read();
}

}  // namespace almesh
