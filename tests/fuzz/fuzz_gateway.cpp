// The gateway's protocol core under arbitrary requests: bytes become writes, ticks, planner's
// answers, journal failures and restarts, and what core_checks.hpp says must hold after each.
//
// With libFuzzer (`make fuzz`) this is the fuzzer's target. Without it, it is a program that makes
// the bytes by random numbers of its own:
//   fuzz_gateway [--count N] [--seed S]
// N requests at least, 200000 by default, 10 million with PACKCELL_CHECK_ALL=1.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <vector>

#include "gateway/core_play.hpp"
#include "support/splitmix.hpp"

using namespace packcell_programs;

namespace {

Play::Reached total;
uint64_t current = 0;  // seed of the input that is played

SmallPlanner &planner() {
    static SmallPlanner one;
    return one;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

extern "C" int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    try {
        Play play(data, size, planner());
        play.run();
        const Play::Reached reached = play.reached();
        total.requests += reached.requests;
        total.commands += reached.commands;
        total.plans += reached.plans;
        total.placed += reached.placed;
        total.resolved += reached.resolved;
        total.restarts += reached.restarts;
        total.failures += reached.failures;
    } catch (const std::exception &error) {
        std::fprintf(stderr, "fuzz_gateway: %s (--seed %llu --count 1)\n", error.what(),
                     static_cast<unsigned long long>(current));
        std::abort();
    }
    return 0;
}

#ifndef PACKCELL_LIBFUZZER

int main(int argc, char **argv) {
    uint64_t count = 200000;
    const char *all = std::getenv("PACKCELL_CHECK_ALL");
    if (all != nullptr && std::strcmp(all, "1") == 0) count = 10000000;
    uint64_t seed = 1;
    for (int i = 1; i + 1 < argc; i += 2) {
        const bool is_count = std::strcmp(argv[i], "--count") == 0;
        (is_count ? count : seed) = std::strtoull(argv[i + 1], nullptr, 10);
    }
    std::printf("fuzz_gateway: %llu requests, --seed %llu\n",
                static_cast<unsigned long long>(count), static_cast<unsigned long long>(seed));
    std::fflush(stdout);
    const auto start = std::chrono::steady_clock::now();
    std::vector<uint8_t> bytes;
    for (uint64_t i = 0; total.requests < count; ++i) {
        // Each input has its own numbers: --seed S+i --count 1 gives input i alone.
        uint64_t state = (seed + i) * 0x2545f4914f6cdd1du;
        bytes.resize(1 + next_random(state) % 1500);
        for (uint8_t &byte : bytes) byte = static_cast<uint8_t>(next_random(state));
        // Long runs of one kind of act come about by repeated stretches.
        if (next_random(state) % 2 == 0 && bytes.size() > 64) {
            const size_t from = next_random(state) % (bytes.size() / 2);
            const size_t length = 1 + next_random(state) % 32;
            for (size_t k = from + length; k < bytes.size(); ++k) bytes[k] = bytes[k - length];
        }
        current = seed + i;
        LLVMFuzzerTestOneInput(bytes.data(), bytes.size());
    }
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    const auto show = [](const char *what, uint64_t n) {
        std::printf("  %-10s %llu\n", what, static_cast<unsigned long long>(n));
    };
    show("requests", total.requests);
    show("commands", total.commands);
    show("placed", total.placed);
    show("plans", total.plans);
    show("resolved", total.resolved);
    show("restarts", total.restarts);
    show("failures", total.failures);
    std::printf("  %.0f requests a second\n",
                static_cast<double>(total.requests) / seconds.count());
    const bool idle = count >= 200000 && (total.plans == 0 || total.placed == 0 ||
                                          total.resolved == 0 || total.restarts == 0);
    return idle ? 1 : 0;
}

#endif
