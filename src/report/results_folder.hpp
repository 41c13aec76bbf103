// The folder of a run's results, for one run at a time.
#pragma once
#include <string>

namespace almesh {

struct Deck;

inline constexpr const char* frames_log = "frames.log";  // what a coupled run says of its progress
inline constexpr const char* sweep_row = "sweep.row";     // of a run of a sweep that has ended

// Of the operating system on the file almesh.lock in the folder, for the life of the object; a killed process, and those
// that it has started, lose it with their end. The file says whose it is. Throws InputError where another one has it.
class FolderLock {
public:
    explicit FolderLock(const std::string& folder);
    ~FolderLock();
    FolderLock(const FolderLock&) = delete;
    FolderLock& operator=(const FolderLock&) = delete;

private:
    std::string path_;
    int file_ = -1;  // its descriptor
};

// From here on the folder belongs to this run, until the end of the object: it is made where it is missing and locked,
// and what an earlier run has left in it is removed, so that whatever lies there after a run was killed is that run's.
// deck.txt, of which the run writes a new one at once, stays until then, with `resume` the frames of the run before, and
// so-far.msh where the run starts from it. The meshes of a coupled run, and all that is beside them, stay until another
// run of frames has its first mesh and calls empty().
//
// Throws InputError where the folder cannot be made or written to, where another run has it, and UsageError where the
// mesh or a file of targets is among the results that would be removed, or the meshes are those of a coupled run of
// another mesh: nothing has been touched then.
class ResultsFolder {
public:
    explicit ResultsFolder(const Deck& deck);
    bool is_kept() const { return kept_; }
    void empty();

private:
    const Deck& deck_;
    FolderLock lock_;
    bool kept_;
};

}  // namespace almesh
