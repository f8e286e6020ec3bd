// Weight blobs of arbitrary bytes: whatever they are, loading them refuses them with a status of
// the header's or gives a policy that works and saves the same bytes.
//
// With libFuzzer (`make fuzz`) this is the fuzzer's target. Without it, it is a program that
// mutates the blobs named on its command line by random numbers of our own:
//   fuzz_blob [--count N] [--seed S] FILE...
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <iterator>
#include <string>
#include <vector>

#include "base/bytes.h"
#include "base/random.h"
#include "packcell.h"
#include "policy/afterstate_policy.h"
#include "policy/weights.h"

using namespace packcell;

namespace {

using Bytes = std::vector<uint8_t>;

uint64_t blobs_read = 0;
uint64_t policies_made = 0;

void check(bool holds, const char *what) {
    if (holds) return;
    std::fprintf(stderr, "fuzz_blob: %s: %s\n", what, pkc_last_error());
    std::abort();
}

// Weights that are read are written the same.
void try_weights(const Bytes &bytes) {
    Weights weights;
    try {
        weights = read_weights(bytes.data(), bytes.size());
    } catch (const Error &e) {
        check(e.status() == Status::kFormat, "reading fails by another status");
        check(std::strncmp(e.what(), "byte ", 5) == 0, "an error does not begin with its place");
        return;
    }
    ++blobs_read;
    for (const Tensor &tensor : weights.tensors) {
        for (const float value : tensor.data) check(std::isfinite(value), "a weight is not finite");
    }
    check(write_weights(weights) == bytes, "the blob is not written as it was read");
}

// A policy that is loaded can be asked and saved. Its numbers may be anything, its answers not.
void try_policy(const Bytes &bytes) {
    pkc_policy *policy = nullptr;
    const uint8_t nothing = 0;
    const pkc_status status =
        pkc_policy_load(bytes.empty() ? &nothing : bytes.data(), bytes.size(), &policy);
    check(status == PKC_OK || status == PKC_E_FORMAT || status == PKC_E_UNSUPPORTED,
          "loading gives another status");
    if (status != PKC_OK) return;
    ++policies_made;
    pkc_policy_info info;
    check(pkc_policy_info_init(&info, sizeof info) == PKC_OK, "info_init");
    check(pkc_policy_get_info(policy, &info) == PKC_OK, "get_info");
    const int32_t w = info.bin_w > 0 ? info.bin_w : 7;
    const int32_t h = info.bin_h > 0 ? info.bin_h : 5;
    pkc_bin *bin = nullptr;
    check(pkc_bin_create(w, h, &bin) == PKC_OK, "bin_create");
    check(pkc_bin_block(bin, w / 2, h / 2, 1, 1) == PKC_OK, "bin_block");
    const size_t count = static_cast<size_t>(w * h) + 1;
    std::vector<uint8_t> mask(count);
    std::vector<float> numbers(count);
    for (const int32_t side : {1, 2, PKC_MAX_SIDE}) {
        size_t got = 0;
        int32_t position = -1;
        float value = 0;
        check(pkc_bin_feasible(bin, side, 1, mask.data(), count, &got) == PKC_OK, "feasible");
        check(pkc_policy_select(policy, bin, side, 1, &position) == PKC_OK, "select");
        check(position >= 0 && static_cast<size_t>(position) < count &&
                  mask[static_cast<size_t>(position)] == 1,
              "the position is not feasible");
        const pkc_status told =
            pkc_policy_evaluate(policy, bin, side, 1, numbers.data(), nullptr, count, &got, &value);
        check(told == PKC_OK || told == PKC_E_UNSUPPORTED, "evaluate");
    }
    size_t size = 0;
    Bytes saved(bytes.size());
    check(pkc_policy_save(policy, saved.data(), saved.size(), &size) == PKC_OK, "save");
    check(saved == bytes, "the policy is not saved as it was loaded");
    pkc_policy_free(policy);
    pkc_bin_free(bin);
}

// The same bytes under a right size and checksum, which no mutation would meet by chance.
Bytes sealed(Bytes bytes) {
    if (bytes.size() < 16) return bytes;
    std::memcpy(bytes.data(), "PKW\1", 4);
    ByteWriter(bytes.data() + 4, 4).u32(static_cast<uint32_t>(bytes.size()));
    const size_t at = bytes.size() - 8;
    ByteWriter(bytes.data() + at, 8).u64(fnv1a(kFnvBasis, bytes.data(), at));
    return bytes;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

extern "C" int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    const Bytes bytes(data, data + size);
    for (const Bytes &tried : {bytes, sealed(bytes)}) {
        try_weights(tried);
        try_policy(tried);
    }
    return 0;
}

#ifndef PACKCELL_LIBFUZZER

namespace {

Bytes read_seed(const char *path) {
    Bytes bytes;
    std::FILE *const file = std::fopen(path, "rb");
    if (file == nullptr) {
        std::fprintf(stderr, "fuzz_blob: %s: cannot be read\n", path);
        std::exit(1);
    }
    for (int c = std::fgetc(file); c != EOF; c = std::fgetc(file))
        bytes.push_back(static_cast<uint8_t>(c));
    std::fclose(file);
    return bytes;
}

constexpr uint32_t kTelling[] = {0,          1,          2,          3,          4,
                                 5,          127,        128,        129,        1024,
                                 1025,       0x02000000, 0x3f800000, 0x7f7fffff, 0x7f800000,
                                 0x7fc00000, 0x7fffffff, 0x80000000, 0xbf800000, 0xffffffff};

void mutate(Bytes &bytes, const Bytes &other, Random &random) {
    const auto below = [&random](size_t bound) { return static_cast<size_t>(random.below(bound)); };
    // Most of what decides lies in the first part; the rest is numbers.
    const size_t reach = random.below(2) == 0 ? std::min<size_t>(bytes.size(), 512) : bytes.size();
    const size_t at = below(reach + 1);
    switch (random.below(9)) {
        case 0:
            if (at < bytes.size()) bytes[at] = static_cast<uint8_t>(bytes[at] ^ 1 << below(8));
            break;
        case 1:
            if (at < bytes.size()) bytes[at] = static_cast<uint8_t>(random.next());
            break;
        case 2:
        case 3: {
            const size_t whole = at / 4 * 4;
            if (whole + 4 > bytes.size()) break;
            const uint32_t value = random.below(4) == 0 ? static_cast<uint32_t>(random.next())
                                                        : kTelling[below(std::size(kTelling))];
            ByteWriter(bytes.data() + whole, 4).u32(value);
            break;
        }
        case 4:  // a neighbouring value
        {
            const size_t whole = at / 4 * 4;
            if (whole + 4 > bytes.size()) break;
            const uint32_t value = u32_at(bytes.data() + whole);
            ByteWriter(bytes.data() + whole, 4)
                .u32(random.below(2) == 0 ? value + 4 : value - static_cast<uint32_t>(below(5)));
            break;
        }
        case 5:
            bytes.resize(at);
            break;
        case 6:
            bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(at),
                         (1 + below(16)) * (random.below(2) == 0 ? 4 : 1), uint8_t{0});
            break;
        case 7: {
            const size_t count = std::min(bytes.size() - at, (1 + below(20)) * 4);
            const auto first = bytes.begin() + static_cast<std::ptrdiff_t>(at);
            bytes.erase(first, first + static_cast<std::ptrdiff_t>(count));
            break;
        }
        default: {
            if (other.empty()) break;
            const size_t from = below(other.size());
            const size_t count = std::min({other.size() - from, bytes.size() - at, 1 + below(80)});
            std::copy_n(other.begin() + static_cast<std::ptrdiff_t>(from), count,
                        bytes.begin() + static_cast<std::ptrdiff_t>(at));
        }
    }
}

// The golden files have the networks; of tables, which are longer, these are the smallest.
Bytes afterstate_blob() {
    AfterstateValue value({3, 2, 1, true}, 0.0f);
    Random random(1);
    for (float &entry : value.entries()) entry = static_cast<float>(random.unit());
    Weights weights;
    weights.architecture = Architecture::kAfterstate;
    weights.name = "small";
    weights.bin_w = 3;
    weights.bin_h = 2;
    append_tensors(value, weights.tensors);
    return write_weights(weights);
}

// Long ones seldom: they take their time and have little that short ones have not.
const Bytes &draw_seed(const std::vector<Bytes> &seeds, Random &random) {
    for (;;) {
        const Bytes &bytes = seeds[static_cast<size_t>(random.below(seeds.size()))];
        if (random.below(1 + bytes.size() / 1024) == 0) return bytes;
    }
}

}  // namespace

