// Schedules: what holds for every schedule of every mode, by what it says alone; what happens to an
// item that did not fit; and that arms which cannot pass each other are named.
#include "motion/scheduler.h"

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "episodes.h"
#include "motion.h"
#include "motion/breakdown.h"

namespace packcell {
namespace {

constexpr double kPeriod = 0.005;  // seconds between two samples
constexpr double kSlack = 1e-6;    // seconds
constexpr CoordinationMode kModes[] = {CoordinationMode::kSyncPaper, CoordinationMode::kZoneMutex,
                                       CoordinationMode::kCoordinated};

// ---- What a schedule says, action by action ----------------------------------------------------

struct Done {
    AtomicKind kind;
    int32_t step;
    int32_t item;
    double begins;  // to travel
    double lowers;  // comes down; of `ready`: begins
    double ends;
};

// An arm's actions: the travel to it, if any, down, grip or release, up.
std::vector<Done> actions_of(const std::vector<Motion> &lane) {
    std::vector<Done> actions;
    bool open = false;
    for (const Motion &m : lane) {
        if (m.activity == Activity::kWait) continue;
        if (!open) actions.push_back({m.atomic, m.step, m.item, m.start, m.start, m.end()});
        if (m.activity == Activity::kLower) actions.back().lowers = m.start;
        actions.back().ends = m.end();
        open = m.activity != Activity::kLift && m.atomic != AtomicKind::kReady;
    }
    return actions;
}

// That of a handover.
const Done &action_of(const std::vector<Done> &actions, const Handover &h) {
    const auto at = std::find_if(actions.begin(), actions.end(), [&h](const Done &d) {
        return d.lowers <= h.time + kSlack && h.time <= d.ends + kSlack &&
               d.kind != AtomicKind::kReady;
    });
    assert_true(at != actions.end());
    return *at;
}

// ---- Rules -------------------------------------------------------------------------------------

struct Judge {
    const CellLayout &cell;
    const std::vector<PlannedStep> &steps;
    const Schedule &schedule;
    uint64_t seed;
    std::vector<Done> actions[2];

    Judge(const CellLayout &c, const std::vector<PlannedStep> &p, const Schedule &s, uint64_t of)
        : cell(c), steps(p), schedule(s), seed(of) {
        for (int arm = 0; arm < s.robots; ++arm) actions[arm] = actions_of(s.lanes[arm]);
    }

    void check(bool holds, const char *what, double value = 0, double allowed = 0) const {
        expect(holds, seed, what, value, allowed);
    }

    void all() const {
        for (int arm = 0; arm < schedule.robots; ++arm) {
            lane_is_whole(arm);
            hands_are_used_in_turn(arm);
        }
        arms_stay_apart();
        check(schedule.makespan >= schedule.lower_bound - kSlack, "makespan, below its bound",
              schedule.makespan, schedule.lower_bound);
        work_waits_for_belt_and_plan();
        belt_waits_for_picks();
        cells_are_free();
        if (schedule.robots == 1) return;
        if (schedule.taken == CoordinationMode::kZoneMutex) one_tool_over_the_bin();
        if (schedule.taken == CoordinationMode::kSyncPaper) slots_are_kept();
    }

    // From second 0 to the makespan, from home to home.
    void lane_is_whole(int arm) const {
        const std::vector<Motion> &lane = schedule.lanes[arm];
        const ArmPlace &place = cell.arms[static_cast<size_t>(arm)];
        double time = 0;
        check(!lane.empty(), "the lane is empty");
        for (size_t i = 0; i < lane.size(); ++i) {
            check(std::fabs(lane[i].start - time) < kSlack, "a gap in the lane", lane[i].start,
                  time);
            time = lane[i].end();
            for (size_t k = 0; i > 0 && k < lane[i].segment.from.size(); ++k) {
                const double jump = std::fabs(lane[i].segment.from[k] - lane[i - 1].segment.to[k]);
                check(jump < 1e-9, "the arm jumps", jump);
            }
        }
        check(std::fabs(time - schedule.makespan) < kSlack, "the lane's end", time,
              schedule.makespan);
        for (const Motion *m : {&lane.front(), &lane.back()}) {
            const ToolPose pose = tool_pose(place.model, place.base,
                                            m == &lane.front() ? m->segment.from : m->segment.to);
            check(distance({pose.x, pose.y}, place.home) < 1e-6, "not at home");
        }
    }

