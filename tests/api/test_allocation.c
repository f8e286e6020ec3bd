/* Planning takes no memory from the heap, and a call that gets none fails cleanly. */
#define _GNU_SOURCE
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "check.h"
#include "count_malloc.h"

static const char *const scenarios[] = {"S-R1A1",   "S-R5A1",   "S-R5A3",
                                        "D-R2A2O2", "D-R5A2O2", "D-R5A3O1"};

static void the_counter_counts_what_the_library_allocates(void **state) {
    uint64_t calls;
    int64_t live;
    pkc_bin *bin;
    (void)state;
    if (check_watched()) skip();
    calls = count_malloc_calls;
    live = count_malloc_live;
    bin = check_bin(4, 4);
    assert_true(count_malloc_calls > calls);
    assert_true(count_malloc_live > live);
    pkc_bin_free(bin);
    assert_int_equal(count_malloc_live, live);
}

/* One step: planned in one go and again in slices; false at the end of the bin. */
static int step(pkc_planner *planner, pkc_bin *bin, pkc_queue *queue, uint64_t nodes) {
    static pkc_action actions[1024];
    const pkc_budget budget = check_budget(nodes);
    pkc_plan_info info = check_plan_info();
    const uint64_t before = count_malloc_calls;
    size_t count = 0;
    int32_t done = 0;
    CHECK_OK(pkc_planner_plan(planner, bin, queue, &budget, &info));
    assert_int_equal(count_malloc_calls, before);
    CHECK_OK(pkc_planner_begin(planner, bin, queue, &budget));
    while (!done) {
        CHECK_OK(pkc_planner_step(planner, 50, &done));
        if (!done) CHECK_OK(pkc_planner_result(planner, &info, actions, 1024, &count));
    }
    CHECK_OK(pkc_planner_result(planner, &info, actions, 1024, &count));
    assert_int_equal(count_malloc_calls, before);
    CHECK_OK(pkc_step_apply(bin, queue, actions, count));
    return info.terminate == 0;
}

static void plan_whole_streams(int32_t w, int32_t h, int32_t buffer, int bins) {
    uint64_t seed = 21;
    int32_t method;
    int32_t repack;
    size_t s;
    for (method = 1; method <= 2; ++method) {
        for (repack = 0; repack <= 2; ++repack) {
            for (s = 0; s < 6; ++s) {
                pkc_planner_options options = check_options();
                pkc_planner *planner = NULL;
                pkc_bin *bin = check_bin(w, h);
                pkc_queue *queue = check_queue(scenarios[s]);
                int32_t id = 0;
                int closed = 0;
                options.method = method;
                options.repack = repack;
                options.rotation = (int32_t)(s & 1);
                options.buffer_capacity = buffer;
                options.max_side = w;
                options.max_items = w * h;
                options.memory = 65536;
                CHECK_OK(pkc_planner_create(&options, NULL, &planner));
                while (closed < bins) {
                    pkc_queue_info info;
                    CHECK_OK(pkc_queue_info_init(&info, sizeof info));
                    CHECK_OK(pkc_queue_get_info(queue, &info));
                    for (; info.belt < 12; ++info.belt)
                        check_push(queue, id++, check_draw(&seed, 1, 5), check_draw(&seed, 1, 4));
                    if (step(planner, bin, queue, 400)) continue;
                    CHECK_OK(pkc_bin_clear(bin));
                    ++closed;
                }
                pkc_planner_free(planner);
                pkc_bin_free(bin);
                pkc_queue_free(queue);
            }
        }
    }
}

static void planning_allocates_nothing_over_whole_streams(void **state) {
    (void)state;
    if (check_watched()) skip();
    plan_whole_streams(9, 8, PKC_UNLIMITED, check_count(3, 30));
}

/* The default policy looks at bins of this size by its tables, and judges by their values. */
static void planning_with_the_default_policy_s_tables_allocates_nothing(void **state) {
    (void)state;
    if (check_watched()) skip();
    plan_whole_streams(10, 10, PKC_UNLIMITED, check_count(2, 30));
}

