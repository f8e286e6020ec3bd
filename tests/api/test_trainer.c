/* Training through the C API: options, runs, checkpoints, what comes out, and what is refused. */
#define _GNU_SOURCE
#include <math.h>
#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "packcell.h"

#include "check.h"
#include "count_malloc.h"

static pkc_trainer_options small_options(void) {
    pkc_trainer_options o;
    assert_int_equal(pkc_trainer_options_init(&o, sizeof o), PKC_OK);
    o.bin_w = 6;
    o.bin_h = 6;
    o.most_side = 3;
    o.workers = 2;
    o.environments = 4;
    o.steps = 5;
    o.channels = 4;
    o.features = 8;
    o.hidden = 8;
    return o;
}

static pkc_trainer *make_trainer(const pkc_trainer_options *options) {
    pkc_trainer *trainer = NULL;
    assert_int_equal(pkc_trainer_create(options, &trainer), PKC_OK);
    assert_non_null(trainer);
    return trainer;
}

static pkc_trainer_info info_of(const pkc_trainer *trainer) {
    pkc_trainer_info info;
    assert_int_equal(pkc_trainer_info_init(&info, sizeof info), PKC_OK);
    assert_int_equal(pkc_trainer_get_info(trainer, &info), PKC_OK);
    return info;
}

static size_t blob_of(const pkc_trainer *trainer, uint8_t *bytes, size_t capacity) {
    pkc_policy *policy = NULL;
    size_t size = 0;
    assert_int_equal(pkc_trainer_policy(trainer, &policy), PKC_OK);
    assert_int_equal(pkc_policy_save(policy, bytes, capacity, &size), PKC_OK);
    pkc_policy_free(policy);
    return size;
}

static void the_defaults_are_a_training_on_ten_by_ten(void **state) {
    pkc_trainer_options o;
    pkc_trainer *trainer;
    (void)state;
    assert_int_equal(pkc_trainer_options_init(&o, sizeof o), PKC_OK);
    assert_int_equal(o.struct_size, sizeof o);
    assert_int_equal(o.learner, PKC_LEARNER_A3C);
    assert_int_equal(o.architecture, PKC_ARCH_ACTOR_CRITIC);
    assert_true(o.bin_w == 10 && o.bin_h == 10 && o.least_side == 1 && o.most_side == 5);
    assert_true(o.items == 0 && o.rotation == PKC_ROTATION_MIXED && o.workers == 3);
    assert_true(o.seed == 1 && o.reward_fill == 0);
    assert_string_equal(o.name, "a3c");
    trainer = make_trainer(NULL);
    memset(&o.bin_w, 0x55, sizeof o - offsetof(pkc_trainer_options, bin_w));
    assert_int_equal(pkc_trainer_get_options(trainer, &o), PKC_OK);
    assert_true(o.bin_w == 10 && o.hidden == 128 && o.gamma > 0.89 && o.gamma < 0.91);
    pkc_trainer_free(trainer);
    pkc_trainer_free(NULL);
}

