/* The bin through the C API: right use, every wrong argument, and worked contact rewards. */
#include <limits.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "check.h"

static pkc_bin_info info_of(const pkc_bin *bin) {
    pkc_bin_info info;
    CHECK_OK(pkc_bin_info_init(&info, sizeof info));
    CHECK_OK(pkc_bin_get_info(bin, &info));
    return info;
}

static void create_takes_sides_of_1_to_128(void **state) {
    static const int32_t right[] = {1, 2, 64, 65, 127, 128};
    static const int32_t wrong[] = {INT_MIN, -1, 0, 129, INT_MAX};
    size_t i;
    (void)state;
    for (i = 0; i < sizeof right / sizeof right[0]; ++i) {
        pkc_bin *bin = check_bin(right[i], 129 - right[i]);
        const pkc_bin_info info = info_of(bin);
        assert_int_equal(info.w, right[i]);
        assert_int_equal(info.h, 129 - right[i]);
        assert_int_equal(info.items, 0);
        assert_int_equal(info.occupied_cells, 0);
        assert_int_equal(info.fixed_cells, 0);
        pkc_bin_free(bin);
    }
    for (i = 0; i < sizeof wrong / sizeof wrong[0]; ++i) {
        pkc_bin *const sentinel = (pkc_bin *)&state;
        pkc_bin *bin = sentinel;
        char text[64];
        snprintf(text, sizeof text, "bin width %d: must be 1..128", wrong[i]);
        CHECK_FAILS(PKC_E_ARGUMENT, text, pkc_bin_create(wrong[i], 5, &bin));
        snprintf(text, sizeof text, "bin height %d: must be 1..128", wrong[i]);
        CHECK_FAILS(PKC_E_ARGUMENT, text, pkc_bin_create(5, wrong[i], &bin));
        assert_ptr_equal(bin, sentinel);
    }
    CHECK_FAILS(PKC_E_ARGUMENT, "out_bin", pkc_bin_create(5, 5, NULL));
}

static void every_null_is_named(void **state) {
    pkc_bin *bin = check_bin(3, 3);
    pkc_bin *other = NULL;
    pkc_bin_info info;
    pkc_placement placement;
    int32_t cells[9];
    uint8_t mask[10];
    size_t count = 99;
    int32_t reward = 99;
    const pkc_item item = check_item(1, 1, 1, 0);
    (void)state;
    CHECK_OK(pkc_bin_info_init(&info, sizeof info));
    CHECK_FAILS(PKC_E_ARGUMENT, "bin is NULL", pkc_bin_clone(NULL, &other));
    CHECK_FAILS(PKC_E_ARGUMENT, "out_bin is NULL", pkc_bin_clone(bin, NULL));
    CHECK_FAILS(PKC_E_ARGUMENT, "bin is NULL", pkc_bin_clear(NULL));
    CHECK_FAILS(PKC_E_ARGUMENT, "bin is NULL", pkc_bin_block(NULL, 0, 0, 1, 1));
    CHECK_FAILS(PKC_E_ARGUMENT, "bin is NULL", pkc_bin_pack(NULL, &item, 0, 0, 0));
    CHECK_FAILS(PKC_E_ARGUMENT, "item is NULL", pkc_bin_pack(bin, NULL, 0, 0, 0));
    CHECK_FAILS(PKC_E_ARGUMENT, "bin is NULL", pkc_bin_unpack(NULL, 1, &placement));
    CHECK_FAILS(PKC_E_ARGUMENT, "bin is NULL", pkc_bin_get_info(NULL, &info));
    CHECK_FAILS(PKC_E_ARGUMENT, "info is NULL", pkc_bin_get_info(bin, NULL));
    CHECK_FAILS(PKC_E_ARGUMENT, "bin is NULL", pkc_bin_items(NULL, &placement, 1, &count));
    CHECK_FAILS(PKC_E_ARGUMENT, "out_count is NULL", pkc_bin_items(bin, &placement, 1, NULL));
    CHECK_FAILS(PKC_E_ARGUMENT, "bin is NULL", pkc_bin_cells(NULL, cells, 9, &count));
    CHECK_FAILS(PKC_E_ARGUMENT, "cells is NULL", pkc_bin_cells(bin, NULL, 9, &count));
    CHECK_FAILS(PKC_E_ARGUMENT, "out_count is NULL", pkc_bin_cells(bin, cells, 9, NULL));
    CHECK_FAILS(PKC_E_ARGUMENT, "out_count is NULL", pkc_bin_cells(bin, NULL, 0, NULL));
    CHECK_FAILS(PKC_E_ARGUMENT, "bin is NULL", pkc_bin_feasible(NULL, 1, 1, mask, 10, &count));
    CHECK_FAILS(PKC_E_ARGUMENT, "mask is NULL", pkc_bin_feasible(bin, 1, 1, NULL, 10, &count));
    CHECK_FAILS(PKC_E_ARGUMENT, "out_count is NULL", pkc_bin_feasible(bin, 1, 1, mask, 10, NULL));
    CHECK_FAILS(PKC_E_ARGUMENT, "bin is NULL", pkc_bin_contact(NULL, 0, 0, 1, 1, &reward));
    CHECK_FAILS(PKC_E_ARGUMENT, "out_reward is NULL", pkc_bin_contact(bin, 0, 0, 1, 1, NULL));
    CHECK_OK(pkc_bin_pack(bin, &item, 0, 0, 0));
    CHECK_FAILS(PKC_E_ARGUMENT, "placements is NULL", pkc_bin_items(bin, NULL, 1, &count));
    assert_null(other);
    assert_int_equal(count, 99);
    assert_int_equal(reward, 99);
    pkc_bin_free(bin);
}

