#include "gen/generate.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include "common/errors.hpp"
#include "common/handles.hpp"
#include "common/interrupt.hpp"
#include "common/line_reader.hpp"
#include "common/progress.hpp"
#include "common/raw_instance.hpp"

namespace packcell_programs {

namespace {

constexpr uint64_t kHeadBytes = 100;  // of a stream's line before its items

std::string bin_json(const pkc_generator_options &options) {
    return "[" + std::to_string(options.w) + "," + std::to_string(options.h) + "]";
}

void append_items(std::string &line, const std::vector<pkc_item> &items, size_t count) {
    for (size_t i = 0; i < count; ++i) {
        line += line.back() == '[' ? "[" : ",[";
        line += std::to_string(items[i].w);
        line += ',';
        line += std::to_string(items[i].h);
        line += ']';
    }
}

// Sides are uniform on 1..most.
int32_t most_side(int32_t bin_side) { return std::max(1, bin_side / 2); }

uint64_t most_bins(const pkc_generator_options &options) {
    const size_t digits = std::to_string(most_side(std::max(options.w, options.h))).size();
    const uint64_t bytes_per_item = 2 * digits + 4;
    const uint64_t items = std::min((kMaxLineBytes - kHeadBytes) / bytes_per_item, kMaxItems);
    return items / static_cast<uint64_t>(stream_items_per_bin(options.w, options.h));
}

}  // namespace

int64_t stream_items_per_bin(int32_t w, int32_t h) {
    // 1.2 * W * H / (mean w * mean h), the means being (most + 1) / 2: in whole numbers, so that
    // the quotient is rounded up exactly.
    const int64_t numerator = int64_t{24} * w * h;
    const int64_t denominator = int64_t{5} * (most_side(w) + 1) * (most_side(h) + 1);
    return (numerator + denominator - 1) / denominator;
}

void write_sets(const pkc_generator_options &options, uint64_t count, Output &out) {
    const GeneratorHandle generator = make_generator(options);
    std::vector<pkc_item> items(static_cast<size_t>(options.w) * static_cast<size_t>(options.h));
    Progress progress(!out.is_standard(), "sets");
    for (uint64_t i = 1; i <= count && interrupt_signal() == 0; ++i) {
        size_t filled = 0;
        check(pkc_generator_next(generator.get(), items.data(), items.size(), &filled));
        std::string line =
            "{\"id\":\"s" + std::to_string(i) + "\",\"bin\":" + bin_json(options) + ",\"items\":[";
        append_items(line, items, filled);
        line += "]}\n";
        out.write(line);
        progress.update(static_cast<double>(i) / static_cast<double>(count), i);
    }
}

void need_readable_stream(const pkc_generator_options &options, uint64_t bins) {
    const uint64_t most = most_bins(options);
    if (bins <= most) return;
    throw UsageError("--count '" + std::to_string(bins) + "': must be at most " +
                     std::to_string(most) + " bins of this size in one stream");
}

void write_stream(const pkc_generator_options &options, uint64_t bins, Output &out) {
    const GeneratorHandle generator = make_generator(options);
    std::vector<pkc_item> items(static_cast<size_t>(stream_items_per_bin(options.w, options.h)));
    std::string line = "{\"id\":\"r1\",\"bin\":" + bin_json(options) +
                       ",\"bins\":" + std::to_string(bins) + ",\"stream\":[";
    for (uint64_t i = 0; i < bins; ++i) {
        size_t filled = 0;
        check(pkc_generator_next(generator.get(), items.data(), items.size(), &filled));
        append_items(line, items, filled);
    }
    line += "]}\n";
    // Half a stream would be another stream: an interrupt leaves none.
    if (interrupt_signal() == 0) out.write(line);
}

}  // namespace packcell_programs
