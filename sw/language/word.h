/* SPDX-License-Identifier: Apache-2.0 */
/* word.h - what a kind has: names that stand for values of a neighbour of another group. kind.h
 * declares them. */
#ifndef FP3_ODE_WORD_H
#define FP3_ODE_WORD_H

#include "parser.h"

/* The kind of this name, or FP3_NONE; of "balls.x" by what stands before the dot. */
uint32_t fp3_ode_kind_named(ode_parser *p, fp3_token name);
/* Likewise, or FP3_NONE after an error. */
uint32_t fp3_ode_kind_here(ode_parser *p, fp3_token name);

/* The first param of the word of this name, or NULL. */
const ode_quantity *fp3_ode_word_of(const ode_parser *p, const fp3_kind *kind, fp3_token name);
/* The word that a name, or a component of it, begins with, as a symbol of params. 0 after an
 * error. */
int fp3_ode_word_named(ode_parser *p, uint32_t kind, fp3_token name, ode_symbol *symbol);

#endif
