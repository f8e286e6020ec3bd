/* A program of the first release: it knows packcell-0.1.0.h alone and runs against today's library.
 *
 * usage: kept GOLDEN_HASH
 */
#include "packcell-0.1.0.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void require(int right, const char *what, int line) {
    if (right) return;
    fprintf(stderr, "kept.c:%d: %s (%s)\n", line, what, pkc_last_error());
    exit(1);
}
#define REQUIRE(right) require((right), #right, __LINE__)

/* What lies behind a struct of the size that the program knows is not the library's. */
#define CANARY 0x5aa5c33c5aa5c33cULL
#define FAR_TAIL 1024

/* Its `_init` fills the first size and that of a later release; a smaller one never was. */
#define INIT(type)                                                                \
    do {                                                                          \
        struct {                                                                  \
            type record;                                                          \
            unsigned long long canary;                                            \
        } old = {.canary = CANARY};                                               \
        struct {                                                                  \
            type record;                                                          \
            unsigned char tail[FAR_TAIL];                                         \
        } later;                                                                  \
        REQUIRE(type##_init(&old.record, sizeof old.record) == PKC_OK);           \
        REQUIRE(old.record.struct_size == sizeof old.record);                     \
        REQUIRE(old.canary == CANARY);                                            \
        REQUIRE(type##_init(&later.record, sizeof later) == PKC_OK);              \
        REQUIRE(later.record.struct_size == sizeof later);                        \
        REQUIRE(later.tail[FAR_TAIL - 1] == 0);                                   \
        REQUIRE(type##_init(&old.record, sizeof old.record - 1) == PKC_E_STRUCT); \
        REQUIRE(type##_init(&old.record, (size_t)1 << 20) == PKC_E_STRUCT);       \
    } while (0)

static void structs_of_the_old_and_of_a_later_size_are_filled(void) {
    INIT(pkc_bin_info);
    INIT(pkc_scenario);
    INIT(pkc_queue_info);
    INIT(pkc_grid);
    INIT(pkc_policy_info);
    INIT(pkc_trainer_options);
    INIT(pkc_trainer_info);
    INIT(pkc_planner_options);
    INIT(pkc_budget);
    INIT(pkc_plan_info);
    INIT(pkc_generator_options);
    /* Without the cell its functions are there and say so. */
    pkc_cell_info info;
    if (pkc_cell_info_init(&info, sizeof info) == PKC_E_UNSUPPORTED) return;
    INIT(pkc_cell_info);
    INIT(pkc_layout_options);
    INIT(pkc_layout_info);
    INIT(pkc_schedule_info);
    INIT(pkc_simulation_options);
    INIT(pkc_simulation_info);
}

static void an_unknown_tail_is_read_only_when_it_is_zero(pkc_bin *bin, pkc_queue *queue) {
    struct {
        pkc_budget budget;
        unsigned char tail[FAR_TAIL];
    } later;
    struct {
        pkc_plan_info info;
        unsigned long long canary;
    } old = {.canary = CANARY};
    pkc_planner *planner = NULL;
    REQUIRE(pkc_planner_create(NULL, NULL, &planner) == PKC_OK);
    REQUIRE(pkc_budget_init(&later.budget, sizeof later) == PKC_OK);
    REQUIRE(pkc_plan_info_init(&old.info, sizeof old.info) == PKC_OK);
    REQUIRE(pkc_planner_plan(planner, bin, queue, &later.budget, &old.info) == PKC_OK);
    REQUIRE(old.info.actions > 0 && old.info.struct_size == sizeof old.info);
    REQUIRE(old.canary == CANARY);
    later.tail[FAR_TAIL - 1] = 1;
    REQUIRE(pkc_planner_plan(planner, bin, queue, &later.budget, NULL) == PKC_E_STRUCT);
    pkc_planner_free(planner);
}

static void fill(pkc_queue *queue) {
    static const int32_t sides[][2] = {{2, 1}, {4, 3}, {2, 2}, {4, 4}, {2, 4}, {3, 4}, {3, 2},
                                       {3, 1}, {3, 5}, {2, 2}, {2, 2}, {2, 3}, {5, 5}, {2, 4}};
    for (int32_t i = 0; i < 14; ++i) {
        const pkc_item item = {i, sides[i][0], sides[i][1], 0};
        REQUIRE(pkc_queue_push(queue, &item) == PKC_OK);
    }
}

/* bindings/README.md, "The golden scenario". */
static uint64_t golden(pkc_bin *bin, pkc_queue *queue) {
    static pkc_action all[8 * PKC_MAX_ACTIONS];
    pkc_planner_options options;
    pkc_budget budget;
    pkc_plan_info info;
    pkc_policy *policy = NULL;
    pkc_planner *planner = NULL;
    size_t count = 0;
    uint64_t hash = 0;
    REQUIRE(pkc_planner_options_init(&options, sizeof options) == PKC_OK);
    options.method = PKC_METHOD_EXACT;
    options.rotation = 1;
    options.repack = PKC_REPACK_FULL;
    REQUIRE(pkc_budget_init(&budget, sizeof budget) == PKC_OK);
    budget.nodes = 20000;
    REQUIRE(pkc_plan_info_init(&info, sizeof info) == PKC_OK);
    REQUIRE(pkc_policy_create("contact", &policy) == PKC_OK);
    REQUIRE(pkc_planner_create(&options, policy, &planner) == PKC_OK);
    do {
        size_t added = 0;
        REQUIRE(count + PKC_MAX_ACTIONS <= sizeof all / sizeof *all);
        REQUIRE(pkc_planner_plan(planner, bin, queue, &budget, &info) == PKC_OK);
        REQUIRE(pkc_planner_result(planner, &info, all + count, PKC_MAX_ACTIONS, &added) == PKC_OK);
        REQUIRE(pkc_step_apply(bin, queue, all + count, added) == PKC_OK);
        count += added;
    } while (info.terminate == 0);
    REQUIRE(pkc_plan_hash(all, count, &hash) == PKC_OK);
    pkc_planner_free(planner);
    pkc_policy_free(policy);
    return hash;
}

int main(int argc, char **argv) {
    pkc_bin *bin = NULL;
    pkc_queue *queue = NULL;
    pkc_scenario scenario;
    char hash[17];
    REQUIRE(argc == 2);
    REQUIRE(pkc_version() / 10000 == PKC_VERSION_MAJOR);
    REQUIRE(pkc_version() >= PKC_VERSION_MAJOR * 10000 + PKC_VERSION_MINOR * 100);
    structs_of_the_old_and_of_a_later_size_are_filled();
    REQUIRE(pkc_scenario_init(&scenario, sizeof scenario) == PKC_OK);
    REQUIRE(pkc_scenario_parse("D-R5A3O1", &scenario) == PKC_OK);
    REQUIRE(pkc_queue_create(&scenario, &queue) == PKC_OK);
    REQUIRE(pkc_bin_create(10, 10, &bin) == PKC_OK);
    fill(queue);
    an_unknown_tail_is_read_only_when_it_is_zero(bin, queue);
    snprintf(hash, sizeof hash, "%016llx", (unsigned long long)golden(bin, queue));
    if (strcmp(hash, argv[1]) != 0) fprintf(stderr, "golden scenario: %s\n", hash);
    REQUIRE(strcmp(hash, argv[1]) == 0);
    pkc_queue_free(queue);
    pkc_bin_free(bin);
    return 0;
}
