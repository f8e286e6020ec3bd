/* The cell through the C API: descriptions, kinematics, schedules, simulation and traces, and what
 * all of them do with arguments that are wrong. */
#define _GNU_SOURCE
#include <math.h>
#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

#include "check.h"
#include "count_malloc.h"

static pkc_cell *make_cell(const char *preset) {
    pkc_cell *cell = NULL;
    CHECK_OK(pkc_cell_create(preset, &cell));
    return cell;
}

static pkc_scenario scenario_of(const char *name) {
    pkc_scenario scenario;
    CHECK_OK(pkc_scenario_init(&scenario, sizeof scenario));
    CHECK_OK(pkc_scenario_parse(name, &scenario));
    return scenario;
}

static pkc_schedule_info info_of(const pkc_schedule *schedule) {
    pkc_schedule_info info;
    CHECK_OK(pkc_schedule_info_init(&info, sizeof info));
    CHECK_OK(pkc_schedule_get_info(schedule, &info));
    return info;
}

static pkc_action action(int32_t op, int32_t item, int32_t x, int32_t y, int32_t rot, int32_t arm) {
    const pkc_action a = {op, item, x, y, rot, arm};
    return a;
}

/* A cell with a schedule, an empty bin and four items on the belt. */
typedef struct scene {
    pkc_cell *cell;
    pkc_bin *bin;
    pkc_queue *queue;
    pkc_schedule *schedule;
} scene;

static scene make_scene(const char *preset, const char *scenario, int32_t mode) {
    const pkc_scenario s = scenario_of(scenario);
    pkc_cell_info info;
    scene made;
    int32_t i;
    made.cell = make_cell(preset);
    CHECK_OK(pkc_cell_info_init(&info, sizeof info));
    CHECK_OK(pkc_cell_get_info(made.cell, &info));
    made.bin = check_bin(info.bin_w, info.bin_h);
    made.queue = check_queue(scenario);
    for (i = 0; i < 4; ++i) check_push(made.queue, i, 3, 2);
    made.schedule = NULL;
    CHECK_OK(pkc_schedule_create(made.cell, &s, mode, &made.schedule));
    return made;
}

static void free_scene(scene *s) {
    pkc_schedule_free(s->schedule);
    pkc_queue_free(s->queue);
    pkc_bin_free(s->bin);
    pkc_cell_free(s->cell);
}

static void add_step(scene *s, pkc_action *actions, size_t count) {
    CHECK_OK(pkc_allocate(s->cell, s->queue, actions, count));
    CHECK_OK(pkc_schedule_add_step(s->schedule, s->bin, s->queue, actions, count));
    CHECK_OK(pkc_step_apply(s->bin, s->queue, actions, count));
}

static char *saved(const pkc_cell *cell, size_t *size) {
    char *text;
    size_t written = 0;
    CHECK_FAILS(PKC_E_CAPACITY, NULL, pkc_cell_save(cell, NULL, 0, size));
    text = (char *)malloc(*size + 1);
    assert_non_null(text);
    CHECK_OK(pkc_cell_save(cell, text, *size, &written));
    assert_int_equal(written, *size);
    text[*size] = '\0';
    return text;
}

/* ---- Descriptions --------------------------------------------------------------------------- */

static void presets_are_listed_and_made(void **state) {
    size_t i;
    (void)state;
    for (i = 0; pkc_cell_preset(i) != NULL; ++i) {
        pkc_cell_info info;
        pkc_cell *cell = make_cell(pkc_cell_preset(i));
        CHECK_OK(pkc_cell_info_init(&info, sizeof info));
        CHECK_OK(pkc_cell_get_info(cell, &info));
        assert_string_equal(info.name, pkc_cell_preset(i));
        assert_int_equal(info.arms, 2);
        assert_true(info.margin > 0 && info.tick > 0 && info.cycle > 0);
        assert_true(info.bin_w >= 1 && info.bin_h >= 1 && info.buffer_slots[0] >= 1);
        assert_true(info.joints[0] == 6 || info.joints[0] == 4);
        pkc_cell_free(cell);
    }
    assert_int_equal(i, 4);
    assert_null(pkc_cell_preset(SIZE_MAX));
}

static void the_paper_s_cell_has_its_cycle(void **state) {
    pkc_cell *cell = make_cell("paper");
    pkc_cell_info info;
    (void)state;
    CHECK_OK(pkc_cell_info_init(&info, sizeof info));
    CHECK_OK(pkc_cell_get_info(cell, &info));
    assert_true(fabs(info.cycle - 15.5) < 1e-6);
    pkc_cell_free(cell);
}

static void a_description_gives_the_same_cell(void **state) {
    char folder[] = "/tmp/pkc_cell_XXXXXX";
    char path[64];
    size_t i;
    (void)state;
    assert_non_null(mkdtemp(folder));
    snprintf(path, sizeof path, "%s/cell.json", folder);
    for (i = 0; pkc_cell_preset(i) != NULL; ++i) {
        pkc_cell *cell = make_cell(pkc_cell_preset(i));
        pkc_cell *again = NULL;
        pkc_cell *from_file = NULL;
        size_t size = 0;
        size_t size_again = 0;
        char *text = saved(cell, &size);
        char *text_again;
        CHECK_OK(pkc_cell_load(text, size, &again));
        text_again = saved(again, &size_again);
        assert_int_equal(size_again, size);
        assert_memory_equal(text_again, text, size);
        free(text_again);
        CHECK_OK(pkc_cell_save_file(cell, path));
        CHECK_OK(pkc_cell_load_file(path, &from_file));
        text_again = saved(from_file, &size_again);
        assert_string_equal(text_again, text);
        free(text_again);
        free(text);
        pkc_cell_free(cell);
        pkc_cell_free(again);
        pkc_cell_free(from_file);
    }
    remove(path);
    rmdir(folder);
}

/* Puts `with` in place of the first `old` after `at` in a preset's description. */
static pkc_status load_changed(const char *preset, const char *at, const char *old,
                               const char *with, pkc_cell **out) {
    pkc_cell *cell = make_cell(preset);
    size_t size = 0;
    char *text = saved(cell, &size);
    char *changed = (char *)malloc(size + strlen(with) + 1);
    char *from = strstr(strstr(text, at), old);
    pkc_status status;
    assert_non_null(from);
    assert_non_null(changed);
    memcpy(changed, text, (size_t)(from - text));
    strcpy(changed + (from - text), with);
    strcat(changed, from + strlen(old));
    status = pkc_cell_load(changed, strlen(changed), out);
    free(changed);
    free(text);
    pkc_cell_free(cell);
    return status;
}

