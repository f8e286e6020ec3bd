// Instances (paper, Sec. V-A "Dataset"): random items, and 100 % sets after Algorithm 4.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/random.h"
#include "bin/bin.h"

namespace packcell {

struct GeneratorOptions {
    int w = 10;  // of the bin, 1..128
    int h = 10;
    double mean = 0.445;  // of an item's side, as a fraction of the bin's side; > 0, <= 1
    double sigma = 1.0;   // its standard deviation in cells; > 0, <= 128
    uint64_t seed = 1;
};

// Sets mean and sigma: "text" (0.5 and 2) is what the paper's text says, "table" (0.445 and 1) what
// its Table (b) agrees with. False, and nothing set, for other names.
bool set_generator_preset(GeneratorOptions &options, const char *preset);

// Equal options give equal items on every machine: draws are Random's integers, and the few
// floating-point numbers come from operations that IEEE 754 rounds exactly (no exp of libm), so
// that the integer weights made of them are the same everywhere.
class Generator {
public:
    // Throws on options out of range.
    explicit Generator(const GeneratorOptions &options);

    // The stream's next `count` items, sides uniform on 1..W/2 and 1..H/2 (at least 1). Ids count
    // on from 0, and start again there after 2^31 - 1.
    void random(std::vector<Item> &items, size_t count);

    // The next 100 % set, shuffled, ids from 0; at most W * H items.
    //
    // Algorithm 4 draws sizes until one passes its tests (lines 7 to 13). Here the size is drawn at
    // once from those that pass, with the same odds, so that no bin and no sigma makes it wait for
    // a rare size. Two cases in which the printed loop never ends go on like this:
    //  - No size meets w + h <= W + H - max_w - max_h any more (a 10 x 9 item in a 10 x 10 bin,
    //  say):
    //    the condition is dropped for the rest of the set.
    //  - Every size that passes has a weight of less than 2^-25 of the likeliest one's, and counts
    //  as
    //    0: of those that pass, the one nearest the mean is taken, ties at random. That is what the
    //    Gaussian's odds among them come to.
    void full_set(std::vector<Item> &items);

private:
    // GaussianProb(side, sigma) as integer weights of the sizes 1..side.
    struct Side {
        double mean;
        std::array<uint64_t, kMaxSide + 1> weight;
        std::array<uint64_t, kMaxSide + 1> up_to;  // sum of the weights of 1..i
    };

    // For each width the largest height that passes the tests, or 0. Where `weighted`, a width may
    // have 0 when all that it could have has no weight.
    using Heights = std::array<int, kMaxSide + 1>;

    static Side make_side(int side, double mean, double sigma);
    void passing(int most_sum, bool weighted, Heights &heights) const;
    Size draw_size(int most_sum);
    Size nearest_size(int most_sum);
    int draw_position(Size size);

    GeneratorOptions options_;
    Random random_;
    Side width_;
    Side height_;
    Bin bin_;
    std::vector<int> ties_;
    uint32_t next_id_ = 0;
};

}  // namespace packcell
