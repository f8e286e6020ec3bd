// The files that show a schedule: whole, true to it, and harmless whatever the names in it.
#include "trace/trace.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "base/status.h"
#include "motion/breakdown.h"
#include "trace/text.h"

extern "C" {
#include <cmocka.h>
}

namespace packcell {
namespace {

using Json = nlohmann::json;

void assert_near(double a, double b, double most) {
    if (!(std::fabs(a - b) <= most)) fail_msg("%.9g and %.9g are not within %g", a, b, most);
}

// ---- A schedule by hand ------------------------------------------------------------------------

// Writes one arm's lane and handovers, a piece after the other.
class Hand {
public:
    Hand(const CellLayout &cell, Schedule &schedule, int arm)
        : cell_(cell), schedule_(schedule), arm_(arm), place_(cell.arms[static_cast<size_t>(arm)]) {
        const ToolPose home{place_.home.x, place_.home.y, high(), 0};
        assert_true(solve(place_.model, place_.base, home, Coordinates{}, true, at_));
    }

    double now() const { return now_; }

    void wait(double duration, WaitReason reason) {
        push(rest(at_, duration), Activity::kWait, reason);
    }

    void home(int step) {
        kind_ = AtomicKind::kReady;
        step_ = step;
        item_ = -1;
        travel(place_.home, 0);
    }

    void pick(int step, const Item &item, Location from, Point where, double yaw) {
        begin(AtomicKind::kPick, step, item);
        move(item, from, where, yaw, true);
    }

    void put(int step, const Item &item, Location to, Point where, double yaw) {
        begin(AtomicKind::kPlaceToBin, step, item);
        move(item, to, where, yaw, false);
    }

private:
    double low() const { return cell_.work_height; }
    double high() const { return cell_.work_height + cell_.dwells.stroke; }

    void begin(AtomicKind kind, int step, const Item &item) {
        kind_ = kind;
        step_ = step;
        item_ = item.id;
    }

    void push(const Segment &segment, Activity activity, WaitReason reason) {
        Motion m;
        m.start = now_;
        m.segment = segment;
        m.activity = activity;
        m.reason = reason;
        m.atomic = kind_;
        m.step = step_;
        m.item = item_;
        m.held = held_;
        schedule_.lanes[arm_].push_back(m);
        now_ = m.end();
        at_ = segment.to;
    }

    void go(const Coordinates &to, Activity activity) {
        push(fastest_segment(place_.model, cell_.law, cell_.tool_speed, at_, to), activity,
             WaitReason::kNone);
    }

    void travel(Point to, double yaw) {
        Coordinates c;
        assert_true(solve(place_.model, place_.base, {to.x, to.y, high(), yaw}, at_, true, c));
        go(c, Activity::kTravel);
    }

    void move(const Item &item, Location at, Point where, double yaw, bool grip) {
        travel(where, yaw);
        Coordinates down = at_;
        down[kHeight] -= high() - low();
        const Coordinates up = at_;
        go(down, Activity::kLower);
        push(rest(at_, grip ? 0.3 : 0.2), grip ? Activity::kGrip : Activity::kRelease,
             WaitReason::kNone);
        held_ = grip ? half_diagonal(cell_, item) : 0;
        Handover h;
        h.time = now_;
        h.arm = arm_;
        h.step = step_;
        h.grip = grip;
        h.item = item;
        h.at = at;
        h.where = where;
        h.yaw = yaw;
        h.tool_yaw = yaw;
        schedule_.handovers.push_back(h);
        go(up, Activity::kLift);
    }

    const CellLayout &cell_;
    Schedule &schedule_;
    int arm_;
    const ArmPlace &place_;
    Coordinates at_{};
    double now_ = 0;
    double held_ = 0;
    AtomicKind kind_ = AtomicKind::kReady;
    int step_ = 0;
    int item_ = -1;
};

struct Example {
    CellLayout cell;
    Scenario scenario;
    Schedule schedule;

