// The state of a run, saved while it goes on: after a crash another process goes on from there and ends with the same
// bits.
//
// A run is a sequence of minimisations by Newton's method. All that happens between them, multipliers, schedules, parts
// of the motion, powers, finer meshes, is cheap and follows from their results. So these are what is saved: a file for
// every minimisation, numbered in their order. Who resumes starts from the beginning and takes the ends that were saved
// instead of computing them; the minimisation at which the run was interrupted is computed anew.
//
// A file is written whole or not at all, and ends with the hash of what is before it, so that neither a process that
// was killed nor a full disk nor a power failure leaves a state that is wrong.
#pragma once
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/interrupt.hpp"  // Clock
#include "energy/distortion_energy.hpp"
#include "linalg/linear_solver.hpp"
#include "method/newton.hpp"

namespace almesh {

// What a minimisation came to: all that the next ones depend on.
struct Minimised {
    std::string start;  // a hash of x where it began, of the multipliers and of E there
    NewtonResult result;
    NewtonMemory memory;
    QuadratureState quadrature;
    std::vector<double> x;
    std::vector<NewtonStep> steps;  // for those who follow the run
};

struct AugmentedFunctional;

class Checkpoint {
public:
    using Tell = std::function<void(const std::string& note)>;

    // folder: of the files, made when the first one is written. run: its id and the program's, which must be the same
    // to resume. seconds: between two savings. tell: what the user should know. Throws UsageError where `resume` is
    // wanted and the folder has the state of another run.
    Checkpoint(std::string folder, std::string run, double seconds, bool resume, Tell tell);

    int minimisations() const { return last_; }  // that were saved

    // The next minimisation begins. Returns what was saved of it; start: what tells it from others.
    std::optional<Minimised> next(const std::string& start);

    // The end of the minimisation that was begun last, written when `seconds` have gone since the last writing.
    void save(Minimised minimised);
    // What has not been written yet. A file that cannot be written is told of once, and tried again with the next.
    void write();

    // Removes the files, and the folder where it has no others.
    static void remove(const std::string& folder);

private:
    std::string folder_, run_;
    double seconds_;
    Tell tell_;
    int number_ = 0, last_ = 0;  // of the minimisation at hand, and of the last that is read
    bool has_failed_ = false;    // to write a file
    Clock::time_point written_ = Clock::now();
    std::vector<std::pair<int, Minimised>> unwritten_;  // by number

    std::string path(int number) const;
    std::string contents(Minimised& minimised) const;
    std::optional<Minimised> read(int number) const;
};

// newton.minimise(E, params, x, observe), or what was saved of it. checkpoint: null for none.
NewtonResult minimise_or_recall(Checkpoint* checkpoint, Newton& newton, const AugmentedFunctional& E,
                                const NewtonParams& params, std::vector<double>& x, const NewtonObserver& observe);

}  // namespace almesh
