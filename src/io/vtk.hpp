// Legacy VTK files, ASCII or binary: cells of any degree with point and cell data, which the reader leaves out.
//
// File format: "VTK File Formats" of the VTK User's Guide. Header 3.0 with the body of that version, which ParaView,
// MFEM and VisIt read; Lagrange cells (types 68 to 73) from degree 3 on. ParaView shows curved cells as curved with a
// raised Nonlinear Subdivision Level.
//
// Binary files hold the same sequence of numbers without separators, as big-endian doubles and 4-byte integers: faster
// to write and to read, and without rounding.
#pragma once
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "mesh/raw_mesh.hpp"

namespace almesh {

enum class VtkFormat { ascii, binary };

struct VtkArray {
    std::string name;           // blanks and other special characters are %-encoded, which readers undo
    int components;             // 1, or dim, written as a 3-vector
    std::vector<double> value;  // count x components
};

// An unstructured grid.
struct VtkGrid {
    std::string title;                           // its first line, at most 255 characters, is written
    int dim, degree;
    std::vector<double> positions;               // node_count x dim
    std::vector<int> cells;                      // cell_count x nodes of a cell of `degree`, Gmsh order
    int cell_dim;                                // 1, 2, 3
    std::vector<VtkArray> point_data, cell_data;
    std::vector<std::pair<std::string, std::string>> provenance;  // names and texts, kept in the file as field data
    std::vector<ElementGroup> groups{};          // of the cells; empty: all are simplices
};

// Data have 9 digits in ASCII. VTK readers turn inf and nan into 0, so +inf and nan are written as 1e300, -inf as
// -1e300.
std::string vtk_text(const VtkGrid& grid, VtkFormat format = VtkFormat::ascii);

// What a grid of such cells loses in the file; "": nothing.
std::string vtk_loss(const std::vector<ElementGroup>& groups, int degree);

// Throws InputError where the file cannot be written.
void write_vtk(const std::string& path, const VtkGrid& grid, VtkFormat format = VtkFormat::ascii);

// Whether a text begins like a legacy VTK file.
bool looks_like_vtk(std::string_view text);

// Points and cells of an unstructured grid, of versions up to 5.1; ids are VTK's numbers plus one. Throws InputError
// "path:line: message": other datasets and cells, wrong counts, a file that is cut off.
RawMesh parse_vtk(std::string_view text, const std::string& path);

// The cells of a legacy or an XML file: cell c has the points connectivity[offsets[c] ... offsets[c + 1]).
struct VtkCells {
    std::vector<long long> offsets, connectivity, types;
    bool are_of_vtk_8 = false;  // Lagrange hexahedra with two edges in another order
};

// Appends them, once the nodes are there. Throws InputError where numbers are out of range, and for cells of other
// types all together.
void append_vtk_cells(const VtkCells& cells, const std::string& path, RawMesh& mesh);

}  // namespace almesh
