/* Scenarios, the conveyor and its regions, steps and plan hashes through the C API. */
#include <limits.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "check.h"

static pkc_queue_info info_of(const pkc_queue *queue) {
    pkc_queue_info info;
    CHECK_OK(pkc_queue_info_init(&info, sizeof info));
    CHECK_OK(pkc_queue_get_info(queue, &info));
    return info;
}

static pkc_action make_action(int32_t op, int32_t item, int32_t x, int32_t y, int32_t rot,
                              int32_t arm) {
    pkc_action action;
    action.op = op;
    action.item = item;
    action.x = x;
    action.y = y;
    action.rot = rot;
    action.arm = arm;
    return action;
}

/* ---- Scenarios ------------------------------------------------------------------------------- */

static void names_are_parsed_and_given_back(void **state) {
    static const struct {
        const char *name;
        int32_t robots, recognized, accessible, overlap;
    } right[] = {
        {"S-R1A1", 1, 1, 1, 0},     {"S-R5A1", 1, 5, 1, 0},       {"S-R5A3", 1, 5, 3, 0},
        {"D-R2A2O2", 2, 2, 2, 2},   {"D-R5A2O2", 2, 5, 2, 2},     {"D-R5A3O1", 2, 5, 3, 1},
        {"S-R64A64", 1, 64, 64, 0}, {"D-R64A32O0", 2, 64, 32, 0}, {"D-R1A1O1", 2, 1, 1, 1}};
    size_t i;
    (void)state;
    for (i = 0; i < sizeof right / sizeof right[0]; ++i) {
        pkc_scenario s;
        char name[32];
        CHECK_OK(pkc_scenario_init(&s, sizeof s));
        CHECK_OK(pkc_scenario_parse(right[i].name, &s));
        assert_int_equal(s.robots, right[i].robots);
        assert_int_equal(s.recognized, right[i].recognized);
        assert_int_equal(s.accessible, right[i].accessible);
        assert_int_equal(s.overlap, right[i].overlap);
        CHECK_OK(pkc_scenario_name(&s, name, sizeof name));
        assert_string_equal(name, right[i].name);
        memset(name, 'x', sizeof name);
        CHECK_FAILS(PKC_E_CAPACITY, "capacity", pkc_scenario_name(&s, name, strlen(right[i].name)));
        assert_int_equal(name[0], 'x');
        CHECK_OK(pkc_scenario_name(&s, name, strlen(right[i].name) + 1));
    }
}

static void wrong_names_are_refused_and_quoted(void **state) {
    static const char *const wrong[] = {"",
                                        "S",
                                        "S-",
                                        "X-R1A1",
                                        "s-R1A1",
                                        "S-R1",
                                        "S-R1A",
                                        "S-A1R1",
                                        "S-R1A1O0",
                                        "S-R1A1 ",
                                        " S-R1A1",
                                        "D-R5A3",
                                        "D-R5A3O",
                                        "S-R-1A1",
                                        "S-R1A1x",
                                        "S-R0001A1",
                                        "S-R0A0",
                                        "S-R65A1",
                                        "S-R1A2",
                                        "D-R5A3O4",
                                        "D-R4A3O1",
                                        "D-R999A1O1",
                                        "S-R99999999999999999999A1"};
    size_t i;
    char longest[4000];
    (void)state;
    for (i = 0; i < sizeof wrong / sizeof wrong[0]; ++i) {
        pkc_scenario s = {20, 77, 77, 77, 77};
        CHECK_FAILS(PKC_E_ARGUMENT, "must be", pkc_scenario_parse(wrong[i], &s));
        assert_int_equal(s.robots, 77);
        assert_int_equal(s.overlap, 77);
    }
    memset(longest, '9', sizeof longest);
    memcpy(longest, "S-R", 3);
    longest[sizeof longest - 1] = '\0';
    {
        pkc_scenario s = {20, 77, 77, 77, 77};
        CHECK_FAILS(PKC_E_ARGUMENT, "S-R999", pkc_scenario_parse(longest, &s));
        CHECK_FAILS(PKC_E_ARGUMENT, "name is NULL", pkc_scenario_parse(NULL, &s));
        CHECK_FAILS(PKC_E_ARGUMENT, "scenario is NULL", pkc_scenario_parse("S-R1A1", NULL));
        assert_int_equal(s.robots, 77);
    }
}

static void every_field_of_a_scenario_is_checked(void **state) {
    static const struct {
        int32_t robots, recognized, accessible, overlap;
        const char *text;
    } wrong[] = {
        {0, 5, 3, 0, "robots 0"},
        {3, 5, 3, 0, "robots 3"},
        {-1, 5, 3, 0, "robots -1"},
        {INT_MIN, 5, 3, 0, "robots -2147483648"},
        {INT_MAX, 5, 3, 0, "robots 2147483647"},
        {1, 0, 1, 0, "recognized 0"},
        {1, 65, 1, 0, "recognized 65"},
        {1, INT_MIN, 1, 0, "recognized -2147483648"},
        {1, INT_MAX, 1, 0, "recognized 2147483647"},
        {1, 5, 0, 0, "accessible 0"},
        {1, 5, -1, 0, "accessible -1"},
        {1, 5, 6, 0, "accessible 6"},
        {1, 5, INT_MIN, 0, "accessible -2147483648"},
        {2, 5, INT_MAX, 0, "accessible 2147483647"},
        {1, 5, 3, 1, "overlap 1"},
        {2, 5, 3, -1, "overlap -1"},
        {2, 5, 3, 4, "overlap 4"},
        {2, 5, 3, INT_MIN, "overlap -2147483648"},
        {2, 5, 3, INT_MAX, "overlap 2147483647"},
        {2, 5, 3, 0, "n_max 6"},
        {2, 64, 64, 0, "n_max 128"},
    };
    size_t i;
    (void)state;
    for (i = 0; i < sizeof wrong / sizeof wrong[0]; ++i) {
        pkc_queue *const sentinel = (pkc_queue *)&state;
        pkc_queue *queue = sentinel;
        pkc_scenario s;
        char name[32] = "untouched";
        CHECK_OK(pkc_scenario_init(&s, sizeof s));
        s.robots = wrong[i].robots;
        s.recognized = wrong[i].recognized;
        s.accessible = wrong[i].accessible;
        s.overlap = wrong[i].overlap;
        CHECK_FAILS(PKC_E_ARGUMENT, wrong[i].text, pkc_queue_create(&s, &queue));
        CHECK_FAILS(PKC_E_ARGUMENT, wrong[i].text, pkc_scenario_name(&s, name, sizeof name));
        assert_ptr_equal(queue, sentinel);
        assert_string_equal(name, "untouched");
    }
}

