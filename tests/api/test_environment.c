/* Environments play by the rules of the bin: each step is done again on a pkc_bin. */
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

#define MOST_BINS 24
#define MOST_CELLS 400
#define MOST_ACTIONS (2 * MOST_CELLS + 1)

/* What one environment's bins show, and a bin of the library for each of them. */
typedef struct scene {
    pkc_environment *environment;
    pkc_environment_options options;
    pkc_environment_info info;
    pkc_bin *bins[MOST_BINS];
    int32_t packed[MOST_BINS];
    int32_t actions[MOST_BINS];
    double rewards[MOST_BINS];
    int32_t contacts[MOST_BINS];
    uint8_t closed[MOST_BINS];
    uint8_t cells[MOST_BINS * MOST_CELLS];
    int32_t sizes[2 * MOST_BINS];
    uint8_t mask[MOST_BINS * MOST_ACTIONS];
    int32_t occupied[MOST_BINS];
} scene;

static pkc_environment_options default_options(void) {
    pkc_environment_options options;
    CHECK_OK(pkc_environment_options_init(&options, sizeof options));
    return options;
}

static pkc_environment_info info_of(const pkc_environment *environment) {
    pkc_environment_info info;
    CHECK_OK(pkc_environment_info_init(&info, sizeof info));
    CHECK_OK(pkc_environment_get_info(environment, &info));
    return info;
}

static void observe(scene *s) {
    CHECK_OK(pkc_environment_observe(s->environment, NULL, (size_t)s->info.count, s->cells,
                                     s->sizes, s->mask, s->occupied));
}

static scene *make_scene(const pkc_environment_options *options, uint64_t seed) {
    scene *s = calloc(1, sizeof *s);
    int32_t i;
    assert_non_null(s);
    s->options = *options;
    CHECK_OK(pkc_environment_create(options, &s->environment));
    s->info = info_of(s->environment);
    assert_true(s->info.count <= MOST_BINS && s->info.bin_w * s->info.bin_h <= MOST_CELLS);
    for (i = 0; i < s->info.count; ++i) s->bins[i] = check_bin(options->bin_w, options->bin_h);
    CHECK_OK(pkc_environment_reset(s->environment, &seed, 1));
    observe(s);
    return s;
}

static void free_scene(scene *s) {
    int32_t i;
    for (i = 0; i < s->info.count; ++i) pkc_bin_free(s->bins[i]);
    pkc_environment_free(s->environment);
    free(s);
}

/* The cells and the mask that are shown of bin i are those of its pkc_bin. */
static void check_shown(const scene *s, int32_t i) {
    const int32_t cells = s->info.bin_w * s->info.bin_h;
    const uint8_t *mask = s->mask + i * s->info.actions;
    const int32_t w = s->sizes[2 * i];
    const int32_t h = s->sizes[2 * i + 1];
    int32_t ids[MOST_CELLS];
    uint8_t feasible[MOST_CELLS + 1];
    size_t count = 0;
    int32_t at;
    int32_t any = 0;
    assert_in_range(w, s->options.least_side, s->options.most_side);
    assert_in_range(h, s->options.least_side, s->options.most_side);
    CHECK_OK(pkc_bin_cells(s->bins[i], ids, MOST_CELLS, &count));
    for (at = 0; at < cells; ++at)
        assert_int_equal(s->cells[i * cells + at], ids[at] != PKC_CELL_FREE);
    CHECK_OK(pkc_bin_feasible(s->bins[i], w, h, feasible, MOST_CELLS + 1, &count));
    assert_memory_equal(mask, feasible, (size_t)cells);
    any = !feasible[cells];
    if (s->info.actions > cells + 1) {
        uint8_t none[MOST_CELLS] = {0};
        const uint8_t *turned = mask + cells;
        CHECK_OK(pkc_bin_feasible(s->bins[i], h, w, feasible, MOST_CELLS + 1, &count));
        /* Where each bin draws whether its items may be turned, either is right. */
        if (w == h || (s->options.rotation == PKC_ROTATION_MIXED && turned[0] != feasible[0] &&
                       memcmp(turned, none, (size_t)cells) == 0)) {
            assert_memory_equal(turned, none, (size_t)cells);
        } else if (s->options.rotation == PKC_ROTATION_ON) {
            assert_memory_equal(turned, feasible, (size_t)cells);
        }
        any = memchr(mask, 1, (size_t)(2 * cells)) != NULL;
    }
    assert_int_equal(any, 1);
    assert_int_equal(mask[s->info.actions - 1], 0);
}

