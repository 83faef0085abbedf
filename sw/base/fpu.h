/* SPDX-License-Identifier: Apache-2.0 */
/* fpu.h - the processor's rounding and its sticky flags, faster than <fenv.h>, which also handles
 * those of unused units.
 *
 * What a processor must have: binary32 arithmetic that is rounded once. Where it detects tininess
 * before rounding (ARM), a product that is rounded to 2^-126 may raise underflow, which FP3 does
 * not: FP3_FPU_IS_EARLY, and who asks for underflow has to look closer. A sum is exact where it is
 * tiny, so it raises none on either.
 *
 * WebAssembly has neither flags nor modes: there fpu_soft.h finds both. FP3_FPU_SOFT asks for it
 * elsewhere, which is how it is tested. fp3_fpu_add, _mul, _fma and _rint are for whoever counts on
 * either.
 */
#ifndef FP3_FPU_H
#define FP3_FPU_H

#include <float.h>
#include <math.h>
#include <stdint.h>

#if FLT_EVAL_METHOD != 0
#error "needs binary32 arithmetic that is rounded once"
#endif

#if defined FP3_FPU_SOFT || defined __wasm__
#include "fpu_soft.h"

#elif defined __x86_64__
#include <xmmintrin.h>

#define FP3_FPU_IS_EARLY 0
/* Bits of MXCSR. */
#define FP3_FPU_INVALID 0x01u
#define FP3_FPU_DIVIDE_BY_ZERO 0x04u
#define FP3_FPU_OVERFLOW 0x08u
#define FP3_FPU_UNDERFLOW 0x10u
#define FP3_FPU_INEXACT 0x20u
#define FP3_FPU_STICKY 0x3fu
#define FP3_FPU_SLOW 0x12u   /* subnormal operand, underflow: what takes this processor long */
#define FP3_FPU_OF_C 0x1f80u /* nothing traps, to nearest, nothing is flushed */
#define FP3_FPU_TO_ZERO 0x6000u

static inline uint64_t fp3_fpu_get(void) { return _mm_getcsr(); }
static inline void fp3_fpu_set(uint64_t state) { _mm_setcsr((uint32_t)state); }
static inline void fp3_fpu_pause(void) { _mm_pause(); }

#elif defined __aarch64__

#define FP3_FPU_IS_EARLY 1
/* Bits of FPSR, and of FPCR, which stands above it. */
#define FP3_FPU_INVALID 0x01u
#define FP3_FPU_DIVIDE_BY_ZERO 0x02u
#define FP3_FPU_OVERFLOW 0x04u
#define FP3_FPU_UNDERFLOW 0x08u
#define FP3_FPU_INEXACT 0x10u
#define FP3_FPU_STICKY 0x9fu
#define FP3_FPU_SLOW 0u
#define FP3_FPU_OF_C UINT64_C(0)
#define FP3_FPU_TO_ZERO (UINT64_C(0x00c00000) << 32)

static inline uint64_t fp3_fpu_get(void) {
    uint64_t modes, flags;
    __asm__ volatile("mrs %0, fpcr" : "=r"(modes));
    __asm__ volatile("mrs %0, fpsr" : "=r"(flags));
    return modes << 32 | (flags & 0xffffffffu);
}
static inline void fp3_fpu_set(uint64_t state) {
    __asm__ volatile("msr fpcr, %0" : : "r"(state >> 32) : "memory");
    __asm__ volatile("msr fpsr, %0" : : "r"(state & 0xffffffffu) : "memory");
}
static inline void fp3_fpu_pause(void) { __asm__ volatile("yield"); }

#elif defined __riscv && defined __riscv_flen && __riscv_flen >= 64

#define FP3_FPU_IS_EARLY 0
/* Bits of fcsr. */
#define FP3_FPU_INVALID 0x10u
#define FP3_FPU_DIVIDE_BY_ZERO 0x08u
#define FP3_FPU_OVERFLOW 0x04u
#define FP3_FPU_UNDERFLOW 0x02u
#define FP3_FPU_INEXACT 0x01u
#define FP3_FPU_STICKY 0x1fu
#define FP3_FPU_SLOW 0u
#define FP3_FPU_OF_C 0u
#define FP3_FPU_TO_ZERO 0x20u

static inline uint64_t fp3_fpu_get(void) {
    uint64_t state;
    __asm__ volatile("frcsr %0" : "=r"(state));
    return state;
}
static inline void fp3_fpu_set(uint64_t state) {
    __asm__ volatile("fscsr %0" : : "r"(state) : "memory");
}
static inline void fp3_fpu_pause(void) { __asm__ volatile("nop"); }

#else
#error                                                                                             \
    "its rounding and flags are not known here: x86-64, arm64, riscv64 with doubles and WebAssembly are"
#endif

#ifndef FP3_FPU_IS_SOFT
#define FP3_FPU_IS_SOFT 0

static inline float fp3_fpu_add(float a, float b) { return a + b; }
static inline float fp3_fpu_mul(float a, float b) { return a * b; }
/* a b + c, rounded once. 754 leaves open whether infinity times 0 is invalid if a quiet NaN is
 * added; FP3's is. */
static inline float fp3_fpu_fma(float a, float b, float c) {
    if ((isinf(a) && b == 0) || (a == 0 && isinf(b)))
        fp3_fpu_set(fp3_fpu_get() | FP3_FPU_INVALID);
    return fmaf(a, b, c);
}
static inline float fp3_fpu_rint(float a) { return nearbyintf(a); }
#endif

/* All that is not a flag. */
#define FP3_FPU_MODES (~(uint64_t)FP3_FPU_STICKY)

/* Returns the caller's state, for fp3_fpu_set: until then nothing traps, nothing is flushed and no
 * flag is raised. */
static inline uint64_t fp3_fpu_begin(int is_nearest) {
    const uint64_t callers = fp3_fpu_get();
    fp3_fpu_set(FP3_FPU_OF_C | (is_nearest ? 0 : FP3_FPU_TO_ZERO));
    return callers;
}

/* To write the state takes longer than a look. */
static inline void fp3_fpu_forget(void) {
    const uint64_t now = fp3_fpu_get();
    if (now & FP3_FPU_STICKY)
        fp3_fpu_set(now & FP3_FPU_MODES);
}

#endif
