/* SPDX-License-Identifier: Apache-2.0 */
/* ahead.h - which instructions of a step are of the next one.
 *
 * A program may compute at the end of a step what the next step begins with. The last step of a
 * visit then computes it for nothing, and an exception there says nothing about the run.
 */
#ifndef FP3_AHEAD_H
#define FP3_AHEAD_H

#include "placement.h"

/* Sets is_ahead[pc] to 1 for each instruction of the step part whose result reaches no state, no
 * store, no sleep and nothing of the last part before the step ends; the caller has filled it with
 * 0, program->count of them. states: a set of registers. */
void fp3_ahead_find(const fp3_code *program, uint64_t states, uint8_t *is_ahead);

#endif
