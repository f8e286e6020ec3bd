#include "search/view.h"

#include <algorithm>

namespace packcell {

namespace {

constexpr int kBothArms = 3;  // the bits of arm 0 and arm 1

int lowest_arm(int arms) { return (arms & 1) != 0 ? 0 : 1; }

}  // namespace

void View::look(const Queue &queue) {
    scenario = queue.scenario();
    known.clear();
    for (const Buffered &b : queue.buffer()) known.push_back({b.item, b.arm, -1, 1 << b.arm});
    const auto seen = std::min(queue.belt_size(), static_cast<size_t>(scenario.recognized));
    whole_belt = seen == queue.belt_size();
    for (size_t place = 0; place < seen; ++place) {
        const int p = static_cast<int>(place);
        known.push_back({queue.belt(place), kNoArm, p, reach(scenario, queue.regions(), p)});
    }
}

KnownSet View::accessible() const {
    KnownSet set = 0;
    for (int i = 0; i < count(); ++i) {
        if ((*this)[i].arms != 0) set |= known_bit(i);
    }
    return set;
}

KnownSet View::reachable(KnownSet placed) const {
    KnownSet taken = 0;
    int waiting = 0;  // items that stay on the belt in front of the one looked at
    for (int i = 0; i < count(); ++i) {
        const bool is_placed = (placed & known_bit(i)) != 0;
        if ((*this)[i].buffered()) {
            if (is_placed) taken |= known_bit(i);
        } else if (is_placed && waiting < scenario.n_max()) {
            taken |= known_bit(i);
        } else {
            ++waiting;
        }
    }
    return taken;
}

int View::area(KnownSet set) const {
    int sum = 0;
    for (KnownSet rest = set; rest != 0; rest &= rest - 1)
        sum += (*this)[row_lowest(rest)].item.area();
    return sum;
}

Picks choose_picks(const View &view, const Tuple *sequence, int length) {
    Picks picks;
    for (int t = 0; t < length; ++t) {
        const Known &k = view[sequence[t].known];
        if (!k.buffered()) {
            if (k.arms == 0 || picks.count == view.scenario.robots) continue;
            if (picks.count == 1) {
                const int first = view[sequence[picks.tuple[0]].known].arms;
                if ((first | k.arms) != kBothArms) continue;
                // An item that both arms reach leaves the other one its arm.
                const int arm = first == kBothArms ? lowest_arm(k.arms == kBothArms ? 2 : k.arms)
                                                   : 1 - lowest_arm(first);
                picks.arm[0] = 1 - arm;
                picks.arm[1] = arm;
            } else {
                picks.arm[0] = lowest_arm(k.arms);
            }
            picks.tuple[picks.count++] = t;
        }
        picks.depth_sum += sequence[t].depth;
    }
    return picks;
}

}  // namespace packcell
