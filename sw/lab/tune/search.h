/* SPDX-License-Identifier: Apache-2.0 */
/* search.h - how many steps, or which tolerance of adaptive ones, an integrator needs to meet a
 * target. */
#ifndef FP3_TUNE_SEARCH_H
#define FP3_TUNE_SEARCH_H

#include "candidate.h"
#include "meter.h"

typedef struct {
    const fp3_sample *sample;
    fp3_meter *meter;
    const char *config;
    double target;
    uint64_t first; /* where to begin, if nothing is known */
    double dearest; /* cycles of an object in a run, at most */
    double cheaper; /* only what costs less than this is of interest; INFINITY: everything */
} fp3_search;

/* Notes a run of the sample. */
void fp3_search_note(fp3_tune_row *row, double cycles, double error);

/* Fills steps .. why of the row. A run that is more expensive than what is of interest is not made.
 */
fp3_status fp3_search_steps(const fp3_search *search, const fp3_candidate *candidate,
                            fp3_tune_row *row, fp3_error *error);
/* The same for an adaptive candidate: fills tolerance, absolute, attempts and error .. why. */
fp3_status fp3_search_tolerance(const fp3_search *search, const fp3_candidate *candidate,
                                fp3_tune_row *row, fp3_error *error);

#endif
