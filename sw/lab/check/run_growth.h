/* SPDX-License-Identifier: Apache-2.0 */
/* run_growth.h - whether the time step of a run was too long for the forces in it: by how much one
 * step of the method enlarges a small disturbance of the final states.
 *
 * The equations are linearised at the final states, and the method's step is applied to a random
 * disturbance of all looked objects until its fastest part is left (power iteration). Objects that
 * are not looked at stay where they are. That can only slow a disturbance down, where forces
 * between objects are equal and opposite.
 */
#ifndef FP3_CHECK_RUN_GROWTH_H
#define FP3_CHECK_RUN_GROWTH_H

#include <fp3/program.h>

/* The objects of a model at some time of a run. */
typedef struct {
    const fp3_program *program;
    const fp3_params *params;
    double *columns; /* states, of `objects` each; changed during the call, and put back */
    size_t objects;
    double t;
} fp3_run_moment;

typedef struct {
    double factor; /* by which a disturbance grows in a step */
    double h;      /* the step */
    double stable; /* one with which it does not grow; 0: even with h/16 it does */
    size_t object; /* where it is largest */
} fp3_run_growth;

/* factor is 1 where the step is short enough, where the motion itself grows as fast, and with
 * adaptive steps, linearly implicit methods and Stoermer's, where nothing is looked at. The first
 * objects are looked at. */
fp3_status fp3_run_growth_find(const fp3_run_moment *moment, fp3_run_growth *found,
                               fp3_error *error);
/* The same at the start of a run; of more than a few thousand objects nothing. */
fp3_status fp3_run_growth_find_at_start(const fp3_program *program, const fp3_params *params,
                                        size_t objects, fp3_run_growth *found, fp3_error *error);

/* What is said of a factor above 1. first: what the first object is called. */
#define FP3_RUN_GROWTH_TEXT_SIZE 256
void fp3_run_growth_text(const fp3_run_growth *found, const fp3_program *program, size_t first,
                         char text[FP3_RUN_GROWTH_TEXT_SIZE]);

#endif
