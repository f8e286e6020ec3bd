#include "sim/summary.hpp"

#include <algorithm>
#include <cstdio>
#include <vector>

#include "common/text.hpp"

namespace packcell_programs {

namespace {

constexpr size_t kLabelColumns = 17;
constexpr size_t kArmColumns = 11;

template <typename... Values>
std::string format(const char *pattern, Values... values) {
    char text[200];
    std::snprintf(text, sizeof text, pattern, values...);
    return text;
}

// "1 bin", "2 bins".
std::string counted(int64_t count, const char *what) {
    return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

class Block {
public:
    Block(size_t columns, bool utf8) : columns_(columns), utf8_(utf8) {}

    void title(const std::string &text) { text_ += clip_columns(text, columns_) + "\n"; }

    // The parts go beside each other, and below where there is no more room.
    void row(const std::string &label, const std::vector<std::string> &parts) {
        std::string line = padded(label);
        size_t width = kLabelColumns;
        for (size_t i = 0; i < parts.size(); ++i) {
            const std::string part = parts[i] + (i + 1 < parts.size() ? "," : "");
            const size_t wide = columns_of(part) + (i > 0 ? 1 : 0);
            if (i > 0 && width + wide > columns_) {
                text_ += line + "\n";
                line = padded("") + part;
                width = kLabelColumns + columns_of(part);
            } else {
                line += (i > 0 ? " " : "") + part;
                width += wide;
            }
        }
        text_ += line + "\n";
    }

    // A value for each arm.
    void arms(const std::string &label, const std::vector<std::string> &values) {
        std::string line = padded(label);
        for (const std::string &value : values) {
            line +=
                std::string(kArmColumns - std::min(kArmColumns, columns_of(value)), ' ') + value;
        }
        text_ += line + "\n";
    }

    bool utf8() const { return utf8_; }
    const std::string &text() const { return text_; }

private:
    static std::string padded(std::string label) {
        label.resize(std::max(label.size() + (label.empty() ? 0 : 1), kLabelColumns), ' ');
        return label;
    }

    size_t columns_;
    bool utf8_;
    std::string text_;
};

void makespan_rows(Block &block, const CellFigures &f) {
    const auto bins = static_cast<double>(f.bins);
    if (f.bins == 1) {
        block.row("makespan",
                  {format("%.2f s", f.makespan.mean()), format("at least %.2f s", f.lower_bound),
                   format("%.1f %% above it", 100 * f.gap())});
        return;
    }
    block.row("makespan", {format("mean %.2f %s %.2f s", f.makespan.mean(),
                                  block.utf8() ? "\u00b1" : "+-", f.makespan.half_width_95()),
                           format("at least %.2f s", f.lower_bound / bins),
                           format("%.1f %% above it", 100 * f.gap())});
    if (f.makespans() > 0) {
        block.row("throughput", {format("%.0f items an hour",
                                        3600 * static_cast<double>(f.items) / f.makespans())});
    }
}

void arm_rows(Block &block, const CellFigures &f) {
    const auto bins = static_cast<double>(f.bins);
    const auto add = [&](const std::string &label, const auto &value, const char *pattern,
                         double factor) {
        std::vector<std::string> values(static_cast<size_t>(f.robots));
        for (int arm = 0; arm < f.robots; ++arm)
            values[static_cast<size_t>(arm)] = format(pattern, factor * value(arm));
        block.arms(label, values);
    };
    const auto seconds = [&](const std::string &label, const auto &value) {
        add(label, value, "%.2f s", 1 / bins);
    };
    std::vector<std::string> names(static_cast<size_t>(f.robots));
    for (int arm = 0; arm < f.robots; ++arm)
        names[static_cast<size_t>(arm)] = "arm " + std::to_string(arm);
    block.arms(f.bins == 1 ? "" : "mean of a bin", names);
    seconds("travel", [&](int arm) { return f.arms[arm].travel; });
    seconds("strokes", [&](int arm) { return f.arms[arm].strokes; });
    seconds("grips", [&](int arm) { return f.arms[arm].grips; });
    for (int reason = 1; reason < PKC_WAIT_COUNT; ++reason) {
        const double sum = f.arms[0].waits[reason] + f.arms[1].waits[reason];
        if (sum < 0.005) continue;  // would read 0.00 s
        seconds(std::string("wait: ") + wait_name(reason),
                [&](int arm) { return f.arms[arm].waits[reason]; });
    }
    add(
        "busy", [&](int arm) { return f.busy(arm); }, "%.1f %%", 100);
}

void mode_row(Block &block, const CellFigures &f) {
    std::vector<std::string> parts;
    for (int32_t mode = PKC_MODE_COORDINATED; mode >= PKC_MODE_SYNC_PAPER; --mode) {
        if (f.taken[mode] == 0) continue;
        parts.push_back(mode_name(mode) +
                        (f.bins > 1 ? " " + std::to_string(f.taken[mode]) : std::string()));
    }
    block.row(f.bins > 1 ? "schedules taken" : "schedule taken", parts);
}

void measured_rows(Block &block, const CellFigures &f) {
    const double steps = static_cast<double>(std::max<int64_t>(1, f.steps));
    block.row("measured, a step", {format("planner %.2f ms", f.plan_ms / steps),
                                   format("coordination %.2f ms", f.motion_ms / steps)});
    if (!f.simulated) return;
    block.row("simulation", {counted(f.jams, "jam"), std::to_string(f.misplaced) + " misplaced",
                             format("error at most %.3f mm", 1000 * f.worst_error),
                             format("overlap %.3f mm", 1000 * f.worst_overlap),
                             format("%.0f x real time", f.times_real())});
    if (f.missed > 0) block.row("photo-eyes", {counted(f.missed, "arrival") + " missed"});
    if (f.retries + f.repacks + f.set_aside > 0) {
        block.row("planned again", {std::to_string(f.retries) + " retried",
                                    std::to_string(f.repacks) + " with repacking",
                                    std::to_string(f.set_aside) + " set aside"});
    }
}

}  // namespace

std::string summary_block(const std::string &title, const CellFigures &f, size_t columns,
                          bool utf8) {
    Block block(columns, utf8);
    block.title(title);
    std::vector<std::string> packed = {
        format("%.1f %%", 100 * f.utilization.mean()),
        counted(f.items, "item") + " in " + counted(f.steps, "step")};
    if (f.bins > 1) packed.insert(packed.begin() + 1, std::to_string(f.full) + " bins full");
    if (f.unpacks > 0) packed.push_back(std::to_string(f.unpacks) + " unpacked");
    block.row("packed", packed);
    makespan_rows(block, f);
    arm_rows(block, f);
    const auto bins = static_cast<double>(f.bins);
    block.row("beside them", {format("belt moves %.2f s", f.belt / bins),
                              format("planning %.2f s", f.planning / bins)});
    if (f.min_clearance >= 0) {
        block.row("clearance", {format("%.1f mm at the least", 1000 * f.min_clearance)});
    }
    mode_row(block, f);
    measured_rows(block, f);
    if (f.bins == 1) {
        block.row("schedule hash",
                  {format("%016llx", static_cast<unsigned long long>(f.schedule_hash))});
        if (f.simulated) {
            block.row("simulation hash",
                      {format("%016llx", static_cast<unsigned long long>(f.simulation_hash))});
        }
    }
    return block.text();
}

}  // namespace packcell_programs
