/* lns_certify.c - every function value of logarithmic arithmetic, enclosed by MPFR.
 *
 *     lns_certify              every input: 2^28 distances of a sum, as many of a difference, 2^23
 * fractions of each converter and of each inverse at each exponent that changes it lns_certify 1009
 * runs of inputs, one of 1009
 *
 * The logarithm of a sum is that of the larger operand plus a function of the distance of both; all
 * else is exact. So all distances are all pairs of operands. Where a run starts, MPFR gives the
 * function and its slope. Within the run the function leaves this line by at most max|f''| k^2 / 2,
 * and the run ends before that is 2^-12 of the last place. It counts as error, as does what doubles
 * may lose.
 */
#include <gen/logarithms.h>
#include <inttypes.h>
#include <machine/lns.h>
#include <math.h>
#include <mpfr.h>
#include <stdio.h>
#include <stdlib.h>

#define LAST_PLACE 0x1p-23
#define BOUND 0.65     /* promised, in last places ... */
#define INVERSE 0.95   /* ... of the inverse of a float */
#define LEAVES 0x1p-12 /* of the line, in last places */
/* Lost by doubles, likewise: values are below 2^29 last places, and each operation loses 2^-53. */
#define DOUBLES 0x1p-24

typedef struct {
    mpfr_t x, y, z, ln2;
} numbers;

/* In last places: the function at an input, and its slope from there to the next. */
typedef struct {
    double value, slope;
} line;

typedef struct {
    const char *name;
    uint32_t first, count; /* inputs */
    double bend;           /* at least the second derivative; 0: difference_bend knows */
    double bound;
    line (*at)(numbers *n, uint32_t input);
    double (*result)(uint32_t input); /* in last places */
} function;

static line scaled(double value, double slope) { return (line){value / LAST_PLACE, slope}; }

/* y = 2^-r */
static void power_of(numbers *n, uint32_t r) {
    mpfr_set_ui_2exp(n->x, r, -23, MPFR_RNDN);
    mpfr_neg(n->x, n->x, MPFR_RNDN);
    mpfr_exp2(n->y, n->x, MPFR_RNDN);
}

static double log2_1p(numbers *n, const mpfr_t x) {
    mpfr_log1p(n->z, x, MPFR_RNDN);
    mpfr_div(n->z, n->z, n->ln2, MPFR_RNDN);
    return mpfr_get_d(n->z, MPFR_RNDN);
}

static line sum_at(numbers *n, uint32_t r) {
    power_of(n, r);
    const double y = mpfr_get_d(n->y, MPFR_RNDN);
    return scaled(log2_1p(n, n->y), -y / (1 + y));
}

static line difference_at(numbers *n, uint32_t r) {
    power_of(n, r);
    const double y = mpfr_get_d(n->y, MPFR_RNDN);
    mpfr_ui_sub(n->x, 1, n->y, MPFR_RNDN);
    const double rest = mpfr_get_d(n->x, MPFR_RNDN);
    mpfr_neg(n->y, n->y, MPFR_RNDN);
    return scaled(log2_1p(n, n->y), y / rest);
}

static line log_at(numbers *n, uint32_t f) {
    mpfr_set_ui_2exp(n->x, f, -23, MPFR_RNDN);
    return scaled(log2_1p(n, n->x), 1.4426950408889634 / (1 + f * LAST_PLACE));
}

static line power_at(numbers *n, uint32_t f) {
    mpfr_set_ui_2exp(n->x, f, -23, MPFR_RNDN);
    mpfr_exp2(n->y, n->x, MPFR_RNDN);
    const double y = mpfr_get_d(n->y, MPFR_RNDN);
    return scaled(y, y * 0.6931471805599453);
}

/* A result below 2^-126 has a place less. */
static line small_power_at(numbers *n, uint32_t f) {
    const line whole = power_at(n, f);
    return (line){whole.value / 2, whole.slope / 2};
}

/* At least the second derivative of a difference from r on: it falls. */
static double difference_bend(uint32_t r) {
    const double rest = -expm1(-0.6931 * LAST_PLACE * r);
    return 0.6932 / (rest * rest);
}

static line float_at(uint32_t f, double power, double unit) {
    const double x = 1 + f * LAST_PLACE, y = pow(x, power) * unit;
    return scaled(y, power * y / x);
}

/* Of a float from 1 to 2 the inverse is below 1, where a last place is half as large. */
static line rcp_at(numbers *n, uint32_t f) { return (void)n, float_at(f, -1, 2); }
static line rsqrt_at(numbers *n, uint32_t f) { return (void)n, float_at(f, -0.5, 2); }
static line rsqrt_of_twice_at(numbers *n, uint32_t f) {
    return (void)n, float_at(f, -0.5, M_SQRT2);
}
static line rcp_from_126_at(numbers *n, uint32_t f) { return (void)n, float_at(f, -1, 1); }
static line rcp_from_127_at(numbers *n, uint32_t f) { return (void)n, float_at(f, -1, 0.5); }

static double sum_of(uint32_t r) { return fp3_lns_of_distance(r, 0); }

