#include "policy/network_kernels.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>

// A function for wider vectors than the build's must have all that it calls compiled into it, and
// sums must stay in registers, of which only loops without a branch can make use.
#define PACKCELL_INLINE [[gnu::always_inline]] inline
#if defined(__clang__)
#define PACKCELL_UNROLL _Pragma("clang loop unroll(full)")
#else
#define PACKCELL_UNROLL _Pragma("GCC unroll 16")
#endif

namespace packcell {

namespace {

template <int Lanes>
struct Vector {
    using Type
        [[gnu::vector_size(Lanes * sizeof(float)), gnu::aligned(alignof(float)), gnu::may_alias]] =
            float;
};
template <>
struct Vector<1> {
    using Type = float;
};

// ---- Products ----------------------------------------------------------------------------------

// Inputs taken together: their rows of the weights stay in the first cache while all samples are
// gone through.
constexpr int kTile = 32;

// The inputs of a tile that are not 0.
struct Active {
    int index[kTile];
    int count = 0;
};

PACKCELL_INLINE void find_active(const float *in, int inputs, Active &active) {
    int count = 0;
    for (int i = 0; i < inputs; ++i) {
        // As a number the comparison would have to mind NaN; -0 may count as active.
        uint32_t bits = 0;
        std::memcpy(&bits, in + i, sizeof bits);
        active.index[count] = i;
        count += bits != 0 ? 1 : 0;
    }
    active.count = count;
}

template <int Lanes, int Vectors>
PACKCELL_INLINE void add_rows(const float *weight, int outputs, const float *in,
                              const Active &active, float *out) {
    using V = typename Vector<Lanes>::Type;
    V sum[Vectors];
    V *sums = reinterpret_cast<V *>(out);
    PACKCELL_UNROLL
    for (int v = 0; v < Vectors; ++v) sum[v] = sums[v];
    for (int k = 0; k < active.count; ++k) {
        const int i = active.index[k];
        const float x = in[i];
        const V *row = reinterpret_cast<const V *>(weight + i * outputs);
        PACKCELL_UNROLL
        for (int v = 0; v < Vectors; ++v) sum[v] += x * row[v];
    }
    PACKCELL_UNROLL
    for (int v = 0; v < Vectors; ++v) sums[v] = sum[v];
}

// As many sums at once as there are registers, for a sum waits for the one before it.
template <int Lanes>
PACKCELL_INLINE void add_tile(const float *weight, int outputs, const float *in,
                              const Active &active, float *out) {
    int from = 0;
    for (; from + 8 * Lanes <= outputs; from += 8 * Lanes) {
        add_rows<Lanes, 8>(weight + from, outputs, in, active, out + from);
    }
    for (; from + 4 * Lanes <= outputs; from += 4 * Lanes) {
        add_rows<Lanes, 4>(weight + from, outputs, in, active, out + from);
    }
    for (; from + 4 <= outputs; from += 4) {
        add_rows<4, 1>(weight + from, outputs, in, active, out + from);
    }
    for (; from < outputs; ++from) {
        add_rows<1, 1>(weight + from, outputs, in, active, out + from);
    }
}

template <int Lanes>
PACKCELL_INLINE void add_all_products(const float *weight, int inputs, int outputs, const float *in,
                                      float *out, int samples) {
    Active active;
    for (int first = 0; first < inputs; first += kTile) {
        const float *tile = weight + first * outputs;
        for (int k = 0; k < samples; ++k) {
            const float *x = in + k * inputs + first;
            find_active(x, std::min(kTile, inputs - first), active);
            add_tile<Lanes>(tile, outputs, x, active, out + k * outputs);
        }
    }
}

// ---- The convolution of cells two apart --------------------------------------------------------

// So many neighbours in a row share each weight that is read.
constexpr int kCells = 5;

// Some channels of some neighbouring cells from (x, y) on; `weight`, `bias` and `out` begin at the
// first of those channels.
template <int Lanes, int Vectors, int Cells>
PACKCELL_INLINE void convolve_cells(const WideConvolution &c, const float *weight,
                                    const float *bias, int x, int y, const float *in, float *out) {
    using V = typename Vector<Lanes>::Type;
    V sum[Cells][Vectors];
    PACKCELL_UNROLL
    for (int k = 0; k < Cells; ++k) {
        PACKCELL_UNROLL
        for (int v = 0; v < Vectors; ++v) sum[k][v] = reinterpret_cast<const V *>(bias)[v];
    }
    const int in_row = (c.w + 2 * kWideMargin) * c.channels;
    for (int ky = 0; ky < 3; ++ky) {
        const int ty = y + (ky - 1) * 2;
        if (ty < 0 || ty >= c.h) continue;
        for (int kx = 0; kx < 3; ++kx) {
            const float *cells = in + ty * in_row + (x + kx * 2) * c.channels;
            const float *row = weight + (ky * 3 + kx) * c.channels * c.channels;
            for (int i = 0; i < c.channels; ++i, row += c.channels) {
                V factor[Vectors];
                PACKCELL_UNROLL
                for (int v = 0; v < Vectors; ++v) factor[v] = reinterpret_cast<const V *>(row)[v];
                PACKCELL_UNROLL
                for (int k = 0; k < Cells; ++k) {
                    const float value = cells[k * c.channels + i];
                    PACKCELL_UNROLL
                    for (int v = 0; v < Vectors; ++v) sum[k][v] += value * factor[v];
                }
            }
        }
    }
    const V zero = {};
    PACKCELL_UNROLL
    for (int k = 0; k < Cells; ++k) {
        V *to = reinterpret_cast<V *>(out + y * c.out_row + (x + k) * c.channels);
        PACKCELL_UNROLL
        for (int v = 0; v < Vectors; ++v) to[v] = sum[k][v] > zero ? sum[k][v] : zero;
    }
}

// Channels from `from` on, of all cells. A row's last cells are reckoned twice where kCells does
// not divide it.
template <int Lanes, int Vectors>
PACKCELL_INLINE void convolve_channels(const WideConvolution &c, int from, const float *in,
                                       float *out) {
    const float *weight = c.weight + from;
    const float *bias = c.bias + from;
    for (int y = 0; y < c.h; ++y) {
        if (c.w >= kCells) {
            for (int x = 0; x < c.w; x += kCells) {
                convolve_cells<Lanes, Vectors, kCells>(c, weight, bias, std::min(x, c.w - kCells),
                                                       y, in, out + from);
            }
        } else {
            for (int x = 0; x < c.w; ++x) {
                convolve_cells<Lanes, Vectors, 1>(c, weight, bias, x, y, in, out + from);
            }
        }
    }
}

template <int Lanes>
PACKCELL_INLINE void convolve_all(const WideConvolution &c, const float *in, float *out) {
    int from = 0;
    for (; from + 2 * Lanes <= c.channels; from += 2 * Lanes) {
        convolve_channels<Lanes, 2>(c, from, in, out);
    }
    for (; from + 4 <= c.channels; from += 4) convolve_channels<4, 1>(c, from, in, out);
    for (; from < c.channels; ++from) convolve_channels<1, 1>(c, from, in, out);
}

// ---- One set for each width --------------------------------------------------------------------

void add_products_usual(const float *weight, int inputs, int outputs, const float *in, float *out,
                        int samples) {
    add_all_products<4>(weight, inputs, outputs, in, out, samples);
}

void convolve_wide_usual(const WideConvolution &convolution, const float *in, float *out) {
    convolve_all<4>(convolution, in, out);
}

constexpr NetworkKernels kUsualKernels = {add_products_usual, convolve_wide_usual};

#if defined(__x86_64__)

[[gnu::target("avx")]] void add_products_avx(const float *weight, int inputs, int outputs,
                                             const float *in, float *out, int samples) {
    add_all_products<8>(weight, inputs, outputs, in, out, samples);
}

[[gnu::target("avx")]] void convolve_wide_avx(const WideConvolution &convolution, const float *in,
                                              float *out) {
    convolve_all<8>(convolution, in, out);
}

constexpr NetworkKernels kAvxKernels = {add_products_avx, convolve_wide_avx};

bool has_avx() { return __builtin_cpu_supports("avx") != 0; }

#else

constexpr NetworkKernels kAvxKernels = kUsualKernels;

bool has_avx() { return false; }

#endif

}  // namespace

const NetworkKernels &network_kernels(VectorWidth width) {
    return width == VectorWidth::kAvx && has_avx() ? kAvxKernels : kUsualKernels;
}

const NetworkKernels &network_kernels() {
    static const NetworkKernels &widest = network_kernels(VectorWidth::kAvx);
    return widest;
}

}  // namespace packcell
