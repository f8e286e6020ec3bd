/* Snapshots: a round trip loses nothing, and no damaged byte is taken for good. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "check.h"

static const char *const scenarios[] = {"S-R1A1",   "S-R5A1",   "S-R5A3",
                                        "D-R2A2O2", "D-R5A2O2", "D-R5A3O1"};

/* A random state reached by planning some steps, so that belts, regions and buffers occur as they
 * do in use. */
static void make_state(uint64_t *seed, pkc_planner *planner, pkc_bin **bin, pkc_queue **queue) {
    const pkc_budget budget = check_budget(300);
    const int32_t side = check_draw(seed, 3, 9);
    const int32_t steps = check_draw(seed, 0, 6);
    int32_t i;
    *bin = check_bin(side, check_draw(seed, 3, 9));
    *queue = check_queue(scenarios[check_draw(seed, 0, 5)]);
    if (check_draw(seed, 0, 1)) CHECK_OK(pkc_bin_block(*bin, 1, 1, check_draw(seed, 1, 2), 1));
    for (i = check_draw(seed, 0, 14); i > 0; --i) {
        const pkc_item item = check_item(1000 - i, check_draw(seed, 1, 4), check_draw(seed, 1, 4),
                                         (uint32_t)check_draw(seed, 0, 3));
        CHECK_OK(pkc_queue_push(*queue, &item));
    }
    for (i = 0; i < steps; ++i) {
        pkc_action actions[64];
        size_t count = 0;
        CHECK_OK(pkc_planner_plan(planner, *bin, *queue, &budget, NULL));
        CHECK_OK(pkc_planner_result(planner, NULL, actions, 64, &count));
        CHECK_OK(pkc_step_apply(*bin, *queue, actions, count));
    }
}

static pkc_planner *make_planner(void) {
    pkc_planner_options options = check_options();
    pkc_planner *planner = NULL;
    options.repack = PKC_REPACK_ANYTIME;
    options.memory = 65536;
    options.max_side = 16;
    CHECK_OK(pkc_planner_create(&options, NULL, &planner));
    return planner;
}

static uint64_t plan_of(pkc_planner *planner, const pkc_bin *bin, const pkc_queue *queue) {
    const pkc_budget budget = check_budget(300);
    pkc_plan_info info = check_plan_info();
    CHECK_OK(pkc_planner_plan(planner, bin, queue, &budget, &info));
    return info.hash;
}

static void a_round_trip_gives_the_same_bytes_and_the_same_plan(void **state) {
    const uint64_t first_seed = 1;
    const int rounds = check_count(150, 3000);
    pkc_planner *planner = make_planner();
    int round;
    (void)state;
    for (round = 0; round < rounds; ++round) {
        uint64_t seed = first_seed + (uint64_t)round;
        pkc_bin *bin;
        pkc_queue *queue;
        pkc_bin *bin_again = NULL;
        pkc_queue *queue_again = NULL;
        pkc_bin_info one;
        pkc_bin_info two;
        check_state saved;
        make_state(&seed, planner, &bin, &queue);
        saved = check_remember(bin, queue);
        CHECK_OK(pkc_snapshot_load(saved.bytes, saved.size, &bin_again, &queue_again));
        CHECK_OK(pkc_bin_info_init(&one, sizeof one));
        CHECK_OK(pkc_bin_info_init(&two, sizeof two));
        CHECK_OK(pkc_bin_get_info(bin, &one));
        CHECK_OK(pkc_bin_get_info(bin_again, &two));
        if (memcmp(&one, &two, sizeof one) != 0 ||
            plan_of(planner, bin, queue) != plan_of(planner, bin_again, queue_again)) {
            print_error("seed %d\n", round + 1);
            fail();
        }
        check_unchanged(&saved, bin_again, queue_again);
        pkc_bin_free(bin);
        pkc_queue_free(queue);
        pkc_bin_free(bin_again);
        pkc_queue_free(queue_again);
    }
    pkc_planner_free(planner);
}

/* Loads that must fail: out-parameters stay as they were. */
static void refuse(const uint8_t *bytes, size_t size, const char *text) {
    static char somewhere;
    pkc_bin *const no_bin = (pkc_bin *)(void *)&somewhere;
    pkc_queue *const no_queue = (pkc_queue *)(void *)&somewhere;
    pkc_bin *bin = no_bin;
    pkc_queue *queue = no_queue;
    CHECK_FAILS(PKC_E_FORMAT, text, pkc_snapshot_load(bytes, size, &bin, &queue));
    assert_ptr_equal(bin, no_bin);
    assert_ptr_equal(queue, no_queue);
}

