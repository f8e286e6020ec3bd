#include "search/bound.h"

#include <algorithm>

namespace packcell {

namespace {

constexpr int kViews = 8;
constexpr uint64_t kFirstLimit = 2000;
constexpr uint64_t kLimitFactor = 2;

}  // namespace

ExactPacker::Answer decide(ExactPacker &packer, const Bin &bin, const Item *items, int count,
                           bool rotation, Budget &budget) {
    uint64_t limit = kFirstLimit;
    for (int attempt = 0;; ++attempt) {
        packer.start(bin, items, count, rotation, attempt % kViews);
        const ExactPacker::Answer answer = packer.run(budget, limit);
        if (answer != ExactPacker::Answer::kLimit) return answer;
        if (limit < UINT64_MAX / kLimitFactor) limit *= kLimitFactor;
    }
}

InOrderBound bound_in_order(ExactPacker &packer, const Bin &bin, const Item *items, int count,
                            bool rotation, Budget &budget) {
    InOrderBound bound;
    int area = bin.free_cells();
    int most = 0;
    while (most < count && items[most].area() <= area) area -= items[most++].area();
    // Fewer of them fit whenever more do: from few to many, until the first that cannot be.
    for (int n = 1; n <= most; ++n) {
        const ExactPacker::Answer answer = decide(packer, bin, items, n, rotation, budget);
        if (answer == ExactPacker::Answer::kImpossible) return bound;
        if (answer == ExactPacker::Answer::kPaused) return {most, false};
        bound.count = n;
    }
    return bound;
}

}  // namespace packcell
