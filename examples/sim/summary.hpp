// The figures of a bin, or of all, as a block of text for a terminal.
#pragma once

#include <cstddef>
#include <string>

#include "sim/figures.hpp"

namespace packcell_programs {

// No line is wider than `columns`, where that is 40 or more.
std::string summary_block(const std::string &title, const CellFigures &figures, size_t columns,
                          bool utf8);

}  // namespace packcell_programs
