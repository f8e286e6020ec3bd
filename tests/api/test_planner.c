/* The planner through the C API: options, budgets, slices, cancel, limits, and what a second thread
 * may do. How good its plans are is the matter of the unit tests. */
#include <float.h>
#include <limits.h>
#include <math.h>
#include <pthread.h>
#include <sched.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "check.h"

static pkc_planner *make(const pkc_planner_options *options) {
    pkc_planner *planner = NULL;
    CHECK_OK(pkc_planner_create(options, NULL, &planner));
    return planner;
}

static pkc_planner *make_small(int32_t repack) {
    pkc_planner_options options = check_options();
    options.repack = repack;
    options.max_side = 32;
    options.memory = 65536;
    return make(&options);
}

static void defaults_are_those_of_the_header(void **state) {
    const pkc_planner_options o = check_options();
    pkc_budget b;
    const pkc_plan_info i = check_plan_info();
    (void)state;
    assert_int_equal(o.method, PKC_METHOD_EXACT);
    assert_int_equal(o.rotation, 1);
    assert_int_equal(o.repack, PKC_REPACK_OFF);
    assert_int_equal(o.select, PKC_SELECT_AUTO);
    assert_int_equal(o.buffer_capacity, PKC_UNLIMITED);
    assert_int_equal(o.skip, 0);
    assert_int_equal(o.max_side, 128);
    assert_int_equal(o.max_items, 256);
    assert_int_equal(o.max_known, 128);
    assert_true(o.memory == 8u << 20);
    CHECK_OK(pkc_budget_init(&b, sizeof b));
    assert_int_equal(b.reserved, 0);
    assert_true(b.nodes == 200000 && b.milliseconds == 0);
    assert_int_equal(i.actions, 0);
}

static void every_option_is_checked(void **state) {
    static const struct {
        size_t offset;
        const char *name;
        int32_t least, most;
    } fields[] = {
        {offsetof(pkc_planner_options, method), "method", 1, 2},
        {offsetof(pkc_planner_options, rotation), "rotation", 0, 1},
        {offsetof(pkc_planner_options, repack), "repack", 0, 2},
        {offsetof(pkc_planner_options, select), "select", -1, 128},
        {offsetof(pkc_planner_options, buffer_capacity), "buffer_capacity", -1, 4096},
        {offsetof(pkc_planner_options, skip), "skip", 0, 1},
        {offsetof(pkc_planner_options, max_side), "max_side", 1, 128},
        {offsetof(pkc_planner_options, max_items), "max_items", 1, 16384},
        {offsetof(pkc_planner_options, max_known), "max_known", 1, 128},
    };
    static const uint64_t wrong_memory[] = {0, 65535, ((uint64_t)4 << 30) + 1, UINT64_MAX};
    pkc_planner *const sentinel = (pkc_planner *)&state;
    pkc_planner *planner = sentinel;
    pkc_planner_options options;
    size_t f;
    size_t i;
    (void)state;
    for (f = 0; f < sizeof fields / sizeof fields[0]; ++f) {
        int32_t wrong[4];
        int32_t right[2];
        wrong[0] = INT_MIN;
        wrong[1] = fields[f].least - 1;
        wrong[2] = fields[f].most + 1;
        wrong[3] = INT_MAX;
        right[0] = fields[f].least;
        right[1] = fields[f].most;
        for (i = 0; i < 4; ++i) {
            char text[64];
            options = check_options();
            memcpy((char *)&options + fields[f].offset, &wrong[i], sizeof wrong[i]);
            snprintf(text, sizeof text, "%s %d: must be %d..%d", fields[f].name, wrong[i],
                     fields[f].least, fields[f].most);
            CHECK_FAILS(PKC_E_ARGUMENT, text, pkc_planner_create(&options, NULL, &planner));
            assert_ptr_equal(planner, sentinel);
        }
        for (i = 0; i < 2; ++i) {
            pkc_planner *made = NULL;
            options = check_options();
            options.memory = 65536;
            options.max_side = 8;
            memcpy((char *)&options + fields[f].offset, &right[i], sizeof right[i]);
            CHECK_OK(pkc_planner_create(&options, NULL, &made));
            pkc_planner_free(made);
        }
    }
    for (i = 0; i < 4; ++i) {
        char text[64];
        options = check_options();
        options.memory = wrong_memory[i];
        snprintf(text, sizeof text, "memory %llu: must be 65536..4294967296",
                 (unsigned long long)wrong_memory[i]);
        CHECK_FAILS(PKC_E_ARGUMENT, text, pkc_planner_create(&options, NULL, &planner));
    }
    options = check_options();
    CHECK_FAILS(PKC_E_ARGUMENT, "out_planner is NULL", pkc_planner_create(&options, NULL, NULL));
    assert_ptr_equal(planner, sentinel);
}