static void pack_then_unpack_gives_the_bin_and_the_place_back(void **state) {
    pkc_bin *bin = check_bin(6, 5);
    const pkc_item item = check_item(7, 3, 2, 0);
    const uint64_t before = info_of(bin).hash;
    pkc_placement out;
    (void)state;
    CHECK_OK(pkc_bin_pack(bin, &item, 4, 1, 1));
    assert_int_equal(info_of(bin).items, 1);
    assert_int_equal(info_of(bin).occupied_cells, 6);
    assert_true(info_of(bin).hash != before);
    CHECK_OK(pkc_bin_unpack(bin, 7, &out));
    assert_memory_equal(&out.item, &item, sizeof item);
    assert_int_equal(out.x, 4);
    assert_int_equal(out.y, 1);
    assert_int_equal(out.rot, 1);
    assert_int_equal(info_of(bin).items, 0);
    assert_int_equal(info_of(bin).occupied_cells, 0);
    assert_true(info_of(bin).hash == before);
    CHECK_OK(pkc_bin_pack(bin, &item, 0, 0, 0));
    CHECK_OK(pkc_bin_unpack(bin, 7, NULL));
    pkc_bin_free(bin);
}

static void pack_refuses_what_breaks_a_rule_and_changes_nothing(void **state) {
    static const int32_t wrong_side[] = {INT_MIN, -1, 0, 129, INT_MAX};
    static const int32_t wrong_at[] = {INT_MIN, -1, 128, INT_MAX};
    static const int32_t wrong_rot[] = {INT_MIN, -1, 2, INT_MAX};
    pkc_bin *bin = check_bin(6, 5);
    pkc_queue *queue = check_queue("S-R1A1");
    check_state before;
    pkc_item item;
    char text[64];
    size_t i;
    (void)state;
    check_pack(bin, 1, 3, 2, 0, 0);
    CHECK_OK(pkc_bin_block(bin, 5, 4, 1, 1));
    before = check_remember(bin, queue);
    for (i = 0; i < sizeof wrong_side / sizeof wrong_side[0]; ++i) {
        item = check_item(2, wrong_side[i], 1, 0);
        snprintf(text, sizeof text, "item w %d: must be 1..128", wrong_side[i]);
        CHECK_FAILS(PKC_E_ARGUMENT, text, pkc_bin_pack(bin, &item, 4, 0, 0));
        item = check_item(2, 1, wrong_side[i], 0);
        snprintf(text, sizeof text, "item h %d: must be 1..128", wrong_side[i]);
        CHECK_FAILS(PKC_E_ARGUMENT, text, pkc_bin_pack(bin, &item, 4, 0, 0));
    }
    item = check_item(INT_MIN, 1, 1, 0);
    CHECK_FAILS(PKC_E_ARGUMENT, "item id -2147483648", pkc_bin_pack(bin, &item, 4, 0, 0));
    item = check_item(-1, 1, 1, 0);
    CHECK_FAILS(PKC_E_ARGUMENT, "item id -1", pkc_bin_pack(bin, &item, 4, 0, 0));
    item = check_item(2, 1, 1, 4);
    CHECK_FAILS(PKC_E_ARGUMENT, "item flags 4", pkc_bin_pack(bin, &item, 4, 0, 0));
    item = check_item(2, 1, 1, UINT32_MAX);
    CHECK_FAILS(PKC_E_ARGUMENT, "item flags 4294967295", pkc_bin_pack(bin, &item, 4, 0, 0));
    item = check_item(2, 2, 1, 0);
    for (i = 0; i < sizeof wrong_at / sizeof wrong_at[0]; ++i) {
        snprintf(text, sizeof text, "x %d: must be 0..127", wrong_at[i]);
        CHECK_FAILS(PKC_E_ARGUMENT, text, pkc_bin_pack(bin, &item, wrong_at[i], 0, 0));
        snprintf(text, sizeof text, "y %d: must be 0..127", wrong_at[i]);
        CHECK_FAILS(PKC_E_ARGUMENT, text, pkc_bin_pack(bin, &item, 4, wrong_at[i], 0));
    }
    for (i = 0; i < sizeof wrong_rot / sizeof wrong_rot[0]; ++i) {
        snprintf(text, sizeof text, "rot %d: must be 0..1", wrong_rot[i]);
        CHECK_FAILS(PKC_E_ARGUMENT, text, pkc_bin_pack(bin, &item, 4, 0, wrong_rot[i]));
    }
    CHECK_FAILS(PKC_E_STATE, "2x1 at (5, 0)", pkc_bin_pack(bin, &item, 5, 0, 0));
    CHECK_FAILS(PKC_E_STATE, "(0, 127)", pkc_bin_pack(bin, &item, 0, 127, 0));
    CHECK_FAILS(PKC_E_STATE, "2x1 at (2, 1)", pkc_bin_pack(bin, &item, 2, 1, 0)); /* on item 1 */
    CHECK_FAILS(PKC_E_STATE, "1x2 at (5, 3)", pkc_bin_pack(bin, &item, 5, 3, 1)); /* on the block */
    item = check_item(1, 1, 1, 0);
    CHECK_FAILS(PKC_E_STATE, "item 1", pkc_bin_pack(bin, &item, 4, 0, 0));
    item = check_item(2, 2, 1, PKC_ITEM_NO_ROTATE);
    CHECK_FAILS(PKC_E_STATE, "item 2", pkc_bin_pack(bin, &item, 4, 0, 1));
    check_unchanged(&before, bin, queue);
    pkc_queue_free(queue);
    pkc_bin_free(bin);
}

