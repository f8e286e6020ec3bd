// Figures of many numbers: mean with its interval, quantiles, largest.
#pragma once

#include <cstddef>
#include <vector>

namespace packcell_programs {

class Sample {
public:
    void add(double value);

    size_t size() const { return values_.size(); }
    bool empty() const { return values_.empty(); }

    // All are 0 for an empty sample.
    double mean() const;
    double max() const;
    // Half the width of the mean's 95 % interval (normal approximation); 0 below two values.
    double half_width_95() const;
    // The smallest value that at least this share of the values does not exceed, 0..1.
    double quantile(double share) const;

private:
    std::vector<double> values_;
    double sum_ = 0;
};

}  // namespace packcell_programs
