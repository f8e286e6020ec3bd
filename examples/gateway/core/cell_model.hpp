// The cell as the journal tells it: bin, belt and buffers, the step under way, what is unresolved
// and the jobs. Changed by records alone, so that a replay gives the same cell.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "common/handles.hpp"
#include "gateway/core/command.hpp"
#include "gateway/core/current_step.hpp"
#include "gateway/core/record.hpp"

namespace packcell_programs {

// An order of the MES that no JOB_START has taken up.
struct JobOrder {
    uint32_t id = 0;
    std::string text;  // JSON, as it came
};

// What a kJobOrder record does with its order; the payload is the id, 4 bytes high first, and the
// text.
constexpr uint16_t kOrderStore = 1;
constexpr uint16_t kOrderCancel = 2;
std::vector<uint8_t> order_bytes(const JobOrder &order);
JobOrder order_from(const std::vector<uint8_t> &bytes);  // throws std::runtime_error

// How the cell was configured when the gateway started: the payload of a kBoot record, as text
// "D-R5A3O1 10x10". The bin counts at the first start alone; later it is the journal's.
struct BootText {
    pkc_scenario scenario = initialised(pkc_scenario_init);
    int32_t bin_w = 0;
    int32_t bin_h = 0;
};
std::vector<uint8_t> boot_bytes(const BootText &text);
BootText boot_from(const std::vector<uint8_t> &bytes);  // throws std::runtime_error

// Told of what was done, for those who keep a log of it.
class CellObserver {
public:
    virtual ~CellObserver() = default;
    // `item.id` counts arrivals from 0.
    virtual void arrived(const pkc_item &item) = 0;
    // What the arms did in a step, in its order; items by the library's numbers.
    virtual void step_done(const std::vector<pkc_action> &actions, uint32_t plan_micros) = 0;
    // Before the bin is replaced.
    virtual void bin_closed(const pkc_bin *bin) = 0;
};

class CellModel {
public:
    // Empty until the first kBoot record, which says scenario and bin.
    CellModel();

    // Whether a command may be accepted now, as far as the cell is concerned.
    Refusal judge(const Command &command, int arm) const;
    Refusal judge_order(uint16_t what, uint32_t id) const;

    // Throws std::runtime_error for a record that does not follow from those before.
    void apply(const Record &record);

    const pkc_bin *bin() const { return bin_.get(); }
    pkc_bin_info bin_info() const;
    bool is_full() const;
    const std::vector<pkc_placement> &packed() const { return packed_; }

    // Belt and buffers as they are between two steps: planning needs a step without open actions.
    const pkc_queue *queue() const { return queue_.get(); }
    // What is left of them now: items placed in the step under way are off the belt.
    pkc_queue_info queue_info() const;
    std::vector<pkc_queued> belt() const;
    const std::vector<pkc_queued> &buffer() const { return buffer_; }

    const CurrentStep &step() const { return step_; }
    const std::set<uint32_t> &unresolved() const { return unresolved_; }
    uint32_t job() const { return job_; }  // 0: none
    const std::deque<JobOrder> &orders() const { return orders_; }
    uint32_t bins_closed() const { return bins_closed_; }

    // The PLC's number of an item that the library knows by `internal`.
    uint32_t outer_id(int32_t internal) const { return outer_.at(internal); }
    // A plan in the PLC's numbers; nothing if it is not legal any more.
    std::vector<StepAction> translate(const std::vector<pkc_action> &actions) const;

    // None (default), or one that outlives the model.
    void observe(CellObserver *observer) { observer_ = observer; }

private:
    int robots() const;
    const pkc_placement *find_packed(uint32_t id) const;
    const pkc_queued *find_queued(uint32_t id) const;
    Refusal judge_place(uint32_t id, int32_t x, int32_t y, int32_t rot) const;
    Refusal judge_unpack(uint32_t id) const;
    Refusal judge_resolve(const Command &c) const;
    Refusal judge_resolved() const;

    void apply_command(const Command &c, int arm);
    void apply_plan(const PlanEnd &end, int arm);
    void apply_order(uint16_t what, const JobOrder &order);
    void boot(const BootText &text);
    void change_scenario(const pkc_scenario &scenario);
    void arrive(const Command &c);
    void place(uint32_t id, int32_t x, int32_t y, int32_t rot, int arm);
    void unpack(uint32_t id, int arm);
    void resolve(const Command &c);
    void remove(uint32_t id);
    void change_bin(int32_t w, int32_t h);
    void take_up(uint32_t job);
    void take_off_queue(int32_t internal);
    void settle();
    void refresh();
    void forget(uint32_t id);

    BinHandle bin_;
    QueueHandle queue_;
    std::vector<pkc_placement> packed_;  // what bin_ and queue_ hold
    std::vector<pkc_queued> belt_;
    std::vector<pkc_queued> buffer_;
    std::map<uint32_t, int32_t> inner_;  // the PLC's number to the library's
    std::map<int32_t, uint32_t> outer_;
    int32_t arrivals_ = 0;
    bool booted_ = false;

    CurrentStep step_;
    std::vector<pkc_action> done_;  // in the step under way
    std::vector<int32_t> leaving_;  // off the belt when the step ends: it moves only then

    std::set<uint32_t> unresolved_;
    uint32_t job_ = 0;
    std::deque<JobOrder> orders_;
    uint32_t bins_closed_ = 0;
    CellObserver *observer_ = nullptr;
};

}  // namespace packcell_programs