static void unpack_refuses_absent_and_pinned_items(void **state) {
    pkc_bin *bin = check_bin(4, 4);
    const pkc_item pinned = check_item(3, 2, 2, PKC_ITEM_PINNED);
    pkc_placement out;
    pkc_placement sentinel;
    (void)state;
    memset(&out, 0x5a, sizeof out);
    sentinel = out;
    CHECK_OK(pkc_bin_pack(bin, &pinned, 0, 0, 0));
    CHECK_FAILS(PKC_E_STATE, "item 3", pkc_bin_unpack(bin, 3, &out));
    CHECK_FAILS(PKC_E_STATE, "item 4", pkc_bin_unpack(bin, 4, &out));
    CHECK_FAILS(PKC_E_STATE, "item -1", pkc_bin_unpack(bin, -1, &out));
    CHECK_FAILS(PKC_E_STATE, "item -2147483648", pkc_bin_unpack(bin, INT_MIN, &out));
    CHECK_FAILS(PKC_E_STATE, "item 2147483647", pkc_bin_unpack(bin, INT_MAX, &out));
    assert_memory_equal(&out, &sentinel, sizeof out);
    assert_int_equal(info_of(bin).items, 1);
    pkc_bin_free(bin);
}

static void the_largest_id_is_an_id(void **state) {
    pkc_bin *bin = check_bin(2, 2);
    (void)state;
    check_pack(bin, INT_MAX, 1, 1, 0, 0);
    check_pack(bin, 0, 1, 1, 1, 1);
    CHECK_OK(pkc_bin_unpack(bin, INT_MAX, NULL));
    pkc_bin_free(bin);
}

