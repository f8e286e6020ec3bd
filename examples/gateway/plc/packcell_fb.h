/* The function blocks of packcell.st in C99: what a PLC does to talk to packcell-gateway.
 *
 * Same names, states and lines as the Structured Text; whoever changes one changes the other. No
 * socket, no allocation, no clock: the caller reads and writes the images by its own Modbus client
 * and says how much time passed. A block that is all zero bits but for what its _init sets is cold.
 *
 * Order within a scan: read status and results, packcell_link_scan(), packcell_arm_scan() for each
 * channel, write the images. Images that were not read anew are not looked at. */
#ifndef PACKCELL_FB_H
#define PACKCELL_FB_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The map: what status_image[0] and [1] hold. */
#define PACKCELL_MAGIC 0x504B
#define PACKCELL_MAJOR 1

/* Command codes. */
#define PACKCELL_ITEM_ARRIVED 1 /* id high, id low, w, h; flags 1 no rotation, 2 pinned */
#define PACKCELL_PLAN_NEXT 2    /* deadline, ms */
#define PACKCELL_PLACED 3       /* id high, id low, x, y, rotation */
#define PACKCELL_PLACE_FAILED 4 /* id high, id low */
#define PACKCELL_UNPACKED 5     /* id high, id low */
#define PACKCELL_BIN_CHANGED 6  /* W, H */
#define PACKCELL_JOB_START 7    /* id high, id low */
#define PACKCELL_JOB_END 8
#define PACKCELL_RESOLVE 9    /* id high, id low, 0 not in the bin | 1 in the bin */
#define PACKCELL_ITEM_GONE 10 /* id high, id low */

/* Results of a PLAN_NEXT. */
#define PACKCELL_PLANNED 1
#define PACKCELL_PLANNED_BEST 2 /* the best plan by the deadline */
#define PACKCELL_NO_PLAN 3      /* nothing to place, or the other arm is still at work */
#define PACKCELL_CANCELLED 4
#define PACKCELL_PLANNER_FAULT 5

/* Reject codes that the block looks at or makes up itself. */
#define PACKCELL_SEQ_GAP 2

/* States of packcell_arm. */
#define PACKCELL_COLD 0 /* the gateway's number is not known yet */
#define PACKCELL_READY 1
#define PACKCELL_WAIT_ACK 2   /* written every scan until it is acknowledged */
#define PACKCELL_WAIT_DONE 3  /* acknowledged; the work goes on */
#define PACKCELL_READ_PAGES 4 /* a plan is there and is read page by page */
#define PACKCELL_FINISHED 5   /* outputs stay until execute goes false */

/* States of a control request in packcell_link. */
#define PACKCELL_CONTROL_IDLE 0
#define PACKCELL_CONTROL_RAISED 1
#define PACKCELL_CONTROL_LOWERED 2

/* Times, ms. The gateway counts a PLC as lost after 1000 by default. */
#define PACKCELL_HEARTBEAT_MS 200u
#define PACKCELL_SILENT_MS 1000u
#define PACKCELL_LONGEST_MS 4000000000u /* where counted times stop */

/* Status images read after the command was written, before a reject code is believed: the one of an
 * earlier command stands there until the next one is accepted. */
#define PACKCELL_REJECT_READS 2

/* The longest plan that there is. A small PLC may have fewer; longer plans are then too_long. */
#define PACKCELL_MOST_ACTIONS 768
#define PACKCELL_ACTIONS_PER_PAGE 7

typedef struct packcell_action {
    uint16_t code; /* 1 pack, 2 unpack, 3 terminate, 4 skip */
    uint32_t item;
    uint16_t x; /* cells */
    uint16_t y;
    uint16_t rotation; /* 1: turned by a quarter */
    uint16_t arm;      /* 0 or 1 */
} packcell_action;

/* FB_PackcellLink: heartbeats, PackML commands, restarts. One for the gateway, called before the
 * arms' blocks. */
typedef struct packcell_link {
    /* VAR_INPUT */
    bool status_read; /* status_image was read since the last call */
    uint16_t status_image[32];
    bool link_written;    /* link_image as the last call left it was written */
    uint16_t control;     /* PackML: 1 Reset 2 Start 3 Stop 4 Hold 5 Unhold 6 Suspend 7 Unsuspend
                             8 Abort 9 Clear 10 Complete */
    bool control_request; /* true asks for it; then false again */
    uint16_t cancel_seq;  /* cancel_seq of an arm's block, 0 for none */
    uint16_t page_a;      /* page of the arms' blocks */
    uint16_t page_b;
    uint32_t elapsed_ms; /* since the last call */
    /* VAR_OUTPUT */
    uint16_t link_image[8];
    bool link_ok;   /* the gateway's heartbeat moves */
    bool map_wrong; /* what answers is no gateway of this map */
    bool restarted; /* for one call: the gateway is another run than before */
    uint16_t boot_id;
    uint16_t state_current; /* PackML state; of the past unless link_ok */
    bool control_busy;
    bool control_done; /* it was handed over; whether it fitted, state_current shows */
    /* VAR */
    bool known; /* boot_id and gateway_heartbeat were read once */
    uint16_t gateway_heartbeat;
    uint32_t silent_ms;
    uint32_t own_ms;
    int control_state;
} packcell_link;

/* FB_PackcellArm: one command channel. Raise execute with code, flags and payload; keep them until
 * done or rejected comes, then lower it. Nothing is executed twice: as long as no acknowledgement
 * comes, the same image with the same number is written again, over lost links and restarts too. */
typedef struct packcell_arm {
    /* VAR_INPUT */
    int arm; /* 0: channel A, 1: channel B */
    bool execute;
    uint16_t code;
    uint16_t flags;
    uint16_t payload[8];
    bool cancel;  /* give up the PLAN_NEXT under way */
    bool link_ok; /* of packcell_link */
    bool status_read;
    uint16_t status_image[32];
    bool result_read; /* result_image was read since the last call */
    uint16_t result_image[64];
    bool command_written; /* command_image as the last call left it was written since it was put
                             out, and status_image was read after that */
    uint32_t elapsed_ms;
    /* VAR_OUTPUT */
    uint16_t command_image[48]; /* to be written while its word 0 is not 0 */
    uint16_t page;              /* of the result, for packcell_link */
    uint16_t cancel_seq;        /* for packcell_link */
    bool busy;
    bool acked; /* in the gateway's journal: it will not be forgotten */
    bool done;
    bool rejected;
    uint16_t reject_code;
    uint16_t result; /* of a PLAN_NEXT; 0: the gateway restarted meanwhile */
    uint16_t action_count;
    packcell_action actions[PACKCELL_MOST_ACTIONS];
    bool too_long;      /* the plan has more actions than fit */
    uint16_t seq;       /* number of the command */
    uint32_t waited_ms; /* since execute; for an alarm of the PLC's choice */
    /* VAR */
    int state;
    uint16_t last_seq; /* the last accepted number before the command */
    bool known;
    uint16_t boot_id;
    bool boot_changed; /* and nothing was done about it yet */
    bool fresh;
    int base;         /* of this arm's words in status_image */
    uint16_t ack_seq; /* as read last */
    uint16_t rejects_read;
} packcell_arm;

/* Cold blocks. */
void packcell_link_init(packcell_link *fb);
void packcell_arm_init(packcell_arm *fb, int arm);

/* One call of the block: inputs are read, outputs set. */
void packcell_link_scan(packcell_link *fb);
void packcell_arm_scan(packcell_arm *fb);

#ifdef __cplusplus
}
#endif

#endif
