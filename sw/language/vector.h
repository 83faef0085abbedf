/* SPDX-License-Identifier: Apache-2.0 */
/* vector.h - operations on numbers and vectors. Each takes the token of the operation, and returns
 * a value of size 0 after an error, or if an operand is such a value. */
#ifndef FP3_ODE_VECTOR_H
#define FP3_ODE_VECTOR_H

#include "parser.h"

ode_value fp3_ode_leaf(ode_parser *p, fp3_token at, fp3_expr_op op, uint32_t index, double number);
ode_value fp3_ode_unary(ode_parser *p, fp3_token at, fp3_expr_op op, ode_value a);
ode_value fp3_ode_binary(ode_parser *p, fp3_token at, fp3_expr_op op, ode_value a, ode_value b);
ode_value fp3_ode_select(ode_parser *p, fp3_token at, ode_value c, ode_value a, ode_value b);
ode_value fp3_ode_dot(ode_parser *p, fp3_token at, ode_value a, ode_value b);
ode_value fp3_ode_cross(ode_parser *p, fp3_token at, ode_value a, ode_value b);
/* The operation between all components, from the left. */
ode_value fp3_ode_fold(ode_parser *p, fp3_token at, fp3_expr_op op, ode_value a);

/* FP3_EXPR_TOTAL, LEAST or MOST over the neighbours of a relation, of each component, from
 * start on. */
ode_value fp3_ode_total(ode_parser *p, fp3_token at, fp3_expr_op op, uint32_t relation,
                        ode_value term, ode_value start);

/* FP3_EXPR_OBJECTS, or PAIRS of a relation, of each component. */
ode_value fp3_ode_sum_of_group(ode_parser *p, fp3_token at, fp3_expr_op op, uint32_t relation,
                               ode_value term);

/* Whether the value is a number that is known while the text is read. */
int fp3_ode_is_number(const ode_parser *p, ode_value value);
/* Drops the expressions from this one on: what was made of them has its value. */
void fp3_ode_forget(ode_parser *p, uint32_t from);

/* A vector that grows, component by component; open is its bracket. */
typedef struct {
    ode_value value;
    unsigned size;
    int is_good;
} ode_components;
void fp3_ode_append(ode_parser *p, fp3_token open, ode_value part, ode_components *all);
ode_value fp3_ode_vector_of(ode_parser *p, fp3_token open, ode_components *all);

/* "a number", "a vector of 2". */
const char *fp3_ode_shape(unsigned size);

#endif
