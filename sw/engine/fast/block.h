/* SPDX-License-Identifier: Apache-2.0 */
/* block.h - the objects that a worker has in hand, lane by lane: what they hold, what is known of
 * them. */
#ifndef FP3_FAST_BLOCK_H
#define FP3_FAST_BLOCK_H

#include "native.h"
#include "run.h"
#include "sweep.h"

#include <machine/estimate.h>
#include <machine/watch.h>

typedef struct {
    float rows[FP3_FAST_ROWS][FP3_BLOCK];
    float own[FP3_BANK_OBJECT_COUNT]
             [FP3_BLOCK]; /* records, unless they are the columns themselves */
    int awake[FP3_BLOCK]; /* -1, or 0: it sleeps */
    float *records[FP3_BANK_OBJECT_COUNT];
    /* Of each lane once they are counted, see fp3_fast_count: */
    uint32_t object[FP3_BLOCK]; /* its number */
    uint32_t lane[FP3_BLOCK];   /* its lane when the block was taken up */
    int known[FP3_BLOCK];       /* flags that are known to have been raised */
    int grave[FP3_BLOCK];       /* the grave ones of this run */
    int is_counted;
    const uint32_t *list; /* until then: numbers of the objects, or NULL: first and those behind */
    uint32_t first;
    uint32_t common; /* flags that are already set for every element */
    uint32_t count;
    unsigned seen; /* FP3_SEEN_* of the last stretch */
    int is_tiny;   /* the next stretch is executed as in tiny.h */
    int is_awake;  /* all of awake is -1 */
    int is_dense;  /* objects are numbered in a row, from first on */
    int is_direct; /* records are the columns */
    fp3_witness witness;
} __attribute__((aligned(64))) fp3_fast_lanes;

struct fp3_fast {
    fp3_fast_plan plan;
    fp3_watch_plan watch;
    const fp3_sweep *sweep;
    fp3_fast_native native; /* {0}: interpreted */
    int table[FP3_TABLE];
    char how[160];
};

typedef struct {
    uint32_t lane;
    int is_astray;
} fp3_fast_suspect;

struct fp3_fast_worker {
    fp3_fast_lanes now;                           /* the block */
    fp3_fast_lanes again;                         /* those of it that failed, from the beginning */
    fp3_fast_lanes aside;                         /* for a stretch that is made once more */
    fp3_fast_lanes leaving;                       /* those who fell asleep */
    float rows[FP3_BANK_OBJECT_COUNT][FP3_BLOCK]; /* before a part */
    float records[FP3_BANK_OBJECT_COUNT][FP3_BLOCK]; /* likewise */
    int awake[FP3_BLOCK];
    float origin[FP3_BANK_OBJECT_COUNT][FP3_BLOCK]; /* what the run changes, before it */
    const uint32_t *list; /* the objects that the block was taken up with, or NULL: first and ... */
    uint32_t first;       /* ... those behind */
    fp3_fast_suspect suspects[FP3_BLOCK];
    uint32_t suspect_count;
    int is_grave;       /* some lane of the block has a grave exception */
    uint32_t confirmed; /* flags that objects raised */
    fp3_failed *failures;
    size_t failure_count, failure_room;
};

/* Most blocks never need counts of a single lane: these are made on demand. status: words of all
 * objects, or NULL. */
void fp3_fast_count(fp3_fast_lanes *lanes, const uint32_t *status);
/* The number of a lane's object. */
uint32_t fp3_fast_object(const fp3_fast_lanes *lanes, uint32_t lane);
void fp3_fast_wake(fp3_fast_lanes *lanes);

/* Whether there is native code and it may run: it takes no shared constant for a NaN. */
int fp3_fast_native_for(const fp3_fast *fast, const uint32_t *constants);

/* A place of these lanes, for an executor. */
fp3_fast_place fp3_fast_place_of(fp3_fast_lanes *lanes, const fp3_fast_run *run,
                                 const fp3_fast *fast);

/* Takes lanes, which are counted, out of `from`, in order: their rows and records in these sets,
 * and all that is known of them. The last one fills its vector. to is not from. */
void fp3_fast_pick(const fp3_fast_lanes *from, const uint32_t *lanes, uint32_t count, uint64_t rows,
                   uint64_t records, fp3_fast_lanes *to);
void fp3_fast_pick_witness(const fp3_fast_lanes *from, const uint32_t *lanes, uint32_t count,
                           fp3_fast_lanes *to);
/* Keeps these lanes, ascending, and forgets the others. */
void fp3_fast_keep(fp3_fast_lanes *lanes, const uint32_t *which, uint32_t count, uint64_t rows,
                   uint64_t records);
/* The last lane's values in all lanes that its vector has beyond it. Records are there. */
void fp3_fast_fill(fp3_fast_lanes *lanes, uint64_t rows, uint64_t records);
/* Likewise one row. */
void fp3_fast_fill_row(fp3_fast_lanes *lanes, uint32_t row);
/* From and to the columns of the objects. */
void fp3_fast_gather(fp3_fast_lanes *lanes, float (*to)[FP3_BLOCK], uint32_t *const *columns,
                     uint64_t set);
void fp3_fast_scatter(const fp3_fast_lanes *lanes, const float *const *from,
                      uint32_t *const *columns, uint64_t set);

#endif
