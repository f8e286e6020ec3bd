/* Whole episodes, from the planner to the physics: what every schedule must be, judged at every
 * millisecond by code that shares nothing with the one that made it (support/judge.h). Few episodes
 * by default, the 30 of `packcell-bench makespan` with PACKCELL_CHECK_ALL=1. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "check.h"
#include "judge.h"

#define MODES 3

static const char *const mode_names[MODES] = {"SYNC_PAPER", "ZONE_MUTEX", "COORDINATED"};

typedef struct episode {
    judge_episode plan;
    pkc_schedule *schedules[MODES];
} episode;

static void free_episode(episode *e) {
    int i;
    for (i = 0; i < e->plan.step_count; ++i) free(e->plan.steps[i].actions);
    for (i = 0; i < MODES; ++i) pkc_schedule_free(e->schedules[i]);
    free(e->plan.items);
    free(e->plan.cells);
}

/* Plans a set to its end; each step goes into the schedules of all modes. */
static void run_episode(const pkc_cell *cell, const char *name, int32_t repack, pkc_item *items,
                        size_t count, episode *out) {
    static pkc_action actions[PKC_MAX_ACTIONS];
    const pkc_budget budget = check_budget(200000);
    pkc_planner_options options = check_options();
    pkc_plan_info plan = check_plan_info();
    pkc_cell_info info;
    pkc_scenario scenario;
    pkc_planner *planner = NULL;
    pkc_queue *queue = check_queue(name);
    pkc_bin *bin;
    size_t size = 0;
    size_t i;
    int m;
    memset(out, 0, sizeof *out);
    CHECK_OK(pkc_cell_info_init(&info, sizeof info));
    CHECK_OK(pkc_cell_get_info(cell, &info));
    CHECK_OK(pkc_scenario_init(&scenario, sizeof scenario));
    CHECK_OK(pkc_scenario_parse(name, &scenario));
    bin = check_bin(info.bin_w, info.bin_h);
    options.repack = repack;
    options.skip = 1;
    options.max_side = 10;
    options.max_items = 100;
    options.buffer_capacity = info.buffer_slots[0];
    if (scenario.robots == 2 && info.buffer_slots[1] < info.buffer_slots[0])
        options.buffer_capacity = info.buffer_slots[1];
    CHECK_OK(pkc_planner_create(&options, NULL, &planner));
    for (i = 0; i < count; ++i) CHECK_OK(pkc_queue_push(queue, &items[i]));
    for (m = 0; m < MODES; ++m) {
        CHECK_OK(pkc_schedule_create(cell, &scenario, m + 1, &out->schedules[m]));
    }
    out->plan.items = (pkc_item *)malloc(count * sizeof items[0]);
    assert_non_null(out->plan.items);
    memcpy(out->plan.items, items, count * sizeof items[0]);
    out->plan.item_count = count;
    do {
        judge_step *step = &out->plan.steps[out->plan.step_count++];
        assert_true(out->plan.step_count <= JUDGE_MAX_STEPS);
        CHECK_OK(pkc_planner_plan(planner, bin, queue, &budget, &plan));
        CHECK_OK(pkc_planner_result(planner, &plan, actions, PKC_MAX_ACTIONS, &step->count));
        CHECK_OK(pkc_allocate(cell, queue, actions, step->count));
        for (m = 0; m < MODES; ++m) {
            CHECK_OK(pkc_schedule_add_step(out->schedules[m], bin, queue, actions, step->count));
        }
        CHECK_OK(pkc_step_apply(bin, queue, actions, step->count));
        step->actions = (pkc_action *)malloc(step->count * sizeof actions[0]);
        assert_non_null(step->actions);
        memcpy(step->actions, actions, step->count * sizeof actions[0]);
    } while (!plan.terminate);
    size = (size_t)info.bin_w * (size_t)info.bin_h;
    out->plan.cells = (int32_t *)malloc(size * sizeof(int32_t));
    assert_non_null(out->plan.cells);
    CHECK_OK(pkc_bin_cells(bin, out->plan.cells, size, &size));
    pkc_planner_free(planner);
    pkc_queue_free(queue);
    pkc_bin_free(bin);
}

static pkc_schedule_info info_of(const pkc_schedule *schedule) {
    pkc_schedule_info info;
    CHECK_OK(pkc_schedule_info_init(&info, sizeof info));
    CHECK_OK(pkc_schedule_get_info(schedule, &info));
    return info;
}

static pkc_generator *set_generator(const pkc_cell *cell) {
    pkc_generator_options options;
    pkc_generator *generator = NULL;
    pkc_cell_info info;
    CHECK_OK(pkc_cell_info_init(&info, sizeof info));
    CHECK_OK(pkc_cell_get_info(cell, &info));
    CHECK_OK(pkc_generator_options_init(&options, sizeof options));
    options.kind = PKC_GENERATE_FULL;
    options.w = info.bin_w;
    options.h = info.bin_h;
    CHECK_OK(pkc_generator_preset(&options, "table"));
    CHECK_OK(pkc_generator_create(&options, &generator));
    return generator;
}

