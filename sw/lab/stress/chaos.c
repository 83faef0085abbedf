/* SPDX-License-Identifier: Apache-2.0 */
/* chaos.c - the largest Lyapunov exponent of Lorenz's equations, with the linearised ones beside
 * them. */
#include "sections.h"

#include <math.h>

#define OBJECTS 512
#define STEP 0.00390625
#define ROUNDINGS 16
#define PART 128 /* steps, after which the deviation is made 1 again */
#define WARM 32  /* parts until the start is forgotten */
#define PARTS 200
#define PARTS_QUICK 40
#define PUBLISHED                                                                                  \
    0.9056 /* Sprott, Chaos and Time-Series Analysis (2003); Viswanath 1998: 0.90566 */
#define TOLERANCE 0.05

static const char text[] = "model lorenz\nstate x = 0\nstate y = 1\nstate z = 20\nstate a = "
                           "1\nstate b = 0\nstate c = 0\nstep 1\n"
                           "x' = 10*(y - x)\ny' = x*(28 - z) - y\nz' = x*y - 8/3*z\n"
                           "a' = 10*(b - a)\nb' = a*(28 - z) - x*c - b\nc' = a*y + x*b - 8/3*c\n";

/* The sum of the logarithms of what deviations have become; they are 1 again. */
static fp3_status shorten(fp3_lab *lab, double *sum, fp3_error *error) {
    static const char *const names[] = {"a", "b", "c"};
    double d[3][OBJECTS];
    fp3_status status = FP3_OK;
    for (int j = 0; !status && j < 3; j++)
        status = fp3_lab_read(lab, names[j], d[j], error);
    for (int i = 0; !status && i < OBJECTS; i++) {
        const double size = sqrt(d[0][i] * d[0][i] + d[1][i] * d[1][i] + d[2][i] * d[2][i]);
        *sum += log(size);
        for (int j = 0; j < 3; j++)
            d[j][i] /= size;
    }
    for (int j = 0; !status && j < 3; j++)
        status = fp3_lab_write(lab, names[j], d[j], error);
    return status;
}

static fp3_status measure(const fp3_trial *trial, fp3_rig *rig, double *exponent,
                          fp3_error *error) {
    const int parts = trial->options->is_quick ? PARTS_QUICK : PARTS;
    double x[OBJECTS], sum = 0, before = 0;
    uint64_t seed = 4;
    for (int i = 0; i < OBJECTS; i++)
        x[i] = 10 * fp3_trial_chance(&seed) - 5;
    fp3_status status = fp3_lab_fill(rig->lab, "x", x, error);
    if (!status)
        status = fp3_lab_start(rig->lab, error);
    for (int k = 0; !status && k < WARM + parts; k++) {
        before = k == WARM ? sum : before;
        status = fp3_lab_run(rig->lab, PART, error);
        if (!status)
            status = shorten(rig->lab, &sum, error);
    }
    *exponent = (sum - before) / OBJECTS / (parts * PART * STEP);
    return status;
}

fp3_status fp3_section_chaos(const fp3_trial *trial, fp3_error *error) {
    fp3_status status = FP3_OK;
    for (unsigned i = 0; !status && i < fp3_lab_arithmetic_count; i++) {
        fp3_rig rig;
        if (fp3_lab_arithmetics[i].update == FP3_DOUBLE_SINGLE ||       /* no matter of digits */
            ROUNDINGS * fp3_lab_unit(&fp3_lab_arithmetics[i]) > STEP || /* a step is lost in them */
            !fp3_trial_tries(trial, &fp3_lab_arithmetics[i], i && trial->options->is_quick))
            continue;
        fp3_verdict v = fp3_trial_verdict(trial, "chaos", "lorenz", &fp3_lab_arithmetics[i],
                                          "largest Lyapunov exponent");
        v.expected = PUBLISHED;
        v.tolerance = TOLERANCE * PUBLISHED;
        status = fp3_rig_open(trial, text, &fp3_lab_arithmetics[i], STEP, OBJECTS, &rig, error);
        if (!status)
            status = measure(trial, &rig, &v.measured, error);
        fp3_rig_close(&rig);
        if (!status)
            status = fp3_verdicts_add(trial->verdicts, &v, error);
    }
    return status;
}
