/* SPDX-License-Identifier: Apache-2.0 */
/* lanes.h - each arithmetic operation for a vector of objects, lane by lane, with the bits of
 * machine/execute.c.
 *
 * It is compiled into the interpreter (sw/engine/fast/sweep.c), once for each kind of processor,
 * and its text stands in front of the C that sw/engine/fast/write.c writes for a program: so it
 * includes nothing. Who uses it defines, as 0 or 1, FP3_NEAREST, FP3_SUBNORMAL, FP3_FINITE,
 * FP3_FLAGS      the configuration's keys and compiles it with -ffp-contract=off -frounding-math.
 * The processor has the rounding of the configuration while it runs.
 *
 * What these functions leave to their caller: a NaN has any payload and sign until fp3_one_nan.
 * That is sound, as no operation tells one quiet NaN from another. With FP3_FLAGS the processor's
 * own sticky flags are those that the operations raise; so comparisons may not raise invalid for a
 * quiet NaN, and what an adder behind a value has to raise is raised by fp3_behind.
 */
#if defined __AVX512F__ && defined __AVX512DQ__
#define FP3_LANES 16
#elif defined __AVX2__
#define FP3_LANES 8
#else
#define FP3_LANES 4
#endif

typedef float fp3_v __attribute__((vector_size(4 * FP3_LANES), may_alias));
typedef int fp3_i __attribute__((vector_size(4 * FP3_LANES), may_alias));
typedef unsigned fp3_u __attribute__((vector_size(4 * FP3_LANES), may_alias));
typedef float fp3_loose __attribute__((vector_size(4 * FP3_LANES), may_alias, aligned(4)));
typedef float fp3_half __attribute__((vector_size(2 * FP3_LANES)));
typedef double fp3_d __attribute__((vector_size(4 * FP3_LANES)));
typedef long long fp3_l __attribute__((vector_size(4 * FP3_LANES)));

/* Where an asm may find a vector. */
#if defined __x86_64__
#define FP3_ANYWHERE "x"
#elif defined __aarch64__
#define FP3_ANYWHERE "w"
#else
#define FP3_ANYWHERE "m"
#endif

/* What is not used by a program is no mistake. */
#define FP3_OPERATION static inline __attribute__((always_inline, unused))

#define FP3_SIGN ((int)0x80000000u)
#define FP3_INFINITE 0x7f800000
#define FP3_LEAST 0x00800000 /* the least normal number */
#define FP3_ONE 0x3f800000
#define FP3_QUIET 0x7fc00000      /* the NaN of every result */
#define FP3_SIGNALLING 0x7fa00000 /* raises invalid in the adder */

FP3_OPERATION fp3_i fp3_all(int bits) { return (fp3_i){0} + bits; }
/* Where the mask is -1 a, where it is 0 b. */
FP3_OPERATION fp3_v fp3_choose(fp3_i mask, fp3_v a, fp3_v b) {
    return (fp3_v)((mask & (fp3_i)a) | (~mask & (fp3_i)b));
}
FP3_OPERATION fp3_i fp3_magnitude(fp3_v a) { return (fp3_i)a & ~FP3_SIGN; }
FP3_OPERATION fp3_i fp3_is_nan(fp3_v a) {
    return (fp3_magnitude(a) > FP3_INFINITE) & (FP3_FINITE ? 0 : -1);
}
FP3_OPERATION fp3_i fp3_exponent(fp3_v a) { return ((fp3_i)a >> 23) & 255; }

FP3_OPERATION fp3_v fp3_one_nan(fp3_v a) {
    return fp3_choose(fp3_is_nan(a), (fp3_v)fp3_all(FP3_QUIET), a);
}

/* ---- what is flushed, and halves in double ---- */

FP3_OPERATION fp3_v fp3_flushed(fp3_v a) {
    if (FP3_SUBNORMAL)
        return a;
    return (fp3_v)((fp3_i)a & (((((fp3_i)a & FP3_INFINITE) != 0)) | FP3_SIGN));
}

/* Where a result that is not 0 is below the normal numbers: 0 of its sign, underflow and inexact.
 */
FP3_OPERATION fp3_v fp3_underflown(fp3_i mask, fp3_i sign, fp3_v result) {
    if (FP3_FLAGS) {
        fp3_v x = fp3_choose(mask, (fp3_v)fp3_all(FP3_LEAST + 1), (fp3_v)fp3_all(FP3_ONE));
        x *= x;
        __asm__ volatile("" : : FP3_ANYWHERE(x));
    }
    return fp3_choose(mask, (fp3_v)(sign & FP3_SIGN), result);
}