    TraceInput input() const { return {&cell, &scenario, &schedule, nullptr, nullptr}; }
};

// Each arm in turn takes items from the belt to the bin, the second one a step later; ids 40, 41...
Example make_example(int robots, const char *preset = "ur5e", int rounds = 3) {
    Example e;
    e.cell = cell_preset(preset);
    e.scenario = parse_scenario(robots == 2 ? "D-R5A3O1" : "S-R5A3");
    Schedule &s = e.schedule;
    s.robots = robots;
    const double yaw = e.cell.belt.direction;
    const double belt = belt_time(e.cell, 1);
    std::vector<Hand> hands;
    for (int arm = 0; arm < robots; ++arm) hands.emplace_back(e.cell, s, arm);
    for (int round = 0; round < rounds; ++round) {
        double begin = 0;
        for (const Hand &hand : hands) begin = std::max(begin, hand.now());
        BeltMove move{begin, belt, round, {}, {}};
        for (int arm = 0; arm < robots; ++arm) {
            Hand &hand = hands[static_cast<size_t>(arm)];
            const Item item{40 + round * robots + arm, 2, 3, 0};
            const int zone = arm == 0 ? 1 : 3;
            move.shifts.push_back({item, zone + 1, zone});
            hand.wait(begin + belt - hand.now(), arm == 0 ? WaitReason::kBelt : WaitReason::kSync);
            hand.wait(0.25, WaitReason::kPlanning);
            hand.pick(round, item, {Spot::kBelt, zone, {}, 0},
                      zone_centre(e.cell, e.scenario, zone), yaw);
            if (arm == 1) hand.wait(hands[0].now() - hand.now() + 4, WaitReason::kBin);
            const Rect cells{3 * round, 4 * arm, 2, 3};
            hand.put(round, item, {Spot::kBin, 0, cells, 0}, cell_centre(e.cell, cells), 0);
            hand.home(round);
        }
        s.belt.push_back(move);
        s.planning.push_back({begin + belt, 0.25, round});
    }
    for (const Hand &hand : hands) s.makespan = std::max(s.makespan, hand.now());
    for (Hand &hand : hands) {
        if (hand.now() < s.makespan) hand.wait(s.makespan - hand.now(), WaitReason::kDone);
    }
    std::stable_sort(s.handovers.begin(), s.handovers.end(),
                     [](const Handover &a, const Handover &b) { return a.time < b.time; });
    s.lower_bound = 0.7 * s.makespan;
    return e;
}

Example make_empty(int robots) {
    Example e;
    e.cell = cell_preset("ur5e");
    e.scenario = parse_scenario(robots == 2 ? "D-R5A3O1" : "S-R5A3");
    e.schedule.robots = robots;
    return e;
}

// ---- Readers -----------------------------------------------------------------------------------

using Table = std::vector<std::vector<std::string>>;

Table read_csv(const std::string &text) {
    Table rows;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
        std::vector<std::string> fields(1);
        for (const char c : line) {
            if (c == ',')
                fields.emplace_back();
            else
                fields.back() += c;
        }
        rows.push_back(fields);
    }
    assert_int_equal(text.back(), '\n');
    return rows;
}

size_t column(const Table &table, const std::string &name) {
    const auto at = std::find(table[0].begin(), table[0].end(), name);
    if (at == table[0].end()) fail_msg("no column %s", name.c_str());
    return static_cast<size_t>(at - table[0].begin());
}

double value(const std::string &field) {
    char *end = nullptr;
    const double v = std::strtod(field.c_str(), &end);
    if (field.empty() || *end != '\0' || !std::isfinite(v))
        fail_msg("'%s' is no finite number", field.c_str());
    return v;
}

size_t count(const std::string &text, const std::string &part) {
    size_t n = 0;
    for (size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
    return n;
}

// Tags match, attributes are quoted and named once, entities are known. "" or what is wrong.
std::string xml_fault(const std::string &xml) {
    const std::set<std::string> entities = {"amp", "lt", "gt", "quot", "#39"};
    std::vector<std::string> open;
    int roots = 0;
    for (size_t i = 0; i < xml.size(); ++i) {
        const auto c = static_cast<unsigned char>(xml[i]);
        if (c < 0x20 && c != '\n') return "a control character";
        if (c == '&') {
            const size_t end = xml.find(';', i);
            if (end == std::string::npos || entities.count(xml.substr(i + 1, end - i - 1)) == 0)
                return "an ampersand at " + xml.substr(i, 20);
        }
        if (c != '<') continue;
        const size_t end = xml.find('>', i);
        if (end == std::string::npos) return "a tag without end";
        std::string tag = xml.substr(i + 1, end - i - 1);
        i = end;
        if (tag[0] == '?') continue;
        if (tag[0] == '/') {
            if (open.empty() || open.back() != tag.substr(1)) return "</" + tag.substr(1) + ">";
            open.pop_back();
            continue;
        }
        const bool closed = tag.back() == '/';
        if (closed) tag.pop_back();
        const size_t name_end = std::min(tag.find(' '), tag.size());
        const std::string name = tag.substr(0, name_end);
        if (name.empty() || name.find_first_of("<\"'=&") != std::string::npos) return "<" + tag;
        std::set<std::string> names;
        for (size_t at = name_end; at < tag.size();) {
            const size_t equals = tag.find("=\"", at);
            if (equals == std::string::npos) return "<" + tag;
            const size_t quote = tag.find('"', equals + 2);
            if (quote == std::string::npos) return "<" + tag;
            if (!names.insert(tag.substr(at + 1, equals - at - 1)).second) return "twice in " + tag;
            if (tag.substr(equals + 2, quote - equals - 2).find('<') != std::string::npos)
                return "<" + tag;
            at = quote + 1;
        }
        if (open.empty()) ++roots;
        if (!closed) open.push_back(name);
    }
    if (!open.empty()) return open.back() + " is not closed";
    return roots == 1 ? "" : "not one root";
}

// The data of a replay page.
Json data_of(const std::string &page) {
    const std::string mark = "<script type=\"application/json\" id=\"data\">";
    assert_int_equal(count(page, mark), 1);
    const size_t from = page.find(mark) + mark.size();
    return Json::parse(page.substr(from, page.find("</script>", from) - from));
}

using Lanes = std::map<std::string, std::vector<Json>>;

Lanes lanes_of(const Json &trace) {
    std::map<int, std::string> names;
    Lanes lanes;
    for (const Json &e : trace["traceEvents"]) {
        if (e["ph"] == "M" && e["name"] == "thread_name") names[e["tid"]] = e["args"]["name"];
    }
    for (const auto &[id, name] : names) lanes[name];
    for (const Json &e : trace["traceEvents"]) {
        if (e["ph"] == "X") lanes[names.at(e["tid"])].push_back(e);
    }
    return lanes;
}

Status status_of(const TraceInput &input) {
    try {
        gantt_svg(input);
    } catch (const Error &error) {
        return error.status();
    }
    return Status::kOk;
}

// ---- Chrome trace ------------------------------------------------------------------------------

void test_the_lanes_of_a_chrome_trace_do_not_overlap(void **) {
    const Example e = make_example(2);
    const Json trace = Json::parse(chrome_trace(e.input()));
    const Lanes lanes = lanes_of(trace);
    assert_int_equal(lanes.size(), 5);
    for (const auto &[name, events] : lanes) {
        assert_false(events.empty());
        int64_t end = 0;
        for (const Json &event : events) {
            assert_true(event["ts"].get<int64_t>() >= end);
            end = event["ts"].get<int64_t>() + event["dur"].get<int64_t>();
        }
        assert_true(end <= std::llround(e.schedule.makespan * 1e6));
    }
}

void test_the_arms_lanes_sum_to_the_makespan(void **) {
    const Example e = make_example(2);
    const Lanes lanes = lanes_of(Json::parse(chrome_trace(e.input())));
    for (const char *name : {"arm 0", "arm 1"}) {
        int64_t sum = 0;
        for (const Json &event : lanes.at(name)) sum += event["dur"].get<int64_t>();
        assert_int_equal(sum, std::llround(e.schedule.makespan * 1e6));
    }
}

void test_events_say_step_item_and_why_an_arm_waits(void **) {
    const Example e = make_example(2);
    const Lanes lanes = lanes_of(Json::parse(chrome_trace(e.input())));
    std::set<int> items;
    std::set<std::string> reasons;
    for (const char *name : {"arm 0", "arm 1"}) {
        for (const Json &event : lanes.at(name)) {
            assert_true(event["args"].contains("step"));
            if (event["args"].contains("item")) items.insert(event["args"]["item"].get<int>());
            assert_int_equal(event["cat"] == "wait", event["args"].contains("reason"));
            if (event["cat"] == "wait") reasons.insert(event["args"]["reason"]);
        }
    }
    assert_int_equal(items.size(), 6);
    assert_int_equal(reasons.count("no item has arrived"), 1);
    assert_int_equal(reasons.count("the other arm has the bin"), 1);
}

void test_the_bin_is_occupied_from_lower_to_lift(void **) {
    const Example e = make_example(1);
    const Lanes lanes = lanes_of(Json::parse(chrome_trace(e.input())));
    const std::vector<Json> &bin = lanes.at("bin");
    assert_int_equal(bin.size(), 3);
    size_t at = 0;
    for (const Motion &m : e.schedule.lanes[0]) {
        if (m.atomic != AtomicKind::kPlaceToBin) continue;
        if (m.activity == Activity::kLower)
            assert_int_equal(bin[at]["ts"], std::llround(m.start * 1e6));
        if (m.activity == Activity::kLift) {
            const int64_t end = bin[at]["ts"].get<int64_t>() + bin[at]["dur"].get<int64_t>();
            assert_int_equal(end, std::llround(m.end() * 1e6));
            assert_int_equal(bin[at]["args"]["item"][0], m.item);
            ++at;
        }
    }
    assert_int_equal(at, 3);
}

// The second arm does the same as the first one a little later.
void test_both_arms_in_the_bin_are_one_event(void **) {
    constexpr double kLater = 0.3;
    Example e = make_example(1, "ur5e", 1);
    e.scenario = parse_scenario("D-R5A3O1");
    Schedule &s = e.schedule;
    s.robots = 2;
    Motion wait;
    wait.segment = rest(s.lanes[0][0].segment.from, kLater);
    s.lanes[1].push_back(wait);
    for (Motion m : s.lanes[0]) {
        m.start += kLater;
        s.lanes[1].push_back(m);
    }
    for (size_t i = 0, n = s.handovers.size(); i < n; ++i) {
        Handover h = s.handovers[i];
        h.arm = 1;
        h.time += kLater;
        s.handovers.push_back(h);
    }
    const Lanes lanes = lanes_of(Json::parse(chrome_trace(e.input())));
    std::vector<std::string> names;
    for (const Json &event : lanes.at("bin")) names.push_back(event["name"]);
    const std::vector<std::string> expected = {"arm 0", "arm 0 and 1", "arm 1"};
    assert_true(names == expected);
}

void test_the_clearance_is_a_counter_where_there_are_two_arms(void **) {
    for (int robots = 1; robots <= 2; ++robots) {
        const Example e = make_example(robots);
        int counts = 0;
        const Json trace = Json::parse(chrome_trace(e.input()));
        for (const Json &event : trace["traceEvents"]) {
            if (event["ph"] != "C") continue;
            ++counts;
            const double t = event["ts"].get<double>() / 1e6;
            assert_near(event["args"]["m"].get<double>(), clearance_at(e.cell, e.schedule, t),
                        2e-4);
        }
        if (robots == 1 ? counts != 0 : counts <= 20) fail_msg("%d counts", counts);
    }
}

// ---- CSV ---------------------------------------------------------------------------------------

void test_a_timeline_has_a_row_for_each_period(void **) {
    const Example e = make_example(2);
    const Table table = read_csv(timeline_csv(e.input(), 0.05));
    assert_int_equal(table.size(), 2 + static_cast<size_t>(e.schedule.makespan / 0.05));
    assert_int_equal(table[0].size(), 1 + 2 * (6 + 4 + 3) + 1);
    assert_string_equal(table[0][0].c_str(), "time_s");
    for (size_t row = 1; row < table.size(); ++row) {
        assert_int_equal(table[row].size(), table[0].size());
        assert_near(value(table[row][0]), 0.05 * static_cast<double>(row - 1), 1e-9);
    }
}

void test_a_timeline_says_where_the_arms_are(void **) {
    for (const char *preset : {"ur5e", "scara"}) {
        const Example e = make_example(2, preset);
        const Table table = read_csv(timeline_csv(e.input(), 0.1));
        const size_t clear = column(table, "clearance_m");
        for (size_t row = 1; row < table.size(); ++row) {
            const double t = value(table[row][0]);
            for (int arm = 0; arm < 2; ++arm) {
                const ArmPlace &place = e.cell.arms[static_cast<size_t>(arm)];
                const std::string name = "arm" + std::to_string(arm) + "_";
                Joints q{};
                for (int j = 0; j < place.model.joints; ++j) {
                    const bool metres = place.model.kind == ArmKind::kScara && j == 2;
                    q[static_cast<size_t>(j)] = value(table[row][column(
                        table, name + "q" + std::to_string(j + 1) + (metres ? "_m" : "_rad"))]);
                }
                const ToolPose tool = forward(place.model, place.base, q);
                assert_near(tool.x, value(table[row][column(table, name + "x_m")]), 1e-5);
                assert_near(tool.y, value(table[row][column(table, name + "y_m")]), 1e-5);
                assert_near(tool.z, value(table[row][column(table, name + "z_m")]), 1e-5);
                const double yaw = value(table[row][column(table, name + "yaw_rad")]);
                assert_near(std::remainder(tool.yaw - yaw, 2 * kPi), 0, 1e-5);
            }
            assert_near(value(table[row][clear]), clearance_at(e.cell, e.schedule, t), 1e-5);
        }
    }
}

void test_a_timeline_says_what_the_gripper_holds(void **) {
    const Example e = make_example(1);
    const Table table = read_csv(timeline_csv(e.input(), 0.01));
    const size_t held = column(table, "arm0_held_item");
    const size_t activity = column(table, "arm0_activity");
    const size_t reason = column(table, "arm0_wait_for");
    for (size_t row = 1; row < table.size(); ++row) {
        const double t = value(table[row][0]);
        std::string expected;
        for (const Handover &h : e.schedule.handovers) {
            if (h.time <= t) expected = h.grip ? std::to_string(h.item.id) : "";
        }
        assert_string_equal(table[row][held].c_str(), expected.c_str());
        const bool waits = motion_at(e.schedule.lanes[0], t).activity == Activity::kWait;
        assert_int_equal(table[row][activity] == "wait", waits);
        assert_int_equal(table[row][reason].empty(), !waits);
    }
}

void test_one_arm_has_no_clearance(void **) {
    const Example e = make_example(1);
    const Table table = read_csv(timeline_csv(e.input(), 0.1));
    assert_int_equal(table[0].size(), 1 + 6 + 4 + 3 + 1);
    for (size_t row = 1; row < table.size(); ++row) assert_true(table[row].back().empty());
}

void test_set_points_are_each_others_derivatives(void **) {
    const Example e = make_example(2);
    constexpr double kPeriod = 0.001;
    const Table table = read_csv(joints_csv(e.input(), 1, kPeriod));
    assert_int_equal(table[0].size(), 1 + 3 * 6);
    int tested = 0;
    for (size_t row = 2; row + 1 < table.size(); ++row) {
        const Motion &m = motion_at(e.schedule.lanes[1], value(table[row][0]));
        const bool inside = &m == &motion_at(e.schedule.lanes[1], value(table[row - 1][0])) &&
                            &m == &motion_at(e.schedule.lanes[1], value(table[row + 1][0]));
        for (size_t j = 1; j <= 6; ++j) {
            const double v = value(table[row][6 + j]);
            const double a = value(table[row][12 + j]);
            if (m.activity == Activity::kWait) {
                assert_near(v, 0, 0);
                assert_near(a, 0, 0);
            }
            if (!inside) continue;
            const double mean =
                (value(table[row + 1][j]) - value(table[row - 1][j])) / (2 * kPeriod);
            assert_near(v, mean, 0.01);
            if (std::fabs(v) > 0.1) ++tested;
        }
    }
    assert_true(tested > 1000);
}

void test_a_period_out_of_range_is_refused(void **) {
    const Example e = make_example(1);
    for (const double period : {0.0, -1.0, 1e-9, 1e9, std::numeric_limits<double>::quiet_NaN()}) {
        Status status = Status::kOk;
        try {
            timeline_csv(e.input(), period);
        } catch (const Error &error) {
            status = error.status();
        }
        assert_int_equal(static_cast<int>(status), static_cast<int>(Status::kArgument));
    }
}

void test_the_locale_does_not_change_numbers(void **) {
    std::string text;
    append_number(text, -0.00001, 3);
    append_number(text, 1234.5, 2);
    append_number(text, -2.25, 1);
    assert_string_equal(text.c_str(), "0.0001234.50-2.2");
}

// ---- Gantt -------------------------------------------------------------------------------------

void test_a_gantt_chart_is_well_formed_and_names_each_item(void **) {
    for (int robots = 1; robots <= 2; ++robots) {
        const Example e = make_example(robots);
        const std::string svg = gantt_svg(e.input());
        assert_string_equal(xml_fault(svg).c_str(), "");
        for (const Handover &h : e.schedule.handovers) {
            const std::string id = std::to_string(h.item.id);
            assert_true(count(svg, "pick " + id + ",") > 0);
            assert_true(count(svg, "place " + id + ",") > 0);
        }
        size_t motions = 0;
        for (const std::vector<Motion> &lane : e.schedule.lanes) motions += lane.size();
        assert_true(count(svg, "<rect ") >= motions);
        assert_int_equal(count(svg, "lower bound"), 2);
        assert_int_equal(count(svg, "prefers-color-scheme: dark"), 1);
        assert_int_equal(count(svg, "http"), 1);  // the name space
    }
}

void test_bars_are_to_scale(void **) {
    const Example e = make_example(1);
    const std::string svg = gantt_svg(e.input());
    double sum = 0;
    double chart = 0;
    for (size_t at = svg.find("<rect "); at != std::string::npos; at = svg.find("<rect ", at + 1)) {
        const std::string tag = svg.substr(at, svg.find('>', at) - at);
        const auto attribute = [&tag](const char *name) {
            const size_t from = tag.find(name) + std::string(name).size();
            return value(tag.substr(from, tag.find('"', from) - from));
        };
        if (tag.find(" height=\"26.0\"") == std::string::npos) continue;
        if (tag.find("class=\"track\"") != std::string::npos)
            chart = attribute(" width=\"");
        else
            sum += attribute(" width=\"");
    }
    assert_near(sum, chart, 0.02 * chart);
}

// ---- Replay ------------------------------------------------------------------------------------

void test_a_replay_page_needs_no_network(void **) {
    const Example e = make_example(2);
    const std::string page = replay_html(e.input());
    for (const char *part : {"http:", "https:", "src=", "@import", "url(", "@PACKCELL"})
        assert_int_equal(count(page, part), 0);
}

void test_a_replay_page_holds_the_schedule(void **) {
    Example e = make_example(2);
    e.schedule.lanes[0][2].segment.bow = 0.0125;
    const Json data = data_of(replay_html(e.input()));
    assert_near(data["makespan"].get<double>(), e.schedule.makespan, 1e-6);
    assert_int_equal(data["items"].size(), 6);
    assert_int_equal(data["handovers"].size(), e.schedule.handovers.size());
    for (size_t arm = 0; arm < 2; ++arm) {
        assert_int_equal(data["lanes"][arm].size(), e.schedule.lanes[arm].size());
        for (size_t i = 0; i < data["lanes"][arm].size(); ++i) {
            const Json &row = data["lanes"][arm][i];
            const Motion &m = e.schedule.lanes[arm][i];
            assert_near(row[0].get<double>(), m.start, 1e-6);
            assert_near(row[1].get<double>(), m.segment.duration(), 1e-6);
            assert_int_equal(row[2], static_cast<int>(m.activity));
            assert_near(row[10].get<double>(), m.segment.bow, 1e-6);
            const Json &to = row.size() > 12 ? row[12] : row[11];
            for (size_t c = 0; c < 4; ++c) assert_near(to[c].get<double>(), m.segment.to[c], 1e-6);
        }
    }
}

void test_a_long_replay_is_small(void **) {
    const Example e = make_example(2, "ur5e", 3);
    Example longer = e;
    // The same again and again, for ten minutes.
    for (int again = 1; longer.schedule.makespan < 600; ++again) {
        const double shift = again * e.schedule.makespan;
        for (int arm = 0; arm < 2; ++arm) {
            for (Motion m : e.schedule.lanes[arm]) {
                m.start += shift;
                longer.schedule.lanes[arm].push_back(m);
            }
        }
        longer.schedule.makespan += e.schedule.makespan;
    }
    assert_true(replay_html(longer.input()).size() < 1000000);
}

void test_what_lay_in_the_bin_before_is_there(void **) {
    const Example e = make_example(1);
    const std::vector<Placement> bin = {{{7, 2, 1, 0}, 4, 5, 1}};
    TraceInput input = e.input();
    input.bin = &bin;
    const Json data = data_of(replay_html(input));
    const Point centre = cell_centre(e.cell, {4, 5, 1, 2});
    assert_int_equal(data["before"][0][0], 7);
    assert_near(data["before"][0][1].get<double>(), centre.x, 1e-4);
    assert_near(data["before"][0][2].get<double>(), centre.y, 1e-4);
    assert_near(data["before"][0][3].get<double>(), kPi / 2, 1e-4);
}

// Where straight lines between the keys of an item are at t.
double along(const Json &keys, double t, size_t field) {
    size_t at = 0;
    while (at + 8 <= keys.size() && keys[at + 4].get<double>() <= t) at += 4;
    const double a = keys[at + field];
    if (at + 4 >= keys.size()) return a;
    const double t0 = keys[at];
    const double t1 = keys[at + 4];
    return a + (keys[at + 4 + field].get<double>() - a) * (t - t0) / (t1 - t0);
}

void test_simulated_poses_are_thinned_but_kept(void **) {
    const Example e = make_example(1);
    SimulationReport report;
    // A way with a rest in it and a turn past pi.
    std::vector<double> times;
    for (int i = 0; i <= 200; ++i) {
        if (i > 60 && i < 120) continue;
        const double t = 0.04 * i;
        const double moved = i <= 60 ? t : t - 2.4;
        times.push_back(t);
        report.frames.push_back({t, 40, static_cast<float>(0.3 * std::sin(moved)),
                                 static_cast<float>(0.1 * moved * moved),
                                 static_cast<float>(std::remainder(3 + 0.2 * moved, 2 * kPi))});
    }
    TraceInput input = e.input();
    input.simulation = &report;
    const Json keys = data_of(replay_html(input))["simulation"]["frames"]["40"];
    assert_true(keys.size() < 4 * times.size() * 3 / 4);
    for (size_t i = 0; i < times.size(); ++i) {
        const ItemFrame &f = report.frames[i];
        assert_near(along(keys, times[i], 1), f.x, 0.0005);
        assert_near(along(keys, times[i], 2), f.y, 0.0005);
        assert_near(std::remainder(along(keys, times[i], 3) - f.yaw, 2 * kPi), 0, 0.01);
    }
    // At rest it stays where it was.
    const ItemFrame &rested = report.frames[60];
    assert_near(along(keys, 4, 1), rested.x, 0.0005);
}

// ---- Whatever comes ----------------------------------------------------------------------------

void test_names_do_no_harm(void **) {
    Example e = make_example(2);
    const std::string before = replay_html(e.input());
    const char name[32] = "</script><b a='&\"\x01\xff\xc3\xa9]]>";
    std::copy(name, name + sizeof name, e.cell.name);
    std::fill(e.cell.arms[0].model.name, e.cell.arms[0].model.name + 32, '<');  // no end
    const std::string svg = gantt_svg(e.input());
    assert_string_equal(xml_fault(svg).c_str(), "");
    assert_true(count(svg, "\xc3\xa9") > 0);
    const std::string page = replay_html(e.input());
    assert_int_equal(count(page, "</script>"), count(before, "</script>"));
    assert_int_equal(count(page, "<b "), count(before, "<b "));
    assert_int_equal(data_of(page)["title"].get<std::string>().rfind("</script><b a='&\"\x01", 0),
                     0);
    const Json trace = Json::parse(chrome_trace(e.input()));
    assert_true(trace["otherData"]["title"].is_string());
}

void test_an_empty_schedule_is_drawn(void **) {
    for (int robots = 1; robots <= 2; ++robots) {
        const Example e = make_empty(robots);
        const Lanes lanes = lanes_of(Json::parse(chrome_trace(e.input())));
        assert_int_equal(lanes.size(), static_cast<size_t>(3 + robots));
        const Table table = read_csv(timeline_csv(e.input(), 0.1));
        assert_int_equal(table.size(), 2);
        assert_near(value(table[1][column(table, "arm0_x_m")]), e.cell.arms[0].home.x, 1e-6);
        assert_int_equal(read_csv(joints_csv(e.input(), 0, 0.1)).size(), 2);
        assert_string_equal(xml_fault(gantt_svg(e.input())).c_str(), "");
        assert_near(data_of(replay_html(e.input()))["makespan"].get<double>(), 0, 0);
    }
}

void test_what_is_not_finite_is_refused(void **) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const auto refused = [](const Example &e) {
        assert_int_equal(static_cast<int>(status_of(e.input())), static_cast<int>(Status::kState));
    };
    Example e = make_example(2);
    e.schedule.makespan = nan;
    refused(e);
    e = make_example(2);
    e.schedule.lanes[1][2].start = HUGE_VAL;
    refused(e);
    e = make_example(2);
    e.schedule.lanes[0][3].segment.to[kPan] = nan;
    refused(e);
    e = make_example(2);
    e.schedule.lanes[0][3].activity = static_cast<Activity>(99);
    refused(e);
    e = make_example(2);
    std::swap(e.schedule.lanes[0][3], e.schedule.lanes[0][5]);
    refused(e);
    e = make_example(2);
    e.schedule.handovers[0].arm = 2;
    refused(e);
    e = make_example(2);
    e.schedule.planning[0].duration = nan;
    refused(e);
}

void test_an_input_without_its_parts_is_refused(void **) {
    const Example e = make_example(2);
    TraceInput input = e.input();
    input.schedule = nullptr;
    assert_int_equal(static_cast<int>(status_of(input)), static_cast<int>(Status::kArgument));
    Example one_arm = make_example(2);
    one_arm.cell.arms.pop_back();
    assert_int_equal(static_cast<int>(status_of(one_arm.input())),
                     static_cast<int>(Status::kArgument));
}

}  // namespace
}  // namespace packcell