/* One for other scenarios than the cycle is of. */
static void a_cell_that_reaches_few_zones_has_no_cycle(void **state) {
    const pkc_scenario scenario = scenario_of("S-R1A1");
    pkc_cell *cell = NULL;
    pkc_cell_info info;
    (void)state;
    CHECK_OK(load_changed("ur5e", "\"belt\"", "[0.0, 0.44]", "[-0.9, 0.5]", &cell));
    CHECK_OK(pkc_cell_check(cell, &scenario));
    CHECK_OK(pkc_cell_info_init(&info, sizeof info));
    CHECK_OK(pkc_cell_get_info(cell, &info));
    assert_int_equal(info.arms, 2);
    assert_true(info.cycle == 0);
    pkc_cell_free(cell);
}

static void a_bad_description_is_told_by_field_and_value(void **state) {
    pkc_cell *cell = NULL;
    (void)state;
    CHECK_FAILS(PKC_E_FORMAT, "line 1", pkc_cell_load("{", 1, &cell));
    CHECK_FAILS(PKC_E_FORMAT, "cell", pkc_cell_load("[]", 2, &cell));
    CHECK_FAILS(PKC_E_FORMAT, NULL, pkc_cell_load("", 0, &cell));
    CHECK_FAILS(PKC_E_FORMAT, "size", pkc_cell_load("{}", PKC_MAX_CELL_BYTES + 1, &cell));
    CHECK_FAILS(PKC_E_FORMAT, "pace",
                load_changed("ur5e", "\"belt\"", "\"pitch\"", "\"pace\": 1, \"pitch\"", &cell));
    CHECK_FAILS(PKC_E_FORMAT, "belt.speed",
                load_changed("ur5e", "\"belt\"", "\"speed\"", "\"pace\"", &cell));
    CHECK_FAILS(PKC_E_FORMAT, NULL, load_changed("ur5e", "\"margin\"", "0.05", "NaN", &cell));
    CHECK_FAILS(PKC_E_FORMAT, "margin",
                load_changed("ur5e", "\"margin\"", "0.05", "\"wide\"", &cell));
    CHECK_FAILS(PKC_E_ARGUMENT, "belt.speed",
                load_changed("ur5e", "\"speed\"", ": 0.5", ": 0", &cell));
    CHECK_FAILS(PKC_E_ARGUMENT, "belt.speed",
                load_changed("ur5e", "\"speed\"", ": 0.5", ": -1", &cell));
    CHECK_FAILS(PKC_E_ARGUMENT, "margin", load_changed("ur5e", "\"margin\"", "0.05", "-1", &cell));
    CHECK_FAILS(PKC_E_ARGUMENT, NULL, load_changed("ur5e", "\"bin\"", "[0", "[9", &cell));
    CHECK_FAILS(PKC_E_IO, "none.json", pkc_cell_load_file("/nowhere/none.json", &cell));
    CHECK_FAILS(PKC_E_IO, NULL, pkc_cell_load_file("/", &cell));
    assert_null(cell);
}

static void saving_fails_cleanly(void **state) {
    pkc_cell *cell = make_cell("ur5e");
    char few[8] = "before";
    size_t size = 0;
    (void)state;
    CHECK_FAILS(PKC_E_ARGUMENT, "cell", pkc_cell_save(NULL, few, 8, &size));
    CHECK_FAILS(PKC_E_ARGUMENT, "out_size", pkc_cell_save(cell, few, 8, NULL));
    CHECK_FAILS(PKC_E_ARGUMENT, "json", pkc_cell_save(cell, NULL, 8, &size));
    CHECK_FAILS(PKC_E_CAPACITY, NULL, pkc_cell_save(cell, few, 8, &size));
    assert_string_equal(few, "before");
    assert_true(size > 8);
    CHECK_FAILS(PKC_E_ARGUMENT, NULL, pkc_cell_save_file(NULL, "x"));
    CHECK_FAILS(PKC_E_ARGUMENT, NULL, pkc_cell_save_file(cell, NULL));
    CHECK_FAILS(PKC_E_IO, NULL, pkc_cell_save_file(cell, "/nowhere/cell.json"));
    pkc_cell_free(cell);
}

static void cell_arguments_are_checked(void **state) {
    pkc_cell *cell = make_cell("ur5e");
    pkc_cell *none = NULL;
    pkc_cell_info info;
    pkc_layout_options options;
    pkc_layout_info layout;
    pkc_scenario scenario = scenario_of("D-R5A3O1");
    (void)state;
    CHECK_FAILS(PKC_E_ARGUMENT, "preset", pkc_cell_create(NULL, &none));
    CHECK_FAILS(PKC_E_ARGUMENT, "out_cell", pkc_cell_create("ur5e", NULL));
    CHECK_FAILS(PKC_E_ARGUMENT, "'ur6e'", pkc_cell_create("ur6e", &none));
    CHECK_FAILS(PKC_E_ARGUMENT, NULL, pkc_cell_create("", &none));
    CHECK_FAILS(PKC_E_ARGUMENT, NULL, pkc_cell_load(NULL, 0, &none));
    CHECK_FAILS(PKC_E_ARGUMENT, NULL, pkc_cell_load("{}", 2, NULL));
    CHECK_FAILS(PKC_E_ARGUMENT, NULL, pkc_cell_load_file(NULL, &none));
    CHECK_FAILS(PKC_E_ARGUMENT, NULL, pkc_cell_load_file("x", NULL));
    pkc_cell_free(NULL);
    assert_null(none);

    CHECK_FAILS(PKC_E_ARGUMENT, NULL, pkc_cell_info_init(NULL, sizeof info));
    CHECK_FAILS(PKC_E_STRUCT, NULL, pkc_cell_info_init(&info, 4));
    CHECK_OK(pkc_cell_info_init(&info, sizeof info));
    CHECK_FAILS(PKC_E_ARGUMENT, NULL, pkc_cell_get_info(NULL, &info));
    CHECK_FAILS(PKC_E_ARGUMENT, NULL, pkc_cell_get_info(cell, NULL));
    info.struct_size = 7;
    CHECK_FAILS(PKC_E_STRUCT, NULL, pkc_cell_get_info(cell, &info));

    CHECK_FAILS(PKC_E_ARGUMENT, NULL, pkc_cell_check(NULL, &scenario));
    CHECK_FAILS(PKC_E_ARGUMENT, NULL, pkc_cell_check(cell, NULL));
    CHECK_OK(pkc_cell_check(cell, &scenario));
    scenario.struct_size = 3;
    CHECK_FAILS(PKC_E_STRUCT, NULL, pkc_cell_check(cell, &scenario));
    scenario = scenario_of("S-R64A64");
    CHECK_FAILS(PKC_E_ARGUMENT, NULL, pkc_cell_check(cell, &scenario));
    scenario = scenario_of("D-R5A3O1");

    CHECK_FAILS(PKC_E_ARGUMENT, NULL, pkc_layout_options_init(NULL, sizeof options));
    CHECK_FAILS(PKC_E_STRUCT, NULL, pkc_layout_options_init(&options, 0));
    CHECK_FAILS(PKC_E_ARGUMENT, NULL, pkc_layout_info_init(NULL, sizeof layout));
    CHECK_FAILS(PKC_E_STRUCT, NULL, pkc_layout_info_init(&layout, 0));
    CHECK_OK(pkc_layout_options_init(&options, sizeof options));
    assert_int_equal(options.evaluations, 800);
    assert_true(options.range == 0.3);
    CHECK_FAILS(PKC_E_ARGUMENT, NULL,
                pkc_cell_optimize_layout(NULL, &scenario, &options, NULL, &none));
    CHECK_FAILS(PKC_E_ARGUMENT, NULL, pkc_cell_optimize_layout(cell, NULL, &options, NULL, &none));
    CHECK_FAILS(PKC_E_ARGUMENT, NULL,
                pkc_cell_optimize_layout(cell, &scenario, &options, NULL, NULL));
    options.evaluations = 9;
    CHECK_FAILS(PKC_E_ARGUMENT, "evaluations",
                pkc_cell_optimize_layout(cell, &scenario, &options, NULL, &none));
    options.evaluations = 20;
    options.range = NAN;
    CHECK_FAILS(PKC_E_ARGUMENT, "range",
                pkc_cell_optimize_layout(cell, &scenario, &options, NULL, &none));
    options.range = 0;
    CHECK_FAILS(PKC_E_ARGUMENT, "range 0: must be above 0, at most 2",
                pkc_cell_optimize_layout(cell, &scenario, &options, NULL, &none));
    options.range = 2.5;
    CHECK_FAILS(PKC_E_ARGUMENT, "range",
                pkc_cell_optimize_layout(cell, &scenario, &options, NULL, &none));
    options.range = 0.1;
    options.struct_size = 2;
    CHECK_FAILS(PKC_E_STRUCT, NULL,
                pkc_cell_optimize_layout(cell, &scenario, &options, NULL, &none));
    assert_null(none);
    pkc_cell_free(cell);
}

