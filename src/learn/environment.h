// What a learner plays: items come one by one and go into a bin until it closes (paper, Sec. III-B,
// the low-level MDP, and Sec. V-B).
#pragma once

#include <cstdint>
#include <vector>

#include "base/bytes.h"
#include "base/random.h"
#include "bin/bin.h"
#include "policy/policy.h"

namespace packcell {

// Items have sides that are uniform on least_side..most_side, independent of each other.
struct Protocol {
    int bin_w = 10;
    int bin_h = 10;
    int least_side = 1;
    int most_side = 5;
    // 0: the first item without a position closes the bin and opens the next one. n: so many items
    // are offered to a bin, those without a position are skipped, and a full bin closes at once.
    int items = 0;
    bool rotation = false;  // items may be turned
    bool mixed = false;     // each bin draws whether they may
};

// Throws kArgument on values out of range.
void check_protocol(const Protocol &protocol);

// What a stream of items is for. Streams for training and for measuring never share a seed: the
// purpose is the seed's lowest bit.
enum class Purpose : uint64_t { kTraining = 0, kHeldOut = 1 };

constexpr uint64_t stream_seed(uint64_t seed, uint64_t stream, Purpose purpose) {
    return (mix64(mix64(seed) + stream) & ~uint64_t{1}) | static_cast<uint64_t>(purpose);
}

void save_random(const Random &random, ByteWriter &out);
Random restore_random(ByteReader &in);

class Environment {
public:
    Environment(const Protocol &protocol, uint64_t seed);

    const Bin &bin() const { return bin_; }

    // The item to be placed now; it has a position.
    Size item() const { return item_; }

    // Whether the item may be turned and that makes a difference.
    bool turns() const { return rotation_ && item_.w != item_.h; }

    struct Outcome {
        int contact;   // reward of eq. (3)
        bool closed;   // the bin closed after this item
        int occupied;  // cells of it
    };

    // The item goes to a feasible position x + y * W. A bin that closes stays as it is, and item()
    // is the one that closed it or comes next, until open().
    Outcome pack(int position, bool turned);

    // The next bin, empty; it begins with item().
    void open();

    // Both: where a bin closes the next one is open and empty.
    Outcome place(int position, bool turned);

    // Begins another stream, with an empty bin.
    void reseed(uint64_t seed);

    void save(ByteWriter &out) const;
    void restore(ByteReader &in);

private:
    void draw_item();
    bool fits(Size size) const;
    bool fits_now() const { return fits(item_) || (turns() && fits({item_.h, item_.w})); }
    Protocol protocol_;
    Random random_;
    Bin bin_;
    Size item_ = {0, 0};
    int offered_ = 0;
    bool rotation_ = false;
};

// Which of an item's two orientations goes into the bin, as the planner chooses: the one whose
// position has the larger contact reward, unturned where both have the same. A position of W * H
// is none.
bool choose_turned(const Bin &bin, Size item, int position, int turned_position);

struct Utilization {
    double mean = 0;           // 0..1
    double half_width_95 = 0;  // of the mean's confidence interval
};

// The policy on so many bins of the held-out streams of `seed`.
Utilization measure(const Policy &policy, const Protocol &protocol, uint64_t seed, uint64_t bins);

}  // namespace packcell
