#include "learn/trainer.h"

#include <cmath>
#include <cstring>
#include <utility>

#include "base/status.h"
#include "learn/afterstate_learner.h"

namespace packcell {

namespace {

constexpr char kMagic[] = {'P', 'K', 'T', 1};  // the last one is the version
constexpr size_t kNameBytes = 32;
constexpr size_t kChecksumBytes = 8;

// Calls visit(what, field) for every option, in the order of the file.
template <class Options, class Visit>
void each_option(Options &o, Visit &&visit) {
    visit("bin w", o.protocol.bin_w);
    visit("bin h", o.protocol.bin_h);
    visit("least side", o.protocol.least_side);
    visit("most side", o.protocol.most_side);
    visit("items", o.protocol.items);
    visit("rotation", o.protocol.rotation);
    visit("mixed", o.protocol.mixed);
    visit("network bin w", o.shape.bin_w);
    visit("network bin h", o.shape.bin_h);
    visit("channels", o.shape.channels);
    visit("features", o.shape.features);
    visit("hidden", o.shape.hidden);
    visit("workers", o.workers);
    visit("environments", o.environments);
    visit("steps", o.steps);
    visit("seed", o.seed);
    visit("anneal", o.anneal);
    visit("gamma", o.gamma);
    visit("learning rate", o.learning_rate);
    visit("entropy", o.entropy);
    visit("value weight", o.value_weight);
    visit("clip", o.clip);
    visit("reward fill", o.reward_fill);
}

struct Write {
    ByteWriter &out;
    void operator()(const char *, int value) { out.i32(value); }
    void operator()(const char *, bool value) { out.u8(value ? 1 : 0); }
    void operator()(const char *, uint64_t value) { out.u64(value); }
    void operator()(const char *, double value) {
        uint64_t bits = 0;
        std::memcpy(&bits, &value, sizeof bits);
        out.u64(bits);
    }
};

// Ranges are checked by make_learner().
struct Read {
    ByteReader &in;
    void operator()(const char *, int &value) { value = in.i32(); }
    void operator()(const char *what, bool &value) {
        const size_t at = in.at();
        const uint8_t byte = in.u8();
        if (byte > 1) fail(Status::kFormat, "byte %zu: %s %u: must be 0 or 1", at, what, byte);
        value = byte != 0;
    }
    void operator()(const char *, uint64_t &value) { value = in.u64(); }
    void operator()(const char *what, double &value) {
        const size_t at = in.at();
        const uint64_t bits = in.u64();
        std::memcpy(&value, &bits, sizeof value);
        if (!std::isfinite(value)) {
            fail(Status::kFormat, "byte %zu: %s is not a finite number", at, what);
        }
    }
};

void write(const Training &training, ByteWriter &out) {
    for (const char c : kMagic) out.u8(static_cast<uint8_t>(c));
    const TrainerOptions &o = training.options;
    out.i32(static_cast<int32_t>(o.learner));
    out.u32(static_cast<uint32_t>(o.a3c.shape.architecture));
    for (size_t i = 0; i < kNameBytes; ++i) {
        out.u8(i < o.a3c.name.size() ? static_cast<uint8_t>(o.a3c.name[i]) : 0);
    }
    each_option(o.a3c, Write{out});
    out.f32(training.utilization);
    training.learner->save(out);
    out.u64(out.hash());
}

TrainerOptions read_options(ByteReader &in) {
    TrainerOptions o;
    o.learner = static_cast<LearnerKind>(in.ranged("learner", 1, 2));
    o.a3c.shape.architecture = static_cast<Architecture>(in.ranged("architecture", 1, 3));
    const size_t at = in.at();
    const auto *name = reinterpret_cast<const char *>(in.take(kNameBytes));
    const size_t length = strnlen(name, kNameBytes);
    for (size_t i = length; i < kNameBytes; ++i) {
        if (name[i] != 0)
            fail(Status::kFormat, "byte %zu: something follows the end of the name", at + i);
    }
    o.a3c.name.assign(name, length);
    each_option(o.a3c, Read{in});
    return o;
}

}  // namespace

std::unique_ptr<Learner> make_learner(const TrainerOptions &options) {
    std::unique_ptr<Learner> learner;
    if (options.learner == LearnerKind::kA3c) {
        learner = make_a3c(options.a3c);
    } else {
        const A3cOptions &o = options.a3c;
        learner =
            std::make_unique<AfterstateLearner>(AfterstateOptions{o.name, o.protocol, o.seed});
    }
    // Not after hours: throws for a name or a size that no blob has.
    write_weights(learner->weights());
    return learner;
}

std::vector<uint8_t> write_checkpoint(const Training &training) {
    ByteWriter counter(nullptr, 0);
    write(training, counter);
    std::vector<uint8_t> bytes(counter.size());
    ByteWriter out(bytes.data(), bytes.size());
    write(training, out);
    return bytes;
}

Training read_checkpoint(const uint8_t *bytes, size_t size) {
    if (size < sizeof kMagic || std::memcmp(bytes, kMagic, 3) != 0) {
        fail(Status::kFormat, "byte 0: not a checkpoint of a training: must begin with 'PKT'");
    }
    if (bytes[3] != static_cast<uint8_t>(kMagic[3])) {
        fail(Status::kFormat, "byte 3: version %u: must be %d", bytes[3], kMagic[3]);
    }
    if (size < sizeof kMagic + kChecksumBytes) {
        fail(Status::kFormat, "byte %zu: the data ends here", size);
    }
    const size_t end = size - kChecksumBytes;
    if (ByteReader(bytes + end, kChecksumBytes).u64() != fnv1a(kFnvBasis, bytes, end)) {
        fail(Status::kFormat, "byte %zu: the checksum does not agree", end);
    }
    ByteReader in(bytes, end);
    in.take(sizeof kMagic);
    Training training;
    training.options = read_options(in);
    try {
        training.learner = make_learner(training.options);
    } catch (const Error &e) {
        if (e.status() != Status::kArgument) throw;
        fail(Status::kFormat, "%s", e.what());
    }
    const size_t at = in.at();
    training.utilization = in.f32();
    if (!(training.utilization >= -1.0f && training.utilization <= 1.0f)) {
        fail(Status::kFormat, "byte %zu: utilisation must be -1..1", at);
    }
    training.learner->restore(in);
    if (in.left() > 0) {
        fail(Status::kFormat, "byte %zu: %zu bytes follow the end", in.at(), in.left());
    }
    return training;
}

}  // namespace packcell
