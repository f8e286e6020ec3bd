/* The exact packer and the clairvoyant bound through the C API. */
#include <limits.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "check.h"

/* Three 2 x 3 items and one 3 x 3 tile a 9 x 3 bin; four items of a pinwheel tile 3 x 3 but for the
 * centre, only if they may be turned. */
static void exact_pack_finds_a_packing(void **state) {
    pkc_bin *bin = check_bin(3, 3);
    const pkc_budget budget = check_budget(0);
    pkc_item items[4];
    pkc_placement placements[4];
    int32_t answer = 0;
    uint64_t nodes = 0;
    size_t i;
    (void)state;
    for (i = 0; i < 4; ++i) items[i] = check_item((int32_t)i, 2, 1, 0);
    CHECK_OK(pkc_bin_block(bin, 1, 1, 1, 1));
    CHECK_OK(pkc_exact_pack(bin, items, 4, 1, &budget, placements, &answer, &nodes));
    assert_int_equal(answer, PKC_PACKING_FOUND);
    assert_true(nodes >= 4);
    for (i = 0; i < 4; ++i) {
        assert_memory_equal(&placements[i].item, &items[i], sizeof items[i]);
        CHECK_OK(pkc_bin_pack(bin, &items[i], placements[i].x, placements[i].y, placements[i].rot));
    }
    CHECK_OK(pkc_bin_clear(bin));
    memset(placements, 0x5a, sizeof placements);
    CHECK_OK(pkc_exact_pack(bin, items, 4, 0, &budget, placements, &answer, &nodes));
    assert_int_equal(answer, PKC_PACKING_IMPOSSIBLE);
    assert_int_equal(placements[0].x, 0x5a5a5a5a);
    for (i = 0; i < 4; ++i) items[i].flags = PKC_ITEM_NO_ROTATE;
    CHECK_OK(pkc_exact_pack(bin, items, 4, 1, &budget, placements, &answer, NULL));
    assert_int_equal(answer, PKC_PACKING_IMPOSSIBLE);
    pkc_bin_free(bin);
}

static void nothing_always_fits_and_too_much_never(void **state) {
    pkc_bin *bin = check_bin(2, 2);
    const pkc_budget budget = check_budget(1);
    pkc_item items[2];
    pkc_placement placements[2];
    int32_t answer = 0;
    (void)state;
    CHECK_OK(pkc_exact_pack(bin, NULL, 0, 1, &budget, NULL, &answer, NULL));
    assert_int_equal(answer, PKC_PACKING_FOUND);
    items[0] = check_item(0, 128, 128, 0);
    items[1] = check_item(1, 1, 1, 0);
    CHECK_OK(pkc_exact_pack(bin, items, 2, 1, &budget, placements, &answer, NULL));
    assert_int_equal(answer, PKC_PACKING_IMPOSSIBLE);
    pkc_bin_free(bin);
}

static void a_small_budget_leaves_the_question_open(void **state) {
    pkc_bin *bin = check_bin(12, 12);
    const pkc_budget budget = check_budget(10);
    pkc_item items[23];
    pkc_placement placements[23];
    int32_t answer = 0;
    uint64_t nodes = 0;
    size_t i;
    (void)state;
    /* 23 2 x 3 items and not all of them in one go. */
    for (i = 0; i < 23; ++i) items[i] = check_item((int32_t)i, 2, 3, 0);
    CHECK_OK(pkc_exact_pack(bin, items, 23, 1, &budget, placements, &answer, &nodes));
    assert_int_equal(answer, PKC_PACKING_BUDGET);
    assert_in_range(nodes, 1, 10);
    pkc_bin_free(bin);
}

