/* SPDX-License-Identifier: Apache-2.0 */
/* short.h - operations of numbers with fewer fraction bits than binary32, for a vector of objects,
 * in double: 53 bits are enough that a sum or product of at most 24 bits may be rounded once more
 * (Figueroa, "When is double rounding innocuous?", ACM SIGNUM Newsletter 30, 1995). For sweep.c,
 * behind tiny.h. What is not ordinary is left to machine/execute.h: infinities, NaN, results that
 * are or become subnormal or overflow, and the operations that no step uses often. */
#ifndef FP3_FAST_SHORT_H
#define FP3_FAST_SHORT_H

#include <fp3/isa.h>
#include <machine/narrow.h>

typedef double fp3_doubles __attribute__((vector_size(8 * FP3_LANES)));
typedef unsigned long long fp3_longs __attribute__((vector_size(8 * FP3_LANES)));

#define FP3_LONG_SIGN 0x8000000000000000ull
#define FP3_LONG_LEAST 0x3810000000000000ull /* 2^-126 */
#define FP3_LONG_OVER 0x47f0000000000000ull  /* 2^128 */

/* The rounding of a configuration, and what results of a row met. */
typedef struct {
    int read;  /* of a word: what arithmetic reads */
    int place; /* of a double: of the last bit that stays */
    unsigned long long cut,
        half; /* the bits below; half of the last, or a little less (0: truncates) */
    int is_flushed;
    fp3_longs lost; /* not 0: a result was rounded */
} fp3_short;

/* Of one operation: not 0 where an operand, or bit 63 where a result, is not ordinary; what is
 * rounded away. */
typedef struct {
    fp3_i operand;
    fp3_longs result, lost;
} fp3_short_met;

static inline fp3_short fp3_short_of(const fp3_config *config) {
    const int place = 52 - (int)config->fraction;
    return (fp3_short){.read = (int)fp3_narrow_read(config, UINT32_MAX),
                       .place = place,
                       .cut = (1ull << place) - 1,
                       .half = config->nearest ? (1ull << (place - 1)) - 1 : 0,
                       .is_flushed = !config->subnormal};
}

static inline unsigned long long fp3_short_any(fp3_longs bits) {
    unsigned long long any = 0;
    for (int i = 0; i < FP3_LANES; i++)
        any |= bits[i];
    return any;
}

static inline int fp3_any(fp3_i bits) {
    int any = 0;
    for (int i = 0; i < FP3_LANES; i++)
        any |= bits[i];
    return any;
}

/* As it is read; only a finite one is ordinary. */
FP3_OPERATION fp3_v fp3_short_operand(const fp3_short *n, fp3_short_met *met, fp3_v a) {
    const fp3_i bits = (fp3_i)a & n->read, size = bits & ~FP3_SIGN;
    const fp3_i is_subnormal = (size < FP3_LEAST) & (size != 0);
    met->operand |= (size >= FP3_INFINITE) | (is_subnormal & -n->is_flushed);
    return (fp3_v)bits;
}

/* Ordinary: 0, or from 2^-126 on before it is rounded, and finite behind. By sums alone, as not
 * every processor compares 64 bits. */
FP3_OPERATION fp3_v fp3_short_rounded(const fp3_short *n, fp3_short_met *met, fp3_doubles exact) {
    const fp3_longs bits = (fp3_longs)exact, size = bits & ~FP3_LONG_SIGN;
    const fp3_longs up = n->half ? n->half + (bits >> n->place & 1) : size - size;
    const fp3_longs d = (bits + up) & ~n->cut;
    met->result |= (size - FP3_LONG_LEAST) & ~(size - 1);
    met->result |= (d & ~FP3_LONG_SIGN) + (FP3_LONG_SIGN - FP3_LONG_OVER);
    met->lost |= bits & n->cut;
    return __builtin_convertvector((fp3_doubles)d, fp3_v);
}

FP3_OPERATION fp3_doubles fp3_short_wide(fp3_v a) {
    return __builtin_convertvector(a, fp3_doubles);
}

FP3_OPERATION fp3_v fp3_short_sum(const fp3_short *n, fp3_short_met *met, fp3_v a, fp3_v b) {
    return fp3_short_rounded(n, met, fp3_short_wide(a) + fp3_short_wide(b));
}
FP3_OPERATION fp3_v fp3_short_product(const fp3_short *n, fp3_short_met *met, fp3_v a, fp3_v b) {
    return fp3_short_rounded(n, met, fp3_short_wide(a) * fp3_short_wide(b));
}

/* Of ordinary operands a is the magnitude that has an estimate. */
FP3_OPERATION fp3_v fp3_short_estimate(const fp3_short *n, fp3_short_met *met, uint32_t op, fp3_v a,
                                       const int *table) {
    const fp3_i e = fp3_exponent(a);
    const int is_root = op == FP3_OP_RSQRT;
    met->operand |= (e == 0) | (e >= 253) | (((fp3_i)a < 0) & -is_root);
    const fp3_v y = is_root ? fp3_rsqrt(a, table) : fp3_rcp(a, table);
    return (fp3_v)((fp3_i)y & n->read);
}

/* Whether all lanes are ordinary; only then *d is the result. The processor's flags may rise: of
 * them only inexact counts. */
static inline int fp3_short_apply(fp3_short *n, uint32_t op, uint32_t sources, fp3_v a, fp3_v b,
                                  fp3_v c, const int *table, fp3_v *d) {
    fp3_short_met met = {0};
    fp3_v value;
    a = fp3_short_operand(n, &met, a);
    b = sources > 1 ? fp3_short_operand(n, &met, b) : a;
    c = sources > 2 ? fp3_short_operand(n, &met, c) : a;
    if (fp3_any(met.operand)) /* what is read as 0 must not raise inexact */
        return 0;
    switch (op) {
    case FP3_OP_ADD:
        value = fp3_short_sum(n, &met, a, b);
        break;
    case FP3_OP_SUB:
        value = fp3_short_sum(n, &met, a, fp3_minus(b));
        break;
    case FP3_OP_MUL:
        value = fp3_short_product(n, &met, a, b);
        break;
    case FP3_OP_MADD:
        value = fp3_short_sum(n, &met, c, fp3_short_product(n, &met, a, b));
        break;
    case FP3_OP_MSUB:
        value = fp3_short_sum(n, &met, c, fp3_minus(fp3_short_product(n, &met, a, b)));
        break;
    case FP3_OP_MIN:
        value = fp3_min_raw(a, b);
        break;
    case FP3_OP_MAX:
        value = fp3_max_raw(a, b);
        break;
    case FP3_OP_ABS:
        value = fp3_abs(a);
        break;
    case FP3_OP_LT:
        value = fp3_lt_raw(a, b);
        break;
    case FP3_OP_LE:
        value = fp3_le_raw(a, b);
        break;
    case FP3_OP_SEL:
        value = fp3_sel(a, b, c);
        break;
    case FP3_OP_RCP:
    case FP3_OP_RSQRT:
        value = fp3_short_estimate(n, &met, op, a, table);
        break;
    default:
        return 0;
    }
    if (fp3_any(met.operand) || fp3_short_any(met.result) >> 63)
        return 0;
    *d = value;
    n->lost |= met.lost;
    return 1;
}

#endif
