#include "io/inflate.hpp"

#include <doctest/doctest.h>

#include "base/text.hpp"

using namespace almesh;

namespace {

std::string bytes_of(std::string_view hexadecimal) {
    std::string bytes;
    for (std::size_t k = 0; k + 1 < hexadecimal.size(); k += 2)
        bytes += static_cast<char>(std::stoi(std::string(hexadecimal.substr(k, 2)), nullptr, 16));
    return bytes;
}

// 150 numbers with blanks between, compressed by zlib with codes of its own.
std::string numbers() {
    std::string text;
    for (int k = 0; k < 150; ++k) text += concat(k ? " " : "", (k * k * 7919 + k * 31) % 997);
    return text;
}
const std::string numbers_stream = bytes_of(
    "78da2d91d791c5300c035b41090a4ceabfb15bf8dd8787234660bdf47a6bee5676ebaca73ea17d46b15339a38a56bea33857"
    "3b969aef9ca75acc2551b7f482c1dc8afbb4afa297c631b56bf15119326cf51596258b2af4f8f2eaa466968ad327834a33f3"
    "e80a72a99af345bf9d77fd7cb5f8e628b1c4bbbcd3bb7d824bdfc5f9ee5b0772e65f9dc3fd69b6762cd4cf0daeecce2eedd6"
    "aeedfea3303f2aa6634aa6656aa6678a4bcffc56eb3e32e96e24595a8f58320f9174dca1832c7397ae2ad8184600d213bc73"
    "21fb6231104a9b0d319ee1c87b9576abb6e52bf0d69bfd389f66c140d55c8adc811513058a09cb42a6419cc218e839daf03d"
    "c84eccb52d8cc9c0dd56e87d55400310e237c4eef64fef3f014969b9");

}  // namespace

TEST_CASE("what zlib has compressed is inflated, with codes of its own and with the fixed ones") {
    CHECK(inflate(numbers_stream, numbers().size()) == numbers());
    const std::string fixed = bytes_of("78da4b4c4a4e44a014002df605c0");
    CHECK(inflate(fixed, 15) == "abcabcabcabcabd");
    CHECK(!inflate(fixed, 14));
    CHECK(!inflate(fixed, 16));
}

TEST_CASE("what is stored is inflated, also in several blocks") {
    for (const std::size_t size : {0, 1, 65535, 65536, 200000}) {
        std::string data;
        for (std::size_t k = 0; k < size; ++k) data += static_cast<char>(k * k / 7);
        CHECK(inflate(stored(data), size) == data);
    }
}

TEST_CASE("a damaged stream is told, wherever it is damaged") {
    const std::string data = numbers();
    for (std::size_t size = 0; size < numbers_stream.size(); ++size)
        CHECK(!inflate(numbers_stream.substr(0, size), data.size()));
    int deceived = 0;
    for (std::size_t bit = 16; bit < 8 * numbers_stream.size(); ++bit) {
        std::string damaged = numbers_stream;
        damaged[bit / 8] = static_cast<char>(damaged[bit / 8] ^ 1 << bit % 8);
        const auto read = inflate(damaged, data.size());
        deceived += read && *read != data;
    }
    CHECK(deceived == 1);  // so is zlib: the checksum of the stream is that of 128 for 209, too
    CHECK(!inflate("", 0));
}
