/* division_bounds.c - how far quotients and roots may be from the truth, for all operands whose
 * steps are normal numbers.
 *
 *     division_bounds CONFIG [ENTRY]     ENTRY of the table of estimates is taken for one more
 *
 * An estimate's fraction is that of its operand's, as are all roundings behind it: what exponents
 * there are makes no difference, but for a root whether b's is even. So every fraction of b, with
 * both, is every b. `exact` is the largest error over them. `bound` is of a quotient, for every
 * numerator: for each b, with q = a y rounded, p = q t rounded, and z = q + p rounded, and Q the
 * true quotient between 1 and 2, in units of its last place,
 *
 *     |z - Q| <= [z's rounding] + [p's] + (1 + t) [q's] + Q |y (1 + t) b - 1|
 *
 * where a rounding is off by half a unit of its own binade, or by one if it truncates. If q + p is
 * 2 or more, z is not beyond it.
 *
 * Without infinities a / sqrt(b) is a times 1 / sqrt(b): one unit, and twice that one's largest
 * error.
 *
 * Each entry of the table is the largest that is not too large for any number with its index: so
 * 1 - b y is not negative, and a table with another entry is refused.
 */
#include "function.h"

#include <machine/estimate.h>

#define ONE 0x3f800000u

typedef struct {
    const char *expression;
    int is_root, is_quotient;
    long double (*truth)(long double b); /* of a = 1 */
} function;

static long double inverse(long double b) { return 1 / b; }
static long double root(long double b) { return sqrtl(b); }
static long double inverse_root(long double b) { return 1 / sqrtl(b); }

static const function functions[] = {
    {"1/x", 0, 0, inverse},
    {"a/x", 0, 1, inverse},
    {"sqrt(x)", 1, 0, root},
    {"1/sqrt(x)", 1, 0, inverse_root},
    {"a/sqrt(x)", 1, 1, inverse_root},
};

/* ---- the table ---- */

/* The index has all b below m. Reciprocals: d m <= 1. Roots: d d m <= 1. In whole numbers. */
static int is_best(const int table[], int i) {
    const int64_t f = i & 511, g = table[i];
    if (i < 1024)
        return (512 + g) * (1025 + i) <= 1 << 20 && (513 + g) * (1025 + i) > 1 << 20;
    const int is_odd = i >= 1536;
    const int64_t d = is_odd ? 512 + g : 1024 + g, most = (int64_t)1 << (is_odd ? 29 : 30);
    return d * d * (513 + f) <= most && (d + 1) * (d + 1) * (513 + f) > most;
}

static int table_is_best(int wrong) {
    int table[FP3_ESTIMATES];
    fp3_estimate_table(table);
    if (wrong >= 0)
        table[wrong]++;
    for (int i = 0; i < FP3_ESTIMATES; i++)
        if (!is_best(table, i)) {
            printf("entry %d of the estimates is not the largest that is never too large\n", i);
            return 0;
        }
    return 1;
}

/* ---- the errors ---- */

static double unit(const fp3_config *config, double x) {
    return ldexp(1, ilogb(x) - (int)config->fraction);
}

/* The sum q + q t: the last one of this form. Returns t. */
static uint32_t correction(const program *p, uint32_t *q) {
    for (uint32_t i = p->g->count; i-- > 0;) {
        const dag_node *sum = &p->g->nodes[i];
        if (sum->op != FP3_OP_ADD)
            continue;
        for (int side = 0; side < 2; side++) {
            const uint32_t one = side ? sum->b : sum->a, other = side ? sum->a : sum->b;
            const dag_node *product = &p->g->nodes[other];
            if (product->op != FP3_OP_MUL || (product->a != one && product->b != one))
                continue;
            *q = one;
            return product->a == one ? product->b : product->a;
        }
    }
    return FP3_NONE;
}

/* Of a / b with any a, where value has what is computed of a = 1. */
static double bound(const fp3_config *config, uint32_t q, uint32_t t, const uint32_t value[],
                    long double truth) {
    const double place = ldexp(1, -(int)config->fraction), c = config->nearest ? 0.5 : 1;
    const double y = (double)fp3_value_of(value[q]), s = (double)fp3_value_of(value[t]);
    long double near = (long double)y * (1 + (long double)s) / truth;
    near /= exp2l(roundl(log2l(near)));                         /* the operands may be scaled */
    const double p = s == 0 ? 0 : ldexp(c, ilogb(2 * fabs(s))); /* q is at most 2 */
    return c + p + c * (1 + fabs(s)) + (double)fabsl(near - 1) * 2 / place;
}

static double measure(const function *f, const fp3_config *config) {
    static uint32_t value[NODES_MAX];
    const uint32_t fractions = 1u << config->fraction, step = 23 - config->fraction;
    program p;
    double worst = 0;
    uint32_t flags, q = FP3_NONE;
    make(&p, f->expression, 1, config->name);
    const uint32_t t = f->is_quotient ? correction(&p, &q) : FP3_NONE;
    const uint64_t callers = fp3_fpu_begin((int)config->nearest);
    for (uint32_t i = 0; i < fractions << f->is_root; i++) {
        const uint32_t b = ONE + (i << step);
        execute_all(&p, config, b, ONE, &flags, value);
        const long double truth = f->truth((long double)fp3_value_of(b));
        const double error = f->is_quotient
                                 ? bound(config, q, t, value, truth)
                                 : (double)fabsl((long double)fp3_value_of(value[p.root]) - truth) /
                                       unit(config, (double)truth);
        if (!(error <= worst))
            worst = error;
    }
    fp3_fpu_set(callers);
    end(&p);
    return worst;
}

int main(int argc, char **argv) {
    const fp3_config *config = fp3_config_find(argc > 1 ? argv[1] : "many_full");
    if (!config || !table_is_best(argc > 2 ? atoi(argv[2]) : -1))
        return 1;
    double last = 0;
    for (size_t i = 0; i < sizeof functions / sizeof *functions; i++) {
        const function *f = &functions[i];
        const int is_product = config->finite && f->is_root && f->is_quotient;
        last = is_product ? 1 + 2 * last : measure(f, config);
        /* Upwards, as it must not be larger. */
        printf("%-10s %s %.4f\n", f->expression, f->is_quotient ? "bound" : "exact",
               ceil(last * 1e4) / 1e4);
    }
    return 0;
}