/* Halves of a vector, and a vector of its halves. */
#if FP3_LANES == 16
#define FP3_LOW 0, 1, 2, 3, 4, 5, 6, 7
#define FP3_HIGH 8, 9, 10, 11, 12, 13, 14, 15
#elif FP3_LANES == 8
#define FP3_LOW 0, 1, 2, 3
#define FP3_HIGH 4, 5, 6, 7
#else
#define FP3_LOW 0, 1
#define FP3_HIGH 2, 3
#endif
typedef int fp3_narrow __attribute__((vector_size(2 * FP3_LANES)));
FP3_OPERATION fp3_half fp3_part(fp3_v a, int part) {
    return part ? __builtin_shufflevector(a, a, FP3_HIGH) : __builtin_shufflevector(a, a, FP3_LOW);
}
FP3_OPERATION fp3_narrow fp3_part_i(fp3_i a, int part) {
    return part ? __builtin_shufflevector(a, a, FP3_HIGH) : __builtin_shufflevector(a, a, FP3_LOW);
}
FP3_OPERATION fp3_v fp3_whole(fp3_half low, fp3_half high) {
    return __builtin_shufflevector(low, high, FP3_LOW, FP3_HIGH);
}
FP3_OPERATION fp3_i fp3_whole_i(fp3_narrow low, fp3_narrow high) {
    return __builtin_shufflevector(low, high, FP3_LOW, FP3_HIGH);
}

/* Half of a vector in double, and a mask of double made one of float. */
FP3_OPERATION fp3_d fp3_wide(fp3_v a, int part) {
    return __builtin_convertvector(fp3_part(a, part), fp3_d);
}
FP3_OPERATION fp3_i fp3_joined(fp3_l low, fp3_l high) {
    return fp3_whole_i(__builtin_convertvector(low, fp3_narrow),
                       __builtin_convertvector(high, fp3_narrow));
}

/* Bits of a double, which has every product of two floats: those of the magnitude. */
#define FP3_WIDE_LEAST 0x3810000000000000ll /* 2^-126 */
FP3_OPERATION fp3_l fp3_product(fp3_v a, fp3_v b, int part) {
    return (fp3_l)(fp3_wide(a, part) * fp3_wide(b, part)) & 0x7fffffffffffffffll;
}
FP3_OPERATION fp3_l fp3_is_below(fp3_v a, fp3_v b, int part, long long bits) {
    const fp3_l size = fp3_product(a, b, part);
    return (size < bits) & (size != 0);
}

/* ---- numbers without infinities, as doubles ---- */

#define FP3_MOST 0x7fffffff               /* the largest number */
#define FP3_MOST_ESTIMATE 0x7fffe000      /* ... of those that an estimate can be */
#define FP3_WIDE_BIAS (896ll << 52)       /* by how much a double's exponent has more */
#define FP3_WIDE_TOP 0x4800000000000000ll /* 2^129: the first that is too large */
#define FP3_WIDE_BELOW 0x1fffffffll       /* bits of a double below a float's last */

/* What was lost of each number, as masks. */
typedef struct {
    fp3_v value;
    fp3_i over, under, inexact;
} fp3_finite;

FP3_OPERATION fp3_d fp3_finite_wide(fp3_v a, int part) {
    const fp3_l bits = __builtin_convertvector(fp3_part_i((fp3_i)a, part), fp3_l);
    const fp3_l size = (bits & 0x7fffffff) << 29, is_some = (bits & FP3_INFINITE) != 0;
    return (fp3_d)((is_some & (size + FP3_WIDE_BIAS)) | (bits & (long long)0x8000000000000000ull));
}

