// The layout search: what it gives is a valid cell in which transfers are faster, by so much.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmath>
#include <string>

#include "base/status.h"
#include "motion/layout.h"

extern "C" {
#include <cmocka.h>
}

namespace packcell {
namespace {

bool near(double a, double b) { return std::fabs(a - b) < 1e-9; }

bool same_place(const ArmPlace &a, const ArmPlace &b) {
    bool same = a.base.x == b.base.x && a.base.y == b.base.y && a.home.x == b.home.x &&
                a.home.y == b.home.y && a.buffer.size() == b.buffer.size();
    for (size_t i = 0; same && i < a.buffer.size(); ++i)
        same = a.buffer[i].x == b.buffer[i].x && a.buffer[i].y == b.buffer[i].y;
    return same;
}

// Only what may move has moved, each group as one and no farther than allowed.
void assert_moved_as_promised(const CellLayout &from, const CellLayout &to, int robots,
                              double range) {
    assert_int_equal(from.arms.size(), to.arms.size());
    for (size_t a = 0; a < from.arms.size(); ++a) {
        const ArmPlace &before = from.arms[a];
        const ArmPlace &after = to.arms[a];
        if (a >= static_cast<size_t>(robots)) {
            assert_true(same_place(before, after));
            continue;
        }
        const Point base = {after.base.x - before.base.x, after.base.y - before.base.y};
        assert_true(std::fabs(base.x) <= range + 1e-9 && std::fabs(base.y) <= range + 1e-9);
        assert_true(after.base.z == before.base.z && after.base.yaw == before.base.yaw);
        const Point home = after.home - before.home;
        assert_true(near(home.x, base.x) && near(home.y, base.y));
        assert_int_equal(before.buffer.size(), after.buffer.size());
        for (size_t i = 0; i < before.buffer.size(); ++i) {
            const Point slot = after.buffer[i] - before.buffer[i];
            const Point first = after.buffer[0] - before.buffer[0];
            assert_true(near(slot.x, first.x) && near(slot.y, first.y));
            assert_true(std::fabs(slot.x) <= range + 1e-9 && std::fabs(slot.y) <= range + 1e-9);
        }
    }
    assert_true(near(from.bin.centre.x, to.bin.centre.x));
    assert_true(near(from.belt.centre.y, to.belt.centre.y));
}

LayoutOptions options(int evaluations, double range = 0.3) {
    LayoutOptions o;
    o.evaluations = evaluations;
    o.range = range;
    return o;
}

// What check_cell says, empty where it allows the cell.
std::string verdict(const CellLayout &cell, const Scenario &scenario) {
    try {
        check_cell(cell, scenario);
    } catch (const Error &error) {
        return error.what();
    }
    return "";
}

void the_result_is_valid_and_never_slower(void **) {
    int allowed = 0;
    for (int p = 0; cell_preset_name(p) != nullptr; ++p) {
        for (const char *name : {"S-R1A1", "D-R2A2O2", "D-R5A3O1"}) {
            const CellLayout cell = cell_preset(cell_preset_name(p));
            const Scenario scenario = parse_scenario(name);
            if (!verdict(cell, scenario).empty()) continue;
            ++allowed;
            const LayoutResult result = optimize_layout(cell, scenario, options(12, 0.1));
            assert_string_equal(verdict(result.cell, scenario).c_str(), "");
            assert_in_range(result.evaluations, 1, 12);
            assert_true(result.before == mean_transfer(cell, scenario));
            assert_true(result.after == mean_transfer(result.cell, scenario));
            assert_true(result.after <= result.before);
            assert_moved_as_promised(cell, result.cell, scenario.robots, 0.1);
        }
    }
    assert_true(allowed >= 8);
}

void transfers_get_faster(void **) {
    const Scenario scenario = parse_scenario("D-R5A3O1");
    const LayoutResult ur5e = optimize_layout(cell_preset("ur5e"), scenario, options(200));
    assert_true(ur5e.after < 0.98 * ur5e.before);
    const LayoutResult scara = optimize_layout(cell_preset("scara"), scenario, options(200));
    assert_true(scara.after < 0.95 * scara.before);
}

// The arms stand too far from the belt; a small bin leaves room for that.
void a_bad_start_is_left(void **) {
    const Scenario scenario = parse_scenario("D-R5A3O1");
    CellLayout cell = cell_preset("ur5e");
    cell.bin.grid.bin_w = cell.bin.grid.bin_h = 270;
    const double good = mean_transfer(cell, scenario);
    for (ArmPlace &arm : cell.arms) {
        arm.base.y -= 0.15;
        arm.home.y -= 0.15;
    }
    const LayoutResult result = optimize_layout(cell, scenario, options(200));
    assert_true(result.before > 1.03 * good);
    assert_true(result.after < 0.95 * good);
    assert_string_equal(verdict(result.cell, scenario).c_str(), "");
    assert_moved_as_promised(cell, result.cell, 2, 0.3);
}

void it_repeats_itself(void **) {
    const Scenario scenario = parse_scenario("D-R5A3O1");
    const CellLayout cell = cell_preset("scara");
    const LayoutResult a = optimize_layout(cell, scenario, options(90));
    optimize_layout(cell, parse_scenario("S-R1A1"), options(30));
    const LayoutResult b = optimize_layout(cell, scenario, options(90));
    assert_int_equal(a.evaluations, 90);
    assert_int_equal(a.evaluations, b.evaluations);
    assert_true(a.after == b.after);
    for (size_t arm = 0; arm < 2; ++arm)
        assert_true(same_place(a.cell.arms[arm], b.cell.arms[arm]));
}

void one_evaluation_is_the_start(void **) {
    const CellLayout cell = cell_preset("scara");
    const LayoutResult result = optimize_layout(cell, parse_scenario("D-R5A3O1"), options(1));
    assert_int_equal(result.evaluations, 1);
    assert_true(result.after == result.before);
    for (size_t arm = 0; arm < 2; ++arm)
        assert_true(same_place(cell.arms[arm], result.cell.arms[arm]));
}

void an_arm_without_buffer_moves_too(void **) {
    const Scenario scenario = parse_scenario("S-R5A3");
    CellLayout cell = cell_preset("scara");
    cell.arms[0].buffer.clear();
    const LayoutResult result = optimize_layout(cell, scenario, options(60));
    assert_true(result.after < result.before);
    assert_moved_as_promised(cell, result.cell, 1, 0.3);
}

// Wherever the evaluations end, in either method.
void it_ends_at_every_number_of_evaluations(void **) {
    const Scenario scenario = parse_scenario("S-R1A1");
    CellLayout cell = cell_preset("scara");
    cell.bin.grid.bin_w = cell.bin.grid.bin_h = 135;
    double last = mean_transfer(cell, scenario);
    for (int most = 1; most < 40; ++most) {
        const LayoutResult result = optimize_layout(cell, scenario, options(most));
        assert_in_range(result.evaluations, 1, most);
        assert_true(result.after <= result.before);
        last = std::fmin(last, result.after);
    }
    assert_true(last < mean_transfer(cell, scenario));
}

// The mean depends on how things stand to each other, not on where the cell's zero is.
void a_moved_cell_takes_as_long(void **) {
    const Scenario scenario = parse_scenario("D-R5A3O1");
    CellLayout cell = cell_preset("piper");
    const double before = mean_transfer(cell, scenario);
    const Point by = {0.3, -1.7};
    cell.belt.centre = cell.belt.centre + by;
    cell.bin.centre = cell.bin.centre + by;
    for (ArmPlace &arm : cell.arms) {
        arm.base.x += by.x;
        arm.base.y += by.y;
        arm.home = arm.home + by;
        for (Point &slot : arm.buffer) slot = slot + by;
    }
    assert_true(near(before, mean_transfer(cell, scenario)));
    cell.tool_speed *= 0.5;
    assert_true(mean_transfer(cell, scenario) > before);
}

std::string refusal(const CellLayout &cell, const Scenario &scenario, const LayoutOptions &o) {
    try {
        optimize_layout(cell, scenario, o);
    } catch (const Error &error) {
        assert_true(error.status() == Status::kArgument);
        return error.what();
    }
    return "accepted";
}

void a_start_that_is_not_allowed_is_refused_as_by_check_cell(void **) {
    const Scenario scenario = parse_scenario("D-R5A3O1");
    CellLayout cell = cell_preset("ur5e");
    cell.arms[0].base.x -= 0.15;
    const std::string want = verdict(cell, scenario);
    assert_true(!want.empty());
    assert_string_equal(refusal(cell, scenario, options(10)).c_str(), want.c_str());

    cell = cell_preset("ur5e");
    cell.arms.pop_back();
    assert_string_equal(refusal(cell, scenario, options(10)).c_str(),
                        "arms: 1: must be 2 for the scenario");
}

void options_out_of_range_are_refused(void **) {
    const Scenario scenario = parse_scenario("S-R1A1");
    const CellLayout cell = cell_preset("scara");
    assert_string_equal(refusal(cell, scenario, options(0)).c_str(),
                        "evaluations 0: must be 1..100000");
    assert_string_equal(refusal(cell, scenario, options(100001)).c_str(),
                        "evaluations 100001: must be 1..100000");
    assert_string_equal(refusal(cell, scenario, options(5, 0)).c_str(),
                        "range 0: must be above 0, at most 2");
    assert_string_equal(refusal(cell, scenario, options(5, 2.5)).c_str(),
                        "range 2.5: must be above 0, at most 2");
    assert_string_equal(refusal(cell, scenario, options(5, NAN)).c_str(),
                        "range nan: must be above 0, at most 2");
}

}  // namespace
}  // namespace packcell

int main() {
    using namespace packcell;
    const CMUnitTest tests[] = {
        cmocka_unit_test(the_result_is_valid_and_never_slower),
        cmocka_unit_test(transfers_get_faster),
        cmocka_unit_test(a_bad_start_is_left),
        cmocka_unit_test(it_repeats_itself),
        cmocka_unit_test(one_evaluation_is_the_start),
        cmocka_unit_test(it_ends_at_every_number_of_evaluations),
        cmocka_unit_test(an_arm_without_buffer_moves_too),
        cmocka_unit_test(a_moved_cell_takes_as_long),
        cmocka_unit_test(a_start_that_is_not_allowed_is_refused_as_by_check_cell),
        cmocka_unit_test(options_out_of_range_are_refused),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