static check_state small_state(void) {
    pkc_bin *bin = check_bin(3, 3);
    pkc_queue *queue = check_queue("D-R5A3O1");
    pkc_action unpack;
    check_state saved;
    memset(&unpack, 0, sizeof unpack);
    unpack.op = PKC_OP_UNPACK;
    unpack.item = 8;
    unpack.arm = 1;
    CHECK_OK(pkc_bin_block(bin, 2, 2, 1, 1));
    check_pack(bin, 8, 1, 2, 0, 0);
    CHECK_OK(pkc_step_apply(bin, queue, &unpack, 1));
    check_pack(bin, 9, 2, 1, 0, 0);
    check_push(queue, 1, 2, 2);
    check_push(queue, 2, 1, 2);
    saved = check_remember(bin, queue);
    pkc_bin_free(bin);
    pkc_queue_free(queue);
    return saved;
}

static void truncation_at_every_byte_is_refused(void **state) {
    check_state saved = small_state();
    size_t size;
    (void)state;
    for (size = 0; size < saved.size; ++size) {
        /* An exact copy, so that a read beyond the end is seen. */
        uint8_t *part = (uint8_t *)malloc(size > 0 ? size : 1);
        assert_non_null(part);
        memcpy(part, saved.bytes, size);
        refuse(part, size, "byte ");
        free(part);
    }
    free(saved.bytes);
}

static void a_flipped_bit_at_every_byte_is_refused(void **state) {
    check_state saved = small_state();
    size_t at;
    int bit;
    (void)state;
    for (at = 0; at < saved.size; ++at) {
        for (bit = 0; bit < 8; ++bit) {
            saved.bytes[at] ^= (uint8_t)(1 << bit);
            refuse(saved.bytes, saved.size, NULL);
            saved.bytes[at] ^= (uint8_t)(1 << bit);
        }
    }
    free(saved.bytes);
}

static void bytes_after_the_end_are_refused(void **state) {
    check_state saved = small_state();
    uint8_t *more = (uint8_t *)calloc(saved.size + 1, 1);
    (void)state;
    assert_non_null(more);
    memcpy(more, saved.bytes, saved.size);
    refuse(more, saved.size + 1, "byte ");
    free(more);
    free(saved.bytes);
}

/* With the checksum made right again, every field alone has to stand up to any value. */
static void random_values_with_a_right_checksum_never_crash(void **state) {
    check_state saved = small_state();
    const int rounds = check_count(20000, 1000000);
    uint64_t seed = 77;
    int round;
    (void)state;
    for (round = 0; round < rounds; ++round) {
        uint8_t *bytes = (uint8_t *)malloc(saved.size);
        uint64_t hash = 0xcbf29ce484222325u;
        pkc_bin *bin = NULL;
        pkc_queue *queue = NULL;
        pkc_status status;
        size_t i;
        int changes;
        assert_non_null(bytes);
        memcpy(bytes, saved.bytes, saved.size);
        for (changes = check_draw(&seed, 1, 3); changes > 0; --changes) {
            const size_t at = (size_t)check_draw(&seed, 8, (int32_t)saved.size - 9);
            static const uint8_t values[] = {0, 1, 2, 3, 4, 9, 64, 127, 128, 129, 255};
            bytes[at] = check_draw(&seed, 0, 1) ? values[check_draw(&seed, 0, 10)]
                                                : (uint8_t)check_draw(&seed, 0, 255);
        }
        for (i = 0; i + 8 < saved.size; ++i) hash = (hash ^ bytes[i]) * 0x100000001b3u;
        for (i = 0; i < 8; ++i) bytes[saved.size - 8 + i] = (uint8_t)(hash >> (8 * i));
        status = pkc_snapshot_load(bytes, saved.size, &bin, &queue);
        if (status == PKC_OK) {
            /* What is accepted is a state like any other. */
            size_t size = 0;
            uint8_t *again = check_snapshot(bin, queue, &size);
            assert_int_equal(size, saved.size);
            assert_memory_equal(again, bytes, size);
            free(again);
            pkc_bin_free(bin);
            pkc_queue_free(queue);
        } else {
            assert_int_equal(status, PKC_E_FORMAT);
        }
        free(bytes);
    }
    free(saved.bytes);
}

