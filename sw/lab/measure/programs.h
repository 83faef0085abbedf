/* SPDX-License-Identifier: Apache-2.0 */
/* programs.h - programs of fp3 on its own engines, and the cycles of hardware. */
#ifndef FP3_MEASURE_PROGRAMS_H
#define FP3_MEASURE_PROGRAMS_H

#include "machines.h"
#include "options.h"

/* Every integrator and arithmetic with fixed steps, of a model with events also with steps that are
 * cut at them ("rk4 cut"), then every one that estimates its error with adaptive steps ("dopri5
 * adaptive"). */
fp3_status fp3_measure_add_programs(fp3_measure_points *points, const fp3_measure_problem *problem,
                                    const fp3_measure_options *options,
                                    fp3_measure_machines *machines, fp3_error *error);

#endif
