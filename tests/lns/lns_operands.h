/* lns_operands.h - logarithmic words where something changes, and random pairs at all distances. */
#ifndef FP3_TESTS_LNS_OPERANDS_H
#define FP3_TESTS_LNS_OPERANDS_H

#include <gsl/gsl_rng.h>
#include <stddef.h>
#include <stdint.h>

#define LNS_INFINITE 0x7f800000u
#define LNS_SPECIAL 128

/* Operands at all distances, near and far, and anything. */
static inline void lns_draw(gsl_rng *rng, uint32_t *a, uint32_t *b) {
    *a = (uint32_t)gsl_rng_get(rng);
    const uint32_t other = (uint32_t)gsl_rng_get(rng), kind = (uint32_t)gsl_rng_get(rng) >> 29;
    if (kind == 0)
        *b = other;
    else
        *b = ((*a & 0x7fffffff) + (other >> (kind + 2 + (uint32_t)gsl_rng_get(rng) % 20))) %
                 LNS_INFINITE |
             (other << 31);
    if (kind & 1) {
        const uint32_t swap = *a;
        *a = *b;
        *b = swap;
    }
}

/* Returns how many there are. */
static inline size_t lns_special_words(uint32_t *words) {
    static const uint32_t sizes[] = {0,          1,          2,          3,          0x3fffff,
                                     0x400000,   0x400001,   0x7fffff,   0x800000,   0x800001,
                                     0x1fc00000, 0x3effffff, 0x3f000000, 0x3f7fffff, 0x3f800000,
                                     0x3f800001, 0x40000000, 0x40000001, 0x41800000, 0x4f7fffff,
                                     0x4f800000, 0x4f800001, 0x7effffff, 0x7f000000, 0x7f7ffffe,
                                     0x7f7fffff, 0x7f800000, 0x7f800001, 0x7fc00000, 0x7fffffff};
    size_t n = 0;
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++)
        for (uint32_t sign = 0; sign < 2; sign++)
            words[n++] = sizes[i] | sign << 31;
    return n;
}

#endif
