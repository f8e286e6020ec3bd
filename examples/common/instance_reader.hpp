// Reads instances one after the other from a file or standard input, in whichever format.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <unordered_set>

#include "common/instance.hpp"
#include "common/instance_text.hpp"
#include "common/line_reader.hpp"
#include "common/numbers.hpp"
#include "common/units.hpp"

namespace packcell_programs {

constexpr const char *kInstanceFormats[] = {"auto", "jsonl", "arrays", "plain", "csv", "ngcut"};

struct ReadOptions {
    std::string format = "auto";          // of kInstanceFormats; auto: told from the first line
    std::optional<NumberPair> bin;        // for formats that carry none, or:
    std::string bins_file;                // PackingSolver's table of bins
    std::optional<NumberPair> usual_bin;  // where a format carries none and neither is given
    int64_t bins = 0;  // above 0: streams of so many bins, where a format cannot say
    bool millimetres = false;
    double cell = 0;  // the rest only in millimetres
    double clearance = 0;
    double margin = 0;
    bool rotation = true;  // whether an item may be turned to fit
};

class InstanceReader {
public:
    // Throws Failure for the file and UsageError for options that do not go with it.
    InstanceReader(const std::string &path, const ReadOptions &options);

    // The next instance; nothing at the end or after an interrupt. Throws Failure
    // "FILE:LINE: field 'FIELD': VALUE: must be ...", after which nothing more can be read.
    std::optional<Instance> next();

    const std::string &name() const { return lines_.name(); }

    // Of a regular file, else 0: with Instance::bytes the share that is done.
    uint64_t size() const { return lines_.size(); }

private:
    void detect();
    bool carries_bin() const { return format_ == "jsonl" || format_ == "ngcut"; }
    void settle_bin();
    std::optional<RawInstance> next_raw();
    std::optional<RawInstance> next_json();

    LineReader lines_;
    ReadOptions options_;
    Units units_;
    std::string format_;  // empty until the first line was seen
    Size bin_;
    int64_t bins_ = 0;
    std::unique_ptr<NgcutReader> ngcut_;
    uint64_t count_ = 0;
    uint64_t bytes_before_ = 0;
    std::unordered_set<std::string> ids_;
};

}  // namespace packcell_programs
