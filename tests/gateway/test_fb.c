/* The PLC's function blocks against a small gateway that is an array of registers: the handshake,
 * what restarts, lost links and torn images do to it, and the pages of a plan. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "gateway/plc/packcell_fb.h"

enum { kStatus = 200, kResult = 300, kLink = 96, kRegisters = 500, kMostPlan = 20, kScanMs = 10 };
enum { kConflict = 1, kSeqGap = 2, kWrongState = 5 };

/* A gateway as the contract has it, of two arms and without a planner. */
typedef struct fake_gateway {
    uint16_t registers[kRegisters];
    uint16_t last[2][48]; /* the accepted blocks */
    int executed[2];      /* commands accepted */
    int refuse;           /* reject code for the next commands, 0: accept them */
    bool dead;            /* its heartbeat stands still */
    bool hold_done;       /* work does not end */
    bool torn;            /* results show another tail */
    uint16_t result;      /* of a PLAN_NEXT */
    packcell_action plan[kMostPlan];
    uint16_t plan_count;
    bool late;        /* it takes commands after the next reading, not while they are written */
    int controls[32]; /* PackML commands taken */
    int control_count;
} fake_gateway;

/* The gateway, the blocks, and the Modbus client between them. */
typedef struct rig {
    fake_gateway gateway;
    packcell_link link;
    packcell_arm arms[2];
    bool read_fails;
    bool write_fails;
    bool written[2]; /* commands, since the last scan */
    bool link_written;
    uint16_t waiting[2][48]; /* the commands written last */
    int command_writes;
} rig;

static uint16_t *status_of(fake_gateway *g, int field) { return &g->registers[kStatus + field]; }

static uint16_t *arm_status(fake_gateway *g, int arm, int field) {
    return status_of(g, 7 + 4 * arm + field);
}

static uint16_t after(uint16_t number) {
    return number == 65535 ? (uint16_t)1 : (uint16_t)(number + 1);
}

static void show_page(fake_gateway *g, int arm) {
    uint16_t *r = &g->registers[kResult + 100 * arm];
    const uint16_t number = r[0];
    const uint16_t pages = (uint16_t)((g->plan_count + 6) / 7);
    uint16_t page = g->registers[kLink + 4 + arm];
    uint16_t i;
    if (page >= pages) page = pages > 0 ? (uint16_t)(pages - 1) : 0;
    memset(r, 0, 64 * sizeof *r);
    r[0] = number;
    r[1] = g->plan_count;
    r[2] = page;
    r[3] = pages;
    for (i = 0; i < 7 && page * 7 + i < g->plan_count; ++i) {
        const packcell_action *a = &g->plan[page * 7 + i];
        uint16_t *to = r + 4 + 8 * i;
        to[0] = a->code;
        to[1] = (uint16_t)(a->item >> 16);
        to[2] = (uint16_t)(a->item & 0xFFFF);
        to[3] = a->x;
        to[4] = a->y;
        to[5] = a->rotation;
        to[6] = a->arm;
    }
    r[63] = g->torn ? (uint16_t)(number + 1) : number;
}

static void end_work(fake_gateway *g, int arm) {
    const uint16_t number = *arm_status(g, arm, 0);
    if (g->last[arm][1] == PACKCELL_PLAN_NEXT) {
        *arm_status(g, arm, 2) = g->result;
        g->registers[kResult + 100 * arm] = number;
        show_page(g, arm);
    }
    *arm_status(g, arm, 1) = number;
}

static void take_command(fake_gateway *g, int arm, const uint16_t *block) {
    const uint16_t ack = *arm_status(g, arm, 0);
    if (block[0] == 0 || block[0] != block[47]) return;
    if (block[0] == ack) {
        if (memcmp(block, g->last[arm], sizeof g->last[arm]) != 0)
            *arm_status(g, arm, 3) = kConflict;
    } else if (block[0] != after(ack)) {
        *arm_status(g, arm, 3) = kSeqGap;
    } else if (g->refuse != 0) {
        *arm_status(g, arm, 3) = (uint16_t)g->refuse;
    } else {
        memcpy(g->last[arm], block, sizeof g->last[arm]);
        ++g->executed[arm];
        *arm_status(g, arm, 0) = block[0];
        *arm_status(g, arm, 3) = 0;
        if (!g->hold_done) end_work(g, arm);
    }
}

