/* SPDX-License-Identifier: Apache-2.0 */
/* savings.h - what each pass saves. */
#ifndef FP3_SAVINGS_H
#define FP3_SAVINGS_H

#include "pipeline.h"

/* saved: for each pass that is on, the cost of a step without the pass minus the cost with it:
 * operations; of `chain` instructions, of `scale` products, of `ahead` cycles. Takes as long again
 * for each. */
void fp3_savings(const fp3_pipeline *with, const fp3_integrator *integrator,
                 const fp3_options *options, uint32_t saved[FP3_PASS_COUNT]);

#endif
