// Scanner of a text with one record per line, in one pass and without allocation: blank lines are skipped, and a number
// is never taken from the next line, so that a missing one is reported in the line where it is missing.
#pragma once
#include <limits>
#include <string>
#include <string_view>

namespace almesh {

// `at` points into line `line` (from 1) or to its line end. All failures are InputError "path:line: message".
struct TextScanner {
    const char *at, *end;
    const std::string& path;  // for messages; must outlive the scanner
    int line = 1;

    TextScanner(std::string_view text, const std::string& path_)
        : at(text.data()), end(text.data() + text.size()), path(path_) {}

    [[noreturn]] void fail(int where, const std::string& message) const;
    [[noreturn]] void fail(const std::string& message) const { fail(line, message); }

    static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }
    bool at_line_end() const { return at == end || *at == '\n'; }
    void skip_blanks() {
        while (at != end && is_blank(*at)) ++at;
    }

    bool next_line();                 // to the next character that is not blank; false where the text ends
    std::string_view rest_of_line();  // trimmed; at the line end afterwards
    std::string word() const;         // the word here, for messages
    void end_of_line();               // fails where anything but blanks is left in this line

    // Fail where no such number is here. `what` names it in the message.
    long long integer(const char* what, long long lowest, long long highest);
    int small_integer(const char* what, int lowest = -std::numeric_limits<int>::max());
    double real(const char* what);  // finite

private:
    bool is_word_end(const char* p) const { return p == end || is_blank(*p) || *p == '\n'; }
};

}  // namespace almesh
