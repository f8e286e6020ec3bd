// Bytes as a play: requests, time, planner's answers, failures and restarts for a controller; after
// each, what core_checks.hpp says must hold. The property test and the fuzzer share it.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "gateway/core_checks.hpp"

namespace packcell_programs {

class Play {
public:
    static constexpr uint64_t kMostRequests = 300;

    // What was reached, so that a run can show that it was not idle.
    struct Reached {
        uint64_t requests = 0;
        uint64_t commands = 0;
        uint64_t plans = 0;
        uint64_t placed = 0;
        uint64_t resolved = 0;
        uint64_t restarts = 0;
        uint64_t failures = 0;
    };

    // `planner` may be shared by plays; the bytes must outlive the play.
    Play(const uint8_t *bytes, size_t size, SmallPlanner &planner)
        : bytes_(bytes), size_(size), planner_(planner), gateway_(draw_settings()) {}

    // Throws std::logic_error that says what did not hold.
    void run() {
        account();
        while (at_ < size_ && reached_.requests < kMostRequests) act();
        restart();
    }

    Reached reached() const {
        Reached all = reached_;
        all.commands = shadow_.commands();
        all.placed = shadow_.placed();
        all.resolved = shadow_.resolved();
        return all;
    }

private:
    // ---- Choices
    uint8_t byte() { return at_ < size_ ? bytes_[at_++] : uint8_t{0}; }
    uint16_t word() {
        const unsigned high = byte();
        return static_cast<uint16_t>(high << 8 | byte());
    }
    unsigned below(unsigned bound) { return byte() % bound; }
    int draw_arm() { return static_cast<int>(below(2)); }
    template <typename T>
    const T &one_of(const std::vector<T> &all) {
        return all[below(static_cast<unsigned>(std::min<size_t>(all.size(), 256)))];
    }

    ControllerSettings draw_settings() {
        static const char *const scenarios[] = {"S-R1A1", "S-R3A2", "D-R5A3O1", "D-R6A4O4"};
        auto settings = settings_of(scenarios[below(4)], 2 + static_cast<int32_t>(below(4)),
                                    2 + static_cast<int32_t>(below(4)));
        if (below(4) == 0) settings.word_order = WordOrder::kLowFirst;
        return settings;
    }

    // ---- Requests
    void act() {
        if (gateway_.is_slow() && below(3) == 0) disk_answers();
        switch (below(17)) {
            case 0:
            case 1:
            case 2:
            case 3:
            case 4:
                if (const auto block = draw_command(draw_arm())) write_block(*block);
                break;
            case 5:
            case 6:
                follow_plan();
                break;
            case 7:
                damage();
                break;
            case 8:
                garbage();
                break;
            case 9:
                link();
                break;
            case 10:
                bring_to_execute();
                break;
            case 11:
                tick();
                break;
            case 12:
            case 13:
                answer();
                answer();
                break;
            case 14:
                seldom();
                break;
            case 15:
                change_disk();
                break;
            default:
                if (below(2) == 0) {
                    plan_next();
                } else {
                    produce();
                }
        }
    }

    struct Block {
        int arm;
        CommandBlock words;
    };

    void write(unsigned address, const std::vector<uint16_t> &values) {
        begin();
        gateway_.write(address, values);
        account();
    }
    void write_block(const Block &block) {
        last_ = block;
        if (below(8) != 0) {
            write(address_of(block.arm), block.words);
            return;
        }
        const auto cut = static_cast<std::ptrdiff_t>(1 + below(kCommandSize - 1));
        write(address_of(block.arm), {block.words.begin(), block.words.begin() + cut});
        if (below(2) == 0) tick();
        write(static_cast<unsigned>(address_of(block.arm) + cut),
              {block.words.begin() + cut, block.words.end()});
    }

    std::optional<Block> command(int arm, Code code, const std::vector<uint16_t> &words,
                                 uint16_t flags = 0) {
        return Block{arm, block_of(next_number(gateway_.ack(arm)), static_cast<uint16_t>(code),
                                   words, flags)};
    }

