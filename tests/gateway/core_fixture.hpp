// What the tests of the gateway's protocol core share: a journal in memory that fails when told to,
// a small PLC, a planner and a controller that can be started anew from its records.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/handles.hpp"
#include "gateway/core/controller.hpp"

namespace packcell_programs {

// Keeps the promise of Journal: after a failure it refuses everything until reopen(), which takes
// back what was stored although append() threw.
class MemoryJournal : public Journal {
public:
    enum class Failure { kBefore, kAfter };  // storing

    // The n-th append from now on fails, 1 being the next.
    void fail_at(int n, Failure how = Failure::kBefore) {
        countdown_ = n;
        how_ = how;
    }
    void allow_reopen(bool allowed) { reopens_ = allowed; }

    void append(const Record &record) override {
        if (broken_) throw JournalFailure("the journal is closed");
        if (record.sequence != records_.size() + 1) throw std::logic_error("a gap in the journal");
        const bool fails = countdown_ > 0 && --countdown_ == 0;
        if (!fails || how_ == Failure::kAfter) records_.push_back(record);
        if (!fails) {
            good_ = records_.size();
            return;
        }
        broken_ = true;
        throw JournalFailure("the disk is full");
    }

    void reopen() override {
        if (!reopens_) throw JournalFailure("the disk is still full");
        records_.resize(good_);
        broken_ = false;
    }

    // The power goes between the disk's work and the word that it is done.
    void store_untold(const Record &record) {
        if (!broken_) records_.push_back(record);
    }

    // What was promised to be durable.
    size_t size() const { return good_; }
    const Record &operator[](size_t i) const { return records_[i]; }
    const Record &back() const { return records_[good_ - 1]; }
    bool is_broken() const { return broken_; }
    bool keeps_too_much() const { return records_.size() > good_; }

    // What a restart finds: with what was stored although append() threw.
    const std::vector<Record> &on_disk() const { return records_; }
    void close() {
        good_ = records_.size();
        broken_ = false;
        countdown_ = 0;
    }

private:
    std::vector<Record> records_;
    size_t good_ = 0;
    int countdown_ = 0;
    Failure how_ = Failure::kBefore;
    bool broken_ = false;
    bool reopens_ = true;
};

inline pkc_scenario scenario_of(const char *name) {
    auto scenario = initialised(pkc_scenario_init);
    check(pkc_scenario_parse(name, &scenario));
    return scenario;
}

inline ControllerSettings settings_of(const char *scenario, int32_t w, int32_t h,
                                      WordOrder order = WordOrder::kHighFirst) {
    ControllerSettings settings;
    settings.scenario = scenario_of(scenario);
    settings.bin_w = w;
    settings.bin_h = h;
    settings.word_order = order;
    return settings;
}

// A command block as a PLC holds it; `words` is the payload.
using CommandBlock = std::vector<uint16_t>;

inline CommandBlock block_of(uint16_t number, uint16_t code, const std::vector<uint16_t> &words,
                             uint16_t flags = 0) {
    CommandBlock block(kCommandSize, 0);
    block[kSeqHead] = block[kSeqTail] = number;
    block[kCode] = code;
    block[kFlags] = flags;
    std::copy(words.begin(), words.end(), block.begin() + kPayload);
    return block;
}

inline uint16_t address_of(int arm) { return arm == 0 ? kCommandA : kCommandB; }

// The real planner with few nodes; bins up to 16 x 16, any that do not fit get no plan.
class SmallPlanner {
public:
    SmallPlanner() {
        auto options = initialised(pkc_planner_options_init);
        options.repack = PKC_REPACK_ANYTIME;
        options.max_side = kSide;
        options.memory = 64 * 1024;
        planner_ = make_planner(options, nullptr);
    }

    PlanAnswer plan(const PlanRequest &request) {
        auto budget = initialised(pkc_budget_init);
        budget.nodes = 60;
        PlanAnswer answer;
        answer.info = initialised(pkc_plan_info_init);
        check(pkc_planner_plan(planner_.get(), request.bin.get(), request.queue.get(), &budget,
                               &answer.info));
        answer.actions =
            all_of<std::vector<pkc_action>>([&](pkc_action *out, size_t n, size_t *count) {
                return pkc_planner_result(planner_.get(), nullptr, out, n, count);
            });
        answer.milliseconds = 1.5;
        return answer;
    }