/* Prints what the judge found; the number of faults. */
static long tell(const char *what, int set, int mode, const judge_report *report) {
    long all = 0;
    int f;
    for (f = 0; f < JUDGE_FAULTS; ++f) {
        if (report->faults[f] == 0) continue;
        all += report->faults[f];
        print_error("%s, set %d, %s: %s, %ld times; first: %s\n", what, set, mode_names[mode],
                    judge_fault_name(f), report->faults[f], report->first[f]);
    }
    return all;
}

static void judge_bounds(const char *what, int set, const episode *e, long *faults) {
    pkc_schedule_info info[MODES];
    int m;
    for (m = 0; m < MODES; ++m) info[m] = info_of(e->schedules[m]);
    for (m = 0; m < MODES; ++m) {
        const int late = m > 0 && info[m].makespan > info[m - 1].makespan + 1e-6;
        if (info[m].mode != m + 1 || info[m].taken < 1 || info[m].taken > m + 1 || late ||
            info[m].makespan < info[m].lower_bound - 1e-6) {
            print_error(
                "%s, set %d, %s: makespan %.6f s, bound %.6f s, before %.6f s, of mode %d\n", what,
                set, mode_names[m], info[m].makespan, info[m].lower_bound,
                info[m > 0 ? m - 1 : 0].makespan, (int)info[m].taken);
            ++*faults;
        }
    }
}

/* Without noise everything lies where it was planned to. */
static void judge_simulation(const char *what, int set, const pkc_schedule *schedule,
                             long *faults) {
    pkc_simulation *simulation = NULL;
    pkc_simulation_info info;
    CHECK_OK(pkc_simulate(schedule, NULL, &simulation));
    CHECK_OK(pkc_simulation_info_init(&info, sizeof info));
    CHECK_OK(pkc_simulation_get_info(simulation, &info));
    if (info.jams != 0 || info.misplaced != 0 || info.missed != 0 || info.places == 0 ||
        !(info.worst_error <= 1e-4) || !(info.worst_overlap <= 5e-5)) {
        print_error(
            "%s, set %d: %d places, %d jams, %d misplaced, %d not detected, worst error %g m, "
            "overlap %g m\n",
            what, set, (int)info.places, (int)info.jams, (int)info.misplaced, (int)info.missed,
            info.worst_error, info.worst_overlap);
        ++*faults;
    }
    pkc_simulation_free(simulation);
}

static void judge_sets(const char *preset, const char *scenario, int32_t repack) {
    const int sets = check_watched() ? 1 : check_count(2, 30);
    const double begun = check_milliseconds();
    char what[64];
    judge_cell known;
    judge_report report;
    pkc_cell *cell = NULL;
    pkc_generator *generator;
    pkc_item items[PKC_MAX_SIDE];
    double least = 1e9;
    double links = 1e9;
    double outside = 0;
    long faults = 0;
    long samples = 0;
    int set;
    int m;
    CHECK_OK(pkc_cell_create(preset, &cell));
    judge_read_cell(&known, cell);
    generator = set_generator(cell);
    snprintf(what, sizeof what, "%s, %s, repacking %s", preset, scenario, repack ? "on" : "off");
    for (set = 1; set <= sets; ++set) {
        episode e;
        size_t count = 0;
        CHECK_OK(pkc_generator_next(generator, items, PKC_MAX_SIDE, &count));
        run_episode(cell, scenario, repack, items, count, &e);
        judge_bounds(what, set, &e, &faults);
        for (m = 0; m < MODES; ++m) {
            judge_schedule(&known, scenario[0] == 'D' ? 2 : 1, &e.plan, e.schedules[m],
                           pkc_schedule_sample, &report);
            faults += tell(what, set, m, &report);
            samples += report.samples;
            if (report.outside > outside) outside = report.outside;
            if (report.least_between_links < links) links = report.least_between_links;
            if (report.least_clearance < least) least = report.least_clearance;
            judge_simulation(what, set, e.schedules[m], &faults);
        }
        free_episode(&e);
    }
    print_message("%s: %d sets, %ld samples, %.1f s\n", what, sets, samples,
                  (check_milliseconds() - begun) / 1000);
    if (least < 1e8) {
        print_message(
            "    least clearance %.1f mm, %.1f mm between the links themselves, which are up to "
            "%.1f mm outside of their footprint\n",
            least * 1000, links * 1000, outside * 1000);
    }
    pkc_generator_free(generator);
    pkc_cell_free(cell);
    assert_int_equal(faults, 0);
    /* A footprint leaves out the elbow of an arm that works near its base, and the bend of a UR5e's
     * wrist. What sticks out stays away from the other arm. */
    assert_true(links > 0);
}

