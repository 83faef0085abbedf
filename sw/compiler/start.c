/* SPDX-License-Identifier: Apache-2.0 */
/* start.c - values of a program's inputs, rounded once. */
#include "start.h"

#include <float.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/host.h"
#include "base/number.h"
#include "before.h"
#include "compiled.h"
#include "compiler/adaptive/adapted.h"
#include "inputs.h"

#define TINY 0x1p-50
#define FAR_BELOW 0x1p-20

/* Where an input comes from: a variable of the step, or a known value. */
typedef struct {
    uint32_t variable, known; /* FP3_NONE: not from there */
} origin;

struct fp3_start {
    const fp3_compiled *compiled;
    const fp3_compilation *compilation;
    origin *origins;           /* of each input */
    uint32_t *wanted, count;   /* inputs */
    uint32_t *poor;            /* those of them that have no room in FP32 for some object */
    int has_variables;         /* some of them are variables */
    fp3_known_subset subset;   /* of the others */
    double *known, *variables; /* columns */
};

/* In the order of fp3_inputs_make. */
static origin origin_of(const fp3_compilation *k, uint32_t input) {
    const fp3_step *step = &k->p.step;
    const conversion *c = &k->p.code;
    for (uint32_t i = 0; i < step->variable_count; i++)
        if (fp3_inputs_has_variable(&step->variables[i]) && input-- == 0)
            return (origin){i, FP3_NONE};
    if (input < c->code.param_count)
        return (origin){FP3_NONE, c->params[input]};
    input -= c->code.param_count;
    for (uint32_t i = 0; i < c->code.constant_count; i++)
        if (fp3_inputs_has_constant(step, c, i) && input-- == 0)
            return (origin){FP3_NONE, c->constants[i]};
    return (origin){FP3_NONE, FP3_NONE};
}

static fp3_status choose(fp3_start *s, const char *is_wanted, size_t most, fp3_error *error) {
    const known_table *table = &s->compilation->p.step.known;
    char *is_known_wanted = calloc(table->count + 1u, 1);
    fp3_status status = is_known_wanted ? FP3_OK : fp3_no_memory(error);
    for (uint32_t i = 0; !status && i < s->compiled->input_count; i++) {
        if (is_wanted && !is_wanted[i])
            continue;
        const origin o = s->origins[i] = origin_of(s->compilation, i);
        s->wanted[s->count++] = i;
        if (o.known == FP3_NONE)
            s->has_variables = 1;
        else
            is_known_wanted[o.known] = 1;
    }
    if (!status)
        status = fp3_known_choose(table, is_known_wanted, most, &s->subset, error);
    free(is_known_wanted);
    return status;
}

fp3_status fp3_start_open(const fp3_compiled *compiled, const char *is_wanted, size_t most,
                          fp3_start **start, fp3_error *error) {
    const fp3_compilation *k = compiled->self;
    fp3_start *s = *start = calloc(1, sizeof *s);
    if (!s)
        return fp3_no_memory(error);
    s->compiled = compiled;
    s->compilation = k;
    s->origins = calloc(compiled->input_count + 1u, sizeof *s->origins);
    s->wanted = calloc(compiled->input_count + 1u, sizeof *s->wanted);
    s->poor = calloc(compiled->input_count + 1u, sizeof *s->poor);
    s->known = malloc((k->p.step.known.count * most + 1u) * sizeof *s->known);
    s->variables = malloc((k->p.step.variable_count * most + 1u) * sizeof *s->variables);
    fp3_status status = s->origins && s->wanted && s->poor && s->known && s->variables
                            ? FP3_OK
                            : fp3_no_memory(error);
    if (!status)
        status = choose(s, is_wanted, most, error);
    if (status)
        fp3_start_close(start);
    return status;
}

void fp3_start_close(fp3_start **start) {
    fp3_start *s = *start;
    if (!s)
        return;
    fp3_known_release(&s->subset);
    free(s->origins);
    free(s->wanted);
    free(s->poor);
    free(s->known);
    free(s->variables);
    free(s);
    *start = NULL;
}

