#include <algorithm>

#include "capi/handles.h"

using namespace packcell;

namespace {

Rect checked_rect(int32_t x, int32_t y, int32_t w, int32_t h) {
    require_range("x", x, 0, PKC_MAX_SIDE - 1);
    require_range("y", y, 0, PKC_MAX_SIDE - 1);
    require_range("w", w, 1, PKC_MAX_SIDE);
    require_range("h", h, 1, PKC_MAX_SIDE);
    return {x, y, w, h};
}

void require_free(const Bin &bin, const Rect &r) {
    if (!bin.inside(r)) {
        fail(Status::kState, "%dx%d at (%d, %d): does not lie inside the %dx%d bin", r.w, r.h, r.x,
             r.y, bin.w(), bin.h());
    }
    if (!bin.is_free(r))
        fail(Status::kState, "%dx%d at (%d, %d): a cell is taken", r.w, r.h, r.x, r.y);
}

pkc_bin_info default_info() { return {sizeof(pkc_bin_info), 0, 0, 0, 0, 0, 0}; }

}  // namespace

extern "C" {

pkc_status pkc_bin_info_init(pkc_bin_info *info, size_t size) {
    return guard([&] { init_struct("info", info, size, default_info()); });
}

pkc_status pkc_bin_create(int32_t w, int32_t h, pkc_bin **out_bin) {
    return guard([&] {
        require(out_bin, "out_bin");
        require_range("bin width", w, 1, PKC_MAX_SIDE);
        require_range("bin height", h, 1, PKC_MAX_SIDE);
        *out_bin = new pkc_bin(Bin(w, h));
    });
}

void pkc_bin_free(pkc_bin *bin) { delete bin; }

pkc_status pkc_bin_clone(const pkc_bin *bin, pkc_bin **out_bin) {
    return guard([&] {
        require(out_bin, "out_bin");
        const Use<const pkc_bin> use("bin", bin);
        *out_bin = new pkc_bin(use->bin);
    });
}

pkc_status pkc_bin_clear(pkc_bin *bin) {
    return guard([&] { Use<pkc_bin>("bin", bin)->bin.clear(); });
}

pkc_status pkc_bin_block(pkc_bin *bin, int32_t x, int32_t y, int32_t w, int32_t h) {
    return guard([&] {
        const Use<pkc_bin> use("bin", bin);
        const Rect r = checked_rect(x, y, w, h);
        require_free(use->bin, r);
        use->bin.block(r);
    });
}

pkc_status pkc_bin_pack(pkc_bin *bin, const pkc_item *item, int32_t x, int32_t y, int32_t rot) {
    return guard([&] {
        const Use<pkc_bin> use("bin", bin);
        const Item checked = checked_item("item", item);
        require_flag("rot", rot);
        if (rot == 1 && (checked.flags & kNoRotate) != 0) {
            fail(Status::kState, "item %d: must not be turned (PKC_ITEM_NO_ROTATE)", checked.id);
        }
        if (use->bin.find(checked.id) >= 0)
            fail(Status::kState, "item %d: is in the bin already", checked.id);
        const Size size = checked.turned(rot);
        require_free(use->bin, checked_rect(x, y, size.w, size.h));
        use->bin.place({checked, x, y, rot});
    });
}

pkc_status pkc_bin_unpack(pkc_bin *bin, int32_t id, pkc_placement *out_placement) {
    return guard([&] {
        const Use<pkc_bin> use("bin", bin);
        const int index = use->bin.find(id);
        if (index < 0) fail(Status::kState, "item %d: is not in the bin", id);
        if (use->bin.items()[static_cast<size_t>(index)].item.pinned()) {
            fail(Status::kState, "item %d: is pinned (PKC_ITEM_PINNED)", id);
        }
        const Placement p = use->bin.remove(static_cast<size_t>(index));
        if (out_placement != nullptr) *out_placement = to_c(p);
    });
}

pkc_status pkc_bin_get_info(const pkc_bin *bin, pkc_bin_info *info) {
    return guard([&] {
        const Use<const pkc_bin> use("bin", bin);
        const Bin &b = use->bin;
        pkc_bin_info value = default_info();
        value.w = b.w();
        value.h = b.h();
        value.items = static_cast<int32_t>(b.items().size());
        value.occupied_cells = b.occupied();
        value.fixed_cells = b.fixed();
        value.hash = b.hash();
        write_struct("info", info, value);
    });
}

pkc_status pkc_bin_items(const pkc_bin *bin, pkc_placement *placements, size_t capacity,
                         size_t *out_count) {
    return guard([&] {
        const Use<const pkc_bin> use("bin", bin);
        const auto &items = use->bin.items();
        require_capacity(items.size(), capacity, out_count);
        if (!items.empty()) require(placements, "placements");
        std::transform(items.begin(), items.end(), placements,
                       [](const Placement &p) { return to_c(p); });
        *out_count = items.size();
    });
}

pkc_status pkc_bin_cells(const pkc_bin *bin, int32_t *cells, size_t capacity, size_t *out_count) {
    return guard([&] {
        const Use<const pkc_bin> use("bin", bin);
        const Bin &b = use->bin;
        const auto count = static_cast<size_t>(b.cells());
        require_capacity(count, capacity, out_count);
        require(cells, "cells");
        for (int y = 0; y < b.h(); ++y) {
            for (int x = 0; x < b.w(); ++x) {
                const bool taken = (b.row(y) >> x & kRowOne) != 0;
                cells[x + y * b.w()] = taken ? PKC_CELL_FIXED : PKC_CELL_FREE;
            }
        }
        for (const Placement &p : b.items()) {
            const Rect r = p.rect();
            for (int y = r.y; y < r.y + r.h; ++y)
                std::fill_n(cells + r.x + y * b.w(), r.w, p.item.id);
        }
        *out_count = count;
    });
}

pkc_status pkc_bin_feasible(const pkc_bin *bin, int32_t w, int32_t h, uint8_t *mask,
                            size_t capacity, size_t *out_count) {
    return guard([&] {
        const Use<const pkc_bin> use("bin", bin);
        const Bin &b = use->bin;
        require_range("w", w, 1, PKC_MAX_SIDE);
        require_range("h", h, 1, PKC_MAX_SIDE);
        const auto count = static_cast<size_t>(b.cells()) + 1;
        require_capacity(count, capacity, out_count);
        require(mask, "mask");
        Positions positions;
        b.feasible({w, h}, positions);
        std::fill_n(mask, count, uint8_t{0});
        for (int y = 0; y < positions.count; ++y) {
            for (Row row = positions.rows[static_cast<size_t>(y)]; row != 0; row &= row - 1) {
                mask[row_lowest(row) + y * b.w()] = 1;
            }
        }
        mask[count - 1] = positions.any() ? 0 : 1;
        *out_count = count;
    });
}

pkc_status pkc_bin_contact(const pkc_bin *bin, int32_t x, int32_t y, int32_t w, int32_t h,
                           int32_t *out_reward) {
    return guard([&] {
        require(out_reward, "out_reward");
        const Use<const pkc_bin> use("bin", bin);
        const Rect r = checked_rect(x, y, w, h);
        require_free(use->bin, r);
        *out_reward = use->bin.contact(r);
    });
}

}  // extern "C"
