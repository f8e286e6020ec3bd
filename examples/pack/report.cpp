#include "pack/report.hpp"

#include <algorithm>
#include <cstdio>
#include <vector>

#include "common/draw.hpp"
#include "common/terminal.hpp"
#include "common/text.hpp"

namespace packcell_programs {

namespace {

constexpr size_t kBinsShown = 3;
constexpr size_t kLabelColumns = 16;
constexpr size_t kNameBytes = 60;

template <typename... Values>
std::string format(const char *pattern, Values... values) {
    char text[200];
    std::snprintf(text, sizeof text, pattern, values...);
    return text;
}

std::string row(std::string label, const std::string &value) {
    label.resize(std::max(label.size() + 1, kLabelColumns), ' ');
    return label + value + "\n";
}

std::string title_of(const Instance &instance, const Bin &bin) {
    std::string title = instance.id;
    if (!instance.is_set) title += " #" + std::to_string(bin.index);
    return title + format(" %.1f %%", 100 * bin.utilization);
}

}  // namespace

Report::Report(Output &episodes, const EpisodeLabel &label, const std::string &svg_directory,
               uint64_t input_bytes, bool quiet)
    : episodes_(episodes),
      label_(label),
      svg_directory_(svg_directory),
      input_bytes_(input_bytes),
      progress_(!quiet && !is_terminal(episodes.descriptor()), "bins") {}

void Report::bin_closed(const Instance &instance, const Bin &bin) {
    episodes_.write(episode_line(instance.id, label_, bin));
    if (!svg_directory_.empty()) write_svg(instance, bin);
    count(bin);
    last_.push_back(Shown{title_of(instance, bin), bin});
    last_.back().bin.steps.clear();
    if (last_.size() > kBinsShown) last_.pop_front();

    const double share = static_cast<double>(++bins_of_open_) /
                         static_cast<double>(std::max<int64_t>(1, instance.bins));
    const double bytes = bytes_done_ + static_cast<double>(instance.bytes) * share;
    progress_.update(input_bytes_ > 0 ? bytes / static_cast<double>(input_bytes_) : -1, bins_,
                     format("mean %.1f %%", 100 * utilization_.mean()));
}

void Report::instance_done(const Instance &instance) {
    bytes_done_ += static_cast<double>(instance.bytes);
    bins_of_open_ = 0;
}

void Report::count(const Bin &bin) {
    ++bins_;
    full_ += bin.full ? 1 : 0;
    packed_ += bin.placements.size();
    add_counts(counts_, count_bin(bin));
    utilization_.add(bin.utilization);
    for (const Step &step : bin.steps) plan_ms_.add(step.milliseconds);
}

// The number in front keeps names apart whatever the ids are.
void Report::write_svg(const Instance &instance, const Bin &bin) const {
    const std::string number = format("%06llu", static_cast<unsigned long long>(bins_ + 1));
    Output file(svg_directory_ + "/" + number + "-" + file_name_part(instance.id, kNameBytes) +
                "-" + std::to_string(bin.index) + ".svg");
    file.write(draw_svg(bin, title_of(instance, bin)));
    file.close();
}

std::string Report::figures(bool utf8) const {
    std::string text =
        row("scenario", name_of(label_.scenario) + ", rotation " +
                            (label_.rotation ? "on" : "off") + ", repack " + label_.repack);
    text += row("planner", label_.method + ", " + label_.policy);
    text += row("bins", std::to_string(bins_) + ", " + std::to_string(full_) + " of them full");
    std::string interval;
    if (bins_ > 1) {
        interval = format(" %s %.2f (95 %% interval)", utf8 ? "\u00b1" : "+-",
                          100 * utilization_.half_width_95());
    }
    text += row("utilisation", format("%.2f %%", 100 * utilization_.mean()) + interval);
    text += row("packed items", std::to_string(packed_));
    if (counts_.skipped > 0) text += row("skipped items", std::to_string(counts_.skipped));
    text += row("steps", std::to_string(counts_.packing_steps));
    if (counts_.unpacks > 0) {
        text += row("repacked items", std::to_string(counts_.unpacks) + " in " +
                                          std::to_string(counts_.repack_steps) + " steps");
        text += row("largest buffer", std::to_string(counts_.largest_buffer));
    }
    text += row("planning, ms",
                format("mean %.3g, p50 %.3g, p99 %.3g, max %.3g", plan_ms_.mean(),
                       plan_ms_.quantile(0.5), plan_ms_.quantile(0.99), plan_ms_.max()));
    return text;
}

std::string Report::summary(size_t columns, bool utf8) const {
    if (bins_ == 0) return "no bins\n";
    std::vector<std::vector<std::string>> pictures;
    for (const Shown &shown : last_) {
        pictures.push_back(draw_text(shown.bin, shown.title, columns, utf8));
    }
    return join_pictures(pictures, columns) + figures(utf8);
}

}  // namespace packcell_programs
