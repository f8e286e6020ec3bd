#include "softplc/report.hpp"

#include <cstdio>
#include <nlohmann/json.hpp>

namespace packcell_programs {

namespace {

using Json = nlohmann::ordered_json;

constexpr const char *kStream = "belt";
constexpr double kHour = 3600;

std::string plural(int64_t count, const char *what) {
    return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

std::string fixed(double value, int digits) {
    char text[64];
    std::snprintf(text, sizeof text, "%.*f", digits, value);
    return text;
}

std::string span_text(const char *what, const Sample &sample) {
    return std::string(what) + " mean " + fixed(sample.mean(), 2) + ", p99 " +
           fixed(sample.quantile(0.99), 2) + ", max " + fixed(sample.max(), 2) + " ms";
}

Json span_json(const Sample &sample) {
    return Json{{"count", sample.size()},
                {"mean", sample.mean()},
                {"p99", sample.quantile(0.99)},
                {"max", sample.max()}};
}

std::string happened(const SequenceCounts &counts) {
    std::string text = plural(static_cast<int64_t>(counts.plans), "plan");
    if (counts.unpacked > 0) text += ", " + std::to_string(counts.unpacked) + " unpacked";
    if (counts.failed_places > 0)
        text += ", " + std::to_string(counts.failed_places) + " failed to be placed";
    if (counts.resolved > 0) text += ", " + std::to_string(counts.resolved) + " resolved";
    return text;
}

}  // namespace

Report::Report(const ReportOptions &options, const EpisodeLabel &label)
    : options_(options), label_(label), standard_("-") {
    if (!options.episodes.empty()) episodes_ = std::make_unique<Output>(options.episodes);
    if (!options.instances.empty()) instances_ = std::make_unique<Output>(options.instances);
}

void Report::bin_closed(const Bin &bin, const SequenceCounts &counts, double seconds) {
    ++bins_;
    items_ += static_cast<int64_t>(bin.placements.size());
    utilization_ += bin.utilization;
    if (episodes_) episodes_->write(episode_line(kStream, label_, bin));
    if (options_.quiet || options_.json) return;
    standard_.write("bin " + std::to_string(bins_) + ": " +
                    plural(static_cast<int64_t>(bin.placements.size()), "item") + ", " +
                    fixed(100 * bin.utilization, 1) + " %, " + fixed(seconds, 2) + " s, " +
                    happened(counts) + "\n");
}

void Report::finish(const std::vector<pkc_item> &stream, int32_t w, int32_t h,
                    const SequenceCounts &counts, const PlcCounts &plc, double seconds) {
    if (episodes_) episodes_->close();
    if (instances_) {
        Json sizes = Json::array();
        for (const pkc_item &item : stream) sizes.push_back(Json::array({item.w, item.h}));
        Json line{{"id", kStream}, {"bin", Json::array({w, h})}, {"bins", bins_}};
        line["stream"] = std::move(sizes);
        instances_->write(line.dump() + "\n");
        instances_->close();
    }
    const double mean = bins_ > 0 ? utilization_ / static_cast<double>(bins_) : 0;
    if (options_.json) {
        Json line{{"bins", bins_}, {"items", items_}, {"seconds", seconds}, {"utilization", mean}};
        line["plans"] = counts.plans;
        line["best_so_far"] = counts.best_so_far;
        line["unpacked"] = counts.unpacked;
        line["failed_places"] = counts.failed_places;
        line["resolved"] = counts.resolved;
        line["scans"] = plc.scans;
        line["commands"] = plc.commands;
        line["rejects"] = plc.rejects;
        line["restarts"] = plc.restarts;
        line["write_ms"] = span_json(plc.write_ms);
        line["ack_ms"] = span_json(plc.ack_ms);
        line["plan_ms"] = span_json(plc.plan_ms);
        standard_.write(line.dump() + "\n");
        return;
    }
    if (options_.quiet) return;
    const double hourly = seconds > 0 ? static_cast<double>(items_) * kHour / seconds : 0;
    std::string text = plural(bins_, "bin") + ", " + plural(items_, "item") + ", " +
                       fixed(100 * mean, 2) + " % full, " + fixed(seconds, 1) + " simulated s, " +
                       fixed(hourly, 0) + " items/h; " + happened(counts) + "\n";
    text += plural(static_cast<int64_t>(plc.commands), "command") + ", " +
            plural(static_cast<int64_t>(plc.rejects), "reject") + ", " +
            plural(static_cast<int64_t>(plc.restarts), "restart") + " of the gateway, " +
            std::to_string(plc.scans) + " scans\n";
    text += span_text("write request:        ", plc.write_ms) + "\n";
    text += span_text("command acknowledged: ", plc.ack_ms) + "\n";
    text += span_text("plan read:            ", plc.plan_ms) + "\n";
    standard_.write(text);
}

}  // namespace packcell_programs
