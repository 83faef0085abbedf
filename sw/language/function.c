/* SPDX-License-Identifier: Apache-2.0 */
#include "function.h"

#include "base/nearest.h"
#include "function_rows.h"
#include "vector.h"

enum {
#define X(NAME, operands, host) ARGUMENTS_##NAME = (operands),
    FP3_EXPR_OPS(X)
#undef X
};

static const ode_function functions[] = {
#define X(OP, name, ...) {#name, ARGUMENTS_##OP, ODE_OF_NUMBERS, FP3_EXPR_##OP},
    FP3_FUNCTION_ROWS(X)
#undef X
        {"dot", 2, ODE_OF_DOT, FP3_EXPR_OP_COUNT},
    {"cross", 2, ODE_OF_CROSS, FP3_EXPR_OP_COUNT},
    {"norm", 1, ODE_OF_NORM, FP3_EXPR_OP_COUNT},
    {"sum", 1, ODE_OF_TERMS, FP3_EXPR_ADD},
    {"prod", 1, ODE_OF_TERMS, FP3_EXPR_MUL},
};
enum { FUNCTIONS = sizeof functions / sizeof *functions };

const ode_function *fp3_ode_function(fp3_token name) {
    for (unsigned i = 0; i < FUNCTIONS; i++)
        if (fp3_token_is(name, functions[i].name))
            return &functions[i];
    return NULL;
}

const char *fp3_ode_nearest_function(fp3_token name) {
    const char *near = NULL;
    for (unsigned i = 0; i < FUNCTIONS; i++)
        fp3_nearest(name, functions[i].name, &near);
    return near;
}

int fp3_ode_has_terms(const ode_function *f) {
    return f->rule == ODE_OF_TERMS || f->op == FP3_EXPR_MIN || f->op == FP3_EXPR_MAX;
}

ode_value fp3_ode_apply(ode_parser *p, fp3_token at, const ode_function *f,
                        const ode_value argument[ODE_ARGUMENTS]) {
    switch (f->rule) {
    case ODE_OF_DOT:
        return fp3_ode_dot(p, at, argument[0], argument[1]);
    case ODE_OF_CROSS:
        return fp3_ode_cross(p, at, argument[0], argument[1]);
    case ODE_OF_NORM:
        return fp3_ode_unary(p, at, FP3_EXPR_SQRT, fp3_ode_dot(p, at, argument[0], argument[0]));
    case ODE_OF_TERMS:
        return fp3_ode_fold(p, at, f->op, argument[0]);
    case ODE_OF_NUMBERS:
        break;
    }
    return f->arguments == 1   ? fp3_ode_unary(p, at, f->op, argument[0])
           : f->arguments == 2 ? fp3_ode_binary(p, at, f->op, argument[0], argument[1])
                               : fp3_ode_select(p, at, argument[0], argument[1], argument[2]);
}
