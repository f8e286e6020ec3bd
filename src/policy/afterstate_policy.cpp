#include "policy/afterstate_policy.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "base/random.h"
#include "base/status.h"
#include "policy/contact.h"

namespace packcell {

namespace {

// Positions whose contact reward is further below the largest one are not looked at: less than a
// hundredth of a point is lost, and most of the time is saved.
constexpr int kContactMargin = 2;

// Positions that are looked ahead from: so many, with values so close to the highest.
constexpr int kMostLookAhead = 8;
constexpr float kLookAheadMargin = 2;

using Values = std::array<std::shared_ptr<const AfterstateValue>, 2>;  // rotation off, on

std::string tensor_name(bool rotation, const char *table) {
    return std::string(rotation ? "on/" : "off/") + table;
}

const AfterstateValue &value_for(const Values &values, bool rotation) {
    const auto &value = values[rotation ? 1 : 0];
    return value != nullptr ? *value : *values[rotation ? 0 : 1];
}

float whole_value(const Bin &bin, float further) {
    const auto occupied = static_cast<float>(bin.occupied());
    return std::clamp(occupied + further, occupied, static_cast<float>(bin.cells()));
}

struct Candidate {
    int x;
    int y;
    int contact;
    float value;
};

struct Candidates {
    std::array<Candidate, kMaxSide> all;  // a bin that FreeCells holds has no more cells
    int count = 0;

    Candidate *begin() { return all.data(); }
    Candidate *end() { return all.data() + count; }
};

// The values of the bins that rectangles leave behind.
class Afterstates {
public:
    // Remembers as many values as there are places, a power of two, or none: items that are packed
    // in another order often leave the same bin.
    Afterstates(const AfterstateValue &value, size_t places) : value_(value), known_(places) {}

    float operator()(const FreeCells &free) {
        if (known_.empty()) return value_(free);
        Known &known = place_of(free);
        if (known.cells != free.cells || !known.set) known = {free.cells, value_(free), true};
        return known.value;
    }

    // Of the candidates for a rectangle of this size.
    void judge(const FreeCells &free, Size size, Candidates &candidates);

private:
    // So many sums are added up side by side, each in its own order: one alone would wait for its
    // last addition all the time.
    static constexpr int kLanes = 4;

    struct Known {
        Row cells = 0;
        float value = 0;
        bool set = false;
    };
    struct Lane {
        Candidate *candidate;
        Known *known;  // where it is remembered, or null
        Row cells;
        std::array<float, AfterstateFeatures::kMostCount> read;  // what its features name
    };
    using Lanes = std::array<Lane, kLanes>;

    Known &place_of(const FreeCells &free) {
        const auto low = static_cast<uint64_t>(free.cells);
        const auto high = static_cast<uint64_t>(free.cells >> 64);
        return known_[mix64(low ^ mix64(high)) & (known_.size() - 1)];
    }
    void add_up(const Lanes &lanes, int used) const;

