// What the machine itself can do, measured in the same run as the kernels: the limits they are held against.
//
//   peak       multiply-adds on registers alone, 2 operations each; no kernel can do more per second
//   bandwidth  a_i = b_i + s c_i on arrays far beyond the caches: 32 bytes per entry, because a cache line of a is read
//              before it is written
#pragma once
#include <vector>

#include "bench/table.hpp"

namespace almesh::bench {

struct Machine {
    std::vector<int> threads;      // 1 and all of the machine's
    std::vector<double> peak;      // operations per second, for each number of threads
    std::vector<double> bandwidth;  // bytes per second
};

Machine measure_machine(Table& table);

}  // namespace almesh::bench