/* Halves that are exact, or truncated by the processor: truncated. is_cut: by the processor. */
FP3_OPERATION fp3_finite fp3_finite_of(fp3_d low, fp3_d high, fp3_i is_cut) {
    const fp3_l x[2] = {(fp3_l)low & 0x7fffffffffffffffll, (fp3_l)high & 0x7fffffffffffffffll};
    const fp3_i sign = fp3_whole_i(__builtin_convertvector((fp3_l)low >> 32, fp3_narrow),
                                   __builtin_convertvector((fp3_l)high >> 32, fp3_narrow)) &
                       FP3_SIGN;
    const fp3_i bits =
        fp3_whole_i(__builtin_convertvector((x[0] - FP3_WIDE_BIAS) >> 29, fp3_narrow),
                    __builtin_convertvector((x[1] - FP3_WIDE_BIAS) >> 29, fp3_narrow));
    const fp3_i small = fp3_joined(x[0] < FP3_WIDE_LEAST, x[1] < FP3_WIDE_LEAST);
    const fp3_i over = fp3_joined(x[0] >= FP3_WIDE_TOP, x[1] >= FP3_WIDE_TOP);
    const fp3_i below = fp3_joined((x[0] & FP3_WIDE_BELOW) != 0, (x[1] & FP3_WIDE_BELOW) != 0);
    const fp3_i under = small & fp3_joined(x[0] != 0, x[1] != 0);
    const fp3_i size = (over & FP3_MOST) | (~over & bits);
    return (fp3_finite){(fp3_v)(~small & (size | sign)), over, under,
                        over | under | below | is_cut};
}
/* That the processor cut a sum shows in the difference with the larger one, which is exact in every
 * rounding (Dekker 1971). */
FP3_OPERATION fp3_l fp3_is_cut(fp3_d a, fp3_d b, fp3_d sum) {
    return (sum - a != b) | (sum - b != a);
}
FP3_OPERATION fp3_finite fp3_finite_sum(fp3_v a, fp3_v b, int is_told) {
    const fp3_d x[2] = {fp3_finite_wide(a, 0), fp3_finite_wide(a, 1)};
    const fp3_d y[2] = {fp3_finite_wide(b, 0), fp3_finite_wide(b, 1)};
    const fp3_d sum[2] = {x[0] + y[0], x[1] + y[1]};
    fp3_i is_cut = fp3_all(0);
    if (is_told)
        is_cut = fp3_joined(fp3_is_cut(x[0], y[0], sum[0]), fp3_is_cut(x[1], y[1], sum[1]));
    return fp3_finite_of(sum[0], sum[1], is_cut);
}
/* Exact as a double. */
FP3_OPERATION fp3_finite fp3_finite_product(fp3_v a, fp3_v b) {
    return fp3_finite_of(fp3_finite_wide(a, 0) * fp3_finite_wide(b, 0),
                         fp3_finite_wide(a, 1) * fp3_finite_wide(b, 1), fp3_all(0));
}
/* The value; the processor raises what a product of this number with itself does: all that was
 * lost. */
FP3_OPERATION fp3_v fp3_finite_raised(fp3_finite of) {
    if (FP3_FLAGS) {
        const fp3_i lost = (of.over & 0x7f7fffff) | (of.under & (FP3_LEAST + 1)) |
                           (of.inexact & ~(of.over | of.under) & (FP3_ONE + 1));
        fp3_v x = (fp3_v)(lost | (~of.inexact & FP3_ONE));
        x *= x;
        __asm__ volatile("" : : FP3_ANYWHERE(x));
    }
    return of.value;
}
/* Functions: a program of some hundred of these in line would take a compiler minutes. */
static __attribute__((noinline, unused)) fp3_v fp3_finite_add(fp3_v a, fp3_v b) {
    return fp3_finite_raised(fp3_finite_sum(a, b, 0));
}
static __attribute__((noinline, unused)) fp3_v fp3_finite_mul(fp3_v a, fp3_v b) {
    return fp3_finite_raised(fp3_finite_product(a, b));
}
FP3_OPERATION fp3_v fp3_minus(fp3_v a) { return (fp3_v)((fp3_i)a ^ FP3_SIGN); }

/* ---- adder and multiplier ---- */

/* Functions, too, where subnormal numbers are flushed. A sum below the normal numbers is exact. */
static __attribute__((noinline, unused)) fp3_v fp3_flushed_add(fp3_v a, fp3_v b) {
    const fp3_v sum = fp3_flushed(a) + fp3_flushed(b);
    const fp3_i size = fp3_magnitude(sum);
    return fp3_underflown((size < FP3_LEAST) & (size != 0), (fp3_i)sum, sum);
}
static __attribute__((noinline, unused)) fp3_v fp3_flushed_mul(fp3_v a, fp3_v b) {
    const fp3_v x = fp3_flushed(a), y = fp3_flushed(b);
    return fp3_underflown(
        fp3_joined(fp3_is_below(x, y, 0, FP3_WIDE_LEAST), fp3_is_below(x, y, 1, FP3_WIDE_LEAST)),
        (fp3_i)a ^ (fp3_i)b, x * y);
}

