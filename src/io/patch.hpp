// A mesh file with other coordinates: every other byte stays.
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "mesh/file_tags.hpp"

namespace almesh {

// The text of the file with the coordinates x, `dim` of each node of the fields in their order. A number whose double
// is the one that is there keeps its characters; else it is the shortest text that reads back to the same bits, or of
// fields with a width or with most characters the most digits that fit; in binary files a number of their form and
// order of bytes. Cost: O(length of the file), in parallel.
std::string patched(std::string_view file, const CoordinateFields& fields, const std::vector<double>& x);

// Whether numbers are rounded to be written so, and to what, which is what will be read back.
inline bool rounds(const CoordinateFields& fields) {
    return !fields.first.empty() && fields.width + fields.most + (fields.form == CoordinateFields::Form::float32) > 0;
}
std::vector<double> rounded_as(const CoordinateFields& fields, std::vector<double> x);

// The same of all nodes of a mesh of the file, with those that the file does not have where the others put them; and
// whether that is what is written.
std::vector<double> read_back(const FileTags& file, std::vector<double> x);
inline bool is_read_back(const FileTags& file) { return !rounds(file.coordinates) && file.implied.empty(); }

}  // namespace almesh
