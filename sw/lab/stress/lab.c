/* SPDX-License-Identifier: Apache-2.0 */
/* lab.c - see lab.h. */
#include "lab.h"

#include "machine/config.h"
#include "machine/format.h"
#include "world/batch.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define CONFIG "many_full"

const fp3_lab_arithmetic fp3_lab_arithmetics[] = {
    {CONFIG, FP3_PLAIN},   {CONFIG, FP3_COMPENSATED}, {"flush", FP3_PLAIN},
    {"cell", FP3_PLAIN},   {"fused_full", FP3_PLAIN}, {"bfloat", FP3_PLAIN},
    {"middle", FP3_PLAIN}, {"log", FP3_PLAIN},        {CONFIG, FP3_DOUBLE_SINGLE},
};
const unsigned fp3_lab_arithmetic_count = sizeof fp3_lab_arithmetics / sizeof *fp3_lab_arithmetics;

const char *fp3_lab_name(const fp3_lab_arithmetic *arithmetic) {
    return strcmp(arithmetic->config, CONFIG) ? arithmetic->config
                                              : fp3_arithmetic_of(arithmetic->update)->name;
}

int fp3_lab_flushes(const fp3_lab_arithmetic *arithmetic) {
    const fp3_config *config = fp3_config_find(arithmetic->config);
    return !config->subnormal || config->logarithmic;
}

double fp3_lab_least(const fp3_lab_arithmetic *arithmetic) {
    const int fraction = (int)fp3_config_find(arithmetic->config)->fraction;
    return fp3_lab_is_logarithmic(arithmetic) ? 0x1p-127
           : fp3_lab_flushes(arithmetic)      ? 0x1p-126
                                              : ldexp(1, -126 - fraction);
}

int fp3_lab_truncates(const fp3_lab_arithmetic *arithmetic) {
    return !fp3_config_find(arithmetic->config)->nearest;
}

int fp3_lab_is_finite(const fp3_lab_arithmetic *arithmetic) {
    return (int)fp3_config_find(arithmetic->config)->finite;
}

int fp3_lab_is_logarithmic(const fp3_lab_arithmetic *arithmetic) {
    return (int)fp3_config_find(arithmetic->config)->logarithmic;
}

int fp3_lab_is_small(const fp3_lab_arithmetic *arithmetic) {
    return fp3_config_find(arithmetic->config)->fraction < FP3_WORDS_FRACTION;
}

int fp3_lab_is_slow(const fp3_lab_arithmetic *arithmetic) {
    const fp3_config *config = fp3_config_find(arithmetic->config);
    return config->finite || !fp3_format_is_float(config);
}

double fp3_lab_unit(const fp3_lab_arithmetic *arithmetic) {
    const int fraction = (int)fp3_config_find(arithmetic->config)->fraction;
    return ldexp(fp3_lab_is_logarithmic(arithmetic) ? M_LN2 : 1, -fraction - 1);
}

double fp3_lab_rounded(const fp3_lab_arithmetic *arithmetic) {
    const double unit = fp3_lab_unit(arithmetic);
    return arithmetic->update == FP3_DOUBLE_SINGLE ? FP3_LAB_PAIR_ROUNDED
           : fp3_lab_is_logarithmic(arithmetic)    ? unit / sqrt(3)
                                                   : 2.5e-8 * 0x1p24 * unit;
}

double fp3_lab_bias(const fp3_lab_arithmetic *arithmetic) {
    const double unit = fp3_lab_unit(arithmetic);
    return fp3_lab_is_logarithmic(arithmetic) ? 0.015 * 2 * unit
           : fp3_lab_truncates(arithmetic)    ? -4.3e-8 * 0x1p24 * unit
                                              : 0;
}

/* A logarithm is not read again as the float that is nearest to it, so it is left to the machine.
 */
double fp3_lab_number(const fp3_lab_arithmetic *arithmetic, double x) {
    const fp3_config *config = fp3_config_find(arithmetic->config);
    uint32_t word;
    return fp3_lab_is_logarithmic(arithmetic) || fp3_format_word(config, (float)x, &word)
               ? (double)(float)x
               : (double)fp3_format_value(config, word);
}

int fp3_lab_is_as_exact(const fp3_lab_arithmetic *one, const fp3_lab_arithmetic *other) {
    return one->update == other->update &&
           fp3_config_find(one->config)->fraction == fp3_config_find(other->config)->fraction;
}

