/* Millimetres to cells and back. */
#include <float.h>
#include <limits.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "check.h"

static pkc_grid make_grid(double bin_w, double bin_h, double margin, double cell,
                          double clearance) {
    pkc_grid grid;
    CHECK_OK(pkc_grid_init(&grid, sizeof grid));
    grid.bin_w = bin_w;
    grid.bin_h = bin_h;
    grid.margin = margin;
    grid.cell = cell;
    grid.clearance = clearance;
    return grid;
}

static void the_papers_bin_has_10_by_8_cells(void **state) {
    pkc_grid grid;
    int32_t w = 0;
    int32_t h = 0;
    (void)state;
    CHECK_OK(pkc_grid_init(&grid, sizeof grid));
    assert_true(grid.bin_w == 320 && grid.bin_h == 260 && grid.margin == 10 && grid.cell == 30 &&
                grid.clearance == 0);
    CHECK_OK(pkc_grid_bin(&grid, &w, &h));
    assert_int_equal(w, 10);
    assert_int_equal(h, 8);
}

static void bins_round_down_and_items_round_up(void **state) {
    const pkc_grid grid = make_grid(319.9, 109.9, 10, 30, 2);
    int32_t w = 0;
    int32_t h = 0;
    (void)state;
    CHECK_OK(pkc_grid_bin(&grid, &w, &h));
    assert_int_equal(w, 9);
    assert_int_equal(h, 2);
    CHECK_OK(pkc_grid_item(&grid, 28, 28.1, &w, &h)); /* 28 + 2 is one cell, 28.1 + 2 is two */
    assert_int_equal(w, 1);
    assert_int_equal(h, 2);
    CHECK_OK(pkc_grid_item(&grid, 1e-6, 88, &w, &h));
    assert_int_equal(w, 1);
    assert_int_equal(h, 3);
}

/* 0.1 + 0.2 and the like miss whole numbers of cells by the last bits of a double. */
static void whole_numbers_of_cells_survive_binary_fractions(void **state) {
    int n;
    (void)state;
    for (n = 1; n <= 128; ++n) {
        const pkc_grid grid = make_grid(n * 0.1 + 0.2, n * 0.3 + 0.2, 0.1, 0.1, 0.0);
        int32_t w = 0;
        int32_t h = 0;
        if (3 * n <= 128) {
            CHECK_OK(pkc_grid_bin(&grid, &w, &h));
            assert_int_equal(w, n);
            assert_int_equal(h, 3 * n);
        }
        CHECK_OK(pkc_grid_item(&grid, n * 0.1, 0.1 * n, &w, &h));
        assert_int_equal(w, n);
        assert_int_equal(h, n);
    }
}

static void every_field_is_checked(void **state) {
    static const char *const names[] = {"bin_w", "bin_h", "margin", "cell", "clearance"};
    const double wrong[] = {NAN, INFINITY, -INFINITY, -1.0, -DBL_MIN, 1e308, 1.0001e6};
    size_t f;
    size_t i;
    (void)state;
    for (f = 0; f < 5; ++f) {
        for (i = 0; i < sizeof wrong / sizeof wrong[0]; ++i) {
            double v[5] = {320, 260, 10, 30, 0};
            pkc_grid grid;
            int32_t w = 77;
            int32_t h = 77;
            double x = 77;
            double y = 77;
            v[f] = wrong[i];
            grid = make_grid(v[0], v[1], v[2], v[3], v[4]);
            CHECK_FAILS(PKC_E_ARGUMENT, names[f], pkc_grid_bin(&grid, &w, &h));
            CHECK_FAILS(PKC_E_ARGUMENT, names[f], pkc_grid_item(&grid, 10, 10, &w, &h));
            CHECK_FAILS(PKC_E_ARGUMENT, names[f], pkc_grid_centre(&grid, 0, 0, 1, 1, &x, &y));
            assert_int_equal(w, 77);
            assert_int_equal(h, 77);
            assert_true(x == 77 && y == 77);
        }
    }
}

