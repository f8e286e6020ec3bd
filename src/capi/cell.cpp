#include <algorithm>
#include <cstdio>
#include <string>

#include "base/file.h"
#include "capi/cell_handles.h"
#include "cell/cell_json.h"
#include "motion/kinematics.h"
#include "motion/layout.h"

using namespace packcell;

namespace {

static_assert(PKC_MAX_JOINTS == kMaxJoints);

// 0 where arm 0 reaches no three zones of the belt: the cell may be for scenarios with fewer.
double cycle_of(const CellLayout &cell) {
    try {
        return reference_cycle(cell);
    } catch (const Error &) {
        return 0;
    }
}

pkc_cell_info info_of(const CellLayout &cell) {
    pkc_cell_info info = {};
    info.struct_size = sizeof info;
    info.arms = static_cast<int32_t>(cell.arms.size());
    const Size sides = grid_bin(cell.bin.grid);
    info.bin_w = sides.w;
    info.bin_h = sides.h;
    for (size_t i = 0; i < cell.arms.size(); ++i) {
        info.buffer_slots[i] = static_cast<int32_t>(cell.arms[i].buffer.size());
        info.joints[i] = cell.arms[i].model.joints;
    }
    info.margin = cell.margin;
    info.tick = cell.tick;
    info.cycle = cycle_of(cell);
    std::snprintf(info.name, sizeof info.name, "%s", cell.name);
    return info;
}

const ArmPlace &checked_arm(const pkc_cell *cell, int32_t arm) {
    require(cell, "cell");
    require_range("arm", arm, 0, static_cast<int64_t>(cell->layout.arms.size()) - 1);
    return cell->layout.arms[static_cast<size_t>(arm)];
}

void require_all_finite(const char *name, const double *values, int count, double most) {
    require(values, name);
    for (int i = 0; i < count; ++i) require_finite(name, values[i], -most, most);
}

pkc_layout_options default_layout_options() {
    const LayoutOptions d;
    return {sizeof(pkc_layout_options), d.evaluations, d.range};
}

}  // namespace

extern "C" {

pkc_status pkc_cell_create(const char *preset, pkc_cell **out_cell) {
    return guard([&] {
        require(preset, "preset");
        require(out_cell, "out_cell");
        *out_cell = new pkc_cell(cell_preset(preset));
    });
}

void pkc_cell_free(pkc_cell *cell) { delete cell; }

const char *pkc_cell_preset(size_t index) {
    return index < 1000 ? cell_preset_name(static_cast<int>(index)) : nullptr;
}

pkc_status pkc_cell_load(const char *json, size_t size, pkc_cell **out_cell) {
    return guard([&] {
        require(json, "json");
        require(out_cell, "out_cell");
        if (size > PKC_MAX_CELL_BYTES) {
            fail(Status::kFormat, "size %zu: a cell description has up to %d bytes", size,
                 PKC_MAX_CELL_BYTES);
        }
        *out_cell = new pkc_cell(read_cell(std::string(json, size)));
    });
}

pkc_status pkc_cell_load_file(const char *path, pkc_cell **out_cell) {
    return guard([&] {
        require(path, "path");
        require(out_cell, "out_cell");
        const std::vector<uint8_t> bytes = read_file(path, PKC_MAX_CELL_BYTES);
        *out_cell = new pkc_cell(read_cell(std::string(bytes.begin(), bytes.end())));
    });
}

pkc_status pkc_cell_save(const pkc_cell *cell, char *json, size_t capacity, size_t *out_size) {
    return guard([&] {
        require(cell, "cell");
        require(out_size, "out_size");
        if (capacity > 0) require(json, "json");
        const std::string text = write_cell(cell->layout);
        require_capacity(text.size(), capacity, out_size);
        std::copy(text.begin(), text.end(), json);
        *out_size = text.size();
    });
}

pkc_status pkc_cell_save_file(const pkc_cell *cell, const char *path) {
    return guard([&] {
        require(cell, "cell");
        require(path, "path");
        const std::string text = write_cell(cell->layout);
        write_file(path, reinterpret_cast<const uint8_t *>(text.data()), text.size());
    });
}

pkc_status pkc_cell_info_init(pkc_cell_info *info, size_t size) {
    return guard([&] { init_struct("info", info, size, pkc_cell_info{}); });
}

pkc_status pkc_cell_get_info(const pkc_cell *cell, pkc_cell_info *info) {
    return guard([&] {
        require(cell, "cell");
        write_struct("info", info, info_of(cell->layout));
    });
}

pkc_status pkc_cell_check(const pkc_cell *cell, const pkc_scenario *scenario) {
    return guard([&] {
        require(cell, "cell");
        check_cell(cell->layout, checked_scenario(scenario));
    });
}

pkc_status pkc_cell_inverse(const pkc_cell *cell, int32_t arm, const double pose[4],
                            double joints[PKC_MAX_JOINTS]) {
    return guard([&] {
        const ArmPlace &place = checked_arm(cell, arm);
        require_all_finite("pose", pose, 4, 1e3);
        require(joints, "joints");
        Coordinates c{};
        Joints q{};
        if (!solve(place.model, place.base, {pose[0], pose[1], pose[2], pose[3]}, Coordinates{},
                   false, c) ||
            !joints_at(place.model, c, q)) {
            fail(Status::kState, "pose (%g, %g, %g): arm %d does not reach it", pose[0], pose[1],
                 pose[2], arm);
        }
        std::copy(q.begin(), q.end(), joints);
    });
}

pkc_status pkc_cell_forward(const pkc_cell *cell, int32_t arm, const double joints[PKC_MAX_JOINTS],
                            double pose[4]) {
    return guard([&] {
        const ArmPlace &place = checked_arm(cell, arm);
        require_all_finite("joints", joints, place.model.joints, 1e3);
        require(pose, "pose");
        Joints q{};
        std::copy(joints, joints + place.model.joints, q.begin());
        const ToolPose tool = forward(place.model, place.base, q);
        pose[0] = tool.x;
        pose[1] = tool.y;
        pose[2] = tool.z;
        pose[3] = tool.yaw;
    });
}

pkc_status pkc_layout_options_init(pkc_layout_options *options, size_t size) {
    return guard([&] { init_struct("options", options, size, default_layout_options()); });
}

pkc_status pkc_layout_info_init(pkc_layout_info *info, size_t size) {
    return guard([&] { init_struct("info", info, size, pkc_layout_info{}); });
}

pkc_status pkc_cell_optimize_layout(const pkc_cell *cell, const pkc_scenario *scenario,
                                    const pkc_layout_options *options, pkc_layout_info *info,
                                    pkc_cell **out_cell) {
    return guard([&] {
        require(cell, "cell");
        require(out_cell, "out_cell");
        if (info != nullptr) require_writable("info", info);
        const Scenario s = checked_scenario(scenario);
        LayoutOptions wanted;
        if (options != nullptr) {
            const pkc_layout_options o = read_struct("options", options, default_layout_options());
            require_range("options.evaluations", o.evaluations, 10, 100000);
            wanted.evaluations = o.evaluations;
            wanted.range = o.range;
        }
        const LayoutResult result = optimize_layout(cell->layout, s, wanted);
        auto made = std::make_unique<pkc_cell>(result.cell);
        if (info != nullptr) {
            pkc_layout_info found = {};
            found.evaluations = result.evaluations;
            found.before = result.before;
            found.after = result.after;
            write_struct("info", info, found);
        }
        *out_cell = made.release();
    });
}

}  // extern "C"
