/* trial.c - see trial.h. */
#include "trial.h"

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
    snprintf(v.arithmetic, sizeof v.arithmetic, "%s", arithmetic->name);
    return v;
}

fp3_status fp3_rig_open(const fp3_trial *trial, const char *text,
                        const fp3_lab_arithmetic *arithmetic, double h, size_t objects,
                        fp3_rig *rig, fp3_error *error) {
    *rig = (fp3_rig){0};
    const fp3_status status = fp3_lab_model(text, &rig->model, error);
    const fp3_lab_def def = {rig->model, trial->run, arithmetic,
                             h,          objects,    !trial->options->is_quick};
    return status ? status : fp3_lab_open(&def, &rig->lab, error);
}

void fp3_rig_close(fp3_rig *rig) {
    fp3_lab_close(&rig->lab);
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

static unsigned factors(const double *row, unsigned count, double unit) {
    unsigned found = 0;
    for (unsigned i = 0; i < count; i++)
        found += row[i] != 0 && fabs(row[i]) != unit;
    return found;
}

/* As docs/compiler.md says: whole multiples of the smallest coefficient have it as a factor, where that saves products. */
static void round_row(double *row, unsigned count) {
    double unit = INFINITY;
    int is_common = 1;
    for (unsigned i = 0; i < count; i++)
        unit = row[i] != 0 ? fmin(unit, fabs(row[i])) : unit;
    for (unsigned i = 0; i < count; i++)
        is_common &= fabs(row[i] / unit - round(row[i] / unit)) < 1e-9;
    is_common &= factors(row, count, unit * (1 + 1e-9)) > 1 &&
                 factors(row, count, unit) + (unit != 1) < factors(row, count, 1);
    for (unsigned i = 0; i < count; i++)
        row[i] = is_common ? round(row[i] / unit) * (float)unit : (float)row[i];
}

/* c h is one number of the program. */
static void round_recurrence(fp3_recurrence *r, double h) {
    r->first = (float)(r->first * h) / h;
    r->bend = (float)r->bend;
    for (unsigned j = 1; j <= r->stages; j++) {
        r->at[j] = (float)r->at[j];
        r->share[j] = (float)r->share[j];
        r->slope[j] = (float)(r->slope[j] * h) / h;
    }
}

/* Of a splitting, c h is one number of the program; of Runge-Kutta h and the coefficients are. */
fp3_integrator fp3_trial_rounded(const fp3_integrator *table, double h) {
    fp3_integrator r = *table;
    round_row(r.b, r.stages);
    for (unsigned i = 0; i < r.stages; i++) {
        r.substeps[i].coefficient = (float)(r.substeps[i].coefficient * h) / h;
        round_row(r.a[i], i);
    }
    round_recurrence(&r.recurrence, h);
    return r;
}

int fp3_trial_is_symplectic(const fp3_integrator *integrator) {
    return integrator->kind == FP3_SPLITTING || integrator->kind == FP3_STOERMER ||
           integrator->is_position_late;
}
