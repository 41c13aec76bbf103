// Many runs of one deck: one for each combination of the values of its lines
//
//   sweep KEY = VALUES            # any key of the deck or `let` constant; the last line varies fastest
//
// VALUES: separated by commas, FROM : STEP : TO for all of a range. Each run is the one of `almesh DECK KEY=VALUE ...`,
// to the last bit, in a folder of its own named by its values: outputs/circle/mu0=10,refine=1. A run that has come to
// its end, whatever that was, leaves the file sweep.row there, and is not done again while deck, its files and program
// are the same; runs that were killed have none. The runs of a sweep that is killed are killed with it.
#pragma once
#include <cstdio>
#include <string>
#include <vector>

#include "base/error.hpp"

namespace almesh {

// arguments: DECK, settings of the command line, and at most one of
//
//   --slurm      write sweep.sh, the batch script of a job array of Slurm, instead of running
//   --run K/N    only the runs K, K + N, K + 2 N, ...: a task of that array
//   --collect    only gather what has been run
//
// Otherwise as many runs at a time as there are cores for their threads. Writes sweep.csv in the deck's folder of
// results: a row for each run that has ended, with all quantities of its summary. The exit code is the lowest of a run
// but success; a run that is missing counts as not_converged. Throws UsageError for what is wrong with any run's deck
// before the first one starts, and InputError where another sweep writes to the folder.
ExitCode sweep(const std::vector<std::string>& arguments, std::FILE* out);

}  // namespace almesh
