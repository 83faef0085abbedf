/* SPDX-License-Identifier: Apache-2.0 */
/* sample.h - objects with parameters from their ranges, and where each really is. */
#ifndef FP3_TUNE_SAMPLE_H
#define FP3_TUNE_SAMPLE_H

#include "lab/truth/path.h"

#include <fp3/tune.h>

typedef struct {
    const fp3_model *model;
    double span;
    size_t count, room;
    double *params, *initial, *sizes; /* a row for each object */
    fp3_path **paths;
    double *there; /* room for two rows of states */
} fp3_sample;

/* Ranges of the params: how many values are spread. */
uint32_t fp3_sample_ranges(const fp3_params *params);

void fp3_sample_open(fp3_sample *sample, const fp3_model *model, double span);
void fp3_sample_close(fp3_sample *sample);

/* Adds the object that lies at these shares, one for each range: 0 its first, 1 its last value.
 * Parameters and start are FP32 numbers. FP3_E_FAILED: it has no truth. */
fp3_status fp3_sample_add(fp3_sample *sample, const fp3_program *program, const fp3_params *params,
                          const double *shares, fp3_error *error);
/* Takes all objects of another one, which then has none. */
fp3_status fp3_sample_join(fp3_sample *sample, fp3_sample *other, fp3_error *error);

/* The error of an object that has these states at time t, as fp3/tune.h defines it. */
double fp3_sample_error(const fp3_sample *sample, size_t object, double t, const double *states);
/* Whether the truth of an object is ever elsewhere than at its start. */
int fp3_sample_moves(const fp3_sample *sample);
/* How far the truths move between time t and the end of the span, likewise. */
double fp3_sample_gap(const fp3_sample *sample, double t);

#endif
