// The queue: the items on the conveyor (N of the paper) and in the arms' buffers (C).
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "bin/item.h"
#include "feed/scenario.h"

namespace packcell {

// An unpacked item and the arm whose buffer holds it.
struct Buffered {
    Item item;
    int arm;
};

class Queue {
public:
    explicit Queue(const Scenario &scenario);

    const Scenario &scenario() const { return scenario_; }
    const Regions &regions() const { return regions_; }
    int alpha_left() const { return alpha_left_; }

    // In arrival order; the first is nearest the downstream end.
    size_t belt_size() const { return belt_.size() - head_; }
    const Item &belt(size_t place) const { return belt_[head_ + place]; }
    const std::vector<Buffered> &buffer() const { return buffer_; }

    // Place on the belt or index in the buffer, or -1.
    int find_belt(int32_t id) const;
    int find_buffer(int32_t id) const;
    bool holds(int32_t id) const { return find_belt(id) >= 0 || find_buffer(id) >= 0; }

    void push(const Item &item);

    // Takes these items (places, ascending) off the belt; then it advances (Sec. V-C2).
    void take(const std::vector<int> &places);

    void put_in_buffer(const Buffered &item) { buffer_.push_back(item); }
    Buffered take_from_buffer(size_t index);

    // Restores what a snapshot says.
    void set_alpha_left(int alpha_left);

private:
    void advance();

    Scenario scenario_;
    std::vector<Item> belt_;  // from head_ on; the front is dropped in bulk
    size_t head_ = 0;
    std::vector<Buffered> buffer_;
    Regions regions_;
    int alpha_left_ = 0;
};

}  // namespace packcell
