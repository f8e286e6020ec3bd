// Tasks: which arm takes which item off the belt, and what each arm does in a step, in order.
#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include "base/status.h"
#include "episodes.h"
#include "motion.h"
#include "task/allocation.h"
#include "task/atomic.h"

namespace packcell {
namespace {

constexpr int kSlots = 3;

Item item(int32_t id, int w, int h) { return {id, w, h, 0}; }

// In the bin of 10 x 10 lie 10 (3 x 2 at the left, turned: 2 x 3), 11 (4 x 4) and 12 (2 x 2); of
// the items 0..6, 3 x 2 each, on the belt arm 0 reaches 0..2 and arm 1 2..4.
struct Cell {
    Bin bin{10, 10};
    Queue queue{parse_scenario("D-R5A3O1")};
    BufferSlots slots{kSlots, kSlots};

    Cell() {
        bin.place({item(10, 3, 2), 0, 0, 1});
        bin.place({item(11, 4, 4), 2, 0, 0});
        bin.place({item(12, 2, 2), 6, 0, 0});
        for (int32_t id = 0; id < 7; ++id) queue.push(item(id, 3, 2));
    }

    // As if nothing had come of it.
    StepWork sequence(const std::vector<Action> &actions) const {
        BufferSlots tried = slots;
        return sequence_step(bin, queue, actions.data(), actions.size(), tried);
    }