/* Items make detours through the bin there. */
static void planning_with_small_buffers_allocates_nothing(void **state) {
    int32_t buffer;
    (void)state;
    if (check_watched()) skip();
    for (buffer = 0; buffer <= 1; ++buffer) plan_whole_streams(7, 7, buffer, check_count(3, 30));
}

/* The limits themselves, not only what is far from them. */
static void planning_at_the_limits_allocates_nothing(void **state) {
    int32_t method;
    int32_t repack;
    (void)state;
    if (check_watched()) skip();
    for (method = 1; method <= 2; ++method) {
        for (repack = 0; repack <= 2; ++repack) {
            pkc_planner_options options = check_options();
            pkc_planner *planner = NULL;
            pkc_bin *bin = check_bin(20, 20);
            pkc_queue *queue = check_queue("D-R64A64O64");
            uint64_t seed = 3;
            int32_t i;
            options.method = method;
            options.repack = repack;
            options.max_side = 20;
            options.max_items = 150;
            options.max_known = 128;
            CHECK_OK(pkc_planner_create(&options, NULL, &planner));
            for (i = 0; i < 64; ++i) {
                /* Half of the known items lie in a buffer. */
                pkc_action unpack;
                memset(&unpack, 0, sizeof unpack);
                unpack.op = PKC_OP_UNPACK;
                unpack.item = 5000 + i;
                unpack.arm = i % 2;
                check_pack(bin, 5000 + i, 1 + i % 3, 1 + i % 2, 10, 10);
                CHECK_OK(pkc_step_apply(bin, queue, &unpack, 1));
            }
            for (i = 0; i < 150; ++i) check_pack(bin, 1000 + i, 2, 1, i % 10 * 2, i / 10);
            for (i = 0; i < 64; ++i)
                check_push(queue, i, check_draw(&seed, 1, 6), check_draw(&seed, 1, 6));
            step(planner, bin, queue, 20000);
            pkc_planner_free(planner);
            pkc_bin_free(bin);
            pkc_queue_free(queue);
        }
    }
}

/* ---- Allocations that fail ------------------------------------------------------------------- */

static pkc_bin *given_bin;
static pkc_queue *given_queue;
static uint8_t *given_bytes;
static size_t given_size;
static uint8_t given_blob[10000];
static size_t given_blob_size;
static pkc_policy *given_policy;

static pkc_status try_bin_create(void) {
    pkc_bin *bin = NULL;
    const pkc_status status = pkc_bin_create(5, 5, &bin);
    pkc_bin_free(bin);
    return status;
}

static pkc_status try_bin_clone(void) {
    pkc_bin *bin = NULL;
    const pkc_status status = pkc_bin_clone(given_bin, &bin);
    pkc_bin_free(bin);
    return status;
}

static pkc_status try_bin_pack(void) {
    const pkc_item item = {400, 1, 1, 0};
    const pkc_status status = pkc_bin_pack(given_bin, &item, 19, 19, 0);
    if (status == PKC_OK) pkc_bin_unpack(given_bin, 400, NULL);
    return status;
}

static pkc_status try_queue_create(void) {
    const pkc_scenario scenario = {sizeof scenario, 1, 1, 1, 0};
    pkc_queue *queue = NULL;
    const pkc_status status = pkc_queue_create(&scenario, &queue);
    pkc_queue_free(queue);
    return status;
}

static pkc_status try_queue_clone(void) {
    pkc_queue *queue = NULL;
    const pkc_status status = pkc_queue_clone(given_queue, &queue);
    pkc_queue_free(queue);
    return status;
}

static pkc_status try_queue_push(void) {
    pkc_queue *queue = NULL;
    pkc_status status = pkc_queue_clone(given_queue, &queue);
    int32_t i;
    for (i = 0; status == PKC_OK && i < 100; ++i) {
        const pkc_item item = {500 + i, 1, 1, 0};
        status = pkc_queue_push(queue, &item);
    }
    pkc_queue_free(queue);
    return status;
}

