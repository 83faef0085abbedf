/* SPDX-License-Identifier: Apache-2.0 */
/* apply.c - the values of a program, for a block of objects at once: those that an image declares,
 * those that a compiled model computes from its own.
 *
 * They do not go through the fields of a batch: those keep a value for each object, and say which
 * object is wrong, where a scene has a formula for all of them, and says in which line.
 */
#include "apply.h"

#include "adaptive_image.h"
#include "values.h"
#include "values_own.h"

#include "base/host.h"
#include "base/number.h"
#include "engine/common/inside.h"
#include "field.h"
#include "relations.h"

#include <assert.h>
#include <fp3/compile.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define BLOCK 64 /* objects: their words wait together for a bus (engine/board/driver.h) */

/* 0 of the first object to 1 of the last. */
static double share_of(const fp3_apply_to *to, size_t object) {
    return to->objects > 1 ? (double)object / (double)(to->objects - 1) : 0;
}

static size_t block_of(const fp3_apply_to *to, size_t first) {
    return to->objects - first < BLOCK ? to->objects - first : BLOCK;
}

/* ---- of an image ---- */

static int image_has(const void *image, const char *name) {
    return fp3_image_find(image, name, FP3_CLASSES_HOST) != NULL;
}

/* What a field is for an object: none made, or awake, where nothing is given. */
static fp3_status word_at(const fp3_params *params, const fp3_field_table *table,
                          const fp3_field *of, double share, unsigned words, float *word,
                          int *is_spread, fp3_error *error) {
    const int has_default = of->kind == FP3_FIELD_COUNT || of->kind == FP3_FIELD_SLEPT;
    double value = 0;
    fp3_status status = FP3_OK;
    *is_spread = 0;
    if (!has_default || fp3_params_has(params, of->name))
        status = fp3_values_at(params, of->name, share, words, &value, is_spread, error);
    const char *expected = status ? NULL : fp3_field_word(table, of, value, word);
    if (expected)
        return fp3_value_wrong(params, of->name, error, "parameter '%s' is %.9g: expected %s",
                               of->name, value, expected);
    if (!status && *is_spread && of->is_shared)
        return fp3_value_wrong(params, of->name, error,
                               "parameter '%s' is spread, and the program has one for all objects",
                               of->name);
    return status;
}