    const AfterstateValue &value_;
    std::vector<Known> known_;
};

void Afterstates::judge(const FreeCells &free, Size size, Candidates &candidates) {
    const AfterstateFeatures &features = value_.features();
    Lanes lanes;
    int used = 0;
    const float *entries = value_.entries().data();
    std::array<float, AfterstateFeatures::kMostCount> before;
    bool read = false;
    for (Candidate &c : candidates) {
        const Rect taken{c.x, c.y, size.w, size.h};
        FreeCells after = free;
        after.take(taken);
        Known *known = known_.empty() ? nullptr : &place_of(after);
        if (known != nullptr && known->set && known->cells == after.cells) {
            c.value = known->value;
            continue;
        }
        if (!read) features.read(free, {0, 0, free.w, free.h}, entries, before.data());
        read = true;
        Lane &lane = lanes[static_cast<size_t>(used++)];
        lane.candidate = &c;
        lane.known = known;
        lane.cells = after.cells;
        std::copy_n(before.begin(), features.count(), lane.read.begin());
        features.read(after, taken, entries, lane.read.data());
        if (used < kLanes) continue;
        add_up(lanes, used);
        used = 0;
    }
    add_up(lanes, used);
}

void Afterstates::add_up(const Lanes &lanes, int used) const {
    if (used == 0) return;
    const auto lane = [&](int i) {
        return lanes[static_cast<size_t>(i < used ? i : 0)].read.data();
    };
    const float *lane0 = lane(0), *lane1 = lane(1), *lane2 = lane(2), *lane3 = lane(3);
    float sum0 = 0, sum1 = 0, sum2 = 0, sum3 = 0;
    for (int f = 0; f < value_.features().count(); ++f) {
        sum0 += lane0[f];
        sum1 += lane1[f];
        sum2 += lane2[f];
        sum3 += lane3[f];
    }
    const std::array<float, kLanes> sums{sum0, sum1, sum2, sum3};
    for (int i = 0; i < used; ++i) {
        const Lane &done = lanes[static_cast<size_t>(i)];
        done.candidate->value = sums[static_cast<size_t>(i)];
        if (done.known != nullptr) {
            *done.known = {done.cells, sums[static_cast<size_t>(i)], true};
        }
    }
}

// The positions of a size that are worth a look, row by row, with the values of what they leave.
void list_candidates(Afterstates &values, const Bin &bin, const FreeCells &free, Size size,
                     Candidates &out) {
    Positions positions;
    bin.feasible(size, positions);
    int most_contact = 0;
    for (int y = 0; y < positions.count; ++y) {
        auto row = static_cast<uint64_t>(positions.rows[static_cast<size_t>(y)]);
        for (; row != 0; row &= row - 1) {
            const int x = row_lowest(row);
            const int contact = bin.contact({x, y, size.w, size.h});
            most_contact = std::max(most_contact, contact);
            out.all[static_cast<size_t>(out.count++)] = {x, y, contact, 0};
        }
    }
    const auto too_loose = [&](const Candidate &c) {
        return c.contact < most_contact - kContactMargin;
    };
    out.count = static_cast<int>(std::remove_if(out.begin(), out.end(), too_loose) - out.begin());
    values.judge(free, size, out);
}

int best_position(Afterstates &values, const Bin &bin, const FreeCells &free, Size size,
                  float *out_value) {
    Candidates candidates;
    list_candidates(values, bin, free, size, candidates);
    const Candidate *best = nullptr;
    for (const Candidate &c : candidates) {
        if (best == nullptr || c.value > best->value) best = &c;
    }
    if (best == nullptr) return bin.cells();
    *out_value = best->value;
    return best->x + best->y * bin.w();
}

void evaluate_positions(const AfterstateValue &value, const Bin &bin, Size size, Evaluation &out) {
    constexpr float kInfeasible = -1e8f;
    const auto cells = static_cast<size_t>(bin.cells());
    out.logits.assign(cells + 1, kInfeasible);
    out.probabilities.assign(cells + 1, 0.0f);
    const FreeCells free(bin);
    Positions positions;
    bin.feasible(size, positions);
    float best = kInfeasible;
    for (int y = 0; y < positions.count; ++y) {
        for (Row row = positions.rows[static_cast<size_t>(y)]; row != 0; row &= row - 1) {
            const int x = row_lowest(row);
            FreeCells after = free;
            after.take({x, y, size.w, size.h});
            float &logit = out.logits[static_cast<size_t>(x + y * bin.w())];
            logit = static_cast<float>(bin.cells() - after.count) + value(after);
            best = std::max(best, logit);
        }
    }
    if (best == kInfeasible) {
        out.value = static_cast<float>(bin.occupied());
        out.logits[cells] = 0;
        out.probabilities[cells] = 1;
        return;
    }
    out.value = best;
    float sum = 0;
    for (size_t i = 0; i < cells; ++i) sum += std::exp(out.logits[i] - best);
    for (size_t i = 0; i < cells; ++i) out.probabilities[i] = std::exp(out.logits[i] - best) / sum;
}

// For one thread: remembers what it answered.
class AfterstateSession : public Policy {
public:
    AfterstateSession(std::string name, std::shared_ptr<const AfterstateValue> value)
        : name_(std::move(name)),
          value_(std::move(value)),
          afterstates_(*value_, kAfterstates),
          next_(value_->features().shape().bin_w, value_->features().shape().bin_h, kMaxSide),
          positions_(kPlaces),
          values_(kPlaces) {}

    int select(const Bin &bin, Size size) const override {
        return select(bin, size, Effort::kUsual);
    }

