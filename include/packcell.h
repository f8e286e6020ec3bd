/* packcell: plans a robotic bin-packing cell.
 *
 * Rectangular items arrive on a conveyor; one or two arms pack them into a bin and may unpack and
 * repack what is already there. The terms and the algorithms are those of "A Hierarchical Bin
 * Packing Framework with Dual Manipulators via Heuristic Search and Deep Reinforcement Learning"
 * (Lee and Nam), called "the paper" below.
 *
 * Conventions, for every function:
 *  - It returns a pkc_status, unless it frees or gives a name. PKC_OK is 0; a failing call leaves
 *    every out-parameter untouched (but see arrays, below), and pkc_last_error() says which value
 *    was wrong and what is allowed.
 *  - NULL, where the comment does not allow it, and a value outside its range are PKC_E_ARGUMENT;
 *    PKC_E_MEMORY may come from all calls but those that are said to take none. The comment names
 *    the other errors, except PKC_E_BUSY, PKC_E_STRUCT and PKC_E_CAPACITY, of which more below.
 *  - Lengths are in bin cells: x to the right, y down, origin at the top-left cell, cell index
 *    x + y * W. Items are w x h cells; `rot` 1 turns an item by a quarter, which swaps w and h.
 *  - Whoever gets a handle through a pkc_x ** owns it and gives it back to pkc_x_free, which takes
 *    NULL too. A `_clone` is a copy of its own. A handle belongs to one thread at a time: a second
 *    thread gets PKC_E_BUSY. A pkc_policy, pkc_cell and pkc_simulation do not change and may be
 *    shared by threads.
 *  - A handle keeps alive what it needs; handles may be freed in any order.
 *  - Arrays are the caller's, and so is text, which is copied. A function that fills an array takes
 *    its capacity in elements and stores the number of elements there are; with too small an array
 *    it stores nothing but that number and returns PKC_E_CAPACITY. So NULL with capacity 0 asks for
 *    the number: PKC_E_CAPACITY, or PKC_OK where it is 0.
 *  - Option and info structs begin with struct_size; fill them by their `_init` function first,
 *    which sets the defaults (zeros in nearly every info struct) and gets the sizeof, so that a
 *    program built today runs against a later library. PKC_E_STRUCT: that was left out, or a field
 *    is set that this library does not know.
 *  - Nothing is printed, no file is touched but the one that a `_file` call names, no thread is
 *    started but by pkc_trainer_run, which ends with them; the text of pkc_last_error(), one a
 *    thread, is the only state outside the handles.
 *  - A handle must not be freed while a call uses it.
 *
 * Built by GCC or Clang for 64-bit targets.
 */
#ifndef PACKCELL_H
#define PACKCELL_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#if defined(__GNUC__)
#define PKC_API __attribute__((visibility("default")))
#else
#define PKC_API
#endif

/* ---- Version and errors ---------------------------------------------------------------------- */

#define PKC_VERSION_MAJOR 0
#define PKC_VERSION_MINOR 1
#define PKC_VERSION_PATCH 0

/* Status of a call. The numbers are pinned; new ones are only added. */
typedef int32_t pkc_status;
#define PKC_OK 0
#define PKC_E_ARGUMENT (-1)     /* a pointer is NULL or a value lies outside what is allowed */
#define PKC_E_STRUCT (-2)       /* struct_size or a field beyond it is none this library knows */
#define PKC_E_MEMORY (-3)       /* memory could not be had */
#define PKC_E_BUSY (-4)         /* the handle is in use by another thread */
#define PKC_E_STATE (-5)        /* the call does not fit the handle's state */
#define PKC_E_CAPACITY (-6)     /* the caller's array is too small */
#define PKC_E_LIMIT (-7)        /* more than the limits that the handle was created with */
#define PKC_E_FORMAT (-8)       /* bytes do not hold what they should */
#define PKC_E_IO (-9)           /* a named file could not be read or written */
#define PKC_E_UNSUPPORTED (-10) /* not in this build, or not something this policy does */
#define PKC_E_INTERNAL (-11)    /* a fault of packcell's own; please report it */

/* Version of the linked library: major * 10000 + minor * 100 + patch. */
PKC_API uint32_t pkc_version(void);

/* "PKC_E_ARGUMENT" and the like; "unknown status" for other numbers. Static storage. */
PKC_API const char *pkc_status_name(pkc_status status);

/* One line about this thread's last failing call: the value and what is allowed; "" before the
 * first failure. Valid until the thread's next call into packcell. */
PKC_API const char *pkc_last_error(void);

/* ---- Plain records (frozen: they are elements of arrays and never grow) ---------------------- */

#define PKC_ITEM_NO_ROTATE 1u /* may only be packed with rot 0 */
#define PKC_ITEM_PINNED 2u    /* is never unpacked */

/* An item. `id` is the caller's, >= 0, and unique among what a bin and a queue hold; w and h are
 * 1..128 cells. */
typedef struct pkc_item {
    int32_t id;
    int32_t w;
    int32_t h;
    uint32_t flags; /* PKC_ITEM_* */
} pkc_item;

/* An item in a bin, its top-left corner at (x, y). */
typedef struct pkc_placement {
    pkc_item item;
    int32_t x;
    int32_t y;
    int32_t rot;
} pkc_placement;

/* An item on the conveyor or in a buffer. `arms`: bit 0 and bit 1 say which arms can take it now
 * (0: none yet). `recognized`: 1 when the planner sees its size. */
typedef struct pkc_queued {
    pkc_item item;
    int32_t arms;
    int32_t recognized;
} pkc_queued;

/* What an action does, and the fields that it uses. */
#define PKC_OP_UNPACK 1    /* item, arm: from the bin into the arm's buffer */
#define PKC_OP_PACK 2      /* item, x, y, rot, arm: off the conveyor or the buffer into the bin */
#define PKC_OP_SKIP 3      /* item: taken off the conveyor for good (sets only) */
#define PKC_OP_TERMINATE 4 /* the bin is closed */

#define PKC_MAX_ACTIONS 768 /* no step has more: an array of so many always suffices */

/* A task primitive (paper, Sec. III-A). Fields that an operation does not use are 0. */
typedef struct pkc_action {
    int32_t op;
    int32_t item;
    int32_t x;
    int32_t y;
    int32_t rot;
    int32_t arm;
} pkc_action;

/* FNV-1a 64 over op, item, x, y, rot, arm of each action as little-endian int32: equal plans have
 * equal hashes on every machine. Any values; NULL if `count` is 0. */
PKC_API pkc_status pkc_plan_hash(const pkc_action *actions, size_t count, uint64_t *out_hash);

/* ---- Bin ------------------------------------------------------------------------------------- */

#define PKC_MAX_SIDE 128 /* cells of a bin's or an item's side */

/* A bin and the items in it. For all that follow x and y are 0..127, w and h 1..128 cells; a
 * rectangle within these ranges that does not lie on free cells of the bin alone is PKC_E_STATE. */
typedef struct pkc_bin pkc_bin;

typedef struct pkc_bin_info {
    uint32_t struct_size;
    int32_t w, h;           /* cells */
    int32_t items;          /* items packed */
    int32_t occupied_cells; /* fixed cells and items */
    int32_t fixed_cells;    /* cells taken by pkc_bin_block */
    uint64_t hash;          /* of the occupied cells; equal occupancy, equal hash */
} pkc_bin_info;
PKC_API pkc_status pkc_bin_info_init(pkc_bin_info *info, size_t size);

