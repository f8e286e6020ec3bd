#include "feed/snapshot.h"

#include <algorithm>
#include <vector>

namespace packcell {

namespace {

constexpr uint32_t kMagic = 0x53434b50;  // "PKCS"
constexpr uint32_t kVersion = 1;
constexpr int32_t kMostItems = 1 << 24;
constexpr size_t kItemBytes = 10;

void write_item(ByteWriter &out, const Item &item) {
    out.i32(item.id);
    out.u8(static_cast<uint8_t>(item.w));
    out.u8(static_cast<uint8_t>(item.h));
    out.u32(item.flags);
}

Item read_item(ByteReader &in) {
    Item item;
    item.id = in.ranged("id", 0, INT32_MAX);
    const size_t at = in.at();
    item.w = in.u8();
    item.h = in.u8();
    item.flags = in.u32();
    if (item.w < 1 || item.w > kMaxSide || item.h < 1 || item.h > kMaxSide) {
        fail(Status::kFormat, "byte %zu: item %dx%d: sides must be 1..%d", at, item.w, item.h,
             kMaxSide);
    }
    if ((item.flags & ~(kNoRotate | kPinned)) != 0) {
        fail(Status::kFormat, "byte %zu: flags %u: must be 0..3", at, item.flags);
    }
    return item;
}

// A count of records that the rest of the data has room for.
int32_t read_count(ByteReader &in, const char *what) {
    const size_t at = in.at();
    const int32_t count = in.ranged(what, 0, kMostItems);
    if (static_cast<size_t>(count) > in.left() / kItemBytes) {
        fail(Status::kFormat, "byte %zu: %s %d: the data ends before so many", at, what, count);
    }
    return count;
}

// Cells that no item covers but that are taken.
std::vector<Row> fixed_rows(const Bin &bin) {
    std::vector<Row> rows;
    rows.reserve(static_cast<size_t>(bin.h()));
    for (int y = 0; y < bin.h(); ++y) rows.push_back(bin.row(y));
    for (const Placement &p : bin.items()) {
        const Rect r = p.rect();
        for (int y = r.y; y < r.y + r.h; ++y) rows[static_cast<size_t>(y)] &= ~row_ones(r.x, r.w);
    }
    return rows;
}

void read_bin(ByteReader &in, Bin &bin) {
    const int w = in.ranged("bin width", 1, kMaxSide);
    const int h = in.ranged("bin height", 1, kMaxSide);
    bin = Bin(w, h);
    for (int y = 0; y < h; ++y) {
        const size_t at = in.at();
        const uint64_t low = in.u64();
        Row row = static_cast<Row>(in.u64()) << 64 | low;
        if ((row & ~row_ones(0, w)) != 0)
            fail(Status::kFormat, "byte %zu: fixed cells beyond the bin", at);
        for (; row != 0; row &= row - 1) bin.block({row_lowest(row), y, 1, 1});
    }
    const int32_t count = read_count(in, "items in the bin");
    for (int32_t i = 0; i < count; ++i) {
        const size_t at = in.at();
        Placement p;
        p.item = read_item(in);
        p.x = in.ranged("x", 0, kMaxSide);
        p.y = in.ranged("y", 0, kMaxSide);
        p.rot = in.ranged("rot", 0, (p.item.flags & kNoRotate) != 0 ? 0 : 1);
        if (!bin.is_free(p.rect())) {
            fail(Status::kFormat, "byte %zu: item %d does not lie on free cells", at, p.item.id);
        }
        bin.place(p);
    }
}

void read_queue(ByteReader &in, Queue &queue) {
    Scenario s;
    s.robots = in.ranged("robots", 1, 2);
    s.recognized = in.ranged("recognized", 1, kMaxRecognized);
    s.accessible = in.ranged("accessible", 1, kMaxRecognized);
    s.overlap = in.ranged("overlap", 0, kMaxRecognized);
    try {
        check_scenario(s);
    } catch (const Error &e) {
        fail(Status::kFormat, "byte %zu: %s", in.at(), e.what());
    }
    queue = Queue(s);
    const int alpha_left = in.ranged("alpha_left", 0, kMaxRecognized);
    const int32_t belt = read_count(in, "items on the belt");
    for (int32_t i = 0; i < belt; ++i) queue.push(read_item(in));
    const int32_t buffered = read_count(in, "items in buffers");
    for (int32_t i = 0; i < buffered; ++i) {
        const Item item = read_item(in);
        queue.put_in_buffer({item, in.ranged("arm", 0, s.robots - 1)});
    }
    queue.set_alpha_left(alpha_left);
}

void check_ids(const Bin &bin, const Queue &queue, Status status) {
    std::vector<int32_t> ids;
    for (const Placement &p : bin.items()) ids.push_back(p.item.id);
    for (size_t i = 0; i < queue.belt_size(); ++i) ids.push_back(queue.belt(i).id);
    for (const Buffered &b : queue.buffer()) ids.push_back(b.item.id);
    std::sort(ids.begin(), ids.end());
    const auto twice = std::adjacent_find(ids.begin(), ids.end());
    if (twice != ids.end()) fail(status, "item %d: occurs twice", *twice);
}

}  // namespace

void save_snapshot(const Bin &bin, const Queue &queue, ByteWriter &out) {
    check_ids(bin, queue, Status::kState);
    out.u32(kMagic);
    out.u32(kVersion);
    out.i32(bin.w());
    out.i32(bin.h());
    for (const Row row : fixed_rows(bin)) {
        out.u64(static_cast<uint64_t>(row));
        out.u64(static_cast<uint64_t>(row >> 64));
    }
    out.i32(static_cast<int32_t>(bin.items().size()));
    for (const Placement &p : bin.items()) {
        write_item(out, p.item);
        out.i32(p.x);
        out.i32(p.y);
        out.i32(p.rot);
    }
    const Scenario &s = queue.scenario();
    for (const int value : {s.robots, s.recognized, s.accessible, s.overlap, queue.alpha_left()})
        out.i32(value);
    out.i32(static_cast<int32_t>(queue.belt_size()));
    for (size_t i = 0; i < queue.belt_size(); ++i) write_item(out, queue.belt(i));
    out.i32(static_cast<int32_t>(queue.buffer().size()));
    for (const Buffered &b : queue.buffer()) {
        write_item(out, b.item);
        out.i32(b.arm);
    }
    out.u64(out.hash());
}

void load_snapshot(ByteReader &in, Bin &bin, Queue &queue) {
    if (in.u32() != kMagic) fail(Status::kFormat, "byte 0: not a packcell snapshot");
    const uint32_t version = in.u32();
    if (version != kVersion)
        fail(Status::kFormat, "byte 4: version %u: must be %u", version, kVersion);
    read_bin(in, bin);
    read_queue(in, queue);
    check_ids(bin, queue, Status::kFormat);
    const size_t at = in.at();
    const uint64_t hash = in.hash();
    if (in.u64() != hash) fail(Status::kFormat, "byte %zu: the checksum does not agree", at);
    if (in.left() != 0)
        fail(Status::kFormat, "byte %zu: %zu bytes follow the end", in.at(), in.left());
}

}  // namespace packcell
