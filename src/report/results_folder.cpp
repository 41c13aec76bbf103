#include "report/results_folder.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <string_view>
#include <utility>
#include <vector>

#include "deck/deck.hpp"
#include "io/mesh_format.hpp"
#include "report/frame_table.hpp"
#include "deck/frame_times.hpp"
#include "deck/so_far.hpp"
#include "base/error.hpp"
#include "base/files.hpp"

namespace almesh {
namespace {

namespace fs = std::filesystem;

// Or of its proof.
bool is_ending_of_mesh(std::string_view ending) {
    const auto is_one = [&](const MeshFormat& format) {
        return ending == format.ending || ending == ending_of_final({format.ending});
    };
    return ending == ".proof" || ending == ".proof.msh" ||
           std::any_of(std::begin(mesh_formats), std::end(mesh_formats), is_one);
}

// frame-0001.msh, frame-0001-1.msh, and what is told of all of them.
bool is_of_frame(const std::string& name) {
    const std::string ending = name.substr(std::min(name.find_last_of("0123456789") + 1, name.size()));
    return name == "frames.csv" || name == "frames.vtk.series" || name == "history.csv" || name == frames_state ||
           name == frames_log ||
           (name.starts_with("frame-") && (is_ending_of_mesh(ending) || ending == "-velocity.csv" ||
                                           ending == "-swept.csv"));
}

// What a run may write, but for deck.txt and the mesh so far.
bool is_result(const std::string& name) {
    constexpr std::array<std::string_view, 11> results = {
        "initial.vtk", "final.vtk", "boundary.vtk", "stop.vtk", sweep_row,
        "summary.txt", "quality.csv", "expectations.csv", "moved-nodes.csv", "invalid.csv", "iterates.vtk.series"};
    return (name.starts_with("final") && is_ending_of_mesh(name.substr(5))) || is_of_frame(name) ||
           ((name.starts_with("adjoint-") || name.starts_with("tangent-")) && name.ends_with(".csv")) ||
           (name.starts_with("iterate-") && name.ends_with(".vtk")) ||
           std::find(results.begin(), results.end(), name) != results.end();
}

// Left by a process that was killed while it wrote a result: "final.msh.part1234".
bool is_part(const std::string& name) {
    const auto at = name.rfind(".part");
    if (at == std::string::npos) return false;
    const std::string of = name.substr(0, at);
    return (is_result(of) || of == "deck.txt" || of == "so-far.msh") &&
           name.find_first_not_of("0123456789", at + std::string_view(".part").size()) == std::string::npos;
}

std::vector<std::string> names_in(const std::string& folder) {
    std::vector<std::string> names;
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(folder, error)) names.push_back(entry.path().filename().string());
    return names;
}

void check_is_not_result(const std::string& file, const std::string& where, const Deck& deck) {
    std::error_code error;
    const fs::path folder = fs::weakly_canonical(deck.output, error), path = fs::weakly_canonical(file, error);
    if (path.parent_path() != folder || !is_result(path.filename().string())) return;
    throw UsageError(where, ": ", file, " is among the results in the folder ", deck.output,
                     ", which this run would replace: give it another folder, `output = FOLDER`");
}

// Whether there are meshes of a coupled run: they are another program's, and no run makes them again by itself.
bool has_coupled_meshes(const std::string& folder) {
    const std::vector<std::string> names = names_in(folder);
    const auto is_mesh = [](const std::string& name) { return name.starts_with("frame-") && is_of_frame(name); };
    return std::find(names.begin(), names.end(), frames_log) != names.end() &&
           std::any_of(names.begin(), names.end(), is_mesh);
}

void check_coupled_meshes(const Deck& deck) {
    const std::string path = deck.output + "/deck.txt", key = "mesh = ";
    std::error_code error;
    if (!has_coupled_meshes(deck.output) || !fs::exists(path, error)) return;
    for (const std::string text = read_file(path); const std::string_view line : split(text, '\n')) {
        if (!line.starts_with(key)) continue;
        const std::string mesh = without_quotes(line.substr(key.size())).value_or("");
        const fs::path before = fs::weakly_canonical(fs::path(deck.output) / mesh, error);
        if (before == fs::weakly_canonical(deck.mesh, error)) continue;
        throw UsageError(deck.output, " has the meshes of a coupled run of another mesh, ", mesh,
                         ", which this run would remove: give it another folder, `output = FOLDER`");
    }
}

// The deck's folder, where nothing that the run reads is among the results.
const std::string& checked_folder(const Deck& deck) {
    check_coupled_meshes(deck);
    check_is_not_result(deck.mesh, deck.given.contains("mesh") ? deck.given.at("mesh") : deck.path, deck);
    if (deck.start == Start::file) check_is_not_result(deck.start_file, deck.given.at("start"), deck);
    for (const BoundaryMotion& boundary : deck.boundaries)
        for (const MotionStep& step : boundary.motion.steps)
            if (!step.file.empty()) check_is_not_result(step.file, boundary.where, deck);
    make_folder(deck.output);
    return deck.output;
}

}  // namespace

ResultsFolder::ResultsFolder(const Deck& deck)
    : deck_(deck), lock_(checked_folder(deck)), kept_(!deck.frames.empty() && has_coupled_meshes(deck.output)) {
    if (!kept_) empty();
}

// A coupled run has its log open.
void ResultsFolder::empty() {
    const bool goes_on = !std::exchange(kept_, false) && deck_.resume;
    std::error_code error;
    if (!fs::equivalent(path_so_far(deck_), deck_.start_file, error)) remove_file(path_so_far(deck_));
    for (const std::string& name : names_in(deck_.output))
        if (is_part(name) || (is_result(name) && !(goes_on && is_of_frame(name)) &&
                              !(name == frames_log && is_coupled(deck_.frames))))
            remove_file(deck_.output + "/" + name);
}

FolderLock::FolderLock(const std::string& folder) : path_(folder + "/almesh.lock") {
    for (;;) {
        const int file = open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
        if (file < 0) throw InputError("cannot write to ", path_, ": ", std::strerror(errno));
        if (flock(file, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
            char owner[300] = {};
            if (read(file, owner, sizeof owner - 1) <= 0) std::strcpy(owner, "another process");
            close(file);
            throw InputError("another run writes to ", folder, " (", owner,
                             "): wait for its end, or give this one another folder, `output = FOLDER`");
        }
        struct stat locked {}, there {};
        const bool is_there = fstat(file, &locked) == 0 && stat(path_.c_str(), &there) == 0;
        if (is_there && locked.st_ino == there.st_ino) {  // else its owner has just removed it
            file_ = file;
            break;
        }
        close(file);
    }
    char host[256] = {};
    const bool is_known = gethostname(host, sizeof host - 1) == 0;
    const std::string owner = concat("process ", getpid(), " on ", is_known ? host : "this machine");
    if (ftruncate(file_, 0) != 0 || write(file_, owner.data(), owner.size()) < 0)
        throw InputError("cannot write to ", path_, ": ", std::strerror(errno));
}

FolderLock::~FolderLock() {
    unlink(path_.c_str());
    close(file_);
}

}  // namespace almesh
