#include "bench/one_item_planner.hpp"

namespace packcell_programs {

namespace {

constexpr uint64_t kLeastMemory = 65536;  // of a planner; one item has no states to remember

pkc_planner_options planner_options(const SmallGame &game) {
    auto options = initialised(pkc_planner_options_init);
    options.rotation = game.rotation ? 1 : 0;
    options.max_side = game.side;
    options.max_items = game.side * game.side;
    options.max_known = 1;
    options.memory = kLeastMemory;
    return options;
}

}  // namespace

OneItemPlanner::OneItemPlanner(const pkc_policy *policy, const SmallGame &game)
    : small_(game.side),
      bin_(make_bin(game.side, game.side)),
      queue_(make_queue(initialised(pkc_scenario_init))),
      planner_(make_planner(planner_options(game), policy)),
      actions_(PKC_MAX_ACTIONS) {}

void OneItemPlanner::clear() {
    check(pkc_bin_clear(bin_.get()));
    next_id_ = 0;
}

void OneItemPlanner::set(Cells taken) {
    clear();
    const int side = small_.side();
    for (int y = 0; y < side; ++y) {
        for (int x = 0; x < side; ++x) {
            int w = 0;
            while (x + w < side && (taken >> (x + w + y * side) & 1) != 0) ++w;
            if (w == 0) continue;
            const pkc_item item{next_id_++, w, 1, 0};
            check(pkc_bin_pack(bin_.get(), &item, x, y, 0));
            x += w;
        }
    }
}

std::optional<pkc_action> OneItemPlanner::plan(int w, int h) {
    const pkc_item item{next_id_++, w, h, 0};
    check(pkc_queue_push(queue_.get(), &item));
    check(pkc_planner_plan(planner_.get(), bin_.get(), queue_.get(), nullptr, nullptr));
    check(pkc_planner_result(planner_.get(), nullptr, actions_.data(), actions_.size(), &count_));
    if (count_ == 0 || actions_.front().op != PKC_OP_PACK) return std::nullopt;
    return actions_.front();
}

std::optional<Cells> OneItemPlanner::place(int w, int h) {
    const std::optional<pkc_action> action = plan(w, h);
    check(pkc_queue_remove(queue_.get(), --next_id_));
    if (!action) return std::nullopt;
    const bool turned = action->rot != 0;
    return small_.covered(turned ? h : w, turned ? w : h, action->x + action->y * small_.side());
}

bool OneItemPlanner::pack(int w, int h) {
    if (plan(w, h)) {
        check(pkc_step_apply(bin_.get(), queue_.get(), actions_.data(), count_));
        return true;
    }
    check(pkc_queue_remove(queue_.get(), --next_id_));
    return false;
}

}  // namespace packcell_programs
