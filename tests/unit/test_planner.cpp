// Properties of one plan, over random states of every scenario, method and repack mode.
#include "cell.h"

namespace packcell::cell {
namespace {

struct Mode {
    int32_t method;
    int32_t repack;
};
const Mode kModes[] = {{1, 0}, {1, 1}, {1, 2}, {2, 0}, {2, 1}, {2, 2}};

[[noreturn]] void report(uint64_t seed, const char *scenario, const Mode &mode,
                         const std::string &what) {
    print_error("seed %llu, %s, method %d, repack %d: %s\n", static_cast<unsigned long long>(seed),
                scenario, mode.method, mode.repack, what.c_str());
    fail();
    throw 0;
}

// Calls test(random, seed, scenario, mode) for every mode and scenario.
template <class Test>
void over_modes(int rounds, uint64_t first_seed, Test test) {
    for (const Mode &mode : kModes) {
        for (const char *scenario : kScenarios) {
            for (int round = 0; round < rounds; ++round) {
                const uint64_t seed = first_seed + static_cast<uint64_t>(round);
                Random random(seed);
                test(random, seed, scenario, mode);
            }
        }
    }
}

void slices_give_the_plan_made_in_one_go(void **) {
    over_modes(
        check_count(8, 100), 1, [](Random &random, uint64_t seed, const char *scenario, Mode mode) {
            const State s = draw_state(random, scenario, 8);
            pkc_planner_options options = small_options(mode.method, mode.repack);
            options.rotation = draw(random, 0, 1);
            options.buffer_capacity = draw(random, -1, 2);
            const PlannerHandle planner = make_planner(options);
            const auto nodes = static_cast<uint64_t>(draw(random, 1, 3000));
            const Plan whole = plan_once(planner, s, nodes);
            if (!same(whole, plan_once(planner, s, nodes)))
                report(seed, scenario, mode, "another plan the second time");
            if (!same(whole, plan_once(make_planner(options), s, nodes)))
                report(seed, scenario, mode, "another plan by a fresh planner");
            if (whole.info.nodes > nodes)
                report(seed, scenario, mode, "more nodes than the budget");
            for (const uint64_t slice : {1, 7, 1000}) {
                const Plan sliced = plan_in_slices(planner, s, nodes, slice, slice == 7);
                if (!same(whole, sliced)) {
                    report(seed, scenario, mode,
                           "budget " + std::to_string(nodes) + ": " + describe(whole) +
                               "; in slices of " + std::to_string(slice) + ": " + describe(sliced));
                }
            }
        });
}

void every_budget_gives_a_legal_plan(void **) {
    over_modes(
        check_count(10, 100), 1000,
        [](Random &random, uint64_t seed, const char *scenario, Mode mode) {
            const State s = draw_state(random, scenario, 9);
            pkc_planner_options options = small_options(mode.method, mode.repack);
            options.rotation = draw(random, 0, 1);
            options.skip = draw(random, 0, 1);
            options.select = draw(random, -1, 3);
            const PlannerHandle planner = make_planner(options);
            for (const uint64_t nodes : {1, 2, 3, 10, 50, 300, 2000}) {
                State after = s.copy();
                const std::string wrong = carry_out(after, plan_once(planner, s, nodes), options);
                if (!wrong.empty())
                    report(seed, scenario, mode, wrong + " with nodes " + std::to_string(nodes));
            }
            for (const double ms : {1e-300, 0.001, 0.1}) {
                State after = s.copy();
                const std::string wrong = carry_out(after, plan_once(planner, s, 0, ms), options);
                if (!wrong.empty())
                    report(seed, scenario, mode, wrong + " with ms " + std::to_string(ms));
            }
        });
}

void the_best_so_far_is_always_a_legal_plan(void **) {
    over_modes(check_count(3, 40), 2000,
               [](Random &random, uint64_t seed, const char *scenario, Mode mode) {
                   const State s = draw_state(random, scenario, 7);
                   pkc_planner_options options = small_options(mode.method, mode.repack);
                   options.buffer_capacity = draw(random, -1, 1);
                   const PlannerHandle planner = make_planner(options);
                   const pkc_budget budget = check_budget(500);
                   CHECK_OK(pkc_planner_begin(planner.get(), s.bin.get(), s.queue.get(), &budget));
                   for (int32_t done = 0; done == 0;) {
                       State after = s.copy();
                       const std::string wrong =
                           carry_out(after, result_of(planner.get()), options);
                       if (!wrong.empty()) report(seed, scenario, mode, wrong);
                       CHECK_OK(pkc_planner_step(planner.get(), 5, &done));
                   }
               });
}

// Not their sizes, not their number, as long as some remain: with none left the belt would come to
// its end, which shows. `side` 0: bins of many shapes.
void change_items_behind(const char *policy, int side, int rounds) {
    over_modes(rounds, 3000, [&](Random &random, uint64_t seed, const char *scenario, Mode mode) {
        const State s = side == 0 ? draw_state(random, scenario, 8, 8)
                                  : draw_state(random, scenario, side, 8, side);
        pkc_scenario sc;
        CHECK_OK(pkc_scenario_init(&sc, sizeof sc));
        CHECK_OK(pkc_queue_get_scenario(s.queue.get(), &sc));
        const auto belt = belt_of(s);
        if (belt.size() < static_cast<size_t>(sc.recognized) + 2) return;
        const PlannerHandle planner = make_planner(small_options(mode.method, mode.repack), policy);
        const Plan plan = plan_once(planner, s, 1500);
        State fewer = s.copy();
        for (size_t i = static_cast<size_t>(sc.recognized) + 1; i < belt.size(); ++i)
            CHECK_OK(pkc_queue_remove(fewer.queue.get(), belt[i].item.id));
        if (!same(plan, plan_once(planner, fewer, 1500)))
            report(seed, scenario, mode, "another plan with fewer items behind");
        State other = fewer.copy();
        CHECK_OK(
            pkc_queue_remove(other.queue.get(), belt[static_cast<size_t>(sc.recognized)].item.id));
        push_items(random, other, 5, 5000, 9, 9);
        if (!same(plan, plan_once(planner, other, 1500)))
            report(seed, scenario, mode, "another plan with other items behind");
    });
}

void items_beyond_the_recognised_ones_change_no_plan(void **) {
    change_items_behind("contact", 0, check_count(6, 80));
    change_items_behind("skyline", 0, check_count(2, 20));
    // With its critic, which is for bins of ten cells a side.
    change_items_behind("default", 10, check_count(3, 40));
}

// Small enough for the search to end by itself: then a larger choice cannot rank lower.
void rotation_never_ranks_below_none(void **) {
    over_modes(
        check_count(6, 60), 4000,
        [](Random &random, uint64_t seed, const char *scenario, Mode mode) {
            if (mode.method == PKC_METHOD_PAPER && mode.repack == PKC_REPACK_ANYTIME) return;
            const State s = draw_state(random, scenario, 5);
            pkc_planner_options options = small_options(mode.method, mode.repack);
            options.select = PKC_SELECT_ALL;
            const Plan turned = plan_once(make_planner(options), s, 2000000);
            options.rotation = 0;
            const Plan straight = plan_once(make_planner(options), s, 2000000);
            if (turned.info.proof == PKC_PROOF_BUDGET || straight.info.proof == PKC_PROOF_BUDGET)
                return;
            const bool packing = turned.info.repacked == 0 && straight.info.repacked == 0;
            const bool lower = packing && turned.info.score != straight.info.score
                                   ? turned.info.score < straight.info.score
                                   : turned.info.utilization < straight.info.utilization;
            // In full mode a rearrangement is preferred to a higher score.
            if (lower && mode.repack != PKC_REPACK_FULL)
                report(seed, scenario, mode, "ranks lower");
        });
}

void anytime_repacking_never_fills_less_than_none(void **) {
    for (const int32_t method : {PKC_METHOD_PAPER, PKC_METHOD_EXACT}) {
        for (const char *scenario : kScenarios) {
            for (int round = 0; round < check_count(12, 150); ++round) {
                const auto seed = static_cast<uint64_t>(round) + 5000;
                Random random(seed);
                const State s = draw_state(random, scenario, 7);
                pkc_planner_options options = small_options(method, PKC_REPACK_OFF);
                options.select = PKC_SELECT_ALL;
                const Plan off = plan_once(make_planner(options), s, 0);
                options.repack = PKC_REPACK_ANYTIME;
                const Plan on = plan_once(make_planner(options), s, 20000);
                if (on.info.proof == PKC_PROOF_BUDGET && on.info.repacked == 0) continue;
                if (on.info.utilization < off.info.utilization)
                    report(seed, scenario, {method, PKC_REPACK_ANYTIME}, "fills less");
            }
        }
    }
}

// Without a limit in nodes, a limit in time ends any plan, and not much later. Areas that are all
// even in a bin with an odd number of cells make for many combinations that come to nothing.
void a_time_budget_ends_plans_that_have_much_to_try(void **) {
    if (check_watched()) skip();
    for (const Mode &mode : kModes) {
        for (const char *scenario : {"S-R5A1", "D-R5A3O1", "S-R40A40"}) {
            State s = make_state(21, 21, scenario);
            Random random(7);
            static const int sizes[][2] = {{2, 1}, {2, 2}, {2, 3}, {4, 1},
                                           {2, 5}, {4, 3}, {2, 4}, {6, 1}};
            int id = 0;
            for (int y = 0; y < 21; y += 3) {
                for (int x = 0; x + 6 <= 21;) {
                    const int *size = sizes[random.below(8)];
                    const int w =
                        std::min(size[0], size[1]) <= 3 && size[1] > 3 ? size[1] : size[0];
                    const int h = w == size[0] ? size[1] : size[0];
                    if (h <= 3) check_pack(s.bin.get(), id++, w, h, x, y);
                    x += w;
                }
            }
            for (int i = 0; i < 45; ++i) check_push(s.queue.get(), 500 + i, 6, 8 + i % 3 * 2);
            pkc_planner_options options = small_options(mode.method, mode.repack, 21);
            const PlannerHandle planner = make_planner(options);
            for (const double ms : {1.0, 20.0}) {
                const double begun = check_milliseconds();
                const Plan plan = plan_once(planner, s, 0, ms);
                const double took = check_milliseconds() - begun;
                if (took > ms + 500)
                    report(7, scenario, mode, "took " + std::to_string(took) + " ms");
                State after = s.copy();
                const std::string wrong = carry_out(after, plan, options);
                if (!wrong.empty()) report(7, scenario, mode, wrong);
            }
        }
    }
}

void bins_of_extreme_shape_are_planned(void **) {
    static const int shapes[][2] = {{128, 128}, {1, 1},  {1, 128}, {128, 1}, {64, 64},
                                    {65, 65},   {64, 1}, {65, 64}, {1, 65},  {127, 3}};
    for (const auto &shape : shapes) {
        for (const Mode &mode : kModes) {
            Random random(static_cast<uint64_t>(shape[0] * 1000 + shape[1]));
            State s = make_state(shape[0], shape[1], "D-R5A3O1");
            push_items(random, s, 40, 0, std::max(1, shape[0] / 2), std::max(1, shape[1] / 2));
            pkc_planner_options options = small_options(mode.method, mode.repack, 128);
            const PlannerHandle planner = make_planner(options);
            int steps = 0;
            for (; steps < check_count(12, 60); ++steps) {
                const double begun = check_milliseconds();
                const Plan plan = plan_once(planner, s, 300);
                const double took = check_milliseconds() - begun;
                // 300 nodes of a 128 x 128 bin: some milliseconds each at the very most.
                if (took > 3000 && !check_watched())
                    report(0, "D-R5A3O1", mode, "took " + std::to_string(took) + " ms");
                const std::string wrong = carry_out(s, plan, options);
                if (!wrong.empty()) report(0, "D-R5A3O1", mode, wrong);
                if (plan.info.terminate != 0) break;
            }
            assert_true(items_of(s).size() > 0);
        }
    }
}

// The largest plan that a scenario allows: 64 recognised items, all within reach.
void the_largest_scenario_is_planned(void **) {
    for (const Mode &mode : kModes) {
        Random random(3);
        State s = make_state(24, 24, "D-R64A64O64");
        push_items(random, s, 80, 0, 8, 8);
        pkc_planner_options options = small_options(mode.method, mode.repack, 24);
        const PlannerHandle planner = make_planner(options);
        for (int steps = 0; steps < 100; ++steps) {
            const Plan plan = plan_once(planner, s, 2000);
            const std::string wrong = carry_out(s, plan, options);
            if (!wrong.empty()) report(3, "D-R64A64O64", mode, wrong);
            if (plan.info.terminate != 0) break;
        }
    }
}

// What the proofs say must be so: after OPTIMAL or IMPOSSIBLE a larger budget changes nothing.
void a_proof_holds_with_any_larger_budget(void **) {
    for (const int32_t repack : {PKC_REPACK_ANYTIME, PKC_REPACK_FULL}) {
        for (const char *scenario : kScenarios) {
            for (int round = 0; round < check_count(15, 200); ++round) {
                const auto seed = static_cast<uint64_t>(round) + 6000;
                Random random(seed);
                const State s = draw_state(random, scenario, 6);
                pkc_planner_options options = small_options(PKC_METHOD_EXACT, repack);
                options.buffer_capacity = draw(random, -1, 2);
                const PlannerHandle planner = make_planner(options);
                const Plan plan = plan_once(planner, s, 3000);
                if (plan.info.proof == PKC_PROOF_BUDGET) continue;
                const Plan more = plan_once(planner, s, 100000);
                if (!same(plan, more))
                    report(seed, scenario, {PKC_METHOD_EXACT, repack}, "a proved plan changes");
            }
        }
    }
}

}  // namespace
}  // namespace packcell::cell

int main() {
    using namespace packcell::cell;
    const CMUnitTest tests[] = {
        cmocka_unit_test(slices_give_the_plan_made_in_one_go),
        cmocka_unit_test(every_budget_gives_a_legal_plan),
        cmocka_unit_test(the_best_so_far_is_always_a_legal_plan),
        cmocka_unit_test(items_beyond_the_recognised_ones_change_no_plan),
        cmocka_unit_test(rotation_never_ranks_below_none),
        cmocka_unit_test(anytime_repacking_never_fills_less_than_none),
        cmocka_unit_test(a_time_budget_ends_plans_that_have_much_to_try),
        cmocka_unit_test(bins_of_extreme_shape_are_planned),
        cmocka_unit_test(the_largest_scenario_is_planned),
        cmocka_unit_test(a_proof_holds_with_any_larger_budget),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
