/* lns_operands.h - logarithmic words where something changes, and random pairs at all distances. */
#ifndef FP3_TESTS_LNS_OPERANDS_H
#define FP3_TESTS_LNS_OPERANDS_H

#include <fp3/isa.h>
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

/* What rtl/lns computes and no instruction uses: to the nearest word, ties to even. */
static inline uint32_t lns_sqrt(uint32_t a, uint32_t *flags) {
    const uint32_t size = a & 0x7fffffff, twice = a + 0x3f800000;
    *flags = 0;
    if (size > LNS_INFINITE)
        return 0x7fc00000;
    if (size == 0 || a == LNS_INFINITE)
        return a;
    *flags = a >> 31 ? FP3_FLAG_INVALID : twice & 1 ? FP3_FLAG_INEXACT : 0;
    return a >> 31 ? 0x7fc00000 : (twice + (twice >> 1 & 1)) >> 1;
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
    /* Each bit alone makes a NaN of an infinity, and a number of a zero. */
    for (uint32_t bit = 0; bit < 23; bit++) {
        words[n++] = LNS_INFINITE | 1u << bit;
        words[n++] = 1u << bit;
    }
    return n;
}

#endif
