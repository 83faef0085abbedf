/* SPDX-License-Identifier: Apache-2.0 */
/* symbol.h - names: what they may be, and what they stand for. A name may carry a component, r.x;
 * its base is the name alone. */
#ifndef FP3_ODE_SYMBOL_H
#define FP3_ODE_SYMBOL_H

#include "parser.h"

ode_symbol *fp3_ode_find(ode_parser *p, fp3_token name); /* NULL if there is none; by the base */
/* What a name, or a component of it, stands for; *start is its first component. NULL after an
 * error. */
ode_symbol *fp3_ode_resolve(ode_parser *p, fp3_token name, unsigned *start, unsigned *size);

/* What a component behind the name makes of this symbol: r.x is one of three. 0 after an error. */
int fp3_ode_component(ode_parser *p, const ode_symbol *symbol, fp3_token name, unsigned *start,
                      unsigned *size);

/* A symbol that shares a name with a new one, or with the components of a vector of this size; or
 * NULL. */
const ode_symbol *fp3_ode_occupied(const ode_parser *p, fp3_token name, unsigned size);
/* Whether the token can be a new name, of a vector of this size. Reports it if not. */
int fp3_ode_is_new_name(ode_parser *p, fp3_token name, unsigned size);
/* Returns the number of the symbol. */
uint32_t fp3_ode_declare(ode_parser *p, fp3_token name, ode_class class, uint32_t first,
                         ode_value value);
void fp3_ode_undeclare(ode_parser *p, uint32_t symbol);

/* The name of component i: "r", or "r_x" if it is a vector. */
void fp3_ode_scalar_name(fp3_token base, unsigned size, unsigned i, char name[FP3_NAME_SIZE]);

#endif
