/* SPDX-License-Identifier: Apache-2.0 */
/* fpu_soft.h - what fpu.h has, for a processor that only rounds to nearest and raises nothing.
 *
 * A register of each thread has the mode and the sticky flags; sums and products look at it. A
 * product of two floats is exact in double. A sum is not always, but its error is known to the bit,
 * and a sum that is rounded to odd instead (Boldo and Melquiond 2008) makes the same float as the
 * exact one, in any rounding. So a double tells all that is raised.
 */
#ifndef FP3_FPU_SOFT_H
#define FP3_FPU_SOFT_H

#include <stdint.h>

#define FP3_FPU_IS_SOFT 1
#define FP3_FPU_IS_EARLY 0
/* The flags have the places of FP3_FLAG_*. */
#define FP3_FPU_INVALID 0x10u
#define FP3_FPU_DIVIDE_BY_ZERO 0x08u
#define FP3_FPU_OVERFLOW 0x04u
#define FP3_FPU_UNDERFLOW 0x02u
#define FP3_FPU_INEXACT 0x01u
#define FP3_FPU_STICKY 0x1fu
#define FP3_FPU_SLOW 0u
#define FP3_FPU_OF_C 0u
#define FP3_FPU_TO_ZERO 0x20u

extern _Thread_local uint64_t fp3_fpu_register;

static inline uint64_t fp3_fpu_get(void) { return fp3_fpu_register; }
static inline void fp3_fpu_set(uint64_t state) { fp3_fpu_register = state; }
static inline void fp3_fpu_pause(void) {}

/* Rounded as the register says, which gets the flags. */
float fp3_fpu_add(float a, float b);
float fp3_fpu_mul(float a, float b);
/* a b + c, rounded once. */
float fp3_fpu_fma(float a, float b, float c);
/* ... to an integer; it raises nothing. */
float fp3_fpu_rint(float a);

#endif
