/* SPDX-License-Identifier: Apache-2.0 */
/* known.c - values that the host computes. */
#include "known.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/number.h"
#include "language/loss.h"

static uint32_t add(known_table *table, known wanted) {
    for (uint32_t i = 0; i < table->count; i++) {
        const known *k = &table->list[i];
        if (k->op == wanted.op && k->a == wanted.a && k->b == wanted.b &&
            memcmp(&k->number, &wanted.number, sizeof k->number) == 0)
            return i;
    }
    if (table->count == table->room) {
        const uint32_t room = table->room ? 2 * table->room : 64;
        known *list = realloc(table->list, room * sizeof *list);
        if (!list) {
            table->has_failed = 1;
            return 0;
        }
        table->list = list;
        table->room = room;
    }
    table->list[table->count] = wanted;
    return table->count++;
}

/* For each expression of the model, whether no param is in it that is_wanted. */
static char *find_without(const fp3_model *model, int (*is_wanted)(const fp3_quantity *param)) {
    char *without = malloc(model->expr_count + 1);
    for (uint32_t i = 0; without && i < model->expr_count; i++) {
        const fp3_expr *e = &model->exprs[i];
        without[i] = e->op != FP3_EXPR_PARAM || !is_wanted(&model->params[e->index]);
        for (int j = 0; j < 3; j++)
            if (e->operand[j] != FP3_NONE && !without[e->operand[j]])
                without[i] = 0;
    }
    return without;
}

/* Operands are compared as what they are the same as. */
static int is_alike(const fp3_expr *a, const fp3_expr *b, const uint32_t *same) {
    for (int j = 0; j < 3; j++) {
        const uint32_t x = a->operand[j], y = b->operand[j];
        if (x != y && (x == FP3_NONE || y == FP3_NONE || same[x] != same[y]))
            return 0;
    }
    return a->op == b->op && a->index == b->index &&
           memcmp(&a->number, &b->number, sizeof a->number) == 0;
}

/* A param has a node wherever it is read: what is made of params alike is one value. */
static uint32_t *find_same(const fp3_model *model) {
    uint32_t *same = malloc((model->expr_count + 1) * sizeof *same);
    uint32_t *firsts = malloc((model->expr_count + 1) * sizeof *firsts), count = 0;
    for (uint32_t i = 0; same && firsts && i < model->expr_count; i++) {
        uint32_t k = 0;
        same[i] = i;
        if (!model->exprs[i].is_known)
            continue;
        while (k < count && !is_alike(&model->exprs[i], &model->exprs[firsts[k]], same))
            k++;
        if (k == count)
            firsts[count++] = i;
        same[i] = firsts[k];
    }
    if (!firsts) {
        free(same);
        same = NULL;
    }
    free(firsts);
    return same;
}

static int is_single(const fp3_quantity *param) { return !param->is_shared; }
static int is_any(const fp3_quantity *param) { return (void)param, 1; }

void fp3_known_open(known_table *table, const fp3_model *model, unsigned words) {
    *table = (known_table){.model = model,
                           .words = words,
                           .is_shared = find_without(model, is_single),
                           .is_constant = find_without(model, is_any),
                           .same = find_same(model)};
    table->has_failed = !table->is_shared || !table->is_constant || !table->same;
    if (!table->has_failed)
        fp3_known_number(table, 0.0);
}

void fp3_known_close(known_table *table) {
    free(table->list);
    free(table->is_shared);
    free(table->same);
    free(table->is_constant);
    *table = (known_table){0};
}

uint32_t fp3_known_number(known_table *table, double number) {
    return add(table,
               (known){.op = KNOWN_NUMBER, .number = number, .exact = number, .is_shared = 1});
}

void fp3_known_stands_for(known_table *table, double number, double exact) {
    const uint32_t id = fp3_known_number(table, number);
    if (!table->has_failed)
        table->list[id].exact = exact;
}

uint32_t fp3_known_step(known_table *table) {
    return add(table, (known){.op = KNOWN_STEP, .is_shared = 1});
}

uint32_t fp3_known_model(known_table *table, uint32_t expr) {
    const fp3_expr *e = &table->model->exprs[expr];
    if (e->op == FP3_EXPR_NUMBER)
        return fp3_known_number(table, e->number);
    if (e->op == FP3_EXPR_NEGATE)
        return fp3_known_make(table, KNOWN_NEGATE, fp3_known_model(table, e->operand[0]), 0);
    return add(
        table,
        (known){.op = KNOWN_MODEL, .a = table->same[expr], .is_shared = table->is_shared[expr]});
}

