#include "feed/grid.h"

#include "capi/handles.h"

using namespace packcell;

namespace {

pkc_grid default_grid() {
    const Grid g;
    return {sizeof(pkc_grid), 0, g.bin_w, g.bin_h, g.margin, g.cell, g.clearance};
}

Grid checked_grid(const pkc_grid *grid) {
    const pkc_grid g = read_struct("grid", grid, default_grid());
    require_range("grid.reserved", g.reserved, 0, 0);
    return {g.bin_w, g.bin_h, g.margin, g.cell, g.clearance};
}

}  // namespace

extern "C" {

pkc_status pkc_grid_init(pkc_grid *grid, size_t size) {
    return guard([&] { init_struct("grid", grid, size, default_grid()); });
}

pkc_status pkc_grid_bin(const pkc_grid *grid, int32_t *out_w, int32_t *out_h) {
    return guard([&] {
        require(out_w, "out_w");
        require(out_h, "out_h");
        const Size size = grid_bin(checked_grid(grid));
        *out_w = size.w;
        *out_h = size.h;
    });
}

pkc_status pkc_grid_item(const pkc_grid *grid, double w, double h, int32_t *out_w, int32_t *out_h) {
    return guard([&] {
        require(out_w, "out_w");
        require(out_h, "out_h");
        const Size size = grid_item(checked_grid(grid), w, h);
        *out_w = size.w;
        *out_h = size.h;
    });
}

pkc_status pkc_grid_centre(const pkc_grid *grid, int32_t x, int32_t y, int32_t w, int32_t h,
                           double *out_x, double *out_y) {
    return guard([&] {
        require(out_x, "out_x");
        require(out_y, "out_y");
        require_range("x", x, 0, PKC_MAX_SIDE - 1);
        require_range("y", y, 0, PKC_MAX_SIDE - 1);
        require_range("w", w, 1, PKC_MAX_SIDE);
        require_range("h", h, 1, PKC_MAX_SIDE);
        const Millimetres centre = grid_centre(checked_grid(grid), {x, y, w, h});
        *out_x = centre.x;
        *out_y = centre.y;
    });
}

}  // extern "C"
