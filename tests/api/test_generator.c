/* Generators through the C API: right use and every wrong option; the items' distribution is the
 * matter of the unit test. */
#include <float.h>
#include <limits.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "check.h"

static pkc_generator_options defaults(void) {
    pkc_generator_options options;
    CHECK_OK(pkc_generator_options_init(&options, sizeof options));
    return options;
}

static pkc_generator *make(int32_t kind, uint64_t seed) {
    pkc_generator_options options = defaults();
    pkc_generator *generator = NULL;
    options.kind = kind;
    options.seed = seed;
    CHECK_OK(pkc_generator_create(&options, &generator));
    return generator;
}

static void defaults_are_those_of_the_header(void **state) {
    const pkc_generator_options options = defaults();
    (void)state;
    assert_int_equal(options.kind, PKC_GENERATE_RANDOM);
    assert_int_equal(options.w, 10);
    assert_int_equal(options.h, 10);
    assert_true(options.mean == 0.445 && options.sigma == 1.0);
    assert_int_equal(options.seed, 1);
}

static void presets_set_mean_and_sigma_alone(void **state) {
    pkc_generator_options options = defaults();
    pkc_generator_options kept;
    (void)state;
    options.w = 7;
    options.seed = 99;
    CHECK_OK(pkc_generator_preset(&options, "text"));
    assert_true(options.mean == 0.5 && options.sigma == 2.0);
    assert_int_equal(options.w, 7);
    assert_int_equal(options.seed, 99);
    CHECK_OK(pkc_generator_preset(&options, "table"));
    assert_true(options.mean == 0.445 && options.sigma == 1.0);
    kept = options;
    CHECK_FAILS(PKC_E_ARGUMENT, "tables", pkc_generator_preset(&options, "tables"));
    CHECK_FAILS(PKC_E_ARGUMENT, "preset", pkc_generator_preset(&options, ""));
    CHECK_FAILS(PKC_E_ARGUMENT, "preset is NULL", pkc_generator_preset(&options, NULL));
    CHECK_FAILS(PKC_E_ARGUMENT, "options is NULL", pkc_generator_preset(NULL, "text"));
    assert_memory_equal(&options, &kept, sizeof kept);
}

static void every_option_is_checked(void **state) {
    static const int32_t wrong_kind[] = {INT_MIN, -1, 0, 3, INT_MAX};
    static const int32_t wrong_side[] = {INT_MIN, -1, 0, 129, INT_MAX};
    const double wrong_mean[] = {NAN, INFINITY, -INFINITY, -1, 0, 1.0001, 1e308};
    const double wrong_sigma[] = {NAN, INFINITY, -INFINITY, -1, 0, 128.0001, 1e308};
    pkc_generator *const sentinel = (pkc_generator *)&state;
    pkc_generator *generator = sentinel;
    pkc_generator_options options;
    char text[64];
    size_t i;
    (void)state;
    for (i = 0; i < 5; ++i) {
        options = defaults();
        options.kind = wrong_kind[i];
        snprintf(text, sizeof text, "kind %d", wrong_kind[i]);
        CHECK_FAILS(PKC_E_ARGUMENT, text, pkc_generator_create(&options, &generator));
        options = defaults();
        options.w = wrong_side[i];
        snprintf(text, sizeof text, "w %d", wrong_side[i]);
        CHECK_FAILS(PKC_E_ARGUMENT, text, pkc_generator_create(&options, &generator));
        options = defaults();
        options.h = wrong_side[i];
        snprintf(text, sizeof text, "h %d", wrong_side[i]);
        CHECK_FAILS(PKC_E_ARGUMENT, text, pkc_generator_create(&options, &generator));
    }
    for (i = 0; i < 7; ++i) {
        options = defaults();
        options.mean = wrong_mean[i];
        CHECK_FAILS(PKC_E_ARGUMENT, "mean ", pkc_generator_create(&options, &generator));
        options = defaults();
        options.sigma = wrong_sigma[i];
        CHECK_FAILS(PKC_E_ARGUMENT, "sigma ", pkc_generator_create(&options, &generator));
    }
    CHECK_FAILS(PKC_E_ARGUMENT, "options is NULL", pkc_generator_create(NULL, &generator));
    options = defaults();
    CHECK_FAILS(PKC_E_ARGUMENT, "out_generator is NULL", pkc_generator_create(&options, NULL));
    assert_ptr_equal(generator, sentinel);
}

static void extreme_options_still_give_sets(void **state) {
    static const double means[] = {DBL_MIN, 0.5, 1.0};
    static const double sigmas[] = {DBL_MIN, 1.0, 128.0};
    static const int32_t sides[] = {1, 2, 13, 128};
    static pkc_item items[128 * 128];
    size_t m;
    size_t s;
    size_t d;
    (void)state;
    for (m = 0; m < 3; ++m) {
        for (s = 0; s < 3; ++s) {
            for (d = 0; d < 3; ++d) {
                pkc_generator_options options = defaults();
                pkc_generator *generator = NULL;
                size_t count = 0;
                size_t i;
                int area = 0;
                options.kind = PKC_GENERATE_FULL;
                options.w = sides[d];
                options.h = sides[d + 1] > 20 ? 20 : sides[d + 1];
                options.mean = means[m];
                options.sigma = sigmas[s];
                CHECK_OK(pkc_generator_create(&options, &generator));
                CHECK_OK(pkc_generator_next(generator, items, 128 * 128, &count));
                for (i = 0; i < count; ++i) area += items[i].w * items[i].h;
                assert_int_equal(area, options.w * options.h);
                pkc_generator_free(generator);
            }
        }
    }
}