    int select(const Bin &bin, Size size, Effort effort) const override {
        if (effort == Effort::kLow) return contact_.select(bin, size);
        const auto question = static_cast<uint64_t>(size.w * 256 + size.h) * 2;
        const uint64_t key = bin.hash() ^ mix64(question + (effort == Effort::kHigh ? 1 : 0));
        Known<int> &known = positions_[key % kPlaces];
        if (known.key != key || !known.set) {
            float value = 0;
            const int position =
                effort == Effort::kHigh
                    ? look_ahead(bin, size)
                    : best_position(afterstates_, bin, FreeCells(bin), size, &value);
            known = {key, true, position};
        }
        return known.answer;
    }

    float value(const Bin &bin, Effort effort) const override {
        const uint64_t key = bin.hash() ^ (effort == Effort::kHigh ? mix64(1) : 0);
        Known<float> &known = values_[key % kPlaces];
        if (known.key != key || !known.set) {
            const FreeCells free(bin);
            const float further =
                effort == Effort::kHigh ? expected(bin, free) : afterstates_(free);
            known = {key, true, whole_value(bin, further)};
        }
        return known.answer;
    }

    void evaluate(const Bin &bin, Size size, Evaluation &out) const override {
        evaluate_positions(*value_, bin, size, out);
    }

    bool has_value(const Bin &) const override { return true; }
    const char *name() const override { return name_.c_str(); }

private:
    static constexpr size_t kPlaces = 1 << 12;
    static constexpr size_t kAfterstates = 1 << 13;

    template <class T>
    struct Known {
        uint64_t key = 0;
        bool set = false;
        T answer{};
    };

    int look_ahead(const Bin &bin, Size size) const;
    float expected(const Bin &bin, const FreeCells &free) const;

    std::string name_;
    std::shared_ptr<const AfterstateValue> value_;
    mutable Afterstates afterstates_;
    ContactPolicy contact_;
    mutable Bin next_;  // a bin that is thought of
    mutable std::vector<Known<int>> positions_;
    mutable std::vector<Known<float>> values_;
};

// The cells still to be taken, by what the best places of all items that may arrive next leave
// behind: one exact step ahead of the value itself.
float AfterstateSession::expected(const Bin &bin, const FreeCells &free) const {
    const AfterstateShape &shape = value_->features().shape();
    const float here = value_->misfit_keeps() > 0 ? afterstates_(free) * value_->misfit_keeps() : 0;
    float sum = 0;
    for (int w = 1; w <= shape.most_side; ++w) {
        for (int h = shape.rotation ? w : 1; h <= shape.most_side; ++h) {
            const float weight = shape.rotation && w != h ? 2 : 1;
            float best = here;
            bool fits = false;
            for (int turned = 0; turned < (weight > 1 ? 2 : 1); ++turned) {
                const Size size = turned == 0 ? Size{w, h} : Size{h, w};
                float after = 0;
                if (best_position(afterstates_, bin, free, size, &after) == bin.cells()) continue;
                after += static_cast<float>(w * h);
                if (!fits || after > best) best = after;
                fits = true;
            }
            sum += weight * best;
        }
    }
    return sum / static_cast<float>(shape.most_side * shape.most_side);
}

// Of the positions whose values are highest, the one to be expected most of.
int AfterstateSession::look_ahead(const Bin &bin, Size size) const {
    Candidates candidates;
    const FreeCells free(bin);
    list_candidates(afterstates_, bin, free, size, candidates);
    std::sort(candidates.begin(), candidates.end(), [](const Candidate &a, const Candidate &b) {
        if (a.value != b.value) return a.value > b.value;
        return a.y != b.y ? a.y < b.y : a.x < b.x;
    });
    int best = bin.cells();
    float best_expected = 0;
    next_.assign(bin);
    for (int i = 0; i < std::min(candidates.count, kMostLookAhead); ++i) {
        const Candidate &c = candidates.all[static_cast<size_t>(i)];
        if (c.value < candidates.all[0].value - kLookAheadMargin) break;
        FreeCells after = free;
        after.take({c.x, c.y, size.w, size.h});
        next_.place({{0, size.w, size.h, 0}, c.x, c.y, 0});
        const float e = expected(next_, after);
        next_.undo_place();
        if (best < bin.cells() && e <= best_expected) continue;
        best = c.x + c.y * bin.w();
        best_expected = e;
    }
    return best;
}

class AfterstatePolicy : public LearnedPolicy {
public:
    AfterstatePolicy(Weights weights, Values values)
        : LearnedPolicy(std::move(weights)), values_(std::move(values)) {}

