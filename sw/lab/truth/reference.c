/* SPDX-License-Identifier: Apache-2.0 */
/* reference.c - what a step means: one operation after the other, in the order of its nodes. */
#include "base/bits.h"
#include <fp3/truth.h>

#include <fp3/isa.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/host.h"
#include "compiler/before.h"
#include "compiler/compiled.h"
#include "machine/execute.h"
#include "machine/format.h"

/* What is rounded to the machine's numbers: all; only what the host gives the program; nothing. */
typedef enum { ROUNDED, INPUTS_ROUNDED, EXACT } rounding;

/* A value: without all of the roundings; a float in IEEE 754; in other arithmetic the machine's
 * word. */
typedef union {
    double number;
    float single;
    uint32_t word;
} value;
typedef enum { NUMBERS, SINGLES, WORDS } form;

/* The nodes of a part in their order. Operands are places in `values`: a zero for those that the
 * operation does not have, known values, variables, then a place for each node. */
typedef struct {
    uint32_t op, a, b, c, to;
} operation;
typedef struct {
    operation *list;
    uint32_t count;
    uint32_t *place; /* of each node */
} part;

typedef struct {
    const fp3_step *b;
    rounding rounding;
    form form;
    const fp3_config *config; /* whose arithmetic rounds */
    part step, last;
    double *known;
    value *values, *next;
} runner;

static uint32_t place_of_known(uint32_t known) { return 1 + known; }

static uint32_t place_of_variable(const fp3_step *b, uint32_t variable) {
    return 1 + b->known.count + variable;
}

static fp3_status make_part(const fp3_step *b, const dag *g, part *p, fp3_error *error) {
    p->list = calloc(g->count + 1u, sizeof *p->list);
    p->place = calloc(g->count + 1u, sizeof *p->place);
    if (!p->list || !p->place)
        return fp3_no_memory(error);
    for (uint32_t i = 0; i < g->count; i++) {
        const dag_node *n = &g->nodes[i];
        if (n->op == NODE_KNOWN)
            p->place[i] = place_of_known(n->a);
        else if (n->op == NODE_VARIABLE)
            p->place[i] = place_of_variable(b, n->a);
        else {
            p->place[i] = place_of_variable(b, b->variable_count) + p->count;
            p->list[p->count++] =
                (operation){n->op, p->place[n->a], n->b == FP3_NONE ? 0 : p->place[n->b],
                            n->c == FP3_NONE ? 0 : p->place[n->c], p->place[i]};
        }
    }
    return FP3_OK;
}

static void close_part(part *p) {
    free(p->list);
    free(p->place);
}

/* What the host gives the program. */
static fp3_status give(const runner *r, double x, value *given, fp3_error *error) {
    uint32_t word;
    given->number = x;
    if (r->rounding == EXACT)
        return FP3_OK;
    const char *wrong = fp3_format_written(r->config, (float)x, &word);
    if (wrong)
        return fp3_fail(error, FP3_E_ARGUMENT, "%g %s: configuration '%s' has no word for it", x,
                        wrong, r->config->name);
    if (r->form == WORDS)
        given->word = word;
    else if (r->form == SINGLES)
        given->single = fp3_value_of(word);
    else
        given->number = (double)fp3_format_value(r->config, word);
    return FP3_OK;
}

/* Known values that the program has. */
static fp3_status give_known(const runner *r, const dag *g, fp3_error *error) {
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; !status && i < g->count; i++) {
        const dag_node *n = &g->nodes[i];
        if (n->op == NODE_KNOWN)
            status = give(r, r->known[n->a], &r->values[place_of_known(n->a)], error);
    }
    return status;
}

static double number_of(const runner *r, value x) {
    return r->form == NUMBERS   ? x.number
           : r->form == SINGLES ? (double)x.single
                                : (double)fp3_format_value(r->config, x.word);
}

/* Most of a step is sums and products. They are written out, and not as a switch: a call of each
 * takes three times as long, the jumps of a table twice. */
static void evaluate_numbers(value *v, const operation *o, const operation *end) {
    for (; o < end; o++) {
        const double a = v[o->a].number, b = v[o->b].number, c = v[o->c].number;
        v[o->to].number = o->op == FP3_OP_ADD    ? a + b
                          : o->op == FP3_OP_SUB  ? a - b
                          : o->op == FP3_OP_MUL  ? a * b
                          : o->op == FP3_OP_MADD ? c + a * b
                          : o->op == FP3_OP_MSUB ? c - a * b
                                                 : fp3_execute_exact(o->op, a, b, c);
    }
}