static void a_full_set_fills_the_bin_and_fits(void **state) {
    pkc_generator *generator = make(PKC_GENERATE_FULL, 3);
    const pkc_budget budget = check_budget(0);
    int round;
    (void)state;
    for (round = 0; round < 10; ++round) {
        pkc_item items[100];
        pkc_placement placements[100];
        pkc_bin *bin = check_bin(10, 10);
        size_t count = 0;
        int32_t answer = 0;
        size_t i;
        CHECK_OK(pkc_generator_next(generator, items, 100, &count));
        for (i = 0; i < count; ++i) assert_int_equal(items[i].id, i);
        CHECK_OK(pkc_exact_pack(bin, items, count, 0, &budget, placements, &answer, NULL));
        assert_int_equal(answer, PKC_PACKING_FOUND);
        pkc_bin_free(bin);
    }
    pkc_generator_free(generator);
}

static void a_set_that_does_not_fit_the_array_is_given_again(void **state) {
    pkc_generator *one = make(PKC_GENERATE_FULL, 8);
    pkc_generator *two = make(PKC_GENERATE_FULL, 8);
    pkc_item a[100];
    pkc_item b[100];
    size_t count_a = 0;
    size_t count_b = 0;
    size_t needed = 0;
    int round;
    (void)state;
    for (round = 0; round < 5; ++round) {
        CHECK_FAILS(PKC_E_CAPACITY, "capacity 0", pkc_generator_next(one, NULL, 0, &needed));
        memset(a, 0x5a, sizeof a);
        CHECK_FAILS(PKC_E_CAPACITY, NULL, pkc_generator_next(one, a, needed - 1, &needed));
        assert_int_equal(a[0].id, 0x5a5a5a5a);
        CHECK_FAILS(PKC_E_ARGUMENT, "items is NULL", pkc_generator_next(one, NULL, 100, &count_a));
        CHECK_OK(pkc_generator_next(one, a, needed, &count_a));
        assert_int_equal(count_a, needed);
        CHECK_OK(pkc_generator_next(two, b, 100, &count_b));
        assert_int_equal(count_a, count_b);
        assert_memory_equal(a, b, count_a * sizeof a[0]);
    }
    pkc_generator_free(one);
    pkc_generator_free(two);
}

static void a_random_stream_goes_on_where_it_stopped(void **state) {
    pkc_generator *one = make(PKC_GENERATE_RANDOM, 8);
    pkc_generator *two = make(PKC_GENERATE_RANDOM, 8);
    pkc_item a[30];
    pkc_item b[30];
    size_t count = 99;
    size_t i;
    (void)state;
    CHECK_OK(pkc_generator_next(one, a, 30, &count));
    assert_int_equal(count, 30);
    for (i = 0; i < 30; i += 10) CHECK_OK(pkc_generator_next(two, b + i, 10, &count));
    assert_memory_equal(a, b, sizeof a);
    for (i = 0; i < 30; ++i) {
        assert_int_equal(a[i].id, i);
        assert_in_range(a[i].w, 1, 5);
        assert_in_range(a[i].h, 1, 5);
        assert_int_equal(a[i].flags, 0);
    }
    CHECK_OK(pkc_generator_next(one, NULL, 0, &count));
    assert_int_equal(count, 0);
    pkc_generator_free(one);
    pkc_generator_free(two);
}

static void a_failing_call_loses_no_items_of_the_stream(void **state) {
    pkc_generator *generator = make(PKC_GENERATE_RANDOM, 8);
    pkc_item item;
    size_t count = 99;
    (void)state;
    CHECK_FAILS(PKC_E_ARGUMENT, "generator is NULL", pkc_generator_next(NULL, &item, 1, &count));
    CHECK_FAILS(PKC_E_ARGUMENT, "out_count is NULL", pkc_generator_next(generator, &item, 1, NULL));
    CHECK_FAILS(PKC_E_ARGUMENT, "items is NULL", pkc_generator_next(generator, NULL, 10, &count));
    assert_int_equal(count, 99);
    CHECK_OK(pkc_generator_next(generator, &item, 1, &count));
    assert_int_equal(item.id, 0);
    pkc_generator_free(generator);
}

static void an_absurd_capacity_is_no_internal_error(void **state) {
    pkc_generator *generator = make(PKC_GENERATE_RANDOM, 8);
    size_t count = 99;
    (void)state;
    /* items NULL, since no array is so large: refused, and not by PKC_E_INTERNAL. */
    CHECK_FAILS(PKC_E_ARGUMENT, NULL, pkc_generator_next(generator, NULL, SIZE_MAX, &count));
    assert_int_equal(count, 99);
    pkc_generator_free(generator);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(defaults_are_those_of_the_header),
        cmocka_unit_test(presets_set_mean_and_sigma_alone),
        cmocka_unit_test(every_option_is_checked),
        cmocka_unit_test(extreme_options_still_give_sets),
        cmocka_unit_test(a_full_set_fills_the_bin_and_fits),
        cmocka_unit_test(a_set_that_does_not_fit_the_array_is_given_again),
        cmocka_unit_test(a_random_stream_goes_on_where_it_stopped),
        cmocka_unit_test(a_failing_call_loses_no_items_of_the_stream),
        cmocka_unit_test(an_absurd_capacity_is_no_internal_error),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