static void queues_keep_their_scenario(void **state) {
    pkc_queue *queue = check_queue("D-R5A3O1");
    pkc_queue *clone = NULL;
    pkc_scenario s;
    (void)state;
    check_push(queue, 4, 1, 2);
    CHECK_OK(pkc_queue_clone(queue, &clone));
    CHECK_OK(pkc_queue_remove(queue, 4));
    pkc_queue_free(queue);
    CHECK_OK(pkc_scenario_init(&s, sizeof s));
    CHECK_OK(pkc_queue_get_scenario(clone, &s));
    assert_int_equal(s.robots, 2);
    assert_int_equal(s.recognized, 5);
    assert_int_equal(s.accessible, 3);
    assert_int_equal(s.overlap, 1);
    assert_int_equal(info_of(clone).belt, 1);
    pkc_queue_free(clone);
}

/* n_max = A robots - O (robots - 1): with a long belt that many items are within reach. */
static void n_max_items_are_within_reach(void **state) {
    static const struct {
        const char *name;
        int n_max, alpha, shared, beta;
    } rows[] = {{"S-R1A1", 1, 0, 1, 0},   {"S-R5A1", 1, 0, 1, 0},   {"S-R5A3", 3, 0, 3, 0},
                {"D-R2A2O2", 2, 0, 2, 0}, {"D-R5A2O2", 2, 0, 2, 0}, {"D-R5A3O1", 5, 2, 1, 2},
                {"D-R8A4O0", 8, 4, 0, 4}, {"D-R9A4O3", 5, 1, 3, 1}};
    size_t i;
    (void)state;
    for (i = 0; i < sizeof rows / sizeof rows[0]; ++i) {
        pkc_queue *queue = check_queue(rows[i].name);
        pkc_queued items[20];
        pkc_queue_info info;
        size_t count = 0;
        int32_t id;
        int reached = 0;
        int place;
        for (id = 0; id < 20; ++id) check_push(queue, id, 1, 1);
        info = info_of(queue);
        assert_int_equal(info.k_alpha, rows[i].alpha);
        assert_int_equal(info.k_shared, rows[i].shared);
        assert_int_equal(info.k_beta, rows[i].beta);
        CHECK_OK(pkc_queue_belt(queue, items, 20, &count));
        for (place = 0; place < 20; ++place) {
            int want = 0;
            if (place < rows[i].alpha)
                want = 1;
            else if (place < rows[i].alpha + rows[i].shared)
                want = rows[i].name[0] == 'S' ? 1 : 3;
            else if (place < rows[i].n_max)
                want = 2;
            assert_int_equal(items[place].arms, want);
            reached += want != 0;
        }
        assert_int_equal(reached, rows[i].n_max);
        pkc_queue_free(queue);
    }
}

/* ---- The conveyor ---------------------------------------------------------------------------- */

/* The paper's conveyor logic for A 3, O 1 as the belt fills: with fewer than n_max = 5 items
 * k_O = min(total - k_alpha left, 1), k_alpha = floor(total / 2) + 1 - k_O, the rest is beta's. */
static void regions_of_a_filling_belt_follow_the_formulas(void **state) {
    static const int want[8][3] = {{0, 0, 0}, {0, 1, 0}, {1, 1, 0}, {1, 1, 1},
                                   {2, 1, 1}, {2, 1, 2}, {2, 1, 2}, {2, 1, 2}};
    pkc_queue *queue = check_queue("D-R5A3O1");
    int32_t total;
    (void)state;
    for (total = 0; total < 8; ++total) {
        const pkc_queue_info info = info_of(queue);
        assert_int_equal(info.belt, total);
        assert_int_equal(info.k_alpha, want[total][0]);
        assert_int_equal(info.k_shared, want[total][1]);
        assert_int_equal(info.k_beta, want[total][2]);
        check_push(queue, total, 1, 1);
    }
    pkc_queue_free(queue);
}

/* Every legal pick from belts of 1 to 7 items: items 0.. in arrival order, those taken, and the
 * regions afterwards; k_alpha left is what alpha held less what was taken from it. */