static void block_takes_free_cells_alone(void **state) {
    static const int32_t wrong[] = {INT_MIN, -1, INT_MAX};
    pkc_bin *bin = check_bin(5, 4);
    size_t i;
    (void)state;
    for (i = 0; i < sizeof wrong / sizeof wrong[0]; ++i) {
        CHECK_FAILS(PKC_E_ARGUMENT, "x ", pkc_bin_block(bin, wrong[i], 0, 1, 1));
        CHECK_FAILS(PKC_E_ARGUMENT, "y ", pkc_bin_block(bin, 0, wrong[i], 1, 1));
        CHECK_FAILS(PKC_E_ARGUMENT, "w ", pkc_bin_block(bin, 0, 0, wrong[i], 1));
        CHECK_FAILS(PKC_E_ARGUMENT, "h ", pkc_bin_block(bin, 0, 0, 1, wrong[i]));
    }
    CHECK_FAILS(PKC_E_ARGUMENT, "w 0", pkc_bin_block(bin, 0, 0, 0, 1));
    CHECK_FAILS(PKC_E_ARGUMENT, "h 129", pkc_bin_block(bin, 0, 0, 1, 129));
    CHECK_FAILS(PKC_E_STATE, "2x1 at (4, 0)", pkc_bin_block(bin, 4, 0, 2, 1));
    CHECK_OK(pkc_bin_block(bin, 1, 1, 2, 2));
    CHECK_FAILS(PKC_E_STATE, "1x1 at (2, 2)", pkc_bin_block(bin, 2, 2, 1, 1));
    check_pack(bin, 1, 1, 1, 0, 0);
    CHECK_FAILS(PKC_E_STATE, "2x1 at (0, 0)", pkc_bin_block(bin, 0, 0, 2, 1));
    assert_int_equal(info_of(bin).fixed_cells, 4);
    assert_int_equal(info_of(bin).occupied_cells, 5);
    pkc_bin_free(bin);
}

static void clear_removes_items_and_keeps_fixed_cells(void **state) {
    pkc_bin *bin = check_bin(5, 4);
    const pkc_item pinned = check_item(3, 1, 1, PKC_ITEM_PINNED);
    uint64_t hash;
    (void)state;
    CHECK_OK(pkc_bin_block(bin, 1, 1, 2, 2));
    hash = info_of(bin).hash;
    check_pack(bin, 1, 1, 1, 0, 0);
    CHECK_OK(pkc_bin_pack(bin, &pinned, 4, 3, 0));
    CHECK_OK(pkc_bin_clear(bin));
    assert_int_equal(info_of(bin).items, 0);
    assert_int_equal(info_of(bin).occupied_cells, 4);
    assert_int_equal(info_of(bin).fixed_cells, 4);
    assert_true(info_of(bin).hash == hash);
    pkc_bin_free(bin);
}

