/* Version, status names, last error, the rules of struct_size and of frees: what holds for every
 * family of functions. */
#include <limits.h>
#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "check.h"

static void version_is_that_of_the_header(void **state) {
    (void)state;
    assert_int_equal(pkc_version(),
                     PKC_VERSION_MAJOR * 10000 + PKC_VERSION_MINOR * 100 + PKC_VERSION_PATCH);
}

/* The numbers are promises: a program compiled against an older header compares with them. */
static void status_numbers_and_names_are_pinned(void **state) {
    static const char *const names[] = {"PKC_OK",         "PKC_E_ARGUMENT",    "PKC_E_STRUCT",
                                        "PKC_E_MEMORY",   "PKC_E_BUSY",        "PKC_E_STATE",
                                        "PKC_E_CAPACITY", "PKC_E_LIMIT",       "PKC_E_FORMAT",
                                        "PKC_E_IO",       "PKC_E_UNSUPPORTED", "PKC_E_INTERNAL"};
    static const pkc_status codes[] = {PKC_OK,         PKC_E_ARGUMENT,    PKC_E_STRUCT,
                                       PKC_E_MEMORY,   PKC_E_BUSY,        PKC_E_STATE,
                                       PKC_E_CAPACITY, PKC_E_LIMIT,       PKC_E_FORMAT,
                                       PKC_E_IO,       PKC_E_UNSUPPORTED, PKC_E_INTERNAL};
    int32_t i;
    (void)state;
    for (i = 0; i < 12; ++i) {
        assert_int_equal(codes[i], -i);
        assert_string_equal(pkc_status_name(-i), names[i]);
    }
    assert_string_equal(pkc_status_name(1), "unknown status");
    assert_string_equal(pkc_status_name(-12), "unknown status");
    assert_string_equal(pkc_status_name(INT_MAX), "unknown status");
    assert_string_equal(pkc_status_name(INT_MIN), "unknown status");
}

static void record_layouts_are_frozen(void **state) {
    (void)state;
    assert_int_equal(sizeof(pkc_item), 16);
    assert_int_equal(sizeof(pkc_placement), 28);
    assert_int_equal(sizeof(pkc_queued), 24);
    assert_int_equal(sizeof(pkc_action), 24);
    assert_int_equal(offsetof(pkc_placement, x), 16);
    assert_int_equal(offsetof(pkc_queued, arms), 16);
    assert_int_equal(offsetof(pkc_action, arm), 20);
}

/* What a program built against this header passes as size for ever. */
static void first_layouts_keep_their_sizes(void **state) {
    (void)state;
    assert_true(sizeof(pkc_bin_info) >= 32);
    assert_int_equal(offsetof(pkc_bin_info, hash), 24);
    assert_true(sizeof(pkc_scenario) >= 20);
    assert_true(sizeof(pkc_queue_info) >= 24);
    assert_true(sizeof(pkc_grid) >= 48);
    assert_true(sizeof(pkc_planner_options) >= 48);
    assert_int_equal(offsetof(pkc_planner_options, memory), 40);
    assert_true(sizeof(pkc_budget) >= 24);
    assert_true(sizeof(pkc_plan_info) >= 88);
    assert_int_equal(offsetof(pkc_plan_info, repack_milliseconds), 80);
    assert_true(sizeof(pkc_generator_options) >= 40);
    assert_int_equal(offsetof(pkc_generator_options, seed), 32);
}

typedef pkc_status init_fn(void *, size_t);

#define INIT(type)                                         \
    static pkc_status init_##type(void *at, size_t size) { \
        return pkc_##type##_init((pkc_##type *)at, size);  \
    }
INIT(bin_info)
INIT(scenario)
INIT(queue_info)
INIT(grid)
INIT(planner_options)
INIT(budget)
INIT(plan_info)
INIT(generator_options)

static const struct {
    init_fn *init;
    size_t size;
    const char *name;
} inits[] = {
    {init_bin_info, sizeof(pkc_bin_info), "info"},
    {init_scenario, sizeof(pkc_scenario), "scenario"},
    {init_queue_info, sizeof(pkc_queue_info), "info"},
    {init_grid, sizeof(pkc_grid), "grid"},
    {init_planner_options, sizeof(pkc_planner_options), "options"},
    {init_budget, sizeof(pkc_budget), "budget"},
    {init_plan_info, sizeof(pkc_plan_info), "info"},
    {init_generator_options, sizeof(pkc_generator_options), "options"},
};
#define INITS (sizeof inits / sizeof inits[0])

static void init_writes_exactly_the_size_given(void **state) {
    size_t i;
    (void)state;
    for (i = 0; i < INITS; ++i) {
        union {
            uint64_t align;
            unsigned char bytes[8192];
        } b;
        size_t size;
        for (size = inits[i].size; size <= 4096;
             size = size < 4096 && size * 3 > 4096 ? 4096 : size * 3) {
            uint32_t said;
            size_t k;
            memset(b.bytes, 0xa5, sizeof b.bytes);
            CHECK_OK(inits[i].init(b.bytes, size));
            memcpy(&said, b.bytes, sizeof said);
            assert_int_equal(said, size);
            for (k = inits[i].size; k < size; ++k) assert_int_equal(b.bytes[k], 0);
            for (k = size; k < sizeof b.bytes; ++k) assert_int_equal(b.bytes[k], 0xa5);
            if (size == 4096) break;
        }
    }
}

