// The Gantt chart as one SVG file: lanes of arms, belt, planner and bin over the seconds.
#include <algorithm>
#include <cmath>

#include "motion/breakdown.h"
#include "trace/lanes.h"
#include "trace/text.h"
#include "trace/trace.h"

namespace packcell {

namespace {

constexpr double kLeft = 96;  // of second 0, for the lanes' names
constexpr double kRight = 72;
constexpr double kTop = 76;
constexpr double kLeastChart = 860;
constexpr double kMostChart = 24000;
constexpr double kPixelsPerSecond = 15;
constexpr double kBar = 26;
constexpr double kLabelRow = 14;  // above an arm's bars: what they are for
constexpr double kThinBar = 16;
constexpr double kLaneGap = 12;
constexpr double kLetter = 5.9;  // width at the labels' size

// Colours are classes, not variables, which some viewers of SVG do not know.
const char *const kStyle = R"css(
svg { background: #ffffff; }
text { font: 11px system-ui, -apple-system, "Segoe UI", Roboto, "DejaVu Sans", sans-serif; fill: #1f2933; }
.head { font-size: 16px; font-weight: 600; }
.muted { fill: #66717f; }
.lane { font-weight: 600; font-size: 12px; }
.mid { text-anchor: middle; }
.end { text-anchor: end; }
.grid { stroke: #e6e9ee; stroke-width: 1; }
.step { stroke: #b9c1cb; stroke-width: 1; stroke-dasharray: 2 3; }
.track { fill: #f5f6f8; }
.finish { stroke: #1f2933; stroke-width: 1.5; }
.bound { stroke: #1f2933; stroke-width: 1.5; stroke-dasharray: 5 4; }
.travel { fill: #64778b; }
.lower, .lift { fill: #b6c2cd; }
.grip { fill: #2c3e50; }
.release { fill: #d08a2e; }
.belt { fill: #8a6d4b; }
.plan { fill: #7a5ea8; }
.arm0 { fill: #3f73b0; }
.arm1 { fill: #2f8f6b; }
.base { fill: #eef0f3; }
.h1 { stroke: #8a6d4b; } .h2 { stroke: #7a5ea8; } .h3 { stroke: #c0504d; } .h4 { stroke: #b06a9a; }
.h5 { stroke: #a8862a; } .h6 { stroke: #5c7285; } .h7, .h0 { stroke: #d4d9e0; }
@media (prefers-color-scheme: dark) {
svg { background: #14171c; }
text { fill: #e4e8ee; }
.muted { fill: #98a3b1; }
.grid { stroke: #262c35; }
.step { stroke: #4a5462; }
.track { fill: #1a1e25; }
.finish, .bound { stroke: #e4e8ee; }
.travel { fill: #7b8fa4; }
.lower, .lift { fill: #46535f; }
.grip { fill: #dde5ec; }
.arm0 { fill: #5b93d6; }
.arm1 { fill: #45b088; }
.release { fill: #e0a450; }
.belt { fill: #b08e66; }
.plan { fill: #9b82c9; }
.base { fill: #20252d; }
.h1 { stroke: #b08e66; } .h2 { stroke: #9b82c9; } .h3 { stroke: #e07a77; } .h4 { stroke: #cf8fbd; }
.h5 { stroke: #cbaa52; } .h6 { stroke: #8ba1b5; } .h7, .h0 { stroke: #333b46; }
}
)css";

double text_width(const std::string &text) { return kLetter * static_cast<double>(text.size()); }

// 1, 2 or 5 times a power of ten, or whole minutes, at least `least` seconds.
double tick_step(double least) {
    for (const double s : {0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 30.0, 60.0, 120.0, 300.0,
                           600.0, 1800.0, 3600.0}) {
        if (s >= least) return s;
    }
    return 3600 * std::ceil(least / 3600);
}

class Chart {
public:
    explicit Chart(const TraceInput &input)
        : input_(input),
          schedule_(*input.schedule),
          span_(schedule_.makespan > 0 ? schedule_.makespan : 1),
          chart_(std::clamp(kPixelsPerSecond * span_, kLeastChart, kMostChart)),
          scale_(chart_ / span_) {}

    std::string draw() {
        y_ = kTop;
        for (int arm = 0; arm < schedule_.robots; ++arm) draw_arm(arm);
        draw_belt();
        draw_planner();
        draw_bin();
        const double bottom = y_ - kLaneGap + 6;
        const double height = draw_legend(bottom + 44);

        std::string out =
            "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
            "<svg xmlns=\"http://www.w3.org/2000/svg\" role=\"img\" width=\"";
        append_number(out, width(), 0);
        out += "\" height=\"";
        append_number(out, height, 0);
        out += "\" viewBox=\"0 0 ";
        append_number(out, width(), 0);
        out += ' ';
        append_number(out, height, 0);
        out += "\">\n<title>Schedule of " + escaped(title(input_)) + "</title>\n<style>";
        out += kStyle;
        out += "</style>\n";
        out += patterns();
        out += backdrop(bottom);
        out += body_;
        out += marks(bottom);
        out += "</svg>\n";
        return out;
    }

private:
    double width() const { return kLeft + chart_ + kRight; }
    double x(double t) const { return kLeft + scale_ * t; }

    static void text(std::string &out, double x, double y, const char *classes,
                     const std::string &words) {
        out += "<text x=\"";
        append_number(out, x, 1);
        out += "\" y=\"";
        append_number(out, y, 1);
        out += std::string("\" class=\"") + classes + "\">" + escaped(words) + "</text>\n";
    }

    static void line(std::string &out, double x1, double y1, double x2, double y2,
                     const char *classes) {
        out += std::string("<line class=\"") + classes + "\" x1=\"";
        append_number(out, x1, 2);
        out += "\" y1=\"";
        append_number(out, y1, 1);
        out += "\" x2=\"";
        append_number(out, x2, 2);
        out += "\" y2=\"";
        append_number(out, y2, 1);
        out += "\"/>\n";
    }

    // `paint` is a class, or the number of a hatch as "#w3".
    static void box(std::string &out, double x, double y, double w, double h,
                    const std::string &paint, const std::string &words) {
        out += "<rect x=\"";
        append_number(out, x, 2);
        out += "\" y=\"";
        append_number(out, y, 1);
        out += "\" width=\"";
        append_number(out, w, 2);
        out += "\" height=\"";
        append_number(out, h, 1);
        out += paint[0] == '#' ? "\" fill=\"url(" + paint + ")\"" : "\" class=\"" + paint + "\"";
        out += words.empty() ? "/>\n" : "><title>" + escaped(words) + "</title></rect>\n";
    }

    void bar(double start, double end, double y, double h, const std::string &paint,
             const std::string &words) {
        box(body_, x(start), y, std::max(0.5, scale_ * (end - start)), h, paint,
            words + ", " + number(start, 2) + " to " + number(end, 2) + " s");
    }

    void lane_name(double middle, const std::string &name, const std::string &note) {
        text(body_, 16, note.empty() ? middle + 4 : middle - 2, "lane", name);
        if (!note.empty()) text(body_, 16, middle + 12, "muted", note);
    }

    void draw_arm(int arm) {
        const std::vector<Motion> &lane = schedule_.lanes[arm];
        const double top = y_ + kLabelRow;
        std::string note;
        if (schedule_.makespan > 0) note = number(busy_share(lane), 0) + " % busy";
        lane_name(top + kBar / 2, "arm " + std::to_string(arm), note);
        box(body_, kLeft, top, chart_, kBar, "track", "");
        for (const Motion &m : lane) {
            const std::string paint = m.activity == Activity::kWait
                                          ? "#w" + std::to_string(static_cast<int>(m.reason))
                                          : activity_name(m.activity);
            std::string words = motion_title(m);
            if (m.step >= 0) words += ", step " + std::to_string(m.step);
            bar(m.start, m.end(), top, kBar, paint, words);
        }
        for (size_t i = 0; i < lane.size();) i = draw_group(lane, i, y_ + 10);
        y_ = top + kBar + kLaneGap;
    }

    // Per cent of the makespan.
    double busy_share(const std::vector<Motion> &lane) const {
        const ArmTimes times = arm_times(lane);
        return 100 * (times.travel + times.strokes + times.grips) / schedule_.makespan;
    }

    // Names what the pieces of one atomic action are for, as much as fits over them.
    size_t draw_group(const std::vector<Motion> &lane, size_t first, double y) {
        const Motion &a = lane[first];
        size_t last = first;
        while (last + 1 < lane.size() && lane[last + 1].atomic == a.atomic &&
               lane[last + 1].item == a.item && lane[last + 1].step == a.step)
            ++last;
        if (a.item >= 0) {
            const double room = scale_ * (lane[last].end() - a.start) - 8;
            const std::string id = std::to_string(a.item);
            const std::string full = std::string(atomic_name(a.atomic)) + " " + id;
            const double middle = x((a.start + lane[last].end()) / 2);
            if (text_width(full) <= room)
                text(body_, middle, y, "mid muted", full);
            else if (text_width(id) <= room)
                text(body_, middle, y, "mid muted", id);
        }
        return last + 1;
    }

    // Returns the top of the lane.
    double thin_lane(const char *name) {
        const double top = y_;
        lane_name(top + kThinBar / 2, name, "");
        box(body_, kLeft, top, chart_, kThinBar, "track", "");
        y_ += kThinBar + kLaneGap;
        return top;
    }

    void draw_belt() {
        const double top = thin_lane("belt");
        for (const BeltMove &move : schedule_.belt) {
            std::string words = "belt moves";
            const char *separator = " ";
            for (const BeltMove::Shift &shift : move.shifts) {
                words += separator + std::to_string(shift.item.id);
                separator = ", ";
            }
            words += ", for step " + std::to_string(move.step);
            bar(move.start, move.start + move.duration, top, kThinBar, "belt", words);
        }
    }

    void draw_planner() {
        const double top = thin_lane("planner");
        for (const PlanningSpan &span : schedule_.planning)
            bar(span.start, span.start + span.duration, top, kThinBar, "plan",
                "plans step " + std::to_string(span.step));
    }

    // The upper half is arm 0's, where there are two.
    void draw_bin() {
        const double top = thin_lane("bin");
        const double h = kThinBar / schedule_.robots;
        for (const BinSpan &s : bin_spans(schedule_)) {
            const std::string arm = std::to_string(s.arm);
            bar(s.start, s.end, top + h * s.arm, h, "arm" + arm,
                "arm " + arm + " in the bin for " + std::to_string(s.item));
        }
    }

    std::string patterns() const {
        std::string out = "<defs>\n";
        for (int reason = 0; reason < kWaitReasons; ++reason) {
            const std::string id = std::to_string(reason);
            out += "<pattern id=\"w" + id +
                   "\" width=\"6\" height=\"6\" patternUnits=\"userSpaceOnUse\" "
                   "patternTransform=\"rotate(45)\"><rect class=\"base\" width=\"6\" height=\"6\"/>"
                   "<line class=\"h" +
                   id + "\" x1=\"1\" y1=\"0\" x2=\"1\" y2=\"6\" stroke-width=\"2\"/></pattern>\n";
        }
        return out + "</defs>\n";
    }

    // What lies behind the bars: title, axis, steps.
    std::string backdrop(double bottom) const {
        std::string out;
        text(out, 16, 28, "head", title(input_));
        std::string words = "makespan " + number(schedule_.makespan, 2) + " s";
        if (schedule_.lower_bound > 0)
            words += ", lower bound " + number(schedule_.lower_bound, 2) + " s";
        const std::vector<StepStart> steps = step_starts(schedule_);
        if (!steps.empty()) words += ", " + std::to_string(steps.size()) + " steps";
        text(out, 16, 46, "muted", words);

        const double tick = tick_step(56 / scale_);
        const auto ticks = static_cast<int64_t>(std::floor(span_ / tick + 1e-9));
        for (int64_t i = 0; i <= ticks; ++i) {
            const double t = static_cast<double>(i) * tick;
            line(out, x(t), kTop - 6, x(t), bottom, "grid");
            text(out, x(t), kTop - 11, "mid muted", number(t, tick < 1 ? 1 : 0) + " s");
        }
        double free_from = 0;
        for (const StepStart &s : steps) {
            line(out, x(s.time), kTop, x(s.time), bottom, "step");
            const std::string name = std::to_string(s.step);
            if (x(s.time) < free_from) continue;
            text(out, x(s.time) + 2, bottom + 11, "muted", name);
            free_from = x(s.time) + text_width(name) + 6;
        }
        if (!steps.empty()) text(out, kLeft - 8, bottom + 11, "end muted", "step");
        return out;
    }

    // The makespan and the lower bound, over the bars.
    std::string marks(double bottom) const {
        std::string out;
        line(out, x(schedule_.makespan), kTop - 6, x(schedule_.makespan), bottom + 16, "finish");
        text(out, x(schedule_.makespan) + 5, bottom + 14, "", number(schedule_.makespan, 1) + " s");
        const double bound = schedule_.lower_bound;
        if (bound > 0 && bound <= span_ * 1.02) {
            line(out, x(bound), kTop - 6, x(bound), bottom + 26, "bound");
            text(out, x(bound) - 5, bottom + 26, "end", "lower bound " + number(bound, 1) + " s");
        }
        return out;
    }

    // Returns the picture's height.
    double draw_legend(double y) {
        double at = 16;
        const auto entry = [&](const std::string &paint, const std::string &words) {
            const double room = 20 + text_width(words) + 18;
            if (at + room > width() && at > 16) {
                at = 16;
                y += 20;
            }
            box(body_, at, y - 10, 14, 12, paint, "");
            text(body_, at + 20, y, "", words);
            at += room;
        };
        entry("travel", "travel");
        entry("lower", "lower, lift");
        entry("grip", "grip");
        entry("release", "release");
        bool used[kWaitReasons] = {};
        for (const std::vector<Motion> &lane : schedule_.lanes) {
            for (const Motion &m : lane)
                if (m.activity == Activity::kWait) used[static_cast<int>(m.reason)] = true;
        }
        for (int reason = 1; reason < kWaitReasons; ++reason) {
            if (!used[reason]) continue;
            entry("#w" + std::to_string(reason),
                  std::string("wait: ") + reason_text(static_cast<WaitReason>(reason)));
        }
        entry("belt", "belt moves");
        entry("plan", "planning");
        if (schedule_.robots == 2) {
            entry("arm0", "arm 0 in the bin");
            entry("arm1", "arm 1 in the bin");
        }
        return y + 20;
    }

    const TraceInput &input_;
    const Schedule &schedule_;
    double span_;   // seconds of the chart
    double chart_;  // its width
    double scale_;  // pixels a second
    double y_ = 0;  // where the next lane begins
    std::string body_;
};

}  // namespace

std::string gantt_svg(const TraceInput &input) {
    check_input(input);
    return Chart(input).draw();
}

}  // namespace packcell
