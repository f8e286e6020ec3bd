#include "common/numbers.hpp"

#include <charconv>
#include <cmath>

#include "common/text.hpp"

namespace packcell_programs {

namespace {

constexpr double kLargestExact = 9007199254740992.0;  // 2^53
constexpr size_t kShownDigits = 40;

bool is_integer_text(std::string_view text) {
    if (!text.empty() && text[0] == '-') text.remove_prefix(1);
    return !text.empty() && text.find_first_not_of("0123456789") == std::string_view::npos;
}

}  // namespace

std::optional<Number> parse_number(std::string_view text) {
    Number number;
    const char *end = text.data() + text.size();
    const auto [stopped, error] = std::from_chars(text.data(), end, number.value);
    if (error != std::errc() || stopped != end || !std::isfinite(number.value)) return std::nullopt;
    number.whole = is_integer_text(text) && std::fabs(number.value) <= kLargestExact;
    number.text = one_line(text, kShownDigits);
    return number;
}

std::optional<uint64_t> parse_unsigned(std::string_view text) {
    uint64_t value = 0;
    const char *end = text.data() + text.size();
    const auto [stopped, error] = std::from_chars(text.data(), end, value);
    if (error != std::errc() || stopped != end) return std::nullopt;
    return value;
}

std::optional<NumberPair> parse_number_pair(std::string_view text) {
    const size_t cross = text.find_first_of("xX");
    if (cross == std::string_view::npos) return std::nullopt;
    const std::optional<Number> w = parse_number(text.substr(0, cross));
    const std::optional<Number> h = parse_number(text.substr(cross + 1));
    if (!w || !h) return std::nullopt;
    return NumberPair{*w, *h};
}

std::string number_text(double value) {
    char digits[32];
    const auto [end, error] = std::to_chars(digits, digits + sizeof digits, value);
    return error == std::errc() ? std::string(digits, end) : std::to_string(value);
}

}  // namespace packcell_programs
