// A function of the time t given by a file with rows `t value`, separated by blanks or commas: straight lines between
// them. What stands behind # is a comment, and a first row without numbers is passed over.
#pragma once
#include <string>
#include <vector>

namespace almesh {

class TimeTable {
public:
    // Throws UsageError where the file cannot be read, with its line where a row is none or the times run backwards.
    explicit TimeTable(const std::string& path);

    double operator()(double t) const;  // throws UsageError outside of the range of its times

private:
    std::string path_;
    std::vector<double> t_, value_;
};

}  // namespace almesh