/* An empty bin of w x h cells. Free with pkc_bin_free. */
PKC_API pkc_status pkc_bin_create(int32_t w, int32_t h, pkc_bin **out_bin);
PKC_API void pkc_bin_free(pkc_bin *bin);
PKC_API pkc_status pkc_bin_clone(const pkc_bin *bin, pkc_bin **out_bin);

/* Removes every item; fixed cells stay. */
PKC_API pkc_status pkc_bin_clear(pkc_bin *bin);

/* Marks the free cells of the w x h rectangle at (x, y) as taken from the start, for good. They
 * count in the utilisation. PKC_E_STATE if one is taken already or outside of the bin. */
PKC_API pkc_status pkc_bin_block(pkc_bin *bin, int32_t x, int32_t y, int32_t w, int32_t h);

/* Puts an item at (x, y), paper eq. (1). PKC_E_STATE if it does not lie on free cells alone, its id
 * is in the bin already, or it is turned and must not be. Any position is allowed; the policies
 * choose good ones. */
PKC_API pkc_status pkc_bin_pack(pkc_bin *bin, const pkc_item *item, int32_t x, int32_t y,
                                int32_t rot);

/* Takes an item out (paper, Sec. III-A); `out_placement` (may be NULL) gets where it was.
 * PKC_E_STATE if it is not in the bin or is pinned. */
PKC_API pkc_status pkc_bin_unpack(pkc_bin *bin, int32_t id, pkc_placement *out_placement);

PKC_API pkc_status pkc_bin_get_info(const pkc_bin *bin, pkc_bin_info *info);

/* The packed items in packing order. */
PKC_API pkc_status pkc_bin_items(const pkc_bin *bin, pkc_placement *placements, size_t capacity,
                                 size_t *out_count);

/* W*H cells by index: the id of the item there, PKC_CELL_FREE or PKC_CELL_FIXED. */
#define PKC_CELL_FREE (-1)
#define PKC_CELL_FIXED (-2)
PKC_API pkc_status pkc_bin_cells(const pkc_bin *bin, int32_t *cells, size_t capacity,
                                 size_t *out_count);

/* The feasibility mask b of the paper (Sec. IV-A) for an item that covers w x h cells as it is
 * turned: W*H + 1 bytes, 1 where its top-left corner may lie; the last is "no position", 1 only
 * when no other is. */
PKC_API pkc_status pkc_bin_feasible(const pkc_bin *bin, int32_t w, int32_t h, uint8_t *mask,
                                    size_t capacity, size_t *out_count);

/* The contact reward r_low (paper eq. (3)): occupied cells, walls included, in the four strips
 * around a w x h rectangle at (x, y), 0..2(w+h). PKC_E_STATE if the rectangle is not free. */
PKC_API pkc_status pkc_bin_contact(const pkc_bin *bin, int32_t x, int32_t y, int32_t w, int32_t h,
                                   int32_t *out_reward);

/* ---- Scenario and queue ---------------------------------------------------------------------- */

/* Who sees and reaches what (paper, Sec. V-C). n_max = accessible * robots - overlap * (robots - 1)
 * items are within reach of some arm; 1 <= n_max <= recognized <= 64. */
typedef struct pkc_scenario {
    uint32_t struct_size;
    int32_t robots;     /* 1 or 2 */
    int32_t recognized; /* R: items whose size is known, from the conveyor's head */
    int32_t accessible; /* A: items within one arm's reach */
    int32_t overlap;    /* O: items within both arms' reach, 0..accessible; 0 for one robot */
} pkc_scenario;
PKC_API pkc_status pkc_scenario_init(pkc_scenario *scenario, size_t size); /* S-R1A1 */

/* "S-R5A3" or "D-R5A3O1" and back; `capacity` bytes with the closing zero, 32 are enough; with too
 * few nothing is stored. PKC_E_ARGUMENT for a scenario that cannot be. */
PKC_API pkc_status pkc_scenario_parse(const char *name, pkc_scenario *scenario);
PKC_API pkc_status pkc_scenario_name(const pkc_scenario *scenario, char *name, size_t capacity);

/* The conveyor with its regions (paper, Sec. V-C2, "Conveyor Logic") and one buffer an arm, all
 * without a limit of their own. */
typedef struct pkc_queue pkc_queue;

typedef struct pkc_queue_info {
    uint32_t struct_size;
    int32_t belt;       /* items on the conveyor, recognised or not */
    int32_t buffered;   /* items in the arms' buffers */
    int32_t k_alpha;    /* items only arm 0 (rear, downstream) reaches */
    int32_t k_shared;   /* items both reach, or all accessible ones with one robot */
    int32_t k_beta;     /* items only arm 1 (front) reaches */
    int32_t alpha_left; /* items that stayed in arm 0's region when the conveyor last moved; with
                           the items, all that the regions depend on */
} pkc_queue_info;
PKC_API pkc_status pkc_queue_info_init(pkc_queue_info *info, size_t size);

PKC_API pkc_status pkc_queue_create(const pkc_scenario *scenario, pkc_queue **out_queue);
PKC_API void pkc_queue_free(pkc_queue *queue);
PKC_API pkc_status pkc_queue_clone(const pkc_queue *queue, pkc_queue **out_queue);

/* An item arrives at the conveyor's end. PKC_E_STATE if the queue holds its id already. */
PKC_API pkc_status pkc_queue_push(pkc_queue *queue, const pkc_item *item);

/* An item leaves the conveyor or a buffer without being packed (removed by hand, say); the conveyor
 * advances. PKC_E_STATE if the queue does not hold it. */
PKC_API pkc_status pkc_queue_remove(pkc_queue *queue, int32_t id);

/* Several items, or none, leave so at once, and the conveyor advances as it does after a step. All
 * or nothing; PKC_E_STATE, with the index in pkc_last_error(), if one is not there or named twice.
 */
PKC_API pkc_status pkc_queue_remove_items(pkc_queue *queue, const int32_t *ids, size_t count);

/* An item is put into the buffer of `arm` from without: a queue rebuilt from a message, or an item
 * unpacked outside a planned step. `arm`: 0, or 1 with two robots. PKC_E_STATE if the queue holds
 * its id already. */
PKC_API pkc_status pkc_queue_put_in_buffer(pkc_queue *queue, const pkc_item *item, int32_t arm);

/* Arranges the conveyor's regions anew, as if so many items (0..64) had stayed in arm 0's: for a
 * queue rebuilt from a message, with the alpha_left of its pkc_queue_info. */
PKC_API pkc_status pkc_queue_set_alpha_left(pkc_queue *queue, int32_t alpha_left);

PKC_API pkc_status pkc_queue_get_scenario(const pkc_queue *queue, pkc_scenario *scenario);
PKC_API pkc_status pkc_queue_get_info(const pkc_queue *queue, pkc_queue_info *info);

/* The conveyor's items in arrival order, and the buffered ones in the order they were unpacked. */
PKC_API pkc_status pkc_queue_belt(const pkc_queue *queue, pkc_queued *items, size_t capacity,
                                  size_t *out_count);
PKC_API pkc_status pkc_queue_buffer(const pkc_queue *queue, pkc_queued *items, size_t capacity,
                                    size_t *out_count);