    uint32_t draw_id() {
        std::vector<uint32_t> ids = {0, 1, 0xFFFFFFFF};
        for (const auto &[inner, outer] : shadow_.known()) ids.push_back(outer);
        return one_of(ids);
    }

    std::optional<Block> draw_command(int arm) {
        const auto side = [this] { return static_cast<uint16_t>(1 + below(4)); };
        switch (below(14)) {
            case 0:
            case 1:
            case 2:
            case 3: {
                if (shadow_.known().size() > 12) return std::nullopt;
                const uint16_t w = side();
                const auto flags = static_cast<uint16_t>(below(8) < 4 ? 0 : below(4));
                next_id_ += 1 + (below(16) == 0 ? 0x10001u * below(200) : 0);
                return command(arm, Code::kItemArrived, gateway_.with_id(next_id_, {w, side()}),
                               flags);
            }
            case 4: {
                const auto x = static_cast<uint16_t>(below(6));
                const auto y = static_cast<uint16_t>(below(6));
                return command(
                    arm, Code::kPlaced,
                    gateway_.with_id(draw_id(), {x, y, static_cast<uint16_t>(below(2))}));
            }
            case 5:
                return command(arm, Code::kPlaceFailed, gateway_.with_id(draw_id()));
            case 6:
            case 7:
                return command(arm, Code::kUnpacked, gateway_.with_id(draw_id()));
            case 8: {
                if (below(3) != 0) return std::nullopt;
                const uint16_t w = side();
                return command(arm, Code::kBinChanged, {w, side()});
            }
            case 9:
                return command(arm, Code::kJobStart, gateway_.with_id(below(4)));
            case 10:
                if (below(4) != 0) return std::nullopt;
                return command(arm, Code::kJobEnd, {});
            case 11:
            case 12: {
                const auto &open = gateway_.cell().unresolved();
                const std::vector<uint32_t> ids(open.begin(), open.end());
                const uint32_t id = ids.empty() ? draw_id() : one_of(ids);
                return command(arm, Code::kResolve,
                               gateway_.with_id(id, {static_cast<uint16_t>(below(2))}));
            }
            default:
                return command(arm, Code::kItemGone, gateway_.with_id(draw_id()));
        }
    }

    // What the step under way wants, or nearly so.
    void follow_plan() {
        std::vector<StepAction> open;
        for (const StepAction &a : gateway_.cell().step().actions()) {
            if (a.moves_item() && a.state == ActionState::kOpen) open.push_back(a);
        }
        if (open.empty()) return;
        if (below(24) == 0) {
            restart();
            return;
        }
        const StepAction &a = below(4) == 0 ? one_of(open) : open.front();
        const int arm = below(8) == 0 ? draw_arm() : a.arm;
        const unsigned how = below(12);
        if (how == 0) {
            write_block(*command(arm, Code::kPlaceFailed, gateway_.with_id(a.item)));
        } else if (a.op == PKC_OP_UNPACK) {
            write_block(*command(arm, Code::kUnpacked, gateway_.with_id(a.item)));
        } else {
            const auto x = static_cast<uint16_t>(a.x + (how == 1 ? 1 : 0));
            write_block(*command(arm, Code::kPlaced,
                                 gateway_.with_id(a.item, {x, static_cast<uint16_t>(a.y),
                                                           static_cast<uint16_t>(a.rot)})));
        }
    }

    void plan_next() {
        const auto &unresolved = gateway_.cell().unresolved();
        if (!unresolved.empty() && below(4) != 0) {
            const auto in_bin = static_cast<uint16_t>(below(2));
            write_block(*command(draw_arm(), Code::kResolve,
                                 gateway_.with_id(*unresolved.begin(), {in_bin})));
            return;
        }
        static const uint16_t deadlines[] = {1, 20, 200, 60000};
        write_block(*command(draw_arm(), Code::kPlanNext, {deadlines[below(4)]}));
    }

