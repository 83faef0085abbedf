/* units_check.c - the unit of each expression, from those of its operands. */
#include <math.h>
#include <string.h>

#include "parse.h"

static const ode_unit any = {.kind = ODE_UNIT_ANY}, number = {.kind = ODE_UNIT_NUMBER},
                      one = {.kind = ODE_UNIT_KNOWN};

/* An operation on vectors is several expressions at one place: one report is enough. */
static int is_repeated(const ode_parser *p, token at) {
    const report *r = &p->report;
    return r->count > 0 && r->entry[r->count - 1].at == at.text;
}

static const char *text_of(const ode_parser *p, const ode_unit *unit,
                           char text[ODE_UNIT_TEXT_SIZE]) {
    return fp3_ode_unit_text(&p->unit_names, unit, text);
}

static ode_unit same(ode_parser *p, token at, const ode_unit *a, const ode_unit *b) {
    char left[ODE_UNIT_TEXT_SIZE], right[ODE_UNIT_TEXT_SIZE];
    if (fp3_ode_unit_fits(a, b))
        return fp3_ode_unit_common(a, b);
    if (!is_repeated(p, at))
        fp3_ode_wrong(p, at, "two values of one unit (these are in %s and %s)", text_of(p, a, left),
                      text_of(p, b, right));
    return any;
}

static ode_unit pure(ode_parser *p, token at, const ode_unit *a) {
    char text[ODE_UNIT_TEXT_SIZE];
    if (a->kind == ODE_UNIT_NUMBER)
        return number;
    if (!fp3_ode_unit_is_one(a) && !is_repeated(p, at))
        fp3_ode_wrong(p, at, "a value without a unit for it (this is in %s)", text_of(p, a, text));
    return one;
}

static ode_unit root(ode_parser *p, token at, const ode_unit *a) {
    char text[ODE_UNIT_TEXT_SIZE];
    ode_unit power;
    if (fp3_ode_unit_power(a, 1, 2, &power))
        return power;
    if (!is_repeated(p, at))
        fp3_ode_wrong(p, at, "a value with a square root of its unit (this is in %s)",
                      text_of(p, a, text));
    return any;
}

static ode_unit power(ode_parser *p, token at, const ode_unit *a, const fp3_expr *exponent,
                      const ode_unit *b) {
    char text[ODE_UNIT_TEXT_SIZE];
    ode_unit result = any;
    double eighths = exponent->number * ODE_UNIT_ONE;
    pure(p, at, b);
    if (a->kind != ODE_UNIT_KNOWN)
        return *a;
    if (fp3_ode_unit_is_one(a))
        return one;
    int is_number = exponent->op == FP3_EXPR_NUMBER && fabs(eighths) <= ODE_UNIT_POWER_MAX &&
                    eighths == floor(eighths);
    if (!is_number || !fp3_ode_unit_power(a, (int)eighths, ODE_UNIT_ONE, &result)) {
        if (!is_repeated(p, at))
            fp3_ode_wrong(p, at, "a number as 2 or 0.5 for the power of what is in %s",
                          text_of(p, a, text));
        return any;
    }
    return result;
}

static ode_unit unit_of(ode_parser *p, uint32_t i) {
    const fp3_expr *e = &p->exprs[i];
    const token at = p->expr_at[i];
    const ode_unit *operand[3] = {&any, &any, &any};
    for (unsigned j = 0; j < fp3_ode_operands(e->op); j++)
        operand[j] = &p->units[e->operand[j]];
    const ode_unit *a = operand[0], *b = operand[1];
    switch (e->op) {
    case FP3_EXPR_NUMBER:
        return number;
    case FP3_EXPR_STATE:
    case FP3_EXPR_INITIAL:
        return p->states[e->index].unit;
    case FP3_EXPR_PARAM:
        return p->params[e->index].unit;
    case FP3_EXPR_TIME:
        return p->step.unit;
    case FP3_EXPR_NEGATE:
    case FP3_EXPR_ABS:
        return *a;
    case FP3_EXPR_ADD:
    case FP3_EXPR_SUB:
    case FP3_EXPR_MIN:
    case FP3_EXPR_MAX:
        return same(p, at, a, b);
    case FP3_EXPR_MUL:
        return fp3_ode_unit_product(a, b, 1);
    case FP3_EXPR_DIV:
        return fp3_ode_unit_product(a, b, -1);
    case FP3_EXPR_POWER:
        return power(p, at, a, &p->exprs[e->operand[1]], b);
    case FP3_EXPR_SQRT:
        return root(p, at, a);
    case FP3_EXPR_LESS:
    case FP3_EXPR_LESS_EQUAL:
    case FP3_EXPR_EQUAL:
    case FP3_EXPR_ATAN2:
        same(p, at, a, b);
        return one;
    case FP3_EXPR_AND:
    case FP3_EXPR_OR:
    case FP3_EXPR_NOT:
        return one;
    case FP3_EXPR_SELECT:
        return same(p, at, b, operand[2]);
    default: /* functions of one number */
        return pure(p, at, a);
    }
}

void fp3_ode_check_units(ode_parser *p, uint32_t from) {
    for (uint32_t i = from; i < p->expr_count && !fp3_report_full(&p->report); i++)
        p->units[i] = unit_of(p, i);
}

static void check(ode_parser *p, const ode_equation *equation, const ode_unit *wanted,
                  const char *what) {
    char left[ODE_UNIT_TEXT_SIZE], right[ODE_UNIT_TEXT_SIZE];
    if (!equation->at.line || equation->expr == FP3_NONE ||
        fp3_ode_unit_fits(wanted, &p->units[equation->expr]) || is_repeated(p, equation->at))
        return;
    fp3_ode_wrong(p, equation->at, "%s in %s (its right side is in %s)", what,
                  text_of(p, wanted, left), text_of(p, &p->units[equation->expr], right));
}

void fp3_ode_check_equations(ode_parser *p) {
    for (uint32_t i = 0; i < p->state_count && !fp3_report_full(&p->report); i++) {
        ode_quantity *s = &p->states[i];
        ode_unit rate = fp3_ode_unit_product(&s->unit, &p->step.unit, -1);
        ode_unit second = fp3_ode_unit_product(&rate, &p->step.unit, -1);
        check(p, &s->first, &rate, "a derivative");
        check(p, &s->second, &second, "a second derivative");
        check(p, &s->exact, &s->unit, "a closed form");
    }
}