FP3_OPERATION fp3_v fp3_add(fp3_v a, fp3_v b) {
    if (FP3_FINITE)
        return fp3_finite_add(a, b);
    if (FP3_SUBNORMAL)
        return a + b;
    return fp3_flushed_add(a, b);
}
FP3_OPERATION fp3_v fp3_sub(fp3_v a, fp3_v b) {
    if (FP3_FINITE)
        return fp3_add(a, fp3_minus(b));
    if (FP3_SUBNORMAL)
        return a - b;
    return fp3_flushed_add(a, fp3_minus(b));
}

FP3_OPERATION fp3_v fp3_mul(fp3_v a, fp3_v b) {
    if (FP3_FINITE)
        return fp3_finite_mul(a, b);
    if (FP3_SUBNORMAL)
        return a * b;
    return fp3_flushed_mul(a, b);
}

FP3_OPERATION fp3_v fp3_madd(fp3_v a, fp3_v b, fp3_v c) { return fp3_add(c, fp3_mul(a, b)); }
FP3_OPERATION fp3_v fp3_msub(fp3_v a, fp3_v b, fp3_v c) { return fp3_sub(c, fp3_mul(a, b)); }
#define FP3_HALF ((fp3_v)fp3_all(0x3f000000))
#define FP3_TWO ((fp3_v)fp3_all(0x40000000))
FP3_OPERATION fp3_v fp3_addh(fp3_v a, fp3_v b) { return fp3_add(a, fp3_mul(b, FP3_HALF)); }
FP3_OPERATION fp3_v fp3_subh(fp3_v a, fp3_v b) { return fp3_sub(a, fp3_mul(b, FP3_HALF)); }
FP3_OPERATION fp3_v fp3_addt(fp3_v a, fp3_v b) { return fp3_add(a, fp3_mul(b, FP3_TWO)); }
FP3_OPERATION fp3_v fp3_subt(fp3_v a, fp3_v b) { return fp3_sub(a, fp3_mul(b, FP3_TWO)); }

/* ---- comparison, selection ---- */

/* Signed integers in the order of the numbers, but for the zeros. */
FP3_OPERATION fp3_i fp3_order(fp3_v a) { return (fp3_i)a ^ (((fp3_i)a < 0) & ~FP3_SIGN); }
/* Without infinities: subnormal numbers are read as zeros. */
FP3_OPERATION fp3_i fp3_finite_order(fp3_v a) {
    return fp3_order((fp3_v)((fp3_i)a & (fp3_exponent(a) != 0)));
}
FP3_OPERATION fp3_i fp3_is_number(fp3_v a, fp3_v b) { return ~(fp3_is_nan(a) | fp3_is_nan(b)); }
FP3_OPERATION fp3_i fp3_are_zero(fp3_v a, fp3_v b) {
    return (((fp3_i)a | (fp3_i)b) & ~FP3_SIGN) == 0;
}

#if FP3_LANES == 16
/* Predicates 17 and 18: less, less or equal, ordered, quiet. */
#define FP3_COMPARE(a, b, predicate)                                                               \
    ((fp3_i)__builtin_ia32_cvtmask2d512(                                                           \
        __builtin_ia32_cmpps512_mask((a), (b), (predicate), (unsigned short)-1, 4)))
#elif FP3_LANES == 8
#define FP3_COMPARE(a, b, predicate) ((fp3_i)__builtin_ia32_cmpps256((a), (b), (predicate)))
#endif

#ifdef FP3_COMPARE
FP3_OPERATION fp3_i fp3_is_less(fp3_v a, fp3_v b) {
    if (FP3_FINITE)
        return fp3_finite_order(a) < fp3_finite_order(b);
    return FP3_COMPARE(a, b, 17);
}
FP3_OPERATION fp3_i fp3_is_at_most(fp3_v a, fp3_v b) {
    if (FP3_FINITE)
        return fp3_finite_order(a) <= fp3_finite_order(b);
    return FP3_COMPARE(a, b, 18);
}
/* Of any operands: even a quiet comparison raises invalid for a signalling NaN, so each is made a
 * quiet one. */