static void options_out_of_range_are_refused_by_name(void **state) {
    pkc_trainer *trainer = NULL;
    pkc_trainer_options o;
    (void)state;
#define REFUSED(field, value, status, text)                     \
    o = small_options();                                        \
    o.field = value;                                            \
    assert_int_equal(pkc_trainer_create(&o, &trainer), status); \
    assert_null(trainer);                                       \
    assert_non_null(strstr(pkc_last_error(), text))
    REFUSED(learner, 0, PKC_E_ARGUMENT, "learner 0");
    REFUSED(learner, 3, PKC_E_ARGUMENT, "learner 3");
    REFUSED(architecture, 0, PKC_E_ARGUMENT, "architecture 0");
    REFUSED(architecture, 4, PKC_E_ARGUMENT, "architecture 4");
    REFUSED(bin_w, 0, PKC_E_ARGUMENT, "bin w 0");
    REFUSED(bin_h, 129, PKC_E_ARGUMENT, "bin h 129");
    REFUSED(least_side, 4, PKC_E_ARGUMENT, "side");
    REFUSED(most_side, 7, PKC_E_ARGUMENT, "most side 7");
    REFUSED(items, -1, PKC_E_ARGUMENT, "items -1");
    REFUSED(rotation, 3, PKC_E_ARGUMENT, "rotation 3");
    REFUSED(workers, 0, PKC_E_ARGUMENT, "workers 0");
    REFUSED(environments, 1025, PKC_E_ARGUMENT, "environments 1025");
    REFUSED(steps, 0, PKC_E_ARGUMENT, "steps 0");
    REFUSED(channels, 65, PKC_E_ARGUMENT, "channels 65");
    REFUSED(features, 0, PKC_E_ARGUMENT, "features 0");
    REFUSED(hidden, 2000, PKC_E_ARGUMENT, "hidden units 2000");
    REFUSED(reserved, 1, PKC_E_ARGUMENT, "reserved 1");
    REFUSED(gamma, NAN, PKC_E_ARGUMENT, "gamma");
    REFUSED(gamma, 1.01, PKC_E_ARGUMENT, "gamma 1.01");
    REFUSED(learning_rate, 0, PKC_E_ARGUMENT, "learning_rate 0");
    REFUSED(entropy, -1, PKC_E_ARGUMENT, "entropy -1");
    REFUSED(value_weight, 11, PKC_E_ARGUMENT, "value_weight 11");
    REFUSED(clip, 0, PKC_E_ARGUMENT, "clip 0");
    REFUSED(reward_fill, INFINITY, PKC_E_ARGUMENT, "reward_fill inf");
    REFUSED(name[0], 0, PKC_E_ARGUMENT, "name");
    REFUSED(name[0], 'A', PKC_E_ARGUMENT, "name");
    REFUSED(struct_size, 8, PKC_E_STRUCT, "8");
    assert_int_equal(pkc_trainer_create(NULL, NULL), PKC_E_ARGUMENT);
}

static void a_run_counts_updates_steps_and_bins(void **state) {
    const pkc_trainer_options o = small_options();
    pkc_trainer *trainer = make_trainer(&o);
    pkc_trainer_info info = info_of(trainer);
    (void)state;
    assert_true(info.updates == 0 && info.steps == 0 && info.bins == 0);
    assert_int_equal(pkc_trainer_run(trainer, 0), PKC_OK);
    assert_int_equal(pkc_trainer_run(trainer, 21), PKC_OK);
    info = info_of(trainer);
    assert_int_equal(info.updates, 21);
    assert_int_equal(info.steps, 21 * 4 * 5);
    assert_true(info.bins > 20 && info.bins < info.steps);
    assert_true(info.utilization > 0.3 && info.utilization < 1);
    assert_true(info.entropy > 0 && info.entropy < 4);
    assert_true(info.reward > 0 && info.value_loss > 0);
    assert_int_equal(pkc_trainer_run(trainer, UINT64_MAX), PKC_E_ARGUMENT);
    assert_int_equal(pkc_trainer_run(NULL, 1), PKC_E_ARGUMENT);
    pkc_trainer_free(trainer);
}