/* Takes the item packed last out and puts it back. */
static pkc_status try_step_apply(void) {
    pkc_action actions[2];
    memset(actions, 0, sizeof actions);
    actions[0].op = PKC_OP_UNPACK;
    actions[0].item = 12;
    actions[1].op = PKC_OP_PACK;
    actions[1].item = 12;
    actions[1].x = 11;
    return pkc_step_apply(given_bin, given_queue, actions, 2);
}

static pkc_status try_policy_create(void) {
    pkc_policy *policy = NULL;
    const pkc_status status = pkc_policy_create("skyline", &policy);
    pkc_policy_free(policy);
    return status;
}

static pkc_status try_policy_load(void) {
    pkc_policy *policy = NULL;
    const pkc_status status = pkc_policy_load(given_blob, given_blob_size, &policy);
    if (status != PKC_OK) assert_null(policy);
    pkc_policy_free(policy);
    return status;
}

static pkc_status try_policy_load_file(void) {
    pkc_policy *policy = NULL;
    const pkc_status status =
        pkc_policy_load_file(PACKCELL_GOLDEN "/fully-convolutional.pkw", &policy);
    if (status != PKC_OK) assert_null(policy);
    pkc_policy_free(policy);
    return status;
}

static pkc_status try_policy_save(void) {
    static uint8_t bytes[sizeof given_blob];
    size_t size = 0;
    return pkc_policy_save(given_policy, bytes, sizeof bytes, &size);
}

static pkc_status try_policy_save_file(void) {
    return pkc_policy_save_file(given_policy, "test_allocation.tmp.pkw");
}

static pkc_status try_policy_evaluate(void) {
    float numbers[401];
    float value = 0;
    size_t count = 0;
    return pkc_policy_evaluate(given_policy, given_bin, 2, 1, numbers, NULL, 401, &count, &value);
}

static pkc_status try_planner_create(int32_t method) {
    pkc_planner_options options;
    pkc_planner *planner = NULL;
    pkc_status status = pkc_planner_options_init(&options, sizeof options);
    if (status != PKC_OK) return status;
    options.method = method;
    options.repack = PKC_REPACK_ANYTIME;
    options.memory = 65536;
    status = pkc_planner_create(&options, NULL, &planner);
    pkc_planner_free(planner);
    return status;
}
static pkc_status try_paper_planner(void) { return try_planner_create(PKC_METHOD_PAPER); }
static pkc_status try_exact_planner(void) { return try_planner_create(PKC_METHOD_EXACT); }

static pkc_status try_generator(void) {
    pkc_generator_options options;
    pkc_generator *generator = NULL;
    pkc_item items[100];
    size_t count = 0;
    pkc_status status = pkc_generator_options_init(&options, sizeof options);
    options.kind = PKC_GENERATE_FULL;
    if (status == PKC_OK) status = pkc_generator_create(&options, &generator);
    if (status == PKC_OK) status = pkc_generator_next(generator, items, 100, &count);
    pkc_generator_free(generator);
    return status;
}

static pkc_status try_save(void) {
    uint8_t bytes[2048];
    size_t size = 0;
    return pkc_snapshot_save(given_bin, given_queue, bytes, sizeof bytes, &size);
}

static pkc_status try_load(void) {
    pkc_bin *bin = NULL;
    pkc_queue *queue = NULL;
    const pkc_status status = pkc_snapshot_load(given_bytes, given_size, &bin, &queue);
    if (status != PKC_OK) {
        assert_null(bin);
        assert_null(queue);
    }
    pkc_bin_free(bin);
    pkc_queue_free(queue);
    return status;
}

static pkc_status try_exact_pack(void) {
    const pkc_item items[2] = {{800, 1, 2, 0}, {801, 3, 2, 0}};
    pkc_placement placements[2];
    pkc_budget budget;
    int32_t answer = 0;
    pkc_status status = pkc_budget_init(&budget, sizeof budget);
    if (status == PKC_OK)
        status = pkc_exact_pack(given_bin, items, 2, 1, &budget, placements, &answer, NULL);
    return status;
}