static void init_refuses_null_and_unknown_sizes(void **state) {
    static const size_t wrong[] = {0, 1, 4, 8, 19, 4097, 65536, SIZE_MAX};
    size_t i;
    size_t k;
    (void)state;
    for (i = 0; i < INITS; ++i) {
        union {
            uint64_t align;
            unsigned char bytes[64];
        } b;
        CHECK_FAILS(PKC_E_ARGUMENT, inits[i].name, inits[i].init(NULL, inits[i].size));
        CHECK_FAILS(PKC_E_ARGUMENT, "NULL", inits[i].init(NULL, inits[i].size));
        memset(b.bytes, 0x5a, sizeof b.bytes);
        for (k = 0; k < sizeof wrong / sizeof wrong[0]; ++k) {
            size_t at;
            CHECK_FAILS(PKC_E_STRUCT, "struct_size", inits[i].init(b.bytes, wrong[k]));
            for (at = 0; at < sizeof b.bytes; ++at) assert_int_equal(b.bytes[at], 0x5a);
        }
        CHECK_FAILS(PKC_E_STRUCT, "struct_size", inits[i].init(b.bytes, inits[i].size - 1));
    }
}

/* A struct of a later version: zero beyond what this library knows is fine, a field set there asks
 * for what this library cannot do. */
typedef struct later_scenario {
    pkc_scenario known;
    int32_t later[3];
} later_scenario;

static void a_larger_struct_is_read_when_its_tail_is_zero(void **state) {
    later_scenario s;
    pkc_queue *queue = NULL;
    (void)state;
    memset(&s, 0, sizeof s);
    CHECK_OK(pkc_scenario_init(&s.known, sizeof s));
    assert_int_equal(s.known.struct_size, sizeof s);
    CHECK_OK(pkc_queue_create(&s.known, &queue));
    pkc_queue_free(queue);
    queue = NULL;
    s.later[2] = 1;
    CHECK_FAILS(PKC_E_STRUCT, "scenario", pkc_queue_create(&s.known, &queue));
    assert_null(queue);
}

static void a_larger_struct_is_written_within_what_is_known(void **state) {
    later_scenario s;
    (void)state;
    CHECK_OK(pkc_scenario_init(&s.known, sizeof s));
    s.later[0] = 77;
    CHECK_OK(pkc_scenario_parse("D-R5A3O1", &s.known));
    assert_int_equal(s.known.struct_size, sizeof s);
    assert_int_equal(s.known.overlap, 1);
    assert_int_equal(s.later[0], 77);
}

static void reading_refuses_wrong_struct_sizes(void **state) {
    static const uint32_t wrong[] = {0, 1, 19, 4097, 0xa5a5a5a5u, UINT32_MAX};
    size_t i;
    (void)state;
    for (i = 0; i < sizeof wrong / sizeof wrong[0]; ++i) {
        pkc_scenario s = {20, 1, 1, 1, 0};
        pkc_planner_options o = check_options();
        pkc_grid g;
        pkc_generator_options generate;
        pkc_queue *queue = NULL;
        pkc_planner *planner = NULL;
        pkc_generator *generator = NULL;
        int32_t w = 7;
        int32_t h = 7;
        s.struct_size = wrong[i];
        CHECK_FAILS(PKC_E_STRUCT, "scenario.struct_size", pkc_queue_create(&s, &queue));
        assert_null(queue);
        o.struct_size = wrong[i];
        CHECK_FAILS(PKC_E_STRUCT, "options.struct_size", pkc_planner_create(&o, NULL, &planner));
        assert_null(planner);
        CHECK_OK(pkc_grid_init(&g, sizeof g));
        g.struct_size = wrong[i];
        CHECK_FAILS(PKC_E_STRUCT, "grid.struct_size", pkc_grid_bin(&g, &w, &h));
        assert_int_equal(w, 7);
        CHECK_OK(pkc_generator_options_init(&generate, sizeof generate));
        generate.struct_size = wrong[i];
        CHECK_FAILS(PKC_E_STRUCT, "options.struct_size",
                    pkc_generator_create(&generate, &generator));
        assert_null(generator);
    }
}

