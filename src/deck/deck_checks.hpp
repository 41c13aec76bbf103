// What a deck asks for that does not go together, or not with its mesh: refused before anything is solved.
#pragma once
#include "base/error.hpp"
#include "deck/deck.hpp"
#include "mesh/mesh.hpp"

namespace almesh {

// All throw UsageError with the line of the deck.
void check_times(const Deck& deck);  // frames
void check_keys(const Deck& deck);   // and all else that needs no mesh

std::string su2_losses(const Deck& deck, const Mesh& mesh);  // of final.su2: "" or a note
// If the mesh is not to be written in the format of its file, it leaves the file. "" or a note of what it loses.
std::string set_patched(const Deck& deck, Mesh& mesh);

// Whether a run accepts the deck with another value of a key, so that it can be advised.
bool accepts(Deck deck, const std::string& key, const std::string& value);

// How the final mesh is written: final.msh, final.su2, or both.
std::vector<FileFormat> final_formats(FinalFormat wanted, const Mesh& mesh);

// Of an error of a setting, with the line of its key.
UsageError with_line(const Deck& deck, const SettingError& error);

}  // namespace almesh
