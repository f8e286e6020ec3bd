#include "gateway/core/register_image.hpp"

#include <algorithm>

#include "gateway/core/channel.hpp"

namespace packcell_programs {

namespace {

constexpr uint16_t kProduction = 1;  // UnitModeCurrent
constexpr uint32_t kTestWord = 0x01020304;
constexpr uint32_t kTestFloat = 0x42F6E979;  // 123.456f

uint16_t saturate(int64_t value) {
    return static_cast<uint16_t>(std::clamp<int64_t>(value, 0, 65535));
}

size_t address_of(int arm, ArmField field) {
    return static_cast<size_t>(kAckSeqA + arm * kArmStatusSize + static_cast<int>(field));
}

}  // namespace

RegisterImage::RegisterImage(const pkc_scenario &scenario, WordOrder order) : order_(order) {
    words_[kMagic] = kMapMagic;
    words_[kMajor] = kMapMajor;
    words_[kMinor] = kMapMinor;
    words_[kUnitModeCurrent] = kProduction;
    words_[kIdentity] = PKC_VERSION_MAJOR;
    words_[kIdentity + 1] = PKC_VERSION_MINOR;
    words_[kIdentity + 2] = PKC_VERSION_PATCH;
    show_words(kIdentity + 4, kTestWord);
    show_words(kIdentity + 6, kTestFloat);
    uint16_t at = kIdentityScenario;
    for (const int32_t value :
         {scenario.robots, scenario.recognized, scenario.accessible, scenario.overlap})
        show(at++, value);
}

void RegisterImage::write(uint16_t address, const uint16_t *values, uint16_t count) {
    std::copy(values, values + count, words_.begin() + address);
}

const uint16_t *RegisterImage::command(int arm) const { return &words_[command_block(arm)]; }

void RegisterImage::show(uint16_t address, int64_t value) { words_[address] = saturate(value); }

void RegisterImage::show_words(uint16_t address, uint32_t value) {
    put_words(order_, value, &words_[address]);
}

void RegisterImage::show(int arm, ArmField field, uint16_t value) {
    words_[address_of(arm, field)] = value;
}

void RegisterImage::show_result(int arm, uint16_t number, const PlanEnd &end) {
    const uint16_t base = arm == 0 ? kResultA : kResultB;
    const size_t count = end.actions.size();
    const size_t pages = std::max<size_t>((count + kActionsPerPage - 1) / kActionsPerPage, 1);
    const size_t page = std::min<size_t>(words_[arm == 0 ? kPageA : kPageB], pages - 1);
    uint16_t *block = &words_[base];
    std::fill(block, block + kResultSize, uint16_t{0});
    block[kSeqHead] = block[kResultTail] = number;
    block[kActionCount] = saturate(static_cast<int64_t>(count));
    block[kPageIndex] = static_cast<uint16_t>(page);
    block[kPages] = static_cast<uint16_t>(pages);
    const size_t first = page * kActionsPerPage;
    for (size_t i = first; i < std::min<size_t>(count, first + kActionsPerPage); ++i)
        put_action(end.actions[i], order_, block + kActions + (i - first) * kActionSize);
}

void RegisterImage::show_cell(const CellModel &cell) {
    const pkc_bin_info bin = cell.bin_info();
    show(kIdentityBin, bin.w);
    show(kIdentityBin + 1, bin.h);
    show(kUtilization, int64_t{10000} * bin.occupied_cells / (bin.w * bin.h));
    show(kItemsInBin, bin.items);
    const pkc_queue_info queue = cell.queue_info();
    show(kItemsOnBelt, queue.belt);
    show(kBufferedItems, queue.buffered);
    show_words(kBinsClosed, cell.bins_closed());
    show(kKAlpha, queue.k_alpha);
    show(kKShared, queue.k_shared);
    show(kKBeta, queue.k_beta);
    const auto &orders = cell.orders();
    show_words(kNextJob, orders.empty() ? 0 : orders.front().id);
    show(kJobsWaiting, static_cast<int64_t>(orders.size()));
}

void RegisterImage::show_queue_depth() {
    int depth = 0;
    for (int arm = 0; arm < kArms; ++arm) {
        depth += numbers_between(words_[address_of(arm, ArmField::kDone)],
                                 words_[address_of(arm, ArmField::kAck)]);
    }
    show(kQueueDepth, depth);
}

}  // namespace packcell_programs
