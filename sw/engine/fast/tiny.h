/* SPDX-License-Identifier: Apache-2.0 */
/* tiny.h - products of subnormal numbers without the processor's help.
 *
 * Many processors multiply subnormal numbers in microcode, 100 times slower. fp3_tiny_product tells
 * all that a product raises; fp3_tiny_value is for runs, and where there is a fused sum it takes a
 * third of the time.
 *
 * A double has every product of two floats, and its sum with 2^-97 is rounded where a subnormal
 * float is: the last bit of 2^-97 is 2^-149. So no multiplication and no conversion here meets a
 * subnormal number or makes one. Sums are not slower for them.
 */
#ifndef FP3_FAST_TINY_H
#define FP3_FAST_TINY_H

#include "lanes.h"

#include "fused.h"

typedef struct {
    fp3_v value;
    fp3_i is_subnormal; /* an operand or the value before it was flushed */
    fp3_i under, over, inexact;
} fp3_product_of;

#define FP3_WIDE_STEP 0x39e0000000000000ll /* 2^-97 */
#define FP3_WIDE_UNIT 0x36a0000000000000ll /* 2^-149 */
#define FP3_WIDE_ONE 0x3ff0000000000000ll
#define FP3_WIDE_END 0x47f0000000000000ll /* 2^128 */
#define FP3_WIDE_SIZE 0x7fffffffffffffffll
/* What is less is tiny: 2^-126, or 2^-126 - 2^-151, where rounding to nearest comes first. */
#define FP3_WIDE_TINY (FP3_SUBNORMAL && FP3_NEAREST ? 0x380ffffff0000000ll : FP3_WIDE_LEAST)

FP3_OPERATION fp3_l fp3_wide_mask(fp3_i mask, int part) {
    return __builtin_convertvector(fp3_part_i(mask, part), fp3_l);
}
FP3_OPERATION fp3_l fp3_wide_choose(fp3_l mask, fp3_l a, fp3_l b) {
    return (mask & a) | (~mask & b);
}
FP3_OPERATION fp3_l fp3_wide_all(long long bits) { return (fp3_l){0} + bits; }

FP3_OPERATION fp3_i fp3_is_subnormal(fp3_v a) {
    return (fp3_exponent(a) == 0) & (fp3_magnitude(a) != 0);
}

/* A float as a double; a subnormal one by its fraction, an integer. */
FP3_OPERATION fp3_d fp3_widened(fp3_v a, int part) {
    const fp3_i sub = fp3_is_subnormal(a);
    const fp3_v whole = __builtin_convertvector(fp3_magnitude(a) & sub, fp3_v);
    const fp3_v x = fp3_choose(sub, (fp3_v)((fp3_i)whole | ((fp3_i)a & FP3_SIGN)), a);
    const fp3_l unit = fp3_wide_choose(fp3_wide_mask(sub, part), fp3_wide_all(FP3_WIDE_UNIT),
                                       fp3_wide_all(FP3_WIDE_ONE));
    return fp3_wide(x, part) * (fp3_d)unit;
}

typedef struct {
    fp3_half normal;
    fp3_narrow bits; /* of a subnormal magnitude */
    fp3_l is_small, under, over, inexact;
} fp3_half_product;

FP3_OPERATION fp3_half_product fp3_round(fp3_d exact) {
    const fp3_l size = (fp3_l)exact & FP3_WIDE_SIZE;
    fp3_half_product p = {.is_small = (size < FP3_WIDE_LEAST) & (size != 0)};
    const fp3_l one = fp3_wide_all(FP3_WIDE_ONE);
    p.normal =
        __builtin_convertvector((fp3_d)fp3_wide_choose(p.is_small, one, (fp3_l)exact), fp3_half);
    const fp3_d small = (fp3_d)fp3_wide_choose(p.is_small, size, fp3_wide_all(0));
    const fp3_d sum = small + (fp3_d)fp3_wide_all(FP3_WIDE_STEP);
    p.bits = __builtin_convertvector((fp3_l)sum, fp3_narrow);
    const fp3_l finite = size < FP3_WIDE_END;
    p.over = (size >= FP3_WIDE_END) & (size < 0x7ff0000000000000ll);
    const fp3_l not_exact =
        fp3_wide_choose(p.is_small, (fp3_l)(sum - (fp3_d)fp3_wide_all(FP3_WIDE_STEP) != small),
                        (fp3_l)(__builtin_convertvector(p.normal, fp3_d) !=
                                (fp3_d)fp3_wide_choose(p.is_small, one, (fp3_l)exact)));
    p.inexact = (finite & not_exact) | p.over;
    p.under = p.is_small & (size < FP3_WIDE_TINY) & (FP3_SUBNORMAL ? p.inexact : fp3_wide_all(-1));
    return p;
}

