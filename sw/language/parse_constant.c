/* parse_constant.c - values that are known before a run, and their units. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "parse.h"

/* The power behind a unit's name, 1 where there is none. */
static int unit_power(ode_parser *p) {
    if (!fp3_ode_accept(p, "^"))
        return 1;
    int sign = fp3_ode_accept(p, "-") ? -1 : 1;
    const char *digits = p->next.text;
    size_t length = p->next.length;
    int is_good = p->next.kind == TOKEN_NUMBER && length <= 2;
    for (size_t i = 0; is_good && i < length; i++)
        is_good = digits[i] >= '0' && digits[i] <= '9';
    if (!is_good) {
        fp3_ode_lost(p, "an integer from -99 to 99 as power of a unit");
        return 1;
    }
    int power = length == 2 ? 10 * (digits[0] - '0') + digits[1] - '0' : digits[0] - '0';
    fp3_ode_advance(p);
    return sign * power;
}

static void unit_factor(ode_parser *p, ode_unit *unit, int sign) {
    token name = p->next;
    if (name.kind == TOKEN_NUMBER && fp3_token_is(name, "1")) {
        fp3_ode_advance(p);
        return;
    }
    char text[FP3_NAME_SIZE] = "";
    if (name.kind != TOKEN_NAME || name.length >= sizeof text ||
        memchr(name.text, '.', name.length)) {
        fp3_ode_lost(p, "a unit as m, 1/s or kg*m/s^2");
        return;
    }
    memcpy(text, name.text, name.length);
    fp3_ode_advance(p);
    int done = fp3_ode_unit_multiply_name(&p->unit_names, unit, text, sign * unit_power(p));
    if (done == 0)
        fp3_ode_wrong(p, name, "at most %d different units in a model", ODE_UNIT_NAMES);
    else if (done < 0)
        fp3_ode_wrong(p, name, "a unit with smaller powers");
}

static void append(char text[ODE_UNIT_SIZE], token t) {
    size_t used = strlen(text);
    if (used + t.length < ODE_UNIT_SIZE)
        memcpy(text + used, t.text, t.length);
    else
        memset(text + used, '?', ODE_UNIT_SIZE - 1 - used); /* too long: unit_here reports it */
}

/* "[kg*m/s^2]", or nothing. */
static void unit_here(ode_parser *p, ode_unit *unit, char text[ODE_UNIT_SIZE]) {
    token open = p->next;
    *unit = (ode_unit){.kind = ODE_UNIT_ANY};
    memset(text, 0, ODE_UNIT_SIZE);
    if (!fp3_ode_accept(p, "["))
        return;
    unit->kind = ODE_UNIT_KNOWN;
    ode_lexer from = p->lexer;
    token first = p->next;
    int sign = 1;
    for (;;) {
        unit_factor(p, unit, sign);
        if (fp3_ode_at(p, "*") || fp3_ode_at(p, "/"))
            sign = fp3_ode_at(p, "*") ? 1 : -1;
        else
            break;
        fp3_ode_advance(p);
    }
    if (!fp3_ode_at(p, "]"))
        fp3_ode_lost(p, "'*', '/' or ']'");
    if (p->is_lost)
        return;
    for (token t = first; t.text < p->next.text; t = fp3_ode_next(&from))
        append(text, t);
    if (strlen(text) == ODE_UNIT_SIZE - 1)
        fp3_ode_wrong(p, open, "a unit of fewer than %d characters", ODE_UNIT_SIZE - 1);
    fp3_ode_advance(p);
}

/* Values of the expressions from .. expr_count-1. */
static void compute(ode_parser *p, uint32_t from) {
    double params[ODE_QUANTITIES];
    for (uint32_t i = 0; i < p->param_count; i++)
        params[i] = p->params[i].quantity.value;
    const fp3_point point = {.params = params};
    for (uint32_t i = from; i < p->expr_count; i++)
        p->values[i] = fp3_ode_compute(&p->exprs[i], &point, p->values);
}

static int take(ode_parser *p, token at, ode_value value, unsigned size, ode_constant *constant) {
    char is[ODE_UNIT_TEXT_SIZE], wanted[ODE_UNIT_TEXT_SIZE];
    if (value.size != size) {
        fp3_ode_wrong(p, at, "%s (this is %s)",
                      size == 1   ? "a number"
                      : size == 2 ? "a vector, as (1, 0)"
                                  : "a vector, as (1, 0, 0)",
                      fp3_ode_shape(value.size));
        return 0;
    }
    for (unsigned i = 0; i < size; i++) {
        const ode_unit *unit = &p->units[value.expr[i]];
        constant->value[i] = p->values[value.expr[i]];
        if (!fp3_ode_unit_fits(unit, &constant->unit)) {
            fp3_ode_wrong(p, at, "a value in %s (this is in %s)",
                          fp3_ode_unit_text(&p->unit_names, &constant->unit, wanted),
                          fp3_ode_unit_text(&p->unit_names, unit, is));
            return 0;
        }
        if (!isfinite(constant->value[i])) {
            fp3_ode_wrong(p, at, "a finite value (this is %s)",
                          isnan(constant->value[i]) ? "not a number" : "infinite");
            return 0;
        }
    }
    return 1;
}

int fp3_ode_constant(ode_parser *p, ode_context context, unsigned size, ode_unit_place place,
                     ode_constant *constant) {
    token at = p->next;
    uint32_t from = p->expr_count;
    *constant = (ode_constant){.unit = {.kind = ODE_UNIT_ANY}};
    ode_value value = fp3_ode_expression(p, context);
    if (place == ODE_WITH_UNIT)
        unit_here(p, &constant->unit, constant->unit_text);
    int is_good = 0;
    if (value.size && !p->is_lost) {
        compute(p, from);
        fp3_ode_check_units(p, from);
        is_good = take(p, at, value, size, constant);
    }
    p->expr_count = from;
    return is_good;
}