static int32_t draw_action(const uint8_t *mask, int32_t actions, uint64_t *seed) {
    int32_t allowed[MOST_ACTIONS];
    int32_t count = 0;
    int32_t a;
    for (a = 0; a < actions; ++a)
        if (mask[a]) allowed[count++] = a;
    assert_true(count > 0);
    return allowed[check_draw(seed, 0, count - 1)];
}

/* Does action i of the last step on the bin of the library, and compares what was told. */
static void check_step(scene *s, int32_t i, int32_t w, int32_t h) {
    const int32_t cells = s->info.bin_w * s->info.bin_h;
    const int32_t rot = s->actions[i] >= cells;
    const int32_t x = s->actions[i] % cells % s->info.bin_w;
    const int32_t y = s->actions[i] % cells / s->info.bin_w;
    const pkc_item item = check_item(s->packed[i]++, w, h, 0);
    const double share = s->options.reward_fill;
    pkc_bin_info bin;
    int32_t contact = 0;
    double reward;
    CHECK_OK(pkc_bin_contact(s->bins[i], x, y, rot ? h : w, rot ? w : h, &contact));
    assert_int_equal(s->contacts[i], contact);
    CHECK_OK(pkc_bin_pack(s->bins[i], &item, x, y, rot));
    CHECK_OK(pkc_bin_info_init(&bin, sizeof bin));
    CHECK_OK(pkc_bin_get_info(s->bins[i], &bin));
    assert_int_equal(s->occupied[i], bin.occupied_cells);
    reward = (1 - share) * contact / 20;
    if (s->closed[i]) reward += share * bin.occupied_cells / cells;
    assert_true(reward - s->rewards[i] < 1e-12 && s->rewards[i] - reward < 1e-12);
}

/* A closed bin shows its end: the only action left is "no position", and with items 0 the next
 * item has none. */
static void check_closed(const scene *s, int32_t i) {
    const int32_t cells = s->info.bin_w * s->info.bin_h;
    const uint8_t *mask = s->mask + i * s->info.actions;
    uint8_t feasible[MOST_CELLS + 1];
    size_t count = 0;
    int32_t at;
    for (at = 0; at < s->info.actions - 1; ++at) assert_int_equal(mask[at], 0);
    assert_int_equal(mask[s->info.actions - 1], 1);
    CHECK_OK(pkc_bin_feasible(s->bins[i], s->sizes[2 * i], s->sizes[2 * i + 1], feasible,
                              MOST_CELLS + 1, &count));
    if (s->options.items == 0) assert_int_equal(feasible[cells], 1);
}

static void play(const pkc_environment_options *options, uint64_t seed, int steps) {
    scene *s = make_scene(options, seed);
    uint64_t random = seed + 17;
    uint64_t bins = 0;
    int32_t sizes[2 * MOST_BINS];
    int32_t i;
    int k;
    for (k = 0; k < steps; ++k) {
        int32_t closed = 0;
        for (i = 0; i < s->info.count; ++i) {
            check_shown(s, i);
            s->actions[i] = draw_action(s->mask + i * s->info.actions, s->info.actions, &random);
        }
        memcpy(sizes, s->sizes, sizeof sizes);
        CHECK_OK(pkc_environment_step(s->environment, s->actions, (size_t)s->info.count, s->rewards,
                                      s->contacts, s->closed));
        observe(s);
        for (i = 0; i < s->info.count; ++i) {
            check_step(s, i, sizes[2 * i], sizes[2 * i + 1]);
            closed += s->closed[i];
            if (s->closed[i]) check_closed(s, i);
        }
        bins += (uint64_t)closed;
        assert_int_equal(info_of(s->environment).closed, closed);
        assert_int_equal(info_of(s->environment).bins, bins);
        assert_int_equal(info_of(s->environment).steps, (k + 1) * s->info.count);
        CHECK_OK(pkc_environment_open(s->environment));
        assert_int_equal(info_of(s->environment).closed, 0);
        for (i = 0; i < s->info.count; ++i)
            if (s->closed[i]) CHECK_OK(pkc_bin_clear(s->bins[i]));
        memcpy(sizes, s->sizes, sizeof sizes);
        observe(s);
        assert_memory_equal(sizes, s->sizes, sizeof sizes); /* who closed it begins the next */
    }
    assert_true(bins > 0);
    free_scene(s);
}