static void zero_is_allowed_for_margin_and_clearance_alone(void **state) {
    pkc_grid grid = make_grid(100, 100, 0, 10, 0);
    int32_t w = 77;
    int32_t h = 77;
    (void)state;
    CHECK_OK(pkc_grid_bin(&grid, &w, &h));
    assert_int_equal(w, 10);
    grid.cell = 0;
    CHECK_FAILS(PKC_E_ARGUMENT, "cell 0", pkc_grid_bin(&grid, &w, &h));
    grid = make_grid(0, 100, 0, 10, 0);
    CHECK_FAILS(PKC_E_ARGUMENT, "bin_w 0", pkc_grid_bin(&grid, &w, &h));
    grid = make_grid(100, 0, 0, 10, 0);
    CHECK_FAILS(PKC_E_ARGUMENT, "bin_h 0", pkc_grid_bin(&grid, &w, &h));
}

static void reserved_must_be_zero(void **state) {
    pkc_grid grid = make_grid(100, 100, 0, 10, 0);
    int32_t w = 77;
    int32_t h = 77;
    (void)state;
    grid.reserved = 5;
    CHECK_FAILS(PKC_E_ARGUMENT, "reserved 5", pkc_grid_bin(&grid, &w, &h));
    assert_int_equal(w, 77);
}

static void cells_must_come_to_1_to_128(void **state) {
    pkc_grid grid = make_grid(320, 260, 160, 30, 0);
    int32_t w = 77;
    int32_t h = 77;
    (void)state;
    CHECK_FAILS(PKC_E_ARGUMENT, "bin_w 320", pkc_grid_bin(&grid, &w, &h)); /* all margin */
    grid = make_grid(1281, 260, 0, 10, 0);
    CHECK_OK(pkc_grid_bin(&grid, &w, &h));
    assert_int_equal(w, 128);
    w = 77;
    h = 77;
    grid = make_grid(1290, 260, 0, 10, 0);
    CHECK_FAILS(PKC_E_ARGUMENT, "bin_w 1290", pkc_grid_bin(&grid, &w, &h));
    grid = make_grid(260, 1e6, 0, 1e-9, 0);
    CHECK_FAILS(PKC_E_ARGUMENT, "bin_w", pkc_grid_bin(&grid, &w, &h));
    grid = make_grid(1e6, 1e6, 0, DBL_MIN, 0);
    CHECK_FAILS(PKC_E_ARGUMENT, "bin_w", pkc_grid_bin(&grid, &w, &h));
    grid = make_grid(320, 260, 10, 30, 0);
    CHECK_FAILS(PKC_E_ARGUMENT, "h 3841", pkc_grid_item(&grid, 10, 3841, &w, &h));
    assert_int_equal(w, 77);
    assert_int_equal(h, 77);
}

static void item_sides_are_checked(void **state) {
    const double wrong[] = {NAN, INFINITY, -INFINITY, -1.0, 0.0, 1e308, 1.0001e6};
    const pkc_grid grid = make_grid(320, 260, 10, 30, 0);
    size_t i;
    (void)state;
    for (i = 0; i < sizeof wrong / sizeof wrong[0]; ++i) {
        int32_t w = 77;
        int32_t h = 77;
        CHECK_FAILS(PKC_E_ARGUMENT, "w ", pkc_grid_item(&grid, wrong[i], 10, &w, &h));
        CHECK_FAILS(PKC_E_ARGUMENT, "h ", pkc_grid_item(&grid, 10, wrong[i], &w, &h));
        assert_int_equal(w, 77);
        assert_int_equal(h, 77);
    }
}

