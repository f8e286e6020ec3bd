// Instances as tables: plain "w h" lines, PackingSolver's CSV and OR-Library's ngcut.
#pragma once

#include <optional>
#include <string>

#include "common/line_reader.hpp"
#include "common/raw_instance.hpp"
#include "common/units.hpp"

namespace packcell_programs {

// The words of a line, split at blanks; the fields of a CSV line, split at commas.
std::vector<std::string> split_words(const std::string &line);
std::vector<std::string> split_commas(const std::string &line);

// Each reads one instance without its id; nothing at the end of the file. The first two give no
// bin. All throw Failure naming file, line and field.
std::optional<RawInstance> read_plain(LineReader &lines, const Units &units);
std::optional<RawInstance> read_csv(LineReader &lines, const Units &units);

// PackingSolver's table of bins, which must hold one row; `copies` is its column COPIES, or 1.
struct CsvBin {
    Size size;
    int64_t copies = 1;
};
CsvBin read_csv_bin(const std::string &path, const Units &units);

// The problems of one ngcut file, or the one problem of a file without a leading count.
class NgcutReader {
public:
    NgcutReader(LineReader &lines, const Units &units) : lines_(lines), units_(units) {}
    std::optional<RawInstance> next();

private:
    bool next_words(std::vector<std::string> &words);
    void need_words(std::vector<std::string> &words, const std::string &what);
    uint64_t read_count(const std::vector<std::string> &words, const std::string &name);
    bool begin();
    void read_piece(const std::vector<std::string> &words, RawInstance &raw);
    [[noreturn]] void refuse(const std::string &what) const;

    LineReader &lines_;
    const Units &units_;
    bool begun_ = false;
    uint64_t problems_ = 0;            // still to come
    std::vector<std::string> pieces_;  // the count of a lone problem, read ahead
};

}  // namespace packcell_programs
