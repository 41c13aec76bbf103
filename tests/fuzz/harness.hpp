// Fuzzing in process: a harness feeds any bytes to a part of the program and throws a Violation where what comes out
// breaks a promise. Crashes, sanitizers' reports and hangs are for whoever calls it: libFuzzer (libfuzzer.cpp, `make
// fuzz`), or the replay of the seeds in `make test` (replay_test.cpp).
#pragma once
#include <stdexcept>
#include <string_view>

#include "support/program.hpp"

namespace almesh::fuzz {

// Any text is a deck, with settings of the command line after zero bytes, or refused; a deck as resolved is the same.
void fuzz_deck(std::string_view bytes);

// Any file is a mesh or refused; written in each version of MSH it reads back the same, and `info` prints a deck.
void fuzz_msh(std::string_view bytes);
void fuzz_su2(std::string_view bytes);
void fuzz_vtk(std::string_view bytes);
void fuzz_inp(std::string_view bytes);
void fuzz_vtu(std::string_view bytes);

// Any file is a list of frames, or rows of nodes and their vectors, or refused in a sentence.
void fuzz_frames(std::string_view bytes);
void fuzz_rows(std::string_view bytes);

// A small mesh with nodes moved and its file damaged: `quality` certifies only what is valid and does not overlap.
void fuzz_quality(std::string_view bytes);

// The same by `improve`: after exit code 0 the final mesh is valid.
void fuzz_improve(std::string_view bytes);

// Such a mesh moved by a deck of legal keys: exit code 0 only with a final mesh that is valid and in place. A run that
// leaves its state behind goes on from it, damaged or not.
void fuzz_run(std::string_view bytes);

// Calls of the interface for C in any order: each ends with a code and a sentence, and a mesh that is called certified is.
void fuzz_library(std::string_view bytes);

struct Harness {
    std::string_view name;
    void (*run)(std::string_view bytes);
};

inline constexpr Harness harnesses[] = {{"deck", fuzz_deck},
                                        {"msh", fuzz_msh},
                                        {"su2", fuzz_su2},
                                        {"vtk", fuzz_vtk},
                                        {"inp", fuzz_inp},
                                        {"vtu", fuzz_vtu},
                                        {"frames", fuzz_frames},
                                        {"rows", fuzz_rows},
                                        {"quality", fuzz_quality},
                                        {"improve", fuzz_improve},
                                        {"run", fuzz_run},
                                        {"library", fuzz_library}};

struct Violation : std::logic_error {
    using std::logic_error::logic_error;
};

template <class... Parts>
void demand(bool holds, const Parts&... parts) {
    if (!holds) throw Violation(concat(parts...));
}

// The command's outcome. One of the documented exit codes, with a message that the program has chosen itself.
test::Outcome outcome_of(const std::vector<std::string>& arguments);

// One for the process; it stays where that crashes, with the files at hand.
const test::TemporaryFolder& work_folder();

}  // namespace almesh::fuzz