    // And carries it out.
    StepWork run(const std::vector<Action> &actions) {
        StepWork work = sequence_step(bin, queue, actions.data(), actions.size(), slots);
        apply_step(bin, queue, actions.data(), actions.size());
        return work;
    }
};

Action unpack(int32_t id, int arm) { return {kUnpack, id, 0, 0, 0, arm}; }
Action pack(int32_t id, int x, int y, int arm, int rot = 0) { return {kPack, id, x, y, rot, arm}; }

// "standby, pick 10 from bin, 10 to buffer 0, ..."
std::string text_of(const std::vector<Atomic> &arm) {
    std::string text;
    for (const Atomic &a : arm) {
        if (!text.empty()) text += ", ";
        const std::string id = std::to_string(a.item.id);
        const std::string place = std::to_string(a.at.place);
        const std::string buffer = "buffer " + place;
        const std::string at = a.at.spot == Spot::kBelt  ? "belt " + place
                               : a.at.spot == Spot::kBin ? "bin"
                                                         : buffer;
        switch (a.kind) {
            case AtomicKind::kPick:
                text += "pick " + id + " from " + at;
                break;
            case AtomicKind::kPlaceToBin:
            case AtomicKind::kPlaceToBuffer:
                assert_true((a.kind == AtomicKind::kPlaceToBin) == (a.at.spot == Spot::kBin));
                text += id + " to " + at;
                break;
            case AtomicKind::kStandby:
            case AtomicKind::kReady:
                assert_int_equal(a.item.id, -1);
                assert_true(a.at.spot == Spot::kNone);
                text += a.kind == AtomicKind::kStandby ? "standby" : "ready";
                break;
        }
    }
    return text;
}

void expect_work(const StepWork &work, const char *arm0, const char *arm1) {
    assert_string_equal(text_of(work.arms[0]).c_str(), arm0);
    assert_string_equal(text_of(work.arms[1]).c_str(), arm1);
}

void each_item_is_picked_and_placed_and_its_arm_gets_ready(void **) {
    Cell cell;
    const StepWork one = cell.sequence({pack(1, 8, 0, 0, 1)});
    expect_work(one, "pick 1 from belt 1, 1 to bin, ready", "");
    assert_int_equal(one.robots, 2);
    assert_false(one.repacking);
    assert_false(one.terminates);
    const Atomic &place = one.arms[0][1];
    assert_int_equal(place.at.rot, 1);
    assert_int_equal(place.at.cells.x, 8);
    assert_int_equal(place.at.cells.w, 2);
    assert_int_equal(place.at.cells.h, 3);
    assert_int_equal(place.item.w, 3);
    assert_int_equal(place.action, 0);
    assert_int_equal(place.after, -1);
    assert_int_equal(one.arms[0][0].at.rot, 0);

    expect_work(cell.sequence({pack(4, 0, 5, 1)}), "", "pick 4 from belt 4, 4 to bin, ready");

    // One robot.
    Bin bin(10, 10);
    Queue queue(parse_scenario("S-R1A1"));
    queue.push(item(1, 2, 2));
    BufferSlots none(0, 0);
    const Action only = pack(1, 0, 0, 0);
    const StepWork single = sequence_step(bin, queue, &only, 1, none);
    expect_work(single, "pick 1 from belt 0, 1 to bin, ready", "");
    assert_int_equal(single.robots, 1);
}

void what_moves_no_item_is_no_work(void **) {
    Cell cell;
    StepWork work = cell.sequence({{kSkip, 0, 0, 0, 0, 0}});
    expect_work(work, "", "");
    assert_false(work.terminates);
    work = cell.sequence({{kTerminate, 0, 0, 0, 0, 0}});
    expect_work(work, "", "");
    assert_true(work.terminates);
    work = cell.sequence({{kSkip, 0, 0, 0, 0, 0}, pack(1, 0, 5, 0), {kTerminate, 0, 0, 0, 0, 0}});
    expect_work(work, "pick 1 from belt 1, 1 to bin, ready", "");
    assert_int_equal(work.arms[0][0].action, 1);
    assert_true(work.terminates);
}

void the_arm_with_fewer_actions_stands_by_first(void **) {
    Cell cell;
    // As many: the front one waits.
    expect_work(cell.sequence({pack(0, 0, 5, 0), pack(3, 0, 8, 1)}),
                "pick 0 from belt 0, 0 to bin, ready",
                "standby, pick 3 from belt 3, 3 to bin, ready");
    expect_work(cell.sequence({unpack(12, 0), pack(3, 0, 8, 1)}),
                "pick 12 from bin, 12 to buffer 0, ready",
                "standby, pick 3 from belt 3, 3 to bin, ready");
    expect_work(cell.sequence({unpack(12, 1), pack(0, 0, 5, 0), pack(3, 0, 8, 1)}),
                "standby, pick 0 from belt 0, 0 to bin, ready",
                "pick 12 from bin, 12 to buffer 0, pick 3 from belt 3, 3 to bin, ready");
    expect_work(cell.sequence({unpack(12, 0), pack(0, 0, 5, 0), pack(3, 0, 8, 1)}),
                "pick 12 from bin, 12 to buffer 0, pick 0 from belt 0, 0 to bin, ready",
                "standby, pick 3 from belt 3, 3 to bin, ready");
}

void what_the_arm_packs_next_stays_in_its_hand(void **) {
    Cell cell;
    StepWork work = cell.sequence({unpack(10, 0), pack(10, 0, 8, 0)});
    expect_work(work, "pick 10 from bin, 10 to bin, ready", "");
    assert_true(work.repacking);
    assert_int_equal(work.arms[0][0].action, 0);
    assert_int_equal(work.arms[0][0].at.rot, 1);  // as it lay
    assert_int_equal(work.arms[0][0].at.cells.h, 3);
    assert_int_equal(work.arms[0][1].action, 1);
    assert_int_equal(work.arms[0][1].at.rot, 0);
    assert_int_equal(work.arms[0][1].at.cells.w, 3);

    // What the other arm does in between, and what no arm does, does not matter.
    work = cell.sequence({unpack(10, 0),
                          unpack(12, 1),
                          {kSkip, 1, 0, 0, 0, 0},
                          pack(3, 0, 5, 1),
                          pack(10, 0, 8, 0),
                          pack(12, 4, 8, 1)});
    expect_work(work, "standby, pick 10 from bin, 10 to bin, ready",
                "pick 12 from bin, 12 to buffer 0, pick 3 from belt 3, 3 to bin, "
                "pick 12 from buffer 0, 12 to bin, ready");

    // Something else first: it is put down.
    work = cell.sequence({unpack(10, 0), pack(0, 0, 5, 0), pack(10, 0, 8, 0)});
    expect_work(work,
                "pick 10 from bin, 10 to buffer 0, pick 0 from belt 0, 0 to bin, "
                "pick 10 from buffer 0, 10 to bin, ready",
                "");
    // In a buffer without slots, too, an item in hand needs none.
    cell.slots = BufferSlots(0, 0);
    expect_work(cell.sequence({unpack(10, 0), pack(10, 0, 8, 0)}),
                "pick 10 from bin, 10 to bin, ready", "");
}

void unpacked_items_are_packed_in_reverse_order(void **) {
    Cell cell;
    const StepWork work = cell.sequence({unpack(10, 0), unpack(11, 0), unpack(12, 0),
                                         pack(12, 0, 0, 0), pack(11, 2, 0, 0), pack(10, 6, 0, 0)});
    expect_work(work,
                "pick 10 from bin, 10 to buffer 0, pick 11 from bin, 11 to buffer 1, "
                "pick 12 from bin, 12 to bin, pick 11 from buffer 1, 11 to bin, "
                "pick 10 from buffer 0, 10 to bin, ready",
                "");
    // Its own arm has freed the cells by then, in the order of its work.
    for (const Atomic &a : work.arms[0]) assert_int_equal(a.after, -1);
}

void a_place_waits_for_the_other_arm_to_free_its_cells(void **) {
    Cell cell;
    // Arm 0 has more to do: arm 1 stands by, which moves nothing in arm 0's list.
    StepWork work = cell.sequence({unpack(10, 0), unpack(12, 0), pack(3, 6, 0, 1)});
    expect_work(work, "pick 10 from bin, 10 to buffer 0, pick 12 from bin, 12 to buffer 1, ready",
                "standby, pick 3 from belt 3, 3 to bin, ready");
    assert_int_equal(work.arms[1][2].after, 2);
    assert_int_equal(work.arms[1][1].after, -1);

    // Arm 0 stands by: its pick is the action after that.
    work = cell.sequence({unpack(12, 0), unpack(11, 1), unpack(10, 1), pack(3, 6, 0, 1)});
    expect_work(work, "standby, pick 12 from bin, 12 to buffer 0, ready",
                "pick 11 from bin, 11 to buffer 0, pick 10 from bin, 10 to buffer 1, "
                "pick 3 from belt 3, 3 to bin, ready");
    assert_int_equal(work.arms[1][5].after, 1);
    assert_true(work.arms[0][static_cast<size_t>(work.arms[1][5].after)].kind == AtomicKind::kPick);

    // Of several, the last one.
    work = cell.sequence({unpack(12, 0), unpack(10, 0), unpack(11, 0), pack(3, 5, 0, 1)});
    assert_int_equal(work.arms[1][2].after, 4);
    assert_int_equal(work.arms[0][4].item.id, 11);

    // Cells that touch are not the same cells; those freed by itself need no gate.
    work = cell.sequence({unpack(12, 0), pack(3, 6, 2, 1)});
    assert_int_equal(work.arms[1][2].after, -1);
    work = cell.sequence({unpack(12, 1), pack(3, 6, 0, 1), unpack(10, 0)});
    for (const Atomic &a : work.arms[1]) assert_int_equal(a.after, -1);
}

// It is picked from where the action before has put it, not from where it lay when the step began.
void an_item_may_move_more_than_once_in_a_step(void **) {
    Cell cell;
    StepWork work = cell.sequence(
        {unpack(12, 0), pack(12, 8, 8, 0), unpack(12, 0), pack(12, 0, 8, 0), pack(0, 7, 7, 0)});
    expect_work(work,
                "pick 12 from bin, 12 to bin, pick 12 from bin, 12 to bin, pick 0 from belt 0, "
                "0 to bin, ready",
                "");
    assert_int_equal(work.arms[0][2].at.cells.x, 8);
    assert_int_equal(work.arms[0][2].at.cells.y, 8);

    // By the other arm: once it lies there, and where it lay once it is gone.
    work = cell.sequence(
        {unpack(12, 0), pack(12, 8, 8, 0), unpack(12, 1), pack(12, 0, 8, 1), pack(0, 7, 7, 0)});
    expect_work(work, "pick 12 from bin, 12 to bin, pick 0 from belt 0, 0 to bin, ready",
                "standby, pick 12 from bin, 12 to bin, ready");
    assert_int_equal(work.arms[1][1].after, 1);
    assert_int_equal(work.arms[0][3].after, 1);

    // One from a buffer, which was not in the bin when the step began.
    cell.run({unpack(10, 0)});
    work = cell.run({pack(10, 0, 8, 0), unpack(10, 0), unpack(12, 0), pack(10, 6, 0, 0, 1)});
    expect_work(work,
                "pick 10 from buffer 0, 10 to bin, pick 10 from bin, 10 to buffer 0, "
                "pick 12 from bin, 12 to buffer 1, pick 10 from buffer 0, 10 to bin, ready",
                "");
    assert_int_equal(work.arms[0][2].at.cells.w, 3);
    assert_int_equal(work.arms[0][6].at.rot, 0);
}

void a_slot_is_kept_until_its_item_is_packed(void **) {
    Cell cell;
    expect_work(cell.run({unpack(10, 0), unpack(12, 0), unpack(11, 1)}),
                "pick 10 from bin, 10 to buffer 0, pick 12 from bin, 12 to buffer 1, ready",
                "standby, pick 11 from bin, 11 to buffer 0, ready");
    expect_work(cell.run({pack(0, 0, 8, 0)}), "pick 0 from belt 0, 0 to bin, ready", "");

    // It lies there as it lay in the bin, whichever way it goes back.
    const StepWork back = cell.run({pack(10, 0, 0, 0)});
    expect_work(back, "pick 10 from buffer 0, 10 to bin, ready", "");
    assert_false(back.repacking);
    assert_int_equal(back.arms[0][0].at.rot, 1);
    assert_int_equal(back.arms[0][1].at.rot, 0);
    assert_int_equal(back.arms[0][0].item.w, 3);

    // The first free slot is the next one's.
    const StepWork again = cell.run({unpack(0, 0), pack(11, 5, 5, 1)});
    expect_work(again, "pick 0 from bin, 0 to buffer 0, ready",
                "standby, pick 11 from buffer 0, 11 to bin, ready");
    assert_int_equal(again.arms[0][1].at.rot, 0);
    expect_work(cell.run({pack(12, 8, 0, 0)}), "pick 12 from buffer 1, 12 to bin, ready", "");
    expect_work(cell.run({unpack(10, 0)}), "pick 10 from bin, 10 to buffer 1, ready", "");
}

void a_buffer_without_a_place_is_a_limit(void **) {
    Cell cell;
    cell.slots = BufferSlots(1, 1);
    const auto fails = [&cell](const std::vector<Action> &actions) {
        return failure(Status::kLimit, [&] { cell.run(actions); });
    };
    assert_string_equal(fails({unpack(10, 0), unpack(12, 0)}).c_str(),
                        "item 12: the buffer of arm 0 has 1 places, all taken");
    assert_string_equal(fails({unpack(10, 0), unpack(11, 1), unpack(12, 1)}).c_str(),
                        "item 12: the buffer of arm 1 has 1 places, all taken");
    // Nothing has changed: both slots are free.
    expect_work(cell.sequence({unpack(10, 0), unpack(11, 1)}),
                "pick 10 from bin, 10 to buffer 0, ready",
                "standby, pick 11 from bin, 11 to buffer 0, ready");
}

void what_breaks_a_rule_changes_nothing(void **) {
    Cell cell;
    const auto fails = [&cell](const std::vector<Action> &actions) {
        return failure(Status::kState, [&] { cell.run(actions); });
    };
    fails({unpack(10, 0), pack(4, 0, 5, 0)});
    fails({unpack(10, 0), unpack(10, 0)});
    fails({unpack(10, 0), pack(10, 0, 5, 1)});
    fails({unpack(10, 0), pack(0, 2, 0, 0)});
    for (int i = 0; i < kSlots; ++i) fails({unpack(10 + i, 0), unpack(99, 0)});
    assert_int_equal(cell.bin.items().size(), 3);
    assert_int_equal(cell.queue.buffer().size(), 0);
    int32_t rot = 0;
    for (int32_t id = 10; id <= 12; ++id) assert_int_equal(cell.slots.take(0, id, rot), -1);

    // In a buffer by the queue, but nobody has put it there.
    cell.queue.put_in_buffer({item(20, 1, 1), 0});
    assert_string_equal(
        fails({pack(20, 0, 5, 0)}).c_str(),
        "actions[0] (op 2, item 20): the item lies in no slot of the buffer of arm 0");
}

// ---- Whole episodes -----------------------------------------------------------------------------

// Carries out a step's atomic actions, the arms in a random order that keeps the gates: cells are
// free when something comes down on them, items are where they are taken from, and a gripper holds
// one item at a time.
class Actor {
public:
    Actor(const PlannedStep &step, const StepWork &work, uint64_t seed)
        : bin_(step.bin), queue_(step.queue), work_(work), seed_(seed) {}

