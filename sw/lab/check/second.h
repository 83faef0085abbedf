/* SPDX-License-Identifier: Apache-2.0 */
/* second.h - groups that see each other run again, with half the time step or a tenth of the
 * tolerance.
 */
#ifndef FP3_CHECK_SECOND_H
#define FP3_CHECK_SECOND_H

#include "run_growth.h"
#include "run_set.h"

/* A group in both runs. */
typedef struct {
    const fp3_run_part *run; /* that has ended */
    const fp3_scene_group *group;
    const fp3_model *model;
    uint32_t states; /* those of the model, without what adaptive steps add */
    size_t objects;
    int is_adaptive, is_chosen;
    double *now, *size;  /* rows of a number for each object: each state, and the largest so far */
    size_t first;        /* of the second engine */
    fp3_program program; /* but for what is compiled, the first run's */
    fp3_params *params;
    double end;    /* of fixed steps: the time */
    char how[400]; /* it was run */
} fp3_second_part;

typedef struct {
    const fp3_run_set *set;
    const fp3_engine_def *first_def;
    fp3_second_part *parts;
    size_t count;
    fp3_engine *engine;
    fp3_engine_def def;
    fp3_error *error;       /* the engine's, as long as it is open */
    int is_adaptive;        /* some group is */
    int is_blind;           /* nothing is looked at but the two ends */
    fp3_run_growth *growth; /* of all looks, with the step of the first run */
} fp3_second;

/* The set, def (of the first run's engine) and error must outlive it. After a failure, too, the
 * caller closes it. FP3_E_ARGUMENT: a value does not allow another step. */
fp3_status fp3_second_open(const fp3_run_set *set, const fp3_engine_def *def, fp3_second *second,
                           fp3_error *error);
/* Runs it in this arithmetic, and leaves the final states in `now`. May be called again.
 * FP3_E_PROGRAM: it has no such program. */
fp3_status fp3_second_run(fp3_second *second, fp3_arithmetic arithmetic);
/* Leaves {0}, which may be closed as well. */
void fp3_second_close(fp3_second *second);

#endif