static void null_options_are_the_defaults(void **state) {
    pkc_planner *planner = NULL;
    pkc_bin *bin = check_bin(128, 128);
    pkc_queue *queue = check_queue("S-R1A1");
    const pkc_budget budget = check_budget(10);
    (void)state;
    CHECK_OK(pkc_planner_create(NULL, NULL, &planner));
    CHECK_OK(pkc_planner_plan(planner, bin, queue, &budget, NULL));
    pkc_planner_free(planner);
    pkc_bin_free(bin);
    pkc_queue_free(queue);
}

static void budgets_are_checked(void **state) {
    const double wrong[] = {NAN, INFINITY, -INFINITY, -1, -DBL_MIN, 1e308, 1.0001e12};
    const double right[] = {0, DBL_MIN, 1e-300, 1, 1e12};
    pkc_planner *planner = make_small(PKC_REPACK_OFF);
    pkc_bin *bin = check_bin(4, 4);
    pkc_queue *queue = check_queue("S-R1A1");
    pkc_budget budget;
    size_t i;
    (void)state;
    check_push(queue, 0, 2, 2);
    for (i = 0; i < sizeof wrong / sizeof wrong[0]; ++i) {
        budget = check_budget(10);
        budget.milliseconds = wrong[i];
        CHECK_FAILS(PKC_E_ARGUMENT, "milliseconds",
                    pkc_planner_plan(planner, bin, queue, &budget, NULL));
        CHECK_FAILS(PKC_E_ARGUMENT, "milliseconds",
                    pkc_planner_begin(planner, bin, queue, &budget));
    }
    for (i = 0; i < sizeof right / sizeof right[0]; ++i) {
        budget = check_budget(10);
        budget.milliseconds = right[i];
        CHECK_OK(pkc_planner_plan(planner, bin, queue, &budget, NULL));
    }
    budget = check_budget(10);
    budget.reserved = 3;
    CHECK_FAILS(PKC_E_ARGUMENT, "reserved 3", pkc_planner_plan(planner, bin, queue, &budget, NULL));
    budget = check_budget(UINT64_MAX);
    CHECK_OK(pkc_planner_plan(planner, bin, queue, &budget, NULL));
    pkc_planner_free(planner);
    pkc_bin_free(bin);
    pkc_queue_free(queue);
}

