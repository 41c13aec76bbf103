// The problem of a deck: its files read, and what is refused told with the line of the deck and with advice.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "deck/deck.hpp"
#include "mesh/raw_mesh.hpp"
#include "problem/problem.hpp"

namespace almesh {

struct ElementList;

// A mesh before a deck is applied to it.
struct MeshSource {
    RawMesh raw;
    std::string text, hash;  // of its file; text: empty where it is not of a file
};

MeshSource read_source(const Deck& deck);  // the file of the deck; throws InputError

// Throws UsageError or InputError for everything that can be wrong before solving. The level has no energy and no
// constraint yet. given: the mesh, which then is not read; null: read_source().
Problem make_problem(const Deck& deck, const MeshSource* given = nullptr);

// As of problem/, with faces that the deck selects.
void assign_boundaries(const Deck& deck, Mesh& mesh, std::vector<std::string>& notes);
void move_target(const Deck& deck, Problem& problem);

// In all files of a run, but not in a mesh that is the user's file: a hash of the settings, wherever the results go, on
// however many threads, and in however many pieces, and of the files that the deck names; those of frames are read when
// their time comes. The same run again has the same. known: of files by their paths; "" or no row: not yet.
using FileHashes = std::map<std::string, std::string>;
std::string run_id(Deck deck, FileHashes& known);

// The run's id, and the comment of meshes that are written anew, become those of this deck.
void identify(const Deck& deck, Problem& problem);

// Where there are more than ten, writes them all to invalid.csv in the folder, which is made if it is missing; "": to
// none. Returns a line that says so, else "".
std::string write_invalid(const ElementList& list, const std::string& folder);

}  // namespace almesh