/* Carries out one step's actions on bin and queue, then lets the conveyor advance. All or nothing:
 * PKC_E_STATE, with the action's index in pkc_last_error(), when one breaks a rule (an item out of
 * reach, a second item from the belt by one arm, an overlap, a foreign buffer, ...). TERMINATE is
 * accepted last and changes nothing: the caller then clears or replaces the bin. */
PKC_API pkc_status pkc_step_apply(pkc_bin *bin, pkc_queue *queue, const pkc_action *actions,
                                  size_t count);

/* ---- Snapshots ------------------------------------------------------------------------------- */

/* Bin, conveyor and buffers as bytes, little-endian and the same on every machine, for restarts and
 * stateless workers. `out_size` gets the bytes needed or written. PKC_E_STATE if an id is both in
 * the bin and in the queue. */
PKC_API pkc_status pkc_snapshot_save(const pkc_bin *bin, const pkc_queue *queue, uint8_t *bytes,
                                     size_t capacity, size_t *out_size);

/* Makes a bin and a queue from such bytes, which are copied; PKC_E_FORMAT names the first offset
 * that is wrong. */
PKC_API pkc_status pkc_snapshot_load(const uint8_t *bytes, size_t size, pkc_bin **out_bin,
                                     pkc_queue **out_queue);

/* ---- Millimetres ----------------------------------------------------------------------------- */

/* From a real bin to cells and back. A side has floor((side - 2 * margin) / cell) cells; an item
 * takes ceil((side + clearance) / cell). All in millimetres, finite, up to 1e6. */
typedef struct pkc_grid {
    uint32_t struct_size;
    uint32_t reserved;   /* 0 */
    double bin_w, bin_h; /* inside of the bin */
    double margin;       /* kept free along each wall, >= 0 */
    double cell;         /* side of a cell, > 0 */
    double clearance;    /* kept free between neighbouring items, >= 0 */
} pkc_grid;
/* The paper's: 320 x 260, 10, 30, 0. */
PKC_API pkc_status pkc_grid_init(pkc_grid *grid, size_t size);
PKC_API pkc_status pkc_grid_bin(const pkc_grid *grid, int32_t *out_w, int32_t *out_h);
PKC_API pkc_status pkc_grid_item(const pkc_grid *grid, double w, double h, int32_t *out_w,
                                 int32_t *out_h);

/* Centre in millimetres, from the inside top-left corner of the bin, of a w x h cell rectangle at
 * cell (x, y): an item is put down with its own centre there, which shares slack and clearance
 * evenly. x and y are 0..127, w and h 1..128; whether the bin is so large is not looked at. */
PKC_API pkc_status pkc_grid_centre(const pkc_grid *grid, int32_t x, int32_t y, int32_t w, int32_t h,
                                   double *out_x, double *out_y);

/* ---- Policy ---------------------------------------------------------------------------------- */

/* The low level: where an item goes (paper eq. (5)). Immutable; may be shared by threads. */
typedef struct pkc_policy pkc_policy;

/* By name: "default" (learned weights for the bins that they serve, see pkc_policy_get_info, and
 * "contact" for all others), "contact" (largest contact reward), "bottom-left", "skyline",
 * "shelf-next-fit", "maxrects-cp", "maxrects-bssf". Free with pkc_policy_free. */
PKC_API pkc_status pkc_policy_create(const char *name, pkc_policy **out_policy);
PKC_API void pkc_policy_free(pkc_policy *policy);
/* "" for NULL; lives as long as the policy. */
PKC_API const char *pkc_policy_name(const pkc_policy *policy);

/* Names that pkc_policy_create knows, by index from 0; NULL past the last. Static storage. */
PKC_API const char *pkc_policy_builtin(size_t index);

/* What a policy is made of. Heuristics are not learned: they have no weights. */
#define PKC_ARCH_HEURISTIC 0
#define PKC_ARCH_ACTOR_CRITIC 1        /* the paper's network (Fig. 4), for one bin size */
#define PKC_ARCH_FULLY_CONVOLUTIONAL 2 /* its variant for bins of any size */
#define PKC_ARCH_AFTERSTATE 3          /* tables that give the value of a bin left behind */

#define PKC_MAX_BLOB_BYTES 67108864 /* of a weight blob: 64 MiB */

/* A learned policy from a weight blob (.pkw, docs/blob-format.md), which is copied. PKC_E_FORMAT
 * names the first offset that is wrong: another kind of file, another version, cut short, bytes
 * after the end, a checksum that does not agree, or contents that no policy can have. Free with
 * pkc_policy_free. */
PKC_API pkc_status pkc_policy_load(const void *bytes, size_t size, pkc_policy **out_policy);

/* The same from a file of up to PKC_MAX_BLOB_BYTES, else PKC_E_FORMAT. PKC_E_IO if it cannot be
 * read. */
PKC_API pkc_status pkc_policy_load_file(const char *path, pkc_policy **out_policy);

/* The policy's weight blob; a policy that was loaded gives the bytes it came from. `out_size` gets
 * the bytes needed or written. PKC_E_UNSUPPORTED for a heuristic. */
PKC_API pkc_status pkc_policy_save(const pkc_policy *policy, void *bytes, size_t capacity,
                                   size_t *out_size);

/* The same into a file, all or nothing: it is written as a new file in the same folder, which then
 * takes the place of the named one, or of the link by that name. PKC_E_IO if that fails: what was
 * there before is unchanged. PKC_E_UNSUPPORTED for a heuristic. */
PKC_API pkc_status pkc_policy_save_file(const pkc_policy *policy, const char *path);

/* Where a policy comes from; zeros, and utilization -1, for a heuristic. */
typedef struct pkc_policy_info {
    uint32_t struct_size;
    int32_t architecture; /* PKC_ARCH_* */
    int32_t bin_w, bin_h; /* the bins it was trained for and serves; 0 x 0: any */
    uint64_t parameters;  /* numbers learned */
    uint64_t seed;
    uint64_t steps;     /* items placed while learning */
    double reward_fill; /* share of filled cells in the reward, 0..1; the rest is contact */
    double utilization; /* mean on held-out streams, 0..1; -1: not measured */
    char learner[32];   /* how it learned: "a3c", "td-afterstate"; "" for a heuristic */
} pkc_policy_info;
PKC_API pkc_status pkc_policy_info_init(pkc_policy_info *info, size_t size);
PKC_API pkc_status pkc_policy_get_info(const pkc_policy *policy, pkc_policy_info *info);

/* The position x + y*W for an item that covers w x h cells, each 1..128, as it is turned; W*H is
 * "no position" (paper, eq. (2)). PKC_E_ARGUMENT if the policy was trained for bins of another
 * size. */
PKC_API pkc_status pkc_policy_select(const pkc_policy *policy, const pkc_bin *bin, int32_t w,
                                     int32_t h, int32_t *out_position);

/* What actor and critic say about such an item: W*H + 1 logits and probabilities by position, the
 * last for "no position", infeasible ones with probability 0, and the value of the bin. Each of
 * both arrays, and `out_value`, may be NULL; `capacity` is that of each array, and at least W*H + 1
 * even if both are NULL. w and h are 1..128. PKC_E_UNSUPPORTED if the policy gives positions alone,
 * as heuristics do; PKC_E_ARGUMENT if it was trained for bins of another size. */
PKC_API pkc_status pkc_policy_evaluate(const pkc_policy *policy, const pkc_bin *bin, int32_t w,
                                       int32_t h, float *out_logits, float *out_probabilities,
                                       size_t capacity, size_t *out_count, float *out_value);