static void regions_after_picks_follow_the_formulas(void **state) {
    static const struct {
        int total;
        int taken[2];
        int count;
        int want[3];
    } rows[] = {{1, {0, -1}, 1, {0, 0, 0}}, {2, {1, -1}, 1, {1, 0, 0}}, {2, {0, -1}, 1, {0, 1, 0}},
                {2, {0, 1}, 2, {0, 0, 0}},  {3, {1, -1}, 1, {1, 1, 0}}, {3, {2, -1}, 1, {1, 1, 0}},
                {3, {0, -1}, 1, {1, 1, 0}}, {3, {0, 1}, 2, {0, 1, 0}},  {3, {0, 2}, 2, {0, 1, 0}},
                {3, {1, 2}, 2, {1, 0, 0}},  {4, {2, -1}, 1, {2, 1, 0}}, {4, {3, -1}, 1, {2, 1, 0}},
                {4, {0, -1}, 1, {1, 1, 1}}, {4, {0, 2}, 2, {1, 1, 0}},  {4, {0, 3}, 2, {1, 1, 0}},
                {4, {1, -1}, 1, {1, 1, 1}}, {4, {1, 2}, 2, {1, 1, 0}},  {4, {1, 3}, 2, {1, 1, 0}},
                {4, {2, 3}, 2, {2, 0, 0}},  {5, {2, -1}, 1, {2, 1, 1}}, {5, {3, -1}, 1, {2, 1, 1}},
                {5, {4, -1}, 1, {2, 1, 1}}, {5, {0, -1}, 1, {2, 1, 1}}, {5, {0, 2}, 2, {1, 1, 1}},
                {5, {0, 3}, 2, {1, 1, 1}},  {5, {0, 4}, 2, {1, 1, 1}},  {5, {1, -1}, 1, {2, 1, 1}},
                {5, {1, 2}, 2, {1, 1, 1}},  {5, {1, 3}, 2, {1, 1, 1}},  {5, {1, 4}, 2, {1, 1, 1}},
                {5, {2, 3}, 2, {2, 1, 0}},  {5, {2, 4}, 2, {2, 1, 0}},  {6, {2, -1}, 1, {2, 1, 2}},
                {6, {3, -1}, 1, {2, 1, 2}}, {6, {4, -1}, 1, {2, 1, 2}}, {6, {0, -1}, 1, {2, 1, 2}},
                {6, {0, 2}, 2, {2, 1, 1}},  {6, {0, 3}, 2, {2, 1, 1}},  {6, {0, 4}, 2, {2, 1, 1}},
                {6, {1, -1}, 1, {2, 1, 2}}, {6, {1, 2}, 2, {2, 1, 1}},  {6, {1, 3}, 2, {2, 1, 1}},
                {6, {1, 4}, 2, {2, 1, 1}},  {6, {2, 3}, 2, {2, 1, 1}},  {6, {2, 4}, 2, {2, 1, 1}},
                {7, {2, -1}, 1, {2, 1, 2}}, {7, {3, -1}, 1, {2, 1, 2}}, {7, {4, -1}, 1, {2, 1, 2}},
                {7, {0, -1}, 1, {2, 1, 2}}, {7, {0, 2}, 2, {2, 1, 2}},  {7, {0, 3}, 2, {2, 1, 2}},
                {7, {0, 4}, 2, {2, 1, 2}},  {7, {1, -1}, 1, {2, 1, 2}}, {7, {1, 2}, 2, {2, 1, 2}},
                {7, {1, 3}, 2, {2, 1, 2}},  {7, {1, 4}, 2, {2, 1, 2}},  {7, {2, 3}, 2, {2, 1, 2}},
                {7, {2, 4}, 2, {2, 1, 2}}};
    size_t i;
    (void)state;
    for (i = 0; i < sizeof rows / sizeof rows[0]; ++i) {
        pkc_queue *queue = check_queue("D-R5A3O1");
        pkc_bin *bin = check_bin(10, 10);
        pkc_queued items[8];
        pkc_action actions[2];
        pkc_queue_info info;
        size_t count = 0;
        int32_t id;
        int a;
        for (id = 0; id < rows[i].total; ++id) check_push(queue, id, 1, 1);
        CHECK_OK(pkc_queue_belt(queue, items, 8, &count));
        for (a = 0; a < rows[i].count; ++a) {
            /* A single pick by whichever arm reaches it; of two the first belongs to arm 0. */
            const int taken = rows[i].taken[a];
            const int arm = rows[i].count == 2 ? a : (items[taken].arms & 1) != 0 ? 0 : 1;
            actions[a] = make_action(PKC_OP_PACK, taken, a, 0, 0, arm);
        }
        CHECK_OK(pkc_step_apply(bin, queue, actions, (size_t)rows[i].count));
        info = info_of(queue);
        if (info.k_alpha != rows[i].want[0] || info.k_shared != rows[i].want[1] ||
            info.k_beta != rows[i].want[2]) {
            print_error("row %d: %d %d %d\n", (int)i, info.k_alpha, info.k_shared, info.k_beta);
            fail();
        }
        assert_int_equal(info.belt, rows[i].total - rows[i].count);
        pkc_bin_free(bin);
        pkc_queue_free(queue);
    }
}

static void belt_lists_items_in_arrival_order_with_reach(void **state) {
    static const int32_t arms[7] = {1, 1, 3, 2, 2, 0, 0};
    pkc_queue *queue = check_queue("D-R6A3O1");
    pkc_queued items[7];
    size_t count = 77;
    int32_t i;
    (void)state;
    CHECK_OK(pkc_queue_belt(queue, NULL, 0, &count));
    assert_int_equal(count, 0);
    for (i = 0; i < 7; ++i) check_push(queue, 10 - i, 1 + i, 2);
    memset(items, 0x5a, sizeof items);
    CHECK_FAILS(PKC_E_CAPACITY, "7", pkc_queue_belt(queue, items, 6, &count));
    assert_int_equal(count, 7);
    assert_int_equal(items[0].arms, 0x5a5a5a5a);
    CHECK_FAILS(PKC_E_CAPACITY, "7", pkc_queue_belt(queue, NULL, 0, &count));
    CHECK_OK(pkc_queue_belt(queue, items, 7, &count));
    for (i = 0; i < 7; ++i) {
        assert_int_equal(items[i].item.id, 10 - i);
        assert_int_equal(items[i].item.w, 1 + i);
        assert_int_equal(items[i].arms, arms[i]);
        assert_int_equal(items[i].recognized, i < 6);
    }
    pkc_queue_free(queue);
}

