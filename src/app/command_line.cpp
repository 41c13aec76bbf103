#include "app/commands.hpp"
#include "base/version.hpp"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <exception>
#include <filesystem>
#include <fstream>
#include <new>
#include <optional>

#include "deck/deck.hpp"
#include "report/iteration_table.hpp"
#include "base/text.hpp"
#include "io/mesh_format.hpp"

namespace almesh {
namespace {

constexpr const char* help =
    "almesh moves and curves meshes without inverting an element: triangles, quadrilaterals, solids of all types.\n"
    "\n"
    "  almesh DECK [key=value ...]   run a deck; keys given here replace those of the deck\n"
    "  almesh info FILE              describe a mesh file in a deck to start from: almesh info FILE > my.deck\n"
    "  almesh quality FILE           certify and measure any mesh (Gmsh MSH, SU2, Abaqus, VTU, VTK)\n"
    "                                before=FILE: and how far the boundary is from where that file has it\n"
    "                                proof=FILE: and write a proof that others can check: tests/verify.py\n"
    "                                both take keys: almesh quality FILE threads=1\n"
    "  almesh improve FILE [key=value ...]\n"
    "                                make a mesh valid and its elements better; boundary nodes slide along the boundary\n"
    "  almesh adjoint DECK dJ-dx.csv [...] [key=value ...]\n"
    "                                run it; derivatives of each J by the boundary and the deck's constants\n"
    "  almesh tangent DECK [dg.csv ...] [key=value ...]\n"
    "                                run it; velocities of all nodes by those of the boundary and by the constants\n"
    "  almesh sweep DECK [key=value ...]\n"
    "                                run a deck once for each value of its lines `sweep KEY = VALUES`\n"
    "                                --slurm: write the script of a job array for that; --collect: gather its runs\n"
    "  almesh --keys                 list the keys of a deck with defaults, legal values and meaning\n"
    "  almesh --version              print version, commit and compiler\n"
    "  almesh --help                 print this text\n"
    "  --json, anywhere              for programs: JSON instead, an object on each line; this text goes to stderr\n"
    "\n"
    "A deck is plain text, for instance inputs/circle.deck:\n"
    "  mesh = meshes/circle.msh\n"
    "  boundary inner = translate 8 0\n"
    "  boundary outer = fixed\n"
    "Results are written to outputs/<deck name>, or to the folder that the key `output` names.\n"
    "Keys may stand on the command line: almesh inputs/circle.deck refine=2 \"boundary inner=translate 4 0\"\n"
    "\n"
    "Exit codes:\n"
    "  0  the run converged or settled (no_visible_gain), and the mesh is certified valid and injective\n"
    "  1  the command line or the deck is wrong\n"
    "  2  the mesh, the target or the output folder cannot be used\n"
    "  3  the run did not converge, or its mesh has no derivative; the last mesh is written\n"
    "  4  the run converged, but the mesh is not certified\n"
    "  5  the mesh is certified, but an `expect` line of the deck does not hold\n";

// `info FILE [key=value ...]`, and the same of quality, which has keys of its own.
Deck deck_of_mesh(const std::vector<std::string>& arguments, QualityFiles* files = nullptr) {
    if (arguments.size() < 2)
        throw UsageError(arguments[0], " takes a mesh file: almesh ", arguments[0], " FILE [key=value ...]");
    constexpr std::string_view before = "before=", proof = "proof=";
    std::vector<std::string> settings;
    for (auto argument = arguments.begin() + 2; argument != arguments.end(); ++argument)
        if (files && argument->starts_with(before)) files->before = argument->substr(before.size());
        else if (files && argument->starts_with(proof)) files->proof = argument->substr(proof.size());
        else settings.push_back(*argument);
    return parse_deck("", arguments[1], settings, arguments[1]);
}

// Of the commands for which what they print is all there is; nothing for others.
std::optional<ExitCode> print_result(const std::vector<std::string>& arguments, const Output& out) {
    const auto print = [&out](const std::string& text) {
        std::fputs(text.c_str(), out);
        return ExitCode::success;
    };
    if (arguments.empty()) return print(help), ExitCode::usage;
    const std::string& first = arguments[0];
    const auto asks = [](const std::string& argument) { return argument == "--help" || argument == "-h"; };
    if (std::any_of(arguments.begin(), arguments.end(), asks)) return print(help);
    if (first == "--keys") return print(keys_table(history_columns()));
    if (first == "--version") return print(version() + ", commit " + commit() + "\n" + compiler() + "\n");
    QualityFiles files;
    if (first == "quality") {
        const Deck deck = deck_of_mesh(arguments, &files);
        return quality(deck, files, out);
    }
    if (first == "info") return info(deck_of_mesh(arguments), out);
    if (first.starts_with("-")) throw UsageError("unknown option ", first, "; see almesh --help");
    return std::nullopt;
}

bool is_mesh(const std::string& path) {
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(path, ignored)) return false;  // what a pipe holds can be read once
    std::string start(4096, '\0');
    std::ifstream file(path, std::ios::binary);
    file.read(start.data(), static_cast<std::streamsize>(start.size()));
    start.resize(static_cast<std::size_t>(file.gcount()));
    return std::any_of(std::begin(mesh_formats), std::end(mesh_formats), [&](const MeshFormat& format) {
        return !start.empty() && (format.recognise(start) || path.ends_with(format.ending));
    });
}

// What to type instead of `almesh MESH`.
[[noreturn]] void refuse_mesh(const std::string& mesh) {
    const std::string deck = std::filesystem::path(mesh).stem().string() + ".deck";
    const auto quoted = [](const std::string& name) { return quoted_where_needed(name, " \t\"'$&;()<>|*?#"); };
    throw UsageError(mesh, ": this is a mesh, and a run needs a deck that says what to do with it. Make one, edit its "
                     "motions, and run it:\n  almesh info ", quoted(mesh), " > ", quoted(deck), "\n  almesh ",
                     quoted(deck),
                     "\nor certify and measure the mesh as it is:\n  almesh quality ", quoted(mesh));
}

// The results are files: whoever reads what is printed may go away, at the end of the program too.
ExitCode write_results(const std::vector<std::string>& arguments, const Output& out) {
    std::signal(SIGPIPE, SIG_IGN);
    const std::string& first = arguments[0];
    if (first == "adjoint" || first == "tangent") return differentiate(arguments, out);
    if (first == "sweep") return sweep({arguments.begin() + 1, arguments.end()}, out);
    if (first == "improve") return run(improvement_deck(arguments), out);
    if (is_mesh(first)) refuse_mesh(first);
    return run(read_deck(first, {arguments.begin() + 1, arguments.end()}), out);
}

}  // namespace

