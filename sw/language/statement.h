/* SPDX-License-Identifier: Apache-2.0 */
/* statement.h - what each statement of a model says. */
#ifndef FP3_ODE_STATEMENT_H
#define FP3_ODE_STATEMENT_H

#include "constant.h"

/* A new param, or state without an equation, of this name. */
void fp3_ode_add_quantity(ode_parser *p, fp3_token at, ode_class class, unsigned size,
                          int is_shared, const ode_constant *constant, const char *doc);

void fp3_ode_statement(ode_parser *p);

#endif
