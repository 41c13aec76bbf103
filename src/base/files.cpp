#include "base/files.hpp"

#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>

#include "base/error.hpp"
#include "base/physical_memory.hpp"

namespace almesh {
namespace {

namespace fs = std::filesystem;

using File = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

[[noreturn]] void cannot(const char* verb, const std::string& path, const std::string& reason) {
    throw InputError("cannot ", verb, " ", path, ": ", reason);
}

// What may be renamed onto: a regular file, or none yet. /dev/null and its like must stay what they are.
fs::path writable_target(const std::string& path) {
    std::error_code error;
    const fs::path target = fs::weakly_canonical(path, error);
    if (error) cannot("write to", path, error.message());
    const fs::file_status status = fs::status(target, error);
    if (fs::is_directory(status)) cannot("write to", path, "it is a folder");
    if (fs::exists(status) && !fs::is_regular_file(status)) cannot("write to", path, "it is not a regular file");
    return target;
}

// 0, or the errno of the first piece that was not written.
int write_all(const std::string& path, const std::function<void(const TextSink&)>& fill) {
    File file(std::fopen(path.c_str(), "wb"), std::fclose);
    if (!file) return errno;
    int reason = 0;
    fill([&](std::string_view piece) {
        if (reason == 0 && std::fwrite(piece.data(), 1, piece.size(), file.get()) != piece.size()) reason = errno;
    });
    const bool closed = std::fclose(file.release()) == 0;  // network disks report a full disk only here
    return reason == 0 && !closed ? errno : reason;
}

template <class... Format>
void append_chars(std::string& text, Format... number_and_format) {
    char digits[32];  // the longest double needs 24 characters
    text.append(digits, std::to_chars(digits, digits + sizeof digits, number_and_format...).ptr);
}

}  // namespace

std::string read_file(const std::string& path) {
    std::error_code error;
    const fs::file_status status = fs::status(path, error);
    if (fs::is_directory(status)) cannot("read", path, "it is a folder");
    if (fs::is_character_file(status) || fs::is_block_file(status)) cannot("read", path, "it is a device");
    const File file(std::fopen(path.c_str(), "rb"), std::fclose);
    if (!file) cannot("read", path, std::strerror(errno));
    const auto size = fs::file_size(path, error);  // a pipe has none, and files of the system have 0
    const bool is_known = !error && size > 0;
    const double most = is_known ? available_memory() : 5e8;
    const char* const too_long = is_known ? "it is larger than the free memory"
                                          : "it has more than 0.5 GB, or no end: save it in a file";
    if (is_known && static_cast<double>(size) > most) cannot("read", path, too_long);
    std::string text;
    text.reserve(is_known ? size : 0);
    for (char piece[1 << 16]; const std::size_t more = std::fread(piece, 1, sizeof piece, file.get());)
        if (static_cast<double>(text.append(piece, more).size()) > most) cannot("read", path, too_long);
    if (std::ferror(file.get())) cannot("read", path, std::strerror(errno));
    if (text.empty()) cannot("read", path, "it is empty");
    return text;
}

void check_is_text(std::string_view contents, const std::string& path) {
    if (contents.find('\0') != contents.npos)
        cannot("read", path, "it is binary; save it as text (ASCII)");
}

std::string read_text_file(const std::string& path) {
    const std::string text = read_file(path);
    check_is_text(text, path);
    return std::string(without_mark(text));
}

void write_file(const std::string& path, std::string_view content) {
    write_file(path, [content](const TextSink& sink) { sink(content); });
}

void write_file(const std::string& path, const std::function<void(const TextSink&)>& fill) {
    const fs::path target = writable_target(path);
    const std::string part = target.string() + ".part" + std::to_string(getpid());
    int reason = write_all(part, fill);
    if (reason == 0 && std::rename(part.c_str(), target.c_str()) != 0) reason = errno;
    if (reason == 0) return;
    std::remove(part.c_str());
    cannot("write to", path, std::strerror(reason));
}

void append_to_file(const std::string& path, std::string_view text, std::string_view tail) {
    const auto start_of_tail = [&](std::FILE* file) {
        return std::fseek(file, -static_cast<long>(tail.size()), SEEK_END) == 0 ? std::ftell(file) : -1;
    };
    const auto put = [](std::FILE* file, std::string_view piece) {
        return std::fwrite(piece.data(), 1, piece.size(), file) == piece.size() && std::fflush(file) == 0;
    };
    const File file(std::fopen(path.c_str(), "rb+"), std::fclose);
    const long at = file ? start_of_tail(file.get()) : -1;
    if (at < 0) cannot("write to", path, std::strerror(errno));
    if (put(file.get(), concat(text, tail))) return;
    const int reason = errno;
    std::error_code error;
    std::fseek(file.get(), at, SEEK_SET);
    put(file.get(), tail);
    fs::resize_file(path, at + tail.size(), error);
    cannot("write to", path, std::strerror(reason));
}

void remove_file(const std::string& path) {
    std::error_code error;
    fs::remove(path, error);
    if (error) cannot("remove", path, error.message());
}

void make_folder(const std::string& path) {
    std::error_code error;
    fs::create_directories(path, error);
    if (error) cannot("write to", path, error.message());
    if (!fs::is_directory(path, error)) cannot("write to", path, "it is not a folder");
    if (access(path.c_str(), W_OK | X_OK) != 0) cannot("write to", path, std::strerror(errno));
}

void append(std::string& text, long long number) { append_chars(text, number); }
void append(std::string& text, double number) { append_chars(text, number); }
void append(std::string& text, double number, int digits) {
    append_chars(text, number, std::chars_format::general, digits);
}

}  // namespace almesh