static void the_policy_tells_where_it_comes_from_and_stays_as_it_is(void **state) {
    pkc_trainer_options o = small_options();
    pkc_trainer *trainer;
    pkc_policy *policy = NULL;
    pkc_policy_info info;
    pkc_bin *bin = NULL;
    float before[37];
    float after[37];
    size_t count = 0;
    double mean = 0;
    double half = 0;
    double again = 0;
    (void)state;
    strcpy(o.name, "mine");
    o.seed = 77;
    o.reward_fill = 0.5;
    trainer = make_trainer(&o);
    assert_int_equal(pkc_trainer_run(trainer, 10), PKC_OK);
    assert_int_equal(pkc_trainer_measure(trainer, PKC_ROTATION_OFF, 3, 200, &mean, &half), PKC_OK);
    assert_true(mean > 0.3 && mean < 1 && half > 0 && half < 0.1);
    assert_int_equal(pkc_trainer_measure(trainer, 9, 3, 200, &mean, &half), PKC_E_ARGUMENT);
    assert_int_equal(pkc_trainer_measure(trainer, 0, 3, 0, &mean, &half), PKC_E_ARGUMENT);
    assert_int_equal(pkc_trainer_policy(trainer, &policy), PKC_OK);
    assert_string_equal(pkc_policy_name(policy), "mine");
    assert_int_equal(pkc_policy_info_init(&info, sizeof info), PKC_OK);
    assert_int_equal(pkc_policy_get_info(policy, &info), PKC_OK);
    assert_string_equal(info.learner, "a3c");
    assert_true(info.seed == 77 && info.steps == 200 && info.bin_w == 6 && info.bin_h == 6);
    assert_true(info.reward_fill == 0.5 && fabs(info.utilization - mean) < 1e-6);

    o.rotation = PKC_ROTATION_OFF;
    assert_int_equal(pkc_policy_measure(policy, &o, 3, 200, &again, NULL), PKC_OK);
    assert_true(again == mean);
    o.bin_w = 7;
    assert_int_equal(pkc_policy_measure(policy, &o, 3, 200, &again, NULL), PKC_E_ARGUMENT);

    assert_int_equal(pkc_bin_create(6, 6, &bin), PKC_OK);
    assert_int_equal(pkc_policy_evaluate(policy, bin, 2, 3, before, NULL, 37, &count, NULL),
                     PKC_OK);
    assert_int_equal(count, 37);
    assert_int_equal(pkc_trainer_run(trainer, 10), PKC_OK);
    pkc_trainer_free(trainer);
    assert_int_equal(pkc_policy_evaluate(policy, bin, 2, 3, after, NULL, 37, &count, NULL), PKC_OK);
    assert_memory_equal(before, after, sizeof before);
    pkc_bin_free(bin);
    pkc_policy_free(policy);
}

static void a_checkpoint_goes_on_bit_for_bit(void **state) {
    static uint8_t whole[65536];
    static uint8_t halves[65536];
    const pkc_trainer_options o = small_options();
    pkc_trainer *trainer = make_trainer(&o);
    pkc_trainer *loaded = NULL;
    pkc_trainer_options found;
    char path[64];
    size_t size;
    FILE *file;
    (void)state;
    snprintf(path, sizeof path, "/tmp/pkc_trainer_%ld.pkt", (long)getpid());
    assert_int_equal(pkc_trainer_run(trainer, 13), PKC_OK);
    assert_int_equal(pkc_trainer_save_file(trainer, path), PKC_OK);
    assert_int_equal(pkc_trainer_run(trainer, 20), PKC_OK);
    size = blob_of(trainer, whole, sizeof whole);

    assert_int_equal(pkc_trainer_load_file(path, &loaded), PKC_OK);
    assert_int_equal(pkc_trainer_options_init(&found, sizeof found), PKC_OK);
    assert_int_equal(pkc_trainer_get_options(loaded, &found), PKC_OK);
    assert_memory_equal(&found, &o, sizeof o);
    assert_int_equal(info_of(loaded).updates, 13);
    assert_int_equal(pkc_trainer_run(loaded, 20), PKC_OK);
    assert_int_equal(blob_of(loaded, halves, sizeof halves), size);
    assert_memory_equal(whole, halves, size);
    pkc_trainer_free(loaded);
    pkc_trainer_free(trainer);

    file = fopen(path, "r+b");
    assert_non_null(file);
    assert_int_equal(fseek(file, 500, SEEK_SET), 0);
    fputc(0x5a, file);
    fputc(0xa5, file);
    assert_int_equal(fclose(file), 0);
    loaded = NULL;
    assert_int_equal(pkc_trainer_load_file(path, &loaded), PKC_E_FORMAT);
    assert_null(loaded);
    assert_non_null(strstr(pkc_last_error(), path));
    assert_int_equal(unlink(path), 0);
    assert_int_equal(pkc_trainer_load_file(path, &loaded), PKC_E_IO);
}

static size_t read_all(const char *path, uint8_t *bytes, size_t capacity) {
    FILE *file = fopen(path, "rb");
    size_t size;
    assert_non_null(file);
    size = fread(bytes, 1, capacity, file);
    assert_int_equal(fclose(file), 0);
    assert_true(size < capacity);
    return size;
}

static void write_all(const char *path, const uint8_t *bytes, size_t size) {
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, size, file), size);
    assert_int_equal(fclose(file), 0);
}