static void what_is_saved_can_be_loaded(void **state) {
    pkc_bin *bin = check_bin(3, 3);
    pkc_queue *queue = check_queue("S-R1A1");
    uint8_t bytes[512];
    size_t size = 77;
    (void)state;
    check_pack(bin, 5, 1, 1, 0, 0);
    check_push(queue, 5, 1, 1);
    /* One id in the bin and on the belt: such a pair cannot be loaded, so it must not be saved. */
    CHECK_FAILS(PKC_E_STATE, "5", pkc_snapshot_save(bin, queue, bytes, sizeof bytes, &size));
    assert_int_equal(size, 77);
    pkc_bin_free(bin);
    pkc_queue_free(queue);
}

static void a_large_state_survives(void **state) {
    pkc_bin *bin = check_bin(128, 128);
    pkc_queue *queue = check_queue("S-R64A64");
    pkc_bin *bin_again = NULL;
    pkc_queue *queue_again = NULL;
    check_state saved;
    int32_t i;
    (void)state;
    CHECK_OK(pkc_bin_block(bin, 127, 0, 1, 128));
    for (i = 0; i < 1000; ++i) check_pack(bin, i, 1, 1, i % 120, i / 120);
    for (i = 0; i < 1000; ++i) check_push(queue, 5000 + i, 128, 1 + i % 128);
    saved = check_remember(bin, queue);
    CHECK_OK(pkc_snapshot_load(saved.bytes, saved.size, &bin_again, &queue_again));
    check_unchanged(&saved, bin_again, queue_again);
    pkc_bin_free(bin);
    pkc_queue_free(queue);
    pkc_bin_free(bin_again);
    pkc_queue_free(queue_again);
}

static void arguments_are_checked(void **state) {
    check_state saved = small_state();
    pkc_bin *bin = check_bin(3, 3);
    pkc_queue *queue = check_queue("S-R1A1");
    pkc_bin *no_bin = NULL;
    pkc_queue *no_queue = NULL;
    uint8_t bytes[512];
    size_t size = 77;
    (void)state;
    memset(bytes, 0x5a, sizeof bytes);
    CHECK_FAILS(PKC_E_ARGUMENT, "bin is NULL", pkc_snapshot_save(NULL, queue, bytes, 512, &size));
    CHECK_FAILS(PKC_E_ARGUMENT, "queue is NULL", pkc_snapshot_save(bin, NULL, bytes, 512, &size));
    CHECK_FAILS(PKC_E_ARGUMENT, "bytes is NULL", pkc_snapshot_save(bin, queue, NULL, 512, &size));
    CHECK_FAILS(PKC_E_ARGUMENT, "out_size is NULL",
                pkc_snapshot_save(bin, queue, bytes, 512, NULL));
    assert_int_equal(size, 77);
    CHECK_FAILS(PKC_E_CAPACITY, "capacity 10", pkc_snapshot_save(bin, queue, bytes, 10, &size));
    assert_true(size > 10 && size != 77);
    assert_int_equal(bytes[0], 0x5a);
    CHECK_FAILS(PKC_E_ARGUMENT, "bytes is NULL", pkc_snapshot_load(NULL, 5, &no_bin, &no_queue));
    CHECK_FAILS(PKC_E_ARGUMENT, "out_bin is NULL",
                pkc_snapshot_load(saved.bytes, saved.size, NULL, &no_queue));
    CHECK_FAILS(PKC_E_ARGUMENT, "out_queue is NULL",
                pkc_snapshot_load(saved.bytes, saved.size, &no_bin, NULL));
    assert_null(no_bin);
    assert_null(no_queue);
    pkc_bin_free(bin);
    pkc_queue_free(queue);
    free(saved.bytes);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_round_trip_gives_the_same_bytes_and_the_same_plan),
        cmocka_unit_test(truncation_at_every_byte_is_refused),
        cmocka_unit_test(a_flipped_bit_at_every_byte_is_refused),
        cmocka_unit_test(bytes_after_the_end_are_refused),
        cmocka_unit_test(random_values_with_a_right_checksum_never_crash),
        cmocka_unit_test(what_is_saved_can_be_loaded),
        cmocka_unit_test(a_large_state_survives),
        cmocka_unit_test(arguments_are_checked),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