    // A whole step as it should go, left at some point.
    void produce() {
        bring_to_execute();
        if (gateway_.state() == PackmlState::kSuspended)
            write_block(*command(draw_arm(), Code::kBinChanged, {4, 3}));
        for (unsigned n = 1 + below(4); n > 0 && shadow_.known().size() < 12; --n) {
            const auto w = static_cast<uint16_t>(1 + below(3));
            write_block(*command(0, Code::kItemArrived, gateway_.with_id(++next_id_, {w, 1})));
        }
        if (gateway_.state() != PackmlState::kExecute) bring_to_execute();
        while (!gateway_.cell().unresolved().empty() && below(8) != 0) plan_next();
        const int arm = draw_arm();
        write_block(*command(arm, Code::kPlanNext, {200}));
        if (below(2) == 0) write_block(*command(1 - arm, Code::kPlanNext, {100}));
        answer();
        for (unsigned n = below(6); n > 0; --n) follow_plan();
    }

    // The last block once more, as it was or with a word or two changed.
    void damage() {
        if (!last_) return;
        Block block = *last_;
        for (unsigned n = below(3); n > 0; --n) {
            const unsigned places[] = {kSeqHead, kCode,        kFlags,       kPayload,
                                       kSeqTail, kPayload + 1, kPayload + 2, kPayload + 4};
            uint16_t &at = block.words[places[below(8)]];
            at = below(2) == 0 ? word() : static_cast<uint16_t>(at + (below(2) == 0 ? 1 : -1));
        }
        if (below(4) == 0) block.arm = 1 - block.arm;
        write(address_of(block.arm), block.words);
    }

    void garbage() {
        const unsigned address = below(4) == 0 ? word() : below(110);
        std::vector<uint16_t> values(1 + below(below(8) == 0 ? 120 : 6));
        for (uint16_t &value : values) value = below(2) == 0 ? word() : uint16_t{byte()};
        write(address, values);
    }

    void link() {
        switch (below(5)) {
            case 0:
                write(kPlcHeartbeat, {word()});
                break;
            case 1:
                write(kCancelSeq, {gateway_.ack(draw_arm())});
                break;
            case 2:
                write(kPageA, {byte(), byte()});
                break;
            case 3:
                write(kChangeRequest, {0});
                write(kControlCommand, {static_cast<uint16_t>(below(12)), 1});
                break;
            default:
                tick();
        }
    }

    void control(PackmlCommand wanted) {
        write(kChangeRequest, {0});
        write(kControlCommand, {static_cast<uint16_t>(wanted), 1});
        tick(10);
        if (gateway_.state() == PackmlState::kSuspending) tick(10);
    }
    // The way that an operator takes, as far as the planner lets go.
    void bring_to_execute() {
        for (int i = 0; i < 5; ++i) {
            if (gateway_.state() == PackmlState::kExecute) return;
            switch (gateway_.state()) {
                case PackmlState::kAborted:
                    control(PackmlCommand::kClear);
                    break;
                case PackmlState::kStopped:
                case PackmlState::kComplete:
                    control(PackmlCommand::kReset);
                    break;
                case PackmlState::kIdle:
                    control(PackmlCommand::kStart);
                    break;
                case PackmlState::kHeld:
                    control(PackmlCommand::kUnhold);
                    break;
                default:
                    tick(10);
            }
        }
    }

    void tick(int64_t ms) {
        begin();
        gateway_.tick(ms);
        account();
    }
    void tick() {
        static const int64_t steps[] = {0,  1,  10, 10, 10, 10,  10,   10,
                                        10, 10, 10, 30, 30, 100, 1500, 70000};
        tick(steps[below(16)]);
    }

    // ---- The planner: asked, and answering once, in time, late or never
    void answer() {
        const unsigned how = below(16);
        if (!request_) request_ = gateway_.core().next_request(gateway_.now());
        if (how == 0) {  // names nothing that was asked
            begin();
            gateway_.plan_done(word(), answer_of({}));
            account();
            return;
        }
        if (!request_ || how == 1) return;
        begin();
        const PlanRequest request = std::move(*request_);
        request_.reset();
        if (how == 2) {
            gateway_.core().plan_failed(request.ticket, "told to", gateway_.now());
        } else {
            const PlanAnswer plan = how == 3 ? answer_of(draw_actions()) : ask(request);
            if (!plan.actions.empty()) ++reached_.plans;
            gateway_.plan_done(request.ticket, plan);
        }
        account();
    }

