/* Policies through the C API: names, selection, and that they may be shared by threads. */
#include <limits.h>
#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "check.h"

static void the_builtin_names_are_those_of_the_header(void **state) {
    static const char *const names[] = {"contact",        "bottom-left", "skyline",
                                        "shelf-next-fit", "maxrects-cp", "maxrects-bssf"};
    size_t i;
    (void)state;
    for (i = 0; i < 6; ++i) {
        pkc_policy *policy = NULL;
        assert_string_equal(pkc_policy_builtin(i), names[i]);
        CHECK_OK(pkc_policy_create(names[i], &policy));
        assert_string_equal(pkc_policy_name(policy), names[i]);
        pkc_policy_free(policy);
    }
    assert_null(pkc_policy_builtin(6));
    assert_null(pkc_policy_builtin(SIZE_MAX));
}

static void unknown_names_are_refused_and_quoted(void **state) {
    static const char *const wrong[] = {"", "Contact", "contact ", "contac", "maxrects"};
    pkc_policy *const sentinel = (pkc_policy *)&state;
    pkc_policy *policy = sentinel;
    char longest[5000];
    size_t i;
    (void)state;
    for (i = 0; i < sizeof wrong / sizeof wrong[0]; ++i) {
        CHECK_FAILS(PKC_E_ARGUMENT, wrong[i], pkc_policy_create(wrong[i], &policy));
        CHECK_FAILS(PKC_E_ARGUMENT, "maxrects-bssf", pkc_policy_create(wrong[i], &policy));
    }
    memset(longest, 'x', sizeof longest);
    longest[sizeof longest - 1] = '\0';
    CHECK_FAILS(PKC_E_ARGUMENT, "xxxx", pkc_policy_create(longest, &policy));
    assert_true(strlen(pkc_last_error()) < 300);
    CHECK_FAILS(PKC_E_ARGUMENT, "name is NULL", pkc_policy_create(NULL, &policy));
    CHECK_FAILS(PKC_E_ARGUMENT, "out_policy is NULL", pkc_policy_create("contact", NULL));
    assert_ptr_equal(policy, sentinel);
}

static void select_gives_a_feasible_position_or_none(void **state) {
    uint64_t seed = 5;
    size_t p;
    (void)state;
    for (p = 0; pkc_policy_builtin(p) != NULL; ++p) {
        pkc_policy *policy = NULL;
        int round;
        CHECK_OK(pkc_policy_create(pkc_policy_builtin(p), &policy));
        for (round = 0; round < 40; ++round) {
            pkc_bin *bin = check_bin(check_draw(&seed, 1, 9), check_draw(&seed, 1, 9));
            pkc_bin_info info;
            int32_t id;
            CHECK_OK(pkc_bin_info_init(&info, sizeof info));
            CHECK_OK(pkc_bin_get_info(bin, &info));
            for (id = 0; id < 30; ++id) {
                const int32_t w = check_draw(&seed, 1, 5);
                const int32_t h = check_draw(&seed, 1, 5);
                const pkc_item item = check_item(id, w, h, 0);
                uint8_t mask[82];
                size_t count = 0;
                int32_t position = -1;
                CHECK_OK(pkc_bin_feasible(bin, w, h, mask, sizeof mask, &count));
                CHECK_OK(pkc_policy_select(policy, bin, w, h, &position));
                assert_in_range(position, 0, count - 1);
                assert_int_equal(mask[position], 1); /* W*H only when nothing else is feasible */
                if ((size_t)position + 1 == count) continue;
                CHECK_OK(pkc_bin_pack(bin, &item, position % info.w, position / info.w, 0));
            }
            pkc_bin_free(bin);
        }
        pkc_policy_free(policy);
    }
}

/* Worked by hand: in a 5 x 4 bin with a 2 x 2 item in the corner a 2 x 1 touches most (4) beside
 * it at the top, where it would touch 3, or in a corner with walls on two sides: 3 too. The notch
 * made by a second item decides. */
