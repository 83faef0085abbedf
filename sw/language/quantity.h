/* SPDX-License-Identifier: Apache-2.0 */
/* quantity.h - a param or state that the model declares. */
#ifndef FP3_ODE_QUANTITY_H
#define FP3_ODE_QUANTITY_H

#include "constant.h"

/* A new param, or state without an equation, of this name. */
void fp3_ode_add_quantity(ode_parser *p, fp3_token at, ode_class class, unsigned size,
                          int is_shared, const ode_constant *constant, const char *doc);

#endif
