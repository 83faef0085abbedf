/* SPDX-License-Identifier: Apache-2.0 */
/* narrow.h - the arithmetic of a configuration with fewer fraction bits than binary32, in integers.
 *
 *     uint32_t flags;
 *     const uint32_t sum = fp3_narrow_add(config, FP3_BITS_ONE, 0x3b800000, &flags);     with 7
 * bits 1 + 2^-8 is 1, inexact
 *
 * Words are binary32's, and so are exponents, infinities, NaNs and signed zeros. The bits of a word
 * below the fraction are 0 in every result, and are read as 0. Results are rounded once, as
 * `nearest` says; gradual underflow, or none, as `subnormal` says. docs/arithmetic.md has the
 * details; rtl/fp/ does the same with FRAC = fraction. No host's arithmetic matters.
 */
#ifndef FP3_NARROW_H
#define FP3_NARROW_H

#include "config.h"

#include <stdint.h>

/* What arithmetic reads of a word. */
uint32_t fp3_narrow_read(const fp3_config *config, uint32_t word);

/* a + b, a b and a b + c, each rounded once; the exceptions raised are added to flags, as
 * FP3_FLAG_*. */
uint32_t fp3_narrow_add(const fp3_config *config, uint32_t a, uint32_t b, uint32_t *flags);
uint32_t fp3_narrow_mul(const fp3_config *config, uint32_t a, uint32_t b, uint32_t *flags);
uint32_t fp3_narrow_fma(const fp3_config *config, uint32_t a, uint32_t b, uint32_t c,
                        uint32_t *flags);

#endif
