// Weight blobs: what was written is read, the golden blob stays readable for ever, and bytes that
// are no blob are refused, by name and within bounds.
#include "policy/weights.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <limits>
#include <new>
#include <string>
#include <vector>

#include "base/bytes.h"
#include "base/file.h"
#include "base/random.h"
#include "base/status.h"
#include "check.h"

extern "C" {
#include <cmocka.h>
}

namespace {

size_t largest_allocation = 0;

}  // namespace

// Watched, so that sizes in a blob that lie are found out. Inlined halves would look to GCC like
// free() of what operator new gave.
__attribute__((noinline)) void *operator new(size_t size) {
    largest_allocation = std::max(largest_allocation, size);
    void *p = std::malloc(size);
    if (p == nullptr) throw std::bad_alloc();
    return p;
}
__attribute__((noinline)) void operator delete(void *p) noexcept { std::free(p); }
__attribute__((noinline)) void operator delete(void *p, size_t) noexcept { std::free(p); }

namespace packcell {
namespace {

using Bytes = std::vector<uint8_t>;

constexpr size_t kHeader = 112;
constexpr size_t kEntry = 64;
constexpr size_t kChecksum = 8;

// ---- Blobs --------------------------------------------------------------------------------------

const Bytes &golden() {
    static const Bytes bytes = read_file(PACKCELL_GOLDEN "/weights.pkw", 1 << 20);
    return bytes;
}

// What tests/golden/make_blobs.py put into it.
Weights golden_weights() {
    Weights w;
    w.architecture = Architecture::kActorCritic;
    w.name = "golden";
    w.bin_w = 10;
    w.bin_h = 8;
    w.training = {"by-hand", UINT64_MAX, 500000, 0.25f, 0.826f};
    w.tensors = {
        {"head/w.1", Stored::kFloat32, {2, 3}, {0, 1, -1.5f, 3.25f, -0.0078125f, 65536}, 0},
        {"table-2x2_0", Stored::kInt16, {3}, {-4096, 0.875f, 4095.875f}, 0.125f},
        {"c", Stored::kFloat32, {1, 1, 2, 1}, {-1e-20f, 1e30f}, 0}};
    return w;
}

// The same bytes with the size and the checksum that they should have.
Bytes sealed(Bytes bytes) {
    ByteWriter size(bytes.data() + 4, 4);
    size.u32(static_cast<uint32_t>(bytes.size()));
    const size_t at = bytes.size() - kChecksum;
    ByteWriter checksum(bytes.data() + at, kChecksum);
    checksum.u64(fnv1a(kFnvBasis, bytes.data(), at));
    return bytes;
}

Bytes with_u32(size_t at, uint32_t value) {
    Bytes bytes = golden();
    ByteWriter(bytes.data() + at, 4).u32(value);
    return sealed(bytes);
}

Weights read(const Bytes &bytes) { return read_weights(bytes.data(), bytes.size()); }

void assert_same(const Weights &a, const Weights &b) {
    assert_int_equal(a.architecture, b.architecture);
    assert_string_equal(a.name.c_str(), b.name.c_str());
    assert_int_equal(a.bin_w, b.bin_w);
    assert_int_equal(a.bin_h, b.bin_h);
    assert_string_equal(a.training.learner.c_str(), b.training.learner.c_str());
    assert_true(a.training.seed == b.training.seed);
    assert_true(a.training.steps == b.training.steps);
    assert_true(a.training.reward_fill == b.training.reward_fill);
    assert_true(a.training.utilization == b.training.utilization);
    assert_int_equal(a.tensors.size(), b.tensors.size());
    for (size_t i = 0; i < a.tensors.size(); ++i) {
        assert_string_equal(a.tensors[i].name.c_str(), b.tensors[i].name.c_str());
        assert_int_equal(a.tensors[i].stored, b.tensors[i].stored);
        assert_true(a.tensors[i].shape == b.tensors[i].shape);
        assert_true(a.tensors[i].scale == b.tensors[i].scale);
        assert_int_equal(a.tensors[i].data.size(), b.tensors[i].data.size());
        assert_memory_equal(a.tensors[i].data.data(), b.tensors[i].data.data(),
                            a.tensors[i].data.size() * sizeof(float));
    }
}

// The text that a call fails with; "" when it does not fail. The status must be the one given.
std::string failure(Status status, const std::function<void()> &call) {
    try {
        call();
    } catch (const Error &e) {
        if (e.status() == status) return e.what();
        print_error("status %d, should be %d: %s\n", static_cast<int>(e.status()),
                    static_cast<int>(status), e.what());
        fail();
    }
    return "";
}

void assert_holds(const std::string &text, const std::string &part) {
    if (text.find(part) != std::string::npos) return;
    print_error("the error '%s' should hold '%s'\n", text.c_str(), part.c_str());
    fail();
}

void refuse(const Bytes &bytes, const std::string &text) {
    // Of exactly their size, so that a sanitizer sees any step past the end.
    const Bytes exact(bytes.begin(), bytes.end());
    assert_holds(failure(Status::kFormat, [&] { read(exact); }), text);
}

// Either refused with the offset, or read and then written the same. Neither takes memory beyond a
// multiple of what the blob has.
bool read_or_refuse(const Bytes &bytes) {
    Weights weights;
    largest_allocation = 0;
    const std::string text = failure(Status::kFormat, [&] { weights = read(bytes); });
    assert_true(largest_allocation <= 8 * bytes.size() + 1024);
    if (!text.empty()) {
        assert_holds(text, "byte ");
        return false;
    }
    assert_true(write_weights(weights) == bytes);
    return true;
}

std::string draw_name(Random &random, int least) {
    const char characters[] = "abcdefghijklmnopqrstuvwxyz0123456789_./-";
    std::string name;
    for (uint64_t i =
             static_cast<uint64_t>(least) + random.below(32 - static_cast<uint64_t>(least));
         i > 0; --i)
        name += characters[random.below(sizeof characters - 1)];
    return name;
}

// Finite floats of all sizes, denormal ones and -0 too.
float draw_float(Random &random) {
    for (;;) {
        const float value = float_of(static_cast<uint32_t>(random.next()));
        if (std::isfinite(value)) return value;
    }
}

Weights draw_weights(Random &random) {
    Weights w;
    w.architecture = static_cast<Architecture>(1 + random.below(3));
    w.name = draw_name(random, 1);
    if (random.below(3) != 0) {
        w.bin_w = 1 + static_cast<int>(random.below(kMaxSide));
        w.bin_h = 1 + static_cast<int>(random.below(kMaxSide));
    }
    w.training = {draw_name(random, 0), random.next(), random.next(),
                  static_cast<float>(random.unit()),
                  random.below(2) == 0 ? -1.0f : static_cast<float>(random.unit())};
    for (uint64_t i = 1 + random.below(6); i > 0; --i) {
        Tensor t;
        t.name = draw_name(random, 1).substr(0, 29) + std::to_string(i);
        size_t count = 1;
        for (uint64_t d = 1 + random.below(4); d > 0; --d) {
            t.shape.push_back(static_cast<uint32_t>(1 + random.below(6)));
            count *= t.shape.back();
        }
        if (random.below(2) == 0) t.stored = Stored::kInt16;
        const float reach = std::ldexp(1.0f, static_cast<int>(random.below(60)) - 30);
        for (size_t k = 0; k < count; ++k) {
            t.data.push_back(t.stored == Stored::kInt16
                                 ? (static_cast<float>(random.unit()) - 0.5f) * reach
                                 : draw_float(random));
        }
        w.tensors.push_back(t);
    }
    return w;
}

// ---- Round trips --------------------------------------------------------------------------------

void the_golden_blob_holds_what_its_maker_put_in(void **) {
    assert_int_equal(golden().size(), 352);
    const Weights weights = read(golden());
    assert_same(weights, golden_weights());
    assert_int_equal(weights.parameters(), 11);
}

void what_the_golden_blob_holds_makes_the_golden_blob(void **) {
    assert_true(write_weights(golden_weights()) == golden());
    assert_true(write_weights(read(golden())) == golden());
}

void random_weights_come_back_and_their_blob_too(void **) {
    const uint64_t seed = 20260;
    Random random(seed);
    for (int round = 0; round < check_count(500, 20000); ++round) {
        const Weights weights = draw_weights(random);
        const Bytes bytes = write_weights(weights);
        const Weights again = read(bytes);
        Weights rounded = weights;
        for (size_t i = 0; i < rounded.tensors.size(); ++i) {
            Tensor &t = rounded.tensors[i];
            if (t.stored == Stored::kFloat32) continue;
            t.scale = again.tensors[i].scale;
            for (float &value : t.data) {
                const float nearest = std::nearbyint(value / t.scale) * t.scale;
                assert_true(std::fabs(nearest - value) <= t.scale * 0.505f);
                value = nearest + 0.0f;  // int16 has one zero
            }
        }
        if (write_weights(again) != bytes) print_error("seed %llu\n", (unsigned long long)seed);
        assert_same(again, rounded);
        assert_true(write_weights(again) == bytes);
    }
}

void a_blob_may_lie_at_any_address(void **) {
    Bytes shifted = golden();
    shifted.insert(shifted.begin(), 0);
    assert_same(read_weights(shifted.data() + 1, golden().size()), golden_weights());
}

void int16_keeps_a_scale_that_still_fits_and_else_takes_the_smallest(void **) {
    Weights w = golden_weights();
    Tensor &t = w.tensors[1];
    t.data = {0.25f, -0.5f, 0};  // multiples of 0.125
    assert_true(read(write_weights(w)).tensors[1].scale == 0.125f);
    t.data = {0.25f, -0.3f, 0};
    assert_true(read(write_weights(w)).tensors[1].scale == 0.3f / 32767);
    t.data = {0.25f, 32768 * 0.125f, 0};  // one more than int16 has
    assert_true(read(write_weights(w)).tensors[1].scale == 4096.0f / 32767);
    t.data = {0, 0, 0};
    t.scale = 0;
    assert_true(read(write_weights(w)).tensors[1].scale == 1e-30f);
    t.data = {1e-38f, 1e-44f, -1e-38f};  // so small that they are nothing
    assert_true(read(write_weights(w)).tensors[1].data[0] == 0);
    t.data = {3e34f, -3e34f, 0};
    assert_true(std::isfinite(read(write_weights(w)).tensors[1].data[0]));
}

void large_tensors_come_back(void **) {
    Weights w = golden_weights();
    Random random(3);
    w.tensors[0].shape = {1024, 256};
    w.tensors[0].data.assign(size_t{1024} * 256, 0);
    for (float &value : w.tensors[0].data) value = draw_float(random);
    w.tensors[1].shape = {65537, 3};
    w.tensors[1].data.assign(size_t{65537} * 3, 0.125f);
    w.tensors[1].data.back() = -0.25f;
    const Bytes bytes = write_weights(w);
    assert_same(read(bytes), w);
    Bytes damaged = bytes;
    damaged[bytes.size() / 2] ^= 1;
    refuse(damaged, "the checksum does not agree");
}

// ---- Damage -------------------------------------------------------------------------------------

void a_blob_cut_short_anywhere_is_refused_as_such(void **) {
    for (size_t size = 0; size < golden().size(); ++size) {
        const Bytes cut(golden().begin(), golden().begin() + static_cast<std::ptrdiff_t>(size));
        refuse(cut, "byte " + std::to_string(size) + ": the data ends here");
        if (size < 16) continue;
        // Nor does it help to adapt the size and the checksum.
        assert_false(read_or_refuse(sealed(cut)));
    }
}

void bytes_after_the_end_are_refused(void **) {
    for (size_t more = 1; more < 70; ++more) {
        Bytes longer = golden();
        longer.resize(golden().size() + more);
        refuse(longer, "byte 352: " + std::to_string(more) + " bytes follow the end");
        assert_false(read_or_refuse(sealed(longer)));
    }
    Bytes longer = golden();
    longer.resize(golden().size() + 4);
    refuse(sealed(longer), "byte 344: 4 bytes follow the last tensor");
}

void every_flipped_bit_is_noticed(void **) {
    for (size_t at = 0; at < golden().size(); ++at) {
        for (int bit = 0; bit < 8; ++bit) {
            Bytes bytes = golden();
            bytes[at] = static_cast<uint8_t>(bytes[at] ^ 1 << bit);
            const char *text = at < 3    ? "byte 0: not a packcell weight blob"
                               : at == 3 ? "byte 3: version "
                               : at < 8  ? "byte "
                                         : "byte 344: the checksum does not agree";
            refuse(bytes, text);
        }
    }
}

void a_flipped_bit_under_a_right_checksum_is_refused_or_read_as_it_stands(void **) {
    int accepted = 0;
    for (size_t at = 8; at < golden().size() - kChecksum; ++at) {
        for (int bit = 0; bit < 8; ++bit) {
            Bytes bytes = golden();
            bytes[at] = static_cast<uint8_t>(bytes[at] ^ 1 << bit);
            accepted += read_or_refuse(sealed(bytes)) ? 1 : 0;
        }
    }
    assert_true(accepted > 16 * 8);  // seed, steps, numbers
}

void no_absurd_number_anywhere_takes_memory(void **) {
    const uint32_t absurd[] = {0,          1,          2,          4,           5,
                               0x7f,       0xffff,     0x10000,    0x02000000,  0x02000001,
                               0x03ffffff, 0x40000000, 0x55555556, 0x7fffffff,  0x80000000,
                               0xaaaaaaab, 0xfffffffc, 0xfffffffe, 0xffffffffu, 0x7fc00000};
    for (size_t at = 8; at + kChecksum < golden().size(); ++at) {
        for (const uint32_t value : absurd) read_or_refuse(with_u32(at, value));
    }
    for (const uint32_t one : absurd) {
        for (const uint32_t two : absurd) {
            // Sides whose product overflows, for both ways of storage.
            for (const size_t entry : {kHeader, kHeader + kEntry}) {
                Bytes bytes = with_u32(entry + 40, one);
                ByteWriter(bytes.data() + entry + 36, 4).u32(4);
                for (const size_t side : {44, 48, 52})
                    ByteWriter(bytes.data() + entry + side, 4).u32(two);
                read_or_refuse(sealed(bytes));
            }
        }
    }
}

void each_field_is_checked_and_named(void **) {
    const uint32_t nan = 0x7fc00000;
    const uint32_t infinity = 0x7f800000;
    const size_t second = kHeader + kEntry;
    const size_t data = kHeader + 3 * kEntry;
    const struct {
        size_t at;
        uint32_t value;
        const char *text;
    } cases[] = {
        {8, 0, "byte 8: architecture 0: must be 1..3"},
        {8, 4, "byte 8: architecture 4: must be 1..3"},
        {8, UINT32_MAX, "byte 8: architecture -1: must be 1..3"},
        {12, 129, "byte 12: bin width 129: must be 0..128"},
        {16, 129, "byte 16: bin height 129: must be 0..128"},
        {12, 0, "byte 12: bin 0x8: must be 1x1..128x128, or 0x0 for any"},
        {16, 0, "byte 12: bin 10x0: must be 1x1..128x128, or 0x0 for any"},
        {20, 0, "byte 20: tensors 0: must be 1..1024"},
        {20, 1025, "byte 20: tensors 1025: must be 1..1024"},
        {20, 1024, "byte 20: tensors 1024: the data ends before so many"},
        {20, 2, "byte 172: tensor 'head/w.1' begins at 304: must be 240"},
        {24, 0x00474f47, "byte 24: policy name has character 71: must be a-z"},
        {24, 0, "byte 28: policy name has character"},
        {52, 0x61000000, "byte 55: policy name has character 97"},
        {56, 0x20626262, "byte 59: learner has character 32"},
        {104, nan, "byte 104: reward_fill nan: must be finite and 0..1"},
        {104, 0x3f800001, "byte 104: reward_fill 1: must be finite and 0..1"},
        {104, 0xbf800000, "byte 104: reward_fill -1: must be finite and 0..1"},
        {108, infinity, "byte 108: utilization inf: must be finite and -1..1"},
        {108, 0xbf000000, "byte 108: utilization -0.5: must be 0..1, or -1 for not measured"},
        {kHeader, 0, "byte 116: tensor name has character"},
        {kHeader + 32, 0, "byte 144: storage 0: must be 1..2"},
        {kHeader + 32, 3, "byte 144: storage 3: must be 1..2"},
        {kHeader + 32, 2, "byte 168: scale 0: must be finite and 1e-30..1e+30"},
        {kHeader + 36, 0, "byte 148: dimensions 0: must be 1..4"},
        {kHeader + 36, 5, "byte 148: dimensions 5: must be 1..4"},
        {kHeader + 36, 3, "byte 160: side 0: must be 1..33554432"},
        {kHeader + 36, 1, "byte 156: side of no dimension 3: must be 0..0"},
        {kHeader + 40, 0, "byte 152: side 0: must be 1..33554432"},
        {kHeader + 40, 33554433, "byte 152: side 33554433: must be 1..33554432"},
        {kHeader + 40, 33554432, "tensor 'head/w.1' of 33554432x3: the data ends before so much"},
        {kHeader + 56, 0x80000000, "byte 168: scale of float32 "},
        {kHeader + 60, 300, "byte 172: tensor 'head/w.1' begins at 300: must be 304"},
        {kHeader + 60, 308, "byte 172: tensor 'head/w.1' begins at 308: must be 304"},
        {kHeader + 60, UINT32_MAX, "begins at 4294967295: must be 304"},
        {second + 56, nan, "byte 232: scale nan: must be finite and 1e-30..1e+30"},
        {second + 56, infinity, "byte 232: scale inf"},
        {second + 56, 0, "byte 232: scale 0"},
        {second + 56, 0xbf800000, "byte 232: scale -1"},
        {second + 56, 1, "byte 232: scale 1.4013e-45"},
        {second + 56, 0x7f7fffff, "byte 232: scale 3.40282e+38"},
        {data, nan, "byte 304: tensor 'head/w.1' has nan: must be finite"},
        {data + 4, infinity, "byte 308: tensor 'head/w.1' has inf: must be finite"},
        {data + 20, 0xff800000, "byte 324: tensor 'head/w.1' has -inf: must be finite"},
        {data + 24 + 4, 0x00010000, "byte 334: padding 1: must be 0"},
        {data + 24 + 4, 0x80000000, "byte 335: padding 128: must be 0"},
        {data + 36, 0x7f800001, "byte 340: tensor 'c' has nan: must be finite"},
    };
    for (const auto &c : cases) refuse(with_u32(c.at, c.value), c.text);
}

void another_kind_another_version_and_impossible_sizes_are_told(void **) {
    Bytes bytes(400, 'x');
    refuse(bytes, "byte 0: not a packcell weight blob: must begin with 'PKW'");
    refuse({'x'}, "byte 0: not a packcell weight blob");
    refuse({'P', 'K'}, "byte 2: the data ends here");
    bytes = golden();
    bytes[3] = 2;
    refuse(bytes, "byte 3: version 2: must be 1");
    refuse({'P', 'K', 'W', 0}, "byte 3: version 0: must be 1");
    for (const uint32_t size : {0u, 187u, 67108868u, UINT32_MAX}) {
        bytes = golden();
        ByteWriter(bytes.data() + 4, 4).u32(size);
        refuse(bytes, "byte 4: size " + std::to_string(size) + ": must be 188..67108864");
    }
    ByteWriter(bytes.data() + 4, 4).u32(353);
    refuse(bytes, "byte 4: size 353: must be a multiple of 4");
}

void a_name_that_occurs_twice_is_refused(void **) {
    Bytes bytes = golden();
    std::copy_n(bytes.begin() + kHeader, 32, bytes.begin() + kHeader + 2 * kEntry);
    refuse(sealed(bytes), "byte 240: tensor 'head/w.1' occurs twice");
}

void names_fill_their_field_up_to_one_zero(void **) {
    Weights w = golden_weights();
    w.name = std::string(31, 'z');
    w.training.learner = "";
    w.tensors[2].name = std::string(31, '-');
    assert_same(read(write_weights(w)), w);
    Bytes bytes = write_weights(w);
    bytes[24 + 31] = 'z';
    refuse(sealed(bytes), "byte 24: policy name has 32 characters: must be 1..31");
    bytes = golden();
    std::fill_n(bytes.begin() + 24, 32, uint8_t{0});
    refuse(sealed(bytes), "byte 24: policy name has 0 characters: must be 1..31");
}

// ---- Writing what makes no blob -----------------------------------------------------------------

void weights_that_could_not_be_read_again_are_not_written(void **) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const struct {
        const char *text;
        void (*spoil)(Weights &, float);
    } cases[] = {
        {"policy name has 0 characters", [](Weights &w, float) { w.name = ""; }},
        {"must be 1..31", [](Weights &w, float) { w.name = std::string(32, 'a'); }},
        {"must be 1..31", [](Weights &w, float) { w.name = std::string("a\0b", 3); }},
        {"policy name has character 65", [](Weights &w, float) { w.name = "A"; }},
        {"learner has character 32", [](Weights &w, float) { w.training.learner = "a 3c"; }},
        {"reward_fill nan", [](Weights &w, float n) { w.training.reward_fill = n; }},
        {"utilization nan", [](Weights &w, float n) { w.training.utilization = n; }},
        {"utilization 2", [](Weights &w, float) { w.training.utilization = 2; }},
        {"bin 0x8", [](Weights &w, float) { w.bin_w = 0; }},
        {"bin width -1", [](Weights &w, float) { w.bin_w = -1; }},
        {"bin height 129", [](Weights &w, float) { w.bin_h = 129; }},
        {"architecture 7",
         [](Weights &w, float) { w.architecture = static_cast<Architecture>(7); }},
        {"0 tensors: must be 1..1024", [](Weights &w, float) { w.tensors.clear(); }},
        {"1025 tensors: must be 1..1024", [](Weights &w, float) { w.tensors.resize(1025); }},
        {"tensor '' has 0 dimensions", [](Weights &w, float) { w.tensors.emplace_back(); }},
        {"storage 9", [](Weights &w, float) { w.tensors[0].stored = static_cast<Stored>(9); }},
        {"has 5 dimensions",
         [](Weights &w, float) {
             w.tensors[0].shape = {1, 1, 1, 2, 3};
         }},
        {"of 2x0: must have 1..",
         [](Weights &w, float) {
             w.tensors[0].shape = {2, 0};
         }},
        {"of 65536x65536: must have",
         [](Weights &w, float) {
             w.tensors[0].shape = {65536, 65536};
         }},
        {"of 2x2 has 6 numbers: must be 4",
         [](Weights &w, float) {
             w.tensors[0].shape = {2, 2};
         }},
        {"has nan: must be finite", [](Weights &w, float n) { w.tensors[0].data[3] = n; }},
        {"has nan: must be finite", [](Weights &w, float n) { w.tensors[1].data[0] = n; }},
        {"has inf: must be finite", [](Weights &w, float) { w.tensors[1].data[0] = HUGE_VALF; }},
        {"scale 1e+33", [](Weights &w, float) { w.tensors[1].data[0] = 32767e33f; }},
        {"'head/w.1' occurs twice", [](Weights &w, float) { w.tensors[2].name = "head/w.1"; }},
        {"has more than 67108864 bytes",
         [](Weights &w, float) {
             w.tensors[0].shape = {1 << 24};
             w.tensors[0].data.resize(1 << 24);
         }},
    };
    for (const auto &c : cases) {
        Weights weights = golden_weights();
        c.spoil(weights, nan);
        assert_holds(failure(Status::kArgument, [&] { write_weights(weights); }), c.text);
    }
}

// ---- What policies ask of weights ---------------------------------------------------------------

void a_tensor_is_found_by_name_and_shape(void **) {
    const Weights w = golden_weights();
    assert_ptr_equal(&w.tensor("c", {1, 1, 2, 1}), &w.tensors[2]);
    assert_holds(failure(Status::kFormat, [&] { w.tensor("c", {2}); }),
                 "tensor 'c' of 1x1x2x1: must be of 2");
    assert_holds(failure(Status::kFormat,
                         [&] {
                             w.tensor("d", {2, 3});
                         }),
                 "there is no tensor 'd' of 2x3");
}

class Learned : public LearnedPolicy {
public:
    using LearnedPolicy::LearnedPolicy;
    int select(const Bin &, Size) const override { return 0; }
};

void a_learned_policy_serves_the_bins_that_it_was_trained_for(void **) {
    const Learned learned(golden_weights());
    assert_string_equal(learned.name(), "golden");
    assert_same(learned.weights(), golden_weights());
    learned.check_bin(10, 8);
    for (const Size size : {Size{8, 10}, Size{10, 10}, Size{8, 8}}) {
        assert_holds(failure(Status::kArgument, [&] { learned.check_bin(size.w, size.h); }),
                     "bin " + std::to_string(size.w) + "x" + std::to_string(size.h) +
                         ": policy 'golden' was trained for 10x8 bins");
    }
    Weights any = golden_weights();
    any.bin_w = any.bin_h = 0;
    const Learned everywhere(any);
    everywhere.check_bin(1, 1);
    everywhere.check_bin(kMaxSide, kMaxSide);
}

}  // namespace
}  // namespace packcell

