// What is known about the terminal behind a file descriptor.
#pragma once

#include <cstddef>

namespace packcell_programs {

// A terminal that can redraw a line (not TERM=dumb).
bool is_terminal(int fd);

// COLUMNS if set, else the terminal's width, else 80; at least 1.
size_t terminal_columns(int fd);

// Whether the user's locale shows UTF-8.
bool shows_utf8();

}  // namespace packcell_programs