static void one_arm_of_the_paper_s_cell_keeps_the_rules(void **state) {
    (void)state;
    judge_sets("paper", "S-R5A3", PKC_REPACK_OFF);
    judge_sets("paper", "S-R5A3", PKC_REPACK_FULL);
}

static void one_fast_arm_keeps_the_rules(void **state) {
    (void)state;
    judge_sets("ur5e", "S-R5A3", PKC_REPACK_OFF);
    judge_sets("ur5e", "S-R5A3", PKC_REPACK_FULL);
}

static void one_piper_keeps_the_rules(void **state) {
    (void)state;
    judge_sets("piper", "S-R5A3", PKC_REPACK_OFF);
    judge_sets("piper", "S-R5A3", PKC_REPACK_FULL);
}

static void two_arms_of_the_paper_s_cell_keep_the_rules(void **state) {
    (void)state;
    judge_sets("paper", "D-R5A3O1", PKC_REPACK_OFF);
    judge_sets("paper", "D-R5A3O1", PKC_REPACK_FULL);
}

static void two_fast_arms_keep_the_rules(void **state) {
    (void)state;
    judge_sets("ur5e", "D-R5A3O1", PKC_REPACK_OFF);
    judge_sets("ur5e", "D-R5A3O1", PKC_REPACK_FULL);
}

/* The paper's physical test: two Pipers, a bin of 32 x 26 cm with margins of 1 cm and cells of 3
 * cm. */
static void two_pipers_pack_the_paper_s_physical_bin(void **state) {
    judge_cell known;
    pkc_cell *cell = NULL;
    (void)state;
    CHECK_OK(pkc_cell_create("piper", &cell));
    judge_read_cell(&known, cell);
    assert_int_equal(known.arms, 2);
    assert_string_equal(known.model[0], "piper");
    assert_string_equal(known.model[1], "piper");
    assert_true(known.bin_w == 0.32 && known.bin_h == 0.26 && known.bin_margin == 0.01 &&
                known.side == 0.03);
    assert_int_equal(known.w, 10);
    assert_int_equal(known.h, 8);
    pkc_cell_free(cell);
    judge_sets("piper", "D-R5A3O1", PKC_REPACK_OFF);
    judge_sets("piper", "D-R5A3O1", PKC_REPACK_FULL);
}

/* ---- The judge itself ----------------------------------------------------------------------- */

static double makespan_now;

static double clipped(double time) {
    return time < 0 ? 0 : time > makespan_now ? makespan_now : time;
}

static pkc_status arm_1_is_late(const pkc_schedule *schedule, int32_t arm, double time,
                                pkc_arm_sample *s) {
    return pkc_schedule_sample(schedule, arm, arm == 1 ? clipped(time - 1.5) : time, s);
}

static pkc_status a_joint_is_off(const pkc_schedule *schedule, int32_t arm, double time,
                                 pkc_arm_sample *s) {
    const pkc_status status = pkc_schedule_sample(schedule, arm, time, s);
    s->position[1] += 1e-5;
    return status;
}

static pkc_status all_is_faster(const pkc_schedule *schedule, int32_t arm, double time,
                                pkc_arm_sample *s) {
    const double rate = 1.6;
    const pkc_status status = pkc_schedule_sample(schedule, arm, clipped(time * rate), s);
    int i;
    for (i = 0; i < 6; ++i) {
        s->velocity[i] *= rate;
        s->acceleration[i] *= rate * rate;
    }
    return status;
}

static pkc_status velocities_are_low(const pkc_schedule *schedule, int32_t arm, double time,
                                     pkc_arm_sample *s) {
    const pkc_status status = pkc_schedule_sample(schedule, arm, time, s);
    int i;
    for (i = 0; i < 6; ++i) s->velocity[i] *= 0.99;
    return status;
}

static pkc_status travel_is_called_waiting(const pkc_schedule *schedule, int32_t arm, double time,
                                           pkc_arm_sample *s) {
    const pkc_status status = pkc_schedule_sample(schedule, arm, time, s);
    if (s->activity == PKC_ACTIVITY_TRAVEL && s->velocity[0] > 0.5) {
        s->activity = PKC_ACTIVITY_WAIT;
        s->reason = PKC_WAIT_OTHER_ARM;
    }
    return status;
}

