// Plays with generators, environments and trainers.
#pragma once

#include "fuzz/calls/cell.hpp"

namespace packcell_fuzz {

// ---- Generators --------------------------------------------------------------------------------

inline void generate(World &world) {
    Choices &in = world.in;
    if (!world.generator || in.seldom(4)) {
        auto options = initialised<pkc_generator_options, pkc_generator_options_init>();
        told("generator_preset", pkc_generator_preset(&options, in.seldom(20)  ? "none"
                                                                : in.seldom(2) ? "text"
                                                                               : "table"));
        options.kind = in.number(1, 2);
        options.w = in.number(1, 12);
        options.h = in.number(1, 12);
        if (in.seldom(3)) options.mean = in.real(0.1, 1);
        if (in.seldom(3)) options.sigma = in.real(0.1, 5);
        options.seed = in.byte();
        make("generator_create", world.generator,
             [&](auto **to) { return pkc_generator_create(&options, to); });
    }
    if (!world.generator) return;
    std::vector<pkc_item> items;
    const auto next = [&](pkc_item *to, size_t capacity, size_t *count) {
        return pkc_generator_next(world.generator.get(), to, capacity, count);
    };
    const size_t capacity = in.capacity(static_cast<size_t>(in.from(0, 200)));
    if (fill("generator_next", capacity, items, next) != PKC_OK) return;
    for (const pkc_item &item : items) {
        check(item.id >= 0 && item.w >= 1 && item.w <= PKC_MAX_SIDE && item.h >= 1 &&
                  item.h <= PKC_MAX_SIDE && item.flags == 0,
              "a generated item");
        world.see(static_cast<uint64_t>(item.w) << 32 | static_cast<uint64_t>(item.h));
    }
    const Scene &scene = world.scene();
    if (!scene.queue) return;
    for (size_t i = 0; i < items.size() && i < 12; ++i) {
        items[i].id = world.next_id++;
        told("queue_push", pkc_queue_push(scene.queue.get(), &items[i]));
    }
}

// ---- Environments ------------------------------------------------------------------------------

inline pkc_environment_info info_of(const pkc_environment *environment) {
    auto info = initialised<pkc_environment_info, pkc_environment_info_init>();
    must("environment_get_info", pkc_environment_get_info(environment, &info));
    return info;
}

struct Seen {
    Bytes cells;
    std::vector<int32_t> sizes;
    Bytes mask;
    std::vector<int32_t> occupied;

