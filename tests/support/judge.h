/* An independent judge of schedules: it takes nothing from the library but what its public header
 * gives, and computes everything else by itself: limits and links typed in again, its own forward
 * kinematics, footprints and bookkeeping of bin, buffers and grippers. It looks at every
 * millisecond. */
#ifndef PACKCELL_TESTS_JUDGE_H
#define PACKCELL_TESTS_JUDGE_H

#include <stddef.h>
#include <stdint.h>

#include "packcell.h"

#ifdef __cplusplus
extern "C" {
#endif

#define JUDGE_MAX_STEPS 128
#define JUDGE_MAX_SLOTS 16

/* What a schedule may be at fault in. */
enum judge_fault {
    JUDGE_LIMITS,      /* a joint beyond its position, velocity or acceleration */
    JUDGE_DERIVATIVES, /* velocities and accelerations that are not those of the positions */
    JUDGE_TOOL,        /* a tool that is not where the joints put it, or not straight down */
    JUDGE_CLEARANCE,   /* arms nearer to each other than the margin */
    JUDGE_PAUSE,       /* a wait or a dwell in motion */
    JUDGE_LANES,       /* times that do not add up */
    JUDGE_BOOKING,     /* an item, a gripper or a place in two uses; not the work of the steps */
    JUDGE_FAULTS
};
const char *judge_fault_name(int fault);

/* The figures of a cell that the judge needs, from the text of its description. */
typedef struct judge_cell {
    int arms;
    char model[2][16];
    double base[2][4]; /* x, y, z, yaw */
    double buffer[2][JUDGE_MAX_SLOTS][2];
    int slots[2];
    double belt[2], belt_yaw, pitch;
    double bin[2], bin_w, bin_h, bin_margin, side, gap; /* metres */
    int w, h;                                           /* cells */
    double margin, work_height;
} judge_cell;
void judge_read_cell(judge_cell *cell, const pkc_cell *from);

/* The steps of an episode, with the bin before each. */
typedef struct judge_step {
    pkc_action *actions;
    size_t count;
} judge_step;
typedef struct judge_episode {
    pkc_item *items;
    size_t item_count;
    judge_step steps[JUDGE_MAX_STEPS];
    int step_count;
    int32_t *cells; /* the bin at the end, as pkc_bin_cells gives it */
} judge_episode;

/* As pkc_schedule_sample; a test gives another one to see what the judge says of it. */
typedef pkc_status judge_sampler(const pkc_schedule *schedule, int32_t arm, double time,
                                 pkc_arm_sample *out_sample);

typedef struct judge_report {
    long faults[JUDGE_FAULTS];
    char first[JUDGE_FAULTS][240]; /* the first one of each kind */
    double least_clearance;        /* metres; 1e9 with one arm */
    double least_between_links; /* the same between the links as they are, not their footprints */
    double outside; /* metres by which a joint's centre is farther from the arm's line, seen from
                       above, than the links are thick */
    long samples;
} judge_report;

/* `robots` arms carry out the episode, from an empty bin. */
void judge_schedule(const judge_cell *cell, int robots, const judge_episode *episode,
                    const pkc_schedule *schedule, judge_sampler *sampler, judge_report *report);

#ifdef __cplusplus
}
#endif

#endif
