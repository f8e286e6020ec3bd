// Text tables: columns in groups, split into several tables where the terminal is narrow.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace packcell_programs {

struct TableColumn {
    std::string group;  // shared heading of neighbouring columns; may be empty
    std::string heading;
    bool key = false;  // leads every part of a split table; keys come first
};

// Each row has a text for every column. Groups stay whole: a part is wider than `columns` only
// where keys and one group are.
std::string layout_table(const std::vector<TableColumn> &columns_of_table,
                         const std::vector<std::vector<std::string>> &rows, size_t columns);

// Running text in lines of at most so many columns, each beginning with the indent.
std::string wrap_text(const std::string &text, size_t columns, size_t indent = 0);

}  // namespace packcell_programs
