// Errors that a user can cause, thrown as exceptions that carry the exit code of the program. What a solver ends with
// (no convergence, an indefinite matrix) is a result, not an error: see the status enums of linalg/ and method/.
#pragma once
#include <stdexcept>
#include <string>

#include "base/text.hpp"

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

// parts: of the message, see concat().
template <ExitCode code>
struct ErrorOf : Error {
    template <class... Parts>
    explicit ErrorOf(const Parts&... parts) : Error(code, concat(parts...)) {}
};
using UsageError = ErrorOf<ExitCode::usage>;
using InputError = ErrorOf<ExitCode::input>;

// Of one of the settings, by its name; the deck, which has them as keys, adds the line.
struct SettingError : UsageError {
    std::string key;
    template <class... Parts>
    explicit SettingError(std::string of_key, const Parts&... parts) : UsageError(parts...), key(std::move(of_key)) {}
};

// Printed where an allocation fails; the exit code is `input`.
inline constexpr const char* out_of_memory = "out of memory; a coarser mesh takes less";

}  // namespace almesh