int main(int argc, char **argv) {
    uint64_t count = 4000;
    const char *all = std::getenv("PACKCELL_CHECK_ALL");
    if (all != nullptr && std::strcmp(all, "1") == 0) count = 1000000;
    uint64_t seed = 1;
    std::vector<Bytes> seeds = {Bytes(), afterstate_blob()};
    for (int i = 1; i < argc; ++i) {
        const bool is_count = std::strcmp(argv[i], "--count") == 0;
        if ((is_count || std::strcmp(argv[i], "--seed") == 0) && i + 1 < argc) {
            (is_count ? count : seed) = std::strtoull(argv[++i], nullptr, 10);
        } else {
            seeds.push_back(read_seed(argv[i]));
        }
    }
    std::printf("fuzz_blob: %llu inputs from %zu seeds, --seed %llu\n",
                static_cast<unsigned long long>(count), seeds.size(),
                static_cast<unsigned long long>(seed));
    for (const Bytes &bytes : seeds) LLVMFuzzerTestOneInput(bytes.data(), bytes.size());
    check(policies_made > 0, "no seed makes a policy");
    for (uint64_t i = 0; i < count; ++i) {
        // Each input has its own numbers: --seed S+i --count 1 gives input i alone.
        Random random(seed + i);
        Bytes bytes = draw_seed(seeds, random);
        for (uint64_t n = 1 + random.below(4); n > 0; --n)
            mutate(bytes, draw_seed(seeds, random), random);
        LLVMFuzzerTestOneInput(bytes.data(), bytes.size());
    }
    std::printf("fuzz_blob: %llu of them could be read, %llu made a policy\n",
                static_cast<unsigned long long>(blobs_read),
                static_cast<unsigned long long>(policies_made));
    return 0;
}

#endif
