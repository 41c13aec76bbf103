// The deck: the input file of a run, plain text of `key = value` lines.
//
//   mesh = meshes/circle.msh        # from the deck's folder
//   boundary inner = translate 8 0
//   boundary "outer wall" = fixed
//   volume solid = rotate 10 about 0 0
//   select top = z > 0.99 and nz > 0.5
//   let turn = 30
//   expect relative_quality = 0.9365 +- 0.0005
//   sweep refine = 0, 1, 2
//
// `#` starts a comment. A boundary name with blanks, and a text with a `#` or with blanks at its ends, stands in double
// quotes; a `"` inside cannot be written. Every key, its legal values and meaning: the table of deck_keys.cpp. Settings
// of the same form on the command line replace those of the file: `refine=2`, `boundary inner=translate 4 0`,
// `expect nodes = 3324` (which replaces all that the file expects of that quantity).
#pragma once
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "constraint/expression.hpp"
#include "problem/boundaries.hpp"
#include "problem/summary.hpp"

namespace almesh {

// Outer faces that are a boundary although the file does not name it.
struct FaceSelection {
    std::string name, text;              // text: as written
    std::optional<Condition> condition;  // of the faces' centres and normals; else by the numbers of smooth parts
    std::vector<int> parts;
    std::string where;
};

// A line `sweep KEY = VALUES`, see app/sweep/sweep.cpp.
struct Sweep {
    std::string name;                 // of the key or constant
    std::vector<std::string> values;  // as written, those of ranges as numbers
    std::string where;                // "circle.deck:12" or "command line"
};

enum class Velocity { no, nodes, faces };
enum class VtkOutput { ascii, binary, none };
enum class FinalFormat { input, msh, su2, both };

struct Deck : ProblemSetup {
    // The other keys with their defaults.
    std::string mesh;    // path as seen from the current folder
    std::string output;  // folder, from the current one; outputs/<name> where the deck says nothing
    std::string title;
    std::string ideal_size, ideal_file;  // formula of x, y, z; path as seen from the current folder
    std::string start_file;  // path as seen from the current folder
    int iterates = 0;
    double max_seconds = 0;
    int resume = 0;
    VtkOutput vtk = VtkOutput::ascii;
    FinalFormat final_format = FinalFormat::input;
    bool proof = false;  // of the final mesh and those of frames (io/proof_file.hpp)
    std::string frames;  // times, or path of a file of them; "": one run without time
    bool keep_going = false;
    Velocity velocity = Velocity::no;
    int threads = 0;

    Constants constants;                    // in the order written
    std::vector<FaceSelection> selections;  // in the order written
    std::vector<Expectation> expectations;  // in the order written
    std::vector<Sweep> sweeps;              // in the order written, for `almesh sweep`

    std::string path, folder, name;            // of the deck file: inputs/circle.deck, inputs, circle
    std::map<std::string, std::string> given;  // key -> where it was set, for errors found later
};

// Reads the file, then the settings of the command line. Throws UsageError naming file and line (or "command line") for
// anything that is not a legal setting, a repeated one, a missing mesh, and a file that is no text or over 1 MB.
Deck read_deck(const std::string& path, const std::vector<std::string>& overrides = {});

// The same from text in memory; `path` stands for the file.
// mesh: what the deck's key would name, where the text has none.
Deck parse_deck(std::string_view text, const std::string& path, const std::vector<std::string>& overrides = {},
                const std::string& mesh = "");

// `KEY = VALUES`. Throws UsageError without file and line.
Sweep parse_sweep(std::string_view text);

// What a deck of `improve` says besides the mesh.
inline constexpr const char* improvement_lines = "ideal = regular\nboundary all = slide\n";

// The deck of `improve FILE [key=value ...]`: regular elements, all boundaries slide.
Deck improvement_deck(const std::vector<std::string>& arguments);

// Every key with its value, commented, as text of a deck to stand in the output folder. Read from the same current
// folder it gives the same Deck but for path, folder, name and lines. The mesh is given by its path relative to the
// output folder, or by the absolute one where there is none.
std::string resolved(const Deck& deck);

// The value of a key as text.
struct DeckValue {
    std::string legal;  // "integer in 0..8", "nodal | least_squares", "auto or number > 0"
    // Reads the text; returns nothing, or where it is not legal a hint, which may be "".
    std::function<std::optional<std::string>(Deck&, std::string_view)> set;
    std::function<std::string(const Deck&)> text;  // set() reads it again
};

// One row of the table in deck_keys.cpp, which feeds the parser, the list of keys and the resolved deck.
struct DeckKey {
    std::string name;
    DeckValue value;
    std::string meaning;
};

const std::vector<DeckKey>& deck_keys();

// Throws UsageError, without file and line, for a text that is not a legal value.
void set_value(Deck& deck, const DeckKey& key, std::string_view text);

// The text of `almesh --keys`, within 100 columns: all keys with default, legal values and meaning, boundary, its
// motions, expect, the quantities of the summary, these columns of history.csv.
std::string keys_table(const std::vector<Named>& history);

}  // namespace almesh
