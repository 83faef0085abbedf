/* expression.h - expressions, from tokens to values. */
#ifndef FP3_ODE_EXPRESSION_H
#define FP3_ODE_EXPRESSION_H

#include "parser.h"

ode_value fp3_ode_expression(ode_parser *p, ode_context context);

#endif
