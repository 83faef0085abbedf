/* SPDX-License-Identifier: Apache-2.0 */
/* sweep.h - the interpreter: one instruction for all objects of a block, then the next.
 *
 * sweep.c is compiled for several kinds of processor and arithmetic; fp3_sweep_choose finds the one
 * for this machine. It needs no compiler at run time, and so it stands in for native code; and it
 * is the one that knows the flags of each object.
 */
#ifndef FP3_SWEEP_H
#define FP3_SWEEP_H

#include "place.h"
#include "plan.h"

/* The least kind of processor of this family, as gcc's -march has it. */
#if defined __x86_64__
#define FP3_SWEEP_LEAST "x86-64"
#elif defined __aarch64__
#define FP3_SWEEP_LEAST "armv8-a"
#elif defined __wasm__
#define FP3_SWEEP_LEAST "wasm32"
#else
#define FP3_SWEEP_LEAST "rv64gc"
#endif

/* What becomes of each object: rows of FP3_BLOCK. Steps are numbers of steps, as an object's status
 * has them. */
typedef struct {
    int flags[FP3_BLOCK];     /* raised, FP3_FLAG_* */
    int failed[FP3_BLOCK];    /* the first step but 0 with a grave exception, if grave has one */
    int grave[FP3_BLOCK];     /* the grave exceptions of any instruction */
    int is_raised[FP3_BLOCK]; /* -1: one of them counts as a failure, in step ... */
    int raised[FP3_BLOCK];
    int raised_flags[FP3_BLOCK]; /* ... with those of its first instruction */
    int ahead[FP3_BLOCK];        /* grave exceptions of the step that follows */
    int is_strayed[FP3_BLOCK];   /* -1: a state was not finite, after step ... */
    int strayed[FP3_BLOCK];
    int reg[FP3_BLOCK]; /* ... this one */
    int bits[FP3_BLOCK];
} __attribute__((aligned(64))) fp3_witness;

typedef struct {
    const fp3_fast_plan *plan;
    const uint8_t *is_ahead; /* of each instruction: it works for the step that follows */
    uint64_t states;
    uint64_t live; /* registers that a step leaves to what follows; other states are in records */
} fp3_watch_plan;

typedef struct {
    unsigned lanes;
    const char *name; /* of the kind of processor, as gcc's -march has it */
    /* A part; the step part so many times, the first time as step number + 1. */
    void (*run)(const fp3_fast_plan *plan, const fp3_fast_place *place, fp3_fast_part_number part,
                uint32_t steps, uint32_t number);
    /* The same without the processor's multiplier for subnormal numbers: see tiny.h. What it raises
     * for underflow is in place->seen. */
    void (*run_tiny)(const fp3_fast_plan *plan, const fp3_fast_place *place,
                     fp3_fast_part_number part, uint32_t steps, uint32_t number);
    /* The same, and what it does to each object is added to *witness. */
    void (*watch)(const fp3_watch_plan *plan, const fp3_fast_place *place,
                  fp3_fast_part_number part, uint32_t steps, uint32_t number, fp3_witness *witness);
    /* Words first .. end - 1 of the program, once; likewise without the multiplier, if that raises
     * underflow too early. */
    void (*run_words)(const fp3_fast_plan *plan, const fp3_fast_place *place, uint32_t first,
                      uint32_t end);
    /* 0: none of these values is infinite or a NaN. */
    int (*is_any_astray)(const float *row, unsigned count);
    /* 0: this processor cannot compute the estimates of the table. */
    int (*are_estimates_exact)(const int *table);
} fp3_sweep;

/* For this processor and this arithmetic. most: no better kind than this; "": any. */
const fp3_sweep *fp3_sweep_choose(const fp3_config *config, const char *most);
/* Whether there is a kind of that name; and all of them, as words of a message. */
int fp3_sweep_is_kind(const char *name);
extern const char fp3_sweep_kinds[];

#endif