static void every_step_is_a_bin_s(void **state) {
    static const struct {
        int32_t w, h, least, most, items, rotation;
        double fill;
    } cases[] = {{10, 10, 1, 5, 0, PKC_ROTATION_OFF, 0},   {10, 10, 1, 5, 0, PKC_ROTATION_ON, 0.5},
                 {10, 10, 1, 5, 0, PKC_ROTATION_MIXED, 1}, {4, 4, 1, 3, 16, PKC_ROTATION_ON, 0.25},
                 {1, 1, 1, 1, 0, PKC_ROTATION_ON, 0},      {3, 17, 2, 3, 5, PKC_ROTATION_ON, 0.1},
                 {20, 20, 1, 20, 0, PKC_ROTATION_ON, 0.9}, {128, 3, 1, 3, 0, PKC_ROTATION_OFF, 0}};
    size_t c;
    (void)state;
    for (c = 0; c < sizeof cases / sizeof cases[0]; ++c) {
        pkc_environment_options options = default_options();
        options.count = (int32_t)(1 + 23 * (c % 2));
        options.bin_w = cases[c].w;
        options.bin_h = cases[c].h;
        options.least_side = cases[c].least;
        options.most_side = cases[c].most;
        options.items = cases[c].items;
        options.rotation = cases[c].rotation;
        options.reward_fill = cases[c].fill;
        play(&options, c + 1, check_count(options.count == 1 ? 400 : 60, 3000));
    }
}

/* The first actions of all bins as numbers; what a stream of items is made of. */
static uint64_t play_greedily(pkc_environment *environment, int steps) {
    const pkc_environment_info info = info_of(environment);
    const size_t count = (size_t)info.count;
    int32_t *actions = calloc(count, sizeof *actions);
    uint8_t *mask = calloc(count, (size_t)info.actions);
    int32_t *sizes = calloc(count, 2 * sizeof *sizes);
    uint64_t hash = 0xcbf29ce484222325u;
    size_t i;
    assert_true(actions != NULL && mask != NULL && sizes != NULL);
    for (; steps > 0; --steps) {
        CHECK_OK(pkc_environment_observe(environment, NULL, count, NULL, sizes, mask, NULL));
        for (i = 0; i < count; ++i) {
            const uint8_t *row = mask + i * (size_t)info.actions;
            actions[i] = (int32_t)((const uint8_t *)memchr(row, 1, (size_t)info.actions) - row);
            hash =
                (hash ^ (uint64_t)(sizes[2 * i] * 1000003 + sizes[2 * i + 1] * 1009 + actions[i])) *
                0x100000001b3u;
        }
        CHECK_OK(pkc_environment_step(environment, actions, count, NULL, NULL, NULL));
        CHECK_OK(pkc_environment_open(environment));
    }
    free(actions);
    free(mask);
    free(sizes);
    return hash;
}

static pkc_environment *make_environment(int32_t count) {
    pkc_environment_options options = default_options();
    pkc_environment *environment = NULL;
    options.count = count;
    CHECK_OK(pkc_environment_create(&options, &environment));
    return environment;
}

/* A refactoring leaves the number as it is; it is the same on every machine. */
static void streams_are_pinned(void **state) {
    pkc_environment *environment = make_environment(3);
    const uint64_t seed = 5;
    (void)state;
    CHECK_OK(pkc_environment_reset(environment, &seed, 1));
    assert_int_equal(play_greedily(environment, 200), 0xae7de19560eca9efu);
    pkc_environment_free(environment);
}