FP3_OPERATION fp3_v fp3_quieted(fp3_v a) {
    return (fp3_v)((fp3_i)a | (fp3_is_nan(a) & (FP3_QUIET ^ FP3_INFINITE)));
}
FP3_OPERATION fp3_i fp3_is_less_raw(fp3_v a, fp3_v b) {
    return fp3_is_less(fp3_quieted(a), fp3_quieted(b));
}
FP3_OPERATION fp3_i fp3_is_at_most_raw(fp3_v a, fp3_v b) {
    return fp3_is_at_most(fp3_quieted(a), fp3_quieted(b));
}
#else
/* In integers. */
FP3_OPERATION fp3_i fp3_is_less_raw(fp3_v a, fp3_v b) {
    if (FP3_FINITE)
        return fp3_finite_order(a) < fp3_finite_order(b);
    return (fp3_order(a) < fp3_order(b)) & fp3_is_number(a, b) & ~fp3_are_zero(a, b);
}
FP3_OPERATION fp3_i fp3_is_at_most_raw(fp3_v a, fp3_v b) {
    if (FP3_FINITE)
        return fp3_finite_order(a) <= fp3_finite_order(b);
    return ((fp3_order(a) <= fp3_order(b)) & fp3_is_number(a, b)) | fp3_are_zero(a, b);
}
#define fp3_is_less fp3_is_less_raw
#define fp3_is_at_most fp3_is_at_most_raw
#endif

/* The adder behind every value: subnormal numbers are flushed, a signalling NaN raises invalid. The
 * asm hides the constant, as the compiler takes x + -0 for x. */
FP3_OPERATION fp3_v fp3_behind(fp3_v a) {
    const fp3_v value = fp3_flushed(a);
    if (FP3_FINITE)
        return (fp3_v)((fp3_i)a & (fp3_exponent(a) != 0));
    if (!FP3_FLAGS)
        return value;
    fp3_i zero = fp3_all(FP3_SIGN);
    __asm__("" : "+" FP3_ANYWHERE(zero));
    return value + (fp3_v)zero;
}

FP3_OPERATION fp3_v fp3_min(fp3_v a, fp3_v b) { return fp3_choose(fp3_is_less(a, b), a, b); }
FP3_OPERATION fp3_v fp3_max(fp3_v a, fp3_v b) { return fp3_choose(fp3_is_less(b, a), a, b); }
FP3_OPERATION fp3_v fp3_lt(fp3_v a, fp3_v b) { return (fp3_v)(fp3_is_less(a, b) & FP3_ONE); }
FP3_OPERATION fp3_v fp3_le(fp3_v a, fp3_v b) { return (fp3_v)(fp3_is_at_most(a, b) & FP3_ONE); }
/* The same where an operand may be a signalling NaN. */
FP3_OPERATION fp3_v fp3_min_raw(fp3_v a, fp3_v b) {
    return fp3_choose(fp3_is_less_raw(a, b), a, b);
}
FP3_OPERATION fp3_v fp3_max_raw(fp3_v a, fp3_v b) {
    return fp3_choose(fp3_is_less_raw(b, a), a, b);
}
FP3_OPERATION fp3_v fp3_lt_raw(fp3_v a, fp3_v b) {
    return (fp3_v)(fp3_is_less_raw(a, b) & FP3_ONE);
}
FP3_OPERATION fp3_v fp3_le_raw(fp3_v a, fp3_v b) {
    return (fp3_v)(fp3_is_at_most_raw(a, b) & FP3_ONE);
}
FP3_OPERATION fp3_v fp3_abs(fp3_v a) { return (fp3_v)fp3_magnitude(a); }
FP3_OPERATION fp3_v fp3_sel(fp3_v a, fp3_v b, fp3_v c) {
    return fp3_choose((FP3_FINITE ? fp3_exponent(c) : fp3_magnitude(c)) != 0, a, b);
}

/* ---- estimates, rounding, exponents ---- */

FP3_OPERATION fp3_i fp3_entry(const int *table, fp3_i index) {
#if FP3_LANES == 16
    return (fp3_i)__builtin_ia32_gathersiv16si(fp3_all(0), table, index, (unsigned short)-1, 4);
#elif FP3_LANES == 8
    return (fp3_i)__builtin_ia32_gathersiv8si(fp3_all(0), table, index, fp3_all(-1), 4);
#else
    fp3_i entry = fp3_all(0);
    for (int i = 0; i < FP3_LANES; i++)
        entry[i] = table[index[i]];
    return entry;
#endif
}

