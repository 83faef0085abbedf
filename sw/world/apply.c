/* SPDX-License-Identifier: Apache-2.0 */
/* apply.c - the values of a program, from scenes and files to the fields of its objects. */
#include "apply.h"

#include "adaptive_image.h"
#include "values.h"
#include "values_own.h"

#include "base/host.h"
#include "base/number.h"
#include "engine/common/inside.h"
#include "fields.h"
#include "relations.h"

#include <assert.h>
#include <fp3/compile.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define BLOCK 4096 /* objects whose values are on their way together, if they differ */

/* 0 of the first object to 1 of the last. */
static double share_of(const fp3_apply_to *to, size_t object) {
    return to->objects > 1 ? (double)object / (double)(to->objects - 1) : 0;
}

/* ---- of an image ---- */

static int image_has(const void *image, const char *name) {
    return fp3_image_find(image, name, FP3_CLASSES_HOST) != NULL;
}

static fp3_status check_image(const fp3_image *image, const fp3_params *params,
                              const fp3_apply_to *to, fp3_error *error) {
    fp3_status status = FP3_OK;
    int is_spread = 1;
    for (size_t i = 0; !status && is_spread && i < to->objects; i++)
        status = fp3_adaptive_image_check(image, params, share_of(to, i), &is_spread, error);
    return status ? status : fp3_values_check(params, image_has, image, error);
}

/* ---- of a model ---- */

/* Whether the equations have t, which is made of the number of steps. */
static int has_steps(const fp3_program *program) { return fp3_image_steps(program->image) >= 0; }

static int model_has(const void *of, const char *name) {
    const fp3_program *program = of;
    const int is_chosen = fp3_model_chooses_steps(program->model); /* h_next is a state */
    const uint32_t param = fp3_model_param(program->model, name);
    return (strcmp(name, FP3_NAME_STEP) == 0 && !is_chosen) ||
           (strcmp(name, FP3_NAME_STEPS) == 0 && has_steps(program)) ||
           (param != FP3_NONE && !fp3_model_is_foreign(program->model, param)) ||
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
                                 "'%s' is spread, and all objects have the same", q->name);
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

/* Where an object starts in time: at h times its number of steps. */
static fp3_status take_steps(fp3_object_values *of, double share, fp3_error *error) {
    const fp3_integrator *integrator = of->program->integrator;
    double n = 0;
    int is_spread = 0;
    if (!has_steps(of->program))
        return FP3_OK;
    fp3_status status = take(of, FP3_NAME_STEPS, share, &n, &is_spread, error);
    if (is_spread) /* between whole numbers it is whole but for its last bit in double */
        n = (double)(float)n;
    of->steps = n;
    if (!status && !(fabs(n) <= FP3_STEPS_LIMIT && floor(n) == n))
        return fp3_value_wrong(of->given, FP3_NAME_STEPS, error,
                               "'steps' is %.9g: expected a whole number from -16777216 to "
                               "16777216",
                               n);
    if (!status && n != 0 && integrator->kind == FP3_STOERMER)
        return fp3_value_wrong(of->given, FP3_NAME_STEPS, error,
                               "'steps' is %.9g: integrator '%s' begins at 0, because the position "
                               "one step before is known only there",
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
                              .values = calloc(model->expr_count + params + 1, sizeof *of->values)};
    return of->is_varied && of->params && of->initial && of->values ? FP3_OK : fp3_no_memory(error);
}

fp3_status fp3_object_values_at(fp3_object_values *of, double share, fp3_error *error) {
    const fp3_status status = take_all(of, share, error);
    of->is_begun |= !status;
    return status ? status : take_steps(of, share, error);
}

/* What is made of several values has the place of all. */
static fp3_status place(const fp3_params *params, const char *name, fp3_status status,
                        const fp3_error *why, fp3_error *error) {
    if (!status || !why->text[0]) /* the engine has said why */
        return status;
    return status == FP3_E_ARGUMENT ? fp3_value_wrong(params, name, error, "%s", why->text)
                                    : fp3_fail(error, status, "%s", why->text);
}

fp3_status fp3_object_values_inputs(const fp3_object_values *of, float *inputs, fp3_error *error) {
    const fp3_compiled *c = of->program->compiled;
    fp3_error why = {.text = ""};
    const fp3_status status = fp3_compiled_inputs(c, of->params, of->initial, of->h, inputs, &why);
    for (uint32_t i = 0; !status && i < c->input_count; i++)
        if (strcmp(c->inputs[i].name, FP3_NAME_STEPS) == 0)
            inputs[i] = (float)of->steps;
    return place(of->given, "", status, &why, error);
}

void fp3_object_values_free(fp3_object_values *of) {
    free(of->is_varied);
    free(of->params);
    free(of->initial);
    free(of->values);
    *of = (fp3_object_values){0};
}

fp3_status fp3_program_inputs(const fp3_program *program, const fp3_params *params, double share,
                              float *values, int *is_spread, fp3_error *error) {
    FP3_HOST;
    fp3_object_values of;
    fp3_status status = fp3_object_values_open(program, params, &of, error);
    if (!status)
        status = fp3_object_values_at(&of, share, error);
    if (!status)
        status = fp3_object_values_inputs(&of, values, error);
    *is_spread = of.is_spread;
    fp3_object_values_free(&of);
    return status;
}

/* ---- all fields of a group ---- */

typedef struct {
    const fp3_program *program;
    const fp3_params *params;
    const fp3_apply_to *to;
    fp3_field_table table;
    fp3_object_values of; /* of a model */
    double *columns;      /* of each field, a block each */
    char *is_varied;      /* of each field: objects differ */
    int is_spread;        /* of some field */
} load;

