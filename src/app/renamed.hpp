// Names that keys, values of keys, and quantities of the summary had in earlier decks: these run as they are, and a note
// says the present name.
#pragma once
#include <string>
#include <string_view>

namespace almesh {

struct Deck;

// `name = value` in present names; a note in the deck, once for each, where one was renamed. name: of a key, or of a
// quantity, which comes without a value.
void use_present_names(Deck& deck, std::string& name, std::string& value);

}  // namespace almesh