/* The estimates without their table, where all lanes are ordinary numbers. An entry is 1/u or
 * 1/sqrt(u) of the upper end u of its interval, cut to its bits. Of all 2,048, some are cut
 * nowhere; the others are cut by 7.5 units of FP32 or more, and all are 31 or more below the next
 * entry. A step of Newton's is wrong by 2 units at most. Its 1 (or 1/2) is 2^-22 more than that,
 * which makes the result 2 to 4 units larger, so that it may be cut. These instructions raise no
 * flag, and round to nearest in any mode. */
#define FP3_NUMBER(of) fp3_all(table[FP3_AT_##of])
#if FP3_LANES == 16 && !defined __clang__
#define FP3_ALL_LANES ((unsigned short)-1)
#define FP3_QUIETLY 8 /* to nearest, no exceptions */
#define FP3_QUIET_MUL(a, b) __builtin_ia32_mulps512_mask((a), (b), (a), FP3_ALL_LANES, FP3_QUIETLY)
#define FP3_QUIET_MADD(a, b, c)                                                                    \
    __builtin_ia32_vfmaddps512_mask((a), (b), (c), FP3_ALL_LANES, FP3_QUIETLY)
#define FP3_QUIET_MSUB(a, b, c)                                                                    \
    __builtin_ia32_vfnmaddps512_mask((a), (b), (c), FP3_ALL_LANES, FP3_QUIETLY)

FP3_OPERATION int fp3_are_ordinary(fp3_i a, fp3_i least, const int *table) {
    return __builtin_ia32_ucmpd512_mask(a - least, FP3_NUMBER(ABOVE), 1, FP3_ALL_LANES) ==
           FP3_ALL_LANES;
}
FP3_OPERATION fp3_v fp3_rcp_ordinary(fp3_v a, const int *table) {
    const fp3_v u = (fp3_v)(((fp3_i)a | FP3_NUMBER(RCP_END)) + FP3_NUMBER(NEXT));
    const fp3_v y = __builtin_ia32_rcp14ps512_mask(u, u, FP3_ALL_LANES);
    const fp3_v off = FP3_QUIET_MSUB(u, y, (fp3_v)FP3_NUMBER(ONE));
    return (fp3_v)((fp3_i)FP3_QUIET_MADD(y, off, y) & FP3_NUMBER(RCP_CUT));
}
FP3_OPERATION fp3_v fp3_rsqrt_ordinary(fp3_v a, const int *table) {
    const fp3_i end = (fp3_i)a | FP3_NUMBER(RSQRT_END);
    const fp3_v u = (fp3_v)(end + FP3_NUMBER(NEXT)), half = (fp3_v)(end + FP3_NUMBER(HALF_OF_NEXT));
    const fp3_v y = __builtin_ia32_rsqrt14ps512_mask(u, u, FP3_ALL_LANES);
    const fp3_v off = FP3_QUIET_MSUB(FP3_QUIET_MUL(half, y), y, (fp3_v)FP3_NUMBER(HALF));
    const fp3_i cut = (((fp3_i)a >> 10) & FP3_NUMBER(RSQRT_ODD)) | FP3_NUMBER(RSQRT_CUT);
    return (fp3_v)((fp3_i)FP3_QUIET_MADD(y, off, y) & ~cut);
}
#elif FP3_LANES == 8 && defined __FMA__
/* The processor's estimate is wrong by 1.5/4096 at most; 1.41/4096 is asked for here, so each
 * processor is looked at (fp3_are_estimates_exact). So the nearest number with an entry's bits is
 * that entry or the next one: it is the next one if its product with u is above 1. These products
 * are exact, so they raise nothing, in any mode.
 */
