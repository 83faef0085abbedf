/* fp_pairs.h - random operand pairs, mostly where floating-point cores go wrong. */
#ifndef FP3_TESTS_FP_PAIRS_H
#define FP3_TESTS_FP_PAIRS_H

#include <stdbool.h>
#include <stdint.h>

#include <gsl/gsl_rng.h>

#include "fp_bench.h"

/* The generator of all pairs: all 32 bits of a draw are random, and a draw takes 3 ns. */
#define FP3_PAIRS_RNG gsl_rng_taus2

static inline uint32_t fp3_below(gsl_rng *rng, uint32_t n) {
    return (uint32_t)((uint64_t)gsl_rng_get(rng) * n >> 32);
}

static inline int fp3_between(gsl_rng *rng, int low, int high) {
    return low + (int)fp3_below(rng, (uint32_t)(high - low + 1));
}

/* Half of the fractions are uniform, the others have runs of ones or zeros. */
static inline uint32_t fp3_fraction(gsl_rng *rng, unsigned frac) {
    const uint32_t all = (UINT32_C(1) << frac) - 1, bits = (uint32_t)gsl_rng_get(rng);
    const uint32_t run = all >> fp3_below(rng, frac + 1);
    switch (bits >> 29) {
    case 0:
        return bits & all & ~run;
    case 1:
        return (bits | run) & all;
    case 2:
        return all & ~run;
    case 3:
        return (run + 1) & all;
    default:
        return bits & all;
    }
}

/* Two exponent fields in 0 .. top with the given sum. */
static inline void fp3_exponents(gsl_rng *rng, int top, int sum, int *ea, int *eb) {
    sum = sum < 0 ? 0 : sum > 2 * top ? 2 * top : sum;
    *ea = fp3_between(rng, sum > top ? sum - top : 0, sum < top ? sum : top);
    *eb = sum - *ea;
}

static inline void fp3_pair(gsl_rng *rng, unsigned exp, unsigned frac, fp3_bench_op op, uint32_t *a,
                            uint32_t *b) {
    const uint32_t all = (UINT32_C(1) << frac) - 1;
    const int f = (int)frac, top = (1 << exp) - 2, bias = top / 2; /* top: the largest finite */
    const bool mul = op >= FP3_BENCH_MUL;
    uint32_t fa = fp3_fraction(rng, frac), fb = fp3_fraction(rng, frac);
    int ea = fp3_between(rng, 0, top), eb = fp3_between(rng, 0, top);

    switch (fp3_below(rng, 8)) {
    case 0: /* any bits, NaN and infinity too */
        ea = fp3_between(rng, 0, top + 1);
        eb = fp3_between(rng, 0, top + 1);
        break;
    case 1: /* cancellation: neighbours whose difference has few bits */
        fb = fa ^ (all >> fp3_below(rng, frac + 1) & (uint32_t)gsl_rng_get(rng));
        eb = ea + fp3_between(rng, -2, 2);
        if (ea != eb) { /* 1.0..0x and 1.1..1x, one binade apart */
            const uint32_t low = all >> fp3_below(rng, frac + 1);
            fa &= low;
            fb |= all & ~low;
        }
        break;
    case 2: { /* a subnormal operand; the product is near the smallest normal number */
        const int zeros = fp3_between(rng, 0, f);
        ea = 0;
        fa = (all >> zeros) & (uint32_t)gsl_rng_get(rng);
        eb = mul ? bias + zeros + fp3_between(rng, -3, 3) : fp3_between(rng, 0, f + 3);
        break;
    }
    case 3: /* a subnormal result, or nearly */
        if (mul)
            fp3_exponents(rng, top, bias + fp3_between(rng, -f - 3, 2), &ea, &eb);
        else
            fp3_exponents(rng, f, fp3_between(rng, 0, f), &ea, &eb);
        break;
    case 4: /* a tie, or nearly: the bit below the last is the last one set */
        if (mul) {
            const int ta = fp3_between(rng, 0, f), tb = f - ta - fp3_between(rng, 0, 1);
            const uint32_t one_a = UINT32_C(1) << ta, one_b = UINT32_C(1) << (tb < 0 ? 0 : tb);
            fa = ((fa & ~(one_a - 1)) | one_a) & all;
            fb = ((fb & ~(one_b - 1)) | one_b) & all;
            fp3_exponents(rng, top, bias + fp3_between(rng, 1, top - 1), &ea, &eb);
        } else {
            const int d = fp3_between(rng, 1, f + 1);
            const uint32_t half = UINT32_C(1) << (d - 1);
            fb = ((fb & ~(half - 1)) | half) & all;
            eb = ea - d;
        }
        if (fp3_below(rng, 4) == 0)
            fb = (fb + (fp3_below(rng, 2) ? 1 : all)) & all;
        break;
    case 5: /* around the largest finite number */
        if (mul) {
            fp3_exponents(rng, top, bias + top + fp3_between(rng, -1, 1), &ea, &eb);
        } else {
            ea = top - fp3_between(rng, 0, 1);
            eb = top - (fp3_below(rng, 2) ? fp3_between(rng, 0, 1) : fp3_between(rng, 0, f + 3));
        }
        break;
    case 6: /* far apart: the smaller one is a sticky bit or a little more */
        eb = ea - f + fp3_between(rng, -4, 3);
        break;
    default: /* any finite numbers */
        break;
    }
    eb = eb < 0 ? 0 : eb > top + 1 ? top + 1 : eb;

    const uint32_t signs = (uint32_t)gsl_rng_get(rng);
    const uint32_t p = (signs >> 31) << (exp + frac) | (uint32_t)ea << frac | fa;
    const uint32_t q = (signs >> 30 & 1) << (exp + frac) | (uint32_t)eb << frac | fb;
    *a = signs >> 29 & 1 ? p : q;
    *b = signs >> 29 & 1 ? q : p;
}