    bool operator==(const Seen &o) const {
        return cells == o.cells && sizes == o.sizes && mask == o.mask && occupied == o.occupied;
    }
};

inline Seen observe(const pkc_environment *environment) {
    const pkc_environment_info info = info_of(environment);
    const auto count = static_cast<size_t>(info.count);
    const auto cells = static_cast<size_t>(info.bin_w * info.bin_h);
    Seen seen = {Bytes(count * cells), std::vector<int32_t>(2 * count),
                 Bytes(count * static_cast<size_t>(info.actions)), std::vector<int32_t>(count)};
    must("environment_observe",
         pkc_environment_observe(environment, nullptr, count, seen.cells.data(), seen.sizes.data(),
                                 seen.mask.data(), seen.occupied.data()));
    for (size_t i = 0; i < count; ++i) {
        const auto taken = std::count(
            seen.cells.begin() + static_cast<std::ptrdiff_t>(i * cells),
            seen.cells.begin() + static_cast<std::ptrdiff_t>((i + 1) * cells), uint8_t{1});
        check(taken == seen.occupied[i], "an environment's cells are not counted");
    }
    return seen;
}

inline void new_environment(World &world) {
    Choices &in = world.in;
    auto options = initialised<pkc_environment_options, pkc_environment_options_init>();
    options.count = std::min(in.number(1, 5), 5000);
    options.bin_w = in.number(1, 9);
    options.bin_h = in.number(1, 9);
    options.least_side = in.number(1, 2);
    options.most_side = in.number(1, 4);
    options.items = in.seldom(4) ? in.number(0, 9) : 0;
    options.rotation = in.number(0, 2);
    options.reward_fill = in.real(0, 1);
    make("environment_create", world.environment,
         [&](auto **to) { return pkc_environment_create(&options, to); });
}

inline void step_environment(World &world, pkc_environment *environment) {
    Choices &in = world.in;
    const pkc_environment_info before = info_of(environment);
    const Seen seen = observe(environment);
    std::vector<int32_t> actions;
    for (int32_t i = 0; i < before.count; ++i) {
        const auto begin = static_cast<size_t>(i) * static_cast<size_t>(before.actions);
        int32_t action = in.below(before.actions);
        for (int32_t k = 0;
             k < before.actions && seen.mask[begin + static_cast<size_t>(action)] == 0; ++k)
            action = (action + 1) % before.actions;
        actions.push_back(in.seldom(60) ? in.number(0, before.actions) : action);
    }
    if (in.seldom(30)) actions.push_back(0);
    const size_t count = actions.size();
    std::vector<double> rewards(count, -7);
    std::vector<int32_t> contacts(count, -7);
    Bytes closed(count, 7);
    const pkc_status status =
        told("environment_step",
             pkc_environment_step(environment, actions.data(), count, rewards.data(),
                                  in.seldom(3) ? nullptr : contacts.data(), closed.data()));
    const pkc_environment_info after = info_of(environment);
    for (size_t i = 0; i < count; ++i) {
        check((closed[i] == 7) == (status != PKC_OK), "an output is changed or not");
        check(std::isfinite(rewards[i]), "a reward");
    }
    if (status != PKC_OK) {
        check(observe(environment) == seen && after.steps == before.steps &&
                  after.bins == before.bins,
              "a step that fails changes an environment");
    } else {
        check(before.closed == 0 && after.steps == before.steps + count, "steps are not counted");
    }
    world.see(after.steps * 1000 + after.bins);
}

inline void play_environment(World &world) {
    Choices &in = world.in;
    if (!world.environment) return new_environment(world);
    pkc_environment *const environment = world.environment.get();
    switch (in.below(12)) {
        case 0:
            if (in.seldom(4)) return new_environment(world);
            break;
        case 1: {
            std::vector<uint64_t> seeds(static_cast<size_t>(in.number(0, 5)) % 70, in.byte());
            told("environment_reset",
                 pkc_environment_reset(environment, seeds.data(), seeds.size()));
            break;
        }
        case 2: {
            Environment copy;
            make("environment_clone", copy,
                 [&](auto **to) { return pkc_environment_clone(environment, to); });
            check(observe(copy.get()) == observe(environment), "a copy is another environment");
            if (in.seldom(2)) world.environment = std::move(copy);
            break;
        }
        case 3: {
            std::vector<int32_t> indices;
            for (int n = in.below(6); n > 0; --n) indices.push_back(in.number(0, 4));
            const auto count = indices.size();
            const pkc_environment_info info = info_of(environment);
            std::vector<int32_t> sizes(2 * count);
            Bytes mask(count * static_cast<size_t>(info.actions));
            told("environment_observe",
                 pkc_environment_observe(environment, count > 0 ? indices.data() : nullptr, count,
                                         nullptr, sizes.data(), mask.data(), nullptr));
            break;
        }
        case 4:
            must("environment_open", pkc_environment_open(environment));
            check(info_of(environment).closed == 0, "a bin is closed still");
            break;
        default:
            if (info_of(environment).closed > 0 && !in.seldom(12))
                must("environment_open", pkc_environment_open(environment));
            step_environment(world, environment);
    }
}

// ---- Trainers ----------------------------------------------------------------------------------

inline pkc_trainer_info info_of(const pkc_trainer *trainer) {
    auto info = initialised<pkc_trainer_info, pkc_trainer_info_init>();
    must("trainer_get_info", pkc_trainer_get_info(trainer, &info));
    return info;
}

inline void new_trainer(World &world) {
    Choices &in = world.in;
    auto options = initialised<pkc_trainer_options, pkc_trainer_options_init>();
    options.learner = in.number(1, 2);
    options.architecture = in.number(1, 2);
    options.bin_w = in.number(3, 5);
    options.bin_h = in.number(3, 5);
    options.least_side = in.number(1, 2);
    options.most_side = in.number(1, 3);
    options.items = in.seldom(4) ? in.number(0, 9) : 0;
    options.rotation = in.number(0, 2);
    const auto few = [&](int most) { return std::min(in.number(1, most), 128); };
    options.workers = std::min(few(2), 4);
    options.environments = std::min(few(3), 8);
    options.steps = std::min(few(3), 8);
    options.channels = few(3);
    options.features = few(6);
    options.hidden = few(6);
    options.seed = in.byte();
    options.anneal = in.below(4);
    options.gamma = in.real(0, 1);
    options.learning_rate = in.real(1e-4, 1);
    options.entropy = in.real(0, 1);
    options.value_weight = in.real(0, 1);
    options.clip = in.real(0.1, 10);
    options.reward_fill = in.real(0, 1);
    std::memcpy(options.name, "fuzzed", 7);
    if (in.seldom(20)) std::memset(options.name, in.byte(), sizeof options.name);
    make("trainer_create", world.trainer,
         [&](auto **to) { return pkc_trainer_create(&options, to); });
}

inline void reload_trainer(World &world) {
    Choices &in = world.in;
    const char *const path = scratch_file().c_str();
    must("trainer_save_file", pkc_trainer_save_file(world.trainer.get(), path));
    const Bytes saved = read_file(scratch_file());
    Bytes bytes = saved;
    const bool damaged = in.seldom(2);
    if (damaged) {
        damage(in, bytes);
        write_file(scratch_file(), bytes);
    }
    Trainer loaded;
    const pkc_status status = make("trainer_load_file", loaded,
                                   [&](auto **to) { return pkc_trainer_load_file(path, to); });
    check(status == PKC_OK || (damaged && status == PKC_E_FORMAT), "a training cannot be loaded");
    if (status != PKC_OK) return;
    must("trainer_save_file", pkc_trainer_save_file(loaded.get(), path));
    check(read_file(scratch_file()) == bytes, "a training is not saved as it was loaded");
    world.trainer = std::move(loaded);
}

inline void play_trainer(World &world) {
    Choices &in = world.in;
    if (!world.trainer || in.seldom(12)) return new_trainer(world);
    pkc_trainer *const trainer = world.trainer.get();
    switch (in.below(8)) {
        case 0:
            must("trainer_cancel", pkc_trainer_cancel(trainer));
            break;
        case 1:
            if (in.seldom(2)) reload_trainer(world);
            break;
        case 2: {
            Policy &policy = world.policies[in.below(2)];
            const pkc_status status = make("trainer_policy", policy, [&](auto **to) {
                return pkc_trainer_policy(trainer, to);
            });
            check(status == PKC_OK, "what was learned is no policy");
            break;
        }
        case 3: {
            double mean = -7, width = -7;
            const int32_t rotation = in.number(0, 2);
            const auto bins = static_cast<uint64_t>(in.seldom(20) ? 0 : in.from(1, 3));
            const pkc_status status = call(
                "trainer_measure",
                [&] {
                    return pkc_trainer_measure(trainer, rotation, in.byte(), bins, &mean, &width);
                },
                mean, width);
            if (status != PKC_OK) break;
            check(mean >= 0 && mean <= 1 && width >= 0, "a mean utilisation");
            break;
        }
        default: {
            const pkc_trainer_info before = info_of(trainer);
            const auto updates = static_cast<uint64_t>(in.from(0, 3));
            const pkc_status status = told("trainer_run", pkc_trainer_run(trainer, updates));
            const pkc_trainer_info after = info_of(trainer);
            check(status == PKC_OK || status == PKC_E_STATE, "a training fails in another way");
            check(status != PKC_OK || after.updates == before.updates + updates,
                  "a training's updates are not counted");
            world.see(after.steps);
        }
    }
}

}  // namespace packcell_fuzz
