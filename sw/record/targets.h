/* SPDX-License-Identifier: Apache-2.0 */
/* targets.h - snapshots of adaptive steps: objects end at each time, and go on from there. */
#ifndef FP3_OUTPUT_TARGETS_H
#define FP3_OUTPUT_TARGETS_H

#include "source.h"

typedef struct {
    double *times; /* as FP32 has them; NULL: steps are fixed */
    float *until;  /* where each object is to end */
    float *next;   /* ... in the part that is run */
    size_t count;
} fp3_targets;

/* Nothing of a program whose steps are fixed. The caller frees, after a failure too.
 * FP3_E_ARGUMENT: no times, or they do not ascend, or one is before an object's start. */
fp3_status fp3_targets_make(const fp3_source *source, const double *times, size_t count,
                            fp3_targets *targets, fp3_error *error);
/* Leaves {0}, which may be freed as well. */
void fp3_targets_free(fp3_targets *targets);

/* Has objects end at this time, or at their own end where that comes before, and wakes them. What
 * goes wrong the engine tells. */
fp3_status fp3_targets_set(const fp3_targets *targets, const fp3_source *source, size_t number);

#endif
