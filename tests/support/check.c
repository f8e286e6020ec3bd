#include "check.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

int check_is_raised(const int *flag) { return __atomic_load_n(flag, __ATOMIC_ACQUIRE); }

void check_raise(int *flag) { __atomic_store_n(flag, 1, __ATOMIC_RELEASE); }

void check_ok(pkc_status status, const char *call, const char *file, int line) {
    if (status == PKC_OK) return;
    print_error("%s:%d: %s: %s: %s\n", file, line, call, pkc_status_name(status), pkc_last_error());
    fail();
}

void check_fails(pkc_status wanted, const char *text, pkc_status status, const char *call,
                 const char *file, int line) {
    if (status != wanted) {
        print_error("%s:%d: %s: gives %s, should give %s\n", file, line, call,
                    pkc_status_name(status), pkc_status_name(wanted));
        fail();
    }
    if (text != NULL && strstr(pkc_last_error(), text) == NULL) {
        print_error("%s:%d: %s: the error '%s' should hold '%s'\n", file, line, call,
                    pkc_last_error(), text);
        fail();
    }
}

pkc_item check_item(int32_t id, int32_t w, int32_t h, uint32_t flags) {
    pkc_item item;
    item.id = id;
    item.w = w;
    item.h = h;
    item.flags = flags;
    return item;
}

pkc_bin *check_bin(int32_t w, int32_t h) {
    pkc_bin *bin = NULL;
    CHECK_OK(pkc_bin_create(w, h, &bin));
    return bin;
}

pkc_queue *check_queue(const char *name) {
    pkc_scenario scenario;
    pkc_queue *queue = NULL;
    CHECK_OK(pkc_scenario_init(&scenario, sizeof scenario));
    CHECK_OK(pkc_scenario_parse(name, &scenario));
    CHECK_OK(pkc_queue_create(&scenario, &queue));
    return queue;
}

void check_push(pkc_queue *queue, int32_t id, int32_t w, int32_t h) {
    const pkc_item item = check_item(id, w, h, 0);
    CHECK_OK(pkc_queue_push(queue, &item));
}

void check_pack(pkc_bin *bin, int32_t id, int32_t w, int32_t h, int32_t x, int32_t y) {
    const pkc_item item = check_item(id, w, h, 0);
    CHECK_OK(pkc_bin_pack(bin, &item, x, y, 0));
}

pkc_planner_options check_options(void) {
    pkc_planner_options options;
    CHECK_OK(pkc_planner_options_init(&options, sizeof options));
    return options;
}

pkc_budget check_budget(uint64_t nodes) {
    pkc_budget budget;
    CHECK_OK(pkc_budget_init(&budget, sizeof budget));
    budget.nodes = nodes;
    return budget;
}

pkc_plan_info check_plan_info(void) {
    pkc_plan_info info;
    CHECK_OK(pkc_plan_info_init(&info, sizeof info));
    return info;
}

uint8_t *check_snapshot(const pkc_bin *bin, const pkc_queue *queue, size_t *size) {
    uint8_t *bytes;
    size_t written = 0;
    CHECK_FAILS(PKC_E_CAPACITY, NULL, pkc_snapshot_save(bin, queue, NULL, 0, size));
    bytes = (uint8_t *)malloc(*size);
    assert_non_null(bytes);
    CHECK_OK(pkc_snapshot_save(bin, queue, bytes, *size, &written));
    assert_int_equal(written, *size);
    return bytes;
}

check_state check_remember(const pkc_bin *bin, const pkc_queue *queue) {
    check_state state;
    state.bytes = check_snapshot(bin, queue, &state.size);
    return state;
}

void check_unchanged(check_state *state, const pkc_bin *bin, const pkc_queue *queue) {
    size_t size = 0;
    uint8_t *bytes = check_snapshot(bin, queue, &size);
    assert_int_equal(size, state->size);
    assert_memory_equal(bytes, state->bytes, size);
    free(bytes);
    free(state->bytes);
    state->bytes = NULL;
}
