/* SPDX-License-Identifier: Apache-2.0 */
/* evaluator.c - see evaluator.h. */
#include "evaluator.h"

#include "base/number.h"
#include "language/evaluate.h"
#include "world/apply.h"

#include <fp3/compile.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

struct fp3_evaluator {
    const fp3_model *model;
    size_t room;
    char *is_needed;                /* of each expression */
    uint32_t *needed, needed_count; /* in their order, so that operands come first */
    float *states[64];              /* of the block; NULL: not needed */
    float *low[64];                 /* their second words; NULL: they have none */
    uint32_t reg[64];
    int low_reg[64];
    int steps;      /* register of `steps`, or -1 */
    uint32_t own_t; /* adaptive steps: the state that is the object's t; else FP3_NONE */
    float *made;    /* what it holds, of the block; NULL: not needed */
    double *values; /* of all expressions, for one object */
    double *params; /* a row of param_count for each object, or one for all */
    int is_spread;
    size_t first; /* of the block */
    double t;     /* of the snapshot, where no object counts */
    double h;
};

fp3_status fp3_evaluator_open(const fp3_program *program, size_t room, fp3_evaluator **evaluator,
                              fp3_error *error) {
    const fp3_model *model = program->model;
    fp3_evaluator *e = *evaluator = calloc(1, sizeof *e);
    if (e) {
        e->model = model;
        e->room = room;
        e->steps = -1;
        e->own_t = fp3_model_adapted(model);
        e->is_needed = calloc(model->expr_count + 1u, sizeof *e->is_needed);
        e->needed = calloc(model->expr_count + 1u, sizeof *e->needed);
        e->values = calloc(model->expr_count + 1u, sizeof *e->values);
    }
    return e && e->is_needed && e->needed && e->values ? FP3_OK : fp3_no_memory(error);
}

void fp3_evaluator_free(fp3_evaluator **evaluator) {
    fp3_evaluator *e = *evaluator;
    *evaluator = NULL;
    if (!e)
        return;
    for (size_t i = 0; i < sizeof e->states / sizeof *e->states; i++)
        free(e->states[i]), free(e->low[i]);
    free(e->is_needed);
    free(e->needed);
    free(e->made);
    free(e->values);
    free(e->params);
    free(e);
}

static fp3_status make_room(const fp3_evaluator *e, float **block, fp3_error *error) {
    if (!*block && !(*block = calloc(e->room, sizeof **block)))
        return fp3_no_memory(error);
    return FP3_OK;
}

static fp3_status need_state(fp3_evaluator *e, const fp3_program *program, uint32_t state,
                             fp3_error *error) {
    const char *name = e->model->states[state].name;
    const fp3_symbol *symbol = fp3_image_find(program->image, name, FP3_CLASS(FP3_SYMBOL_STATE));
    if (!symbol)
        return fp3_fail(error, FP3_E_ARGUMENT, "the program has no state '%s'", name);
    e->reg[state] = symbol->index;
    e->low_reg[state] = fp3_compiled_low(program->compiled, state);
    const fp3_status status = e->low_reg[state] < 0 ? FP3_OK : make_room(e, &e->low[state], error);
    return status ? status : make_room(e, &e->states[state], error);
}

/* Where an object counts its time, or holds it. */
static fp3_status need_time(fp3_evaluator *e, const fp3_program *program, fp3_error *error) {
    if (e->own_t != FP3_NONE)
        return need_state(e, program, e->own_t, error);
    e->steps = fp3_image_steps(program->image);
    return e->steps < 0 ? FP3_OK : make_room(e, &e->made, error);
}