/* The same for `count` pairs of a bin and an item, 1..2^20, faster than one by one: for pair i the
 * bin is bins[i] and the item covers sizes[2*i] x sizes[2*i + 1] cells. All bins have the same
 * sides; the same bin may stand in many pairs, best next to each other. Each of the outputs may be
 * NULL: `count` positions as pkc_policy_select gives them, count * (W*H + 1) probabilities, and
 * `count` values. PKC_E_UNSUPPORTED if one of the last two is asked of a heuristic. */
PKC_API pkc_status pkc_policy_evaluate_batch(const pkc_policy *policy, const pkc_bin *const *bins,
                                             const int32_t *sizes, size_t count,
                                             int32_t *out_positions, float *out_probabilities,
                                             float *out_values);

/* ---- Training -------------------------------------------------------------------------------- */

#define PKC_LEARNER_A3C 1        /* the paper's actor-critic (Sec. IV-A), for a network */
#define PKC_LEARNER_AFTERSTATE 2 /* TD(0) of the value of bins left behind, for tables */

#define PKC_ROTATION_OFF 0
#define PKC_ROTATION_ON 1
#define PKC_ROTATION_MIXED 2 /* each bin draws whether its items may be turned */

/* A training: the protocol that is played, the learner and its settings. Equal options give equal
 * trainings on one architecture, also with several workers: they change the shared network in a
 * fixed order. */
typedef struct pkc_trainer_options {
    uint32_t struct_size;
    int32_t learner;      /* PKC_LEARNER_A3C; PKC_LEARNER_AFTERSTATE takes from what follows the
                             protocol (bins of 2..12 a side with (W + 1) * H <= 128, items up to 8),
                             seed and name alone, and one thread for each setting of rotation */
    int32_t architecture; /* PKC_ARCH_ACTOR_CRITIC (bins of 3..32 cells a side) or
                             PKC_ARCH_FULLY_CONVOLUTIONAL */
    int32_t bin_w, bin_h; /* bins that are packed, 1..128 cells each (10 x 10) */
    int32_t least_side;   /* items' sides are uniform on least_side..most_side (1..5), */
    int32_t most_side;    /* at most the bin's shorter side */
    int32_t items;        /* 0 (default): the first item without a position closes the bin and opens
                             the next one; else so many items are offered to a bin, 1..1000000, and
                             those without a position are skipped */
    int32_t rotation;     /* PKC_ROTATION_MIXED */
    int32_t workers;      /* threads, 1..64 (3, as in the paper) */
    int32_t environments; /* bins that a worker packs side by side, 1..1024 (32) */
    int32_t steps;        /* items it places in each between two updates, 1..1024 (8) */
    int32_t channels;     /* of each convolution, 1..64 (16) */
    int32_t features;     /* of the encoded bin, 1..1024 (128) */
    int32_t hidden;       /* units where bin and item are joined, 1..1024 (128) */
    int32_t reserved;     /* 0 */
    uint64_t seed;        /* any (1) */
    uint64_t anneal;      /* over so many updates learning rate and entropy weight fall to a tenth;
                             0 (default): they stay */
    double gamma;         /* discount of later rewards, 0..1 (0.9) */
    double learning_rate; /* of Adam, 1e-9..1 (0.0015) */
    double entropy;       /* weight of the policy's entropy, 0..10 (0.02) */
    double value_weight;  /* weight of the critic's loss, 0..10 (0.5) */
    double clip;          /* largest norm of a gradient, 1e-6..1e6 (1) */
    double reward_fill;   /* share of the bin's utilisation in the reward, 0..1 (0); the rest is the
                             contact reward, paper eq. (3), over 20 */
    char name[32];        /* of the policy, 1..31 of a-z, 0-9, '_', '.', '/', '-' ("a3c") */
} pkc_trainer_options;
PKC_API pkc_status pkc_trainer_options_init(pkc_trainer_options *options, size_t size);

typedef struct pkc_trainer pkc_trainer;

/* A training that has not begun. NULL options are the defaults. Free with pkc_trainer_free. */
PKC_API pkc_status pkc_trainer_create(const pkc_trainer_options *options,
                                      pkc_trainer **out_trainer);
PKC_API void pkc_trainer_free(pkc_trainer *trainer);

/* Trains for so many updates, 0..2^48, of the shared network. Starts as many threads as there are
 * workers, and has joined them when it returns. However the updates are split into calls, the
 * training is the same. PKC_E_STATE if the gradient is not finite any more. */
PKC_API pkc_status pkc_trainer_run(pkc_trainer *trainer, uint64_t updates);

/* From any thread: a pkc_trainer_run that is under way returns within some updates, with PKC_OK.
 * One that begins later is not affected. */
PKC_API pkc_status pkc_trainer_cancel(pkc_trainer *trainer);

/* How far it is, and means over the last pkc_trainer_run (0 before the first, and where no bin
 * closed). */
typedef struct pkc_trainer_info {
    uint32_t struct_size;
    uint32_t reserved;
    uint64_t updates;   /* since the training began */
    uint64_t steps;     /* items placed since then */
    uint64_t bins;      /* bins closed since then */
    double policy_loss; /* mean of -log pi(a) * A */
    double value_loss;  /* mean of (R - V)^2 */
    double entropy;     /* of the policy, in nats */
    double reward;      /* sum over a bin */
    double utilization; /* of the bins closed, 0..1, while the policy explores */
} pkc_trainer_info;
PKC_API pkc_status pkc_trainer_info_init(pkc_trainer_info *info, size_t size);
PKC_API pkc_status pkc_trainer_get_info(const pkc_trainer *trainer, pkc_trainer_info *info);
PKC_API pkc_status pkc_trainer_get_options(const pkc_trainer *trainer,
                                           pkc_trainer_options *options);

/* What has been learned so far, as a policy of its own: training on does not change it. */
PKC_API pkc_status pkc_trainer_policy(const pkc_trainer *trainer, pkc_policy **out_policy);

/* Packs `bins` bins, 1..2^32, of a held-out stream by the policy so far, always its most probable
 * position; the streams of all seeds are apart from those that are trained on. Gives the mean
 * utilisation, 0..1, and half the width of its 95 % interval (`out_half_width` may be NULL).
 * `rotation` is PKC_ROTATION_*. The policies of pkc_trainer_policy tell the last mean as theirs. */
PKC_API pkc_status pkc_trainer_measure(pkc_trainer *trainer, int32_t rotation, uint64_t seed,
                                       uint64_t bins, double *out_mean, double *out_half_width);

/* The same for any policy: bins, items and rotation are those of `options`, which may not be NULL.
 * PKC_E_ARGUMENT if the policy was trained for bins of another size. */
PKC_API pkc_status pkc_policy_measure(const pkc_policy *policy, const pkc_trainer_options *options,
                                      uint64_t seed, uint64_t bins, double *out_mean,
                                      double *out_half_width);

/* The training with all that its next update depends on, all or nothing as in pkc_policy_save_file
 * (PKC_E_IO). A training that was killed and loaded again goes on bit for bit. */
PKC_API pkc_status pkc_trainer_save_file(const pkc_trainer *trainer, const char *path);

/* From a file of up to 1 GiB. PKC_E_IO if it cannot be read, PKC_E_FORMAT with the first offset
 * that is wrong. Free with pkc_trainer_free. */
PKC_API pkc_status pkc_trainer_load_file(const char *path, pkc_trainer **out_trainer);

