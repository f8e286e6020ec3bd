#include "judge.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "check.h"

#define PERIOD 0.001
#define TURN 6.283185307179586
#define DEGREE (TURN / 360)
#define MAX_EVENTS 8192
#define SAME_PLACE 1e-6 /* metres */

/* ---- Arms, from the makers' documents ------------------------------------------------------- */

typedef struct limit {
    double least, most, velocity, acceleration;
} limit;

/* Links in Craig's convention, each T = Rx(alpha) Tx(a) Rz(offset + q) Tz(d). */
typedef struct link {
    double alpha, a, offset, d;
} link;

typedef struct arm_data {
    const char *name;
    limit limits[6];
    link links[6];
    double tip;        /* from the flange to the tool's tip */
    double pan;        /* direction of the arm in the plan where its first joint is 0 */
    double body, disc; /* radii of the footprint */
} arm_data;

#define HALF_TURN (TURN / 2)
#define QUARTER (TURN / 4)

static const arm_data arms_known[] = {
    {"ur5e",
     {{-TURN, TURN, HALF_TURN, HALF_TURN},
      {-TURN, TURN, HALF_TURN, HALF_TURN},
      {-HALF_TURN, HALF_TURN, HALF_TURN, HALF_TURN},
      {-TURN, TURN, HALF_TURN, HALF_TURN},
      {-TURN, TURN, HALF_TURN, HALF_TURN},
      {-TURN, TURN, HALF_TURN, HALF_TURN}},
     {{0, 0, 0, 0.1625},
      {QUARTER, 0, 0, 0},
      {0, -0.425, 0, 0},
      {0, -0.3922, 0, 0.1333},
      {QUARTER, 0, 0, 0.0997},
      {-QUARTER, 0, 0, 0.0996}},
     0.15,
     HALF_TURN,
     0.075,
     0.05},
    {"piper",
     {{-150 * DEGREE, 150 * DEGREE, 3, 5},
      {0, 180 * DEGREE, 3, 5},
      {-170 * DEGREE, 0, 3, 5},
      {-100 * DEGREE, 100 * DEGREE, 3, 5},
      {-70 * DEGREE, 70 * DEGREE, 3, 5},
      {-120 * DEGREE, 120 * DEGREE, 3, 5}},
     {{0, 0, 0, 0.123},
      {-QUARTER, 0, -172.22 * DEGREE, 0},
      {0, 0.28503, -102.78 * DEGREE, 0},
      {QUARTER, -0.02198, 0, 0.25075},
      {-QUARTER, 0, 0, 0},
      {QUARTER, 0, 0, 0.091}},
     0.135,
     0,
     0.05,
     0.05},
};

static const arm_data *find_arm(const char *name) {
    size_t i;
    for (i = 0; i < sizeof arms_known / sizeof arms_known[0]; ++i) {
        if (strcmp(arms_known[i].name, name) == 0) return &arms_known[i];
    }
    print_error("the judge knows no arm '%s'\n", name);
    fail();
    return NULL;
}

const char *judge_fault_name(int fault) {
    static const char *const names[JUDGE_FAULTS] = {"limits", "derivatives", "tool",   "clearance",
                                                    "pause",  "lanes",       "booking"};
    return names[fault];
}

/* ---- The cell's description ----------------------------------------------------------------- */

/* What follows "name": from `at` on. */
static const char *value_of(const char *at, const char *name) {
    char quoted[40];
    const char *found;
    snprintf(quoted, sizeof quoted, "\"%s\":", name);
    found = strstr(at, quoted);
    if (found == NULL) {
        print_error("the description of the cell has no %s\n", quoted);
        fail();
    }
    return found + strlen(quoted);
}

static double number_of(const char *at, const char *name) {
    return strtod(value_of(at, name), NULL);
}

/* An angle is a number of degrees or a list of two to be added. */
static double angle_of(const char *at, const char *name) {
    const char *value = value_of(at, name);
    char *end;
    double degrees;
    while (*value == ' ') ++value;
    if (*value != '[') return strtod(value, NULL) * DEGREE;
    degrees = strtod(value + 1, &end);
    return (degrees + strtod(end + 1, NULL)) * DEGREE;
}

/* Numbers of a list, lists within it included. */
static int list_of(const char *at, const char *name, double *values, int most) {
    const char *value = value_of(at, name);
    int depth = 0;
    int count = 0;
    for (;;) {
        if (*value == '[') {
            ++depth;
        } else if (*value == ']') {
            if (--depth == 0) return count;
        } else if (*value == '-' || (*value >= '0' && *value <= '9')) {
            char *end;
            assert_true(count < most);
            values[count++] = strtod(value, &end);
            value = end;
            continue;
        }
        ++value;
    }
}

