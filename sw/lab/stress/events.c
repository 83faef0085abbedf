/* SPDX-License-Identifier: Apache-2.0 */
/* events.c - the order of a bouncing ball: an event happens at the end of a step, so it is 1,
 * whatever the integrator. */
#include "sections.h"

#include <math.h>
#include <string.h>

#define OBJECTS 4096 /* where in a step a ball hits is chance: the mean of many falls evenly */
#define RUNGS 6
#define FIRST 5 /* h = 2^-5 */
#define SPAN 2.0
#define GRAVITY 9.8125 /* exact in FP32 */
#define ORDER_OFF 0.1

static const char text[] =
    "model ball\nparam e = 0.75\nstate v = 0\nstate x = 1\nstep 1\nv' = -9.8125\nx' = v\n"
    "when x < 0 and v < 0: x = -e*x, v = -e*v\n";

/* Height of a ball that was let go at rest at x. */
static double truth(double e, double x) {
    double speed = sqrt(2 * GRAVITY * x), t = SPAN - speed / GRAVITY;
    if (t < 0)
        return x - GRAVITY / 2 * SPAN * SPAN;
    for (speed *= e; t > 2 * speed / GRAVITY; speed *= e)
        t -= 2 * speed / GRAVITY;
    return speed * t - GRAVITY / 2 * t * t;
}

static fp3_status measure(fp3_rig *rig, double h, double *mean, fp3_error *error) {
    double x[OBJECTS];
    fp3_lab_step(rig->lab, h);
    fp3_status status = fp3_lab_start(rig->lab, error);
    if (!status)
        status = fp3_lab_run(rig->lab, (uint64_t)(SPAN / h), error);
    if (!status)
        status = fp3_lab_read(rig->lab, "x", x, error);
    *mean = 0;
    for (int i = 0; !status && i < OBJECTS; i++)
        *mean += fabs(x[i] - truth(fp3_lab_params(rig->lab, (size_t)i)[0],
                                   fp3_lab_initial(rig->lab, (size_t)i)[1])) /
                 OBJECTS;
    return status;
}

static fp3_status judge(const fp3_trial *trial, fp3_rig *rig, fp3_error *error) {
    const fp3_lab_arithmetic *plain = &fp3_lab_arithmetics[FP3_LAB_PLAIN];
    double e[OBJECTS], x[OBJECTS], h[RUNGS], mean[RUNGS];
    uint64_t seed = 2;
    for (int i = 0; i < OBJECTS; i++) {
        e[i] = 0.7 + 0.2 * fp3_trial_chance(&seed);
        x[i] = 1 + fp3_trial_chance(&seed);
    }
    fp3_status status = fp3_lab_fill(rig->lab, "e", e, error);
    if (!status)
        status = fp3_lab_fill(rig->lab, "x", x, error);
    for (int k = 0; !status && k < RUNGS; k++)
        status = measure(rig, h[k] = ldexp(1, -FIRST - k), &mean[k], error);
    fp3_verdict v = fp3_trial_verdict(trial, "events", "ball", plain,
                                      "order: slope of the mean error of %d balls", OBJECTS);
    v.expected = 1;
    v.measured = fp3_trial_slope(h, mean, RUNGS);
    v.tolerance = ORDER_OFF;
    return status ? status : fp3_verdicts_add(trial->verdicts, &v, error);
}

fp3_status fp3_section_events(const fp3_trial *trial, fp3_error *error) {
    fp3_rig rig;
    if (trial->run->kind == FP3_STOERMER || /* refuses events */
        !fp3_trial_tries(trial, &fp3_lab_arithmetics[FP3_LAB_PLAIN], 0))
        return FP3_OK;
    fp3_status status =
        fp3_rig_open(trial, text, &fp3_lab_arithmetics[FP3_LAB_PLAIN], 1, OBJECTS, &rig, error);
    if (!status)
        status = judge(trial, &rig, error);
    fp3_rig_close(&rig);
    return status;
}