/* An addend for the product of a and b, mostly where they meet: it cancels the product, or is half
 * a unit of one of them away from where it changes something; beside an infinite product it is
 * often infinite. */
static inline uint32_t fp3_third(gsl_rng *rng, unsigned exp, unsigned frac, uint32_t a,
                                 uint32_t b) {
    const uint32_t all = (UINT32_C(1) << frac) - 1, hidden = all + 1;
    const int f = (int)frac, top = (1 << exp) - 2, bias = top / 2;
    const uint32_t ea = a >> frac & (uint32_t)(top + 1), eb = b >> frac & (uint32_t)(top + 1);
    if ((ea > (uint32_t)top || eb > (uint32_t)top) && fp3_below(rng, 2))
        return ((uint32_t)top + 1 + (fp3_below(rng, 2) << exp)) << frac;
    uint64_t product = (uint64_t)((a & all) | (ea ? hidden : 0)) * ((b & all) | (eb ? hidden : 0));
    int e =
        (int)(ea ? ea : 1) + (int)(eb ? eb : 1) - bias + 1; /* of the product's bit 2 * frac + 1 */
    while (product && !(product >> (2 * frac + 1) & 1)) {
        product <<= 1;
        e--;
    }
    uint32_t fraction = (uint32_t)(product >> (frac + 1)) & all;
    switch (fp3_below(rng, 8)) {
    case 0: /* any bits */
        return (uint32_t)gsl_rng_get(rng) & ((hidden << (exp + 1)) - 1);
    case 1: /* the product, rounded up or down */
        fraction = (fraction + fp3_below(rng, 2)) & all;
        break;
    case 2: /* nearly */
        fraction = (fraction + (uint32_t)fp3_between(rng, -3, 3)) & all;
        e += fp3_between(rng, -1, 1);
        break;
    case 3: /* at every distance */
        fraction = fp3_fraction(rng, frac);
        e += fp3_between(rng, -2 * f - 6, 2 * f + 8);
        break;
    case 4: /* the ends of the window */
        fraction = fp3_fraction(rng, frac);
        e += (fp3_below(rng, 2) ? f + 2 : -f - 2) + fp3_between(rng, -3, 3);
        break;
    case 5: /* few bits are the same */
        fraction ^= all >> fp3_below(rng, frac + 1) & (uint32_t)gsl_rng_get(rng);
        break;
    case 6: /* zero, or subnormal */
        fraction = fp3_below(rng, 2) ? 0 : fp3_fraction(rng, frac);
        e = 0;
        break;
    default: /* any finite number near it */
        fraction = fp3_fraction(rng, frac);
        e += fp3_between(rng, -3, 3);
        break;
    }
    e = e < 0 ? 0 : e > top ? top : e;
    return fp3_below(rng, 2) << (exp + frac) | (uint32_t)e << frac | fraction;
}

#endif
