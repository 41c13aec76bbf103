#include "deck/deck.hpp"
#include "fuzz/harness.hpp"

namespace almesh::fuzz {
namespace {

// Where the motion takes some points does not matter here.
void move_points(const Deck& deck, int dim) {
    try {
        for (const BoundaryMotion& line : deck.boundaries) check_dimension(line.motion, dim);
    } catch (const UsageError&) {
        return;
    }
    for (const char* const name : {"inner", "outer", "a wall"})
        if (const BoundaryMotion* const boundary = motion_for(deck, name))
            for (const double fraction : {0.0, 0.5, 1.0}) {
                double x[3] = {0.5, -1, 2};
                apply(at_fraction(shortest(boundary->motion), fraction), dim, x);
            }
}

}  // namespace

void fuzz_deck(std::string_view bytes) {
    const auto zero = std::min(bytes.find('\0'), bytes.size());
    std::vector<std::string> settings;
    for (auto from = zero; from < bytes.size();) {
        const auto to = std::min(bytes.find('\0', from + 1), bytes.size());
        settings.emplace_back(bytes.substr(from + 1, to - from - 1));
        from = to;
    }
    std::optional<Deck> deck;
    try {
        deck = parse_deck(bytes.substr(0, zero), "a/fuzz.deck", settings);
    } catch (const UsageError& error) {
        demand(error.what()[0] != '\0', "a deck is refused without a word");
        return;
    }
    for (int dim : {2, 3}) move_points(*deck, dim);
    const std::string text = resolved(*deck);
    std::string again;
    try {
        again = resolved(parse_deck(text, deck->output + "/deck.txt"));
    } catch (const UsageError& error) {
        throw Violation(concat("a resolved deck is refused: ", error.what(), "\n", text));
    }
    demand(again == text, "a resolved deck reads back as another:\n", text, "\n", again);
}

}  // namespace almesh::fuzz
