#include <packcell.h>
#include <stdio.h>

int main(void) {
    const pkc_item items[] = {{0, 5, 4, 0}, {1, 6, 5, 0}, {2, 3, 5, 0},
                              {3, 4, 4, 0}, {4, 2, 7, 0}, {5, 1, 5, 0}};
    pkc_scenario scenario;
    pkc_queue *queue = NULL;
    pkc_bin *bin = NULL;
    pkc_planner *planner = NULL;
    pkc_action a[PKC_MAX_ACTIONS];
    size_t n = 0;

    pkc_scenario_init(&scenario, sizeof scenario); /* one arm that sees and reaches one item */
    if (pkc_queue_create(&scenario, &queue) || pkc_bin_create(10, 10, &bin) ||
        pkc_planner_create(NULL, NULL, &planner))
        return puts(pkc_last_error()), 1;
    for (int i = 0; i < 6; ++i) pkc_queue_push(queue, &items[i]);
    do { /* plan a step, carry it out, show it */
        if (pkc_planner_plan(planner, bin, queue, NULL, NULL) ||
            pkc_planner_result(planner, NULL, a, PKC_MAX_ACTIONS, &n) ||
            pkc_step_apply(bin, queue, a, n))
            return puts(pkc_last_error()), 1;
        for (size_t i = 0; i < n && a[i].op == PKC_OP_PACK; ++i)
            printf("pack %d at (%d, %d), turned %d\n", a[i].item, a[i].x, a[i].y, a[i].rot);
    } while (a[n - 1].op != PKC_OP_TERMINATE);
    pkc_planner_free(planner);
    pkc_bin_free(bin);
    pkc_queue_free(queue);
    return 0;
}