static double difference_of(uint32_t r) { return fp3_lns_of_distance(r, 1); }

static double log_of(uint32_t f) {
    uint32_t flags;
    return (double)fp3_lns_from_float(0x3f800000 | f, &flags) - 0x3f800000;
}

static double power_of_two(uint32_t f) {
    uint32_t flags;
    return (double)(fp3_lns_to_float(0x3f800000 | f, &flags) - 0x3f000000);
}

static double small_power(uint32_t f) {
    uint32_t flags;
    return fp3_lns_to_float(f, &flags);
}

static double rcp(uint32_t a) {
    uint32_t flags;
    return fp3_lns_float_rcp(a, &flags);
}

static double rsqrt(uint32_t a) {
    uint32_t flags;
    return fp3_lns_float_rsqrt(a, &flags);
}

static double rcp_of(uint32_t f) { return rcp(0x3f800000 | f) - 0x3e800000; }
static double rsqrt_of(uint32_t f) { return rsqrt(0x3f800000 | f) - 0x3e800000; }
static double rsqrt_of_twice(uint32_t f) { return rsqrt(0x40000000 | f) - 0x3e800000; }
static double rcp_from_126(uint32_t f) { return rcp(0x7e800000 | f); }
static double rcp_from_127(uint32_t f) { return rcp(0x7f000000 | f); }

static const function functions[] = {
    {"sum", 0, 1u << 28, 0.1733 /* ln 2 / 4 */, BOUND, sum_at, sum_of},
    {"difference", 1, (1u << 28) - 1, 0, BOUND, difference_at, difference_of},
    {"from_float", 0, 1u << 23, 1.443 /* 1 / ln 2 */, BOUND, log_at, log_of},
    {"to_float", 0, 1u << 23, 0.961 /* 2 ln(2)^2 */, BOUND, power_at, power_of_two},
    {"to_float, subnormal", 1, (1u << 23) - 1, 0.961, BOUND, small_power_at, small_power},
    {"rcp", 0, 1u << 23, 4, INVERSE, rcp_at, rcp_of},
    {"rcp from 2^126", 0, 1u << 23, 2, 0.75, rcp_from_126_at, rcp_from_126},
    {"rcp from 2^127", 0, 1u << 23, 1, BOUND, rcp_from_127_at, rcp_from_127},
    {"rsqrt, exponent even", 0, 1u << 23, 1.5, INVERSE, rsqrt_at, rsqrt_of},
    {"rsqrt, exponent odd", 0, 1u << 23, 1.07, 0.85, rsqrt_of_twice_at, rsqrt_of_twice},
};

static uint32_t length_of(double bend) {
    const double most = sqrt(LEAVES / bend);
    return most < 1 ? 1 : most > 1024 ? 1024 : (uint32_t)most;
}

/* Returns whether no error is above the bound. */
static int certify(const function *f, numbers *n, uint32_t stride) {
    uint64_t checked = 0, nearest = 0, runs = 0;
    double worst = 0;
    uint32_t where = 0;
    for (uint64_t input = f->first, end = (uint64_t)f->first + f->count; input < end; runs++) {
        const double bend =
            (f->bend > 0 ? f->bend : difference_bend((uint32_t)input)) * LAST_PLACE / 2;
        const uint32_t length = length_of(bend);
        const uint64_t stop = input + length < end ? input + length : end;
        if (runs % stride == 0) {
            const line l = f->at(n, (uint32_t)input);
            for (uint32_t k = 0; input + k < stop; k++) {
                const double truth = l.value + l.slope * k;
                const double error =
                    fabs(f->result((uint32_t)input + k) - truth) + bend * k * k + DOUBLES;
                checked++;
                nearest += error < 0.5;
                if (error > worst) {
                    worst = error;
                    where = (uint32_t)input + k;
                }
            }
        }
        input = stop;
    }
    const int good = worst <= f->bound && checked > 0;
    printf("%s%s: %" PRIu64 " of %" PRIu32
           " inputs checked, largest error %.4f of the last place (bound %.2f), at 0x%" PRIx32
           "; %.2f %% certainly nearest\n",
           good ? "" : "FAIL ", f->name, checked, f->count, worst, f->bound, where,
           100.0 * (double)nearest / (double)checked);
    return good;
}

int main(int argc, char **argv) {
    const unsigned long stride = argc > 1 ? strtoul(argv[1], NULL, 10) : 1;
    if (argc > 2 || stride == 0) {
        fprintf(stderr, "usage: lns_certify [STRIDE]\n");
        return 2;
    }
    numbers n;
    mpfr_inits2(96, n.x, n.y, n.z, n.ln2, (mpfr_ptr)0);
    mpfr_const_log2(n.ln2, MPFR_RNDN);
    int good = 1;
    for (size_t i = 0; i < sizeof functions / sizeof *functions; i++)
        good &= certify(&functions[i], &n, (uint32_t)stride);
    mpfr_clears(n.x, n.y, n.z, n.ln2, (mpfr_ptr)0);
    mpfr_free_cache();
    return !good;
}
