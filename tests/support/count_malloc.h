/* Counts the program's allocations, those of shared libraries too, and makes chosen ones fail. It
 * defines malloc and its kin, so exactly one file of a program includes it. Does nothing where a
 * sanitizer has an allocator of its own. The file needs _GNU_SOURCE, for RTLD_NEXT. */
#ifndef PACKCELL_TESTS_COUNT_MALLOC_H
#define PACKCELL_TESTS_COUNT_MALLOC_H

#include <errno.h>
#include <stddef.h>
#include <stdint.h>

/* Allocations since the program began, and how many of them were not freed yet. */
static volatile uint64_t count_malloc_calls;
static volatile int64_t count_malloc_live;

/* The n-th allocation from now on fails; with count_malloc_fail_all every later one too. 0: none.
 */
static volatile uint64_t count_malloc_fail_at;
static volatile int count_malloc_fail_all;

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)

#include <dlfcn.h>
#include <string.h>

/* dlsym may allocate while the real allocator is being looked up; that much comes from here. */
typedef union count_malloc_align {
    long double number;
    void *pointer;
} count_malloc_align;
static union {
    count_malloc_align align;
    unsigned char bytes[4096];
} count_malloc_early;
static size_t count_malloc_early_used;
static int count_malloc_looking;

static void *count_malloc_take_early(size_t size) {
    void *at = count_malloc_early.bytes + count_malloc_early_used;
    size = (size + sizeof(count_malloc_align) - 1) / sizeof(count_malloc_align) *
           sizeof(count_malloc_align);
    if (size > sizeof count_malloc_early.bytes - count_malloc_early_used) return NULL;
    count_malloc_early_used += size;
    return at;
}

static int count_malloc_is_early(const void *p) {
    const uintptr_t at = (uintptr_t)p;
    const uintptr_t first = (uintptr_t)count_malloc_early.bytes;
    return at >= first && at < first + sizeof count_malloc_early.bytes;
}

typedef void *count_malloc_fn(size_t);
typedef void *count_calloc_fn(size_t, size_t);
typedef void *count_realloc_fn(void *, size_t);
typedef void *count_aligned_fn(size_t, size_t);
typedef void count_free_fn(void *);

/* POSIX lets dlsym's result be a function; C99 has no cast for it. */
static void count_malloc_look(void *function, const char *name) {
    void *symbol;
    count_malloc_looking = 1;
    symbol = dlsym(RTLD_NEXT, name);
    count_malloc_looking = 0;
    memcpy(function, &symbol, sizeof symbol);
}

/* Counts one allocation; false when it has to fail. */
static int count_malloc_allow(void) {
    ++count_malloc_calls;
    if (count_malloc_fail_at == 0) return 1;
    if (count_malloc_fail_at > 1) {
        --count_malloc_fail_at;
        return 1;
    }
    if (!count_malloc_fail_all) count_malloc_fail_at = 0;
    errno = ENOMEM;
    return 0;
}

static void *count_malloc_got(void *p) {
    if (p != NULL) ++count_malloc_live;
    return p;
}

void *malloc(size_t size) {
    static count_malloc_fn *real;
    if (real == NULL) {
        if (count_malloc_looking) return count_malloc_take_early(size);
        count_malloc_look(&real, "malloc");
    }
    return count_malloc_allow() ? count_malloc_got(real(size)) : NULL;
}

void *calloc(size_t count, size_t size) {
    static count_calloc_fn *real;
    if (real == NULL) {
        if (count_malloc_looking) return count_malloc_take_early(count * size);
        count_malloc_look(&real, "calloc");
    }
    return count_malloc_allow() ? count_malloc_got(real(count, size)) : NULL;
}

void *realloc(void *p, size_t size) {
    static count_realloc_fn *real;
    void *q;
    if (real == NULL) count_malloc_look(&real, "realloc");
    if (!count_malloc_allow()) return NULL;
    q = real(p, size);
    if (p == NULL && q != NULL) ++count_malloc_live;
    return q;
}

void *aligned_alloc(size_t align, size_t size) {
    static count_aligned_fn *real;
    if (real == NULL) count_malloc_look(&real, "aligned_alloc");
    return count_malloc_allow() ? count_malloc_got(real(align, size)) : NULL;
}

int posix_memalign(void **out, size_t align, size_t size) {
    void *p = aligned_alloc(align, size);
    if (p == NULL) return ENOMEM;
    *out = p;
    return 0;
}

void free(void *p) {
    static count_free_fn *real;
    if (p == NULL || count_malloc_is_early(p)) return;
    if (real == NULL) count_malloc_look(&real, "free");
    --count_malloc_live;
    real(p);
}

#endif

#endif