    static constexpr int32_t kSide = 16;

private:
    PlannerHandle planner_;
};

// An answer of given actions.
inline PlanAnswer answer_of(std::vector<pkc_action> actions) {
    PlanAnswer answer;
    answer.info = initialised(pkc_plan_info_init);
    answer.info.proof = PKC_PROOF_OPTIMAL;
    answer.actions = std::move(actions);
    answer.milliseconds = 2;
    return answer;
}

// A controller, its journal and its clock.
class Gateway {
public:
    explicit Gateway(const ControllerSettings &settings = settings_of("S-R3A2", 6, 6))
        : settings_(settings) {
        boot();
    }

    // The power goes and comes back; `settings` may be others then.
    void restart() {
        journal_->close();
        boot();
    }
    void restart(const ControllerSettings &settings) {
        settings_ = settings;
        restart();
    }

    Controller &core() { return *core_; }
    const Controller &core() const { return *core_; }
    const CellModel &cell() const { return core_->cell(); }
    MemoryJournal &journal() { return *journal_; }
    const MemoryJournal &journal() const { return *journal_; }
    const ControllerSettings &settings() const { return settings_; }
    Moment now() const { return now_; }
    void pass(int64_t ms) {
        now_.micros += ms * 1000;
        now_.wall_ms += ms;
    }
    void tick(int64_t ms = 10) {
        pass(ms);
        core_->tick(now_);
        settle();
    }

    // While the disk is slow, a record under way stays so until settle_one().
    void slow_disk(bool slow) {
        slow_ = slow;
        settle();
    }
    bool is_slow() const { return slow_; }
    // The journal answers; false if it was not asked.
    bool settle_one() {
        if (core_->wants_reopen()) {
            try {
                journal_->reopen();
                core_->reopened(now_);
            } catch (const JournalFailure &failure) {
                core_->reopen_failed(failure.what());
            }
            return true;
        }
        if (core_->record() == nullptr) return false;
        try {
            journal_->append(*core_->record());
            core_->committed(now_);
        } catch (const JournalFailure &failure) {
            core_->commit_failed(failure.what(), now_);
        }
        return true;
    }

    uint16_t at(unsigned address) const { return core_->registers()[address]; }
    uint32_t at32(unsigned address) const {
        return join_words(settings_.word_order, at(address), at(address + 1));
    }
    uint16_t ack(int arm = 0) const { return status(arm, 0); }
    uint16_t done(int arm = 0) const { return status(arm, 1); }
    PlanResult result(int arm = 0) const { return static_cast<PlanResult>(status(arm, 2)); }
    Reject reject(int arm = 0) const { return static_cast<Reject>(status(arm, 3)); }
    PackmlState state() const { return core_->state(); }
    const std::vector<Event> &events() const { return *events_; }
    size_t count_events(const std::string &kind) const {
        return static_cast<size_t>(std::count_if(events_->begin(), events_->end(),
                                                 [&](const Event &e) { return e.kind == kind; }));
    }

    void write(unsigned address, const std::vector<uint16_t> &values) {
        core_->write(static_cast<uint16_t>(address), values.data(),
                     static_cast<uint16_t>(values.size()), now_);
        settle();
    }
    void write_block(int arm, const CommandBlock &block) { write(address_of(arm), block); }

    std::vector<uint16_t> with_id(uint32_t id, std::vector<uint16_t> rest = {}) const {
        std::vector<uint16_t> words(2);
        put_words(settings_.word_order, id, words.data());
        words.insert(words.end(), rest.begin(), rest.end());
        return words;
    }

    // The next command of an arm, whole in one request; the reject code.
    Reject send(Code code, const std::vector<uint16_t> &words, int arm = 0, uint16_t flags = 0) {
        const uint16_t number = next_number(ack(arm));
        write_block(arm, block_of(number, static_cast<uint16_t>(code), words, flags));
        return ack(arm) == number ? Reject::kNone : reject(arm);
    }
    Reject arrive(uint32_t id, uint16_t w, uint16_t h, uint16_t flags = 0, int arm = 0) {
        return send(Code::kItemArrived, with_id(id, {w, h}), arm, flags);
    }
    Reject plan_next(uint16_t deadline = 100, int arm = 0) {
        return send(Code::kPlanNext, {deadline}, arm);
    }
    Reject placed(uint32_t id, uint16_t x, uint16_t y, uint16_t rot = 0, int arm = 0) {
        return send(Code::kPlaced, with_id(id, {x, y, rot}), arm);
    }
    Reject place_failed(uint32_t id, int arm = 0) {
        return send(Code::kPlaceFailed, with_id(id), arm);
    }
    Reject unpacked(uint32_t id, int arm = 0) { return send(Code::kUnpacked, with_id(id), arm); }
    Reject bin_changed(uint16_t w, uint16_t h) { return send(Code::kBinChanged, {w, h}); }
    Reject job_start(uint32_t id) { return send(Code::kJobStart, with_id(id)); }
    Reject job_end() { return send(Code::kJobEnd, {}); }
    Reject resolve(uint32_t id, bool in_bin) {
        return send(Code::kResolve, with_id(id, {in_bin ? uint16_t{1} : uint16_t{0}}));
    }
    Reject gone(uint32_t id) { return send(Code::kItemGone, with_id(id)); }

