// cell.json: what is written is read bit for bit, and every fault is told by field, value and what
// is allowed.
#include "cell/cell_json.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmath>
#include <cstdio>
#include <cstring>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "base/random.h"
#include "base/status.h"
#include "check.h"

extern "C" {
#include <cmocka.h>
}

namespace packcell {
namespace {

using Json = nlohmann::ordered_json;

// What reading throws, "" for nothing.
std::string error_of(const std::string &text, Status *status = nullptr) {
    try {
        read_cell(text);
    } catch (const Error &e) {
        if (status != nullptr) *status = e.status();
        return e.what();
    }
    return "";
}

void assert_refused(const std::string &text, const char *wanted) {
    Status status = Status::kOk;
    const std::string what = error_of(text, &status);
    if (what != wanted) fail_msg("'%s' instead of '%s'", what.c_str(), wanted);
    assert_int_equal(static_cast<int>(status), static_cast<int>(Status::kFormat));
}

void assert_starts(const std::string &what, const std::string &start) {
    if (what.compare(0, start.size(), start) != 0)
        fail_msg("'%s' does not begin with '%s'", what.c_str(), start.c_str());
}

// A preset whose arms are spelled out.
CellLayout spelled_out(const char *name) {
    CellLayout cell = cell_preset(name);
    for (ArmPlace &arm : cell.arms) {
        std::snprintf(arm.model.name, sizeof arm.model.name, "own %s", name);
        arm.model.body_radius += 0.001;
    }
    return cell;
}

// ---- Equality, bit for bit ----------------------------------------------------------------------

bool same(double a, double b) { return std::memcmp(&a, &b, sizeof a) == 0; }
bool same(Point a, Point b) { return same(a.x, b.x) && same(a.y, b.y); }

bool same(const ArmModel &a, const ArmModel &b) {
    bool all = std::strcmp(a.name, b.name) == 0 && a.kind == b.kind && a.joints == b.joints;
    for (size_t i = 0; i < kMaxJoints; ++i) {
        all = all && same(a.dh[i].a, b.dh[i].a) && same(a.dh[i].alpha, b.dh[i].alpha) &&
              same(a.dh[i].d, b.dh[i].d) && same(a.dh[i].offset, b.dh[i].offset) &&
              same(a.limits[i].least, b.limits[i].least) &&
              same(a.limits[i].most, b.limits[i].most) &&
              same(a.limits[i].velocity, b.limits[i].velocity) &&
              same(a.limits[i].acceleration, b.limits[i].acceleration) &&
              same(a.map[i].sign, b.map[i].sign) && same(a.map[i].zero, b.map[i].zero);
    }
    const auto rest = {&ArmModel::shoulder,    &ArmModel::upper,       &ArmModel::fore,
                       &ArmModel::wrist,       &ArmModel::lateral,     &ArmModel::drop,
                       &ArmModel::tool,        &ArmModel::least_reach, &ArmModel::most_reach,
                       &ArmModel::body_radius, &ArmModel::tool_radius};
    for (const auto member : rest) all = all && same(a.*member, b.*member);
    return all;
}

bool same(const CellLayout &a, const CellLayout &b) {
    bool all = std::strcmp(a.name, b.name) == 0 && a.arms.size() == b.arms.size();
    for (size_t i = 0; all && i < a.arms.size(); ++i) {
        const ArmPlace &p = a.arms[i];
        const ArmPlace &q = b.arms[i];
        all = same(p.model, q.model) && same(p.base.x, q.base.x) && same(p.base.y, q.base.y) &&
              same(p.base.z, q.base.z) && same(p.base.yaw, q.base.yaw) && same(p.home, q.home) &&
              p.buffer.size() == q.buffer.size();
        for (size_t j = 0; all && j < p.buffer.size(); ++j) all = same(p.buffer[j], q.buffer[j]);
    }
    const BinPlace &m = a.bin;
    const BinPlace &n = b.bin;
    return all && same(a.belt.centre, b.belt.centre) && same(a.belt.direction, b.belt.direction) &&
           same(a.belt.pitch, b.belt.pitch) && same(a.belt.speed, b.belt.speed) &&
           same(a.belt.acceleration, b.belt.acceleration) && same(m.centre, n.centre) &&
           same(m.grid.bin_w, n.grid.bin_w) && same(m.grid.bin_h, n.grid.bin_h) &&
           same(m.grid.margin, n.grid.margin) && same(m.grid.cell, n.grid.cell) &&
           same(m.grid.clearance, n.grid.clearance) && same(m.wall, n.wall) && same(m.gap, n.gap) &&
           same(m.chamfer, n.chamfer) && std::memcmp(&a.dwells, &b.dwells, sizeof a.dwells) == 0 &&
           std::memcmp(&a.planning, &b.planning, sizeof a.planning) == 0 && a.law == b.law &&
           same(a.jerk, b.jerk) && same(a.work_height, b.work_height) &&
           same(a.tool_speed, b.tool_speed) && same(a.margin, b.margin) && same(a.tick, b.tick);
}

void assert_round_trip(const CellLayout &cell) {
    const std::string text = write_cell(cell);
    const CellLayout again = read_cell(text);
    if (!same(cell, again)) fail_msg("not the same: %s", text.c_str());
    assert_string_equal(write_cell(again).c_str(), text.c_str());
}

// ---- Round trips --------------------------------------------------------------------------------

void what_is_written_is_read(void **) {
    for (int i = 0; cell_preset_name(i) != nullptr; ++i) {
        assert_round_trip(cell_preset(cell_preset_name(i)));
        assert_round_trip(spelled_out(cell_preset_name(i)));
    }
    CellLayout cell = cell_preset("ur5e");
    cell.law = LawKind::kSCurve;
    cell.arms.pop_back();
    cell.arms[0].buffer.clear();
    std::snprintf(cell.name, sizeof cell.name, "%s", "one arm, \"quoted\" \\ of 31 chars");
    assert_round_trip(cell);
}

void any_angle_and_number_is_read_as_it_was(void **) {
    Random random(1);
    for (int i = 0; i < check_count(300, 20000); ++i) {
        CellLayout cell = cell_preset("ur5e");
        // A base's yaw and a belt's direction are the angles that people turn a little.
        cell.arms[0].base.yaw = 1e-3 * (random.unit() - 0.5);
        cell.arms[1].base.yaw = kPi + 1e-3 * (random.unit() - 0.5);
        cell.belt.direction = 0.05 * (random.unit() - 0.5);
        cell.tick = 0.01 + 0.1 * random.unit();
        cell.bin.gap = 0.001 * random.unit();
        assert_round_trip(cell);
    }
    CellLayout cell = cell_preset("ur5e");
    cell.arms[0].base.yaw = -0.0;
    cell.arms[0].home.x = -0.0;
    assert_round_trip(cell);
}

void a_known_arm_is_named_and_angles_are_in_degrees(void **) {
    const Json json = Json::parse(write_cell(cell_preset("ur5e")));
    assert_true(json["arms"][0]["model"] == "ur5e");
    assert_true(json["arms"][0]["base"]["yaw_deg"] == 0);
    assert_true(json["arms"][1]["base"]["yaw_deg"] == 180);
    assert_true(json["version"] == 1);
    const Json own = Json::parse(write_cell(spelled_out("piper")));
    const Json &joint = own["arms"][0]["model"]["joints"][0];
    assert_true(joint["least_deg"] == -150);
    assert_true(joint["dh"]["alpha_deg"] == -90);
}

// ---- Faults -------------------------------------------------------------------------------------

using Pointer = Json::json_pointer;

// Every place in the document, with its path as errors name it.
void walk(const Json &value, const Pointer &at, const std::string &path,
          const std::function<void(const Pointer &, const std::string &)> &visit) {
    if (!path.empty()) visit(at, path);
    if (value.is_object()) {
        for (const auto &[key, entry] : value.items())
            walk(entry, at / key, path.empty() ? key : path + "." + key, visit);
    } else if (value.is_array()) {
        for (size_t i = 0; i < value.size(); ++i)
            walk(value[i], at / i, path + "[" + std::to_string(i) + "]", visit);
    }
}

void every_field_is_required(void **) {
    for (const char *name : {"ur5e", "piper", "scara"}) {
        const Json json = Json::parse(write_cell(spelled_out(name)));
        int fields = 0;
        walk(json, Pointer(), "", [&](const Pointer &at, const std::string &path) {
            Json less = json;
            Json &parent = less[at.parent_pointer()];
            if (!parent.is_object()) return;
            parent.erase(at.back());
            assert_refused(less.dump(), (path + ": missing").c_str());
            ++fields;
        });
        assert_true(fields > 100);
    }
}

void every_field_has_its_type(void **) {
    for (const char *name : {"ur5e", "scara"}) {
        const Json json = Json::parse(write_cell(spelled_out(name)));
        walk(json, Pointer(), "", [&](const Pointer &at, const std::string &path) {
            const Json &value = json[at];
            const Json strange[] = {
                nullptr, true, "a", 7, Json::array(), Json::object(), Json::array({1, 2, 3})};
            for (const Json &other : strange) {
                if (other.type() == value.type() || (other.is_number() && value.is_number()))
                    continue;
                // Lists of places may be empty, an arm may be a name.
                if (other == Json::array() && path.find("buffer") != std::string::npos) continue;
                Json wrong = json;
                wrong[at] = other;
                Status status = Status::kOk;
                const std::string what = error_of(wrong.dump(), &status);
                assert_starts(what, path);
                assert_int_equal(static_cast<int>(status), static_cast<int>(Status::kFormat));
                // An object without fields lacks the first; all else is named with what is allowed.
                if (what.find(": must be ") == std::string::npos &&
                    what.find(": missing") == std::string::npos)
                    fail_msg("%s", what.c_str());
            }
        });
    }
}

void faults_name_field_value_and_what_is_allowed(void **) {
    const Json json = Json::parse(write_cell(cell_preset("ur5e")));
    const auto with = [&](const char *at, const Json &value) {
        Json other = json;
        other[Pointer(at)] = value;
        return other.dump();
    };
    assert_refused(with("/arms/1/base/x", "a"), "arms[1].base.x \"a\": must be a number");
    assert_refused(with("/arms/0/base/yaw_deg", {1, 2, 3}),
                   "arms[0].base.yaw_deg [...]: must be a number or a list of 2");
    assert_refused(with("/arms/0/base/yaw_deg", {1, nullptr}),
                   "arms[0].base.yaw_deg[1] null: must be a number");
    assert_refused(with("/belt/centre", {1}), "belt.centre [...]: must be a list of 2");
    assert_refused(with("/belt", 5), "belt 5: must be an object");
    assert_refused(with("/arms", Json::array()), "arms [...]: must be a list of 1 to 2");
    assert_refused(with("/version", 2), "version 2: must be 1");
    assert_refused(with("/version", 1.5), "version 1.5: must be 1");
    assert_refused(with("/law", "jerk"), "law \"jerk\": must be \"trapezoid\" or \"s-curve\"");
    assert_refused(with("/arms/0/model", "ur6"),
                   "arms[0].model \"ur6\": must be ur5e, piper, scara, or an object");
    assert_refused(
        with("/name", std::string(32, 'x')),
        "name \"xxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxx\": must be at most 31 characters of ASCII");
    assert_refused(with("/name", "\n"), "name \"\\n\": must be at most 31 characters of ASCII");
    assert_refused(with("/belt/sped", 1), "belt: unknown field \"sped\"");
    assert_refused(with("/comment", "x"), "cell: unknown field \"comment\"");
    assert_refused(with("/planning/task/1", {1, 2, 3}),
                   "planning.task[1] [...]: must be a list of 2");
    assert_refused("[1]", "cell [...]: must be an object");
    assert_refused("3", "cell 3: must be an object");
    assert_refused("{}", "version: missing");
    // What a cell may be is judged by check_cell.
    assert_starts(error_of(with("/belt/speed", -1)), "belt.speed -1: must be ");
    assert_starts(error_of(with("/tick", 1e300)), "tick 1e+300: must be ");
    assert_starts(error_of(with("/belt/direction_deg", 1e300)), "belt.direction");
}

void text_that_is_not_json_is_told_by_its_position(void **) {
    assert_refused("", "line 1, column 1: is not JSON");
    assert_refused("{\n  \"version\": NaN\n}", "line 2, column 14: is not JSON");
    assert_refused("{\n  // none\n}", "line 2, column 3: is not JSON");
    assert_refused("{\"version\": 1e999}", "a number is too large");
    assert_refused("{\"version\": 1, \"version\": 1}", "field \"version\": given twice");
    assert_refused(std::string(size_t{1} << 20, '['), "line 1, column 1048577: is not JSON");
    assert_refused(std::string((size_t{1} << 20) + 1, ' '),
                   "cell of 1048577 bytes: must be at most 1048576");
    assert_refused(std::string(1 << 19, '[') + std::string(1 << 19, ']'),
                   "cell [...]: must be an object");
    assert_refused("{} {}", "line 1, column 4: is not JSON");
    assert_refused(std::string("{}\0", 3), "line 1, column 3: is not JSON");
}

void every_truncation_is_refused(void **) {
    for (const CellLayout &cell : {cell_preset("ur5e"), spelled_out("scara")}) {
        std::string text = write_cell(cell);
        text.pop_back();  // the last newline
        assert_string_equal(error_of(text).c_str(), "");
        while (!text.empty()) {
            text.pop_back();
            assert_false(error_of(text).empty());
        }
    }
}

// Whatever is read is a cell that can be used: it can be written and read again.
void random_bytes_never_get_through(void **) {
    Random random(2);
    const std::string texts[] = {write_cell(cell_preset("piper")), write_cell(spelled_out("ur5e"))};
    int read = 0;
    for (int i = 0; i < check_count(4000, 200000); ++i) {
        std::string text = texts[i % 2];
        for (uint64_t flips = 1 + random.below(3); flips > 0; --flips) {
            const size_t at = random.below(text.size());
            text[at] = random.below(2) == 0 ? static_cast<char>(random.below(256))
                                            : "0123456789.-+eE,:[]{}\" \n"[random.below(25)];
        }
        try {
            assert_round_trip(read_cell(text));
            ++read;
        } catch (const Error &e) {
            assert_true(std::strlen(e.what()) > 0);
            assert_null(std::strchr(e.what(), '\n'));
        }
    }
    assert_true(read > 0);
}

}  // namespace
}  // namespace packcell

int main() {
    using namespace packcell;
    const CMUnitTest tests[] = {
        cmocka_unit_test(what_is_written_is_read),
        cmocka_unit_test(any_angle_and_number_is_read_as_it_was),
        cmocka_unit_test(a_known_arm_is_named_and_angles_are_in_degrees),
        cmocka_unit_test(every_field_is_required),
        cmocka_unit_test(every_field_has_its_type),
        cmocka_unit_test(faults_name_field_value_and_what_is_allowed),
        cmocka_unit_test(text_that_is_not_json_is_told_by_its_position),
        cmocka_unit_test(every_truncation_is_refused),
        cmocka_unit_test(random_bytes_never_get_through),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