/* a * b with what it raises, NaN and infinity aside: those the processor raises itself. */
FP3_OPERATION fp3_product_of fp3_tiny_product(fp3_v x, fp3_v y) {
    const fp3_v a = fp3_flushed(x), b = fp3_flushed(y);
    const fp3_half_product p[2] = {fp3_round(fp3_widened(a, 0) * fp3_widened(b, 0)),
                                   fp3_round(fp3_widened(a, 1) * fp3_widened(b, 1))};
    const fp3_v normal = fp3_whole(p[0].normal, p[1].normal);
    const fp3_i small = fp3_whole_i(p[0].bits, p[1].bits);
    const fp3_i is_small = fp3_joined(p[0].is_small, p[1].is_small);
    const fp3_i sign = ((fp3_i)a ^ (fp3_i)b) & FP3_SIGN;
    const fp3_i kept = small & (FP3_SUBNORMAL ? 0x00ffffff : 0);
    fp3_product_of of = {.value = fp3_choose(is_small, (fp3_v)(kept | sign), normal),
                         .is_subnormal = is_small | fp3_is_subnormal(a) | fp3_is_subnormal(b),
                         .under = fp3_joined(p[0].under, p[1].under),
                         .over = fp3_joined(p[0].over, p[1].over),
                         .inexact = fp3_joined(p[0].inexact, p[1].inexact) |
                                    fp3_joined(p[0].under, p[1].under)};
    return of;
}

/* a * b + c, rounded once, likewise. */
FP3_OPERATION fp3_product_of fp3_tiny_fused(fp3_v x, fp3_v y, fp3_v z) {
    const fp3_v a = fp3_flushed(x), b = fp3_flushed(y), c = fp3_flushed(z);
    const fp3_d exact[2] = {fp3_odd_sum(fp3_widened(a, 0) * fp3_widened(b, 0), fp3_widened(c, 0)),
                            fp3_odd_sum(fp3_widened(a, 1) * fp3_widened(b, 1), fp3_widened(c, 1))};
    const fp3_half_product p[2] = {fp3_round(exact[0]), fp3_round(exact[1])};
    const fp3_i is_small = fp3_joined(p[0].is_small, p[1].is_small);
    const fp3_i sign = fp3_joined((fp3_l)exact[0] < 0, (fp3_l)exact[1] < 0) & FP3_SIGN;
    const fp3_i kept = fp3_whole_i(p[0].bits, p[1].bits) & (FP3_SUBNORMAL ? 0x00ffffff : 0);
    const fp3_i under = fp3_joined(p[0].under, p[1].under);
    return (fp3_product_of){
        .value = fp3_choose(is_small, (fp3_v)(kept | sign), fp3_whole(p[0].normal, p[1].normal)),
        .is_subnormal = is_small | fp3_is_subnormal(a) | fp3_is_subnormal(b) | fp3_is_subnormal(c),
        .under = under,
        .over = fp3_joined(p[0].over, p[1].over),
        .inexact = fp3_joined(p[0].inexact, p[1].inexact) | under};
}

/* A product, and who met a subnormal number or underflow: what a run needs. */
typedef struct {
    fp3_v value;
    fp3_i is_subnormal, under;
} fp3_light_product;

#if defined __FMA__ && FP3_SUBNORMAL && FP3_NEAREST