static void buffer_lists_items_in_the_order_they_were_unpacked(void **state) {
    pkc_queue *queue = check_queue("D-R2A2O2");
    pkc_bin *bin = check_bin(5, 5);
    pkc_action actions[2];
    pkc_queued items[2];
    size_t count = 77;
    (void)state;
    check_pack(bin, 3, 1, 1, 0, 0);
    check_pack(bin, 4, 2, 1, 1, 0);
    actions[0] = make_action(PKC_OP_UNPACK, 4, 0, 0, 0, 1);
    actions[1] = make_action(PKC_OP_UNPACK, 3, 0, 0, 0, 0);
    CHECK_OK(pkc_queue_buffer(queue, NULL, 0, &count));
    assert_int_equal(count, 0);
    CHECK_OK(pkc_step_apply(bin, queue, actions, 2));
    assert_int_equal(info_of(queue).buffered, 2);
    CHECK_FAILS(PKC_E_CAPACITY, "2", pkc_queue_buffer(queue, items, 1, &count));
    assert_int_equal(count, 2);
    CHECK_FAILS(PKC_E_ARGUMENT, "items is NULL", pkc_queue_buffer(queue, NULL, 2, &count));
    CHECK_OK(pkc_queue_buffer(queue, items, 2, &count));
    assert_int_equal(items[0].item.id, 4);
    assert_int_equal(items[0].item.w, 2);
    assert_int_equal(items[0].arms, 2);
    assert_int_equal(items[0].recognized, 1);
    assert_int_equal(items[1].item.id, 3);
    assert_int_equal(items[1].arms, 1);
    pkc_bin_free(bin);
    pkc_queue_free(queue);
}

static void push_refuses_wrong_and_duplicate_items(void **state) {
    pkc_queue *queue = check_queue("S-R1A1");
    pkc_bin *bin = check_bin(2, 2);
    const pkc_action unpack = make_action(PKC_OP_UNPACK, 6, 0, 0, 0, 0);
    check_state before;
    pkc_item item;
    (void)state;
    check_push(queue, 5, 1, 1);
    check_pack(bin, 6, 1, 1, 0, 0);
    CHECK_OK(pkc_step_apply(bin, queue, &unpack, 1));
    before = check_remember(bin, queue);
    item = check_item(5, 2, 2, 0);
    CHECK_FAILS(PKC_E_STATE, "item 5", pkc_queue_push(queue, &item));
    item = check_item(6, 2, 2, 0); /* in a buffer */
    CHECK_FAILS(PKC_E_STATE, "item 6", pkc_queue_push(queue, &item));
    item = check_item(-1, 2, 2, 0);
    CHECK_FAILS(PKC_E_ARGUMENT, "id -1", pkc_queue_push(queue, &item));
    item = check_item(7, 0, 2, 0);
    CHECK_FAILS(PKC_E_ARGUMENT, "w 0", pkc_queue_push(queue, &item));
    item = check_item(7, 2, 129, 0);
    CHECK_FAILS(PKC_E_ARGUMENT, "h 129", pkc_queue_push(queue, &item));
    item = check_item(7, INT_MIN, 2, 0);
    CHECK_FAILS(PKC_E_ARGUMENT, "w -2147483648", pkc_queue_push(queue, &item));
    item = check_item(7, 2, 2, 8);
    CHECK_FAILS(PKC_E_ARGUMENT, "flags 8", pkc_queue_push(queue, &item));
    CHECK_FAILS(PKC_E_STATE, "item 7", pkc_queue_remove(queue, 7));
    CHECK_FAILS(PKC_E_STATE, "item -1", pkc_queue_remove(queue, -1));
    check_unchanged(&before, bin, queue);
    pkc_bin_free(bin);
    pkc_queue_free(queue);
}

static void remove_takes_items_from_belt_and_buffer(void **state) {
    pkc_queue *queue = check_queue("S-R3A2");
    pkc_bin *bin = check_bin(2, 2);
    const pkc_action unpack = make_action(PKC_OP_UNPACK, 9, 0, 0, 0, 0);
    pkc_queued items[3];
    size_t count = 0;
    int32_t i;
    (void)state;
    for (i = 0; i < 4; ++i) check_push(queue, i, 1, 1);
    check_pack(bin, 9, 1, 1, 0, 0);
    CHECK_OK(pkc_step_apply(bin, queue, &unpack, 1));
    CHECK_OK(pkc_queue_remove(queue, 9));
    assert_int_equal(info_of(queue).buffered, 0);
    CHECK_OK(pkc_queue_remove(queue, 1));
    CHECK_OK(pkc_queue_belt(queue, items, 3, &count));
    assert_int_equal(items[0].item.id, 0);
    assert_int_equal(items[1].item.id, 2);
    assert_int_equal(items[1].arms, 1); /* the belt has advanced */
    assert_int_equal(items[2].item.id, 3);
    assert_int_equal(items[2].arms, 0);
    assert_int_equal(items[2].recognized, 1);
    pkc_bin_free(bin);
    pkc_queue_free(queue);
}

/* The front of the belt is dropped in bulk now and then: the order must not notice. */
static void a_long_belt_keeps_its_order(void **state) {
    pkc_queue *queue = check_queue("S-R4A3");
    int32_t pushed = 0;
    int32_t first = 0;
    uint64_t seed = 11;
    (void)state;
    while (pushed < 6000) {
        pkc_queue_info info;
        check_push(queue, pushed, 1, 1);
        ++pushed;
        if (check_draw(&seed, 0, 3) == 0) continue;
        CHECK_OK(pkc_queue_remove(queue, first));
        ++first;
        info = info_of(queue);
        assert_int_equal(info.belt, pushed - first);
        if (info.belt > 0 && info.belt < 2000 && pushed % 97 == 0) {
            static pkc_queued items[2000];
            size_t count = 0;
            size_t i;
            CHECK_OK(pkc_queue_belt(queue, items, 2000, &count));
            for (i = 0; i < count; ++i) assert_int_equal(items[i].item.id, first + (int32_t)i);
        }
    }
    pkc_queue_free(queue);
}

