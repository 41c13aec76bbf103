// The iterations of a run as they happen, in the units of the mesh file and twice: as a table on the terminal and in
// history.csv.
//
// Table: a row per augmented Lagrangian iteration and, on a terminal, one line that follows the Newton iterations and
// is overwritten. history.csv: one row per augmented Lagrangian iteration (kind `al`, row 0 the mesh at the start) and,
// before it, one per Newton iteration of its subproblem (kind `newton`); first of all one per coarser mesh (kind
// `coarse`: its last iteration, all its Newton steps). Columns that a kind does not have are empty. Name, meaning and
// cells of every column: one table in iteration_table.cpp. Numbers with all digits.
#pragma once
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "base/text.hpp"

namespace almesh {

struct AlIteration;
struct Stage;
struct NewtonStep;

// From the run's unit of length (Problem::frame) to that of the mesh file. The distortion eta has no unit, so that an
// energy is a volume; the product (1, 1) = |1|^2 of constraint/dirichlet.hpp has the unit length^(dim - 2).
struct Units {
    int dim;
    double length;  // of the run, in units of the mesh file

    double distance(double value) const { return value * length; }
    double energy(double value) const { return value * std::pow(length, dim); }
    double gradient(double value) const { return energy(value) / length; }            // of the energy
    double penalty(double value) const { return energy(value) / (length * length); }  // mu
    // At a point: lambda, and c = (phi - g_D) / |1|.
    double multiplier(double value) const { return value * std::pow(length, 0.5 * dim); }
    double constraint(double value) const { return value * std::pow(length, 2 - 0.5 * dim); }
    AlIteration of(AlIteration row) const;
    NewtonStep of(NewtonStep step) const;
};

std::string history_heading();
std::vector<Named> history_columns();  // for the list of keys

class IterationTable {
public:
    // Prints the header of the table. run: its id.
    IterationTable(std::FILE* out, const Units& units, const std::string& run);

    void add(const Stage& stage);
    void add(const AlIteration& row);
    void add(int al_iteration, const NewtonStep& step);

    const std::string& rows() const { return rows_; }  // of history.csv
    std::string csv() const { return history_heading() + rows_; }
    int newton_steps = 0;  // added so far: rows of kind `newton`
    int fallbacks = 0;     // those in which an iterative solver failed and Cholesky took over
    double reached = 0;   // the largest part of the motion, less than all of it, that converged

private:
    std::FILE* out_;
    bool is_terminal_;
    Units units_;
    std::string run_;
    std::string rows_;
    // update: nullptr for the mesh at the start.
    void show(const AlIteration& row, const char* update, const std::string& note);
};

}  // namespace almesh
