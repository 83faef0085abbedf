/* failures.c - overflow and NaN put into one object of many: the engine names the object and the step. */
#include "sections.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define OBJECTS 600
#define INJECTED 437
#define STEPS 110

static const char text[] = "model twice\nstate x = 1\nstep 1\nx' = x\n";

/* x doubles in each step, so 2^k overflows in step 128 - k; of double-single when 2^116 is split into halves by a
 * product with 2^12 + 1, in step 117 - k. */
static fp3_status inject(const fp3_trial *trial, const fp3_lab_arithmetic *how, double value,
                         fp3_failure *failure, char said[FP3_FAILURE_TEXT_SIZE], fp3_error *error) {
    double x[OBJECTS];
    fp3_rig rig;
    for (int i = 0; i < OBJECTS; i++)
        x[i] = i == INJECTED ? value : 1;
    fp3_status status = fp3_rig_open(trial, text, how, 1, OBJECTS, &rig, error);
    if (!status)
        status = fp3_lab_start(rig.lab, error);
    if (!status)
        status = fp3_lab_write(rig.lab, "x", x, error);
    if (!status)
        status = fp3_lab_run(rig.lab, STEPS, error);
    if (!status)
        status = fp3_lab_failure(rig.lab, failure, said, error);
    fp3_rig_close(&rig);
    return status;
}

static fp3_status judge(const fp3_trial *trial, const fp3_lab_arithmetic *how, double value,
                        const char *what, const char *expected, fp3_error *error) {
    fp3_failure failure = {0};
    char said[FP3_FAILURE_TEXT_SIZE], because[FP3_FAILURE_TEXT_SIZE + 32];
    fp3_status status = inject(trial, how, value, &failure, said, error);
    fp3_verdict v = fp3_trial_verdict(trial, "failures", "twice", how,
                                      "%s: failures that are told as \"%s\"", what, expected);
    snprintf(because, sizeof because, "told: %s", said);
    v.expected = 1;
    v.measured = failure.failed == 1 && !strcmp(said, expected);
    v.because = because;
    return status ? status : fp3_verdicts_add(trial->verdicts, &v, error);
}

fp3_status fp3_section_failures(const fp3_trial *trial, fp3_error *error) {
    fp3_status status = FP3_OK;
    for (int i = 0; !status && i < FP3_LAB_ARITHMETICS; i++) {
        const fp3_lab_arithmetic *how = &fp3_lab_arithmetics[i];
        status = judge(trial, how, 0x1p20, "2^20 doubled",
                       how->update == FP3_DOUBLE_SINGLE ? "object 437 in step 97: overflow"
                                                        : "object 437 in step 108: overflow",
                       error);
        if (!status)
            status = judge(trial, how, NAN, "NaN",
                           "object 437 before its first step: state x is NaN", error);
        if (!status)
            status = judge(trial, how, INFINITY, "infinity",
                           "object 437 before its first step: state x is infinite", error);
    }
    return status;
}