void judge_read_cell(judge_cell *cell, const pkc_cell *from) {
    size_t size = 0;
    char *text;
    const char *at;
    CHECK_FAILS(PKC_E_CAPACITY, NULL, pkc_cell_save(from, NULL, 0, &size));
    text = (char *)malloc(size + 1);
    assert_non_null(text);
    CHECK_OK(pkc_cell_save(from, text, size, &size));
    text[size] = '\0';
    memset(cell, 0, sizeof *cell);
    for (at = text; cell->arms < 2 && (at = strstr(at, "\"model\":")) != NULL; ++cell->arms) {
        const int i = cell->arms;
        const char *name = value_of(at, "model");
        size_t n = 0;
        while (*name == ' ' || *name == '"') ++name;
        while (n + 1 < sizeof cell->model[i] && name[n] != '"') ++n;
        memcpy(cell->model[i], name, n);
        at = value_of(at, "base");
        cell->base[i][0] = number_of(at, "x");
        cell->base[i][1] = number_of(at, "y");
        cell->base[i][2] = number_of(at, "z");
        cell->base[i][3] = angle_of(at, "yaw_deg");
        cell->slots[i] = list_of(at, "buffer", &cell->buffer[i][0][0], 2 * JUDGE_MAX_SLOTS) / 2;
    }
    at = value_of(text, "belt");
    assert_int_equal(list_of(at, "centre", cell->belt, 2), 2);
    cell->belt_yaw = angle_of(at, "direction_deg");
    cell->pitch = number_of(at, "pitch");
    at = value_of(text, "bin");
    assert_int_equal(list_of(at, "centre", cell->bin, 2), 2);
    cell->bin_w = number_of(at, "w_mm") / 1000;
    cell->bin_h = number_of(at, "h_mm") / 1000;
    cell->bin_margin = number_of(at, "margin_mm") / 1000;
    cell->side = number_of(at, "cell_mm") / 1000;
    cell->gap = number_of(at, "gap");
    cell->w = (int)floor((cell->bin_w - 2 * cell->bin_margin) / cell->side + 1e-9);
    cell->h = (int)floor((cell->bin_h - 2 * cell->bin_margin) / cell->side + 1e-9);
    cell->work_height = number_of(text, "work_height");
    cell->margin = number_of(value_of(text, "tool_speed"), "margin");
    free(text);
}

/* ---- Kinematics ----------------------------------------------------------------------------- */

typedef struct frame {
    double x[3], y[3], z[3], o[3]; /* axes and origin */
} frame;

static void turn_pair(double *a, double *b, double angle) {
    const double c = cos(angle);
    const double s = sin(angle);
    int i;
    for (i = 0; i < 3; ++i) {
        const double was = a[i];
        a[i] = c * was + s * b[i];
        b[i] = c * b[i] - s * was;
    }
}

static void move_along(frame *f, const double axis[3], double by) {
    int i;
    for (i = 0; i < 3; ++i) f->o[i] += by * axis[i];
}

/* The tool's frame, and where the joints are seen from above. */
static frame tool_frame(const arm_data *arm, const double base[4], const double q[6],
                        double joints[6][2]) {
    frame f = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 0}};
    int i;
    memcpy(f.o, base, sizeof f.o);
    turn_pair(f.x, f.y, base[3]);
    for (i = 0; i < 6; ++i) {
        const link *l = &arm->links[i];
        if (l->alpha != 0) turn_pair(f.y, f.z, l->alpha);
        move_along(&f, f.x, l->a);
        turn_pair(f.x, f.y, l->offset + q[i]);
        move_along(&f, f.z, l->d);
        joints[i][0] = f.o[0];
        joints[i][1] = f.o[1];
    }
    move_along(&f, f.z, arm->tip);
    return f;
}

/* ---- Footprints ----------------------------------------------------------------------------- */

typedef double point[2];

/* Links from point to point, and a disc at the last one, the tool. */
typedef struct shape {
    point at[6];
    int count;
    double body, disc;
} shape;

static double length(double x, double y) { return sqrt(x * x + y * y); }

static double to_segment(const point p, const point a, const point b) {
    const double x = b[0] - a[0];
    const double y = b[1] - a[1];
    const double square = x * x + y * y;
    double s = square > 0 ? ((p[0] - a[0]) * x + (p[1] - a[1]) * y) / square : 0;
    if (s < 0) s = 0;
    if (s > 1) s = 1;
    return length(p[0] - a[0] - s * x, p[1] - a[1] - s * y);
}

static double side_of(const point p, const point a, const point b) {
    return (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]);
}

