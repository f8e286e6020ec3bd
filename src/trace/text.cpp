#include "trace/text.h"

#include <charconv>
#include <cmath>

#include "base/status.h"

namespace packcell {

namespace {

constexpr double kMostNumber = 1e12;

void check_number(double value) {
    if (!(std::fabs(value) <= kMostNumber))
        fail(Status::kState, "a number of the trace is %g: must be finite", value);
}

bool continues(char c) { return (static_cast<unsigned char>(c) & 0xC0U) == 0x80U; }

// Bytes of the UTF-8 character that `text` begins with; 0 where that is none.
size_t character(std::string_view text) {
    const unsigned first = static_cast<unsigned char>(text[0]);
    const size_t size = first < 0x80   ? 1
                        : first < 0xC2 ? 0
                        : first < 0xE0 ? 2
                        : first < 0xF0 ? 3
                                       : 4;
    if (size == 0 || size > text.size() || first > 0xF4) return 0;
    for (size_t i = 1; i < size; ++i) {
        if (!continues(text[i])) return 0;
    }
    if (size < 3) return size;
    // Overlong forms, surrogates and what lies past U+10FFFF; U+FFFE and U+FFFF are not for XML.
    const unsigned second = static_cast<unsigned char>(text[1]);
    if ((first == 0xE0 && second < 0xA0) || (first == 0xED && second > 0x9F)) return 0;
    if ((first == 0xF0 && second < 0x90) || (first == 0xF4 && second > 0x8F)) return 0;
    if (first == 0xEF && second == 0xBF && static_cast<unsigned char>(text[2]) > 0xBD) return 0;
    return size;
}

}  // namespace

void append_number(std::string &out, double value, int decimals) {
    check_number(value);
    char text[64];
    const std::to_chars_result result =
        std::to_chars(text, text + sizeof text, value, std::chars_format::fixed, decimals);
    std::string_view digits(text, static_cast<size_t>(result.ptr - text));
    if (digits.find_first_not_of("-0.") == std::string_view::npos && digits[0] == '-')
        digits.remove_prefix(1);
    out += digits;
}

void append_number(std::string &out, int32_t value) { out += std::to_string(value); }

std::string number(double value, int decimals) {
    std::string out;
    append_number(out, value, decimals);
    return out;
}

double rounded(double value, int decimals) {
    check_number(value);
    const double unit = std::pow(10.0, decimals);
    return std::round(value * unit) / unit + 0.0;
}

std::string escaped(std::string_view text) {
    text = text.substr(0, text.find('\0'));
    std::string out;
    while (!text.empty()) {
        const size_t size = character(text);
        const char c = text[0];
        if (size == 0)
            out += "\xEF\xBF\xBD";
        else if (c == '&')
            out += "&amp;";
        else if (c == '<')
            out += "&lt;";
        else if (c == '>')
            out += "&gt;";
        else if (c == '"')
            out += "&quot;";
        else if (c == '\'')
            out += "&#39;";
        else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F)
            out += ' ';
        else
            out += text.substr(0, size);
        text.remove_prefix(size == 0 ? 1 : size);
    }
    return out;
}

}  // namespace packcell