static void every_null_is_named(void **state) {
    pkc_planner *planner = make_small(PKC_REPACK_OFF);
    pkc_bin *bin = check_bin(4, 4);
    pkc_queue *queue = check_queue("S-R1A1");
    const pkc_budget budget = check_budget(10);
    pkc_plan_info info = check_plan_info();
    pkc_action action;
    size_t count = 77;
    int32_t done = 77;
    (void)state;
    check_push(queue, 0, 2, 2);
    CHECK_FAILS(PKC_E_ARGUMENT, "planner is NULL",
                pkc_planner_plan(NULL, bin, queue, &budget, &info));
    CHECK_FAILS(PKC_E_ARGUMENT, "bin is NULL",
                pkc_planner_plan(planner, NULL, queue, &budget, &info));
    CHECK_FAILS(PKC_E_ARGUMENT, "queue is NULL",
                pkc_planner_plan(planner, bin, NULL, &budget, &info));
    CHECK_FAILS(PKC_E_ARGUMENT, "planner is NULL", pkc_planner_begin(NULL, bin, queue, &budget));
    CHECK_FAILS(PKC_E_ARGUMENT, "bin is NULL", pkc_planner_begin(planner, NULL, queue, &budget));
    CHECK_FAILS(PKC_E_ARGUMENT, "queue is NULL", pkc_planner_begin(planner, bin, NULL, &budget));
    CHECK_FAILS(PKC_E_ARGUMENT, "planner is NULL", pkc_planner_step(NULL, 1, &done));
    CHECK_FAILS(PKC_E_ARGUMENT, "out_done is NULL", pkc_planner_step(planner, 1, NULL));
    CHECK_FAILS(PKC_E_ARGUMENT, "planner is NULL",
                pkc_planner_result(NULL, &info, &action, 1, &count));
    CHECK_FAILS(PKC_E_ARGUMENT, "planner is NULL", pkc_planner_cancel(NULL));
    CHECK_OK(pkc_planner_plan(planner, bin, queue, &budget, NULL));
    CHECK_FAILS(PKC_E_ARGUMENT, "out_count is NULL",
                pkc_planner_result(planner, &info, &action, 1, NULL));
    CHECK_FAILS(PKC_E_ARGUMENT, "actions is NULL",
                pkc_planner_result(planner, &info, NULL, 1, &count));
    assert_int_equal(count, 77);
    assert_int_equal(done, 77);
    assert_int_equal(info.actions, 0);
    pkc_planner_free(planner);
    pkc_bin_free(bin);
    pkc_queue_free(queue);
}

static void step_and_result_need_a_plan_begun(void **state) {
    pkc_planner *planner = make_small(PKC_REPACK_OFF);
    pkc_bin *bin = check_bin(4, 4);
    pkc_queue *queue = check_queue("S-R1A1");
    const pkc_budget budget = check_budget(10);
    pkc_action actions[4];
    size_t count = 77;
    int32_t done = 77;
    (void)state;
    CHECK_FAILS(PKC_E_STATE, "no plan", pkc_planner_step(planner, 1, &done));
    CHECK_FAILS(PKC_E_STATE, "no plan", pkc_planner_result(planner, NULL, actions, 4, &count));
    CHECK_OK(pkc_planner_cancel(planner));
    assert_int_equal(done, 77);
    assert_int_equal(count, 77);
    CHECK_OK(pkc_planner_begin(planner, bin, queue, &budget));
    CHECK_FAILS(PKC_E_ARGUMENT, "nodes 0", pkc_planner_step(planner, 0, &done));
    assert_int_equal(done, 77);
    CHECK_OK(pkc_planner_step(planner, UINT64_MAX, &done));
    assert_int_equal(done, 1);
    CHECK_OK(pkc_planner_step(planner, 1, &done)); /* nothing is left to do */
    assert_int_equal(done, 1);
    pkc_planner_free(planner);
    pkc_bin_free(bin);
    pkc_queue_free(queue);
}

static void an_empty_queue_ends_the_bin(void **state) {
    pkc_planner *planner = make_small(PKC_REPACK_ANYTIME);
    pkc_bin *bin = check_bin(4, 4);
    pkc_queue *queue = check_queue("D-R5A3O1");
    const pkc_budget budget = check_budget(10);
    pkc_plan_info info = check_plan_info();
    pkc_action action;
    size_t count = 0;
    (void)state;
    CHECK_OK(pkc_planner_plan(planner, bin, queue, &budget, &info));
    CHECK_OK(pkc_planner_result(planner, NULL, &action, 1, &count));
    assert_int_equal(count, 1);
    assert_int_equal(action.op, PKC_OP_TERMINATE);
    assert_int_equal(info.terminate, 1);
    assert_int_equal(info.actions, 1);
    assert_true(info.utilization == 0);
    pkc_planner_free(planner);
    pkc_bin_free(bin);
    pkc_queue_free(queue);
}

