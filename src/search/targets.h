// Which items could lie in the bin in the end? A target is such a set: some recognised items come
// in, some packed or buffered ones stay out. Targets are listed by falling area, so that the first
// one that can be packed is the best.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/budget.h"
#include "search/view.h"

namespace packcell {

struct Target {
    int area = 0;
    KnownSet belt = 0;          // recognised items that come in
    std::vector<int> left_out;  // elements (see TargetList) that stay out of the bin
};

// The elements are the items that are in hand: 0..packed-1 the movable ones in the bin, then the
// buffered ones.
class TargetList {
public:
    explicit TargetList(size_t max_elements);

    // `areas` of the elements; `room`: most cells that a target may take; `may_leave`: elements
    // that may be left out at once. With `full` the target is every item, or failing that any that
    // takes exactly `room`, none left out.
    void start(const View &view, const std::vector<int> &areas, int room, int may_leave, bool full);

    // Begins again at the largest area.
    void rewind();

    enum class Answer { kTarget, kEnd, kPaused };

    // The next target of more than `above` cells. No heap use.
    Answer next(int above, Budget &budget);

    // Whether every target is listed: with many recognised items some are left out.
    bool complete() const { return complete_; }
    const Target &target() const { return target_; }

private:
    struct Belt {
        KnownSet set;
        int area;
    };

    void list_belt_sets(const View &view);
    Answer next_leaving(Budget &budget);
    bool advance_choice();

    std::vector<Belt> belts_;
    std::vector<int> order_;  // elements by falling area
    std::vector<int> sorted_areas_;
    std::vector<int> chosen_;  // indices in order_ of what is left out
    int element_area_ = 0;
    int largest_ = 0;
    int may_leave_ = 0;
    bool full_ = false;
    bool complete_ = true;

    int area_ = 0;       // being looked at
    size_t belt_ = 0;    // likewise
    int leaving_ = 0;    // how many are left out
    int wanted_ = 0;     // area to be left out
    bool open_ = false;  // chosen_ holds a choice to go on from
    Target target_;
};

}  // namespace packcell
