// Numbers and names as text that fits its file: finite, free of the locale, escaped.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace packcell {

// Appends `value` with so many decimals, never "-0". Throws kState where it is not finite or beyond
// 1e12: no file says "nan".
void append_number(std::string &out, double value, int decimals);
void append_number(std::string &out, int32_t value);

std::string number(double value, int decimals);

// Rounded to so many decimals, for JSON; throws as append_number does.
double rounded(double value, int decimals);

// What `text`, up to its first NUL, is in XML and HTML: markup escaped, control characters and
// bytes that are no UTF-8 replaced.
std::string escaped(std::string_view text);

}  // namespace packcell