    // Grip and release in turn, of the same item, when its motions say so.
    void hands_are_used_in_turn(int arm) const {
        int32_t held = -1;
        double before = 0;
        size_t count = 0;
        for (const Handover &h : schedule.handovers) {
            check(h.time >= before, "handovers are not by time", h.time, before);
            before = h.time;
            if (h.arm != arm) continue;
            check(h.grip == (held < 0), "takes or lets go twice");
            check(h.grip || h.item.id == held, "lets go what it does not hold");
            if (!h.aside) held = h.grip ? h.item.id : -1;
            const Done &action = action_of(actions[arm], h);
            check(action.item == h.item.id && action.step == h.step, "a handover of another one");
            check((action.kind == AtomicKind::kPick) == h.grip, "of another kind");
            ++count;
        }
        check(held < 0, "holds an item at the end");
        const auto work = std::count_if(actions[arm].begin(), actions[arm].end(),
                                        [](const Done &d) { return d.kind != AtomicKind::kReady; });
        check(count == static_cast<size_t>(work), "actions without handover");
        double size = 0;
        for (const Motion &m : schedule.lanes[arm]) {
            if (m.activity == Activity::kTravel)
                check(m.held == size, "carries another size", m.held, size);
            if (m.activity == Activity::kLift) size = m.held;
        }
    }

    void arms_stay_apart() const {
        if (schedule.robots == 1) return;
        const double least = least_clearance(cell, schedule, kPeriod);
        check(least >= cell.margin - 1e-9, "metres apart", least, cell.margin);
    }

    // All that is recognised before the step was so before the last one.
    bool foreseen(int32_t step) const {
        if (step == 0) return false;
        const Queue &now = steps[static_cast<size_t>(step)].queue;
        const Queue &before = steps[static_cast<size_t>(step) - 1].queue;
        const int recognized = now.scenario().recognized;
        for (int i = 0; i < recognized && i < static_cast<int>(now.belt_size()); ++i) {
            const int place = before.find_belt(now.belt(static_cast<size_t>(i)).id);
            if (place < 0 || place >= recognized) return false;
        }
        return true;
    }

    void work_waits_for_belt_and_plan() const {
        std::vector<double> released(steps.size(), 0.0);
        double before = 0;
        for (const BeltMove &b : schedule.belt) {
            check(b.start >= before - kSlack, "the belt moves twice at once", b.start, before);
            before = b.start + b.duration;
            double &since = released[static_cast<size_t>(b.step)];
            since = std::max(since, before);
        }
        before = 0;
        for (const PlanningSpan &p : schedule.planning) {
            check(p.start >= before - kSlack, "plans twice at once", p.start, before);
            double &since = released[static_cast<size_t>(p.step)];
            const bool sees = p.start >= since - kSlack || foreseen(p.step);
            check(sees, "plans before the belt rests", p.start, since);
            before = p.start + p.duration;
            since = std::max(since, before);
        }
        for (int arm = 0; arm < schedule.robots; ++arm) {
            for (const Done &d : actions[arm]) {
                if (d.kind == AtomicKind::kReady) continue;
                const double since = released[static_cast<size_t>(d.step)];
                check(d.begins >= since - kSlack, "begins before its plan", d.begins, since);
            }
        }
    }

    void belt_waits_for_picks() const {
        for (const Handover &h : schedule.handovers) {
            if (!h.grip || h.at.spot != Spot::kBelt) continue;
            const Done &pick = action_of(actions[h.arm], h);
            for (const BeltMove &b : schedule.belt) {
                const bool apart =
                    pick.ends <= b.start + kSlack || b.start + b.duration <= pick.lowers + kSlack;
                check(apart, "the belt moves under a pick", b.start, pick.lowers);
                check(b.step > h.step || b.start < pick.lowers, "the belt is late");
            }
        }
    }

