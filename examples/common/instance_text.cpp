#include "common/instance_text.hpp"

#include <algorithm>
#include <cctype>

#include "common/text.hpp"

namespace packcell_programs {

namespace {

constexpr size_t kShownBytes = 40;
constexpr size_t kNoColumn = static_cast<size_t>(-1);

std::string quoted(const std::string &text) { return "'" + one_line(text, kShownBytes) + "'"; }

Number number_or_junk(const std::string &text) {
    const std::optional<Number> number = parse_number(text);
    return number ? *number : Number{0, false, one_line(text, kShownBytes)};
}

double read_side(const LineReader &lines, const Units &units, const std::string &field,
                 const std::string &text) {
    const Number number = number_or_junk(text);
    const std::string wrong = units.refuse_side(number);
    if (!wrong.empty()) fault(lines.name(), lines.line_number(), field, number.text + ": " + wrong);
    return number.value;
}

uint64_t read_whole(const LineReader &lines, const std::string &field, const std::string &text,
                    uint64_t least, uint64_t most) {
    const std::optional<uint64_t> value = parse_unsigned(text);
    if (value && *value >= least && *value <= most) return *value;
    fault(lines.name(), lines.line_number(), field,
          one_line(text, kShownBytes) + ": must be a whole number, " + std::to_string(least) +
              ".." + std::to_string(most));
}

void add_items(RawInstance &raw, const LineReader &lines, const Size &size, uint64_t copies) {
    if (copies > kMaxItems - raw.items.size()) {
        fault(lines.name(), lines.line_number(), "",
              "too many items: must be at most " + std::to_string(kMaxItems));
    }
    raw.items.insert(raw.items.end(), copies, size);
    raw.item_lines.insert(raw.item_lines.end(), copies, lines.line_number());
}

bool is_blank(const std::string &line) {
    return line.find_first_not_of(" \t") == std::string::npos;
}

bool next_filled(LineReader &lines, std::string &line) {
    while (lines.next(line)) {
        if (!is_blank(line)) return true;
    }
    return false;
}

std::string upper(std::string text) {
    for (char &c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    return text;
}

// A CSV file with its header line read: rows by column name.
class Table {
public:
    // Columns outside of `known` are refused. Nothing is read where the file is empty.
    Table(LineReader &lines, const std::vector<std::string> &known) : lines_(lines) {
        std::string line;
        if (!next_filled(lines_, line)) return;
        for (const std::string &cell : split_commas(line)) {
            const std::string name = upper(cell);
            if (std::find(known.begin(), known.end(), name) == known.end()) {
                fault(lines_.name(), lines_.line_number(), one_line(cell, kShownBytes),
                      "unknown column: must be one of " + joined(known));
            }
            if (column(name) != kNoColumn) {
                fault(lines_.name(), lines_.line_number(), name, "given twice: must be given once");
            }
            columns_.push_back(name);
        }
        for (const char *name : {"WIDTH", "HEIGHT"}) {
            if (column(name) == kNoColumn) {
                fault(lines_.name(), lines_.line_number(), name, "missing column: must be there");
            }
        }
    }

    bool next() {
        std::string line;
        if (columns_.empty() || !next_filled(lines_, line)) return false;
        row_ = split_commas(line);
        if (row_.size() != columns_.size()) {
            fault(lines_.name(), lines_.line_number(), "",
                  std::to_string(row_.size()) + " columns: must be " +
                      std::to_string(columns_.size()) + ", as in the header");
        }
        return true;
    }

    bool empty() const { return columns_.empty(); }

    Size size(const Units &units) const {
        return {read_side(lines_, units, "WIDTH", row_[column("WIDTH")]),
                read_side(lines_, units, "HEIGHT", row_[column("HEIGHT")])};
    }

    uint64_t whole(const std::string &name, uint64_t otherwise, uint64_t least,
                   uint64_t most) const {
        const size_t at = column(name);
        return at == kNoColumn ? otherwise : read_whole(lines_, name, row_[at], least, most);
    }

private:
    static std::string joined(const std::vector<std::string> &names) {
        std::string text;
        for (const std::string &name : names) text += (text.empty() ? "" : ", ") + name;
        return text;
    }

    size_t column(const std::string &name) const {
        const auto at = std::find(columns_.begin(), columns_.end(), name);
        return at == columns_.end() ? kNoColumn : static_cast<size_t>(at - columns_.begin());
    }

    LineReader &lines_;
    std::vector<std::string> columns_;
    std::vector<std::string> row_;
};

}  // namespace

std::vector<std::string> split_words(const std::string &line) {
    std::vector<std::string> words;
    size_t at = 0;
    while ((at = line.find_first_not_of(" \t", at)) != std::string::npos) {
        const size_t end = std::min(line.find_first_of(" \t", at), line.size());
        words.push_back(line.substr(at, end - at));
        at = end;
    }
    return words;
}

std::vector<std::string> split_commas(const std::string &line) {
    std::vector<std::string> cells;
    size_t at = 0;
    for (;;) {
        const size_t end = std::min(line.find(',', at), line.size());
        const std::vector<std::string> words = split_words(line.substr(at, end - at));
        std::string cell;
        for (const std::string &word : words) cell += (cell.empty() ? "" : " ") + word;
        cells.push_back(cell);
        if (end == line.size()) return cells;
        at = end + 1;
    }
}

std::optional<RawInstance> read_plain(LineReader &lines, const Units &units) {
    RawInstance raw;
    std::string line;
    while (next_filled(lines, line)) {
        const std::vector<std::string> words = split_words(line);
        if (words.size() != 2) {
            fault(lines.name(), lines.line_number(), "", quoted(line) + ": must be 'w h'");
        }
        const double w = read_side(lines, units, "width", words[0]);
        const double h = read_side(lines, units, "height", words[1]);
        add_items(raw, lines, Size{w, h}, 1);
    }
    if (raw.items.empty()) return std::nullopt;
    raw.line = lines.line_number();
    return raw;
}

std::optional<RawInstance> read_csv(LineReader &lines, const Units &units) {
    // Columns after ORIENTED say nothing that packing one bin after the other could use.
    Table table(lines, {"ID", "WIDTH", "HEIGHT", "COPIES", "ORIENTED", "PROFIT", "GROUP_ID",
                        "WEIGHT", "ELIGIBILITY_ID"});
    if (table.empty()) return std::nullopt;
    RawInstance raw;
    while (table.next()) {
        const size_t first = raw.items.size();
        add_items(raw, lines, table.size(units), table.whole("COPIES", 1, 1, kMaxItems));
        if (table.whole("ORIENTED", 0, 0, 1) == 0) continue;
        for (size_t i = first; i < raw.items.size(); ++i) {
            raw.no_rotate.push_back(static_cast<int32_t>(i));
        }
    }
    raw.line = lines.line_number();
    return raw;
}

CsvBin read_csv_bin(const std::string &path, const Units &units) {
    LineReader lines(path);
    Table table(lines, {"ID", "WIDTH", "HEIGHT", "COPIES", "COPIES_MIN", "COST"});
    CsvBin bin;
    if (!table.next()) {
        fault(lines.name(), lines.line_number() + 1, "", "no bin: must be one row");
    }
    bin.size = table.size(units);
    bin.copies = static_cast<int64_t>(table.whole("COPIES", 1, 1, static_cast<uint64_t>(kMaxBins)));
    if (table.next()) {
        fault(lines.name(), lines.line_number(), "", "a second kind of bin: must be one row");
    }
    return bin;
}

void NgcutReader::refuse(const std::string &what) const {
    fault(lines_.name(), lines_.line_number(), "", what);
}

bool NgcutReader::next_words(std::vector<std::string> &words) {
    std::string line;
    if (!next_filled(lines_, line)) return false;
    words = split_words(line);
    return true;
}

void NgcutReader::need_words(std::vector<std::string> &words, const std::string &what) {
    if (!next_words(words)) refuse("the file ends here: must go on with " + what);
}

uint64_t NgcutReader::read_count(const std::vector<std::string> &words, const std::string &name) {
    if (words.size() != 1) {
        refuse(std::to_string(words.size()) + " numbers: must be one, the " + name);
    }
    return read_whole(lines_, name, words[0], 1, kMaxItems);
}

// A file of several problems opens with their number; the next line, the first problem's number of
// pieces, has one number too. A lone problem goes on with the two sides of its stock.
bool NgcutReader::begin() {
    begun_ = true;
    std::vector<std::string> first;
    if (!next_words(first)) return false;
    read_count(first, "number of problems");
    std::string line;
    if (!next_filled(lines_, line)) refuse("the file ends here: must go on with a problem");
    lines_.unread(line);
    const bool lone = split_words(line).size() == 2;
    problems_ = lone ? 1 : read_whole(lines_, "number of problems", first[0], 1, kMaxItems);
    if (lone) pieces_ = first;
    return true;
}

std::optional<RawInstance> NgcutReader::next() {
    if (!begun_ && !begin()) return std::nullopt;
    std::vector<std::string> words;
    if (problems_ == 0) {
        if (next_words(words)) refuse("more lines than problems: must end before this line");
        return std::nullopt;
    }
    --problems_;
    if (pieces_.empty()) {
        need_words(pieces_, "the number of pieces");
    }
    const uint64_t pieces = read_count(pieces_, "number of pieces");
    pieces_.clear();
    need_words(words, "the stock's length and width");
    if (words.size() != 2) {
        refuse(std::to_string(words.size()) +
               " numbers: must be two, the stock's length and width");
    }
    RawInstance raw;
    raw.bin.w = read_side(lines_, units_, "stock length", words[0]);
    raw.bin.h = read_side(lines_, units_, "stock width", words[1]);
    for (uint64_t i = 0; i < pieces; ++i) {
        need_words(words, "piece " + std::to_string(i + 1) + " of " + std::to_string(pieces));
        read_piece(words, raw);
    }
    raw.line = lines_.line_number();
    return raw;
}

// "length width maximum value", or with a minimum before the maximum. Minimum and value belong to
// the cutting problem; as items there are `maximum` of them.
void NgcutReader::read_piece(const std::vector<std::string> &words, RawInstance &raw) {
    if (words.size() != 4 && words.size() != 5) {
        refuse(std::to_string(words.size()) +
               " numbers: must be length, width, [minimum,] maximum and value");
    }
    const double w = read_side(lines_, units_, "length", words[0]);
    const double h = read_side(lines_, units_, "width", words[1]);
    const uint64_t most = read_whole(lines_, "maximum", words[words.size() - 2], 0, kMaxItems);
    add_items(raw, lines_, Size{w, h}, most);
}

}  // namespace packcell_programs