    // A PackML command, its edge included.
    void control(PackmlCommand command) {
        write(kChangeRequest, {0});
        write(kControlCommand, {static_cast<uint16_t>(command), 1});
    }
    void beat() { write(kPlcHeartbeat, {static_cast<uint16_t>(at(kPlcHeartbeat) + 1)}); }

    // From Stopped to Execute.
    void run() {
        control(PackmlCommand::kReset);
        tick();
        control(PackmlCommand::kStart);
        tick();
    }

    // The planner answers, if it is asked.
    bool plan() {
        const auto request = core_->next_request(now_);
        if (!request) return false;
        plan_done(request->ticket, planner_->plan(*request));
        return true;
    }
    bool plan(const std::vector<pkc_action> &actions) {
        const auto request = core_->next_request(now_);
        if (!request) return false;
        plan_done(request->ticket, answer_of(actions));
        return true;
    }
    void plan_done(uint64_t ticket, const PlanAnswer &answer) {
        core_->plan_done(ticket, answer, now_);
        settle();
    }

    // Nothing while the disk is slow.
    std::optional<Refusal> take_order(uint16_t what, const JobOrder &order) {
        core_->take_order(what, order, now_);
        settle();
        return core_->order_answer();
    }
    // Whether an order was stored or withdrawn.
    bool order(uint16_t what, const JobOrder &order) {
        const auto answer = take_order(what, order);
        return answer && !*answer;
    }

    // The library's number of an item.
    int32_t inner(uint32_t id) const {
        for (const pkc_placement &p : cell().packed()) {
            if (cell().outer_id(p.item.id) == id) return p.item.id;
        }
        for (const auto &list : {cell().belt(), cell().buffer()}) {
            for (const pkc_queued &q : list) {
                if (cell().outer_id(q.item.id) == id) return q.item.id;
            }
        }
        return -1;
    }
    pkc_action pack(uint32_t id, int32_t x, int32_t y, int32_t arm = 0, int32_t rot = 0) const {
        return {PKC_OP_PACK, inner(id), x, y, rot, arm};
    }
    pkc_action unpack(uint32_t id, int32_t arm = 0) const {
        return {PKC_OP_UNPACK, inner(id), 0, 0, 0, arm};
    }

    // The words of an action in a result block.
    std::vector<uint16_t> shown(int arm, unsigned action) const {
        const unsigned first = (arm == 0 ? kResultA : kResultB) + kActions + action * kActionSize;
        std::vector<uint16_t> words;
        for (unsigned i = 0; i < kActionSize; ++i) words.push_back(at(first + i));
        return words;
    }
    uint16_t shown_count(int arm) const {
        return at((arm == 0 ? kResultA : kResultB) + kActionCount);
    }

private:
    uint16_t status(int arm, int field) const {
        return at(static_cast<unsigned>(kAckSeqA + arm * kArmStatusSize + field));
    }

    void settle() {
        while (!slow_ && settle_one()) {
        }
    }

    void boot() {
        core_ = std::make_unique<Controller>(
            settings_, [events = events_.get()](const Event &event) { events->push_back(event); });
        for (const Record &record : journal_->on_disk()) core_->restore(record);
        core_->start(now_);
        settle_one();
    }

    ControllerSettings settings_;
    bool slow_ = false;
    // Where the controller finds them, even if the gateway is moved.
    std::unique_ptr<MemoryJournal> journal_ = std::make_unique<MemoryJournal>();
    std::unique_ptr<std::vector<Event>> events_ = std::make_unique<std::vector<Event>>();
    std::unique_ptr<SmallPlanner> planner_ = std::make_unique<SmallPlanner>();
    std::unique_ptr<Controller> core_;
    Moment now_{1000000, 1700000000000};
};

}  // namespace packcell_programs