static void a_clone_is_equal_and_apart(void **state) {
    pkc_bin *bin = check_bin(5, 4);
    pkc_bin *clone = NULL;
    (void)state;
    CHECK_OK(pkc_bin_block(bin, 1, 1, 2, 2));
    check_pack(bin, 1, 1, 1, 0, 0);
    CHECK_OK(pkc_bin_clone(bin, &clone));
    assert_true(info_of(clone).hash == info_of(bin).hash);
    assert_int_equal(info_of(clone).fixed_cells, 4);
    CHECK_OK(pkc_bin_unpack(clone, 1, NULL));
    assert_int_equal(info_of(bin).items, 1);
    assert_int_equal(info_of(clone).items, 0);
    pkc_bin_free(bin);
    assert_int_equal(info_of(clone).fixed_cells, 4);
    pkc_bin_free(clone);
}

static void items_come_in_packing_order(void **state) {
    pkc_bin *bin = check_bin(5, 4);
    pkc_placement out[3];
    size_t count = 99;
    (void)state;
    CHECK_OK(pkc_bin_items(bin, NULL, 0, &count));
    assert_int_equal(count, 0);
    check_pack(bin, 9, 1, 2, 4, 0);
    check_pack(bin, 2, 2, 1, 0, 3);
    check_pack(bin, 5, 1, 1, 0, 0);
    CHECK_FAILS(PKC_E_CAPACITY, "3", pkc_bin_items(bin, NULL, 0, &count));
    assert_int_equal(count, 3);
    memset(out, 0x5a, sizeof out);
    count = 0;
    CHECK_FAILS(PKC_E_CAPACITY, "capacity 2", pkc_bin_items(bin, out, 2, &count));
    assert_int_equal(count, 3);
    assert_int_equal(out[0].x, 0x5a5a5a5a);
    CHECK_OK(pkc_bin_unpack(bin, 2, NULL));
    check_pack(bin, 2, 2, 1, 1, 3);
    CHECK_OK(pkc_bin_items(bin, out, 3, &count));
    assert_int_equal(out[0].item.id, 9);
    assert_int_equal(out[1].item.id, 5);
    assert_int_equal(out[2].item.id, 2);
    assert_int_equal(out[2].x, 1);
    assert_int_equal(out[0].item.h, 2);
    pkc_bin_free(bin);
}

static void cells_name_items_free_and_fixed(void **state) {
    static const int32_t want[12] = {7, 7, -1, 0, 7, 7, -1, 0, -2, -1, -1, 0};
    pkc_bin *bin = check_bin(4, 3);
    const pkc_item tall = check_item(0, 3, 1, 0);
    int32_t cells[12];
    size_t count = 0;
    (void)state;
    check_pack(bin, 7, 2, 2, 0, 0);
    CHECK_OK(pkc_bin_pack(bin, &tall, 3, 0, 1));
    CHECK_OK(pkc_bin_block(bin, 0, 2, 1, 1));
    memset(cells, 0x5a, sizeof cells);
    CHECK_FAILS(PKC_E_CAPACITY, "12", pkc_bin_cells(bin, cells, 11, &count));
    assert_int_equal(count, 12);
    assert_int_equal(cells[0], 0x5a5a5a5a);
    CHECK_OK(pkc_bin_cells(bin, cells, 12, &count));
    assert_memory_equal(cells, want, sizeof want);
    pkc_bin_free(bin);
}