static void centre_is_that_of_the_cells(void **state) {
    static const int32_t wrong_at[] = {INT_MIN, -1, 128, INT_MAX};
    static const int32_t wrong_side[] = {INT_MIN, -1, 0, 129, INT_MAX};
    const pkc_grid grid = make_grid(320, 260, 10, 30, 0);
    double x = 0;
    double y = 0;
    size_t i;
    (void)state;
    CHECK_OK(pkc_grid_centre(&grid, 0, 0, 1, 1, &x, &y));
    assert_true(x == 25 && y == 25);
    CHECK_OK(pkc_grid_centre(&grid, 9, 6, 1, 2, &x, &y)); /* the bottom right corner */
    assert_true(x == 295 && y == 220);
    CHECK_OK(pkc_grid_centre(&grid, 2, 3, 3, 2, &x, &y));
    assert_true(x == 115 && y == 130);
    for (i = 0; i < sizeof wrong_at / sizeof wrong_at[0]; ++i) {
        CHECK_FAILS(PKC_E_ARGUMENT, "x ", pkc_grid_centre(&grid, wrong_at[i], 0, 1, 1, &x, &y));
        CHECK_FAILS(PKC_E_ARGUMENT, "y ", pkc_grid_centre(&grid, 0, wrong_at[i], 1, 1, &x, &y));
    }
    for (i = 0; i < sizeof wrong_side / sizeof wrong_side[0]; ++i) {
        CHECK_FAILS(PKC_E_ARGUMENT, "w ", pkc_grid_centre(&grid, 0, 0, wrong_side[i], 1, &x, &y));
        CHECK_FAILS(PKC_E_ARGUMENT, "h ", pkc_grid_centre(&grid, 0, 0, 1, wrong_side[i], &x, &y));
    }
    assert_true(x == 115 && y == 130);
}

static void every_null_is_named(void **state) {
    const pkc_grid grid = make_grid(320, 260, 10, 30, 0);
    int32_t n = 77;
    double x = 77;
    (void)state;
    CHECK_FAILS(PKC_E_ARGUMENT, "grid is NULL", pkc_grid_bin(NULL, &n, &n));
    CHECK_FAILS(PKC_E_ARGUMENT, "out_w is NULL", pkc_grid_bin(&grid, NULL, &n));
    CHECK_FAILS(PKC_E_ARGUMENT, "out_h is NULL", pkc_grid_bin(&grid, &n, NULL));
    CHECK_FAILS(PKC_E_ARGUMENT, "grid is NULL", pkc_grid_item(NULL, 1, 1, &n, &n));
    CHECK_FAILS(PKC_E_ARGUMENT, "out_w is NULL", pkc_grid_item(&grid, 1, 1, NULL, &n));
    CHECK_FAILS(PKC_E_ARGUMENT, "out_h is NULL", pkc_grid_item(&grid, 1, 1, &n, NULL));
    CHECK_FAILS(PKC_E_ARGUMENT, "grid is NULL", pkc_grid_centre(NULL, 0, 0, 1, 1, &x, &x));
    CHECK_FAILS(PKC_E_ARGUMENT, "out_x is NULL", pkc_grid_centre(&grid, 0, 0, 1, 1, NULL, &x));
    CHECK_FAILS(PKC_E_ARGUMENT, "out_y is NULL", pkc_grid_centre(&grid, 0, 0, 1, 1, &x, NULL));
    assert_int_equal(n, 77);
    assert_true(x == 77);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_papers_bin_has_10_by_8_cells),
        cmocka_unit_test(bins_round_down_and_items_round_up),
        cmocka_unit_test(whole_numbers_of_cells_survive_binary_fractions),
        cmocka_unit_test(every_field_is_checked),
        cmocka_unit_test(zero_is_allowed_for_margin_and_clearance_alone),
        cmocka_unit_test(reserved_must_be_zero),
        cmocka_unit_test(cells_must_come_to_1_to_128),
        cmocka_unit_test(item_sides_are_checked),
        cmocka_unit_test(centre_is_that_of_the_cells),
        cmocka_unit_test(every_null_is_named),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
