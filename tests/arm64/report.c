/* Prints what must be the same on every machine, or nearly so, a line a fact:
 *
 *     golden HASH                          the golden scenario of bindings/README.md
 *     plan POLICY SCENARIO REPACK HASH NODES CELLS
 *     net POLICY BIN WxH POSITION VALUE LOGIT... PROBABILITY...
 *     cell PRESET MODE SCHEDULE SIMULATION
 *
 * compare.py says which of them may differ, and by how much. $1 is the folder of weight blobs. */
#include <inttypes.h>
#include <packcell.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define CHECK(call)                                                               \
    do {                                                                          \
        const pkc_status check_status = (call);                                   \
        if (check_status != PKC_OK) {                                             \
            fprintf(stderr, "%s: %s: %s\n", #call, pkc_status_name(check_status), \
                    pkc_last_error());                                            \
            exit(1);                                                              \
        }                                                                         \
    } while (0)

#define SIDE 10
#define BINS 2
#define NODES 2000

static pkc_queue *make_queue(const char *scenario_name) {
    pkc_scenario scenario;
    CHECK(pkc_scenario_init(&scenario, sizeof scenario));
    CHECK(pkc_scenario_parse(scenario_name, &scenario));
    pkc_queue *queue = NULL;
    CHECK(pkc_queue_create(&scenario, &queue));
    return queue;
}

static pkc_planner *make_planner(const pkc_policy *policy, int32_t repack) {
    pkc_planner_options options;
    CHECK(pkc_planner_options_init(&options, sizeof options));
    options.method = PKC_METHOD_EXACT;
    options.rotation = 1;
    options.repack = repack;
    pkc_planner *planner = NULL;
    CHECK(pkc_planner_create(&options, policy, &planner));
    return planner;
}

static pkc_generator *make_generator(uint64_t seed) {
    pkc_generator_options options;
    CHECK(pkc_generator_options_init(&options, sizeof options));
    options.seed = seed;
    pkc_generator *generator = NULL;
    CHECK(pkc_generator_create(&options, &generator));
    return generator;
}

/* One step, carried out; its actions are left in `actions`. Returns whether it closed the bin. */
static int plan_step(pkc_planner *planner, pkc_bin *bin, pkc_queue *queue, uint64_t nodes,
                     pkc_action *actions, size_t *count, pkc_plan_info *info) {
    pkc_budget budget;
    CHECK(pkc_budget_init(&budget, sizeof budget));
    budget.nodes = nodes;
    CHECK(pkc_plan_info_init(info, sizeof *info));
    CHECK(pkc_planner_plan(planner, bin, queue, &budget, info));
    CHECK(pkc_planner_result(planner, info, actions, PKC_MAX_ACTIONS, count));
    CHECK(pkc_step_apply(bin, queue, actions, *count));
    return info->terminate != 0;
}

static void report_golden(void) {
    static const int32_t sides[][2] = {{2, 1}, {4, 3}, {2, 2}, {4, 4}, {2, 4}, {3, 4}, {3, 2},
                                       {3, 1}, {3, 5}, {2, 2}, {2, 2}, {2, 3}, {5, 5}, {2, 4}};
    static pkc_action all[2 * PKC_MAX_ACTIONS];
    pkc_policy *policy = NULL;
    CHECK(pkc_policy_create("contact", &policy));
    pkc_planner *planner = make_planner(policy, PKC_REPACK_FULL);
    pkc_queue *queue = make_queue("D-R5A3O1");
    pkc_bin *bin = NULL;
    CHECK(pkc_bin_create(SIDE, SIDE, &bin));
    for (int32_t i = 0; i < (int32_t)(sizeof sides / sizeof sides[0]); ++i) {
        const pkc_item item = {i, sides[i][0], sides[i][1], 0};
        CHECK(pkc_queue_push(queue, &item));
    }
    pkc_plan_info info;
    size_t total = 0;
    size_t count = 0;
    while (!plan_step(planner, bin, queue, 20000, all + total, &count, &info)) {
        total += count;
        if (total > PKC_MAX_ACTIONS) exit(1);
    }
    uint64_t hash = 0;
    CHECK(pkc_plan_hash(all, total + count, &hash));
    printf("golden %016" PRIx64 "\n", hash);
    pkc_bin_free(bin);
    pkc_queue_free(queue);
    pkc_planner_free(planner);
    pkc_policy_free(policy);
}

