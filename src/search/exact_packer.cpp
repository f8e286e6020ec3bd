#include "search/exact_packer.h"

#include <algorithm>

namespace packcell {

namespace {

// After so many nodes the states met are remembered: shorter searches end sooner without.
constexpr uint64_t kRememberAfter = 200;

// The views are the symmetries of the square: bit 0 flips x, bit 1 flips y, bit 2 transposes.
constexpr int kTranspose = 4;

constexpr uint64_t kHashFactor = 0x9e3779b97f4a7c15u;

}  // namespace

ExactPacker::ExactPacker(int max_side, int max_items, uint64_t memory) : rows_(), seen_(memory) {
    const auto items = static_cast<size_t>(max_items);
    kinds_.reserve(items);
    items_.reserve(items);
    kind_of_.reserve(items);
    order_.reserve(items);
    frames_.resize(static_cast<size_t>(max_side) * static_cast<size_t>(max_side) + 1);
}

void ExactPacker::start(const Bin &bin, const Item *items, int count, bool rotation, int view) {
    view_ = view;
    const bool transpose = (view & kTranspose) != 0;
    w_ = transpose ? bin.h() : bin.w();
    h_ = transpose ? bin.w() : bin.h();
    for (int y = 0; y < h_; ++y) {
        const int from = (view & 2) != 0 ? h_ - 1 - y : y;
        const Row cells = transpose ? bin.column(from) : bin.row(from);
        Row row = cells;
        if ((view & 1) != 0) {
            row = 0;
            for (int x = 0; x < w_; ++x) {
                if ((cells & (kRowOne << x)) != 0) row |= kRowOne << (w_ - 1 - x);
            }
        }
        rows_[static_cast<size_t>(y)] = row | ~row_ones(0, w_);
    }

    items_.assign(items, items + count);
    order_.clear();
    for (int i = 0; i < count; ++i) order_.push_back(i);
    std::sort(order_.begin(), order_.end(), [&](int a, int b) {
        const Item &p = items[a];
        const Item &q = items[b];
        if (p.area() != q.area()) return p.area() > q.area();
        if (p.w != q.w) return p.w > q.w;
        return a < b;
    });
    kinds_.clear();
    kind_of_.assign(static_cast<size_t>(count), 0);
    min_side_ = kMaxSide;
    int area = 0;
    for (int i : order_) {
        const Item &item = items[i];
        const bool turns = rotation && item.turns();
        Size size = transpose ? Size{item.h, item.w} : Size{item.w, item.h};
        if (turns && size.w < size.h) std::swap(size.w, size.h);
        size_t k = 0;
        while (k < kinds_.size() && (kinds_[k].size.w != size.w || kinds_[k].size.h != size.h ||
                                     kinds_[k].turns != turns))
            ++k;
        if (k == kinds_.size()) kinds_.push_back({size, turns, 0});
        ++kinds_[k].left;
        kind_of_[static_cast<size_t>(i)] = static_cast<int>(k);
        min_side_ = std::min(min_side_, turns ? std::min(size.w, size.h) : size.w);
        area += size.area();
    }
    left_ = count;
    slack_ = total_slack_ = bin.free_cells() - area;
    nodes_ = 0;
    depth_ = 0;
    entered_ = false;
    impossible_ = slack_ < 0 || !possible(bin);
    seen_.clear();
}

// A quick refusal: an item without any position, or more cells that no item can cover than may be
// wasted.
bool ExactPacker::possible(const Bin &bin) const {
    std::array<Row, kMaxSide> covered;
    std::fill_n(covered.begin(), bin.h(), Row{0});
    Positions positions;
    for (const Kind &kind : kinds_) {
        bool fits = false;
        for (int rot = 0; rot < (kind.turns ? 2 : 1); ++rot) {
            const bool swap = (rot != 0) != ((view_ & kTranspose) != 0);
            const Size size = swap ? Size{kind.size.h, kind.size.w} : kind.size;
            bin.feasible(size, positions);
            for (int y = 0; y < positions.count; ++y) {
                Row row = positions.rows[static_cast<size_t>(y)];
                if (row == 0) continue;
                fits = true;
                for (int have = 1; have < size.w;) {
                    const int by = std::min(have, size.w - have);
                    row |= row << by;
                    have += by;
                }
                for (int dy = 0; dy < size.h; ++dy) covered[static_cast<size_t>(y + dy)] |= row;
            }
        }
        if (!fits) return false;
    }
    int coverable = 0;
    for (int y = 0; y < bin.h(); ++y) coverable += row_count(covered[static_cast<size_t>(y)]);
    return bin.free_cells() - coverable <= slack_;
}

ExactPacker::Answer ExactPacker::run(Budget &budget, uint64_t node_limit) {
    if (impossible_) return Answer::kImpossible;
    if (!entered_) {
        entered_ = true;
        if (left_ == 0) return Answer::kFound;
        if (!enter(0)) return Answer::kImpossible;
    }
    while (depth_ > 0) {
        if (budget.must_return()) return Answer::kPaused;
        if (nodes_ >= node_limit) return Answer::kLimit;
        Frame &frame = frames_[depth_ - 1];
        lift(frame);
        if (place_next(frame)) {
            ++nodes_;
            budget.spend();
            if (left_ == 0) return Answer::kFound;
        } else if (waste(frame)) {
            budget.idle();
        } else {
            --depth_;
            continue;
        }
        enter(frame.y);
    }
    impossible_ = true;
    return Answer::kImpossible;
}

// Opens a frame at the first empty cell; false, and no frame, where that cannot lead anywhere.
bool ExactPacker::enter(int from_row) {
    int y = from_row;
    while (y < h_ && rows_[static_cast<size_t>(y)] == ~Row{0}) ++y;
    if (y == h_) return false;
    if (nodes_ > kRememberAfter && left_ > 1 && seen_.meet(state_key(y), 0) != UINT32_MAX)
        return false;
    const Row row = rows_[static_cast<size_t>(y)];
    const int x = row_lowest(~row);
    const Row beyond = row >> x;
    const int run = beyond == 0 ? kMaxSide - x : row_lowest(beyond);
    frames_[depth_++] = {x, y, run, -1, 1, 0, 0, false};
    return true;
}

// Places the next kind, or the same one turned, that fits at the frame's cell.
bool ExactPacker::place_next(Frame &frame) {
    if (frame.wasted) return false;
    const auto kinds = static_cast<int>(kinds_.size());
    while (frame.kind < kinds) {
        if (frame.rot == 0 && frame.kind >= 0 && kinds_[static_cast<size_t>(frame.kind)].turns) {
            frame.rot = 1;
        } else {
            frame.rot = 0;
            ++frame.kind;
            while (frame.kind < kinds && kinds_[static_cast<size_t>(frame.kind)].left == 0)
                ++frame.kind;
            if (frame.kind == kinds) break;
        }
        Kind &kind = kinds_[static_cast<size_t>(frame.kind)];
        const Size size = frame.rot != 0 ? Size{kind.size.h, kind.size.w} : kind.size;
        if (size.w > frame.run || !is_free(frame.x, frame.y, size)) continue;
        frame.width = size.w;
        frame.height = size.h;
        flip(frame);
        --kind.left;
        --left_;
        return true;
    }
    return false;
}

// Wastes the frame's cell; the whole run where no side is short enough for it.
bool ExactPacker::waste(Frame &frame) {
    if (frame.wasted) return false;
    const int cells = frame.run < min_side_ ? frame.run : 1;
    if (cells > slack_) return false;
    frame.wasted = true;
    frame.width = cells;
    frame.height = 1;
    slack_ -= cells;
    flip(frame);
    return true;
}

// Takes away what lies at the frame.
void ExactPacker::lift(Frame &frame) {
    if (frame.width == 0) return;
    flip(frame);
    if (frame.wasted) {
        slack_ += frame.width;
    } else {
        ++kinds_[static_cast<size_t>(frame.kind)].left;
        ++left_;
    }
    frame.width = 0;
}

void ExactPacker::flip(const Frame &frame) {
    const Row mask = row_ones(frame.x, frame.width);
    for (int y = frame.y; y < frame.y + frame.height; ++y) {
        rows_[static_cast<size_t>(y)] ^= mask;
    }
}

bool ExactPacker::is_free(int x, int y, Size size) const {
    if (size.h > h_ - y) return false;
    const Row mask = row_ones(x, size.w);
    for (int i = y + 1; i < y + size.h; ++i) {
        if ((rows_[static_cast<size_t>(i)] & mask) != 0) return false;
    }
    return true;
}

// The cells that are still free and the items left; the rows above y are full.
uint64_t ExactPacker::state_key(int y) const {
    uint64_t key = 0;
    for (; y < h_; ++y) {
        const Row row = rows_[static_cast<size_t>(y)];
        key = (key ^ (key >> 29) ^ static_cast<uint64_t>(row)) * kHashFactor;
        if (w_ > 64) key = (key ^ (key >> 29) ^ static_cast<uint64_t>(row >> 64)) * kHashFactor;
    }
    for (const Kind &kind : kinds_)
        key = (key ^ (key >> 29) ^ static_cast<uint64_t>(kind.left)) * kHashFactor;
    return mix64(key);
}

void ExactPacker::placements(Placement *out) const {
    std::fill_n(out, items_.size(), Placement{{-1, 0, 0, 0}, 0, 0, 0});
    const bool transpose = (view_ & kTranspose) != 0;
    for (size_t d = 0; d < depth_; ++d) {
        const Frame &f = frames_[d];
        if (f.wasted || f.width == 0) continue;
        // Undo the view, then give the rectangle to the first item of its kind that has none yet.
        int x = (view_ & 1) != 0 ? w_ - f.x - f.width : f.x;
        int y = (view_ & 2) != 0 ? h_ - f.y - f.height : f.y;
        Size size{f.width, f.height};
        if (transpose) {
            std::swap(x, y);
            std::swap(size.w, size.h);
        }
        for (size_t i = 0; i < items_.size(); ++i) {
            if (kind_of_[i] != f.kind || out[i].item.id >= 0) continue;
            const int rot = items_[i].w == size.w && items_[i].h == size.h ? 0 : 1;
            out[i] = {items_[i], x, y, rot};
            break;
        }
    }
}

}  // namespace packcell
