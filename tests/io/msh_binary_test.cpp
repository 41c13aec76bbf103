#include <doctest/doctest.h>

#include <random>

#include "base/bytes.hpp"
#include "base/error.hpp"
#include "io/msh_samples.hpp"
#include "mesh/build.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

// Writes the numbers of a binary MSH file as its version has them.
struct Bytes {
    int version;
    std::endian order = std::endian::little;
    int size_bytes = 8;
    bool parametric = false;
    std::string text{};

    void ints(std::initializer_list<int> values) {
        for (const int value : values) append_bytes(text, value, order);
    }
    void reals(std::initializer_list<double> values) {
        for (const double value : values) append_bytes(text, value, order);
    }
    void sizes(std::initializer_list<int> values) {
        for (const int value : values)
            size_bytes == 4 ? append_bytes(text, value, order) : append_bytes(text, std::int64_t{value}, order);
    }
    void ids(std::initializer_list<int> values) { version == 41 ? sizes(values) : ints(values); }
    void entity(int dim, int tag) { version == 40 ? ints({tag, dim}) : ints({dim, tag}); }
    void node(int id, double x, double y, double z) {
        if (version < 41) ids({id});
        reals({x, y, z});
    }
    void element(int id, std::initializer_list<int> tags, std::initializer_list<int> nodes) {
        ids({id});
        if (version == 22) ints(tags);
        ids(nodes);
    }
};

void append_entities(Bytes& to) {
    to.text += "$Entities\n";
    to.sizes({1, 2, 1, 0});
    to.ints({1});
    to.reals({0, 0, 0});
    if (to.version == 40) to.reals({0, 0, 0});
    to.sizes({0});
    for (const int tag : {12, 11}) {
        to.ints({tag});
        to.reals({0, 0, 0, 1, 1, 0});
        to.sizes({tag == 12 ? 2 : 1});
        if (tag == 12) to.ints({4, 6});
        else to.ints({-4});
        to.sizes({2});
        to.ints({1, -1});
    }
    to.ints({1});
    to.reals({0, 0, 0, 1, 1, 0});
    to.sizes({1});
    to.ints({9});
    to.sizes({2});
    to.ints({11, 12});
    to.text += "\n$EndEntities\n";
}

void append_nodes(Bytes& to) {
    const std::string name = to.version == 22 && to.parametric ? "ParametricNodes" : "Nodes";
    to.text += "$" + name + "\n";
    const auto parameters = [&](int dim, int tag) {
        if (to.parametric && to.version == 22) to.ints({dim, tag});
        for (int k = 0; to.parametric && k < dim; ++k) to.reals({0.5});
    };
    if (to.version == 22) {
        to.text += "3\n";
    } else {
        to.sizes({2, 3});
        if (to.version == 41) to.sizes({1, 5});
        to.entity(1, 11);
        to.ints({to.parametric});
        to.sizes({2});
    }
    if (to.version == 41) to.ids({1, 5});
    to.node(1, 0, 0, 0);
    parameters(1, 11);
    if (to.version < 41) to.node(5, 0, 1, 1e-300);
    else to.reals({0, 1, 1e-300});
    parameters(1, 11);
    if (to.version > 22) {
        to.entity(2, 1);
        to.ints({to.parametric});
        to.sizes({1});
    }
    if (to.version == 41) to.ids({2});
    to.node(2, 1, 0, 0);
    parameters(2, 1);
    to.text += "\n$End" + name + "\n";
}

// Begins elements: their type, number and place.
void append_block(Bytes& to, int dim, int tag, int type, int count) {
    if (to.version == 22) {
        to.ints({type, count, 2});
        return;
    }
    to.entity(dim, tag);
    to.ints({type});
    to.sizes({count});
}

void append_elements(Bytes& to) {
    to.text += "$Elements\n";
    if (to.version == 22) to.text += "5\n";
    else to.sizes({4, 5});
    if (to.version == 41) to.sizes({1, 8});
    append_block(to, 0, 1, 15, 1);
    to.element(1, {0, 1}, {1});
    append_block(to, 1, 11, 1, 2);
    to.element(2, {4, 11}, {1, 2});
    to.element(3, {4, 11}, {2, 5});
    append_block(to, 1, 12, 1, 1);
    to.element(4, {4, 12}, {5, 1});
    append_block(to, 2, 1, 2, 1);
    to.element(8, {9, 1}, {1, 2, 5});
    to.text += "\n$EndElements\n";
}

