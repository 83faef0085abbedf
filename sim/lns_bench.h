/* SPDX-License-Identifier: Apache-2.0 */
/* lns_bench.h - run operands through the units of tests/lns/lns_bench.v.
 *
 *     fp3_lns_bench *bench = fp3_lns_bench_open();
 *     fp3_lns_bench_run(bench, FP3_LNS_SUB, n, a, b, z, flags);
 *     fp3_lns_bench_close(bench);
 */
#ifndef FP3_SIM_LNS_BENCH_H
#define FP3_SIM_LNS_BENCH_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct fp3_lns_bench fp3_lns_bench;

/* Two of each unit, in the order of the bench. */
typedef enum {
    FP3_LNS_ADD,
    FP3_LNS_SUB,
    FP3_LNS_MUL,
    FP3_LNS_DIV,
    FP3_LNS_SQRT,
    FP3_LNS_RSQRT,
    FP3_LNS_FROM_FLOAT,
    FP3_LNS_TO_FLOAT = FP3_LNS_FROM_FLOAT + 2,
    FP3_LNS_FLOAT_RCP = FP3_LNS_TO_FLOAT + 2,
    FP3_LNS_FLOAT_RSQRT
} fp3_lns_op;

/* NULL when there is no memory. Owned by the caller. */
fp3_lns_bench *fp3_lns_bench_open(void);
void fp3_lns_bench_close(fp3_lns_bench *bench);

/* z[i] and flags[i] of a[i] and b[i] for i < n, one operation per cycle. flags are {NV, DZ, OF, UF,
 * NX}. */
void fp3_lns_bench_run(fp3_lns_bench *bench, fp3_lns_op op, size_t n, const uint32_t *a,
                       const uint32_t *b, uint32_t *z, uint8_t *flags);

#ifdef __cplusplus
}
#endif
#endif
