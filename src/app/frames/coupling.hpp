// frames = -: a solver beside this program asks for one mesh after the other, by lines of standard input, and goes on
// when it has read the answer, a line of standard output. Each line has exactly one answer.
//
//   asked:  T [FILE ...]                 the time, and the files of the deck's steps that are named `-`, in their order
//   told:   T converged MESH             the mesh is on disk and certified
//           T way_not_valid MESH         so is this one, but on their straight ways from the mesh before nodes invert
//                                        elements
//           T STATUS SENTENCE            there is none; STATUS: refused, stalled, not_certified, ...; T: - for a line
//                                        that is empty
//
// A repeated time is a time step that is tried again, and its mesh replaces the last one: a mesh depends on the times
// before it and on the files alone, not on earlier tries. The progress of the run is written to frames.log.
#pragma once
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

namespace almesh {

inline constexpr const char* way_not_valid = "way_not_valid";

struct AskedFrame {
    double t;
    std::vector<std::string> files;
};

class Coupling {
public:
    // files: how many are in each line. Where it is one, it is all that follows the time, blanks included.
    Coupling(std::FILE* in, std::FILE* out, int files) : in_(in), out_(out), files_(files) {}

    // The next line; nothing at the end of the input. Lines that ask for no frame are refused and skipped.
    // reached: the time of the last mesh, before which there is none. Throws Error where the run is interrupted.
    std::optional<AskedFrame> next(double reached);

    // Of the frame that was asked for last. Throws InputError where nobody reads it.
    void tell(const std::string& status, const std::string& what);

private:
    std::FILE *in_, *out_;
    int files_;
    std::string time_;  // as it was written

    std::optional<std::string> read_line();
    AskedFrame parse(const std::string& line, double reached);
};

}  // namespace almesh