/* One quiet NaN: operations on bits see no other. */
static uint32_t bits_of(float x) { return isnan(x) ? FP3_BITS_NAN : fp3_bits_of(x); }

static float execute_single(const fp3_config *config, uint32_t op, float a, float b, float c) {
    const uint32_t operands[3] = {bits_of(a), bits_of(b), bits_of(c)};
    return fp3_value_of(fp3_execute(config, op, operands, NULL));
}

static void evaluate_singles(const fp3_config *config, value *v, const operation *o,
                             const operation *end) {
    for (; o < end; o++) {
        const float a = v[o->a].single, b = v[o->b].single, c = v[o->c].single;
        v[o->to].single = o->op == FP3_OP_ADD    ? a + b
                          : o->op == FP3_OP_SUB  ? a - b
                          : o->op == FP3_OP_MUL  ? a * b
                          : o->op == FP3_OP_MADD ? c + a * b
                          : o->op == FP3_OP_MSUB ? c - a * b
                                                 : execute_single(config, o->op, a, b, c);
    }
}

static void evaluate_words(const fp3_config *config, value *v, const operation *o,
                           const operation *end) {
    for (; o < end; o++) {
        const uint32_t operands[3] = {v[o->a].word, v[o->b].word, v[o->c].word};
        v[o->to].word = fp3_execute(config, o->op, operands, NULL);
    }
}

static void evaluate(const runner *r, const part *p) {
    const operation *end = p->list + p->count;
    if (r->form == NUMBERS)
        evaluate_numbers(r->values, p->list, end);
    else if (r->form == SINGLES)
        evaluate_singles(r->config, r->values, p->list, end);
    else
        evaluate_words(r->config, r->values, p->list, end);
}

static void step(const runner *r) {
    const fp3_step *b = r->b;
    evaluate(r, &r->step);
    for (uint32_t i = 0; i < b->variable_count; i++)
        r->next[i] = r->values[r->step.place[b->variables[i].next]];
    memcpy(r->values + place_of_variable(b, 0), r->next, b->variable_count * sizeof *r->next);
}

/* A run without a step executes no last part. */
static void look(const runner *r, int is_run, double *states, double *low) {
    const fp3_step *b = r->b;
    evaluate(r, &r->last);
    for (uint32_t i = 0; i < b->variable_count; i++) {
        const variable *v = &b->variables[i];
        double *to = v->role == ROLE_STATE ? states : v->role == ROLE_LOW ? low : NULL;
        if (to)
            to[v->state] =
                number_of(r, r->values[is_run && v->last != FP3_NONE ? r->last.place[v->last]
                                                                     : place_of_variable(b, i)]);
    }
}

/* In double, the first word and the first half of it have all, and a start loses nothing. */
static void join_words(const fp3_step *b, double *known, double *start) {
    for (uint32_t i = 0; i < b->known.count; i++) {
        const known_op op = b->known.list[i].op;
        if (op == KNOWN_HEAD)
            known[i] = known[b->known.list[i].a];
        else if (op == KNOWN_LOW || op == KNOWN_TAIL)
            known[i] = 0;
    }
    for (uint32_t i = 0; i < b->variable_count; i++)
        if (b->variables[i].role == ROLE_LOW || b->variables[i].role == ROLE_LOW_BEFORE ||
            b->variables[i].role == ROLE_LOST_BEFORE)
            start[i] = 0;
}

/* start: of each variable; it is overwritten. states: in row i, of each state of the model that is
 * a variable, its value after steps[i] steps. Where not all is rounded, estimates are what they
 * estimate. */
static fp3_status run_from(const fp3_step *b, const fp3_config *config, const double *params,
                           double h, rounding rounding, double *start, const uint64_t *steps,
                           size_t count, double *states, double *low, fp3_error *error) {
    const uint32_t most = b->values.count > b->last.count ? b->values.count : b->last.count;
    const form form = rounding != ROUNDED                                 ? NUMBERS
                      : fp3_execute_is_of_words(config) || config->finite ? WORDS
                                                                          : SINGLES;
    runner r = {.b = b,
                .rounding = rounding,
                .form = form,
                .config = config,
                .known = calloc(b->known.count + 1u, sizeof *r.known),
                .next = calloc(b->variable_count + 1u, sizeof *r.next),
                .values = calloc(place_of_variable(b, b->variable_count) + most, sizeof *r.values)};
    fp3_status status =
        r.known && r.next && r.values
            ? fp3_known_evaluate(&b->known, params, h, rounding == EXACT, r.known, error)
            : fp3_no_memory(error);
    uint64_t made = 0;
    if (!status && rounding != ROUNDED)
        join_words(b, r.known, start);
    if (!status)
        status = make_part(b, &b->values, &r.step, error);
    if (!status)
        status = make_part(b, &b->last, &r.last, error);
    if (!status)
        status = give_known(&r, &b->values, error);
    if (!status)
        status = give_known(&r, &b->last, error);
    for (uint32_t i = 0; !status && i < b->variable_count; i++) {
        value *variable = &r.values[place_of_variable(b, i)];
        if (rounding == ROUNDED)
            status = give(&r, start[i], variable, error);
        else
            variable->number = start[i];
    }
    for (size_t i = 0; !status && i < count; i++) {
        for (; made < steps[i]; made++)
            step(&r);
        const size_t row = i * b->model->state_count;
        look(&r, made > 0, states + row, low ? low + row : NULL);
    }
    close_part(&r.step);
    close_part(&r.last);
    free(r.known);
    free(r.next);
    free(r.values);
    return status;
}

