// Cells: what is wrong with one is said in one line by the name that the field has in cell.json,
// and the presets are good for all of the paper's scenarios.
#include "motion/cell_layout.h"

#include <functional>
#include <vector>

#include "motion.h"
#include "motion/footprint.h"
#include "motion/segment.h"

namespace packcell {
namespace {

const char *const kScenarios[] = {"S-R1A1", "S-R5A1", "S-R5A3", "D-R2A2O2", "D-R5A2O2", "D-R5A3O1"};

// The error of a preset with a change, which must be one line.
std::string said(const char *preset, const std::function<void(CellLayout &)> &change) {
    CellLayout cell = cell_preset(preset);
    change(cell);
    const std::string text = failure(Status::kArgument, [&cell] { check_cell(cell); });
    assert_true(text.find('\n') == std::string::npos);
    assert_true(text.size() + 1 < Error::kTextSize);
    return text;
}

void expect_start(const std::string &text, const std::string &start) {
    if (text.compare(0, start.size(), start) == 0) return;
    print_error("'%s' does not start with '%s'\n", text.c_str(), start.c_str());
    assert_true(false);
}

// In the preset "paper" the arms share one zone at most.
bool laid_out_for(const CellLayout &cell, const Scenario &scenario) {
    return scenario.overlap < 2 || std::string(cell.name) != "paper";
}

void the_presets_serve_all_scenarios(void **) {
    int count = 0;
    for (; cell_preset_name(count) != nullptr; ++count) {
        const CellLayout cell = cell_preset(cell_preset_name(count));
        assert_string_equal(cell.name, cell_preset_name(count));
        assert_int_equal(cell.arms.size(), 2);
        check_cell(cell);
        for (const char *name : kScenarios) {
            const Scenario scenario = parse_scenario(name);
            if (!laid_out_for(cell, scenario)) continue;
            check_cell(cell, scenario);
            check_cell(cell, {scenario.robots, scenario.recognized, scenario.accessible,
                              scenario.robots == 2 ? scenario.overlap : 0});
        }
    }
    assert_int_equal(count, 4);
    assert_string_equal(failure(Status::kArgument, [] { cell_preset("ur6"); }).c_str(),
                        "cell preset 'ur6': must be ur5e, paper, piper or scara");
}

// The coordinates of a stop at travel height.
Coordinates stop(const CellLayout &cell, size_t arm, Point p, const Coordinates &near) {
    const ArmPlace &place = cell.arms[arm];
    const double height = cell.work_height + cell.dwells.stroke;
    Coordinates c{};
    assert_true(solve(place.model, place.base, {p.x, p.y, height, 0}, near, true, c));
    return c;
}

std::vector<Point> zones_of(const CellLayout &cell, size_t arm) {
    std::vector<Point> zones;
    for (const char *name : kScenarios) {
        const Scenario scenario = parse_scenario(name);
        if (arm >= static_cast<size_t>(scenario.robots)) continue;
        if (!laid_out_for(cell, scenario)) continue;
        const int first = arm == 0 ? 0 : scenario.accessible - scenario.overlap;
        for (int zone = first; zone < first + scenario.accessible; ++zone)
            zones.push_back(zone_centre(cell, scenario, zone));
    }
    return zones;
}

void an_arm_at_its_home_leaves_the_other_one_room(void **) {
    for (int i = 0; cell_preset_name(i) != nullptr; ++i) {
        const CellLayout cell = cell_preset(cell_preset_name(i));
        const Size bin = grid_bin(cell.bin.grid);
        Footprint loaded[2];
        for (size_t arm = 0; arm < 2; ++arm) {
            const ArmPlace &still = cell.arms[1 - arm];
            const ArmPlace &moves = cell.arms[arm];
            const Footprint home =
                footprint(still.model, still.base, stop(cell, 1 - arm, still.home, {}), 0);
            const Coordinates ready = stop(cell, arm, moves.home, {});
            loaded[arm] = footprint(moves.model, moves.base, ready, 0.25);
            for (const int side : {7, 5, 1}) {
                const double held = half_diagonal(cell, {0, side, side, 0});
                // The elbows of SCARA arms swing out with large items from zone to zone.
                const bool on_the_way = moves.model.kind == ArmKind::kPolar || side < 7;
                const auto expect_room = [&](const Coordinates &c) {
                    const double room =
                        clearance(home, footprint(moves.model, moves.base, c, held));
                    expect(room >= cell.margin, static_cast<uint64_t>(i), "metres apart", room,
                           cell.margin);
                };
                std::vector<Point> stops = zones_of(cell, arm);
                stops.insert(stops.end(), moves.buffer.begin(), moves.buffer.end());
                for (const Point &from : stops) {
                    const Coordinates start = stop(cell, arm, from, ready);
                    expect_room(start);
                    for (int y = 0; y + side <= bin.h; ++y) {
                        for (int x = 0; x + side <= bin.w; ++x) {
                            const bool edge =
                                x == 0 || y == 0 || x + side == bin.w || y + side == bin.h;
                            if (!edge) continue;
                            const Coordinates goal =
                                stop(cell, arm, cell_centre(cell, {x, y, side, side}), start);
                            Segment line = rest(start, 1);
                            line.to = goal;
                            for (int k = on_the_way ? 1 : 8; k <= 8; ++k)
                                expect_room(coordinates_at(line, k / 8.0));
                        }
                    }
                }
            }
        }
        assert_true(clearance(loaded[0], loaded[1]) >= cell.margin);
    }
}

void buffer_slots_hold_items_of_seven_cells(void **) {
    for (int i = 0; cell_preset_name(i) != nullptr; ++i) {
        const CellLayout cell = cell_preset(cell_preset_name(i));
        const double side = item_side(cell, 7);
        std::vector<Point> slots;
        for (const ArmPlace &arm : cell.arms) {
            assert_true(arm.buffer.size() >= 3);
            slots.insert(slots.end(), arm.buffer.begin(), arm.buffer.end());
        }
        for (size_t a = 0; a < slots.size(); ++a) {
            for (size_t b = 0; b < a; ++b) {
                const double apart = std::max(std::fabs(slots[a].x - slots[b].x),
                                              std::fabs(slots[a].y - slots[b].y));
                assert_true(apart >= side + 0.02 - 1e-9);
            }
            // Clear of bin and belt, as the item lies.
            const double bottom = cell.bin.centre.y - 0.0005 * cell.bin.grid.bin_h - cell.bin.wall;
            const double left = cell.bin.centre.x - 0.0005 * cell.bin.grid.bin_w - cell.bin.wall;
            assert_true(slots[a].y + 0.5 * side < bottom ||
                        std::fabs(slots[a].x) - 0.5 * side > -left);
            assert_true(slots[a].y + 0.5 * side < cell.belt.centre.y - 0.5 * cell.belt.pitch);
            for (const ArmPlace &arm : cell.arms) {
                assert_true(distance(slots[a], {arm.base.x, arm.base.y}) >
                            half_diagonal(cell, {0, 7, 7, 0}) + arm.model.body_radius);
            }
        }
        // The belt's zones hold them, too.
        assert_true(side < cell.belt.pitch);
    }
}

void a_cycle_of_the_preset_paper_takes_as_long_as_in_the_paper(void **) {
    const CellLayout cell = cell_preset("paper");
    assert_near(reference_cycle(cell), 15.5, 0.01);
    assert_true(cell.dwells.scale > 1);
    assert_true(reference_cycle(cell_preset("ur5e")) < 8);
    assert_near(cell.planning.motion[1][1], 1.6, 0);
    assert_near(cell.planning.task[0][0], 0.71, 0);
}

void numbers_that_are_not_are_named(void **) {
    struct Case {
        const char *name;
        double *(*field)(CellLayout &);
    };
    const Case cases[] = {
        {"belt.centre[0]", [](CellLayout &c) { return &c.belt.centre.x; }},
        {"belt.centre[1]", [](CellLayout &c) { return &c.belt.centre.y; }},
        {"belt.direction_deg", [](CellLayout &c) { return &c.belt.direction; }},
        {"belt.pitch", [](CellLayout &c) { return &c.belt.pitch; }},
        {"belt.speed", [](CellLayout &c) { return &c.belt.speed; }},
        {"belt.acceleration", [](CellLayout &c) { return &c.belt.acceleration; }},
        {"bin.centre[0]", [](CellLayout &c) { return &c.bin.centre.x; }},
        {"bin.centre[1]", [](CellLayout &c) { return &c.bin.centre.y; }},
        {"bin.w_mm", [](CellLayout &c) { return &c.bin.grid.bin_w; }},
        {"bin.h_mm", [](CellLayout &c) { return &c.bin.grid.bin_h; }},
        {"bin.margin_mm", [](CellLayout &c) { return &c.bin.grid.margin; }},
        {"bin.cell_mm", [](CellLayout &c) { return &c.bin.grid.cell; }},
        {"bin.clearance_mm", [](CellLayout &c) { return &c.bin.grid.clearance; }},
        {"bin.wall", [](CellLayout &c) { return &c.bin.wall; }},
        {"bin.gap", [](CellLayout &c) { return &c.bin.gap; }},
        {"bin.chamfer", [](CellLayout &c) { return &c.bin.chamfer; }},
        {"dwells.stroke", [](CellLayout &c) { return &c.dwells.stroke; }},
        {"dwells.stroke_speed", [](CellLayout &c) { return &c.dwells.stroke_speed; }},
        {"dwells.stroke_acceleration", [](CellLayout &c) { return &c.dwells.stroke_acceleration; }},
        {"dwells.grip", [](CellLayout &c) { return &c.dwells.grip; }},
        {"dwells.release", [](CellLayout &c) { return &c.dwells.release; }},
        {"dwells.scale", [](CellLayout &c) { return &c.dwells.scale; }},
        {"planning.task[0][1]", [](CellLayout &c) { return &c.planning.task[0][1]; }},
        {"planning.task[1][0]", [](CellLayout &c) { return &c.planning.task[1][0]; }},
        {"planning.motion[0][0]", [](CellLayout &c) { return &c.planning.motion[0][0]; }},
        {"planning.motion[1][1]", [](CellLayout &c) { return &c.planning.motion[1][1]; }},
        {"jerk", [](CellLayout &c) { return &c.jerk; }},
        {"work_height", [](CellLayout &c) { return &c.work_height; }},
        {"tool_speed", [](CellLayout &c) { return &c.tool_speed; }},
        {"margin", [](CellLayout &c) { return &c.margin; }},
        {"tick", [](CellLayout &c) { return &c.tick; }},
        {"arms[0].base.x", [](CellLayout &c) { return &c.arms[0].base.x; }},
        {"arms[0].base.y", [](CellLayout &c) { return &c.arms[0].base.y; }},
        {"arms[1].base.z", [](CellLayout &c) { return &c.arms[1].base.z; }},
        {"arms[1].base.yaw_deg", [](CellLayout &c) { return &c.arms[1].base.yaw; }},
        {"arms[0].home[0]", [](CellLayout &c) { return &c.arms[0].home.x; }},
        {"arms[1].home[1]", [](CellLayout &c) { return &c.arms[1].home.y; }},
        {"arms[1].buffer[2][0]", [](CellLayout &c) { return &c.arms[1].buffer[2].x; }},
        {"arms[0].buffer[1][1]", [](CellLayout &c) { return &c.arms[0].buffer[1].y; }},
        {"arms[1].model.upper", [](CellLayout &c) { return &c.arms[1].model.upper; }},
        {"arms[0].model.tool_radius", [](CellLayout &c) { return &c.arms[0].model.tool_radius; }},
        {"arms[0].model.joints[5].least_deg",
         [](CellLayout &c) { return &c.arms[0].model.limits[5].least; }},
        {"arms[0].model.joints[2].dh.d", [](CellLayout &c) { return &c.arms[0].model.dh[2].d; }},
        {"arms[0].model.joints[1].sign",
         [](CellLayout &c) { return &c.arms[0].model.map[1].sign; }},
    };
    for (const Case &c : cases) {
        for (const double value : {static_cast<double>(NAN), HUGE_VAL, -HUGE_VAL, 1e300, -1e300}) {
            const std::string text =
                said("ur5e", [&c, value](CellLayout &cell) { *c.field(cell) = value; });
            expect_start(text, std::string(c.name) + " ");
            assert_true(text.find(": must be ") != std::string::npos);
        }
    }
}

void what_cannot_be_is_named(void **) {
    struct Case {
        const char *start;
        void (*change)(CellLayout &);
    };
    const Case cases[] = {
        {"belt.speed -0.1: must be 0.01..5", [](CellLayout &c) { c.belt.speed = -0.1; }},
        {"belt.speed 0: must be 0.01..5", [](CellLayout &c) { c.belt.speed = 0; }},
        {"belt.pitch 0: must be ", [](CellLayout &c) { c.belt.pitch = 0; }},
        {"bin.w_mm 40: is 0 cells, must be 1..128", [](CellLayout &c) { c.bin.grid.bin_w = 40; }},
        {"bin.h_mm 9000: is 200 cells, must be 1..128",
         [](CellLayout &c) { c.bin.grid.bin_h = 9000; }},
        {"bin.gap 0.023: must be 0..0.0225", [](CellLayout &c) { c.bin.gap = 0.023; }},
        {"dwells.scale 0: must be 0.01..100", [](CellLayout &c) { c.dwells.scale = 0; }},
        {"dwells.grip -1: must be 0..60", [](CellLayout &c) { c.dwells.grip = -1; }},
        {"arms: 0: must be 1 or 2", [](CellLayout &c) { c.arms.clear(); }},
        {"arms: 3: must be 1 or 2", [](CellLayout &c) { c.arms.push_back(c.arms[0]); }},
        {"law 3: must be 1 or 2", [](CellLayout &c) { c.law = static_cast<LawKind>(3); }},
        {"arms[1].base: 0.120 m from arms[0].base: must be at least 0.2",
         [](CellLayout &c) {
             c.arms[1].base.x = c.arms[0].base.x - 0.12;
             c.arms[1].base.y = c.arms[0].base.y;
         }},
        {"arms[0].base: 0.000 m from the bin: must be at least 0.075",
         [](CellLayout &c) { c.arms[0].base.x = 0; }},
        {"arms[0].base: 0.000 m from the belt: must be at least 0.075",
         [](CellLayout &c) { c.arms[0].base.y = 0.4; }},
        {"belt.centre: 0.000 m from the bin", [](CellLayout &c) { c.belt.centre.y = 0.3; }},
        {"belt.centre: 0.000 m from the bin", [](CellLayout &c) { c.belt.direction = 0.5 * kPi; }},
        {"arms[0].buffer[1]: 0.000 m from the bin",
         [](CellLayout &c) {
             c.arms[0].buffer[1] = {0.1, 0.1};
         }},
        {"arms[0].buffer[1]: 0.000 m from the belt",
         [](CellLayout &c) {
             c.arms[0].buffer[1] = {0.1, 0.5};
         }},
        {"arms[1].buffer[2]: 0.000 m from arms[0].buffer[0]: must be at least 0.044",
         [](CellLayout &c) { c.arms[1].buffer[2] = c.arms[0].buffer[0]; }},
        {"arms[0].buffer[2]: 0.000 m from arms[0].buffer[0]",
         [](CellLayout &c) { c.arms[0].buffer[2] = c.arms[0].buffer[0]; }},
        {"arms[0].buffer[2]: 0.000 m from arms[1].base",
         [](CellLayout &c) {
             c.arms[0].buffer[2] = {c.arms[1].base.x, c.arms[1].base.y};
         }},
        {"arms[1].buffer: 65 slots: must be at most 64",
         [](CellLayout &c) { c.arms[1].buffer.resize(65); }},
        {"arms[0]: does not reach bin cell (9, 9): 0.803 m away, must be 0.25..0.8",
         [](CellLayout &c) { c.arms[0].base.x = -0.545; }},
        {"arms[1]: does not reach its home: ",
         [](CellLayout &c) {
             c.arms[1].home = {2, 2};
         }},
        {"arms[0]: does not reach buffer[1]: 1.",
         [](CellLayout &c) {
             c.arms[0].buffer[1] = {-1, -1};
         }},
        {"arms[0]: does not reach bin cell (0, 0): joint 1 beyond its limits at height 0",
         [](CellLayout &c) {
             c.arms[0].model.limits[0] = {0, 1, 1, 1};
         }},
        {"arms[0]: does not reach bin cell ", [](CellLayout &c) { c.arms[0].base.z = 0.8; }},
        {"arms[1].home: -0.150 m from arms[0] at its home: must be at least 0.050",
         [](CellLayout &c) {
             c.arms[0].home = {-0.1, 0.25};
             c.arms[1].home = {0.1, 0.25};
             c.arms[0].home.x += 0.2;
         }},
    };
    for (const Case &c : cases) expect_start(said("ur5e", c.change), c.start);

    expect_start(said("piper", [](CellLayout &c) { c.arms[1].base.z = 0; }),
                 "arms[1]: does not reach bin cell (0, 0): joint 5 beyond its limits at height 0");
    // Down to the work it gets, up with its load it does not.
    expect_start(
        said("scara", [](CellLayout &c) { c.dwells.stroke = 0.4; }),
        "arms[0]: does not reach bin cell (0, 0): joint 3 beyond its limits at height 0.4");
    // Items that lie along the bin it takes, those across it does not.
    expect_start(said("piper",
                      [](CellLayout &c) {
                          c.arms.resize(1);
                          c.arms[0].buffer.clear();
                          c.arms[0].home = {-0.1, 0.1};
                          check_cell(c);
                          c.arms[0].model.limits[5] = {-1, 1, 3, 5};
                      }),
                 "arms[0]: does not reach bin cell (0, 0): joint 6 beyond its limits");
    expect_start(said("ur5e", [](CellLayout &c) { std::fill_n(c.name, sizeof c.name, 'x'); }),
                 "name: must be at most 31 characters");
}

void a_scenario_needs_its_arms_and_zones(void **) {
    const auto told = [](const CellLayout &cell, const char *scenario) {
        return failure(Status::kArgument, [&] { check_cell(cell, parse_scenario(scenario)); });
    };
    CellLayout cell = cell_preset("ur5e");
    expect_start(told(cell, "S-R5A5"), "arms[0]: does not reach belt zone 0: 0.9");
    expect_start(told(cell, "D-R9A5O1"), "arms[0]: does not reach belt zone 0: ");
    cell.belt.centre.x = -0.3;
    expect_start(told(cell, "D-R5A3O1"), "arms[1]: does not reach belt zone 2: 0.910 m away");
    cell.belt.centre.x = 0;
    cell.arms.pop_back();
    check_cell(cell, parse_scenario("S-R5A3"));
    expect_start(told(cell, "D-R5A3O1"), "arms: 1: must be 2 for the scenario");
}

void zones_lie_upstream_from_the_shared_ones(void **) {
    CellLayout cell = cell_preset("ur5e");
    const auto x = [&cell](const char *scenario, int zone) {
        return zone_centre(cell, parse_scenario(scenario), zone).x;
    };
    for (int zone = 0; zone < 5; ++zone) {
        assert_near(x("D-R5A3O1", zone), 0.35 * (zone - 2), 1e-12);
        assert_near(x("S-R5A3", zone), 0.35 * (zone - 2), 1e-12);
        assert_near(x("S-R5A1", zone), 0.35 * zone, 1e-12);
        assert_near(x("D-R5A2O2", zone), 0.35 * (zone - 0.5), 1e-12);
        assert_near(x("D-R5A2O0", zone), 0.35 * (zone - 1), 1e-12);
        assert_near(zone_centre(cell, parse_scenario("D-R5A3O1"), zone).y, cell.belt.centre.y,
                    1e-12);
    }
    cell.belt.direction = 0.5 * kPi;
    assert_near(zone_centre(cell, parse_scenario("D-R5A3O1"), 3).y, cell.belt.centre.y + 0.35,
                1e-12);
}

// An item's zone by the regions, when there are fewer items than zones, too; and what stays on the
// belt never goes back.
void items_lie_in_the_zones_of_their_regions(void **) {
    const Scenario d = parse_scenario("D-R5A3O1");
    for (int place = 0; place < 7; ++place)
        assert_int_equal(belt_zone(d, arrange(d, 7, 0), place), place);
    const Regions few = {1, 1, 1};
    assert_int_equal(belt_zone(d, few, 0), 0);
    assert_int_equal(belt_zone(d, few, 1), 2);
    assert_int_equal(belt_zone(d, few, 2), 3);
    const Scenario both = parse_scenario("D-R5A2O2");
    for (int place = 0; place < 5; ++place)
        assert_int_equal(belt_zone(both, arrange(both, 5, 0), place), place);

    for (int accessible = 1; accessible <= 5; ++accessible) {
        for (int overlap = 0; overlap <= accessible; ++overlap) {
            const Scenario scenario = {2, 10, accessible, overlap};
            for (int total = 0; total <= 10; ++total) {
                for (int left = 0; left <= std::min(total, accessible - overlap); ++left) {
                    const Regions regions = arrange(scenario, total, left);
                    int before = -1;
                    for (int place = 0; place < total; ++place) {
                        const int zone = belt_zone(scenario, regions, place);
                        assert_true(zone > before);
                        before = zone;
                        // Arms reach the item where they reach its zone.
                        const int first = accessible - overlap;
                        const int arms = (zone < accessible ? 1 : 0) |
                                         (zone >= first && zone < first + accessible ? 2 : 0);
                        assert_int_equal(reach(scenario, regions, place), arms);
                    }
                }
            }
        }
    }
}

void places_and_times_follow_from_the_cell(void **) {
    const CellLayout cell = cell_preset("ur5e");
    Point p = cell_centre(cell, {0, 0, 1, 1});
    assert_near(p.x, -0.2025, 1e-12);
    assert_near(p.y, 0.2025, 1e-12);  // rows count downwards
    p = cell_centre(cell, {2, 9, 8, 1});
    assert_near(p.x, 0.045, 1e-12);
    assert_near(p.y, -0.2025, 1e-12);
    assert_near(belt_time(cell, 2), 1.7, 1e-12);
    assert_true(belt_time(cell, 0) == 0);
    assert_near(item_side(cell, 3), 0.135 - cell.bin.gap, 1e-12);
    assert_near(half_diagonal(cell, {0, 3, 4, 0}), 0.5 * std::hypot(0.134, 0.179), 1e-12);
    assert_near(stroke_time(cell), 0.1 / 0.25 + 0.25 / 1.2, 1e-12);
    const CellLayout paper = cell_preset("paper");
    assert_near(stroke_time(paper), paper.dwells.scale * stroke_time(cell), 1e-12);
    assert_near(grip_time(paper), paper.dwells.scale * 0.5, 1e-12);
    assert_near(release_time(paper), paper.dwells.scale * 0.3, 1e-12);

    // With margins: the paper's physical bin of 10 x 8 cells.
    const CellLayout piper = cell_preset("piper");
    p = cell_centre(piper, {0, 0, 10, 8});
    assert_near(p.x, 0, 1e-12);
    assert_near(p.y, 0, 1e-12);
    p = cell_centre(piper, {9, 7, 1, 1});
    assert_near(p.x, 0.135, 1e-12);
    assert_near(p.y, -0.105, 1e-12);
}

}  // namespace
}  // namespace packcell

int main() {
    using namespace packcell;
    const CMUnitTest tests[] = {
        cmocka_unit_test(the_presets_serve_all_scenarios),
        cmocka_unit_test(an_arm_at_its_home_leaves_the_other_one_room),
        cmocka_unit_test(buffer_slots_hold_items_of_seven_cells),
        cmocka_unit_test(a_cycle_of_the_preset_paper_takes_as_long_as_in_the_paper),
        cmocka_unit_test(numbers_that_are_not_are_named),
        cmocka_unit_test(what_cannot_be_is_named),
        cmocka_unit_test(a_scenario_needs_its_arms_and_zones),
        cmocka_unit_test(zones_lie_upstream_from_the_shared_ones),
        cmocka_unit_test(items_lie_in_the_zones_of_their_regions),
        cmocka_unit_test(places_and_times_follow_from_the_cell),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