int fp3_lab_is_nearly_plain(const fp3_lab_arithmetic *arithmetic) {
    return strcmp(arithmetic->config, CONFIG) != 0 && !fp3_lab_truncates(arithmetic);
}

struct fp3_lab {
    fp3_lab_def def;
    fp3_compiled *compiled;
    fp3_batch *batch;
    double *params, *initial; /* a row for each object */
    float *column;
    fp3_error said;
};

/* ---- open and close ---- */

static fp3_status open_batch(fp3_lab *lab) {
    fp3_batch_def def = fp3_batch_default();
    def.compiled = lab->compiled;
    def.compile.config = lab->def.arithmetic->config;
    def.objects = lab->def.objects;
    def.may_compile = lab->def.is_long;
    def.error = &lab->said;
    def.may_fail = 1;
    return fp3_batch_open(&def, &lab->batch);
}

static void default_all(fp3_lab *lab) {
    const fp3_model *model = lab->def.model;
    for (size_t i = 0; i < lab->def.objects; i++) {
        for (uint32_t p = 0; p < model->param_count; p++)
            lab->params[i * model->param_count + p] =
                fp3_lab_number(lab->def.arithmetic, model->params[p].value);
        for (uint32_t s = 0; s < model->state_count; s++)
            lab->initial[i * model->state_count + s] =
                fp3_lab_number(lab->def.arithmetic, model->states[s].value);
    }
}

/* What the engine refuses is told in a place of its own. */
static fp3_status told(const fp3_lab *lab, fp3_status status, fp3_error *error) {
    return status ? fp3_fail(error, status, "%s", lab->said.text) : FP3_OK;
}

static fp3_status make(fp3_lab *lab, fp3_error *error) {
    const fp3_lab_def *def = &lab->def;
    fp3_compile_def how = fp3_compile_default();
    how.config = def->arithmetic->config;
    how.arithmetic = def->arithmetic->update;
    lab->params = calloc(def->objects * def->model->param_count + 1, sizeof *lab->params);
    lab->initial = calloc(def->objects * def->model->state_count + 1, sizeof *lab->initial);
    lab->column = calloc(def->objects, sizeof *lab->column);
    fp3_status status = lab->params && lab->initial && lab->column ? FP3_OK : fp3_no_memory(error);
    if (!status)
        status = fp3_compile(def->model, def->integrator, &how, &lab->compiled, error);
    if (status)
        return status;
    default_all(lab);
    return told(lab, open_batch(lab), error);
}

fp3_status fp3_lab_open(const fp3_lab_def *def, fp3_lab **lab, fp3_error *error) {
    *lab = calloc(1, sizeof **lab);
    if (!*lab)
        return fp3_no_memory(error);
    (*lab)->def = *def;
    const fp3_status status = make(*lab, error);
    if (status)
        fp3_lab_close(lab);
    return status;
}

void fp3_lab_close(fp3_lab **lab) {
    fp3_lab *closing = *lab;
    if (!closing)
        return;
    fp3_batch_close(&closing->batch);
    fp3_compiled_free(&closing->compiled);
    free(closing->params);
    free(closing->initial);
    free(closing->column);
    free(closing);
    *lab = NULL;
}

const fp3_compiled *fp3_lab_program(const fp3_lab *lab) { return lab->compiled; }

void fp3_lab_step(fp3_lab *lab, double h) { lab->def.h = h; }

/* ---- values ---- */

fp3_status fp3_lab_fill(fp3_lab *lab, const char *name, const double *column, fp3_error *error) {
    const fp3_model *model = lab->def.model;
    const uint32_t param = fp3_model_param(model, name), state = fp3_model_state(model, name);
    if (state == FP3_NONE && (param == FP3_NONE || model->params[param].is_shared))
        return fp3_fail(error, FP3_E_ARGUMENT, "no state or param '%s' of each object", name);
    for (size_t i = 0; i < lab->def.objects; i++)
        if (state != FP3_NONE)
            lab->initial[i * model->state_count + state] =
                fp3_lab_number(lab->def.arithmetic, column[i]);
        else
            lab->params[i * model->param_count + param] =
                fp3_lab_number(lab->def.arithmetic, column[i]);
    return FP3_OK;
}

const double *fp3_lab_params(const fp3_lab *lab, size_t object) {
    return lab->params + object * lab->def.model->param_count;
}

const double *fp3_lab_initial(const fp3_lab *lab, size_t object) {
    return lab->initial + object * lab->def.model->state_count;
}

