#include "common/instance_reader.hpp"

#include <algorithm>
#include <cctype>

#include "common/errors.hpp"
#include "common/handles.hpp"
#include "common/instance_json.hpp"
#include "common/interrupt.hpp"
#include "common/text.hpp"

namespace packcell_programs {

namespace {

constexpr size_t kShownBytes = 40;

Units make_units(const ReadOptions &options) {
    if (!options.millimetres) return Units();
    return Units(options.cell, options.clearance, options.margin);
}

bool is_csv_header(const std::string &line) {
    std::string text = line;
    for (char &c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    return text.find("WIDTH") != std::string::npos && text.find(',') != std::string::npos;
}

// The format that a first line tells; empty if it tells none.
std::string told_format(const std::string &line) {
    const size_t start = line.find_first_not_of(" \t");
    if (line[start] == '{') return "jsonl";
    if (line[start] == '[') return "arrays";
    if (is_csv_header(line)) return "csv";
    const std::vector<std::string> words = split_words(line);
    const bool numbers = std::all_of(words.begin(), words.end(), [](const std::string &word) {
        return word.find_first_not_of("0123456789+-.eE") == std::string::npos;
    });
    if (!numbers) return "";
    return words.size() == 2 ? "plain" : words.size() == 1 ? "ngcut" : "";
}

}  // namespace

InstanceReader::InstanceReader(const std::string &path, const ReadOptions &options)
    : lines_(path), options_(options), units_(make_units(options)), bins_(options.bins) {
    detect();
    if (!format_.empty()) settle_bin();
}

void InstanceReader::detect() {
    std::string line;
    do {
        if (!lines_.next(line)) return;
    } while (split_words(line).empty());
    lines_.unread(line);
    format_ = options_.format == "auto" ? told_format(line) : options_.format;
    if (format_.empty()) {
        fault(lines_.name(), lines_.line_number(), "",
              "'" + one_line(line, kShownBytes) +
                  "': must begin as one of jsonl, arrays, plain, csv or ngcut does");
    }
    if (format_ == "ngcut") ngcut_ = std::make_unique<NgcutReader>(lines_, units_);
}

void InstanceReader::settle_bin() {
    const bool given = options_.bin.has_value() || !options_.bins_file.empty();
    if (carries_bin()) {
        if (!given) return;
        throw UsageError(std::string(options_.bin ? "--bin" : "--bins-file") + ": " +
                         lines_.name() + " has format " + format_ + ", which carries its bins");
    }
    if (!given && options_.usual_bin) options_.bin = options_.usual_bin;
    if (!given && !options_.bin) {
        throw UsageError("--bin: missing: " + lines_.name() + " has format " + format_ +
                         ", which carries no bin: must be WxH");
    }
    if (!options_.bins_file.empty()) {
        const CsvBin row = read_csv_bin(options_.bins_file, units_);
        bin_ = row.size;
        if (bins_ == 0 && row.copies > 1) bins_ = row.copies;
        return;
    }
    for (const Number *side : {&options_.bin->w, &options_.bin->h}) {
        const std::string wrong = units_.refuse_side(*side);
        if (!wrong.empty()) throw UsageError("--bin: side " + side->text + ": " + wrong);
    }
    bin_ = Size{options_.bin->w.value, options_.bin->h.value};
    try {
        int32_t w = 0;
        int32_t h = 0;
        units_.bin(bin_, w, h);
    } catch (const LibraryError &error) {
        throw UsageError(std::string("--bin: ") + error.what());
    }
}

std::optional<RawInstance> InstanceReader::next_json() {
    std::string line;
    do {
        if (!lines_.next(line)) return std::nullopt;
    } while (split_words(line).empty());
    const auto parse = format_ == "jsonl" ? parse_json_object : parse_json_array;
    return parse(line, lines_.name(), lines_.line_number(), units_);
}

std::optional<RawInstance> InstanceReader::next_raw() {
    if (format_.empty()) return std::nullopt;
    if (format_ == "jsonl" || format_ == "arrays") return next_json();
    if (format_ == "ngcut") return ngcut_->next();
    if (count_ > 0) return std::nullopt;  // these two are one instance a file
    return format_ == "csv" ? read_csv(lines_, units_) : read_plain(lines_, units_);
}

std::optional<Instance> InstanceReader::next() {
    std::optional<RawInstance> raw = next_raw();
    // A file that was not read to its end gives no instance that ends early.
    if (interrupt_signal() != 0) return std::nullopt;
    if (!raw) {
        if (count_ > 0) return std::nullopt;
        fault(lines_.name(), std::max<uint64_t>(1, lines_.line_number()), "",
              "no instance: must hold at least one");
    }
    ++count_;
    if (!carries_bin()) raw->bin = bin_;
    if (format_ != "jsonl") {
        raw->is_set = bins_ == 0;
        raw->bins = bins_;
        raw->id = (raw->is_set ? "s" : "r") + std::to_string(count_);
    } else if (!ids_.insert(raw->id).second) {
        fault(lines_.name(), raw->line, "id",
              "\"" + raw->id + "\": given to an earlier instance: must be given once");
    }
    Instance instance = make_instance(*raw, lines_.name(), units_, options_.rotation);
    instance.bytes = lines_.bytes_read() - bytes_before_;
    bytes_before_ = lines_.bytes_read();
    return instance;
}

}  // namespace packcell_programs
