/* SPDX-License-Identifier: Apache-2.0 */
/* lab.h - one program over many objects whose params and starts differ, on the engine fast.
 *
 *     fp3_lab *lab = NULL;
 *     const fp3_lab_def def = {model, integrator, &fp3_lab_arithmetics[0], .h = 1, .objects = 512};
 *     if (fp3_lab_open(&def, &lab, error) || fp3_lab_fill(lab, "k", stiffness, error) ||
 *         fp3_lab_start(lab, error) || fp3_lab_run(lab, 1000, error) || fp3_lab_read(lab, "x", x,
 * error)) ... fp3_lab_close(&lab);
 */
#ifndef FP3_LAB_H
#define FP3_LAB_H

#include <fp3/compile.h>
#include <fp3/engine.h>

/* A configuration, and how a state is updated on it. A configuration with another arithmetic needs
 * one more row. */
typedef struct {
    const char *config;
    fp3_arithmetic update;
} fp3_lab_arithmetic;

enum { FP3_LAB_PLAIN, FP3_LAB_COMPENSATED }; /* the first two; both on the same configuration */
extern const fp3_lab_arithmetic fp3_lab_arithmetics[];
extern const unsigned fp3_lab_arithmetic_count;
/* That of the update, or of a configuration other than the usual one. */
const char *fp3_lab_name(const fp3_lab_arithmetic *arithmetic);
int fp3_lab_flushes(const fp3_lab_arithmetic *arithmetic);   /* no gradual underflow */
double fp3_lab_least(const fp3_lab_arithmetic *arithmetic);  /* the smallest number above 0 */
int fp3_lab_truncates(const fp3_lab_arithmetic *arithmetic); /* rounds to zero */
int fp3_lab_is_finite(const fp3_lab_arithmetic *arithmetic); /* no infinities and no NaN */
int fp3_lab_is_logarithmic(const fp3_lab_arithmetic *arithmetic);
int fp3_lab_is_small(const fp3_lab_arithmetic *arithmetic); /* fewer fraction bits than FP32 */
/* Has no native code: runs are shorter. */
int fp3_lab_is_slow(const fp3_lab_arithmetic *arithmetic);
/* What a sum rounded to nearest is off by at most, relative to it: 2^-24 of binary32, 2^-(fraction
 * + 1), and half of a step of logarithms, ln 2 2^-24 (of which 1.3 may be lost:
 * docs/logarithmic.md). Truncated it is twice that. */
double fp3_lab_unit(const fp3_lab_arithmetic *arithmetic);
/* The relative error of one update, as the root of its mean square: a unit in the last place over
 * sqrt(12), where logarithms of fractions, and of numbers, are equally likely; of double-single
 * below. */
double fp3_lab_rounded(const fp3_lab_arithmetic *arithmetic);
/* What an update makes a number larger in the mean, relative to it: truncated it is half a unit
 * less. Sums of logarithms are 0.015 last places too large in the mean of each octave of ratios
 * from 1 to 4,096 (over 400,000 pairs each: 0.010 to 0.022), as their tables cut off low digits.
 * Elsewhere 0. */
double fp3_lab_bias(const fp3_lab_arithmetic *arithmetic);
/* The number that the host gives for x: FP32, of small formats with as many bits as they have. */
double fp3_lab_number(const fp3_lab_arithmetic *arithmetic, double x);
/* Whether two have the same numbers and the same coefficients. */
int fp3_lab_is_as_exact(const fp3_lab_arithmetic *one, const fp3_lab_arithmetic *other);
/* Another configuration that rounds numbers of ordinary size to nearest, as plain does: long runs
 * show nothing new. */
int fp3_lab_is_nearly_plain(const fp3_lab_arithmetic *arithmetic);

/* The relative error of an update in double-single: its sum is off by 3.1 u^2 at most
 * (docs/compiler.md), where a plain one is off by u/2, which in the mean is 2.5e-8. */
#define FP3_LAB_PAIR_ROUNDED (6.2 * 2.5e-8 * 0x1p-24)

typedef struct {
    const fp3_model *model; /* the caller's, as is the next; they outlive the lab */
    const fp3_integrator *integrator;
    const fp3_lab_arithmetic *arithmetic;
    double h;
    size_t objects;
    int is_long; /* worth native code */
} fp3_lab_def;

typedef struct fp3_lab fp3_lab;

/* All objects have the model's defaults. FP3_E_PROGRAM: the integrator does not fit the model, or
 * the program not the configuration. The caller closes *lab, which is NULL on failure. */
fp3_status fp3_lab_open(const fp3_lab_def *def, fp3_lab **lab, fp3_error *error);
/* Sets *lab to NULL, which it may be already. */
void fp3_lab_close(fp3_lab **lab);

const fp3_compiled *fp3_lab_program(const fp3_lab *lab);

/* Another time step for the next start. */
void fp3_lab_step(fp3_lab *lab, double h);

/* A param, or the start of a state, of every object, rounded as fp3_lab_number. FP3_E_ARGUMENT: no
 * such name, or a param that objects share. */
fp3_status fp3_lab_fill(fp3_lab *lab, const char *name, const double *column, fp3_error *error);
/* Rows of an object, as fp3_lab_number has them: model->param_count and state_count numbers. */
const double *fp3_lab_params(const fp3_lab *lab, size_t object);
const double *fp3_lab_initial(const fp3_lab *lab, size_t object);

/* Loads the program and gives all objects their values, at time 0. */
fp3_status fp3_lab_start(fp3_lab *lab, fp3_error *error);
fp3_status fp3_lab_run(fp3_lab *lab, uint64_t steps, fp3_error *error);
/* A state of every object: of double-single the sum of its words. */
fp3_status fp3_lab_read(fp3_lab *lab, const char *state, double *column, fp3_error *error);
/* All states, a row of model->state_count for each object. */
fp3_status fp3_lab_read_all(fp3_lab *lab, double *rows, fp3_error *error);
fp3_status fp3_lab_write(fp3_lab *lab, const char *state, const double *column, fp3_error *error);
/* Sets all states of the objects marked, what is lost of them included, to 0: they rest, and cost
 * no look at how they failed. */
fp3_status fp3_lab_rest(fp3_lab *lab, const char *is_marked, fp3_error *error);
/* As fp3_engine_failure, of all objects; text has its words, "" if there is none. */
fp3_status fp3_lab_failure(fp3_lab *lab, fp3_failure *failure, char text[FP3_FAILURE_TEXT_SIZE],
                           fp3_error *error);
/* flags and the step of the first failure of each object. */
fp3_status fp3_lab_status(fp3_lab *lab, fp3_object_status *status, fp3_error *error);

/* A model from a text of the suite's own. */
fp3_status fp3_lab_model(const char *text, fp3_model **model, fp3_error *error);

#endif
