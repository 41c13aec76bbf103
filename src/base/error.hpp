// Errors that a user can cause, thrown as exceptions that carry the exit code of the program. What a solver ends with
// (no convergence, an indefinite matrix) is a result, not an error: see the status enums of linalg/ and method/.
#pragma once
#include <stdexcept>
#include <string>

namespace almesh {

enum class ExitCode {
    success = 0,            // converged, every element certified valid
    usage = 1,              // command line or deck
    input = 2,              // mesh, target or output folder
    not_converged = 3,      // the last mesh is written
    not_certified = 4,      // converged, but some element could not be certified valid
    expectation_failed = 5  // an `expect` line of the deck does not hold
};

// what() says what is wrong, where (file and line, or "command line") and what to do.
struct Error : std::runtime_error {
    ExitCode exit_code;
    Error(ExitCode code, const std::string& message) : std::runtime_error(message), exit_code(code) {}
};

struct UsageError : Error {
    explicit UsageError(const std::string& message) : Error(ExitCode::usage, message) {}
};

struct InputError : Error {
    explicit InputError(const std::string& message) : Error(ExitCode::input, message) {}
};

// Printed where an allocation fails; the exit code is `input`.
inline constexpr const char* out_of_memory = "almesh: out of memory; a coarser mesh takes less, and so may solver=cg\n";

}  // namespace almesh
