/* SPDX-License-Identifier: Apache-2.0 */
/* problem.h - what is solved: a model from 0 to its span, for objects that differ a little
 * (variants). */
#ifndef FP3_MEASURE_PROBLEM_H
#define FP3_MEASURE_PROBLEM_H

#include <fp3/model.h>
#include <stdint.h>

typedef struct {
    const fp3_model *model;
    double end;        /* time, exact in FP32: where errors are taken */
    unsigned variants; /* objects that differ */
    double *params;    /* a row for each variant */
    double *initial;   /* likewise */
    double *truth;     /* likewise, states at the end */
    double *scale;     /* of each state: the largest magnitude along the truth */
} fp3_measure_problem;

/* The truth of every variant, by two methods. model stays the caller's. */
fp3_status fp3_measure_problem_open(const fp3_model *model, unsigned variants,
                                    fp3_measure_problem *problem, fp3_error *error);
void fp3_measure_problem_close(fp3_measure_problem *problem);

/* Of ends, a row of states for each variant: relative to the scale, root of the mean square over
 * the states; its median and its largest over the variants. Infinite where a state is not finite.
 */
void fp3_measure_problem_errors(const fp3_measure_problem *problem, const double *ends,
                                double *median, double *worst);

/* Fixed steps that are tried: 1, 2, 4, 8, ... over the span. Between two of them errors follow the
 * order of the method. */
uint64_t fp3_measure_steps(unsigned rung);

double fp3_measure_median(const double *values, unsigned count);

#endif
