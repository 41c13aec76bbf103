// Files: read as a whole, written atomically. Long files are handed over piece by piece, formatted in parallel.
// Numbers are appended to a text buffer without locale or stream.
#pragma once
#include <algorithm>
#include <functional>
#include <string>
#include <string_view>

namespace almesh {

// Contents of a file. Throws InputError where it is missing, unreadable, a folder, a device, empty or without end.
std::string read_file(const std::string& path);

// Throws InputError where the contents of the file `path` are no text: where there is a zero byte.
void check_is_text(std::string_view contents, const std::string& path);

// Contents of a text file: both of these; without a byte-order mark.
std::string read_text_file(const std::string& path);

// Writes a temporary file beside `path` and renames it, so that `path` holds the old contents or the new ones, never
// a part of them. Symbolic links are followed. Throws InputError (disk full, no such folder, no permission, not a
// file).
void write_file(const std::string& path, std::string_view content);

// The same for a long text: fill(sink) hands it to the sink piece by piece. fill must not throw.
using TextSink = std::function<void(std::string_view)>;
void write_file(const std::string& path, const std::function<void(const TextSink&)>& fill);

// Puts `text` before the tail that the file ends with. Where there is no room for it the file stays as it is. Throws
// InputError.
void append_to_file(const std::string& path, std::string_view text, std::string_view tail = {});

// Formats rows 0 .. count - 1 and hands them to the sink; row(part, i) appends row i to `part`. Blocks of rows are
// formatted in parallel and written in order: the same text for any number of threads, and one block per thread in
// memory.
template <class Row>
void append_rows(const TextSink& sink, int count, const Row& row) {
    constexpr int block = 4096;
    const int blocks = (count + block - 1) / block;
#pragma omp parallel if (blocks > 1)
    {
        std::string part;
#pragma omp for ordered schedule(static, 1)
        for (int b = 0; b < blocks; ++b) {
            part.clear();
            for (int i = b * block, end = std::min(count, i + block); i < end; ++i) row(part, i);
#pragma omp ordered
            sink(part);
        }
    }
}

// Nothing happens where there is no such file. Throws InputError where it cannot be removed.
void remove_file(const std::string& path);

// Makes the folder and those above it where they are missing. Throws InputError where that fails, or where nothing can
// be written into it.
void make_folder(const std::string& path);

void append(std::string& text, long long number);
void append(std::string& text, double number);              // shortest text that reads back to the same bits
void append(std::string& text, double number, int digits);  // %.<digits>g; digits <= 17

}  // namespace almesh
