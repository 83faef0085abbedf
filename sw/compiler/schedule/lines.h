/* SPDX-License-Identifier: Apache-2.0 */
/* lines.h - the instructions of a program in their order of issue, with registers. */
#ifndef FP3_LINES_H
#define FP3_LINES_H

#include <stdint.h>

typedef struct {
    uint32_t op;
    uint32_t d;          /* object register */
    uint32_t operand[3]; /* as numbered in a word: constant k is FP3_BANK_SHARED_BASE + k */
    uint32_t note;       /* of the fp3_op; FP3_NONE_INDEX: a copy */
    uint32_t from;       /* index of the fp3_op in its part; FP3_NONE_INDEX: a copy */
    int is_ahead;        /* of the next step: executed here, and once by the first part */
} fp3_line;

typedef struct {
    fp3_line *first, *step, *last;
    uint32_t first_count, step_count, last_count;
    /* Object registers in use: variables are 0 .. variable_count-1, then params, then temps. */
    uint32_t registers;
    uint32_t constants;
    int needs_minus_zero; /* a copy reads constant constant_count, which the caller adds as -0.0 */
    uint32_t ahead;       /* operations that a step executes for the next one */
    uint32_t copies;      /* of the step: instructions that only move a value */
    uint32_t loads, stores; /* what a visit puts around the program (interleaved) */
    int is_spilled;         /* the program has all loads and stores itself, within the step ... */
    uint32_t spills;        /* ... so many */
    /* Cycles per object-step when all contexts are full, steady state, loads and stores not
     * counted: exact. 0: not known beforehand (schedulers share units). */
    double cycles;
    double bound;       /* the larger of the two below */
    double bound_issue; /* issue slots, uses of a unit, write port: whatever is scarcest */
    double bound_path;  /* the longest dependence cycle from step to step, latency over distance */
} fp3_schedule;

#endif
