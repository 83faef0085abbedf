/* parse_call.c - the functions of the language. */
#include "parse.h"

typedef enum { PLAIN, CHOICE, DOT, CROSS, NORM } function_kind;

typedef struct {
    const char *name;
    unsigned arguments;
    function_kind kind;
    fp3_expr_op op;
} function;

static const function functions[] = {
    {"sqrt", 1, PLAIN, FP3_EXPR_SQRT},    {"sin", 1, PLAIN, FP3_EXPR_SIN},
    {"cos", 1, PLAIN, FP3_EXPR_COS},      {"min", 2, PLAIN, FP3_EXPR_MIN},
    {"max", 2, PLAIN, FP3_EXPR_MAX},      {"abs", 1, PLAIN, FP3_EXPR_ABS},
    {"exp", 1, PLAIN, FP3_EXPR_EXP},      {"log", 1, PLAIN, FP3_EXPR_LOG},
    {"tan", 1, PLAIN, FP3_EXPR_TAN},      {"asin", 1, PLAIN, FP3_EXPR_ASIN},
    {"acos", 1, PLAIN, FP3_EXPR_ACOS},    {"atan2", 2, PLAIN, FP3_EXPR_ATAN2},
    {"sinh", 1, PLAIN, FP3_EXPR_SINH},    {"cosh", 1, PLAIN, FP3_EXPR_COSH},
    {"tanh", 1, PLAIN, FP3_EXPR_TANH},    {"select", 3, CHOICE, FP3_EXPR_SELECT},
    {"dot", 2, DOT, FP3_EXPR_OP_COUNT},   {"cross", 2, CROSS, FP3_EXPR_OP_COUNT},
    {"norm", 1, NORM, FP3_EXPR_OP_COUNT},
};
enum { FUNCTIONS = sizeof functions / sizeof *functions };

static const function *find_function(token name) {
    for (unsigned i = 0; i < FUNCTIONS; i++)
        if (fp3_token_is(name, functions[i].name))
            return &functions[i];
    return NULL;
}

int fp3_ode_is_function(token name) { return find_function(name) != NULL; }

static void nearest_function(token wanted, const char **best) {
    for (unsigned i = 0; i < FUNCTIONS; i++)
        fp3_report_nearest(wanted, functions[i].name, best);
}

ode_value fp3_ode_call(ode_parser *p, token name) {
    const function *f = find_function(name);
    ode_value argument[3] = {{0}};
    if (!fp3_ode_accept(p, "("))
        fp3_ode_lost(p, "'(' after '%s'", f->name);
    for (unsigned i = 0; i < f->arguments; i++) {
        if (i > 0 && !fp3_ode_accept(p, ","))
            fp3_ode_lost(p, "',' ('%s' has %u arguments)", f->name, f->arguments);
        argument[i] = fp3_ode_subexpression(p);
    }
    if (!fp3_ode_accept(p, ")"))
        fp3_ode_lost(p, "an operator or ')' ('%s' has %u argument%s)", f->name, f->arguments,
                     f->arguments > 1 ? "s" : "");
    switch (f->kind) {
    case CHOICE:
        return fp3_ode_select(p, name, argument[0], argument[1], argument[2]);
    case DOT:
        return fp3_ode_dot(p, name, argument[0], argument[1]);
    case CROSS:
        return fp3_ode_cross(p, name, argument[0], argument[1]);
    case NORM:
        return fp3_ode_unary(p, name, FP3_EXPR_SQRT,
                             fp3_ode_dot(p, name, argument[0], argument[0]));
    default:
        return f->arguments == 1 ? fp3_ode_unary(p, name, f->op, argument[0])
                                 : fp3_ode_binary(p, name, f->op, argument[0], argument[1]);
    }
}

void fp3_ode_no_function(ode_parser *p, token name) {
    const char *near = NULL;
    nearest_function(name, &near);
    if (near)
        fp3_ode_wrong(p, name, "a function (did you mean '%s'?)", near);
    else
        fp3_ode_wrong(p, name, "a function");
    fp3_ode_give_up(p, name);
}
