// cell.json: a cell as people write it. Lengths in metres, the bin's in millimetres where the name
// says so, angles in degrees.
#pragma once

#include <string>

#include "motion/cell_layout.h"

namespace packcell {

constexpr size_t kMaxCellText = size_t{1} << 20;

// Every field is required, and no other allowed. An arm's model is a name or an object with all its
// figures. An angle is a number of degrees or a list of two, which are added: so that any angle in
// radians can be said exactly. Throws kFormat, with one line that names field, value and what is
// allowed, and what check_cell() throws.
CellLayout read_cell(const std::string &text);

// Reading it gives the same cell, bit for bit. An arm that is one of arm_model() is named.
std::string write_cell(const CellLayout &cell);

}  // namespace packcell