static void take_link(fake_gateway *g, const uint16_t *image) {
    uint16_t *link = &g->registers[kLink];
    const bool edge = image[3] == 1 && (link[3] == 0 || link[2] != image[2]);
    memcpy(link, image, 8 * sizeof *link);
    if (edge) g->controls[g->control_count++] = image[2];
    show_page(g, 0);
    show_page(g, 1);
}

static void restart(fake_gateway *g) {
    int arm;
    ++*status_of(g, 3);
    for (arm = 0; arm < 2; ++arm) {
        *arm_status(g, arm, 1) = *arm_status(g, arm, 0);
        *arm_status(g, arm, 2) = 0;
        *arm_status(g, arm, 3) = 0;
        memset(&g->registers[kResult + 100 * arm], 0, 64 * sizeof(uint16_t));
    }
    g->plan_count = 0;
}

static void scan(rig *r) {
    int i;
    const bool read = !r->read_fails;
    if (!r->gateway.dead) ++*status_of(&r->gateway, 4);
    r->link.status_read = read;
    if (read) memcpy(r->link.status_image, status_of(&r->gateway, 0), sizeof r->link.status_image);
    r->link.link_written = r->link_written;
    r->link.page_a = r->arms[0].page;
    r->link.page_b = r->arms[1].page;
    r->link.cancel_seq = r->arms[0].cancel_seq;
    r->link.elapsed_ms = kScanMs;
    packcell_link_scan(&r->link);
    for (i = 0; i < 2; ++i) {
        packcell_arm *fb = &r->arms[i];
        fb->link_ok = r->link.link_ok;
        fb->status_read = read;
        memcpy(fb->status_image, r->link.status_image, sizeof fb->status_image);
        fb->result_read = read;
        if (read)
            memcpy(fb->result_image, &r->gateway.registers[kResult + 100 * i],
                   sizeof fb->result_image);
        fb->command_written = r->written[i];
        fb->elapsed_ms = kScanMs;
        packcell_arm_scan(fb);
        r->written[i] = !r->write_fails && fb->command_image[0] != 0;
        if (fb->command_image[0] == 0) memset(r->waiting[i], 0, sizeof r->waiting[i]);
        if (!r->written[i]) continue;
        ++r->command_writes;
        if (r->gateway.late) take_command(&r->gateway, i, r->waiting[i]);
        memcpy(r->waiting[i], fb->command_image, sizeof r->waiting[i]);
        if (!r->gateway.late) take_command(&r->gateway, i, fb->command_image);
    }
    r->link_written = !r->write_fails;
    if (r->link_written) take_link(&r->gateway, r->link.link_image);
}

static void scans(rig *r, int count) {
    while (count-- > 0) scan(r);
}

static rig cold_rig(uint16_t ack) {
    rig r;
    memset(&r, 0, sizeof r);
    *status_of(&r.gateway, 0) = PACKCELL_MAGIC;
    *status_of(&r.gateway, 1) = PACKCELL_MAJOR;
    *status_of(&r.gateway, 3) = 7;
    *status_of(&r.gateway, 5) = 6;
    *arm_status(&r.gateway, 0, 0) = ack;
    *arm_status(&r.gateway, 0, 1) = ack;
    r.gateway.result = PACKCELL_PLANNED;
    packcell_link_init(&r.link);
    packcell_arm_init(&r.arms[0], 0);
    packcell_arm_init(&r.arms[1], 1);
    return r;
}

static rig warm_rig(uint16_t ack) {
    rig r = cold_rig(ack);
    scans(&r, 5);
    assert_int_equal(r.arms[0].state, PACKCELL_READY);
    return r;
}

static void put_out(packcell_arm *fb, uint16_t code, uint16_t first_word) {
    fb->code = code;
    fb->payload[0] = first_word;
    fb->execute = true;
}

static bool has_ended(const packcell_arm *fb) { return fb->done || fb->rejected; }

