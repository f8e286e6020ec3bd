// The network's first two convolutions as sums of table entries. A map of free and taken cells has
// only 512 different 3x3 windows, "patterns": the first convolution's output at a cell is one of
// 512 vectors, and the second one's is a sum of nine, each from the table of one kernel cell. This
// is the same function, with a few additions in the place of hundreds of products.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "bin/bin.h"

namespace packcell {

constexpr int kPatterns = 512;
constexpr int kTaps = 9;

// The pattern of each cell, w * h of them: bit ky * 3 + kx is the cell (x + kx - 1, y + ky - 1),
// and cells outside are walls (the padded map B).
inline void find_patterns(const Row *rows, int w, int h, uint16_t *out) {
    const auto window = [&](int y, int x) -> unsigned {
        if (y < 0 || y >= h) return 7;
        const Row row = rows[y];
        const Row shifted = x == 0 ? (row << 1) | kRowOne : row >> (x - 1);
        return (static_cast<unsigned>(shifted) & 7u) | (x == w - 1 ? 4u : 0u);
    };
    for (int x = 0; x < w; ++x) {
        unsigned pattern = window(-1, x) << 3 | window(0, x) << 6;
        for (int y = 0; y < h; ++y) {
            pattern = pattern >> 3 | window(y + 1, x) << 6;
            out[y * w + x] = static_cast<uint16_t>(pattern);
        }
    }
}

inline void find_patterns(const Bin &bin, uint16_t *out) {
    Row rows[kMaxSide];
    for (int y = 0; y < bin.h(); ++y) rows[y] = bin.row(y);
    find_patterns(rows, bin.w(), bin.h(), out);
}

template <class Scalar>
class PatternTables {
public:
    using Matrix = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

    // Kernels as {3, 3, in, channels}.
    void build(int channels, const Scalar *weight1, const Scalar *bias1, const Scalar *weight2,
               const Scalar *bias2) {
        channels_ = channels;
        bias_.assign(bias2, bias2 + channels);
        first_.resize(kPatterns, channels);
        using Vector = Eigen::Map<const Eigen::Matrix<Scalar, 1, Eigen::Dynamic>>;
        for (int p = 0; p < kPatterns; ++p) {
            first_.row(p) = Vector(bias1, channels);
            for (int tap = 0; tap < kTaps; ++tap) {
                if ((p >> tap & 1) != 0) {
                    first_.row(p) += Vector(weight1 + tap * channels, channels);
                }
            }
        }
        first_ = first_.cwiseMax(Scalar(0));
        second_.resize(kTaps * kPatterns, channels);
        for (int tap = 0; tap < kTaps; ++tap) {
            second_.middleRows(tap * kPatterns, kPatterns).noalias() =
                first_ *
                Eigen::Map<const Matrix>(weight2 + tap * channels * channels, channels, channels);
        }
    }

    // The first convolution's output for each pattern.
    const Matrix &first() const { return first_; }

    // The second one's output after ReLU, row by row, `channels` numbers a cell: of the cells that
    // are `margin` (0 or 1) away from the walls; what a kernel has outside counts 0.
    void convolve(const uint16_t *patterns, int w, int h, int margin, Scalar *out) const {
        if (channels_ == 16) {
            run<16>(patterns, w, h, margin, out);
        } else if (channels_ == 32) {
            run<32>(patterns, w, h, margin, out);
        } else {
            run<Eigen::Dynamic>(patterns, w, h, margin, out);
        }
    }

private:
    template <int Channels>
    void run(const uint16_t *patterns, int w, int h, int margin, Scalar *out) const {
        using Vector = Eigen::Array<Scalar, Channels, 1>;
        using Map = Eigen::Map<const Vector>;
        const auto entry = [&](int tap, int cell) {
            return Map(second_.data() + (tap * kPatterns + patterns[cell]) * channels_, channels_);
        };
        const Map bias(bias_.data(), channels_);
        for (int y = margin; y < h - margin; ++y) {
            for (int x = margin; x < w - margin; ++x, out += channels_) {
                Eigen::Map<Vector> result(out, channels_);
                if (x > 0 && x < w - 1 && y > 0 && y < h - 1) {
                    const int cell = y * w + x;
                    result = (bias + entry(0, cell - w - 1) + entry(1, cell - w) +
                              entry(2, cell - w + 1) + entry(3, cell - 1) + entry(4, cell) +
                              entry(5, cell + 1) + entry(6, cell + w - 1) + entry(7, cell + w) +
                              entry(8, cell + w + 1))
                                 .max(Scalar(0));
                    continue;
                }
                result = bias;
                for (int tap = 0; tap < kTaps; ++tap) {
                    const int tx = x + tap % 3 - 1;
                    const int ty = y + tap / 3 - 1;
                    if (tx >= 0 && tx < w && ty >= 0 && ty < h) result += entry(tap, ty * w + tx);
                }
                result = result.max(Scalar(0));
            }
        }
    }

    int channels_ = 0;
    std::vector<Scalar> bias_;
    Matrix first_;
    Matrix second_;
};

}  // namespace packcell
