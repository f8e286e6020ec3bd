/* Policies through the C API: names, selection, learned ones from weight blobs and back, and that
 * they may be shared by threads. */
#define _POSIX_C_SOURCE 200809L
#include <limits.h>
#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "check.h"

static const char actor_critic[] = PACKCELL_GOLDEN "/actor-critic.pkw"; /* for 4 x 3 bins */
static const char any_bin[] = PACKCELL_GOLDEN "/fully-convolutional.pkw";
static const char no_policy[] = PACKCELL_GOLDEN "/weights.pkw"; /* a blob, but of no network */

static void the_builtin_names_are_those_of_the_header(void **state) {
    static const char *const names[] = {"default",        "contact",     "bottom-left",  "skyline",
                                        "shelf-next-fit", "maxrects-cp", "maxrects-bssf"};
    size_t i;
    (void)state;
    for (i = 0; i < 7; ++i) {
        pkc_policy *policy = NULL;
        assert_string_equal(pkc_policy_builtin(i), names[i]);
        CHECK_OK(pkc_policy_create(names[i], &policy));
        assert_string_equal(pkc_policy_name(policy), names[i]);
        pkc_policy_free(policy);
    }
    assert_null(pkc_policy_builtin(7));
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

/* ---- Learned policies ------------------------------------------------------------------------ */

static uint8_t *read_whole(const char *path, size_t *size) {
    uint8_t *bytes = (uint8_t *)malloc(100000);
    FILE *file = fopen(path, "rb");
    assert_non_null(bytes);
    assert_non_null(file);
    *size = fread(bytes, 1, 100000, file);
    fclose(file);
    assert_in_range(*size, 1, 99999);
    return bytes;
}

static pkc_policy *load(const char *path) {
    pkc_policy *policy = NULL;
    CHECK_OK(pkc_policy_load_file(path, &policy));
    return policy;
}

static pkc_policy_info info_of(const pkc_policy *policy) {
    pkc_policy_info info;
    CHECK_OK(pkc_policy_info_init(&info, sizeof info));
    CHECK_OK(pkc_policy_get_info(policy, &info));
    return info;
}

static void info_says_where_a_policy_comes_from(void **state) {
    pkc_policy *policy = load(actor_critic);
    pkc_policy_info info = info_of(policy);
    (void)state;
    assert_string_equal(pkc_policy_name(policy), "golden-4x3");
    assert_int_equal(info.architecture, PKC_ARCH_ACTOR_CRITIC);
    assert_int_equal(info.bin_w, 4);
    assert_int_equal(info.bin_h, 3);
    assert_int_equal(info.parameters, 18 + 2 + 36 + 2 + 12 + 3 + 12 + 28 + 4 + 52 + 13 + 4 + 1);
    assert_int_equal(info.seed, 7);
    assert_int_equal(info.steps, 0);
    assert_true(info.reward_fill == 0.5);
    assert_true(info.utilization == -1);
    assert_string_equal(info.learner, "by-hand");
    pkc_policy_free(policy);

    policy = load(any_bin);
    info = info_of(policy);
    assert_string_equal(pkc_policy_name(policy), "golden-any");
    assert_int_equal(info.architecture, PKC_ARCH_FULLY_CONVOLUTIONAL);
    assert_int_equal(info.bin_w, 0);
    assert_int_equal(info.bin_h, 0);
    pkc_policy_free(policy);

    CHECK_OK(pkc_policy_create("contact", &policy));
    memset(&info, 0x55, sizeof info);
    info.struct_size = sizeof info;
    CHECK_OK(pkc_policy_get_info(policy, &info));
    assert_int_equal(info.architecture, PKC_ARCH_HEURISTIC);
    assert_int_equal(info.bin_w, 0);
    assert_int_equal(info.parameters, 0);
    assert_true(info.utilization == -1);
    assert_string_equal(info.learner, "");
    CHECK_FAILS(PKC_E_ARGUMENT, "policy is NULL", pkc_policy_get_info(NULL, &info));
    CHECK_FAILS(PKC_E_ARGUMENT, "info is NULL", pkc_policy_get_info(policy, NULL));
    info.struct_size = 87;
    CHECK_FAILS(PKC_E_STRUCT, "info.struct_size 87", pkc_policy_get_info(policy, &info));
    CHECK_FAILS(PKC_E_STRUCT, "info.struct_size 0", pkc_policy_info_init(&info, 0));
    CHECK_FAILS(PKC_E_ARGUMENT, "info is NULL", pkc_policy_info_init(NULL, sizeof info));
    pkc_policy_free(policy);
}

static void what_is_loaded_is_saved_byte_by_byte(void **state) {
    static const char *const paths[] = {actor_critic, any_bin};
    size_t p;
    (void)state;
    for (p = 0; p < 2; ++p) {
        size_t size = 0;
        size_t needed = 0;
        size_t written = 77;
        uint8_t *const bytes = read_whole(paths[p], &size);
        uint8_t *const saved = (uint8_t *)calloc(size + 1, 1);
        pkc_policy *policy = NULL;
        pkc_policy *again = NULL;
        assert_non_null(saved);
        CHECK_OK(pkc_policy_load(bytes, size, &policy));
        CHECK_FAILS(PKC_E_CAPACITY, NULL, pkc_policy_save(policy, NULL, 0, &needed));
        assert_int_equal(needed, size);
        CHECK_FAILS(PKC_E_CAPACITY, NULL, pkc_policy_save(policy, saved, size - 1, &needed));
        assert_int_equal(saved[0], 0);
        CHECK_FAILS(PKC_E_ARGUMENT, "bytes is NULL", pkc_policy_save(policy, NULL, size, &written));
        CHECK_FAILS(PKC_E_ARGUMENT, "out_size is NULL", pkc_policy_save(policy, saved, size, NULL));
        CHECK_FAILS(PKC_E_ARGUMENT, "policy is NULL", pkc_policy_save(NULL, saved, size, &written));
        assert_int_equal(written, 77);
        CHECK_OK(pkc_policy_save(policy, saved, size + 1, &written));
        assert_int_equal(written, size);
        assert_memory_equal(saved, bytes, size);
        assert_int_equal(saved[size], 0);
        /* The policy keeps nothing of the bytes that it was loaded from. */
        memset(bytes, 0, size);
        CHECK_OK(pkc_policy_load(saved, size, &again));
        assert_string_equal(pkc_policy_name(policy), pkc_policy_name(again));
        pkc_policy_free(policy);
        pkc_policy_free(again);
        free(bytes);
        free(saved);
    }
}

static void files_are_written_whole_or_not_at_all(void **state) {
    char folder[] = "/tmp/packcell-policy-XXXXXX";
    char path[200];
    char deep[300];
    pkc_policy *policy = load(actor_critic);
    pkc_policy *heuristic = NULL;
    pkc_policy *again = NULL;
    uint8_t *bytes;
    uint8_t *saved;
    size_t size = 0;
    size_t saved_size = 0;
    FILE *file;
    (void)state;
    assert_non_null(mkdtemp(folder));
    snprintf(path, sizeof path, "%s/a.pkw", folder);
    snprintf(deep, sizeof deep, "%s/b.pkw", path);
    CHECK_FAILS(PKC_E_IO, path, pkc_policy_load_file(path, &again));
    file = fopen(path, "wb");
    assert_non_null(file);
    fputs("not a blob, and longer than one that is short", file);
    fclose(file);
    CHECK_FAILS(PKC_E_FORMAT, path, pkc_policy_load_file(path, &again));
    CHECK_FAILS(PKC_E_FORMAT, "byte 0: not a packcell", pkc_policy_load_file(path, &again));
    assert_null(again);

    CHECK_OK(pkc_policy_create("skyline", &heuristic));
    CHECK_FAILS(PKC_E_UNSUPPORTED, "'skyline' is a heuristic",
                pkc_policy_save_file(heuristic, path));
    CHECK_FAILS(PKC_E_UNSUPPORTED, "'skyline' is a heuristic",
                pkc_policy_save(heuristic, NULL, 0, &saved_size));
    CHECK_FAILS(PKC_E_FORMAT, NULL, pkc_policy_load_file(path, &again));

    CHECK_OK(pkc_policy_save_file(policy, path));
    bytes = read_whole(actor_critic, &size);
    saved = read_whole(path, &saved_size);
    assert_int_equal(saved_size, size);
    assert_memory_equal(saved, bytes, size);
    CHECK_OK(pkc_policy_load_file(path, &again));

    CHECK_FAILS(PKC_E_IO, deep, pkc_policy_save_file(policy, deep));
    CHECK_FAILS(PKC_E_IO, folder, pkc_policy_load_file(folder, &policy));
    CHECK_FAILS(PKC_E_IO, "cannot be", pkc_policy_load_file("", &policy));
    CHECK_FAILS(PKC_E_ARGUMENT, "path is NULL", pkc_policy_load_file(NULL, &policy));
    CHECK_FAILS(PKC_E_ARGUMENT, "out_policy is NULL", pkc_policy_load_file(path, NULL));
    CHECK_FAILS(PKC_E_ARGUMENT, "path is NULL", pkc_policy_save_file(policy, NULL));
    CHECK_FAILS(PKC_E_ARGUMENT, "policy is NULL", pkc_policy_save_file(NULL, path));
    pkc_policy_free(policy);
    pkc_policy_free(heuristic);
    pkc_policy_free(again);
    free(bytes);
    free(saved);
    assert_int_equal(unlink(path), 0);
    assert_int_equal(rmdir(folder), 0); /* nothing else was left there */
}

static void bytes_that_are_no_policy_are_refused(void **state) {
    pkc_policy *const sentinel = (pkc_policy *)&state;
    pkc_policy *policy = sentinel;
    size_t size = 0;
    size_t i;
    uint8_t *bytes = read_whole(actor_critic, &size);
    (void)state;
    for (i = 0; i < size; ++i) {
        CHECK_FAILS(PKC_E_FORMAT, "the data ends here", pkc_policy_load(bytes, i, &policy));
        bytes[i] ^= 0x10;
        CHECK_FAILS(PKC_E_FORMAT, "byte ", pkc_policy_load(bytes, size, &policy));
        bytes[i] ^= 0x10;
    }
    bytes[3] = 2;
    CHECK_FAILS(PKC_E_FORMAT, "version 2: must be 1", pkc_policy_load(bytes, size, &policy));
    bytes[3] = 1;
    CHECK_FAILS(PKC_E_ARGUMENT, "bytes is NULL", pkc_policy_load(NULL, size, &policy));
    CHECK_FAILS(PKC_E_ARGUMENT, "out_policy is NULL", pkc_policy_load(bytes, size, NULL));
    CHECK_FAILS(PKC_E_FORMAT, "tensor 'conv1", pkc_policy_load_file(no_policy, &policy));
    CHECK_FAILS(PKC_E_FORMAT, no_policy, pkc_policy_load_file(no_policy, &policy));
    assert_ptr_equal(policy, sentinel);
    free(bytes);
}

/* For every size: probabilities that are some, 0 where the item cannot lie, and largest where the
 * policy puts it. */
static void evaluation_and_selection_agree(void **state) {
    pkc_policy *policies[2];
    uint64_t seed = 9;
    int p;
    int round;
    (void)state;
    policies[0] = load(actor_critic);
    policies[1] = load(any_bin);
    for (p = 0; p < 2; ++p) {
        for (round = 0; round < 30; ++round) {
            const int32_t bin_w = p == 0 ? 4 : check_draw(&seed, 1, 9);
            const int32_t bin_h = p == 0 ? 3 : check_draw(&seed, 1, 9);
            pkc_bin *bin = check_bin(bin_w, bin_h);
            int32_t id;
            for (id = 0; id < 8; ++id) {
                const int32_t w = check_draw(&seed, 1, 4);
                const int32_t h = check_draw(&seed, 1, 4);
                const pkc_item item = check_item(id, w, h, 0);
                uint8_t mask[82];
                float logits[82];
                float probabilities[82];
                float value = -1;
                float sum = 0;
                size_t feasible = 0;
                size_t count = 0;
                size_t i;
                int32_t position = -1;
                CHECK_OK(pkc_bin_feasible(bin, w, h, mask, sizeof mask, &feasible));
                CHECK_OK(pkc_policy_evaluate(policies[p], bin, w, h, logits, probabilities, 82,
                                             &count, &value));
                assert_int_equal(count, feasible);
                CHECK_OK(pkc_policy_select(policies[p], bin, w, h, &position));
                assert_in_range(position, 0, count - 1);
                for (i = 0; i < count; ++i) {
                    sum += probabilities[i];
                    if (mask[i] == 0) {
                        assert_true(probabilities[i] == 0 && logits[i] <= -1e8f);
                    }
                    assert_true(probabilities[i] <= probabilities[position]);
                }
                assert_true(sum > 0.999f && sum < 1.001f);
                assert_true(value > -1e6f && value < 1e6f);
                if ((size_t)position + 1 == count) continue;
                CHECK_OK(pkc_bin_pack(bin, &item, position % bin_w, position / bin_w, 0));
            }
            pkc_bin_free(bin);
        }
        pkc_policy_free(policies[p]);
    }
}

static void evaluate_keeps_the_rules_of_arrays(void **state) {
    pkc_policy *policy = load(actor_critic);
    pkc_policy *heuristic = NULL;
    pkc_bin *bin = check_bin(4, 3);
    float one[13];
    float two[13];
    float value = 77;
    size_t count = 0;
    (void)state;
    one[0] = two[0] = 77;
    CHECK_FAILS(PKC_E_CAPACITY, "13 elements",
                pkc_policy_evaluate(policy, bin, 1, 1, NULL, NULL, 0, &count, &value));
    assert_int_equal(count, 13);
    CHECK_FAILS(PKC_E_CAPACITY, "capacity 12",
                pkc_policy_evaluate(policy, bin, 1, 1, one, two, 12, &count, &value));
    CHECK_FAILS(PKC_E_ARGUMENT, "policy is NULL",
                pkc_policy_evaluate(NULL, bin, 1, 1, one, two, 13, &count, &value));
    CHECK_FAILS(PKC_E_ARGUMENT, "bin is NULL",
                pkc_policy_evaluate(policy, NULL, 1, 1, one, two, 13, &count, &value));
    CHECK_FAILS(PKC_E_ARGUMENT, "out_count is NULL",
                pkc_policy_evaluate(policy, bin, 1, 1, one, two, 13, NULL, &value));
    CHECK_FAILS(PKC_E_ARGUMENT, "w 0: must be 1..128",
                pkc_policy_evaluate(policy, bin, 0, 1, one, two, 13, &count, &value));
    CHECK_FAILS(PKC_E_ARGUMENT, "h 129: must be 1..128",
                pkc_policy_evaluate(policy, bin, 1, 129, one, two, 13, &count, &value));
    CHECK_OK(pkc_policy_create("contact", &heuristic));
    CHECK_FAILS(PKC_E_UNSUPPORTED, "policy 'contact'",
                pkc_policy_evaluate(heuristic, bin, 1, 1, one, two, 13, &count, &value));
    assert_true(one[0] == 77 && two[0] == 77 && value == 77);
    /* Each result alone. */
    CHECK_OK(pkc_policy_evaluate(policy, bin, 2, 1, one, NULL, 13, &count, NULL));
    assert_true(one[0] != 77 && two[0] == 77);
    CHECK_OK(pkc_policy_evaluate(policy, bin, 2, 1, NULL, two, 13, &count, NULL));
    assert_true(two[0] >= 0 && two[0] <= 1);
    CHECK_OK(pkc_policy_evaluate(policy, bin, 2, 1, NULL, NULL, 13, &count, &value));
    assert_true(value != 77);
    assert_int_equal(count, 13);
    pkc_policy_free(policy);
    pkc_policy_free(heuristic);
    pkc_bin_free(bin);
}

static void a_policy_for_one_bin_size_refuses_others_everywhere(void **state) {
    static const int32_t sides[][2] = {{3, 4}, {4, 4}, {3, 3}, {1, 1}, {10, 10}};
    static const char text[] = ": policy 'golden-4x3' was trained for 4x3 bins";
    pkc_policy *policy = load(actor_critic);
    pkc_planner_options options = check_options();
    pkc_planner *planner = NULL;
    pkc_queue *queue = check_queue("S-R1A1");
    pkc_plan_info info = check_plan_info();
    pkc_bin *bin;
    size_t i;
    (void)state;
    options.max_side = 16;
    options.memory = 65536;
    CHECK_OK(pkc_planner_create(&options, policy, &planner));
    check_push(queue, 1, 2, 1);
    for (i = 0; i < sizeof sides / sizeof sides[0]; ++i) {
        int32_t position = 77;
        float numbers[200];
        float value = 77;
        size_t count = 77;
        bin = check_bin(sides[i][0], sides[i][1]);
        CHECK_FAILS(PKC_E_ARGUMENT, text, pkc_policy_select(policy, bin, 1, 1, &position));
        CHECK_FAILS(PKC_E_ARGUMENT, text,
                    pkc_policy_evaluate(policy, bin, 1, 1, numbers, NULL, 200, &count, &value));
        CHECK_FAILS(PKC_E_ARGUMENT, text, pkc_planner_begin(planner, bin, queue, NULL));
        CHECK_FAILS(PKC_E_ARGUMENT, text, pkc_planner_plan(planner, bin, queue, NULL, &info));
        CHECK_FAILS(PKC_E_STATE, NULL, pkc_planner_result(planner, &info, NULL, 0, &count));
        assert_true(position == 77 && value == 77 && count == 77);
        pkc_bin_free(bin);
    }
    bin = check_bin(4, 3);
    CHECK_OK(pkc_planner_plan(planner, bin, queue, NULL, &info));
    assert_int_equal(info.packs, 1);
    pkc_planner_free(planner);
    pkc_policy_free(policy);
    pkc_queue_free(queue);
    pkc_bin_free(bin);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_builtin_names_are_those_of_the_header),
        cmocka_unit_test(unknown_names_are_refused_and_quoted),
        cmocka_unit_test(select_gives_a_feasible_position_or_none),
        cmocka_unit_test(contact_takes_the_largest_reward_and_the_first_of_equals),
        cmocka_unit_test(select_checks_its_arguments),
        cmocka_unit_test(a_policy_may_be_shared_by_threads),
        cmocka_unit_test(info_says_where_a_policy_comes_from),
        cmocka_unit_test(what_is_loaded_is_saved_byte_by_byte),
        cmocka_unit_test(files_are_written_whole_or_not_at_all),
        cmocka_unit_test(bytes_that_are_no_policy_are_refused),
        cmocka_unit_test(evaluation_and_selection_agree),
        cmocka_unit_test(evaluate_keeps_the_rules_of_arrays),
        cmocka_unit_test(a_policy_for_one_bin_size_refuses_others_everywhere),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