static void info_agrees_with_the_actions(void **state) {
    pkc_planner *planner = make_small(PKC_REPACK_OFF);
    pkc_bin *bin = check_bin(4, 4);
    pkc_queue *queue = check_queue("D-R2A2O2");
    const pkc_budget budget = check_budget(1000);
    pkc_plan_info info = check_plan_info();
    pkc_plan_info again = check_plan_info();
    pkc_action actions[4];
    uint64_t hash = 0;
    size_t count = 0;
    (void)state;
    check_push(queue, 0, 4, 2);
    check_push(queue, 1, 4, 2);
    CHECK_OK(pkc_planner_plan(planner, bin, queue, &budget, &info));
    CHECK_FAILS(PKC_E_CAPACITY, "3", pkc_planner_result(planner, &again, NULL, 0, &count));
    assert_int_equal(count, 3);
    assert_int_equal(again.actions, 0); /* untouched */
    CHECK_FAILS(PKC_E_CAPACITY, "capacity 2",
                pkc_planner_result(planner, &again, actions, 2, &count));
    CHECK_OK(pkc_planner_result(planner, &again, actions, 4, &count));
    assert_int_equal(info.actions, 3);
    assert_int_equal(info.packs, 2);
    assert_int_equal(info.unpacks, 0);
    assert_int_equal(info.terminate, 1); /* the bin is full */
    assert_int_equal(info.repacked, 0);
    assert_int_equal(info.cancelled, 0);
    assert_true(info.utilization == 1.0);
    assert_int_equal(info.proof, PKC_PROOF_NONE);
    /* The first touches three walls: 4 + 2 + 2; the second three walls and the first: 12. */
    assert_int_equal(info.score, 20);
    assert_true(info.nodes >= 2 && info.nodes == info.tree_nodes);
    assert_true(info.milliseconds >= 0 && info.repack_milliseconds == 0);
    CHECK_OK(pkc_plan_hash(actions, count, &hash));
    assert_true(hash == info.hash && hash == again.hash);
    assert_int_equal(actions[0].op, PKC_OP_PACK);
    assert_int_equal(actions[1].op, PKC_OP_PACK);
    assert_true(actions[0].arm != actions[1].arm);
    assert_int_equal(actions[2].op, PKC_OP_TERMINATE);
    pkc_planner_free(planner);
    pkc_bin_free(bin);
    pkc_queue_free(queue);
}

static void planning_changes_neither_bin_nor_queue(void **state) {
    int32_t repack;
    (void)state;
    for (repack = 0; repack < 3; ++repack) {
        pkc_planner *planner = make_small(repack);
        pkc_bin *bin = check_bin(6, 5);
        pkc_queue *queue = check_queue("D-R5A3O1");
        const pkc_budget budget = check_budget(1000);
        check_state before;
        int32_t i;
        check_pack(bin, 10, 2, 3, 1, 1);
        check_pack(bin, 11, 1, 1, 5, 4);
        for (i = 0; i < 7; ++i) check_push(queue, i, 1 + i % 3, 1 + i % 4);
        before = check_remember(bin, queue);
        CHECK_OK(pkc_planner_plan(planner, bin, queue, &budget, NULL));
        check_unchanged(&before, bin, queue);
        pkc_planner_free(planner);
        pkc_bin_free(bin);
        pkc_queue_free(queue);
    }
}