static void a_layout_is_never_worse_and_always_the_same(void **state) {
    pkc_cell *cell = make_cell("ur5e");
    const pkc_scenario scenario = scenario_of("D-R5A3O1");
    pkc_layout_options options;
    pkc_layout_info info;
    char *texts[2];
    size_t size = 0;
    int i;
    (void)state;
    CHECK_OK(pkc_layout_options_init(&options, sizeof options));
    CHECK_OK(pkc_layout_info_init(&info, sizeof info));
    options.evaluations = 20;
    for (i = 0; i < 2; ++i) {
        pkc_cell *better = NULL;
        CHECK_OK(pkc_cell_optimize_layout(cell, &scenario, &options, &info, &better));
        assert_true(info.after <= info.before && info.after > 0);
        assert_true(info.evaluations >= 1);
        CHECK_OK(pkc_cell_check(better, &scenario));
        texts[i] = saved(better, &size);
        pkc_cell_free(better);
    }
    assert_string_equal(texts[0], texts[1]);
    free(texts[0]);
    free(texts[1]);
    pkc_cell_free(cell);
}

/* ---- Kinematics ----------------------------------------------------------------------------- */

static void inverse_and_forward_agree(void **state) {
    size_t p;
    (void)state;
    for (p = 0; pkc_cell_preset(p) != NULL; ++p) {
        pkc_cell *cell = make_cell(pkc_cell_preset(p));
        int32_t arm;
        for (arm = 0; arm < 2; ++arm) {
            uint64_t seed = 5;
            int reached = 0;
            int i;
            for (i = 0; i < 2000; ++i) {
                const double pose[4] = {
                    check_draw(&seed, -900, 900) * 1e-3, check_draw(&seed, -900, 900) * 1e-3,
                    check_draw(&seed, 0, 100) * 1e-3, check_draw(&seed, -3000, 3000) * 1e-3};
                double joints[PKC_MAX_JOINTS];
                double back[4];
                const pkc_status status = pkc_cell_inverse(cell, arm, pose, joints);
                if (status != PKC_OK) {
                    assert_int_equal(status, PKC_E_STATE);
                    continue;
                }
                ++reached;
                CHECK_OK(pkc_cell_forward(cell, arm, joints, back));
                assert_true(fabs(back[0] - pose[0]) < 1e-9);
                assert_true(fabs(back[1] - pose[1]) < 1e-9);
                assert_true(fabs(back[2] - pose[2]) < 1e-9);
                assert_true(fabs(remainder(back[3] - pose[3], 6.283185307179586)) < 1e-9);
            }
            assert_true(reached > 100);
        }
        pkc_cell_free(cell);
    }
}

static void kinematics_arguments_are_checked(void **state) {
    pkc_cell *cell = make_cell("ur5e");
    double pose[4] = {0, 0, 0.1, 0};
    double joints[PKC_MAX_JOINTS] = {7, 7, 7, 7, 7, 7};
    (void)state;
    CHECK_FAILS(PKC_E_ARGUMENT, "cell", pkc_cell_inverse(NULL, 0, pose, joints));
    CHECK_FAILS(PKC_E_ARGUMENT, "arm", pkc_cell_inverse(cell, 2, pose, joints));
    CHECK_FAILS(PKC_E_ARGUMENT, "arm", pkc_cell_inverse(cell, -1, pose, joints));
    CHECK_FAILS(PKC_E_ARGUMENT, "pose", pkc_cell_inverse(cell, 0, NULL, joints));
    CHECK_FAILS(PKC_E_ARGUMENT, "joints", pkc_cell_inverse(cell, 0, pose, NULL));
    pose[3] = INFINITY;
    CHECK_FAILS(PKC_E_ARGUMENT, "pose", pkc_cell_inverse(cell, 0, pose, joints));
    pose[3] = 0;
    pose[0] = NAN;
    CHECK_FAILS(PKC_E_ARGUMENT, "pose", pkc_cell_inverse(cell, 0, pose, joints));
    pose[0] = 50;
    CHECK_FAILS(PKC_E_STATE, "pose", pkc_cell_inverse(cell, 0, pose, joints));
    assert_true(joints[0] == 7 && joints[5] == 7);
    pose[0] = 7;
    CHECK_FAILS(PKC_E_ARGUMENT, NULL, pkc_cell_forward(NULL, 0, joints, pose));
    CHECK_FAILS(PKC_E_ARGUMENT, "arm", pkc_cell_forward(cell, 5, joints, pose));
    CHECK_FAILS(PKC_E_ARGUMENT, NULL, pkc_cell_forward(cell, 0, NULL, pose));
    CHECK_FAILS(PKC_E_ARGUMENT, NULL, pkc_cell_forward(cell, 0, joints, NULL));
    joints[2] = NAN;
    CHECK_FAILS(PKC_E_ARGUMENT, "joints", pkc_cell_forward(cell, 0, joints, pose));
    assert_true(pose[0] == 7);
    pkc_cell_free(cell);
}

