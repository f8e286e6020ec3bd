// What a play of calls is made of: bytes as choices, odd values among them, what must hold after
// any call of packcell.h, and the handles that are played with.
#pragma once

#include <array>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <iterator>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "packcell.h"

namespace packcell_fuzz {

using Bytes = std::vector<uint8_t>;

// How a run that breaks a rule is named, so that it can be repeated.
inline std::string &current_input() {
    static std::string name;
    return name;
}

[[noreturn]] inline void broken(const char *what) {
    std::fprintf(stderr, "fuzz_calls: %s: last error '%s' %s\n", what, pkc_last_error(),
                 current_input().c_str());
    std::abort();
}

inline void check(bool holds, const char *what) {
    if (!holds) broken(what);
}

// ---- Choices -----------------------------------------------------------------------------------

// Bytes as choices; past the last one each is the first of what there is.
class Choices {
public:
    Choices(const uint8_t *bytes, size_t size) : bytes_(bytes), size_(size) {}

    bool over() const { return at_ >= size_; }
    uint8_t byte() { return over() ? uint8_t{0} : bytes_[at_++]; }
    uint32_t word() {
        uint32_t value = 0;
        for (int i = 0; i < 4; ++i) value = value << 8 | byte();
        return value;
    }
    int below(int bound) { return byte() % bound; }
    int from(int least, int most) { return least + below(most - least + 1); }
    // True once in `n` times.
    bool seldom(int n) { return below(n) == n - 1; }
    template <class T>
    const T &of(const std::vector<T> &all) {
        return all[word() % all.size()];
    }

    // Small and legal as a rule, else anything.
    int32_t number(int least, int most) {
        static constexpr int32_t odd[] = {-1,  0,   1,    2,     63,    64,        65,       127,
                                          128, 129, 4096, 16384, 65537, INT32_MAX, INT32_MIN};
        if (!seldom(40)) return from(least, most);
        return odd[byte() % std::size(odd)];
    }
    double real(double least, double most) {
        static constexpr double inf = std::numeric_limits<double>::infinity();
        static constexpr double odd[] = {
            -1,   0,     -0.0, 1e-320, 1e-9,
            0.5,  1,     1e3,  1e6,    1e9,
            1e18, 1e308, inf,  -inf,   std::numeric_limits<double>::quiet_NaN()};
        if (!seldom(20)) return least + (most - least) * byte() / 255;
        return odd[byte() % std::size(odd)];
    }
    // A capacity for `count` elements: enough as a rule.
    size_t capacity(size_t count) {
        return seldom(6) ? static_cast<size_t>(below(static_cast<int>(count % 200) + 2)) : count;
    }

private:
    const uint8_t *bytes_;
    size_t size_;
    size_t at_ = 0;
};

// ---- Calls -------------------------------------------------------------------------------------

// How often which call gave what.
inline std::map<std::pair<std::string, pkc_status>, uint64_t> outcomes;

// One thread, enough memory, and no fault of packcell's own: these have no excuse.
inline pkc_status told(const char *call, pkc_status status) {
    ++outcomes[{call, status}];
    if (status == PKC_OK) return status;
    if (status >= 0 || std::strcmp(pkc_status_name(status), "unknown status") == 0)
        broken("a status is none of the header's");
    if (status == PKC_E_INTERNAL || status == PKC_E_BUSY || status == PKC_E_MEMORY) broken(call);
    check(pkc_last_error()[0] != '\0', "a call fails and says nothing");
    return status;
}

inline void must(const char *call, pkc_status status) {
    if (told(call, status) != PKC_OK) broken(call);
}

// A call that fails leaves its outputs, which hold something already, as they were.
template <class Call, class... Out>
pkc_status call(const char *name, const Call &made, Out &...outs) {
    const std::array<Bytes, sizeof...(Out)> before = {
        Bytes(reinterpret_cast<const uint8_t *>(&outs),
              reinterpret_cast<const uint8_t *>(&outs) + sizeof outs)...};
    const pkc_status status = told(name, made());
    if (status != PKC_OK) {
        size_t i = 0;
        const bool same = ((std::memcmp(before[i++].data(), &outs, sizeof outs) == 0) && ...);
        if (!same) {
            std::fprintf(stderr, "%s\n", name);
            broken("a call that fails changes an output");
        }
    }
    return status;
}

// A call that fills an array of exactly `capacity` elements, and what it filled.
template <class T, class Call>
pkc_status fill(const char *name, size_t capacity, std::vector<T> &out, const Call &made) {
    const Bytes pattern(capacity * sizeof(T), 0xa5);
    out.resize(capacity);
    if (capacity > 0) std::memcpy(out.data(), pattern.data(), pattern.size());
    size_t count = 0x5a5a5a5a;
    const pkc_status status = told(name, made(out.data(), capacity, &count));
    if (status == PKC_OK) {
        check(count <= capacity, "an array gets more than its capacity");
        out.resize(count);
        return status;
    }
    check(status == PKC_E_CAPACITY ? count > capacity : count == 0x5a5a5a5a,
          "a call that fails changes a count");
    check(capacity == 0 || std::memcmp(out.data(), pattern.data(), pattern.size()) == 0,
          "a call that fails changes an array");
    out.clear();
    return status;
}

// All there is: asks for the number first.
template <class T, class Call>
std::vector<T> all(const char *name, const Call &made) {
    size_t count = 0;
    const pkc_status asked = told(name, made(static_cast<T *>(nullptr), 0, &count));
    check(asked == PKC_E_CAPACITY || (asked == PKC_OK && count == 0), name);
    std::vector<T> out;
    if (count > 0 && fill(name, count, out, made) != PKC_OK) broken(name);
    check(out.size() == count, "an array has another number of elements than was said");
    return out;
}

template <class T, pkc_status (*Init)(T *, size_t)>
T initialised() {
    T value;
    must("_init", Init(&value, sizeof value));
    return value;
}

// ---- Handles -----------------------------------------------------------------------------------

template <auto Free>
struct Freer {
    template <class T>
    void operator()(T *handle) const {
        Free(handle);
    }
};
template <class T, void (*Free)(T *)>
using Handle = std::unique_ptr<T, Freer<Free>>;

using Bin = Handle<pkc_bin, pkc_bin_free>;
using Queue = Handle<pkc_queue, pkc_queue_free>;
using Policy = Handle<pkc_policy, pkc_policy_free>;
using Planner = Handle<pkc_planner, pkc_planner_free>;
using Cell = Handle<pkc_cell, pkc_cell_free>;
using Schedule = Handle<pkc_schedule, pkc_schedule_free>;
using Simulation = Handle<pkc_simulation, pkc_simulation_free>;
using Trainer = Handle<pkc_trainer, pkc_trainer_free>;
using Environment = Handle<pkc_environment, pkc_environment_free>;
using Generator = Handle<pkc_generator, pkc_generator_free>;

// A call that makes a handle: all or nothing. What was in `out` before is freed.
template <class Owner, class Call>
pkc_status make(const char *name, Owner &out, const Call &made) {
    typename Owner::pointer handle = nullptr;
    const pkc_status status = told(name, made(&handle));
    check((status == PKC_OK) == (handle != nullptr), "a handle is made by halves");
    if (status == PKC_OK) out.reset(handle);
    return status;
}

// A bin and a queue that belong together, and the schedule of what is done with them.
struct Scene {
    Bin bin;
    Queue queue;
    Schedule schedule;
    int steps = 0;     // in the schedule
    int releases = 0;  // of items into the bin, in the schedule
};

// A plan under way, and copies of what it is for.
struct Planning {
    Planner planner;
    pkc_planner_options options{};
    Policy *policy = nullptr;
    Bin bin;
    Queue queue;
    bool begun = false;
};

// All that is played with; every handle may be missing.
struct World {
    World(const uint8_t *bytes, size_t size) : in(bytes, size) {}

