#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include "capi/handles.h"
#include "feed/snapshot.h"

using namespace packcell;

namespace {

std::vector<Action> to_core(const pkc_action *actions, size_t count) {
    if (count > 0) require(actions, "actions");
    std::vector<Action> core;
    core.reserve(count);
    for (size_t i = 0; i < count; ++i) {
        const pkc_action &a = actions[i];
        core.push_back({a.op, a.item, a.x, a.y, a.rot, a.arm});
    }
    return core;
}

pkc_queue_info default_info() { return {sizeof(pkc_queue_info), 0, 0, 0, 0, 0, 0}; }

// Places on the belt and indices in the buffer of the items to go, each ascending.
struct Leaving {
    std::vector<int> places;
    std::vector<int> buffered;
};

Leaving find_leaving(const Queue &queue, const int32_t *ids, size_t count) {
    Leaving leaving;
    for (size_t i = 0; i < count; ++i) {
        const int place = queue.find_belt(ids[i]);
        const int buffered = queue.find_buffer(ids[i]);
        if (place < 0 && buffered < 0)
            fail(Status::kState, "ids[%zu] %d: is not in the queue", i, ids[i]);
        std::vector<int> &list = place >= 0 ? leaving.places : leaving.buffered;
        const int index = place >= 0 ? place : buffered;
        const auto at = std::lower_bound(list.begin(), list.end(), index);
        if (at != list.end() && *at == index)
            fail(Status::kState, "ids[%zu] %d: is named twice", i, ids[i]);
        list.insert(at, index);
    }
    return leaving;
}

}  // namespace