static pkc_status try_bound(void) {
    const pkc_item items[2] = {{800, 1, 2, 0}, {801, 3, 2, 0}};
    pkc_budget budget;
    size_t count = 0;
    int32_t answer = 0;
    pkc_status status = pkc_budget_init(&budget, sizeof budget);
    if (status == PKC_OK)
        status = pkc_bound_in_order(given_bin, items, 2, 1, &budget, &count, &answer);
    return status;
}

static void an_allocation_that_fails_is_told_and_leaks_nothing(void **state) {
    static const struct {
        const char *name;
        pkc_status (*call)(void);
    } calls[] = {{"bin_create", try_bin_create},
                 {"bin_clone", try_bin_clone},
                 {"bin_pack", try_bin_pack},
                 {"queue_create", try_queue_create},
                 {"queue_clone", try_queue_clone},
                 {"queue_push", try_queue_push},
                 {"step_apply", try_step_apply},
                 {"policy_create", try_policy_create},
                 {"policy_load", try_policy_load},
                 {"policy_load_file", try_policy_load_file},
                 {"policy_save", try_policy_save},
                 {"policy_save_file", try_policy_save_file},
                 {"policy_evaluate", try_policy_evaluate},
                 {"paper planner", try_paper_planner},
                 {"exact planner", try_exact_planner},
                 {"generator", try_generator},
                 {"snapshot_save", try_save},
                 {"snapshot_load", try_load},
                 {"exact_pack", try_exact_pack},
                 {"bound_in_order", try_bound}};
    size_t c;
    int32_t i;
    int all;
    (void)state;
    if (check_watched()) skip();
    given_bin = check_bin(20, 20);
    given_queue = check_queue("S-R1A1");
    for (i = 1; i <= 12; ++i) check_pack(given_bin, i, 1, 1, i - 1, 0);
    for (i = 200; i < 210; ++i) check_push(given_queue, i, 2, 1);
    given_bytes = check_snapshot(given_bin, given_queue, &given_size);
    CHECK_OK(pkc_policy_load_file(PACKCELL_GOLDEN "/fully-convolutional.pkw", &given_policy));
    CHECK_OK(pkc_policy_save(given_policy, given_blob, sizeof given_blob, &given_blob_size));
    for (c = 0; c < sizeof calls / sizeof calls[0]; ++c) {
        for (all = 0; all < 2; ++all) {
            uint64_t n;
            for (n = 1;; ++n) {
                const int64_t live = count_malloc_live;
                pkc_status status;
                uint64_t left;
                assert_true(n < 10000);
                count_malloc_fail_all = all;
                count_malloc_fail_at = n;
                status = calls[c].call();
                left = count_malloc_fail_at;
                count_malloc_fail_at = 0;
                count_malloc_fail_all = 0;
                if (count_malloc_live > live && status != PKC_OK) {
                    print_error("%s: allocation %d fails: %d blocks leaked\n", calls[c].name,
                                (int)n, (int)(count_malloc_live - live));
                    fail();
                }
                if (status == PKC_OK) {
                    /* Either no more allocations to fail, or one that could be done without. */
                    if (all ? left > 1 || n > 200 : left != 0) break;
                    continue;
                }
                if (status != PKC_E_MEMORY) {
                    print_error("%s: allocation %d fails: %s: %s\n", calls[c].name, (int)n,
                                pkc_status_name(status), pkc_last_error());
                    fail();
                }
            }
        }
    }
    {
        /* Nothing of what was given has changed. */
        check_state before;
        before.bytes = given_bytes;
        before.size = given_size;
        check_unchanged(&before, given_bin, given_queue);
    }
    pkc_bin_free(given_bin);
    pkc_queue_free(given_queue);
    pkc_policy_free(given_policy);
    remove("test_allocation.tmp.pkw");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_counter_counts_what_the_library_allocates),
        cmocka_unit_test(planning_allocates_nothing_over_whole_streams),
        cmocka_unit_test(planning_with_the_default_policy_s_tables_allocates_nothing),
        cmocka_unit_test(planning_with_small_buffers_allocates_nothing),
        cmocka_unit_test(planning_at_the_limits_allocates_nothing),
        cmocka_unit_test(an_allocation_that_fails_is_told_and_leaks_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