static void equal_seeds_give_equal_streams(void **state) {
    pkc_environment *many = make_environment(4);
    pkc_environment *again = make_environment(4);
    const uint64_t seeds[] = {7, 8, 7, 9};
    const uint64_t seed = 7;
    int32_t of_seeds[8];
    int32_t of_seed[8];
    uint64_t first;
    (void)state;
    CHECK_OK(pkc_environment_reset(many, &seed, 1));
    CHECK_OK(pkc_environment_reset(again, &seed, 1));
    first = play_greedily(many, 50);
    assert_int_equal(play_greedily(again, 50), first);
    /* Streams go on, and begin anew with a seed. */
    CHECK_OK(pkc_environment_reset(many, NULL, 0));
    assert_int_not_equal(play_greedily(many, 50), first);
    CHECK_OK(pkc_environment_reset(many, &seed, 1));
    assert_int_equal(play_greedily(many, 50), first);
    /* A new environment has the streams of seed 0. */
    {
        const uint64_t zero = 0;
        pkc_environment *fresh = make_environment(4);
        CHECK_OK(pkc_environment_reset(many, &zero, 1));
        assert_int_equal(play_greedily(fresh, 50), play_greedily(many, 50));
        pkc_environment_free(fresh);
    }

    CHECK_OK(pkc_environment_reset(many, seeds, 4));
    CHECK_OK(pkc_environment_reset(again, &seed, 1));
    CHECK_OK(pkc_environment_observe(many, NULL, 4, NULL, of_seeds, NULL, NULL));
    CHECK_OK(pkc_environment_observe(again, NULL, 4, NULL, of_seed, NULL, NULL));
    assert_memory_equal(of_seeds, of_seed, 2 * sizeof of_seeds[0]);
    assert_memory_equal(of_seeds, of_seeds + 4, 2 * sizeof of_seeds[0]);
    pkc_environment_free(many);
    pkc_environment_free(again);
}

static void a_clone_plays_on_from_there(void **state) {
    pkc_environment *environment = make_environment(5);
    pkc_environment *clone = NULL;
    (void)state;
    play_greedily(environment, 30);
    CHECK_OK(pkc_environment_clone(environment, &clone));
    assert_int_equal(info_of(clone).steps, 150);
    assert_int_equal(info_of(clone).bins, info_of(environment).bins);
    assert_int_equal(play_greedily(clone, 100), play_greedily(environment, 100));
    pkc_environment_free(environment);
    play_greedily(clone, 10);
    CHECK_FAILS(PKC_E_ARGUMENT, "environment", pkc_environment_clone(NULL, &clone));
    CHECK_FAILS(PKC_E_ARGUMENT, "out_environment", pkc_environment_clone(clone, NULL));
    pkc_environment_free(clone);
}

static void some_bins_are_seen_as_all_are(void **state) {
    pkc_environment *environment = make_environment(6);
    const int32_t which[] = {4, 0, 4};
    const int32_t wrong[] = {0, 6};
    uint8_t all_cells[6 * 100];
    uint8_t all_mask[6 * 101];
    uint8_t cells[3 * 100];
    uint8_t mask[3 * 101];
    int32_t all_sizes[12];
    int32_t sizes[6];
    int32_t occupied[3] = {77, 77, 77};
    size_t k;
    (void)state;
    play_greedily(environment, 5);
    CHECK_OK(pkc_environment_observe(environment, NULL, 6, all_cells, all_sizes, all_mask, NULL));
    CHECK_OK(pkc_environment_observe(environment, which, 3, cells, sizes, mask, occupied));
    for (k = 0; k < 3; ++k) {
        const size_t i = (size_t)which[k];
        assert_memory_equal(cells + 100 * k, all_cells + 100 * i, 100);
        assert_memory_equal(mask + 101 * k, all_mask + 101 * i, 101);
        assert_memory_equal(sizes + 2 * k, all_sizes + 2 * i, 2 * sizeof sizes[0]);
    }
    occupied[0] = 77;
    CHECK_FAILS(PKC_E_ARGUMENT, "index 6",
                pkc_environment_observe(environment, wrong, 2, NULL, NULL, NULL, occupied));
    assert_int_equal(occupied[0], 77);
    CHECK_FAILS(PKC_E_ARGUMENT, "5 bins",
                pkc_environment_observe(environment, NULL, 5, NULL, NULL, NULL, occupied));
    CHECK_OK(pkc_environment_observe(environment, which, 0, cells, sizes, mask, occupied));
    pkc_environment_free(environment);
}

