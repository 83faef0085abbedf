/* SPDX-License-Identifier: Apache-2.0 */
/* field.c - see field.h. */
#include "field.h"

#include "base/nearest.h"
#include "base/number.h"
#include "compiler/compiled.h"
#include "compiler/inputs.h"
#include "compiler/start.h"

#include <fp3/compile.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static fp3_field *add(fp3_field_table *t, const char *name, fp3_field_kind kind) {
    fp3_field *q = &t->list[t->count++];
    *q = (fp3_field){.name = name, .kind = kind, .place = -1, .low = -1, .lost = -1};
    return q;
}

/* ---- of an image ---- */

static void list_image(const fp3_image *image, fp3_field_table *t) {
    const int slept = fp3_image_slept(image);
    for (uint32_t i = 0; i < image->symbol_count; i++) {
        const fp3_symbol *s = &image->symbols[i];
        const int is_shared = s->symbol_class == FP3_SYMBOL_SHARED;
        const int is_state = s->symbol_class == FP3_SYMBOL_STATE;
        const int is_count = !is_shared && !strcmp(s->name, FP3_NAME_STEPS);
        if (!(FP3_CLASS(s->symbol_class) & FP3_CLASSES_HOST))
            continue;
        const fp3_field_kind kind = is_shared && !strcmp(s->name, FP3_NAME_STEP) ? FP3_FIELD_STEP
                                    : is_count                                   ? FP3_FIELD_COUNT
                                    : is_state && (int)s->index == slept         ? FP3_FIELD_SLEPT
                                    : is_state                                   ? FP3_FIELD_STATE
                                                                                 : FP3_FIELD_PARAM;
        fp3_field *q = add(t, s->name, kind);
        q->is_shared = is_shared;
        q->place = (int)s->index;
    }
}

/* ---- of a model ---- */

static int place_of(const fp3_compiled *c, uint32_t input) {
    return (int)fp3_image_find(c->image, c->inputs[input].name, FP3_CLASSES_HOST)->index;
}

/* Of a variable that has this role for a state; -1: there is none, or no word for it. */
static int place_of_role(const fp3_compiled *c, role role, uint32_t state) {
    const fp3_step *step = &((const fp3_compilation *)c->self)->p.step;
    uint32_t input = 0;
    for (uint32_t i = 0; i < step->variable_count; i++) {
        const variable *v = &step->variables[i];
        if (v->role == role && v->state == state && fp3_inputs_has_variable(v))
            return place_of(c, input);
        input += (uint32_t)fp3_inputs_has_variable(v);
    }
    return -1;
}

static int has_before(const fp3_compiled *c, uint32_t states) {
    for (uint32_t i = 0; i < states; i++)
        if (place_of_role(c, ROLE_BEFORE, i) >= 0)
            return 1;
    return 0;
}

/* A param that is nothing but an input of each object is kept where the engine has it. */
static void place_param(const fp3_compiled *c, int is_adapted, fp3_field *q) {
    const uint64_t bit = (uint64_t)1 << q->index;
    q->is_kept = is_adapted || q->is_shared;
    for (uint32_t i = 0; i < c->input_count; i++)
        if (fp3_start_param(c, i) == q->index && !c->inputs[i].is_shared)
            q->place = place_of(c, i);
        else if (c->inputs[i].params & bit)
            q->is_kept = 1;
    q->is_kept |= q->place < 0;
    q->is_pending = !q->is_kept;
}

/* For each expression the params in it, a bit each. Operands stand before their users. */
static void find_params(const fp3_model *model, uint64_t *params) {
    for (uint32_t i = 0; i < model->expr_count; i++) {
        const fp3_expr *e = &model->exprs[i];
        params[i] = e->op == FP3_EXPR_PARAM ? (uint64_t)1 << e->index : 0;
        for (int k = 0; k < 3; k++)
            params[i] |= e->operand[k] < i ? params[e->operand[k]] : 0;
    }
}