/* IEEE 754 rounds to nearest, unless words are no floats: then the configuration does it in its
 * way. Its inverses are its own. */
static fp3_status run(const fp3_compilation *k, const double *params, const double *initial,
                      double h, rounding rounding, const uint64_t *steps, size_t count,
                      double *states, double *low, fp3_error *error) {
    const fp3_config *own = k->options.config;
    const fp3_config ieee = {.nearest = 1, .subnormal = 1, .fraction = 23, .mixed = own->mixed};
    const fp3_config *config = fp3_format_is_float(own) ? &ieee : own;
    const fp3_step *b = &k->reference;
    const int is_counted = fp3_step_find(b, ROLE_STEPS, FP3_NONE) != FP3_NONE;
    const uint64_t limit = (uint64_t)fp3_format_counts(config);
    if (is_counted && count && steps[count - 1] > limit)
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "%" PRIu64 " steps of equations with t: %s counts to %" PRIu64,
                        steps[count - 1], config == own ? own->name : "FP32", limit);
    fp3_status status = fp3_model_check_alone(b->model, error);
    if (status)
        return status;
    double *start = calloc(b->variable_count + 1u, sizeof *start);
    status = start ? FP3_OK : fp3_no_memory(error);
    if (!status)
        status = fp3_before_start(b, params, initial, h, 1, start, error);
    if (!status)
        status = run_from(b, config, params, h, rounding, start, steps, count, states, low, error);
    free(start);
    return status;
}

static float canonical(double x) {
    const float f = (float)x;
    return isnan(f) ? fp3_value_of(FP3_BITS_NAN) : f;
}

fp3_status fp3_compiled_reference_pairs(const fp3_compiled *compiled, const double *params,
                                        const double *initial, double h, const uint64_t *steps,
                                        size_t count, float *states, float *low, fp3_error *error) {
    FP3_HOST;
    const fp3_compilation *k = compiled->self;
    const size_t cells = count * k->reference.model->state_count;
    double *wide = calloc(2 * cells + 1u, sizeof *wide);
    if (!wide)
        return fp3_no_memory(error);
    for (size_t i = 0; i < cells; i++)
        wide[i] = states[i];
    const fp3_status status =
        run(k, params, initial, h, ROUNDED, steps, count, wide, wide + cells, error);
    for (size_t i = 0; !status && i < cells; i++) {
        states[i] = canonical(wide[i]);
        if (low)
            low[i] = canonical(wide[cells + i]);
    }
    free(wide);
    return status;
}

fp3_status fp3_compiled_reference(const fp3_compiled *compiled, const double *params,
                                  const double *initial, double h, const uint64_t *steps,
                                  size_t count, float *states, fp3_error *error) {
    FP3_HOST;
    return fp3_compiled_reference_pairs(compiled, params, initial, h, steps, count, states, NULL,
                                        error);
}

fp3_status fp3_compiled_exact(const fp3_compiled *compiled, const double *params,
                              const double *initial, double h, const uint64_t *steps, size_t count,
                              double *states, fp3_error *error) {
    FP3_HOST;
    const fp3_compilation *k = compiled->self;
    return run(k, params, initial, h, EXACT, steps, count, states, NULL, error);
}

fp3_status fp3_compiled_exact_given(const fp3_compiled *compiled, const double *params,
                                    const double *initial, double h, const uint64_t *steps,
                                    size_t count, double *states, fp3_error *error) {
    FP3_HOST;
    const fp3_compilation *k = compiled->self;
    const rounding rounding = k->options.arithmetic == FP3_DOUBLE_SINGLE ? EXACT : INPUTS_ROUNDED;
    return run(k, params, initial, h, rounding, steps, count, states, NULL, error);
}
