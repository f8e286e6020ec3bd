#include "bench/held_back_bound.hpp"

#include <algorithm>
#include <map>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "common/errors.hpp"
#include "common/handles.hpp"

namespace packcell_programs {

namespace {

constexpr double kMostPercent = 100;
// Of the interval in which the best price is sought: the bound is flat around its lowest.
constexpr int kHalvings = 12;
constexpr double kSame = 1e-9;

// A set of items, as how many there are of each kind; equal sets have equal texts.
using Counts = std::u32string;

// Items of one size, either way round where they may be turned, are of one kind.
class Kinds {
public:
    Kinds(const std::vector<pkc_item> &items, bool rotation) {
        std::map<std::pair<int32_t, int32_t>, size_t> known;
        for (const pkc_item &item : items) {
            auto size = std::make_pair(item.w, item.h);
            if (rotation && size.first < size.second) std::swap(size.first, size.second);
            const auto [place, is_new] = known.try_emplace(size, sizes_.size());
            if (is_new) sizes_.push_back(item);
            of_item_.push_back(place->second);
        }
    }

    size_t count() const { return sizes_.size(); }
    size_t of_item(size_t index) const { return of_item_[index]; }
    int area(size_t kind) const { return sizes_[kind].w * sizes_[kind].h; }

    std::vector<pkc_item> items(const Counts &counts) const {
        std::vector<pkc_item> items;
        for (size_t kind = 0; kind < counts.size(); ++kind) {
            items.insert(items.end(), static_cast<size_t>(counts[kind]), sizes_[kind]);
        }
        return items;
    }

private:
    std::vector<pkc_item> sizes_;
    std::vector<size_t> of_item_;
};

// Whether sets of items fit into a bin; asks the exact packer once for each.
class Packings {
public:
    Packings(const Instance &stream, const Kinds &kinds, bool rotation, const pkc_budget &budget)
        : bin_(make_bin(stream.w, stream.h)), kinds_(kinds), rotation_(rotation), budget_(budget) {}

    bool possible(const Counts &counts) {
        const auto [known, is_new] = answers_.try_emplace(counts, false);
        if (is_new) known->second = ask(counts);
        return known->second;
    }

    int64_t undecided() const { return undecided_; }

private:
    bool ask(const Counts &counts) {
        const std::vector<pkc_item> items = kinds_.items(counts);
        std::vector<pkc_placement> placements(items.size());
        int32_t answer = 0;
        check(pkc_exact_pack(bin_.get(), items.data(), items.size(), rotation_ ? 1 : 0, &budget_,
                             placements.data(), &answer, nullptr));
        if (answer == PKC_PACKING_BUDGET) ++undecided_;
        return answer != PKC_PACKING_IMPOSSIBLE;
    }

    BinHandle bin_;
    const Kinds &kinds_;
    bool rotation_;
    pkc_budget budget_;
    std::unordered_map<Counts, bool> answers_;
    int64_t undecided_ = 0;
};

// Between two bins: the items before `next` were taken, one of kind `held` is held back, or none.
struct State {
    size_t next = 0;
    size_t held = 0;
};

struct Close {
    double value = 0;  // of the bin's cells and of what follows, less the prices
    State after;
};

bool is_worse(const Close &a, const Close &b) { return a.value < b.value; }

// The best that can be done when a bin costs a price, by dynamic programming from the stream's end.
class PricedBins {
public:
    PricedBins(const Instance &stream, const Kinds &kinds, Packings &packings, int64_t bins)
        : kinds_(kinds), packings_(packings), bins_(bins), cells_(stream.w * stream.h) {
        // More items than this the bins cannot take.
        int64_t room = bins * cells_ + largest_area();
        for (; end_ < stream.items.size() && room >= 0; ++end_) {
            room -= kinds_.area(kinds_.of_item(end_));
        }
    }

    // At `price` cells a bin; as many bins are packed as pay. False where part_done, called as
    // often as there are bins, returned false.
    bool solve(double price, const std::function<bool()> &part_done) {
        price_ = price;
        best_.assign((end_ + 1) * states_an_item(), Close{});
        size_t next = end_ + 1;  // what is held then can still fill a bin
        for (int64_t part = bins_; part-- > 0;) {
            const size_t begin = end_ * static_cast<size_t>(part) / static_cast<size_t>(bins_);
            while (next > begin) solve_with(--next);
            if (!part_done()) return false;
        }
        return true;
    }

