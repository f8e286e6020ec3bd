// Many environments side by side, for learners outside of packcell: one call steps all of them.
// What is chosen and what is seen are arrays, a row a bin.
#pragma once

#include <cstdint>
#include <vector>

#include "learn/environment.h"

namespace packcell {

class EnvironmentBatch {
public:
    // The share `reward_fill` of the reward is the bin's utilisation when it closes.
    EnvironmentBatch(const Protocol &protocol, int count, double reward_fill);

    // A copy has as much room as its model, so that it needs no memory either.
    EnvironmentBatch(const EnvironmentBatch &other);
    EnvironmentBatch(EnvironmentBatch &&) = default;

    const Protocol &protocol() const { return protocol_; }
    size_t count() const { return bins_.size(); }
    size_t cells() const;

    // Positions for each orientation that an item may have, and "no position".
    size_t actions() const;

    uint64_t items_placed() const { return items_placed_; }
    uint64_t bins_closed() const { return bins_closed_; }
    size_t closed_now() const;

    // Begins streams of items: one seed gives bin i its stream i, one seed a bin its stream 0.
    void reseed(const uint64_t *seeds, size_t count);

    // All bins are empty; the streams go on.
    void open_all();
    void open_closed();

    // An item into each bin. Nothing is placed if an action is not allowed: kState where the bin
    // is closed, kArgument where the item cannot lie.
    void step(const int32_t *actions);

    // Of the last step, as are those of closed bins below.
    double reward(size_t i) const;
    int contact(size_t i) const { return bins_[i].contact; }
    bool closed(size_t i) const { return bins_[i].closed; }

    int occupied(size_t i) const { return bins_[i].environment.bin().occupied(); }
    Size item(size_t i) const { return bins_[i].environment.item(); }

    // cells() bytes, 1 where taken; actions() bytes, 1 where allowed.
    void write_cells(size_t i, uint8_t *out) const;
    void write_mask(size_t i, uint8_t *out) const;

private:
    struct Slot {
        Environment environment;
        int contact;
        bool closed;
    };

    void open(Slot &slot);
    void check_action(size_t i, int32_t action) const;

    Protocol protocol_;
    double reward_fill_;
    std::vector<Slot> bins_;
    uint64_t items_placed_ = 0;
    uint64_t bins_closed_ = 0;
};

}  // namespace packcell