/* Until the block has ended; at most a second. */
static void run_command(rig *r, packcell_arm *fb) {
    int i;
    for (i = 0; i < 100 && !has_ended(fb); ++i) scan(r);
    assert_true(has_ended(fb));
}

static void lower(rig *r, packcell_arm *fb) {
    fb->execute = false;
    scan(r);
    assert_false(has_ended(fb));
    assert_int_equal(fb->state, PACKCELL_READY);
}

static void plan_of(fake_gateway *g, uint16_t count) {
    uint16_t i;
    g->plan_count = count;
    for (i = 0; i < count; ++i) {
        const packcell_action a = {1, 0x10000u + i, i, (uint16_t)(2 * i), i & 1, i & 1};
        g->plan[i] = a;
    }
}

/* ---- Handshake ------------------------------------------------------------------------------- */

static void a_command_is_acknowledged_and_done(void **state) {
    rig r = warm_rig(0);
    packcell_arm *fb = &r.arms[0];
    (void)state;
    put_out(fb, PACKCELL_JOB_START, 3);
    scan(&r);
    assert_true(fb->busy);
    assert_int_equal(fb->seq, 1);
    run_command(&r, fb);
    assert_true(fb->acked && fb->done && !fb->busy && !fb->rejected);
    assert_int_equal(r.gateway.executed[0], 1);
    assert_int_equal(r.gateway.last[0][1], PACKCELL_JOB_START);
    assert_int_equal(r.gateway.last[0][3], 3);
    assert_int_equal(r.gateway.executed[1], 0);
    lower(&r, fb);
}

static void writing_it_every_scan_executes_it_once(void **state) {
    rig r = warm_rig(0);
    packcell_arm *fb = &r.arms[0];
    uint16_t first[48];
    (void)state;
    r.gateway.hold_done = true;
    put_out(fb, PACKCELL_PLAN_NEXT, 100);
    scan(&r);
    memcpy(first, fb->command_image, sizeof first);
    fb->payload[0] = 999; /* what the program does with its inputs meanwhile does not matter */
    scans(&r, 50);
    assert_memory_equal(first, fb->command_image, sizeof first);
    assert_true(r.command_writes > 40);
    assert_int_equal(r.gateway.executed[0], 1);
    assert_true(fb->acked && fb->busy && !fb->done);
    assert_int_equal(*arm_status(&r.gateway, 0, 3), 0);
    plan_of(&r.gateway, 1);
    end_work(&r.gateway, 0);
    run_command(&r, fb);
    assert_int_equal(fb->action_count, 1);
}

static void numbers_rise_by_one_and_wrap_past_0(void **state) {
    rig r = warm_rig(65533);
    packcell_arm *fb = &r.arms[0];
    const uint16_t expected[] = {65534, 65535, 1, 2};
    size_t i;
    (void)state;
    for (i = 0; i < 4; ++i) {
        put_out(fb, PACKCELL_JOB_END, 0);
        run_command(&r, fb);
        assert_true(fb->done);
        assert_int_equal(fb->seq, expected[i]);
        lower(&r, fb);
    }
    assert_int_equal(r.gateway.executed[0], 4);
}

static void a_rejection_keeps_its_number(void **state) {
    rig r = warm_rig(41);
    packcell_arm *fb = &r.arms[0];
    (void)state;
    r.gateway.refuse = kWrongState;
    put_out(fb, PACKCELL_PLAN_NEXT, 100);
    run_command(&r, fb);
    assert_true(fb->rejected && !fb->done && !fb->acked && !fb->busy);
    assert_int_equal(fb->reject_code, kWrongState);
    assert_int_equal(fb->seq, 42);
    lower(&r, fb);
    r.gateway.refuse = 0;
    put_out(fb, PACKCELL_JOB_END, 0);
    run_command(&r, fb);
    assert_true(fb->done);
    assert_int_equal(fb->seq, 42);
    assert_int_equal(*arm_status(&r.gateway, 0, 0), 42);
}

static void a_rejected_command_does_not_stay_written(void **state) {
    rig r = warm_rig(0);
    packcell_arm *fb = &r.arms[0];
    (void)state;
    r.gateway.refuse = kWrongState;
    put_out(fb, PACKCELL_PLAN_NEXT, 100);
    run_command(&r, fb);
    r.gateway.refuse = 0; /* now it would be accepted */
    scans(&r, 20);
    assert_int_equal(r.gateway.executed[0], 0);
}