/* Loading fails where byte `at` is 2, under the right checksum. */
static void assert_fails_sealed(const char *path, const uint8_t *bytes, size_t size, size_t at,
                                const char *why) {
    uint8_t *changed = (uint8_t *)malloc(size);
    pkc_trainer *loaded = NULL;
    uint64_t hash = 0xcbf29ce484222325u;
    size_t i;
    assert_non_null(changed);
    memcpy(changed, bytes, size);
    changed[at] = 2;
    for (i = 0; i < size - 8; ++i) hash = (hash ^ changed[i]) * 0x100000001b3u;
    for (i = 0; i < 8; ++i) changed[size - 8 + i] = (uint8_t)(hash >> (8 * i));
    write_all(path, changed, size);
    assert_int_equal(pkc_trainer_load_file(path, &loaded), PKC_E_FORMAT);
    assert_null(loaded);
    assert_non_null(strstr(pkc_last_error(), why));
    free(changed);
}

static void tables_are_learned_saved_and_learned_on_bit_for_bit(void **state) {
    static uint8_t whole[1 << 20];
    static uint8_t halves[1 << 20];
    static uint8_t checkpoint[1 << 21];
    static const char *const ends[] = {"PKT", "ends here", "checksum", "checksum", "checksum"};
    pkc_trainer_options o = small_options();
    pkc_trainer_options found;
    pkc_trainer *trainer;
    pkc_trainer *loaded = NULL;
    pkc_policy *policy = NULL;
    pkc_policy_info info;
    char path[64];
    size_t cuts[5];
    size_t size;
    size_t i;
    double off = 0;
    double on = 0;
    (void)state;
    o.learner = PKC_LEARNER_AFTERSTATE;
    strcpy(o.name, "tables");
    trainer = make_trainer(&o);
    snprintf(path, sizeof path, "/tmp/pkc_tables_%ld.pkt", (long)getpid());
    assert_int_equal(pkc_trainer_run(trainer, 4001), PKC_OK);
    assert_int_equal(pkc_trainer_save_file(trainer, path), PKC_OK);
    assert_int_equal(pkc_trainer_run(trainer, 3000), PKC_OK);
    assert_int_equal(info_of(trainer).updates, 7001);
    assert_int_equal(info_of(trainer).steps, 7001);
    assert_true(info_of(trainer).bins > 300 && info_of(trainer).utilization > 0.6);
    size = blob_of(trainer, whole, sizeof whole);

    assert_int_equal(pkc_trainer_load_file(path, &loaded), PKC_OK);
    assert_int_equal(pkc_trainer_options_init(&found, sizeof found), PKC_OK);
    assert_int_equal(pkc_trainer_get_options(loaded, &found), PKC_OK);
    assert_memory_equal(&found, &o, sizeof o);
    assert_int_equal(info_of(loaded).updates, 4001);
    assert_int_equal(pkc_trainer_run(loaded, 1), PKC_OK);
    assert_int_equal(pkc_trainer_run(loaded, 2999), PKC_OK);
    assert_int_equal(blob_of(loaded, halves, sizeof halves), size);
    assert_memory_equal(whole, halves, size);

    assert_int_equal(pkc_trainer_measure(loaded, PKC_ROTATION_ON, 3, 500, &on, NULL), PKC_OK);
    assert_int_equal(pkc_trainer_measure(loaded, PKC_ROTATION_OFF, 3, 500, &off, NULL), PKC_OK);
    assert_true(off > 0.75 && on > off);
    assert_int_equal(pkc_trainer_policy(loaded, &policy), PKC_OK);
    assert_int_equal(pkc_policy_info_init(&info, sizeof info), PKC_OK);
    assert_int_equal(pkc_policy_get_info(policy, &info), PKC_OK);
    assert_string_equal(pkc_policy_name(policy), "tables");
    assert_string_equal(info.learner, "td-afterstate");
    assert_int_equal(info.architecture, PKC_ARCH_AFTERSTATE);
    assert_true(info.bin_w == 6 && info.bin_h == 6 && info.steps == 7001 && info.seed == 1);
    assert_true(fabs(info.utilization - off) < 1e-6);
    pkc_policy_free(policy);
    pkc_trainer_free(loaded);
    pkc_trainer_free(trainer);

    size = read_all(path, checkpoint, sizeof checkpoint);
    cuts[0] = 0;
    cuts[1] = 8;
    cuts[2] = 100;
    cuts[3] = size / 2;
    cuts[4] = size - 1;
    for (i = 0; i < 5; ++i) {
        loaded = NULL;
        write_all(path, checkpoint, cuts[i]);
        assert_int_equal(pkc_trainer_load_file(path, &loaded), PKC_E_FORMAT);
        assert_null(loaded);
        assert_non_null(strstr(pkc_last_error(), path));
        assert_non_null(strstr(pkc_last_error(), ends[i]));
    }
    /* What would be written in another way. */
    assert_fails_sealed(path, checkpoint, size, 43,
                        "byte 43: something follows the end of the name");
    assert_fails_sealed(path, checkpoint, size, 65, "byte 65: mixed 2: must be 0 or 1");
    assert_int_equal(unlink(path), 0);

    /* A number that it has no use for would be saved too, and could not be loaded. */
    trainer = NULL;
    o.clip = NAN;
    assert_int_equal(pkc_trainer_create(&o, &trainer), PKC_E_ARGUMENT);
    assert_string_equal(pkc_last_error(), "clip nan: must be finite");
    assert_null(trainer);
    o.clip = 1;
    o.bin_w = 13;
    assert_int_equal(pkc_trainer_create(&o, &trainer), PKC_E_ARGUMENT);
    assert_string_equal(pkc_last_error(),
                        "bin 13x6: an afterstate policy needs sides 2..12, (w + 1) h <= 128");
    assert_null(trainer);
}

