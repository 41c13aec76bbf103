// The table of the deck's keys: one row gives name, field (and with it type and default), legal values and meaning, and
// feeds the parser, the list of keys and the resolved deck.
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "app/deck.hpp"

namespace almesh {

struct TextField {
    std::string Deck::*member;
    const char* what;  // what kind of text
};

// Where a number stands in the deck: in a member, or in a member of one of its parameter structs.
template <class T>
struct NumberField {
    const T& (*value)(const Deck&);
    T& (*place)(Deck&);
};

// An enum of the deck; enumerator i is written words[i].
struct ChoiceField {
    std::vector<std::string> words;
    int (*get)(const Deck&);
    void (*set)(Deck&, int);
};

struct NumberRange {
    double lowest = 0, highest = 0;  // highest may be infinite
    bool open = false;               // lowest itself is not legal
};

struct DeckKey {
    std::string name;
    std::variant<TextField, ChoiceField, NumberField<int>, NumberField<double>, NumberField<std::optional<double>>>
        field;
    NumberRange range;  // of numbers
    std::string meaning;
};

const std::vector<DeckKey>& deck_keys();

const DeckKey* find_key(std::string_view name);  // nullptr where there is none

std::string legal_values(const DeckKey& key);  // "integer in 0..8", "exact | nodal", "auto or number > 0"

// Throws UsageError, without a place, for a text that is not a legal value.
void set_value(Deck& deck, const DeckKey& key, std::string_view text);

std::string value_text(const Deck& deck, const DeckKey& key);  // set_value() reads it again

// All keys with default, legal values and meaning, aligned, within 100 columns; then boundary, its motions, and expect.
std::string keys_table();

}  // namespace almesh