static void report_plans(const char *policy_name, const char *scenario, int32_t repack) {
    static const char *const repack_names[] = {"off", "anytime", "full"};
    static pkc_action actions[PKC_MAX_ACTIONS];
    pkc_policy *policy = NULL;
    CHECK(pkc_policy_create(policy_name, &policy));
    pkc_planner *planner = make_planner(policy, repack);
    pkc_queue *queue = make_queue(scenario);
    pkc_generator *generator = make_generator(7);
    pkc_bin *bin = NULL;
    CHECK(pkc_bin_create(SIDE, SIDE, &bin));
    uint64_t hash = 0;
    uint64_t nodes = 0;
    int32_t cells = 0;
    for (int closed = 0; closed < BINS;) {
        pkc_queue_info waiting;
        CHECK(pkc_queue_info_init(&waiting, sizeof waiting));
        CHECK(pkc_queue_get_info(queue, &waiting));
        for (; waiting.belt < 8; ++waiting.belt) {
            pkc_item item;
            size_t one = 0;
            CHECK(pkc_generator_next(generator, &item, 1, &one));
            CHECK(pkc_queue_push(queue, &item));
        }
        pkc_plan_info info;
        size_t count = 0;
        const int terminated = plan_step(planner, bin, queue, NODES, actions, &count, &info);
        hash = hash * 31 + info.hash;
        nodes += info.nodes;
        if (!terminated) continue;
        pkc_bin_info full;
        CHECK(pkc_bin_info_init(&full, sizeof full));
        CHECK(pkc_bin_get_info(bin, &full));
        cells += full.occupied_cells;
        CHECK(pkc_bin_clear(bin));
        ++closed;
    }
    printf("plan %s %s %s %016" PRIx64 " %" PRIu64 " %d\n", policy_name, scenario,
           repack_names[repack], hash, nodes, (int)cells);
    pkc_bin_free(bin);
    pkc_generator_free(generator);
    pkc_queue_free(queue);
    pkc_planner_free(planner);
    pkc_policy_free(policy);
}

/* What the network says of five sizes of items, in bins that it filled itself. */
static void report_network(const char *folder, const char *name) {
    static const int32_t sizes[][2] = {{1, 1}, {2, 5}, {5, 2}, {3, 3}, {5, 5}};
    static float logits[SIDE * SIDE + 1];
    static float probabilities[SIDE * SIDE + 1];
    char path[1024];
    snprintf(path, sizeof path, "%s/%s.pkw", folder, name);
    pkc_policy *policy = NULL;
    CHECK(pkc_policy_load_file(path, &policy));
    pkc_generator *generator = make_generator(3);
    pkc_bin *bin = NULL;
    CHECK(pkc_bin_create(SIDE, SIDE, &bin));
    for (int packed = 0; packed < 10; ++packed) {
        for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; ++i) {
            int32_t position = 0;
            float value = 0;
            size_t count = 0;
            CHECK(pkc_policy_select(policy, bin, sizes[i][0], sizes[i][1], &position));
            CHECK(pkc_policy_evaluate(policy, bin, sizes[i][0], sizes[i][1], logits, probabilities,
                                      SIDE * SIDE + 1, &count, &value));
            printf("net %s %d %dx%d %d %.9g", name, packed, (int)sizes[i][0], (int)sizes[i][1],
                   (int)position, (double)value);
            for (size_t k = 0; k < count; ++k) printf(" %.9g", (double)logits[k]);
            for (size_t k = 0; k < count; ++k) printf(" %.9g", (double)probabilities[k]);
            printf("\n");
        }
        pkc_item item;
        size_t one = 0;
        int32_t position = 0;
        CHECK(pkc_generator_next(generator, &item, 1, &one));
        CHECK(pkc_policy_select(policy, bin, item.w, item.h, &position));
        if (position == SIDE * SIDE) continue;
        CHECK(pkc_bin_pack(bin, &item, position % SIDE, position / SIDE, 0));
    }
    pkc_bin_free(bin);
    pkc_generator_free(generator);
    pkc_policy_free(policy);
}

