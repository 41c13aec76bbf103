// The element types of MSH files by their numbers (GmshDefines.h).
#pragma once
#include <string>
#include <vector>

#include "mesh/cells.hpp"

namespace almesh {

struct MshType {
    int number;
    const CellType* cell = nullptr;  // none: not a complete cell of the table of a degree up to max_degree
    int degree = 0, nodes = 0;  // nodes: in the file
};

MshType msh_type(int number);

// Elements of types that are not read, counted to be refused all together.
struct ForeignMshElements {
    struct Kind {
        int type, line;  // of the first; 0: of a binary file
        long long count;
    };
    std::vector<Kind> kinds;

    void add(int type, int line, long long count);
    std::string message() const;  // what they are, with what to do about them
};

}  // namespace almesh