/* Nothing given: no steps are made, and all objects are awake. */
static fp3_status take_of_image(load *l, const fp3_field *f, double share, double *value,
                                char *is_varied, fp3_error *error) {
    const int has_default = f->kind == FP3_FIELD_COUNT || f->kind == FP3_FIELD_SLEPT;
    int is_spread = 0;
    *value = 0;
    if (has_default && !fp3_params_has(l->params, f->name))
        return FP3_OK;
    const fp3_status status = fp3_values_at(
        l->params, f->name, share, fp3_values_words(l->program->image), value, &is_spread, error);
    *is_varied = (char)is_spread;
    l->is_spread |= is_spread;
    return status || !is_spread || !f->is_shared
               ? status
               : fp3_value_wrong(l->params, f->name, error,
                                 "'%s' is spread, but is one value for all objects", f->name);
}

static double of_model(const load *l, const fp3_field *f) {
    return f->kind == FP3_FIELD_PARAM   ? l->of.params[f->index]
           : f->kind == FP3_FIELD_STATE ? l->of.initial[f->index]
           : f->kind == FP3_FIELD_STEP  ? l->of.h
                                        : l->of.steps;
}

/* The values of an object, as number i of the block. */
static fp3_status take_object(load *l, size_t object, size_t i, fp3_error *error) {
    const double share = share_of(l->to, object);
    const int is_model = l->program->model != NULL;
    fp3_status status = is_model ? fp3_object_values_at(&l->of, share, error) : FP3_OK;
    l->is_spread |= is_model && l->of.is_spread;
    for (uint32_t k = 0; !status && k < l->table.count; k++) {
        const fp3_field *f = &l->table.list[k];
        double *value = &l->columns[(size_t)k * BLOCK + i];
        if (is_model) {
            *value = of_model(l, f);
            l->is_varied[k] = (char)(l->is_spread && !f->is_shared);
        } else if (!object || l->is_varied[k])
            status = take_of_image(l, f, share, value, &l->is_varied[k], error);
    }
    return status;
}

/* What objects share goes into each block again: other inputs of its objects are made of it. */
static fp3_status put_block(load *l, fp3_fields *fields, size_t count, fp3_error *error) {
    fp3_status status = FP3_OK;
    fp3_error why = {.text = ""};
    for (uint32_t k = 0; !status && k < l->table.count; k++) {
        const char *name = l->table.list[k].name;
        const double *column = l->columns + (size_t)k * BLOCK;
        status = l->is_varied[k]
                     ? fp3_fields_write(fields, name, 0, count, (fp3_numbers){.wide = column}, &why)
                     : fp3_fields_set(fields, name, column[0], &why);
        status = place(l->params, name, status, &why, error);
    }
    if (status)
        return status;
    status = fp3_fields_settle(fields, &why);
    return place(l->params, "", status, &why, error);
}

static fp3_status load_block(load *l, size_t first, size_t count, fp3_error *error) {
    const fp3_fields_def def = {.engine = l->to->engine,
                                .group = l->to->group,
                                .first = l->to->first + first,
                                .objects = count,
                                .number = first,
                                .image = l->program->image,
                                .compiled = l->program->compiled,
                                .h = l->of.h};
    fp3_fields *fields = NULL;
    fp3_status status = FP3_OK;
    for (size_t i = first ? 0 : 1; !status && l->is_spread && i < count; i++)
        status = take_object(l, first + i, i, error);
    if (!status)
        status = fp3_fields_open(&def, &fields, error);
    if (!status)
        status = put_block(l, fields, count, error);
    fp3_fields_close(&fields);
    return status;
}

/* One block, if all objects are alike. */
static fp3_status load_all(load *l, fp3_error *error) {
    const size_t objects = l->to->objects;
    fp3_status status = take_object(l, 0, 0, error);
    for (size_t first = 0, count; !status && first < objects; first += count) {
        count = l->is_spread && objects - first > BLOCK ? BLOCK : objects - first;
        status = load_block(l, first, count, error);
    }
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
    load l = {.program = program, .params = params, .to = to};
    status = fp3_field_list(program->image, program->compiled, 0, &l.table, error);
    l.columns = calloc((l.table.count + 1u) * (size_t)BLOCK, sizeof *l.columns);
    l.is_varied = calloc(l.table.count + 1u, 1);
    if (!status && !(l.columns && l.is_varied))
        status = fp3_no_memory(error);
    if (!status && program->model)
        status = fp3_object_values_open(program, params, &l.of, error);
    if (!status)
        status = load_all(&l, error);
    if (!status && !program->model)
        status = check_image(program->image, params, to, error);
    if (to->h && program->model)
        *to->h = l.of.h;
    if (!status)
        status = relate(program, params, to, l.of.params, error);
    fp3_object_values_free(&l.of);
    fp3_field_close(&l.table);
    free(l.columns);
    free(l.is_varied);
    return status;
}

fp3_status fp3_program_load(const fp3_program *program, const fp3_params *params,
                            fp3_engine *engine, fp3_error *error) {
    FP3_HOST;
    const fp3_apply_to all = {
        .engine = engine, .group = 0, .first = 0, .objects = fp3_engine_objects(engine)};
    fp3_engine_hush(error);
    fp3_status status = fp3_engine_load(engine, program->image);
    if (!status)
        status = fp3_apply(program, params, &all, error);
    return fp3_engine_hear(engine, status, error);
}
