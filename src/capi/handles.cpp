#include "capi/handles.h"

namespace packcell {

namespace {

// A budget is a limit, not a schedule: a longer one is none.
constexpr double kLongestMilliseconds = 1e12;

}  // namespace

Item checked_item(const char *name, const pkc_item *item) {
    require(item, name);
    require_range("item id", item->id, 0, INT32_MAX);
    require_range("item w", item->w, 1, PKC_MAX_SIDE);
    require_range("item h", item->h, 1, PKC_MAX_SIDE);
    require_range("item flags", item->flags, 0, PKC_ITEM_NO_ROTATE | PKC_ITEM_PINNED);
    return {item->id, item->w, item->h, item->flags};
}

pkc_item to_c(const Item &item) { return {item.id, item.w, item.h, item.flags}; }

pkc_placement to_c(const Placement &p) { return {to_c(p.item), p.x, p.y, p.rot}; }

pkc_scenario to_c(const Scenario &s) {
    return {sizeof(pkc_scenario), s.robots, s.recognized, s.accessible, s.overlap};
}

Scenario checked_scenario(const pkc_scenario *scenario) {
    const pkc_scenario s = read_struct("scenario", scenario, to_c(Scenario()));
    const Scenario checked{s.robots, s.recognized, s.accessible, s.overlap};
    check_scenario(checked);
    return checked;
}

pkc_budget default_budget() { return {sizeof(pkc_budget), 0, 200000, 0.0}; }

pkc_budget checked_budget(const pkc_budget *budget) {
    if (budget == nullptr) return default_budget();
    const pkc_budget b = read_struct("budget", budget, default_budget());
    require_range("budget.reserved", b.reserved, 0, 0);
    require_finite("budget.milliseconds", b.milliseconds, 0.0, kLongestMilliseconds);
    return b;
}

}  // namespace packcell
