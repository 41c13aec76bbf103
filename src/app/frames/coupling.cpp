#include "app/frames/coupling.hpp"

#include "base/error.hpp"
#include "base/interrupt.hpp"
#include "base/table.hpp"

namespace almesh {

std::optional<std::string> Coupling::read_line() {
    std::string line;
    int c = std::getc(in_);
    if (c == EOF) return std::nullopt;
    for (; c != EOF && c != '\n'; c = std::getc(in_)) line += static_cast<char>(c);
    return std::string(trim(line));
}

AskedFrame Coupling::parse(const std::string& line, double reached) {
    time_ = line.empty() ? "-" : line.substr(0, line.find_first_of(" \t"));
    const std::string wanted = "expected a time" + (files_ > 0 ? " and " + counted(files_, "file") : std::string());
    if (line.empty()) throw UsageError(wanted, ": the line is empty");
    const std::string_view rest = trim(std::string_view(line).substr(time_.size()));
    const auto t = parse_double(time_);
    if (!t) throw UsageError(wanted, ": ", in_backquotes(time_), " is not a number");
    if (*t < reached) throw UsageError("the times run backwards, the last mesh is of t = ", reached);
    AskedFrame asked{*t, {}};
    if (files_ == 1 && !rest.empty()) asked.files.emplace_back(rest);
    else for (const std::string_view file : words(rest)) asked.files.emplace_back(file);
    if (static_cast<int>(asked.files.size()) != files_)
        throw UsageError("the deck takes ", counted(files_, "file"), " with each time, in its steps named `-`; here ",
                         asked.files.size() == 1 ? "is " : "are ", asked.files.size());
    return asked;
}

std::optional<AskedFrame> Coupling::next(double reached) {
    for (;;) {
        if (interrupted()) throw Error(ExitCode::not_converged, "interrupted");
        const std::optional<std::string> line = read_line();
        if (!line) return std::nullopt;
        try {
            return parse(*line, reached);
        } catch (const UsageError& error) {
            tell("refused", error.what());
        }
    }
}

void Coupling::tell(const std::string& status, const std::string& what) {
    print(out_, time_, " ", status, " ", on_one_line(what), "\n");
    if (std::fflush(out_) != 0 || std::ferror(out_))
        throw InputError("frames = -: nobody reads the answers any more; the meshes made so far are there");
}

}  // namespace almesh
