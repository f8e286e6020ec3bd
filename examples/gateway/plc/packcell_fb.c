#include "packcell_fb.h"

#include <string.h>

static uint32_t add_ms(uint32_t counted, uint32_t elapsed_ms) {
    const uint32_t elapsed = elapsed_ms < PACKCELL_LONGEST_MS ? elapsed_ms : PACKCELL_LONGEST_MS;
    const uint32_t most = PACKCELL_LONGEST_MS - elapsed;
    return (counted < most ? counted : most) + elapsed;
}

/* ---- FB_PackcellLink ------------------------------------------------------------------------- */

void packcell_link_init(packcell_link *fb) {
    memset(fb, 0, sizeof *fb);
    fb->silent_ms = PACKCELL_LONGEST_MS;
}

/* The gateway takes a command on the edge 0 -> 1 of word 3, so each level has to be written once.
 */
static void scan_control(packcell_link *fb) {
    switch (fb->control_state) {
        case PACKCELL_CONTROL_IDLE:
            if (fb->control_request && !fb->control_done) {
                fb->link_image[2] = fb->control;
                fb->link_image[3] = 1;
                fb->control_busy = true;
                fb->control_state = PACKCELL_CONTROL_RAISED;
            }
            if (!fb->control_request) {
                fb->control_done = false;
            }
            break;
        case PACKCELL_CONTROL_RAISED:
            if (fb->link_written) {
                fb->link_image[3] = 0;
                fb->control_state = PACKCELL_CONTROL_LOWERED;
            }
            break;
        case PACKCELL_CONTROL_LOWERED:
            if (fb->link_written) {
                fb->control_busy = false;
                fb->control_done = true;
                fb->control_state = PACKCELL_CONTROL_IDLE;
            }
            break;
        default:
            break;
    }
}

void packcell_link_scan(packcell_link *fb) {
    fb->restarted = false;
    fb->silent_ms = add_ms(fb->silent_ms, fb->elapsed_ms);
    if (fb->status_read) {
        fb->map_wrong =
            fb->status_image[0] != PACKCELL_MAGIC || fb->status_image[1] != PACKCELL_MAJOR;
        if (!fb->map_wrong) {
            /* One reading proves nothing: only a heartbeat that moves is a live one. */
            if (fb->known && fb->status_image[4] != fb->gateway_heartbeat) {
                fb->silent_ms = 0;
            }
            fb->restarted = fb->known && fb->status_image[3] != fb->boot_id;
            fb->gateway_heartbeat = fb->status_image[4];
            fb->boot_id = fb->status_image[3];
            fb->state_current = fb->status_image[5];
            fb->known = true;
        }
    }
    fb->link_ok = fb->silent_ms < PACKCELL_SILENT_MS && !fb->map_wrong;

    fb->own_ms = add_ms(fb->own_ms, fb->elapsed_ms);
    if (fb->own_ms >= PACKCELL_HEARTBEAT_MS) {
        fb->own_ms = 0;
        if (fb->link_image[0] == 0xFFFF) {
            fb->link_image[0] = 0;
        } else {
            fb->link_image[0] = (uint16_t)(fb->link_image[0] + 1);
        }
    }

    scan_control(fb);

    fb->link_image[1] = fb->cancel_seq;
    fb->link_image[4] = fb->page_a;
    fb->link_image[5] = fb->page_b;
}

/* ---- FB_PackcellArm -------------------------------------------------------------------------- */

void packcell_arm_init(packcell_arm *fb, int arm) {
    memset(fb, 0, sizeof *fb);
    fb->arm = arm;
}

static void clear_command(packcell_arm *fb) {
    memset(fb->command_image, 0, sizeof fb->command_image);
}

static void scan_cold(packcell_arm *fb) {
    if (fb->fresh) {
        fb->state = PACKCELL_READY;
    }
}

static void scan_ready(packcell_arm *fb) {
    int i;
    fb->last_seq = fb->ack_seq;
    if (fb->boot_changed) {
        fb->boot_changed = false;
        clear_command(fb);
    }
    if (fb->execute) {
        if (fb->last_seq == 0xFFFF) {
            fb->seq = 1;
        } else {
            fb->seq = (uint16_t)(fb->last_seq + 1);
        }
        clear_command(fb);
        fb->command_image[0] = fb->seq;
        fb->command_image[1] = fb->code;
        fb->command_image[2] = fb->flags;
        for (i = 0; i <= 7; ++i) {
            fb->command_image[3 + i] = fb->payload[i];
        }
        fb->command_image[47] = fb->seq;
        fb->busy = true;
        fb->acked = false;
        fb->done = false;
        fb->rejected = false;
        fb->reject_code = 0;
        fb->result = 0;
        fb->action_count = 0;
        fb->too_long = false;
        fb->waited_ms = 0;
        fb->rejects_read = 0;
        fb->state = PACKCELL_WAIT_ACK;
    }
}