static void feasibility_mask_ends_with_no_position(void **state) {
    /* A 3 x 3 bin with its centre taken: a 2 x 1 lies in the top or the bottom row. */
    static const uint8_t flat[10] = {1, 1, 0, 0, 0, 0, 1, 1, 0, 0};
    static const uint8_t none[10] = {0, 0, 0, 0, 0, 0, 0, 0, 0, 1};
    static const int32_t wrong[] = {INT_MIN, -1, 0, 129, INT_MAX};
    pkc_bin *bin = check_bin(3, 3);
    uint8_t mask[10];
    uint8_t kept[10];
    size_t count = 0;
    size_t i;
    (void)state;
    CHECK_OK(pkc_bin_block(bin, 1, 1, 1, 1));
    CHECK_OK(pkc_bin_feasible(bin, 2, 1, mask, 10, &count));
    assert_int_equal(count, 10);
    assert_memory_equal(mask, flat, 10);
    CHECK_OK(pkc_bin_feasible(bin, 2, 2, mask, 10, &count));
    assert_memory_equal(mask, none, 10);
    CHECK_OK(pkc_bin_feasible(bin, 4, 1, mask, 10, &count)); /* wider than the bin */
    assert_memory_equal(mask, none, 10);
    CHECK_OK(pkc_bin_feasible(bin, 1, 128, mask, 10, &count));
    assert_memory_equal(mask, none, 10);
    memset(mask, 0x5a, sizeof mask);
    memset(kept, 0x5a, sizeof kept);
    CHECK_FAILS(PKC_E_CAPACITY, "10", pkc_bin_feasible(bin, 1, 1, mask, 9, &count));
    CHECK_FAILS(PKC_E_CAPACITY, "10", pkc_bin_feasible(bin, 1, 1, NULL, 0, &count));
    count = 99;
    for (i = 0; i < sizeof wrong / sizeof wrong[0]; ++i) {
        CHECK_FAILS(PKC_E_ARGUMENT, "w ", pkc_bin_feasible(bin, wrong[i], 1, mask, 10, &count));
        CHECK_FAILS(PKC_E_ARGUMENT, "h ", pkc_bin_feasible(bin, 1, wrong[i], mask, 10, &count));
    }
    assert_int_equal(count, 99);
    assert_memory_equal(mask, kept, 10);
    pkc_bin_free(bin);
}

/* Worked by hand on the padded map, with walls as ones:
 *
 *     # # # # # # #
 *     # A A . . . #      A: item 1, 2 x 2 at (0, 0)
 *     # A A . . . #      F: fixed, (4, 3)
 *     # . . . . . #
 *     # . . . . F #
 *     # # # # # # #
 */
static void contact_reward_agrees_with_worked_examples(void **state) {
    static const struct {
        int32_t x, y, w, h, reward;
    } examples[] = {
        {2, 0, 2, 1, 2 + 1},         /* wall above 2, A on the left 1 */
        {2, 0, 3, 2, 3 + 2 + 2},     /* wall above 3, A left 2, wall right 2 */
        {0, 2, 2, 2, 2 + 2 + 2},     /* A above 2, wall left 2, wall below 2 */
        {2, 2, 2, 2, 2 + 1},         /* wall below 2, F on the right of its lower row 1 */
        {3, 2, 1, 1, 0},             /* touches nothing: F is diagonal to it */
        {4, 2, 1, 1, 1 + 1},         /* wall right, F below */
        {4, 0, 1, 3, 1 + 3 + 1},     /* wall above, wall right 3, F below */
        {0, 2, 5, 1, 2 + 1 + 1 + 1}, /* A above 2, both walls, F below */
        {0, 3, 4, 1, 1 + 4 + 1},     /* wall left, wall below 4, F right */
        {2, 1, 1, 1, 1},             /* A on the left */
    };
    pkc_bin *bin = check_bin(5, 4);
    pkc_bin *whole = check_bin(4, 3);
    size_t i;
    int32_t reward = -5;
    (void)state;
    check_pack(bin, 1, 2, 2, 0, 0);
    CHECK_OK(pkc_bin_block(bin, 4, 3, 1, 1));
    for (i = 0; i < sizeof examples / sizeof examples[0]; ++i) {
        CHECK_OK(pkc_bin_contact(bin, examples[i].x, examples[i].y, examples[i].w, examples[i].h,
                                 &reward));
        assert_int_equal(reward, examples[i].reward);
    }
    CHECK_OK(pkc_bin_contact(whole, 0, 0, 4, 3, &reward)); /* all of 2(w + h) */
    assert_int_equal(reward, 14);
    pkc_bin_free(whole);
    pkc_bin_free(bin);
}