/* ---- Schedules ------------------------------------------------------------------------------ */

static void allocation_arguments_are_checked(void **state) {
    scene s = make_scene("ur5e", "D-R5A3O1", PKC_MODE_SYNC_PAPER);
    pkc_action a = action(PKC_OP_PACK, 0, 0, 0, 0, 0);
    (void)state;
    CHECK_FAILS(PKC_E_ARGUMENT, "cell", pkc_allocate(NULL, s.queue, &a, 1));
    CHECK_FAILS(PKC_E_ARGUMENT, "queue", pkc_allocate(s.cell, NULL, &a, 1));
    CHECK_FAILS(PKC_E_ARGUMENT, "actions", pkc_allocate(s.cell, s.queue, NULL, 1));
    CHECK_FAILS(PKC_E_LIMIT, "count", pkc_allocate(s.cell, s.queue, &a, PKC_MAX_ACTIONS + 1));
    CHECK_OK(pkc_allocate(s.cell, s.queue, NULL, 0));
    CHECK_OK(pkc_allocate(s.cell, s.queue, &a, 1));
    assert_in_range(a.arm, 0, 1);
    free_scene(&s);
}

static void schedule_arguments_are_checked(void **state) {
    scene s = make_scene("ur5e", "D-R5A3O1", PKC_MODE_COORDINATED);
    pkc_scenario scenario = scenario_of("D-R5A3O1");
    pkc_schedule *none = NULL;
    pkc_schedule_info info;
    pkc_arm_sample sample;
    pkc_action a = action(PKC_OP_PACK, 0, 0, 0, 0, 0);
    double makespan;
    (void)state;
    CHECK_FAILS(PKC_E_ARGUMENT, "cell", pkc_schedule_create(NULL, &scenario, 1, &none));
    CHECK_FAILS(PKC_E_ARGUMENT, "scenario", pkc_schedule_create(s.cell, NULL, 1, &none));
    CHECK_FAILS(PKC_E_ARGUMENT, "out_schedule", pkc_schedule_create(s.cell, &scenario, 1, NULL));
    CHECK_FAILS(PKC_E_ARGUMENT, "mode", pkc_schedule_create(s.cell, &scenario, 0, &none));
    CHECK_FAILS(PKC_E_ARGUMENT, "mode", pkc_schedule_create(s.cell, &scenario, 4, &none));
    scenario.robots = 3;
    CHECK_FAILS(PKC_E_ARGUMENT, "robots", pkc_schedule_create(s.cell, &scenario, 1, &none));
    pkc_schedule_free(NULL);
    assert_null(none);

    CHECK_FAILS(PKC_E_ARGUMENT, NULL, pkc_schedule_info_init(NULL, sizeof info));
    CHECK_FAILS(PKC_E_STRUCT, NULL, pkc_schedule_info_init(&info, 8));
    CHECK_OK(pkc_schedule_info_init(&info, sizeof info));
    CHECK_FAILS(PKC_E_ARGUMENT, NULL, pkc_schedule_get_info(NULL, &info));
    CHECK_FAILS(PKC_E_ARGUMENT, NULL, pkc_schedule_get_info(s.schedule, NULL));
    info.struct_size = 8;
    CHECK_FAILS(PKC_E_STRUCT, NULL, pkc_schedule_get_info(s.schedule, &info));

    /* Nothing is in it yet. */
    info = info_of(s.schedule);
    assert_int_equal(info.steps, 0);
    assert_true(info.makespan == 0);
    CHECK_OK(pkc_schedule_sample(s.schedule, 0, 0, &sample));
    assert_int_equal(sample.activity, PKC_ACTIVITY_WAIT);

    CHECK_FAILS(PKC_E_ARGUMENT, NULL, pkc_schedule_add_step(NULL, s.bin, s.queue, &a, 1));
    CHECK_FAILS(PKC_E_ARGUMENT, NULL, pkc_schedule_add_step(s.schedule, NULL, s.queue, &a, 1));
    CHECK_FAILS(PKC_E_ARGUMENT, NULL, pkc_schedule_add_step(s.schedule, s.bin, NULL, &a, 1));
    CHECK_FAILS(PKC_E_ARGUMENT, NULL, pkc_schedule_add_step(s.schedule, s.bin, s.queue, NULL, 1));
    CHECK_FAILS(PKC_E_LIMIT, NULL,
                pkc_schedule_add_step(s.schedule, s.bin, s.queue, &a, PKC_MAX_ACTIONS + 1));

    add_step(&s, &a, 1);
    makespan = info_of(s.schedule).makespan;
    assert_true(makespan > 0);
    CHECK_FAILS(PKC_E_ARGUMENT, NULL, pkc_schedule_sample(NULL, 0, 0, &sample));
    CHECK_FAILS(PKC_E_ARGUMENT, NULL, pkc_schedule_sample(s.schedule, 0, 0, NULL));
    CHECK_FAILS(PKC_E_ARGUMENT, "arm", pkc_schedule_sample(s.schedule, 2, 0, &sample));
    CHECK_FAILS(PKC_E_ARGUMENT, "arm", pkc_schedule_sample(s.schedule, -1, 0, &sample));
    CHECK_FAILS(PKC_E_ARGUMENT, "time", pkc_schedule_sample(s.schedule, 0, -1e-9, &sample));
    CHECK_FAILS(PKC_E_ARGUMENT, "time", pkc_schedule_sample(s.schedule, 0, NAN, &sample));
    CHECK_FAILS(PKC_E_ARGUMENT, "time",
                pkc_schedule_sample(s.schedule, 0, makespan * 1.001, &sample));
    CHECK_FAILS(PKC_E_ARGUMENT, "time", pkc_schedule_sample(s.schedule, 0, INFINITY, &sample));
    free_scene(&s);
}

/* What is refused leaves the schedule as it was, and what comes afterwards is as if nothing had
 * been tried. */
