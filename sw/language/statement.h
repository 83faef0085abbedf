/* SPDX-License-Identifier: Apache-2.0 */
/* statement.h - what each statement of a model says. */
#ifndef FP3_ODE_STATEMENT_H
#define FP3_ODE_STATEMENT_H

#include "parser.h"

void fp3_ode_statement(ode_parser *p);

#endif
