#include <algorithm>
#include <memory>
#include <vector>

#include "capi/handles.h"
#include "policy/policy.h"

using namespace packcell;

namespace {

constexpr int64_t kMostPairs = int64_t{1} << 20;

}  // namespace

extern "C" {

pkc_status pkc_policy_evaluate_batch(const pkc_policy *policy, const pkc_bin *const *bins,
                                     const int32_t *sizes, size_t count, int32_t *out_positions,
                                     float *out_probabilities, float *out_values) {
    return guard([&] {
        require(policy, "policy");
        require(bins, "bins");
        require(sizes, "sizes");
        require_range("count", static_cast<int64_t>(std::min<size_t>(count, INT64_MAX)), 1,
                      kMostPairs);
        require(bins[0], "bins[0]");
        const int w = bins[0]->bin.w();
        const int h = bins[0]->bin.h();
        const Policy &shared = *policy->policy;
        shared.check_bin(w, h);
        const auto session = shared.session({true, std::max(w, h)});
        const Policy &used = session != nullptr ? *session : shared;

        const size_t actions = static_cast<size_t>(w) * static_cast<size_t>(h) + 1;
        const bool evaluates = out_probabilities != nullptr || out_values != nullptr;
        // Kept apart until nothing can fail any more.
        std::vector<int32_t> positions;
        std::vector<float> probabilities;
        std::vector<float> values;
        Evaluation evaluation;
        for (size_t i = 0; i < count; ++i) {
            const Use<const pkc_bin> use("a bin", bins[i]);
            const Bin &bin = use->bin;
            if (bin.w() != w || bin.h() != h) {
                fail(Status::kArgument, "bin %zu has %d x %d cells: must have %d x %d as bin 0", i,
                     bin.w(), bin.h(), w, h);
            }
            require_range("w", sizes[2 * i], 1, PKC_MAX_SIDE);
            require_range("h", sizes[2 * i + 1], 1, PKC_MAX_SIDE);
            const Size size = {sizes[2 * i], sizes[2 * i + 1]};
            if (out_positions != nullptr) positions.push_back(used.select(bin, size));
            if (!evaluates) continue;
            used.evaluate(bin, size, evaluation);
            values.push_back(evaluation.value);
            if (out_probabilities == nullptr) continue;
            probabilities.insert(
                probabilities.end(), evaluation.probabilities.begin(),
                evaluation.probabilities.begin() + static_cast<std::ptrdiff_t>(actions));
        }
        if (out_positions != nullptr) {
            std::copy(positions.begin(), positions.end(), out_positions);
        }
        if (out_probabilities != nullptr) {
            std::copy(probabilities.begin(), probabilities.end(), out_probabilities);
        }
        if (out_values != nullptr) std::copy(values.begin(), values.end(), out_values);
    });
}

}  // extern "C"
