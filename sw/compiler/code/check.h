/* SPDX-License-Identifier: Apache-2.0 */
/* check.h - whether a program fits into a configuration. */
#ifndef FP3_CHECK_H
#define FP3_CHECK_H

#include "compiler/schedule/code.h"
#include "compiler/schedule/lines.h"
#include "compiler/step/fit.h"
#include "compiler/step/step.h"

/* FP3_E_PROGRAM: what is asked for needs another arithmetic than the configuration has. */
fp3_status fp3_check_arithmetic(const fp3_options *options, const fp3_fit *fit, fp3_error *error);
/* Before an order is searched for: operations and words. FP3_E_PROGRAM, in words. */
fp3_status fp3_check_code(const fp3_step *step, const fp3_step_code *code, const fp3_config *config,
                          fp3_error *error);
/* After it: words, with the loads and stores of a visit, registers and constants. */
fp3_status fp3_check_schedule(const fp3_step_code *code, const fp3_schedule *schedule,
                              const fp3_config *config, fp3_error *error);

#endif
