// The gateway's protocol core: registers in, registers out. It has no sockets, no threads, no disk
// and no clock of its own; requests, time and the answers of planner and journal are given to it,
// one at a time.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "gateway/core/cell_model.hpp"
#include "gateway/core/channel.hpp"
#include "gateway/core/packml.hpp"
#include "gateway/core/plan.hpp"
#include "gateway/core/record.hpp"
#include "gateway/core/register_image.hpp"
#include "gateway/core/registers.hpp"

namespace packcell_programs {

constexpr int64_t kMicrosPerMs = 1000;

// The moment of a call: `micros` of a clock that never goes back, for deadlines, and the wall's for
// the journal.
struct Moment {
    int64_t micros = 0;
    int64_t wall_ms = 0;
};

struct ControllerSettings {
    pkc_scenario scenario = initialised(pkc_scenario_init);
    int32_t bin_w = 10;  // until the first BIN_CHANGED; of a new journal alone
    int32_t bin_h = 10;
    WordOrder word_order = WordOrder::kHighFirst;
    int64_t heartbeat_ms = 1000;  // a PLC silent for longer is lost
    int64_t reserve_ms = 12;      // of a deadline, for the journal and the wire
};

// Something to be logged and told; `kind` is one word.
struct Event {
    std::string kind;  // "state", "reject", "plan", "alarm", ...
    std::string text;
    bool alarm = false;
};

// What changes the cell is a record, and becomes so in two steps: it is judged and handed out by
// record(), and only committed(), when it is on the disk, carries it out and acknowledges it. One
// record at a time is on its way. Until it is there the cell is as it was, and commands, orders and
// plans that come meanwhile wait for their turn; what needs no record does not: link, PackML
// commands, heartbeats and acting states.
class Controller {
public:
    using OnEvent = std::function<void(const Event &)>;

    Controller(const ControllerSettings &settings, OnEvent on_event);

    // The journal's records, in order, before start(). Throws std::runtime_error for one that does
    // not follow from those before.
    void restore(const Record &record);

    // State Stopped, once the record of the start is committed; before that nothing else is called.
    void start(const Moment &now);

    // What the journal is to append, the same one until it is answered; or nullptr.
    const Record *record() const { return commit_ ? &commit_->record : nullptr; }
    void committed(const Moment &now);
    void commit_failed(const std::string &why, const Moment &now);

    // Whether the journal, which has failed, is to be opened again; until it is answered.
    bool wants_reopen() const { return reopening_; }
    void reopened(const Moment &now);
    void reopen_failed(const std::string &why);

    // One write request, already known to be writable.
    void write(uint16_t address, const uint16_t *values, uint16_t count, const Moment &now);

    // Whether a command in these registers waits for the journal: neither accepted nor refused.
    bool is_undecided(uint16_t address, uint16_t count) const;

    // Time passes: heartbeats, deadlines, acting states. To be called every 10 ms or so.
    void tick(const Moment &now);

    // An order of the MES: kOrderStore or kOrderCancel. The next one when this one is answered.
    void take_order(uint16_t what, const JobOrder &order, const Moment &now);
    // The answer, once.
    std::optional<Refusal> order_answer();

    // The step to plan, once; nothing when none is wanted. The planner answers by plan_done() or
    // plan_failed() with the ticket; wants_cancel() says that it should end now.
    std::optional<PlanRequest> next_request(const Moment &now);
    void plan_done(uint64_t ticket, const PlanAnswer &plan, const Moment &now);
    void plan_failed(uint64_t ticket, const std::string &why, const Moment &now);
    bool wants_cancel() const { return planner_ == Planner::kAbandoned || hurry_; }

    bool wants_plan() const { return planner_ == Planner::kWanted; }

