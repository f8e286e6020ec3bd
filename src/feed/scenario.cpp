#include "feed/scenario.h"

#include <algorithm>
#include <cstdio>

#include "base/status.h"

namespace packcell {

namespace {

// Reads `letter` and a number of one to three digits at `*at`; false if that is not what is there.
bool read_part(const char **at, char letter, int *value) {
    const char *p = *at;
    if (*p++ != letter) return false;
    int digits = 0;
    int v = 0;
    while (*p >= '0' && *p <= '9' && digits < 3) {
        v = v * 10 + (*p++ - '0');
        ++digits;
    }
    if (digits == 0) return false;
    *value = v;
    *at = p;
    return true;
}

}  // namespace

void check_scenario(const Scenario &s) {
    if (s.robots != 1 && s.robots != 2)
        fail(Status::kArgument, "robots %d: must be 1 or 2", s.robots);
    if (s.recognized < 1 || s.recognized > kMaxRecognized) {
        fail(Status::kArgument, "recognized %d: must be 1..%d", s.recognized, kMaxRecognized);
    }
    if (s.accessible < 1 || s.accessible > s.recognized) {
        fail(Status::kArgument, "accessible %d: must be 1..recognized (%d)", s.accessible,
             s.recognized);
    }
    if (s.robots == 1 && s.overlap != 0) {
        fail(Status::kArgument, "overlap %d: must be 0 with one robot", s.overlap);
    }
    if (s.overlap < 0 || s.overlap > s.accessible) {
        fail(Status::kArgument, "overlap %d: must be 0..accessible (%d)", s.overlap, s.accessible);
    }
    if (s.n_max() > s.recognized) {
        fail(Status::kArgument,
             "n_max %d (accessible * robots - overlap): must be at most recognized (%d)", s.n_max(),
             s.recognized);
    }
}

Scenario parse_scenario(const char *name) {
    Scenario s;
    const char *at = name;
    bool ok = (*at == 'S' || *at == 'D');
    if (ok) {
        s.robots = *at++ == 'S' ? 1 : 2;
        ok = *at == '-';
    }
    if (ok) ++at;
    ok = ok && read_part(&at, 'R', &s.recognized) && read_part(&at, 'A', &s.accessible);
    if (ok && s.robots == 2) ok = read_part(&at, 'O', &s.overlap);
    if (!ok || *at != '\0') {
        fail(Status::kArgument, "scenario '%.40s': must be like S-R5A3 or D-R5A3O1", name);
    }
    check_scenario(s);
    return s;
}

void name_scenario(const Scenario &s, char *text, size_t size) {
    if (s.robots == 1) {
        std::snprintf(text, size, "S-R%dA%d", s.recognized, s.accessible);
    } else {
        std::snprintf(text, size, "D-R%dA%dO%d", s.recognized, s.accessible, s.overlap);
    }
}

Regions arrange(const Scenario &s, int total, int alpha_left) {
    if (s.robots == 1) return {0, std::min(total, s.accessible), 0};
    if (s.accessible == s.overlap) return {0, std::min(total, s.overlap), 0};
    const int only = s.accessible - s.overlap;
    if (total >= s.n_max()) return {only, s.overlap, only};
    // The paper's three formulas; the bounds keep them meaningful where it is silent (few items).
    const int shared = std::max(0, std::min(total - alpha_left, s.overlap));
    const int alpha = std::min(std::max(alpha_left, total / 2 + 1 - shared), total - shared);
    return {alpha, shared, total - alpha - shared};
}

int reach(const Scenario &s, const Regions &r, int place) {
    if (place < 0 || place >= r.accessible()) return 0;
    if (s.robots == 1) return 1;
    if (place < r.alpha) return 1;
    return place < r.alpha + r.shared ? 3 : 2;
}

}  // namespace packcell