    PlanAnswer ask(const PlanRequest &request) {
        auto bin = initialised(pkc_bin_info_init);
        check(pkc_bin_get_info(request.bin.get(), &bin));
        if (std::max(bin.w, bin.h) > SmallPlanner::kSide) return answer_of({});
        return planner_.plan(request);
    }

    std::vector<pkc_action> draw_actions() {
        std::vector<pkc_action> actions(below(4));
        for (pkc_action &a : actions) {
            const auto some = [this] { return static_cast<int32_t>(below(6)) - 1; };
            a = {some(), some(), some(), some(), some(), some()};
        }
        return actions;
    }

    // ---- A disk that takes its time, while all else goes on
    bool disk_answers() {
        begin();
        const bool asked = gateway_.settle_one();
        account();
        return asked;
    }
    void change_disk() {
        while (disk_answers()) {
        }
        gateway_.slow_disk(!gateway_.is_slow());
    }

    // ---- What happens seldom
    void seldom() {
        switch (below(16)) {
            case 0:
                restart();
                break;
            case 1:
                ++reached_.failures;
                gateway_.journal().fail_at(1 + static_cast<int>(below(3)),
                                           below(2) == 0 ? MemoryJournal::Failure::kBefore
                                                         : MemoryJournal::Failure::kAfter);
                break;
            default:
                order();
        }
    }

    void order() {
        if (is_ordered_ && !gateway_.core().order_answer()) return;
        begin();
        const uint16_t what = below(3) == 0 ? kOrderCancel : kOrderStore;
        const auto answer = gateway_.take_order(what, {1 + below(4), "{}"});
        is_ordered_ = !answer;
        if (answer && answer->reject == Reject::kJournal)
            hold(gateway_.journal().is_broken(), "an order failed without the journal");
        account();
    }

    void begin() { ++reached_.requests; }
    void account() { shadow_.check(gateway_); }

    // The power goes: what comes back is what lived through it, by the records alone.
    void restart() {
        ++reached_.restarts;
        // What got in although the journal failed, or was not told of it any more, is known from
        // now on; the old cell learns it too.
        CellModel &old = gateway_.core().cell();
        MemoryJournal &journal = gateway_.journal();
        const Record *under_way = gateway_.core().record();
        if (under_way != nullptr && below(2) == 0) journal.store_untold(*under_way);
        const bool late = journal.keeps_too_much();
        if (late) old.apply(journal.on_disk().back());
        const Registers before = gateway_.core().registers();
        std::vector<CellModel> keep;
        keep.push_back(std::move(old));
        ControllerSettings settings = gateway_.settings();
        if (below(4) == 0) settings.scenario = draw_settings().scenario;
        begin();
        gateway_.restart(settings);
        request_.reset();
        is_ordered_ = false;
        account();
        keep[0].apply(journal.back());
        check_same_cell(keep[0], gateway_.cell());
        hold(gateway_.state() == PackmlState::kStopped, "not Stopped after a start");
        for (int arm = 0; arm < kArms; ++arm)
            hold(gateway_.done(arm) == gateway_.ack(arm), "work under way after a start");
        if (late) return;
        for (const unsigned at : {unsigned{kAckSeqA}, unsigned{kAckSeqA} + kArmStatusSize})
            hold(gateway_.at(at) == before[at], "another ack after a restart");
        for (unsigned at = kUtilization; at < kKAlpha; ++at)
            hold(gateway_.at(at) == before[at], "another bin or belt after a restart");
        for (const unsigned at :
             {unsigned{kNextJob}, unsigned{kNextJob} + 1, unsigned{kJobsWaiting}})
            hold(gateway_.at(at) == before[at], "other orders after a restart");
        check_results(gateway_, before);
    }

    const uint8_t *bytes_;
    size_t size_;
    size_t at_ = 0;
    SmallPlanner &planner_;
    Gateway gateway_;
    Reached reached_;

    std::optional<Block> last_;
    uint32_t next_id_ = 0;
    bool is_ordered_ = false;             // an order that is not answered
    std::optional<PlanRequest> request_;  // that the planner is at
    Shadow shadow_;
};

}  // namespace packcell_programs