static void contact_takes_the_largest_reward_and_the_first_of_equals(void **state) {
    pkc_bin *bin = check_bin(5, 4);
    pkc_policy *policy = NULL;
    int32_t position = -1;
    (void)state;
    CHECK_OK(pkc_policy_create("contact", &policy));
    CHECK_OK(pkc_policy_select(policy, bin, 2, 1, &position));
    assert_int_equal(position, 0);
    check_pack(bin, 1, 2, 2, 0, 0);
    CHECK_OK(pkc_policy_select(policy, bin, 2, 1, &position));
    assert_int_equal(position, 2); /* 3: wall above 2, item 1; also at (3, 0), which is later */
    CHECK_OK(pkc_policy_select(policy, bin, 3, 1, &position));
    assert_int_equal(position, 2); /* 5 of 8: wall above 3, item 1, wall right */
    check_pack(bin, 2, 3, 1, 2, 3);
    CHECK_OK(pkc_policy_select(policy, bin, 2, 2, &position));
    assert_int_equal(position, 0 + 2 * 5); /* above, left and below, and item 2 on the right: 7 */
    pkc_policy_free(policy);
    pkc_bin_free(bin);
}

static void select_checks_its_arguments(void **state) {
    static const int32_t wrong[] = {INT_MIN, -1, 0, 129, INT_MAX};
    pkc_bin *bin = check_bin(3, 3);
    pkc_policy *policy = NULL;
    int32_t position = 77;
    size_t i;
    (void)state;
    CHECK_OK(pkc_policy_create("contact", &policy));
    for (i = 0; i < sizeof wrong / sizeof wrong[0]; ++i) {
        CHECK_FAILS(PKC_E_ARGUMENT, "w ", pkc_policy_select(policy, bin, wrong[i], 1, &position));
        CHECK_FAILS(PKC_E_ARGUMENT, "h ", pkc_policy_select(policy, bin, 1, wrong[i], &position));
    }
    CHECK_FAILS(PKC_E_ARGUMENT, "policy is NULL", pkc_policy_select(NULL, bin, 1, 1, &position));
    CHECK_FAILS(PKC_E_ARGUMENT, "bin is NULL", pkc_policy_select(policy, NULL, 1, 1, &position));
    CHECK_FAILS(PKC_E_ARGUMENT, "out_position is NULL", pkc_policy_select(policy, bin, 1, 1, NULL));
    assert_int_equal(position, 77);
    CHECK_OK(pkc_policy_select(policy, bin, 128, 128, &position));
    assert_int_equal(position, 9);
    pkc_policy_free(policy);
    pkc_bin_free(bin);
}

static void *select_often(void *shared) {
    pkc_bin *bin = NULL;
    int32_t position = -1;
    int failures = 0;
    int i;
    if (pkc_bin_create(8, 8, &bin) != PKC_OK) return shared;
    for (i = 0; i < 2000; ++i) {
        if (pkc_policy_select((pkc_policy *)shared, bin, 1 + i % 8, 3, &position) != PKC_OK ||
            position != 0)
            ++failures;
    }
    pkc_bin_free(bin);
    return failures == 0 ? NULL : shared;
}

static void a_policy_may_be_shared_by_threads(void **state) {
    pkc_policy *policy = NULL;
    pthread_t threads[3];
    void *result = NULL;
    int i;
    (void)state;
    CHECK_OK(pkc_policy_create("contact", &policy));
    for (i = 0; i < 3; ++i)
        assert_int_equal(pthread_create(&threads[i], NULL, select_often, policy), 0);
    for (i = 0; i < 3; ++i) {
        pthread_join(threads[i], &result);
        assert_null(result);
    }
    pkc_policy_free(policy);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_builtin_names_are_those_of_the_header),
        cmocka_unit_test(unknown_names_are_refused_and_quoted),
        cmocka_unit_test(select_gives_a_feasible_position_or_none),
        cmocka_unit_test(contact_takes_the_largest_reward_and_the_first_of_equals),
        cmocka_unit_test(select_checks_its_arguments),
        cmocka_unit_test(a_policy_may_be_shared_by_threads),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
