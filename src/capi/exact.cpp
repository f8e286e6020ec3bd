#include <algorithm>
#include <vector>

#include "capi/handles.h"
#include "search/bound.h"

using namespace packcell;

namespace {

constexpr size_t kMostItems = PKC_MAX_SIDE * PKC_MAX_SIDE;
constexpr uint64_t kTableMemory = uint64_t{4} << 20;

std::vector<Item> checked_items(const pkc_item *items, size_t count) {
    if (count > 0) require(items, "items");
    std::vector<Item> checked;
    for (size_t i = 0; i < count; ++i) checked.push_back(checked_item("item", items + i));
    return checked;
}

Budget checked_start(const pkc_budget *budget) {
    const pkc_budget b = checked_budget(budget);
    Budget started;
    started.start(b.nodes, b.milliseconds, nullptr);
    return started;
}

int32_t to_c(ExactPacker::Answer answer) {
    switch (answer) {
        case ExactPacker::Answer::kFound:
            return PKC_PACKING_FOUND;
        case ExactPacker::Answer::kImpossible:
            return PKC_PACKING_IMPOSSIBLE;
        default:
            return PKC_PACKING_BUDGET;
    }
}

ExactPacker make_packer(const Bin &bin, size_t items) {
    return {std::max(bin.w(), bin.h()), static_cast<int>(items), kTableMemory};
}

}  // namespace

extern "C" {

pkc_status pkc_exact_pack(const pkc_bin *bin, const pkc_item *items, size_t count, int32_t rotation,
                          const pkc_budget *budget, pkc_placement *placements, int32_t *out_answer,
                          uint64_t *out_nodes) {
    return guard([&] {
        require(out_answer, "out_answer");
        require_flag("rotation", rotation);
        require_range("count", static_cast<int64_t>(std::min<size_t>(count, INT32_MAX)), 0,
                      kMostItems);
        const std::vector<Item> checked = checked_items(items, count);
        if (count > 0) require(placements, "placements");
        Budget started = checked_start(budget);
        const Use<const pkc_bin> use("bin", bin);
        ExactPacker packer = make_packer(use->bin, count);
        const auto answer = decide(packer, use->bin, checked.data(), static_cast<int>(count),
                                   rotation != 0, started);
        if (answer == ExactPacker::Answer::kFound) {
            std::vector<Placement> placed(count);
            packer.placements(placed.data());
            std::transform(placed.begin(), placed.end(), placements,
                           [](const Placement &p) { return packcell::to_c(p); });
        }
        *out_answer = to_c(answer);
        if (out_nodes != nullptr) *out_nodes = started.nodes();
    });
}

pkc_status pkc_bound_in_order(const pkc_bin *bin, const pkc_item *items, size_t count,
                              int32_t rotation, const pkc_budget *budget, size_t *out_count,
                              int32_t *out_answer) {
    return guard([&] {
        require(out_count, "out_count");
        require(out_answer, "out_answer");
        require_flag("rotation", rotation);
        const Use<const pkc_bin> use("bin", bin);
        // Every item takes a cell at least.
        const std::vector<Item> checked =
            checked_items(items, std::min(count, static_cast<size_t>(use->bin.cells())));
        Budget started = checked_start(budget);
        ExactPacker packer = make_packer(use->bin, checked.size());
        const InOrderBound bound =
            bound_in_order(packer, use->bin, checked.data(), static_cast<int>(checked.size()),
                           rotation != 0, started);
        *out_count = static_cast<size_t>(bound.count);
        *out_answer = bound.proved ? PKC_PACKING_FOUND : PKC_PACKING_BUDGET;
    });
}

}  // extern "C"
