#include "bench/workload.hpp"

#include <algorithm>

#include "common/handles.hpp"

namespace packcell_programs {

namespace {

// Random items on 10x10 have 9 cells on average. A third more than fills a bin is never used up,
// for what is not packed comes again; the rest keeps the last bins of short streams supplied.
constexpr size_t kStreamItemsPerBin = 15;
constexpr size_t kStreamSpare = 200;

std::vector<pkc_item> next_items(pkc_generator *generator, size_t capacity) {
    std::vector<pkc_item> items(capacity);
    size_t count = 0;
    check(pkc_generator_next(generator, items.data(), items.size(), &count));
    items.resize(count);
    return items;
}

Instance make_set(pkc_generator *generator, const pkc_generator_options &options, int64_t number) {
    Instance set;
    set.id = "s" + std::to_string(number);
    set.w = options.w;
    set.h = options.h;
    set.items =
        next_items(generator, static_cast<size_t>(options.w) * static_cast<size_t>(options.h));
    return set;
}

Workload make_sets(const pkc_generator_options &options, int64_t count) {
    const GeneratorHandle generator = make_generator(options);
    auto sets = std::make_shared<std::vector<Instance>>();
    for (int64_t i = 1; i <= count; ++i) {
        sets->push_back(make_set(generator.get(), options, i));
    }
    return sets;
}

pkc_generator_options generator_options(int32_t kind, int32_t w, int32_t h, uint64_t seed) {
    auto options = initialised(pkc_generator_options_init);
    options.kind = kind;
    options.w = w;
    options.h = h;
    options.seed = seed;
    return options;
}

}  // namespace

Workload random_stream(int64_t bins, uint64_t seed) {
    const GeneratorHandle generator =
        make_generator(generator_options(PKC_GENERATE_RANDOM, kPaperSide, kPaperSide, seed));
    Instance stream;
    stream.id = "r1";
    stream.w = kPaperSide;
    stream.h = kPaperSide;
    stream.is_set = false;
    stream.bins = bins;
    stream.items =
        next_items(generator.get(), static_cast<size_t>(bins) * kStreamItemsPerBin + kStreamSpare);
    return std::make_shared<std::vector<Instance>>(1, std::move(stream));
}

Workload full_sets(int64_t count, const std::string &preset, uint64_t seed) {
    return full_sets(count, kPaperSide, kPaperSide, preset, seed);
}

Workload full_sets(int64_t count, int32_t w, int32_t h, const std::string &preset, uint64_t seed) {
    pkc_generator_options options = generator_options(PKC_GENERATE_FULL, w, h, seed);
    check(pkc_generator_preset(&options, preset.c_str()));
    return make_sets(options, count);
}

Workload square_sets(int64_t count, int32_t side, double mean, double sigma, uint64_t seed) {
    pkc_generator_options options = generator_options(PKC_GENERATE_FULL, side, side, seed);
    options.mean = mean / side;
    options.sigma = sigma;
    return make_sets(options, count);
}

size_t most_items(const std::vector<Instance> &sets) {
    size_t most = 0;
    for (const Instance &set : sets) most = std::max(most, set.items.size());
    return most;
}

double mean_items(const std::vector<Instance> &sets) {
    double sum = 0;
    for (const Instance &set : sets) sum += static_cast<double>(set.items.size());
    return sets.empty() ? 0 : sum / static_cast<double>(sets.size());
}

}  // namespace packcell_programs
