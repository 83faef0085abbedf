/* SPDX-License-Identifier: Apache-2.0 */
/* plan.h - after which steps of a run a snapshot is taken. */
#ifndef FP3_OUTPUT_PLAN_H
#define FP3_OUTPUT_PLAN_H

#include "source.h"

typedef struct {
    uint64_t steps; /* of the run */
    uint64_t every; /* 0: at the start and the end alone */
    uint64_t *list; /* ascending; NULL: by every */
    size_t count;   /* of list */
} fp3_plan;

/* The caller frees *plan, after a failure too. times: NULL, or in the unit of h, with source's h.
 * FP3_E_ARGUMENT: a time is no multiple of h, beyond the run, or not above the one before. */
fp3_status fp3_plan_make(const fp3_source *source, uint64_t steps, uint64_t every,
                         const double *times, size_t count, fp3_plan *plan, fp3_error *error);
/* A snapshot after each of `parts` steps. FP3_E_SYSTEM. */
fp3_status fp3_plan_parts(uint64_t parts, fp3_plan *plan, fp3_error *error);
/* Snapshots after these steps, ascending, of a run that ends at the last. FP3_E_SYSTEM. */
fp3_status fp3_plan_steps(const uint64_t *steps, size_t count, fp3_plan *plan, fp3_error *error);
/* Leaves {0}, which may be freed as well. */
void fp3_plan_free(fp3_plan *plan);

/* How many snapshots there are, from step `from` on. */
uint64_t fp3_plan_count(const fp3_plan *plan, uint64_t from);
/* Whether there is one after that many steps. */
int fp3_plan_has(const fp3_plan *plan, uint64_t step);
/* The step of the next one behind `step`; the end of the run if there is none. */
uint64_t fp3_plan_next(const fp3_plan *plan, uint64_t step);

/* The step at this time. FP3_E_ARGUMENT: there is none. */
fp3_status fp3_plan_step(const fp3_source *source, double time, uint64_t *step, fp3_error *error);

#endif