static void a_step_that_is_refused_changes_nothing(void **state) {
    scene s = make_scene("ur5e", "D-R5A3O1", PKC_MODE_COORDINATED);
    scene plain = make_scene("ur5e", "D-R5A3O1", PKC_MODE_COORDINATED);
    pkc_bin *wide = check_bin(11, 10);
    pkc_queue *other = check_queue("D-R6A3O1");
    pkc_action first = action(PKC_OP_PACK, 0, 0, 0, 0, 0);
    pkc_action second = action(PKC_OP_PACK, 1, 3, 0, 0, 0);
    pkc_action bad[7];
    pkc_schedule_info before;
    size_t i;
    (void)state;
    check_push(other, 0, 3, 2);
    add_step(&s, &first, 1);
    add_step(&plain, &first, 1);
    before = info_of(s.schedule);
    CHECK_FAILS(PKC_E_ARGUMENT, "bin 11 x 10",
                pkc_schedule_add_step(s.schedule, wide, s.queue, &second, 1));
    CHECK_FAILS(PKC_E_ARGUMENT, "scenario",
                pkc_schedule_add_step(s.schedule, s.bin, other, &first, 1));
    bad[0] = action(PKC_OP_PACK, 1, 1, 1, 0, 0);   /* on another item */
    bad[1] = action(PKC_OP_PACK, 77, 5, 5, 0, 0);  /* unknown */
    bad[2] = action(PKC_OP_PACK, 1, 9, 9, 0, 0);   /* outside */
    bad[3] = action(PKC_OP_PACK, 1, 3, 0, 2, 0);   /* turned by half a turn */
    bad[4] = action(PKC_OP_PACK, 1, 3, 0, 0, 2);   /* no such arm */
    bad[5] = action(PKC_OP_UNPACK, 3, 0, 0, 0, 0); /* not in the bin */
    bad[6] = action(99, 1, 0, 0, 0, 0);
    for (i = 0; i < 7; ++i) {
        pkc_schedule_info after;
        const pkc_status status = pkc_schedule_add_step(s.schedule, s.bin, s.queue, &bad[i], 1);
        if (status != PKC_E_STATE && status != PKC_E_ARGUMENT) {
            print_error("bad step %d: %s\n", (int)i, pkc_status_name(status));
            fail();
        }
        after = info_of(s.schedule);
        assert_true(after.hash == before.hash && after.steps == before.steps);
        assert_true(after.makespan == before.makespan && after.released == before.released);
    }
    add_step(&s, &second, 1);
    second = action(PKC_OP_PACK, 1, 3, 0, 0, 0);
    add_step(&plain, &second, 1);
    assert_true(info_of(s.schedule).hash == info_of(plain.schedule).hash);
    assert_true(info_of(s.schedule).hash != before.hash);
    pkc_bin_free(wide);
    pkc_queue_free(other);
    free_scene(&s);
    free_scene(&plain);
}

/* Time at which an arm lets an item go: the end of its release. */
static double release_of(const pkc_schedule *schedule, int32_t arm, int32_t item) {
    const double makespan = info_of(schedule).makespan;
    pkc_simulation *simulation = NULL;
    pkc_place places[16];
    size_t count = 0;
    size_t i;
    CHECK_OK(pkc_simulate(schedule, NULL, &simulation));
    CHECK_OK(pkc_simulation_places(simulation, places, 16, &count));
    pkc_simulation_free(simulation);
    for (i = 0; i < count; ++i) {
        if (places[i].item == item && places[i].arm == arm) {
            assert_true(places[i].time > 0 && places[i].time < makespan);
            return places[i].time;
        }
    }
    fail();
    return 0;
}

static void an_item_is_put_aside_where_it_is_let_go(void **state) {
    scene s = make_scene("ur5e", "S-R5A3", PKC_MODE_COORDINATED);
    pkc_action first = action(PKC_OP_PACK, 0, 0, 0, 0, 0);
    pkc_action again;
    pkc_schedule_info before;
    double time;
    (void)state;
    add_step(&s, &first, 1);
    before = info_of(s.schedule);
    time = release_of(s.schedule, 0, 0);
    CHECK_FAILS(PKC_E_ARGUMENT, NULL, pkc_schedule_put_aside(NULL, 0, time));
    CHECK_FAILS(PKC_E_ARGUMENT, "time", pkc_schedule_put_aside(s.schedule, 0, NAN));
    CHECK_FAILS(PKC_E_ARGUMENT, "time", pkc_schedule_put_aside(s.schedule, 0, -1));
    CHECK_FAILS(PKC_E_STATE, "item 0", pkc_schedule_put_aside(s.schedule, 0, time + 0.01));
    CHECK_FAILS(PKC_E_STATE, "item 0", pkc_schedule_put_aside(s.schedule, 0, 0));
    CHECK_FAILS(PKC_E_STATE, "item 1", pkc_schedule_put_aside(s.schedule, 1, time));
    CHECK_FAILS(PKC_E_STATE, "item -1", pkc_schedule_put_aside(s.schedule, -1, time));
    assert_true(info_of(s.schedule).hash == before.hash);
    CHECK_OK(pkc_schedule_put_aside(s.schedule, 0, time));
    assert_true(info_of(s.schedule).hash != before.hash);
    assert_true(info_of(s.schedule).makespan > before.makespan);
    /* To what comes next it is an unpacked item. */
    again = action(PKC_OP_UNPACK, 0, 0, 0, 0, 0);
    CHECK_OK(pkc_step_apply(s.bin, s.queue, &again, 1));
    again = action(PKC_OP_PACK, 0, 5, 5, 0, 0);
    CHECK_OK(pkc_schedule_add_step(s.schedule, s.bin, s.queue, &again, 1));
    free_scene(&s);
}

static void a_sample_is_whole_at_both_ends(void **state) {
    scene s = make_scene("paper", "D-R5A3O1", PKC_MODE_COORDINATED);
    pkc_action first = action(PKC_OP_PACK, 0, 0, 0, 0, 0);
    pkc_schedule_info info;
    int32_t arm;
    (void)state;
    add_step(&s, &first, 1);
    info = info_of(s.schedule);
    for (arm = 0; arm < 2; ++arm) {
        pkc_arm_sample ends[2];
        double joints[4];
        int e;
        CHECK_OK(pkc_schedule_sample(s.schedule, arm, 0, &ends[0]));
        CHECK_OK(pkc_schedule_sample(s.schedule, arm, info.makespan, &ends[1]));
        for (e = 0; e < 2; ++e) {
            double pose[4];
            int i;
            CHECK_OK(pkc_cell_forward(s.cell, arm, ends[e].position, pose));
            for (i = 0; i < 3; ++i) assert_true(fabs(pose[i] - ends[e].tool[i]) < 1e-9);
            for (i = 0; i < 6; ++i) assert_true(fabs(ends[e].velocity[i]) < 1e-9);
            assert_true(ends[e].held == 0);
        }
        memcpy(joints, ends[0].tool, sizeof joints);
        assert_true(fabs(joints[0] - ends[1].tool[0]) < 1e-9);
        assert_true(fabs(joints[1] - ends[1].tool[1]) < 1e-9);
    }
    free_scene(&s);
}

static void equal_work_gives_equal_schedules(void **state) {
    int32_t mode;
    (void)state;
    for (mode = PKC_MODE_SYNC_PAPER; mode <= PKC_MODE_COORDINATED; ++mode) {
        scene a = make_scene("ur5e", "D-R5A3O1", mode);
        scene b = make_scene("ur5e", "D-R5A3O1", mode);
        pkc_schedule_info info_a;
        pkc_schedule_info info_b;
        pkc_action first = action(PKC_OP_PACK, 0, 0, 0, 0, 0);
        add_step(&a, &first, 1);
        add_step(&b, &first, 1);
        info_a = info_of(a.schedule);
        info_b = info_of(b.schedule);
        assert_true(info_a.hash == info_b.hash && info_a.nodes == info_b.nodes);
        assert_true(info_a.makespan == info_b.makespan);
        assert_int_equal(info_a.mode, mode);
        assert_true(info_a.makespan >= info_a.lower_bound - 1e-9);
        free_scene(&a);
        free_scene(&b);
    }
}