    void act(Random &random, std::map<int32_t, Location> *buffers) {
        while (next_[0] < work_.arms[0].size() || next_[1] < work_.arms[1].size()) {
            const int first = static_cast<int>(random.below(2));
            const int arm = may_go(first) ? first : 1 - first;
            check(may_go(arm), "both arms wait");
            go(arm, buffers);
        }
    }

    const Bin &bin() const { return bin_; }

private:
    void check(bool holds, const char *what) { expect(holds, seed_, what, 0, 0); }

    bool may_go(int arm) const {
        const size_t next = next_[arm];
        if (next >= work_.arms[arm].size()) return false;
        const int32_t after = work_.arms[arm][next].after;
        return after < 0 || next_[1 - arm] > static_cast<size_t>(after);
    }

    void go(int arm, std::map<int32_t, Location> *buffers) {
        const std::vector<Atomic> &list = work_.arms[arm];
        const size_t at = next_[arm]++;
        const Atomic &a = list[at];
        const int32_t id = a.item.id;
        if (a.kind == AtomicKind::kStandby) {
            check(at == 0, "standby is not first");
        } else if (a.kind == AtomicKind::kReady) {
            check(at + 1 == list.size() && held_[arm] < 0, "ready is not last, or holds an item");
        } else if (a.kind == AtomicKind::kPick) {
            check(held_[arm] < 0, "picks with an item in the hand");
            held_[arm] = id;
            if (a.at.spot == Spot::kBelt) {
                check(queue_.find_belt(id) == a.at.place, "not at its place on the belt");
                const int arms = reach(queue_.scenario(), queue_.regions(), a.at.place);
                check((arms & (1 << arm)) != 0, "out of the arm's reach");
            } else if (a.at.spot == Spot::kBin) {
                const int index = bin_.find(id);
                check(index >= 0, "not in the bin");
                bin_.remove(static_cast<size_t>(index));
            } else {
                const auto lies = buffers[arm].find(id);
                check(lies != buffers[arm].end() && lies->second.place == a.at.place &&
                          lies->second.rot == a.at.rot,
                      "does not lie so in the buffer");
                buffers[arm].erase(lies);
            }
        } else {
            check(held_[arm] == id, "places what it does not hold");
            held_[arm] = -1;
            if (a.kind == AtomicKind::kPlaceToBin) {
                check(bin_.is_free(a.at.cells), "cells are taken");
                bin_.place({a.item, a.at.cells.x, a.at.cells.y, a.at.rot});
            } else {
                for (const auto &other : buffers[arm])
                    check(other.second.place != a.at.place, "the slot is taken");
                buffers[arm][id] = a.at;
            }
        }
    }