const std::string names = "$PhysicalNames\n2\n1 4 \"the wall\"\n2 9 \"inside\"\n$EndPhysicalNames\n";

std::string binary_triangle(Bytes to) {
    to.text = to.version == 22 ? "$MeshFormat\n2.2" : to.version == 40 ? "$MeshFormat\n4" : "$MeshFormat\n4.1";
    to.text += " 1 " + std::to_string(to.size_bytes) + "\n";
    to.ints({1});
    to.text += "\n$EndMeshFormat\n" + names;
    if (to.version > 22) append_entities(to);
    append_nodes(to);
    append_elements(to);
    return to.text;
}

std::string error_of(const std::string& file) {
    try {
        parse_msh(file, "a.msh");
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

std::size_t begin_of(const std::string& text, const std::string& section) {
    return text.find(section + "\n") + section.size() + 1;
}

// The file with the bytes at `place` replaced.
std::string with_bytes(std::string file, std::size_t place, const std::string& bytes) {
    return file.replace(place, bytes.size(), bytes);
}

std::string int_bytes(int value) {
    std::string bytes;
    append_bytes(bytes, value, std::endian::little);
    return bytes;
}

bool begins(const std::string& text, const std::string& beginning) {
    CAPTURE(text);
    CHECK(text.starts_with(beginning));
    return text.starts_with(beginning);
}

}  // namespace

TEST_CASE("binary files of every version, order of bytes and size of a count hold the mesh of the text") {
    for (const int version : {22, 40, 41})
        for (const std::endian order : {std::endian::little, std::endian::big})
            for (const int size_bytes : {4, 8})
                for (const bool parametric : {false, true}) {
                    if (size_bytes == 4 && version < 41) continue;
                    CAPTURE(version);
                    CAPTURE(size_bytes);
                    const RawMesh mesh = parse_msh(binary_triangle({version, order, size_bytes, parametric}), "a.msh");
                    CHECK(mesh.format == FileFormat{.msh_version = version, .binary = true});
                    check_is_the_triangle(mesh);
                    CHECK(mesh.elements[4].line == 0);
                    if (version == 22) continue;
                    CHECK(find_entity(mesh.entities, 1, 12)->physical == std::vector<int>{4, 6});
                }
}

TEST_CASE("sections of other kinds are passed over, whatever is in them") {
    std::string data = "$NodeData\n1\n\"a\"\n";
    data += std::string("\0\1$Nodes\n$EndNodeData\nno end: no section follows\n", 49);
    data += "\n$EndNodeData\n$Periodic\n$EndPeriodic\n";
    for (const int version : {22, 40, 41})
        for (const char* before : {"$PhysicalNames", "$Nodes", "$Elements"}) {
            const std::string file = binary_triangle({version});
            check_is_the_triangle(parse_msh(replaced(file, std::string(before) + "\n", data + before + "\n"), "a.msh"));
            check_is_the_triangle(parse_msh(file + data, "a.msh"));
            begins(error_of(file + data.substr(0, data.find("$EndNodeData"))), "a.msh: $NodeData, byte ");
        }
}

TEST_CASE("a binary file cut off anywhere is refused with the section and the byte") {
    for (const int version : {22, 40, 41}) {
        const std::string file = binary_triangle({version});
        for (std::size_t length = 0; length < file.size() - 13; ++length) {
            const std::string error = error_of(file.substr(0, length));
            CAPTURE(length);
            CAPTURE(error);
            CHECK(!error.empty());
            const bool in_data = length > begin_of(file, "$Nodes") && length < file.find("\n$EndElements");
            if (in_data) CHECK(error.find(", byte ") != std::string::npos);
        }
    }
    const std::string file = binary_triangle({22});
    const std::size_t nodes = begin_of(file, "$Nodes") + 2;
    CHECK(error_of(file.substr(0, nodes + 60)) ==
          concat("a.msh: $Nodes, byte ", nodes,
                 ": the file is cut off: $Nodes announces 3 nodes of at least 28 bytes, "
                 "60 bytes are left"));
    const std::string no_end = error_of(file.substr(0, file.size() - 14));
    CHECK(no_end.ends_with("the file is cut off: $Elements has no $EndElements"));
}

TEST_CASE("a binary file with bytes changed is refused or read, never worse") {
    std::mt19937 random(1);
    for (const int version : {22, 40, 41}) {
        const std::string file = binary_triangle({version});
        for (std::size_t k = 0; k < file.size(); ++k)
            for (const char byte : {'\0', '\1', '\x7f', '\xff', '\n', '$'}) error_of(with_bytes(file, k, {byte}));
        for (int k = 0; k < 3000; ++k) {
            std::string changed = file;
            for (int n = 0; n < 3; ++n) changed[random() % file.size()] = static_cast<char>(random());
            error_of(changed);
        }
    }
}

TEST_CASE("damage in a binary file is named with its place") {
    const std::string file = binary_triangle({22});
    const std::size_t nodes = begin_of(file, "$Nodes") + 2, elements = begin_of(file, "$Elements") + 2;
    const auto place = [](const char* section, std::size_t byte) {
        return concat("a.msh: ", section, ", byte ", byte, ": ");
    };
    begins(error_of(with_bytes(file, nodes + 28, int_bytes(1))),
           place("$Nodes", nodes + 32) + "node id 1 is there twice");
    begins(error_of(with_bytes(file, nodes, int_bytes(-1))), place("$Nodes", nodes) + "a node id -1 is out of range");
    std::string nan;
    append_bytes(nan, std::numeric_limits<double>::quiet_NaN(), std::endian::little);
    begins(error_of(with_bytes(file, nodes + 4, nan)), place("$Nodes", nodes + 4) + "a coordinate nan is not a finite");
    begins(error_of(with_bytes(file, elements, int_bytes(20))),
           place("$Elements", elements + 12) +
               "1 element of type 20: only triangles");
    begins(error_of(with_bytes(file, elements + 4, int_bytes(6))),
           place("$Elements", elements + 4) + "the number of elements of this type 6 is out of range");
    begins(error_of(with_bytes(file, elements + 24, int_bytes(4))),
           place("$Elements", elements + 28) + "the element has node 4, which is not in $Nodes");
    begins(error_of(replaced(file, "$Nodes\n3\n", "$Nodes\n2\n")), "a.msh: $Nodes, byte ");
    CHECK(error_of(replaced(file, " 1 8\n", " 1 4\n")) ==
          "a.msh:2: numbers of 4 bytes: only those of 8 are read, in MSH 4.1 also of 4");
    CHECK(error_of(replaced(file, int_bytes(1), int_bytes(2))) ==
          "a.msh: $MeshFormat, byte 20: expected the number 1 in four bytes, by which the order of bytes is told");
}

TEST_CASE("counts that the file has no room for are refused before anything is allocated for them") {
    const std::string huge = int_bytes(2000000000);
    for (const int version : {40, 41}) {
        const std::string file = binary_triangle({version});
        const std::size_t entities = begin_of(file, "$Entities"), nodes = begin_of(file, "$Nodes");
        CHECK(error_of(with_bytes(file, nodes + 8, huge)).find("announces 2000000000 nodes of at least") !=
              std::string::npos);
        CHECK(!error_of(with_bytes(file, nodes, huge)).empty());
        CHECK(!error_of(with_bytes(file, entities, huge)).empty());
        CHECK(!error_of(with_bytes(file, begin_of(file, "$Elements") + 8, huge)).empty());
    }
    const std::string old = binary_triangle({22});
    CHECK(error_of(replaced(old, "$Elements\n5", "$Elements\n2000000000")).find("only") == std::string::npos);
    CHECK(error_of(replaced(old, "$Elements\n5", "$Elements\n2000000000")).find("bytes are left") != std::string::npos);
}

TEST_CASE("refusals of a mesh from a binary file name the element without a line") {
    std::string file = binary_triangle({22});
    const std::size_t first_edge = begin_of(file, "$Elements") + 2 + 12 + 16 + 12;
    RawMesh raw = parse_msh(with_bytes(file, first_edge + 4, int_bytes(0)), "a.msh");
    raw.elements[2].degree = 2;
    std::vector<std::string> notes;
    CHECK_THROWS_WITH_AS(build_mesh(raw, notes),
                         "a.msh: element 3 has degree 2, element 2 has degree 1: all elements "
                         "and boundary faces need the same one",
                         InputError);
}
