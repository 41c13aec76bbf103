// What is told of the frames of a motion: frames.csv, a row for each, history.csv, the iterations of those that were
// solved anew with the number of the frame before them, and frames.vtk.series, which plays their VTK files. All grow at
// their ends.
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "base/table.hpp"

namespace almesh {

struct Deck;
struct FramesBefore;
struct Problem;

// How the nodes go from the frame before to this one, each on a straight line.
namespace frame_path {
inline constexpr const char* valid = "valid";          // certified: no element is inverted on the way
inline constexpr const char* not_valid = "not valid";  // and not by frames at times between either
}  // namespace frame_path

struct FrameRow {
    int number = 0;  // from 1
    int between = 0;  // 1, 2, ... of those at times between the frame before and this one; 0: of the time itself
    double t = 0;
    std::string status = "refused", started_from = {}, path = {}, note = {};
    std::string mesh = {};     // its file
    std::string history = {};  // rows of history.csv, without the frame
    ExitCode code = ExitCode::success;
    int newton_steps = 0;
    double max_distortion = 0, relative_quality = 0, min_certified_bound = 0, seconds = 0;
    bool certified = false;

    void refuse(const Error& error);
    Fields cells(bool with_mesh) const;  // of the table; with_mesh: and its file, which that has not
    bool has_mesh() const;
    std::string label() const;      // "3", or "3-1"
    std::string file_name() const;  // "frame-0003", or "frame-0003-1"
};

class FrameTable {
public:
    explicit FrameTable(const Deck& deck) : deck_(deck) {}

    // The rows of an earlier run, up to the frame `last`.
    void read(int last);
    // The next one; those between come before their frame, and are written with it, where `writes` is not false. A
    // frame that is asked for again takes the place of the first try; in vain, its mesh stays.
    void add(const FrameRow& row, bool writes = true);

    std::size_t size() const { return frames_.size(); }  // frames, without those between
    const FrameRow& operator[](std::size_t k) const { return frames_[k].row; }
    ExitCode code() const;                   // the lowest of a frame but success
    int count(const std::string& path) const;  // frames

private:
    struct Entry {
        FrameRow row;
        std::string lines;  // of it and of those between
        std::vector<std::pair<std::string, double>> meshes;
    };

    const Deck& deck_;
    std::vector<Entry> frames_;
    Entry next_;          // what is between
    bool begun_ = false;  // whether table and series are there, of this run,
    bool has_history_ = false;  // and whether that is
    std::string history_;       // rows that are not written yet

    bool place(const FrameRow& row, const std::string& line);
    void write();
};

// What a run goes on from, in the folder of results until it has ended: the number of the last frame and the meshes that
// the next one may start from, to the last bit.
inline constexpr const char* frames_state = "frames.state";

void save_state(const Deck& deck, const Problem& problem, const FramesBefore& before, int number);

// Without their motions. Returns the number of the last frame, 0 where there is no state. Throws UsageError where it is
// of another run.
int read_state(const Deck& deck, const Problem& problem, FramesBefore& before);

}  // namespace almesh