FP3_OPERATION int fp3_are_ordinary(fp3_i a, fp3_i least, const int *table) {
    const fp3_i is = (fp3_u)(a - least) < (fp3_u)FP3_NUMBER(ABOVE);
    return __builtin_ia32_movmskps256((fp3_v)is) == 255;
}
FP3_OPERATION fp3_v fp3_rcp_ordinary(fp3_v a, const int *table) {
    const fp3_v u = (fp3_v)(((fp3_i)a | FP3_NUMBER(RCP_END)) + FP3_NUMBER(NEXT));
    const fp3_i y = (fp3_i)__builtin_ia32_rcpps256(u) + FP3_NUMBER(RSQRT_ODD);
    const fp3_v next = (fp3_v)(y & FP3_NUMBER(RCP_CUT));
    return (fp3_v)((fp3_i)next + (FP3_COMPARE((fp3_v)fp3_all(FP3_ONE), u * next, 17) << 14));
}
FP3_OPERATION fp3_v fp3_rsqrt_ordinary(fp3_v a, const int *table) {
    const fp3_v u = (fp3_v)(((fp3_i)a | FP3_NUMBER(RSQRT_END)) + FP3_NUMBER(NEXT));
    const fp3_i odd = ((fp3_i)a >> 10) & FP3_NUMBER(RSQRT_ODD), unit = odd + FP3_NUMBER(RSQRT_ODD);
    const fp3_i y = (fp3_i)__builtin_ia32_rsqrtps256(u) + (unit >> 1);
    const fp3_v next = (fp3_v)(y & -unit);
    const fp3_v left = __builtin_ia32_vfmaddps256(-(u * next), next, (fp3_v)fp3_all(FP3_ONE));
    return (fp3_v)((fp3_i)next - (((fp3_i)left >> 31) & unit));
}
#else
#define fp3_are_ordinary(a, least, table) ((void)(a), (void)(table), 0)
#define fp3_rcp_ordinary(a, table) (a)
#define fp3_rsqrt_ordinary(a, table) (a)
#endif

/* Exponents 1 to 251 of any sign; 2 to 252, as a step of Newton's takes half of one. */
FP3_OPERATION int fp3_rcp_is_ordinary(fp3_v a, const int *table) {
    return fp3_are_ordinary(fp3_magnitude(a), FP3_NUMBER(RCP_LEAST), table);
}
FP3_OPERATION int fp3_rsqrt_is_ordinary(fp3_v a, const int *table) {
    return fp3_are_ordinary((fp3_i)a, FP3_NUMBER(RSQRT_LEAST), table);
}

FP3_OPERATION fp3_v fp3_rcp_any(fp3_v a, const int *table) {
    const fp3_i sign = (fp3_i)a & FP3_SIGN, e = fp3_exponent(a);
    const fp3_i entry = fp3_entry(table, ((fp3_i)a & 0x7fffff) >> 13), is_small = e >= 253;
    const fp3_i down = is_small & (e - 253) & 3;
    fp3_i bits = (is_small & (((entry | 512) >> down) << 13)) |
                 (~is_small & (((253 - e) << 23) | (entry << 14)));
    bits &= e < (FP3_FINITE ? 253 : 255);
    bits = (~(e == 0) & bits) | ((e == 0) & (FP3_FINITE ? FP3_MOST_ESTIMATE : FP3_INFINITE));
    return fp3_choose(fp3_is_nan(a), a, (fp3_v)(bits | sign));
}

FP3_OPERATION fp3_v fp3_rsqrt_any(fp3_v a, const int *table) {
    const fp3_i e = fp3_exponent(a), odd = e & 1;
    const fp3_i entry = fp3_entry(table + 1024, odd * 512 + (((fp3_i)a & 0x7fffff) >> 14));
    fp3_i bits = ((190 - ((e + 1) >> 1)) << 23) | (entry << (13 + odd));
    if (FP3_FINITE) {
        const fp3_i is_right = (e != 0) & ((fp3_i)a >= 0);
        return (fp3_v)((is_right & bits) | (~is_right & FP3_MOST_ESTIMATE));
    }
    bits &= e != 255;
    bits = (((fp3_i)a < 0) & FP3_SIGNALLING) | (~((fp3_i)a < 0) & bits);
    bits = ((e == 0) & FP3_INFINITE) | (~(e == 0) & bits);
    return fp3_choose(fp3_is_nan(a), a, (fp3_v)bits);
}

