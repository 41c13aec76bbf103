// Text cut into cells, for files of rows.
#pragma once
#include <cstdlib>
#include <sstream>
#include <string>
#include <vector>

namespace almesh::test {

inline std::vector<std::string> pieces(const std::string& text, char separator) {
    std::vector<std::string> result;
    std::istringstream in(text);
    for (std::string piece; std::getline(in, piece, separator);) result.push_back(piece);
    if (text.ends_with(separator) && separator != '\n') result.emplace_back();
    return result;
}

// Line by line, cells separated by commas.
inline std::vector<std::vector<std::string>> csv_rows(const std::string& text) {
    std::vector<std::vector<std::string>> rows;
    for (const std::string& line : pieces(text, '\n')) rows.push_back(pieces(line, ','));
    return rows;
}

// The numbers below a heading in a VTK file; none where it is missing.
inline std::vector<double> numbers_of(const std::string& vtk, const std::string& heading) {
    const auto at = vtk.find(heading);
    if (at == std::string::npos) return {};
    std::vector<double> values;
    const char* from = vtk.c_str() + at + heading.size();
    for (char* end = nullptr;; from = end) {
        const double value = std::strtod(from, &end);
        if (end == from) return values;
        values.push_back(value);
    }
}

inline std::vector<double> scalars(const std::string& vtk, const std::string& name) {
    return numbers_of(vtk, "SCALARS " + name + " double 1\nLOOKUP_TABLE default\n");
}

inline std::string with_crlf(const std::string& text) {
    std::string other;
    for (const char c : text) (other += c == '\n' ? "\r" : "") += c;
    return other;
}

}  // namespace almesh::test
