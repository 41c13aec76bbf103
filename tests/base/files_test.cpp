#include "base/files.hpp"

#include <doctest/doctest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <limits>

#include "base/error.hpp"
#include "support/child.hpp"
#include "support/targets.hpp"

using namespace almesh;
namespace fs = std::filesystem;

namespace {

// A folder of its own for each test, removed at its end.
struct Scratch {
    fs::path folder = fs::temp_directory_path() / ("almesh_files_test_" + std::to_string(getpid()));
    Scratch() { fs::create_directories(folder); }
    ~Scratch() { fs::remove_all(folder); }
    std::string operator/(const std::string& name) const { return (folder / name).string(); }
};

template <class Number, class... Digits>
std::string shown(Number number, Digits... digits) {
    std::string text;
    append(text, number, digits...);
    return text;
}

std::string message_of_reading(const std::string& path) {
    try {
        read_text_file(path);
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

}  // namespace

TEST_CASE("a written file reads back, and is replaced as a whole") {
    const Scratch scratch;
    const std::string path = scratch / "a.txt";
    write_file(path, "one\n");
    CHECK(read_text_file(path) == "one\n");
    const std::string large(100000, 'x');
    write_file(path, large);
    CHECK(read_text_file(path) == large);
    CHECK(std::distance(fs::directory_iterator(scratch.folder), fs::directory_iterator()) == 1);  // no .part left
}

TEST_CASE("a file written in pieces holds them in their order") {
    const Scratch scratch;
    const std::string large(100000, 'x');
    write_file(scratch / "a.txt", [&](const TextSink& sink) {
        for (const std::string& piece : {std::string("one "), large, std::string(), std::string(" two\n")}) sink(piece);
    });
    CHECK(read_text_file(scratch / "a.txt") == "one " + large + " two\n");
}

TEST_CASE("writing through a symbolic link keeps the link") {
    const Scratch scratch;
    write_file(scratch / "real.txt", "old");
    fs::create_symlink("real.txt", scratch / "link.txt");
    write_file(scratch / "link.txt", "new");
    CHECK(fs::is_symlink(scratch / "link.txt"));
    CHECK(read_text_file(scratch / "real.txt") == "new");
}

TEST_CASE("text is put before the tail of a file; where there is no room for it the file stays as it is") {
    const Scratch scratch;
    const std::string path = scratch / "list.txt";
    write_file(path, "[1]");
    append_to_file(path, ",2", "]");
    CHECK(read_file(path) == "[1,2]");
    append_to_file(path, "\n");
    CHECK(read_file(path) == "[1,2]\n");
    CHECK_THROWS_AS(append_to_file(scratch / "none", "a"), InputError);
    const auto without_room = [&] {
        std::signal(SIGXFSZ, SIG_IGN);
        const rlimit limit = {10, 10};
        setrlimit(RLIMIT_FSIZE, &limit);
        try {
            append_to_file(path, ",3,4,5,6,7,8", "]\n");
        } catch (const InputError&) {
            return 2;
        }
        return 0;
    };
    CHECK(test::in_child(without_room, [](pid_t) {}) == 2);
    CHECK(read_file(path) == "[1,2]\n");
}

TEST_CASE("what cannot be read is named with its reason") {
    const Scratch scratch;
    CHECK(message_of_reading(scratch / "none") == "cannot read " + scratch / "none" + ": No such file or directory");
    CHECK(message_of_reading(scratch.folder.string()) == "cannot read " + scratch.folder.string() + ": it is a folder");
    write_file(scratch / "empty", "");
    CHECK(message_of_reading(scratch / "empty") == "cannot read " + scratch / "empty" + ": it is empty");
    write_file(scratch / "binary", std::string_view("a\0b", 3));
    CHECK(message_of_reading(scratch / "binary").find("it is binary") != std::string::npos);
}

TEST_CASE("a device is not read, and a pipe only to its bound") {
    const Scratch scratch;
    for (const std::string device : {"/dev/zero", "/dev/null"})
        CHECK(message_of_reading(device) == "cannot read " + device + ": it is a device");
    const std::string fifo = scratch / "fifo";
    REQUIRE(mkfifo(fifo.c_str(), 0600) == 0);
    const auto writes = [&](int pieces) {
        return [&fifo, pieces] {
            std::signal(SIGPIPE, SIG_IGN);
            std::FILE* const file = std::fopen(fifo.c_str(), "w");
            const std::string piece(1 << 16, 'y');
            for (int k = 0; k < pieces; ++k)
                if (std::fwrite(piece.data(), 1, piece.size(), file) != piece.size()) return 1;
            return std::fclose(file);
        };
    };
    std::string text, message;
    CHECK(test::in_child(writes(3), [&](pid_t) { text = read_file(fifo); }) == 0);
    CHECK(text == std::string(3 << 16, 'y'));
    CHECK(test::in_child(writes(1 << 30), [&](pid_t) { message = message_of_reading(fifo); }) == 1);
    CHECK(message == "cannot read " + fifo + ": it has more than 0.5 GB, or no end: save it in a file");
}

TEST_CASE("what cannot be written leaves nothing behind") {
    const Scratch scratch;
    CHECK_THROWS_AS(write_file(scratch / "no/such/folder/a.txt", "x"), InputError);
    CHECK_THROWS_AS(write_file(scratch.folder.string(), "x"), InputError);
    CHECK_THROWS_WITH_AS(write_file("/dev/null", "x"), "cannot write to /dev/null: it is not a regular file",
                         InputError);
    CHECK(fs::is_character_file("/dev/null"));
    CHECK(fs::is_empty(scratch.folder));
}

TEST_CASE("folders are made with those above them") {
    const Scratch scratch;
    make_folder(scratch / "a/b/c");
    make_folder(scratch / "a/b/c");
    CHECK(fs::is_directory(scratch / "a/b/c"));
    write_file(scratch / "file", "x");
    CHECK_THROWS_AS(make_folder(scratch / "file"), InputError);
    CHECK_THROWS_AS(make_folder(scratch / "file/below"), InputError);
}

TEST_CASE("a file is removed, a missing one is no error, a full folder is") {
    const Scratch scratch;
    write_file(scratch / "file", "x");
    remove_file(scratch / "file");
    CHECK(!fs::exists(scratch / "file"));
    remove_file(scratch / "file");
    make_folder(scratch / "a/b");
    CHECK_THROWS_AS(remove_file(scratch / "a"), InputError);
}

TEST_CASE("numbers are appended shortest, or with the digits asked for") {
    CHECK(shown(-9223372036854775807LL) == "-9223372036854775807");
    CHECK(shown(0.1) == "0.1");
    CHECK(shown(1.0 / 3, 9) == "0.333333333");
    CHECK(shown(1e300, 9) == "1e+300");
    for (const double value : {1.0 / 3, 5e-324, -std::numeric_limits<double>::max(), 0.1 + 0.2})
        CHECK(std::strtod(shown(value).c_str(), nullptr) == value);
}

TEST_CASE("rows stand in their order behind what the text holds, for any count and number of threads") {
    for (int count : {0, 1, 4095, 4096, 4097, 300000}) {  // blocks of 4096
        std::string expected = "before\n";
        for (int i = 0; i < count; ++i) expected += std::to_string(i) + "\n";
        const auto texts = test::for_threads([&] {
            std::string text = "before\n";
            append_rows([&](std::string_view piece) { text += piece; }, count,
                        [](std::string& part, int i) { part += std::to_string(i) + "\n"; });
            return text;
        });
        for (const std::string& text : texts) CHECK(text == expected);
    }
}
