/* fp_estimates.c - sw/machine/estimate.c keeps its promises, for every fraction.
 *
 *     fp_estimates
 *
 * All 2^23 fractions with exponents of both parities, near the ends and in the middle: never too
 * large, never too small by more than promised, and no larger fraction would do for the same entry
 * of the table. Every product is exact in binary64: a fraction of the estimate has ten bits. Then
 * what is no normal number, and the exponents that leave the normal ones.
 */
#include <base/bits.h>
#include <inttypes.h>
#include <machine/estimate.h>
#include <math.h>
#include <stdio.h>

#define RCP_ERROR (0x1p-9 + 0x1p-11)
#define RSQRT_ERROR 0x1p-8
#define SUBNORMAL_ERROR 0x1p-8 /* of rcp, where its last bit is lost */
#define COUNT(array) (sizeof(array) / sizeof *(array))

typedef struct {
    uint64_t checked, wrong;
    double worst; /* error seen */
} tally;

static double value_of(uint32_t bits) { return (double)fp3_value_of(bits); }

static void fail(tally *t, const char *what, uint32_t a, uint32_t y) {
    if (t->wrong++ < 10)
        printf("FAIL %s: of 0x%08" PRIx32 " it is 0x%08" PRIx32 "\n", what, a, y);
}

static double error_of(int is_root, double a, double y) {
    return is_root ? 1 - a * y * y : 1 - fabs(a) * fabs(y);
}

/* y with the next fraction that the table can give is too large for some number of a's entry: for
 * the last, as its end is beyond it. */
static int is_largest(int is_root, uint32_t a, uint32_t y) {
    const uint32_t entry = is_root ? 0x3fff : 0x1fff;
    const uint32_t next = y + (is_root && !(a >> 23 & 1) ? 0x2000 : 0x4000);
    return error_of(is_root, value_of((a | entry) + 1), value_of(next)) < 0;
}

static void check(tally *t, int is_root, uint32_t a, double bound) {
    const uint32_t y = is_root ? fp3_estimate_rsqrt(a) : fp3_estimate_rcp(a);
    const double error = error_of(is_root, value_of(a), value_of(y));
    t->checked++;
    if (error > t->worst)
        t->worst = error;
    if (error < 0 || error >= bound)
        fail(t, is_root ? "rsqrt is too large or too small" : "rcp is too large or too small", a,
             y);
    if ((y ^ (is_root ? 0 : a)) >> 31)
        fail(t, "the sign is wrong", a, y);
    /* The last entry below the largest exponent ends in the next one. */
    const int is_subnormal = !(y >> 23 & 255);
    if ((a | 0x7fffffu) != 0x7f7fffffu && !is_subnormal &&
        !is_largest(is_root, a & 0x7fffffffu, y & 0x7fffffffu))
        fail(t, "a larger one is not too large", a, y);
}

static void check_fractions(tally *t, int is_root) {
    static const uint32_t rcp[] = {1, 127, 252, 0x100 + 126}, rsqrt[] = {1, 2, 127, 128, 254};
    const uint32_t *exponents = is_root ? rsqrt : rcp;
    const size_t count = is_root ? COUNT(rsqrt) : COUNT(rcp);
    for (size_t e = 0; e < count; e++)
        for (uint32_t fraction = 0; fraction < 1u << 23; fraction++)
            check(t, is_root, exponents[e] << 23 | fraction, is_root ? RSQRT_ERROR : RCP_ERROR);
}

/* Every exponent, as it changes the estimate's alone. */
static void check_exponents(tally *t) {
    for (uint32_t e = 1; e < 255; e++) {
        const uint32_t a = e << 23 | 0x123456;
        check(t, 0, a, e < 253 ? RCP_ERROR : SUBNORMAL_ERROR);
        check(t, 1, a, RSQRT_ERROR);
    }
    for (uint32_t fraction = 0; fraction < 1u << 23; fraction += 0x1fff) {
        check(t, 0, 253u << 23 | fraction, RCP_ERROR);
        check(t, 0, 254u << 23 | fraction, SUBNORMAL_ERROR);
    }
}

static void check_others(tally *t) {
    static const struct {
        uint32_t a, rcp, rsqrt;
    } rows[] = {
        {0x00000000, 0x7f800000, 0x7f800000}, {0x80000000, 0xff800000, 0x7f800000},
        {0x00000001, 0x7f800000, 0x7f800000}, {0x807fffff, 0xff800000, 0x7f800000},
        {0x7e800000, 0x007fe000, 0x1fffc000}, {0xfeffffff, 0x80400000, 0x7fa00000},
        {0x7f7fffff, 0x00200000, 0x1f800000}, {0xff7fffff, 0x80200000, 0x7fa00000},
        {0x7f800000, 0x00000000, 0x00000000}, {0xff800000, 0x80000000, 0x7fa00000},
        {0x7fc00000, 0x7fc00000, 0x7fc00000}, {0xff800001, 0xff800001, 0xff800001},
        {0x80800000, 0xfe7fc000, 0x7fa00000}, {0x3f800000, 0x3f7fc000, 0x3f7fc000},
    };
    for (size_t i = 0; i < COUNT(rows); i++) {
        t->checked++;
        if (fp3_estimate_rcp(rows[i].a) != rows[i].rcp)
            fail(t, "rcp", rows[i].a, fp3_estimate_rcp(rows[i].a));
        if (fp3_estimate_rsqrt(rows[i].a) != rows[i].rsqrt)
            fail(t, "rsqrt", rows[i].a, fp3_estimate_rsqrt(rows[i].a));
    }
}

int main(void) {
    tally t[3] = {0};
    for (int is_root = 0; is_root < 2; is_root++)
        check_fractions(&t[is_root], is_root);
    check_exponents(&t[2]);
    check_others(&t[2]);
    printf("%" PRIu64 " estimates, largest error rcp %.3g, rsqrt %.3g; %" PRIu64 " wrong\n",
           t[0].checked + t[1].checked + t[2].checked, t[0].worst, t[1].worst,
           t[0].wrong + t[1].wrong + t[2].wrong);
    return t[0].wrong + t[1].wrong + t[2].wrong != 0;
}