    Choices in;
    int32_t next_id = 0;
    Scene scenes[3];
    Planning plannings[2];
    Policy policies[2];
    Cell cells[2];
    Simulation simulations[2];
    Trainer trainer;
    Environment environment;
    Generator generator;
    Bytes snapshot;
    uint64_t seen = 0xcbf29ce484222325u;  // of all results: equal bytes are to give an equal one

    Scene &scene() { return scenes[in.seldom(4) ? in.below(3) : 0]; }

    void see(uint64_t value) {
        for (int i = 0; i < 8; ++i) {
            seen = (seen ^ (value >> (8 * i) & 0xff)) * 0x100000001b3u;
        }
    }
};

// FNV-1a, to put a checksum under changed bytes.
inline uint64_t checksum(const uint8_t *bytes, size_t size) {
    uint64_t hash = 0xcbf29ce484222325u;
    for (size_t i = 0; i < size; ++i) hash = (hash ^ bytes[i]) * 0x100000001b3u;
    return hash;
}

// Changes some of the bytes; as a rule their last eight are the right checksum again.
inline void damage(Choices &in, Bytes &bytes) {
    for (int n = in.from(1, 3); n > 0 && !bytes.empty(); --n) {
        const size_t at = in.word() % bytes.size();
        switch (in.below(8)) {
            case 0:
                bytes.resize(at);
                break;
            case 1:
                bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(at), in.byte());
                break;
            case 2:
            case 3: {
                const auto value = static_cast<uint32_t>(in.number(0, 12));
                for (size_t i = 0; i < 4 && at + i < bytes.size(); ++i)
                    bytes[at + i] = static_cast<uint8_t>(value >> (8 * i));
                break;
            }
            case 4:
                bytes[at] = in.byte();
                break;
            default:
                bytes[at] = static_cast<uint8_t>(bytes[at] ^ 1 << in.below(8));
        }
    }
    if (bytes.size() < 8 || in.seldom(4)) return;
    const uint64_t hash = checksum(bytes.data(), bytes.size() - 8);
    for (size_t i = 0; i < 8; ++i)
        bytes[bytes.size() - 8 + i] = static_cast<uint8_t>(hash >> (8 * i));
}

}  // namespace packcell_fuzz