    double value() const { return best(start()).value; }

    int64_t bins() const {
        int64_t bins = 0;
        for (State state = start(); best(state).value > kSame; state = best(state).after) ++bins;
        return bins;
    }

private:
    size_t none() const { return kinds_.count(); }
    size_t states_an_item() const { return kinds_.count() + 1; }
    State start() const { return State{0, none()}; }
    const Close &best(State state) const {
        return best_[state.next * states_an_item() + state.held];
    }

    int largest_area() const {
        int largest = 0;
        for (size_t kind = 0; kind < kinds_.count(); ++kind) {
            largest = std::max(largest, kinds_.area(kind));
        }
        return largest;
    }

    void solve_with(size_t next) {
        // A bin may close with nothing in it but what was held: then nothing is held.
        solve(State{next, none()});
        for (size_t held = 0; held < kinds_.count(); ++held) solve(State{next, held});
    }

    // All ways to close the bin that this state begins, by the cells they take alone.
    void find_closes(State state) {
        closes_.clear();
        Counts counts(kinds_.count(), 0);
        int area = 0;
        const auto add = [&](size_t kind) {
            ++counts[kind];
            area += kinds_.area(kind);
        };
        const auto close = [&](size_t next, size_t held, int taken) {
            if (taken == 0 || taken > cells_) return;
            const State after{next, held};
            closes_.push_back(Close{taken - price_ + best(after).value, after});
        };
        if (state.held != none()) add(state.held);
        for (size_t next = state.next;; ++next) {
            close(next, none(), area);
            for (size_t kind = 0; kind < kinds_.count(); ++kind) {
                const bool new_items = next > state.next;
                if (new_items && counts[kind] > 0) close(next, kind, area - kinds_.area(kind));
            }
            if (next == end_ || area > cells_ + largest_area()) return;
            add(kinds_.of_item(next));
        }
    }

    // What the bin holds that begins with `state` and closes with `after`.
    Counts contents(State state, State after) const {
        Counts counts(kinds_.count(), 0);
        if (state.held != none()) ++counts[state.held];
        for (size_t item = state.next; item < after.next; ++item) ++counts[kinds_.of_item(item)];
        if (after.held != none()) --counts[after.held];
        return counts;
    }

    // The best close whose items fit; the better ones are asked about first, and few are.
    void solve(State state) {
        find_closes(state);
        std::make_heap(closes_.begin(), closes_.end(), is_worse);
        for (auto end = closes_.end(); end != closes_.begin(); --end) {
            const Close &close = closes_.front();
            if (close.value <= 0) return;
            if (packings_.possible(contents(state, close.after))) {
                best_[state.next * states_an_item() + state.held] = close;
                return;
            }
            std::pop_heap(closes_.begin(), end, is_worse);
        }
    }

    const Kinds &kinds_;
    Packings &packings_;
    int64_t bins_;
    int cells_;
    size_t end_ = 0;  // items that the bins may take
    double price_ = 0;
    std::vector<Close> best_;    // by state; value 0 where no bin pays
    std::vector<Close> closes_;  // of the state at hand, a heap
};

}  // namespace

int64_t held_back_parts(int64_t bins) { return kHalvings * bins; }

// At any price p, n bins take at most n p cells and what bins, as many as pay, take beyond their
// prices (Lagrangian relaxation of the number of bins). Lowest where the price makes n bins pay.
std::optional<HeldBackBound> held_back_bound(const Instance &stream, bool rotation,
                                             const pkc_budget &budget, int64_t bins,
                                             const std::function<bool()> &part_done) {
    const Kinds kinds(stream.items, rotation);
    Packings packings(stream, kinds, rotation, budget);
    PricedBins priced(stream, kinds, packings, bins);
    const double cells = static_cast<double>(stream.w) * stream.h;
    double least = cells;  // a bin
    double low = 0;
    double high = cells;
    for (int i = 0; i < kHalvings; ++i) {
        const double price = (low + high) / 2;
        if (!priced.solve(price, part_done)) return std::nullopt;
        least = std::min(least, price + priced.value() / static_cast<double>(bins));
        (priced.bins() > bins ? low : high) = price;
    }
    return HeldBackBound{kMostPercent * least / cells, packings.undecided()};
}

}  // namespace packcell_programs
