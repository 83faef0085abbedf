/* SPDX-License-Identifier: Apache-2.0 */
/* finite.h - the arithmetic of a configuration with `finite`: Cell's, in integers.
 *
 * Numbers are binary32's, but exponent 255 is a number's like any other: up to (2 - 2^-23) 2^128,
 * and neither infinity nor NaN. An operand with exponent 0 is zero. Results are truncated; a result
 * above the largest number is that number, with its sign, and one below 2^-126 is +0, as is each
 * zero result. Source: the floating-point pages of IBM's SDK for Multicore Acceleration 3.0,
 * "Programming Tutorial"; docs/arithmetic.md has the tables.
 */
#ifndef FP3_FINITE_H
#define FP3_FINITE_H

#include <stdint.h>

/* As fp3_execute (execute.h); flags are not optional. */
uint32_t fp3_finite_execute(uint32_t op, const uint32_t operands[3], uint32_t *flags);

/* a < b. */
int fp3_finite_is_less(uint32_t a, uint32_t b);

#endif