static void a_full_buffer_is_told(void **state) {
    /* One arm unpacks more than its buffer holds. */
    scene s = make_scene("piper", "S-R5A3", PKC_MODE_SYNC_PAPER);
    pkc_action unpack[8];
    pkc_schedule_info before;
    int32_t i;
    (void)state;
    for (i = 0; i < 8; ++i) {
        const pkc_item item = check_item(100 + i, 1, 1, 0);
        CHECK_OK(pkc_bin_pack(s.bin, &item, i, 7, 0));
        unpack[i] = action(PKC_OP_UNPACK, 100 + i, 0, 0, 0, 0);
    }
    before = info_of(s.schedule);
    CHECK_FAILS(PKC_E_LIMIT, NULL, pkc_schedule_add_step(s.schedule, s.bin, s.queue, unpack, 8));
    assert_true(info_of(s.schedule).hash == before.hash);
    free_scene(&s);
}

/* ---- Simulation ----------------------------------------------------------------------------- */

static pkc_simulation_info simulated(const pkc_schedule *schedule,
                                     const pkc_simulation_options *options) {
    pkc_simulation *simulation = NULL;
    pkc_simulation_info info;
    CHECK_OK(pkc_simulate(schedule, options, &simulation));
    CHECK_OK(pkc_simulation_info_init(&info, sizeof info));
    CHECK_OK(pkc_simulation_get_info(simulation, &info));
    pkc_simulation_free(simulation);
    return info;
}

/* It is refused before memory is taken for it; a shorter one is not. */
static void a_step_of_too_many_ticks_is_told(void **state) {
    static pkc_action step[PKC_MAX_ACTIONS];
    const pkc_scenario scenario = scenario_of("S-R1A1");
    pkc_cell *cell = NULL;
    pkc_schedule *schedule = NULL;
    pkc_schedule_info info;
    scene s = make_scene("ur5e", "S-R1A1", PKC_MODE_COORDINATED);
    int32_t i;
    (void)state;
    check_pack(s.bin, 9, 2, 2, 0, 0);
    for (i = 0; i < PKC_MAX_ACTIONS; i += 2) {
        step[i] = action(PKC_OP_UNPACK, 9, 0, 0, 0, 0);
        step[i + 1] = action(PKC_OP_PACK, 9, i % 8, 0, 0, 0);
    }
    CHECK_OK(load_changed("ur5e", "\"tick\"", "0.04", "0.001", &cell));
    CHECK_OK(pkc_schedule_create(cell, &scenario, PKC_MODE_COORDINATED, &schedule));
    CHECK_FAILS(PKC_E_LIMIT, "ticks: must be at most 1048576",
                pkc_schedule_add_step(schedule, s.bin, s.queue, step, PKC_MAX_ACTIONS));
    CHECK_OK(pkc_schedule_info_init(&info, sizeof info));
    CHECK_OK(pkc_schedule_get_info(schedule, &info));
    assert_int_equal(info.steps, 0);
    CHECK_OK(pkc_schedule_add_step(schedule, s.bin, s.queue, step, 2));
    pkc_schedule_free(schedule);
    pkc_cell_free(cell);
    free_scene(&s);
}

