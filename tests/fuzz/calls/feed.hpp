// Plays with bins, queues, steps and snapshots.
#pragma once

#include <algorithm>
#include <cmath>

#include "fuzz/calls/play.hpp"

namespace packcell_fuzz {

// ---- What they hold ----------------------------------------------------------------------------

inline pkc_bin_info info_of(const pkc_bin *bin) {
    auto info = initialised<pkc_bin_info, pkc_bin_info_init>();
    must("bin_get_info", pkc_bin_get_info(bin, &info));
    return info;
}

inline std::vector<pkc_placement> items_of(const pkc_bin *bin) {
    return all<pkc_placement>("bin_items", [&](auto *to, size_t capacity, size_t *count) {
        return pkc_bin_items(bin, to, capacity, count);
    });
}

inline pkc_queue_info info_of(const pkc_queue *queue) {
    auto info = initialised<pkc_queue_info, pkc_queue_info_init>();
    must("queue_get_info", pkc_queue_get_info(queue, &info));
    return info;
}

inline std::vector<pkc_queued> belt_of(const pkc_queue *queue) {
    return all<pkc_queued>("queue_belt", [&](auto *to, size_t capacity, size_t *count) {
        return pkc_queue_belt(queue, to, capacity, count);
    });
}

inline std::vector<pkc_queued> buffer_of(const pkc_queue *queue) {
    return all<pkc_queued>("queue_buffer", [&](auto *to, size_t capacity, size_t *count) {
        return pkc_queue_buffer(queue, to, capacity, count);
    });
}

inline pkc_scenario scenario_of(const pkc_queue *queue) {
    auto scenario = initialised<pkc_scenario, pkc_scenario_init>();
    must("queue_get_scenario", pkc_queue_get_scenario(queue, &scenario));
    return scenario;
}

inline Bin copy_of(const pkc_bin *bin) {
    Bin copy;
    make("bin_clone", copy, [&](auto **to) { return pkc_bin_clone(bin, to); });
    return copy;
}

inline Queue copy_of(const pkc_queue *queue) {
    Queue copy;
    make("queue_clone", copy, [&](auto **to) { return pkc_queue_clone(queue, to); });
    return copy;
}

template <class T>
void append(Bytes &bytes, const T &value) {
    const auto *at = reinterpret_cast<const uint8_t *>(&value);
    bytes.insert(bytes.end(), at, at + sizeof value);
}

// All that can be asked of a bin and of a queue.
inline Bytes print_of(const pkc_bin *bin) {
    Bytes bytes;
    append(bytes, info_of(bin));
    for (const pkc_placement &p : items_of(bin)) append(bytes, p);
    return bytes;
}

inline Bytes print_of(const pkc_queue *queue) {
    Bytes bytes;
    append(bytes, info_of(queue));
    append(bytes, scenario_of(queue));
    for (const pkc_queued &q : belt_of(queue)) append(bytes, q);
    for (const pkc_queued &q : buffer_of(queue)) append(bytes, q);
    return bytes;
}

inline void add_id(std::vector<int32_t> &ids, const pkc_placement &p) { ids.push_back(p.item.id); }
inline void add_id(std::vector<int32_t> &ids, const pkc_queued &q) { ids.push_back(q.item.id); }

inline std::vector<int32_t> ids_of(const pkc_bin *bin, const pkc_queue *queue) {
    std::vector<int32_t> ids;
    if (bin != nullptr) {
        for (const pkc_placement &p : items_of(bin)) add_id(ids, p);
    }
    if (queue != nullptr) {
        for (const pkc_queued &q : belt_of(queue)) add_id(ids, q);
        for (const pkc_queued &q : buffer_of(queue)) add_id(ids, q);
    }
    std::sort(ids.begin(), ids.end());
    return ids;
}

inline bool distinct(const std::vector<int32_t> &ids) {
    return std::adjacent_find(ids.begin(), ids.end()) == ids.end();
}

// ---- What must hold ----------------------------------------------------------------------------

inline void check_bin(const pkc_bin *bin) {
    const pkc_bin_info info = info_of(bin);
    int32_t taken = info.fixed_cells;
    const auto items = items_of(bin);
    for (const pkc_placement &p : items) {
        taken += p.item.w * p.item.h;
        const int32_t w = p.rot != 0 ? p.item.h : p.item.w;
        const int32_t h = p.rot != 0 ? p.item.w : p.item.h;
        check(p.item.id >= 0 && p.x >= 0 && p.y >= 0 && p.x + w <= info.w && p.y + h <= info.h,
              "an item lies outside of its bin");
        check(p.rot == 0 || (p.item.flags & PKC_ITEM_NO_ROTATE) == 0, "an item is turned");
    }
    check(taken == info.occupied_cells && taken <= info.w * info.h,
          "occupied cells are not those of the items and the fixed ones");
    check(static_cast<size_t>(info.items) == items.size(), "a bin's items are not counted");
    check(distinct(ids_of(bin, nullptr)), "an item is twice in a bin");
    const auto cells = all<int32_t>("bin_cells", [&](auto *to, size_t capacity, size_t *count) {
        return pkc_bin_cells(bin, to, capacity, count);
    });
    const auto free = std::count(cells.begin(), cells.end(), PKC_CELL_FREE);
    check(static_cast<int64_t>(cells.size()) - free == taken, "cells are not those of the items");
}

inline void check_queue(const pkc_queue *queue) {
    const pkc_queue_info info = info_of(queue);
    const pkc_scenario s = scenario_of(queue);
    const auto belt = belt_of(queue);
    check(static_cast<size_t>(info.belt) == belt.size(), "a belt's items are not counted");
    check(static_cast<size_t>(info.buffered) == buffer_of(queue).size(), "nor those buffered");
    check(distinct(ids_of(nullptr, queue)), "an item is twice in a queue");
    const int32_t reached = info.k_alpha + info.k_shared + info.k_beta;
    const int32_t most = s.accessible * s.robots - s.overlap * (s.robots - 1);
    check(info.k_alpha >= 0 && info.k_shared >= 0 && info.k_beta >= 0 && reached <= most &&
              reached <= info.belt,
          "a queue's regions are not within its scenario");
    check(info.belt == 0 || reached > 0, "nothing of a belt is within reach");
    const auto within =
        std::count_if(belt.begin(), belt.end(), [](const pkc_queued &q) { return q.arms != 0; });
    check(within == reached, "items within reach are not those of the regions");
}

// ---- Bins --------------------------------------------------------------------------------------

inline pkc_item draw_item(World &world, int most = 5) {
    Choices &in = world.in;
    const int32_t id = in.seldom(12) ? in.number(0, 20) : world.next_id++;
    const uint32_t flags = in.seldom(60) ? in.word() : in.seldom(8) ? in.byte() & 3u : 0u;
    return {id, in.number(1, most), in.number(1, most), flags};
}

inline void new_bin(World &world, Scene &scene) {
    const int most = world.in.seldom(30) ? 128 : 12;
    const int32_t w = world.in.number(1, most);
    const int32_t h = world.in.number(1, most);
    make("bin_create", scene.bin, [&](auto **to) { return pkc_bin_create(w, h, to); });
}

// As the cell has it, so that its schedules take the bin.
inline void new_bin_of(const pkc_cell *cell, Scene &scene) {
    auto info = initialised<pkc_cell_info, pkc_cell_info_init>();
    must("cell_get_info", pkc_cell_get_info(cell, &info));
    make("bin_create", scene.bin,
         [&](auto **to) { return pkc_bin_create(info.bin_w, info.bin_h, to); });
}

// A bin whose call fails is as before.
template <class Call>
pkc_status on_bin(const char *name, pkc_bin *bin, const Call &made) {
    const Bytes before = print_of(bin);
    const pkc_status status = told(name, made());
    if (status != PKC_OK) check(print_of(bin) == before, "a call that fails changes a bin");
    check_bin(bin);
    return status;
}

inline void change_bin(World &world) {
    Choices &in = world.in;
    Scene &scene = world.scene();
    if (!scene.bin) return new_bin(world, scene);
    pkc_bin *const bin = scene.bin.get();
    const int32_t side = 12;
    switch (in.below(10)) {
        case 0:
            if (in.seldom(6)) return new_bin(world, scene);
            break;
        case 1:
            if (in.seldom(4)) on_bin("bin_clear", bin, [&] { return pkc_bin_clear(bin); });
            break;
        case 2: {
            const int32_t x = in.number(0, side), y = in.number(0, side);
            const int32_t w = in.number(1, 2), h = in.number(1, 2);
            on_bin("bin_block", bin, [&] { return pkc_bin_block(bin, x, y, w, h); });
            break;
        }
        case 3: {
            const auto items = items_of(bin);
            const int32_t id =
                items.empty() || in.seldom(8) ? in.number(0, 30) : in.of(items).item.id;
            pkc_placement was{};
            const pkc_placement untouched = was;
            const bool asks = in.seldom(2);
            const pkc_status status = on_bin(
                "bin_unpack", bin, [&] { return pkc_bin_unpack(bin, id, asks ? &was : nullptr); });
            if (status != PKC_OK || !asks)
                check(std::memcmp(&was, &untouched, sizeof was) == 0, "an output is changed");
            break;
        }
        case 4: {
            int32_t reward = 77;
            const int32_t x = in.number(0, side), y = in.number(0, side);
            const int32_t w = in.number(1, 4), h = in.number(1, 4);
            call(
                "bin_contact", [&] { return pkc_bin_contact(bin, x, y, w, h, &reward); }, reward);
            check(reward == 77 || (reward >= 0 && reward <= 2 * (w + h)), "a contact reward");
            break;
        }
        case 5: {
            const auto copy = copy_of(bin);
            check(print_of(copy.get()) == print_of(bin), "a copy is another bin");
            break;
        }
        default: {
            const pkc_item item = draw_item(world);
            const int32_t x = in.number(0, side), y = in.number(0, side);
            const int32_t rot = in.number(0, 1);
            on_bin("bin_pack", bin, [&] { return pkc_bin_pack(bin, &item, x, y, rot); });
        }
    }
}

// ---- Queues ------------------------------------------------------------------------------------

inline pkc_scenario draw_scenario(Choices &in) {
    static const char *const names[] = {"D-R5A3O1", "D-R5A2O2", "S-R5A3",
                                        "S-R1A1",   "D-R2A2O2", "S-R5A1"};
    auto scenario = initialised<pkc_scenario, pkc_scenario_init>();
    must("scenario_parse", pkc_scenario_parse(names[in.below(6)], &scenario));
    if (in.seldom(6)) {
        scenario.robots = in.number(1, 2);
        scenario.recognized = in.number(1, 9);
        scenario.accessible = in.number(1, 6);
        scenario.overlap = in.number(0, 3);
    }
    return scenario;
}

inline void new_queue(World &world, Scene &scene) {
    const pkc_scenario scenario = draw_scenario(world.in);
    make("queue_create", scene.queue, [&](auto **to) { return pkc_queue_create(&scenario, to); });
}

template <class Call>
pkc_status on_queue(const char *name, pkc_queue *queue, const Call &made) {
    const Bytes before = print_of(queue);
    const pkc_status status = told(name, made());
    if (status != PKC_OK) check(print_of(queue) == before, "a call that fails changes a queue");
    check_queue(queue);
    return status;
}

inline int32_t draw_queued(World &world, const pkc_queue *queue) {
    const auto ids = ids_of(nullptr, queue);
    return ids.empty() || world.in.seldom(8) ? world.in.number(0, 30) : world.in.of(ids);
}

inline void change_queue(World &world) {
    Choices &in = world.in;
    Scene &scene = world.scene();
    if (!scene.queue) return new_queue(world, scene);
    pkc_queue *const queue = scene.queue.get();
    switch (in.below(12)) {
        case 0:
            if (in.seldom(8)) return new_queue(world, scene);
            break;
        case 1: {
            const int32_t id = draw_queued(world, queue);
            on_queue("queue_remove", queue, [&] { return pkc_queue_remove(queue, id); });
            break;
        }
        case 2: {
            std::vector<int32_t> ids;
            for (int n = in.below(4); n > 0; --n) ids.push_back(draw_queued(world, queue));
            on_queue("queue_remove_items", queue,
                     [&] { return pkc_queue_remove_items(queue, ids.data(), ids.size()); });
            break;
        }
        case 3: {
            const pkc_item item = draw_item(world);
            const int32_t arm = in.number(0, 1);
            on_queue("queue_put_in_buffer", queue,
                     [&] { return pkc_queue_put_in_buffer(queue, &item, arm); });
            break;
        }
        case 4: {
            const int32_t left = in.number(0, 4);
            on_queue("queue_set_alpha_left", queue,
                     [&] { return pkc_queue_set_alpha_left(queue, left); });
            break;
        }
        case 5: {
            const auto copy = copy_of(queue);
            check(print_of(copy.get()) == print_of(queue), "a copy is another queue");
            break;
        }
        default:
            for (int n = in.from(1, 4); n > 0; --n) {
                const pkc_item item = draw_item(world);
                on_queue("queue_push", queue, [&] { return pkc_queue_push(queue, &item); });
            }
    }
}

// ---- Snapshots ---------------------------------------------------------------------------------

inline void save_snapshot(World &world) {
    Scene &scene = world.scene();
    if (!scene.bin || !scene.queue) return;
    const auto save = [&](uint8_t *to, size_t capacity, size_t *size) {
        return pkc_snapshot_save(scene.bin.get(), scene.queue.get(), to, capacity, size);
    };
    if (!distinct(ids_of(scene.bin.get(), scene.queue.get()))) {
        uint8_t byte = 0;
        size_t size = 0;
        check(told("snapshot_save", save(&byte, 1, &size)) == PKC_E_STATE && size == 0,
              "an item is twice in a snapshot");
        return;
    }
    world.snapshot = all<uint8_t>("snapshot_save", save);
    Bytes some;
    fill("snapshot_save", world.in.capacity(world.snapshot.size()), some, save);
}

inline void load_snapshot(World &world) {
    Choices &in = world.in;
    Bytes bytes = world.snapshot;
    const bool damaged = in.seldom(2);
    if (damaged) damage(in, bytes);
    if (bytes.empty()) bytes.push_back(in.byte());
    pkc_bin *bin = nullptr;
    pkc_queue *queue = nullptr;
    const pkc_status status = call(
        "snapshot_load",
        [&] { return pkc_snapshot_load(bytes.data(), bytes.size(), &bin, &queue); }, bin, queue);
    check(status == PKC_OK || status == PKC_E_FORMAT, "a snapshot fails by another status");
    if (world.snapshot.empty() || status != PKC_OK) {
        check(damaged || world.snapshot.empty(), "a snapshot cannot be loaded");
        return;
    }
    Scene &scene = world.scene();
    scene.bin.reset(bin);
    scene.queue.reset(queue);
    check_bin(bin);
    check_queue(queue);
    const Bytes again = all<uint8_t>("snapshot_save", [&](auto *to, size_t capacity, size_t *size) {
        return pkc_snapshot_save(bin, queue, to, capacity, size);
    });
    check(again == bytes, "a snapshot is not saved as it was loaded");
}

}  // namespace packcell_fuzz
