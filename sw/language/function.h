/* SPDX-License-Identifier: Apache-2.0 */
/* function.h - calls of the functions of the language: of those in function_rows.h, and of vectors.
 */
#ifndef FP3_ODE_FUNCTION_H
#define FP3_ODE_FUNCTION_H

#include "parser.h"

enum { ODE_ARGUMENTS = 3 };

/* What a function does with vectors. */
typedef enum {
    ODE_OF_NUMBERS, /* takes none; but one of three arguments chooses between two of one size */
    ODE_OF_DOT,
    ODE_OF_CROSS,
    ODE_OF_NORM,
    ODE_OF_TERMS /* of a vector, or one for each value of an index; so may min and max be */
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

/* Whether it can be made of terms. */
int fp3_ode_has_terms(const ode_function *function);

/* The value of a call at this token. */
ode_value fp3_ode_apply(ode_parser *p, fp3_token at, const ode_function *function,
                        const ode_value argument[ODE_ARGUMENTS]);

#endif
