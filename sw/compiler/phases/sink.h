/* SPDX-License-Identifier: Apache-2.0 */
/* sink.h - values of a step are computed as late as possible, so that fewer are kept from phase to
 * phase.
 *
 * A step of a length of its own multiplies that length with each row's coefficient, and says how
 * wrong each state may be: all that is known when the step begins, and needed in a later phase.
 */
#ifndef FP3_PHASES_SINK_H
#define FP3_PHASES_SINK_H

#include "plan.h"

/* Moves nodes of straight code to the phase that reads them first, if no more values are kept then.
 * FP3_E_SYSTEM: out of memory. */
fp3_status fp3_cut_sink(fp3_cut_plan *plan, fp3_error *error);

#endif
