#include "learn/environment.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <type_traits>

#include "base/status.h"

namespace packcell {

namespace {

constexpr int kMostItems = 1000000;

void check_range(const char *what, int value, int least, int most) {
    if (value < least || value > most) {
        fail(Status::kArgument, "protocol %s %d: must be %d..%d", what, value, least, most);
    }
}

}  // namespace

// A Random is its four words of state.
static_assert(std::is_trivially_copyable_v<Random> && sizeof(Random) == 32);

void save_random(const Random &random, ByteWriter &out) {
    uint64_t words[4];
    std::memcpy(words, &random, sizeof words);
    for (const uint64_t word : words) out.u64(word);
}

Random restore_random(ByteReader &in) {
    uint64_t words[4];
    for (uint64_t &word : words) word = in.u64();
    Random random(0);
    std::memcpy(static_cast<void *>(&random), words, sizeof words);
    return random;
}

void check_protocol(const Protocol &p) {
    check_range("bin w", p.bin_w, 1, kMaxSide);
    check_range("bin h", p.bin_h, 1, kMaxSide);
    check_range("least side", p.least_side, 1, std::min(p.bin_w, p.bin_h));
    check_range("most side", p.most_side, p.least_side, std::min(p.bin_w, p.bin_h));
    check_range("items", p.items, 0, kMostItems);
}

Environment::Environment(const Protocol &protocol, uint64_t seed)
    : protocol_(protocol),
      random_(seed),
      bin_(protocol.bin_w, protocol.bin_h,
           static_cast<size_t>(protocol.bin_w) * static_cast<size_t>(protocol.bin_h)) {
    check_protocol(protocol);
    draw_item();
    open();
}

void Environment::reseed(uint64_t seed) {
    random_ = Random(seed);
    draw_item();
    open();
}

void Environment::draw_item() {
    const auto sides = static_cast<uint64_t>(protocol_.most_side - protocol_.least_side + 1);
    item_.w = protocol_.least_side + static_cast<int>(random_.below(sides));
    item_.h = protocol_.least_side + static_cast<int>(random_.below(sides));
}

void Environment::open() {
    bin_.clear();
    offered_ = 1;
    rotation_ = protocol_.mixed ? random_.below(2) != 0 : protocol_.rotation;
}

bool Environment::fits(Size size) const {
    Positions positions;
    bin_.feasible(size, positions);
    return positions.any();
}

Environment::Outcome Environment::pack(int position, bool turned) {
    const Size size = turned ? Size{item_.h, item_.w} : item_;
    const Rect rect = {position % bin_.w(), position / bin_.w(), size.w, size.h};
    Outcome outcome = {bin_.contact(rect), false, 0};
    bin_.place({{0, item_.w, item_.h, 0}, rect.x, rect.y, turned ? 1 : 0});
    outcome.occupied = bin_.occupied();
    draw_item();
    if (protocol_.items == 0) {
        outcome.closed = !fits_now();
    } else {
        while (!bin_.full() && offered_ < protocol_.items) {
            ++offered_;
            if (fits_now()) return outcome;
            draw_item();
        }
        outcome.closed = true;
    }
    return outcome;
}

Environment::Outcome Environment::place(int position, bool turned) {
    const Outcome outcome = pack(position, turned);
    if (outcome.closed) open();
    return outcome;
}

void Environment::save(ByteWriter &out) const {
    save_random(random_, out);
    out.i32(item_.w);
    out.i32(item_.h);
    out.i32(offered_);
    out.u8(rotation_ ? 1 : 0);
    out.u32(static_cast<uint32_t>(bin_.items().size()));
    for (const Placement &p : bin_.items()) {
        const Rect r = p.rect();
        for (const int v : {r.x, r.y, r.w, r.h}) out.i32(v);
    }
}

void Environment::restore(ByteReader &in) {
    random_ = restore_random(in);
    item_.w = in.ranged("item w", protocol_.least_side, protocol_.most_side);
    item_.h = in.ranged("item h", protocol_.least_side, protocol_.most_side);
    offered_ = in.ranged("items offered", 1, std::max(1, protocol_.items));
    rotation_ = in.u8() != 0;
    const uint32_t count = in.u32();
    bin_.clear();
    for (uint32_t i = 0; i < count; ++i) {
        const size_t at = in.at();
        Rect r = {};
        for (int *v : {&r.x, &r.y, &r.w, &r.h}) *v = in.ranged("placement", 0, kMaxSide);
        if (r.w < 1 || r.h < 1 || !bin_.inside(r) || !bin_.is_free(r)) {
            fail(Status::kFormat, "byte %zu: placement %u does not lie on free cells", at, i);
        }
        bin_.place({{0, r.w, r.h, 0}, r.x, r.y, 0});
    }
    if (!fits_now()) fail(Status::kFormat, "byte %zu: the item has no position", in.at());
}

bool choose_turned(const Bin &bin, Size item, int position, int turned_position) {
    if (turned_position >= bin.cells()) return false;
    if (position >= bin.cells()) return true;
    const int w = bin.w();
    return bin.contact({turned_position % w, turned_position / w, item.h, item.w}) >
           bin.contact({position % w, position / w, item.w, item.h});
}

namespace {

// The same by the value of what is left behind; `after` is memory for a copy of the bin.
bool worth_more_turned(const Policy &policy, Bin &after, const Bin &bin, Size item, int position,
                       int turned_position) {
    if (turned_position >= bin.cells()) return false;
    if (position >= bin.cells()) return true;
    const auto worth = [&](int at, int rot) {
        after.assign(bin);
        after.place({{0, item.w, item.h, 0}, at % bin.w(), at / bin.w(), rot});
        return policy.value(after);
    };
    return worth(turned_position, 1) > worth(position, 0);
}

}  // namespace

Utilization measure(const Policy &policy, const Protocol &protocol, uint64_t seed, uint64_t bins) {
    const std::unique_ptr<const Policy> session =
        policy.session({protocol.rotation, std::max(protocol.bin_w, protocol.bin_h)});
    const Policy &used = session != nullptr ? *session : policy;
    Environment environment(protocol, stream_seed(seed, 0, Purpose::kHeldOut));
    Bin after(protocol.bin_w, protocol.bin_h);
    double sum = 0;
    double squares = 0;
    for (uint64_t closed = 0; closed < bins;) {
        const Size item = environment.item();
        int position = used.select(environment.bin(), item);
        bool turned = false;
        if (environment.turns()) {
            const int other = used.select(environment.bin(), {item.h, item.w});
            turned = used.has_value(environment.bin())
                         ? worth_more_turned(used, after, environment.bin(), item, position, other)
                         : choose_turned(environment.bin(), item, position, other);
            if (turned) position = other;
        }
        const Environment::Outcome outcome = environment.place(position, turned);
        if (!outcome.closed) continue;
        const double share =
            static_cast<double>(outcome.occupied) / static_cast<double>(environment.bin().cells());
        sum += share;
        squares += share * share;
        ++closed;
    }
    const auto n = static_cast<double>(bins);
    Utilization u;
    u.mean = sum / n;
    if (bins > 1) {
        u.half_width_95 =
            1.96 * std::sqrt(std::max(0.0, squares / n - u.mean * u.mean) / (n - 1.0));
    }
    return u;
}

}  // namespace packcell