/* ---- Environment ----------------------------------------------------------------------------- */

/* The low level as a decision process (paper, Sec. III-B), for learners outside of packcell: what
 * pkc_trainer_run plays, many bins side by side. An item comes and goes to one of its feasible
 * positions, then the next one comes; the first that has none closes the bin (or as `items` says)
 * and begins the next one.
 *
 * An action is a number, 0..actions - 1 (pkc_environment_info): the position x + y*W of the item's
 * top-left corner; W*H more for the turned item, unless rotation is PKC_ROTATION_OFF; the last one
 * is "no position", the only one of a closed bin and never allowed in an open one.
 *
 * No call but create, clone and free takes or gives back memory. */
typedef struct pkc_environment pkc_environment;

/* How many bins, and what is played. */
typedef struct pkc_environment_options {
    uint32_t struct_size;
    int32_t count;        /* bins side by side, 1..65536 (1); together at most 2^24 cells */
    int32_t bin_w, bin_h; /* what is played, as in pkc_trainer_options (10 x 10) */
    int32_t least_side;   /* (1) */
    int32_t most_side;    /* (5) */
    int32_t items;        /* (0) */
    int32_t rotation;     /* (PKC_ROTATION_OFF) */
    double reward_fill;   /* (0) */
} pkc_environment_options;
PKC_API pkc_status pkc_environment_options_init(pkc_environment_options *options, size_t size);

/* Empty bins, with the streams of seed 0. NULL options are the defaults. PKC_E_LIMIT if the bins
 * have too many cells together; a bin takes some 4 KiB and 28 bytes a cell. Free with
 * pkc_environment_free. */
PKC_API pkc_status pkc_environment_create(const pkc_environment_options *options,
                                          pkc_environment **out_environment);
PKC_API void pkc_environment_free(pkc_environment *environment);
PKC_API pkc_status pkc_environment_clone(const pkc_environment *environment,
                                         pkc_environment **out_environment);

/* What there is to choose from, and what was done. */
typedef struct pkc_environment_info {
    uint32_t struct_size;
    int32_t count;        /* bins side by side */
    int32_t bin_w, bin_h; /* cells */
    int32_t actions;      /* W*H + 1, or 2*W*H + 1 where items may be turned */
    int32_t closed;       /* bins that are closed now */
    uint64_t steps;       /* items placed since the creation */
    uint64_t bins;        /* bins closed since then */
} pkc_environment_info;
PKC_API pkc_status pkc_environment_info_init(pkc_environment_info *info, size_t size);
PKC_API pkc_status pkc_environment_get_info(const pkc_environment *environment,
                                            pkc_environment_info *info);

/* Empties every bin. With one seed bin i gets its stream i, with a seed for each bin its stream 0;
 * with `count` 0 (`seeds` may be NULL) the streams go on with the items that wait. Equal seeds give
 * equal items on every machine, none of which pkc_policy_measure draws. */
PKC_API pkc_status pkc_environment_reset(pkc_environment *environment, const uint64_t *seeds,
                                         size_t count);

/* Places an item into each bin: `count` actions, one a bin. Each of the outputs may be NULL, and
 * else gets `count` values: the reward, (1 - reward_fill) * contact / 20 and, when the bin closes,
 * reward_fill * its utilisation; the contact reward of paper eq. (3); 1 where the bin closed, else
 * 0. A closed bin stays as it is until pkc_environment_open or _reset. All or nothing: PKC_E_STATE
 * if a bin is closed, PKC_E_ARGUMENT if an action is not allowed, with the bin's index in
 * pkc_last_error(). */
PKC_API pkc_status pkc_environment_step(pkc_environment *environment, const int32_t *actions,
                                        size_t count, double *out_rewards, int32_t *out_contacts,
                                        uint8_t *out_closed_flags);

/* Opens the next bin, empty, where one is closed; it begins with the item that closed it. */
PKC_API pkc_status pkc_environment_open(pkc_environment *environment);

/* What is seen of `count` bins: those of these `indices`, or all (`indices` NULL, `count` theirs).
 * Each of the outputs may be NULL. A bin gets W*H bytes of cells by index, 1 where taken; the
 * item's two sides, in cells; a byte for each action, 1 where it is allowed (the feasibility mask b
 * of the paper); the number of its taken cells. */
PKC_API pkc_status pkc_environment_observe(const pkc_environment *environment,
                                           const int32_t *indices, size_t count, uint8_t *out_cells,
                                           int32_t *out_sizes, uint8_t *out_mask,
                                           int32_t *out_occupied_cells);

/* ---- Planner --------------------------------------------------------------------------------- */

#define PKC_METHOD_PAPER 1 /* Algorithms 1-3 of the paper as written */
#define PKC_METHOD_EXACT 2 /* the same tree, equal states once; repacking by an exact packer */

#define PKC_REPACK_OFF 0
#define PKC_REPACK_ANYTIME 1 /* raises the utilisation as far as the budget allows */
#define PKC_REPACK_FULL 2    /* only for a plan that places every known item or fills the bin */

#define PKC_SELECT_AUTO (-1) /* two candidates in method paper with repacking, else all */
#define PKC_SELECT_ALL 0     /* no pruning */
#define PKC_UNLIMITED (-1)

typedef struct pkc_planner pkc_planner;

typedef struct pkc_planner_options {
    uint32_t struct_size;
    int32_t method;   /* PKC_METHOD_EXACT */
    int32_t rotation; /* 1 (default): items may be turned; 0: never, and packed ones that lie turned
                         stay where they are */
    int32_t repack;   /* PKC_REPACK_OFF */
    int32_t select;   /* PKC_SELECT_AUTO, PKC_SELECT_ALL, or candidates kept a node, 1..128 */
    int32_t buffer_capacity; /* items an arm's buffer holds at any moment of a step, 0..4096; an
                                item that goes straight back into the bin is in the gripper, not
                                there; PKC_UNLIMITED (default) */
    int32_t skip;            /* 1: an accessible item that cannot be placed is skipped for good;
                                0 (default): it stays for the next bin */
    int32_t max_side;        /* largest bin side planned for, 1..128 (128) */
    int32_t max_items;       /* most items in the bin at once, 1..16384 (256) */
    int32_t max_known;       /* most recognised and buffered items together, 1..128 (128) */
    uint64_t memory;         /* bytes for tables of states met, 64 KiB..4 GiB (8 MiB) */
} pkc_planner_options;
PKC_API pkc_status pkc_planner_options_init(pkc_planner_options *options, size_t size);

/* A planner that keeps its own hold on the policy. All memory is taken here: planning allocates
 * none. NULL options are the defaults, a NULL policy is the default one. Free with
 * pkc_planner_free. */
PKC_API pkc_status pkc_planner_create(const pkc_planner_options *options, const pkc_policy *policy,
                                      pkc_planner **out_planner);
PKC_API void pkc_planner_free(pkc_planner *planner);

/* How much a plan may cost. A budget in nodes alone gives the same plan on every machine. Where a
 * budget is asked for, NULL is the default one; one without any limit may run for hours. */
typedef struct pkc_budget {
    uint32_t struct_size;
    uint32_t reserved;   /* 0 */
    uint64_t nodes;      /* placements tried; 0: no limit */
    double milliseconds; /* wall time; 0: no limit; finite, 0..1e12 */
} pkc_budget;
/* 200000 nodes, no time limit. */
PKC_API pkc_status pkc_budget_init(pkc_budget *budget, size_t size);

