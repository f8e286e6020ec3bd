// packcell for C++17: packcell.h with handles that free themselves, exceptions and spans.
//
// Conventions, beside those of packcell.h, which says what each call does:
//  - Classes own one handle each; they are moved, not copied (`clone` copies where C can). An
//    object that was moved from holds NULL: it may be destroyed or assigned to, and any other use
//    throws an Error, as the library says it.
//  - A failing call throws Error, with the status and the library's line. (A program built with
//    -fno-exceptions uses packcell.h.)
//  - Plain records are the C structs (Item, Action, ...). Option and info structs are filled by
//    their `_init` when they are made, then set fields.
//  - Arrays given are Spans over the caller's memory and are not copied. Arrays asked for come as
//    std::vector, or into the caller's Span, where it is enough.
//  - Nothing but what is inline here is added to the C calls.
#ifndef PACKCELL_HPP
#define PACKCELL_HPP

#include <packcell.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace packcell {
// A name of its own in every symbol: the static library has classes of the same names inside.
inline namespace v0 {

// ---- Errors -------------------------------------------------------------------------------------

// A call that failed. what() is the line of pkc_last_error().
class Error : public std::runtime_error {
public:
    explicit Error(pkc_status status) : Error(status, pkc_last_error()) {}
    Error(pkc_status status, const std::string &line) : std::runtime_error(line), status_(status) {}

    pkc_status status() const noexcept { return status_; }
    // "PKC_E_ARGUMENT" and the like.
    const char *status_name() const noexcept { return pkc_status_name(status_); }

private:
    pkc_status status_;
};

namespace detail {
// Apart, so that a call that succeeds costs its caller a test and nothing else.
[[noreturn, gnu::noinline, gnu::cold]] inline void raise(pkc_status status) { throw Error(status); }
}  // namespace detail

// Throws what a failed call says of itself.
inline void check(pkc_status status) {
    if (status != PKC_OK) detail::raise(status);
}

inline std::uint32_t version() noexcept { return pkc_version(); }

// ---- Spans and records --------------------------------------------------------------------------

// Elements of the caller's: a pointer and a size. Made from anything that has data() and size(), or
// from an array.
template <class T>
class Span {
    template <class U>
    using Same = std::enable_if_t<std::is_convertible_v<U (*)[], T (*)[]>>;

public:
    constexpr Span() noexcept = default;
    constexpr Span(T *data, std::size_t size) noexcept : data_(data), size_(size) {}
    template <std::size_t N>
    constexpr Span(T (&array)[N]) noexcept : data_(array), size_(N) {}
    template <class C, class = Same<std::remove_pointer_t<decltype(std::declval<C &>().data())>>>
    constexpr Span(C &elements) noexcept : data_(elements.data()), size_(elements.size()) {}
    // A temporary may give what even a const one would: a container its elements to read, a view
    // (std::span) those that it is of.
    template <class C,
              class = Same<std::remove_pointer_t<decltype(std::declval<const C &>().data())>>,
              class = std::enable_if_t<!std::is_lvalue_reference_v<C>>>
    constexpr Span(C &&elements) noexcept : data_(elements.data()), size_(elements.size()) {}

    constexpr T *data() const noexcept { return data_; }
    constexpr std::size_t size() const noexcept { return size_; }
    constexpr bool empty() const noexcept { return size_ == 0; }
    constexpr T &operator[](std::size_t index) const noexcept { return data_[index]; }
    constexpr T *begin() const noexcept { return data_; }
    constexpr T *end() const noexcept { return data_ + size_; }

private:
    T *data_ = nullptr;
    std::size_t size_ = 0;
};

using Item = pkc_item;
using Placement = pkc_placement;
using Queued = pkc_queued;
using Action = pkc_action;
using ArmTimes = pkc_arm_times;
using ArmSample = pkc_arm_sample;
using Place = pkc_place;

// A struct that begins with struct_size, with its defaults in it.
template <class T, pkc_status (*Init)(T *, std::size_t)>
struct Versioned : T {
    Versioned() : T() { check(Init(this, sizeof(T))); }
    Versioned(const T &record) : T(record) {}
};

using BinInfo = Versioned<pkc_bin_info, pkc_bin_info_init>;
using QueueInfo = Versioned<pkc_queue_info, pkc_queue_info_init>;
using Grid = Versioned<pkc_grid, pkc_grid_init>;
using PolicyInfo = Versioned<pkc_policy_info, pkc_policy_info_init>;
using EnvironmentOptions = Versioned<pkc_environment_options, pkc_environment_options_init>;
using EnvironmentInfo = Versioned<pkc_environment_info, pkc_environment_info_init>;
using TrainerOptions = Versioned<pkc_trainer_options, pkc_trainer_options_init>;
using TrainerInfo = Versioned<pkc_trainer_info, pkc_trainer_info_init>;
using PlannerOptions = Versioned<pkc_planner_options, pkc_planner_options_init>;
using Budget = Versioned<pkc_budget, pkc_budget_init>;
using PlanInfo = Versioned<pkc_plan_info, pkc_plan_info_init>;
using CellInfo = Versioned<pkc_cell_info, pkc_cell_info_init>;
using LayoutOptions = Versioned<pkc_layout_options, pkc_layout_options_init>;
using LayoutInfo = Versioned<pkc_layout_info, pkc_layout_info_init>;
using ScheduleInfo = Versioned<pkc_schedule_info, pkc_schedule_info_init>;
using SimulationOptions = Versioned<pkc_simulation_options, pkc_simulation_options_init>;
using SimulationInfo = Versioned<pkc_simulation_info, pkc_simulation_info_init>;
using GeneratorOptions = Versioned<pkc_generator_options, pkc_generator_options_init>;

// ---- What the classes are made of ---------------------------------------------------------------

namespace detail {

// Owns a handle, or NULL once it was moved from.
template <class T, void (*Free)(T *)>
class Handle {
public:
    using Type = T;

    // Takes over a handle of the C interface.
    explicit Handle(T *owned) noexcept : handle_(owned) {}
    Handle(Handle &&other) noexcept : handle_(other.release()) {}
    Handle &operator=(Handle &&other) noexcept {
        T *taken = other.release();
        Free(std::exchange(handle_, taken));
        return *this;
    }
    ~Handle() { Free(handle_); }

    // The handle for calls of the C interface; it stays this object's.
    T *get() noexcept { return handle_; }
    const T *get() const noexcept { return handle_; }
    explicit operator bool() const noexcept { return handle_ != nullptr; }
    // Gives the handle away: whoever takes it frees it.
    T *release() noexcept { return std::exchange(handle_, nullptr); }

protected:
    Handle() noexcept = default;
    T **out() noexcept { return &handle_; }

private:
    T *handle_ = nullptr;
};

// Calls `call(args..., data, capacity, &count)` for the caller's memory; the count.
template <class T, class Call, class... Args>
std::size_t fill(Span<T> to, Call call, Args... args) {
    std::size_t count = 0;
    check(call(args..., to.data(), to.size(), &count));
    return count;
}

// The same into a vector of the size that it asks for.
template <class T, class Call, class... Args>
std::vector<T> filled(Call call, Args... args) {
    std::size_t count = 0;
    pkc_status status = call(args..., nullptr, 0, &count);
    if (status != PKC_E_CAPACITY) check(status);
    std::vector<T> elements(count);
    if (count > 0) elements.resize(fill(Span<T>(elements), call, args...));
    return elements;
}

// The struct that `call(handle, &record)` fills.
template <class T, class Call, class H>
T got(Call call, const H *handle) {
    T record;
    check(call(handle, &record));
    return record;
}

// The object that owns what `call(args..., &handle)` gives.
template <class C, class Call, class... Args>
C made(Call call, Args... args) {
    typename C::Type *handle = nullptr;
    check(call(args..., &handle));
    return C(handle);
}

// C reads a text to its first zero, and would not see what comes after it.
inline const char *text(const std::string &text) {
    if (text.find('\0') != std::string::npos)
        throw Error(PKC_E_ARGUMENT, "text with a zero byte: must have none");
    return text.c_str();
}

// No bytes at all hold the wrong thing, but are not NULL.
inline const std::uint8_t *bytes(Span<const std::uint8_t> given) noexcept {
    static constexpr std::uint8_t kNone = 0;
    return given.empty() ? &kNone : given.data();
}

// For a handle that C lets be NULL, where the caller did name one.
template <class H>
auto named(const H &handle, const char *what) {
    if (!handle) throw Error(PKC_E_ARGUMENT, std::string(what) + " was moved from: must hold one");
    return handle.get();
}

template <class Names>
std::vector<std::string> listed(Names name) {
    std::vector<std::string> names;
    while (const char *next = name(names.size())) names.emplace_back(next);
    return names;
}

}  // namespace detail

// ---- Scenario and grid --------------------------------------------------------------------------

// Who sees and reaches what: pkc_scenario with its name.
struct Scenario : Versioned<pkc_scenario, pkc_scenario_init> {
    using Versioned::Versioned;
    // "S-R5A3" or "D-R5A3O1".
    explicit Scenario(const std::string &name) {
        check(pkc_scenario_parse(detail::text(name), this));
    }

    std::string name() const {
        char name[32];
        check(pkc_scenario_name(this, name, sizeof name));
        return name;
    }
};

struct Cells {
    std::int32_t w;
    std::int32_t h;
};

inline Cells bin_cells(const pkc_grid &grid) {
    Cells cells{};
    check(pkc_grid_bin(&grid, &cells.w, &cells.h));
    return cells;
}

// Cells that an item of w x h millimetres takes.
inline Cells item_cells(const pkc_grid &grid, double w, double h) {
    Cells cells{};
    check(pkc_grid_item(&grid, w, h, &cells.w, &cells.h));
    return cells;
}

struct Point {
    double x;
    double y;
};

// Millimetres from the inside top-left corner of the bin.
inline Point centre(const pkc_grid &grid, std::int32_t x, std::int32_t y, std::int32_t w,
                    std::int32_t h) {
    Point point{};
    check(pkc_grid_centre(&grid, x, y, w, h, &point.x, &point.y));
    return point;
}

// ---- Bin and queue ------------------------------------------------------------------------------

// What is packed where, in cells: w x h of them, each 1..128.
class Bin : public detail::Handle<pkc_bin, pkc_bin_free> {
public:
    using Handle::Handle;
    Bin(std::int32_t w, std::int32_t h) { check(pkc_bin_create(w, h, out())); }

    Bin clone() const { return detail::made<Bin>(pkc_bin_clone, get()); }

    void clear() { check(pkc_bin_clear(get())); }
    void block(std::int32_t x, std::int32_t y, std::int32_t w, std::int32_t h) {
        check(pkc_bin_block(get(), x, y, w, h));
    }
    void pack(const Item &item, std::int32_t x, std::int32_t y, std::int32_t rot = 0) {
        check(pkc_bin_pack(get(), &item, x, y, rot));
    }
    // Where the item was.
    Placement unpack(std::int32_t id) {
        Placement placement{};
        check(pkc_bin_unpack(get(), id, &placement));
        return placement;
    }

    BinInfo info() const { return detail::got<BinInfo>(pkc_bin_get_info, get()); }
    std::vector<Placement> items() const { return detail::filled<Placement>(pkc_bin_items, get()); }
    std::size_t items(Span<Placement> to) const { return detail::fill(to, pkc_bin_items, get()); }
    std::vector<std::int32_t> cells() const {
        return detail::filled<std::int32_t>(pkc_bin_cells, get());
    }
    std::size_t cells(Span<std::int32_t> to) const {
        return detail::fill(to, pkc_bin_cells, get());
    }
    std::vector<std::uint8_t> feasible(std::int32_t w, std::int32_t h) const {
        return detail::filled<std::uint8_t>(pkc_bin_feasible, get(), w, h);
    }
    std::size_t feasible(std::int32_t w, std::int32_t h, Span<std::uint8_t> to) const {
        return detail::fill(to, pkc_bin_feasible, get(), w, h);
    }
    std::int32_t contact(std::int32_t x, std::int32_t y, std::int32_t w, std::int32_t h) const {
        std::int32_t reward = 0;
        check(pkc_bin_contact(get(), x, y, w, h, &reward));
        return reward;
    }
};

// The conveyor with its regions, and one buffer an arm.
class Queue : public detail::Handle<pkc_queue, pkc_queue_free> {
public:
    using Handle::Handle;
    explicit Queue(const pkc_scenario &scenario) { check(pkc_queue_create(&scenario, out())); }
    explicit Queue(const std::string &scenario) : Queue(Scenario(scenario)) {}

    Queue clone() const { return detail::made<Queue>(pkc_queue_clone, get()); }

    void push(const Item &item) { check(pkc_queue_push(get(), &item)); }
    void remove(std::int32_t id) { check(pkc_queue_remove(get(), id)); }
    // All at once; all or nothing.
    void remove(Span<const std::int32_t> ids) {
        check(pkc_queue_remove_items(get(), ids.data(), ids.size()));
    }
    // A Span would take {0, 3} for NULL and three elements.
    void remove(std::initializer_list<std::int32_t> ids) {
        remove(Span<const std::int32_t>(ids.begin(), ids.size()));
    }
    void put_in_buffer(const Item &item, std::int32_t arm) {
        check(pkc_queue_put_in_buffer(get(), &item, arm));
    }
    void set_alpha_left(std::int32_t items) { check(pkc_queue_set_alpha_left(get(), items)); }

    Scenario scenario() const { return detail::got<Scenario>(pkc_queue_get_scenario, get()); }
    QueueInfo info() const { return detail::got<QueueInfo>(pkc_queue_get_info, get()); }
    std::vector<Queued> belt() const { return detail::filled<Queued>(pkc_queue_belt, get()); }
    std::size_t belt(Span<Queued> to) const { return detail::fill(to, pkc_queue_belt, get()); }
    std::vector<Queued> buffer() const { return detail::filled<Queued>(pkc_queue_buffer, get()); }
    std::size_t buffer(Span<Queued> to) const { return detail::fill(to, pkc_queue_buffer, get()); }
};

inline std::uint64_t plan_hash(Span<const Action> actions) {
    std::uint64_t hash = 0;
    check(pkc_plan_hash(actions.data(), actions.size(), &hash));
    return hash;
}

// Carries out one step's actions, all or nothing.
inline void apply(Bin &bin, Queue &queue, Span<const Action> actions) {
    check(pkc_step_apply(bin.get(), queue.get(), actions.data(), actions.size()));
}

inline std::vector<std::uint8_t> save_snapshot(const Bin &bin, const Queue &queue) {
    return detail::filled<std::uint8_t>(pkc_snapshot_save, bin.get(), queue.get());
}

inline std::pair<Bin, Queue> load_snapshot(Span<const std::uint8_t> bytes) {
    pkc_bin *bin = nullptr;
    pkc_queue *queue = nullptr;
    check(pkc_snapshot_load(detail::bytes(bytes), bytes.size(), &bin, &queue));
    return {Bin(bin), Queue(queue)};
}

// ---- Policy and training ------------------------------------------------------------------------

struct Measure {
    double mean;        // utilisation, 0..1
    double half_width;  // of its 95 % interval
};

// What actor and critic say: W*H + 1 logits and probabilities, and the value of the bin.
struct Evaluation {
    std::vector<float> logits;
    std::vector<float> probabilities;
    float value;
};

// Where an item goes. Immutable: threads may share it.
class Policy : public detail::Handle<pkc_policy, pkc_policy_free> {
public:
    using Handle::Handle;
    // One of builtins().
    explicit Policy(const std::string &name) {
        check(pkc_policy_create(detail::text(name), out()));
    }

    static std::vector<std::string> builtins() { return detail::listed(pkc_policy_builtin); }
    static Policy load(Span<const std::uint8_t> blob) {
        return detail::made<Policy>(pkc_policy_load, detail::bytes(blob), blob.size());
    }
    static Policy load_file(const std::string &path) {
        return detail::made<Policy>(pkc_policy_load_file, detail::text(path));
    }

    std::vector<std::uint8_t> save() const {
        return detail::filled<std::uint8_t>(pkc_policy_save, get());
    }
    void save_file(const std::string &path) const {
        check(pkc_policy_save_file(get(), detail::text(path)));
    }

    std::string name() const { return pkc_policy_name(detail::named(*this, "policy")); }
    PolicyInfo info() const { return detail::got<PolicyInfo>(pkc_policy_get_info, get()); }

    std::int32_t select(const Bin &bin, std::int32_t w, std::int32_t h) const {
        std::int32_t position = 0;
        check(pkc_policy_select(get(), bin.get(), w, h, &position));
        return position;
    }
    Evaluation evaluate(const Bin &bin, std::int32_t w, std::int32_t h) const {
        BinInfo info = bin.info();
        std::size_t positions = static_cast<std::size_t>(info.w * info.h + 1);
        Evaluation answer{std::vector<float>(positions), std::vector<float>(positions), 0};
        answer.value = evaluate(bin, w, h, answer.logits, answer.probabilities);
        return answer;
    }
    // The same into the caller's arrays, each of W*H + 1 or empty (not asked for); gives the value.
    float evaluate(const Bin &bin, std::int32_t w, std::int32_t h, Span<float> logits,
                   Span<float> probabilities) const {
        std::size_t capacity = std::size_t{PKC_MAX_SIDE} * PKC_MAX_SIDE + 1;  // always enough
        if (!logits.empty()) capacity = std::min(capacity, logits.size());
        if (!probabilities.empty()) capacity = std::min(capacity, probabilities.size());
        std::size_t count = 0;
        float value = 0;
        check(pkc_policy_evaluate(get(), bin.get(), w, h, logits.empty() ? nullptr : logits.data(),
                                  probabilities.empty() ? nullptr : probabilities.data(), capacity,
                                  &count, &value));
        return value;
    }
    // For bins[i] and an item of sizes[2*i] x sizes[2*i + 1]; an empty span is not asked for, one
    // that is too small is an Error.
    void evaluate_batch(Span<const pkc_bin *const> bins, Span<const std::int32_t> sizes,
                        Span<std::int32_t> positions, Span<float> probabilities = {},
                        Span<float> values = {}) const {
        const std::size_t count = bins.size();
        std::size_t cells = 0;
        if (!probabilities.empty() && count > 0) {
            BinInfo info;
            check(pkc_bin_get_info(bins[0], &info));
            cells = static_cast<std::size_t>(info.w * info.h + 1);
        }
        auto lacks = [](std::size_t size, std::size_t least) { return size > 0 && size < least; };
        if (sizes.size() != 2 * count)
            throw Error(PKC_E_ARGUMENT, std::to_string(sizes.size()) + " sizes for " +
                                            std::to_string(count) + " bins: must be two a bin");
        if (lacks(positions.size(), count) || lacks(probabilities.size(), count * cells) ||
            lacks(values.size(), count))
            throw Error(PKC_E_CAPACITY, "an output for " + std::to_string(count) +
                                            " bins is too small: must hold all of them");
        check(pkc_policy_evaluate_batch(get(), bins.data(), sizes.data(), count,
                                        positions.empty() ? nullptr : positions.data(),
                                        probabilities.empty() ? nullptr : probabilities.data(),
                                        values.empty() ? nullptr : values.data()));
    }

    Measure measure(const pkc_trainer_options &options, std::uint64_t seed,
                    std::uint64_t bins) const {
        Measure measure{};
        check(pkc_policy_measure(get(), &options, seed, bins, &measure.mean, &measure.half_width));
        return measure;
    }
};

// A training of a policy.
class Trainer : public detail::Handle<pkc_trainer, pkc_trainer_free> {
public:
    using Handle::Handle;
    explicit Trainer(const pkc_trainer_options &options = TrainerOptions()) {
        check(pkc_trainer_create(&options, out()));
    }

    static Trainer load_file(const std::string &path) {
        return detail::made<Trainer>(pkc_trainer_load_file, detail::text(path));
    }
    void save_file(const std::string &path) const {
        check(pkc_trainer_save_file(get(), detail::text(path)));
    }

    void run(std::uint64_t updates) { check(pkc_trainer_run(get(), updates)); }
    // From any thread.
    void cancel() { check(pkc_trainer_cancel(get())); }

    TrainerInfo info() const { return detail::got<TrainerInfo>(pkc_trainer_get_info, get()); }
    TrainerOptions options() const {
        return detail::got<TrainerOptions>(pkc_trainer_get_options, get());
    }
    Policy policy() const { return detail::made<Policy>(pkc_trainer_policy, get()); }
    Measure measure(std::int32_t rotation, std::uint64_t seed, std::uint64_t bins) {
        Measure measure{};
        check(pkc_trainer_measure(get(), rotation, seed, bins, &measure.mean, &measure.half_width));
        return measure;
    }
};

// The low level as a decision process, many bins side by side.
class Environment : public detail::Handle<pkc_environment, pkc_environment_free> {
public:
    using Handle::Handle;
    explicit Environment(const pkc_environment_options &options = EnvironmentOptions()) {
        check(pkc_environment_create(&options, out()));
    }

    Environment clone() const { return detail::made<Environment>(pkc_environment_clone, get()); }

    EnvironmentInfo info() const {
        return detail::got<EnvironmentInfo>(pkc_environment_get_info, get());
    }

    // Empty bins: the streams go on, begin anew from one seed, or from one for each bin.
    void reset() { check(pkc_environment_reset(get(), nullptr, 0)); }
    void reset(std::uint64_t seed) { check(pkc_environment_reset(get(), &seed, 1)); }
    void reset(Span<const std::uint64_t> seeds) {
        if (seeds.empty()) throw Error(PKC_E_ARGUMENT, "no seeds: must be one for each bin");
        check(pkc_environment_reset(get(), seeds.data(), seeds.size()));
    }

    // Outputs hold a value a bin; an empty span is not asked for, one that is too small is an
    // Error, and then nothing is placed.
    void step(Span<const std::int32_t> actions, Span<double> rewards,
              Span<std::int32_t> contacts = {}, Span<std::uint8_t> closed = {}) {
        const std::size_t count = actions.size();
        check(pkc_environment_step(get(), actions.data(), count, output(rewards, count),
                                   output(contacts, count), output(closed, count)));
    }
    // The next bin where one is closed.
    void open() { check(pkc_environment_open(get())); }

    // W*H cells, two sides, info().actions mask bytes and a number of taken cells a bin.
    void observe(Span<std::uint8_t> cells, Span<std::int32_t> sizes, Span<std::uint8_t> mask,
                 Span<std::int32_t> occupied = {}) const {
        observe_these(nullptr, static_cast<std::size_t>(info().count), cells, sizes, mask,
                      occupied);
    }
    // The same of some of the bins.
    void observe(Span<const std::int32_t> which, Span<std::uint8_t> cells, Span<std::int32_t> sizes,
                 Span<std::uint8_t> mask, Span<std::int32_t> occupied) const {
        if (!which.empty()) observe_these(which.data(), which.size(), cells, sizes, mask, occupied);
    }

private:
    template <class T>
    static T *output(Span<T> to, std::size_t least) {
        if (to.empty()) return nullptr;
        if (to.size() < least)
            throw Error(PKC_E_CAPACITY, "an output for " + std::to_string(to.size()) +
                                            " values: must hold " + std::to_string(least));
        return to.data();
    }

    void observe_these(const std::int32_t *which, std::size_t count, Span<std::uint8_t> cells,
                       Span<std::int32_t> sizes, Span<std::uint8_t> mask,
                       Span<std::int32_t> occupied) const {
        const EnvironmentInfo about = info();
        const auto of_bin = [count](std::int32_t values) {
            return count * static_cast<std::size_t>(values);
        };
        check(pkc_environment_observe(get(), which, count,
                                      output(cells, of_bin(about.bin_w * about.bin_h)),
                                      output(sizes, of_bin(2)), output(mask, of_bin(about.actions)),
                                      output(occupied, count)));
    }
};

// ---- Planner, exact packer, bound ---------------------------------------------------------------

struct Plan {
    PlanInfo info;
    std::vector<Action> actions;
};

// Plans steps (Algorithm 1). All memory is taken when it is made.
class Planner : public detail::Handle<pkc_planner, pkc_planner_free> {
public:
    using Handle::Handle;
    // With the default policy.
    explicit Planner(const pkc_planner_options &options = PlannerOptions()) {
        check(pkc_planner_create(&options, nullptr, out()));
    }
    Planner(const pkc_planner_options &options, const Policy &policy) {
        check(pkc_planner_create(&options, detail::named(policy, "policy"), out()));
    }

    // Plans the next step; actions() or result() give it.
    PlanInfo plan(const Bin &bin, const Queue &queue, const pkc_budget &budget = Budget()) {
        PlanInfo info;
        check(pkc_planner_plan(get(), bin.get(), queue.get(), &budget, &info));
        return info;
    }
    void begin(const Bin &bin, const Queue &queue, const pkc_budget &budget = Budget()) {
        check(pkc_planner_begin(get(), bin.get(), queue.get(), &budget));
    }
    // True when nothing is left to do.
    bool step(std::uint64_t nodes) {
        std::int32_t done = 0;
        check(pkc_planner_step(get(), nodes, &done));
        return done != 0;
    }
    // From any thread.
    void cancel() { check(pkc_planner_cancel(get())); }

    Plan result() {
        Plan plan;
        plan.actions = detail::filled<Action>(pkc_planner_result, get(), &plan.info);
        return plan;
    }
    std::vector<Action> actions() { return result().actions; }
    std::size_t actions(Span<Action> to) {
        PlanInfo info;
        return detail::fill(to, pkc_planner_result, get(), &info);
    }
};

struct Packing {
    std::int32_t answer;                // PKC_PACKING_*
    std::uint64_t nodes;                // placements tried
    std::vector<Placement> placements;  // in the items' order if FOUND, else empty
};

// Can all items be placed on the bin's free cells?
inline Packing exact_pack(const Bin &bin, Span<const Item> items, bool rotation = true,
                          const pkc_budget &budget = Budget()) {
    Packing packing{0, 0, std::vector<Placement>(items.size())};
    check(pkc_exact_pack(bin.get(), items.data(), items.size(), rotation ? 1 : 0, &budget,
                         packing.placements.data(), &packing.answer, &packing.nodes));
    if (packing.answer != PKC_PACKING_FOUND) packing.placements.clear();
    return packing;
}

struct Bound {
    std::size_t count;
    std::int32_t answer;  // PKC_PACKING_*; an upper bound only with BUDGET
};

// How many of the next items, in order and without one left out, fit together.
inline Bound bound_in_order(const Bin &bin, Span<const Item> items, bool rotation = true,
                            const pkc_budget &budget = Budget()) {
    Bound bound{};
    check(pkc_bound_in_order(bin.get(), items.data(), items.size(), rotation ? 1 : 0, &budget,
                             &bound.count, &bound.answer));
    return bound;
}

// ---- Cell, schedule, simulation -----------------------------------------------------------------

using Pose = std::array<double, 4>;                 // x, y, z of the tip, yaw
using Joints = std::array<double, PKC_MAX_JOINTS>;  // radians; metres for the third of a SCARA

// Arms, bin, belt and buffers: metres, radians, seconds. Immutable: threads may share it.
class Cell : public detail::Handle<pkc_cell, pkc_cell_free> {
public:
    using Handle::Handle;
    // One of presets().
    explicit Cell(const std::string &preset) {
        check(pkc_cell_create(detail::text(preset), out()));
    }

    static std::vector<std::string> presets() { return detail::listed(pkc_cell_preset); }
    static Cell load(const std::string &json) {
        return detail::made<Cell>(pkc_cell_load, json.data(), json.size());
    }
    static Cell load_file(const std::string &path) {
        return detail::made<Cell>(pkc_cell_load_file, detail::text(path));
    }
    std::string save() const {
        std::vector<char> json = detail::filled<char>(pkc_cell_save, get());
        return {json.begin(), json.end()};
    }
    void save_file(const std::string &path) const {
        check(pkc_cell_save_file(get(), detail::text(path)));
    }

    CellInfo info() const { return detail::got<CellInfo>(pkc_cell_get_info, get()); }
    // Throws with the zone and the distance if the arms do not reach what the scenario says.
    void check_reach(const pkc_scenario &scenario) const {
        check(pkc_cell_check(get(), &scenario));
    }
    Joints inverse(std::int32_t arm, const Pose &pose) const {
        Joints joints{};
        check(pkc_cell_inverse(get(), arm, pose.data(), joints.data()));
        return joints;
    }
    Pose forward(std::int32_t arm, const Joints &joints) const {
        Pose pose{};
        check(pkc_cell_forward(get(), arm, joints.data(), pose.data()));
        return pose;
    }
    // `info` may be NULL.
    Cell optimize_layout(const pkc_scenario &scenario,
                         const pkc_layout_options &options = LayoutOptions(),
                         LayoutInfo *info = nullptr) const {
        return detail::made<Cell>(pkc_cell_optimize_layout, get(), &scenario, &options, info);
    }
};

// Names the arms of a step's packs from the belt anew, in place.
inline void allocate(const Cell &cell, const Queue &queue, Span<Action> actions) {
    check(pkc_allocate(cell.get(), queue.get(), actions.data(), actions.size()));
}

// What the arms, the belt and the planner do and when, in seconds.
class Schedule : public detail::Handle<pkc_schedule, pkc_schedule_free> {
public:
    using Handle::Handle;
    // `mode` is PKC_MODE_*.
    Schedule(const Cell &cell, const pkc_scenario &scenario, std::int32_t mode) {
        check(pkc_schedule_create(cell.get(), &scenario, mode, out()));
    }

    // Bin and queue are those before the step.
    void add_step(const Bin &bin, const Queue &queue, Span<const Action> actions) {
        check(pkc_schedule_add_step(get(), bin.get(), queue.get(), actions.data(), actions.size()));
    }
    void put_aside(std::int32_t item, double time) {
        check(pkc_schedule_put_aside(get(), item, time));
    }

    ScheduleInfo info() const { return detail::got<ScheduleInfo>(pkc_schedule_get_info, get()); }
    ArmSample sample(std::int32_t arm, double time) const {
        ArmSample sample{};
        check(pkc_schedule_sample(get(), arm, time, &sample));
        return sample;
    }
};

// A run of a schedule in a fresh Box2D world.
class Simulation : public detail::Handle<pkc_simulation, pkc_simulation_free> {
public:
    using Handle::Handle;
    // Runs what the schedule has so far, to its end.
    explicit Simulation(const Schedule &schedule,
                        const pkc_simulation_options &options = SimulationOptions()) {
        check(pkc_simulate(schedule.get(), &options, out()));
    }

    SimulationInfo info() const {
        return detail::got<SimulationInfo>(pkc_simulation_get_info, get());
    }
    std::vector<Place> places() const {
        return detail::filled<Place>(pkc_simulation_places, get());
    }
    std::size_t places(Span<Place> to) const {
        return detail::fill(to, pkc_simulation_places, get());
    }
};

// `kind` is PKC_TRACE_*; `period`, in seconds, is of the CSV files.
inline void write_trace(const Schedule &schedule, std::int32_t kind, const std::string &path,
                        double period = 0.01) {
    check(pkc_trace_write_file(schedule.get(), nullptr, kind, period, detail::text(path)));
}

// With the poses of a run.
inline void write_trace(const Schedule &schedule, const Simulation &simulation, std::int32_t kind,
                        const std::string &path, double period = 0.01) {
    check(pkc_trace_write_file(schedule.get(), detail::named(simulation, "simulation"), kind,
                               period, detail::text(path)));
}

// ---- Generators ---------------------------------------------------------------------------------

// Items: equal options give equal ones on every machine.
class Generator : public detail::Handle<pkc_generator, pkc_generator_free> {
public:
    using Handle::Handle;
    explicit Generator(const pkc_generator_options &options = GeneratorOptions()) {
        check(pkc_generator_create(&options, out()));
    }

    // RANDOM: fills all of `to`. FULL: the next set; its size.
    std::size_t next(Span<Item> to) { return detail::fill(to, pkc_generator_next, get()); }
    // RANDOM: so many items. FULL: the next set, of at most so many.
    std::vector<Item> next(std::size_t most) {
        std::vector<Item> items(most);
        items.resize(next(Span<Item>(items)));
        return items;
    }
};

// Sets mean and sigma: "text" or "table".
inline void preset(pkc_generator_options &options, const std::string &name) {
    check(pkc_generator_preset(&options, detail::text(name)));
}

}  // namespace v0
}  // namespace packcell

#endif
