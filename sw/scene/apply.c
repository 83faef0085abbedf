/* apply.c - the values of a program, object by object: those that an image declares, those that a
 * compiled model computes from its own. */
#include "apply.h"

#include "adaptive_image.h"
#include "values.h"

#include "text/number.h"

#include <assert.h>
#include <fp3/compile.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* 0 of the first object to 1 of the last. */
static double share_of(const fp3_apply_to *to, size_t object) {
    return to->objects > 1 ? (double)object / (double)(to->objects - 1) : 0;
}

/* ---- of an image ---- */

static int image_has(const void *image, const char *name) {
    return fp3_image_find(image, name, FP3_CLASSES_HOST) != NULL;
}

/* How a value becomes the word of a register or constant. */
typedef enum { WORD_NUMBER, WORD_H, WORD_SLEPT, WORD_STEPS } word_kind;

static word_kind kind_of(const fp3_symbol *symbol, int slept) {
    if (symbol->symbol_class == FP3_SYMBOL_SHARED)
        return strcmp(symbol->name, FP3_NAME_STEP) == 0 ? WORD_H : WORD_NUMBER;
    if (strcmp(symbol->name, FP3_NAME_STEPS) == 0)
        return WORD_STEPS;
    return symbol->symbol_class == FP3_SYMBOL_STATE && (int)symbol->index == slept ? WORD_SLEPT
                                                                                   : WORD_NUMBER;
}

/* NULL, or what is expected instead. */
static const char *word_of(double value, word_kind kind, float *word) {
    if (kind == WORD_NUMBER)
        return fp3_number_single(value, word);
    if (kind == WORD_H)
        return fp3_number_step(value, word);
    if (kind == WORD_STEPS) {
        *word = (float)value;
        return fabs(value) <= FP3_STEPS_LIMIT && floor(value) == value
                   ? NULL
                   : "a whole number from -16777216 to 16777216";
    }
    if (!(value >= 0 && value <= UINT32_MAX && floor(value) == value))
        return "the number of a step, an integer from 0 to 4294967295";
    const uint32_t step = (uint32_t)value;
    memcpy(word, &step, sizeof step);
    return NULL;
}

/* What a symbol is for an object. */
static fp3_status word_at(const fp3_params *params, const fp3_symbol *symbol, word_kind kind,
                          double share, float *word, int *is_spread, fp3_error *error) {
    double value = 0;
    fp3_status status = FP3_OK;
    *is_spread = 0;
    const int has_default = kind == WORD_STEPS || kind == WORD_SLEPT; /* none made; awake */
    if (!has_default || fp3_params_has(params, symbol->name))
        status = fp3_values_at(params, symbol->name, share, &value, is_spread, error);
    const char *expected = status ? NULL : word_of(value, kind, word);
    return expected
               ? fp3_value_wrong(params, symbol->name, error, "parameter '%s' is %.9g: expected %s",
                                 symbol->name, value, expected)
               : status;
}

static fp3_status apply_shared(const fp3_params *params, const fp3_apply_to *to,
                               const fp3_symbol *symbol, fp3_error *error) {
    float word;
    int is_spread = 0;
    fp3_status status = word_at(params, symbol, kind_of(symbol, -1), 0, &word, &is_spread, error);
    if (!status && is_spread)
        status = fp3_value_wrong(
            params, symbol->name, error,
            "parameter '%s' is spread, and the program has one for all objects", symbol->name);
    return status ? status
                  : fp3_engine_write_shared_of(to->engine, to->group, symbol->index, 1, &word);
}

static fp3_status apply_object(const fp3_params *params, const fp3_apply_to *to,
                               const fp3_symbol *symbol, word_kind kind, fp3_error *error) {
    float word = 0;
    int is_spread = 1;
    fp3_status status = FP3_OK;
    for (size_t i = 0; !status && i < to->objects; i++) {
        if (is_spread)
            status = word_at(params, symbol, kind, share_of(to, i), &word, &is_spread, error);
        if (!status)
            status = fp3_engine_write(to->engine, to->first + i, 1, symbol->index, &word);
    }
    return status;
}

static fp3_status check_adaptive(const fp3_image *image, const fp3_params *params,
                                 const fp3_apply_to *to, fp3_error *error) {
    fp3_status status = FP3_OK;
    int is_spread = 1;
    for (size_t i = 0; !status && is_spread && i < to->objects; i++)
        status = fp3_adaptive_image_check(image, params, share_of(to, i), &is_spread, error);
    return status;
}