static void simulation_arguments_are_checked(void **state) {
    scene s = make_scene("ur5e", "S-R5A3", PKC_MODE_COORDINATED);
    pkc_action first = action(PKC_OP_PACK, 0, 0, 0, 0, 0);
    pkc_simulation_options options;
    pkc_simulation_info info;
    pkc_simulation *simulation = NULL;
    pkc_place places[4];
    size_t count = 9;
    (void)state;
    add_step(&s, &first, 1);
    CHECK_FAILS(PKC_E_ARGUMENT, NULL, pkc_simulation_options_init(NULL, sizeof options));
    CHECK_FAILS(PKC_E_STRUCT, NULL, pkc_simulation_options_init(&options, 4));
    CHECK_OK(pkc_simulation_options_init(&options, sizeof options));
    assert_int_equal(options.hertz, 240);
    CHECK_FAILS(PKC_E_ARGUMENT, NULL, pkc_simulate(NULL, &options, &simulation));
    CHECK_FAILS(PKC_E_ARGUMENT, NULL, pkc_simulate(s.schedule, &options, NULL));
#define REFUSED(field, value)                                                             \
    do {                                                                                  \
        pkc_simulation_options bad = options;                                             \
        bad.field = (value);                                                              \
        CHECK_FAILS(PKC_E_ARGUMENT, #field, pkc_simulate(s.schedule, &bad, &simulation)); \
    } while (0)
    REFUSED(hertz, 59);
    REFUSED(hertz, 1001);
    REFUSED(hertz, -240);
    REFUSED(sigma, -1e-9);
    REFUSED(sigma, 0.051);
    REFUSED(sigma, NAN);
    REFUSED(sigma, INFINITY);
    REFUSED(sigma_yaw, -1e-9);
    REFUSED(sigma_yaw, 0.51);
    REFUSED(sigma_yaw, NAN);
    REFUSED(frames, 2);
    REFUSED(reserved, 1);
#undef REFUSED
    options.struct_size = 12;
    CHECK_FAILS(PKC_E_STRUCT, NULL, pkc_simulate(s.schedule, &options, &simulation));
    assert_null(simulation);
    pkc_simulation_free(NULL);

    CHECK_OK(pkc_simulate(s.schedule, NULL, &simulation));
    CHECK_FAILS(PKC_E_ARGUMENT, NULL, pkc_simulation_info_init(NULL, sizeof info));
    CHECK_FAILS(PKC_E_STRUCT, NULL, pkc_simulation_info_init(&info, 4));
    CHECK_OK(pkc_simulation_info_init(&info, sizeof info));
    CHECK_FAILS(PKC_E_ARGUMENT, NULL, pkc_simulation_get_info(NULL, &info));
    CHECK_FAILS(PKC_E_ARGUMENT, NULL, pkc_simulation_get_info(simulation, NULL));
    info.struct_size = 5;
    CHECK_FAILS(PKC_E_STRUCT, NULL, pkc_simulation_get_info(simulation, &info));
    CHECK_FAILS(PKC_E_ARGUMENT, NULL, pkc_simulation_places(NULL, places, 4, &count));
    CHECK_FAILS(PKC_E_ARGUMENT, NULL, pkc_simulation_places(simulation, places, 4, NULL));
    CHECK_FAILS(PKC_E_ARGUMENT, NULL, pkc_simulation_places(simulation, NULL, 4, &count));
    assert_int_equal(count, 9);
    CHECK_FAILS(PKC_E_CAPACITY, NULL, pkc_simulation_places(simulation, NULL, 0, &count));
    assert_int_equal(count, 1);
    count = 9;
    CHECK_OK(pkc_simulation_places(simulation, places, 4, &count));
    assert_int_equal(count, 1);
    assert_int_equal(places[0].item, 0);
    assert_int_equal(places[0].outcome, PKC_PLACE_OK);
    pkc_simulation_free(simulation);
    free_scene(&s);
}

static void a_schedule_without_steps_can_be_run(void **state) {
    scene s = make_scene("ur5e", "D-R5A3O1", PKC_MODE_COORDINATED);
    const pkc_simulation_info info = simulated(s.schedule, NULL);
    (void)state;
    assert_int_equal(info.places, 0);
    free_scene(&s);
}

typedef struct run {
    const pkc_schedule *schedule;
    pkc_simulation_options options;
    pkc_simulation_info info;
} run;

static void *run_in_thread(void *given) {
    run *r = (run *)given;
    scene s = make_scene("ur5e", "D-R5A3O1", PKC_MODE_COORDINATED);
    pkc_action first = action(PKC_OP_PACK, 0, 0, 0, 0, 0);
    add_step(&s, &first, 1);
    r->info = simulated(s.schedule, &r->options);
    free_scene(&s);
    return NULL;
}

static void equal_runs_end_alike_on_any_thread(void **state) {
    scene s = make_scene("ur5e", "D-R5A3O1", PKC_MODE_COORDINATED);
    pkc_action first = action(PKC_OP_PACK, 0, 0, 0, 0, 0);
    pkc_simulation_options options;
    pkc_simulation_info once;
    pthread_t threads[2];
    run runs[2];
    int i;
    (void)state;
    add_step(&s, &first, 1);
    CHECK_OK(pkc_simulation_options_init(&options, sizeof options));
    options.sigma = 0.0003;
    options.sigma_yaw = 0.003;
    once = simulated(s.schedule, &options);
    assert_true(simulated(s.schedule, &options).hash == once.hash);
    for (i = 0; i < 2; ++i) {
        runs[i].options = options;
        assert_int_equal(pthread_create(&threads[i], NULL, run_in_thread, &runs[i]), 0);
    }
    for (i = 0; i < 2; ++i) {
        assert_int_equal(pthread_join(threads[i], NULL), 0);
        assert_true(runs[i].info.hash == once.hash);
    }
    options.seed = 77;
    assert_true(simulated(s.schedule, &options).hash != once.hash);
    free_scene(&s);
}

static void without_noise_items_lie_where_they_should(void **state) {
    scene s = make_scene("piper", "D-R5A3O1", PKC_MODE_COORDINATED);
    pkc_action first = action(PKC_OP_PACK, 0, 0, 0, 0, 0);
    pkc_simulation_info info;
    (void)state;
    add_step(&s, &first, 1);
    info = simulated(s.schedule, NULL);
    assert_int_equal(info.places, 1);
    assert_int_equal(info.jams + info.misplaced, 0);
    assert_true(info.worst_error <= 1e-4);
    assert_int_equal(info.missed, 0);
    assert_true(info.seconds >= info_of(s.schedule).makespan && info.steps > 0);
    free_scene(&s);
}

/* ---- Traces --------------------------------------------------------------------------------- */

static void traces_are_written_whole_or_not_at_all(void **state) {
    scene s = make_scene("ur5e", "D-R5A3O1", PKC_MODE_COORDINATED);
    pkc_action first = action(PKC_OP_PACK, 0, 0, 0, 0, 0);
    /* Refused where they matter, ignored elsewhere. */
    const double wrong_periods[] = {NAN, 0.00005, 0, 11};
    char folder[] = "/tmp/pkc_trace_XXXXXX";
    char path[64];
    pkc_simulation_options options;
    pkc_simulation *simulation = NULL;
    struct stat found;
    int32_t kind;
    size_t i;
    (void)state;
    add_step(&s, &first, 1);
    CHECK_OK(pkc_simulation_options_init(&options, sizeof options));
    options.frames = 1;
    CHECK_OK(pkc_simulate(s.schedule, &options, &simulation));
    assert_non_null(mkdtemp(folder));
    snprintf(path, sizeof path, "%s/trace", folder);
    for (kind = PKC_TRACE_CHROME; kind <= PKC_TRACE_REPLAY; ++kind) {
        CHECK_OK(pkc_trace_write_file(s.schedule, NULL, kind, 0.05, path));
        assert_int_equal(stat(path, &found), 0);
        assert_true(found.st_size > 100);
        CHECK_OK(pkc_trace_write_file(s.schedule, simulation, kind, 0.05, path));
        assert_int_equal(stat(path, &found), 0);
        assert_true(found.st_size > 100);
        assert_int_equal(remove(path), 0);
        CHECK_FAILS(PKC_E_IO, NULL,
                    pkc_trace_write_file(s.schedule, NULL, kind, 0.05, "/nowhere/trace"));
        CHECK_FAILS(PKC_E_IO, NULL, pkc_trace_write_file(s.schedule, NULL, kind, 0.05, folder));
        /* Nothing is left of what failed. */
        CHECK_FAILS(PKC_E_ARGUMENT, NULL, pkc_trace_write_file(NULL, NULL, kind, 0.05, path));
        CHECK_FAILS(PKC_E_ARGUMENT, NULL, pkc_trace_write_file(s.schedule, NULL, kind, 0.05, NULL));
        for (i = 0; i < sizeof wrong_periods / sizeof wrong_periods[0]; ++i) {
            if (kind == PKC_TRACE_CHROME || kind == PKC_TRACE_GANTT || kind == PKC_TRACE_REPLAY) {
                CHECK_OK(pkc_trace_write_file(s.schedule, NULL, kind, wrong_periods[i], path));
                assert_int_equal(remove(path), 0);
            } else {
                CHECK_FAILS(PKC_E_ARGUMENT, "period",
                            pkc_trace_write_file(s.schedule, NULL, kind, wrong_periods[i], path));
            }
        }
        assert_int_not_equal(stat(path, &found), 0);
    }
    CHECK_FAILS(PKC_E_ARGUMENT, "kind", pkc_trace_write_file(s.schedule, NULL, 0, 0.05, path));
    CHECK_FAILS(PKC_E_ARGUMENT, "kind", pkc_trace_write_file(s.schedule, NULL, 7, 0.05, path));
    /* The folder is empty again, or this fails. */
    assert_int_equal(rmdir(folder), 0);
    pkc_simulation_free(simulation);
    free_scene(&s);
}

static void one_arm_has_no_second_lane(void **state) {
    scene s = make_scene("ur5e", "S-R5A3", PKC_MODE_COORDINATED);
    pkc_action first = action(PKC_OP_PACK, 0, 0, 0, 0, 0);
    pkc_arm_sample sample;
    (void)state;
    add_step(&s, &first, 1);
    CHECK_FAILS(PKC_E_ARGUMENT, "kind",
                pkc_trace_write_file(s.schedule, NULL, PKC_TRACE_JOINTS_1, 0.1, "/tmp/none"));
    CHECK_FAILS(PKC_E_ARGUMENT, "arm", pkc_schedule_sample(s.schedule, 1, 0, &sample));
    assert_true(info_of(s.schedule).min_clearance == -1);
    free_scene(&s);
}

/* ---- Allocations that fail ------------------------------------------------------------------ */

/* Not of pkc_cell_load and pkc_cell_save: the JSON library's destructor allocates, and ends the
 * process where it gets nothing. */
static scene given;

static pkc_status try_create(void) {
    pkc_cell *cell = NULL;
    const pkc_status status = pkc_cell_create("ur5e", &cell);
    pkc_cell_free(cell);
    return status;
}

static pkc_status try_schedule(void) {
    const pkc_scenario scenario = {sizeof scenario, 2, 5, 3, 1};
    const pkc_action first = action(PKC_OP_PACK, 0, 0, 0, 0, 0);
    pkc_schedule *schedule = NULL;
    pkc_status status = pkc_schedule_create(given.cell, &scenario, PKC_MODE_COORDINATED, &schedule);
    if (status == PKC_OK)
        status = pkc_schedule_add_step(schedule, given.bin, given.queue, &first, 1);
    pkc_schedule_free(schedule);
    return status;
}

static void an_allocation_that_fails_is_told_and_leaks_nothing(void **state) {
    static const struct {
        const char *name;
        pkc_status (*call)(void);
        uint64_t stride; /* of many allocations every so many is tried */
    } calls[] = {{"cell_create", try_create, 1}, {"schedule", try_schedule, 97}};
    size_t c;
    pkc_action first = action(PKC_OP_PACK, 0, 0, 0, 0, 0);
    (void)state;
    if (check_watched()) skip();
    given = make_scene("ur5e", "D-R5A3O1", PKC_MODE_COORDINATED);
    CHECK_OK(pkc_allocate(given.cell, given.queue, &first, 1));
    for (c = 0; c < sizeof calls / sizeof calls[0]; ++c) {
        uint64_t n;
        int failures = 0;
        assert_int_equal(calls[c].call(), PKC_OK); /* what is set up once is there */
        for (n = 1;; n += calls[c].stride) {
            const int64_t live = count_malloc_live;
            pkc_status status;
            uint64_t left;
            count_malloc_fail_at = n;
            status = calls[c].call();
            left = count_malloc_fail_at;
            count_malloc_fail_at = 0;
            if (count_malloc_live > live && status != PKC_OK) {
                print_error("%s: allocation %d fails: %d blocks leaked\n", calls[c].name, (int)n,
                            (int)(count_malloc_live - live));
                fail();
            }
            if (status == PKC_OK) {
                if (left != 0) break;
                continue;
            }
            ++failures;
            if (status != PKC_E_MEMORY) {
                print_error("%s: allocation %d fails: %s: %s\n", calls[c].name, (int)n,
                            pkc_status_name(status), pkc_last_error());
                fail();
            }
        }
        assert_true(failures > 0);
    }
    free_scene(&given);
}

/* What was added before stays, and the step can be added again. */
static void a_step_for_which_memory_ends_changes_nothing(void **state) {
    int32_t mode;
    (void)state;
    if (check_watched()) skip();
    for (mode = PKC_MODE_SYNC_PAPER; mode <= PKC_MODE_COORDINATED; ++mode) {
        scene s = make_scene("ur5e", "D-R5A3O1", mode);
        pkc_action first = action(PKC_OP_PACK, 0, 0, 0, 0, 0);
        pkc_action second = action(PKC_OP_PACK, 1, 4, 4, 0, 0);
        pkc_schedule_info before;
        pkc_schedule_info after;
        pkc_status status = PKC_E_MEMORY;
        uint64_t n;
        add_step(&s, &first, 1);
        CHECK_OK(pkc_schedule_info_init(&before, sizeof before));
        CHECK_OK(pkc_schedule_info_init(&after, sizeof after));
        CHECK_OK(pkc_schedule_get_info(s.schedule, &before));
        for (n = 1; status != PKC_OK; n += 7) {
            count_malloc_fail_at = n;
            status = pkc_schedule_add_step(s.schedule, s.bin, s.queue, &second, 1);
            count_malloc_fail_at = 0;
            CHECK_OK(pkc_schedule_get_info(s.schedule, &after));
            assert_int_equal(after.steps, status == PKC_OK ? 2 : 1);
            if (status == PKC_OK) continue;
            assert_int_equal(status, PKC_E_MEMORY);
            assert_true(after.hash == before.hash);
        }
        assert_true(n > 8);
        free_scene(&s);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(presets_are_listed_and_made),
        cmocka_unit_test(the_paper_s_cell_has_its_cycle),
        cmocka_unit_test(a_description_gives_the_same_cell),
        cmocka_unit_test(a_cell_that_reaches_few_zones_has_no_cycle),
        cmocka_unit_test(a_bad_description_is_told_by_field_and_value),
        cmocka_unit_test(saving_fails_cleanly),
        cmocka_unit_test(cell_arguments_are_checked),
        cmocka_unit_test(a_layout_is_never_worse_and_always_the_same),
        cmocka_unit_test(inverse_and_forward_agree),
        cmocka_unit_test(kinematics_arguments_are_checked),
        cmocka_unit_test(allocation_arguments_are_checked),
        cmocka_unit_test(schedule_arguments_are_checked),
        cmocka_unit_test(a_step_that_is_refused_changes_nothing),
        cmocka_unit_test(an_item_is_put_aside_where_it_is_let_go),
        cmocka_unit_test(a_sample_is_whole_at_both_ends),
        cmocka_unit_test(equal_work_gives_equal_schedules),
        cmocka_unit_test(a_full_buffer_is_told),
        cmocka_unit_test(a_step_of_too_many_ticks_is_told),
        cmocka_unit_test(simulation_arguments_are_checked),
        cmocka_unit_test(a_schedule_without_steps_can_be_run),
        cmocka_unit_test(equal_runs_end_alike_on_any_thread),
        cmocka_unit_test(without_noise_items_lie_where_they_should),
        cmocka_unit_test(traces_are_written_whole_or_not_at_all),
        cmocka_unit_test(one_arm_has_no_second_lane),
        cmocka_unit_test(an_allocation_that_fails_is_told_and_leaks_nothing),
        cmocka_unit_test(a_step_for_which_memory_ends_changes_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
