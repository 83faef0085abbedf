/* SPDX-License-Identifier: Apache-2.0 */
#include "dimension_check.h"

#include <math.h>
#include <string.h>

#include "evaluate.h"
#include "function_rows.h"

static const ode_dimension any = {.kind = ODE_DIMENSION_ANY},
                           number = {.kind = ODE_DIMENSION_NUMBER},
                           one = {.kind = ODE_DIMENSION_KNOWN};

/* An operation on vectors, or for several indices, is several expressions at one location: one
 * error is enough. */
static int is_repeated(const ode_parser *p, fp3_token at) {
    const fp3_report *r = &p->in.report;
    for (unsigned i = 0; i < r->count; i++)
        if (r->entry[i].at == at.text)
            return 1;
    return 0;
}

static const char *text_of(const ode_parser *p, const ode_dimension *dimension,
                           char text[ODE_DIMENSION_TEXT_SIZE]) {
    return fp3_ode_dimension_text(&p->dimension_names, dimension, text);
}

static ode_dimension same(ode_parser *p, fp3_token at, const ode_dimension *a,
                          const ode_dimension *b) {
    char left[ODE_DIMENSION_TEXT_SIZE], right[ODE_DIMENSION_TEXT_SIZE];
    if (fp3_ode_dimension_fits(a, b))
        return fp3_ode_dimension_common(a, b);
    if (!is_repeated(p, at))
        fp3_ode_wrong(&p->in, at, "two values with the same unit (these are in %s and %s)",
                      text_of(p, a, left), text_of(p, b, right));
    return any;
}

static ode_dimension pure(ode_parser *p, fp3_token at, const ode_dimension *a) {
    char text[ODE_DIMENSION_TEXT_SIZE];
    if (a->kind == ODE_DIMENSION_NUMBER)
        return number;
    if (!fp3_ode_dimension_is_one(a) && !is_repeated(p, at))
        fp3_ode_wrong(&p->in, at, "a value without a unit (this is in %s)", text_of(p, a, text));
    return one;
}

static ode_dimension root(ode_parser *p, fp3_token at, const ode_dimension *a) {
    char text[ODE_DIMENSION_TEXT_SIZE];
    ode_dimension power;
    if (fp3_ode_dimension_power(a, 1, 2, &power))
        return power;
    if (!is_repeated(p, at))
        fp3_ode_wrong(&p->in, at, "a value whose unit has a square root (this is in %s)",
                      text_of(p, a, text));
    return any;
}

static ode_dimension power(ode_parser *p, fp3_token at, const ode_dimension *a,
                           const fp3_expr *exponent, const ode_dimension *b) {
    char text[ODE_DIMENSION_TEXT_SIZE];
    ode_dimension result = any;
    double eighths = exponent->number * ODE_DIMENSION_ONE;
    pure(p, at, b);
    if (a->kind != ODE_DIMENSION_KNOWN)
        return *a;
    if (fp3_ode_dimension_is_one(a))
        return one;
    int is_number = exponent->op == FP3_EXPR_NUMBER && fabs(eighths) <= ODE_DIMENSION_POWER_MAX &&
                    eighths == floor(eighths);
    if (!is_number || !fp3_ode_dimension_power(a, (int)eighths, ODE_DIMENSION_ONE, &result)) {
        if (!is_repeated(p, at))
            fp3_ode_wrong(&p->in, at, "a number such as 2 or 0.5 as the exponent of a value in %s",
                          text_of(p, a, text));
        return any;
    }
    return result;
}

static ode_dimension ratio(ode_parser *p, fp3_token at, const ode_dimension *a,
                           const ode_dimension *b) {
    same(p, at, a, b);
    return one;
}

/* Of the functions: what UNIT in function_rows.h stands for. */
#define OF_NONE pure(p, at, a)
#define OF_KEPT *a
#define OF_SAME same(p, at, a, b)
#define OF_CHOICE same(p, at, b, operand[2])
#define OF_RATIO ratio(p, at, a, b)
#define OF_ROOT root(p, at, a)