void fp3_known_seen(known_table *table, uint32_t expr) {
    const uint32_t param = fp3_known_model(table, expr);
    if (table->words > 1)
        fp3_known_make(table, KNOWN_LOW, param, 0);
}

uint32_t fp3_known_param(known_table *table, const char *name) {
    const fp3_model *model = table->model;
    const uint32_t param = fp3_model_param(model, name);
    uint32_t e = 0;
    while (model->exprs[e].op != FP3_EXPR_PARAM || model->exprs[e].index != param)
        e++;
    return fp3_known_model(table, e);
}

int fp3_known_constant(known_table *table, uint32_t expr, double *value) {
    const fp3_model *model = table->model;
    if (table->has_failed || !model->exprs[expr].is_known || !table->is_constant[expr])
        return 0;
    double *exprs = malloc((model->expr_count + 1) * sizeof *exprs);
    double *zeros = calloc(model->state_count + model->param_count + 1u, sizeof *zeros);
    if (exprs && zeros) {
        fp3_model_evaluate(model, &(fp3_point){.states = zeros, .params = zeros}, exprs);
        *value = exprs[expr];
    } else
        table->has_failed = 1;
    free(exprs);
    free(zeros);
    return !table->has_failed;
}

/* See known.h, also of the next. */
static double as_exponent(double a) {
    return a == 0 || isnan(a) ? a : copysign(fmin(fmax(fabs(a), 0x1p-52), 0x1p40), a);
}

static double sign_of_power(double a) {
    return a != trunc(a) ? 0 : fmod(a, 2) == 0 ? 1 : -1; /* of a NaN 0 */
}

/* The 12 bits of a float that products of halves are made of; of a zero or an infinity itself. */
static double head_of(float a) {
    int exponent;
    const double fraction = frexp((double)a, &exponent);
    return a == 0 || !isfinite(a) ? (double)a : ldexp(rint(fraction * 0x1p12), exponent - 12);
}

static int is_unary(known_op op) { return op >= KNOWN_EXPONENT; }

double fp3_known_low(double value) {
    const double single = (double)(float)value;
    return isfinite(single) ? (double)(float)(value - single) : 0;
}

static double of_one(known_op op, double a) {
    const float single = (float)a;
    switch (op) {
    case KNOWN_EXPONENT:
        return as_exponent(a);
    case KNOWN_SIGN:
        return sign_of_power(a);
    case KNOWN_LOW:
        return fp3_known_low(a);
    case KNOWN_HEAD:
        return head_of(single);
    default: /* KNOWN_TAIL */
        return (double)single - head_of(single);
    }
}

/* As an expression whose operands are known values. */
static fp3_expr expr_of(known_op op, uint32_t a, uint32_t b) {
    static const fp3_expr_op ops[KNOWN_TAIL + 1] = {[KNOWN_NEGATE] = FP3_EXPR_NEGATE,
                                                    [KNOWN_ADD] = FP3_EXPR_ADD,
                                                    [KNOWN_SUB] = FP3_EXPR_SUB,
                                                    [KNOWN_MUL] = FP3_EXPR_MUL,
                                                    [KNOWN_DIV] = FP3_EXPR_DIV};
    return (fp3_expr){.op = ops[op], .operand = {a, b, FP3_NONE}};
}

/* Of two numbers. 0: what double has no room for is left to fp3_known_evaluate. */
static int fold(known_op op, double a, double b, double *result) {
    if (is_unary(op)) {
        *result = of_one(op, a);
        return 1;
    }
    double values[3] = {a, b, 0};
    char is_lost[3] = {0};
    const fp3_expr e = expr_of(op, 0, 1);
    fp3_ode_compute_careful(&e, NULL, 2, values, is_lost);
    *result = values[2];
    return !is_lost[2];
}

uint32_t fp3_known_make(known_table *table, known_op op, uint32_t a, uint32_t b) {
    const known *x = &table->list[a], *y = &table->list[b];
    double number, exact;
    if (x->op == KNOWN_NUMBER && y->op == KNOWN_NUMBER && fold(op, x->number, y->number, &number)) {
        if (fold(op, x->exact, y->exact, &exact) && exact != number && !isnan(exact))
            fp3_known_stands_for(table, number, exact);
        return fp3_known_number(table, number);
    }
    if (op == KNOWN_NEGATE && x->op == KNOWN_NEGATE)
        return x->a;
    if (op == KNOWN_MUL && x->op == KNOWN_NUMBER && x->number == 1)
        return b;
    if ((op == KNOWN_MUL || op == KNOWN_DIV) && y->op == KNOWN_NUMBER && y->number == 1)
        return a;
    return add(table, (known){.op = op, .a = a, .b = b, .is_shared = x->is_shared && y->is_shared});
}

