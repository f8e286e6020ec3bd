// What must hold of a protocol core after every request, told from the records of its journal, and
// what a restart must bring back.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "gateway/core_fixture.hpp"

namespace packcell_programs {

// Throws std::logic_error that says what does not hold.
inline void hold(bool holds, const std::string &what) {
    if (!holds) throw std::logic_error(what);
}

// The cell once more, from the records alone and without a plan: what was placed is in the bin.
class Shadow {
public:
    // After each request: the records that it made, and the registers that follow from all of them.
    void check(const Gateway &gateway) {
        const MemoryJournal &journal = gateway.journal();
        int commands[kArms] = {0, 0};
        for (; accounted_ < journal.size(); ++accounted_) {
            const Record &record = journal[accounted_];
            hold(record.sequence == accounted_ + 1, "the records' sequence has a gap");
            follow(record);
            if (record.kind == RecordKind::kPlan) planned_[record.arm] = record.number;
            if (record.kind != RecordKind::kCommand) continue;
            ++commands[record.arm];
            hold(record.number == next_number(numbers_[record.arm]), "a number was left out");
            numbers_[record.arm] = record.number;
        }
        for (int arm = 0; arm < kArms; ++arm) {
            hold(commands[arm] <= 1, "two commands of an arm in one request");
            hold(gateway.ack(arm) == numbers_[arm], "ack is not the last journalled number");
            const int behind = numbers_between(gateway.done(arm), gateway.ack(arm));
            // A PLAN_NEXT that has not ended may have let commands pass.
            hold(behind <= static_cast<int>(accounted_), "done is ahead of ack");
            const unsigned base = arm == 0 ? kResultA : kResultB;
            hold(gateway.at(base + kActionCount) == 0 || gateway.at(base) == planned_[arm],
                 "a plan is shown that is not in the journal");
        }
        check_registers(gateway);
        check_cell(gateway.cell());
    }

    // The library's numbers of all items, and the PLC's.
    const std::map<int32_t, uint32_t> &known() const { return known_; }
    uint64_t commands() const { return commands_; }
    uint64_t placed() const { return placed_; }
    uint64_t resolved() const { return resolved_; }

private:
    void follow(const Record &record) {
        if (record.kind != RecordKind::kCommand) return;
        ++commands_;
        const Command c = command_from(record.code, record.payload);
        switch (c.what()) {
            case Code::kItemArrived:
                hold(known_ids_.insert(c.id).second, "an item arrived twice");
                break;
            case Code::kPlaced:
                ++placed_;
                hold(in_bin_.insert(c.id).second, "an item was placed twice");
                break;
            case Code::kUnpacked:
                hold(in_bin_.erase(c.id) == 1, "an item was unpacked that is not in the bin");
                break;
            case Code::kBinChanged:
                for (const uint32_t id : in_bin_) known_ids_.erase(id);
                if (!in_bin_.empty()) ++closed_;
                in_bin_.clear();
                break;
            case Code::kResolve:
                ++resolved_;
                if (c.in_bin) {
                    in_bin_.insert(c.id);
                } else {
                    in_bin_.erase(c.id);
                }
                break;
            case Code::kItemGone:
                in_bin_.erase(c.id);
                hold(known_ids_.erase(c.id) == 1, "an unknown item is gone");
                break;
            default:
                break;
        }
    }

    void check_registers(const Gateway &gateway) const {
        const Controller &core = gateway.core();
        hold(gateway.at(kMagic) == kMapMagic, "the magic number");
        hold(gateway.at(kStateCurrent) >= 1 && gateway.at(kStateCurrent) <= kPackmlStates,
             "a state that is none");
        hold(gateway.at(kStateCurrent) == static_cast<uint16_t>(core.state()), "state register");
        hold(gateway.at32(kJournalSequence) == gateway.journal().size(), "sequence register");
        hold(gateway.at(kItemsInBin) == in_bin_.size(), "items in bin: PLACED less UNPACKED");
        hold(gateway.at(kItemsInBin) + gateway.at(kItemsOnBelt) + gateway.at(kBufferedItems) ==
                 static_cast<int>(known_ids_.size()),
             "items in bin, on belt and in buffers are not those that arrived");
        hold(gateway.at32(kBinsClosed) == closed_, "bins closed");
        if (gateway.journal().is_broken()) {
            hold(core.state() == PackmlState::kAborting || core.state() == PackmlState::kAborted,
                 "the journal is broken and the state is not Aborted");
        }
        for (const unsigned base : {kResultA, kResultB}) {
            hold(gateway.at(base) == gateway.at(base + kResultTail), "a torn result");
            hold(gateway.at(base + kPageIndex) < gateway.at(base + kPages), "a page too far");
        }
    }

