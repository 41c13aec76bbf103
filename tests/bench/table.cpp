#include "bench/table.hpp"

#include <algorithm>
#include <cstdio>

#include "base/files.hpp"

namespace almesh::bench {
namespace {

std::string number(double value) {
    std::string text;
    append(text, value, 4);
    return text;
}

void add_once(std::vector<std::string>& list, const std::string& text) {
    if (std::find(list.begin(), list.end(), text) == list.end()) list.push_back(text);
}

std::string heading(const Entry& entry) { return entry.quantity + (entry.unit.empty() ? "" : " " + entry.unit); }

int width(const std::string& column) { return std::max(9, static_cast<int>(column.size())); }

std::string label(const Entry& entry) { return entry.name + ", " + std::to_string(entry.threads); }

}  // namespace

void Table::add(const std::string& group, const std::string& name, int threads, const std::string& quantity,
                double value, const std::string& unit) {
    entries_.push_back({group, name, threads, quantity, value, unit});
}

void Table::print(const std::string& group, const std::string& title) const {
    std::vector<std::string> columns, lines;
    for (const Entry& entry : entries_) {
        if (entry.group != group) continue;
        add_once(columns, heading(entry));
        add_once(lines, label(entry));
    }
    std::printf("\n%s\n%-36s", title.c_str(), "name, threads");
    for (const std::string& column : columns) std::printf("  %*s", width(column), column.c_str());
    for (const std::string& line : lines) {
        std::printf("\n%-36s", line.c_str());
        for (const std::string& column : columns) {
            std::string cell;
            for (const Entry& entry : entries_)
                if (entry.group == group && label(entry) == line && heading(entry) == column)
                    cell = number(entry.value);
            std::printf("  %*s", width(column), cell.c_str());
        }
    }
    std::printf("\n");
    std::fflush(stdout);
}

std::string Table::csv() const {
    std::string text = "group,name,threads,quantity,value,unit\n";
    for (const Entry& entry : entries_)
        text += entry.group + "," + entry.name + "," + std::to_string(entry.threads) + "," + entry.quantity + "," +
                number(entry.value) + "," + entry.unit + "\n";
    return text;
}

}  // namespace almesh::bench
