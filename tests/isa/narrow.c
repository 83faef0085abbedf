/* narrow - numbers with fewer fraction bits than binary32: the engine isa's operations against an
 * oracle of its own.
 *
 *     narrow FRACTION NEAREST SUBNORMAL COUNT
 *
 * sw/machine/narrow.c computes in integers. Here numbers are doubles, whose exponents go beyond
 * every result's. A product of two is exact. A sum is rounded to odd by the error that its rounding
 * leaves (Knuth, "The Art of Computer Programming" 2, 4.2.2, theorem B), and rounding to odd is no
 * second rounding where 53 bits become 24 or less (Boldo and Melquiond, "Emulation of a FMA and
 * correctly rounded sums", IEEE Transactions on Computers 57, 2008). Then all is rounded as a
 * multiple of its last place. All pairs of special numbers, COUNT random triples, and, of the
 * operations with one operand, every number.
 */
#include <base/bits.h>
#include <fp3/isa.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../cosim/chance.h"
#include "machine/execute.h"

#define REPORTS 10

static fp3_config config = {.flags = 1, .name = "narrow"};
static uint64_t tried, wrong, raised[5];

/* What a word is read as. */
static uint32_t read_as(uint32_t word) {
    const uint32_t below = (UINT32_C(1) << (23 - config.fraction)) - 1;
    return word & ~below;
}

static double value_of(uint32_t word) {
    const uint32_t bits = read_as(word), e = bits >> 23 & 255, f = bits & 0x7fffff;
    const double sign = bits >> 31 ? -1 : 1;
    if (e == 255)
        return f ? NAN : sign * INFINITY;
    if (e == 0 && !config.subnormal)
        return sign * 0.0;
    return sign * ldexp((double)(e ? f | 0x800000 : f), (e ? (int)e : 1) - 150);
}

static int is_signalling(uint32_t word) { return isnan(value_of(word)) && !(word & 0x400000); }

static double whole(double x) { return config.nearest ? rint(x) : trunc(x); }

/* x, of which rest is left out, as a word. */
static uint32_t rounded(double x, double rest, uint32_t *flags) {
    const int fraction = (int)config.fraction;
    const double size = fabs(x);
    const uint32_t sign = signbit(x) ? FP3_BITS_MINUS_ZERO : 0;
    const uint32_t largest = read_as(0x7f7fffff), infinite = 0x7f800000;
    int exponent;
    if (x == 0)
        return sign;
    frexp(x, &exponent); /* size is below 2^exponent */
    const int is_small = size < 0x1p-126, last = exponent - 1 - fraction;
    const double free = ldexp(whole(ldexp(size, -last)), last); /* with any exponent */
    const int place = is_small ? -126 - fraction : last;
    const double d = ldexp(whole(ldexp(size, -place)), place);
    *flags |= d != size || rest != 0 ? FP3_FLAG_INEXACT : 0;
    if (is_small && !config.subnormal) {
        *flags |= FP3_FLAG_UNDERFLOW | FP3_FLAG_INEXACT;
        return sign;
    }
    if (free < 0x1p-126 && *flags & FP3_FLAG_INEXACT)
        *flags |= FP3_FLAG_UNDERFLOW;
    if (d >= 0x1p128) {
        *flags |= FP3_FLAG_OVERFLOW | FP3_FLAG_INEXACT;
        return sign | (config.nearest ? infinite : largest);
    }
    return sign | fp3_bits_of((float)d);
}

/* z + p, p of at most 48 bits. */
static uint32_t sum(double z, double p, uint32_t *flags) {
    volatile double s = z + p;
    const volatile double of_p = s - z, of_z = s - of_p;
    double rest = (z - of_z) + (p - of_p);
    uint64_t bits;
    const double value = s;
    memcpy(&bits, &value, sizeof bits);
    if (!isfinite(s))
        rest = 0;
    if (rest != 0 && !(bits & 1))
        s = nextafter(s, rest > 0 ? INFINITY : -INFINITY);
    return rounded(s, rest, flags);
}

static int is_nan(uint32_t word) { return isnan(value_of(word)); }

