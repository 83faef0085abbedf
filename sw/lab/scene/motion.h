/* SPDX-License-Identifier: Apache-2.0 */
/* motion.h - steps of a scene in double: equations, projections, events, and what entries remember.
 *
 *     fp3_motion *motion = NULL;
 *     fp3_status status = fp3_motion_open(&crowd, NULL, &motion, error);
 *     for (uint64_t n = 0; !status && n < 100; n++)
 *         status = fp3_motion_step(motion, n, 1, error);
 *     fp3_motion_close(&motion);
 */
#ifndef FP3_LAB_MOTION_H
#define FP3_LAB_MOTION_H

#include "crowd.h"

typedef struct fp3_motion fp3_motion;

/* The states are those of the crowd. instead: of all groups; NULL: each group has the scene's.
 * FP3_E_PROGRAM: an integrator that is not there in double. The caller closes *motion. */
fp3_status fp3_motion_open(fp3_crowd *crowd, const fp3_integrator *instead, fp3_motion **motion,
                           fp3_error *error);
/* Sets *motion to NULL, which it may be already. */
void fp3_motion_close(fp3_motion **motion);

/* Step number `step`, from 0, of which the scene makes `parts` for each of its own. Events happen
 * at its end. FP3_E_FAILED: a state is no number then. */
fp3_status fp3_motion_step(fp3_motion *motion, uint64_t step, uint64_t parts, fp3_error *error);
/* The same, but the step ends wherever an event happens, and another one goes on from there.
 * FP3_E_FAILED: also if events happen again and again. */
fp3_status fp3_motion_step_to_events(fp3_motion *motion, uint64_t step, uint64_t parts,
                                     fp3_error *error);
/* The derivatives of all states at this step of the scene, of each group a column of a number for
 * each object, one after the other. Who does not move has 0. */
fp3_status fp3_motion_slopes(fp3_motion *motion, double at, double *slopes, fp3_error *error);
/* What the equations alone make of the states in this share of a step, without projections and
 * events. A state may be no number then. */
fp3_status fp3_motion_flow(fp3_motion *motion, double at, double share, fp3_error *error);
/* How many numbers were computed so far. */
uint64_t fp3_motion_cost(const fp3_motion *motion);

#endif