static uint64_t params_of(const fp3_model *model, uint32_t expr) {
    const fp3_expr *e = &model->exprs[expr];
    uint64_t params = e->op == FP3_EXPR_PARAM ? UINT64_C(1) << e->index : 0;
    for (int j = 0; j < 3; j++)
        if (e->operand[j] != FP3_NONE)
            params |= params_of(model, e->operand[j]);
    return params;
}

uint64_t fp3_known_params(const known_table *table, uint32_t id, int *has_h) {
    const known *k = &table->list[id];
    int a_has = 0, b_has = 0;
    *has_h = k->op == KNOWN_STEP;
    if (k->op == KNOWN_MODEL)
        return params_of(table->model, k->a);
    if (k->op == KNOWN_NUMBER || k->op == KNOWN_STEP)
        return 0;
    const uint64_t params =
        fp3_known_params(table, k->a, &a_has) | fp3_known_params(table, k->b, &b_has);
    *has_h = a_has || b_has;
    return params;
}

uint32_t fp3_known_line(const known_table *table, uint32_t id) {
    const known *k = &table->list[id];
    if (k->op == KNOWN_MODEL)
        return table->model->exprs[k->a].line;
    if (k->op == KNOWN_NUMBER || k->op == KNOWN_STEP)
        return 0;
    const uint32_t line = fp3_known_line(table, k->a);
    return line ? line : fp3_known_line(table, k->b);
}

int fp3_known_is(const known_table *table, uint32_t id, double number) {
    const known *k = &table->list[id];
    return k->op == KNOWN_NUMBER && memcmp(&k->number, &number, sizeof number) == 0;
}

void fp3_known_release(fp3_known_subset *s) {
    free(s->ids);
    free(s->exprs);
    free(s->expr_values);
    free(s->param_row);
    free(s->row);
    free(s->is_expr_lost);
    free(s->is_lost);
    *s = (fp3_known_subset){0};
}

/* Operands stand in front of what they are for. */
static void list_chosen(const known_table *table, char *is_wanted, char *is_expr_wanted,
                        fp3_known_subset *s) {
    const fp3_model *model = table->model;
    for (uint32_t i = table->count; i-- > 0;) {
        const known *k = &table->list[i];
        if (!is_wanted[i] || k->op == KNOWN_NUMBER || k->op == KNOWN_STEP)
            continue;
        if (k->op == KNOWN_MODEL)
            is_expr_wanted[k->a] = 1;
        else
            is_wanted[k->a] = is_wanted[k->b] = 1; /* b of one operand: 0, a number */
    }
    for (uint32_t i = model->expr_count; i-- > 0;)
        for (int j = 0; is_expr_wanted[i] && j < 3; j++)
            if (model->exprs[i].operand[j] != FP3_NONE)
                is_expr_wanted[model->exprs[i].operand[j]] = 1;
    for (uint32_t i = 0; i < table->count; i++)
        if (is_wanted[i])
            s->ids[s->count++] = i;
    for (uint32_t i = 0; i < model->expr_count; i++)
        if (is_expr_wanted[i])
            s->exprs[s->expr_count++] = i;
}

fp3_status fp3_known_choose(const known_table *table, const char *is_wanted, size_t most,
                            fp3_known_subset *subset, fp3_error *error) {
    const size_t exprs = table->model->expr_count + 1u, count = table->count + 1u;
    char *wanted = malloc(count), *expr_wanted = calloc(exprs, 1);
    *subset =
        (fp3_known_subset){.table = table,
                           .ids = malloc(count * sizeof *subset->ids),
                           .exprs = malloc(exprs * sizeof *subset->exprs),
                           .expr_values = malloc(exprs * most * sizeof *subset->expr_values),
                           .param_row = calloc(table->model->param_count + 1u, sizeof(double)),
                           .row = malloc(count * sizeof *subset->row),
                           .is_expr_lost = malloc(exprs),
                           .is_lost = malloc(count)};
    const int is_good = wanted && expr_wanted && subset->ids && subset->exprs &&
                        subset->expr_values && subset->param_row && subset->row &&
                        subset->is_expr_lost && subset->is_lost;
    if (is_good) {
        if (is_wanted)
            memcpy(wanted, is_wanted, table->count);
        else
            memset(wanted, 1, table->count);
        list_chosen(table, wanted, expr_wanted, subset);
    }
    free(wanted);
    free(expr_wanted);
    return is_good ? FP3_OK : fp3_no_memory(error);
}