static uint32_t result_of(uint32_t op, const uint32_t w[3], uint32_t *flags) {
    const double a = value_of(w[0]), b = value_of(w[1]), c = value_of(w[2]);
    const int is_fused = op == FP3_OP_FMADD || op == FP3_OP_FMSUB,
              is_sum = op == FP3_OP_ADD || op == FP3_OP_SUB;
    const double p = is_sum ? (op == FP3_OP_SUB ? -b : b) : op == FP3_OP_FMSUB ? -a * b : a * b;
    const double z = is_sum ? a : is_fused ? c : 0;
    const int is_clash = !is_nan(w[0]) && !is_nan(w[1]) && isnan(p); /* infinity times zero */
    *flags = 0;
    if (is_signalling(w[0]) || is_signalling(w[1]) || (is_fused && is_signalling(w[2])) ||
        is_clash || (isinf(z) && isinf(p) && z != p))
        *flags = FP3_FLAG_INVALID;
    if (isnan(p) || isnan(z) || *flags)
        return FP3_BITS_NAN;
    if (isinf(p) || isinf(z)) {
        const double d = z + p;
        return d > 0 ? 0x7f800000 : 0xff800000;
    }
    return op == FP3_OP_MUL ? rounded(p, 0, flags) : sum(z, p, flags);
}

/* Operations that choose or look: the sum with -0 then rounds nothing. */
static uint32_t chosen_of(uint32_t op, const uint32_t w[3], uint32_t *flags) {
    const double a = value_of(w[0]);
    const uint32_t word = read_as(w[0]);
    double d = a;
    *flags = is_signalling(w[0]) ? FP3_FLAG_INVALID : 0;
    if (isnan(a))
        return FP3_BITS_NAN;
    if (op == FP3_OP_ABS)
        d = fabs(a);
    else if (op == FP3_OP_RINT)
        d = isinf(a) ? a : copysign(whole(a), a);
    else if (op == FP3_OP_LOGB)
        d = isinf(a) ? INFINITY : fabs(a) < 0x1p-126 ? -INFINITY : logb(a);
    else
        d = trunc(a) > 127 ? INFINITY : ldexp(1, a < -400 ? -400 : (int)trunc(a));
    /* fp_value reads a subnormal number as it is; the adder flushes it then. */
    if (op == FP3_OP_RINT && !config.subnormal && (word & 0x7f800000) == 0)
        d = copysign(0.0, signbit(a) ? -1.0 : 1.0);
    if (op == FP3_OP_EXP2 && d < ldexp(0x1p-126, config.subnormal ? -(int)config.fraction : 0))
        d = 0;
    if (isinf(d))
        return d > 0 ? 0x7f800000 : 0xff800000;
    uint32_t none = 0;
    return rounded(d, 0, &none);
}

/* The engine's, in the host's rounding that it asks for. */
static uint32_t execute(uint32_t op, const uint32_t w[3], uint32_t *flags) {
    const uint64_t callers = fp3_fpu_begin(config.nearest);
    const uint32_t d = fp3_execute(&config, op, w, flags);
    fp3_fpu_set(callers);
    return d;
}

static void compare(uint32_t op, const uint32_t w[3], uint32_t expected, uint32_t expected_flags) {
    uint32_t flags;
    const uint32_t got = execute(op, w, &flags);
    tried++;
    for (int i = 0; i < 5; i++)
        raised[i] += expected_flags >> i & 1;
    if (got == expected && flags == expected_flags)
        return;
    if (wrong++ < REPORTS)
        printf("FAIL op %" PRIu32 " of %08" PRIx32 " %08" PRIx32 " %08" PRIx32 ": %08" PRIx32
               " flags %02" PRIx32 ", expected %08" PRIx32 " flags %02" PRIx32 "\n",
               op, w[0], w[1], w[2], got, flags, expected, expected_flags);
}

static void try_all(const uint32_t w[3]) {
    static const uint32_t ops[] = {FP3_OP_ADD, FP3_OP_SUB, FP3_OP_MUL, FP3_OP_FMADD, FP3_OP_FMSUB};
    for (size_t i = 0; i < sizeof ops / sizeof *ops; i++) {
        uint32_t flags;
        const uint32_t d = result_of(ops[i], w, &flags);
        compare(ops[i], w, d, flags);
    }
}

static void try_one(uint32_t word) {
    static const uint32_t ops[] = {FP3_OP_ABS, FP3_OP_RINT, FP3_OP_LOGB, FP3_OP_EXP2};
    const uint32_t w[3] = {word, 0, 0};
    for (size_t i = 0; i < sizeof ops / sizeof *ops; i++) {
        uint32_t flags;
        const uint32_t d = chosen_of(ops[i], w, &flags);
        compare(ops[i], w, d, flags);
    }
}

