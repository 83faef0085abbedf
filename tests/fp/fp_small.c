/* fp_small - the cores in small formats against tables of all representable numbers.
 *
 * The 8-bit format (4-bit exponent, 3-bit fraction) in its five modes with all 65,536 pairs, and
 * binary16 with random pairs. Multiply-add, which Cell's arithmetic does not have, takes as many of
 * the 8-bit format's 16,777,216 triples as --pairs says. The exact result is a double, as these
 * formats are small enough. Only the exact sum of binary16's multiply-add may be longer: it is
 * rounded to odd, which no later rounding notices. The double is rounded by looking up its two
 * neighbours: once among the format's own numbers, for the value, and once among numbers with the
 * same fractions and all exponents, for overflow and underflow. What zero, infinity and NaN give is
 * taken from the host's double arithmetic.
 */
#include <math.h>

#include "fp_common.h"
#include "fp_pairs.h"

enum { NV = 16, OF = 4, UF = 2, NX = 1 };

/* Ascending. Neighbours of an even index have odd ones, so that ties go to even indices. */
typedef struct {
    double *value;
    size_t n;
} table;

typedef struct {
    fp3_bench_core core;
    table format; /* index = code without sign; one more entry, where infinity is or, without one,
                     would be */
    table unbounded; /* no subnormal numbers: exponents far beyond any result's */
} reference;

static bool reference_open(reference *ref, fp3_bench_core core) {
    const unsigned fractions = 1u << core.frac, exponents = (1u << core.exp) - !core.finite;
    const int bias = (1 << (core.exp - 1)) - 1, least = 1 - bias - (int)core.frac; /* of an ulp */
    const int low = 2 * least - 1, binades = 4 * (int)exponents + 2 * (int)core.frac;

    ref->core = core;
    ref->format.value = calloc((size_t)exponents * fractions + 1, sizeof(double));
    ref->unbounded.value = calloc((size_t)binades * fractions, sizeof(double));
    ref->format.n = ref->unbounded.n = 0;
    if (!ref->format.value || !ref->unbounded.value)
        return false;
    for (unsigned f = 0; f < fractions; f++)
        ref->format.value[ref->format.n++] = ldexp(f, least);
    for (unsigned e = 1; e < exponents; e++)
        for (unsigned f = 0; f < fractions; f++)
            ref->format.value[ref->format.n++] = ldexp(fractions + f, least + (int)e - 1);
    ref->format.value[ref->format.n++] = ldexp(fractions, least + (int)exponents - 1);
    for (int e = 0; e < binades; e++)
        for (unsigned f = 0; f < fractions; f++)
            ref->unbounded.value[ref->unbounded.n++] =
                ldexp(fractions + f, low - (int)core.frac + e);
    return true;
}

static void reference_close(reference *ref) {
    free(ref->format.value);
    free(ref->unbounded.value);
}

/* The index of the entry that x >= value[0] is rounded to; above the last it is the last. */
static size_t nearest_entry(const table *t, double x, bool nearest) {
    size_t below = 0, above = t->n;
    while (above - below > 1) {
        const size_t middle = (below + above) / 2;
        if (t->value[middle] <= x)
            below = middle;
        else
            above = middle;
    }
    if (!nearest || above == t->n)
        return below;
    const double down = x - t->value[below], up = t->value[above] - x;
    return up < down || (up == down && below % 2) ? above : below;
}

static double decode(const reference *ref, uint32_t code) {
    const uint32_t sign = code >> (ref->core.exp + ref->core.frac);
    const uint32_t magnitude = code & ((1u << (ref->core.exp + ref->core.frac)) - 1);
    const size_t infinity = ref->format.n - 1;
    double value = magnitude < infinity   ? ref->format.value[magnitude]
                   : magnitude > infinity ? NAN
                                          : INFINITY;
    if (!ref->core.subnormal && magnitude < 1u << ref->core.frac)
        value = 0;
    return sign ? -value : value;
}

static bool signalling(const reference *ref, uint32_t code) {
    return isnan(decode(ref, code)) && !(code >> (ref->core.frac - 1) & 1);
}

/* a + b; if it is not exact, the neighbour with an odd last bit. */
static double sum_to_odd(double a, double b) {
    const double s = a + b, of_b = s - a, error = (a - (s - of_b)) + (b - of_b);
    uint64_t bits;
    memcpy(&bits, &s, sizeof bits);
    return isfinite(s) && error != 0 && !(bits & 1) ? nextafter(s, error > 0 ? INFINITY : -INFINITY)
                                                    : s;
}

static double exact_result(fp3_bench_op op, double x, double y, double z) {
    switch (op) {
    case FP3_BENCH_ADD:
        return x + y;
    case FP3_BENCH_SUB:
        return x - y;
    case FP3_BENCH_MADD:
        return sum_to_odd(z, x * y);
    case FP3_BENCH_MSUB:
        return sum_to_odd(z, -(x * y));
    default:
        return x * y;
    }
}

/* Whether a result that is NaN is invalid. */
static bool is_invalid(const reference *ref, fp3_bench_op op, const uint32_t code[3],
                       const double v[3]) {
    const bool is_fused = op >= FP3_BENCH_MADD;
    bool is_nan = false, is_signalling = false;
    for (int i = 0; i < 2 + is_fused; i++) {
        is_nan = is_nan || isnan(v[i]);
        is_signalling = is_signalling || signalling(ref, code[i]);
    }
    return is_signalling || !is_nan ||
           (is_fused && isnan(v[0] * v[1]) && !isnan(v[0]) && !isnan(v[1]));
}

