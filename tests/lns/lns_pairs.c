/* lns_pairs.c - sw/machine/lns.c against MPFR, on operands of all kinds.
 *
 *     lns_pairs [PAIRS]        every pair of special words, and so many random pairs (default
 * 200,000)
 *
 * lns_certify checks the functions behind a sum. Here whole operations are computed again from the
 * numbers that words stand for, with what becomes of zeros, infinities, NaN, range, signs and
 * flags.
 */
#include "lns_operands.h"
#include <base/bits.h>

#include <fp3/isa.h>
#include <inttypes.h>
#include <machine/lns.h>
#include <math.h>
#include <mpfr.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define BOUND 0.65    /* promised, in last places ... */
#define INVERSE 0.95  /* ... of the inverse of a float */
#define PRECISION 400 /* bits: 2^128 - 2^-127 has 255 */

enum {
    NX = FP3_FLAG_INEXACT,
    UF = FP3_FLAG_UNDERFLOW,
    OF = FP3_FLAG_OVERFLOW,
    DZ = FP3_FLAG_DIVIDE_BY_ZERO,
    NV = FP3_FLAG_INVALID
};

typedef enum {
    MUL,
    DIV,
    ADD,
    SUB,
    SQRT,
    RSQRT,
    RCP,
    FROM,
    TO,
    FLOAT_RCP,
    FLOAT_RSQRT,
    OPERATIONS
} operation;

static const char *const names[] = {"mul",      "div",       "add",        "sub",
                                    "sqrt",     "rsqrt",     "rcp",        "from_float",
                                    "to_float", "float_rcp", "float_rsqrt"};

static int is_inverse(operation op) { return op == FLOAT_RCP || op == FLOAT_RSQRT; }

static uint32_t compute(operation op, uint32_t a, uint32_t b, uint32_t *flags) {
    switch (op) {
    case MUL:
        return fp3_lns_mul(a, b, flags);
    case DIV:
        return fp3_lns_div(a, b, flags);
    case ADD:
        return fp3_lns_add(a, b, flags);
    case SUB:
        return fp3_lns_sub(a, b, flags);
    case SQRT:
        return lns_sqrt(a, flags);
    case RSQRT:
        return fp3_lns_rsqrt(a, flags);
    case RCP:
        return fp3_lns_rcp(a, flags);
    case FLOAT_RCP:
        return fp3_lns_float_rcp(a, flags);
    case FLOAT_RSQRT:
        return fp3_lns_float_rsqrt(a, flags);
    case FROM:
        return fp3_lns_from_float(a, flags);
    default:
        return fp3_lns_to_float(a, flags);
    }
}

typedef struct {
    mpfr_t a, b, z;
} numbers;

/* The number of a word, to 400 bits. */
static void number_of(mpfr_t x, uint32_t word, int is_float) {
    const uint32_t size = word & 0x7fffffff;
    if (size > LNS_INFINITE) {
        mpfr_set_nan(x);
        return;
    }
    if (is_float) {
        mpfr_set_d(x, (double)fp3_value_of(size), MPFR_RNDN);
    } else if (size == LNS_INFINITE) {
        mpfr_set_inf(x, 1);
    } else if (size == 0) {
        mpfr_set_zero(x, 1);
    } else {
        mpfr_set_si_2exp(x, (long)size - 0x3f800000, -23, MPFR_RNDN);
        mpfr_exp2(x, x, MPFR_RNDN);
    }
    if (word >> 31)
        mpfr_neg(x, x, MPFR_RNDN);
}

/* z, with MPFR's infinities, NaN and signs of zero: those of IEEE 754. Returns whether z is exact.
 */
static int truth(operation op, numbers *n) {
    switch (op) {
    case MUL:
        return mpfr_mul(n->z, n->a, n->b, MPFR_RNDN), 1;
    case DIV:
        return mpfr_div(n->z, n->a, n->b, MPFR_RNDN), 1;
    case RCP:
        return mpfr_ui_div(n->z, 1, n->a, MPFR_RNDN), 1;
    case ADD:
        return mpfr_add(n->z, n->a, n->b, MPFR_RNDN), 0;
    case SUB:
        return mpfr_sub(n->z, n->a, n->b, MPFR_RNDN), 0;
    case FLOAT_RCP:
        return mpfr_ui_div(n->z, 1, n->a, MPFR_RNDN), 0;
    case SQRT:
        return mpfr_sqrt(n->z, n->a, MPFR_RNDN), 0;
    case RSQRT:
    case FLOAT_RSQRT:
        return mpfr_rec_sqrt(n->z, n->a, MPFR_RNDN), 0;
    default:
        return mpfr_set(n->z, n->a, MPFR_RNDN), 0;
    }
}

/* What the flags of a result without a number, or of one from such operands, are to be. */
static uint32_t special_flags(operation op, uint32_t a, const numbers *n) {
    const uint32_t quiet = is_inverse(op) && !(a & 0x400000) ? NV : 0; /* of a NaN */
    const int is_binary = op <= SUB;
    if (mpfr_nan_p(n->z))
        return mpfr_nan_p(n->a) || (is_binary && mpfr_nan_p(n->b)) ? quiet : NV;
    if (is_inverse(op))
        return mpfr_zero_p(n->a) ? DZ : 0;
    if (op == DIV && mpfr_zero_p(n->b) && !mpfr_inf_p(n->a))
        return DZ;
    return (op == RCP || op == RSQRT) && mpfr_zero_p(n->a) ? DZ : 0;
}

/* Position of z among words, in last places: its logarithm, or as binary32. Whether z is one of
 * them: of different powers of two, only those that are equal agree to 2^-300. */
