/* SPDX-License-Identifier: Apache-2.0 */
/* chance.c - params at random over many decades: which runs fail, beside which should, and how it
 * is told. */
#include "sections.h"

#include "theory.h"

#include <gsl/gsl_math.h>
#include <math.h>
#include <stdlib.h>

#define OBJECTS 4096
#define STEPS 512
#define DECADES_LOW (-6.0)
#define DECADES 9.0 /* k; of c as many */
#define LARGEST 3.4028234663852886e38
#define TOLERANCE 0.01 /* of the share: those that are about to overflow at the last step */

static const char text[] = "model damped\nparam k = 1\nparam c = 0\nstate v = 0\nstate x = 1\n"
                           "step 1\nv' = -k*x - c*v\nx' = v\n";
static const char undamped[] =
    "model swing\nparam k = 1\nstate v = 0\nstate x = 1\nstep 1\nv' = -k*x\nx' = v\n";

/* Beyond the critical damping both eigenvalues are real, and z and the angle mean nothing. */
static int is_bound_to_fail(const fp3_integrator *integrator, double k, double c) {
    const double z = sqrt(k), ratio = c / (2 * z);
    return fp3_theory_growth(integrator, z, acos(ratio)) > pow(LARGEST, 1.0 / STEPS);
}

typedef struct {
    double failed, expected; /* shares */
    size_t overflows, others, untold;
} count;

static fp3_status tell(fp3_lab *lab, const double *k, const double *c, const fp3_trial *trial,
                       count *n, fp3_error *error) {
    double x[OBJECTS];
    static const uint32_t invalid = 16, overflow = 4;
    fp3_object_status *status_of = calloc(OBJECTS, sizeof *status_of);
    fp3_status status = status_of ? fp3_lab_status(lab, status_of, error) : fp3_no_memory(error);
    if (!status)
        status = fp3_lab_read(lab, "x", x, error);
    for (int i = 0; !status && i < OBJECTS; i++) {
        const uint32_t flags = status_of[i].flags;
        n->failed += status_of[i].failed ? 1.0 / OBJECTS : 0;
        n->expected += is_bound_to_fail(trial->integrator, k[i], c[i]) ? 1.0 / OBJECTS : 0;
        n->overflows += status_of[i].failed && flags & overflow;
        n->others += status_of[i].failed && !(flags & overflow) && flags & invalid;
        n->untold += !isfinite(x[i]) && !status_of[i].failed;
    }
    free(status_of);
    return status;
}

static fp3_status run(const fp3_trial *trial, fp3_rig *rig, int is_damped, count *n,
                      fp3_error *error) {
    double k[OBJECTS], c[OBJECTS];
    uint64_t seed = 3;
    for (int i = 0; i < OBJECTS; i++) {
        k[i] = (float)pow(10, DECADES_LOW + DECADES * fp3_trial_chance(&seed));
        c[i] = is_damped ? (float)(2 * sqrt(k[i]) * fp3_trial_chance(&seed)) : 0;
    }
    fp3_status status = fp3_lab_fill(rig->lab, "k", k, error);
    if (!status && is_damped)
        status = fp3_lab_fill(rig->lab, "c", c, error);
    if (!status)
        status = fp3_lab_start(rig->lab, error);
    if (!status)
        status = fp3_lab_run(rig->lab, STEPS, error);
    return status ? status : tell(rig->lab, k, c, trial, n, error);
}

fp3_status fp3_section_chance(const fp3_trial *trial, fp3_error *error) {
    const fp3_lab_arithmetic *plain = &fp3_lab_arithmetics[FP3_LAB_PLAIN];
    const int is_damped = trial->run->kind != FP3_STOERMER;
    fp3_rig rig;
    count n = {0};
    if (!fp3_trial_tries(trial, plain, 0))
        return FP3_OK;
    fp3_status status =
        fp3_rig_open(trial, is_damped ? text : undamped, plain, 1, OBJECTS, &rig, error);
    if (!status)
        status = run(trial, &rig, is_damped, &n, error);
    fp3_rig_close(&rig);
    if (status)
        return status;
    fp3_verdict v =
        fp3_trial_verdict(trial, "chance", is_damped ? "damped" : "swing", plain,
                          "share of %d objects that fail in %d steps; k over %.0f decades: "
                          "%zu overflow, %zu only invalid",
                          OBJECTS, STEPS, DECADES, n.overflows, n.others);
    v.expected = n.expected;
    v.measured = n.failed;
    v.tolerance = TOLERANCE;
    status = fp3_verdicts_add(trial->verdicts, &v, error);
    v = fp3_trial_verdict(trial, "chance", is_damped ? "damped" : "swing", plain,
                          "objects that are NaN or infinite and are not told");
    v.measured = (double)n.untold;
    return status ? status : fp3_verdicts_add(trial->verdicts, &v, error);
}