static fp3_status apply_field(const fp3_params *params, const fp3_apply_to *to,
                              const fp3_field_table *table, const fp3_field *of, unsigned words,
                              fp3_error *error) {
    float column[BLOCK] = {0};
    int is_spread;
    fp3_status status = word_at(params, table, of, 0, words, &column[0], &is_spread, error);
    if (!status && of->is_shared)
        return fp3_engine_write_shared_of(to->engine, to->group, (uint32_t)of->place, 1, column);
    for (size_t i = 1; i < BLOCK; i++)
        column[i] = column[0];
    for (size_t first = 0, count; !status && first < to->objects; first += count) {
        count = block_of(to, first);
        for (size_t i = 0; !status && is_spread && i < count; i++)
            status = word_at(params, table, of, share_of(to, first + i), words, &column[i],
                             &is_spread, error);
        if (!status)
            status =
                fp3_engine_write(to->engine, to->first + first, count, (uint32_t)of->place, column);
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
    const unsigned words = fp3_values_words(image);
    fp3_field_table table;
    fp3_status status = fp3_field_list(image, NULL, 0, &table, error);
    table.needs_finite |= fp3_engine_config(to->engine)->finite != 0;
    for (uint32_t i = 0; i < table.count && !status; i++)
        status = apply_field(params, to, &table, &table.list[i], words, error);
    fp3_field_close(&table);
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
    const int is_chosen = fp3_model_chooses_steps(program->model); /* h_next is a state */
    return (strcmp(name, FP3_NAME_STEP) == 0 && !is_chosen) ||
           (strcmp(name, FP3_NAME_STEPS) == 0 && steps_input(program->compiled) != FP3_NONE) ||
           fp3_model_param(program->model, name) != FP3_NONE ||
           fp3_model_state(program->model, name) != FP3_NONE;
}

unsigned fp3_program_words(const fp3_program *program) {
    return program->compiled->arithmetic == FP3_DOUBLE_SINGLE ? 2 : 1;
}

/* *value stays its default where there is no other. */
static fp3_status take(const fp3_object_values *of, const char *name, double share, double *value,
                       int *is_spread, fp3_error *error) {
    *is_spread = 0;
    return fp3_params_has(of->given, name)
               ? fp3_values_at(of->given, name, share, fp3_program_words(of->program), value,
                               is_spread, error)
               : FP3_OK;
}

/* What does not vary is taken once. */
static fp3_status take_quantity(fp3_object_values *of, const fp3_quantity *q, double share,
                                char *is_varied, double *value, fp3_error *error) {
    int is_spread;
    if (of->is_begun && !*is_varied)
        return FP3_OK;
    *value = q->value;
    fp3_status status = take(of, q->name, share, value, &is_spread, error);
    if (!status && q->is_shared && is_spread)
        status = fp3_value_wrong(of->given, q->name, error,
                                 "parameter '%s' is spread, and the model has one for all objects",
                                 q->name);
    *is_varied = (char)is_spread;
    of->is_spread |= is_spread;
    return status;
}

/* Whether a param in the expression is given. */
static int has_given(const fp3_object_values *of, uint32_t expr) {
    const fp3_model *model = of->program->model;
    const fp3_expr *e = &model->exprs[expr];
    if (e->op == FP3_EXPR_PARAM)
        return fp3_params_has(of->given, model->params[e->index].name);
    int has = 0;
    for (int i = 0; i < 3; i++)
        has |= e->operand[i] != FP3_NONE && has_given(of, e->operand[i]);
    return has;
}

/* A start that is made of params follows those that are given, unless it is given itself. */
static void take_starts(fp3_object_values *of) {
    const fp3_model *model = of->program->model;
    double *params = of->values + model->expr_count;
    int is_evaluated = 0;
    for (uint32_t i = 0; i < model->state_count; i++) {
        const uint32_t start = model->states[i].start;
        if (start == FP3_NONE || fp3_params_has(of->given, model->states[i].name) ||
            !has_given(of, start))
            continue;
        for (uint32_t k = 0; !is_evaluated && k < model->param_count; k++)
            params[k] = fp3_number_given(of->params[k], fp3_program_words(of->program));
        if (!is_evaluated++)
            fp3_model_evaluate(model, &(fp3_point){.params = params, .states = of->initial},
                               of->values);
        of->initial[i] = of->values[start];
    }
}

static fp3_status take_h(fp3_object_values *of, double share, fp3_error *error) {
    int is_spread;
    float h;
    of->h = of->program->model->step;
    fp3_status status = take(of, FP3_NAME_STEP, share, &of->h, &is_spread, error);
    if (!status && is_spread)
        status =
            fp3_value_wrong(of->given, "h", error, "'h' is spread, and all objects have the same");
    if (!status)
        status = fp3_values_check(of->given, model_has, of->program, error);
    const char *expected = status ? NULL : fp3_number_step(of->h, &h);
    return expected
               ? fp3_value_wrong(of->given, "h", error, "'h' is %.9g: expected %s", of->h, expected)
               : status;
}

static fp3_status take_all(fp3_object_values *of, double share, fp3_error *error) {
    const fp3_model *model = of->program->model;
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; !status && i < model->param_count; i++)
        status =
            take_quantity(of, &model->params[i], share, &of->is_varied[i], &of->params[i], error);
    for (uint32_t i = 0; !status && i < model->state_count; i++)
        status = take_quantity(of, &model->states[i], share, &of->is_varied[model->param_count + i],
                               &of->initial[i], error);
    take_starts(of);
    return status || of->is_begun ? status : take_h(of, share, error);
}