/* Estimates are never too large, and close: within the table's bound, and what is cut off. */
static void try_estimates(uint32_t word) {
    const uint32_t w[3] = {word, 0, 0};
    const double a = value_of(word), cut = ldexp(1, -(int)config.fraction);
    if (!(a >= 0x1p-126 && a < 0x1p125))
        return;
    const double over = value_of(execute(FP3_OP_RCP, w, NULL)) * a;
    const double root = value_of(execute(FP3_OP_RSQRT, w, NULL));
    const double square = root * root * a;
    tried += 2;
    wrong += !(over <= 1 && over >= 1 - 0x1p-9 - 0x1p-11 - cut);
    wrong += !(square <= 1 && square >= 1 - 0x1p-8 - 2 * cut);
}

static void try_comparisons(const uint32_t w[3]) {
    const double a = value_of(w[0]), b = value_of(w[1]);
    if (isnan(a) || isnan(b) || !config.subnormal)
        return; /* what the operands' flushing leaves of order is the random programs' to say */
    const uint32_t x = read_as(w[0]), y = read_as(w[1]), c = read_as(w[2]) & 0x7fffffff;
    const int is_nan_chosen = is_nan(c ? w[0] : w[1]);
    compare(FP3_OP_LT, w, a < b ? FP3_BITS_ONE : 0, 0);
    compare(FP3_OP_LE, w, a <= b ? FP3_BITS_ONE : 0, 0);
    compare(FP3_OP_MIN, w, a < b ? x : y, 0);
    compare(FP3_OP_MAX, w, b < a ? x : y, 0);
    if (!is_nan_chosen)
        compare(FP3_OP_SEL, w, c ? x : y, 0);
    const int sleeps = fabs(a) < b;
    tried++;
    wrong += fp3_execute_sleeps(&config, w) != sleeps;
}

/* Around every place where something changes. */
static size_t specials(uint32_t *of) {
    static const uint32_t exponents[] = {0,   1,   2,   8,   63,  64,  117, 126,
                                         127, 128, 190, 191, 253, 254, 255};
    const uint32_t one = UINT32_C(1) << (23 - config.fraction);
    const uint32_t fractions[] = {
        0, one, 2 * one, 0x400000 - one, 0x400000, 0x400000 + one, 0x800000 - one};
    size_t n = 0;
    for (size_t e = 0; e < sizeof exponents / sizeof *exponents; e++)
        for (size_t f = 0; f < sizeof fractions / sizeof *fractions; f++)
            for (uint32_t sign = 0; sign < 2; sign++)
                of[n++] = sign << 31 | exponents[e] << 23 | (fractions[f] & 0x7fffff);
    return n;
}

int main(int argc, char **argv) {
    if (argc != 5)
        return 2;
    config.fraction = (uint32_t)atoi(argv[1]);
    config.nearest = (uint32_t)atoi(argv[2]);
    config.subnormal = (uint32_t)atoi(argv[3]);
    const long count = atol(argv[4]);
    chance c = {.state = config.fraction};
    uint32_t special[512];
    const size_t n = specials(special);
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++) {
            const uint32_t w[3] = {special[i], special[j], special[below(&c, (uint32_t)n)]};
            try_all(w);
            try_comparisons(w);
        }
    for (long i = 0; i < count; i++) {
        const uint32_t w[3] = {value(&c), value(&c), value(&c)};
        const uint32_t close[3] = {w[0], w[0] ^ (w[1] & 0x80ff0000), w[2]};
        try_all(w);
        try_comparisons(w);
        try_all(close);
        try_comparisons(close);
    }
    const uint32_t every = config.fraction < 10 ? 1u << (23 - config.fraction) : 0x10001;
    for (uint64_t word = 0; word < UINT64_C(1) << 32; word += every) {
        try_one((uint32_t)word);
        try_estimates((uint32_t)word);
    }
    for (int i = 0; i < 5; i++)
        if (!raised[i] && i != 3) /* no operation divides by zero */
            printf("FAIL no operation raised flag %d\n", i);
    printf("%" PRIu64 " results, %" PRIu64 " wrong\n", tried, wrong);
    return wrong != 0;
}
