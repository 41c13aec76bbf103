// Finds by id what stands in a file with ids: a table where the ids are dense, else a sorted list.
#pragma once
#include <algorithm>
#include <utility>
#include <vector>

namespace almesh {

using IdAndIndex = std::pair<long long, int>;

// (id, index) of items that have a member `id`, ascending. Cost: a sort, only where the ids do not ascend already.
template <class Item>
std::vector<IdAndIndex> sorted_ids(const std::vector<Item>& items) {
    std::vector<IdAndIndex> sorted(items.size());
    for (std::size_t i = 0; i < items.size(); ++i) sorted[i] = {items[i].id, static_cast<int>(i)};
    if (!std::is_sorted(sorted.begin(), sorted.end())) std::sort(sorted.begin(), sorted.end());
    return sorted;
}

class IdIndex {
public:
    IdIndex() = default;

    // sorted: ascending by id, no id twice.
    explicit IdIndex(std::vector<IdAndIndex> sorted) {
        if (sorted.empty()) return;
        lowest_ = bits(sorted.front().first);
        const unsigned long long span = bits(sorted.back().first) - lowest_;
        if (span / 4 > sorted.size()) {
            sorted_ = std::move(sorted);
            return;
        }
        table_.assign(span + 1, -1);
        for (const auto& [id, index] : sorted) table_[bits(id) - lowest_] = index;
    }

    int find(long long id) const {  // -1: not there
        if (sorted_.empty()) {
            const unsigned long long place = bits(id) - lowest_;
            return place < table_.size() ? table_[place] : -1;
        }
        const auto it = std::lower_bound(sorted_.begin(), sorted_.end(), IdAndIndex(id, 0));
        return it != sorted_.end() && it->first == id ? it->second : -1;
    }

private:
    unsigned long long lowest_ = 0;
    std::vector<int> table_;           // by id - lowest_
    std::vector<IdAndIndex> sorted_;

    // Differences of ids may not fit long long, but do fit without sign.
    static unsigned long long bits(long long id) { return static_cast<unsigned long long>(id); }
};

}  // namespace almesh