/* values[i * count + n] of expression i and object n. */
typedef void compute_fn(const fp3_expr *e, const double *params, size_t count, uint32_t i,
                        double *values, char *is_lost);

static void compute_plainly(const fp3_expr *e, const double *params, size_t count, uint32_t i,
                            double *values, char *is_lost) {
    (void)is_lost;
    fp3_ode_compute_column(e, params, values, count, values + i * count);
}

/* Of one object. */
static void compute_carefully(const fp3_expr *e, const double *params, size_t count, uint32_t i,
                              double *values, char *is_lost) {
    (void)count;
    fp3_ode_compute_careful(e, &(fp3_point){.params = params}, i, values, is_lost);
}

static void fill(double *column, size_t count, double number) {
    for (size_t n = 0; n < count; n++)
        column[n] = number;
}

static void evaluate_one(const fp3_known_subset *s, uint32_t i, double h, size_t count,
                         double *values, compute_fn *compute) {
    const known *k = &s->table->list[i];
    double *column = values + i * count;
    s->is_lost[i] = 0;
    if (k->op == KNOWN_NUMBER || k->op == KNOWN_STEP)
        fill(column, count, k->op == KNOWN_STEP ? fp3_number_given(h, s->table->words) : k->number);
    else if (k->op == KNOWN_MODEL) {
        memcpy(column, s->expr_values + k->a * count, count * sizeof *column);
        s->is_lost[i] = s->is_expr_lost[k->a];
    } else if (is_unary(k->op)) {
        for (size_t n = 0; n < count; n++)
            column[n] = of_one(k->op, values[k->a * count + n]);
        s->is_lost[i] = s->is_lost[k->a];
    } else {
        const fp3_expr made = expr_of(k->op, k->a, k->b);
        compute(&made, NULL, count, i, values, s->is_lost);
    }
}

static void evaluate(const fp3_known_subset *s, const double *params, double h, size_t count,
                     double *values, compute_fn *compute) {
    for (uint32_t n = 0; n < s->expr_count; n++) {
        const uint32_t i = s->exprs[n];
        const fp3_expr *e = &s->table->model->exprs[i];
        double *column = s->expr_values + i * count;
        compute(e, params, count, i, s->expr_values, s->is_expr_lost);
        for (size_t k = 0; e->op == FP3_EXPR_PARAM && k < count; k++)
            column[k] = fp3_number_given(column[k], s->table->words);
    }
    for (uint32_t n = 0; n < s->count; n++)
        evaluate_one(s, s->ids[n], h, count, values, compute);
}

/* If nothing has underflowed, nothing is lost; checking each operation takes ten times as long. */
void fp3_known_values(const fp3_known_subset *s, const double *params, double h, size_t count,
                      double *values) {
    fp3_ode_forget_underflow();
    evaluate(s, params, h, count, values, compute_plainly);
    if (!fp3_ode_may_have_underflowed())
        return;
    for (size_t i = 0; i < count; i++) {
        for (uint32_t n = 0; n < s->table->model->param_count; n++)
            s->param_row[n] = params[n * count + i];
        evaluate(s, s->param_row, h, 1, s->row, compute_carefully);
        for (uint32_t n = 0; n < s->count; n++)
            values[s->ids[n] * count + i] = s->is_lost[s->ids[n]] ? NAN : s->row[s->ids[n]];
    }
}

/* A table whose numbers are exact, in `list`. 0: no memory. */
static int make_exact(const known_table *table, known_table *exact) {
    *exact = *table;
    exact->list = malloc((table->count + 1u) * sizeof *exact->list);
    for (uint32_t i = 0; exact->list && i < table->count; i++) {
        exact->list[i] = table->list[i];
        exact->list[i].number = table->list[i].exact;
    }
    return exact->list != NULL;
}

fp3_status fp3_known_evaluate(const known_table *table, const double *params, double h,
                              int is_exact, double *values, fp3_error *error) {
    known_table exact = {0};
    fp3_known_subset all;
    float single;
    const char *expected = fp3_number_step(h, &single);
    if (expected)
        return fp3_fail(error, FP3_E_ARGUMENT, "h is %.9g: expected %s", h, expected);
    if (is_exact && !make_exact(table, &exact))
        return fp3_no_memory(error);
    const fp3_status status = fp3_known_choose(is_exact ? &exact : table, NULL, 1, &all, error);
    if (!status)
        fp3_known_values(&all, params, h, 1, values);
    fp3_known_release(&all);
    free(exact.list);
    return status;
}
