/* SPDX-License-Identifier: Apache-2.0 */
/* fp_bench.h - run operands through the floating-point cores of tests/fp/fp_bench.v.
 *
 *     fp3_bench *bench = fp3_bench_open();
 *     fp3_bench_run(bench, FP3_BENCH_BINARY32, FP3_BENCH_MUL, n, a, b, NULL, z, flags);
 *     fp3_bench_close(bench);
 */
#ifndef FP3_SIM_FP_BENCH_H
#define FP3_SIM_FP_BENCH_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct fp3_bench fp3_bench;

/* madd is c + a * b, msub c - a * b, each rounded once. */
typedef enum {
    FP3_BENCH_ADD,
    FP3_BENCH_SUB,
    FP3_BENCH_MUL,
    FP3_BENCH_MADD,
    FP3_BENCH_MSUB,
    FP3_BENCH_OPS
} fp3_bench_op;

/* Rows of the bench; each has an adder, a multiplier and a fused multiply-add. */
enum {
    FP3_BENCH_SMALL = 0, /* + 2 gradual, + 1 nearest: 4-bit exponent, 3-bit fraction */
    FP3_BENCH_SMALL_CELL = 4,
    FP3_BENCH_BINARY16 = 5,
    FP3_BENCH_CELL = 6, /* binary32's format in Cell's arithmetic */
    FP3_BENCH_BINARY32 = 7,
    FP3_BENCH_CUT = 8 /* and on: binary32 with the cuts of named configurations, each pair once */
};

/* How the core behind a row and an operation was built, read back from the hardware. */
typedef struct {
    unsigned exp, frac;          /* widths in bits */
    unsigned subnormal, nearest; /* 1: gradual underflow, 1: nearest-even */
    unsigned finite;             /* 1: no infinity, no NaN */
    unsigned cuts;               /* mask */
    unsigned latency;            /* set bits of the mask */
} fp3_bench_core;

/* NULL when there is no memory. Owned by the caller. */
fp3_bench *fp3_bench_open(void);
void fp3_bench_close(fp3_bench *bench);

unsigned fp3_bench_rows(const fp3_bench *bench);
fp3_bench_core fp3_bench_describe(const fp3_bench *bench, unsigned row, fp3_bench_op op);

/* z[i] and flags[i] = a[i] op b[i], or c[i] op a[i] * b[i], for i < n, one operation per cycle, as
 * deep as the core is cut. c may be NULL where it is not used. Operands and results are
 * right-aligned, flags {NV, DZ, OF, UF, NX}. row < fp3_bench_rows(). */
void fp3_bench_run(fp3_bench *bench, unsigned row, fp3_bench_op op, size_t n, const uint32_t *a,
                   const uint32_t *b, const uint32_t *c, uint32_t *z, uint8_t *flags);

#ifdef __cplusplus
}
#endif
#endif