static void a_wrong_action_places_nothing(void **state) {
    pkc_environment *environment = make_environment(2);
    const int32_t corner[] = {0, 0};
    int32_t actions[2];
    uint8_t mask[2 * 101];
    uint64_t random = 1;
    const struct {
        int32_t action;
        const char *text;
    } wrong[] = {{101, "action 101 of bin 1: must be 0..100"},
                 {-1, "action -1 of bin 1: must be 0..100"},
                 {INT32_MAX, "must be 0..100"},
                 {INT32_MIN, "must be 0..100"},
                 {100, "action 100 of bin 1: no place for the "},
                 {0, "action 0 of bin 1: no place for the "}};
    uint8_t before[200];
    uint8_t after[200];
    double rewards[2] = {77, 77};
    size_t i;
    (void)state;
    CHECK_OK(pkc_environment_step(environment, corner, 2, NULL, NULL, NULL));
    CHECK_OK(pkc_environment_observe(environment, NULL, 2, before, NULL, NULL, NULL));
    CHECK_OK(pkc_environment_observe(environment, NULL, 2, NULL, NULL, mask, NULL));
    for (i = 0; i < 2; ++i) actions[i] = draw_action(mask + 101 * i, 101, &random);
    for (i = 0; i < sizeof wrong / sizeof wrong[0]; ++i) {
        const int32_t right = actions[1];
        actions[1] = wrong[i].action;
        CHECK_FAILS(PKC_E_ARGUMENT, wrong[i].text,
                    pkc_environment_step(environment, actions, 2, rewards, NULL, NULL));
        actions[1] = right;
    }
    CHECK_FAILS(PKC_E_ARGUMENT, "1 actions: must be 2",
                pkc_environment_step(environment, corner, 1, rewards, NULL, NULL));
    CHECK_FAILS(PKC_E_ARGUMENT, "actions",
                pkc_environment_step(environment, NULL, 2, rewards, NULL, NULL));
    assert_true(rewards[0] == 77 && rewards[1] == 77);
    CHECK_OK(pkc_environment_observe(environment, NULL, 2, after, NULL, NULL, NULL));
    assert_memory_equal(before, after, sizeof before);
    pkc_environment_free(environment);
}

static void a_closed_bin_takes_no_item(void **state) {
    pkc_environment_options options = default_options();
    pkc_environment *environment = NULL;
    const int32_t corner[] = {0};
    uint8_t mask[2];
    uint8_t closed = 0;
    (void)state;
    options.bin_w = options.bin_h = options.most_side = 1;
    CHECK_OK(pkc_environment_create(&options, &environment));
    CHECK_OK(pkc_environment_step(environment, corner, 1, NULL, NULL, &closed));
    assert_int_equal(closed, 1);
    CHECK_OK(pkc_environment_observe(environment, NULL, 1, NULL, NULL, mask, NULL));
    assert_true(mask[0] == 0 && mask[1] == 1);
    CHECK_FAILS(PKC_E_STATE, "bin 0 is closed",
                pkc_environment_step(environment, corner, 1, NULL, NULL, NULL));
    CHECK_OK(pkc_environment_reset(environment, NULL, 0));
    CHECK_OK(pkc_environment_step(environment, corner, 1, NULL, NULL, NULL));
    CHECK_OK(pkc_environment_open(environment));
    CHECK_OK(pkc_environment_step(environment, corner, 1, NULL, NULL, NULL));
    assert_int_equal(info_of(environment).bins, 3);
    pkc_environment_free(environment);
}

