#include "policy/afterstate_features.h"

#include <algorithm>

namespace packcell {

namespace {

constexpr int kWindow = 4;  // a window shows 4 x 4 cells
constexpr int kWindowPatterns = 1 << (kWindow * kWindow);
constexpr int kWindowClasses = 8548;  // of patterns that no turn or mirror makes equal
constexpr int kRings = 5;             // distances to the nearest wall that are told apart
constexpr int kCountSteps = 64;

// How many placements are left: exactly up to 24, by fours beyond.
int count_step(int count) {
    constexpr int kExact = 24;
    return count < kExact ? count : std::min(kExact + (count - kExact) / 4, kCountSteps - 1);
}

uint32_t image(uint32_t pattern, int symmetry) {
    uint32_t result = 0;
    for (int y = 0; y < kWindow; ++y) {
        for (int x = 0; x < kWindow; ++x) {
            if ((pattern >> (y * kWindow + x) & 1) == 0) continue;
            int to_x = (symmetry & 1) != 0 ? kWindow - 1 - x : x;
            int to_y = (symmetry & 2) != 0 ? kWindow - 1 - y : y;
            if ((symmetry & 4) != 0) std::swap(to_x, to_y);
            result |= 1u << (to_y * kWindow + to_x);
        }
    }
    return result;
}

// Classes are numbered by their smallest pattern.
std::vector<uint16_t> window_classes() {
    std::vector<uint16_t> classes(kWindowPatterns);
    uint16_t next = 0;
    for (uint32_t pattern = 0; pattern < kWindowPatterns; ++pattern) {
        uint32_t smallest = pattern;
        for (int s = 1; s < 8; ++s) smallest = std::min(smallest, image(pattern, s));
        classes[pattern] = smallest == pattern ? next++ : classes[smallest];
    }
    return classes;
}

std::vector<uint16_t> mirror_classes(int bits) {
    std::vector<uint16_t> classes(size_t{1} << bits);
    for (uint32_t pattern = 0; pattern < classes.size(); ++pattern) {
        uint32_t mirrored = 0;
        for (int b = 0; b < bits; ++b) {
            if ((pattern >> b & 1) != 0) mirrored |= 1u << (bits - 1 - b);
        }
        classes[pattern] = static_cast<uint16_t>(std::min(pattern, mirrored));
    }
    return classes;
}

// To the right by 1..63 bits: less work than any number of bits.
Row shifted(Row row, int by) {
    const auto low = static_cast<uint64_t>(row);
    const auto high = static_cast<uint64_t>(row >> 64);
    return Row{high >> by} << 64 | (low >> by | high << (64 - by));
}

uint32_t unsigned_of(int value) { return static_cast<uint32_t>(value); }

}  // namespace

bool FreeCells::holds(int w, int h) {
    return w >= 2 && h >= 2 && w <= kMostSide && h <= kMostSide && (w + 1) * h <= kMaxSide;
}

FreeCells::FreeCells(const Bin &bin) : w(bin.w()), h(bin.h()), count(bin.free_cells()), cells(0) {
    const auto row_mask = static_cast<uint16_t>((1u << w) - 1);
    const auto column_mask = static_cast<uint16_t>((1u << h) - 1);
    for (int y = 0; y < h; ++y) {
        const auto row = static_cast<uint16_t>(~static_cast<uint16_t>(bin.row(y)) & row_mask);
        rows[static_cast<size_t>(y)] = row;
        cells |= Row{row} << (y * (w + 1));
    }
    for (int x = 0; x < w; ++x) {
        columns[static_cast<size_t>(x)] =
            static_cast<uint16_t>(~static_cast<uint16_t>(bin.column(x)) & column_mask);
    }
}

void FreeCells::take(const Rect &r) {
    const auto across = static_cast<uint16_t>(((1u << r.w) - 1) << r.x);
    const auto down = static_cast<uint16_t>(((1u << r.h) - 1) << r.y);
    for (int y = r.y; y < r.y + r.h; ++y) {
        auto &row = rows[static_cast<size_t>(y)];
        row = static_cast<uint16_t>(row & ~across);
        cells &= ~(Row{across} << (y * (w + 1)));
    }
    for (int x = r.x; x < r.x + r.w; ++x) {
        auto &column = columns[static_cast<size_t>(x)];
        column = static_cast<uint16_t>(column & ~down);
    }
    count -= r.w * r.h;
}

AfterstateFeatures::AfterstateFeatures(const AfterstateShape &shape)
    : shape_(shape),
      window_class_(window_classes()),
      row_class_(mirror_classes(shape.bin_w)),
      column_class_(mirror_classes(shape.bin_h)) {
    const int m = shape.most_side;
    for (auto &row : paths_) row.fill(0);
    for (int j = 0; j <= m; ++j) paths_[static_cast<size_t>(m)][static_cast<size_t>(j)] = 1;
    for (int i = m; i-- > 0;) {
        uint32_t sum = 0;
        for (int j = 0; j <= m; ++j) {
            sum += paths_[static_cast<size_t>(i) + 1][static_cast<size_t>(j)];
            paths_[static_cast<size_t>(i)][static_cast<size_t>(j)] = sum;
        }
    }
    const uint32_t staircases = paths_[0][static_cast<size_t>(m)];
    const auto sides = unsigned_of(m);
    windows_ = add_table("windows", {kRings, kWindowClasses});
    rows_ = add_table("rows", {sides, kRings, 1u << shape.bin_w});
    columns_ = shape.square() ? rows_ : add_table("columns", {sides, kRings, 1u << shape.bin_h});
    counts_ = add_table("counts", {sides, sides, kCountSteps});
    fits_ = add_table("fits", {staircases, unsigned_of(shape.bin_w * shape.bin_h + 1)});
    count_ = count_features();
}

int AfterstateFeatures::count_features() const {
    const int m = shape_.most_side;
    const auto runs = [m](int lines) {
        int n = 0;
        for (int k = 1; k <= std::min(m, lines); ++k) n += lines + 1 - k;
        return n;
    };
    const int windows = (shape_.bin_w + 3 - kWindow) * (shape_.bin_h + 3 - kWindow);
    const int sizes = shape_.rotation ? m * (m + 1) / 2 : m * m;
    return windows + runs(shape_.bin_h) + runs(shape_.bin_w) + sizes + 1;
}

uint32_t AfterstateFeatures::add_table(const char *name, std::vector<uint32_t> shape) {
    uint32_t entries = 1;
    for (uint32_t n : shape) entries *= n;
    const uint32_t offset = size_;
    tables_.push_back({name, std::move(shape), offset, entries});
    size_ += entries;
    return offset;
}

// Every window of the bin with a wall of one cell around it, row by row.
template <class Put>
int AfterstateFeatures::visit_windows(const FreeCells &free, const Rect &changed,
                                      const Put &put) const {
    std::array<uint32_t, FreeCells::kMostSide + 2> padded;
    padded[0] = 0;
    for (int y = 0; y < free.h; ++y) {
        padded[static_cast<size_t>(y) + 1] = unsigned_of(free.rows[static_cast<size_t>(y)]) << 1;
    }
    padded[static_cast<size_t>(free.h) + 1] = 0;
    const int last_x = free.w + 2 - kWindow;
    const int last_y = free.h + 2 - kWindow;
    const int first_y = std::max(0, changed.y + 2 - kWindow);
    const int end_y = std::min(last_y, changed.y + changed.h);
    for (int x = std::max(0, changed.x + 2 - kWindow); x <= std::min(last_x, changed.x + changed.w);
         ++x) {
        const auto cells = [&](int y) { return padded[static_cast<size_t>(y)] >> x & 15; };
        uint32_t pattern = cells(first_y) << 4 | cells(first_y + 1) << 8 | cells(first_y + 2) << 12;
        const int ring_x = std::min({x, last_x - x, kRings - 1});
        for (int y = first_y; y <= end_y; ++y) {
            pattern = pattern >> 4 | cells(y + 3) << 12;
            const int ring = std::min({y, last_y - y, ring_x});
            put(y * (last_x + 1) + x,
                windows_ + unsigned_of(ring) * kWindowClasses + window_class_[pattern]);
        }
    }
    return (last_x + 1) * (last_y + 1);
}

// For k = 1.. neighbouring lines, where all k are free. The lines from `first` to before `end` have
// changed.
template <class Put>
int AfterstateFeatures::visit_runs(const Lines &lines, int first, int end, int next,
                                   const Put &put) const {
    const int most = std::min(shape_.most_side, lines.count);
    for (int i = std::max(0, first + 1 - most); i < end; ++i) {
        auto common = static_cast<uint16_t>((1u << lines.length) - 1);
        uint32_t table = lines.table;
        int feature = next + i;
        for (int k = 1; k <= std::min(most, lines.count - i); ++k) {
            const int last = lines.count - k;
            common = common & lines.free[static_cast<size_t>(i + k - 1)];
            if (i + k > first) {
                const int ring = std::min({i, last - i, kRings - 1});
                put(feature, table + (unsigned_of(ring) << lines.length) + lines.classes[common]);
            }
            table += unsigned_of(kRings) << lines.length;
            feature += last + 1;
        }
    }
    for (int k = 1; k <= most; ++k) next += lines.count - k + 1;
    return next;
}

// For each item size how many placements there are; and which sizes have any, with how many cells
// are free. Which sizes fit is a staircase: for each width the greatest height.
template <class Put>
void AfterstateFeatures::visit_items(const FreeCells &free, int next, const Put &put) const {
    const int m = shape_.most_side;
    int counts[kMostItemSide][kMostItemSide];
    Row across = free.cells;
    for (int w = 1; w <= m; ++w) {
        if (w > 1) across &= shifted(free.cells, w - 1);
        Row both = across;
        Row line = across;
        for (int h = 1; h <= m; ++h) {
            if (h > 1) both &= line = shifted(line, free.w + 1);
            counts[w - 1][h - 1] = row_count(both);
        }
    }
    const bool alike = shape_.square() || shape_.rotation;
    int heights[kMostItemSide] = {};
    for (int w = 0; w < m; ++w) {
        heights[w] = 0;
        for (int h = 0; h < m; ++h) {
            if (shape_.rotation && h < w) continue;
            int count = counts[w][h];
            if (shape_.rotation && h != w) count += counts[h][w];
            const int a = alike ? std::min(w, h) : w;
            const int b = alike ? std::max(w, h) : h;
            put(next++, counts_ + unsigned_of((a * m + b) * kCountSteps + count_step(count)));
        }
        for (int h = m; h-- > 0 && heights[w] == 0;) {
            if (counts[w][h] > 0 || (shape_.rotation && counts[h][w] > 0)) heights[w] = h + 1;
        }
    }
    if (alike && !shape_.rotation) {
        // Of the staircase and its mirror image the one that is higher first.
        int mirrored[kMostItemSide] = {};
        for (int h = 1; h <= m; ++h) {
            mirrored[h - 1] = static_cast<int>(
                std::count_if(heights, heights + m, [h](int n) { return n >= h; }));
        }
        if (std::lexicographical_compare(heights, heights + m, mirrored, mirrored + m)) {
            std::copy_n(mirrored, m, heights);
        }
    }
    // Rank of the staircase among all, in lexicographic order.
    uint32_t rank = 0;
    for (int w = 0; w < m; ++w) {
        for (int lower = 0; lower < heights[w]; ++lower) {
            rank += paths_[static_cast<size_t>(w) + 1][static_cast<size_t>(lower)];
        }
    }
    put(next,
        fits_ + rank * unsigned_of(shape_.bin_w * shape_.bin_h + 1) + unsigned_of(free.count));
}

template <class Put>
void AfterstateFeatures::visit(const FreeCells &free, const Rect &changed, const Put &put) const {
    int next = visit_windows(free, changed, put);
    next = visit_runs({free.rows, free.h, free.w, rows_, row_class_}, changed.y,
                      changed.y + changed.h, next, put);
    next = visit_runs({free.columns, free.w, free.h, columns_, column_class_}, changed.x,
                      changed.x + changed.w, next, put);
    visit_items(free, next, put);
}

void AfterstateFeatures::list(const FreeCells &free, uint32_t *out) const {
    const Rect all{0, 0, free.w, free.h};
    visit(free, all, [out](int feature, uint32_t entry) { out[feature] = entry; });
}

void AfterstateFeatures::read(const FreeCells &free, const Rect &changed, const float *entries,
                              float *out) const {
    visit(free, changed, [=](int feature, uint32_t entry) { out[feature] = entries[entry]; });
}

}  // namespace packcell
