// The one guard that every C entry runs in, and what all of them need: this thread's last error,
// checked pointers, structs of several sizes, handles that belong to one thread at a time.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "base/status.h"
#include "packcell.h"

namespace packcell {

// Remembers what is being handled in a catch block and gives its code.
pkc_status report_exception() noexcept;

// Runs the body of an entry; whatever it throws becomes a status.
template <class Body>
pkc_status guard(Body &&body) noexcept {
    try {
        body();
        return PKC_OK;
    } catch (...) {
        return report_exception();
    }
}

template <class T>
void require(const T *pointer, const char *name) {
    if (pointer == nullptr) fail(Status::kArgument, "%s is NULL", name);
}

void require_range(const char *name, int64_t value, int64_t least, int64_t most);
void require_finite(const char *name, double value, double least, double most);
void require_flag(const char *name, int32_t value);

// Stores the number of elements there are; with too small an array throws kCapacity, and then the
// number is all that is stored.
void require_capacity(size_t count, size_t capacity, size_t *out_count);

// ---- Structs that begin with struct_size -------------------------------------------------------

// Size of the struct's first published layout: what a caller must at least bring.
template <class T>
struct FirstLayout;

constexpr size_t kLargestStruct = 4096;

void require_struct_size(const char *name, size_t size, size_t least);
void require_zero_tail(const char *name, const void *tail, size_t size);

// The caller's struct over `defaults`, whatever size of it the caller knows.
template <class T>
T read_struct(const char *name, const T *from, const T &defaults) {
    require(from, name);
    const size_t size = from->struct_size;
    require_struct_size(name, size, FirstLayout<T>::size);
    T value = defaults;
    std::memcpy(&value, from, size < sizeof(T) ? size : sizeof(T));
    if (size > sizeof(T))
        require_zero_tail(name, reinterpret_cast<const char *>(from) + sizeof(T), size - sizeof(T));
    value.struct_size = static_cast<uint32_t>(sizeof(T));
    return value;
}

// Whether write_struct() would succeed: asked before work whose result must not be lost.
template <class T>
void require_writable(const char *name, const T *to) {
    require(to, name);
    require_struct_size(name, to->struct_size, FirstLayout<T>::size);
}

template <class T>
void write_struct(const char *name, T *to, T value) {
    require_writable(name, to);
    const uint32_t size = to->struct_size;
    value.struct_size = size;
    std::memcpy(to, &value, size < sizeof(T) ? size : sizeof(T));
}

// The body of an _init function.
template <class T>
void init_struct(const char *name, T *to, size_t size, T defaults) {
    require(to, name);
    require_struct_size(name, size, FirstLayout<T>::size);
    std::memset(static_cast<void *>(to), 0, size);
    defaults.struct_size = static_cast<uint32_t>(size);
    std::memcpy(to, &defaults, size < sizeof(T) ? size : sizeof(T));
}

// ---- Handles -----------------------------------------------------------------------------------

// Holds a handle for the length of one call.
template <class Handle>
class Use {
public:
    Use(const char *name, Handle *handle) : handle_(handle) {
        require(handle, name);
        if (handle->busy.exchange(true, std::memory_order_acquire)) {
            fail(Status::kBusy, "%s is in use by another thread", name);
        }
    }
    Use(const Use &) = delete;
    Use &operator=(const Use &) = delete;
    ~Use() { handle_->busy.store(false, std::memory_order_release); }

    Handle *operator->() const { return handle_; }

private:
    Handle *handle_;
};

}  // namespace packcell
