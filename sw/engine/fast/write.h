/* SPDX-License-Identifier: Apache-2.0 */
/* write.h - a program as C: the text of place.h, lanes.h and, with `fused` or `storage`, fused.h or
 * halves.h, then a function for a stretch of steps.
 *
 * Objects are independent, so several vectors of them go through a step side by side, as many as
 * keep the processor's units busy; each has its registers in variables of its own.
 */
#ifndef FP3_FAST_EMIT_H
#define FP3_FAST_EMIT_H

#include "plan.h"

#include <stdio.h>

/* The text defines FP3_FAST_NAME, a fp3_fast_stretch or, of a program with neighbours, a
 * fp3_fast_around_fn; see native.h. FP3_E_SYSTEM: it could not be written. */
fp3_status fp3_fast_write(const fp3_fast_plan *plan, FILE *to, fp3_error *error);

#endif