/* Its code stands in the status until a command is accepted. */
static void an_old_rejection_does_not_reject_the_next_command(void **state) {
    rig r = warm_rig(0);
    packcell_arm *fb = &r.arms[0];
    (void)state;
    r.gateway.refuse = kWrongState;
    put_out(fb, PACKCELL_PLAN_NEXT, 100);
    run_command(&r, fb);
    lower(&r, fb);
    r.gateway.refuse = 0;
    r.write_fails = true;
    put_out(fb, PACKCELL_JOB_END, 0);
    scans(&r, 30);
    assert_true(fb->busy && !fb->rejected);
    r.write_fails = false;
    run_command(&r, fb);
    assert_true(fb->done);
}

static void a_rejection_is_believed_only_of_readings_after_the_command(void **state) {
    rig r = warm_rig(0);
    packcell_arm *fb = &r.arms[0];
    (void)state;
    r.gateway.refuse = kWrongState;
    put_out(fb, PACKCELL_PLAN_NEXT, 100);
    run_command(&r, fb);
    lower(&r, fb);
    r.gateway.refuse = 0;
    r.gateway.late = true;
    put_out(fb, PACKCELL_JOB_END, 0);
    run_command(&r, fb);
    assert_true(fb->done);
    lower(&r, fb);

    r.gateway.late = false;
    r.gateway.refuse = kWrongState;
    put_out(fb, PACKCELL_PLAN_NEXT, 100);
    run_command(&r, fb);
    lower(&r, fb);
    r.gateway.refuse = 0;
    put_out(fb, PACKCELL_JOB_END, 0);
    scan(&r);
    r.read_fails = true; /* what stands in the image is of before */
    scans(&r, 10);
    assert_true(fb->busy && !fb->rejected);
    r.read_fails = false;
    run_command(&r, fb);
    assert_true(fb->done);
}

static void a_number_that_another_master_used_is_a_conflict(void **state) {
    rig r = warm_rig(9);
    packcell_arm *fb = &r.arms[0];
    uint16_t other[48] = {0};
    (void)state;
    r.write_fails = true;
    put_out(fb, PACKCELL_JOB_END, 0);
    scan(&r);
    other[0] = other[47] = 10;
    other[1] = PACKCELL_JOB_START;
    take_command(&r.gateway, 0, other);
    scans(&r, 10);
    assert_int_equal(fb->seq, 10);
    assert_true(fb->busy && !fb->acked); /* the other's acknowledgement is not its own */
    r.write_fails = false;
    run_command(&r, fb);
    assert_true(fb->rejected);
    assert_int_equal(fb->reject_code, kConflict);
    assert_int_equal(r.gateway.executed[0], 1);
    lower(&r, fb);
    put_out(fb, PACKCELL_JOB_END, 0);
    run_command(&r, fb);
    assert_true(fb->done);
    assert_int_equal(fb->seq, 11);
}

static void a_gateway_that_counts_otherwise_is_adopted(void **state) {
    rig r = warm_rig(100);
    packcell_arm *fb = &r.arms[0];
    (void)state;
    r.write_fails = true;
    put_out(fb, PACKCELL_JOB_END, 0);
    scan(&r);
    *arm_status(&r.gateway, 0, 0) = 5;
    run_command(&r, fb);
    assert_true(fb->rejected);
    assert_int_equal(fb->reject_code, kSeqGap);
    r.write_fails = false;
    lower(&r, fb);
    put_out(fb, PACKCELL_JOB_END, 0);
    run_command(&r, fb);
    assert_true(fb->done);
    assert_int_equal(fb->seq, 6);
}

static void the_arms_count_for_themselves(void **state) {
    rig r = warm_rig(30);
    (void)state;
    put_out(&r.arms[0], PACKCELL_PLAN_NEXT, 100);
    put_out(&r.arms[1], PACKCELL_PLAN_NEXT, 100);
    plan_of(&r.gateway, 3);
    run_command(&r, &r.arms[0]);
    run_command(&r, &r.arms[1]);
    assert_int_equal(r.arms[0].seq, 31);
    assert_int_equal(r.arms[1].seq, 1);
    assert_int_equal(r.arms[1].action_count, 3);
}

