/* flushed.c - quotients and roots where subnormal numbers are flushed, or inverses made by
 * logarithms, for every exponent of both operands.
 *
 *     flushed CONFIG [N]     N pairs of fractions for each pair of exponents (1)
 *
 * Prints of each expression how many values are wrong, how many are refused (they raise invalid or
 * overflow), and the largest error of the others in units in the last place. A value may be refused
 * if a denominator is 0 or the value is beyond the numbers. Quotients are computed scaled: they may
 * also be refused in the last binades, and if the divisor is below eight times the least number. A
 * value that has 0 in a denominator must be refused.
 */
#include "function.h"

#define LEAST 0x1p-126
#define SIGN_AND_EXPONENT 0xff800000u /* comparisons read a subnormal number as it is */
#define NEAR (1.01 * LEAST)           /* what is flushed */

typedef struct {
    const char *expression;
    double (*truth)(double a, double x);
    int has_a;
    double small;    /* denominators below this may be refused */
    int last[2];     /* results in so many last binades may be refused; without infinities */
    double absolute; /* an error that is allowed besides, where numbers are flushed */
    int is_power;    /* parts of it underflow first: not where they lose digits then */
} function;

static double quotient(double a, double x) { return a / x; }
static double half_over(double a, double x) { return (void)a, -0.5 / x; }
static double triple_over(double a, double x) { return (void)a, 3 / x; }
static double over_square(double a, double x) { return a / x / x; }
static double over_cube(double a, double x) { return a / x / x / x; }
static double over_fourth(double a, double x) { return a / x / x / x / x; }
static double root(double a, double x) { return (void)a, sqrt(x); }
static double inverse_root(double a, double x) { return (void)a, 1 / sqrt(x); }
static double over_root(double a, double x) { return a / sqrt(x); }
static double over_root_cubed(double a, double x) { return a / sqrt(x) / x; }
static double beside(double a, double x) { return (void)a, x < 1 ? sqrt(x) : 1 / sqrt(x); }
static double angle(double a, double x) { return atan2(a, x); }

static const function functions[] = {
    {"a/x", quotient, 1, 8 * LEAST, {2, 4}, NEAR, 0},
    {"3/x", triple_over, 0, 8 * LEAST, {2, 4}, NEAR, 0},
    {"-0.5/x", half_over, 0, LEAST, {0, 0}, NEAR, 0},
    {"a/x^2", over_square, 1, LEAST, {0, 2}, 8 * LEAST, 1},
    {"a/x^3", over_cube, 1, LEAST, {0, 3}, 8 * LEAST, 1},
    {"a/x^4", over_fourth, 1, 0x1p-62, {0, 4}, 8 * LEAST, 1},
    {"sqrt(x)", root, 0, 0, {0, 0}, 0, 0},
    {"1/sqrt(x)", inverse_root, 0, LEAST, {0, 0}, 0, 0},
    {"a/sqrt(x)", over_root, 1, LEAST, {0, 0}, NEAR, 0},
    {"a/root^3", over_root_cubed, 1, LEAST, {0, 0}, NEAR, 1},
    {"x < 1 ? root : 1/root", beside, 0, LEAST, {0, 0}, 0, 0},
    {"atan2(a, x)", angle, 1, 8 * LEAST, {0, 0}, NEAR, 0},
};

typedef struct {
    uint64_t checked, wrong, refused;
    double worst;
} result;

/* Exponent 255 is a number's, if the configuration is finite; 0 is no number's where subnormal
 * numbers are flushed. */
static double number(const fp3_config *config, uint32_t bits) {
    const int exponent = (int)(bits >> 23 & 255);
    const double size = exponent ? ldexp((double)((bits & 0x7fffff) | 0x800000), exponent - 150)
                        : config->subnormal ? ldexp((double)(bits & 0x7fffff), -149)
                                            : 0;
    return size > 0 && bits >> 31 ? -size : size;
}