static fp3_status apply_image(const fp3_image *image, const fp3_params *params,
                              const fp3_apply_to *to, fp3_error *error) {
    const int slept = fp3_image_slept(image);
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; i < image->symbol_count && !status; i++) {
        const fp3_symbol *symbol = &image->symbols[i];
        if (symbol->symbol_class == FP3_SYMBOL_SHARED)
            status = apply_shared(params, to, symbol, error);
        else if (FP3_CLASS(symbol->symbol_class) & FP3_CLASSES_HOST)
            status = apply_object(params, to, symbol, kind_of(symbol, slept), error);
    }
    if (!status)
        status = check_adaptive(image, params, to, error);
    return status ? status : fp3_values_check(params, image_has, image, error);
}

/* ---- of a model ---- */

/* Which input is the number of steps made; FP3_NONE: the equations have no t. */
static uint32_t steps_input(const fp3_compiled *c) {
    for (uint32_t i = 0; i < c->input_count; i++)
        if (strcmp(c->inputs[i].name, FP3_NAME_STEPS) == 0)
            return i;
    return FP3_NONE;
}

static int model_has(const void *of, const char *name) {
    const fp3_program *program = of;
    const int is_adapted = fp3_model_adapted(program->model) != FP3_NONE; /* h_next is a state */
    return (strcmp(name, FP3_NAME_STEP) == 0 && !is_adapted) ||
           (strcmp(name, FP3_NAME_STEPS) == 0 && steps_input(program->compiled) != FP3_NONE) ||
           fp3_model_param(program->model, name) != FP3_NONE ||
           fp3_model_state(program->model, name) != FP3_NONE;
}

/* *value stays its default where there is no other. */
static fp3_status take(const fp3_params *params, const char *name, double share, double *value,
                       int *is_spread, fp3_error *error) {
    *is_spread = 0;
    return fp3_params_has(params, name)
               ? fp3_values_at(params, name, share, value, is_spread, error)
               : FP3_OK;
}

static fp3_status take_quantity(const fp3_params *params, const fp3_quantity *q, double share,
                                double *value, int *is_any_spread, fp3_error *error) {
    int is_spread;
    *value = q->value;
    fp3_status status = take(params, q->name, share, value, &is_spread, error);
    if (!status && q->is_shared && is_spread)
        status = fp3_value_wrong(params, q->name, error,
                                 "parameter '%s' is spread, and the model has one for all objects",
                                 q->name);
    *is_any_spread |= is_spread;
    return status;
}

static fp3_status take_all(const fp3_model *model, const fp3_params *params, double share,
                           fp3_object_values *to, fp3_error *error) {
    fp3_status status = FP3_OK;
    int is_spread = 0;
    for (uint32_t i = 0; !status && i < model->param_count; i++)
        status =
            take_quantity(params, &model->params[i], share, &to->params[i], &to->is_spread, error);
    for (uint32_t i = 0; !status && i < model->state_count; i++)
        status =
            take_quantity(params, &model->states[i], share, &to->initial[i], &to->is_spread, error);
    to->h = model->step;
    if (!status)
        status = take(params, FP3_NAME_STEP, share, &to->h, &is_spread, error);
    if (!status && is_spread)
        status =
            fp3_value_wrong(params, "h", error, "'h' is spread, and all objects have the same");
    return status;
}

/* What it refuses is made of several values: it has the place of all. */
static fp3_status inputs_of(const fp3_program *program, const fp3_params *params,
                            const fp3_object_values *of, float *values, fp3_error *error) {
    float h;
    const char *expected = fp3_number_step(of->h, &h);
    if (expected)
        return fp3_value_wrong(params, "h", error, "'h' is %.9g: expected %s", of->h, expected);
    fp3_error why = {.text = ""};
    const fp3_status status =
        fp3_compiled_inputs(program->compiled, of->params, of->initial, of->h, values, &why);
    return status == FP3_E_ARGUMENT ? fp3_value_wrong(params, "", error, "%s", why.text)
           : status                 ? fp3_fail(error, status, "%s", why.text)
                                    : FP3_OK;
}

