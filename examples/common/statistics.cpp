#include "common/statistics.hpp"

#include <algorithm>
#include <cmath>

namespace packcell_programs {

namespace {

constexpr double kNormal95 = 1.959963984540054;

}  // namespace

void Sample::add(double value) {
    values_.push_back(value);
    sum_ += value;
}

double Sample::mean() const {
    return values_.empty() ? 0 : sum_ / static_cast<double>(values_.size());
}

double Sample::max() const {
    return values_.empty() ? 0 : *std::max_element(values_.begin(), values_.end());
}

double Sample::half_width_95() const {
    if (values_.size() < 2) return 0;
    const double centre = mean();
    double squares = 0;
    for (const double value : values_) squares += (value - centre) * (value - centre);
    const auto count = static_cast<double>(values_.size());
    return kNormal95 * std::sqrt(squares / (count - 1) / count);
}

double Sample::quantile(double share) const {
    if (values_.empty()) return 0;
    const double rank = std::ceil(share * static_cast<double>(values_.size()));
    const auto index = static_cast<size_t>(std::max(1.0, rank)) - 1;
    std::vector<double> sorted = values_;
    const auto at =
        sorted.begin() + static_cast<std::ptrdiff_t>(std::min(index, sorted.size() - 1));
    std::nth_element(sorted.begin(), at, sorted.end());
    return *at;
}

}  // namespace packcell_programs