/* What a plan is known to be. IMPOSSIBLE is of full mode: the known items cannot all be placed, nor
 * the bin filled. BUDGET: the budget ended first, or what is looked at (the buffers' room, 8 belt
 * items, 128 packed ones) was too little to decide. */
#define PKC_PROOF_NONE 0    /* nothing was to be proved: no repacking was needed or allowed */
#define PKC_PROOF_OPTIMAL 1 /* no plan over the known items does better in this mode */
#define PKC_PROOF_IMPOSSIBLE 2
#define PKC_PROOF_BUDGET 3

typedef struct pkc_plan_info {
    uint32_t struct_size;
    int32_t actions;        /* actions of this step */
    int32_t packs, unpacks; /* among them */
    int32_t repacked;       /* 1: the plan came from repacking */
    int32_t terminate;      /* 1: the bin is closed by this step */
    int32_t proof;          /* PKC_PROOF_* */
    int32_t cancelled;      /* 1: pkc_planner_cancel ended the search */
    double utilization;     /* of the bin once all that was planned ahead is packed, 0..1 */
    int64_t score;  /* mu, contact rewards summed over the forward simulation; 0 after repacking */
    uint64_t nodes; /* placements tried, and other work of that size */
    uint64_t tree_nodes;        /* of them in the first tree search, the rest in repacking */
    uint64_t hash;              /* pkc_plan_hash of the actions */
    double milliseconds;        /* thread CPU time spent planning */
    double repack_milliseconds; /* of it in repacking */
} pkc_plan_info;
PKC_API pkc_status pkc_plan_info_init(pkc_plan_info *info, size_t size);

/* Plans the next step (Algorithm 1) for what bin and queue hold; changes neither. Always a legal
 * plan: at worst one greedy placement. TERMINATE stands alone when nothing accessible or buffered
 * has a position and repacking found nothing better, and last when the step fills the bin. With an
 * empty conveyor and empty buffers that is TERMINATE too: whoever waits for items should not plan.
 * `info` may be NULL. PKC_E_STATE if an id is both in the bin and in the queue, PKC_E_LIMIT if
 * there is more than the options have room for, PKC_E_ARGUMENT if the policy was trained for bins
 * of another size; then there is no plan, not even the one before. */
PKC_API pkc_status pkc_planner_plan(pkc_planner *planner, const pkc_bin *bin,
                                    const pkc_queue *queue, const pkc_budget *budget,
                                    pkc_plan_info *info);

/* The same work in slices, for cyclic tasks: begin copies the state (and fails as pkc_planner_plan
 * does), step spends up to `nodes` nodes (>= 1) and sets `out_done` to 1 when nothing is left to do
 * or the budget is spent. The plan is the one that pkc_planner_plan gives. */
PKC_API pkc_status pkc_planner_begin(pkc_planner *planner, const pkc_bin *bin,
                                     const pkc_queue *queue, const pkc_budget *budget);
PKC_API pkc_status pkc_planner_step(pkc_planner *planner, uint64_t nodes, int32_t *out_done);

/* The plan: after pkc_planner_plan or a step that was done the final one, before that the best so
 * far. `info` may be NULL. PKC_E_STATE if nothing was begun. */
PKC_API pkc_status pkc_planner_result(pkc_planner *planner, pkc_plan_info *info,
                                      pkc_action *actions, size_t capacity, size_t *out_count);

/* From any thread: the plan being made ends within some microseconds (on a 128 x 128 bin: some
 * milliseconds) with the best so far. A plan begun later is not affected. */
PKC_API pkc_status pkc_planner_cancel(pkc_planner *planner);

/* ---- Exact packer and bounds ----------------------------------------------------------------- */

#define PKC_PACKING_FOUND 1
#define PKC_PACKING_IMPOSSIBLE 2
#define PKC_PACKING_BUDGET 3 /* not decided within the budget */

/* Can all items be placed on the bin's free cells, without moving what is there? At most 16384
 * items; their ids are not looked at. `rotation`: 1, they may be turned; 0, not. When FOUND,
 * `placements` (count of them, in the items' order) says how, else it is untouched. `out_nodes`
 * (may be NULL) gets what it cost. */
PKC_API pkc_status pkc_exact_pack(const pkc_bin *bin, const pkc_item *items, size_t count,
                                  int32_t rotation, const pkc_budget *budget,
                                  pkc_placement *placements, int32_t *out_answer,
                                  uint64_t *out_nodes);

/* The clairvoyant bound for A = 1: how many of the next items, in arrival order and without one
 * left out, fit together on the bin's free cells. No planner without a buffer packs more into this
 * bin, and taking the most for each bin is the most for the stream. With PKC_PACKING_BUDGET in
 * `out_answer` the count is an upper bound only, from the areas, else it is exact
 * (PKC_PACKING_FOUND). Of the items the first W*H are looked at; `rotation` is 1 or 0 as above. */
PKC_API pkc_status pkc_bound_in_order(const pkc_bin *bin, const pkc_item *items, size_t count,
                                      int32_t rotation, const pkc_budget *budget, size_t *out_count,
                                      int32_t *out_answer);

/* ---- Cell ------------------------------------------------------------------------------------ */

/* From here on lengths are metres, angles radians, times seconds: the plane of the cell seen from
 * above, x to the right, y up, angles counter-clockwise. In a build without the cell
 * (PACKCELL_CELL=OFF) every function of this and the next three sections gives
 * PKC_E_UNSUPPORTED; pkc_cell_preset gives NULL. */

#define PKC_MAX_JOINTS 6
#define PKC_MAX_CELL_BYTES 1048576 /* of a cell description: 1 MiB */

/* A cell: arms, bin, belt, buffers, margins and how long what takes (docs/cell.md). Immutable; may
 * be shared by threads. */
typedef struct pkc_cell pkc_cell;

/* By name: "ur5e" (two UR5e with vacuum grippers, real limits), "paper" (the same two with dwells
 * scaled so that one arm's cycle takes the paper's 15.5 s, and the paper's planning times), "piper"
 * (the paper's physical test), "scara" (two SCARA arms). Free with pkc_cell_free. */
PKC_API pkc_status pkc_cell_create(const char *preset, pkc_cell **out_cell);
PKC_API void pkc_cell_free(pkc_cell *cell);

/* Names that pkc_cell_create knows, by index from 0; NULL past the last. Static storage. */
PKC_API const char *pkc_cell_preset(size_t index);

/* From the JSON text of a cell.json, `size` bytes of UTF-8. PKC_E_FORMAT, naming field and value,
 * for what is not a cell description or longer than PKC_MAX_CELL_BYTES; PKC_E_ARGUMENT, naming them
 * too, for a cell that cannot work: a bin out of reach, bases too near each other, a belt that does
 * not move. Free with pkc_cell_free. */
PKC_API pkc_status pkc_cell_load(const char *json, size_t size, pkc_cell **out_cell);
PKC_API pkc_status pkc_cell_load_file(const char *path, pkc_cell **out_cell);

/* The description as JSON text, without a closing zero; loading it gives the same cell.
 * `out_size` gets the bytes needed or written. */
PKC_API pkc_status pkc_cell_save(const pkc_cell *cell, char *json, size_t capacity,
                                 size_t *out_size);
PKC_API pkc_status pkc_cell_save_file(const pkc_cell *cell, const char *path);