struct canceller {
    pkc_trainer *trainer;
    int ended;
};

static void *cancel_all_the_time(void *argument) {
    struct canceller *c = argument;
    while (!check_is_raised(&c->ended)) {
        pkc_trainer_cancel(c->trainer);
        usleep(1000);
    }
    return NULL;
}

static void another_thread_cancels_and_finds_the_handle_busy(void **state) {
    const pkc_trainer_options o = small_options();
    struct canceller c = {NULL, 0};
    pthread_t thread;
    (void)state;
    c.trainer = make_trainer(&o);
    assert_int_equal(pthread_create(&thread, NULL, cancel_all_the_time, &c), 0);
    assert_int_equal(pkc_trainer_run(c.trainer, UINT64_C(1) << 40), PKC_OK);
    check_raise(&c.ended);
    assert_int_equal(pthread_join(thread, NULL), 0);
    assert_true(info_of(c.trainer).updates < UINT64_C(1) << 40);
    assert_int_equal(pkc_trainer_cancel(NULL), PKC_E_ARGUMENT);
    pkc_trainer_free(c.trainer);
}

static void a_batch_gives_what_single_calls_give(void **state) {
    const pkc_trainer_options o = small_options();
    pkc_trainer *trainer = make_trainer(&o);
    pkc_policy *policies[2] = {NULL, NULL};
    pkc_bin *bins[3] = {NULL, NULL, NULL};
    const pkc_bin *pairs[6];
    const int32_t sizes[12] = {1, 2, 3, 3, 2, 1, 6, 6, 7, 1, 2, 2};
    int32_t positions[6];
    float probabilities[6 * 37];
    float values[6];
    size_t i;
    (void)state;
    assert_int_equal(pkc_trainer_policy(trainer, &policies[0]), PKC_OK);
    assert_int_equal(pkc_policy_create("contact", &policies[1]), PKC_OK);
    for (i = 0; i < 3; ++i) assert_int_equal(pkc_bin_create(i < 2 ? 6 : 7, 6, &bins[i]), PKC_OK);
    assert_int_equal(pkc_bin_block(bins[1], 1, 2, 3, 1), PKC_OK);
    for (i = 0; i < 6; ++i) pairs[i] = bins[i / 3];
    assert_int_equal(
        pkc_policy_evaluate_batch(policies[0], pairs, sizes, 6, positions, probabilities, values),
        PKC_OK);
    for (i = 0; i < 6; ++i) {
        float alone[37];
        float value = 0;
        int32_t position = 0;
        size_t count = 0;
        assert_int_equal(
            pkc_policy_select(policies[0], pairs[i], sizes[2 * i], sizes[2 * i + 1], &position),
            PKC_OK);
        assert_int_equal(pkc_policy_evaluate(policies[0], pairs[i], sizes[2 * i], sizes[2 * i + 1],
                                             NULL, alone, 37, &count, &value),
                         PKC_OK);
        assert_int_equal(positions[i], position);
        assert_memory_equal(probabilities + 37 * i, alone, sizeof alone);
        assert_true(values[i] == value);
    }
    assert_int_equal(pkc_policy_evaluate_batch(policies[1], pairs, sizes, 6, positions, NULL, NULL),
                     PKC_OK);
    assert_int_equal(positions[4], 36);
    assert_int_equal(
        pkc_policy_evaluate_batch(policies[1], pairs, sizes, 6, positions, NULL, values),
        PKC_E_UNSUPPORTED);
    pairs[5] = bins[2];
    positions[0] = -7;
    assert_int_equal(pkc_policy_evaluate_batch(policies[0], pairs, sizes, 6, positions, NULL, NULL),
                     PKC_E_ARGUMENT);
    assert_int_equal(positions[0], -7);
    assert_int_equal(pkc_policy_evaluate_batch(policies[0], pairs, sizes, 0, positions, NULL, NULL),
                     PKC_E_ARGUMENT);
    for (i = 0; i < 3; ++i) pkc_bin_free(bins[i]);
    for (i = 0; i < 2; ++i) pkc_policy_free(policies[i]);
    pkc_trainer_free(trainer);
}

