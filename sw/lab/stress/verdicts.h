/* SPDX-License-Identifier: Apache-2.0 */
/* verdicts.h - results of a stress suite: each a measured figure beside what it should be. */
#ifndef FP3_VERDICTS_H
#define FP3_VERDICTS_H

#include <fp3/status.h>
#include <stddef.h>

typedef enum {
    FP3_WITHIN,  /* |measured - expected| <= tolerance */
    FP3_AT_MOST, /* measured <= expected + tolerance */
    FP3_AT_LEAST /* measured >= expected - tolerance */
} fp3_comparison;

enum { FP3_VERDICT_NAME = 128, FP3_VERDICT_WHY = 320 };

typedef struct {
    const char *section;         /* a constant: stability, drift, ... */
    char name[FP3_VERDICT_NAME]; /* what is measured, with its unit where it has one */
    char model[64], integrator[64], arithmetic[32]; /* "": none */
    fp3_comparison relation;
    double expected, measured, tolerance;
    /* Of the caller: what was measured beside it that explains a figure that is off; else NULL or
     * "". */
    const char *because;
    /* Of fp3_verdicts_add. */
    int holds;
    char why[FP3_VERDICT_WHY]; /* "" where it holds */
} fp3_verdict;

/* A line of a picture. */
typedef struct {
    const char *figure; /* a constant */
    char series[96];
    double *x, *y;
    size_t count;
} fp3_curve;

typedef struct {
    fp3_verdict *list;
    size_t count;
    fp3_curve *curves;
    size_t curve_count;
} fp3_verdicts;

/* Decides whether it holds, and keeps a copy. */
fp3_status fp3_verdicts_add(fp3_verdicts *verdicts, const fp3_verdict *verdict, fp3_error *error);
/* Keeps copies of x and y. */
fp3_status fp3_verdicts_draw(fp3_verdicts *verdicts, const char *figure, const char *series,
                             const double *x, const double *y, size_t count, fp3_error *error);
void fp3_verdicts_free(fp3_verdicts *verdicts);
/* How many do not hold. */
size_t fp3_verdicts_failed(const fp3_verdicts *verdicts);

const char *fp3_relation_name(fp3_comparison relation); /* "within", "at most", "at least" */

#endif
