// The constants are the first 32 bits of the fractional parts of the square and cube roots of the first primes.
#include "base/sha256.hpp"

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

#include "base/bytes.hpp"

namespace almesh {
namespace {

using Words = std::array<std::uint32_t, 8>;

std::array<std::uint32_t, 64> roots(bool cube) {
    std::array<std::uint32_t, 64> of{};
    std::size_t count = 0;
    for (unsigned n = 2; count < of.size(); ++n) {
        bool is_prime = true;
        for (unsigned d = 2; d * d <= n; ++d) is_prime = is_prime && n % d != 0;
        if (!is_prime) continue;
        const double root = cube ? std::cbrt(n) : std::sqrt(n);
        of[count++] = static_cast<std::uint32_t>((root - std::floor(root)) * 0x1p32);
    }
    return of;
}

void add_block(Words& h, const char* block) {
    static const std::array<std::uint32_t, 64> k = roots(true);
    std::array<std::uint32_t, 64> w{};
    for (std::size_t t = 0; t < 16; ++t) w[t] = from_bytes<std::uint32_t>(block + 4 * t, std::endian::big);
    for (std::size_t t = 16; t < 64; ++t) {
        const std::uint32_t a = w[t - 15], b = w[t - 2];
        w[t] = w[t - 16] + (std::rotr(a, 7) ^ std::rotr(a, 18) ^ (a >> 3)) + w[t - 7] +
               (std::rotr(b, 17) ^ std::rotr(b, 19) ^ (b >> 10));
    }
    Words s = h;
    for (std::size_t t = 0; t < 64; ++t) {
        const std::uint32_t e = s[4], a = s[0];
        const std::uint32_t first = s[7] + (std::rotr(e, 6) ^ std::rotr(e, 11) ^ std::rotr(e, 25)) +
                                    ((e & s[5]) ^ (~e & s[6])) + k[t] + w[t];
        const std::uint32_t second = (std::rotr(a, 2) ^ std::rotr(a, 13) ^ std::rotr(a, 22)) +
                                     ((a & s[1]) ^ (a & s[2]) ^ (s[1] & s[2]));
        s = {first + second, s[0], s[1], s[2], s[3] + first, s[4], s[5], s[6]};
    }
    for (std::size_t i = 0; i < h.size(); ++i) h[i] += s[i];
}

}  // namespace

std::string sha256(std::string_view bytes) {
    Words h{};
    const std::array<std::uint32_t, 64> initial = roots(false);
    for (std::size_t i = 0; i < h.size(); ++i) h[i] = initial[i];
    const std::size_t whole = bytes.size() / 64 * 64;
    for (std::size_t at = 0; at < whole; at += 64) add_block(h, bytes.data() + at);
    std::string tail(bytes.substr(whole));
    tail += '\x80';
    while (tail.size() % 64 != 56) tail += '\0';
    append_bytes(tail, std::uint64_t{8} * bytes.size(), std::endian::big);
    for (std::size_t at = 0; at < tail.size(); at += 64) add_block(h, tail.data() + at);
    std::string digits;
    for (const std::uint32_t word : h)
        for (int shift = 28; shift >= 0; shift -= 4) digits += "0123456789abcdef"[(word >> shift) & 15];
    return digits;
}

}  // namespace almesh
