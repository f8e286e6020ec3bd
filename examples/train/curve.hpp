// The training curve: one row every so many updates, as a CSV file and as a drawing (paper, Fig.
// 6).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace packcell_programs {

// Means over the updates since the row before. Utilisations are in per cent.
struct CurveRow {
    uint64_t updates = 0;  // all since the training began
    uint64_t steps = 0;
    uint64_t bins = 0;
    double policy_loss = 0;
    double value_loss = 0;
    double entropy = 0;
    double reward = 0;
    double utilization = 0;        // with the exploring policy
    double held_out = -1;          // of the policy so far; below 0: not measured
    double held_out_half = 0;      // half the width of its 95 % interval
    double held_out_turning = -1;  // the same with items that may be turned
    double held_out_turning_half = 0;
};

class Curve {
public:
    const std::vector<CurveRow> &rows() const { return rows_; }
    void add(const CurveRow &row) { rows_.push_back(row); }

    // Takes over a file's rows of up to so many updates. Throws Failure, naming file and line.
    void read_csv(const std::string &path, uint64_t updates);

    // Both replace the file as a whole. Throw Failure.
    void write_csv(const std::string &path) const;
    void write_svg(const std::string &path, const std::string &title) const;

private:
    std::vector<CurveRow> rows_;
};

}  // namespace packcell_programs