static void limits_are_those_given_at_creation(void **state) {
    pkc_planner_options options = check_options();
    pkc_planner *planner;
    pkc_bin *bin = check_bin(5, 5);
    pkc_bin *wide = check_bin(6, 1);
    pkc_bin *high = check_bin(1, 6);
    pkc_queue *queue = check_queue("S-R4A1");
    const pkc_budget budget = check_budget(100);
    pkc_plan_info info = check_plan_info();
    int32_t i;
    (void)state;
    options.max_side = 5;
    options.max_items = 2;
    options.max_known = 3;
    options.repack = PKC_REPACK_ANYTIME;
    planner = make(&options);
    for (i = 0; i < 3; ++i) check_push(queue, i, 1, 1);
    check_pack(bin, 10, 1, 1, 0, 0);
    check_pack(bin, 11, 1, 1, 1, 0);
    CHECK_OK(pkc_planner_plan(planner, bin, queue, &budget, &info));
    info = check_plan_info();
    CHECK_FAILS(PKC_E_LIMIT, "6x1", pkc_planner_plan(planner, wide, queue, &budget, &info));
    CHECK_FAILS(PKC_E_LIMIT, "1x6", pkc_planner_plan(planner, high, queue, &budget, &info));
    check_pack(bin, 12, 1, 1, 2, 0);
    CHECK_FAILS(PKC_E_LIMIT, "max_items is 2",
                pkc_planner_plan(planner, bin, queue, &budget, &info));
    CHECK_OK(pkc_bin_clear(bin));
    check_push(queue, 3, 1, 1);
    CHECK_FAILS(PKC_E_LIMIT, "max_known is 3", pkc_planner_begin(planner, bin, queue, &budget));
    assert_int_equal(info.actions, 0);
    pkc_planner_free(planner);
    pkc_bin_free(bin);
    pkc_bin_free(wide);
    pkc_bin_free(high);
    pkc_queue_free(queue);
}

/* A begin that fails must not spoil the plan that was there, nor leave half of a new one. */
static void a_failing_begin_leaves_the_plan_before_it_or_none(void **state) {
    pkc_planner *planner = make_small(PKC_REPACK_ANYTIME);
    pkc_bin *bin = check_bin(8, 8);
    pkc_bin *clash = check_bin(8, 8);
    pkc_queue *queue = check_queue("S-R5A3");
    pkc_queue *other = check_queue("S-R1A1");
    pkc_queue *unseen = check_queue("S-R1A1");
    pkc_budget budget = check_budget(1000);
    pkc_plan_info first = check_plan_info();
    pkc_plan_info second = check_plan_info();
    pkc_action actions[16];
    size_t count = 0;
    pkc_status status;
    int32_t i;
    (void)state;
    for (i = 0; i < 5; ++i) check_push(queue, i, 2, 3);
    check_push(other, 3, 1, 1);
    check_pack(clash, 3, 1, 1, 0, 0);
    CHECK_OK(pkc_planner_plan(planner, bin, queue, &budget, &first));
    CHECK_FAILS(PKC_E_STATE, "item 3", pkc_planner_plan(planner, clash, other, &budget, &second));
    assert_int_equal(second.actions, 0);
    /* Also where the planner does not see the item yet. */
    check_push(unseen, 7, 1, 1);
    check_push(unseen, 3, 1, 1);
    CHECK_FAILS(PKC_E_STATE, "item 3", pkc_planner_plan(planner, clash, unseen, &budget, &second));
    status = pkc_planner_result(planner, &second, actions, 16, &count);
    if (status == PKC_OK) {
        assert_true(second.hash == first.hash);
    } else {
        assert_int_equal(status, PKC_E_STATE);
    }
    CHECK_OK(pkc_planner_plan(planner, bin, queue, &budget, &second));
    assert_true(second.hash == first.hash);
    pkc_planner_free(planner);
    pkc_bin_free(bin);
    pkc_bin_free(clash);
    pkc_queue_free(queue);
    pkc_queue_free(other);
    pkc_queue_free(unseen);
}