int main() {
    using namespace packcell;
    const CMUnitTest tests[] = {
        cmocka_unit_test(the_golden_blob_holds_what_its_maker_put_in),
        cmocka_unit_test(what_the_golden_blob_holds_makes_the_golden_blob),
        cmocka_unit_test(random_weights_come_back_and_their_blob_too),
        cmocka_unit_test(a_blob_may_lie_at_any_address),
        cmocka_unit_test(int16_keeps_a_scale_that_still_fits_and_else_takes_the_smallest),
        cmocka_unit_test(large_tensors_come_back),
        cmocka_unit_test(a_blob_cut_short_anywhere_is_refused_as_such),
        cmocka_unit_test(bytes_after_the_end_are_refused),
        cmocka_unit_test(every_flipped_bit_is_noticed),
        cmocka_unit_test(a_flipped_bit_under_a_right_checksum_is_refused_or_read_as_it_stands),
        cmocka_unit_test(no_absurd_number_anywhere_takes_memory),
        cmocka_unit_test(each_field_is_checked_and_named),
        cmocka_unit_test(another_kind_another_version_and_impossible_sizes_are_told),
        cmocka_unit_test(a_name_that_occurs_twice_is_refused),
        cmocka_unit_test(names_fill_their_field_up_to_one_zero),
        cmocka_unit_test(weights_that_could_not_be_read_again_are_not_written),
        cmocka_unit_test(a_tensor_is_found_by_name_and_shape),
        cmocka_unit_test(a_learned_policy_serves_the_bins_that_it_was_trained_for),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
