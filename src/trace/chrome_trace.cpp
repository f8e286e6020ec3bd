// The schedule as Chrome trace events: complete events in microseconds, one thread for each lane.
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "trace/lanes.h"
#include "trace/text.h"
#include "trace/trace.h"

namespace packcell {

namespace {

using Json = nlohmann::ordered_json;

constexpr double kClearancePeriod = 0.05;  // seconds between the counter's values
constexpr double kMostCounts = 1e5;

int64_t microseconds(double t) { return std::llround(rounded(t, 6) * 1e6); }

class Writer {
public:
    int thread(const char *name) {
        const int id = static_cast<int>(++threads_);
        events_.push_back({{"name", "thread_name"},
                           {"ph", "M"},
                           {"pid", 1},
                           {"tid", id},
                           {"args", {{"name", name}}}});
        events_.push_back({{"name", "thread_sort_index"},
                           {"ph", "M"},
                           {"pid", 1},
                           {"tid", id},
                           {"args", {{"sort_index", id}}}});
        return id;
    }

    // Both ends are rounded, not the duration: what follows without a gap does so here too.
    void span(int thread, const std::string &name, const char *category, double start, double end,
              Json arguments) {
        const int64_t from = microseconds(start);
        events_.push_back({{"name", name},
                           {"cat", category},
                           {"ph", "X"},
                           {"pid", 1},
                           {"tid", thread},
                           {"ts", from},
                           {"dur", std::max<int64_t>(0, microseconds(end) - from)},
                           {"args", std::move(arguments)}});
    }

    void count(const char *name, double t, double metres) {
        events_.push_back({{"name", name},
                           {"ph", "C"},
                           {"pid", 1},
                           {"ts", microseconds(t)},
                           {"args", {{"m", rounded(metres, 4)}}}});
    }

    Json take() { return std::move(events_); }

private:
    Json events_ = Json::array();
    int64_t threads_ = 0;
};

void write_arm(Writer &writer, const Schedule &schedule, int arm) {
    const int thread = writer.thread(arm == 0 ? "arm 0" : "arm 1");
    for (const Motion &m : schedule.lanes[arm]) {
        Json arguments = {{"action", atomic_name(m.atomic)}};
        if (m.step >= 0) arguments["step"] = m.step;
        if (m.item >= 0) arguments["item"] = m.item;
        std::string name = activity_name(m.activity);
        if (m.activity == Activity::kWait) {
            arguments["reason"] = reason_text(m.reason);
            name += std::string(": ") + reason_name(m.reason);
        } else if (m.item >= 0) {
            name += " " + std::to_string(m.item);
        }
        writer.span(thread, name, activity_name(m.activity), m.start, m.end(),
                    std::move(arguments));
    }
}

// Both arms may be in the bin at once: the lane is cut wherever one comes or goes, so that its
// events do not overlap.
void write_bin(Writer &writer, const Schedule &schedule) {
    const int thread = writer.thread("bin");
    const std::vector<BinSpan> spans = bin_spans(schedule);
    std::vector<double> cuts;
    for (const BinSpan &s : spans) {
        cuts.push_back(s.start);
        cuts.push_back(s.end);
    }
    std::sort(cuts.begin(), cuts.end());
    for (size_t i = 0; i + 1 < cuts.size(); ++i) {
        if (microseconds(cuts[i]) == microseconds(cuts[i + 1])) continue;
        std::string name;
        Json items = Json::array();
        Json steps = Json::array();
        for (const BinSpan &s : spans) {
            if (s.start > cuts[i] || s.end < cuts[i + 1]) continue;
            name += (name.empty() ? "arm " : " and ") + std::to_string(s.arm);
            items.push_back(s.item);
            steps.push_back(s.step);
        }
        if (!items.empty())
            writer.span(thread, name, "bin", cuts[i], cuts[i + 1],
                        {{"item", items}, {"step", steps}});
    }
}

void write_clearance(Writer &writer, const TraceInput &input) {
    const ArmTrack tracks[] = {{input, 0}, {input, 1}};
    const double makespan = input.schedule->makespan;
    const double period = std::max(kClearancePeriod, makespan / kMostCounts);
    const auto samples = static_cast<int64_t>(makespan / period) + 1;
    double last = -1;
    for (int64_t i = 0; i < samples; ++i) {
        const double t = static_cast<double>(i) * period;
        const double d = rounded(clearance(tracks[0].footprint(t), tracks[1].footprint(t)), 4);
        if (i > 0 && std::equal_to<double>()(d, last)) continue;
        writer.count("clearance between the arms", t, d);
        last = d;
    }
}

}  // namespace

std::string chrome_trace(const TraceInput &input) {
    check_input(input);
    const Schedule &schedule = *input.schedule;
    Writer writer;
    for (int arm = 0; arm < schedule.robots; ++arm) write_arm(writer, schedule, arm);

    const int belt = writer.thread("belt");
    for (const BeltMove &move : schedule.belt) {
        Json items = Json::array();
        for (const BeltMove::Shift &shift : move.shifts) items.push_back(shift.item.id);
        writer.span(belt, "index", "belt", move.start, move.start + move.duration,
                    {{"step", move.step}, {"items", items}});
    }
    const int planner = writer.thread("planner");
    for (const PlanningSpan &span : schedule.planning) {
        writer.span(planner, "plan step " + std::to_string(span.step), "plan", span.start,
                    span.start + span.duration, {{"step", span.step}});
    }
    write_bin(writer, schedule);
    if (schedule.robots == 2) write_clearance(writer, input);

    Json out = {{"displayTimeUnit", "ms"},
                {"otherData",
                 {{"title", title(input)},
                  {"makespan_s", rounded(schedule.makespan, 6)},
                  {"lower_bound_s", rounded(schedule.lower_bound, 6)}}}};
    out["traceEvents"] = writer.take();
    // Bytes that are no UTF-8 are replaced.
    return out.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace packcell
