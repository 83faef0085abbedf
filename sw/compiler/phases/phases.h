/* SPDX-License-Identifier: Apache-2.0 */
/* phases.h - a step with sums over neighbours as a program: sections in their order, loads and
 * stores around them. */
#ifndef FP3_PHASES_H
#define FP3_PHASES_H

#include "compiler/code/convert.h"
#include "compiler/schedule/lines.h"

/* Whether something of the step goes over neighbours. */
int fp3_phases_are_needed(const fp3_step *step);

/* FP3_E_PROGRAM: an option is not possible with neighbours. */
fp3_status fp3_phases_check(const fp3_model *model, const fp3_integrator *integrator,
                            const fp3_options *options, fp3_error *error);

/* Adds the params and constants of all sections to code (no operations), and variables to the step.
 * The schedule has a step part alone, with all instructions of a visit. FP3_E_LIMIT: the
 * configuration is too small. The caller closes *schedule, also after a failure. */
fp3_status fp3_phases_make(fp3_step *step, const fp3_options *options, conversion *code,
                           fp3_schedule **schedule, fp3_error *error);

#endif
