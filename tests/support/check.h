/* What the tests share: short ways to make items, bins and queues, to compare states, and to check
 * that a call fails as packcell.h promises. Include it after cmocka.h. */
#ifndef PACKCELL_TESTS_CHECK_H
#define PACKCELL_TESTS_CHECK_H

#include <stddef.h>
#include <stdint.h>

#include "packcell.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Whether PACKCELL_CHECK_ALL=1 asks for the large counts. */
int check_all(void);

/* `few` by default, `many` with PACKCELL_CHECK_ALL=1. */
int check_count(int few, int many);

/* Whether memory is being watched by valgrind or a sanitizer, which brings its own allocator and
 * makes everything slow. */
int check_watched(void);

/* Random numbers of the tests' own: SplitMix64. */
uint64_t check_random(uint64_t *state);
int32_t check_draw(uint64_t *state, int32_t least, int32_t most);

double check_milliseconds(void); /* wall clock */

/* A flag between two threads: C99 has no atomics of its own. */
int check_is_raised(const int *flag);
void check_raise(int *flag);

#define CHECK_OK(call) check_ok((call), #call, __FILE__, __LINE__)

/* The call fails with this status, and pkc_last_error() holds the text, if one is given. */
#define CHECK_FAILS(wanted, text, call) \
    check_fails((wanted), (text), (call), #call, __FILE__, __LINE__)

void check_ok(pkc_status status, const char *call, const char *file, int line);
void check_fails(pkc_status wanted, const char *text, pkc_status status, const char *call,
                 const char *file, int line);

pkc_item check_item(int32_t id, int32_t w, int32_t h, uint32_t flags);
pkc_bin *check_bin(int32_t w, int32_t h);
pkc_queue *check_queue(const char *scenario);
void check_push(pkc_queue *queue, int32_t id, int32_t w, int32_t h);
void check_pack(pkc_bin *bin, int32_t id, int32_t w, int32_t h, int32_t x, int32_t y);
pkc_planner_options check_options(void);
pkc_budget check_budget(uint64_t nodes);
pkc_plan_info check_plan_info(void);

/* Everything that bin and queue hold. To be freed by free(). */
uint8_t *check_snapshot(const pkc_bin *bin, const pkc_queue *queue, size_t *size);

/* Remembers a state, and later asserts that it is still the same, byte by byte. */
typedef struct check_state {
    uint8_t *bytes;
    size_t size;
} check_state;
check_state check_remember(const pkc_bin *bin, const pkc_queue *queue);
void check_unchanged(check_state *state, const pkc_bin *bin, const pkc_queue *queue);

#ifdef __cplusplus
}
#endif

#endif
