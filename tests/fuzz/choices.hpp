// Bytes as a sequence of choices; after their end each is the first of its alternatives, so any bytes are legal.
// Callers take one choice in an expression: compilers evaluate two of them in different orders.
#pragma once
#include <cmath>
#include <cstddef>
#include <string>
#include <string_view>

namespace almesh::fuzz {

class Choices {
public:
    explicit Choices(std::string_view bytes) : rest_(bytes) {}

    int byte() {
        if (rest_.empty()) return 0;
        const auto first = static_cast<unsigned char>(rest_[0]);
        rest_.remove_prefix(1);
        return first;
    }

    bool yes() { return byte() % 2 != 0; }

    // In 0 .. count - 1.
    int below(int count) {
        int number = byte();
        if (count > 256) number = 256 * number + byte();
        return number % count;
    }

    template <class T, std::size_t n>
    const T& of(const T (&alternatives)[n]) {
        return alternatives[below(n)];
    }

    // In [-1, 1), in steps of 1/128.
    double fraction() { return static_cast<signed char>(byte()) / 128.0; }

    // Above 0: mostly within a few powers of ten around 1, sometimes as far off as numbers go.
    double positive() {
        constexpr double extremes[] = {5e-324, 1e-308, 1e-300, 1e-160, 1e-100, 1e-30, 1e-16,
                                       1e16,   1e30,   1e100,  1e160,  1e300,  1.7e308};
        const int kind = byte();
        return kind < 224 ? std::pow(10.0, (kind % 112 - 64) / 8.0) : of(extremes);
    }

    // Printable.
    std::string word(int longest) {
        std::string text;
        for (int left = below(longest + 1); left > 0; --left) text += static_cast<char>(' ' + below(95));
        return text;
    }

private:
    std::string_view rest_;
};

}  // namespace almesh::fuzz