/* ---- Cold starts, restarts, lost links ------------------------------------------------------- */

static void a_cold_block_adopts_the_number(void **state) {
    rig r = cold_rig(1234);
    packcell_arm *fb = &r.arms[0];
    (void)state;
    put_out(fb, PACKCELL_JOB_END, 0); /* raised before anything was read */
    run_command(&r, fb);
    assert_true(fb->done);
    assert_int_equal(fb->seq, 1235);
}

static void nothing_is_sent_to_a_gateway_whose_heartbeat_never_moved(void **state) {
    rig r = cold_rig(3);
    (void)state;
    *status_of(&r.gateway, 4) = 77;
    r.gateway.dead = true;
    put_out(&r.arms[0], PACKCELL_JOB_END, 0);
    scans(&r, 300);
    assert_false(r.link.link_ok);
    assert_int_equal(r.arms[0].state, PACKCELL_COLD);
    assert_int_equal(r.command_writes, 0);
}

static void a_restart_is_told_once_and_numbers_go_on(void **state) {
    rig r = warm_rig(20);
    packcell_arm *fb = &r.arms[0];
    int told = 0;
    int i;
    (void)state;
    put_out(fb, PACKCELL_JOB_END, 0);
    run_command(&r, fb);
    lower(&r, fb);
    restart(&r.gateway);
    for (i = 0; i < 10; ++i) {
        scan(&r);
        told += r.link.restarted;
    }
    assert_int_equal(told, 1);
    assert_int_equal(fb->command_image[0], 0);
    put_out(fb, PACKCELL_JOB_END, 0);
    run_command(&r, fb);
    assert_true(fb->done);
    assert_int_equal(fb->seq, 22);
}

static void an_emptied_journal_is_adopted_after_the_restart(void **state) {
    rig r = warm_rig(20);
    packcell_arm *fb = &r.arms[0];
    (void)state;
    *arm_status(&r.gateway, 0, 0) = 0;
    restart(&r.gateway);
    scans(&r, 3);
    put_out(fb, PACKCELL_JOB_END, 0);
    run_command(&r, fb);
    assert_true(fb->done);
    assert_int_equal(fb->seq, 1);
}

static void a_plan_that_a_restart_swallowed_ends_without_one(void **state) {
    rig r = warm_rig(20);
    packcell_arm *fb = &r.arms[0];
    (void)state;
    r.gateway.hold_done = true;
    put_out(fb, PACKCELL_PLAN_NEXT, 100);
    scans(&r, 5);
    assert_true(fb->acked && fb->busy);
    restart(&r.gateway);
    /* Its end may have been journalled: but its items are unresolved now. */
    plan_of(&r.gateway, 3);
    end_work(&r.gateway, 0);
    run_command(&r, fb);
    assert_true(fb->done);
    assert_int_equal(fb->result, 0);
    assert_int_equal(fb->action_count, 0);
    lower(&r, fb);

    put_out(fb, PACKCELL_PLAN_NEXT, 100);
    scans(&r, 5);
    assert_true(fb->acked && fb->busy);
    *arm_status(&r.gateway, 0, 0) = 0; /* nor does it know the command any more */
    restart(&r.gateway);
    run_command(&r, fb);
    assert_true(fb->done);
    assert_int_equal(fb->result, 0);
}

static void a_command_that_a_restart_did_not_see_is_taken_afterwards(void **state) {
    rig r = warm_rig(20);
    packcell_arm *fb = &r.arms[0];
    (void)state;
    r.write_fails = true;
    put_out(fb, PACKCELL_PLAN_NEXT, 100);
    scans(&r, 5);
    restart(&r.gateway);
    scans(&r, 5);
    r.write_fails = false;
    plan_of(&r.gateway, 2);
    run_command(&r, fb);
    assert_int_equal(fb->result, PACKCELL_PLANNED);
    assert_int_equal(fb->action_count, 2);
    assert_int_equal(r.gateway.executed[0], 1);
}

