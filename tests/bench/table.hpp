// The numbers of a benchmark: printed as tables, written as outputs/bench.csv.
#pragma once
#include <string>
#include <vector>

namespace almesh::bench {

struct Entry {
    std::string group, name;  // name: the kernel with its matrix or mesh, or the deck
    int threads;
    std::string quantity;
    double value;
    std::string unit;  // "" for pure numbers
};

class Table {
public:
    void add(const std::string& group, const std::string& name, int threads, const std::string& quantity, double value,
             const std::string& unit = "");
    // Prints the entries of one group: a line per name and number of threads, a column per quantity.
    void print(const std::string& group, const std::string& title) const;
    std::string csv() const;

private:
    std::vector<Entry> entries_;
};

}  // namespace almesh::bench
