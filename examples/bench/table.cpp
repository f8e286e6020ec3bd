#include "bench/table.hpp"

#include <algorithm>
#include <sstream>

#include "common/text.hpp"

namespace packcell_programs {

namespace {

constexpr size_t kGap = 2;       // between columns
constexpr size_t kGroupGap = 3;  // between groups

// Neighbouring columns under one heading.
struct Group {
    size_t first = 0;
    size_t count = 0;
    size_t width = 0;
};

std::string pad(const std::string &text, size_t width, bool left) {
    const std::string blanks(width - std::min(width, columns_of(text)), ' ');
    return left ? text + blanks : blanks + text;
}

std::string centred(const std::string &text, size_t width) {
    const size_t free = width - std::min(width, columns_of(text));
    return std::string(free / 2, ' ') + text + std::string(free - free / 2, ' ');
}

void end_line(std::string &text, std::string line) {
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + "\n";
}

class Layout {
public:
    Layout(const std::vector<TableColumn> &table_columns,
           const std::vector<std::vector<std::string>> &rows)
        : columns_(table_columns), rows_(rows) {
        measure();
        form_groups();
    }

    std::string text(size_t columns) const {
        std::string text;
        for (size_t next = 0; next < groups_.size() || text.empty();) {
            if (!text.empty()) text += "\n";
            const size_t first = next;
            size_t width = keys_width_;
            do {
                if (next < groups_.size()) width += kGroupGap + groups_[next++].width;
            } while (next < groups_.size() && width + kGroupGap + groups_[next].width <= columns);
            append_part(text, first, next);
        }
        return text;
    }

private:
    void measure() {
        for (size_t i = 0; i < columns_.size(); ++i) {
            size_t width = columns_of(columns_[i].heading);
            for (const auto &row : rows_) width = std::max(width, columns_of(row[i]));
            widths_.push_back(width);
            if (columns_[i].key) keys_width_ += width + (i == 0 ? 0 : kGap);
            if (columns_[i].key) ++keys_;
        }
    }

    void form_groups() {
        for (size_t i = keys_; i < columns_.size(); ++i) {
            const bool joins = i > keys_ && !columns_[i].group.empty() &&
                               columns_[i].group == columns_[i - 1].group;
            if (!joins) groups_.push_back(Group{i, 0, 0});
            Group &group = groups_.back();
            group.width += widths_[i] + (group.count == 0 ? 0 : kGap);
            ++group.count;
        }
        for (Group &group : groups_) {
            const size_t wanted = columns_of(columns_[group.first].group);
            if (wanted <= group.width) continue;
            widths_[group.first] += wanted - group.width;
            group.width = wanted;
        }
    }

    template <typename TextOf>
    std::string line(size_t first, size_t last, const TextOf &text_of) const {
        std::string line;
        for (size_t i = 0; i < keys_; ++i) {
            line += std::string(i == 0 ? 0 : kGap, ' ') + pad(text_of(i), widths_[i], true);
        }
        for (size_t g = first; g < last; ++g) {
            for (size_t i = 0; i < groups_[g].count; ++i) {
                const size_t at = groups_[g].first + i;
                line += std::string(i == 0 ? kGroupGap : kGap, ' ') +
                        pad(text_of(at), widths_[at], false);
            }
        }
        return line;
    }

    std::string group_line(size_t first, size_t last) const {
        std::string line(keys_width_, ' ');
        for (size_t g = first; g < last; ++g) {
            line += std::string(kGroupGap, ' ') +
                    centred(columns_[groups_[g].first].group, groups_[g].width);
        }
        return line;
    }

    void append_part(std::string &text, size_t first, size_t last) const {
        const std::string groups = group_line(first, last);
        if (groups.find_first_not_of(' ') != std::string::npos) end_line(text, groups);
        end_line(text, line(first, last, [&](size_t i) { return columns_[i].heading; }));
        for (const auto &row : rows_) {
            end_line(text, line(first, last, [&](size_t i) { return row[i]; }));
        }
    }

    const std::vector<TableColumn> &columns_;
    const std::vector<std::vector<std::string>> &rows_;
    std::vector<size_t> widths_;
    std::vector<Group> groups_;
    size_t keys_ = 0;
    size_t keys_width_ = 0;
};

}  // namespace

std::string layout_table(const std::vector<TableColumn> &columns_of_table,
                         const std::vector<std::vector<std::string>> &rows, size_t columns) {
    return Layout(columns_of_table, rows).text(columns);
}

std::string wrap_text(const std::string &text, size_t columns, size_t indent) {
    std::string lines;
    std::string line;
    std::istringstream words(text);
    for (std::string word; words >> word;) {
        if (!line.empty() && columns_of(line) + 1 + columns_of(word) > columns) {
            end_line(lines, line);
            line.clear();
        }
        line += line.empty() ? std::string(indent, ' ') + word : " " + word;
    }
    if (!line.empty()) end_line(lines, line);
    return lines;
}

}  // namespace packcell_programs