static void exact_pack_checks_its_arguments(void **state) {
    static const int32_t wrong_flag[] = {INT_MIN, -1, 2, INT_MAX};
    const double wrong_ms[] = {NAN, INFINITY, -INFINITY, -1, 1e308};
    pkc_bin *bin = check_bin(2, 2);
    pkc_budget budget = check_budget(10);
    static pkc_item items[16385];
    static pkc_placement placements[16385];
    int32_t answer = 77;
    uint64_t nodes = 77;
    size_t i;
    (void)state;
    for (i = 0; i < 16385; ++i) items[i] = check_item((int32_t)i, 1, 1, 0);
    for (i = 0; i < 4; ++i) {
        CHECK_FAILS(
            PKC_E_ARGUMENT, "rotation ",
            pkc_exact_pack(bin, items, 1, wrong_flag[i], &budget, placements, &answer, &nodes));
    }
    CHECK_FAILS(PKC_E_ARGUMENT, "count 16385",
                pkc_exact_pack(bin, items, 16385, 1, &budget, placements, &answer, &nodes));
    CHECK_FAILS(PKC_E_ARGUMENT, "count ",
                pkc_exact_pack(bin, items, SIZE_MAX, 1, &budget, placements, &answer, &nodes));
    CHECK_FAILS(PKC_E_ARGUMENT, "bin is NULL",
                pkc_exact_pack(NULL, items, 1, 1, &budget, placements, &answer, &nodes));
    CHECK_FAILS(PKC_E_ARGUMENT, "items is NULL",
                pkc_exact_pack(bin, NULL, 1, 1, &budget, placements, &answer, &nodes));
    CHECK_FAILS(PKC_E_ARGUMENT, "placements is NULL",
                pkc_exact_pack(bin, items, 1, 1, &budget, NULL, &answer, &nodes));
    CHECK_FAILS(PKC_E_ARGUMENT, "out_answer is NULL",
                pkc_exact_pack(bin, items, 1, 1, &budget, placements, NULL, &nodes));
    items[1].w = 0;
    CHECK_FAILS(PKC_E_ARGUMENT, "w 0",
                pkc_exact_pack(bin, items, 2, 1, &budget, placements, &answer, &nodes));
    items[1].w = 1;
    budget.reserved = 1;
    CHECK_FAILS(PKC_E_ARGUMENT, "reserved 1",
                pkc_exact_pack(bin, items, 1, 1, &budget, placements, &answer, &nodes));
    for (i = 0; i < 5; ++i) {
        budget = check_budget(10);
        budget.milliseconds = wrong_ms[i];
        CHECK_FAILS(PKC_E_ARGUMENT, "milliseconds",
                    pkc_exact_pack(bin, items, 1, 1, &budget, placements, &answer, &nodes));
    }
    assert_int_equal(answer, 77);
    assert_int_equal(nodes, 77);
    pkc_bin_free(bin);
}

static void bound_counts_the_first_items_that_fit_together(void **state) {
    pkc_bin *bin = check_bin(3, 3);
    const pkc_budget budget = check_budget(0);
    pkc_item items[5];
    size_t count = 77;
    int32_t answer = 0;
    (void)state;
    /* 1 x 3, 3 x 1 and a 2 x 2 fill 3 x 3 only where two may be parallel. */
    items[0] = check_item(0, 1, 3, 0);
    items[1] = check_item(1, 3, 1, 0);
    items[2] = check_item(2, 1, 3, 0);
    items[3] = check_item(3, 1, 1, 0);
    items[4] = check_item(4, 1, 1, 0);
    CHECK_OK(pkc_bound_in_order(bin, items, 5, 1, &budget, &count, &answer));
    assert_int_equal(count, 3);
    assert_int_equal(answer, PKC_PACKING_FOUND);
    CHECK_OK(pkc_bound_in_order(bin, items, 5, 0, &budget, &count, &answer));
    assert_int_equal(count, 1);
    items[0].flags = PKC_ITEM_NO_ROTATE;
    items[1].flags = PKC_ITEM_NO_ROTATE;
    CHECK_OK(pkc_bound_in_order(bin, items, 5, 1, &budget, &count, &answer));
    assert_int_equal(count, 1);
    CHECK_OK(pkc_bound_in_order(bin, NULL, 0, 1, &budget, &count, &answer));
    assert_int_equal(count, 0);
    assert_int_equal(answer, PKC_PACKING_FOUND);
    pkc_bin_free(bin);
}

static void an_undecided_bound_is_an_upper_bound(void **state) {
    pkc_bin *bin = check_bin(10, 10);
    const pkc_budget little = check_budget(3);
    pkc_item items[25];
    size_t count = 77;
    int32_t answer = 0;
    int32_t i;
    (void)state;
    for (i = 0; i < 25; ++i) items[i] = check_item(i, 2, 2, 0);
    CHECK_OK(pkc_bound_in_order(bin, items, 25, 1, &little, &count, &answer));
    assert_int_equal(answer, PKC_PACKING_BUDGET);
    assert_int_equal(count, 25);
    pkc_bin_free(bin);
}

