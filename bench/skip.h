/* skip.h - what a scene need not do, done and left out. */
#ifndef BENCH_SKIP_H
#define BENCH_SKIP_H

#include <fp3/program.h>
#include <stdint.h>

typedef enum { SKIP_NOBODY, SKIP_SLEEP, SKIP_LIFE } skip_idle; /* how objects are idle */

/* One side of a comparison. */
typedef struct {
    const char *what;        /* for the table */
    unsigned without;        /* passes that are off */
    const char *observed[4]; /* states, ended by NULL; none: all */
    const char *config;      /* of the engine fast; NULL: many_full */
    unsigned percent;        /* of the objects that are not idle */
} skip_side;

#define SKIP_SIDES 5

/* Sides that end with the same values: the first does all there is to do. */
typedef struct {
    const char *way, *program, *integrator; /* integrator: of a model */
    skip_idle idle;
    uint32_t visit;             /* of the hardware; 0: all steps */
    const char *configs[3];     /* whose cycles are measured, ended by NULL */
    skip_side side[SKIP_SIDES]; /* ended by one that is called NULL */
} skip_case;

/* NULL beyond the last. */
const skip_case *skip_case_at(unsigned number);

#endif
