// The program as its users meet it: command lines run in the test's own process, with what they print.
#pragma once
#include <algorithm>
#include <cstdio>
#include <map>
#include <string>
#include <vector>

#include "app/commands.hpp"
#include "base/text.hpp"
#include "io/mesh_format.hpp"
#include "io/msh.hpp"
#include "mesh/build.hpp"
#include "support/rows.hpp"
#include "support/temporary_folder.hpp"

namespace almesh::test {

struct Outcome {
    int code = -1;
    std::string out, error;
};

inline std::string take_contents(std::FILE* file) {
    std::rewind(file);
    std::string text;
    for (int c; (c = std::fgetc(file)) != EOF;) text += static_cast<char>(c);
    std::fclose(file);
    return text;
}

inline Outcome almesh_with(const std::vector<std::string>& arguments) {
    std::FILE *out = std::tmpfile(), *error = std::tmpfile();
    Outcome outcome;
    outcome.code = command_line(arguments, out, error);
    outcome.out = take_contents(out);
    outcome.error = take_contents(error);
    return outcome;
}

// The same in steps that no deck needs, where the arguments name no others: a program that does not converge fails
// instead of going on for hours.
inline Outcome almesh_bounded(std::vector<std::string> arguments) {
    for (const std::string key : {"max_al_iterations=", "max_newton_iterations="}) {
        const auto is_set = [&key](const std::string& argument) { return argument.starts_with(key); };
        if (std::none_of(arguments.begin(), arguments.end(), is_set)) arguments.push_back(key + "40");
    }
    return almesh_with(arguments);
}

inline bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

inline std::string msh_of(const Mesh& mesh) { return msh_text(mesh, mesh.x); }

inline Mesh mesh_of(const std::string& path) {
    std::vector<std::string> notes;
    return build_mesh(read_mesh(path), notes);
}

inline std::vector<std::pair<std::string, std::string>> summary_lines(const std::string& folder) {
    std::vector<std::pair<std::string, std::string>> lines;
    for (const std::string& line : pieces(text_of(folder + "/summary.txt"), '\n')) {
        const auto equals = line.find(" = ");
        lines.emplace_back(line.substr(0, equals), equals == std::string::npos ? "" : line.substr(equals + 3));
    }
    return lines;
}

inline std::map<std::string, std::string> summary_of(const std::string& folder) {
    const auto lines = summary_lines(folder);
    return {lines.begin(), lines.end()};
}

// A decimal or count of the summary.
inline double number(const std::map<std::string, std::string>& summary, const std::string& key) {
    return parse_double(summary.at(key)).value();
}

// Cells of a history without the column of times.
inline std::vector<std::vector<std::string>> history_without_times(const std::string& folder) {
    auto rows = csv_rows(text_of(folder + "/history.csv"));
    for (auto& row : rows) row.pop_back();
    return rows;
}

}  // namespace almesh::test