static uint32_t expected(const reference *ref, fp3_bench_op op, const uint32_t code_of[3],
                         uint8_t *flags) {
    const double v[3] = {decode(ref, code_of[0]), decode(ref, code_of[1]), decode(ref, code_of[2])};
    const double exact = exact_result(op, v[0], v[1], v[2]);
    const uint32_t sign = (uint32_t) !!signbit(exact) << (ref->core.exp + ref->core.frac);
    const uint32_t infinity = (uint32_t)ref->format.n - 1;
    const double magnitude = fabs(exact), least_normal = ref->format.value[1u << ref->core.frac];

    *flags = 0;
    if (isnan(exact)) {
        if (is_invalid(ref, op, code_of, v))
            *flags = NV;
        return infinity | 1u << (ref->core.frac - 1);
    }
    if (isinf(exact))
        return sign | infinity;
    if (exact == 0)
        return ref->core.finite ? 0 : sign;

    if (!ref->core.subnormal && magnitude < least_normal) {
        *flags = UF | NX;
        return ref->core.finite ? 0 : sign;
    }
    const double unbounded =
        ref->unbounded.value[nearest_entry(&ref->unbounded, magnitude, ref->core.nearest)];
    if (unbounded >= ref->format.value[infinity]) {
        *flags = OF | NX;
        return sign | (ref->core.nearest ? infinity : infinity - 1);
    }
    const uint32_t code = (uint32_t)nearest_entry(&ref->format, magnitude, ref->core.nearest);
    if (ref->format.value[code] != magnitude)
        *flags = unbounded < least_normal ? UF | NX : NX;
    return sign | code;
}

static uint64_t flush(const reference *ref, fp3_bench *bench, unsigned row, fp3_bench_op op,
                      fp3_batch *t, const char *program, unsigned *reported) {
    for (size_t i = 0; i < t->n; i++)
        t->z[i] = expected(ref, op, (uint32_t[]){t->a[i], t->b[i], t->c[i]}, &t->flags[i]);
    const uint64_t wrong = fp3_check(bench, row, op, t, program, reported);
    t->n = 0;
    return wrong;
}

/* Every pair of an 8-bit row, random pairs of another one, or the one pair asked for. */
static uint64_t run(const fp3_fp_options *opt, fp3_bench *bench, unsigned row, fp3_bench_op op,
                    fp3_batch *t) {
    reference ref;
    uint64_t wrong = 0;
    unsigned reported = 0;
    const fp3_bench_core core = fp3_bench_describe(bench, row, op);
    const unsigned bits = 1 + core.exp + core.frac;
    const bool is_fused = op >= FP3_BENCH_MADD;
    const uint64_t all = UINT64_C(1) << (is_fused ? 3 : 2) * bits;
    const bool is_all = bits <= 8 && (!is_fused || opt->pairs >= all);
    const uint64_t pairs = opt->one ? 1 : is_all ? all : opt->pairs;
    gsl_rng *rng = gsl_rng_alloc(FP3_PAIRS_RNG);

    if (!rng || !reference_open(&ref, core))
        abort();
    gsl_rng_set(rng, opt->seed + (unsigned long)op);
    t->n = 0;
    for (uint64_t i = 0; i < pairs; i++) {
        uint32_t a = opt->a, b = opt->b, c = opt->c;
        if (!opt->one && is_all) {
            const uint32_t mask = (1u << bits) - 1;
            a = (uint32_t)(i >> bits) & mask;
            b = (uint32_t)i & mask;
            c = (uint32_t)(i >> 2 * bits) & mask;
        } else if (!opt->one) {
            fp3_pair(rng, core.exp, core.frac, op, &a, &b);
            c = is_fused ? fp3_third(rng, core.exp, core.frac, a, b) : 0;
        }
        t->a[t->n] = a;
        t->b[t->n] = b;
        t->c[t->n] = c;
        if (++t->n == FP3_BATCH)
            wrong += flush(&ref, bench, row, op, t, opt->program, &reported);
    }
    wrong += flush(&ref, bench, row, op, t, opt->program, &reported);
    if (opt->one && !wrong)
        fp3_print_result("as expected", t->z[0], t->flags[0]);
    printf("%s, %s: %" PRIu64 " pairs%s: %" PRIu64 " mismatches\n", fp3_op_names[op],
           fp3_row_name(row), pairs,
           opt->one ? ""
           : is_all ? " (all)"
                    : " (random)",
           wrong);
    gsl_rng_free(rng);
    reference_close(&ref);
    return wrong;
}

int main(int argc, char **argv) {
    const fp3_fp_options opt = fp3_parse(
        argc, argv, "Tests the cores in small formats against tables of all numbers.", 1000000);

    if (opt.row > FP3_BENCH_BINARY16) {
        fprintf(stderr, "fp_small: the rows of small formats are 0 .. %d\n", FP3_BENCH_BINARY16);
        return 2;
    }
    fp3_bench *bench = fp3_bench_open();
    if (!bench) {
        fprintf(stderr, "fp_small: no memory\n");
        return 1;
    }
    printf("seed %lu\n", opt.seed);
    uint64_t wrong = 0;
    fp3_batch batch = {.n = 0};
    for (unsigned row = 0; row <= FP3_BENCH_BINARY16 && row < fp3_bench_rows(bench); row++)
        for (int op = 0; op < FP3_BENCH_OPS; op++)
            if ((opt.row == FP3_ALL || opt.row == (int)row) &&
                (opt.op == FP3_ALL || opt.op == op) &&
                (row != FP3_BENCH_SMALL_CELL || op < FP3_BENCH_MADD))
                wrong += run(&opt, bench, row, (fp3_bench_op)op, &batch);
    fp3_bench_close(bench);
    return wrong != 0;
}