typedef struct pkc_cell_info {
    uint32_t struct_size;
    int32_t arms;            /* 1 or 2 */
    int32_t bin_w, bin_h;    /* cells */
    int32_t buffer_slots[2]; /* items that each arm's buffer holds */
    int32_t joints[2];       /* of each arm: 6 or 4; 0 where there is none */
    double margin;           /* kept between the arms */
    double tick;             /* of coordination */
    double cycle; /* one arm's: home, middle of its zones, middle of the bin, home, with dwells; 0
                     where arm 0 does not reach the second of three zones */
    char name[32];
} pkc_cell_info;
PKC_API pkc_status pkc_cell_info_init(pkc_cell_info *info, size_t size);
PKC_API pkc_status pkc_cell_get_info(const pkc_cell *cell, pkc_cell_info *info);

/* Whether there are as many arms and they reach the belt's zones as the scenario says: PKC_OK, or
 * PKC_E_ARGUMENT with the zone and the distance. */
PKC_API pkc_status pkc_cell_check(const pkc_cell *cell, const pkc_scenario *scenario);

/* Joints (radians; metres for the third of a SCARA) at which the arm's tool, straight down, has its
 * tip at (x, y, z) and is turned by yaw, within the position limits and nearest to the middle of
 * the arm's range; joints that it does not have are 0. PKC_E_STATE if there are none. And back, by
 * the full chain of links, whatever the limits. `arm` is 0, or 1 in a cell with two; all numbers
 * are finite, -1000..1000. */
PKC_API pkc_status pkc_cell_inverse(const pkc_cell *cell, int32_t arm, const double pose[4],
                                    double joints[PKC_MAX_JOINTS]);
PKC_API pkc_status pkc_cell_forward(const pkc_cell *cell, int32_t arm,
                                    const double joints[PKC_MAX_JOINTS], double pose[4]);

/* How a layout is looked for. */
typedef struct pkc_layout_options {
    uint32_t struct_size;
    int32_t evaluations; /* of the mean transfer time, 10..100000 (800) */
    double range;        /* by which bases and buffers may move in x and in y, > 0, <= 2 (0.3) */
} pkc_layout_options;
PKC_API pkc_status pkc_layout_options_init(pkc_layout_options *options, size_t size);

typedef struct pkc_layout_info {
    uint32_t struct_size;
    int32_t evaluations; /* made */
    double before;       /* mean transfer time between belt, bin and buffers, without dwells */
    double after;
} pkc_layout_info;
PKC_API pkc_status pkc_layout_info_init(pkc_layout_info *info, size_t size);

/* Moves bases, buffers and homes for the shortest mean transfer within reach and clearance (NLopt:
 * DIRECT, then Subplex). Never worse than `cell`; equal calls give equal cells. NULL options are
 * the defaults; `info` may be NULL. PKC_E_ARGUMENT as in pkc_cell_check. Free with pkc_cell_free.
 */
PKC_API pkc_status pkc_cell_optimize_layout(const pkc_cell *cell, const pkc_scenario *scenario,
                                            const pkc_layout_options *options,
                                            pkc_layout_info *info, pkc_cell **out_cell);

/* ---- Tasks and schedule ---------------------------------------------------------------------- */

/* Task allocation (paper, Sec. IV-D): names the arms of a step's packs from the belt anew, in
 * place, so that each item goes to the nearest arm that reaches it; at most one an arm. `queue` is
 * the one before the step. Whether the step is legal is not looked at. PKC_E_ARGUMENT as in
 * pkc_cell_check, PKC_E_LIMIT for more than PKC_MAX_ACTIONS. */
PKC_API pkc_status pkc_allocate(const pkc_cell *cell, const pkc_queue *queue, pkc_action *actions,
                                size_t count);

/* How two arms are coordinated. Each mode keeps the stricter ones' schedule as its incumbent: over
 * an episode COORDINATED <= ZONE_MUTEX <= SYNC_PAPER. */
#define PKC_MODE_SYNC_PAPER 1  /* the paper's: atomic actions in common slots, one step a time */
#define PKC_MODE_ZONE_MUTEX 2  /* asynchronous; one arm at a time over the bin */
#define PKC_MODE_COORDINATED 3 /* asynchronous; kept apart by their footprints alone */

/* What the arms, the belt and the planner do and when. */
typedef struct pkc_schedule pkc_schedule;

PKC_API pkc_status pkc_schedule_create(const pkc_cell *cell, const pkc_scenario *scenario,
                                       int32_t mode, pkc_schedule **out_schedule);
PKC_API void pkc_schedule_free(pkc_schedule *schedule);

/* Adds the work of a step that was planned for `bin` and `queue`: those before the step. Its motion
 * begins once the last step's items are off the belt, the belt has moved and the step is planned;
 * planning takes the seconds that the cell description says. PKC_E_STATE if the step is not legal
 * or the arms block each other for good, with the pair in pkc_last_error(); PKC_E_LIMIT if a buffer
 * has no place left, for more than PKC_MAX_ACTIONS, or for work of more than 2^20 of the cell's
 * ticks an arm or 2^26 pairs of both arms' ticks; PKC_E_ARGUMENT if the bin has not the cell's
 * sides or the queue not the schedule's scenario. */
PKC_API pkc_status pkc_schedule_add_step(pkc_schedule *schedule, const pkc_bin *bin,
                                         const pkc_queue *queue, const pkc_action *actions,
                                         size_t count);

/* The item that is let go over the bin at `time` (0..1e9, to the microsecond) did not fit
 * (pkc_simulation_places): its arm takes it to its buffer before it does anything else. To the
 * steps planned afterwards the item is an unpacked one. PKC_E_STATE if no arm lets go of it then,
 * PKC_E_LIMIT if the buffer has no place left. */
PKC_API pkc_status pkc_schedule_put_aside(pkc_schedule *schedule, int32_t item, double time);

/* Why an arm waits. */
#define PKC_WAIT_BELT 1      /* no item has arrived */
#define PKC_WAIT_PLANNING 2  /* the step is being planned */
#define PKC_WAIT_OTHER_ARM 3 /* the other arm is too near, or still at the belt */
#define PKC_WAIT_BIN 4       /* the other arm has the bin (ZONE_MUTEX) */
#define PKC_WAIT_CELLS 5     /* the other arm has not freed the cells yet */
#define PKC_WAIT_SYNC 6      /* the slot's or step's other action has not ended (SYNC_PAPER) */
#define PKC_WAIT_DONE 7      /* nothing is left to do */
#define PKC_WAIT_COUNT 8

/* Where an arm's time goes; everything adds up to the makespan. */
typedef struct pkc_arm_times {
    double travel;
    double strokes; /* down and up */
    double grips;   /* gripping and letting go */
    double waits[PKC_WAIT_COUNT];
} pkc_arm_times;

typedef struct pkc_schedule_info {
    uint32_t struct_size;
    int32_t mode;
    int32_t taken;   /* mode whose schedule it is: its own or an incumbent's */
    int32_t steps;   /* added */
    double makespan; /* until both arms are home */
    double lower_bound;
    double released;      /* when the last step's work was released */
    double belt;          /* seconds in which the belt moves */
    double planning;      /* seconds of planning, as the cell description has them */
    double min_clearance; /* between the arms, sampled every 10 ms; -1 with one arm */
    pkc_arm_times arms[2];
    uint64_t hash;       /* of the schedule, times to the microsecond */
    uint64_t nodes;      /* of the coordination search */
    double milliseconds; /* thread CPU time of motion planning and coordination, all steps */
} pkc_schedule_info;
PKC_API pkc_status pkc_schedule_info_init(pkc_schedule_info *info, size_t size);
PKC_API pkc_status pkc_schedule_get_info(const pkc_schedule *schedule, pkc_schedule_info *info);