    void check_cell(const CellModel &cell) {
        known_.clear();
        int32_t area = 0;
        for (const pkc_placement &p : cell.packed()) {
            area += p.item.w * p.item.h;
            hold(known_.emplace(p.item.id, cell.outer_id(p.item.id)).second, "an item twice");
        }
        for (const auto &list : {cell.belt(), cell.buffer()}) {
            for (const pkc_queued &q : list)
                hold(known_.emplace(q.item.id, cell.outer_id(q.item.id)).second, "an item twice");
        }
        std::set<uint32_t> ids;
        for (const auto &[inner, outer] : known_) ids.insert(outer);
        hold(ids == known_ids_, "other items than those that arrived");
        hold(area == cell.bin_info().occupied_cells, "occupied cells");
        for (const uint32_t id : cell.unresolved())
            hold(ids.count(id) == 1, "an unresolved item that is nowhere");
    }

    size_t accounted_ = 0;
    uint16_t numbers_[kArms] = {0, 0};
    uint16_t planned_[kArms] = {0, 0};
    std::set<uint32_t> known_ids_;
    std::set<uint32_t> in_bin_;
    uint32_t closed_ = 0;
    std::map<int32_t, uint32_t> known_;
    uint64_t commands_ = 0;
    uint64_t placed_ = 0;
    uint64_t resolved_ = 0;
};

inline bool same_items(const std::vector<pkc_queued> &a, const std::vector<pkc_queued> &b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const auto &p, const auto &q) {
        return p.item.id == q.item.id && p.item.w == q.item.w && p.item.h == q.item.h &&
               p.item.flags == q.item.flags && p.arms == q.arms && p.recognized == q.recognized;
    });
}

inline void check_same_cell(const CellModel &a, const CellModel &b) {
    hold(same_items(a.belt(), b.belt()), "another belt after a restart");
    hold(same_items(a.buffer(), b.buffer()), "other buffers after a restart");
    hold(a.unresolved() == b.unresolved(), "other unresolved items after a restart");
    hold(a.packed().size() == b.packed().size(), "another bin after a restart");
    for (size_t i = 0; i < a.packed().size(); ++i) {
        const pkc_placement &p = a.packed()[i];
        const pkc_placement &q = b.packed()[i];
        hold(p.item.id == q.item.id && p.x == q.x && p.y == q.y && p.rot == q.rot,
             "another place in the bin after a restart");
        hold(a.outer_id(p.item.id) == b.outer_id(q.item.id), "another number of an item");
    }
    const auto &s = a.step().actions();
    const auto &t = b.step().actions();
    hold(s.size() == t.size(), "another step after a restart");
    for (size_t i = 0; i < s.size(); ++i) {
        hold(s[i].op == t[i].op && s[i].item == t[i].item && s[i].x == t[i].x && s[i].y == t[i].y &&
                 s[i].rot == t[i].rot && s[i].arm == t[i].arm && s[i].state == t[i].state,
             "another action after a restart");
    }
    for (int arm = 0; arm < kArms; ++arm)
        hold(a.step().is_fetched(arm) == b.step().is_fetched(arm), "another arm has the step");
    hold(a.job() == b.job() && a.bins_closed() == b.bins_closed(), "another job");
    hold(a.orders().size() == b.orders().size(), "other orders after a restart");
    for (size_t i = 0; i < a.orders().size(); ++i)
        hold(a.orders()[i].id == b.orders()[i].id && a.orders()[i].text == b.orders()[i].text,
             "another order after a restart");
}

// A plan that was given is shown again.
inline void check_results(const Gateway &gateway, const Registers &before) {
    for (int arm = 0; arm < kArms; ++arm) {
        const unsigned status = static_cast<unsigned>(kAckSeqA + arm * kArmStatusSize);
        const auto result = static_cast<PlanResult>(before[status + 2]);
        if (before[status] != before[status + 1]) continue;
        if (result != PlanResult::kPlan && result != PlanResult::kBestSoFar) continue;
        const unsigned base = arm == 0 ? kResultA : kResultB;
        hold(gateway.at(status + 2) == before[status + 2], "another result after a restart");
        hold(gateway.at(base) == before[base], "another result's number after a restart");
        hold(gateway.at(base + kActionCount) == before[base + kActionCount],
             "another plan after a restart");
        if (before[base + kPageIndex] != 0) continue;
        for (unsigned at = base; at < base + kResultSize; ++at)
            hold(gateway.at(at) == before[at], "another plan after a restart");
    }
}

}  // namespace packcell_programs
