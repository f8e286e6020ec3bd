// Plays with the rest: millimetres, scenario names, structs of other sizes, NULL, files that are
// none, long steps, layouts.
#pragma once

#include "fuzz/calls/learning.hpp"
#include "fuzz/calls/planning.hpp"

namespace packcell_fuzz {

inline void play_grid(World &world) {
    Choices &in = world.in;
    auto grid = initialised<pkc_grid, pkc_grid_init>();
    if (in.seldom(2)) grid.bin_w = in.real(50, 5000);
    if (in.seldom(2)) grid.bin_h = in.real(50, 5000);
    if (in.seldom(3)) grid.margin = in.real(0, 20);
    if (in.seldom(3)) grid.cell = in.real(1, 50);
    if (in.seldom(3)) grid.clearance = in.real(0, 10);
    int32_t w = -7, h = -7;
    if (call(
            "grid_bin", [&] { return pkc_grid_bin(&grid, &w, &h); }, w, h) == PKC_OK)
        check(w >= 1 && w <= PKC_MAX_SIDE && h >= 1 && h <= PKC_MAX_SIDE, "a grid's cells");
    const double item_w = in.real(1, 400), item_h = in.real(1, 400);
    if (call(
            "grid_item", [&] { return pkc_grid_item(&grid, item_w, item_h, &w, &h); }, w, h) ==
        PKC_OK)
        check(w >= 1 && w <= PKC_MAX_SIDE && h >= 1 && h <= PKC_MAX_SIDE, "an item's cells");
    double x = -7, y = -7;
    const int32_t at_x = in.number(0, 20), at_y = in.number(0, 20);
    const int32_t cells_w = in.number(1, 9), cells_h = in.number(1, 9);
    if (call(
            "grid_centre",
            [&] { return pkc_grid_centre(&grid, at_x, at_y, cells_w, cells_h, &x, &y); }, x,
            y) == PKC_OK)
        check(std::isfinite(x) && std::isfinite(y), "a centre");
}

inline void play_name(World &world) {
    Choices &in = world.in;
    static const char letters[] = "SDRAO-0123456789 \xff";
    std::string text = in.seldom(2) ? "D-R5A3O1" : "S-R64A64";
    for (int n = in.below(4); n > 0; --n)
        text.insert(in.byte() % (text.size() + 1), 1, letters[in.byte() % (sizeof letters - 1)]);
    if (in.seldom(3)) text.erase(in.byte() % (text.size() + 1));
    auto scenario = initialised<pkc_scenario, pkc_scenario_init>();
    if (call(
            "scenario_parse", [&] { return pkc_scenario_parse(text.c_str(), &scenario); },
            scenario) != PKC_OK)
        return;
    const size_t capacity = in.capacity(32);
    std::vector<char> name(capacity, '?');
    const pkc_status status =
        told("scenario_name", pkc_scenario_name(&scenario, name.data(), capacity));
    check(
        status == PKC_OK || (status == PKC_E_CAPACITY && name == std::vector<char>(capacity, '?')),
        "a name that does not fit is stored");
    if (status == PKC_OK) check(std::string(name.data()).size() < capacity, "a name has no end");
}

// A struct of another size than this header's: as much as there is of it is used.
template <class T, pkc_status (*Init)(T *, size_t), class Call>
void resize_struct(Choices &in, const char *name, const Call &made) {
    const size_t size = in.seldom(4) ? in.word() : in.word() % 400;
    std::vector<uint64_t> room(std::min<size_t>(size, 5000) / 8 + 1, 0x5a5a5a5a5a5a5a5au);
    auto *const value = reinterpret_cast<T *>(room.data());
    if (told("_init", Init(value, size)) != PKC_OK) {
        check(room[0] == 0x5a5a5a5a5a5a5a5au, "a struct is initialised by halves");
        return;
    }
    if (in.seldom(3)) reinterpret_cast<uint8_t *>(value)[size - 1] = in.byte();
    if (in.seldom(6)) std::memset(value, in.byte(), 4);
    if (value->struct_size > room.size() * 8) return;  // a lie that no library can see
    told(name, made(value));
}

inline void play_structs(World &world) {
    Choices &in = world.in;
    const Scene &scene = world.scene();
    switch (in.below(9)) {
        case 0:
            return resize_struct<pkc_bin_info, pkc_bin_info_init>(
                in, "bin_get_info",
                [&](auto *info) { return pkc_bin_get_info(scene.bin.get(), info); });
        case 1:
            return resize_struct<pkc_scenario, pkc_scenario_init>(
                in, "queue_get_scenario",
                [&](auto *to) { return pkc_queue_get_scenario(scene.queue.get(), to); });
        case 2:
            return resize_struct<pkc_planner_options, pkc_planner_options_init>(
                in, "planner_create", [&](auto *options) {
                    Planner made;
                    pkc_planner *to = nullptr;
                    const pkc_status status = pkc_planner_create(options, nullptr, &to);
                    made.reset(to);
                    return status;
                });
        case 3:
            return resize_struct<pkc_schedule_info, pkc_schedule_info_init>(
                in, "schedule_get_info",
                [&](auto *info) { return pkc_schedule_get_info(scene.schedule.get(), info); });
        case 4:
            return resize_struct<pkc_trainer_info, pkc_trainer_info_init>(
                in, "trainer_get_info",
                [&](auto *info) { return pkc_trainer_get_info(world.trainer.get(), info); });
        case 5:
            return resize_struct<pkc_cell_info, pkc_cell_info_init>(
                in, "cell_get_info",
                [&](auto *info) { return pkc_cell_get_info(world.cells[0].get(), info); });
        case 6:
            return resize_struct<pkc_simulation_info, pkc_simulation_info_init>(
                in, "simulation_get_info", [&](auto *info) {
                    return pkc_simulation_get_info(world.simulations[0].get(), info);
                });
        case 7:
            return resize_struct<pkc_grid, pkc_grid_init>(in, "grid_bin", [&](auto *grid) {
                int32_t w = 0, h = 0;
                return pkc_grid_bin(grid, &w, &h);
            });
        default:
            return resize_struct<pkc_plan_info, pkc_plan_info_init>(
                in, "planner_result", [&](auto *info) {
                    Actions actions(PKC_MAX_ACTIONS);
                    size_t count = 0;
                    return pkc_planner_result(world.plannings[0].planner.get(), info,
                                              actions.data(), actions.size(), &count);
                });
    }
}

// A pointer that is NULL where it must not be.
inline void play_nulls(World &world) {
    Choices &in = world.in;
    const Scene &scene = world.scene();
    pkc_bin *const bin = in.seldom(2) ? scene.bin.get() : nullptr;
    pkc_queue *const queue = in.seldom(2) ? scene.queue.get() : nullptr;
    pkc_planner *const planner = in.seldom(2) ? world.plannings[0].planner.get() : nullptr;
    pkc_schedule *const schedule = in.seldom(2) ? scene.schedule.get() : nullptr;
    const size_t count = in.word() % 3;
    size_t filled = 0;
    uint8_t byte = 0;
    switch (in.below(16)) {
        case 0:
            told("bin_items", pkc_bin_items(bin, nullptr, count, &filled));
            break;
        case 1:
            told("bin_cells", pkc_bin_cells(bin, nullptr, 20000, nullptr));
            break;
        case 2:
            told("bin_cells", pkc_bin_cells(bin, nullptr, 20000, &filled));
            break;
        case 3:
            told("queue_belt", pkc_queue_belt(queue, nullptr, 5000, &filled));
            break;
        case 4:
            told("step_apply", pkc_step_apply(bin, queue, nullptr, count));
            break;
        case 5:
            told("snapshot_save", pkc_snapshot_save(bin, queue, nullptr, 1 << 20, &filled));
            break;
        case 6:
            told("snapshot_load", pkc_snapshot_load(&byte, count % 2, nullptr, nullptr));
            break;
        case 7:
            told("planner_plan", pkc_planner_plan(planner, nullptr, queue, nullptr, nullptr));
            break;
        case 8:
            told("planner_begin", pkc_planner_begin(planner, bin, nullptr, nullptr));
            break;
        case 9:
            told("planner_result", pkc_planner_result(planner, nullptr, nullptr, 999, &filled));
            break;
        case 10:
            told("schedule_add_step", pkc_schedule_add_step(schedule, bin, queue, nullptr, count));
            break;
        case 11:
            told("schedule_sample", pkc_schedule_sample(schedule, 0, 0, nullptr));
            break;
        case 12:
            told("simulate", pkc_simulate(schedule, nullptr, nullptr));
            break;
        case 13:
            told("policy_evaluate_batch",
                 pkc_policy_evaluate_batch(world.policies[0].get(), nullptr, nullptr, count,
                                           nullptr, nullptr, nullptr));
            break;
        case 14: {
            const pkc_bin *const bins[2] = {bin, nullptr};
            const int32_t sizes[4] = {1, 1, 1, 1};
            told("policy_evaluate_batch",
                 pkc_policy_evaluate_batch(world.policies[0].get(), bins, sizes, count, nullptr,
                                           nullptr, nullptr));
            break;
        }
        default:
            told("environment_step", pkc_environment_step(world.environment.get(), nullptr, count,
                                                          nullptr, nullptr, nullptr));
    }
    for (Planning &planning : world.plannings) {
        if (planner == planning.planner.get()) planning.begun = false;
    }
}

// One item unpacked and packed over and over, in a bin and a queue of their own.
inline void play_long_step(World &world) {
    Choices &in = world.in;
    Bin bin;
    Queue queue;
    const pkc_scenario scenario = draw_scenario(in);
    if (make("queue_create", queue, [&](auto **to) { return pkc_queue_create(&scenario, to); }) !=
        PKC_OK)
        return;
    const Cell &cell = world.cells[in.below(2)];
    Scene scene;
    if (cell) {
        new_bin_of(cell.get(), scene);
        make("schedule_create", scene.schedule, [&](auto **to) {
            return pkc_schedule_create(cell.get(), &scenario, in.from(1, 3), to);
        });
        bin = std::move(scene.bin);
    } else {
        make("bin_create", bin, [&](auto **to) { return pkc_bin_create(6, 6, to); });
    }
    const pkc_item items[2] = {{0, 2, 1, 0}, {1, 1, 2, 0}};
    for (int32_t i = 0; i < 2; ++i)
        told("bin_pack", pkc_bin_pack(bin.get(), items + i, 2 * i, 0, 0));
    Actions actions;
    const int rounds = in.seldom(8) ? in.from(300, 420) : in.from(1, 12);
    for (int i = 0; i < rounds; ++i) {
        const int32_t id = in.below(2);
        const int32_t arm = in.below(scenario.robots);
        actions.push_back({PKC_OP_UNPACK, id, 0, 0, 0, arm});
        actions.push_back({PKC_OP_PACK, id, 2 * id, in.below(2), 0, arm});
    }
    const bool legal = is_legal(bin.get(), queue.get(), actions);
    if (scene.schedule) {
        const pkc_status status = told(
            "schedule_add_step", pkc_schedule_add_step(scene.schedule.get(), bin.get(), queue.get(),
                                                       actions.data(), actions.size()));
        check(legal || status != PKC_OK, "a schedule takes a step that is not legal");
        check(actions.size() <= PKC_MAX_ACTIONS || status == PKC_E_LIMIT, "a step is too long");
        const pkc_schedule_info info = info_of(scene.schedule.get());
        check_times(info);
        world.see(info.hash);
    }
    told("step_apply", pkc_step_apply(bin.get(), queue.get(), actions.data(), actions.size()));
    check_bin(bin.get());
}

// What is no file, a folder, or another kind of file.
inline void play_files(World &world) {
    Choices &in = world.in;
    const std::string paths[] = {"", "/", "/tmp", scratch_file() + "/none", scratch_file()};
    const char *const path = paths[in.below(5)].c_str();
    switch (in.below(4)) {
        case 0: {
            Policy policy;
            make("policy_load_file", policy,
                 [&](auto **to) { return pkc_policy_load_file(path, to); });
            break;
        }
        case 1: {
            Trainer trainer;
            make("trainer_load_file", trainer,
                 [&](auto **to) { return pkc_trainer_load_file(path, to); });
            break;
        }
        case 2: {
            Cell cell;
            make("cell_load_file", cell, [&](auto **to) { return pkc_cell_load_file(path, to); });
            break;
        }
        default:
            if (world.cells[0])
                told("cell_save_file", pkc_cell_save_file(world.cells[0].get(), path));
    }
}

inline void optimise_layout(World &world) {
    Choices &in = world.in;
    Cell &cell = world.cells[in.below(2)];
    if (!cell || !in.seldom(3)) return;
    const pkc_scenario scenario = draw_scenario(in);
    auto options = initialised<pkc_layout_options, pkc_layout_options_init>();
    auto info = initialised<pkc_layout_info, pkc_layout_info_init>();
    options.evaluations = std::min(in.number(10, 20), 50);
    options.range = in.real(0.01, 0.5);
    Cell better;
    const pkc_status status = make("cell_optimize_layout", better, [&](auto **to) {
        return pkc_cell_optimize_layout(cell.get(), &scenario, &options, &info, to);
    });
    if (status != PKC_OK) return;
    check(info.after <= info.before && info.after > 0, "a layout is worse");
    check(told("cell_check", pkc_cell_check(better.get(), &scenario)) == PKC_OK,
          "a layout does not reach what it is for");
    cell = std::move(better);
}

// A policy that was learned and a bin that it serves.
inline void measure_policy(World &world) {
    Choices &in = world.in;
    const Policy &policy = world.policies[in.below(2)];
    if (!policy) return;
    auto served = initialised<pkc_policy_info, pkc_policy_info_init>();
    must("policy_get_info", pkc_policy_get_info(policy.get(), &served));
    auto options = initialised<pkc_trainer_options, pkc_trainer_options_init>();
    options.bin_w = served.bin_w > 0 && !in.seldom(8) ? served.bin_w : in.number(1, 9);
    options.bin_h = served.bin_h > 0 && !in.seldom(8) ? served.bin_h : in.number(1, 9);
    options.most_side = in.number(1, 3);
    options.items = in.seldom(4) ? in.from(0, 9) : 0;
    options.rotation = in.number(0, 2);
    Bin bin;
    if (make("bin_create", bin,
             [&](auto **to) { return pkc_bin_create(options.bin_w, options.bin_h, to); }) == PKC_OK)
        world.scenes[2].bin = std::move(bin);
    double mean = -7, width = -7;
    if (call(
            "policy_measure",
            [&] { return pkc_policy_measure(policy.get(), &options, 1, 2, &mean, &width); }, mean,
            width) == PKC_OK)
        check(mean >= 0 && mean <= 1, "a mean utilisation");
}

}  // namespace packcell_fuzz
