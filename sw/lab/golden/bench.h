/* SPDX-License-Identifier: Apache-2.0 */
/* bench.h - one program on one configuration of the hardware: run, compared and measured.
 *
 * Objects differ in one value, a param or the start of a state. Every write to the register of a
 * state is recorded as it retires, and compared afterwards; then the registers are read back
 * through the host port and compared again. No write is skipped, reordered or forgiven.
 *
 * A ship written by hand, on words that are floats, is compared with golden, plain C that knows
 * nothing of instructions. In a visit of n steps its program writes v and s n times each, in the
 * golden order; and before that the value at the beginning of the visit: where objects come from a
 * store, when it is loaded; and once more if the program asks for it (it may run the position one
 * step behind and begin with s + -0).
 *
 * Any other program is compared with the isa engine, write by write; what that computes for a model
 * is compared with the equations elsewhere (fp3 compare).
 */
#ifndef FP3_BENCH_H
#define FP3_BENCH_H

#include "written.h"

#include <fp3/program.h>

#define FP3_BENCH_STATES 64

/* What to run; all that it points to stays the caller's. */
typedef struct {
    const fp3_program *program;
    const fp3_params *params;
    const fp3_model *truth; /* whose solution errors are measured against; NULL: they are not */
    const char *config;
    uint32_t objects;  /* 0: as many as the configuration has contexts */
    uint32_t visit;    /* steps per visit; 0: all */
    uint32_t awake_of; /* one object of this many is awake; the others are removed, which needs a
                          sleep */
    uint64_t steps;    /* of each object that is awake; at least 2 */
} fp3_bench_case;

typedef struct {
    uint64_t objects, awake;
    fp3_stats one, all;          /* a run of one step, and a run of all */
    uint32_t issues, adds, muls; /* of one step: instructions, uses of adder, multiplier */
    uint64_t words, mismatches;  /* compared; of those that differ ... */
    fp3_error mismatch;          /* ... the first one: where, both words */
    /* Of each state of object 0 after all steps, relative, against the truth; NaN: it is 0, or
     * there is none. */
    double error[FP3_BENCH_STATES];
    fp3_error no_truth; /* why there is no truth, if it was asked for */
    char
        failure[FP3_FAILURE_TEXT_SIZE]; /* how an object first failed in the run of all; "": none */
} fp3_bench_result;

/* Whether it is a ship written by hand: v, s, T, C, rm and h are declared. */
int fp3_bench_is_ship(const fp3_program *program);

/* FP3_OK also with mismatches. *is_unfit: the configuration cannot execute the program. */
fp3_status fp3_bench_run(const fp3_bench_case *what, fp3_bench_result *result, int *is_unfit,
                         fp3_error *error);

#endif
