/* SPDX-License-Identifier: Apache-2.0 */
/* repeat.h - projections that happen several times.
 *
 * Where objects see each other a repetition is a loop of the program, over phases: it cuts the step
 * into segments (step.h). Elsewhere there is no loop, and its projections are made one by one.
 */
#ifndef FP3_REPEAT_H
#define FP3_REPEAT_H

#include "compiler/step/advance.h"

/* Whether repetitions of this model are loops. */
int fp3_repeat_loops(const fp3_advance *a);

/* Adds variables for what is read of the beginning of the step. FP3_E_PROGRAM: an event would need
 * sums over neighbours as they were then. */
fp3_status fp3_repeat_prepare(fp3_advance *a, fp3_error *error);

/* A segment ends, and another begins. times: as of fp3_segment. */
fp3_status fp3_repeat_cut(fp3_advance *a, uint32_t times, fp3_error *error);

#endif
