// Text for terminals, error lines and file names: what comes from a file is made harmless here.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace packcell_programs {

// Bytes of the well-formed UTF-8 character at `at`, 1..4; 0 if there is none.
size_t utf8_length(std::string_view text, size_t at);

// The text on one line of at most `limit` bytes: control characters and bytes that are not UTF-8
// as \xNN, and "..." where something was cut off.
std::string one_line(std::string_view text, size_t limit = 500);

// Whether the text is UTF-8 without control characters.
bool is_plain_text(std::string_view text);

// Characters, each taken as one column wide, and the first so many of them.
size_t columns_of(std::string_view text);
std::string clip_columns(std::string_view text, size_t columns);

// For use in a file name: letters, digits, '.', '-' and '_' stay, others become '_'.
std::string file_name_part(std::string_view text, size_t limit);

// For use inside XML text and attributes.
std::string xml_escape(std::string_view text);

}  // namespace packcell_programs