/* ---- values ---- */

/* " (line 3 of the model)", or nothing. */
static void say_line(const fp3_compilation *k, uint32_t id, char *text, size_t size) {
    const uint32_t line = id == FP3_NONE ? 0 : fp3_known_line(&k->p.step.known, id);
    text[0] = '\0';
    if (line)
        snprintf(text, size, " (line %" PRIu32 " of the model)", line);
}

/* What a host gives: params and starts. */
typedef struct {
    const double *params, *initial; /* columns */
    double h;
    size_t count;
} gift;

/* The values of one object and the values computed from them, with 0 for values on their way to 0:
 * computed when the first input needs them. */
typedef struct {
    double *params, *initial, *known, *variables;
    size_t made; /* 1 + the object's number; 0: none is made */
    int is_good;
} vanished;

static fp3_status vanished_open(const fp3_start *s, vanished *v, fp3_error *error) {
    const fp3_step *step = &s->compilation->p.step;
    const size_t params = step->model->param_count, states = step->model->state_count;
    const size_t size = params + states + step->known.count + step->variable_count;
    *v = (vanished){.params = malloc((size + 1u) * sizeof *v->params)};
    if (!v->params)
        return fp3_no_memory(error);
    v->initial = v->params + params;
    v->known = v->initial + states;
    v->variables = v->known + step->known.count;
    return FP3_OK;
}

int fp3_start_vanishes(double value, double usual) {
    const int is_far = usual == 0 || fabs(value) < FAR_BELOW * fabs(usual);
    return is_far && fabs(value) < TINY;
}

static void vanish(const double *columns, const fp3_quantity *of, uint32_t width, size_t count,
                   size_t object, double *row) {
    for (uint32_t i = 0; i < width; i++) {
        const double value = columns[i * count + object];
        row[i] = fp3_start_vanishes(value, of[i].value) ? copysign(0, value) : value;
    }
}

static void vanished_make(const fp3_start *s, const gift *g, size_t object, vanished *v) {
    const fp3_step *step = &s->compilation->p.step;
    const fp3_model *model = step->model;
    vanish(g->params, model->params, model->param_count, g->count, object, v->params);
    vanish(g->initial, model->states, model->state_count, g->count, object, v->initial);
    fp3_known_values(&s->subset, v->params, g->h, 1, v->known);
    v->is_good = !s->has_variables ||
                 !fp3_before_start(step, v->params, v->initial, g->h, 1, v->variables, NULL);
    v->made = object + 1;
}

/* Whether an input is too small because the values behind it are. Then it becomes 0, and so does
 * *value. A product of numbers that are not small is refused, because it shows that the units do
 * not suit FP32. */
static int vanishes(const fp3_start *s, uint32_t input, const gift *g, size_t object, vanished *v,
                    float *value) {
    const origin o = s->origins[input];
    if (v->made != object + 1)
        vanished_make(s, g, object, v);
    if (!v->is_good)
        return 0;
    const double now = o.known == FP3_NONE ? v->variables[o.variable] : v->known[o.known];
    *value = (float)now;
    return now == 0;
}

/* Whether all have room in FP32. */
static int round_column(const double *wanted, size_t count, float *values) {
    int is_good = 1;
    for (size_t i = 0; i < count; i++) {
        values[i] = (float)wanted[i];
        is_good &= fabsf(values[i]) <= FLT_MAX && (values[i] != 0 || wanted[i] == 0);
    }
    return is_good;
}

/* The column of an input. */
static const double *column_of(const fp3_start *s, uint32_t input, size_t count) {
    const origin o = s->origins[input];
    return o.known == FP3_NONE ? s->variables + o.variable * count : s->known + o.known * count;
}