    int select(const Bin &bin, Size size) const override {
        float value = 0;
        return best_afterstate(value_for(values_, true), bin, FreeCells(bin), size, &value);
    }

    void evaluate(const Bin &bin, Size size, Evaluation &out) const override {
        evaluate_positions(value_for(values_, true), bin, size, out);
    }

    bool has_value(const Bin &) const override { return true; }

    float value(const Bin &bin, Effort) const override {
        return whole_value(bin, value_for(values_, true)(FreeCells(bin)));
    }

    std::unique_ptr<const Policy> session(const SessionOptions &options) const override {
        const bool wanted = options.rotation;
        const auto &value = values_[wanted ? 1 : 0];
        return std::make_unique<const AfterstateSession>(
            name(), value != nullptr ? value : values_[wanted ? 0 : 1]);
    }

private:
    Values values_;
};

// Null when there are no tables for this setting.
std::shared_ptr<const AfterstateValue> read_value(const Weights &weights, bool rotation) {
    const std::string counts = tensor_name(rotation, "counts");
    const auto found = std::find_if(weights.tensors.begin(), weights.tensors.end(),
                                    [&](const Tensor &t) { return t.name == counts; });
    if (found == weights.tensors.end()) return nullptr;
    const uint32_t most_side = found->shape[0];
    if (most_side < 1 || most_side > AfterstateFeatures::kMostItemSide) {
        fail(Status::kFormat, "tensor '%s': %u item sides: must be 1..%d", counts.c_str(),
             most_side, AfterstateFeatures::kMostItemSide);
    }
    const std::string misfit = tensor_name(rotation, "misfit");
    const float misfit_keeps = weights.tensor(misfit.c_str(), {1}).data[0];
    if (!(misfit_keeps >= 0 && misfit_keeps <= 1)) {
        fail(Status::kFormat, "tensor '%s': %g: must be 0..1", misfit.c_str(),
             static_cast<double>(misfit_keeps));
    }
    const AfterstateShape shape{weights.bin_w, weights.bin_h, static_cast<int>(most_side),
                                rotation};
    auto value = std::make_shared<AfterstateValue>(shape, misfit_keeps);
    for (const AfterstateFeatures::Table &table : value->features().tables()) {
        const Tensor &tensor =
            weights.tensor(tensor_name(rotation, table.name).c_str(), table.shape);
        std::copy(tensor.data.begin(), tensor.data.end(),
                  value->entries().begin() + static_cast<std::ptrdiff_t>(table.offset));
    }
    return value;
}

}  // namespace

int best_afterstate(const AfterstateValue &value, const Bin &bin, const FreeCells &free, Size size,
                    float *out_value) {
    Afterstates values(value, 0);
    return best_position(values, bin, free, size, out_value);
}

void append_tensors(const AfterstateValue &value, std::vector<Tensor> &tensors) {
    const AfterstateFeatures &features = value.features();
    for (const AfterstateFeatures::Table &table : features.tables()) {
        Tensor tensor;
        tensor.name = tensor_name(features.shape().rotation, table.name);
        tensor.stored = Stored::kInt16;
        tensor.shape = table.shape;
        const auto begin = value.entries().begin() + static_cast<std::ptrdiff_t>(table.offset);
        tensor.data.assign(begin, begin + static_cast<std::ptrdiff_t>(table.size));
        tensors.push_back(std::move(tensor));
    }
    tensors.push_back({tensor_name(features.shape().rotation, "misfit"),
                       Stored::kFloat32,
                       {1},
                       {value.misfit_keeps()}});
}

std::shared_ptr<const Policy> make_afterstate_policy(Weights weights) {
    if (!FreeCells::holds(weights.bin_w, weights.bin_h)) {
        fail(Status::kFormat,
             "policy '%s': bin %dx%d: an afterstate policy needs sides 2..%d, (w + 1) h <= %d",
             weights.name.c_str(), weights.bin_w, weights.bin_h, FreeCells::kMostSide, kMaxSide);
    }
    Values values{read_value(weights, false), read_value(weights, true)};
    if (values[0] == nullptr && values[1] == nullptr) {
        fail(Status::kFormat, "policy '%s': there is neither a tensor 'off/counts' nor 'on/counts'",
             weights.name.c_str());
    }
    return std::make_shared<const AfterstatePolicy>(std::move(weights), std::move(values));
}

}  // namespace packcell
