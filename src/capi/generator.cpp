#include "learn/generator.h"

#include <algorithm>

#include "capi/handles.h"

using namespace packcell;

namespace {

constexpr int64_t kMostRandom = 1 << 24;  // items of one call

pkc_generator_options default_options() {
    const GeneratorOptions o;
    return {sizeof(pkc_generator_options), PKC_GENERATE_RANDOM, o.w, o.h, o.mean, o.sigma, o.seed};
}

}  // namespace

extern "C" {

pkc_status pkc_generator_options_init(pkc_generator_options *options, size_t size) {
    return guard([&] { init_struct("options", options, size, default_options()); });
}

pkc_status pkc_generator_preset(pkc_generator_options *options, const char *preset) {
    return guard([&] {
        require(preset, "preset");
        pkc_generator_options value = read_struct("options", options, default_options());
        GeneratorOptions chosen;
        if (!set_generator_preset(chosen, preset)) {
            fail(Status::kArgument, "preset '%.40s': must be text or table", preset);
        }
        value.mean = chosen.mean;
        value.sigma = chosen.sigma;
        write_struct("options", options, value);
    });
}

pkc_status pkc_generator_create(const pkc_generator_options *options,
                                pkc_generator **out_generator) {
    return guard([&] {
        require(out_generator, "out_generator");
        const pkc_generator_options o = read_struct("options", options, default_options());
        require_range("kind", o.kind, PKC_GENERATE_RANDOM, PKC_GENERATE_FULL);
        *out_generator = new pkc_generator(o.kind, {o.w, o.h, o.mean, o.sigma, o.seed});
    });
}

void pkc_generator_free(pkc_generator *generator) { delete generator; }

pkc_status pkc_generator_next(pkc_generator *generator, pkc_item *items, size_t capacity,
                              size_t *out_count) {
    return guard([&] {
        require(out_count, "out_count");
        const Use<pkc_generator> use("generator", generator);
        std::vector<Item> &made = use->waiting;
        if (capacity > 0) require(items, "items");
        if (use->kind == PKC_GENERATE_RANDOM) {
            require_range("capacity", static_cast<int64_t>(std::min<size_t>(capacity, INT64_MAX)),
                          0, kMostRandom);
            made.clear();
            use->generator.random(made, capacity);
        } else if (made.empty()) {
            use->generator.full_set(made);
        }
        require_capacity(made.size(), capacity, out_count);
        std::transform(made.begin(), made.end(), items,
                       [](const Item &item) { return to_c(item); });
        *out_count = made.size();
        made.clear();
    });
}

}  // extern "C"
