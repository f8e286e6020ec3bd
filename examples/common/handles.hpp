// Owners of the library's handles, and its statuses as exceptions.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "common/errors.hpp"
#include "packcell.h"

namespace packcell_programs {

// A call into the library that failed; what() is the library's own line.
class LibraryError : public Failure {
public:
    LibraryError(pkc_status status, const std::string &message)
        : Failure(message), status_(status) {}
    pkc_status status() const { return status_; }

private:
    pkc_status status_;
};

inline void check(pkc_status status) {
    if (status == PKC_OK) return;
    const std::string said = pkc_last_error();
    throw LibraryError(status, said.empty() ? pkc_status_name(status) : said);
}

template <typename T, void (*Free)(T *)>
struct HandleFree {
    void operator()(T *handle) const noexcept { Free(handle); }
};

template <typename T, void (*Free)(T *)>
using Handle = std::unique_ptr<T, HandleFree<T, Free>>;

using BinHandle = Handle<pkc_bin, pkc_bin_free>;
using QueueHandle = Handle<pkc_queue, pkc_queue_free>;
using PolicyHandle = Handle<pkc_policy, pkc_policy_free>;
using PlannerHandle = Handle<pkc_planner, pkc_planner_free>;
using GeneratorHandle = Handle<pkc_generator, pkc_generator_free>;

// A struct of the library filled by its `_init` function.
template <typename T>
T initialised(pkc_status (*init)(T *, size_t)) {
    T value;
    check(init(&value, sizeof value));
    return value;
}

// The whole of an array that the library fills: fill(array, capacity, count), asked for the number
// first. Array is a vector or a string.
template <typename Array, typename Fill>
Array all_of(Fill fill) {
    size_t count = 0;
    const pkc_status asked = fill(nullptr, 0, &count);
    if (asked != PKC_E_CAPACITY) check(asked);
    Array values(count, typename Array::value_type{});
    if (count > 0) check(fill(values.data(), count, &count));
    return values;
}

// "D-R5A3O1". Throws LibraryError for a scenario that cannot be.
inline std::string name_of(const pkc_scenario &scenario) {
    char name[32] = "";
    check(pkc_scenario_name(&scenario, name, sizeof name));
    return name;
}

inline pkc_queue_info queue_info(const pkc_queue *queue) {
    auto info = initialised(pkc_queue_info_init);
    check(pkc_queue_get_info(queue, &info));
    return info;
}

inline std::vector<pkc_placement> items_of(const pkc_bin *bin) {
    return all_of<std::vector<pkc_placement>>(
        [bin](pkc_placement *out, size_t capacity, size_t *count) {
            return pkc_bin_items(bin, out, capacity, count);
        });
}

inline BinHandle make_bin(int32_t w, int32_t h) {
    pkc_bin *bin = nullptr;
    check(pkc_bin_create(w, h, &bin));
    return BinHandle(bin);
}

inline QueueHandle make_queue(const pkc_scenario &scenario) {
    pkc_queue *queue = nullptr;
    check(pkc_queue_create(&scenario, &queue));
    return QueueHandle(queue);
}

inline PolicyHandle make_policy(const std::string &name) {
    pkc_policy *policy = nullptr;
    check(pkc_policy_create(name.c_str(), &policy));
    return PolicyHandle(policy);
}

inline PlannerHandle make_planner(const pkc_planner_options &options, const pkc_policy *policy) {
    pkc_planner *planner = nullptr;
    check(pkc_planner_create(&options, policy, &planner));
    return PlannerHandle(planner);
}

inline GeneratorHandle make_generator(const pkc_generator_options &options) {
    pkc_generator *generator = nullptr;
    check(pkc_generator_create(&options, &generator));
    return GeneratorHandle(generator);
}

}  // namespace packcell_programs
