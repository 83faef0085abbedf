/* SPDX-License-Identifier: Apache-2.0 */
/* trial.h - what the parts of the suite share: what is asked for, an integrator on trial, a lab for
 * a text. */
#ifndef FP3_STRESS_TRIAL_H
#define FP3_STRESS_TRIAL_H

#include "lab.h"
#include "verdicts.h"

typedef struct {
    int is_quick;                   /* three integrators, fewer steps */
    const char *const *integrators; /* ended by NULL; NULL: all that are built in */
    const char *const *arithmetics; /* names, likewise; NULL: all */
    const char *section;            /* only this one; NULL: all */
    void (*say)(void *user, const char *section, const char *what); /* what is done now; or NULL */
    void *say_user;
    /* To see that it is noticed: what runs instead of an integrator, whose theory stays that of its
     * table; or NULL. */
    void (*spoil)(fp3_integrator *integrator);
} fp3_stress_options;

typedef struct {
    const fp3_stress_options *options;
    const fp3_integrator *integrator; /* as its table says ... */
    const fp3_integrator *run;        /* ... and as it runs: spoiled, if that was asked for */
    fp3_verdicts *verdicts;
} fp3_trial;

/* A text of the suite's own and its lab. The caller closes it, after a failure too. */
typedef struct {
    fp3_model *model;
    fp3_lab *lab;
    const fp3_lab_arithmetic *arithmetic;
    fp3_compiled *exact; /* of fp3_trial_exact */
} fp3_rig;
fp3_status fp3_rig_open(const fp3_trial *trial, const char *text,
                        const fp3_lab_arithmetic *arithmetic, double h, size_t objects,
                        fp3_rig *rig, fp3_error *error);
void fp3_rig_close(fp3_rig *rig);
/* Whether an arithmetic is tried: if it was asked for, or nothing was and it is not left out. */
int fp3_trial_tries(const fp3_trial *trial, const fp3_lab_arithmetic *arithmetic, int is_left_out);
/* Whether a rig was refused because a program in double-single, which is long, does not fit the
 * configuration. */
int fp3_trial_has_no_room(const fp3_lab_arithmetic *arithmetic, fp3_status status);

/* The steps of an object of a rig in double, by the table as it is: rows of all states.
 * Coefficients, h and params are those of the program (in double-single of a plain one), rounded as
 * its numbers are, or as they are. */
typedef enum { FP3_TRIAL_ROUNDED, FP3_TRIAL_UNROUNDED } fp3_trial_numbers;
fp3_status fp3_trial_exact(const fp3_trial *trial, fp3_rig *rig, fp3_trial_numbers numbers,
                           size_t object, double h, const uint64_t *steps, size_t count,
                           double *rows, fp3_error *error);

/* Numbers from 0 to 1, the same in every run. */
double fp3_trial_chance(uint64_t *seed);
/* Slope of log y over log x; NaN of fewer than two points. */
double fp3_trial_slope(const double *x, const double *y, size_t count);
/* Keeps the volume of states where accelerations depend on positions alone. */
int fp3_trial_is_symplectic(const fp3_integrator *integrator);

/* Of a verdict: what it is about. Formats its name. */
__attribute__((format(printf, 5, 6))) fp3_verdict
fp3_trial_verdict(const fp3_trial *trial, const char *section, const char *model,
                  const fp3_lab_arithmetic *arithmetic, const char *name, ...);

#endif
