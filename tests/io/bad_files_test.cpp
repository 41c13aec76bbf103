// Small files of every format, which are the seeds of fuzzing, cut off and with a wrong byte.
#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>

#include "base/error.hpp"
#include "io/mesh_format.hpp"
#include "io/patch.hpp"
#include "mesh/build.hpp"
#include "support/temporary_folder.hpp"

using namespace almesh;

namespace {

// "" where the text is a mesh, of which the same bytes can be written, or is refused in a sentence with the file's name.
std::string fault_of(std::string_view text, const MeshFormat& format) {
    const std::string path = "bad" + std::string(format.ending);
    try {
        std::vector<std::string> notes;
        const Mesh mesh = build_mesh(parse_mesh(text, path), notes, Folds::keep);
        const CoordinateFields& fields = mesh.file.coordinates;  // none where the file cannot be written again
        if (!fields.first.empty() && patched(text, fields, mesh.x) != text)
            return "with its own coordinates it is another file";
    } catch (const InputError& error) {
        const std::string said = error.what();
        return said.find(path) != said.npos && said.size() > path.size() + 8 ? "" : "refused with: " + said;
    } catch (const std::exception& error) {
        return concat("ends with an error that is none of the input: ", error.what());
    }
    return "";
}

// Calls body(text) with each seed of a format that is not long.
template <class Body>
void for_files(const MeshFormat& format, const Body& body) {
    std::vector<std::string> paths;
    for (const auto& entry :
         std::filesystem::directory_iterator("tests/fuzz/seeds/" + std::string(format.ending.substr(1))))
        if (entry.file_size() <= 1000) paths.push_back(entry.path().string());
    REQUIRE(paths.size() >= 4);
    std::sort(paths.begin(), paths.end());
    for (const std::string& path : paths) {
        CAPTURE(path);
        body(test::text_of(path));
    }
}

}  // namespace

TEST_CASE("a file that is cut off anywhere is refused in a sentence, or read") {
    for (const MeshFormat& format : mesh_formats)
        for_files(format, [&](const std::string& text) {
            for (std::size_t size = 0; size <= text.size(); ++size) {
                CAPTURE(size);
                REQUIRE(fault_of(std::string_view(text).substr(0, size), format) == "");
            }
        });
}

TEST_CASE("a file with a wrong byte anywhere is refused in a sentence, or read") {
    for (const MeshFormat& format : mesh_formats)
        for_files(format, [&](const std::string& text) {
            for (const char wrong : {'\0', '\n', '-', '9'})
                for (std::size_t at = 0; at < text.size(); ++at) {
                    std::string other = text;
                    other[at] = wrong;
                    CAPTURE(at);
                    CAPTURE(static_cast<int>(wrong));
                    REQUIRE(fault_of(other, format) == "");
                }
        });
}
