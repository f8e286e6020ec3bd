// Both CSV files: rows at even times, a header that names the units.
#include <cmath>

#include "base/status.h"
#include "trace/lanes.h"
#include "trace/text.h"
#include "trace/trace.h"

namespace packcell {

namespace {

constexpr int kDecimals = 6;
constexpr double kLeastPeriod = 1e-4;
constexpr double kMostPeriod = 3600;
constexpr double kMostRows = 1e7;

// Rows at 0, period, ... up to the makespan.
int64_t count_rows(const Schedule &schedule, double period) {
    if (!(period >= kLeastPeriod && period <= kMostPeriod))
        fail(Status::kArgument, "period %g s: must be %g..%g", period, kLeastPeriod, kMostPeriod);
    const double rows = std::floor(schedule.makespan / period + 1e-9) + 1;
    if (rows > kMostRows)
        fail(Status::kLimit, "period %g s: gives %.0f rows, at most %.0f are written", period, rows,
             kMostRows);
    return static_cast<int64_t>(rows);
}

// The third joint of a SCARA is its vertical axis.
const char *unit(const ArmModel &arm, int joint) {
    return arm.kind == ArmKind::kScara && joint == 2 ? "m" : "rad";
}

void append_field(std::string &out, double value) {
    out += ',';
    append_number(out, value, kDecimals);
}

void append_arm(std::string &out, const ArmTrack &track, double t) {
    const ArmModel &arm = track.model();
    const Coordinates c = track.coordinates(t);
    Joints q{};
    if (!joints_at(arm, c, q)) fail(Status::kState, "at %g s an arm is out of its range", t);
    for (int j = 0; j < arm.joints; ++j) append_field(out, q[static_cast<size_t>(j)]);
    const ToolPose tool = track.tool(t);
    for (const double v : {tool.x, tool.y, tool.z, tool.yaw}) append_field(out, v);
    const int32_t held = track.held(t);
    out += ',';
    if (held >= 0) append_number(out, held);
    const Motion *const m = track.motion(t);
    out += ',';
    out += activity_name(m == nullptr ? Activity::kWait : m->activity);
    out += ',';
    if (m != nullptr && m->activity == Activity::kWait) out += reason_name(m->reason);
}

}  // namespace

std::string timeline_csv(const TraceInput &input, double period) {
    check_input(input);
    const int64_t rows = count_rows(*input.schedule, period);
    std::vector<ArmTrack> tracks;
    std::string out = "time_s";
    for (int arm = 0; arm < input.schedule->robots; ++arm) {
        tracks.emplace_back(input, arm);
        const std::string name = ",arm" + std::to_string(arm) + "_";
        const ArmModel &model = tracks.back().model();
        for (int j = 0; j < model.joints; ++j)
            out += name + "q" + std::to_string(j + 1) + "_" + unit(model, j);
        for (const char *column :
             {"x_m", "y_m", "z_m", "yaw_rad", "held_item", "activity", "wait_for"})
            out += name + column;
    }
    out += ",clearance_m\n";
    for (int64_t row = 0; row < rows; ++row) {
        const double t = static_cast<double>(row) * period;
        append_number(out, t, kDecimals);
        for (const ArmTrack &track : tracks) append_arm(out, track, t);
        out += ',';
        if (tracks.size() == 2)
            append_number(out, clearance(tracks[0].footprint(t), tracks[1].footprint(t)),
                          kDecimals);
        out += '\n';
    }
    return out;
}

std::string joints_csv(const TraceInput &input, int arm, double period) {
    check_input(input);
    if (arm < 0 || arm >= input.schedule->robots)
        fail(Status::kArgument, "arm %d: must be 0..%d", arm, input.schedule->robots - 1);
    const int64_t rows = count_rows(*input.schedule, period);
    const ArmTrack track(input, arm);
    const ArmModel &model = track.model();
    std::string out = "time_s";
    const char *const kPowers[] = {"", "_s", "_s2"};
    for (int power = 0; power < 3; ++power) {
        for (int j = 0; j < model.joints; ++j)
            out += std::string(",") + "qva"[power] + std::to_string(j + 1) + "_" + unit(model, j) +
                   kPowers[power];
    }
    out += '\n';
    for (int64_t row = 0; row < rows; ++row) {
        const double t = static_cast<double>(row) * period;
        append_number(out, t, kDecimals);
        const JointState state = track.joints(t);
        for (const Joints *values : {&state.position, &state.velocity, &state.acceleration}) {
            for (int j = 0; j < model.joints; ++j)
                append_field(out, (*values)[static_cast<size_t>(j)]);
        }
        out += '\n';
    }
    return out;
}

}  // namespace packcell