int main() {
    using namespace packcell;
    const CMUnitTest tests[] = {
        cmocka_unit_test(test_the_lanes_of_a_chrome_trace_do_not_overlap),
        cmocka_unit_test(test_the_arms_lanes_sum_to_the_makespan),
        cmocka_unit_test(test_events_say_step_item_and_why_an_arm_waits),
        cmocka_unit_test(test_the_bin_is_occupied_from_lower_to_lift),
        cmocka_unit_test(test_both_arms_in_the_bin_are_one_event),
        cmocka_unit_test(test_the_clearance_is_a_counter_where_there_are_two_arms),
        cmocka_unit_test(test_a_timeline_has_a_row_for_each_period),
        cmocka_unit_test(test_a_timeline_says_where_the_arms_are),
        cmocka_unit_test(test_a_timeline_says_what_the_gripper_holds),
        cmocka_unit_test(test_one_arm_has_no_clearance),
        cmocka_unit_test(test_set_points_are_each_others_derivatives),
        cmocka_unit_test(test_a_period_out_of_range_is_refused),
        cmocka_unit_test(test_the_locale_does_not_change_numbers),
        cmocka_unit_test(test_a_gantt_chart_is_well_formed_and_names_each_item),
        cmocka_unit_test(test_bars_are_to_scale),
        cmocka_unit_test(test_a_replay_page_needs_no_network),
        cmocka_unit_test(test_a_replay_page_holds_the_schedule),
        cmocka_unit_test(test_a_long_replay_is_small),
        cmocka_unit_test(test_what_lay_in_the_bin_before_is_there),
        cmocka_unit_test(test_simulated_poses_are_thinned_but_kept),
        cmocka_unit_test(test_names_do_no_harm),
        cmocka_unit_test(test_an_empty_schedule_is_drawn),
        cmocka_unit_test(test_what_is_not_finite_is_refused),
        cmocka_unit_test(test_an_input_without_its_parts_is_refused),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