/* Where an object starts in time: at h times its number of steps. */
static fp3_status take_steps(const fp3_program *program, const fp3_params *params, double share,
                             float *values, int *is_any_spread, fp3_error *error) {
    const uint32_t input = steps_input(program->compiled);
    double n = 0;
    int is_spread = 0;
    if (input == FP3_NONE)
        return FP3_OK;
    fp3_status status = take(params, FP3_NAME_STEPS, share, &n, &is_spread, error);
    if (is_spread) /* between whole numbers it is whole but for its last bit in double */
        n = (double)(float)n;
    const char *expected = status ? NULL : word_of(n, WORD_STEPS, &values[input]);
    if (expected)
        return fp3_value_wrong(params, FP3_NAME_STEPS, error, "'steps' is %.9g: expected %s", n,
                               expected);
    if (!status && n != 0 && program->integrator->kind == FP3_STOERMER)
        return fp3_value_wrong(params, FP3_NAME_STEPS, error,
                               "'steps' is %.9g: integrator '%s' begins at 0, since it is there "
                               "that the position one step before is known",
                               n, program->integrator->name);
    *is_any_spread |= is_spread;
    return status;
}

fp3_status fp3_apply_values(const fp3_program *program, const fp3_params *params, double share,
                            fp3_object_values *of, float *values, fp3_error *error) {
    const fp3_model *model = program->model;
    assert(model && program->compiled);
    *of = (fp3_object_values){.params = calloc(model->param_count + 1u, sizeof(double)),
                              .initial = calloc(model->state_count + 1u, sizeof(double))};
    fp3_status status =
        of->params && of->initial ? FP3_OK : fp3_fail(error, FP3_E_SYSTEM, "out of memory");
    if (!status)
        status = take_all(model, params, share, of, error);
    if (!status)
        status = fp3_values_check(params, model_has, program, error);
    if (!status)
        status = inputs_of(program, params, of, values, error);
    return status ? status : take_steps(program, params, share, values, &of->is_spread, error);
}

void fp3_object_values_free(fp3_object_values *of) {
    free(of->params);
    free(of->initial);
    *of = (fp3_object_values){0};
}

fp3_status fp3_program_inputs(const fp3_program *program, const fp3_params *params, double share,
                              float *values, int *is_spread, fp3_error *error) {
    fp3_object_values of;
    fp3_status status = fp3_apply_values(program, params, share, &of, values, error);
    *is_spread = of.is_spread;
    fp3_object_values_free(&of);
    return status;
}

static fp3_status write_inputs(const fp3_compiled *c, const fp3_apply_to *to, size_t object,
                               const float *values) {
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; !status && i < c->input_count; i++) {
        const fp3_symbol *s = fp3_image_find(c->image, c->inputs[i].name, FP3_CLASSES_HOST);
        assert(s); /* the compiler declares its inputs */
        if (s->symbol_class != FP3_SYMBOL_SHARED)
            status = fp3_engine_write(to->engine, to->first + object, 1, s->index, &values[i]);
        else if (object == 0)
            status = fp3_engine_write_shared_of(to->engine, to->group, s->index, 1, &values[i]);
    }
    return status;
}

static fp3_status apply_model(const fp3_program *program, const fp3_params *params,
                              const fp3_apply_to *to, fp3_error *error) {
    float *values = calloc(program->compiled->input_count + 1u, sizeof *values);
    fp3_status status = values ? FP3_OK : fp3_fail(error, FP3_E_SYSTEM, "out of memory");
    int is_spread = 1;
    for (size_t i = 0; !status && i < to->objects; i++) {
        if (is_spread)
            status =
                fp3_program_inputs(program, params, share_of(to, i), values, &is_spread, error);
        if (!status)
            status = write_inputs(program->compiled, to, i, values);
    }
    free(values);
    return status;
}

fp3_status fp3_apply(const fp3_program *program, const fp3_params *params, const fp3_apply_to *to,
                     fp3_error *error) {
    return program->model ? apply_model(program, params, to, error)
                          : apply_image(program->image, params, to, error);
}

fp3_status fp3_program_load(const fp3_program *program, const fp3_params *params,
                            fp3_engine *engine, fp3_error *error) {
    const fp3_apply_to all = {engine, 0, 0, fp3_engine_objects(engine)};
    fp3_status status = fp3_engine_load(engine, program->image);
    return status ? status : fp3_apply(program, params, &all, error);
}