    Bin bin_;
    const Queue &queue_;
    const StepWork &work_;
    uint64_t seed_;
    size_t next_[2] = {0, 0};
    int32_t held_[2] = {-1, -1};
};

void whole_episodes_can_be_carried_out_in_any_order_that_keeps_the_gates(void **) {
    int gates = 0;
    int repacks = 0;
    int again = 0;  // packs of items that were set down on their way
    for (uint64_t seed = 1; seed <= 60; ++seed) {
        EpisodeOptions options;
        options.scenario = seed % 3 == 0 ? "D-R5A2O2" : seed % 3 == 1 ? "D-R5A3O1" : "S-R5A3";
        options.repacks = true;
        options.bin = {8, 8};
        options.buffer = static_cast<int>(seed / 3 % 3);
        BufferSlots slots(options.buffer, options.buffer);
        std::map<int32_t, Location> buffers[2];
        Random random(seed);
        for (const PlannedStep &step : plan_episode(seed, options)) {
            const StepWork work = sequence_step(step.bin, step.queue, step.actions.data(),
                                                step.actions.size(), slots);
            Actor actor(step, work, seed);
            actor.act(random, buffers);
            Bin after = step.bin;
            Queue left = step.queue;
            apply_step(after, left, step.actions.data(), step.actions.size());
            expect(actor.bin().hash() == after.hash(), seed, "the bin is another one", 0, 0);
            expect(buffers[0].size() + buffers[1].size() == left.buffer().size(), seed,
                   "items in the buffers", 0, 0);
            repacks += work.repacking ? 1 : 0;
            std::map<int32_t, int> packs;
            for (const Action &a : step.actions) again += a.op == kPack && ++packs[a.item] > 1;
            for (const auto &arm : work.arms) {
                gates += static_cast<int>(std::count_if(
                    arm.begin(), arm.end(), [](const Atomic &a) { return a.after >= 0; }));
            }
        }
    }
    assert_true(repacks > 20);
    assert_true(again > 0);
    assert_true(gates > 20);
}

// A legal step of random actions, which no planner would give.
std::vector<Action> random_step(Random &random, Bin bin, Queue queue, size_t slots) {
    std::vector<Action> actions;
    int picked = 0;  // bits of the arms
    const auto choose = [&random](size_t n) { return static_cast<size_t>(random.below(n)); };
    const auto put = [&](const Item &it, int arm) {
        const int rot = static_cast<int>(random.below(2));
        Positions positions;
        bin.feasible(it.turned(rot), positions);
        std::vector<Action> all;
        for (int y = 0; y < positions.count; ++y) {
            for (Row row = positions.rows[static_cast<size_t>(y)]; row != 0; row &= row - 1)
                all.push_back(pack(it.id, row_lowest(row), y, arm, rot));
        }
        if (all.empty()) return false;
        const Action &a = all[choose(all.size())];
        bin.place({it, a.x, a.y, a.rot});
        actions.push_back(a);
        return true;
    };
    for (int i = 0; i < 12; ++i) {
        const int arm = static_cast<int>(random.below(2));
        const uint64_t kind = random.below(5);
        if (kind == 0 && queue.belt_size() > 0) {
            const auto place = static_cast<int>(choose(std::min<size_t>(queue.belt_size(), 5)));
            const int arms = reach(queue.scenario(), queue.regions(), place);
            const Item &it = queue.belt(static_cast<size_t>(place));
            if ((arms & 1 << arm) == 0 || (picked & 1 << arm) != 0 || bin.find(it.id) >= 0)
                continue;
            if (put(it, arm)) picked |= 1 << arm;
        } else if (kind <= 2 && !queue.buffer().empty()) {
            const size_t index = choose(queue.buffer().size());
            const Buffered b = queue.buffer()[index];
            if (put(b.item, b.arm)) queue.take_from_buffer(index);
        } else if (!bin.items().empty()) {
            const size_t index = choose(bin.items().size());
            const Item it = bin.items()[index].item;
            const auto held = std::count_if(queue.buffer().begin(), queue.buffer().end(),
                                            [arm](const Buffered &b) { return b.arm == arm; });
            if (static_cast<size_t>(held) == slots || queue.holds(it.id)) continue;
            bin.remove(index);
            queue.put_in_buffer({it, arm});
            actions.push_back(unpack(it.id, arm));
        }
    }
    return actions;
}

void random_steps_can_be_carried_out_in_any_order_that_keeps_the_gates(void **) {
    int again = 0;
    for (uint64_t seed = 1; seed <= 300; ++seed) {
        Random random(seed);
        Cell cell;
        for (int32_t id = 20; id < 80; ++id) {
            const int w = 1 + static_cast<int>(random.below(4));
            const int h = 1 + static_cast<int>(random.below(4));
            cell.queue.push(item(id, w, h));
        }
        std::map<int32_t, Location> buffers[2];
        for (int step = 0; step < 20; ++step) {
            const std::vector<Action> actions =
                random_step(random, cell.bin, cell.queue, static_cast<size_t>(kSlots));
            std::map<int32_t, int> packs;
            for (const Action &a : actions) again += a.op == kPack && ++packs[a.item] > 1 ? 1 : 0;
            const PlannedStep before{cell.bin, cell.queue, actions};
            const StepWork work = cell.run(actions);
            Actor actor(before, work, seed);
            actor.act(random, buffers);
            expect(actor.bin().hash() == cell.bin.hash(), seed, "the bin is another one", step, 0);
            expect(buffers[0].size() + buffers[1].size() == cell.queue.buffer().size(), seed,
                   "items in the buffers", step, 0);
        }
    }
    assert_true(again > 300);
}

// ---- Allocation ---------------------------------------------------------------------------------

std::vector<int> arms_of(const Queue &queue, const BeltDistances &distances,
                         std::vector<Action> actions) {
    allocate(queue, distances, actions);
    std::vector<int> arms(actions.size());
    std::transform(actions.begin(), actions.end(), arms.begin(),
                   [](const Action &a) { return a.arm; });
    return arms;
}

void items_go_to_the_nearest_arm_that_reaches_them(void **) {
    Cell cell;
    const BeltDistances near1 = {{{.9, .9, .9, .9, .9}, {.1, .1, .1, .1, .1}}};
    const BeltDistances near0 = {{{.1, .1, .1, .1, .1}, {.9, .9, .9, .9, .9}}};
    using Arms = std::vector<int>;
    const auto arms = [&cell](const BeltDistances &d, const std::vector<Action> &actions) {
        return arms_of(cell.queue, d, actions);
    };
    // Place 2 is both arms'.
    assert_true(arms(near1, {pack(2, 0, 5, 0)}) == Arms{1});
    assert_true(arms(near1, {pack(2, 0, 5, 1)}) == Arms{1});
    assert_true(arms(near0, {pack(2, 0, 5, 1)}) == Arms{0});
    // Places 0, 1 and 3, 4 are not.
    assert_true(arms(near1, {pack(0, 0, 5, 0)}) == Arms{0});
    assert_true(arms(near0, {pack(4, 0, 5, 1)}) == Arms{1});
    // Never two for one arm.
    assert_true(arms(near0, {pack(0, 0, 5, 0), pack(2, 0, 7, 1)}) == (Arms{0, 1}));
    assert_true(arms(near1, {pack(2, 0, 5, 0), pack(3, 0, 7, 1)}) == (Arms{0, 1}));
    // A tie stays as it was planned.
    const BeltDistances same = {{{.5, .5, .5, .5, .5}, {.5, .5, .5, .5, .5}}};
    assert_true(arms(same, {pack(2, 0, 5, 0)}) == Arms{0});
    assert_true(arms(same, {pack(2, 0, 5, 1)}) == Arms{1});
    // What was unpacked stays with its arm, and so does what lies in a buffer.
    assert_true(arms(near1, {unpack(10, 0), pack(2, 0, 5, 0), pack(10, 0, 8, 0)}) ==
                (Arms{0, 1, 0}));
    cell.queue.put_in_buffer({item(20, 1, 1), 0});
    assert_true(arms(near1, {pack(20, 0, 5, 0)}) == Arms{0});
    assert_true(arms(near1, {{kTerminate, 0, 0, 0, 0, 0}}) == Arms{0});

    const BeltDistances none = {{{}, {}}};
    failure(Status::kArgument, [&] { arms(none, {pack(2, 0, 5, 0)}); });
}

void two_items_that_both_arms_reach_are_swapped_where_that_is_nearer(void **) {
    Queue queue(parse_scenario("D-R5A2O2"));
    for (int32_t id = 0; id < 5; ++id) queue.push(item(id, 2, 2));
    using Arms = std::vector<int>;
    const std::vector<Action> step = {pack(0, 0, 0, 0), pack(1, 2, 0, 1)};
    const std::vector<Action> crossed = {pack(0, 0, 0, 1), pack(1, 2, 0, 0)};
    const BeltDistances straight = {{{.2, .4}, {.4, .2}}};
    assert_true(arms_of(queue, straight, step) == (Arms{0, 1}));
    assert_true(arms_of(queue, straight, crossed) == (Arms{0, 1}));
    // By the sum, not one by one: arm 0 is the nearest to both.
    const BeltDistances one = {{{.1, .2}, {.3, .9}}};
    assert_true(arms_of(queue, one, step) == (Arms{1, 0}));
    assert_true(arms_of(queue, one, crossed) == (Arms{1, 0}));
}

void one_robot_takes_everything(void **) {
    Queue queue(parse_scenario("S-R5A3"));
    for (int32_t id = 0; id < 5; ++id) queue.push(item(id, 2, 2));
    const BeltDistances d = {{{.9, .9, .9}, {.1, .1, .1}}};
    assert_true(arms_of(queue, d, {pack(1, 0, 0, 0)}) == std::vector<int>{0});
}

}  // namespace
}  // namespace packcell

