#include "search/compose.h"

#include <algorithm>

namespace packcell {

StepComposer::StepComposer(int max_side, size_t max_items, bool balance)
    : after_(max_side, max_side, max_items + kMaxKnown),
      balance_(balance),
      moves_(max_side, max_items) {
    belt_.reserve(2 * kMaxKnown);
    actions_.reserve(kMaxActions);
}

void StepComposer::start(const Bin &bin, const View &view) {
    bin_ = &bin;
    view_ = &view;
    after_.assign(bin);
    belt_.clear();
    actions_.clear();
}

void StepComposer::add_outcome(const Outcome &outcome) {
    for (int t = 0; t < outcome.length; ++t) {
        const Tuple &tuple = outcome.sequence[static_cast<size_t>(t)];
        const Known &k = (*view_)[tuple.known];
        if (k.buffered()) {
            pack({k.item, tuple.x, tuple.y, tuple.rot}, k.holder);
        } else {
            belt_.push_back(tuple);
        }
    }
    pack_picks();
}

bool StepComposer::add_repacking(const Repacking &r, int buffer_capacity, bool rotation) {
    moves_.arrange(*bin_, *view_, r, buffer_capacity, rotation);
    for (const Primitive &p : moves_.primitives()) {
        if (p.op == kPack) {
            pack(p.placement, p.arm);
            continue;
        }
        const int32_t id = p.placement.item.id;
        after_.remove(static_cast<size_t>(after_.find(id)));
        actions_.push_back({kUnpack, id, 0, 0, 0, p.arm});
    }
    for (size_t i = 0; i < r.packed.size(); ++i) {
        const int known = r.known[i];
        if (known < 0 || (*view_)[known].buffered()) continue;
        const Placement &p = r.packed[i];
        belt_.push_back({known, p.rot, p.x, p.y, 0});
    }
    // What is nearest the belt's end first: the items behind it come within reach the sooner.
    std::sort(belt_.begin(), belt_.end(),
              [](const Tuple &a, const Tuple &b) { return a.known < b.known; });
    if (pack_picks() > 0 || after_.occupied() > bin_->occupied()) return true;
    start(*bin_, *view_);
    return false;
}

void StepComposer::add_greedy(const Policy &policy, bool rotation) {
    int best_reward = -1;
    Tuple best{};
    for (KnownSet set = view_->accessible(); set != 0; set &= set - 1) {
        const int known = row_lowest(set);
        const Item &item = (*view_)[known].item;
        for (int rot = 0; rot < (rotation && item.turns() ? 2 : 1); ++rot) {
            const Size size = item.turned(rot);
            const int position = policy.select(*bin_, size);
            if (position == bin_->cells()) continue;
            const int x = position % bin_->w();
            const int y = position / bin_->w();
            const int reward = bin_->contact({x, y, size.w, size.h});
            if (reward <= best_reward) continue;
            best_reward = reward;
            best = {known, rot, x, y, 1};
        }
    }
    if (best_reward < 0) return;
    const Known &k = (*view_)[best.known];
    const int arm = k.buffered() ? k.holder : (k.arms & 1) != 0 ? 0 : 1;
    pack({k.item, best.x, best.y, best.rot}, arm);
}

// In their order otherwise, and without the heap that std::stable_partition may use.
void StepComposer::take_exclusive_first() {
    auto end = belt_.begin();
    for (auto t = belt_.begin(); t != belt_.end(); ++t) {
        const int arms = (*view_)[t->known].arms;
        if (arms == 1 || arms == 2) std::rotate(end++, t, t + 1);
    }
}

int StepComposer::pack_picks() {
    if (balance_ && view_->whole_belt) take_exclusive_first();
    const Picks picks = choose_picks(*view_, belt_.data(), static_cast<int>(belt_.size()));
    for (int i = 0; i < picks.count; ++i) {
        const Tuple &t = belt_[static_cast<size_t>(picks.tuple[i])];
        pack({(*view_)[t.known].item, t.x, t.y, t.rot}, picks.arm[i]);
    }
    return picks.count;
}

void StepComposer::pack(const Placement &p, int arm) {
    actions_.push_back({kPack, p.item.id, p.x, p.y, p.rot, arm});
    after_.place(p);
}

void StepComposer::finish(Skip skip, bool rotation) {
    add_skips(skip, rotation);
    if (actions_.empty() || after_.full()) actions_.push_back({kTerminate, 0, 0, 0, 0, 0});
}

void StepComposer::add_skips(Skip skip, bool rotation) {
    if (skip == Skip::kNone || (skip == Skip::kFirst && !actions_.empty()) || after_.full()) return;
    for (const Known &k : view_->known) {
        if (k.buffered() || k.arms == 0 || after_.find(k.item.id) >= 0) continue;
        if (has_position(k.item, rotation)) continue;
        actions_.push_back({kSkip, k.item.id, 0, 0, 0, 0});
        if (skip == Skip::kFirst) return;
    }
}

bool StepComposer::has_position(const Item &item, bool rotation) const {
    Positions positions;
    for (int rot = 0; rot < (rotation && item.turns() ? 2 : 1); ++rot) {
        after_.feasible(item.turned(rot), positions);
        if (positions.any()) return true;
    }
    return false;
}

int StepComposer::count(Op op) const {
    return static_cast<int>(std::count_if(actions_.begin(), actions_.end(),
                                          [op](const Action &a) { return a.op == op; }));
}

}  // namespace packcell