fp3_status fp3_lab_start(fp3_lab *lab, fp3_error *error) {
    const size_t objects = lab->def.objects;
    fp3_status status = fp3_batch_restart(lab->batch);
    if (!status)
        status = fp3_engine_clear_status(fp3_batch_engine(lab->batch), 0, objects);
    if (!status)
        status = fp3_batch_set(lab->batch, "h", lab->def.h);
    if (!status)
        status = fp3_batch_write_rows(lab->batch, 0, objects, lab->params, lab->initial);
    if (!status)
        status = fp3_batch_run(lab->batch, 0); /* the engine has all */
    return told(lab, status, error);
}

fp3_status fp3_lab_run(fp3_lab *lab, uint64_t steps, fp3_error *error) {
    return told(lab, fp3_batch_run(lab->batch, steps), error);
}

static uint32_t register_of(const fp3_lab *lab, const char *state) {
    return fp3_image_find(lab->compiled->image, state, FP3_CLASS(FP3_SYMBOL_STATE))->index;
}

fp3_status fp3_lab_read(fp3_lab *lab, const char *state, double *column, fp3_error *error) {
    return told(lab, fp3_batch_read_double(lab->batch, &state, 1, 0, lab->def.objects, &column),
                error);
}

fp3_status fp3_lab_read_all(fp3_lab *lab, double *rows, fp3_error *error) {
    const uint32_t count = lab->def.model->state_count;
    double *column = calloc(lab->def.objects + 1, sizeof *column);
    fp3_status status = column ? FP3_OK : fp3_no_memory(error);
    for (uint32_t s = 0; !status && s < count; s++) {
        status = fp3_lab_read(lab, lab->def.model->states[s].name, column, error);
        for (size_t i = 0; !status && i < lab->def.objects; i++)
            rows[i * count + s] = column[i];
    }
    free(column);
    return status;
}

/* Behind the batch's back: numbers that are none, too, and nothing else begins again. */
fp3_status fp3_lab_write(fp3_lab *lab, const char *state, const double *column, fp3_error *error) {
    const int low = fp3_compiled_low(lab->compiled, fp3_model_state(lab->def.model, state));
    const size_t objects = lab->def.objects;
    for (size_t i = 0; i < objects; i++)
        lab->column[i] = (float)column[i];
    fp3_status status = fp3_engine_write(fp3_batch_engine(lab->batch), 0, objects,
                                         register_of(lab, state), lab->column);
    for (size_t i = 0; i < objects; i++)
        lab->column[i] = isfinite(column[i]) ? (float)(column[i] - (double)(float)column[i]) : 0;
    if (!status && low >= 0)
        status =
            fp3_engine_write(fp3_batch_engine(lab->batch), 0, objects, (uint32_t)low, lab->column);
    return told(lab, status, error);
}

fp3_status fp3_lab_rest(fp3_lab *lab, const char *is_marked, fp3_error *error) {
    const fp3_image *image = lab->compiled->image;
    const size_t objects = lab->def.objects;
    fp3_status status = FP3_OK;
    for (uint32_t k = 0; !status && k < image->symbol_count; k++) {
        const fp3_symbol *s = &image->symbols[k];
        if (s->symbol_class != FP3_SYMBOL_STATE)
            continue;
        status = fp3_engine_read(fp3_batch_engine(lab->batch), 0, objects, s->index, lab->column);
        for (size_t i = 0; i < objects; i++)
            lab->column[i] = is_marked[i] ? 0 : lab->column[i];
        if (!status)
            status =
                fp3_engine_write(fp3_batch_engine(lab->batch), 0, objects, s->index, lab->column);
    }
    return told(lab, status, error);
}

fp3_status fp3_lab_failure(fp3_lab *lab, fp3_failure *failure, char text[FP3_FAILURE_TEXT_SIZE],
                           fp3_error *error) {
    const fp3_status status =
        fp3_engine_failure(fp3_batch_engine(lab->batch), 0, lab->def.objects, failure);
    text[0] = '\0';
    if (!status && failure->failed)
        fp3_engine_failure_text(fp3_batch_engine(lab->batch), failure, text);
    return told(lab, status, error);
}

fp3_status fp3_lab_status(fp3_lab *lab, fp3_object_status *status, fp3_error *error) {
    return told(lab, fp3_engine_status(fp3_batch_engine(lab->batch), 0, lab->def.objects, status),
                error);
}

fp3_status fp3_lab_model(const char *text, fp3_model **model, fp3_error *error) {
    char *report = NULL;
    const fp3_status status = fp3_model_read(text, strlen(text), "stress", model, &report, error);
    free(report);
    return status;
}