/* The journal has it, but the link went before the PLC could see that. */
static void a_command_that_was_journalled_before_the_restart_is_not_sent_anew(void **state) {
    rig r = warm_rig(20);
    packcell_arm *fb = &r.arms[0];
    (void)state;
    put_out(fb, PACKCELL_UNPACKED, 0);
    scan(&r);
    assert_int_equal(r.gateway.executed[0], 1);
    r.read_fails = r.write_fails = true;
    scans(&r, 150);
    assert_false(r.link.link_ok);
    assert_true(fb->busy && !fb->acked);
    restart(&r.gateway);
    r.read_fails = r.write_fails = false;
    run_command(&r, fb);
    assert_true(fb->done && !fb->rejected);
    assert_int_equal(r.gateway.executed[0], 1);
    assert_int_equal(*arm_status(&r.gateway, 0, 0), 21);
}

static void stale_values_are_not_believed(void **state) {
    rig r = warm_rig(20);
    packcell_arm *fb = &r.arms[0];
    (void)state;
    r.gateway.dead = true; /* a gateway or a cache that answers, but lives no more */
    scans(&r, 101);
    assert_false(r.link.link_ok);
    put_out(fb, PACKCELL_JOB_END, 0);
    scans(&r, 50);
    assert_true(fb->busy && !fb->acked);
    assert_true(fb->waited_ms >= 480);
    r.gateway.dead = false;
    run_command(&r, fb);
    assert_true(fb->done);
    assert_int_equal(r.gateway.executed[0], 1);
}

static void a_number_that_was_used_stays_used_while_nothing_is_read(void **state) {
    rig r = warm_rig(20);
    packcell_arm *fb = &r.arms[0];
    (void)state;
    put_out(fb, PACKCELL_JOB_START, 1);
    run_command(&r, fb);
    r.read_fails = r.write_fails = true;
    lower(&r, fb);
    put_out(fb, PACKCELL_JOB_END, 0);
    scans(&r, 20);
    assert_int_equal(fb->seq, 22);
    r.read_fails = r.write_fails = false;
    run_command(&r, fb);
    assert_true(fb->done);
}

static void the_link_is_lost_after_a_second_of_silence(void **state) {
    rig r = warm_rig(0);
    int quiet = 0;
    (void)state;
    r.read_fails = true;
    while (r.link.link_ok && quiet < 1000) {
        scan(&r);
        ++quiet;
    }
    assert_in_range(quiet * kScanMs, 1000, 1000 + kScanMs);
    r.read_fails = false;
    scans(&r, 2);
    assert_true(r.link.link_ok);
}

/* ---- Link ------------------------------------------------------------------------------------ */

static void the_heartbeat_changes_five_times_a_second(void **state) {
    rig r = warm_rig(0);
    int changes = 0;
    int i;
    uint16_t last = r.link.link_image[0];
    (void)state;
    for (i = 0; i < 1000; ++i) {
        scan(&r);
        changes += r.link.link_image[0] != last;
        last = r.link.link_image[0];
    }
    assert_in_range(changes, 49, 51);
    r.link.link_image[0] = 0xFFFE;
    scans(&r, 20);
    assert_int_equal(r.link.link_image[0], 0xFFFF);
    scans(&r, 20);
    assert_int_equal(r.link.link_image[0], 0);
}

static void another_map_is_no_gateway(void **state) {
    rig r = warm_rig(0);
    (void)state;
    *status_of(&r.gateway, 1) = 2;
    scan(&r);
    assert_true(r.link.map_wrong);
    assert_false(r.link.link_ok);
}

static void a_packml_command_is_one_edge(void **state) {
    rig r = warm_rig(0);
    (void)state;
    r.link.control = 1;
    r.link.control_request = true;
    r.write_fails = true;
    scans(&r, 10);
    assert_true(r.link.control_busy);
    assert_int_equal(r.gateway.control_count, 0);
    r.write_fails = false;
    scans(&r, 10);
    assert_true(r.link.control_done && !r.link.control_busy);
    assert_int_equal(r.gateway.control_count, 1);
    assert_int_equal(r.gateway.controls[0], 1);
    r.link.control_request = false;
    scan(&r);
    r.link.control = 1; /* the same one again is another edge */
    r.link.control_request = true;
    scans(&r, 10);
    assert_int_equal(r.gateway.control_count, 2);
}

