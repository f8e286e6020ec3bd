#include <algorithm>
#include <deque>
#include <vector>

#include "capi/handles.h"
#include "policy/policy.h"

using namespace packcell;

namespace {

constexpr int64_t kMostPairs = int64_t{1} << 20;

// Holds the bins of all pairs, each of them once.
class HeldBins {
public:
    HeldBins(const pkc_bin *const *bins, size_t count) {
        std::vector<const pkc_bin *> distinct(bins, bins + count);
        std::sort(distinct.begin(), distinct.end());
        distinct.erase(std::unique(distinct.begin(), distinct.end()), distinct.end());
        for (const pkc_bin *bin : distinct) held_.emplace_back("a bin", bin);
    }

private:
    std::deque<Use<const pkc_bin>> held_;
};

// Of bins that are held.
std::vector<Question> checked_questions(const pkc_bin *const *bins, const int32_t *sizes,
                                        size_t count) {
    const int w = bins[0]->bin.w();
    const int h = bins[0]->bin.h();
    std::vector<Question> questions;
    questions.reserve(count);
    for (size_t i = 0; i < count; ++i) {
        const Bin &bin = bins[i]->bin;
        if (bin.w() != w || bin.h() != h) {
            fail(Status::kArgument, "bin %zu has %d x %d cells: must have %d x %d as bin 0", i,
                 bin.w(), bin.h(), w, h);
        }
        require_range("w", sizes[2 * i], 1, PKC_MAX_SIDE);
        require_range("h", sizes[2 * i + 1], 1, PKC_MAX_SIDE);
        questions.push_back({&bin, {sizes[2 * i], sizes[2 * i + 1]}});
    }
    return questions;
}

template <class T>
T *room(std::vector<T> &out, const T *asked, size_t size) {
    if (asked == nullptr) return nullptr;
    out.resize(size);
    return out.data();
}

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
        const HeldBins held(bins, count);
        const Bin &any = bins[0]->bin;
        policy->policy->check_bin(any.w(), any.h());
        const std::vector<Question> questions = checked_questions(bins, sizes, count);

        // Kept apart until nothing can fail any more.
        std::vector<int32_t> positions;
        std::vector<float> probabilities;
        std::vector<float> values;
        Answers answers;
        answers.positions = room(positions, out_positions, count);
        answers.probabilities =
            room(probabilities, out_probabilities, count * static_cast<size_t>(any.cells() + 1));
        answers.values = room(values, out_values, count);
        policy->policy->evaluate_batch(questions.data(), count, answers);
        std::copy(positions.begin(), positions.end(), out_positions);
        std::copy(probabilities.begin(), probabilities.end(), out_probabilities);
        std::copy(values.begin(), values.end(), out_values);
    });
}

}  // extern "C"