static void every_null_is_named(void **state) {
    pkc_queue *queue = check_queue("S-R1A1");
    pkc_bin *bin = check_bin(2, 2);
    pkc_queue *other = NULL;
    pkc_queue_info info;
    pkc_scenario scenario;
    pkc_queued item;
    const pkc_action end = make_action(PKC_OP_TERMINATE, 0, 0, 0, 0, 0);
    const pkc_item thing = check_item(0, 1, 1, 0);
    size_t count = 77;
    uint64_t hash = 77;
    char name[32];
    (void)state;
    CHECK_OK(pkc_queue_info_init(&info, sizeof info));
    CHECK_OK(pkc_scenario_init(&scenario, sizeof scenario));
    CHECK_FAILS(PKC_E_ARGUMENT, "scenario is NULL", pkc_scenario_name(NULL, name, 32));
    CHECK_FAILS(PKC_E_ARGUMENT, "name is NULL", pkc_scenario_name(&scenario, NULL, 32));
    CHECK_FAILS(PKC_E_ARGUMENT, "scenario is NULL", pkc_queue_create(NULL, &other));
    CHECK_FAILS(PKC_E_ARGUMENT, "out_queue is NULL", pkc_queue_create(&scenario, NULL));
    CHECK_FAILS(PKC_E_ARGUMENT, "queue is NULL", pkc_queue_clone(NULL, &other));
    CHECK_FAILS(PKC_E_ARGUMENT, "out_queue is NULL", pkc_queue_clone(queue, NULL));
    CHECK_FAILS(PKC_E_ARGUMENT, "queue is NULL", pkc_queue_push(NULL, &thing));
    CHECK_FAILS(PKC_E_ARGUMENT, "item is NULL", pkc_queue_push(queue, NULL));
    CHECK_FAILS(PKC_E_ARGUMENT, "queue is NULL", pkc_queue_remove(NULL, 0));
    CHECK_FAILS(PKC_E_ARGUMENT, "queue is NULL", pkc_queue_get_scenario(NULL, &scenario));
    CHECK_FAILS(PKC_E_ARGUMENT, "scenario is NULL", pkc_queue_get_scenario(queue, NULL));
    CHECK_FAILS(PKC_E_ARGUMENT, "queue is NULL", pkc_queue_get_info(NULL, &info));
    CHECK_FAILS(PKC_E_ARGUMENT, "info is NULL", pkc_queue_get_info(queue, NULL));
    CHECK_FAILS(PKC_E_ARGUMENT, "queue is NULL", pkc_queue_belt(NULL, &item, 1, &count));
    CHECK_FAILS(PKC_E_ARGUMENT, "out_count is NULL", pkc_queue_belt(queue, &item, 1, NULL));
    CHECK_FAILS(PKC_E_ARGUMENT, "queue is NULL", pkc_queue_buffer(NULL, &item, 1, &count));
    CHECK_FAILS(PKC_E_ARGUMENT, "out_count is NULL", pkc_queue_buffer(queue, &item, 1, NULL));
    CHECK_FAILS(PKC_E_ARGUMENT, "bin is NULL", pkc_step_apply(NULL, queue, &end, 1));
    CHECK_FAILS(PKC_E_ARGUMENT, "queue is NULL", pkc_step_apply(bin, NULL, &end, 1));
    CHECK_FAILS(PKC_E_ARGUMENT, "actions is NULL", pkc_step_apply(bin, queue, NULL, 1));
    CHECK_FAILS(PKC_E_ARGUMENT, "actions is NULL", pkc_plan_hash(NULL, 1, &hash));
    CHECK_FAILS(PKC_E_ARGUMENT, "out_hash is NULL", pkc_plan_hash(&end, 1, NULL));
    check_push(queue, 0, 1, 1);
    CHECK_FAILS(PKC_E_ARGUMENT, "items is NULL", pkc_queue_belt(queue, NULL, 1, &count));
    assert_null(other);
    assert_int_equal(count, 77);
    assert_int_equal(hash, 77);
    CHECK_OK(pkc_step_apply(bin, queue, NULL, 0));
    pkc_bin_free(bin);
    pkc_queue_free(queue);
}

/* ---- Steps ----------------------------------------------------------------------------------- */

static void a_step_packs_unpacks_skips_and_advances(void **state) {
    pkc_queue *queue = check_queue("D-R5A3O1");
    pkc_bin *bin = check_bin(6, 6);
    pkc_action actions[6];
    pkc_placement placements[4];
    size_t count = 0;
    int32_t i;
    (void)state;
    check_pack(bin, 50, 2, 2, 0, 0);
    for (i = 0; i < 6; ++i) check_push(queue, i, 2, 1); /* 0 1 | 2 | 3 4 | 5 */
    actions[0] = make_action(PKC_OP_UNPACK, 50, 0, 0, 0, 1);
    actions[1] = make_action(PKC_OP_PACK, 2, 0, 0, 1, 0);
    actions[2] = make_action(PKC_OP_PACK, 50, 4, 4, 0, 1);
    actions[3] = make_action(PKC_OP_PACK, 4, 1, 0, 0, 1);
    actions[4] = make_action(PKC_OP_SKIP, 0, 0, 0, 0, 0);
    actions[5] = make_action(PKC_OP_TERMINATE, 0, 0, 0, 0, 0);
    CHECK_OK(pkc_step_apply(bin, queue, actions, 6));
    CHECK_OK(pkc_bin_items(bin, placements, 4, &count));
    assert_int_equal(count, 3);
    assert_int_equal(placements[0].item.id, 2);
    assert_int_equal(placements[0].rot, 1);
    assert_int_equal(placements[1].item.id, 50);
    assert_int_equal(placements[1].x, 4);
    assert_int_equal(placements[2].item.id, 4);
    assert_int_equal(info_of(queue).belt, 3);
    assert_int_equal(info_of(queue).buffered, 0);
    pkc_bin_free(bin);
    pkc_queue_free(queue);
}