static void cancelling_names_the_plan_that_is_awaited(void **state) {
    rig r = warm_rig(50);
    packcell_arm *fb = &r.arms[0];
    (void)state;
    r.gateway.hold_done = true;
    put_out(fb, PACKCELL_PLAN_NEXT, 100);
    scans(&r, 5);
    assert_int_equal(r.gateway.registers[kLink + 1], 0);
    fb->cancel = true;
    scans(&r, 2);
    assert_int_equal(r.gateway.registers[kLink + 1], 51);
    r.gateway.result = PACKCELL_CANCELLED;
    end_work(&r.gateway, 0);
    run_command(&r, fb);
    assert_int_equal(fb->result, PACKCELL_CANCELLED);
    scans(&r, 2);
    assert_int_equal(r.gateway.registers[kLink + 1], 0);
}

/* ---- Plans ----------------------------------------------------------------------------------- */

static void assert_same_actions(const packcell_action *a, const packcell_action *b, size_t count) {
    size_t i;
    for (i = 0; i < count; ++i) {
        assert_int_equal(a[i].code, b[i].code);
        assert_int_equal(a[i].item, b[i].item);
        assert_int_equal(a[i].x, b[i].x);
        assert_int_equal(a[i].y, b[i].y);
        assert_int_equal(a[i].rotation, b[i].rotation);
        assert_int_equal(a[i].arm, b[i].arm);
    }
}

static void a_plan_is_read_page_by_page(void **state) {
    const uint16_t counts[] = {0, 1, 7, 8, 14, 20};
    size_t i;
    (void)state;
    for (i = 0; i < sizeof counts / sizeof counts[0]; ++i) {
        rig r = warm_rig(0);
        packcell_arm *fb = &r.arms[0];
        plan_of(&r.gateway, counts[i]);
        put_out(fb, PACKCELL_PLAN_NEXT, 100);
        run_command(&r, fb);
        assert_int_equal(fb->result, PACKCELL_PLANNED);
        assert_int_equal(fb->action_count, counts[i]);
        assert_same_actions(fb->actions, r.gateway.plan, counts[i]);
        assert_int_equal(fb->page, 0);
    }
}

static void a_torn_result_is_not_read(void **state) {
    rig r = warm_rig(0);
    packcell_arm *fb = &r.arms[0];
    (void)state;
    plan_of(&r.gateway, 3);
    r.gateway.torn = true;
    put_out(fb, PACKCELL_PLAN_NEXT, 100);
    scans(&r, 50);
    assert_int_equal(fb->state, PACKCELL_READ_PAGES);
    assert_int_equal(fb->action_count, 0);
    r.gateway.torn = false;
    run_command(&r, fb);
    assert_int_equal(fb->action_count, 3);
}

static void a_result_that_was_not_read_anew_is_not_looked_at(void **state) {
    rig r = warm_rig(0);
    packcell_arm *fb = &r.arms[0];
    (void)state;
    plan_of(&r.gateway, 3);
    r.gateway.torn = true;
    put_out(fb, PACKCELL_PLAN_NEXT, 100);
    scans(&r, 5);
    assert_int_equal(fb->state, PACKCELL_READ_PAGES);
    r.read_fails = true;
    fb->result_image[63] = fb->result_image[0];
    scans(&r, 5);
    assert_int_equal(fb->state, PACKCELL_READ_PAGES);
}

static void the_result_of_another_number_is_not_read(void **state) {
    rig r = warm_rig(0);
    packcell_arm *fb = &r.arms[0];
    (void)state;
    plan_of(&r.gateway, 3);
    put_out(fb, PACKCELL_PLAN_NEXT, 100);
    scan(&r);
    r.gateway.registers[kResult] = 9;
    scans(&r, 50);
    assert_int_equal(fb->state, PACKCELL_READ_PAGES);
    r.gateway.registers[kResult] = 0;
    r.gateway.torn = true; /* the right tail behind another head */
    scans(&r, 50);
    assert_int_equal(fb->state, PACKCELL_READ_PAGES);
    r.gateway.torn = false;
    r.gateway.registers[kResult] = 1;
    run_command(&r, fb);
    assert_int_equal(fb->action_count, 3);
}

