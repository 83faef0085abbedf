/* SPDX-License-Identifier: Apache-2.0 */
/* adaptive.h - steps that each object chooses by itself: what surrounds the method.
 *
 * A method must fill fp3_advance.error. docs/adaptive.md describes the computation.
 */
#ifndef FP3_COMPILER_ADAPTIVE_H
#define FP3_COMPILER_ADAPTIVE_H

#include "compiler/step/advance.h"

#define FP3_ADAPTIVE_LEAST 0x1p-126 /* a step below it is none */

/* All of them do nothing where the model is not adapted (fp3/compile.h). */

/* Before the method: a->begin, a->h, a->end. FP3_E_PROGRAM: no object could stop. */
fp3_status fp3_adaptive_begin(fp3_advance *a, fp3_error *error);
/* After the method, and before events: a->is_good says whether the step is good; and the length of
 * the next step. */
fp3_status fp3_adaptive_judge(fp3_advance *a, fp3_error *error);
/* After events: the new states if the step is good, and else the old ones. */
fp3_status fp3_adaptive_accept(fp3_advance *a, fp3_error *error);

#endif