    // What comes down on cells finds them free, and they are in the end as planned.
    void cells_are_free() const {
        struct Stay {
            Rect cells;
            int32_t item;
            double from;  // the item above it comes down
            double lies;
            double to;
        };
        std::vector<Stay> stays;
        for (const Placement &p : steps.front().bin.items())
            stays.push_back({p.rect(), p.item.id, -1, -1, HUGE_VAL});
        for (const Handover &h : schedule.handovers) {
            if (h.at.spot != Spot::kBin || h.aside) continue;
            if (!h.grip) {
                const double lowers = action_of(actions[h.arm], h).lowers;
                stays.push_back({h.at.cells, h.item.id, lowers, h.time, HUGE_VAL});
                continue;
            }
            const auto lies = std::find_if(stays.begin(), stays.end(), [&h](const Stay &s) {
                return s.item == h.item.id && s.to == HUGE_VAL;
            });
            check(lies != stays.end(), "takes from the bin what does not lie there");
            check(lies->cells.x == h.at.cells.x && lies->cells.y == h.at.cells.y,
                  "takes it from elsewhere");
            lies->to = h.time;
        }
        for (size_t a = 0; a < stays.size(); ++a) {
            for (size_t b = 0; b < a; ++b) {
                const Rect &r = stays[a].cells;
                const Rect &q = stays[b].cells;
                const bool meet =
                    r.x < q.x + q.w && q.x < r.x + r.w && r.y < q.y + q.h && q.y < r.y + r.h;
                if (!meet) continue;
                const bool after = stays[a].from >= stays[b].to - kSlack;
                const bool before = stays[b].from >= stays[a].to - kSlack;
                check(after || before, "comes down on cells that are taken", stays[a].from,
                      stays[b].to);
            }
        }
    }

    bool over_bin(int arm, double time) const {
        const Footprint f = footprint_of(cell, schedule, arm, time);
        const Grid &grid = cell.bin.grid;
        const double x = std::fabs(f.tool.x - cell.bin.centre.x) - 0.0005 * grid.bin_w;
        const double y = std::fabs(f.tool.y - cell.bin.centre.y) - 0.0005 * grid.bin_h;
        return std::hypot(std::max(0.0, x - cell.bin.wall), std::max(0.0, y - cell.bin.wall)) <
               f.disc - 1e-9;
    }
    void one_tool_over_the_bin() const {
        for (int i = 0; i * kPeriod < schedule.makespan; ++i) {
            const double t = i * kPeriod;
            check(!over_bin(0, t) || !over_bin(1, t), "both tools are over the bin at", t);
        }
    }

