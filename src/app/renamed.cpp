#include "app/renamed.hpp"

#include <algorithm>

#include "app/deck.hpp"
#include "base/text.hpp"

namespace almesh {
namespace {

struct Renamed {
    std::string_view name, value, present_name, present_value;  // value "": any
};

constexpr Renamed table[] = {
    {"follow", "", "continuation", ""},
    {"region", "all", "local_repair", "0"},
    {"region", "folded", "local_repair", "1"},
    {"region", "", "local_repair", ""},
    {"objective", "worst", "objective", "minimax"},
    {"followed_newton_iterations", "", "earlier_newton_iterations", ""},
    {"released_nodes", "", "freed_nodes", ""},
    {"straightening_distance", "", "boundary_distance", ""},
    {"obstacle", "", "diagnosis", ""},
    {"obstacle_boundary", "", "diagnosis_boundary", ""},
    {"obstacle_node", "", "diagnosis_node", ""},
    {"obstacle_element", "", "diagnosis_element", ""},
    {"obstacle_x", "", "diagnosis_x", ""},
    {"obstacle_y", "", "diagnosis_y", ""},
    {"obstacle_z", "", "diagnosis_z", ""},
};

std::string setting(std::string_view name, std::string_view value) {
    return in_backquotes(value.empty() ? std::string(name) : concat(name, " = ", value));
}

}  // namespace

void use_present_names(Deck& deck, std::string& name, std::string& value) {
    for (const Renamed& row : table) {
        if (name != row.name || !(row.value.empty() || value == row.value)) continue;
        const std::string note = setting(row.name, row.value) + " is now " + setting(row.present_name, row.present_value);
        if (std::find(deck.notes.begin(), deck.notes.end(), note) == deck.notes.end()) deck.notes.push_back(note);
        name = row.present_name;
        if (!row.value.empty()) value = row.present_value;
        return;
    }
}

}  // namespace almesh
