// Times the kernels against the machine's own limits, and whole runs. From the top folder, where ./almesh is:
//
//   make bench            some minutes
//   make bench QUICK=1    without the dear meshes
//
// Prints tables and writes outputs/bench.csv.
#include <cstdio>
#include <string>

#include "base/error.hpp"
#include "base/files.hpp"
#include "bench/decks.hpp"
#include "bench/kernels.hpp"

int main(int argc, char** argv) {
    using namespace almesh;
    const bool quick = argc > 1 && std::string(argv[1]) == "quick";
    bench::Table table;
    try {
        make_folder("outputs");
        const bench::Machine machine = bench::measure_machine(table);
        bench::measure_decks(machine, quick, table);
        bench::measure_frames(machine, quick, table);
        bench::measure_scaling(quick, table);
        bench::measure_kernels(machine, quick, table);
        bench::measure_cells(machine, quick, table);
        write_file("outputs/bench.csv", table.csv());
    } catch (const Error& error) {
        std::fprintf(stderr, "bench: %s\n", error.what());
        return 1;
    }
    std::printf("\noutputs/bench.csv\n");
    return 0;
}