    // The paper's slots: an action of one arm goes with at most one of the other's. Steps follow
    // each other.
    void slots_are_kept() const {
        for (int32_t step = 0; step < static_cast<int32_t>(steps.size()); ++step) {
            std::vector<Done> of[2];
            double begins = HUGE_VAL;
            double before = 0;
            for (int arm = 0; arm < 2; ++arm) {
                for (const Done &d : actions[arm]) {
                    if (d.step == step) begins = std::min(begins, d.begins);
                    if (d.step < step) before = std::max(before, d.ends);
                    if (d.step != step) continue;
                    // What is set aside belongs to the slot in which it did not fit, a way home in
                    // between to that of what was done before.
                    const bool aside = d.kind == AtomicKind::kPlaceToBuffer && !of[arm].empty() &&
                                       of[arm].back().kind == AtomicKind::kPlaceToBin;
                    const bool last = &d == &actions[arm].back() || (&d)[1].step != step;
                    const bool home = d.kind == AtomicKind::kReady && !last && !of[arm].empty();
                    if (aside || home)
                        of[arm].back().ends = d.ends;
                    else
                        of[arm].push_back(d);
                }
            }
            check(begins >= before - kSlack, "steps overlap", begins, before);
            for (int arm = 0; arm < 2; ++arm) {
                for (const Done &d : of[arm]) {
                    const auto count =
                        std::count_if(of[1 - arm].begin(), of[1 - arm].end(), [&d](const Done &o) {
                            return o.begins < d.ends - kSlack && d.begins < o.ends - kSlack;
                        });
                    check(count <= 1, "actions in one slot", static_cast<double>(count), 1);
                }
            }
        }
    }
};

// ---- Schedules of random episodes --------------------------------------------------------------

using SchedulerPtr = std::unique_ptr<Scheduler>;

// Where `blocked` is given, arms that block each other are counted and give no scheduler.
SchedulerPtr scheduled(const CellLayout &cell, const char *scenario, CoordinationMode mode,
                       const std::vector<PlannedStep> &steps, size_t count,
                       int *blocked = nullptr) {
    auto scheduler = std::make_unique<Scheduler>(cell, parse_scenario(scenario), mode);
    for (size_t i = 0; i < count; ++i) {
        const PlannedStep &step = steps[i];
        try {
            scheduler->add_step(step.bin, step.queue, step.actions.data(), step.actions.size());
        } catch (const Error &e) {
            const bool block = std::string(e.what()).find(" block each other") != std::string::npos;
            if (block && blocked != nullptr) {
                ++*blocked;
                return nullptr;
            }
            print_error("%s, %s, mode %d: %s\n", cell.name, scenario, static_cast<int>(mode),
                        e.what());
            fail();
        }
    }
    return scheduler;
}

EpisodeOptions options_for(const CellLayout &cell, const char *scenario, bool repacks) {
    EpisodeOptions options;
    options.scenario = scenario;
    options.bin = grid_bin(cell.bin.grid);
    options.repacks = repacks;
    options.buffer = static_cast<int>(cell.arms[0].buffer.size());
    return options;
}

void every_schedule_keeps_the_rules(void **) {
    const int rounds = check_watched() != 0 ? 1 : check_count(1, 30);
    int own[4] = {0, 0, 0, 0};
    int blocked = 0;
    int count = 0;
    uint64_t seed = 100;
    for (int round = 0; round < rounds; ++round) {
        for (int preset = 0; cell_preset_name(preset) != nullptr; ++preset) {
            const CellLayout cell = cell_preset(cell_preset_name(preset));
            for (const char *scenario : {"S-R5A3", "D-R2A2O2", "D-R5A2O2", "D-R5A3O1"}) {
                const bool two_shared = parse_scenario(scenario).overlap == 2;
                if (two_shared && std::string(cell.name) == "paper") continue;  // out of reach
                for (const bool repacks : {false, true}) {
                    EpisodeOptions options = options_for(cell, scenario, repacks);
                    // With few slots, or none, items are set down in the bin on their way.
                    options.buffer = std::min(options.buffer, round % 2 == 0 ? 0 : 1);
                    const auto steps = plan_episode(++seed, options);
                    double before = HUGE_VAL;
                    for (const CoordinationMode mode : kModes) {
                        // In the paper's slots an arm may have to wait at home with an item in
                        // its hand, and there it is in the way of the other one's elbow.
                        const bool may_block = mode == CoordinationMode::kSyncPaper &&
                                               std::string(cell.name) == "scara";
                        ++count;
                        const auto scheduler = scheduled(cell, scenario, mode, steps, steps.size(),
                                                         may_block ? &blocked : nullptr);
                        if (scheduler == nullptr) continue;
                        const Schedule schedule = scheduler->schedule();
                        Judge(cell, steps, schedule, seed).all();
                        expect(schedule.makespan <= before + kSlack, seed,
                               "longer than the stricter mode's", schedule.makespan, before);
                        before = schedule.makespan;
                        assert_true(schedule.mode == mode);
                        ++own[static_cast<int>(schedule.taken)];
                        expect(scheduler->released() <= schedule.makespan, seed, "released",
                               scheduler->released(), schedule.makespan);
                    }
                }
            }
        }
    }
    for (int mode = 1; mode <= 3; ++mode) assert_true(own[mode] > 0);
    assert_true(blocked <= count / 20);
}

void the_same_work_has_the_same_schedule(void **) {
    for (int preset = 0; cell_preset_name(preset) != nullptr; ++preset) {
        const CellLayout cell = cell_preset(cell_preset_name(preset));
        const auto steps = plan_episode(7, options_for(cell, "D-R5A3O1", true));
        uint64_t hashes[2];
        for (uint64_t &hash : hashes) {
            hash = schedule_hash(
                scheduled(cell, "D-R5A3O1", CoordinationMode::kCoordinated, steps, steps.size())
                    ->schedule());
        }
        assert_true(hashes[0] == hashes[1]);
    }
}

// ---- Items that do not fit ---------------------------------------------------------------------

// Lets every release into the bin after the last step's plan fail, in turn.
void what_did_not_fit_goes_to_the_buffer_and_may_come_back(void **) {
    int tried = 0;
    for (uint64_t seed = 1; seed <= (check_watched() != 0 ? 2u : 8u); ++seed) {
        const CellLayout cell = cell_preset(seed % 2 == 0 ? "ur5e" : "piper");
        const char *scenario = seed % 4 < 2 ? "D-R5A3O1" : "S-R5A3";
        const auto steps = plan_episode(seed, options_for(cell, scenario, false));
        const size_t count = std::min<size_t>(steps.size(), 3);
        for (const CoordinationMode mode : kModes) {
            const auto first = scheduled(cell, scenario, mode, steps, count);
            for (const Handover &h : first->schedule().handovers) {
                if (h.grip || h.time < first->released()) continue;
                auto scheduler = scheduled(cell, scenario, mode, steps, count);
                scheduler->put_aside(h.item.id, h.time);
                const Schedule schedule = scheduler->schedule();
                Judge(cell, steps, schedule, seed).all();
                const auto &all = schedule.handovers;
                const auto aside =
                    std::find_if(all.begin(), all.end(), [](const Handover &x) { return x.aside; });
                assert_true(aside != all.end());
                assert_int_equal(aside->item.id, h.item.id);
                assert_near(aside->time, h.time, 0);
                const auto then = std::find_if(aside + 1, all.end(),
                                               [&h](const Handover &x) { return x.arm == h.arm; });
                assert_true(then != all.end());
                assert_false(then->grip);
                assert_int_equal(then->item.id, h.item.id);
                assert_true(then->at.spot == Spot::kBuffer);

                // Nothing before has changed.
                for (const Handover &x : first->schedule().handovers) {
                    const bool kept =
                        x.time > h.time || std::any_of(all.begin(), all.end(), [&x](const auto &y) {
                            return y.item.id == x.item.id && y.time == x.time;
                        });
                    expect(kept, seed, "another past", x.time, h.time);
                }

                // It is packed again, from there.
                Bin bin = steps[count - 1].bin;
                Queue queue = steps[count - 1].queue;
                apply_step(bin, queue, steps[count - 1].actions.data(),
                           steps[count - 1].actions.size());
                bin.remove(static_cast<size_t>(bin.find(h.item.id)));
                queue.put_in_buffer({h.item, h.arm});
                const Action again = {kPack,        h.item.id, h.at.cells.x,
                                      h.at.cells.y, h.at.rot,  h.arm};
                scheduler->add_step(bin, queue, &again, 1);
                std::vector<PlannedStep> more(steps.begin(),
                                              steps.begin() + static_cast<std::ptrdiff_t>(count));
                more.push_back({bin, queue, {again}});
                const Schedule last = scheduler->schedule();
                Judge(cell, more, last, seed).all();
                const auto back = std::find_if(
                    last.handovers.begin(), last.handovers.end(), [count](const Handover &x) {
                        return x.step == static_cast<int32_t>(count) && !x.grip;
                    });
                assert_true(back != last.handovers.end());
                assert_int_equal(back->item.id, h.item.id);
                assert_true(back->at.spot == Spot::kBin);
                ++tried;
            }
        }
    }
    assert_true(tried >= 10);
}

void only_what_an_arm_lets_go_is_set_aside(void **) {
    const CellLayout cell = cell_preset("ur5e");
    const auto steps = plan_episode(3, options_for(cell, "D-R5A3O1", false));
    for (const CoordinationMode mode : kModes) {
        auto scheduler = scheduled(cell, "D-R5A3O1", mode, steps, 2);
        const Schedule before = scheduler->schedule();
        const auto refused = [&](int32_t item, double time) {
            failure(Status::kState, [&] { scheduler->put_aside(item, time); });
            assert_true(schedule_hash(scheduler->schedule()) == schedule_hash(before));
        };
        for (const Handover &h : before.handovers) {
            if (h.grip || h.time < scheduler->released()) {
                refused(h.item.id, h.time);
                continue;
            }
            refused(h.item.id, h.time + 0.01);
            refused(h.item.id, -h.time);
            refused(h.item.id, static_cast<double>(NAN));
            refused(h.item.id, HUGE_VAL);
            refused(h.item.id + 1000, h.time);
        }
        // It goes on as if nothing had been said.
        auto other = scheduled(cell, "D-R5A3O1", mode, steps, 2);
        for (Scheduler *s : {scheduler.get(), other.get()})
            s->add_step(steps[2].bin, steps[2].queue, steps[2].actions.data(),
                        steps[2].actions.size());
        assert_true(schedule_hash(scheduler->schedule()) == schedule_hash(other->schedule()));
    }
}

void an_item_for_which_the_buffer_has_no_place_is_a_limit(void **) {
    CellLayout cell = cell_preset("ur5e");
    for (ArmPlace &arm : cell.arms) arm.buffer.clear();
    const auto steps = plan_episode(3, options_for(cell, "D-R5A3O1", false));
    auto scheduler = scheduled(cell, "D-R5A3O1", CoordinationMode::kCoordinated, steps, 1);
    const Schedule before = scheduler->schedule();
    const Handover &h = before.handovers.back();
    failure(Status::kLimit, [&] { scheduler->put_aside(h.item.id, h.time); });
    assert_true(schedule_hash(scheduler->schedule()) == schedule_hash(before));
}

// ---- What cannot be ----------------------------------------------------------------------------

// With so wide a margin an arm at its home is in the other one's way wherever that goes.
void arms_that_block_each_other_are_named(void **) {
    CellLayout cell = cell_preset("ur5e");
    cell.margin = 0.6;
    check_cell(cell, parse_scenario("D-R5A3O1"));
    const auto steps = plan_episode(3, options_for(cell, "D-R5A3O1", false));
    for (const CoordinationMode mode : kModes) {
        auto scheduler = scheduled(cell, "D-R5A3O1", mode, steps, 0);
        const uint64_t before = schedule_hash(scheduler->schedule());
        const std::string text = failure(Status::kState, [&] {
            scheduler->add_step(steps[0].bin, steps[0].queue, steps[0].actions.data(),
                                steps[0].actions.size());
        });
        assert_true(text.find("step 0: arm 0 (item ") == 0);
        assert_true(text.find(") and arm 1 (item ") != std::string::npos);
        assert_true(text.find(" block each other: no order of their motions keeps them 0.6 m "
                              "apart") != std::string::npos);
        assert_int_equal(scheduler->steps(), 0);
        assert_true(schedule_hash(scheduler->schedule()) == before);
    }
    // One arm alone has no other in its way.
    const auto single = plan_episode(3, options_for(cell, "S-R5A3", false));
    scheduled(cell, "S-R5A3", CoordinationMode::kCoordinated, single, single.size());
}

void a_step_of_another_bin_or_scenario_is_refused(void **) {
    const CellLayout cell = cell_preset("ur5e");
    auto scheduler = scheduled(cell, "D-R5A3O1", CoordinationMode::kCoordinated, {}, 0);
    const Queue queue(parse_scenario("D-R5A3O1"));
    const Queue other(parse_scenario("D-R5A2O2"));
    const Action end = {kTerminate, 0, 0, 0, 0, 0};
    assert_string_equal(
        failure(Status::kArgument, [&] { scheduler->add_step(Bin(10, 9), queue, &end, 1); })
            .c_str(),
        "bin 10 x 9: the cell's has 10 x 10 cells");
    failure(Status::kArgument, [&] { scheduler->add_step(Bin(10, 10), other, &end, 1); });
    assert_int_equal(scheduler->steps(), 0);
    assert_near(scheduler->schedule().makespan, 0, 0);

    // A step without work takes its planning alone.
    scheduler->add_step(Bin(10, 10), queue, &end, 1);
    assert_int_equal(scheduler->steps(), 1);
}

}  // namespace
}  // namespace packcell

int main() {
    using namespace packcell;
    const CMUnitTest tests[] = {
        cmocka_unit_test(every_schedule_keeps_the_rules),
        cmocka_unit_test(the_same_work_has_the_same_schedule),
        cmocka_unit_test(what_did_not_fit_goes_to_the_buffer_and_may_come_back),
        cmocka_unit_test(only_what_an_arm_lets_go_is_set_aside),
        cmocka_unit_test(an_item_for_which_the_buffer_has_no_place_is_a_limit),
        cmocka_unit_test(arms_that_block_each_other_are_named),
        cmocka_unit_test(a_step_of_another_bin_or_scenario_is_refused),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
