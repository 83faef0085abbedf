/* SPDX-License-Identifier: Apache-2.0 */
/* words.h - operations that no processor has, for a vector of objects: lane by lane, by
 * machine/execute.h. For sweep.c, behind tiny.h, where FP3_OF_WORDS is 1. */
#ifndef FP3_FAST_WORDS_H
#define FP3_FAST_WORDS_H

#include <fp3/isa.h>
#include <machine/execute.h>

/* The arithmetic of a configuration; flags are wanted whether or not it keeps them. */
static inline fp3_config fp3_words_config(const fp3_config *config) {
    fp3_config own = *config;
    own.flags = 1;
    return own;
}

/* The results; flags are those of each lane. */
static inline fp3_v fp3_words(const fp3_config *config, uint32_t op, fp3_v a, fp3_v b, fp3_v c,
                              fp3_i *flags) {
    fp3_u d = {0};
    fp3_i all = fp3_all(0);
    for (int i = 0; i < FP3_LANES; i++) {
        uint32_t raised;
        const uint32_t operands[] = {((fp3_u)a)[i], ((fp3_u)b)[i], ((fp3_u)c)[i]};
        d[i] = fp3_execute(config, op, operands, &raised);
        all[i] = (int)raised;
    }
    *flags = all;
    return (fp3_v)d;
}

/* -1 where `sleep` with these operands puts an object to sleep. */
static inline fp3_i fp3_words_sleep(const fp3_config *config, fp3_v a, fp3_v b) {
    fp3_i is = fp3_all(0);
    for (int i = 0; i < FP3_LANES; i++)
        is[i] = -fp3_execute_sleeps(config, (const uint32_t[]){((fp3_u)a)[i], ((fp3_u)b)[i], 0});
    return is;
}

/* Flags of the machine as the processor would raise them. */
static inline uint64_t fp3_words_sticky(uint32_t flags) {
    return (flags & FP3_FLAG_INVALID ? FP3_FPU_INVALID : 0) |
           (flags & FP3_FLAG_DIVIDE_BY_ZERO ? FP3_FPU_DIVIDE_BY_ZERO : 0) |
           (flags & FP3_FLAG_OVERFLOW ? FP3_FPU_OVERFLOW : 0) |
           (flags & FP3_FLAG_UNDERFLOW ? FP3_FPU_UNDERFLOW : 0) |
           (flags & FP3_FLAG_INEXACT ? FP3_FPU_INEXACT : 0);
}

#endif
