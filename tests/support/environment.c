/* What the tests ask of their surroundings; apart from check.c because it needs no library. */
#define _POSIX_C_SOURCE 200809L
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "check.h"

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define SANITIZED 1
#else
#define SANITIZED 0
#endif

int check_all(void) {
    const char *value = getenv("PACKCELL_CHECK_ALL");
    return value != NULL && strcmp(value, "1") == 0;
}

int check_count(int few, int many) { return check_all() ? many : few; }

int check_watched(void) {
    const char *preload = getenv("LD_PRELOAD");
    return SANITIZED || (preload != NULL && strstr(preload, "vgpreload") != NULL);
}

uint64_t check_random(uint64_t *state) {
    uint64_t v = *state += 0x9e3779b97f4a7c15u;
    v = (v ^ (v >> 30)) * 0xbf58476d1ce4e5b9u;
    v = (v ^ (v >> 27)) * 0x94d049bb133111ebu;
    return v ^ (v >> 31);
}

int32_t check_draw(uint64_t *state, int32_t least, int32_t most) {
    return least + (int32_t)(check_random(state) % (uint64_t)(most - least + 1));
}

double check_milliseconds(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec * 1e3 + (double)t.tv_nsec * 1e-6;
}