static int is_number(const fp3_config *config, uint32_t bits) {
    return config->finite || (bits >> 23 & 255) < 255;
}

/* Fractions and signs that fill their range evenly (Knuth, The Art of Computer Programming 3, 6.4).
 */
static uint32_t operand(uint32_t exponent, uint32_t *count) {
    const uint32_t mixed = 0x9e3779b1u * ++*count;
    return (mixed & 0x80000000u) | exponent << 23 | (mixed >> 8 & 0x7fffff);
}

static double unit_of(double truth) {
    int exponent;
    frexp(truth, &exponent);
    return fabs(truth) < LEAST ? 0x1p-149 : ldexp(1, exponent - 24);
}

static void check(const function *f, const fp3_config *config, const program *p, uint32_t a,
                  uint32_t x, result *found) {
    uint32_t flags;
    const double truth = f->truth(number(config, a), number(config, x));
    const double beyond = config->finite ? 0x1p129 : 0x1p128;
    const double large = ldexp(beyond * (1 - 0x1p-21), -f->last[config->finite]);
    const uint32_t bits = execute_on(p, config, x, a, &flags);
    const int may_be_refused = fabs(number(config, x)) < f->small || !(fabs(truth) < large) ||
                               (f->truth == angle && fabs(number(config, a)) < f->small);
    const int must_be_refused = !isfinite(truth) || fabs(truth) >= beyond;
    const int is_refused =
        !is_number(config, bits) || (flags & (FP3_FLAG_INVALID | FP3_FLAG_OVERFLOW));
    const double off = fabs(number(config, bits) - truth);
    int is_wrong = is_refused ? !may_be_refused : must_be_refused;
    found->checked++;
    found->refused += (uint64_t)is_refused;
    if (!is_refused && !is_wrong) {
        const double ulp = fmax(0, off - (config->subnormal ? 0 : f->absolute)) / unit_of(truth);
        found->worst = fmax(found->worst, ulp);
        is_wrong = !(ulp < 24);
    }
    if (is_wrong && found->wrong++ < 5)
        printf("FAIL %s of a = %a, x = %a: %a with flags %02x, expected %a\n", f->expression,
               number(config, a), number(config, x), number(config, bits), (unsigned)flags, truth);
}

static result measure(const function *f, const fp3_config *config, unsigned fractions) {
    const uint32_t exponents = config->finite ? 256 : 255;
    program p;
    result found = {0};
    uint32_t count = 0;
    make(&p, f->expression, 1, config->name);
    const uint64_t callers = fp3_fpu_begin((int)config->nearest);
    for (uint32_t e = 0; e < exponents; e++)
        for (uint32_t d = 0; d < exponents; d++)
            for (unsigned i = 0; i < fractions; i++) {
                const uint32_t kept = f->truth == angle && (!d || !e) ? SIGN_AND_EXPONENT : ~0u;
                const uint32_t a = operand(d, &count) & kept, x = operand(e, &count) & kept;
                check(f, config, &p, f->has_a ? a : 0x3f800000, x, &found);
            }
    fp3_fpu_set(callers);
    end(&p);
    return found;
}

int main(int argc, char **argv) {
    const fp3_config *config = fp3_config_find(argc > 1 ? argv[1] : "flush");
    const int fractions = argc > 2 ? atoi(argv[2]) : 1;
    int is_bad = 0;
    if (!config || fractions < 1)
        fail("flushed", "CONFIG [N]");
    for (size_t i = 0; i < sizeof functions / sizeof *functions; i++) {
        if (config->subnormal && functions[i].is_power)
            continue;
        const result r = measure(&functions[i], config, (unsigned)fractions);
        printf("%s: %llu checked, %llu wrong, %llu refused, %.3f ulp\n", functions[i].expression,
               (unsigned long long)r.checked, (unsigned long long)r.wrong,
               (unsigned long long)r.refused, r.worst);
        is_bad |= r.wrong != 0;
    }
    return is_bad;
}