static fp3_status check_room(const fp3_start *s, uint32_t input, const gift *g, size_t object,
                             vanished *v, float *value, fp3_error *error) {
    const double wanted = column_of(s, input, g->count)[object];
    float single;
    char line[48];
    const char *expected = fp3_number_single(wanted, &single);
    if (!expected && !isfinite(single))
        expected = isnan(wanted) ? "a finite number, and none below 2.2e-308 on the way"
                                 : "a finite number";
    if (!expected || ((single == 0 || isnan(single)) && vanishes(s, input, g, object, v, value)))
        return FP3_OK;
    say_line(s->compilation, s->origins[input].known, line, sizeof line);
    return fp3_fail(error, FP3_E_ARGUMENT, "%s%s is %.9g: expected %s",
                    s->compiled->inputs[input].formula, line, wanted, expected);
}

/* Object by object, so that what an object's inputs vanish with is made once. */
static fp3_status check_all(const fp3_start *s, const gift *g, uint32_t poor_count, float *values,
                            fp3_error *error) {
    vanished v;
    fp3_status status = vanished_open(s, &v, error);
    for (size_t object = 0; !status && object < g->count; object++)
        for (uint32_t i = 0; !status && i < poor_count; i++)
            status = check_room(s, s->poor[i], g, object, &v,
                                &values[s->poor[i] * g->count + object], error);
    free(v.params);
    return status;
}

static fp3_status round_all(const fp3_start *s, const gift *g, float *values, fp3_error *error) {
    uint32_t poor_count = 0;
    for (uint32_t i = 0; i < s->count; i++) {
        const uint32_t input = s->wanted[i];
        if (!round_column(column_of(s, input, g->count), g->count, values + input * g->count))
            s->poor[poor_count++] = input;
    }
    return poor_count ? check_all(s, g, poor_count, values, error) : FP3_OK;
}

fp3_status fp3_start_values(fp3_start *s, const double *params, const double *initial, double h,
                            size_t count, float *values, fp3_error *error) {
    const fp3_compilation *k = s->compilation;
    const fp3_step *step = &k->p.step;
    float single;
    const char *expected = fp3_number_step(h, &single);
    if (expected)
        return fp3_fail(error, FP3_E_ARGUMENT, "h is %.9g: expected %s", h, expected);
    fp3_known_values(&s->subset, params, h, count, s->known);
    fp3_status status = fp3_adapted_check(step->model, &k->options, params, initial, count, error);
    if (!status && s->has_variables)
        status = fp3_before_start(step, params, initial, h, count, s->variables, error);
    const gift g = {params, initial, h, count};
    return status ? status : round_all(s, &g, values, error);
}

fp3_status fp3_compiled_inputs(const fp3_compiled *compiled, const double *params,
                               const double *initial, double h, float *values, fp3_error *error) {
    FP3_HOST;
    fp3_start *start = NULL;
    fp3_status status = fp3_start_open(compiled, NULL, 1, &start, error);
    if (!status)
        status = fp3_start_values(start, params, initial, h, 1, values, error);
    fp3_start_close(&start);
    return status;
}

/* ---- what a program is made of ---- */

const fp3_model *fp3_start_model(const fp3_compiled *compiled) {
    return ((const fp3_compilation *)compiled->self)->p.step.model;
}

/* The param of the model that a known value is; FP3_NONE: it is none. */
static uint32_t param_of(const fp3_compilation *k, uint32_t id) {
    const known *value = id == FP3_NONE ? NULL : &k->p.step.known.list[id];
    if (!value || value->op != KNOWN_MODEL)
        return FP3_NONE;
    const fp3_expr *e = &k->p.step.model->exprs[value->a];
    return e->op == FP3_EXPR_PARAM ? e->index : FP3_NONE;
}

uint32_t fp3_start_param(const fp3_compiled *compiled, uint32_t input) {
    const fp3_compilation *k = compiled->self;
    return param_of(k, origin_of(k, input).known);
}

uint32_t fp3_start_low_param(const fp3_compiled *compiled, uint32_t input) {
    const fp3_compilation *k = compiled->self;
    const origin o = origin_of(k, input);
    const known *value = o.known == FP3_NONE ? NULL : &k->p.step.known.list[o.known];
    return value && value->op == KNOWN_LOW ? param_of(k, value->a) : FP3_NONE;
}
