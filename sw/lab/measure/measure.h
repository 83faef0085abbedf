/* SPDX-License-Identifier: Apache-2.0 */
/* measure.h - error against run time: one model, many ways to solve it.
 *
 * In the command, and in the program of `make bench`, which adds the solvers of SUNDIALS: not in
 * the library.
 */
#ifndef FP3_MEASURE_H
#define FP3_MEASURE_H

#include "machines.h"
#include "options.h"

#include "lab/bench/native.h"

/* quick: few tolerances, few objects, three repeats. */
fp3_measure_options fp3_measure_default(const char *engine, int is_quick);

typedef struct {
    fp3_measure_problem problem;
    fp3_measure_points points;
    fp3_measure_machines *machines;
    fp3_bench_native *native;
} fp3_measure;

/* model stays the caller's and must live as long. FP3_E_MISMATCH: engines differ, or two truths do;
 * FP3_E_SYSTEM: there is no C compiler. Close it in any case. */
fp3_status fp3_measure_model(const fp3_model *model, const fp3_measure_options *options,
                             fp3_measure *measure, fp3_error *error);
void fp3_measure_close(fp3_measure *measure);

/* {"problems": [...], "points": [...], "left_out": [...]}, the first with one; NULL: no memory. */
json_t *fp3_measure_json(const fp3_measure *measure);

#endif