int main() {
    using namespace packcell;
    const CMUnitTest tests[] = {
        cmocka_unit_test(each_item_is_picked_and_placed_and_its_arm_gets_ready),
        cmocka_unit_test(what_moves_no_item_is_no_work),
        cmocka_unit_test(the_arm_with_fewer_actions_stands_by_first),
        cmocka_unit_test(what_the_arm_packs_next_stays_in_its_hand),
        cmocka_unit_test(unpacked_items_are_packed_in_reverse_order),
        cmocka_unit_test(a_place_waits_for_the_other_arm_to_free_its_cells),
        cmocka_unit_test(an_item_may_move_more_than_once_in_a_step),
        cmocka_unit_test(a_slot_is_kept_until_its_item_is_packed),
        cmocka_unit_test(a_buffer_without_a_place_is_a_limit),
        cmocka_unit_test(what_breaks_a_rule_changes_nothing),
        cmocka_unit_test(whole_episodes_can_be_carried_out_in_any_order_that_keeps_the_gates),
        cmocka_unit_test(random_steps_can_be_carried_out_in_any_order_that_keeps_the_gates),
        cmocka_unit_test(items_go_to_the_nearest_arm_that_reaches_them),
        cmocka_unit_test(two_items_that_both_arms_reach_are_swapped_where_that_is_nearer),
        cmocka_unit_test(one_robot_takes_everything),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