/* A bound that stops counting at some number of its own would not be one. */
static void bound_never_counts_too_few(void **state) {
    static pkc_item items[200];
    pkc_bin *bin = check_bin(14, 14);
    const pkc_budget budget = check_budget(0);
    size_t count = 77;
    int32_t answer = 0;
    int32_t i;
    (void)state;
    for (i = 0; i < 200; ++i) items[i] = check_item(i, 1, 1, 0);
    if (pkc_bound_in_order(bin, items, 200, 1, &budget, &count, &answer) == PKC_OK) {
        assert_int_equal(count, 196);
    } else {
        assert_int_equal(count, 77);
    }
    pkc_bin_free(bin);
}

static void bound_checks_its_arguments(void **state) {
    static const int32_t wrong_flag[] = {INT_MIN, -1, 2, INT_MAX};
    pkc_bin *bin = check_bin(2, 2);
    pkc_budget budget = check_budget(10);
    pkc_item item = check_item(0, 1, 1, 0);
    size_t count = 77;
    int32_t answer = 77;
    size_t i;
    (void)state;
    for (i = 0; i < 4; ++i) {
        CHECK_FAILS(PKC_E_ARGUMENT, "rotation ",
                    pkc_bound_in_order(bin, &item, 1, wrong_flag[i], &budget, &count, &answer));
    }
    CHECK_FAILS(PKC_E_ARGUMENT, "bin is NULL",
                pkc_bound_in_order(NULL, &item, 1, 1, &budget, &count, &answer));
    CHECK_FAILS(PKC_E_ARGUMENT, "items is NULL",
                pkc_bound_in_order(bin, NULL, 1, 1, &budget, &count, &answer));
    CHECK_FAILS(PKC_E_ARGUMENT, "out_count is NULL",
                pkc_bound_in_order(bin, &item, 1, 1, &budget, NULL, &answer));
    CHECK_FAILS(PKC_E_ARGUMENT, "out_answer is NULL",
                pkc_bound_in_order(bin, &item, 1, 1, &budget, &count, NULL));
    item.h = 129;
    CHECK_FAILS(PKC_E_ARGUMENT, "h 129",
                pkc_bound_in_order(bin, &item, 1, 1, &budget, &count, &answer));
    item.h = 1;
    budget.struct_size = 3;
    CHECK_FAILS(PKC_E_STRUCT, "budget.struct_size 3",
                pkc_bound_in_order(bin, &item, 1, 1, &budget, &count, &answer));
    assert_int_equal(count, 77);
    assert_int_equal(answer, 77);
    pkc_bin_free(bin);
}

/* Every item takes a cell at least, so the largest bin's cells are the most items there can be. */
static void exact_pack_takes_as_many_items_as_the_largest_bin_has_cells(void **state) {
    static pkc_item items[16384];
    static pkc_placement placements[16384];
    pkc_bin *bin = check_bin(128, 128);
    const pkc_budget budget = check_budget(0);
    int32_t answer = 0;
    int32_t i;
    (void)state;
    for (i = 0; i < 16384; ++i) items[i] = check_item(i, 1, 1, 0);
    CHECK_OK(pkc_exact_pack(bin, items, 16384, 1, &budget, placements, &answer, NULL));
    assert_int_equal(answer, PKC_PACKING_FOUND);
    for (i = 0; i < 16384; ++i) assert_int_equal(placements[i].item.id, i);
    items[5].w = 2;
    CHECK_OK(pkc_exact_pack(bin, items, 16384, 1, &budget, placements, &answer, NULL));
    assert_int_equal(answer, PKC_PACKING_IMPOSSIBLE);
    pkc_bin_free(bin);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(exact_pack_finds_a_packing),
        cmocka_unit_test(nothing_always_fits_and_too_much_never),
        cmocka_unit_test(a_small_budget_leaves_the_question_open),
        cmocka_unit_test(exact_pack_checks_its_arguments),
        cmocka_unit_test(exact_pack_takes_as_many_items_as_the_largest_bin_has_cells),
        cmocka_unit_test(bound_counts_the_first_items_that_fit_together),
        cmocka_unit_test(an_undecided_bound_is_an_upper_bound),
        cmocka_unit_test(bound_never_counts_too_few),
        cmocka_unit_test(bound_checks_its_arguments),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