static void wrong_options_are_refused(void **state) {
    pkc_environment *environment = NULL;
    pkc_environment_options o;
    const uint64_t seeds[] = {1, 2, 3};
    (void)state;
#define REFUSED(status, text, change)                                    \
    o = default_options();                                               \
    change;                                                              \
    CHECK_FAILS(status, text, pkc_environment_create(&o, &environment)); \
    assert_null(environment)
    REFUSED(PKC_E_ARGUMENT, "count 0", o.count = 0);
    REFUSED(PKC_E_ARGUMENT, "count 65537", o.count = 65537);
    REFUSED(PKC_E_ARGUMENT, "bin w 129", o.bin_w = 129);
    REFUSED(PKC_E_ARGUMENT, "bin h 0", o.bin_h = 0);
    REFUSED(PKC_E_ARGUMENT, "least side 0", o.least_side = 0);
    REFUSED(PKC_E_ARGUMENT, "most side 11", o.most_side = 11);
    REFUSED(PKC_E_ARGUMENT, "items -1", o.items = -1);
    REFUSED(PKC_E_ARGUMENT, "rotation 3", o.rotation = 3);
    REFUSED(PKC_E_ARGUMENT, "reward_fill", o.reward_fill = 1.5);
    REFUSED(PKC_E_ARGUMENT, "reward_fill", o.reward_fill = 0.0 / 0.0);
    REFUSED(PKC_E_STRUCT, "struct_size", o.struct_size = 8);
    REFUSED(PKC_E_LIMIT, "1025 bins of 128 x 128", o.bin_w = o.bin_h = 128; o.count = 1025);
#undef REFUSED
    CHECK_FAILS(PKC_E_ARGUMENT, "out_environment", pkc_environment_create(NULL, NULL));
    CHECK_OK(pkc_environment_create(NULL, &environment));
    assert_int_equal(info_of(environment).count, 1);
    assert_int_equal(info_of(environment).actions, 101);
    CHECK_FAILS(PKC_E_ARGUMENT, "3 seeds: must be 0, 1 or 1",
                pkc_environment_reset(environment, seeds, 3));
    CHECK_FAILS(PKC_E_ARGUMENT, "seeds", pkc_environment_reset(environment, NULL, 1));
    CHECK_FAILS(PKC_E_ARGUMENT, "environment", pkc_environment_reset(NULL, seeds, 1));
    CHECK_FAILS(PKC_E_ARGUMENT, "environment", pkc_environment_open(NULL));
    CHECK_FAILS(PKC_E_ARGUMENT, "environment", pkc_environment_get_info(NULL, NULL));
    CHECK_FAILS(PKC_E_ARGUMENT, "environment",
                pkc_environment_observe(NULL, NULL, 0, NULL, NULL, NULL, NULL));
    pkc_environment_free(environment);
    pkc_environment_free(NULL);
}

static void playing_takes_no_memory(void **state) {
    pkc_environment *model = make_environment(8);
    pkc_environment *environment = NULL;
    const uint64_t seed = 3;
    uint8_t mask[8 * 101];
    uint64_t random = 1;
    uint64_t before;
    int k;
    (void)state;
    CHECK_OK(pkc_environment_clone(model, &environment));
    pkc_environment_free(model);
    if (check_watched()) {
        pkc_environment_free(environment);
        skip();
    }
    before = count_malloc_calls;
    for (k = 0; k < 500; ++k) {
        int32_t actions[8];
        int32_t i;
        if (k % 100 == 0) CHECK_OK(pkc_environment_reset(environment, &seed, 1));
        CHECK_OK(pkc_environment_observe(environment, NULL, 8, NULL, NULL, mask, NULL));
        for (i = 0; i < 8; ++i) actions[i] = draw_action(mask + 101 * i, 101, &random);
        CHECK_OK(pkc_environment_step(environment, actions, 8, NULL, NULL, NULL));
        CHECK_OK(pkc_environment_open(environment));
    }
    assert_int_equal(count_malloc_calls, before);
    pkc_environment_free(environment);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_step_is_a_bin_s),
        cmocka_unit_test(streams_are_pinned),
        cmocka_unit_test(equal_seeds_give_equal_streams),
        cmocka_unit_test(a_clone_plays_on_from_there),
        cmocka_unit_test(some_bins_are_seen_as_all_are),
        cmocka_unit_test(a_wrong_action_places_nothing),
        cmocka_unit_test(a_closed_bin_takes_no_item),
        cmocka_unit_test(wrong_options_are_refused),
        cmocka_unit_test(playing_takes_no_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
