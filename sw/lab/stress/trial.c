/* SPDX-License-Identifier: Apache-2.0 */
/* trial.c - see trial.h. */
#include "trial.h"

#include <fp3/truth.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

fp3_verdict fp3_trial_verdict(const fp3_trial *trial, const char *section, const char *model,
                              const fp3_lab_arithmetic *arithmetic, const char *name, ...) {
    fp3_verdict v = {.section = section};
    va_list arguments;
    va_start(arguments, name);
    vsnprintf(v.name, sizeof v.name, name, arguments);
    va_end(arguments);
    snprintf(v.model, sizeof v.model, "%s", model);
    snprintf(v.integrator, sizeof v.integrator, "%s", trial->integrator->name);
    snprintf(v.arithmetic, sizeof v.arithmetic, "%s", fp3_lab_name(arithmetic));
    return v;
}

fp3_status fp3_rig_open(const fp3_trial *trial, const char *text,
                        const fp3_lab_arithmetic *arithmetic, double h, size_t objects,
                        fp3_rig *rig, fp3_error *error) {
    *rig = (fp3_rig){.arithmetic = arithmetic};
    const fp3_status status = fp3_lab_model(text, &rig->model, error);
    const fp3_lab_def def = {rig->model, trial->run, arithmetic,
                             h,          objects,    !trial->options->is_quick};
    return status ? status : fp3_lab_open(&def, &rig->lab, error);
}

void fp3_rig_close(fp3_rig *rig) {
    fp3_lab_close(&rig->lab);
    fp3_compiled_free(&rig->exact);
    fp3_model_free(&rig->model);
}

/* SplitMix64 (Steele, Lea and Flood 2014). */
double fp3_trial_chance(uint64_t *seed) {
    uint64_t z = *seed += 0x9e3779b97f4a7c15u;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
    z = (z ^ z >> 27) * 0x94d049bb133111ebu;
    return (double)((z ^ z >> 31) >> 11) * 0x1p-53;
}

double fp3_trial_slope(const double *x, const double *y, size_t count) {
    double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
    for (size_t i = 0; i < count; i++) {
        const double a = log(x[i]), b = log(y[i]);
        n++, sx += a, sy += b, sxx += a * a, sxy += a * b;
    }
    return count < 2 ? NAN : (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

int fp3_trial_tries(const fp3_trial *trial, const fp3_lab_arithmetic *arithmetic, int is_left_out) {
    const char *const *asked = trial->options->arithmetics;
    if (!asked)
        return !is_left_out;
    while (*asked && strcmp(*asked, fp3_lab_name(arithmetic)) != 0)
        asked++;
    return *asked != NULL;
}

int fp3_trial_has_no_room(const fp3_lab_arithmetic *arithmetic, fp3_status status) {
    return status == FP3_E_PROGRAM && arithmetic->update == FP3_DOUBLE_SINGLE;
}

fp3_status fp3_trial_exact(const fp3_trial *trial, fp3_rig *rig, fp3_trial_numbers numbers,
                           size_t object, double h, const uint64_t *steps, size_t count,
                           double *rows, fp3_error *error) {
    fp3_compile_def def = fp3_compile_default();
    def.config = rig->arithmetic->config;
    if (rig->arithmetic->update == FP3_COMPENSATED)
        def.arithmetic = FP3_COMPENSATED;
    const fp3_status status =
        rig->exact ? FP3_OK : fp3_compile(rig->model, trial->integrator, &def, &rig->exact, error);
    if (status)
        return status;
    return (numbers == FP3_TRIAL_ROUNDED ? fp3_compiled_exact_given : fp3_compiled_exact)(
        rig->exact, fp3_lab_params(rig->lab, object), fp3_lab_initial(rig->lab, object), h, steps,
        count, rows, error);
}

int fp3_trial_is_symplectic(const fp3_integrator *integrator) {
    return integrator->kind == FP3_SPLITTING || integrator->kind == FP3_STOERMER ||
           integrator->is_position_late;
}
