#include "search/planner.h"

#include <algorithm>

#include "capi/handles.h"

using namespace packcell;

namespace {

static_assert(PKC_MAX_ACTIONS == kMaxActions, "the header promises it");

pkc_planner_options default_options() {
    const PlannerOptions o;
    return {sizeof(pkc_planner_options),
            static_cast<int32_t>(o.method),
            o.rotation ? 1 : 0,
            static_cast<int32_t>(o.repack),
            o.select,
            o.buffer_capacity,
            o.skip ? 1 : 0,
            o.max_side,
            o.max_items,
            o.max_known,
            o.memory};
}

PlannerOptions checked_options(const pkc_planner_options *options) {
    const pkc_planner_options o = read_struct("options", options, default_options());
    require_flag("rotation", o.rotation);
    require_flag("skip", o.skip);
    PlannerOptions checked;
    checked.method = static_cast<Method>(o.method);
    checked.rotation = o.rotation != 0;
    checked.repack = static_cast<Repack>(o.repack);
    checked.select = o.select;
    checked.buffer_capacity = o.buffer_capacity;
    checked.skip = o.skip != 0;
    checked.max_side = o.max_side;
    checked.max_items = o.max_items;
    checked.max_known = o.max_known;
    checked.memory = o.memory;
    check_options(checked);
    return checked;
}

pkc_plan_info empty_info() {
    pkc_plan_info info{};
    info.struct_size = sizeof(pkc_plan_info);
    return info;
}

pkc_plan_info to_c(const Plan &plan, int cells) {
    pkc_plan_info info = empty_info();
    info.actions = static_cast<int32_t>(plan.actions->size());
    info.packs = plan.packs;
    info.unpacks = plan.unpacks;
    info.repacked = plan.repacked ? 1 : 0;
    info.terminate = plan.terminate ? 1 : 0;
    info.proof = static_cast<int32_t>(plan.proof);
    info.cancelled = plan.cancelled ? 1 : 0;
    info.utilization = static_cast<double>(plan.occupied) / cells;
    info.score = plan.score;
    info.nodes = plan.nodes;
    info.tree_nodes = plan.tree_nodes;
    info.hash = plan_hash(plan.actions->data(), plan.actions->size());
    info.milliseconds = plan.milliseconds;
    info.repack_milliseconds = plan.repack_milliseconds;
    return info;
}

void begin(Planner &planner, const pkc_bin *bin, const pkc_queue *queue, const pkc_budget *budget) {
    const pkc_budget b = checked_budget(budget);
    const Use<const pkc_bin> use_bin("bin", bin);
    const Use<const pkc_queue> use_queue("queue", queue);
    planner.begin(use_bin->bin, use_queue->queue, b.nodes, b.milliseconds);
}

}  // namespace

extern "C" {

pkc_status pkc_planner_options_init(pkc_planner_options *options, size_t size) {
    return guard([&] { init_struct("options", options, size, default_options()); });
}

pkc_status pkc_planner_create(const pkc_planner_options *options, const pkc_policy *policy,
                              pkc_planner **out_planner) {
    return guard([&] {
        require(out_planner, "out_planner");
        const pkc_planner_options defaults = default_options();
        const PlannerOptions checked = checked_options(options != nullptr ? options : &defaults);
        auto chosen =
            policy != nullptr ? policy->policy : make_builtin_policy(builtin_policy_name(0));
        *out_planner = new pkc_planner(checked, std::move(chosen));
    });
}

void pkc_planner_free(pkc_planner *planner) { delete planner; }

pkc_status pkc_budget_init(pkc_budget *budget, size_t size) {
    return guard([&] { init_struct("budget", budget, size, default_budget()); });
}

pkc_status pkc_plan_info_init(pkc_plan_info *info, size_t size) {
    return guard([&] { init_struct("info", info, size, empty_info()); });
}

pkc_status pkc_planner_plan(pkc_planner *planner, const pkc_bin *bin, const pkc_queue *queue,
                            const pkc_budget *budget, pkc_plan_info *info) {
    return guard([&] {
        const Use<pkc_planner> use("planner", planner);
        if (info != nullptr) require_writable("info", info);
        begin(use->planner, bin, queue, budget);
        while (!use->planner.step(UINT64_MAX)) {
        }
        if (info != nullptr)
            write_struct("info", info, to_c(use->planner.plan(), use->planner.cells()));
    });
}

pkc_status pkc_planner_begin(pkc_planner *planner, const pkc_bin *bin, const pkc_queue *queue,
                             const pkc_budget *budget) {
    return guard([&] {
        const Use<pkc_planner> use("planner", planner);
        begin(use->planner, bin, queue, budget);
    });
}

pkc_status pkc_planner_step(pkc_planner *planner, uint64_t nodes, int32_t *out_done) {
    return guard([&] {
        require(out_done, "out_done");
        const Use<pkc_planner> use("planner", planner);
        if (nodes == 0) fail(Status::kArgument, "nodes 0: must be at least 1");
        if (!use->planner.begun()) fail(Status::kState, "no plan was begun");
        *out_done = use->planner.step(nodes) ? 1 : 0;
    });
}

pkc_status pkc_planner_result(pkc_planner *planner, pkc_plan_info *info, pkc_action *actions,
                              size_t capacity, size_t *out_count) {
    return guard([&] {
        const Use<pkc_planner> use("planner", planner);
        if (!use->planner.begun()) fail(Status::kState, "no plan was begun");
        if (info != nullptr) require_writable("info", info);
        const Plan &plan = use->planner.plan();
        const size_t count = plan.actions->size();
        require_capacity(count, capacity, out_count);
        require(actions, "actions");
        std::transform(plan.actions->begin(), plan.actions->end(), actions, [](const Action &a) {
            return pkc_action{a.op, a.item, a.x, a.y, a.rot, a.arm};
        });
        if (info != nullptr) write_struct("info", info, to_c(plan, use->planner.cells()));
        *out_count = count;
    });
}

pkc_status pkc_planner_cancel(pkc_planner *planner) {
    return guard([&] {
        require(planner, "planner");
        planner->planner.cancel();
    });
}

}  // extern "C"
