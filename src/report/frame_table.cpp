#include "report/frame_table.hpp"

#include <algorithm>
#include <cstring>
#include <filesystem>

#include "deck/deck.hpp"
#include "problem/frame_solver.hpp"
#include "report/iteration_table.hpp"
#include "report/results.hpp"
#include "base/files.hpp"
#include "base/table.hpp"
#include "base/version.hpp"
#include "method/status.hpp"

namespace almesh {
namespace {

std::string csv_of(const Deck& deck) { return deck.output + "/frames.csv"; }
std::string history_of(const Deck& deck) { return deck.output + "/history.csv"; }
std::string series_of(const Deck& deck) { return deck.output + "/frames.vtk.series"; }

// What the table needs of it; number 0 where it is no row.
FrameRow row_of(std::string_view line) {
    constexpr std::size_t path = 10;
    const auto cell = split(line, ',');
    const auto label = split(cell[0], '-');
    const auto number = parse_int(label[0], 1), code = cell.size() > path + 1 ? parse_int(cell[3]) : std::nullopt;
    if (!number || !code) return {};
    FrameRow row{*number, label.size() > 1 ? parse_int(label[1]).value_or(0) : 0, parse_double(cell[1]).value_or(0),
                 std::string(cell[2])};
    row.code = static_cast<ExitCode>(*code);
    row.path = cell[path];
    return row;
}

std::string state_of(const Deck& deck) { return concat(deck.output, "/", frames_state); }

// What the file begins with, before the number of the frame.
std::string begin_of_state(const Problem& problem) {
    return concat("almesh frames, ", version(), " ", commit(), ", run ", problem.run_id, ", frame ");
}

}  // namespace

void FrameRow::refuse(const Error& error) {
    code = error.exit_code;
    status = "refused";
    note = error.what();
}

Fields FrameRow::cells(bool with_mesh) const {
    const auto of_mesh = [&](const Field& cell) { return started_from.empty() ? "" : cell; };
    Fields cells = {{"frame", label()}, {"t", t}, {"status", status}, {"exit_code", static_cast<int>(code)},
                   {"newton_steps", of_mesh(newton_steps)}, {"max_distortion", of_mesh(max_distortion)},
                   {"relative_quality", of_mesh(relative_quality)}, {"certified_bound", of_mesh(min_certified_bound)},
                   {"certified", of_mesh(certified ? "yes" : "no")}, {"started_from", started_from}, {"path", path},
                   {{"seconds", "", "s"}, rounded_down(seconds, 4)}, {"note", sentence(note)}};
    if (with_mesh) cells.emplace_back("mesh", mesh);
    return cells;
}

bool FrameRow::has_mesh() const { return status == status_row(Status::converged).name; }
std::string FrameRow::label() const { return between > 0 ? concat(number, "-", between) : std::to_string(number); }

std::string FrameRow::file_name() const {
    return frame_name(number) + (between > 0 ? concat("-", between) : std::string());
}

void FrameTable::read(int last) {
    const std::string csv = read_file(csv_of(deck_));
    for (const std::string_view line : split(csv, '\n'))
        if (const FrameRow row = row_of(line); row.number > 0 && row.number <= last) place(row, concat(line, "\n"));
    next_ = {};
    std::error_code error;
    if (!std::filesystem::exists(history_of(deck_), error)) return;
    for (const std::string text = read_file(history_of(deck_)); const std::string_view line : split(text, '\n'))
        if (const int frame = parse_int(line.substr(0, line.find(','))).value_or(0); frame > 0 && frame <= last)
            history_ += concat(line, "\n");
}

// Whether it is at the end.
bool FrameTable::place(const FrameRow& row, const std::string& line) {
    next_.lines += line;
    if (row.has_mesh()) next_.meshes.emplace_back(row.file_name() + ".vtk", row.t);
    if (row.between > 0) return true;
    next_.row = row;
    next_.row.history.clear();
    const Entry entry = std::exchange(next_, {});
    const std::size_t k = row.number - 1;
    if (k < frames_.size() && (row.has_mesh() || !frames_[k].row.has_mesh())) frames_[k] = entry;
    if (k < frames_.size()) return false;
    frames_.push_back(entry);
    return true;
}

void FrameTable::add(const FrameRow& row, bool writes) {
    const bool at_end = place(row, csv_row(row.cells(false)));
    for (const std::string_view line : split(row.history, '\n'))
        if (!line.empty()) history_ += concat(row.number, ",", line, "\n");
    if (row.between > 0 || !writes) return;
    if (has_history_) append_to_file(history_of(deck_), history_);
    else if (!history_.empty()) write_file(history_of(deck_), "frame," + history_heading() + history_);
    has_history_ = !std::exchange(history_, {}).empty() || has_history_;
    if (!begun_ || !at_end) return write();
    append_to_file(csv_of(deck_), frames_.back().lines);
    for (const auto& [name, t] : frames_.back().meshes)
        if (deck_.vtk != VtkOutput::none) append_to_series(series_of(deck_), name, t);
}

void FrameTable::write() {
    std::string csv = csv_heading(FrameRow().cells(false));
    std::vector<std::pair<std::string, double>> series;
    for (const Entry& frame : frames_) {
        csv += frame.lines;
        series.insert(series.end(), frame.meshes.begin(), frame.meshes.end());
    }
    write_file(csv_of(deck_), csv);
    if (deck_.vtk != VtkOutput::none && !series.empty()) write_series(series_of(deck_), series);
    begun_ = !series.empty();
}

ExitCode FrameTable::code() const {
    ExitCode worst = ExitCode::success;
    for (const Entry& frame : frames_)
        if (frame.row.code != ExitCode::success)
            worst = worst == ExitCode::success ? frame.row.code : std::min(worst, frame.row.code);
    return worst;
}

int FrameTable::count(const std::string& path) const {
    const auto is_so = [&](const Entry& frame) { return frame.row.path == path; };
    return static_cast<int>(std::count_if(frames_.begin(), frames_.end(), is_so));
}

void save_state(const Deck& deck, const Problem& problem, const FramesBefore& before, int number) {
    std::string state = concat(begin_of_state(problem), number, "\n");
    for (std::size_t k = std::max<std::size_t>(before.moments.size(), 2) - 2; k < before.moments.size(); ++k) {
        const auto& [t, x, motions] = before.moments[k];
        state.append(reinterpret_cast<const char*>(&t), sizeof t);
        state.append(reinterpret_cast<const char*>(x.data()), x.size() * sizeof(double));
    }
    write_file(state_of(deck), state);
}

int read_state(const Deck& deck, const Problem& problem, FramesBefore& before) {
    std::error_code error;
    if (!std::filesystem::exists(state_of(deck), error)) return 0;
    const std::string text = read_file(state_of(deck)), first = text.substr(0, text.find('\n'));
    std::string_view bytes = std::string_view(text).substr(std::min(text.size(), first.size() + 1));
    const std::size_t of_mesh = (problem.mesh().x.size() + 1) * sizeof(double);
    const auto number = parse_int(first.substr(first.rfind(' ') + 1), 1);
    if (!first.starts_with(begin_of_state(problem)) || !number || (bytes.size() != of_mesh && bytes.size() != 2 * of_mesh))
        throw UsageError("cannot resume: ", state_of(deck), " is of another run or program; without resume=1 this run ",
                         "starts from the beginning and removes it");
    for (; !bytes.empty(); bytes.remove_prefix(of_mesh)) {
        auto& [t, x, motions] = before.moments.emplace_back();
        x.resize(problem.mesh().x.size());
        std::memcpy(&t, bytes.data(), sizeof t);
        std::memcpy(x.data(), bytes.data() + sizeof t, of_mesh - sizeof t);
    }
    return *number;
}

}  // namespace almesh
