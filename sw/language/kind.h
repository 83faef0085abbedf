/* SPDX-License-Identifier: Apache-2.0 */
/* kind.h - what a model reads of objects of another group: `kind`. */
#ifndef FP3_ODE_KIND_H
#define FP3_ODE_KIND_H

#include "parser.h"

/* The rest of the statement: "balls(x[2] [m], R [m])". */
void fp3_ode_kind(ode_parser *p, fp3_token keyword);

#endif
