/* function.h - the functions of the language. What their arguments may be measured in follows from
 * the operations that they become: dimension_check.c. */
#ifndef FP3_ODE_FUNCTION_H
#define FP3_ODE_FUNCTION_H

#include "parser.h"

enum { ODE_ARGUMENTS = 3 };

/* What a function does with vectors. */
typedef enum {
    ODE_OF_NUMBERS, /* takes none */
    ODE_OF_CHOICE,  /* chooses between two of one size */
    ODE_OF_DOT,
    ODE_OF_CROSS,
    ODE_OF_NORM
} ode_rule;

typedef struct {
    const char *name;
    unsigned arguments;
    ode_rule rule;
    fp3_expr_op op; /* of numbers */
} ode_function;

/* NULL if there is none. */
const ode_function *fp3_ode_function(fp3_token name);
/* The function that the name is most likely a misspelling of, or NULL. */
const char *fp3_ode_nearest_function(fp3_token name);

/* The value of a call at this token. */
ode_value fp3_ode_apply(ode_parser *p, fp3_token at, const ode_function *function,
                        const ode_value argument[ODE_ARGUMENTS]);

#endif