/* Operands stand in front of what they are for. */
static fp3_status need(fp3_evaluator *e, const fp3_program *program, fp3_error *error) {
    fp3_status status = FP3_OK;
    e->needed_count = 0;
    for (uint32_t i = e->model->expr_count; i-- > 0;)
        for (unsigned j = 0; e->is_needed[i] && j < fp3_ode_operands(e->model->exprs[i].op); j++)
            e->is_needed[e->model->exprs[i].operand[j]] = 1;
    for (uint32_t i = 0; !status && i < e->model->expr_count; i++) {
        if (!e->is_needed[i])
            continue;
        e->needed[e->needed_count++] = i;
        if (e->model->exprs[i].op == FP3_EXPR_STATE)
            status = need_state(e, program, e->model->exprs[i].index, error);
        if (!status && e->model->exprs[i].op == FP3_EXPR_TIME)
            status = need_time(e, program, error);
        if (!status && fp3_expr_is_fold(e->model->exprs[i].op))
            return fp3_fail(
                error, FP3_E_ARGUMENT,
                "'%s' is added up in line %u of the model, and a recording looks at each "
                "object by itself",
                e->model->relations[e->model->exprs[i].index].name,
                (unsigned)e->model->exprs[i].line);
    }
    return status;
}

fp3_status fp3_evaluator_add(fp3_evaluator *e, const fp3_program *program, uint32_t expr,
                             fp3_error *error) {
    e->is_needed[expr] = 1;
    return need(e, program, error);
}

/* ---- what objects were given ---- */

fp3_status fp3_evaluator_begin(fp3_evaluator *e, const fp3_source *source, fp3_error *error) {
    const size_t count = e->model->param_count;
    const unsigned words = fp3_program_words(source->program);
    const double last = source->objects > 1 ? (double)(source->objects - 1) : 1;
    fp3_object_values of;
    fp3_status status = fp3_object_values_open(source->program, source->params, &of, error);
    free(e->params);
    e->h = source->h;
    e->params = calloc(source->objects * count + 1, sizeof *e->params);
    if (!status && !e->params)
        status = fp3_no_memory(error);
    for (size_t i = 0; !status && (!i || of.is_spread) && i < source->objects; i++) {
        status = fp3_object_values_at(&of, (double)i / last, error);
        for (size_t k = 0; k < count; k++)
            e->params[i * count + k] = fp3_number_given(of.params[k], words);
    }
    e->is_spread = of.is_spread;
    fp3_object_values_free(&of);
    return status;
}

/* ---- a block ---- */

fp3_status fp3_evaluator_read(fp3_evaluator *e, const fp3_source *source, uint64_t step,
                              size_t first, size_t count) {
    const size_t at = source->first + first;
    fp3_status status = FP3_OK;
    e->first = first;
    e->t = (double)step * e->h;
    for (uint32_t i = 0; !status && i < e->model->state_count; i++)
        if (e->states[i])
            status = fp3_engine_read(source->engine, at, count, e->reg[i], e->states[i]);
    for (uint32_t i = 0; !status && i < e->model->state_count; i++)
        if (e->low[i])
            status = fp3_engine_read(source->engine, at, count, (uint32_t)e->low_reg[i], e->low[i]);
    if (!status && e->made)
        status = fp3_engine_read(source->engine, at, count, (uint32_t)e->steps, e->made);
    return status;
}

const double *fp3_evaluator_values(fp3_evaluator *e, size_t i) {
    double states[64];
    const size_t row = e->is_spread ? (e->first + i) * e->model->param_count : 0;
    for (uint32_t s = 0; s < e->model->state_count; s++)
        states[s] =
            (e->states[s] ? (double)e->states[s][i] : NAN) + (e->low[s] ? (double)e->low[s][i] : 0);
    const fp3_point point = {.states = states,
                             .params = &e->params[row],
                             .t = e->own_t != FP3_NONE ? states[e->own_t]
                                  : e->made            ? (double)e->made[i] * e->h
                                                       : e->t};
    for (uint32_t n = 0; n < e->needed_count; n++)
        e->values[e->needed[n]] =
            fp3_ode_compute(&e->model->exprs[e->needed[n]], &point, e->values);
    return e->values;
}