/* It waits in the middle of a motion, and goes on where it was. */
static pkc_status a_pause_in_motion(const pkc_schedule *schedule, int32_t arm, double time,
                                    pkc_arm_sample *s) {
    const double pause = 3.21;
    pkc_status status;
    if (time <= pause || arm == 1) return pkc_schedule_sample(schedule, arm, time, s);
    status =
        pkc_schedule_sample(schedule, arm, clipped(time - 0.5 > pause ? time - 0.5 : pause), s);
    if (time - 0.5 <= pause) {
        memset(s->velocity, 0, sizeof s->velocity);
        memset(s->acceleration, 0, sizeof s->acceleration);
        s->activity = PKC_ACTIVITY_WAIT;
        s->reason = PKC_WAIT_OTHER_ARM;
    }
    return status;
}

static pkc_status items_are_confused(const pkc_schedule *schedule, int32_t arm, double time,
                                     pkc_arm_sample *s) {
    const pkc_status status = pkc_schedule_sample(schedule, arm, time, s);
    if (arm == 0 && s->item == 0) s->item = 1;
    return status;
}

static pkc_status the_gripper_looks_empty(const pkc_schedule *schedule, int32_t arm, double time,
                                          pkc_arm_sample *s) {
    const pkc_status status = pkc_schedule_sample(schedule, arm, time, s);
    s->held = 0;
    return status;
}

static pkc_status both_arms_are_arm_0(const pkc_schedule *schedule, int32_t arm, double time,
                                      pkc_arm_sample *s) {
    (void)arm;
    return pkc_schedule_sample(schedule, 0, time, s);
}

static void the_judge_sees_what_is_wrong(void **state) {
    static const struct {
        const char *name;
        judge_sampler *sampler;
        int fault;
    } mutations[] = {{"an arm is late", arm_1_is_late, JUDGE_CLEARANCE},
                     {"a joint is off", a_joint_is_off, JUDGE_TOOL},
                     {"all is faster", all_is_faster, JUDGE_LIMITS},
                     {"all is faster", all_is_faster, JUDGE_LANES},
                     {"velocities are low", velocities_are_low, JUDGE_DERIVATIVES},
                     {"travel is called waiting", travel_is_called_waiting, JUDGE_PAUSE},
                     {"a pause in motion", a_pause_in_motion, JUDGE_DERIVATIVES},
                     {"items are confused", items_are_confused, JUDGE_BOOKING},
                     {"the gripper looks empty", the_gripper_looks_empty, JUDGE_BOOKING},
                     {"both arms are arm 0", both_arms_are_arm_0, JUDGE_TOOL}};
    judge_cell known;
    judge_report report;
    pkc_cell *cell = NULL;
    pkc_generator *generator;
    pkc_item items[PKC_MAX_SIDE];
    episode e;
    size_t count = 0;
    size_t i;
    pkc_action was;
    (void)state;
    CHECK_OK(pkc_cell_create("ur5e", &cell));
    judge_read_cell(&known, cell);
    generator = set_generator(cell);
    CHECK_OK(pkc_generator_next(generator, items, PKC_MAX_SIDE, &count));
    run_episode(cell, "D-R5A3O1", PKC_REPACK_OFF, items, count, &e);
    makespan_now = info_of(e.schedules[2]).makespan;
    for (i = 0; i < sizeof mutations / sizeof mutations[0]; ++i) {
        judge_schedule(&known, 2, &e.plan, e.schedules[2], mutations[i].sampler, &report);
        if (report.faults[mutations[i].fault] == 0) {
            print_error("%s: the judge sees no fault of %s\n", mutations[i].name,
                        judge_fault_name(mutations[i].fault));
            fail();
        }
    }
    /* Other work than that of the steps: an item one cell aside, on a cell of another one. */
    was = e.plan.steps[1].actions[0];
    e.plan.steps[1].actions[0].x = e.plan.steps[0].actions[0].x;
    e.plan.steps[1].actions[0].y = e.plan.steps[0].actions[0].y;
    judge_schedule(&known, 2, &e.plan, e.schedules[2], pkc_schedule_sample, &report);
    assert_true(report.faults[JUDGE_BOOKING] > 0);
    assert_non_null(strstr(report.first[JUDGE_BOOKING], "is not its place in the bin"));
    e.plan.steps[1].actions[0] = was;
    /* A larger margin than the cell's. */
    known.margin += report.least_clearance;
    judge_schedule(&known, 2, &e.plan, e.schedules[2], pkc_schedule_sample, &report);
    assert_true(report.faults[JUDGE_CLEARANCE] > 0);
    free_episode(&e);
    pkc_generator_free(generator);
    pkc_cell_free(cell);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_judge_sees_what_is_wrong),
        cmocka_unit_test(one_arm_of_the_paper_s_cell_keeps_the_rules),
        cmocka_unit_test(one_fast_arm_keeps_the_rules),
        cmocka_unit_test(one_piper_keeps_the_rules),
        cmocka_unit_test(two_arms_of_the_paper_s_cell_keep_the_rules),
        cmocka_unit_test(two_fast_arms_keep_the_rules),
        cmocka_unit_test(two_pipers_pack_the_paper_s_physical_bin),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