static void terminate_changes_nothing(void **state) {
    static const char *const names[] = {"S-R5A3", "D-R2A2O2", "D-R5A3O1"};
    const pkc_action end = make_action(PKC_OP_TERMINATE, 0, 0, 0, 0, 0);
    size_t s;
    int32_t total;
    (void)state;
    for (s = 0; s < 3; ++s) {
        for (total = 0; total < 8; ++total) {
            pkc_queue *queue = check_queue(names[s]);
            pkc_bin *bin = check_bin(4, 4);
            pkc_queue_info before;
            pkc_queue_info after;
            int32_t i;
            check_pack(bin, 50, 2, 2, 0, 0);
            for (i = 0; i < total; ++i) check_push(queue, i, 2, 1);
            before = info_of(queue);
            CHECK_OK(pkc_step_apply(bin, queue, &end, 1));
            after = info_of(queue);
            before.alpha_left = after.alpha_left;
            assert_memory_equal(&before, &after, sizeof before);
            pkc_bin_free(bin);
            pkc_queue_free(queue);
        }
    }
}

/* Belt 0 1 | 2 | 3 4 | 5 of D-R5A3O1; 20 in arm 0's buffer; 30, 31 (pinned) and a fixed cell in the
 * 6 x 6 bin; item 1 must not be turned. */
static void rules_are_enforced_and_a_broken_one_changes_nothing(void **state) {
    struct {
        pkc_action actions[3];
        size_t count;
        size_t at; /* of the action that breaks the rule */
    } cases[40];
    size_t n = 0;
    size_t i;
    pkc_queue *queue = check_queue("D-R5A3O1");
    pkc_bin *bin = check_bin(6, 6);
    const pkc_item pinned = check_item(31, 1, 1, PKC_ITEM_PINNED);
    const pkc_item straight = check_item(1, 2, 1, PKC_ITEM_NO_ROTATE);
    const pkc_action unpack_20 = make_action(PKC_OP_UNPACK, 20, 0, 0, 0, 0);
    const pkc_action end = make_action(PKC_OP_TERMINATE, 0, 0, 0, 0, 0);
    int32_t id;
    (void)state;
    check_pack(bin, 20, 2, 2, 0, 0);
    check_pack(bin, 30, 2, 2, 4, 4);
    CHECK_OK(pkc_bin_pack(bin, &pinned, 0, 5, 0));
    CHECK_OK(pkc_bin_block(bin, 5, 0, 1, 1));
    check_push(queue, 0, 2, 1);
    CHECK_OK(pkc_queue_push(queue, &straight));
    for (id = 2; id < 6; ++id) check_push(queue, id, 2, 1);
    CHECK_OK(pkc_step_apply(bin, queue, &unpack_20, 1));
#define ONE(action)                   \
    do {                              \
        cases[n].actions[0] = action; \
        cases[n].count = 1;           \
        cases[n].at = 0;              \
        ++n;                          \
    } while (0)
#define TWO(first, second)            \
    do {                              \
        cases[n].actions[0] = first;  \
        cases[n].actions[1] = second; \
        cases[n].count = 2;           \
        cases[n].at = 1;              \
        ++n;                          \
    } while (0)
    ONE(make_action(PKC_OP_PACK, 5, 0, 0, 0, 1)); /* out of reach */
    ONE(make_action(PKC_OP_PACK, 0, 0, 0, 0, 1)); /* alpha's, by arm 1 */
    ONE(make_action(PKC_OP_PACK, 3, 0, 0, 0, 0)); /* beta's, by arm 0 */
    ONE(make_action(PKC_OP_PACK, 0, 0, 0, 0, 2)); /* no such arm */
    ONE(make_action(PKC_OP_PACK, 0, 0, 0, 0, -1));
    ONE(make_action(PKC_OP_PACK, 0, 0, 0, 0, INT_MAX));
    ONE(make_action(PKC_OP_PACK, 0, 0, 0, 0, INT_MIN));
    TWO(make_action(PKC_OP_PACK, 0, 0, 0, 0, 0),
        make_action(PKC_OP_PACK, 2, 0, 1, 0, 0)); /* two by one arm */
    TWO(make_action(PKC_OP_PACK, 2, 0, 0, 0, 0),
        make_action(PKC_OP_PACK, 2, 0, 1, 0, 1));  /* one item twice */
    ONE(make_action(PKC_OP_PACK, 20, 0, 0, 0, 1)); /* foreign buffer */
    TWO(make_action(PKC_OP_PACK, 20, 0, 0, 0, 0), make_action(PKC_OP_PACK, 20, 2, 2, 0, 0));
    ONE(make_action(PKC_OP_PACK, 0, 4, 4, 0, 0)); /* overlap */
    ONE(make_action(PKC_OP_PACK, 0, 4, 0, 0, 0)); /* fixed cell */
    TWO(make_action(PKC_OP_PACK, 0, 0, 0, 0, 0), make_action(PKC_OP_PACK, 3, 1, 0, 0, 1));
    ONE(make_action(PKC_OP_PACK, 0, 5, 2, 0, 0)); /* outside */
    ONE(make_action(PKC_OP_PACK, 0, -1, 0, 0, 0));
    ONE(make_action(PKC_OP_PACK, 0, 0, 6, 0, 0));
    ONE(make_action(PKC_OP_PACK, 0, INT_MAX, 0, 0, 0));
    ONE(make_action(PKC_OP_PACK, 0, INT_MIN, 0, 0, 0));
    ONE(make_action(PKC_OP_PACK, 0, 0, INT_MAX, 0, 0));
    ONE(make_action(PKC_OP_PACK, 0, 0, 0, 2, 0)); /* rot */
    ONE(make_action(PKC_OP_PACK, 0, 0, 0, -1, 0));
    ONE(make_action(PKC_OP_PACK, 1, 0, 0, 1, 0));    /* no-rotate */
    ONE(make_action(PKC_OP_PACK, 30, 0, 0, 0, 0));   /* in the bin */
    ONE(make_action(PKC_OP_PACK, 99, 0, 0, 0, 0));   /* nowhere */
    ONE(make_action(PKC_OP_UNPACK, 31, 0, 0, 0, 0)); /* pinned */
    ONE(make_action(PKC_OP_UNPACK, 0, 0, 0, 0, 0));  /* on the belt */
    ONE(make_action(PKC_OP_UNPACK, 20, 0, 0, 0, 0)); /* in a buffer */
    ONE(make_action(PKC_OP_UNPACK, 30, 0, 0, 0, 2));
    TWO(make_action(PKC_OP_UNPACK, 30, 0, 0, 0, 0), make_action(PKC_OP_UNPACK, 30, 0, 0, 0, 0));
    TWO(make_action(PKC_OP_UNPACK, 30, 0, 0, 0, 1),
        make_action(PKC_OP_PACK, 30, 0, 0, 0, 0)); /* foreign */
    ONE(make_action(PKC_OP_SKIP, 5, 0, 0, 0, 0));  /* out of reach */
    ONE(make_action(PKC_OP_SKIP, 20, 0, 0, 0, 0)); /* in a buffer */
    TWO(make_action(PKC_OP_SKIP, 0, 0, 0, 0, 0), make_action(PKC_OP_SKIP, 0, 0, 0, 0, 0));
    TWO(make_action(PKC_OP_SKIP, 0, 0, 0, 0, 0), make_action(PKC_OP_PACK, 0, 0, 0, 0, 0));
    TWO(end, end); /* after the end */
    TWO(end, make_action(PKC_OP_PACK, 0, 0, 0, 0, 0));
    ONE(make_action(0, 0, 0, 0, 0, 0)); /* unknown op */
    ONE(make_action(5, 0, 0, 0, 0, 0));
    ONE(make_action(INT_MIN, 0, 0, 0, 0, 0));
    assert_int_equal(n, sizeof cases / sizeof cases[0]);
    for (i = 0; i < n; ++i) {
        check_state before = check_remember(bin, queue);
        char text[32];
        snprintf(text, sizeof text, "actions[%d]", (int)cases[i].at);
        CHECK_FAILS(PKC_E_STATE, text,
                    pkc_step_apply(bin, queue, cases[i].actions, cases[i].count));
        check_unchanged(&before, bin, queue);
    }
    pkc_bin_free(bin);
    pkc_queue_free(queue);
}