extern "C" {

pkc_status pkc_scenario_init(pkc_scenario *scenario, size_t size) {
    return guard([&] { init_struct("scenario", scenario, size, to_c(Scenario())); });
}

pkc_status pkc_scenario_parse(const char *name, pkc_scenario *scenario) {
    return guard([&] {
        require(name, "name");
        write_struct("scenario", scenario, to_c(parse_scenario(name)));
    });
}

pkc_status pkc_scenario_name(const pkc_scenario *scenario, char *name, size_t capacity) {
    return guard([&] {
        const Scenario s = checked_scenario(scenario);
        char text[32];
        name_scenario(s, text, sizeof text);
        const std::string full(text);
        if (full.size() + 1 > capacity) {
            fail(Status::kCapacity, "capacity %zu: %zu bytes are needed", capacity,
                 full.size() + 1);
        }
        require(name, "name");
        std::snprintf(name, capacity, "%s", text);
    });
}

pkc_status pkc_queue_info_init(pkc_queue_info *info, size_t size) {
    return guard([&] { init_struct("info", info, size, default_info()); });
}

pkc_status pkc_queue_create(const pkc_scenario *scenario, pkc_queue **out_queue) {
    return guard([&] {
        require(out_queue, "out_queue");
        *out_queue = new pkc_queue(Queue(checked_scenario(scenario)));
    });
}

void pkc_queue_free(pkc_queue *queue) { delete queue; }

pkc_status pkc_queue_clone(const pkc_queue *queue, pkc_queue **out_queue) {
    return guard([&] {
        require(out_queue, "out_queue");
        const Use<const pkc_queue> use("queue", queue);
        *out_queue = new pkc_queue(use->queue);
    });
}

pkc_status pkc_queue_push(pkc_queue *queue, const pkc_item *item) {
    return guard([&] {
        const Use<pkc_queue> use("queue", queue);
        const Item checked = checked_item("item", item);
        if (use->queue.holds(checked.id))
            fail(Status::kState, "item %d: is in the queue already", checked.id);
        use->queue.push(checked);
    });
}

pkc_status pkc_queue_remove(pkc_queue *queue, int32_t id) {
    return guard([&] {
        const Use<pkc_queue> use("queue", queue);
        Queue &q = use->queue;
        const int place = q.find_belt(id);
        const int buffered = q.find_buffer(id);
        if (place < 0 && buffered < 0) fail(Status::kState, "item %d: is not in the queue", id);
        if (place >= 0) {
            q.take({place});
        } else {
            q.take_from_buffer(static_cast<size_t>(buffered));
        }
    });
}

pkc_status pkc_queue_remove_items(pkc_queue *queue, const int32_t *ids, size_t count) {
    return guard([&] {
        const Use<pkc_queue> use("queue", queue);
        if (count > 0) require(ids, "ids");
        const Leaving leaving = find_leaving(use->queue, ids, count);
        for (auto index = leaving.buffered.rbegin(); index != leaving.buffered.rend(); ++index)
            use->queue.take_from_buffer(static_cast<size_t>(*index));
        use->queue.take(leaving.places);
    });
}

pkc_status pkc_queue_put_in_buffer(pkc_queue *queue, const pkc_item *item, int32_t arm) {
    return guard([&] {
        const Use<pkc_queue> use("queue", queue);
        const Item checked = checked_item("item", item);
        if (arm < 0 || arm >= use->queue.scenario().robots)
            fail(Status::kArgument, "arm %d: must be one of the scenario's", arm);
        if (use->queue.holds(checked.id))
            fail(Status::kState, "item %d: is in the queue already", checked.id);
        use->queue.put_in_buffer({checked, arm});
    });
}

pkc_status pkc_queue_set_alpha_left(pkc_queue *queue, int32_t alpha_left) {
    return guard([&] {
        const Use<pkc_queue> use("queue", queue);
        if (alpha_left < 0 || alpha_left > kMaxRecognized)
            fail(Status::kArgument, "alpha_left %d: must be 0..%d", alpha_left, kMaxRecognized);
        use->queue.set_alpha_left(alpha_left);
    });
}

pkc_status pkc_queue_get_scenario(const pkc_queue *queue, pkc_scenario *scenario) {
    return guard([&] {
        const Use<const pkc_queue> use("queue", queue);
        write_struct("scenario", scenario, to_c(use->queue.scenario()));
    });
}

pkc_status pkc_queue_get_info(const pkc_queue *queue, pkc_queue_info *info) {
    return guard([&] {
        const Use<const pkc_queue> use("queue", queue);
        const Queue &q = use->queue;
        pkc_queue_info value = default_info();
        value.belt = static_cast<int32_t>(q.belt_size());
        value.buffered = static_cast<int32_t>(q.buffer().size());
        value.k_alpha = q.regions().alpha;
        value.k_shared = q.regions().shared;
        value.k_beta = q.regions().beta;
        value.alpha_left = q.alpha_left();
        write_struct("info", info, value);
    });
}

pkc_status pkc_queue_belt(const pkc_queue *queue, pkc_queued *items, size_t capacity,
                          size_t *out_count) {
    return guard([&] {
        const Use<const pkc_queue> use("queue", queue);
        const Queue &q = use->queue;
        const size_t count = q.belt_size();
        require_capacity(count, capacity, out_count);
        if (count > 0) require(items, "items");
        for (size_t place = 0; place < count; ++place) {
            const int p = static_cast<int>(place);
            items[place] = {to_c(q.belt(place)), reach(q.scenario(), q.regions(), p),
                            p < q.scenario().recognized ? 1 : 0};
        }
        *out_count = count;
    });
}

pkc_status pkc_queue_buffer(const pkc_queue *queue, pkc_queued *items, size_t capacity,
                            size_t *out_count) {
    return guard([&] {
        const Use<const pkc_queue> use("queue", queue);
        const auto &buffer = use->queue.buffer();
        require_capacity(buffer.size(), capacity, out_count);
        if (!buffer.empty()) require(items, "items");
        for (size_t i = 0; i < buffer.size(); ++i)
            items[i] = {to_c(buffer[i].item), 1 << buffer[i].arm, 1};
        *out_count = buffer.size();
    });
}

pkc_status pkc_plan_hash(const pkc_action *actions, size_t count, uint64_t *out_hash) {
    return guard([&] {
        require(out_hash, "out_hash");
        const std::vector<Action> core = to_core(actions, count);
        *out_hash = plan_hash(core.data(), core.size());
    });
}

pkc_status pkc_step_apply(pkc_bin *bin, pkc_queue *queue, const pkc_action *actions, size_t count) {
    return guard([&] {
        const Use<pkc_bin> use_bin("bin", bin);
        const Use<pkc_queue> use_queue("queue", queue);
        const std::vector<Action> core = to_core(actions, count);
        apply_step(use_bin->bin, use_queue->queue, core.data(), core.size());
    });
}

pkc_status pkc_snapshot_save(const pkc_bin *bin, const pkc_queue *queue, uint8_t *bytes,
                             size_t capacity, size_t *out_size) {
    return guard([&] {
        const Use<const pkc_bin> use_bin("bin", bin);
        const Use<const pkc_queue> use_queue("queue", queue);
        require(out_size, "out_size");
        ByteWriter sizing(nullptr, 0);
        save_snapshot(use_bin->bin, use_queue->queue, sizing);
        require_capacity(sizing.size(), capacity, out_size);
        require(bytes, "bytes");
        ByteWriter out(bytes, capacity);
        save_snapshot(use_bin->bin, use_queue->queue, out);
        *out_size = out.size();
    });
}

pkc_status pkc_snapshot_load(const uint8_t *bytes, size_t size, pkc_bin **out_bin,
                             pkc_queue **out_queue) {
    return guard([&] {
        require(bytes, "bytes");
        require(out_bin, "out_bin");
        require(out_queue, "out_queue");
        ByteReader in(bytes, size);
        auto bin = std::make_unique<pkc_bin>(Bin(1, 1));
        auto queue = std::make_unique<pkc_queue>(Queue(Scenario()));
        load_snapshot(in, bin->bin, queue->queue);
        *out_bin = bin.release();
        *out_queue = queue.release();
    });
}

}  // extern "C"