    const Registers &registers() const { return image_.all(); }
    const CellModel &cell() const { return cell_; }
    CellModel &cell() { return cell_; }
    PackmlState state() const { return state_; }
    uint64_t sequence() const { return sequence_; }
    uint16_t boot_id() const { return boot_id_; }
    // The end of the last PLAN_NEXT of any arm.
    const PlanEnd &last_plan() const { return results_[last_arm_]; }
    bool plc_seen() const { return heartbeat_at_.has_value(); }
    bool plc_stale() const { return plc_stale_; }

private:
    // A PLAN_NEXT that has not ended.
    struct Wish {
        uint16_t number = 0;
        int64_t accepted_at = 0;
        int64_t deadline_at = 0;
    };
    // What the planner is doing for us.
    enum class Planner { kIdle, kWanted, kRunning, kAbandoned };
    // What a Suspended cell waits for, where it was not told to wait.
    enum class Want { kNothing, kItems, kBin };
    // A record on its way to the disk.
    struct Commit {
        Record record;
        int64_t since = 0;                    // micros
        std::optional<PlanResult> overtaken;  // a PLAN_NEXT that ends so as soon as it is there
    };
    struct Order {
        uint16_t what = 0;
        JobOrder order;
    };
    struct Answer {
        uint64_t ticket = 0;
        PlanAnswer plan;
    };

    void commit(Record record, const Moment &now);
    bool is_committing(RecordKind kind, int arm) const;
    void take_waiting(const Moment &now);
    void started(uint16_t boot_id);
    void accepted(const Commit &done);
    void planned(int arm, const PlanEnd &end);
    void stored(const Record &order);
    void read_link(const Registers &before, const Moment &now);
    void read_block(int arm, const Moment &now);
    Refusal judge(const Command &command, int arm) const;
    bool is_owed_end(int arm) const;
    void accept(int arm, uint16_t number, const Command &command, const Moment &now);
    void show_refusal(int arm, uint16_t number, const Refusal &refusal);
    void judge_order(const Moment &now);

    void control(uint16_t number);
    void obey(PackmlCommand command);
    void enter(PackmlState state);
    void hold_on_fault(const std::string &why);
    bool is_wanting() const;
    void suspend_if_wanting(Want want, const char *why);
    void move_on();
    void watch_plc(const Moment &now);

    uint16_t asked(int arm) const;
    void cancel(int arm, PlanResult result);
    void pump(const Moment &now);
    void pump_arm(int arm, const Moment &now);
    bool is_awaited(uint64_t ticket) const;
    bool let_go(uint64_t ticket);
    void take_plan(const Answer &answer, const Moment &now);
    void finish(int arm, const PlanEnd &end, const Moment &now);
    void end_wish(int arm, PlanResult result);
    void show_result(int arm);

    void publish(const Moment &now);
    void tell(const char *kind, const std::string &text, bool alarm = false) const;

    ControllerSettings settings_;
    OnEvent on_event_;
    RegisterImage image_;
    CellModel cell_;

    Channel channels_[kArms];
    struct {
        uint16_t number = 0;
        std::string why;
    } refused_[kArms];  // last: a cyclic master repeats itself every scan, the log does not

    uint64_t sequence_ = 0;
    uint16_t boot_id_ = 0;
    std::optional<Commit> commit_;
    bool journal_broken_ = false;
    bool reopening_ = false;

    // What waits until the record under way is on the disk.
    bool unread_[kArms] = {false, false};  // command blocks
    std::optional<Order> order_;
    std::optional<Refusal> order_answer_;
    std::optional<Answer> answer_;  // of the planner, which counts as running so long

    PackmlState state_ = PackmlState::kStopped;
    Want want_ = Want::kNothing;
    std::optional<int64_t> heartbeat_at_;
    bool plc_stale_ = false;

    std::optional<Wish> wishes_[kArms];
    PlanEnd results_[kArms];  // of the last PLAN_NEXT of each arm, and its number
    uint16_t result_numbers_[kArms] = {0, 0};
    int last_arm_ = 0;
    Planner planner_ = Planner::kIdle;
    uint64_t ticket_ = 0;
    int owner_ = 0;       // arm whose PLAN_NEXT is planned
    bool hurry_ = false;  // its time is over
};

}  // namespace packcell_programs
