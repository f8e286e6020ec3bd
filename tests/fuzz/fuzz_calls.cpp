// Calls of packcell.h in any order, with any values: whatever they are, none crashes, hangs or
// fails by a fault of packcell's own, one that fails changes nothing, no item is lost or doubled,
// and what the planner gives is legal. calls/ has the plays; they see the public header alone.
//
// With libFuzzer (`make fuzz`) this is the fuzzer's target. Without it, it is a program that makes
// the bytes by random numbers of its own:
//   fuzz_calls [--count N] [--seed S]
// N plays, 60 by default, 5000 with PACKCELL_CHECK_ALL=1. Other arguments are ignored.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "fuzz/calls/cell.hpp"
#include "fuzz/calls/feed.hpp"
#include "fuzz/calls/learning.hpp"
#include "fuzz/calls/misc.hpp"
#include "fuzz/calls/planning.hpp"
#include "fuzz/calls/steps.hpp"
#include "support/splitmix.hpp"

using namespace packcell_fuzz;

namespace {

constexpr int kMostActs = 120;

// Handles go in any order, also those that others were made from.
void free_one(World &world) {
    Choices &in = world.in;
    switch (in.below(10)) {
        case 0:
            world.scene().bin.reset();
            break;
        case 1:
            world.scene().queue.reset();
            break;
        case 2:
            world.scene().schedule.reset();
            break;
        case 3:
        case 4:
            world.policies[in.below(2)].reset();
            break;
        case 5:
        case 6:
            world.cells[in.below(2)].reset();
            break;
        case 7:
            world.simulations[in.below(2)].reset();
            break;
        case 8:
            world.trainer.reset();
            break;
        default:
            world.plannings[in.below(2)] = Planning();
    }
}

// What most plays need: a scene that a planner and a schedule can work on.
void set_up(World &world) {
    Scene &scene = world.scenes[0];
    new_cell(world);
    new_bin(world, scene);
    new_queue(world, scene);
    for (int n = world.in.below(10); n > 0 && scene.queue; --n) {
        const pkc_item item = draw_item(world);
        on_queue("queue_push", scene.queue.get(),
                 [&] { return pkc_queue_push(scene.queue.get(), &item); });
    }
    new_planner(world);
    new_schedule(world);
}

void act(World &world) {
    using Play = void (*)(World &);
    static constexpr struct {
        int share;
        Play play;
    } plays[] = {
        {24, change_queue},  {16, change_bin},      {24, play_step},      {24, play_plan},
        {4, save_snapshot},  {4, load_snapshot},    {4, new_planner},     {4, begin_plan},
        {10, step_plan},     {4, slice_plan},       {6, pack_exactly},    {4, new_policy},
        {2, reload_policy},  {6, ask_policy},       {4, new_cell},        {4, ask_cell},
        {6, new_schedule},   {3, sample},           {4, put_aside},       {4, simulate},
        {3, trace},          {6, play_environment}, {6, play_trainer},    {4, generate},
        {2, play_grid},      {2, play_name},        {4, play_structs},    {4, play_nulls},
        {4, play_long_step}, {2, play_files},       {2, optimise_layout}, {3, measure_policy},
        {4, free_one},
    };
    int total = 0;
    for (const auto &p : plays) total += p.share;
    int drawn = static_cast<int>(world.in.word() % static_cast<uint32_t>(total));
    for (const auto &p : plays) {
        drawn -= p.share;
        if (drawn < 0) return p.play(world);
    }
}

uint64_t play(const uint8_t *data, size_t size) {
    World world(data, size);
    set_up(world);
    for (int acts = 0; acts < kMostActs && !world.in.over(); ++acts) act(world);
    return world.seen;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

extern "C" int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    play(data, size);
    return 0;
}

#ifndef PACKCELL_LIBFUZZER

namespace {

Bytes draw_bytes(uint64_t seed) {
    uint64_t state = seed * 0x2545f4914f6cdd1du;
    Bytes bytes(1 + next_random(state) % 3000);
    for (uint8_t &byte : bytes) byte = static_cast<uint8_t>(next_random(state));
    return bytes;
}

}  // namespace

int main(int argc, char **argv) {
    uint64_t count = 60;
    const char *all_asked = std::getenv("PACKCELL_CHECK_ALL");
    if (all_asked != nullptr && std::strcmp(all_asked, "1") == 0) count = 5000;
    uint64_t seed = 1;
    for (int i = 1; i < argc; ++i) {
        const bool is_count = std::strcmp(argv[i], "--count") == 0;
        if ((is_count || std::strcmp(argv[i], "--seed") == 0) && i + 1 < argc)
            (is_count ? count : seed) = std::strtoull(argv[++i], nullptr, 10);
    }
    std::printf("fuzz_calls: %llu plays, --seed %llu\n", static_cast<unsigned long long>(count),
                static_cast<unsigned long long>(seed));
    std::fflush(stdout);
    const auto start = std::chrono::steady_clock::now();
    for (uint64_t i = 0; i < count; ++i) {
        // Each play has its own numbers: --seed S+i --count 1 gives play i alone.
        current_input() = "(--seed " + std::to_string(seed + i) + " --count 1)";
        const Bytes bytes = draw_bytes(seed + i);
        const uint64_t seen = play(bytes.data(), bytes.size());
        if (i % 16 == 0)
            check(play(bytes.data(), bytes.size()) == seen,
                  "a play is another one the second time");
    }
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    for (const auto &[what, times] : outcomes) {
        std::printf("  %-22s %-18s %llu\n", what.first.c_str(), pkc_status_name(what.second),
                    static_cast<unsigned long long>(times));
    }
    std::printf("  %.1f s\n", seconds.count());
    return 0;
}

#endif