/* What it refuses is made of several values: it has the place of all. */
static fp3_status compute_inputs(const fp3_object_values *of, fp3_error *error) {
    fp3_error why = {.text = ""};
    const fp3_status status =
        fp3_start_values(of->start, of->params, of->initial, of->h, 1, of->inputs, &why);
    return status == FP3_E_ARGUMENT ? fp3_value_wrong(of->given, "", error, "%s", why.text)
           : status                 ? fp3_fail(error, status, "%s", why.text)
                                    : FP3_OK;
}

/* Where an object starts in time: at h times its number of steps. */
static fp3_status take_steps(fp3_object_values *of, double share, fp3_error *error) {
    const fp3_integrator *integrator = of->program->integrator;
    const uint32_t input = steps_input(of->program->compiled);
    double n = 0;
    int is_spread = 0;
    if (input == FP3_NONE)
        return FP3_OK;
    fp3_status status = take(of, FP3_NAME_STEPS, share, &n, &is_spread, error);
    if (is_spread) /* between whole numbers it is whole but for its last bit in double */
        n = (double)(float)n;
    of->inputs[input] = (float)n;
    if (!status && !(fabs(n) <= FP3_STEPS_LIMIT && floor(n) == n))
        return fp3_value_wrong(of->given, FP3_NAME_STEPS, error,
                               "'steps' is %.9g: expected a whole number from -16777216 to "
                               "16777216",
                               n);
    if (!status && n != 0 && integrator->kind == FP3_STOERMER)
        return fp3_value_wrong(of->given, FP3_NAME_STEPS, error,
                               "'steps' is %.9g: integrator '%s' begins at 0, since it is there "
                               "that the position one step before is known",
                               n, integrator->name);
    of->is_spread |= is_spread;
    return status;
}

fp3_status fp3_object_values_open(const fp3_program *program, const fp3_params *given,
                                  fp3_object_values *of, fp3_error *error) {
    const fp3_model *model = program->model;
    assert(model && program->compiled);
    const size_t params = model->param_count, states = model->state_count;
    *of = (fp3_object_values){.program = program,
                              .given = given,
                              .is_varied = calloc(params + states + 1, 1),
                              .params = calloc(params + 1, sizeof *of->params),
                              .initial = calloc(states + 1, sizeof *of->initial),
                              .values = calloc(model->expr_count + params + 1, sizeof *of->values),
                              .inputs =
                                  calloc(program->compiled->input_count + 1u, sizeof *of->inputs)};
    return of->is_varied && of->params && of->initial && of->values && of->inputs
               ? fp3_start_open(program->compiled, NULL, 1, &of->start, error)
               : fp3_no_memory(error);
}

fp3_status fp3_object_values_at(fp3_object_values *of, double share, fp3_error *error) {
    fp3_status status = take_all(of, share, error);
    if (!status)
        status = compute_inputs(of, error);
    of->is_begun |= !status;
    return status ? status : take_steps(of, share, error);
}

void fp3_object_values_free(fp3_object_values *of) {
    fp3_start_close(&of->start);
    free(of->is_varied);
    free(of->params);
    free(of->initial);
    free(of->values);
    free(of->inputs);
    *of = (fp3_object_values){0};
}

fp3_status fp3_program_inputs(const fp3_program *program, const fp3_params *params, double share,
                              float *values, int *is_spread, fp3_error *error) {
    FP3_HOST;
    fp3_object_values of;
    fp3_status status = fp3_object_values_open(program, params, &of, error);
    if (!status)
        status = fp3_object_values_at(&of, share, error);
    for (uint32_t i = 0; !status && i < program->compiled->input_count; i++)
        values[i] = of.inputs[i];
    *is_spread = of.is_spread;
    fp3_object_values_free(&of);
    return status;
}

/* ---- what objects see of others ---- */

