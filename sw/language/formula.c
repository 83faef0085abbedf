/* SPDX-License-Identifier: Apache-2.0 */
/* formula.c - constant expressions, with names or without: read once, evaluated at any time. */
#include "formula.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/host.h"
#include "base/number.h"
#include "constant.h"
#include "dimension_check.h"
#include "expression.h"
#include "loss.h"
#include "vector.h"

struct fp3_formula {
    uint32_t name_count, expr_count, root;
    char (*names)[FP3_NAME_SIZE]; /* the params of the expressions */
    fp3_expr *exprs;
    unsigned column; /* where it begins, and with what */
    char begin[FP3_TOKEN_SHOWN_SIZE];
};

void fp3_formula_free(fp3_formula **formula) {
    if (*formula) {
        free((*formula)->names);
        free((*formula)->exprs);
    }
    free(*formula);
    *formula = NULL;
}

/* ---- reading ---- */

static fp3_status take(const ode_parser *p, fp3_token begin, uint32_t root, fp3_formula **formula,
                       fp3_error *error) {
    fp3_formula *made = calloc(1, sizeof *made);
    if (made) {
        made->names = calloc(p->param_count + 1u, sizeof *made->names);
        made->exprs = malloc(p->expr_count * sizeof *made->exprs);
    }
    if (!made || !made->names || !made->exprs) {
        fp3_formula_free(&made);
        return fp3_no_memory(error);
    }
    made->name_count = p->param_count;
    made->expr_count = p->expr_count;
    made->root = root;
    for (uint32_t i = 0; i < p->param_count; i++)
        memcpy(made->names[i], p->params[i].quantity.name, FP3_NAME_SIZE);
    memcpy(made->exprs, p->exprs, p->expr_count * sizeof *made->exprs);
    made->column = begin.location.column;
    char shown[FP3_TOKEN_SHOWN_SIZE];
    snprintf(made->begin, sizeof made->begin, "%s", fp3_token_shown(begin, shown));
    *formula = made;
    return FP3_OK;
}

static fp3_status parse(ode_parser *p, const char *text, ode_context context, fp3_formula **formula,
                        fp3_error *error) {
    fp3_ode_open(&p->in, text, strlen(text), "");
    const fp3_token begin = p->in.next;
    const ode_value value = fp3_ode_expression(p, context);
    if (value.size && !p->in.is_lost) {
        fp3_ode_check_dimensions(p, 0);
        if (value.size > 1)
            fp3_ode_wrong(&p->in, begin, "a number (this is %s)", fp3_ode_shape(value.size));
    }
    if (p->in.next.kind != FP3_TOKEN_END_OF_FILE)
        fp3_ode_lost(&p->in, "an operator or the end");
    if (p->in.report.count > 0)
        return fp3_fail(error, FP3_E_PROGRAM, "column %u: %s",
                        p->in.report.entry[0].location.column, p->in.report.entry[0].text);
    return take(p, begin, value.expr[0], formula, error);
}

static fp3_status read(const char *text, ode_context context, fp3_formula **formula,
                       fp3_error *error) {
    ode_parser *p = fp3_ode_make();
    *formula = NULL;
    if (!p)
        return fp3_no_memory(error);
    FP3_HOST;
    p->takes_names = context == ODE_IN_START;
    const fp3_status status = parse(p, text, context, formula, error);
    free(p);
    return status;
}

fp3_status fp3_formula_read(const char *text, fp3_formula **formula, fp3_error *error) {
    return read(text, ODE_IN_START, formula, error);
}

/* ---- evaluating ---- */

static fp3_status evaluate(const fp3_formula *f, const double *params, double *values,
                           char *is_lost, double *value, fp3_error *error) {
    const fp3_point point = {.params = params};
    for (uint32_t i = 0; i < f->expr_count; i++)
        fp3_ode_compute_careful(&f->exprs[i], &point, i, values, is_lost);
    const char *expected = fp3_ode_constant_expected(values[f->root], is_lost[f->root]);
    if (expected)
        return fp3_fail(error, FP3_E_PROGRAM, "column %u: found %s, expected %s", f->column,
                        f->begin, expected);
    *value = values[f->root];
    return FP3_OK;
}

fp3_status fp3_formula_value(const fp3_formula *f, fp3_name_fn *value_of, void *user, double *value,
                             fp3_error *error) {
    FP3_HOST;
    double params[ODE_QUANTITIES], *values = malloc(f->expr_count * sizeof *values);
    char *is_lost = malloc(f->expr_count);
    fp3_status status = values && is_lost ? FP3_OK : fp3_no_memory(error);
    for (uint32_t i = 0; !status && i < f->name_count; i++)
        status = value_of(user, f->names[i], &params[i], error);
    if (!status)
        status = evaluate(f, params, values, is_lost, value, error);
    free(values);
    free(is_lost);
    return status;
}

fp3_status fp3_constant_read(const char *text, double *value, fp3_error *error) {
    fp3_formula *formula;
    fp3_status status = read(text, ODE_IN_CONSTANT, &formula, error);
    if (!status)
        status = fp3_formula_value(formula, NULL, NULL, value, error);
    fp3_formula_free(&formula);
    return status;
}

/* ---- what it is made of ---- */

static int is_number(const fp3_formula *f, uint32_t expr, double number) {
    return f->exprs[expr].op == FP3_EXPR_NUMBER && f->exprs[expr].number == number;
}

/* param == number */
static int is_fact(const fp3_formula *f, const fp3_expr *e) {
    return e->op == FP3_EXPR_EQUAL && f->exprs[e->operand[0]].op == FP3_EXPR_PARAM &&
           f->exprs[e->operand[1]].op == FP3_EXPR_NUMBER;
}

/* How many facts a condition is, ((a and b) and c); 0: it is something else. */
static size_t count_facts(const fp3_formula *f, const fp3_expr *e) {
    size_t count = 1;
    for (; e->op == FP3_EXPR_AND; e = &f->exprs[e->operand[0]], count++)
        if (!is_fact(f, &f->exprs[e->operand[1]]))
            return 0;
    return is_fact(f, e) ? count : 0;
}

size_t fp3_formula_facts(const fp3_formula *f, fp3_fact **facts) {
    const fp3_expr *root = &f->exprs[f->root];
    *facts = NULL;
    if (root->op != FP3_EXPR_SELECT)
        return 0;
    const fp3_expr *e = &f->exprs[root->operand[0]], *none = &f->exprs[root->operand[2]];
    const int has_none = none->op == FP3_EXPR_DIV && is_number(f, none->operand[0], 0) &&
                         is_number(f, none->operand[1], 0);
    const size_t count = has_none ? count_facts(f, e) : 0;
    if (!count || !(*facts = calloc(count, sizeof **facts)))
        return 0;
    for (size_t i = count; i-- > 0;) {
        const fp3_expr *fact = e->op == FP3_EXPR_AND ? &f->exprs[e->operand[1]] : e;
        (*facts)[i].name = f->names[f->exprs[fact->operand[0]].index];
        (*facts)[i].is = f->exprs[fact->operand[1]].number;
        e = &f->exprs[e->operand[0]];
    }
    return count;
}

int fp3_formula_mentions(const fp3_formula *formula, const char *name) {
    for (uint32_t i = 0; i < formula->name_count; i++)
        if (strcmp(formula->names[i], name) == 0)
            return 1;
    return 0;
}
