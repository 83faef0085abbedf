/* SPDX-License-Identifier: Apache-2.0 */
/* failures.c - overflow and NaN put into one object of many: the engine names the object and the
 * step. */
#include "sections.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define OBJECTS 600
#define INJECTED 437
#define STEPS 110

static const char text[] = "model twice\nstate x = 1\nstep 1\nx' = x\n";

/* x doubles in each step, so 2^k overflows in step 128 - k; of double-single when 2^116 is split
 * into halves by a product with 2^12 + 1, in step 117 - k. */
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

/* Without infinities and NaN, all of these are numbers from 2^128 on. */
static fp3_status judge_all(const fp3_trial *trial, const fp3_lab_arithmetic *how,
                            fp3_error *error) {
    static const char before[] = "object 437 before its first step: state x is";
    const int is_finite = fp3_lab_is_finite(how), is_pair = how->update == FP3_DOUBLE_SINGLE;
    char large[96], none[96], infinite[96];
    snprintf(large, sizeof large, "object 437 in step %d: %s", is_pair ? 97 : 108,
             is_finite ? "state x is 2^128 or more" : "overflow");
    snprintf(none, sizeof none, "%s %s", before, is_finite ? "2^128 or more" : "NaN");
    snprintf(infinite, sizeof infinite, "%s %s", before, is_finite ? "2^128 or more" : "infinite");
    fp3_status status = judge(trial, how, 0x1p20, "2^20 doubled", large, error);
    if (!status)
        status = judge(trial, how, NAN, "NaN", none, error);
    return status ? status : judge(trial, how, INFINITY, "infinity", infinite, error);
}

fp3_status fp3_section_failures(const fp3_trial *trial, fp3_error *error) {
    fp3_status status = FP3_OK;
    for (unsigned i = 0; !status && i < fp3_lab_arithmetic_count; i++)
        if (fp3_trial_tries(trial, &fp3_lab_arithmetics[i], 0))
            status = judge_all(trial, &fp3_lab_arithmetics[i], error);
    return status;
}
