// Ids of items as their file has them, and ids for what a file does not have: those after its largest one, and where no
// number is larger, the lowest free ones.
#pragma once
#include <algorithm>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

namespace almesh {

// The file's id of item i, or i where there is no file.
inline long long id_in_file(const std::vector<long long>& ids, int i) { return ids.empty() ? i : ids[i]; }

template <class Id>
class UnusedIds {
public:
    explicit UnusedIds(std::vector<Id> taken) : taken_(std::move(taken)) {
        for (const Id id : taken_) largest_ = std::max(largest_, id);
    }

    Id next() {
        if (largest_ < std::numeric_limits<Id>::max()) return ++largest_;
        if (lowest_ == 1) std::sort(taken_.begin(), taken_.end());
        for (; place_ < taken_.size() && taken_[place_] <= lowest_; ++place_) lowest_ += taken_[place_] == lowest_;
        return lowest_++;
    }

private:
    std::vector<Id> taken_;
    Id largest_ = 0, lowest_ = 1;
    std::size_t place_ = 0;  // among the sorted ones: all before are below lowest_
};

}  // namespace almesh