static double least_of(double a, double b) { return a < b ? a : b; }

static double between_segments(const point a, const point b, const point c, const point d) {
    if (side_of(a, c, d) * side_of(b, c, d) < 0 && side_of(c, a, b) * side_of(d, a, b) < 0)
        return 0;
    return least_of(least_of(to_segment(a, c, d), to_segment(b, c, d)),
                    least_of(to_segment(c, a, b), to_segment(d, a, b)));
}

static double to_shape(const point p, const shape *s) {
    double least = 1e9;
    int i;
    for (i = 0; i + 1 < s->count; ++i)
        least = least_of(least, to_segment(p, s->at[i], s->at[i + 1]));
    return least;
}

static double between_shapes(const shape *a, const shape *b) {
    const double *ta = a->at[a->count - 1];
    const double *tb = b->at[b->count - 1];
    double least = length(ta[0] - tb[0], ta[1] - tb[1]) - a->disc - b->disc;
    int i;
    int j;
    least = least_of(least, to_shape(ta, b) - a->disc - b->body);
    least = least_of(least, to_shape(tb, a) - b->disc - a->body);
    for (i = 0; i + 1 < a->count; ++i) {
        for (j = 0; j + 1 < b->count; ++j) {
            least =
                least_of(least, between_segments(a->at[i], a->at[i + 1], b->at[j], b->at[j + 1]) -
                                    a->body - b->body);
        }
    }
    return least;
}

static void put_point(shape *s, double x, double y) {
    s->at[s->count][0] = x;
    s->at[s->count][1] = y;
    ++s->count;
}

/* What is kept clear for an arm: along its ray as far as the tool is out, and from there to the
 * tool. */
static shape footprint_of(const arm_data *arm, const double base[4], const pkc_arm_sample *s,
                          const frame *tool) {
    const double pan = base[3] + arm->pan + s->position[0];
    const double rx = cos(pan);
    const double ry = sin(pan);
    const double reach = (tool->o[0] - base[0]) * rx + (tool->o[1] - base[1]) * ry;
    shape f;
    memset(&f, 0, sizeof f);
    f.body = arm->body;
    f.disc = s->held > arm->disc ? s->held : arm->disc;
    put_point(&f, base[0], base[1]);
    put_point(&f, base[0] + reach * rx, base[1] + reach * ry);
    put_point(&f, tool->o[0], tool->o[1]);
    return f;
}

/* The links themselves, seen from above: base, elbow, and the joints of the wrist. */
static shape chain_of(const shape *footprint, double joints[6][2]) {
    shape f = *footprint;
    int i;
    f.count = 1;
    for (i = 2; i < 6; ++i) put_point(&f, joints[i][0], joints[i][1]);
    return f;
}

/* ---- What the steps ask for ----------------------------------------------------------------- */

typedef enum spot { ON_BELT, IN_BIN, IN_BUFFER } spot;

/* A grip or a release, asked for or seen. */
typedef struct handover {
    int grip;
    int32_t item;
    int step;
    spot where;
    double at[2];          /* of the bin: the item's centre */
    int x, y, w, h;        /* of the bin: its cells */
    double down, up, done; /* seen: when the arm goes down, is up again, and has gripped */
} handover;

typedef struct lane {
    handover asked[MAX_EVENTS / 4];
    int asked_count;
    handover seen[MAX_EVENTS / 4];
    int seen_count;
} lane;

typedef struct judge {
    const judge_cell *cell;
    const judge_episode *episode;
    int robots;
    judge_report *report;
    const arm_data *data[2];
    lane lanes[2];
} judge;

