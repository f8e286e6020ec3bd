#include "policy/weights.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/bytes.h"

namespace packcell {

namespace {

constexpr char kMagic[] = {'P', 'K', 'W'};
constexpr uint8_t kVersion = 1;
constexpr size_t kNameBytes = 32;  // with at least one closing zero
constexpr size_t kHeaderBytes = 112;
constexpr size_t kEntryBytes = 64;  // of a tensor in the table
constexpr size_t kChecksumBytes = 8;
constexpr size_t kLeastBytes = kHeaderBytes + kEntryBytes + 4 + kChecksumBytes;
constexpr size_t kMostDimensions = 4;
constexpr int kMostElements = static_cast<int>(kMostBlobBytes / 2);

// Products of it with an int16 stay finite, and no number below it is so small that precision goes.
constexpr float kLeastScale = 1e-30f;
constexpr float kMostScale = 1e30f;

constexpr size_t element_bytes(Stored stored) { return stored == Stored::kInt16 ? 2 : 4; }

constexpr size_t aligned(size_t size) { return (size + 3) / 4 * 4; }

std::string text_of(const std::vector<uint32_t> &shape) {
    std::string text;
    for (const uint32_t side : shape) text += (text.empty() ? "" : "x") + std::to_string(side);
    return text;
}

// ---- Reading ------------------------------------------------------------------------------------

// What is told before anything is trusted.
void check_frame(const uint8_t *bytes, size_t size) {
    ByteReader in(bytes, size);
    for (const char c : kMagic) {
        if (in.u8() != static_cast<uint8_t>(c))
            fail(Status::kFormat, "byte 0: not a packcell weight blob: must begin with 'PKW'");
    }
    const uint8_t version = in.u8();
    if (version != kVersion)
        fail(Status::kFormat, "byte 3: version %u: must be %u", version, kVersion);
    const uint32_t total = in.u32();
    if (total < kLeastBytes || total > kMostBlobBytes) {
        fail(Status::kFormat, "byte 4: size %u: must be %zu..%zu", total, kLeastBytes,
             kMostBlobBytes);
    }
    if (total % 4 != 0) fail(Status::kFormat, "byte 4: size %u: must be a multiple of 4", total);
    if (size < total) {
        fail(Status::kFormat, "byte %zu: the data ends here and must have %u bytes", size, total);
    }
    if (size > total) {
        fail(Status::kFormat, "byte %u: %zu bytes follow the end", total, size - total);
    }
    const size_t at = size - kChecksumBytes;
    const uint64_t hash = fnv1a(kFnvBasis, bytes, at);
    if (ByteReader(bytes + at, kChecksumBytes).u64() != hash)
        fail(Status::kFormat, "byte %zu: the checksum does not agree", at);
}

bool name_character(char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') ||
           (c != '\0' && std::strchr("_./-", c));
}

std::string read_name(ByteReader &in, const char *what, bool may_be_empty) {
    const size_t at = in.at();
    const auto *text = reinterpret_cast<const char *>(in.take(kNameBytes));
    size_t length = 0;
    while (length < kNameBytes && name_character(text[length])) ++length;
    for (size_t i = length; i < kNameBytes; ++i) {
        if (text[i] == '\0') continue;
        fail(Status::kFormat, "byte %zu: %s has character %u: must be a-z, 0-9, '_', '.', '/', '-'",
             at + i, what, static_cast<uint8_t>(text[i]));
    }
    if (length == kNameBytes || (length == 0 && !may_be_empty)) {
        fail(Status::kFormat, "byte %zu: %s has %zu characters: must be %d..%zu", at, what, length,
             may_be_empty ? 0 : 1, kNameBytes - 1);
    }
    return {text, length};
}

float read_float(ByteReader &in, const char *what, float least, float most) {
    const size_t at = in.at();
    const float value = in.f32();
    if (std::isfinite(value) && value >= least && value <= most) return value;
    fail(Status::kFormat, "byte %zu: %s %g: must be finite and %g..%g", at, what,
         static_cast<double>(value), static_cast<double>(least), static_cast<double>(most));
}

TrainingRecord read_training(ByteReader &in) {
    TrainingRecord training;
    training.learner = read_name(in, "learner", true);
    training.seed = in.u64();
    training.steps = in.u64();
    training.reward_fill = read_float(in, "reward_fill", 0, 1);
    const size_t at = in.at();
    training.utilization = read_float(in, "utilization", -1, 1);
    if (training.utilization < 0 && training.utilization != -1) {
        fail(Status::kFormat, "byte %zu: utilization %g: must be 0..1, or -1 for not measured", at,
             static_cast<double>(training.utilization));
    }
    return training;
}

// Numbers that the shape stands for: no more than `most`.
size_t count_of(const Tensor &tensor, size_t at, size_t most) {
    size_t count = 1;
    for (const uint32_t side : tensor.shape) {
        if (side > most / count) {
            fail(Status::kFormat, "byte %zu: tensor '%s' of %s: the data ends before so much", at,
                 tensor.name.c_str(), text_of(tensor.shape).c_str());
        }
        count *= side;
    }
    return count;
}

// An entry of the table, and the bytes that belong to it.
struct Entry {
    Tensor tensor;
    size_t count = 0;
};

// `data_at` is where the tensor has to begin and gets where the next one has to; `end` is where the
// last one must end.
Entry read_entry(ByteReader &in, size_t &data_at, size_t end) {
    const size_t at = in.at();
    Entry entry;
    Tensor &tensor = entry.tensor;
    tensor.name = read_name(in, "tensor name", false);
    tensor.stored = static_cast<Stored>(in.ranged("storage", 1, 2));
    const int dimensions = in.ranged("dimensions", 1, static_cast<int>(kMostDimensions));
    for (int i = 0; i < static_cast<int>(kMostDimensions); ++i) {
        if (i < dimensions) {
            tensor.shape.push_back(static_cast<uint32_t>(in.ranged("side", 1, kMostElements)));
        } else {
            in.ranged("side of no dimension", 0, 0);
        }
    }
    tensor.scale = tensor.stored == Stored::kInt16
                       ? read_float(in, "scale", kLeastScale, kMostScale)
                       : static_cast<float>(in.ranged("scale of float32", 0, 0));
    const size_t offset_at = in.at();
    const uint32_t offset = in.u32();
    if (offset != data_at) {
        fail(Status::kFormat, "byte %zu: tensor '%s' begins at %u: must be %zu", offset_at,
             tensor.name.c_str(), offset, data_at);
    }
    const size_t width = element_bytes(tensor.stored);
    entry.count = count_of(tensor, at, (end - data_at) / width);
    // The end is a multiple of 4 as well, so this does not pass it.
    data_at = aligned(data_at + entry.count * width);
    return entry;
}

void read_data(ByteReader &in, Entry &entry) {
    Tensor &tensor = entry.tensor;
    const size_t at = in.at();
    const size_t width = element_bytes(tensor.stored);
    const uint8_t *bytes = in.take(entry.count * width);
    tensor.data.resize(entry.count);
    if (tensor.stored == Stored::kInt16) {
        for (size_t i = 0; i < entry.count; ++i) {
            const auto number = static_cast<int16_t>(u16_at(bytes + 2 * i));
            tensor.data[i] = static_cast<float>(number) * tensor.scale;
        }
    } else {
        for (size_t i = 0; i < entry.count; ++i) {
            tensor.data[i] = float_of(u32_at(bytes + 4 * i));
            if (!std::isfinite(tensor.data[i])) {
                fail(Status::kFormat, "byte %zu: tensor '%s' has %g: must be finite", at + 4 * i,
                     tensor.name.c_str(), static_cast<double>(tensor.data[i]));
            }
        }
    }
    while (in.at() % 4 != 0) {
        const size_t padding_at = in.at();
        const uint8_t padding = in.u8();
        if (padding != 0)
            fail(Status::kFormat, "byte %zu: padding %u: must be 0", padding_at, padding);
    }
}

// ---- Writing ------------------------------------------------------------------------------------

// What a blob has no room for; all else is found by reading it again.
void check_layout(const Weights &weights) {
    const auto check_name = [](const char *what, const std::string &name) {
        if (name.size() < kNameBytes && name.find('\0') == std::string::npos) return;
        fail(Status::kArgument, "%s '%.40s' has %zu characters: must be 1..%zu", what, name.c_str(),
             name.size(), kNameBytes - 1);
    };
    check_name("policy name", weights.name);
    check_name("learner", weights.training.learner);
    if (weights.tensors.empty() || weights.tensors.size() > kMostTensors) {
        fail(Status::kArgument, "%zu tensors: must be 1..%d", weights.tensors.size(), kMostTensors);
    }
    size_t total = kHeaderBytes + kChecksumBytes + weights.tensors.size() * kEntryBytes;
    for (const Tensor &tensor : weights.tensors) {
        check_name("tensor", tensor.name);
        if (tensor.shape.empty() || tensor.shape.size() > kMostDimensions) {
            fail(Status::kArgument, "tensor '%s' has %zu dimensions: must be 1..%zu",
                 tensor.name.c_str(), tensor.shape.size(), kMostDimensions);
        }
        size_t count = 1;
        for (const uint32_t side : tensor.shape) {
            if (side == 0 || side > kMostBlobBytes / count) {
                fail(Status::kArgument, "tensor '%s' of %s: must have 1..%d numbers",
                     tensor.name.c_str(), text_of(tensor.shape).c_str(), kMostElements);
            }
            count *= side;
        }
        if (tensor.data.size() != count) {
            fail(Status::kArgument, "tensor '%s' of %s has %zu numbers: must be %zu",
                 tensor.name.c_str(), text_of(tensor.shape).c_str(), tensor.data.size(), count);
        }
        total += aligned(count * element_bytes(tensor.stored));
        if (total > kMostBlobBytes) {
            fail(Status::kArgument, "tensor '%s' of %s: the blob has more than %zu bytes",
                 tensor.name.c_str(), text_of(tensor.shape).c_str(), kMostBlobBytes);
        }
    }
}

// The nearest int16 number of scales.
int16_t quantised(float value, float scale) {
    const float number = std::nearbyint(value / scale);
    return static_cast<int16_t>(std::clamp(number, -32768.0f, 32767.0f));
}

float scale_of(const Tensor &tensor) {
    float largest = 0;
    for (const float value : tensor.data) {
        if (!std::isfinite(value)) {
            fail(Status::kArgument, "tensor '%s' has %g: must be finite", tensor.name.c_str(),
                 static_cast<double>(value));
        }
        largest = std::max(largest, std::fabs(value));
    }
    const float kept = tensor.scale;
    const auto is_multiple = [kept](float value) {
        return static_cast<float>(quantised(value, kept)) * kept == value;
    };
    if (kept >= kLeastScale && kept <= kMostScale &&
        std::all_of(tensor.data.begin(), tensor.data.end(), is_multiple))
        return kept;
    return std::max(largest / 32767, kLeastScale);
}

void write_name(ByteWriter &out, const std::string &name) {
    for (size_t i = 0; i < kNameBytes; ++i)
        out.u8(static_cast<uint8_t>(i < name.size() ? name[i] : '\0'));
}

void write_header(ByteWriter &out, const Weights &weights, size_t total) {
    for (const char c : kMagic) out.u8(static_cast<uint8_t>(c));
    out.u8(kVersion);
    out.u32(static_cast<uint32_t>(total));
    out.u32(static_cast<uint32_t>(weights.architecture));
    out.i32(weights.bin_w);
    out.i32(weights.bin_h);
    out.u32(static_cast<uint32_t>(weights.tensors.size()));
    write_name(out, weights.name);
    const TrainingRecord &training = weights.training;
    write_name(out, training.learner);
    out.u64(training.seed);
    out.u64(training.steps);
    out.f32(training.reward_fill);
    out.f32(training.utilization < 0 ? -1 : training.utilization);
}

void write_data(ByteWriter &out, const Tensor &tensor, float scale) {
    if (tensor.stored == Stored::kInt16) {
        for (const float value : tensor.data)
            out.u16(static_cast<uint16_t>(quantised(value, scale)));
    } else {
        for (const float value : tensor.data) out.f32(value);
    }
    while (out.size() % 4 != 0) out.u8(0);
}

}  // namespace

Weights read_weights(const uint8_t *bytes, size_t size) {
    check_frame(bytes, size);
    const size_t end = size - kChecksumBytes;
    ByteReader in(bytes, end);
    in.take(sizeof kMagic + sizeof kVersion + sizeof(uint32_t));
    Weights weights;
    weights.architecture = static_cast<Architecture>(in.ranged("architecture", 1, 3));
    const size_t bin_at = in.at();
    weights.bin_w = in.ranged("bin width", 0, kMaxSide);
    weights.bin_h = in.ranged("bin height", 0, kMaxSide);
    if ((weights.bin_w == 0) != (weights.bin_h == 0)) {
        fail(Status::kFormat, "byte %zu: bin %dx%d: must be 1x1..%dx%d, or 0x0 for any", bin_at,
             weights.bin_w, weights.bin_h, kMaxSide, kMaxSide);
    }
    const size_t count_at = in.at();
    const auto count = static_cast<size_t>(in.ranged("tensors", 1, kMostTensors));
    weights.name = read_name(in, "policy name", false);
    weights.training = read_training(in);
    if (count > in.left() / kEntryBytes) {
        fail(Status::kFormat, "byte %zu: tensors %zu: the data ends before so many", count_at,
             count);
    }

    size_t data_at = kHeaderBytes + count * kEntryBytes;
    std::vector<Entry> entries;
    entries.reserve(count);
    for (size_t i = 0; i < count; ++i) {
        const size_t at = in.at();
        entries.push_back(read_entry(in, data_at, end));
        for (size_t j = 0; j < i; ++j) {
            if (entries[j].tensor.name != entries[i].tensor.name) continue;
            fail(Status::kFormat, "byte %zu: tensor '%s' occurs twice", at,
                 entries[i].tensor.name.c_str());
        }
    }
    if (data_at != end) {
        fail(Status::kFormat, "byte %zu: %zu bytes follow the last tensor: must be the checksum",
             data_at, end - data_at);
    }
    weights.tensors.reserve(count);
    for (Entry &entry : entries) {
        read_data(in, entry);
        weights.tensors.push_back(std::move(entry.tensor));
    }
    return weights;
}

std::vector<uint8_t> write_weights(const Weights &weights) {
    check_layout(weights);
    std::vector<float> scales;
    scales.reserve(weights.tensors.size());
    size_t total = kHeaderBytes + weights.tensors.size() * kEntryBytes;
    for (const Tensor &tensor : weights.tensors) {
        scales.push_back(tensor.stored == Stored::kInt16 ? scale_of(tensor) : 0.0f);
        total += aligned(tensor.data.size() * element_bytes(tensor.stored));
    }
    total += kChecksumBytes;

    std::vector<uint8_t> bytes(total);
    ByteWriter out(bytes.data(), bytes.size());
    write_header(out, weights, total);
    size_t offset = kHeaderBytes + weights.tensors.size() * kEntryBytes;
    for (size_t i = 0; i < weights.tensors.size(); ++i) {
        const Tensor &tensor = weights.tensors[i];
        write_name(out, tensor.name);
        out.u32(static_cast<uint32_t>(tensor.stored));
        out.u32(static_cast<uint32_t>(tensor.shape.size()));
        for (size_t d = 0; d < kMostDimensions; ++d)
            out.u32(d < tensor.shape.size() ? tensor.shape[d] : 0);
        out.f32(scales[i]);
        out.u32(static_cast<uint32_t>(offset));
        offset += aligned(tensor.data.size() * element_bytes(tensor.stored));
    }
    for (size_t i = 0; i < weights.tensors.size(); ++i)
        write_data(out, weights.tensors[i], scales[i]);
    out.u64(out.hash());

    // The rules are those of reading, in one place: nothing is written that could not be read.
    try {
        read_weights(bytes.data(), bytes.size());
    } catch (const Error &e) {
        fail(Status::kArgument, "weights '%s' make no blob: %s", weights.name.c_str(), e.what());
    }
    return bytes;
}

const Tensor &Weights::tensor(const char *tensor_name, const std::vector<uint32_t> &shape) const {
    for (const Tensor &t : tensors) {
        if (t.name != tensor_name) continue;
        if (t.shape == shape) return t;
        fail(Status::kFormat, "tensor '%s' of %s: must be of %s", tensor_name,
             text_of(t.shape).c_str(), text_of(shape).c_str());
    }
    fail(Status::kFormat, "there is no tensor '%s' of %s", tensor_name, text_of(shape).c_str());
}

uint64_t Weights::parameters() const {
    uint64_t count = 0;
    for (const Tensor &t : tensors) count += t.data.size();
    return count;
}

void LearnedPolicy::check_bin(int w, int h) const {
    if (weights_.bin_w == 0 || (weights_.bin_w == w && weights_.bin_h == h)) return;
    fail(Status::kArgument, "bin %dx%d: policy '%s' was trained for %dx%d bins", w, h, name(),
         weights_.bin_w, weights_.bin_h);
}

}  // namespace packcell
