#include "bin/bin.h"

#include <algorithm>

#include "base/random.h"

namespace packcell {

namespace {

constexpr uint64_t kOddFactor = 0x9e3779b97f4a7c15u;

constexpr uint64_t place_hash(int y, uint64_t high) {
    return mix64(high + static_cast<uint64_t>(y + 1) * kOddFactor);
}

// Where no cell is beyond the 64th.
constexpr std::array<uint64_t, kMaxSide> kPlaceHashes = [] {
    std::array<uint64_t, kMaxSide> hashes{};
    for (int y = 0; y < kMaxSide; ++y) hashes[static_cast<size_t>(y)] = place_hash(y, 0);
    return hashes;
}();

// Contribution of row y with these bits to the occupancy hash.
uint64_t row_hash(int y, Row row) {
    if (row == 0) return 0;
    const auto high = static_cast<uint64_t>(row >> 64);
    const uint64_t place = high == 0 ? kPlaceHashes[static_cast<size_t>(y)] : place_hash(y, high);
    return mix64(static_cast<uint64_t>(row) ^ place);
}

// Bits where a run of `count` ones begins, by doubling.
template <class Word>
Word runs(Word ones, int count) {
    int have = 1;
    while (have < count) {
        const int by = std::min(have, count - have);
        ones &= ones >> by;
        have += by;
    }
    return ones;
}

template <class Word>
void feasible_rows(const Row *occupied, int w, int h, Size size, Row *out) {
    const Word inside = static_cast<Word>(row_ones(0, w));
    std::array<Word, kMaxSide> run;
    for (int y = 0; y < h; ++y) {
        run[static_cast<size_t>(y)] = runs<Word>(static_cast<Word>(~occupied[y]) & inside, size.w);
    }
    int have = 1;
    while (have < size.h) {
        const int by = std::min(have, size.h - have);
        for (int y = 0; y + have + by <= h; ++y)
            run[static_cast<size_t>(y)] &= run[static_cast<size_t>(y + by)];
        have += by;
    }
    for (int y = 0; y + size.h <= h; ++y) out[y] = run[static_cast<size_t>(y)];
}

}  // namespace

bool Positions::any() const {
    return std::any_of(rows.begin(), rows.begin() + count, [](Row row) { return row != 0; });
}

Bin::Bin(int w, int h, size_t reserve) : rows_(), columns_(), w_(w), h_(h) {
    rows_[0] = rows_[static_cast<size_t>(h) + 1] = ~Row{0};
    columns_[0] = columns_[static_cast<size_t>(w) + 1] = ~Row{0};
    items_.reserve(reserve);
}

int Bin::find(int32_t id) const {
    for (size_t i = 0; i < items_.size(); ++i) {
        if (items_[i].item.id == id) return static_cast<int>(i);
    }
    return -1;
}

bool Bin::is_free(const Rect &r) const {
    if (!inside(r)) return false;
    const Row mask = row_ones(r.x, r.w);
    for (int y = r.y; y < r.y + r.h; ++y) {
        if ((row(y) & mask) != 0) return false;
    }
    return true;
}

void Bin::feasible(Size size, Positions &out) const {
    if (size.w > w_ || size.h > h_) {
        out.count = 0;
        return;
    }
    out.count = h_ - size.h + 1;
    if (w_ <= 64) {
        feasible_rows<uint64_t>(&rows_[1], w_, h_, size, out.rows.data());
    } else {
        feasible_rows<Row>(&rows_[1], w_, h_, size, out.rows.data());
    }
}

int Bin::free_boundary() const {
    int length = 0;
    for (int y = 0; y <= h_; ++y) {
        const auto i = static_cast<size_t>(y);
        length += row_count((rows_[i] ^ rows_[i + 1]) & row_ones(0, w_));
    }
    for (int x = 0; x <= w_; ++x) {
        const auto i = static_cast<size_t>(x);
        length += row_count((columns_[i] ^ columns_[i + 1]) & row_ones(0, h_));
    }
    return length;
}

void Bin::fill(const Rect &r) {
    const Row across = row_ones(r.x, r.w);
    const Row down = row_ones(r.y, r.h);
    for (int y = r.y; y < r.y + r.h; ++y) {
        Row &row = rows_[static_cast<size_t>(y) + 1];
        hash_ ^= row_hash(y, row);
        row |= across;
        hash_ ^= row_hash(y, row);
    }
    for (int x = r.x; x < r.x + r.w; ++x) columns_[static_cast<size_t>(x) + 1] |= down;
    occupied_ += r.w * r.h;
}

void Bin::erase(const Rect &r) {
    const Row across = ~row_ones(r.x, r.w);
    const Row down = ~row_ones(r.y, r.h);
    for (int y = r.y; y < r.y + r.h; ++y) {
        Row &row = rows_[static_cast<size_t>(y) + 1];
        hash_ ^= row_hash(y, row);
        row &= across;
        hash_ ^= row_hash(y, row);
    }
    for (int x = r.x; x < r.x + r.w; ++x) columns_[static_cast<size_t>(x) + 1] &= down;
    occupied_ -= r.w * r.h;
}

void Bin::block(const Rect &r) {
    fill(r);
    fixed_ += r.w * r.h;
}

void Bin::place(const Placement &p) {
    items_.push_back(p);
    fill(p.rect());
}

void Bin::undo_place() {
    erase(items_.back().rect());
    items_.pop_back();
}

Placement Bin::remove(size_t index) {
    const Placement p = items_[index];
    items_.erase(items_.begin() + static_cast<std::ptrdiff_t>(index));
    erase(p.rect());
    return p;
}

void Bin::clear() {
    while (!items_.empty()) undo_place();
}

void Bin::assign(const Bin &other) {
    w_ = other.w_;
    h_ = other.h_;
    // Only the rows in use, the walls with them, are worth copying.
    std::copy_n(other.rows_.begin(), h_ + 2, rows_.begin());
    std::copy_n(other.columns_.begin(), w_ + 2, columns_.begin());
    occupied_ = other.occupied_;
    fixed_ = other.fixed_;
    hash_ = other.hash_;
    items_.assign(other.items_.begin(), other.items_.end());
}

}  // namespace packcell
