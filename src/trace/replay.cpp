// The replay page: a template with the schedule as JSON in it. The page draws from segments and
// their time laws, so that any time between two samples is exact.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>

#include "base/status.h"
#include "motion/breakdown.h"
#include "trace/lanes.h"
#include "trace/text.h"
#include "trace/trace.h"

// The template as it is on disk.
__asm__(
    ".pushsection .rodata\n"
    "packcell_replay_page:\n"
    ".incbin \"" PACKCELL_REPLAY_PAGE
    "\"\n"
    "packcell_replay_page_end:\n"
    ".byte 0\n"
    ".popsection\n");

extern "C" const char packcell_replay_page[] __attribute__((visibility("hidden")));
extern "C" const char packcell_replay_page_end[] __attribute__((visibility("hidden")));

namespace packcell {

namespace {

using Json = nlohmann::ordered_json;

constexpr const char kPlaceholder[] = "@PACKCELL_REPLAY@";
constexpr int kMetres = 4;     // decimals: 0.1 mm
constexpr int kFine = 6;       // of what is computed with: 1 us, 1 um, 1 urad
constexpr int kMoreZones = 2;  // drawn upstream of those that an arm reaches

Json point(Point p) { return {rounded(p.x, kMetres), rounded(p.y, kMetres)}; }

Json names() {
    Json activities = Json::array();
    for (int i = 0; i < kActivities; ++i)
        activities.push_back(activity_name(static_cast<Activity>(i)));
    Json reasons = Json::array();
    Json texts = Json::array();
    for (int i = 0; i < kWaitReasons; ++i) {
        reasons.push_back(reason_name(static_cast<WaitReason>(i)));
        texts.push_back(reason_text(static_cast<WaitReason>(i)));
    }
    Json atomics = Json::array();
    for (int i = 0; i <= static_cast<int>(AtomicKind::kReady); ++i)
        atomics.push_back(atomic_name(static_cast<AtomicKind>(i)));
    return {{"activity", activities}, {"reason", reasons}, {"why", texts}, {"atomic", atomics}};
}

Json bin_of(const CellLayout &cell) {
    const BinPlace &bin = cell.bin;
    const Size cells = grid_bin(bin.grid);
    const Point first = cell_centre(cell, {0, 0, 1, 1});
    const double side = bin.grid.cell / 1000;
    return {{"centre", point(bin.centre)},
            {"w", rounded(bin.grid.bin_w / 1000, kMetres)},
            {"h", rounded(bin.grid.bin_h / 1000, kMetres)},
            {"wall", rounded(bin.wall, kMetres)},
            {"cols", cells.w},
            {"rows", cells.h},
            {"cell", rounded(side, kFine)},
            {"left", rounded(first.x - side / 2, kMetres)},
            {"top", rounded(first.y + side / 2, kMetres)}};
}

// Arms (bit 0, bit 1) that reach a zone.
int zone_reach(const Scenario &s, int zone) {
    if (zone >= s.n_max()) return 0;
    if (s.robots == 1) return 1;
    if (zone < s.accessible - s.overlap) return 1;
    return zone < s.accessible ? 3 : 2;
}

Json belt_of(const TraceInput &input) {
    const Scenario &s = *input.scenario;
    const int zones = std::min(s.n_max() + kMoreZones, std::max(s.n_max(), s.recognized));
    Json list = Json::array();
    for (int zone = 0; zone < zones; ++zone) {
        const Point centre = zone_centre(*input.cell, s, zone);
        list.push_back(
            {rounded(centre.x, kMetres), rounded(centre.y, kMetres), zone_reach(s, zone)});
    }
    return {{"zones", list},
            {"direction", rounded(input.cell->belt.direction, kFine)},
            {"pitch", rounded(input.cell->belt.pitch, kMetres)}};
}

Json coordinates(const Coordinates &c) {
    Json list = Json::array();
    for (const double v : c) list.push_back(rounded(v, kFine));
    return list;
}

// How the tool's yaw follows from the coordinates: the factor of each, 1, 0 or -1, and a constant.
Json yaw_terms(const ArmModel &arm, const Base &base) {
    const Coordinates origin{0, (arm.least_reach + arm.most_reach) / 2, 0, 0};
    const double yaw = tool_pose(arm, base, origin).yaw;
    Json terms = Json::array();
    double rest = yaw;
    for (size_t i = 0; i < origin.size(); ++i) {
        Coordinates moved = origin;
        moved[i] += 0.125;
        const double turn = std::remainder(tool_pose(arm, base, moved).yaw - yaw, 2 * kPi);
        const long term = std::lround(turn / 0.125);
        terms.push_back(term);
        rest -= static_cast<double>(term) * origin[i];
    }
    terms.push_back(rounded(rest, kFine));
    return terms;
}

Json arm_of(const TraceInput &input, int index) {
    const ArmPlace &place = input.cell->arms[static_cast<size_t>(index)];
    const ArmModel &arm = place.model;
    Json buffer = Json::array();
    for (const Point &p : place.buffer) buffer.push_back(point(p));
    return {{"name", std::string(arm.name, strnlen(arm.name, sizeof arm.name))},
            {"scara", arm.kind == ArmKind::kScara},
            {"base",
             {rounded(place.base.x, kFine), rounded(place.base.y, kFine),
              rounded(place.base.yaw, kFine)}},
            {"lateral", rounded(arm.lateral, kFine)},
            {"upper", rounded(arm.upper, kFine)},
            {"fore", rounded(arm.fore, kFine)},
            {"body", rounded(arm.body_radius, kMetres)},
            {"tool", rounded(arm.tool_radius, kMetres)},
            {"yaw", yaw_terms(arm, place.base)},
            {"home", point(place.home)},
            {"rest", coordinates(ArmTrack(input, index).coordinates(0))},
            {"buffer", buffer}};
}

Json lane_of(const std::vector<Motion> &lane) {
    Json list = Json::array();
    for (const Motion &m : lane) {
        Json row = {rounded(m.start, kFine),
                    rounded(m.segment.duration(), kFine),
                    static_cast<int>(m.activity),
                    static_cast<int>(m.reason),
                    static_cast<int>(m.atomic),
                    m.step,
                    m.item,
                    rounded(m.held, kMetres),
                    rounded(m.segment.law.ramp, kFine),
                    rounded(m.segment.law.blend, kFine),
                    rounded(m.segment.bow, kFine),
                    coordinates(m.segment.from)};
        if (m.segment.from != m.segment.to) row.push_back(coordinates(m.segment.to));
        list.push_back(std::move(row));
    }
    return list;
}

// Sides of all items that come up, by id.
Json items_of(const TraceInput &input) {
    std::map<int32_t, Item> items;
    for (const Handover &h : input.schedule->handovers) items.emplace(h.item.id, h.item);
    for (const BeltMove &move : input.schedule->belt) {
        for (const BeltMove::Shift &shift : move.shifts) items.emplace(shift.item.id, shift.item);
    }
    if (input.bin != nullptr) {
        for (const Placement &p : *input.bin) items.emplace(p.item.id, p.item);
    }
    if (input.simulation != nullptr) {
        for (const PlaceReport &place : input.simulation->places)
            items.emplace(place.item.id, place.item);
    }
    Json list = Json::array();
    for (const auto &[id, item] : items)
        list.push_back({id, rounded(item_side(*input.cell, item.w), kMetres),
                        rounded(item_side(*input.cell, item.h), kMetres)});
    return list;
}

Json handovers_of(const Schedule &schedule) {
    Json list = Json::array();
    for (const Handover &h : schedule.handovers) {
        if (h.aside) continue;  // nothing changes hands
        list.push_back({rounded(h.time, kFine), h.arm, h.step, h.grip ? 1 : 0, h.item.id,
                        static_cast<int>(h.at.spot), rounded(h.where.x, kMetres),
                        rounded(h.where.y, kMetres), rounded(h.yaw, kFine)});
    }
    return list;
}

// What is skipped leaves the belt before it moves.
Json gone_of(const Schedule &schedule) {
    Json list = Json::array();
    for (const BeltMove &move : schedule.belt) {
        for (const int32_t item : move.gone) list.push_back({rounded(move.start, kFine), item});
    }
    return list;
}

Json belt_moves_of(const TraceInput &input) {
    const BeltPlace &belt = input.cell->belt;
    Json list = Json::array();
    for (const BeltMove &move : input.schedule->belt) {
        Json shifts = Json::array();
        for (const BeltMove::Shift &s : move.shifts) {
            const Point from = zone_centre(*input.cell, *input.scenario, s.from);
            const Point to = zone_centre(*input.cell, *input.scenario, s.to);
            const TimeLaw law = fastest(LawKind::kTrapezoid, distance(from, to),
                                        {belt.speed, belt.acceleration, input.cell->jerk});
            shifts.push_back({s.item.id, rounded(from.x, kMetres), rounded(from.y, kMetres),
                              rounded(to.x, kMetres), rounded(to.y, kMetres),
                              rounded(law.ramp, kFine)});
        }
        list.push_back({rounded(move.start, kFine), rounded(move.duration, kFine), move.step,
                        std::move(shifts)});
    }
    return list;
}

// What lay in the bin before and stays there or is taken out.
Json bin_before(const TraceInput &input) {
    Json list = Json::array();
    if (input.bin == nullptr) return list;
    for (const Placement &p : *input.bin) {
        const Point centre = cell_centre(*input.cell, p.rect());
        list.push_back({p.item.id, rounded(centre.x, kMetres), rounded(centre.y, kMetres),
                        rounded(p.rot != 0 ? kPi / 2 : 0, kFine)});
    }
    return list;
}

// ---- Simulated poses ---------------------------------------------------------------------------

struct Key {
    double t, x, y, yaw;
};

// Whether a straight line between the keys at both ends passes all between them.
bool straight(const std::vector<Key> &keys, size_t first, size_t last) {
    constexpr double kNear = 0.0003;  // metres
    constexpr double kTurn = 0.005;   // radians
    const Key &a = keys[first];
    const Key &b = keys[last];
    for (size_t i = first + 1; i < last; ++i) {
        const Key &k = keys[i];
        const double s = b.t > a.t ? (k.t - a.t) / (b.t - a.t) : 1;
        if (std::fabs(a.x + s * (b.x - a.x) - k.x) > kNear ||
            std::fabs(a.y + s * (b.y - a.y) - k.y) > kNear ||
            std::fabs(a.yaw + s * (b.yaw - a.yaw) - k.yaw) > kTurn)
            return false;
    }
    return true;
}

// An item's frames hold until the next one; the page draws straight lines between fewer keys.
void add_frame(std::vector<Key> &keys, const ItemFrame &frame) {
    constexpr double kRest = 0.06;   // seconds without a frame: it lay still
    constexpr double kStart = 0.04;  // before the frame that ends the rest
    Key key{frame.time, static_cast<double>(frame.x), static_cast<double>(frame.y),
            static_cast<double>(frame.yaw)};
    if (!keys.empty()) {
        const Key &last = keys.back();
        key.yaw = last.yaw + std::remainder(key.yaw - last.yaw, 2 * kPi);
        if (key.t - last.t > kRest) keys.push_back({key.t - kStart, last.x, last.y, last.yaw});
    }
    keys.push_back(key);
}

Json thinned(const std::vector<Key> &keys) {
    constexpr size_t kMostSpan = 256;
    Json list = Json::array();
    const auto push = [&](const Key &k) {
        list.push_back(rounded(k.t, 3));
        list.push_back(rounded(k.x, kMetres));
        list.push_back(rounded(k.y, kMetres));
        list.push_back(rounded(k.yaw, 3));
    };
    push(keys[0]);
    for (size_t at = 0; at + 1 < keys.size();) {
        size_t next = at + 1;
        while (next + 1 < keys.size() && next - at < kMostSpan && straight(keys, at, next + 1))
            ++next;
        push(keys[next]);
        at = next;
    }
    return list;
}

Json simulated(const SimulationReport &report) {
    std::map<int32_t, std::vector<Key>> items;
    for (const ItemFrame &frame : report.frames) add_frame(items[frame.item], frame);
    Json frames = Json::object();
    for (const auto &[id, keys] : items) frames[std::to_string(id)] = thinned(keys);
    Json faults = Json::array();
    for (const PlaceReport &p : report.places) {
        if (p.outcome == PlaceOutcome::kJammed || p.outcome == PlaceOutcome::kMisplaced)
            faults.push_back({rounded(p.time, kFine), p.item.id, static_cast<int>(p.outcome),
                              rounded(p.gone, kFine)});
    }
    return {{"places", report.places.size()},
            {"jams", report.jams},
            {"misplaced", report.misplaced},
            {"worst", rounded(report.worst_error, 5)},
            {"faults", faults},
            {"frames", frames}};
}

// JSON that may stand in a script element: no markup in it.
std::string harmless(const Json &data) {
    const std::string text = data.dump(-1, ' ', true, Json::error_handler_t::replace);
    std::string out;
    out.reserve(text.size());
    for (const char c : text) {
        if (c == '<')
            out += "\\u003c";
        else if (c == '>')
            out += "\\u003e";
        else if (c == '&')
            out += "\\u0026";
        else
            out += c;
    }
    return out;
}

Json data_of(const TraceInput &input) {
    const Schedule &schedule = *input.schedule;
    Json arms = Json::array();
    Json lanes = Json::array();
    for (int arm = 0; arm < schedule.robots; ++arm) {
        arms.push_back(arm_of(input, arm));
        lanes.push_back(lane_of(schedule.lanes[arm]));
    }
    Json planning = Json::array();
    for (const PlanningSpan &span : schedule.planning)
        planning.push_back({rounded(span.start, kFine), rounded(span.duration, kFine), span.step});
    Json spans = Json::array();
    for (const BinSpan &s : bin_spans(schedule))
        spans.push_back({rounded(s.start, kFine), rounded(s.end, kFine), s.arm, s.step, s.item});
    Json steps = Json::array();
    for (const StepStart &s : step_starts(schedule))
        steps.push_back({s.step, rounded(s.time, kFine)});
    Json data = {{"title", title(input)},
                 {"makespan", rounded(schedule.makespan, kFine)},
                 {"bound", rounded(schedule.lower_bound, kFine)},
                 {"margin", rounded(input.cell->margin, kMetres)},
                 {"names", names()},
                 {"bin", bin_of(*input.cell)},
                 {"belt", belt_of(input)},
                 {"arms", arms},
                 {"lanes", lanes},
                 {"items", items_of(input)},
                 {"before", bin_before(input)},
                 {"handovers", handovers_of(schedule)},
                 {"gone", gone_of(schedule)},
                 {"moves", belt_moves_of(input)},
                 {"planning", planning},
                 {"spans", spans},
                 {"steps", steps}};
    if (input.simulation != nullptr) data["simulation"] = simulated(*input.simulation);
    return data;
}

}  // namespace

std::string replay_html(const TraceInput &input) {
    check_input(input);
    const std::string page(packcell_replay_page, packcell_replay_page_end);
    const size_t at = page.find(kPlaceholder);
    if (at == std::string::npos) fail(Status::kInternal, "the replay page has no place for data");
    return page.substr(0, at) + harmless(data_of(input)) + page.substr(at + strlen(kPlaceholder));
}

}  // namespace packcell
