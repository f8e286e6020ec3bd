// Numbers as text: read from options and files without accepting anything that is not one.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace packcell_programs {

// A finite number as it was written; `whole` when the text is an integer and `value` is exact.
struct Number {
    double value = 0;
    bool whole = false;
    std::string text;
};

// The whole text as a decimal number; nothing for junk, "nan", "inf", hexadecimal or numbers
// beyond the range of double.
std::optional<Number> parse_number(std::string_view text);

// The whole text as an unsigned decimal integer.
std::optional<uint64_t> parse_unsigned(std::string_view text);

// "WxH", two numbers.
struct NumberPair {
    Number w, h;
};
std::optional<NumberPair> parse_number_pair(std::string_view text);

// Shortest text that reads back as the same number.
std::string number_text(double value);

}  // namespace packcell_programs