static void planning_with_a_network_touches_no_heap(void **state) {
    const pkc_trainer_options o = small_options();
    pkc_trainer *trainer = make_trainer(&o);
    pkc_policy *policy = NULL;
    pkc_planner *planner = NULL;
    pkc_bin *bin = NULL;
    pkc_queue *queue = NULL;
    pkc_scenario scenario;
    pkc_plan_info info;
    int32_t id;
    (void)state;
    assert_int_equal(pkc_trainer_policy(trainer, &policy), PKC_OK);
    assert_int_equal(pkc_planner_create(NULL, policy, &planner), PKC_OK);
    assert_int_equal(pkc_bin_create(6, 6, &bin), PKC_OK);
    assert_int_equal(
        pkc_scenario_parse("S-R5A3", (pkc_scenario_init(&scenario, sizeof scenario), &scenario)),
        PKC_OK);
    assert_int_equal(pkc_queue_create(&scenario, &queue), PKC_OK);
    for (id = 0; id < 6; ++id) {
        const pkc_item item = {id, 1 + id % 3, 1 + id % 2, 0};
        assert_int_equal(pkc_queue_push(queue, &item), PKC_OK);
    }
    assert_int_equal(pkc_plan_info_init(&info, sizeof info), PKC_OK);
    {
        const uint64_t before = count_malloc_calls;
        assert_int_equal(pkc_planner_plan(planner, bin, queue, NULL, &info), PKC_OK);
        assert_int_equal(count_malloc_calls, before);
    }
    assert_true(info.packs > 0);
    pkc_queue_free(queue);
    pkc_bin_free(bin);
    pkc_planner_free(planner);
    pkc_policy_free(policy);
    pkc_trainer_free(trainer);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_defaults_are_a_training_on_ten_by_ten),
        cmocka_unit_test(options_out_of_range_are_refused_by_name),
        cmocka_unit_test(a_run_counts_updates_steps_and_bins),
        cmocka_unit_test(the_policy_tells_where_it_comes_from_and_stays_as_it_is),
        cmocka_unit_test(a_checkpoint_goes_on_bit_for_bit),
        cmocka_unit_test(tables_are_learned_saved_and_learned_on_bit_for_bit),
        cmocka_unit_test(another_thread_cancels_and_finds_the_handle_busy),
        cmocka_unit_test(a_batch_gives_what_single_calls_give),
        cmocka_unit_test(planning_with_a_network_touches_no_heap),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