static void list_model(const fp3_compiled *c, double h, const uint64_t *params,
                       fp3_field_table *t) {
    const fp3_model *model = t->model;
    const int is_adapted = fp3_model_adapted(model) != FP3_NONE;
    for (uint32_t i = 0; i < model->param_count; i++) {
        if (fp3_model_is_foreign(model, i))
            continue; /* nobody gives the words of others, and 0 stands where they are not */
        fp3_field *q = add(t, model->params[i].name, FP3_FIELD_PARAM);
        q->index = i;
        q->is_shared = model->params[i].is_shared;
        q->uniform = q->usual = model->params[i].value;
        place_param(c, is_adapted, q);
    }
    for (uint32_t i = 0; i < model->state_count; i++) {
        fp3_field *q = add(t, model->states[i].name, FP3_FIELD_STATE);
        q->index = i;
        q->is_kept = 1;
        q->uniform = q->usual = model->states[i].value;
        q->place = place_of_role(c, ROLE_STATE, i);
        q->low = place_of_role(c, ROLE_LOW, i);
        q->lost = place_of_role(c, ROLE_LOST, i);
        if (model->states[i].start != FP3_NONE)
            q->follows = q->followed = params[model->states[i].start];
    }
    t->has_before = has_before(c, model->state_count);
    const int count = fp3_image_steps(c->image);
    t->has_count = count >= 0;
    if (t->has_count) {
        fp3_field *q = add(t, FP3_NAME_STEPS, FP3_FIELD_COUNT);
        q->place = count;
        q->is_pending = 1;
    }
    if (!fp3_model_chooses_steps(model)) { /* else each object has its own steps */
        fp3_field *q = add(t, FP3_NAME_STEP, FP3_FIELD_STEP);
        q->is_shared = q->is_kept = 1;
        q->uniform = h;
    }
}

/* ---- all ---- */

fp3_status fp3_field_list(const fp3_image *image, const fp3_compiled *compiled, double h,
                          fp3_field_table *table, fp3_error *error) {
    const fp3_model *model = compiled ? fp3_start_model(compiled) : NULL;
    const size_t most =
        (model ? model->param_count + model->state_count : image->symbol_count) + 2u;
    *table = (fp3_field_table){
        .list = calloc(most, sizeof *table->list), .model = model, .needs_finite = model != NULL};
    uint64_t *params = calloc(model ? model->expr_count + 1u : 1u, sizeof *params);
    if (!table->list || !params) {
        free(params);
        return fp3_no_memory(error);
    }
    if (model) {
        find_params(model, params);
        list_model(compiled, h, params, table);
    } else {
        list_image(image, table);
    }
    free(params);
    return FP3_OK;
}

void fp3_field_close(fp3_field_table *table) {
    for (uint32_t i = 0; i < table->count; i++) {
        free(table->list[i].column);
        free(table->list[i].is_given);
    }
    free(table->list);
    *table = (fp3_field_table){0};
}

fp3_field *fp3_field_find(const fp3_field_table *table, const char *name, fp3_error *error) {
    const fp3_token wanted = {.text = name, .length = strlen(name)};
    const char *near = NULL;
    for (uint32_t i = 0; i < table->count; i++) {
        if (strcmp(table->list[i].name, name) == 0)
            return &table->list[i];
        fp3_nearest(wanted, table->list[i].name, &near);
    }
    fp3_fail(error, FP3_E_ARGUMENT, "the %s has no '%s'%s%s%s", table->model ? "model" : "program",
             name, near ? "; did you mean '" : "", near ? near : "", near ? "'?" : "");
    return NULL;
}

const char *fp3_field_word(const fp3_field_table *table, const fp3_field *q, double value,
                           float *word) {
    if (q->kind == FP3_FIELD_STEP)
        return fp3_number_step(value, word);
    if (q->kind == FP3_FIELD_COUNT) {
        *word = (float)value;
        return table->has_before && value != 0 ? "0, where the position one step before is known"
               : fabs(value) <= FP3_STEPS_LIMIT && floor(value) == value
                   ? NULL
                   : "a whole number from -16777216 to 16777216";
    }
    if (q->kind == FP3_FIELD_SLEPT) {
        if (!(value >= 0 && value <= UINT32_MAX && floor(value) == value))
            return "the number of a step, an integer from 0 to 4294967295";
        const uint32_t step = (uint32_t)value;
        memcpy(word, &step, sizeof step);
        return NULL;
    }
    const int is_param = table->model && q->kind == FP3_FIELD_PARAM;
    const char *expected =
        is_param && !fp3_start_vanishes(value, table->model->params[q->index].value)
            ? fp3_number_single(value, word)
            : fp3_number_written(value, word);
    return !expected && table->needs_finite && !isfinite(*word) ? "a finite number" : expected;
}