int command_line(std::vector<std::string> arguments, std::FILE* out, std::FILE* error) {
    const Output to = std::erase(arguments, "--json") > 0 ? Output(error, out) : Output(out);
    const auto end = [&](ExitCode code, const std::string& wrong) {
        if (!wrong.empty()) std::fprintf(error, "almesh: %s\n", wrong.c_str());
        to.end->insert(to.end->begin(), {{"arguments", json({arguments.begin(), arguments.end()})},
                                         {"version", version()}, {"commit", commit()},
                                         {"exit_code", static_cast<int>(code)}, {"error", wrong}});
        to.tell("end", *to.end);
        return static_cast<int>(code);
    };
    try {
        const auto printed = print_result(arguments, to);
        const int code = end(printed ? *printed : write_results(arguments, to), "");
        if (printed && (std::fflush(out) != 0 || std::ferror(out)))
            throw InputError("cannot write the output: ", std::strerror(errno));
        return code;
    } catch (const Error& problem) {
        return end(problem.exit_code, problem.what());
    } catch (const std::bad_alloc&) {
        return end(ExitCode::input, out_of_memory);
    } catch (const std::exception& unexpected) {
        return end(ExitCode::input, concat("unexpected error: ", unexpected.what()));
    }
}

}  // namespace almesh