#define PKC_ACTIVITY_TRAVEL 1
#define PKC_ACTIVITY_LOWER 2
#define PKC_ACTIVITY_GRIP 3
#define PKC_ACTIVITY_RELEASE 4
#define PKC_ACTIVITY_LIFT 5
#define PKC_ACTIVITY_WAIT 6

/* An arm at a time: set-points of its joints, and what it does. */
typedef struct pkc_arm_sample {
    double position[PKC_MAX_JOINTS];
    double velocity[PKC_MAX_JOINTS];
    double acceleration[PKC_MAX_JOINTS];
    double tool[4]; /* x, y, z of the tip, yaw */
    double held;    /* half the diagonal of the item in the gripper; 0: none */
    int32_t item;   /* that the atomic action is about; -1: none */
    int32_t step;
    int32_t activity; /* PKC_ACTIVITY_* */
    int32_t reason;   /* PKC_WAIT_* of a wait, else 0 */
} pkc_arm_sample;

/* At `time`, 0..makespan; `arm` is 0, or 1 with two robots. */
PKC_API pkc_status pkc_schedule_sample(const pkc_schedule *schedule, int32_t arm, double time,
                                       pkc_arm_sample *out_sample);

/* ---- Simulation ------------------------------------------------------------------------------ */

typedef struct pkc_simulation_options {
    uint32_t struct_size;
    int32_t hertz;    /* steps a second, 60..1000 (240) */
    double sigma;     /* standard deviation of an item's place in the gripper, 0..0.05 (0) */
    double sigma_yaw; /* and turn, 0..0.5 (0) */
    uint64_t seed;
    int32_t frames;   /* 1: keep the poses for the replay; 0 (default) */
    int32_t reserved; /* 0 */
} pkc_simulation_options;
PKC_API pkc_status pkc_simulation_options_init(pkc_simulation_options *options, size_t size);

/* A run of a schedule in a fresh Box2D world. */
typedef struct pkc_simulation pkc_simulation;

/* Runs what the schedule has so far, to its end. NULL options are the defaults. Equal schedules and
 * options give equal runs. PKC_E_STATE for more than a day or 16384 items, or where an id comes a
 * second time, for another item. Free with pkc_simulation_free. */
PKC_API pkc_status pkc_simulate(const pkc_schedule *schedule, const pkc_simulation_options *options,
                                pkc_simulation **out_simulation);
PKC_API void pkc_simulation_free(pkc_simulation *simulation);

#define PKC_PLACE_OK 1
#define PKC_PLACE_JAMMED 2    /* it would have come down on a wall or a neighbour: still held */
#define PKC_PLACE_MISPLACED 3 /* in the bin, but farther from its place than allowed */
#define PKC_PLACE_ABSENT 4    /* it had jammed before and was not put aside: nothing is let go */

/* What became of an item that was to be put into the bin. */
typedef struct pkc_place {
    int32_t item;
    int32_t step;
    int32_t arm;
    int32_t outcome; /* PKC_PLACE_* */
    double time;     /* of the release */
    double error;    /* between where it lies at the end and where it should */
    double turn;
} pkc_place;

typedef struct pkc_simulation_info {
    uint32_t struct_size;
    int32_t places;
    int32_t jams;
    int32_t misplaced;
    double worst_error;   /* of an item in the bin at the end */
    double worst_overlap; /* by which two of them, or one and a wall, overlap */
    double seconds;       /* simulated */
    uint64_t steps;
    uint64_t detections; /* arrivals that the photo-eyes saw */
    uint64_t missed;     /* and did not see */
    uint64_t hash;       /* of all final poses, bit for bit */
    double milliseconds; /* thread CPU time of the run */
} pkc_simulation_info;
PKC_API pkc_status pkc_simulation_info_init(pkc_simulation_info *info, size_t size);
PKC_API pkc_status pkc_simulation_get_info(const pkc_simulation *simulation,
                                           pkc_simulation_info *info);

/* In the order of their times. */
PKC_API pkc_status pkc_simulation_places(const pkc_simulation *simulation, pkc_place *places,
                                         size_t capacity, size_t *out_count);

/* ---- Traces ---------------------------------------------------------------------------------- */

#define PKC_TRACE_CHROME 1   /* Chrome trace events (JSON), opens in Perfetto */
#define PKC_TRACE_TIMELINE 2 /* CSV: time, joints, tools, clearance, every `period` */
#define PKC_TRACE_JOINTS_0 3 /* CSV: set-points of arm 0 every `period` */
#define PKC_TRACE_JOINTS_1 4
#define PKC_TRACE_GANTT 5  /* SVG */
#define PKC_TRACE_REPLAY 6 /* one self-contained HTML page */

/* Writes a schedule, all or nothing as in pkc_policy_save_file (PKC_E_IO); `simulation` (may be
 * NULL) adds the poses of its run. `period`: 0.0001..10, of the CSV files; ignored by the others.
 * PKC_E_LIMIT for more than 1e7 rows, PKC_E_ARGUMENT for the joints of an arm that there is not. */
PKC_API pkc_status pkc_trace_write_file(const pkc_schedule *schedule,
                                        const pkc_simulation *simulation, int32_t kind,
                                        double period, const char *path);

/* ---- Generators ------------------------------------------------------------------------------ */

#define PKC_GENERATE_RANDOM 1 /* sides uniform on 1..W/2 and 1..H/2 (at least 1) */
#define PKC_GENERATE_FULL 2   /* 100 % sets, the paper's Algorithm 4 (Sec. V-A) */

typedef struct pkc_generator_options {
    uint32_t struct_size;
    int32_t kind;  /* PKC_GENERATE_RANDOM */
    int32_t w, h;  /* bin, 1..128 cells each (10 x 10) */
    double mean;   /* FULL: of the sides, as a fraction of the bin's side, > 0 and <= 1 */
    double sigma;  /* FULL: standard deviation in cells, > 0 and <= 128 */
    uint64_t seed; /* equal options give equal items on every machine */
} pkc_generator_options;
/* RANDOM, 10 x 10, preset `table`, seed 1. */
PKC_API pkc_status pkc_generator_options_init(pkc_generator_options *options, size_t size);

/* Sets mean and sigma: "text" (0.5 and 2: about 11.3 items on 10 x 10) or "table" (0.445 and 1:
 * about 8.4 items; the paper's Table (b) has 8.17). */
PKC_API pkc_status pkc_generator_preset(pkc_generator_options *options, const char *preset);

typedef struct pkc_generator pkc_generator;
PKC_API pkc_status pkc_generator_create(const pkc_generator_options *options,
                                        pkc_generator **out_generator);
PKC_API void pkc_generator_free(pkc_generator *generator);

/* RANDOM: fills the whole array, of up to 2^24 items, with the stream's next ones, ids counting on.
 * FULL: the next set, shuffled, ids from 0; W*H elements always suffice, and with fewer a set that
 * needs more is PKC_E_CAPACITY and will be given again. */
PKC_API pkc_status pkc_generator_next(pkc_generator *generator, pkc_item *items, size_t capacity,
                                      size_t *out_count);

#ifdef __cplusplus
}
#endif

#endif