static void blame(judge *j, int fault, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
static void blame(judge *j, int fault, const char *format, ...) {
    if (j->report->faults[fault]++ == 0) {
        va_list list;
        va_start(list, format);
        vsnprintf(j->report->first[fault], sizeof j->report->first[fault], format, list);
        va_end(list);
    }
}

static const pkc_item *item_of(const judge *j, int32_t id) {
    size_t i;
    for (i = 0; i < j->episode->item_count; ++i) {
        if (j->episode->items[i].id == id) return &j->episode->items[i];
    }
    return NULL;
}

static double half_diagonal(const judge *j, int32_t id) {
    const pkc_item *item = item_of(j, id);
    if (item == NULL) return -1;
    return length(item->w * j->cell->side - j->cell->gap, item->h * j->cell->side - j->cell->gap) /
           2;
}

static handover in_bin(const judge *j, int step, int grip, int32_t id, int x, int y, int rot) {
    const pkc_item *item = item_of(j, id);
    const judge_cell *cell = j->cell;
    handover h;
    memset(&h, 0, sizeof h);
    assert_non_null(item);
    h.grip = grip;
    h.item = id;
    h.step = step;
    h.where = IN_BIN;
    h.x = x;
    h.y = y;
    h.w = rot ? item->h : item->w;
    h.h = rot ? item->w : item->h;
    h.at[0] = cell->bin[0] - cell->bin_w / 2 + cell->bin_margin + (x + h.w / 2.0) * cell->side;
    h.at[1] = cell->bin[1] + cell->bin_h / 2 - cell->bin_margin - (y + h.h / 2.0) * cell->side;
    return h;
}

static void ask(judge *j, int arm, handover h) {
    lane *l = &j->lanes[arm];
    assert_true(l->asked_count < MAX_EVENTS / 4);
    l->asked[l->asked_count++] = h;
}

typedef struct known {
    spot where;
    int x, y, rot;
} known;

/* Each step's actions as grips and releases: an item that its arm packs next after unpacking it
 * stays in the gripper. */
static void ask_all(judge *j) {
    known where[1024];
    int s;
    memset(where, 0, sizeof where);
    for (s = 0; s < j->episode->step_count; ++s) {
        const judge_step *step = &j->episode->steps[s];
        int32_t in_hand[2] = {-1, -1};
        size_t i;
        for (i = 0; i < step->count; ++i) {
            const pkc_action *a = &step->actions[i];
            known *at;
            handover h;
            if (a->op != PKC_OP_PACK && a->op != PKC_OP_UNPACK) continue;
            assert_in_range(a->item, 0, 1023);
            at = &where[a->item];
            memset(&h, 0, sizeof h);
            h.item = a->item;
            h.step = s;
            if (a->op == PKC_OP_UNPACK) {
                size_t next = i + 1;
                while (next < step->count && (step->actions[next].arm != a->arm ||
                                              (step->actions[next].op != PKC_OP_PACK &&
                                               step->actions[next].op != PKC_OP_UNPACK)))
                    ++next;
                ask(j, a->arm, in_bin(j, s, 1, a->item, at->x, at->y, at->rot));
                if (next < step->count && step->actions[next].op == PKC_OP_PACK &&
                    step->actions[next].item == a->item) {
                    in_hand[a->arm] = a->item;
                } else {
                    h.where = IN_BUFFER;
                    ask(j, a->arm, h);
                    at->where = IN_BUFFER;
                }
                continue;
            }
            if (in_hand[a->arm] != a->item) {
                h.grip = 1;
                h.where = at->where;
                ask(j, a->arm, h);
            }
            in_hand[a->arm] = -1;
            ask(j, a->arm, in_bin(j, s, 0, a->item, a->x, a->y, a->rot));
            at->where = IN_BIN;
            at->x = a->x;
            at->y = a->y;
            at->rot = a->rot;
        }
    }
}

/* ---- Bookkeeping of what was seen ----------------------------------------------------------- */

static const char *spot_name(spot s) {
    static const char *const names[] = {"the belt", "the bin", "the buffer"};
    return names[s];
}

static int slot_at(const judge *j, int arm, const double at[2]) {
    int i;
    for (i = 0; i < j->cell->slots[arm]; ++i) {
        if (length(at[0] - j->cell->buffer[arm][i][0], at[1] - j->cell->buffer[arm][i][1]) <
            SAME_PLACE)
            return i;
    }
    return -1;
}

/* Whether the tool is where the work asks it to be. */
static int right_place(const judge *j, int arm, const handover *asked, const double at[2]) {
    const judge_cell *c = j->cell;
    if (asked->where == IN_BIN)
        return length(at[0] - asked->at[0], at[1] - asked->at[1]) < SAME_PLACE;
    if (asked->where == IN_BUFFER) return slot_at(j, arm, at) >= 0;
    {
        /* Zones lie in one line, whole or half pitches from its middle. */
        const double along =
            (at[0] - c->belt[0]) * cos(c->belt_yaw) + (at[1] - c->belt[1]) * sin(c->belt_yaw);
        const double beside =
            (at[1] - c->belt[1]) * cos(c->belt_yaw) - (at[0] - c->belt[0]) * sin(c->belt_yaw);
        const double halves = 2 * along / c->pitch;
        return fabs(beside) < SAME_PLACE && fabs(halves - floor(halves + 0.5)) < 1e-5;
    }
}

static void compare_lanes(judge *j) {
    int arm;
    for (arm = 0; arm < j->robots; ++arm) {
        const lane *l = &j->lanes[arm];
        int i;
        if (l->asked_count != l->seen_count) {
            blame(j, JUDGE_BOOKING, "arm %d: %d grips and releases, should be %d", arm,
                  l->seen_count, l->asked_count);
        }
        for (i = 0; i < l->asked_count && i < l->seen_count; ++i) {
            const handover *a = &l->asked[i];
            const handover *s = &l->seen[i];
            if (s->grip != (i % 2 == 0)) {
                blame(j, JUDGE_BOOKING, "arm %d: %s at %.3f s twice in a row", arm,
                      s->grip ? "grips" : "releases", s->done);
            }
            if (s->grip != a->grip || s->item != a->item || s->step != a->step) {
                blame(j, JUDGE_BOOKING,
                      "arm %d: %s item %d of step %d at %.3f s, should %s item %d of step %d", arm,
                      s->grip ? "grips" : "releases", (int)s->item, s->step, s->done,
                      a->grip ? "grip" : "release", (int)a->item, a->step);
            } else if (!right_place(j, arm, a, s->at)) {
                blame(j, JUDGE_BOOKING,
                      "arm %d: item %d at %.3f s: (%.6f, %.6f) is not its place in %s", arm,
                      (int)s->item, s->done, s->at[0], s->at[1], spot_name(a->where));
            }
        }
    }
}

/* A place is taken from when the arm goes down with the item until the one that fetched it is up
 * again. */
typedef struct event {
    double time;
    int takes; /* 0: frees */
    int arm;
    const handover *asked;
    const handover *seen;
} event;

static int by_time(const void *a, const void *b) {
    const event *const l = (const event *)a;
    const event *const r = (const event *)b;
    if (l->time != r->time) return l->time < r->time ? -1 : 1;
    return l->takes - r->takes;
}

static void replay(judge *j) {
    static event events[MAX_EVENTS];
    int32_t grid[PKC_MAX_SIDE][PKC_MAX_SIDE];
    int32_t slots[2][JUDGE_MAX_SLOTS];
    int count = 0;
    int arm;
    int i;
    int x;
    int y;
    for (y = 0; y < PKC_MAX_SIDE; ++y)
        for (x = 0; x < PKC_MAX_SIDE; ++x) grid[y][x] = PKC_CELL_FREE;
    for (arm = 0; arm < 2; ++arm)
        for (i = 0; i < JUDGE_MAX_SLOTS; ++i) slots[arm][i] = -1;
    for (arm = 0; arm < j->robots; ++arm) {
        const lane *l = &j->lanes[arm];
        for (i = 0; i < l->asked_count && i < l->seen_count; ++i) {
            event *e = &events[count++];
            assert_true(count < MAX_EVENTS);
            e->takes = !l->asked[i].grip;
            e->time = e->takes ? l->seen[i].down : l->seen[i].up;
            e->arm = arm;
            e->asked = &l->asked[i];
            e->seen = &l->seen[i];
        }
    }
    qsort(events, (size_t)count, sizeof events[0], by_time);
    for (i = 0; i < count; ++i) {
        const event *e = &events[i];
        const handover *h = e->asked;
        const int32_t was = e->takes ? -1 : h->item;
        const int32_t becomes = e->takes ? h->item : -1;
        if (h->where == IN_BIN) {
            for (y = h->y; y < h->y + h->h; ++y) {
                for (x = h->x; x < h->x + h->w; ++x) {
                    if (x < 0 || y < 0 || x >= j->cell->w || y >= j->cell->h || grid[y][x] != was) {
                        blame(j, JUDGE_BOOKING, "arm %d, %.3f s, item %d: cell (%d, %d) holds %d",
                              e->arm, e->time, (int)h->item, x, y, (int)grid[y][x]);
                    }
                    grid[y][x] = becomes;
                }
            }
        } else if (h->where == IN_BUFFER) {
            const int slot = slot_at(j, e->arm, e->seen->at);
            if (slot < 0) continue; /* told already */
            if (slots[e->arm][slot] != was) {
                blame(j, JUDGE_BOOKING, "arm %d, %.3f s, item %d: slot %d holds %d", e->arm,
                      e->time, (int)h->item, slot, (int)slots[e->arm][slot]);
            }
            slots[e->arm][slot] = becomes;
        }
    }
    for (y = 0; y < j->cell->h; ++y) {
        for (x = 0; x < j->cell->w; ++x) {
            const int32_t wanted = j->episode->cells[y * j->cell->w + x];
            if (grid[y][x] != wanted) {
                blame(j, JUDGE_BOOKING, "at the end cell (%d, %d) holds %d, should hold %d", x, y,
                      (int)grid[y][x], (int)wanted);
            }
        }
    }
}

/* ---- One arm from millisecond to millisecond ------------------------------------------------ */

typedef struct watch {
    pkc_arm_sample last;
    double last_time;
    double spent[PKC_ACTIVITY_WAIT + 1];
    int changes;
    double down; /* when the arm last began to go down */
    double held; /* half the diagonal of what the gripper holds */
    shape footprint;
    shape chain;
} watch;

static int is_dwell(int32_t activity) {
    return activity >= PKC_ACTIVITY_LOWER && activity <= PKC_ACTIVITY_LIFT;
}

static void judge_joints(judge *j, int arm, double t, const pkc_arm_sample *s) {
    int i;
    for (i = 0; i < 6; ++i) {
        const limit *l = &j->data[arm]->limits[i];
        if (!(s->position[i] >= l->least - 1e-9 && s->position[i] <= l->most + 1e-9) ||
            !(fabs(s->velocity[i]) <= l->velocity * (1 + 1e-6)) ||
            !(fabs(s->acceleration[i]) <= l->acceleration * (1 + 1e-6))) {
            blame(j, JUDGE_LIMITS,
                  "arm %d, joint %d, %.3f s: %.6f, %.6f a second, %.6f a second squared", arm,
                  i + 1, t, s->position[i], s->velocity[i], s->acceleration[i]);
        }
    }
}

/* Over a period in which the acceleration is smooth, or jumps once: what was there before and after
 * says how far off the mean of both can be. */
static void judge_change(judge *j, int arm, double t, const watch *w, const pkc_arm_sample *s) {
    const double dt = t - w->last_time;
    int i;
    if (dt <= 0) return;
    for (i = 0; i < 6; ++i) {
        const limit *l = &j->data[arm]->limits[i];
        const double dq = s->position[i] - w->last.position[i];
        const double dv = s->velocity[i] - w->last.velocity[i];
        const double mean_v = (s->velocity[i] + w->last.velocity[i]) / 2;
        const double mean_a = (s->acceleration[i] + w->last.acceleration[i]) / 2;
        const double jump = fabs(s->acceleration[i] - w->last.acceleration[i]);
        if (fabs(dq) > l->velocity * dt * (1 + 1e-6) + 1e-9 ||
            fabs(dv) > l->acceleration * dt * (1 + 1e-6) + 1e-9) {
            blame(j, JUDGE_LIMITS,
                  "arm %d, joint %d, %.3f s: moves by %g and speeds up by %g in %g s", arm, i + 1,
                  t, dq, dv, dt);
        }
        if (fabs(dq - mean_v * dt) > (jump / 4 + 0.1) * dt * dt + 1e-11 ||
            fabs(dv - mean_a * dt) > jump / 2 * dt * (1 + 1e-6) + 200 * dt * dt) {
            blame(j, JUDGE_DERIVATIVES,
                  "arm %d, joint %d, %.3f s: moves by %.9f at a speed of %.9f, which changes by "
                  "%.9f at an "
                  "acceleration of %.9f",
                  arm, i + 1, t, dq / dt, mean_v, dv / dt, mean_a);
        }
    }
}

static void judge_tool(judge *j, int arm, double t, const pkc_arm_sample *s, watch *w) {
    const double *base = j->cell->base[arm];
    double joints[6][2];
    const frame f = tool_frame(j->data[arm], base, s->position, joints);
    const double yaw = remainder(atan2(f.x[1], f.x[0]) - s->tool[3], TURN);
    int i;
    if (!(fabs(f.o[0] - s->tool[0]) < 1e-6 && fabs(f.o[1] - s->tool[1]) < 1e-6 &&
          fabs(f.o[2] - s->tool[2]) < 1e-6 && fabs(yaw) < 1e-6)) {
        blame(j, JUDGE_TOOL, "arm %d, %.3f s: off by (%g, %g, %g), yaw %g", arm, t,
              f.o[0] - s->tool[0], f.o[1] - s->tool[1], f.o[2] - s->tool[2], yaw);
    }
    if (!(f.z[2] < -1 + 1e-12)) {
        blame(j, JUDGE_TOOL, "arm %d, %.3f s: the tool leans, its axis falls by %.12f", arm, t,
              -f.z[2]);
    }
    w->footprint = footprint_of(j->data[arm], base, s, &f);
    w->chain = chain_of(&w->footprint, joints);
    for (i = 0; i < 6; ++i) {
        const double out = to_shape(joints[i], &w->footprint) - j->data[arm]->body;
        if (out > j->report->outside) j->report->outside = out;
    }
}

static void judge_rest(judge *j, int arm, double t, const pkc_arm_sample *s, const watch *w) {
    const int same = w->last_time < t && s->activity == w->last.activity &&
                     s->item == w->last.item && s->reason == w->last.reason &&
                     s->step == w->last.step;
    int i;
    if (s->activity == PKC_ACTIVITY_TRAVEL || s->activity == PKC_ACTIVITY_LOWER ||
        s->activity == PKC_ACTIVITY_LIFT)
        return;
    for (i = 0; i < 6; ++i) {
        if (s->velocity[i] != 0 || s->acceleration[i] != 0 ||
            (same && fabs(s->position[i] - w->last.position[i]) > 1e-12)) {
            blame(j, JUDGE_PAUSE, "arm %d, joint %d, %.3f s: moves at %g in activity %d", arm,
                  i + 1, t, s->velocity[i], (int)s->activity);
        }
    }
    if (s->activity != PKC_ACTIVITY_WAIT && fabs(s->tool[2] - j->cell->work_height) > 1e-9) {
        blame(j, JUDGE_PAUSE, "arm %d, %.3f s: grips or releases at a height of %.6f", arm, t,
              s->tool[2]);
    }
}

/* An activity begins. */
static void judge_turn(judge *j, int arm, double t, const pkc_arm_sample *s, watch *w) {
    const pkc_arm_sample *last = &w->last;
    lane *l = &j->lanes[arm];
    ++w->changes;
    if (last->activity == PKC_ACTIVITY_GRIP || last->activity == PKC_ACTIVITY_RELEASE) {
        handover *h = &l->seen[l->seen_count];
        if (l->seen_count + 1 >= MAX_EVENTS / 4) return;
        ++l->seen_count;
        memset(h, 0, sizeof *h);
        h->grip = last->activity == PKC_ACTIVITY_GRIP;
        h->item = last->item;
        h->step = last->step;
        h->at[0] = last->tool[0];
        h->at[1] = last->tool[1];
        h->down = w->down;
        h->done = t;
        w->held = h->grip ? half_diagonal(j, h->item) : 0;
        if (s->activity != PKC_ACTIVITY_LIFT) {
            blame(j, JUDGE_BOOKING, "arm %d, %.3f s: does not go up after grip or release", arm, t);
        }
    }
    if (last->activity == PKC_ACTIVITY_LIFT && l->seen_count > 0) l->seen[l->seen_count - 1].up = t;
    if (s->activity == PKC_ACTIVITY_LOWER) w->down = t;
    if ((s->activity == PKC_ACTIVITY_GRIP || s->activity == PKC_ACTIVITY_RELEASE) &&
        last->activity != PKC_ACTIVITY_LOWER) {
        blame(j, JUDGE_BOOKING, "arm %d, %.3f s: grips or releases without going down", arm, t);
    }
}

static void judge_held(judge *j, int arm, double t, const pkc_arm_sample *s, const watch *w) {
    const int hands_over = s->activity == PKC_ACTIVITY_GRIP || s->activity == PKC_ACTIVITY_RELEASE;
    const double wanted = hands_over ? half_diagonal(j, s->item) : w->held;
    if (fabs(s->held - wanted) > 1e-9) {
        blame(j, JUDGE_BOOKING, "arm %d, %.3f s: holds %.6f m, should hold %.6f m", arm, t, s->held,
              wanted);
    }
}

static void judge_times(judge *j, int arm, const pkc_schedule_info *info, const watch *w) {
    const pkc_arm_times *times = &info->arms[arm];
    const double slack = PERIOD * (w->changes + 2);
    double waits = 0;
    double sum;
    int i;
    for (i = 0; i < PKC_WAIT_COUNT; ++i) waits += times->waits[i];
    sum = times->travel + times->strokes + times->grips + waits;
    if (times->waits[0] != 0) {
        blame(j, JUDGE_LANES, "arm %d: waits %.6f s for no reason", arm, times->waits[0]);
    }
    if (fabs(sum - info->makespan) > 1e-6) {
        blame(j, JUDGE_LANES, "arm %d: its times add up to %.6f s, the makespan is %.6f s", arm,
              sum, info->makespan);
    }
    if (fabs(w->spent[PKC_ACTIVITY_TRAVEL] - times->travel) > slack ||
        fabs(w->spent[PKC_ACTIVITY_LOWER] + w->spent[PKC_ACTIVITY_LIFT] - times->strokes) > slack ||
        fabs(w->spent[PKC_ACTIVITY_GRIP] + w->spent[PKC_ACTIVITY_RELEASE] - times->grips) > slack ||
        fabs(w->spent[PKC_ACTIVITY_WAIT] - waits) > slack) {
        blame(j, JUDGE_LANES,
              "arm %d: what is seen is %.3f s travel, %.3f s strokes, %.3f s grips, %.3f s "
              "waits, told are %.3f, %.3f, %.3f and %.3f",
              arm, w->spent[PKC_ACTIVITY_TRAVEL],
              w->spent[PKC_ACTIVITY_LOWER] + w->spent[PKC_ACTIVITY_LIFT],
              w->spent[PKC_ACTIVITY_GRIP] + w->spent[PKC_ACTIVITY_RELEASE],
              w->spent[PKC_ACTIVITY_WAIT], times->travel, times->strokes, times->grips, waits);
    }
}

static void judge_sample(judge *j, int arm, double t, const pkc_arm_sample *s, watch *w,
                         int first) {
    ++j->report->samples;
    if (s->activity < PKC_ACTIVITY_TRAVEL || s->activity > PKC_ACTIVITY_WAIT ||
        (s->activity == PKC_ACTIVITY_WAIT) != (s->reason != 0)) {
        blame(j, JUDGE_LANES, "arm %d, %.3f s: activity %d with reason %d", arm, t,
              (int)s->activity, (int)s->reason);
        return;
    }
    judge_joints(j, arm, t, s);
    judge_tool(j, arm, t, s, w);
    if (first) {
        w->last_time = t;
        w->last = *s;
    }
    if (s->activity != w->last.activity) judge_turn(j, arm, t, s, w);
    judge_change(j, arm, t, w, s);
    judge_rest(j, arm, t, s, w);
    judge_held(j, arm, t, s, w);
    w->spent[w->last.activity] += t - w->last_time;
    w->last = *s;
    w->last_time = t;
}

static void judge_both(judge *j, double t, const watch *w) {
    const double apart = between_shapes(&w[0].footprint, &w[1].footprint);
    const double links = between_shapes(&w[0].chain, &w[1].chain);
    if (links < j->report->least_between_links) j->report->least_between_links = links;
    if (apart < j->report->least_clearance) j->report->least_clearance = apart;
    if (!(apart >= j->cell->margin - 1e-9)) {
        blame(j, JUDGE_CLEARANCE, "%.3f s: the arms are %.6f m apart, the margin is %.6f m", t,
              apart, j->cell->margin);
    }
    if (is_dwell(w[0].last.activity) && is_dwell(w[1].last.activity) &&
        length(w[0].last.tool[0] - w[1].last.tool[0], w[0].last.tool[1] - w[1].last.tool[1]) <
            1e-3) {
        blame(j, JUDGE_BOOKING, "%.3f s: both arms are at (%.3f, %.3f)", t, w[0].last.tool[0],
              w[0].last.tool[1]);
    }
}

void judge_schedule(const judge_cell *cell, int robots, const judge_episode *episode,
                    const pkc_schedule *schedule, judge_sampler *sampler, judge_report *report) {
    judge *j = (judge *)calloc(1, sizeof *j);
    pkc_schedule_info info;
    watch w[2];
    long k;
    int arm;
    int done = 0;
    assert_non_null(j);
    memset(report, 0, sizeof *report);
    memset(w, 0, sizeof w);
    report->least_clearance = 1e9;
    report->least_between_links = 1e9;
    j->cell = cell;
    j->episode = episode;
    j->robots = robots;
    j->report = report;
    for (arm = 0; arm < robots; ++arm) j->data[arm] = find_arm(cell->model[arm]);
    CHECK_OK(pkc_schedule_info_init(&info, sizeof info));
    CHECK_OK(pkc_schedule_get_info(schedule, &info));
    ask_all(j);
    for (k = 0; !done; ++k) {
        double t = (double)k * PERIOD;
        if (t >= info.makespan) {
            t = info.makespan;
            done = 1;
        }
        for (arm = 0; arm < robots; ++arm) {
            pkc_arm_sample s;
            if (sampler(schedule, arm, t, &s) != PKC_OK) {
                blame(j, JUDGE_LANES, "arm %d, %.3f s: %s", arm, t, pkc_last_error());
                continue;
            }
            judge_sample(j, arm, t, &s, &w[arm], k == 0);
        }
        if (robots == 2) judge_both(j, t, w);
    }
    for (arm = 0; arm < robots; ++arm) {
        judge_times(j, arm, &info, &w[arm]);
        if (w[arm].last.held != 0) blame(j, JUDGE_BOOKING, "arm %d ends with an item", arm);
        if (j->lanes[arm].seen_count > 0 && is_dwell(w[arm].last.activity)) {
            j->lanes[arm].seen[j->lanes[arm].seen_count - 1].up = info.makespan;
        }
    }
    if (robots == 2 && info.min_clearance + 1e-9 < report->least_clearance) {
        blame(j, JUDGE_CLEARANCE, "told is a least clearance of %.6f m, seen are %.6f m",
              info.min_clearance, report->least_clearance);
    }
    compare_lanes(j);
    replay(j);
    free(j);
}
