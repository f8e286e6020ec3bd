// The policy that puts an item where the bin left behind is worth most: value tables over the
// features of AfterstateFeatures, one set for each setting of rotation. Architecture kAfterstate.
#pragma once

#include <memory>
#include <vector>

#include "policy/afterstate_features.h"
#include "policy/weights.h"

namespace packcell {

// The value of a bin that is left behind: the cells that are still going to be taken.
class AfterstateValue {
public:
    // `misfit_keeps`: the share of its value that a bin keeps when an item does not fit: 0 where
    // the bin closes then, 1 where the item is passed by.
    AfterstateValue(const AfterstateShape &shape, float misfit_keeps)
        : features_(shape), misfit_keeps_(misfit_keeps), entries_(features_.size(), 0.0f) {}

    const AfterstateFeatures &features() const { return features_; }
    float misfit_keeps() const { return misfit_keeps_; }
    std::vector<float> &entries() { return entries_; }
    const std::vector<float> &entries() const { return entries_; }

    float operator()(const FreeCells &free) const {
        uint32_t list[AfterstateFeatures::kMostCount];
        features_.list(free, list);
        float sum = 0;
        for (int i = 0; i < features_.count(); ++i) sum += entries_[list[i]];
        return sum;
    }

private:
    AfterstateFeatures features_;
    float misfit_keeps_;
    std::vector<float> entries_;
};

// The position of the highest value for a rectangle of this size, the first one of several; W * H
// without one. `out_value` gets that value.
int best_afterstate(const AfterstateValue &value, const Bin &bin, const FreeCells &free, Size size,
                    float *out_value);

// Tables as tensors and back: "off/..." for items that are never turned, "on/..." for those that
// may be.
void append_tensors(const AfterstateValue &value, std::vector<Tensor> &tensors);

std::shared_ptr<const Policy> make_afterstate_policy(Weights weights);

}  // namespace packcell