static double place_of(const mpfr_t z, int is_float, int *is_whole) {
    mpfr_t place, rest;
    mpfr_inits2(PRECISION, place, rest, (mpfr_ptr)0);
    mpfr_abs(place, z, MPFR_RNDN);
    if (is_float) {
        long e = mpfr_get_exp(place) - 1;
        e = e < -126 ? -126 : e;
        mpfr_mul_2si(place, place, -e, MPFR_RNDN);
        mpfr_add_si(place, place, e + 126, MPFR_RNDN);
    } else {
        mpfr_log2(place, place, MPFR_RNDN);
        mpfr_add_ui(place, place, 127, MPFR_RNDN);
    }
    mpfr_mul_2si(place, place, 23, MPFR_RNDN);
    mpfr_rint(rest, place, MPFR_RNDN);
    mpfr_sub(rest, rest, place, MPFR_RNDN);
    *is_whole = mpfr_zero_p(rest) || mpfr_get_exp(rest) < -300;
    const double nearly = mpfr_get_d(place, MPFR_RNDN); /* below 2^31: to 2^-22 */
    mpfr_clears(place, rest, (mpfr_ptr)0);
    return nearly;
}

/* Whether the result of numbers is what it may be, and its flags are what they must be. */
static int is_good(operation op, const numbers *n, int is_exact, uint32_t z, uint32_t flags,
                   double *worst) {
    int is_whole;
    const int is_float = op == TO || is_inverse(op);
    const double place = place_of(n->z, is_float, &is_whole), slack = 0x1p-20;
    const double size = (double)(z & 0x7fffffff);
    const int is_root = op == SQRT || op == RSQRT;
    const double bound = is_exact         ? slack
                         : is_root        ? 0.5 + slack
                         : is_inverse(op) ? INVERSE
                                          : BOUND;
    const int is_tiny = is_float && !is_whole && place < 0x800000;
    if ((mpfr_signbit(n->z) != 0) != (int)(z >> 31))
        return 0;
    if (!is_float && (place < 1 - bound || size == 0))
        return place < bound && size == 0 && flags == (UF | NX);
    if (op != TO && (place > LNS_INFINITE - 1 + bound || size >= LNS_INFINITE))
        return place > LNS_INFINITE - bound && size == LNS_INFINITE && flags == (OF | NX);
    if (flags != ((is_exact || is_whole ? 0u : (uint32_t)NX) | (is_tiny ? UF : 0u)))
        return 0;
    const double error = fabs(size - place);
    if (!is_exact && error > *worst)
        *worst = error;
    return error <= bound && (!is_root || error < 0.5 - slack || !(z & 1));
}

static int check(operation op, uint32_t a, uint32_t b, numbers *n, double *worst) {
    uint32_t flags = 0xffffffff;
    const uint32_t z = compute(op, a, b, &flags);
    number_of(n->a, a, op == FROM || is_inverse(op));
    number_of(n->b, b, 0);
    int is_exact = truth(op, n), good;
    if (mpfr_number_p(n->z) && !mpfr_zero_p(n->z)) {
        if ((op == ADD || op == SUB) && (mpfr_zero_p(n->a) || mpfr_zero_p(n->b)))
            is_exact = 1;
        good = is_good(op, n, is_exact, z, flags, worst);
    } else {
        const uint32_t expected = mpfr_nan_p(n->z) ? FP3_BITS_NAN
                                                   : (mpfr_zero_p(n->z) ? 0 : LNS_INFINITE) |
                                                         (uint32_t) !!mpfr_signbit(n->z) << 31;
        /* FP3's 1 / sqrt(-0) is +infinity */
        good = z == ((op == RSQRT || op == FLOAT_RSQRT) && a == 0x80000000 ? LNS_INFINITE
                                                                           : expected) &&
               flags == special_flags(op, a, n);
    }
    if (!good)
        printf("FAIL %s 0x%08" PRIx32 " 0x%08" PRIx32 ": 0x%08" PRIx32 ", flags 0x%02" PRIx32 "\n",
               names[op], a, b, z, flags);
    return good;
}

int main(int argc, char **argv) {
    const unsigned long pairs = argc > 1 ? strtoul(argv[1], NULL, 10) : 200000;
    uint32_t words[LNS_SPECIAL];
    const size_t count = lns_special_words(words);
    gsl_rng *rng = gsl_rng_alloc(gsl_rng_taus2);
    if (!rng)
        return 2;
    numbers n;
    mpfr_inits2(PRECISION, n.a, n.b, n.z, (mpfr_ptr)0);
    uint64_t wrong = 0;
    for (int op = 0; op < OPERATIONS; op++) {
        double worst = 0;
        uint64_t failed = 0;
        for (size_t i = 0; i < count; i++)
            for (size_t j = 0; j < (op <= SUB ? count : 1); j++)
                failed += !check((operation)op, words[i], words[j], &n, &worst);
        for (unsigned long i = 0; i < pairs && failed < 10; i++) {
            uint32_t a, b;
            lns_draw(rng, &a, &b);
            failed += !check((operation)op, a, b, &n, &worst);
        }
        printf("%s: %zu special and %lu random operands, largest error %.4f of the last place: "
               "%" PRIu64 " wrong\n",
               names[op], op <= SUB ? count * count : count, pairs, worst, failed);
        wrong += failed;
    }
    mpfr_clears(n.a, n.b, n.z, (mpfr_ptr)0);
    mpfr_free_cache();
    gsl_rng_free(rng);
    return wrong != 0;
}
