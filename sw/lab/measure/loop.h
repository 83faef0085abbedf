/* SPDX-License-Identifier: Apache-2.0 */
/* loop.h - the plain C loop, scalar and as vectors. */
#ifndef FP3_MEASURE_LOOP_H
#define FP3_MEASURE_LOOP_H

#include "options.h"

fp3_status fp3_measure_add_loop(fp3_measure_points *points, const fp3_measure_problem *problem,
                                const fp3_measure_options *options, fp3_error *error);

#endif
