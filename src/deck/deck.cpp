#include "deck/deck.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <set>
#include <span>

#include "deck/frame_times.hpp"
#include "base/error.hpp"
#include "base/text.hpp"
#include "mesh/inner_boundary.hpp"

namespace almesh {

namespace fs = std::filesystem;

namespace {

constexpr const char* command_line = "command line";
constexpr std::size_t largest_file = 1000000;

// What `work` returns; the errors that it throws get the context before their text.
template <class Work>
auto with_context(const std::string& context, const Work& work) {
    try {
        return work();
    } catch (const UsageError& error) {
        throw UsageError(context, ": ", error.what());
    }
}

// A setting of the command line may replace one of the file; two in the same one contradict each other.
void check_repeat(const std::string& what, const std::string& earlier, const std::string& where) {
    if ((earlier == command_line) == (where == command_line))
        throw UsageError(what, " is already set (", earlier, "): remove one of the two");
}

template <class Row>
void put(std::vector<Row>& rows, const Row& row, const std::string& what) {
    Row* const earlier = find_row(rows, row.name);
    if (earlier) check_repeat(what, earlier->where, row.where);
    (earlier ? *earlier : rows.emplace_back()) = row;
}

// Paths start in the deck's folder, on the command line in the current one.
std::string path_from(const std::string& where, const Deck& deck, const std::string& path) {
    if (path == file_of_line) return path;
    const fs::path start = where == command_line ? fs::path() : fs::path(deck.folder);
    return (start / path).lexically_normal().string();
}

void read_key(Deck& deck, const std::string& name, const std::string& value, const std::string& where) {
    const DeckKey* const key = find_row(deck_keys(), name);
    if (!key) {
        std::vector<std::string> names = names_of(deck_keys());
        names.insert(names.begin(), {"boundary", "volume", "select", "let", "expect", "sweep"});
        throw UsageError("unknown key ", in_backquotes(name), did_you_mean(name, names));
    }
    if (const auto it = deck.given.find(key->name); it != deck.given.end())
        check_repeat(in_backquotes(key->name), it->second, where);
    set_value(deck, *key, value);
    deck.given[key->name] = where;
    deck.in_time = !deck.frames.empty();
    deck.needs_objective = deck.given.contains("objective");
    deck.needs_tolerance = deck.given.contains("surface_tolerance");
    if (key->name == "mesh" && !deck.mesh.empty()) deck.mesh = path_from(where, deck, deck.mesh);
    if (key->name == "start" && deck.start == Start::file) deck.start_file = path_from(where, deck, deck.start_file);
    if (key->name == "ideal" && !deck.ideal_file.empty()) deck.ideal_file = path_from(where, deck, deck.ideal_file);
    if (key->name == "frames" && names_file(deck.frames)) deck.frames = path_from(where, deck, deck.frames);
}

// The formulas of a motion with other paths in their tables, table(FILE).
template <class Path>
std::string with_tables(std::string_view text, const Path& path) {
    constexpr std::string_view word = "table(";
    std::string result;
    for (;;) {
        const std::size_t begin = text.find(word), end = text.find(')', begin);
        if (end == std::string_view::npos) return result.append(text);
        const std::size_t name = begin + word.size();
        result.append(text.substr(0, name)).append(path(std::string(trim(text.substr(name, end - name)))));
        text.remove_prefix(end);
    }
}

// Reads and removes `NAME =` at the beginning of `text`. kind: boundary, volume or select.
std::string take_name(std::string_view kind, std::string_view& text) {
    const std::string_view what = kind == "select" ? "CONDITION" : "MOTION";
    const bool in_quotes = !text.empty() && text[0] == '"';
    const auto close = in_quotes ? closing_quote(text) : std::string_view::npos;
    const auto equals = text.find('=', in_quotes ? std::min(close, text.size()) : 0);
    const std::string_view written = trim(text.substr(0, equals));
    const auto name = without_quotes(written);
    if (equals == std::string_view::npos || !name || name->empty())
        throw UsageError("expected `", kind, " NAME = ", what, "` or `", kind, " \"NAME\" = ", what, "`");
    if (!in_quotes && words(written).size() > 1)
        throw UsageError("the ", kind, " name ", in_backquotes(*name), " has blanks: put it in double quotes");
    text.remove_prefix(equals + 1);
    return *name;
}

// kind: boundary or volume.
void read_boundary(Deck& deck, const std::string& kind, std::string_view text, const std::string& where) {
    const bool is_volume = kind == "volume";
    const std::string given = take_name(kind, text), shown = concat(kind, " ", with_quotes(given));
    const std::string name = is_volume ? volume_group(given) : given;
    const auto path = [&](const std::string& file) { return path_from(where, deck, file); };
    Motion motion = with_context(shown, [&] { return parse_motion(with_tables(text, path), deck.constants); });
    if (is_volume && !is_prescribed(kind_of_rest(motion)))
        throw UsageError(shown, ": all nodes of a volume follow its motion: it neither slides nor is free");
    for (MotionStep& step : motion.steps)
        if (!step.file.empty()) step.file = path(step.file);
    put(deck.boundaries, {name, motion, where, is_volume}, shown);
}

void read_selection(Deck& deck, std::string_view text, const std::string& where) {
    FaceSelection selection;
    selection.name = take_name("select", text);
    selection.where = where;
    selection.text = trim(text);
    const std::string shown = "select " + with_quotes(selection.name);
    const std::vector<std::string_view> word = words(text);
    if (!word.empty() && word[0] == "part") {
        for (const std::string_view number : std::span(word).subspan(1)) {
            const auto value = parse_int(number);
            if (!value || *value < 1) throw UsageError(shown, ": ", in_backquotes(number), " is no number of a part");
            selection.parts.push_back(*value);
        }
        if (selection.parts.empty())
            throw UsageError(shown, ": expected `part NUMBER`, as almesh info FILE numbers them");
    } else {
        selection.condition = with_context(shown, [&] { return Condition(selection.text, deck.constants); });
    }
    for (const FaceSelection& earlier : deck.selections)
        if (earlier.name == selection.name) check_repeat(shown, earlier.where, where);
    std::erase_if(deck.selections, [&](const FaceSelection& earlier) { return earlier.name == selection.name; });
    deck.selections.push_back(std::move(selection));
}

void read_expectation(Deck& deck, std::string_view text, const std::string& where) {
    Expectation expectation = parse_expectation(text);
    expectation.where = where;
    const auto replaced = [&](const Expectation& other) {
        return other.quantity == expectation.quantity && where == command_line && other.where != command_line;
    };
    std::erase_if(deck.expectations, replaced);
    for (const Expectation& other : deck.expectations)
        if (other.quantity == expectation.quantity && other.relation == expectation.relation)
            check_repeat(in_backquotes("expect " + to_string(other)), other.where, where);
    deck.expectations.push_back(expectation);
}

// Its value is known when all of them have been read.
void read_constant(Deck& deck, std::string_view text, const std::string& where) {
    const auto equals = std::min(text.find('='), text.size());
    const std::string name(trim(text.substr(0, equals)));
    check_constant_name(name);
    if (equals == text.size()) throw UsageError("expected `let NAME = NUMBER`");
    const std::string value(trim(text.substr(equals + 1)));
    put(deck.constants, {name, without_quotes(value).value_or(value), where}, "let " + name);
}

void evaluate_constants(Deck& deck) {
    Constants known;
    for (Constant& constant : deck.constants) {
        with_context(concat(constant.where, ": let ", constant.name), [&] {
            const Expression formula(constant.text, known);
            if (formula.names_point() || formula.names_time())
                throw UsageError(in_backquotes(constant.text), " may name constants alone");
            constant.value = formula({});
            if (!std::isfinite(constant.value)) throw UsageError(in_backquotes(constant.text), " is not finite");
        });
        known.push_back(constant);
    }
}

void read_sweep(Deck& deck, std::string_view text, const std::string& where) {
    Sweep sweep = parse_sweep(text);
    sweep.where = where;
    if (!find_row(deck_keys(), sweep.name) && !find_row(deck.constants, sweep.name))
        throw UsageError("sweep ", sweep.name, ": there is no such key, nor a line `let ", sweep.name, " = ...`",
                         did_you_mean(sweep.name, names_of(deck_keys())));
    put(deck.sweeps, sweep, "sweep " + sweep.name);
}

// Those in the file of what the command line gives one value.
void remove_set_sweeps(Deck& deck) {
    std::erase_if(deck.sweeps, [&](const Sweep& sweep) {
        if (sweep.where == command_line) return false;
        const Constant* const constant = find_row(deck.constants, sweep.name);
        const auto key = deck.given.find(sweep.name);
        return (key != deck.given.end() && key->second == command_line) ||
               (constant && constant->where == command_line);
    });
}

// A setting without its comment. constants: reads these alone, or else all others.
void read_setting(Deck& deck, std::string_view text, const std::string& where, bool constants) {
    const std::string_view first = text.substr(0, std::min(text.find_first_of(" \t="), text.size()));
    const std::string_view rest = trim(text.substr(first.size()));
    const bool is_constant = first == "let" && !rest.starts_with('=');
    if (is_constant != constants) return;
    if (is_constant) return read_constant(deck, rest, where);
    if (first == "boundary" || (first == "volume" && !rest.starts_with('=')))
        return read_boundary(deck, std::string(first), rest, where);
    if (first == "select" && !rest.starts_with('=')) return read_selection(deck, rest, where);
    if (first == "expect") return read_expectation(deck, rest, where);
    if (first == "sweep") return read_sweep(deck, rest, where);
    const auto equals = text.find('=');
    if (equals == std::string_view::npos)
        throw UsageError("expected `key = value`, got ", in_backquotes(text.substr(0, 60)));
    read_key(deck, std::string(trim(text.substr(0, equals))), std::string(trim(text.substr(equals + 1))), where);
}

std::string_view without_comment(std::string_view line) {
    bool in_quotes = false;
    for (std::size_t i = 0; i < line.size(); ++i) {
        if (line[i] == '"') in_quotes = !in_quotes;
        if (line[i] == '#' && !in_quotes) return line.substr(0, i);
    }
    if (in_quotes) throw UsageError("a double quote is not closed");
    return line;
}

void read_line(Deck& deck, std::string_view line, const std::string& where, bool constants) {
    const bool in_file = where != command_line;
    with_context(where, [&] {
        const auto is_control = [](char c) { return static_cast<unsigned char>(c) < 0x20 && c != '\t'; };
        if (std::any_of(line.begin(), line.end(), is_control))
            throw UsageError("control characters: a deck is plain text, is this another file?");
        const std::string_view text = trim(in_file ? without_comment(line) : line);
        if (!text.empty() || !in_file) read_setting(deck, text, where, constants);
    });
}

// Path of `file` relative to `folder`, both given from the current folder; absolute where there is none.
std::string relative_path(const std::string& folder, const std::string& file) {
    if (file == file_of_line) return file;
    const fs::path from = fs::path(folder).lexically_normal(), to = fs::path(file);
    const bool reachable = from.is_relative() && to.is_relative() && !from.string().starts_with("..");
    const fs::path relative = reachable ? to.lexically_relative(from) : fs::path();
    return relative.empty() ? fs::absolute(to).string() : relative.string();
}

}  // namespace

Deck parse_deck(std::string_view text, const std::string& path, const std::vector<std::string>& overrides,
                const std::string& mesh) {
    Deck deck;
    deck.mesh = mesh;
    deck.path = path;
    deck.folder = fs::path(path).parent_path().string();
    deck.name = fs::path(path).stem().string();
    text = without_mark(text);
    for (const bool constants : {true, false}) {  // a line may name those of the lines after it
        int number = 0;
        for (const std::string_view line : split(text, '\n'))
            read_line(deck, line, path + ":" + std::to_string(++number), constants);
        for (const std::string& setting : overrides) read_line(deck, setting, command_line, constants);
        if (constants) evaluate_constants(deck);
    }
    remove_set_sweeps(deck);
    if (deck.mesh.empty()) throw UsageError(path, ": no mesh: add a line `mesh = FILE`, from the deck's folder");
    if (deck.output.empty()) deck.output = (fs::path("outputs") / deck.name).string();
    return deck;
}

Deck read_deck(const std::string& path, const std::vector<std::string>& overrides) {
    std::error_code ignored;
    if (fs::is_directory(path, ignored)) throw UsageError(path, ": a folder, expected a deck file");
    std::ifstream file(path, std::ios::binary);
    if (!file) throw UsageError(path, ": cannot be opened: check the path of the deck");
    std::string text(largest_file + 1, '\0');
    file.read(text.data(), static_cast<std::streamsize>(text.size()));
    if (file.bad()) throw UsageError(path, ": cannot be read");
    text.resize(static_cast<std::size_t>(file.gcount()));
    if (text.size() > largest_file)
        throw UsageError(path, ": more than 1 MB: a deck is a page of text, is this a mesh?");
    return parse_deck(text, path, overrides);
}

Deck improvement_deck(const std::vector<std::string>& arguments) {
    if (arguments.size() < 2) throw UsageError("improve takes a mesh file: almesh improve FILE [key=value ...]");
    std::vector<std::string> settings(arguments.begin() + 1, arguments.end());
    settings[0] = "mesh=" + quoted_where_needed(settings[0], "#\"");
    return parse_deck(improvement_lines, arguments[1], settings);
}

Sweep parse_sweep(std::string_view text) {
    const auto equals = text.find('=');
    Sweep sweep;
    sweep.name = trim(text.substr(0, equals));
    if (const auto word = words(sweep.name); !word.empty() && (word[0] == "boundary" || word[0] == "volume"))
        throw UsageError("sweep ", sweep.name, ": a sweep is over numbers or words: name what differs between the ",
                         "motions, as in `let a = 30`, `boundary NAME = rotate a`, `sweep a = 30, 60`");
    if (sweep.name == "output")
        throw UsageError("sweep output: every run of a sweep has a folder of its own in that of the key output");
    if (equals == std::string_view::npos || words(sweep.name).size() != 1)
        throw UsageError("expected `sweep KEY = VALUE, VALUE, ...` or `sweep KEY = FROM : STEP : TO`");
    for (const std::string_view value : split(text.substr(equals + 1), ',')) {
        if (value.empty()) throw UsageError("sweep ", sweep.name, ": a value is missing");
        if (value.find(':') == std::string_view::npos) sweep.values.emplace_back(value);
        else for (const double number : numbers_of_range("sweep " + sweep.name, value))
            sweep.values.push_back(to_text(number));
    }
    std::set<std::string> seen;
    for (const std::string& value : sweep.values)
        if (!seen.insert(value).second)
            throw UsageError("sweep ", sweep.name, ": ", in_backquotes(value), " is there twice");
    return sweep;
}

// A deck with all keys and their values, which repeats the run.
std::string resolved(const Deck& deck) {
    Deck shown = deck;
    shown.mesh = relative_path(deck.output, deck.mesh);
    if (deck.start == Start::file) shown.start_file = relative_path(deck.output, deck.start_file);
    if (!deck.ideal_file.empty()) shown.ideal_file = relative_path(deck.output, deck.ideal_file);
    if (names_file(deck.frames)) shown.frames = relative_path(deck.output, deck.frames);
    std::string text = "# Every key with its value: repeats the run from the folder in which it was started.\n";
    for (const DeckKey& key : deck_keys()) {
        text += "\n";
        for (const std::string& line : wrap("[" + key.value.legal + "] " + key.meaning, 98)) text += "# " + line + "\n";
        text += key.name + " = " + key.value.text(shown) + "\n";
    }
    if (!deck.constants.empty()) text += "\n# Constants of the formulas.\n";
    for (const Constant& constant : deck.constants)
        text += "let " + constant.name + " = " + with_quotes(constant.text) + "\n";
    if (!deck.selections.empty()) text += "\n# Boundaries that the mesh file does not name.\n";
    for (const FaceSelection& selection : deck.selections)
        text += "select " + quoted_where_needed(selection.name, "#=\" \t") + " = " + selection.text + "\n";
    if (!deck.boundaries.empty()) text += "\n# Motions of the boundaries.\n";
    const auto from_output = [&](const std::string& file) { return relative_path(deck.output, file); };
    for (BoundaryMotion boundary : deck.boundaries) {
        for (MotionStep& step : boundary.motion.steps)
            if (!step.file.empty()) step.file = from_output(step.file);
        const std::string kind = boundary.is_volume ? "volume " : "boundary ";
        const std::string name = boundary.is_volume ? boundary.name.substr(kind.size()) : boundary.name;
        text += kind + quoted_where_needed(name, "#=\" \t") + " = " +
                with_tables(to_string(boundary.motion), from_output) + "\n";
    }
    if (!deck.expectations.empty()) text += "\n# Checked at the end of the run.\n";
    for (const Expectation& expectation : deck.expectations) text += "expect " + to_string(expectation) + "\n";
    return text;
}

}  // namespace almesh
