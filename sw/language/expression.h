/* SPDX-License-Identifier: Apache-2.0 */
/* expression.h - expressions, from tokens to values; and the indices and ranges that are made of
 * them. */
#ifndef FP3_ODE_EXPRESSION_H
#define FP3_ODE_EXPRESSION_H

#include "parser.h"
#include "range.h"

ode_value fp3_ode_expression(ode_parser *p, ode_context context);

/* Reads a whole number made of numbers and indices. 0 after an error, and where it is skipped:
 * *number is unchanged. */
int fp3_ode_whole(ode_parser *p, long *number);

/* What a name that has been read stands for, with the index behind it: q, r.x, q[3]. *start is the
 * first component. NULL after an error. */
const ode_symbol *fp3_ode_part(ode_parser *p, fp3_token name, unsigned *start, unsigned *size);

/* Likewise of a word of a kind (x, x.y, x[2]): the first param of it, and its size. FP3_NONE after
 * an error. */
uint32_t fp3_ode_word(ode_parser *p, uint32_t kind, fp3_token name, unsigned *size);

/* Reads "i in 1..4", and what stands behind it once for each number, always to the same end:
 *
 *     ode_range range;
 *     fp3_ode_range_open(p, &range);
 *     while (fp3_ode_range_pass(p, &range))
 *         ... reads what stands behind the ':'
 *
 * There is a pass at least, so that the reading goes on behind the text. Where the text does not
 * count (no number is in the range, its condition is false), p->skipping is not 0. */
void fp3_ode_range_open(ode_parser *p, ode_range *range);
int fp3_ode_range_pass(ode_parser *p, ode_range *range);

#endif