/* model_params: of one object; NULL: of an image. */
static fp3_status relate(const fp3_program *program, const fp3_params *params,
                         const fp3_apply_to *to, const double *model_params, fp3_error *error) {
    static const char how[] = "links = (...) of a scene or --links of fp3 run gives them";
    fp3_relations r = {.to = {.engine = to->engine,
                              .group = to->group,
                              .first = to->first,
                              .objects = to->objects,
                              .image = program->image,
                              .compiled = program->compiled},
                       .linked = params->linked,
                       .skin = params->skin < 0 ? FP3_NEAR_SKIN : params->skin};
    fp3_status status = fp3_relations_load(&r, error);
    if (!status && model_params)
        status = fp3_relations_reach(&r, model_params, error);
    return status ? status : fp3_relations_check(&r, how, error);
}

/* Columns of BLOCK values. What objects share is that of the first. */
static fp3_status write_inputs(const fp3_compiled *c, const fp3_apply_to *to, size_t first,
                               size_t count, const float *columns) {
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; !status && i < c->input_count; i++, columns += BLOCK) {
        const fp3_symbol *s = fp3_image_find(c->image, c->inputs[i].name, FP3_CLASSES_HOST);
        assert(s); /* the compiler declares its inputs */
        if (s->symbol_class != FP3_SYMBOL_SHARED)
            status = fp3_engine_write(to->engine, to->first + first, count, s->index, columns);
        else if (first == 0)
            status = fp3_engine_write_shared_of(to->engine, to->group, s->index, 1, columns);
    }
    return status;
}

static fp3_status apply_model(const fp3_program *program, const fp3_params *params,
                              const fp3_apply_to *to, fp3_error *error) {
    const uint32_t inputs = program->compiled->input_count;
    float *columns = calloc((size_t)(inputs + 1u) * BLOCK, sizeof *columns);
    fp3_object_values of = {0};
    fp3_status status =
        columns ? fp3_object_values_open(program, params, &of, error) : fp3_no_memory(error);
    for (size_t first = 0, count; !status && first < to->objects; first += count) {
        count = block_of(to, first);
        for (size_t i = 0; !status && i < count; i++) {
            if (!of.is_begun || of.is_spread)
                status = fp3_object_values_at(&of, share_of(to, first + i), error);
            for (uint32_t k = 0; k < inputs; k++)
                columns[k * BLOCK + i] = of.inputs[k];
        }
        if (!status)
            status = write_inputs(program->compiled, to, first, count, columns);
    }
    if (!status)
        status = relate(program, params, to, of.params, error);
    fp3_object_values_free(&of);
    free(columns);
    return status;
}

/* Of one object alone, the first is meant. */
static fp3_status check_columns(const fp3_params *params, const fp3_apply_to *to,
                                fp3_error *error) {
    fp3_value_look look;
    for (size_t i = 0; to->objects > 1 && fp3_values_look(params, i, &look); i++)
        if (look.objects && look.objects != to->objects)
            return fp3_value_wrong(params, look.name, error,
                                   "'%s' has values of %zu objects, and there are %zu", look.name,
                                   look.objects, to->objects);
    return FP3_OK;
}

fp3_status fp3_apply(const fp3_program *program, const fp3_params *params, const fp3_apply_to *to,
                     fp3_error *error) {
    fp3_status status = check_columns(params, to, error);
    if (status)
        return status;
    if (program->model)
        return apply_model(program, params, to, error);
    status = apply_image(program->image, params, to, error);
    return status ? status : relate(program, params, to, NULL, error);
}

fp3_status fp3_program_load(const fp3_program *program, const fp3_params *params,
                            fp3_engine *engine, fp3_error *error) {
    FP3_HOST;
    const fp3_apply_to all = {engine, 0, 0, fp3_engine_objects(engine)};
    fp3_engine_hush(error);
    fp3_status status = fp3_engine_load(engine, program->image);
    if (!status)
        status = fp3_apply(program, params, &all, error);
    return fp3_engine_hear(engine, status, error);
}
