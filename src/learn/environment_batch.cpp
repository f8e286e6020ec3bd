#include "learn/environment_batch.h"

#include <algorithm>
#include <cstring>

#include "base/status.h"

namespace packcell {

namespace {

// Of contact rewards, so that they are about 1.
constexpr double kContactScale = 20;

// The low eight bits as eight bytes, the lowest first in memory.
uint64_t spread(uint64_t bits) {
    // A copy of the byte in each byte, of which byte k keeps bit k, and that moved to the bottom.
    const uint64_t kept = (bits & 0xff) * 0x0101010101010101u & 0x8040201008040201u;
    return (kept + 0x7f7f7f7f7f7f7f7fu) >> 7 & 0x0101010101010101u;
}

// `count` bits as bytes 0 and 1.
void write_bits(Row row, int count, uint8_t *out) {
    for (; count >= 8; count -= 8, out += 8, row >>= 8) {
        uint64_t bytes = spread(static_cast<uint64_t>(row));
        if (__BYTE_ORDER__ == __ORDER_BIG_ENDIAN__) bytes = __builtin_bswap64(bytes);
        std::memcpy(out, &bytes, sizeof bytes);
    }
    for (; count > 0; --count, ++out, row >>= 1) *out = static_cast<uint8_t>(row & 1);
}

// One byte for each cell, 1 where the corner of such an item may lie.
void write_positions(const Bin &bin, Size size, uint8_t *out) {
    Positions positions;
    bin.feasible(size, positions);
    const auto w = static_cast<size_t>(bin.w());
    for (int y = 0; y < bin.h(); ++y, out += w) {
        const Row row = y < positions.count ? positions.rows[static_cast<size_t>(y)] : Row{0};
        write_bits(row, bin.w(), out);
    }
}

}  // namespace

EnvironmentBatch::EnvironmentBatch(const Protocol &protocol, int count, double reward_fill)
    : protocol_(protocol), reward_fill_(reward_fill) {
    check_protocol(protocol);
    bins_.reserve(static_cast<size_t>(count));
    for (int i = 0; i < count; ++i) bins_.push_back({Environment(protocol, 0), 0, false});
    const uint64_t seed = 0;
    reseed(&seed, 1);
}

EnvironmentBatch::EnvironmentBatch(const EnvironmentBatch &other)
    : EnvironmentBatch(other.protocol_, static_cast<int>(other.count()), other.reward_fill_) {
    std::copy(other.bins_.begin(), other.bins_.end(), bins_.begin());
    items_placed_ = other.items_placed_;
    bins_closed_ = other.bins_closed_;
}

size_t EnvironmentBatch::cells() const {
    return static_cast<size_t>(protocol_.bin_w) * static_cast<size_t>(protocol_.bin_h);
}

size_t EnvironmentBatch::actions() const {
    return cells() * (protocol_.rotation || protocol_.mixed ? 2 : 1) + 1;
}

size_t EnvironmentBatch::closed_now() const {
    return static_cast<size_t>(
        std::count_if(bins_.begin(), bins_.end(), [](const Slot &slot) { return slot.closed; }));
}

void EnvironmentBatch::reseed(const uint64_t *seeds, size_t count) {
    for (size_t i = 0; i < bins_.size(); ++i) {
        const uint64_t seed = count == 1 ? stream_seed(seeds[0], i, Purpose::kTraining)
                                         : stream_seed(seeds[i], 0, Purpose::kTraining);
        bins_[i].environment.reseed(seed);
        bins_[i].contact = 0;
        bins_[i].closed = false;
    }
}

void EnvironmentBatch::open(Slot &slot) {
    slot.environment.open();
    slot.contact = 0;
    slot.closed = false;
}

void EnvironmentBatch::open_all() {
    for (Slot &slot : bins_) open(slot);
}

void EnvironmentBatch::open_closed() {
    for (Slot &slot : bins_)
        if (slot.closed) open(slot);
}

void EnvironmentBatch::check_action(size_t i, int32_t action) const {
    const Environment &environment = bins_[i].environment;
    const auto most = static_cast<int>(actions()) - 1;
    if (action < 0 || action > most) {
        fail(Status::kArgument, "action %d of bin %zu: must be 0..%d", action, i, most);
    }
    const Bin &bin = environment.bin();
    const bool turned = action >= bin.cells();
    const int position = action % bin.cells();
    const Size item = environment.item();
    const Size size = turned ? Size{item.h, item.w} : item;
    const Rect rect = {position % bin.w(), position / bin.w(), size.w, size.h};
    if (action == most || (turned && !environment.turns()) || !bin.is_free(rect)) {
        fail(Status::kArgument, "action %d of bin %zu: no place for the %d x %d item there", action,
             i, item.w, item.h);
    }
}

void EnvironmentBatch::step(const int32_t *actions) {
    for (size_t i = 0; i < bins_.size(); ++i)
        if (bins_[i].closed) fail(Status::kState, "bin %zu is closed: must be opened first", i);
    for (size_t i = 0; i < bins_.size(); ++i) check_action(i, actions[i]);
    for (size_t i = 0; i < bins_.size(); ++i) {
        Slot &slot = bins_[i];
        const int cells = slot.environment.bin().cells();
        const Environment::Outcome outcome =
            slot.environment.pack(actions[i] % cells, actions[i] >= cells);
        slot.contact = outcome.contact;
        slot.closed = outcome.closed;
        ++items_placed_;
        bins_closed_ += outcome.closed ? 1 : 0;
    }
}

double EnvironmentBatch::reward(size_t i) const {
    const double contact = (1 - reward_fill_) * bins_[i].contact / kContactScale;
    if (!bins_[i].closed) return contact;
    return contact + reward_fill_ * occupied(i) / static_cast<double>(cells());
}

void EnvironmentBatch::write_cells(size_t i, uint8_t *out) const {
    const Bin &bin = bins_[i].environment.bin();
    for (int y = 0; y < bin.h(); ++y, out += bin.w()) write_bits(bin.row(y), bin.w(), out);
}

void EnvironmentBatch::write_mask(size_t i, uint8_t *out) const {
    const Slot &slot = bins_[i];
    const size_t last = actions() - 1;
    if (slot.closed) {
        std::memset(out, 0, last);
        out[last] = 1;
        return;
    }
    const Environment &environment = slot.environment;
    const Size item = environment.item();
    write_positions(environment.bin(), item, out);
    if (environment.turns())
        write_positions(environment.bin(), {item.h, item.w}, out + cells());
    else
        std::memset(out + cells(), 0, last - cells());
    out[last] = 0;
}

}  // namespace packcell