/* begin copies the state: bin and queue may change or go while the plan is made. */
static void slices_plan_for_the_state_at_begin(void **state) {
    pkc_planner *planner = make_small(PKC_REPACK_ANYTIME);
    pkc_bin *bin = check_bin(8, 8);
    pkc_queue *queue = check_queue("S-R5A3");
    const pkc_budget budget = check_budget(3000);
    pkc_plan_info whole = check_plan_info();
    pkc_plan_info sliced = check_plan_info();
    pkc_action actions[16];
    size_t count = 0;
    int32_t done = 0;
    int32_t i;
    (void)state;
    for (i = 0; i < 5; ++i) check_push(queue, i, 2 + i % 3, 3);
    check_pack(bin, 20, 5, 5, 2, 2);
    CHECK_OK(pkc_planner_plan(planner, bin, queue, &budget, &whole));
    CHECK_OK(pkc_planner_begin(planner, bin, queue, &budget));
    CHECK_OK(pkc_planner_step(planner, 3, &done));
    pkc_bin_free(bin);
    pkc_queue_free(queue);
    while (!done) CHECK_OK(pkc_planner_step(planner, 3, &done));
    CHECK_OK(pkc_planner_result(planner, &sliced, actions, 16, &count));
    assert_true(whole.hash == sliced.hash);
    assert_true(whole.nodes == sliced.nodes);
    pkc_planner_free(planner);
}

/* ---- Threads --------------------------------------------------------------------------------- */

/* A state whose plan takes for ever: many known items of different sizes in a large bin. */
static void make_long(pkc_bin **bin, pkc_queue **queue) {
    int32_t i;
    *bin = check_bin(30, 30);
    *queue = check_queue("S-R40A40");
    for (i = 0; i < 40; ++i) check_push(*queue, i, 2 + i % 7, 2 + i % 5);
}

typedef struct long_plan {
    pkc_planner *planner;
    pkc_bin *bin;
    pkc_queue *queue;
    pkc_status status;
    pkc_plan_info info;
    int ended;
} long_plan;

static void *run_long_plan(void *at) {
    long_plan *p = (long_plan *)at;
    pkc_budget budget;
    pkc_budget_init(&budget, sizeof budget);
    budget.nodes = 0;
    budget.milliseconds = 60000; /* if cancelling fails */
    /* Whoever looks whether the planner is in use has it for a moment. */
    do {
        p->status = pkc_planner_plan(p->planner, p->bin, p->queue, &budget, &p->info);
    } while (p->status == PKC_E_BUSY);
    check_raise(&p->ended);
    return NULL;
}

