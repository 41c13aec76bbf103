// The iterations of a run as they happen, in the units of the mesh file and twice: as a table on the terminal and in
// history.csv.
//
// Table: a row per augmented Lagrangian iteration and, on a terminal, one line that follows the Newton iterations and
// is overwritten. history.csv: one row per augmented Lagrangian iteration (kind `al`, row 0 the mesh at the start) and,
// before it, one per Newton iteration of its subproblem (kind `newton`); first of all one per coarser mesh (kind
// `coarse`: its last iteration, all its Newton steps). Columns that a kind does not have are empty. Name, meaning and
// cells of every column: one table in iteration_table.cpp. Numbers with all digits. In JSON each row is an object.
#pragma once
#include <cstdio>
#include <string>
#include <vector>

#include "base/table.hpp"
#include "problem/solution.hpp"

namespace almesh {

struct SolveObserver;
struct Stage;

std::string history_heading();
std::vector<Named> history_columns();  // for the list of keys

class IterationTable {
public:
    // Prints the header of the table, if it is shown. run: its id.
    IterationTable(const Output& out, const Units& units, const std::string& run, bool is_shown = true);

    void add(const Stage& stage);
    void add(const AlIteration& row);
    void add(int al_iteration, const NewtonStep& step);

    SolveObserver observer();  // which adds what it is told of; the table must outlive it

    const std::string& rows() const { return rows_; }  // of history.csv
    std::string csv() const { return history_heading() + rows_; }
    int fallbacks = 0;     // those in which an iterative solver failed and Cholesky took over

private:
    Output out_;
    bool is_shown_, is_terminal_;
    Units units_;
    std::string run_;
    std::string rows_;
    void keep(const Fields& row);
    // update: nullptr for the mesh at the start.
    void show(const AlIteration& row, const char* update, const std::string& note);
};

}  // namespace almesh
