#include "gateway/core/cell_model.hpp"

#include <algorithm>
#include <cstring>
#include <stdexcept>

#include "common/options.hpp"

namespace packcell_programs {

namespace {

constexpr size_t kLongestBelt = 4096;
constexpr size_t kMostOrders = 1000;

Refusal refuse(Reject reject, uint32_t id, const char *why) {
    return {reject, "item " + std::to_string(id) + ": " + why};
}

Refusal bad(uint32_t id, const char *why) { return refuse(Reject::kBadPayload, id, why); }

Refusal wrong(uint32_t id, const char *why) { return refuse(Reject::kWrongState, id, why); }

Refusal wrong_job(const std::string &why) { return {Reject::kWrongState, why}; }

// The bin without one item, pinned or not.
BinHandle without(const pkc_bin *bin, int32_t internal) {
    auto info = initialised(pkc_bin_info_init);
    check(pkc_bin_get_info(bin, &info));
    BinHandle rest = make_bin(info.w, info.h);
    for (const pkc_placement &p : items_of(bin)) {
        if (p.item.id != internal) check(pkc_bin_pack(rest.get(), &p.item, p.x, p.y, p.rot));
    }
    return rest;
}

}  // namespace

std::vector<uint8_t> order_bytes(const JobOrder &order) {
    std::vector<uint8_t> bytes;
    for (int shift = 24; shift >= 0; shift -= 8)
        bytes.push_back(static_cast<uint8_t>(order.id >> shift));
    bytes.insert(bytes.end(), order.text.begin(), order.text.end());
    return bytes;
}

JobOrder order_from(const std::vector<uint8_t> &bytes) {
    if (bytes.size() < 4) throw std::runtime_error("not a job order");
    JobOrder order;
    for (size_t i = 0; i < 4; ++i) order.id = order.id << 8 | bytes[i];
    order.text.assign(bytes.begin() + 4, bytes.end());
    return order;
}

std::vector<uint8_t> boot_bytes(const BootText &text) {
    const std::string all = name_of(text.scenario) + ' ' + std::to_string(text.bin_w) + 'x' +
                            std::to_string(text.bin_h);
    return {all.begin(), all.end()};
}

BootText boot_from(const std::vector<uint8_t> &bytes) {
    const std::string all(bytes.begin(), bytes.end());
    const size_t space = all.find(' ');
    if (space == std::string::npos) throw std::runtime_error("not a start of the gateway");
    BootText text;
    check(pkc_scenario_parse(all.substr(0, space).c_str(), &text.scenario));
    read_bin_cells("bin", all.substr(space + 1), text.bin_w, text.bin_h);
    return text;
}

CellModel::CellModel() : bin_(make_bin(1, 1)), queue_(make_queue(initialised(pkc_scenario_init))) {}

// ---- Questions ---------------------------------------------------------------------------------

pkc_bin_info CellModel::bin_info() const {
    auto info = initialised(pkc_bin_info_init);
    check(pkc_bin_get_info(bin_.get(), &info));
    return info;
}

bool CellModel::is_full() const {
    const pkc_bin_info info = bin_info();
    return info.occupied_cells == info.w * info.h;
}

pkc_queue_info CellModel::queue_info() const {
    pkc_queue_info info = packcell_programs::queue_info(queue_.get());
    info.belt -= static_cast<int32_t>(leaving_.size());
    return info;
}

std::vector<pkc_queued> CellModel::belt() const {
    std::vector<pkc_queued> left;
    for (const pkc_queued &q : belt_) {
        if (std::find(leaving_.begin(), leaving_.end(), q.item.id) == leaving_.end())
            left.push_back(q);
    }
    return left;
}

int CellModel::robots() const {
    auto scenario = initialised(pkc_scenario_init);
    check(pkc_queue_get_scenario(queue_.get(), &scenario));
    return scenario.robots;
}

const pkc_placement *CellModel::find_packed(uint32_t id) const {
    const auto inner = inner_.find(id);
    for (const pkc_placement &p : packed_) {
        if (inner != inner_.end() && p.item.id == inner->second) return &p;
    }
    return nullptr;
}

const pkc_queued *CellModel::find_queued(uint32_t id) const {
    const auto inner = inner_.find(id);
    if (inner == inner_.end()) return nullptr;
    const int32_t internal = inner->second;
    if (std::find(leaving_.begin(), leaving_.end(), internal) != leaving_.end()) return nullptr;
    for (const auto *list : {&belt_, &buffer_}) {
        for (const pkc_queued &q : *list) {
            if (q.item.id == internal) return &q;
        }
    }
    return nullptr;
}

std::vector<StepAction> CellModel::translate(const std::vector<pkc_action> &actions) const {
    pkc_bin *bin = nullptr;
    pkc_queue *queue = nullptr;
    check(pkc_bin_clone(bin_.get(), &bin));
    const BinHandle bin_copy(bin);
    check(pkc_queue_clone(queue_.get(), &queue));
    const QueueHandle queue_copy(queue);
    if (pkc_step_apply(bin, queue, actions.data(), actions.size()) != PKC_OK) return {};
    std::vector<StepAction> step;
    for (const pkc_action &a : actions) {
        const uint32_t item = a.op == PKC_OP_TERMINATE ? 0 : outer_id(a.item);
        step.push_back({a.op, item, a.x, a.y, a.rot, a.arm, ActionState::kOpen});
    }
    return step;
}

// ---- Refusals ----------------------------------------------------------------------------------

Refusal CellModel::judge_place(uint32_t id, int32_t x, int32_t y, int32_t rot) const {
    if (find_packed(id) != nullptr) return wrong(id, "is in the bin already");
    const pkc_queued *queued = find_queued(id);
    if (queued == nullptr) return bad(id, "is neither on the belt nor in a buffer");
    const pkc_item &item = queued->item;
    if (rot == 1 && (item.flags & PKC_ITEM_NO_ROTATE) != 0) return bad(id, "must not be turned");
    const int32_t w = rot == 1 ? item.h : item.w;
    const int32_t h = rot == 1 ? item.w : item.h;
    const pkc_bin_info info = bin_info();
    if (x + w > info.w || y + h > info.h) return bad(id, "does not lie inside the bin");
    const auto free = all_of<std::vector<uint8_t>>([&](uint8_t *out, size_t n, size_t *count) {
        return pkc_bin_feasible(bin_.get(), w, h, out, n, count);
    });
    return free[static_cast<size_t>(x + y * info.w)] == 1
               ? Refusal()
               : wrong(id, "does not lie on free cells of the bin");
}

Refusal CellModel::judge_unpack(uint32_t id) const {
    const pkc_placement *packed = find_packed(id);
    if (packed == nullptr) return bad(id, "is not in the bin");
    return (packed->item.flags & PKC_ITEM_PINNED) != 0 ? bad(id, "is pinned") : Refusal();
}

Refusal CellModel::judge_resolve(const Command &c) const {
    if (unresolved_.count(c.id) == 0) return wrong(c.id, "is not unresolved");
    const StepAction *open = step_.first_open(c.id);
    if (open != nullptr && open->op == PKC_OP_PACK && c.in_bin)
        return judge_place(c.id, open->x, open->y, open->rot);
    return {};
}

Refusal CellModel::judge_resolved() const {
    if (unresolved_.empty()) return {};
    std::string list;
    for (const uint32_t id : unresolved_) list += (list.empty() ? "" : ", ") + std::to_string(id);
    return {Reject::kUnresolved, "unresolved items: " + list};
}

Refusal CellModel::judge(const Command &c, int arm) const {
    const bool known = inner_.count(c.id) > 0;
    switch (c.what()) {
        case Code::kItemArrived:
            if (known) return bad(c.id, "has arrived already");
            return belt_.size() < kLongestBelt ? Refusal() : wrong(c.id, "the belt is full");
        case Code::kPlanNext:
            return arm >= robots() ? wrong_job("arm B: the scenario has one arm")
                                   : judge_resolved();
        case Code::kPlaced:
            return judge_place(c.id, c.x, c.y, c.rot);
        case Code::kPlaceFailed:
            if (!known) return bad(c.id, "is not known");
            return step_.first_open(c.id) == nullptr ? wrong(c.id, "is not planned") : Refusal();
        case Code::kUnpacked:
            return judge_unpack(c.id);
        case Code::kBinChanged:
            return judge_resolved();
        case Code::kJobStart:
            return job_ == 0 ? Refusal()
                             : wrong_job("job " + std::to_string(job_) + ": has not ended");
        case Code::kJobEnd:
            return job_ != 0 ? Refusal() : wrong_job("no job has begun");
        case Code::kResolve:
            return judge_resolve(c);
        case Code::kItemGone:
            return known ? Refusal() : bad(c.id, "is not known");
    }
    return {};
}

Refusal CellModel::judge_order(uint16_t what, uint32_t id) const {
    const bool waits = std::any_of(orders_.begin(), orders_.end(),
                                   [id](const JobOrder &order) { return order.id == id; });
    const std::string name = "job order " + std::to_string(id);
    if (what == kOrderCancel)
        return waits ? Refusal() : Refusal{Reject::kBadPayload, name + ": does not wait"};
    if (id == 0) return {Reject::kBadPayload, name + ": must be 1 or more"};
    if (waits || id == job_) return {Reject::kBadPayload, name + ": is known already"};
    if (orders_.size() >= kMostOrders)
        return {Reject::kWrongState, name + ": " + std::to_string(kMostOrders) + " wait already"};
    return {};
}

// ---- Records -----------------------------------------------------------------------------------

void CellModel::apply(const Record &record) {
    switch (record.kind) {
        case RecordKind::kBoot:
            boot(boot_from(record.payload));
            break;
        case RecordKind::kCommand: {
            const Command command = command_from(record.code, record.payload);
            if (const Refusal refusal = judge(command, record.arm))
                throw std::runtime_error(refusal.why);
            apply_command(command, record.arm);
            break;
        }
        case RecordKind::kPlan:
            apply_plan(plan_from(record.code, record.payload), record.arm);
            break;
        case RecordKind::kJobOrder:
            apply_order(record.code, order_from(record.payload));
            break;
        default:
            throw std::runtime_error("a record of an unknown kind");
    }
}

void CellModel::apply_command(const Command &c, int arm) {
    switch (c.what()) {
        case Code::kItemArrived:
            arrive(c);
            break;
        case Code::kPlanNext:
            step_.give_up_arm(arm);
            break;
        case Code::kPlaced:
            place(c.id, c.x, c.y, c.rot, arm);
            break;
        case Code::kPlaceFailed:
            step_.give_up_item(c.id);
            unresolved_.erase(c.id);
            break;
        case Code::kUnpacked:
            unpack(c.id, arm);
            break;
        case Code::kBinChanged:
            change_bin(c.w, c.h);
            break;
        case Code::kJobStart:
            take_up(c.id);
            break;
        case Code::kJobEnd:
            job_ = 0;
            break;
        case Code::kResolve:
            resolve(c);
            break;
        case Code::kItemGone:
            remove(c.id);
            break;
    }
    settle();
}

void CellModel::apply_plan(const PlanEnd &end, int arm) {
    if (!end.has_plan()) return;
    if (!end.same_step) step_.begin(end.actions, end.micros);
    step_.fetch(arm);
}

void CellModel::apply_order(uint16_t what, const JobOrder &order) {
    if (what == kOrderStore) {
        orders_.push_back(order);
    } else {
        orders_.erase(std::remove_if(orders_.begin(), orders_.end(),
                                     [&](const JobOrder &o) { return o.id == order.id; }),
                      orders_.end());
    }
}

// What was in flight when the gateway ended may or may not have been done.
void CellModel::boot(const BootText &text) {
    if (!booted_) bin_ = make_bin(text.bin_w, text.bin_h);
    booted_ = true;
    change_scenario(text.scenario);
    for (const StepAction &a : step_.actions()) {
        if (a.moves_item() && a.state == ActionState::kOpen) unresolved_.insert(a.item);
    }
}

// Another reach: the same items, arranged anew. A buffer whose arm is gone goes to arm A.
void CellModel::change_scenario(const pkc_scenario &scenario) {
    auto old = initialised(pkc_scenario_init);
    check(pkc_queue_get_scenario(queue_.get(), &old));
    if (std::memcmp(&old, &scenario, sizeof old) == 0) return;
    QueueHandle queue = make_queue(scenario);
    for (const pkc_queued &q : belt_) check(pkc_queue_push(queue.get(), &q.item));
    for (const pkc_queued &q : buffer_) {
        const int32_t arm = q.arms == 2 && scenario.robots == 2 ? 1 : 0;
        check(pkc_queue_put_in_buffer(queue.get(), &q.item, arm));
    }
    queue_ = std::move(queue);
    refresh();
}

void CellModel::arrive(const Command &c) {
    const uint32_t flags = ((c.flags & kFlagNoRotate) != 0 ? PKC_ITEM_NO_ROTATE : 0u) |
                           ((c.flags & kFlagPinned) != 0 ? PKC_ITEM_PINNED : 0u);
    const pkc_item item{arrivals_, c.w, c.h, flags};
    check(pkc_queue_push(queue_.get(), &item));
    ++arrivals_;
    inner_[c.id] = item.id;
    outer_[item.id] = c.id;
    if (observer_ != nullptr) observer_->arrived(item);
    refresh();
}

void CellModel::place(uint32_t id, int32_t x, int32_t y, int32_t rot, int arm) {
    const pkc_item item = find_queued(id)->item;
    check(pkc_bin_pack(bin_.get(), &item, x, y, rot));
    take_off_queue(item.id);
    if (StepAction *action = step_.first_open(id, PKC_OP_PACK)) {
        arm = action->arm;
        *action = {PKC_OP_PACK, id, x, y, rot, arm, ActionState::kDone};
    }
    step_.give_up_item(id);
    unresolved_.erase(id);
    done_.push_back({PKC_OP_PACK, item.id, x, y, rot, arm});
    refresh();
}

void CellModel::unpack(uint32_t id, int arm) {
    const pkc_item item = find_packed(id)->item;
    if (StepAction *action = step_.first_open(id, PKC_OP_UNPACK)) {
        arm = action->arm;
        action->state = ActionState::kDone;
    }
    check(pkc_bin_unpack(bin_.get(), item.id, nullptr));
    // Placed in this step: to the queue it is on the belt still.
    const auto leaving = std::find(leaving_.begin(), leaving_.end(), item.id);
    if (leaving != leaving_.end()) {
        leaving_.erase(leaving);
        check(pkc_queue_remove(queue_.get(), item.id));
    }
    arm = std::min(arm, robots() - 1);
    check(pkc_queue_put_in_buffer(queue_.get(), &item, arm));
    unresolved_.erase(id);
    done_.push_back({PKC_OP_UNPACK, item.id, 0, 0, 0, arm});
    refresh();
}

void CellModel::resolve(const Command &c) {
    const StepAction *open = step_.first_open(c.id);
    if (open != nullptr && open->op == PKC_OP_PACK && c.in_bin) {
        place(c.id, open->x, open->y, open->rot, open->arm);
    } else if (open != nullptr && open->op == PKC_OP_UNPACK && !c.in_bin) {
        unpack(c.id, open->arm);
    }
    // What was to be done with it afterwards is planned anew.
    step_.give_up_item(c.id);
    unresolved_.erase(c.id);
}

void CellModel::remove(uint32_t id) {
    const int32_t internal = inner_.at(id);
    if (find_packed(id) != nullptr) {
        bin_ = without(bin_.get(), internal);
    } else {
        take_off_queue(internal);
    }
    step_.give_up_item(id);
    unresolved_.erase(id);
    forget(id);
    refresh();
}

void CellModel::change_bin(int32_t w, int32_t h) {
    const std::vector<StepAction> left = step_.actions();
    for (const StepAction &a : left) step_.give_up_item(a.item);
    settle();
    if (step_.ends_bin() && step_.actions().size() == 1) {
        // A step of its own, after which the belt is arranged as after any other.
        check(pkc_queue_remove_items(queue_.get(), nullptr, 0));
        if (observer_ != nullptr) observer_->step_done({}, step_.micros());
    }
    if (!packed_.empty()) {
        ++bins_closed_;
        if (observer_ != nullptr) observer_->bin_closed(bin_.get());
        for (const pkc_placement &p : packed_) forget(outer_id(p.item.id));
    }
    step_.clear();
    bin_ = make_bin(w, h);
    refresh();
}

void CellModel::take_up(uint32_t job) {
    job_ = job;
    apply_order(kOrderCancel, {job, {}});
}

// From a buffer at once; from the belt when the step ends, for only then does the belt move.
void CellModel::take_off_queue(int32_t internal) {
    for (const pkc_queued &q : buffer_) {
        if (q.item.id != internal) continue;
        check(pkc_queue_remove(queue_.get(), internal));
        return;
    }
    leaving_.push_back(internal);
}

void CellModel::settle() {
    if (step_.has_open() || (leaving_.empty() && done_.empty())) return;
    check(pkc_queue_remove_items(queue_.get(), leaving_.data(), leaving_.size()));
    leaving_.clear();
    refresh();
    if (!done_.empty() && observer_ != nullptr) observer_->step_done(done_, step_.micros());
    done_.clear();
}

void CellModel::refresh() {
    packed_ = items_of(bin_.get());
    belt_ = all_of<std::vector<pkc_queued>>([this](pkc_queued *out, size_t n, size_t *count) {
        return pkc_queue_belt(queue_.get(), out, n, count);
    });
    buffer_ = all_of<std::vector<pkc_queued>>([this](pkc_queued *out, size_t n, size_t *count) {
        return pkc_queue_buffer(queue_.get(), out, n, count);
    });
}

void CellModel::forget(uint32_t id) {
    const auto inner = inner_.find(id);
    outer_.erase(inner->second);
    inner_.erase(inner);
}

}  // namespace packcell_programs
