// What a deck asks for that does not go together, or not with its mesh: refused before anything is solved. All throw
// UsageError with the line of the deck.
#pragma once
#include "deck/deck.hpp"
#include "constraint/target.hpp"
#include "mesh/mesh.hpp"

namespace almesh {

void check_curved_ideal(const Deck& deck, const Mesh& in_file, const Mesh& of_run);
void check_split(const Deck& deck, const Mesh& mesh);
void check_times(const Deck& deck);  // frames
void check_keys(const Deck& deck);  // and all else that needs no mesh
std::string curved_su2(const Deck& deck, const Mesh& mesh);  // "" or a note
// "" where the final mesh has all sections of its file; else a note of those that are left out.
std::string left_out_sections(const Deck& deck, const Mesh& in_file, const Mesh& of_run);
void check_quadrature(const Deck& deck, const Mesh& mesh, int degree);
void check_final_ids(const Deck& deck, const Mesh& mesh);  // throws InputError

// Whether a run accepts the deck with another value of a key, so that it can be advised.
bool accepts(Deck deck, const Mesh& mesh, const std::string& key, const std::string& value);

}  // namespace almesh
