// Many questions one by one, for policies that gain nothing from having them together.
#include <algorithm>

#include "policy/policy.h"

namespace packcell {

void Policy::evaluate_batch(const Question *questions, size_t count, const Answers &answers) const {
    if (count == 0) return;
    const Bin &any = *questions[0].bin;
    const auto own = session({true, std::max(any.w(), any.h())});
    const Policy &used = own != nullptr ? *own : *this;
    const bool evaluates = answers.probabilities != nullptr || answers.values != nullptr;
    float *probabilities = answers.probabilities;
    Evaluation evaluation;
    for (size_t i = 0; i < count; ++i) {
        const Question &q = questions[i];
        if (answers.positions != nullptr) answers.positions[i] = used.select(*q.bin, q.size);
        if (!evaluates) continue;
        used.evaluate(*q.bin, q.size, evaluation);
        if (answers.values != nullptr) answers.values[i] = evaluation.value;
        if (probabilities == nullptr) continue;
        probabilities = std::copy(evaluation.probabilities.begin(), evaluation.probabilities.end(),
                                  probabilities);
    }
}

}  // namespace packcell
