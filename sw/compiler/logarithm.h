/* logarithm.h - log, and powers with an exponent that is known. docs/compiler.md has the errors. */
#ifndef FP3_LOGARITHM_H
#define FP3_LOGARITHM_H

#include "dag.h"

uint32_t fp3_log(dag *g, uint32_t x);

/* x^n, where n is a known value and x is not. A negative x is a NaN, and raises invalid, unless n is an
 * integer. */
uint32_t fp3_power(dag *g, uint32_t x, uint32_t n);

#endif
