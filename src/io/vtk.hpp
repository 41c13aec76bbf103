// Writer of legacy VTK files, ASCII or binary: simplices of any degree with point and cell data, for ParaView and kin.
//
// File format: "VTK File Formats" of the VTK User's Guide. Header 3.0 with the body of that version, which ParaView,
// MFEM and VisIt read; Lagrange cells (types 68, 69, 71) from degree 3 on. ParaView shows curved cells as curved with a
// raised Nonlinear Subdivision Level.
//
// Binary is the same sequence of numbers, without separators, as big-endian doubles and 4-byte integers: faster to
// write and to read, and without rounding to digits.
#pragma once
#include <string>
#include <utility>
#include <vector>

namespace almesh {

enum class VtkFormat { ascii, binary };

struct VtkArray {
    std::string name;           // blanks and the like are %-encoded, which readers undo
    int components;             // 1, or dim, written as a 3-vector
    std::vector<double> value;  // count x components
};

// Node order of a VTK simplex by Gmsh's: node i of the VTK cell is node vtk_node_order(...)[i] of Gmsh's.
std::vector<int> vtk_node_order(int cell_dim, int degree);

// positions: node_count x dim. cells: cell_count x nodes of a simplex of dimension cell_dim (1, 2, 3) and the given
// degree, Gmsh order. provenance: name and text pairs, kept in the file as field data.
// Data have 9 digits in ASCII. VTK readers turn inf and nan into 0, so +inf and nan are written as 1e300, -inf as
// -1e300. Title: the first line of it, at most 255 characters.
std::string vtk_text(const std::string& title, int dim, int degree, const std::vector<double>& positions,
                     const std::vector<int>& cells, int cell_dim, const std::vector<VtkArray>& point_data,
                     const std::vector<VtkArray>& cell_data,
                     const std::vector<std::pair<std::string, std::string>>& provenance,
                     VtkFormat format = VtkFormat::ascii);

// Throws InputError where the file cannot be written.
void write_vtk(const std::string& path, const std::string& title, int dim, int degree,
               const std::vector<double>& positions, const std::vector<int>& cells, int cell_dim,
               const std::vector<VtkArray>& point_data, const std::vector<VtkArray>& cell_data,
               const std::vector<std::pair<std::string, std::string>>& provenance, VtkFormat format = VtkFormat::ascii);

}  // namespace almesh
