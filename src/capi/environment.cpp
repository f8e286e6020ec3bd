#include "learn/environment_batch.h"

#include "capi/handles.h"

using namespace packcell;

namespace {

constexpr int32_t kMostBins = 65536;
constexpr int64_t kMostCells = int64_t{1} << 24;

pkc_environment_options default_options() {
    const Protocol p;
    return {sizeof(pkc_environment_options),
            1,
            p.bin_w,
            p.bin_h,
            p.least_side,
            p.most_side,
            p.items,
            PKC_ROTATION_OFF,
            0};
}

EnvironmentBatch make_batch(const pkc_environment_options &o) {
    require_range("count", o.count, 1, kMostBins);
    require_finite("reward_fill", o.reward_fill, 0, 1);
    const Protocol protocol = checked_protocol(o);
    const int64_t cells = int64_t{o.count} * o.bin_w * o.bin_h;
    if (cells > kMostCells) {
        fail(Status::kLimit, "%d bins of %d x %d cells: at most %lld cells in all", o.count,
             o.bin_w, o.bin_h, static_cast<long long>(kMostCells));
    }
    return EnvironmentBatch(protocol, o.count, o.reward_fill);
}

void require_count(const char *what, size_t count, const EnvironmentBatch &batch) {
    if (count != batch.count())
        fail(Status::kArgument, "%zu %s: must be %zu", count, what, batch.count());
}

}  // namespace

extern "C" {

pkc_status pkc_environment_options_init(pkc_environment_options *options, size_t size) {
    return guard([&] { init_struct("options", options, size, default_options()); });
}

pkc_status pkc_environment_create(const pkc_environment_options *options,
                                  pkc_environment **out_environment) {
    return guard([&] {
        require(out_environment, "out_environment");
        const pkc_environment_options o = options == nullptr
                                              ? default_options()
                                              : read_struct("options", options, default_options());
        *out_environment = new pkc_environment(make_batch(o));
    });
}

void pkc_environment_free(pkc_environment *environment) { delete environment; }

pkc_status pkc_environment_clone(const pkc_environment *environment,
                                 pkc_environment **out_environment) {
    return guard([&] {
        require(out_environment, "out_environment");
        const Use<const pkc_environment> use("environment", environment);
        *out_environment = new pkc_environment(use->batch);
    });
}

pkc_status pkc_environment_info_init(pkc_environment_info *info, size_t size) {
    return guard([&] { init_struct("info", info, size, pkc_environment_info()); });
}

pkc_status pkc_environment_get_info(const pkc_environment *environment,
                                    pkc_environment_info *info) {
    return guard([&] {
        const Use<const pkc_environment> use("environment", environment);
        const EnvironmentBatch &batch = use->batch;
        const pkc_environment_info found = {sizeof found,
                                            static_cast<int32_t>(batch.count()),
                                            batch.protocol().bin_w,
                                            batch.protocol().bin_h,
                                            static_cast<int32_t>(batch.actions()),
                                            static_cast<int32_t>(batch.closed_now()),
                                            batch.items_placed(),
                                            batch.bins_closed()};
        write_struct("info", info, found);
    });
}

pkc_status pkc_environment_reset(pkc_environment *environment, const uint64_t *seeds,
                                 size_t count) {
    return guard([&] {
        const Use<pkc_environment> use("environment", environment);
        if (count == 0) return use->batch.open_all();
        require(seeds, "seeds");
        if (count != 1 && count != use->batch.count()) {
            fail(Status::kArgument, "%zu seeds: must be 0, 1 or %zu", count, use->batch.count());
        }
        use->batch.reseed(seeds, count);
    });
}

pkc_status pkc_environment_step(pkc_environment *environment, const int32_t *actions, size_t count,
                                double *out_rewards, int32_t *out_contacts,
                                uint8_t *out_closed_flags) {
    return guard([&] {
        const Use<pkc_environment> use("environment", environment);
        require(actions, "actions");
        EnvironmentBatch &batch = use->batch;
        require_count("actions", count, batch);
        batch.step(actions);
        for (size_t i = 0; i < count; ++i) {
            if (out_rewards != nullptr) out_rewards[i] = batch.reward(i);
            if (out_contacts != nullptr) out_contacts[i] = batch.contact(i);
            if (out_closed_flags != nullptr) out_closed_flags[i] = batch.closed(i) ? 1 : 0;
        }
    });
}

pkc_status pkc_environment_open(pkc_environment *environment) {
    return guard([&] {
        const Use<pkc_environment> use("environment", environment);
        use->batch.open_closed();
    });
}

pkc_status pkc_environment_observe(const pkc_environment *environment, const int32_t *indices,
                                   size_t count, uint8_t *out_cells, int32_t *out_sizes,
                                   uint8_t *out_mask, int32_t *out_occupied_cells) {
    return guard([&] {
        const Use<const pkc_environment> use("environment", environment);
        const EnvironmentBatch &batch = use->batch;
        if (indices == nullptr) require_count("bins", count, batch);
        const auto last = static_cast<int64_t>(batch.count()) - 1;
        for (size_t k = 0; indices != nullptr && k < count; ++k)
            require_range("index", indices[k], 0, last);
        for (size_t k = 0; k < count; ++k) {
            const size_t i = indices == nullptr ? k : static_cast<size_t>(indices[k]);
            if (out_cells != nullptr) batch.write_cells(i, out_cells + k * batch.cells());
            if (out_mask != nullptr) batch.write_mask(i, out_mask + k * batch.actions());
            if (out_occupied_cells != nullptr) out_occupied_cells[k] = batch.occupied(i);
            if (out_sizes == nullptr) continue;
            const Size item = batch.item(i);
            out_sizes[2 * k] = item.w;
            out_sizes[2 * k + 1] = item.h;
        }
    });
}

}  // extern "C"
