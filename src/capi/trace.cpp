#include "trace/trace.h"

#include "base/file.h"
#include "capi/cell_handles.h"

using namespace packcell;

namespace {

std::string draw(const TraceInput &input, int32_t kind, double period) {
    switch (kind) {
        case PKC_TRACE_CHROME:
            return chrome_trace(input);
        case PKC_TRACE_TIMELINE:
            return timeline_csv(input, period);
        case PKC_TRACE_JOINTS_0:
            return joints_csv(input, 0, period);
        case PKC_TRACE_JOINTS_1:
            return joints_csv(input, 1, period);
        case PKC_TRACE_GANTT:
            return gantt_svg(input);
        default:
            return replay_html(input);
    }
}

}  // namespace

extern "C" {

pkc_status pkc_trace_write_file(const pkc_schedule *schedule, const pkc_simulation *simulation,
                                int32_t kind, double period, const char *path) {
    return guard([&] {
        const Use<const pkc_schedule> use("schedule", schedule);
        require_range("kind", kind, PKC_TRACE_CHROME, PKC_TRACE_REPLAY);
        const bool sampled =
            kind == PKC_TRACE_TIMELINE || kind == PKC_TRACE_JOINTS_0 || kind == PKC_TRACE_JOINTS_1;
        if (sampled) require_finite("period", period, 0.0001, 10);
        require(path, "path");
        if (kind == PKC_TRACE_JOINTS_1 && use->schedule().robots < 2) {
            fail(Status::kArgument, "kind %d: the schedule has one arm", kind);
        }
        const TraceInput input{&use->scheduler.cell(), &use->scheduler.scenario(), &use->schedule(),
                               simulation == nullptr ? nullptr : &simulation->report};
        const std::string text = draw(input, kind, period);
        write_file(path, reinterpret_cast<const uint8_t *>(text.data()), text.size());
    });
}

}  // extern "C"
