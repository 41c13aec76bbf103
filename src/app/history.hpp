// history.csv: one row per augmented Lagrangian iteration (kind `al`, row 0 the mesh at the start) and, before it, one
// per Newton iteration of its subproblem (kind `newton`), in the order they happened; first of all one per coarser mesh
// (kind `coarse`: its last iteration, all its Newton steps). Columns that a kind does not have are empty. Name, meaning
// and cells of every column: one table in history.cpp. Numbers are in the unit of the mesh file, with all digits.
#pragma once
#include <string>

#include "app/units.hpp"

namespace almesh {

struct AlIteration;
struct CoarseStage;
struct NewtonStep;

class History {
public:
    // length: the run's unit, in units of the mesh file.
    History(int dim, double length);
    void add(const CoarseStage& stage);
    void add(const AlIteration& row);
    void add(int al_iteration, const NewtonStep& step);
    const std::string& csv() const { return text_; }
    int newton_steps() const { return newton_steps_; }  // rows of kind `newton`

private:
    Units units_;
    std::string text_;
    int newton_steps_ = 0;
};

std::string columns_table();  // one line each: name and meaning, for the list of keys

}  // namespace almesh