static void contact_refuses_places_that_are_not_free(void **state) {
    static const int32_t wrong[] = {INT_MIN, -1, INT_MAX};
    pkc_bin *bin = check_bin(5, 4);
    int32_t reward = -5;
    size_t i;
    (void)state;
    check_pack(bin, 1, 2, 2, 0, 0);
    CHECK_FAILS(PKC_E_STATE, "1x1 at (1, 1)", pkc_bin_contact(bin, 1, 1, 1, 1, &reward));
    CHECK_FAILS(PKC_E_STATE, "2x1 at (4, 0)", pkc_bin_contact(bin, 4, 0, 2, 1, &reward));
    CHECK_FAILS(PKC_E_STATE, "(127, 127)", pkc_bin_contact(bin, 127, 127, 128, 128, &reward));
    for (i = 0; i < sizeof wrong / sizeof wrong[0]; ++i) {
        CHECK_FAILS(PKC_E_ARGUMENT, "x ", pkc_bin_contact(bin, wrong[i], 0, 1, 1, &reward));
        CHECK_FAILS(PKC_E_ARGUMENT, "y ", pkc_bin_contact(bin, 0, wrong[i], 1, 1, &reward));
        CHECK_FAILS(PKC_E_ARGUMENT, "w ", pkc_bin_contact(bin, 2, 0, wrong[i], 1, &reward));
        CHECK_FAILS(PKC_E_ARGUMENT, "h ", pkc_bin_contact(bin, 2, 0, 1, wrong[i], &reward));
    }
    assert_int_equal(reward, -5);
    pkc_bin_free(bin);
}

static void equal_occupancy_has_equal_hash(void **state) {
    pkc_bin *one = check_bin(5, 4);
    pkc_bin *two = check_bin(5, 4);
    (void)state;
    check_pack(one, 1, 2, 2, 0, 0);
    check_pack(two, 8, 1, 2, 1, 0);
    CHECK_OK(pkc_bin_block(two, 0, 0, 1, 2));
    assert_true(info_of(one).hash == info_of(two).hash);
    check_pack(two, 9, 1, 1, 4, 3);
    assert_true(info_of(one).hash != info_of(two).hash);
    pkc_bin_free(one);
    pkc_bin_free(two);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(create_takes_sides_of_1_to_128),
        cmocka_unit_test(every_null_is_named),
        cmocka_unit_test(pack_then_unpack_gives_the_bin_and_the_place_back),
        cmocka_unit_test(pack_refuses_what_breaks_a_rule_and_changes_nothing),
        cmocka_unit_test(unpack_refuses_absent_and_pinned_items),
        cmocka_unit_test(the_largest_id_is_an_id),
        cmocka_unit_test(block_takes_free_cells_alone),
        cmocka_unit_test(clear_removes_items_and_keeps_fixed_cells),
        cmocka_unit_test(a_clone_is_equal_and_apart),
        cmocka_unit_test(items_come_in_packing_order),
        cmocka_unit_test(cells_name_items_free_and_fixed),
        cmocka_unit_test(feasibility_mask_ends_with_no_position),
        cmocka_unit_test(contact_reward_agrees_with_worked_examples),
        cmocka_unit_test(contact_refuses_places_that_are_not_free),
        cmocka_unit_test(equal_occupancy_has_equal_hash),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
