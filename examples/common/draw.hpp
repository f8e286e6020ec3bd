// Pictures of a bin: as text for terminals, as SVG for files.
#pragma once

#include <string>
#include <vector>

#include "common/episode.hpp"

namespace packcell_programs {

// A letter or digit for each item, '#' for fixed cells, '.' (or a middle dot) for free ones. A bin
// wider than `columns` is drawn with one character for several cells and says so.
std::vector<std::string> draw_text(const Bin &bin, const std::string &title, size_t columns,
                                   bool utf8);

// Pictures beside each other, as many in a row as `columns` allow.
std::string join_pictures(const std::vector<std::vector<std::string>> &pictures, size_t columns);

// A self-contained drawing that reads on light and on dark ground.
std::string draw_svg(const Bin &bin, const std::string &title);

}  // namespace packcell_programs