static ode_dimension dimension_of(ode_parser *p, uint32_t i) {
    const fp3_expr *e = &p->exprs[i];
    const fp3_token at = p->expr_at[i];
    const ode_dimension *operand[3] = {&any, &any, &any};
    for (unsigned j = 0; j < fp3_ode_operands(e->op); j++)
        operand[j] = &p->dimensions[e->operand[j]];
    const ode_dimension *a = operand[0], *b = operand[1];
    switch (e->op) {
    case FP3_EXPR_NUMBER:
        return number;
    case FP3_EXPR_STATE:
    case FP3_EXPR_INITIAL:
        return p->states[e->index].dimension;
    case FP3_EXPR_OTHER_STATE:
    case FP3_EXPR_BEFORE:
        return p->states[e->index].dimension;
    case FP3_EXPR_OTHER_PARAM:
        return p->params[e->index].dimension;
    case FP3_EXPR_FIELD:
        return p->fields[e->index].dimension;
    case FP3_EXPR_PARAM:
        return p->params[e->index].dimension;
    case FP3_EXPR_TIME:
    case FP3_EXPR_STEP:
        return p->step.dimension;
    case FP3_EXPR_NEGATE:
    case FP3_EXPR_TOTAL:
    case FP3_EXPR_OBJECTS:
    case FP3_EXPR_PAIRS:
        return *a;
    case FP3_EXPR_LEAST:
    case FP3_EXPR_MOST:
    case FP3_EXPR_ADD:
    case FP3_EXPR_SUB:
        return same(p, at, a, b);
    case FP3_EXPR_MUL:
        return fp3_ode_dimension_product(a, b, 1);
    case FP3_EXPR_DIV:
        return fp3_ode_dimension_product(a, b, -1);
    case FP3_EXPR_POWER:
        return power(p, at, a, &p->exprs[e->operand[1]], b);
    case FP3_EXPR_LESS:
    case FP3_EXPR_LESS_EQUAL:
    case FP3_EXPR_EQUAL:
        return ratio(p, at, a, b);
    case FP3_EXPR_AND:
    case FP3_EXPR_OR:
    case FP3_EXPR_NOT:
        return one;
#define X(OP, name, MADE, UNIT, ...)                                                               \
    case FP3_EXPR_##OP:                                                                            \
        return OF_##UNIT;
        FP3_FUNCTION_ROWS(X)
#undef X
    case FP3_EXPR_OP_COUNT:
        break;
    }
    return any;
}

void fp3_ode_check_dimensions(ode_parser *p, uint32_t from) {
    char note[FP3_NOTE_SIZE];
    memcpy(note, p->in.note, sizeof note);
    for (uint32_t i = from; i < p->expr_count && !fp3_report_full(&p->in.report); i++) {
        memcpy(p->in.note, p->expr_note[i], sizeof p->in.note);
        p->dimensions[i] = dimension_of(p, i);
    }
    memcpy(p->in.note, note, sizeof note);
}

static void check(ode_parser *p, const ode_equation *equation, const ode_dimension *wanted,
                  const char *what) {
    char left[ODE_DIMENSION_TEXT_SIZE], right[ODE_DIMENSION_TEXT_SIZE];
    if (!equation->at.location.line || equation->expr == FP3_NONE ||
        fp3_ode_dimension_fits(wanted, &p->dimensions[equation->expr]) ||
        is_repeated(p, equation->at))
        return;
    memcpy(p->in.note, equation->note, sizeof p->in.note);
    fp3_ode_wrong(&p->in, equation->at, "%s in %s (its right side is in %s)", what,
                  text_of(p, wanted, left), text_of(p, &p->dimensions[equation->expr], right));
    *p->in.note = 0;
}

void fp3_ode_check_equations(ode_parser *p) {
    for (uint32_t i = 0; i < p->state_count && !fp3_report_full(&p->in.report); i++) {
        ode_quantity *s = &p->states[i];
        ode_dimension rate = fp3_ode_dimension_product(&s->dimension, &p->step.dimension, -1);
        ode_dimension second = fp3_ode_dimension_product(&rate, &p->step.dimension, -1);
        check(p, &s->first, &rate, "a derivative");
        check(p, &s->second, &second, "a second derivative");
        check(p, &s->exact, &s->dimension, "a closed form");
    }
    for (uint32_t i = 0; i < p->assignment_count && !fp3_report_full(&p->in.report); i++) {
        const ode_assignment *a = &p->assignments[i];
        check(p, &a->to, &p->states[a->state].dimension, "a value");
    }
    for (uint32_t i = 0; i < p->memory_count && !fp3_report_full(&p->in.report); i++)
        check(p, &p->memories[i].to, &p->fields[p->memories[i].field].dimension, "a value");
}
