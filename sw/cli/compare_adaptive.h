/* SPDX-License-Identifier: Apache-2.0 */
/* compare_adaptive.h - fp3 compare with --tolerance: adaptive steps beside fixed ones of the same
 * error. */
#ifndef FP3_COMPARE_ADAPTIVE_H
#define FP3_COMPARE_ADAPTIVE_H

#include <argp.h>
#include <fp3/engine.h>
#include <jansson.h>

#include "progress.h"

#define FP3_TOLERANCES_MAX 16

typedef struct {
    double tolerances[FP3_TOLERANCES_MAX];
    unsigned tolerance_count; /* 0: not asked for */
    double span;              /* 0: the model's */
    uint64_t most_steps;      /* of fixed steps */
    int is_quick;             /* no hardware */
    const char *const *integrators;
    unsigned integrator_count; /* 0: those with an estimate, and rk4 and rk6 */
    fp3_progress *progress;
} fp3_compare_adaptive_def;

/* "1e-3,1e-4"; ends with 2 and a message where it cannot be. */
void fp3_compare_adaptive_read(fp3_compare_adaptive_def *def, struct argp_state *state,
                               const char *text);

/* Prints a row for each integrator with an estimate, arithmetic and tolerance, and adds it to rows.
 * path: of the model, which is read anew. FP3_E_MISMATCH: words of an engine and of the equations
 * differ; FP3_E_FAILED: an object did not reach its end. The rows are there. */
fp3_status fp3_compare_adaptive(const fp3_compare_adaptive_def *def, const char *path, json_t *rows,
                                fp3_error *error);

#endif
