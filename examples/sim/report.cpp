#include "sim/report.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <utility>
#include <vector>

#include "common/draw.hpp"
#include "common/terminal.hpp"
#include "sim/summary.hpp"

namespace packcell_programs {

namespace {

constexpr size_t kBinsShown = 3;

struct TraceFile {
    int32_t kind;
    const char *name;
};
constexpr TraceFile kTraceFiles[] = {
    {PKC_TRACE_CHROME, "trace.json"},     {PKC_TRACE_TIMELINE, "timeline.csv"},
    {PKC_TRACE_JOINTS_0, "joints-0.csv"}, {PKC_TRACE_JOINTS_1, "joints-1.csv"},
    {PKC_TRACE_GANTT, "gantt.svg"},       {PKC_TRACE_REPLAY, "replay.html"},
};

std::string title_of(const Instance &instance, int64_t index) {
    return instance.id +
           (instance.is_set || instance.bins == 1 ? "" : " #" + std::to_string(index));
}

// A bin that goes on after a jam in its last step has that step's end in the middle.
void end_once(std::vector<Step> &steps) {
    for (size_t i = 0; i + 1 < steps.size(); ++i) {
        std::vector<pkc_action> &actions = steps[i].actions;
        actions.erase(std::remove_if(actions.begin(), actions.end(),
                                     [](const pkc_action &a) { return a.op == PKC_OP_TERMINATE; }),
                      actions.end());
    }
}

}  // namespace

Report::Report(const ReportOptions &options, const EpisodeLabel &label, const std::string &cell,
               uint64_t bins)
    : options_(options),
      label_(label),
      cell_(cell),
      wanted_bins_(bins),
      standard_("-"),
      progress_(!options.quiet && !(options.json && is_terminal(STDOUT_FILENO)), "bins"),
      columns_(terminal_columns(STDOUT_FILENO)),
      utf8_(shows_utf8()) {
    if (!options.out.empty()) make_directory(options.out);
    if (!options.episodes.empty()) episodes_ = std::make_unique<Output>(options.episodes);
}

void Report::step_done(const std::string &id, int64_t steps, int64_t expected) {
    const double part = std::min(
        0.95, static_cast<double>(steps) / static_cast<double>(std::max<int64_t>(1, expected)));
    const double done = static_cast<double>(all_.bins) + part;
    progress_.update(wanted_bins_ > 0 ? done / static_cast<double>(wanted_bins_) : -1,
                     static_cast<uint64_t>(all_.bins), id + ", step " + std::to_string(steps));
}

std::string Report::folder(bool alone) const {
    if (alone) return options_.out;
    char name[32];
    std::snprintf(name, sizeof name, "/bin-%04lld", static_cast<long long>(all_.bins + 1));
    return options_.out + name;
}

void Report::write_traces(const CellRun &run, const std::string &folder) const {
    make_directory(folder);
    for (const TraceFile &file : kTraceFiles) {
        if (file.kind == PKC_TRACE_JOINTS_1 && label_.scenario.robots < 2) continue;
        check(pkc_trace_write_file(run.schedule.get(), run.simulation.get(), file.kind,
                                   options_.period, (folder + "/" + file.name).c_str()));
    }
}

void Report::bin_closed(const Instance &instance, int64_t index, CellRun &run, bool alone) {
    const std::string title = title_of(instance, index);
    const CellFigures figures = figures_of(run, label_.scenario.robots);
    Bin bin = std::move(run.bin);
    if (!options_.out.empty()) {
        write_traces(run, folder(alone));
        Output drawing(folder(alone) + "/bin.svg");
        drawing.write(draw_svg(bin, title));
        drawing.close();
    }
    if (episodes_) {
        bin.index = index;
        bin.steps = std::move(run.steps);
        end_once(bin.steps);
        episodes_->write(episode_line(instance.id, label_, bin));
        bin.steps.clear();
    }
    add_figures(all_, figures);
    progress_.clear();
    if (options_.json) {
        standard_.write(figures_line(instance.id, index, cell_, label_, figures));
    } else if (!options_.quiet) {
        standard_.write(summary_block(title, figures, columns_, utf8_) + "\n");
    }
    char percent[32];
    std::snprintf(percent, sizeof percent, " %.1f %%", 100 * bin.utilization);
    last_.push_back({title + percent, std::move(bin)});
    if (last_.size() > kBinsShown) last_.pop_front();
}

void Report::bin_failed(CellRun &run, bool alone) {
    progress_.clear();
    if (options_.out.empty() || run.steps.empty()) return;
    try {
        write_traces(run, folder(alone));
    } catch (const Failure &) {
        // The failure that is reported is the one before.
    }
}

void Report::finish() {
    progress_.clear();
    if (episodes_) episodes_->close();
    if (options_.json || options_.quiet) return;
    if (all_.bins == 0) {
        standard_.write("no bins\n");
        return;
    }
    std::vector<std::vector<std::string>> pictures;
    for (const Shown &shown : last_) {
        pictures.push_back(draw_text(shown.bin, shown.title, columns_, utf8_));
    }
    std::string text = join_pictures(pictures, columns_);
    if (all_.bins > 1) {
        text += summary_block("all " + std::to_string(all_.bins) + " bins", all_, columns_, utf8_);
    }
    standard_.write(text);
}

}  // namespace packcell_programs