static void a_plan_beyond_the_array_is_not_cut(void **state) {
    rig r = warm_rig(0);
    packcell_arm *fb = &r.arms[0];
    int i;
    (void)state;
    put_out(fb, PACKCELL_PLAN_NEXT, 100);
    for (i = 0; i < 20 && !fb->done; ++i) {
        scan(&r); /* shows the page anew */
        r.gateway.registers[kResult + 1] = PACKCELL_MOST_ACTIONS + 1;
    }
    assert_true(fb->done && fb->too_long);
    assert_int_equal(fb->action_count, 0);
}

static void no_plan_has_no_pages(void **state) {
    rig r = warm_rig(0);
    packcell_arm *fb = &r.arms[0];
    (void)state;
    plan_of(&r.gateway, 3);
    r.gateway.result = PACKCELL_NO_PLAN;
    put_out(fb, PACKCELL_PLAN_NEXT, 100);
    run_command(&r, fb);
    assert_int_equal(fb->result, PACKCELL_NO_PLAN);
    assert_int_equal(fb->action_count, 0);
}

static void a_restart_while_pages_are_read_gives_no_half_plan(void **state) {
    rig r = warm_rig(0);
    packcell_arm *fb = &r.arms[0];
    (void)state;
    plan_of(&r.gateway, 20);
    put_out(fb, PACKCELL_PLAN_NEXT, 100);
    while (fb->page == 0) scan(&r);
    restart(&r.gateway);
    run_command(&r, fb);
    assert_int_equal(fb->result, 0);
    assert_int_equal(fb->action_count, 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_command_is_acknowledged_and_done),
        cmocka_unit_test(writing_it_every_scan_executes_it_once),
        cmocka_unit_test(numbers_rise_by_one_and_wrap_past_0),
        cmocka_unit_test(a_rejection_keeps_its_number),
        cmocka_unit_test(a_rejected_command_does_not_stay_written),
        cmocka_unit_test(an_old_rejection_does_not_reject_the_next_command),
        cmocka_unit_test(a_rejection_is_believed_only_of_readings_after_the_command),
        cmocka_unit_test(a_number_that_another_master_used_is_a_conflict),
        cmocka_unit_test(a_gateway_that_counts_otherwise_is_adopted),
        cmocka_unit_test(the_arms_count_for_themselves),
        cmocka_unit_test(a_cold_block_adopts_the_number),
        cmocka_unit_test(nothing_is_sent_to_a_gateway_whose_heartbeat_never_moved),
        cmocka_unit_test(a_restart_is_told_once_and_numbers_go_on),
        cmocka_unit_test(an_emptied_journal_is_adopted_after_the_restart),
        cmocka_unit_test(a_plan_that_a_restart_swallowed_ends_without_one),
        cmocka_unit_test(a_command_that_a_restart_did_not_see_is_taken_afterwards),
        cmocka_unit_test(a_command_that_was_journalled_before_the_restart_is_not_sent_anew),
        cmocka_unit_test(stale_values_are_not_believed),
        cmocka_unit_test(a_number_that_was_used_stays_used_while_nothing_is_read),
        cmocka_unit_test(the_link_is_lost_after_a_second_of_silence),
        cmocka_unit_test(the_heartbeat_changes_five_times_a_second),
        cmocka_unit_test(another_map_is_no_gateway),
        cmocka_unit_test(a_packml_command_is_one_edge),
        cmocka_unit_test(cancelling_names_the_plan_that_is_awaited),
        cmocka_unit_test(a_plan_is_read_page_by_page),
        cmocka_unit_test(a_torn_result_is_not_read),
        cmocka_unit_test(a_result_that_was_not_read_anew_is_not_looked_at),
        cmocka_unit_test(the_result_of_another_number_is_not_read),
        cmocka_unit_test(a_plan_beyond_the_array_is_not_cut),
        cmocka_unit_test(no_plan_has_no_pages),
        cmocka_unit_test(a_restart_while_pages_are_read_gives_no_half_plan),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
