#include "capi/guard.h"

#include <cmath>
#include <cstdio>
#include <new>

namespace packcell {

namespace {

thread_local char last_error[Error::kTextSize] = "";

pkc_status remember(Status status, const char *text) noexcept {
    std::snprintf(last_error, sizeof last_error, "%s", text);
    return static_cast<pkc_status>(status);
}

}  // namespace

pkc_status report_exception() noexcept {
    try {
        throw;
    } catch (const Error &e) {
        return remember(e.status(), e.what());
    } catch (const std::bad_alloc &) {
        return remember(Status::kMemory, "memory could not be had");
    } catch (const std::exception &e) {
        return remember(Status::kInternal, e.what());
    } catch (...) {
        return remember(Status::kInternal, "an unknown exception");
    }
}

void require_range(const char *name, int64_t value, int64_t least, int64_t most) {
    if (value >= least && value <= most) return;
    fail(Status::kArgument, "%s %lld: must be %lld..%lld", name, static_cast<long long>(value),
         static_cast<long long>(least), static_cast<long long>(most));
}

void require_finite(const char *name, double value, double least, double most) {
    if (std::isfinite(value) && value >= least && value <= most) return;
    fail(Status::kArgument, "%s %g: must be finite and %g..%g", name, value, least, most);
}

void require_flag(const char *name, int32_t value) { require_range(name, value, 0, 1); }

void require_capacity(size_t count, size_t capacity, size_t *out_count) {
    require(out_count, "out_count");
    if (count > capacity) {
        *out_count = count;
        fail(Status::kCapacity, "capacity %zu: %zu elements are needed", capacity, count);
    }
}

void require_struct_size(const char *name, size_t size, size_t least) {
    if (size >= least && size <= kLargestStruct) return;
    fail(Status::kStruct, "%s.struct_size %zu: must be %zu..%zu (was the struct initialised?)",
         name, size, least, kLargestStruct);
}

void require_zero_tail(const char *name, const void *tail, size_t size) {
    const auto *bytes = static_cast<const unsigned char *>(tail);
    for (size_t i = 0; i < size; ++i) {
        if (bytes[i] != 0)
            fail(Status::kStruct, "%s has a field set that this library does not know", name);
    }
}

}  // namespace packcell

extern "C" {

const char *pkc_last_error(void) { return packcell::last_error; }

uint32_t pkc_version(void) {
    return PKC_VERSION_MAJOR * 10000u + PKC_VERSION_MINOR * 100u + PKC_VERSION_PATCH;
}

const char *pkc_status_name(pkc_status status) {
    switch (status) {
        case PKC_OK:
            return "PKC_OK";
        case PKC_E_ARGUMENT:
            return "PKC_E_ARGUMENT";
        case PKC_E_STRUCT:
            return "PKC_E_STRUCT";
        case PKC_E_MEMORY:
            return "PKC_E_MEMORY";
        case PKC_E_BUSY:
            return "PKC_E_BUSY";
        case PKC_E_STATE:
            return "PKC_E_STATE";
        case PKC_E_CAPACITY:
            return "PKC_E_CAPACITY";
        case PKC_E_LIMIT:
            return "PKC_E_LIMIT";
        case PKC_E_FORMAT:
            return "PKC_E_FORMAT";
        case PKC_E_IO:
            return "PKC_E_IO";
        case PKC_E_UNSUPPORTED:
            return "PKC_E_UNSUPPORTED";
        case PKC_E_INTERNAL:
            return "PKC_E_INTERNAL";
        default:
            return "unknown status";
    }
}

}  // extern "C"