static void a_handle_in_use_is_busy_and_cancel_ends_the_plan(void **state) {
    long_plan p;
    pthread_t thread;
    pkc_plan_info info = check_plan_info();
    pkc_action actions[64];
    const pkc_budget budget = check_budget(10);
    const double begun = check_milliseconds();
    size_t count = 77;
    int32_t done = 77;
    pkc_status status = PKC_OK;
    (void)state;
    memset(&p, 0, sizeof p);
    make_long(&p.bin, &p.queue);
    p.planner = make_small(PKC_REPACK_OFF);
    p.info = check_plan_info();
    assert_int_equal(pthread_create(&thread, NULL, run_long_plan, &p), 0);
    /* Until the other thread is inside, the planner has no plan begun. */
    while (!check_is_raised(&p.ended)) {
        status = pkc_planner_step(p.planner, 1, &done);
        if (status == PKC_E_BUSY) break;
        assert_int_equal(status, PKC_E_STATE);
        sched_yield();
    }
    assert_int_equal(status, PKC_E_BUSY);
    assert_non_null(strstr(pkc_last_error(), "planner"));
    CHECK_FAILS(PKC_E_BUSY, "planner", pkc_planner_result(p.planner, &info, actions, 64, &count));
    CHECK_FAILS(PKC_E_BUSY, "planner", pkc_planner_begin(p.planner, p.bin, p.queue, &budget));
    CHECK_FAILS(PKC_E_BUSY, "planner", pkc_planner_plan(p.planner, p.bin, p.queue, &budget, &info));
    assert_int_equal(done, 77);
    assert_int_equal(count, 77);
    assert_int_equal(info.actions, 0);
    assert_int_equal(check_is_raised(&p.ended), 0);
    /* begin() forgets an earlier cancel, so one may come too early to be seen. */
    while (!check_is_raised(&p.ended)) {
        CHECK_OK(pkc_planner_cancel(p.planner));
        sched_yield();
    }
    pthread_join(thread, NULL);
    assert_int_equal(p.status, PKC_OK);
    assert_int_equal(p.info.cancelled, 1);
    assert_true(p.info.packs >= 1);
    assert_true(check_milliseconds() - begun < 20000);
    CHECK_OK(pkc_planner_result(p.planner, &info, actions, 64, &count));
    CHECK_OK(pkc_step_apply(p.bin, p.queue, actions, count));
    /* A cancel without a plan being made has no effect on the next one. */
    CHECK_OK(pkc_planner_cancel(p.planner));
    CHECK_OK(pkc_planner_plan(p.planner, p.bin, p.queue, &budget, &info));
    assert_int_equal(info.cancelled, 0);
    pkc_planner_free(p.planner);
    pkc_bin_free(p.bin);
    pkc_queue_free(p.queue);
}

static void cancel_ends_slices_too(void **state) {
    pkc_planner *planner = make_small(PKC_REPACK_OFF);
    pkc_bin *bin;
    pkc_queue *queue;
    pkc_budget budget = check_budget(0);
    pkc_plan_info info = check_plan_info();
    pkc_action actions[64];
    size_t count = 0;
    int32_t done = 0;
    int steps = 0;
    (void)state;
    make_long(&bin, &queue);
    CHECK_OK(pkc_planner_begin(planner, bin, queue, &budget));
    CHECK_OK(pkc_planner_step(planner, 10, &done));
    assert_int_equal(done, 0);
    CHECK_OK(pkc_planner_cancel(planner));
    while (!done && ++steps < 20) CHECK_OK(pkc_planner_step(planner, 10, &done));
    assert_int_equal(done, 1);
    CHECK_OK(pkc_planner_result(planner, &info, actions, 64, &count));
    assert_int_equal(info.cancelled, 1);
    CHECK_OK(pkc_step_apply(bin, queue, actions, count));
    pkc_planner_free(planner);
    pkc_bin_free(bin);
    pkc_queue_free(queue);
}

/* A generator draws long sets in one thread while another asks: BUSY or the answer, never both in
 * it at once. The same with a bin and a queue. */
typedef struct shared {
    pkc_bin *bin;
    pkc_queue *queue;
    pkc_generator *generator;
    int oks;
    int busies;
    int others;
} shared;

static void count_status(shared *s, pkc_status status) {
    if (status == PKC_OK)
        ++s->oks;
    else if (status == PKC_E_BUSY)
        ++s->busies;
    else
        ++s->others;
}

static void *hammer(void *at) {
    shared *s = (shared *)at;
    pkc_bin_info info;
    pkc_queue_info queue_info;
    pkc_item items[300];
    size_t count;
    int i;
    pkc_bin_info_init(&info, sizeof info);
    pkc_queue_info_init(&queue_info, sizeof queue_info);
    for (i = 0; i < 3000; ++i) {
        uint8_t mask[900];
        count_status(s, pkc_bin_feasible(s->bin, 3, 3, mask, sizeof mask, &count));
        count_status(s, pkc_bin_get_info(s->bin, &info));
        count_status(s, pkc_queue_get_info(s->queue, &queue_info));
        count_status(s, pkc_generator_next(s->generator, items, 300, &count));
    }
    return NULL;
}

