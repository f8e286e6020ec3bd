// Atomic action sequencing (paper, Sec. IV-D): what each arm does in a step, in order, from the
// step's primitives.
#pragma once

#include <cstdint>
#include <vector>

#include "bin/bin.h"
#include "feed/queue.h"
#include "feed/step.h"
#include "task/buffer_slots.h"

namespace packcell {

enum class AtomicKind : int {
    kPick = 1,
    kPlaceToBin = 2,
    kPlaceToBuffer = 3,
    kStandby = 4,
    kReady = 5,
};

enum class Spot : int { kNone = 0, kBelt = 1, kBin = 2, kBuffer = 3 };

// Where an atomic action takes place.
struct Location {
    Spot spot = Spot::kNone;
    int32_t place = 0;  // on the belt: place at the step's start; in the buffer: slot
    Rect cells{};       // in the bin
    int32_t rot = 0;    // how the item lies there
};

struct Atomic {
    AtomicKind kind = AtomicKind::kReady;
    Item item{};  // id -1 for standby and ready
    Location at;
    int32_t action = -1;  // index among the step's primitives
    // Index of the other arm's atomic action in this step that must be done first, as it frees the
    // cells or puts the item there; -1: none.
    int32_t after = -1;
};

// One step's work for the arms.
struct StepWork {
    std::vector<Atomic> arms[2];
    int robots = 1;
    bool repacking = false;  // it has unpacks
    bool terminates = false;
};

// Rules (i)-(v): the arm with fewer actions begins with `standby`; an unpack whose item the same
// arm packs next stays in the gripper; each arm with work ends with `ready`. `bin` and `queue` are
// those before the step. Throws kState when an action breaks a rule of the step, kLimit when an
// arm's buffer has no slot left.
StepWork sequence_step(const Bin &bin, const Queue &queue, const Action *actions, size_t count,
                       BufferSlots &slots);

}  // namespace packcell