static void report_cell(const char *preset, int32_t mode) {
    static pkc_action actions[PKC_MAX_ACTIONS];
    pkc_cell *cell = NULL;
    CHECK(pkc_cell_create(preset, &cell));
    pkc_cell_info about;
    CHECK(pkc_cell_info_init(&about, sizeof about));
    CHECK(pkc_cell_get_info(cell, &about));
    pkc_scenario scenario;
    CHECK(pkc_scenario_init(&scenario, sizeof scenario));
    CHECK(pkc_scenario_parse("D-R5A3O1", &scenario));
    pkc_schedule *schedule = NULL;
    CHECK(pkc_schedule_create(cell, &scenario, mode, &schedule));

    /* The items' sides follow the bin's, for presets have other bins. */
    pkc_generator_options stream;
    CHECK(pkc_generator_options_init(&stream, sizeof stream));
    stream.w = about.bin_w;
    stream.h = about.bin_h;
    pkc_generator *generator = NULL;
    CHECK(pkc_generator_create(&stream, &generator));
    pkc_policy *policy = NULL;
    CHECK(pkc_policy_create("contact", &policy));
    pkc_planner *planner = make_planner(policy, PKC_REPACK_FULL);
    pkc_queue *queue = make_queue("D-R5A3O1");
    pkc_bin *bin = NULL;
    CHECK(pkc_bin_create(about.bin_w, about.bin_h, &bin));
    pkc_item items[40];
    size_t count = 0;
    CHECK(pkc_generator_next(generator, items, 40, &count));
    for (size_t i = 0; i < count; ++i) CHECK(pkc_queue_push(queue, &items[i]));
    for (int done = 0; !done;) {
        pkc_bin *bin_before = NULL;
        pkc_queue *queue_before = NULL;
        CHECK(pkc_bin_clone(bin, &bin_before));
        CHECK(pkc_queue_clone(queue, &queue_before));
        pkc_plan_info info;
        done = plan_step(planner, bin, queue, NODES, actions, &count, &info);
        CHECK(pkc_schedule_add_step(schedule, bin_before, queue_before, actions, count));
        pkc_queue_free(queue_before);
        pkc_bin_free(bin_before);
    }

    pkc_schedule_info plan;
    CHECK(pkc_schedule_info_init(&plan, sizeof plan));
    CHECK(pkc_schedule_get_info(schedule, &plan));
    pkc_simulation *simulation = NULL;
    CHECK(pkc_simulate(schedule, NULL, &simulation));
    pkc_simulation_info run;
    CHECK(pkc_simulation_info_init(&run, sizeof run));
    CHECK(pkc_simulation_get_info(simulation, &run));
    printf("cell %s %d %016" PRIx64 " %016" PRIx64 "\n", preset, (int)mode, plan.hash, run.hash);
    pkc_simulation_free(simulation);
    pkc_bin_free(bin);
    pkc_queue_free(queue);
    pkc_planner_free(planner);
    pkc_policy_free(policy);
    pkc_generator_free(generator);
    pkc_schedule_free(schedule);
    pkc_cell_free(cell);
}

int main(int argc, char **argv) {
    static const char *const scenarios[] = {"S-R1A1",   "S-R5A1",   "S-R5A3",
                                            "D-R2A2O2", "D-R5A2O2", "D-R5A3O1"};
    if (argc != 2) return fputs("usage: arm64_report FOLDER_OF_WEIGHTS\n", stderr), 2;
    report_golden();
    for (size_t i = 0; pkc_policy_builtin(i) != NULL; ++i) {
        for (size_t s = 0; s < sizeof scenarios / sizeof scenarios[0]; ++s) {
            report_plans(pkc_policy_builtin(i), scenarios[s], PKC_REPACK_OFF);
            report_plans(pkc_policy_builtin(i), scenarios[s], PKC_REPACK_FULL);
        }
    }
    report_network(argv[1], "a3c");
    report_network(argv[1], "fcn");
    for (size_t i = 0; pkc_cell_preset(i) != NULL; ++i)
        for (int32_t mode = PKC_MODE_SYNC_PAPER; mode <= PKC_MODE_COORDINATED; ++mode)
            report_cell(pkc_cell_preset(i), mode);
    return 0;
}