static void two_threads_never_share_a_handle(void **state) {
    shared a;
    shared b;
    pthread_t thread;
    pkc_generator_options options;
    (void)state;
    memset(&a, 0, sizeof a);
    a.bin = check_bin(29, 29);
    a.queue = check_queue("S-R1A1");
    CHECK_OK(pkc_generator_options_init(&options, sizeof options));
    CHECK_OK(pkc_generator_create(&options, &a.generator));
    b = a;
    assert_int_equal(pthread_create(&thread, NULL, hammer, &b), 0);
    hammer(&a);
    pthread_join(thread, NULL);
    assert_int_equal(a.others + b.others, 0);
    assert_int_equal(a.oks + a.busies, 12000);
    assert_int_equal(b.oks + b.busies, 12000);
    assert_true(a.oks > 0 && b.oks > 0);
    /* And nobody left a handle busy. */
    CHECK_OK(pkc_bin_clear(a.bin));
    CHECK_OK(
        pkc_queue_get_info(a.queue, &(pkc_queue_info){sizeof(pkc_queue_info), 0, 0, 0, 0, 0, 0}));
    pkc_bin_free(a.bin);
    pkc_queue_free(a.queue);
    pkc_generator_free(a.generator);
}

static void failing_calls_leave_no_handle_busy_and_no_plan(void **state) {
    pkc_planner *planner = make_small(PKC_REPACK_OFF);
    pkc_bin *bin = check_bin(4, 4);
    pkc_queue *queue = check_queue("S-R1A1");
    const pkc_budget budget = check_budget(10);
    pkc_action action;
    pkc_action actions[8];
    size_t count = 0;
    pkc_plan_info info = check_plan_info();
    (void)state;
    memset(&action, 0, sizeof action);
    CHECK_FAILS(PKC_E_STATE, NULL, pkc_step_apply(bin, queue, &action, 1));
    CHECK_FAILS(PKC_E_ARGUMENT, NULL, pkc_step_apply(bin, NULL, &action, 1));
    CHECK_FAILS(PKC_E_ARGUMENT, NULL, pkc_planner_plan(planner, bin, NULL, &budget, &info));
    info.struct_size = 1;
    CHECK_FAILS(PKC_E_STRUCT, "info.struct_size 1",
                pkc_planner_plan(planner, bin, queue, &budget, &info));
    info.struct_size = sizeof info;
    CHECK_FAILS(PKC_E_STATE, "no plan", pkc_planner_result(planner, &info, actions, 8, &count));
    CHECK_OK(pkc_planner_plan(planner, bin, queue, &budget, &info));
    CHECK_OK(pkc_step_apply(bin, queue, NULL, 0));
    pkc_planner_free(planner);
    pkc_bin_free(bin);
    pkc_queue_free(queue);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(defaults_are_those_of_the_header),
        cmocka_unit_test(every_option_is_checked),
        cmocka_unit_test(null_options_are_the_defaults),
        cmocka_unit_test(budgets_are_checked),
        cmocka_unit_test(every_null_is_named),
        cmocka_unit_test(step_and_result_need_a_plan_begun),
        cmocka_unit_test(an_empty_queue_ends_the_bin),
        cmocka_unit_test(info_agrees_with_the_actions),
        cmocka_unit_test(planning_changes_neither_bin_nor_queue),
        cmocka_unit_test(limits_are_those_given_at_creation),
        cmocka_unit_test(a_failing_begin_leaves_the_plan_before_it_or_none),
        cmocka_unit_test(slices_plan_for_the_state_at_begin),
        cmocka_unit_test(a_handle_in_use_is_busy_and_cancel_ends_the_plan),
        cmocka_unit_test(cancel_ends_slices_too),
        cmocka_unit_test(two_threads_never_share_a_handle),
        cmocka_unit_test(failing_calls_leave_no_handle_busy_and_no_plan),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
