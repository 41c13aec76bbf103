// Text files: read as a whole, written whole or not at all. Numbers are appended to a text buffer without locale,
// allocation or stream.
#pragma once
#include <functional>
#include <string>
#include <string_view>

namespace almesh {

// Contents of a text file. Throws InputError where it is missing, unreadable, a folder, empty or binary (zero bytes).
std::string read_text_file(const std::string& path);

// Writes a temporary file beside `path` and renames it, so that `path` holds the old contents or the new ones, never
// a part. Symbolic links are followed. Throws InputError (disk full, no such folder, no permission, not a file).
void write_file(const std::string& path, std::string_view content);

// The same for a long text, handed over piece by piece: fill(sink) calls the sink with one after the other, and no more
// than a piece need be in memory. fill must not throw.
using TextSink = std::function<void(std::string_view)>;
void write_file(const std::string& path, const std::function<void(const TextSink&)>& fill);

// Makes the folder and those above it where they are missing. Throws InputError where that fails, or where nothing can
// be written into it.
void make_folder(const std::string& path);

void append(std::string& text, long long number);
void append(std::string& text, double number);              // shortest text that reads back to the same bits
void append(std::string& text, double number, int digits);  // %.<digits>g; digits <= 17

}  // namespace almesh
