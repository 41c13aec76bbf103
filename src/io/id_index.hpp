// Index of an item by its id in a file: a table for ids up to a few times the number of items, a hash table for others.
#pragma once
#include <cstddef>
#include <unordered_map>
#include <vector>

namespace almesh {

class IdIndex {
public:
    // items: about how many there will be; 16 bytes each are allocated.
    explicit IdIndex(std::size_t items = 0) : table_(4 * items, -1) {}

    // The index that has the id already, or -1 and the id has this index from now on.
    int insert(long long id, int index) {
        int& place = in_table(id) ? table_[id] : sparse_.try_emplace(id, -1).first->second;
        if (place >= 0) return place;
        place = index;
        return -1;
    }

    int find(long long id) const {  // -1: not there
        if (in_table(id)) return table_[id];
        const auto it = sparse_.find(id);
        return it == sparse_.end() ? -1 : it->second;
    }

private:
    std::vector<int> table_;  // by id
    std::unordered_map<long long, int> sparse_;

    bool in_table(long long id) const { return id >= 0 && static_cast<unsigned long long>(id) < table_.size(); }
};

}  // namespace almesh