/* An id that bin and belt both hold is the caller's mistake; it must not get worse, two items of
 * one id in the queue. */
static void unpacking_never_makes_an_id_occur_twice_in_the_queue(void **state) {
    pkc_queue *queue = check_queue("S-R1A1");
    pkc_bin *bin = check_bin(3, 3);
    const pkc_action unpack = make_action(PKC_OP_UNPACK, 1, 0, 0, 0, 0);
    (void)state;
    check_pack(bin, 1, 1, 1, 0, 0);
    check_push(queue, 1, 1, 1);
    CHECK_FAILS(PKC_E_STATE, "item 1", pkc_step_apply(bin, queue, &unpack, 1));
    pkc_bin_free(bin);
    pkc_queue_free(queue);
}

/* ---- Plan hash ------------------------------------------------------------------------------- */

static void plan_hash_is_fnv1a_of_little_endian_words(void **state) {
    pkc_action actions[3];
    uint64_t want = 0xcbf29ce484222325u;
    uint64_t hash = 0;
    size_t i;
    int k;
    int b;
    (void)state;
    CHECK_OK(pkc_plan_hash(NULL, 0, &hash));
    assert_true(hash == want);
    actions[0] = make_action(PKC_OP_UNPACK, 7, 0, 0, 0, 1);
    actions[1] = make_action(PKC_OP_PACK, 0x01020304, 3, 127, 1, 0);
    actions[2] = make_action(PKC_OP_TERMINATE, 0, 0, 0, 0, -1);
    for (i = 0; i < 3; ++i) {
        const int32_t words[6] = {actions[i].op, actions[i].item, actions[i].x,
                                  actions[i].y,  actions[i].rot,  actions[i].arm};
        for (k = 0; k < 6; ++k) {
            for (b = 0; b < 4; ++b) {
                want ^= ((uint32_t)words[k] >> (8 * b)) & 0xffu;
                want *= 0x100000001b3u;
            }
        }
    }
    CHECK_OK(pkc_plan_hash(actions, 3, &hash));
    assert_true(hash == want);
    actions[1].x = 4;
    CHECK_OK(pkc_plan_hash(actions, 3, &hash));
    assert_true(hash != want);
}

/* ---- Queues changed from without ------------------------------------------------------------- */

/* What a gateway does on the arms' word leaves the queue as the planned step would have. */
static void items_removed_together_leave_the_belt_as_a_step_does(void **state) {
    static const int32_t taken[2] = {1, 3};
    pkc_queue *stepped = check_queue("D-R5A3O1");
    pkc_queue *edited = check_queue("D-R5A3O1");
    pkc_bin *bin = check_bin(10, 10);
    pkc_action actions[2];
    uint8_t a[4096], b[4096];
    size_t a_size = 0, b_size = 0;
    int32_t id;
    (void)state;
    for (id = 0; id < 6; ++id) {
        check_push(stepped, id, 1, 1);
        check_push(edited, id, 1, 1);
    }
    actions[0] = make_action(PKC_OP_PACK, taken[0], 0, 0, 0, 0);
    actions[1] = make_action(PKC_OP_PACK, taken[1], 1, 0, 0, 1);
    CHECK_OK(pkc_step_apply(bin, stepped, actions, 2));
    CHECK_OK(pkc_queue_remove_items(edited, taken, 2));
    CHECK_OK(pkc_snapshot_save(bin, stepped, a, sizeof a, &a_size));
    CHECK_OK(pkc_snapshot_save(bin, edited, b, sizeof b, &b_size));
    assert_int_equal(a_size, b_size);
    assert_memory_equal(a, b, a_size);
    pkc_bin_free(bin);
    pkc_queue_free(stepped);
    pkc_queue_free(edited);
}