#define FP3_ESTIMATE(of, a, table, how)                                                            \
    (fp3_##of##_is_ordinary((a), (table)) ? fp3_##of##_ordinary((a), (table))                      \
                                          : how(fp3_##of##_any((a), (table))))
FP3_OPERATION fp3_v fp3_rcp(fp3_v a, const int *table) { return FP3_ESTIMATE(rcp, a, table, ); }
FP3_OPERATION fp3_v fp3_rsqrt(fp3_v a, const int *table) { return FP3_ESTIMATE(rsqrt, a, table, ); }
/* The same with the adder behind it, which does nothing to an ordinary number. */
FP3_OPERATION fp3_v fp3_rcp_behind(fp3_v a, const int *table) {
    return FP3_ESTIMATE(rcp, a, table, fp3_behind);
}
FP3_OPERATION fp3_v fp3_rsqrt_behind(fp3_v a, const int *table) {
    return FP3_ESTIMATE(rsqrt, a, table, fp3_behind);
}

/* 1: what is computed is what the table has, in each interval, with an even exponent and an odd
 * one.
 */
FP3_OPERATION int fp3_are_estimates_exact(const int *table) {
    fp3_i is_wrong = fp3_all(0), a = fp3_all(FP3_ONE);
    for (int i = 0; i < FP3_LANES; i++)
        a[i] += i << 13;
    for (int i = 0; i < 2048; i += FP3_LANES, a += FP3_LANES << 13) {
        const fp3_v of = (fp3_v)a;
        is_wrong |= (fp3_i)fp3_rcp(of, table) != (fp3_i)fp3_rcp_any(of, table);
        is_wrong |= (fp3_i)fp3_rsqrt(of, table) != (fp3_i)fp3_rsqrt_any(of, table);
    }
    for (int i = 1; i < FP3_LANES; i++)
        is_wrong[0] |= is_wrong[i];
    return !is_wrong[0];
}

/* In integers: the fraction's bits that go, and half of the last that stays. */
FP3_OPERATION fp3_v fp3_rint(fp3_v a) {
    const fp3_i size = fp3_magnitude(a), e = fp3_exponent(a), sign = (fp3_i)a & FP3_SIGN;
    const fp3_i places = 150 - e, is_whole = places <= 0, is_less = e < 127; /* than 1 */
    const fp3_i shift = ~(is_whole | is_less) & places;
    fp3_i rounded = size;
    if (FP3_NEAREST)
        rounded +=
            ~(is_whole | is_less) & (((fp3_all(1) << shift) >> 1) - 1 + ((size >> shift) & 1));
    rounded = (rounded >> shift) << shift;
    const fp3_i one = (size > 0x3f000000) & (FP3_NEAREST ? FP3_ONE : 0);
    rounded = (is_less & one) | (~is_less & rounded);
    return (fp3_v)((is_whole & (fp3_i)a) | (~is_whole & (rounded | sign)));
}

/* 2^n of the integral part n. */
FP3_OPERATION fp3_v fp3_exp2(fp3_v a) {
    const fp3_i e = fp3_exponent(a), is_minus = (fp3_i)a<0, is_over = e> 134;
    const fp3_i shift = (150 - e) & 31, significand = ((fp3_i)a & 0x7fffff) | 0x800000;
    const fp3_i n = ((e >= 127) & ~is_over & (significand >> shift)) | (is_over & 1024);
    const fp3_i is_tiny = n > 126; /* 2^-n */
    const fp3_i below = (is_tiny & (n < 150)) & (fp3_all(1) << ((149 - n) & 31));
    const fp3_i down = (is_tiny & below) | (~is_tiny & ((127 - n) << 23));
    const fp3_i is_high = n > (FP3_FINITE ? 128 : 127);
    const fp3_i up =
        (is_high & (FP3_FINITE ? FP3_MOST : FP3_INFINITE)) | (~is_high & ((127 + n) << 23));
    return fp3_choose(fp3_is_nan(a), a, (fp3_v)((is_minus & down) | (~is_minus & up)));
}

/* A zero or subnormal number has -infinity. */
FP3_OPERATION fp3_v fp3_logb(fp3_v a) {
    const fp3_i e = fp3_exponent(a);
    fp3_i n = e - 127;
    fp3_i bits = (fp3_i) __builtin_convertvector(n, fp3_v);
    if (FP3_FINITE)
        return (fp3_v)(((e == 0) & (FP3_MOST | FP3_SIGN)) | (~(e == 0) & bits));
    bits = ((e == 255) & FP3_INFINITE) | (~(e == 255) & bits);
    bits = ((e == 0) & (FP3_INFINITE | FP3_SIGN)) | (~(e == 0) & bits);
    return fp3_choose(fp3_is_nan(a), a, (fp3_v)bits);
}

/* Each lane's value from another lane. */
FP3_OPERATION fp3_v fp3_from(fp3_v a, fp3_i lane) {
#if defined __GNUC__ && !defined __clang__
    return __builtin_shuffle(a, lane);
#else
    fp3_v made = a;
    for (int i = 0; i < FP3_LANES; i++)
        made[i] = a[lane[i]];
    return made;
#endif
}

/* |a| < b, as sleep compares. */
FP3_OPERATION fp3_i fp3_sleeps(fp3_v a, fp3_v b) { return fp3_is_less_raw(fp3_abs(a), b); }