static void writing_refuses_wrong_struct_sizes(void **state) {
    static const uint32_t wrong[] = {0, 1, 4, 4097, 0xa5a5a5a5u};
    pkc_bin *bin = check_bin(3, 3);
    pkc_queue *queue = check_queue("S-R1A1");
    size_t i;
    (void)state;
    for (i = 0; i < sizeof wrong / sizeof wrong[0]; ++i) {
        pkc_bin_info info;
        pkc_queue_info queue_info;
        pkc_scenario scenario;
        memset(&info, 0x5a, sizeof info);
        memset(&queue_info, 0x5a, sizeof queue_info);
        memset(&scenario, 0x5a, sizeof scenario);
        info.struct_size = queue_info.struct_size = scenario.struct_size = wrong[i];
        CHECK_FAILS(PKC_E_STRUCT, "info.struct_size", pkc_bin_get_info(bin, &info));
        assert_int_equal(info.w, 0x5a5a5a5a);
        CHECK_FAILS(PKC_E_STRUCT, "info.struct_size", pkc_queue_get_info(queue, &queue_info));
        assert_int_equal(queue_info.belt, 0x5a5a5a5a);
        CHECK_FAILS(PKC_E_STRUCT, "scenario.struct_size", pkc_queue_get_scenario(queue, &scenario));
        assert_int_equal(scenario.robots, 0x5a5a5a5a);
        CHECK_FAILS(PKC_E_STRUCT, "scenario.struct_size", pkc_scenario_parse("S-R1A1", &scenario));
        assert_int_equal(scenario.robots, 0x5a5a5a5a);
    }
    pkc_queue_free(queue);
    pkc_bin_free(bin);
}

static void *fail_in_thread(void *seen) {
    char *text = (char *)seen;
    strcpy(text, pkc_last_error());
    pkc_bin_create(-3, 1, NULL);
    return NULL;
}

static void last_error_is_per_thread(void **state) {
    char seen[64] = "?";
    pkc_bin *bin = NULL;
    pthread_t thread;
    (void)state;
    CHECK_FAILS(PKC_E_ARGUMENT, "129", pkc_bin_create(129, 1, &bin));
    assert_int_equal(pthread_create(&thread, NULL, fail_in_thread, seen), 0);
    pthread_join(thread, NULL);
    assert_string_equal(seen, ""); /* a fresh thread has had no failure */
    assert_non_null(strstr(pkc_last_error(), "129"));
}

static void last_error_survives_calls_that_succeed(void **state) {
    pkc_bin *bin = NULL;
    (void)state;
    CHECK_FAILS(PKC_E_ARGUMENT, "bin height 0", pkc_bin_create(1, 0, &bin));
    CHECK_OK(pkc_bin_create(1, 1, &bin));
    assert_non_null(strstr(pkc_last_error(), "bin height 0"));
    pkc_bin_free(bin);
}

static void null_may_be_freed(void **state) {
    (void)state;
    pkc_bin_free(NULL);
    pkc_queue_free(NULL);
    pkc_policy_free(NULL);
    pkc_planner_free(NULL);
    pkc_generator_free(NULL);
    assert_string_equal(pkc_policy_name(NULL), "");
}

/* A planner keeps its policy; clones and plans keep nothing of what they were made from. */
static void handles_may_be_freed_in_any_order(void **state) {
    int order;
    (void)state;
    for (order = 0; order < 4; ++order) {
        pkc_planner_options options = check_options();
        const pkc_budget budget = check_budget(50);
        pkc_policy *policy = NULL;
        pkc_planner *planner = NULL;
        pkc_bin *bin = check_bin(4, 4);
        pkc_bin *clone = NULL;
        pkc_queue *queue = check_queue("S-R1A1");
        pkc_action actions[8];
        size_t count = 0;
        check_push(queue, 1, 2, 2);
        CHECK_OK(pkc_policy_create("skyline", &policy));
        CHECK_OK(pkc_planner_create(&options, policy, &planner));
        if (order & 1) pkc_policy_free(policy);
        CHECK_OK(pkc_bin_clone(bin, &clone));
        CHECK_OK(pkc_planner_plan(planner, bin, queue, &budget, NULL));
        if (order & 2) {
            pkc_bin_free(bin);
            pkc_queue_free(queue);
        }
        CHECK_OK(pkc_planner_result(planner, NULL, actions, 8, &count));
        assert_int_equal(count, 1);
        if (!(order & 2)) CHECK_OK(pkc_planner_plan(planner, clone, queue, &budget, NULL));
        pkc_planner_free(planner);
        if (!(order & 1)) pkc_policy_free(policy);
        if (!(order & 2)) {
            pkc_queue_free(queue);
            pkc_bin_free(bin);
        }
        pkc_bin_free(clone);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(version_is_that_of_the_header),
        cmocka_unit_test(status_numbers_and_names_are_pinned),
        cmocka_unit_test(record_layouts_are_frozen),
        cmocka_unit_test(first_layouts_keep_their_sizes),
        cmocka_unit_test(init_writes_exactly_the_size_given),
        cmocka_unit_test(init_refuses_null_and_unknown_sizes),
        cmocka_unit_test(a_larger_struct_is_read_when_its_tail_is_zero),
        cmocka_unit_test(a_larger_struct_is_written_within_what_is_known),
        cmocka_unit_test(reading_refuses_wrong_struct_sizes),
        cmocka_unit_test(writing_refuses_wrong_struct_sizes),
        cmocka_unit_test(last_error_is_per_thread),
        cmocka_unit_test(last_error_survives_calls_that_succeed),
        cmocka_unit_test(null_may_be_freed),
        cmocka_unit_test(handles_may_be_freed_in_any_order),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