static void scan_wait_ack(packcell_arm *fb) {
    const uint16_t reject = fb->status_image[fb->base + 3];
    if (!fb->fresh) {
        return;
    }
    if (fb->command_written && reject != 0) {
        fb->rejects_read = (uint16_t)(fb->rejects_read + 1);
    }
    if (fb->ack_seq == fb->seq) {
        /* Until this command is there, the number may have been used by another master. */
        if (fb->command_written && reject == 0) {
            fb->acked = true;
            fb->state = PACKCELL_WAIT_DONE;
        } else if (fb->command_written) {
            fb->rejected = true;
            fb->reject_code = reject;
        }
    } else if (fb->ack_seq != fb->last_seq) {
        /* The gateway counts otherwise. */
        fb->rejected = true;
        fb->reject_code = PACKCELL_SEQ_GAP;
    } else if (fb->rejects_read >= PACKCELL_REJECT_READS) {
        fb->rejected = true;
        fb->reject_code = reject;
    } else {
        /* A gateway that restarted will take it as any other. */
        fb->boot_changed = false;
    }
    if (fb->rejected) {
        /* Left to stand, it could be accepted later, when nobody wants it any more. */
        clear_command(fb);
        fb->busy = false;
        fb->state = PACKCELL_FINISHED;
    }
}

static void scan_wait_done(packcell_arm *fb) {
    if (!fb->fresh) {
        return;
    }
    if (fb->boot_changed) {
        /* What was being planned is lost; what was to be remembered is not. */
        fb->done = true;
    } else if (fb->status_image[fb->base + 1] == fb->seq) {
        fb->result = fb->status_image[fb->base + 2];
        if (fb->code == PACKCELL_PLAN_NEXT &&
            (fb->result == PACKCELL_PLANNED || fb->result == PACKCELL_PLANNED_BEST)) {
            fb->page = 0;
            fb->state = PACKCELL_READ_PAGES;
        } else {
            fb->done = true;
        }
    }
}

static void copy_page(packcell_arm *fb, uint32_t first, uint32_t count) {
    uint32_t i = 0;
    while (i < PACKCELL_ACTIONS_PER_PAGE && first + i < count) {
        const uint16_t *from = fb->result_image + 4 + 8 * i;
        packcell_action *to = &fb->actions[first + i];
        to->code = from[0];
        to->item = (uint32_t)from[1] << 16 | from[2];
        to->x = from[3];
        to->y = from[4];
        to->rotation = from[5];
        to->arm = from[6];
        i = i + 1;
    }
}

static void scan_read_pages(packcell_arm *fb) {
    if (fb->fresh && fb->boot_changed) {
        fb->result = 0;
        fb->action_count = 0;
        fb->done = true;
    } else if (fb->result_read && fb->link_ok && fb->result_image[0] == fb->seq &&
               fb->result_image[63] == fb->seq && fb->result_image[2] == fb->page) {
        /* Head, tail and page fit: these words belong together. */
        const uint16_t count = fb->result_image[1];
        const uint32_t first = (uint32_t)fb->page * PACKCELL_ACTIONS_PER_PAGE;
        if (count > PACKCELL_MOST_ACTIONS) {
            fb->too_long = true;
            fb->done = true;
        } else {
            copy_page(fb, first, count);
            if (first + PACKCELL_ACTIONS_PER_PAGE >= count) {
                fb->action_count = count;
                fb->page = 0;
                fb->done = true;
            } else {
                fb->page = (uint16_t)(fb->page + 1);
            }
        }
    }
}

static void scan_finished(packcell_arm *fb) {
    if (!fb->execute) {
        fb->done = false;
        fb->rejected = false;
        fb->acked = false;
        fb->state = PACKCELL_READY;
    }
}

void packcell_arm_scan(packcell_arm *fb) {
    fb->base = 7 + 4 * fb->arm;
    fb->fresh = fb->status_read && fb->link_ok;
    if (fb->fresh) {
        fb->ack_seq = fb->status_image[fb->base];
        if (fb->known && fb->status_image[3] != fb->boot_id) {
            fb->boot_changed = true;
        }
        fb->boot_id = fb->status_image[3];
        fb->known = true;
    }
    fb->waited_ms = add_ms(fb->waited_ms, fb->elapsed_ms);

    switch (fb->state) {
        case PACKCELL_COLD:
            scan_cold(fb);
            break;
        case PACKCELL_READY:
            scan_ready(fb);
            break;
        case PACKCELL_WAIT_ACK:
            scan_wait_ack(fb);
            break;
        case PACKCELL_WAIT_DONE:
            scan_wait_done(fb);
            break;
        case PACKCELL_READ_PAGES:
            scan_read_pages(fb);
            break;
        case PACKCELL_FINISHED:
            scan_finished(fb);
            break;
        default:
            break;
    }

    if (fb->done && fb->state != PACKCELL_FINISHED) {
        fb->busy = false;
        fb->state = PACKCELL_FINISHED;
    }

    /* A number is cancelled as long as its plan is awaited, and no other after it. */
    fb->cancel_seq = 0;
    if (fb->cancel && fb->code == PACKCELL_PLAN_NEXT &&
        (fb->state == PACKCELL_WAIT_ACK || fb->state == PACKCELL_WAIT_DONE)) {
        fb->cancel_seq = fb->seq;
    }
}