#if FP3_LANES == 16
#define FP3_LESSER(a, b) ((fp3_i)__builtin_ia32_pminsd512_mask(a, b, a, (unsigned short)-1))
#define FP3_GREATER(a, b) ((fp3_i)__builtin_ia32_pmaxsd512_mask(a, b, a, (unsigned short)-1))
#else
#define FP3_LESSER(a, b) ((fp3_i)__builtin_ia32_pminsd256(a, b))
#define FP3_GREATER(a, b) ((fp3_i)__builtin_ia32_pmaxsd256(a, b))
#endif

#define FP3_SCALE_LOG 120
#define FP3_SCALED_LEAST 0x3c800000 /* 2^-6: the least normal number times 2^120 */
#define FP3_SCALED_UNIT 0x31000000  /* 2^-29: the least subnormal number times 2^120 */
#define FP3_DOWN 0x03800000         /* 2^-120 */
#define FP3_LITTLE 0x12800000       /* 2^-90 */

/* In floats: where the product may be below the normal numbers, the smaller factor is multiplied by
 * 2^120. Then no number here is subnormal, and the product p of the scaled numbers is tiny, after
 * rounding as if the exponent had no bound, if p < 2^-6. The last bit of 2^-6 is 2^-149 times
 * 2^120; so a fused sum with 2^-6 rounds once, where a subnormal result is rounded, and its last
 * bits are that result. A larger factor below 2^-90 stands for a product below 2^-180, which is 0
 * and inexact: it is raised to 2^-90, with the same result.
 */
FP3_OPERATION fp3_light_product fp3_tiny_value(fp3_v a, fp3_v b) {
    const fp3_i x = fp3_magnitude(a), y = fp3_magnitude(b), least = fp3_all(FP3_SCALED_LEAST);
    const fp3_i less = FP3_LESSER(x, y), more = FP3_GREATER(FP3_GREATER(x, y), fp3_all(FP3_LITTLE));
    const fp3_i is_sub = less < FP3_LEAST; /* or 0 */
    /* As log2(1 + f) >= f, the sum of two numbers' bits is at most that of their product and 1. */
    const fp3_i may_be_small = is_sub | (fp3_i)((fp3_u)less + (fp3_u)more < (128u << 23));
    const fp3_v from_sub =
        __builtin_convertvector(less & is_sub, fp3_v) * (fp3_v)fp3_all(FP3_SCALED_UNIT);
    const fp3_i scaled = less + (may_be_small & (FP3_SCALE_LOG << 23));
    const fp3_v factor = fp3_choose(is_sub, from_sub, (fp3_v)scaled);
    const fp3_v p = factor * (fp3_v)more;
    const fp3_i is_small = may_be_small & (fp3_i)((fp3_u)p < (fp3_u)least); /* no NaN is */
    const fp3_v f = (fp3_v)((fp3_i)factor & is_small), m = (fp3_v)(more & is_small);
    const fp3_v sum = fp3_fused(f, m, (fp3_v)least);
    const fp3_v rest = fp3_fused(f, m, (fp3_v)least - sum); /* what rounding took away */
    const fp3_i bits = (fp3_i)sum - least;
    const fp3_v unscaled =
        fp3_choose(is_small, (fp3_v)least, p) *
        fp3_choose(may_be_small, (fp3_v)fp3_all(FP3_DOWN), (fp3_v)fp3_all(FP3_ONE));
    const fp3_i value = (fp3_i)fp3_choose(is_small, (fp3_v)bits, unscaled);
    return (fp3_light_product){(fp3_v)(value | (((fp3_i)a ^ (fp3_i)b) & FP3_SIGN)),
                               (is_sub & less) | (is_small & bits), (fp3_i)rest};
}

#else /* no fused sum, or rounding that differs */

FP3_OPERATION fp3_light_product fp3_tiny_value(fp3_v a, fp3_v b) {
    const fp3_product_of p = fp3_tiny_product(a, b);
    return (fp3_light_product){p.value, p.is_subnormal, p.under};
}

#endif

#endif