static void removing_items_is_all_or_nothing(void **state) {
    static const int32_t strange[2] = {0, 7};
    static const int32_t twice[2] = {1, 1};
    static const int32_t everywhere[2] = {9, 2};
    const pkc_item buffered = {9, 2, 2, 0};
    pkc_queue *queue = check_queue("S-R5A3");
    int32_t id;
    (void)state;
    for (id = 0; id < 3; ++id) check_push(queue, id, 1, 1);
    CHECK_OK(pkc_queue_put_in_buffer(queue, &buffered, 0));
    CHECK_FAILS(PKC_E_STATE, "ids[1] 7: is not in the queue",
                pkc_queue_remove_items(queue, strange, 2));
    CHECK_FAILS(PKC_E_STATE, "ids[1] 1: is named twice", pkc_queue_remove_items(queue, twice, 2));
    CHECK_FAILS(PKC_E_ARGUMENT, "ids", pkc_queue_remove_items(queue, NULL, 1));
    assert_int_equal(info_of(queue).belt, 3);
    assert_int_equal(info_of(queue).buffered, 1);
    CHECK_OK(pkc_queue_remove_items(queue, NULL, 0));
    CHECK_OK(pkc_queue_remove_items(queue, everywhere, 2));
    assert_int_equal(info_of(queue).belt, 2);
    assert_int_equal(info_of(queue).buffered, 0);
    pkc_queue_free(queue);
}

static void an_item_put_in_a_buffer_is_packed_by_its_arm(void **state) {
    const pkc_item item = {5, 2, 3, 0};
    pkc_queue *queue = check_queue("D-R5A3O1");
    pkc_bin *bin = check_bin(10, 10);
    pkc_action action = make_action(PKC_OP_PACK, 5, 0, 0, 0, 0);
    (void)state;
    CHECK_FAILS(PKC_E_ARGUMENT, "arm 2", pkc_queue_put_in_buffer(queue, &item, 2));
    CHECK_FAILS(PKC_E_ARGUMENT, "item", pkc_queue_put_in_buffer(queue, NULL, 0));
    CHECK_OK(pkc_queue_put_in_buffer(queue, &item, 1));
    CHECK_FAILS(PKC_E_STATE, "in the queue already", pkc_queue_put_in_buffer(queue, &item, 0));
    CHECK_FAILS(PKC_E_STATE, "other arm's buffer", pkc_step_apply(bin, queue, &action, 1));
    action.arm = 1;
    CHECK_OK(pkc_step_apply(bin, queue, &action, 1));
    assert_int_equal(info_of(queue).buffered, 0);
    pkc_bin_free(bin);
    pkc_queue_free(queue);
}

/* Every state that steps lead to is rebuilt from its items and its alpha_left. */
static void a_queue_is_rebuilt_from_its_items_and_alpha_left(void **state) {
    uint64_t seed = 11;
    int round;
    (void)state;
    print_message("seed %d\n", (int)seed);
    for (round = 0; round < 300; ++round) {
        pkc_queue *queue = check_queue("D-R5A3O1");
        pkc_bin *bin = check_bin(10, 10);
        int32_t id = 0;
        while (id < 9) check_push(queue, id++, 1, 1);
        while (info_of(queue).belt > 0) {
            pkc_queue *rebuilt = check_queue("D-R5A3O1");
            pkc_queued items[16];
            size_t count = 0, i;
            int32_t gone;
            CHECK_OK(pkc_queue_belt(queue, items, 16, &count));
            for (i = 0; i < count; ++i) CHECK_OK(pkc_queue_push(rebuilt, &items[i].item));
            CHECK_OK(pkc_queue_set_alpha_left(rebuilt, info_of(queue).alpha_left));
            assert_int_equal(info_of(rebuilt).k_alpha, info_of(queue).k_alpha);
            assert_int_equal(info_of(rebuilt).k_shared, info_of(queue).k_shared);
            assert_int_equal(info_of(rebuilt).k_beta, info_of(queue).k_beta);
            pkc_queue_free(rebuilt);
            gone = items[check_draw(&seed, 0, (int32_t)count - 1)].item.id;
            CHECK_OK(pkc_queue_remove_items(queue, &gone, 1));
        }
        CHECK_FAILS(PKC_E_ARGUMENT, "alpha_left 65", pkc_queue_set_alpha_left(queue, 65));
        CHECK_FAILS(PKC_E_ARGUMENT, "alpha_left -1", pkc_queue_set_alpha_left(queue, -1));
        pkc_bin_free(bin);
        pkc_queue_free(queue);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(names_are_parsed_and_given_back),
        cmocka_unit_test(wrong_names_are_refused_and_quoted),
        cmocka_unit_test(every_field_of_a_scenario_is_checked),
        cmocka_unit_test(queues_keep_their_scenario),
        cmocka_unit_test(n_max_items_are_within_reach),
        cmocka_unit_test(regions_of_a_filling_belt_follow_the_formulas),
        cmocka_unit_test(regions_after_picks_follow_the_formulas),
        cmocka_unit_test(belt_lists_items_in_arrival_order_with_reach),
        cmocka_unit_test(buffer_lists_items_in_the_order_they_were_unpacked),
        cmocka_unit_test(push_refuses_wrong_and_duplicate_items),
        cmocka_unit_test(remove_takes_items_from_belt_and_buffer),
        cmocka_unit_test(a_long_belt_keeps_its_order),
        cmocka_unit_test(every_null_is_named),
        cmocka_unit_test(a_step_packs_unpacks_skips_and_advances),
        cmocka_unit_test(terminate_changes_nothing),
        cmocka_unit_test(rules_are_enforced_and_a_broken_one_changes_nothing),
        cmocka_unit_test(unpacking_never_makes_an_id_occur_twice_in_the_queue),
        cmocka_unit_test(plan_hash_is_fnv1a_of_little_endian_words),
        cmocka_unit_test(items_removed_together_leave_the_belt_as_a_step_does),
        cmocka_unit_test(removing_items_is_all_or_nothing),
        cmocka_unit_test(an_item_put_in_a_buffer_is_packed_by_its_arm),
        cmocka_unit_test(a_queue_is_rebuilt_from_its_items_and_alpha_left),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
