/* SPDX-License-Identifier: Apache-2.0 */
/* exact.h - quotients and roots rounded to nearest, ties to even, as IEEE 754 has them. */
#ifndef FP3_EXACT_H
#define FP3_EXACT_H

#include "compiler/value/dag.h"

/* docs/compiler.md has the proofs, and the results for zeros, infinities and subnormal numbers. */
uint32_t fp3_exact_quotient(dag *g, uint32_t a, uint32_t b);
uint32_t fp3_exact_root(dag *g, uint32_t b);

#endif
