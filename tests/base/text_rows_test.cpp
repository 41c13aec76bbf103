#include "base/text_rows.hpp"

#include <doctest/doctest.h>

#include "support/targets.hpp"

using namespace almesh;

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
