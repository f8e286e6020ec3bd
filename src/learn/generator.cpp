#include "learn/generator.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "base/status.h"

namespace packcell {

namespace {

// The weight of the likeliest size. The odds of a pair of sizes are a product of two weights; the
// sum over all pairs, at most (128 * 2^24)^2, fits into 64 bits.
constexpr double kWeight = 0x1p24;

// exp(-t), t >= 0, to far better than a weight's rounding. Not std::exp, which may differ in the
// last bit from one C library to another.
double exp_minus(double t) {
    if (!(t < 64.0)) return 0.0;
    int halved = 0;
    for (; t > 0.125; ++halved) t *= 0.5;
    double term = 1.0;
    double sum = 1.0;
    for (int i = 1; i <= 10; ++i) {
        term *= -t / i;
        sum += term;
    }
    for (; halved > 0; --halved) sum *= sum;
    return sum;
}

}  // namespace

bool set_generator_preset(GeneratorOptions &options, const char *preset) {
    if (std::strcmp(preset, "text") == 0) {
        options.mean = 0.5;
        options.sigma = 2.0;
    } else if (std::strcmp(preset, "table") == 0) {
        options.mean = 0.445;
        options.sigma = 1.0;
    } else {
        return false;
    }
    return true;
}

Generator::Side Generator::make_side(int side, double mean, double sigma) {
    Side s = {};
    s.mean = mean * side;
    double least = std::fabs(1.0 - s.mean);
    for (int i = 2; i <= side; ++i) least = std::min(least, std::fabs(i - s.mean));
    for (int i = 1; i <= side; ++i) {
        const double d = std::fabs(i - s.mean);
        // Relative to the likeliest size, so that it has full weight however small sigma is.
        const double excess = (d - least) * (d + least);
        const double p = excess > 0.0 ? exp_minus(excess / sigma / sigma * 0.5) : 1.0;
        const auto n = static_cast<size_t>(i);
        s.weight[n] = static_cast<uint64_t>(std::llround(p * kWeight));
        s.up_to[n] = s.up_to[n - 1] + s.weight[n];
    }
    return s;
}

namespace {

const GeneratorOptions &checked(const GeneratorOptions &o) {
    if (o.w < 1 || o.w > kMaxSide) fail(Status::kArgument, "w %d: must be 1..%d", o.w, kMaxSide);
    if (o.h < 1 || o.h > kMaxSide) fail(Status::kArgument, "h %d: must be 1..%d", o.h, kMaxSide);
    if (!(o.mean > 0.0 && o.mean <= 1.0)) {
        fail(Status::kArgument, "mean %g: must be above 0 and at most 1", o.mean);
    }
    if (!(o.sigma > 0.0 && o.sigma <= kMaxSide)) {
        fail(Status::kArgument, "sigma %g: must be above 0 and at most %d", o.sigma, kMaxSide);
    }
    return o;
}

}  // namespace

Generator::Generator(const GeneratorOptions &options)
    : options_(checked(options)),
      random_(options.seed),
      width_(make_side(options.w, options.mean, options.sigma)),
      height_(make_side(options.h, options.mean, options.sigma)),
      bin_(options.w, options.h) {}

void Generator::random(std::vector<Item> &items, size_t count) {
    const auto most_w = static_cast<uint64_t>(std::max(1, options_.w / 2));
    const auto most_h = static_cast<uint64_t>(std::max(1, options_.h / 2));
    items.clear();
    items.reserve(count);
    for (size_t i = 0; i < count; ++i) {
        const auto w = static_cast<int32_t>(1 + random_.below(most_w));
        const auto h = static_cast<int32_t>(1 + random_.below(most_h));
        items.push_back({static_cast<int32_t>(next_id_), w, h, 0});
        next_id_ = (next_id_ + 1) & static_cast<uint32_t>(INT32_MAX);
    }
}

void Generator::passing(int most_sum, bool weighted, Heights &heights) const {
    heights.fill(0);
    Positions positions;
    // A wider item never passes with a greater height, so the height only falls.
    int h = bin_.h();
    for (int w = 1; w <= bin_.w(); ++w) {
        if (weighted && width_.weight[static_cast<size_t>(w)] == 0) continue;
        h = std::min({h, most_sum - w, bin_.free_cells() / w});
        for (; h > 0; --h) {
            if (weighted && height_.up_to[static_cast<size_t>(h)] == 0) return;
            bin_.feasible({w, h}, positions);
            if (positions.any()) break;
        }
        if (h <= 0) return;
        heights[static_cast<size_t>(w)] = h;
    }
}

Size Generator::draw_size(int most_sum) {
    Heights heights;
    passing(most_sum, true, heights);
    uint64_t total = 0;
    for (size_t w = 1; w <= static_cast<size_t>(bin_.w()); ++w) {
        total += width_.weight[w] * height_.up_to[static_cast<size_t>(heights[w])];
    }
    if (total == 0) return nearest_size(most_sum);

    uint64_t v = random_.below(total);
    size_t w = 1;
    for (;; ++w) {
        const uint64_t odds = width_.weight[w] * height_.up_to[static_cast<size_t>(heights[w])];
        if (v < odds) break;
        v -= odds;
    }
    v /= width_.weight[w];
    size_t h = 1;
    while (v >= height_.up_to[h]) ++h;
    return {static_cast<int>(w), static_cast<int>(h)};
}

Size Generator::nearest_size(int most_sum) {
    Heights heights;
    passing(most_sum, false, heights);
    ties_.clear();
    double least = 0.0;
    for (int w = 1; w <= bin_.w(); ++w) {
        for (int h = 1; h <= heights[static_cast<size_t>(w)]; ++h) {
            const double across = w - width_.mean;
            const double down = h - height_.mean;
            const double distance = across * across + down * down;
            if (!ties_.empty() && distance > least) continue;
            if (distance < least) ties_.clear();
            least = distance;
            ties_.push_back(w + h * (kMaxSide + 1));
        }
    }
    const int pick = ties_[static_cast<size_t>(random_.below(ties_.size()))];
    return {pick % (kMaxSide + 1), pick / (kMaxSide + 1)};
}

int Generator::draw_position(Size size) {
    Positions positions;
    bin_.feasible(size, positions);
    ties_.clear();
    int most = 0;
    for (int y = 0; y < positions.count; ++y) {
        for (Row row = positions.rows[static_cast<size_t>(y)]; row != 0; row &= row - 1) {
            const int x = row_lowest(row);
            const int contact = bin_.contact({x, y, size.w, size.h});
            if (contact < most) continue;
            if (contact > most) ties_.clear();
            most = contact;
            ties_.push_back(x + y * bin_.w());
        }
    }
    return ties_[static_cast<size_t>(random_.below(ties_.size()))];
}

void Generator::full_set(std::vector<Item> &items) {
    items.clear();
    bin_.clear();
    int max_w = 0;
    int max_h = 0;
    const int sides = bin_.w() + bin_.h();
    while (bin_.occupied() < bin_.cells() - 1) {
        const int most_sum = sides - max_w - max_h;
        const Size size = draw_size(most_sum >= 2 ? most_sum : sides);
        const int at = draw_position(size);
        const Item item = {0, size.w, size.h, 0};
        bin_.place({item, at % bin_.w(), at / bin_.w(), 0});
        items.push_back(item);
        max_w = std::max(max_w, size.w);
        max_h = std::max(max_h, size.h);
    }
    if (!bin_.full()) items.push_back({0, 1, 1, 0});

    for (size_t i = items.size(); i > 1; --i) {
        std::swap(items[i - 1], items[static_cast<size_t>(random_.below(i))]);
    }
    for (size_t i = 0; i < items.size(); ++i) items[i].id = static_cast<int32_t>(i);
}

}  // namespace packcell
