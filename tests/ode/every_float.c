/* every_float.c - functions of one number against libm in double, for every float of their range.
 *
 *     every_float [N [NAME [FROM TO]]]     every Nth float (1: minutes for each function), of all
 * functions or one, of its whole range or a part
 *
 * Prints of each function the instructions, the largest error, where it is, and how many were
 * compared. The compiler makes a step of y' = f(x); its operations are carried out here on blocks
 * of floats, as the compiler knows no faster way, and a sample of them by fp3_execute, which must
 * give the same bits. A result that should be beyond FLT_MAX counts as 2^128, and so does what
 * should not be.
 */
#pragma GCC optimize("O3")
#include "function.h"

#include <machine/estimate.h>

enum { BLOCK = 1024 };

typedef float block[BLOCK];

typedef struct {
    const char *name, *expression;
    double (*truth)(double x, double n);
    float from, to;
    double n;           /* of x^n, an FP32 number as every param; a NaN: of all sizes */
    double least, most; /* a smaller truth counts as least: near a zero. A larger one is near a
                           pole; 0: none is */
} function;

static double sin_of(double x, double n) { return (void)n, sin(x); }
static double cos_of(double x, double n) { return (void)n, cos(x); }
static double tan_of(double x, double n) { return (void)n, tan(x); }
static double atan_of(double x, double n) { return (void)n, atan(x); }
static double asin_of(double x, double n) { return (void)n, asin(x); }
static double acos_of(double x, double n) { return (void)n, acos(x); }
static double exp_of(double x, double n) { return (void)n, exp(x); }
static double log_of(double x, double n) { return (void)n, log(x); }
static double log2_of(double x, double n) { return (void)n, log2(x); }
static double sinh_of(double x, double n) { return (void)n, sinh(x); }
static double cosh_of(double x, double n) { return (void)n, cosh(x); }
static double tanh_of(double x, double n) { return (void)n, tanh(x); }
static double expm1_of(double x, double n) { return (void)n, expm1(x); }
static double log1p_of(double x, double n) { return (void)n, log1p(x); }
static double logistic_of(double x, double n) { return (void)n, 1 / (1 + exp(-x)); }

#define ALL -INFINITY, INFINITY
#define POSITIVE 0, INFINITY
#define TURNS -0x1.fffffep15f, 0x1.fffffep15f
#define FINITE -0x1.fffffep127f, 0x1.fffffep127f

static const function functions[] = {
    {"sin", "sin(x)", sin_of, TURNS, 0, 0.5, 0},
    {"cos", "cos(x)", cos_of, TURNS, 0, 0.5, 0},
    {"tan", "tan(x)", tan_of, TURNS, 0, 0x1p-10, 0x1p10},
    {"atan", "atan(x)", atan_of, FINITE, 0, 0, 0},
    {"asin", "asin(x)", asin_of, -1, 1, 0, 0, 0},
    {"acos", "acos(x)", acos_of, -1, 1, 0, 0, 0},
    {"exp", "exp(x)", exp_of, ALL, 0, 0, 0},
    {"log", "log(x)", log_of, POSITIVE, 0, 0, 0},
    {"log2", "log2(x)", log2_of, POSITIVE, 0, 0, 0},
    {"sinh", "sinh(x)", sinh_of, ALL, 0, 0, 0},
    {"cosh", "cosh(x)", cosh_of, ALL, 0, 0, 0},
    {"tanh", "tanh(x)", tanh_of, ALL, 0, 0, 0},
    {"expm1", "expm1(x)", expm1_of, ALL, 0, 0, 0},
    {"log1p", "log1p(x)", log1p_of, -1, INFINITY, 0, 0, 0},
    {"logistic", "logistic(x)", logistic_of, ALL, 0, 0, 0},
    {"x^0.5", "x^0.5", pow, 0x1p-126, 0x1p126, 0.5, 0, 0},
    {"x^1.5", "x^1.5", pow, 0x1p-84, 0x1p84, 1.5, 0, 0},
    {"x^2.5", "x^2.5", pow, 0x1p-50, 0x1p51, 2.5, 0, 0},
    {"x^3.5", "x^3.5", pow, 0x1p-35, 0x1p36, 3.5, 0, 0},
    {"x^-0.5", "x^-0.5", pow, 0x1p-126, 0x1p126, -0.5, 0, 0},
    {"x^-1.5", "x^-1.5", pow, 0x1p-84, 0x1p83, -1.5, 0, 0},
    {"x^-2.5", "x^-2.5", pow, POSITIVE, -2.5, 0, 0},
    {"x^(1/3)", "x^(1/3)", pow, POSITIVE, 1.0 / 3, 0, 0},
    {"x^-0.7", "x^-0.7", pow, POSITIVE, -0.7, 0, 0},
    {"x^1.4", "x^n", pow, POSITIVE, 1.4f, 0, 0},
    {"x^3", "x^n", pow, ALL, 3, 0, 0},
    {"x^-31", "x^-31", pow, ALL, -31, 0, 0},
    {"x^100.5", "x^n", pow, POSITIVE, 100.5, 0, 0},
    {"x^n", "x^n", pow, POSITIVE, NAN, 0, 0},
};

#define EACH for (int i = 0; i < BLOCK; i++)

static void rint_each(float *restrict d, const float *restrict a) {
    EACH {
        const float large = copysignf(0x1p23f, a[i]);
        const float near = copysignf((a[i] + large) - large, a[i]);
        d[i] = fabsf(a[i]) < 0x1p23f ? near : a[i];
    }
}

static void exp2_each(float *restrict d, const float *restrict a) {
    EACH {
        const float n = a[i] > -151 ? a[i] < 128 ? a[i] : 128 : -151;
        const int k = (int)n;
        const uint32_t bits = k < -149   ? 0
                              : k < -126 ? 1u << ((149 + k) & 31)
                                         : (uint32_t)(k + 127) << 23;
        d[i] = a[i] != a[i] ? a[i] : fp3_value_of(bits);
    }
}

static void logb_each(float *restrict d, const float *restrict a) {
    EACH {
        const uint32_t e = fp3_bits_of(a[i]) >> 23 & 255;
        const float n = (float)((int)e - 127);
        d[i] = a[i] != a[i] ? a[i] : e == 0 ? -INFINITY : e == 255 ? INFINITY : n;
    }
}

static void apply(uint32_t op, float *restrict d, const float *restrict a, const float *restrict b,
                  const float *restrict c) {
    switch (op) {
    case FP3_OP_ADD:
        EACH d[i] = a[i] + b[i];
        return;
    case FP3_OP_SUB:
        EACH d[i] = a[i] - b[i];
        return;
    case FP3_OP_MUL:
        EACH d[i] = a[i] * b[i];
        return;
    case FP3_OP_MIN:
        EACH d[i] = a[i] < b[i] ? a[i] : b[i];
        return;
    case FP3_OP_MAX:
        EACH d[i] = b[i] < a[i] ? a[i] : b[i];
        return;
    case FP3_OP_ABS:
        EACH d[i] = fabsf(a[i]);
        return;
    case FP3_OP_LT:
        EACH d[i] = a[i] < b[i] ? 1 : 0;
        return;
    case FP3_OP_LE:
        EACH d[i] = a[i] <= b[i] ? 1 : 0;
        return;
    case FP3_OP_SEL:
        EACH d[i] = c[i] != 0 ? a[i] : b[i];
        return;
    case FP3_OP_RINT:
        rint_each(d, a);
        return;
    case FP3_OP_EXP2:
        exp2_each(d, a);
        return;
    case FP3_OP_LOGB:
        logb_each(d, a);
        return;
    case FP3_OP_RCP:
        EACH d[i] = fp3_value_of(fp3_estimate_rcp(fp3_bits_of(a[i])));
        return;
    case FP3_OP_RSQRT:
        EACH d[i] = fp3_value_of(fp3_estimate_rsqrt(fp3_bits_of(a[i])));
        return;
    default:
        fail("an operation", "not known here");
    }
}

static block value[NODES_MAX];

/* Once for a program: leaves other than x stay as they are. */
static void fill_leaves(const program *p) {
    for (uint32_t j = 0; j < p->g->count; j++)
        if (p->g->nodes[j].op >= NODE_KNOWN)
            EACH value[j][i] = fp3_value_of(leaf_bits(p, j, 0));
}

static const float *by_blocks(const program *p, const block x) {
    for (uint32_t j = 0; j < p->g->count; j++) {
        const dag_node *n = &p->g->nodes[j];
        if (n->op == NODE_VARIABLE && n->a == p->x)
            memcpy(value[j], x, sizeof(block));
        else if (n->op < NODE_KNOWN)
            apply(n->op, value[j], value[n->a], value[n->b == FP3_NONE ? 0 : n->b],
                  value[n->c == FP3_NONE ? 0 : n->c]);
    }
    return value[p->root];
}

/* ---- how far it is off ---- */

typedef struct {
    double ulp; /* largest error where the truth is normal */
    float at;
    double subnormal; /* likewise, in units of 2^-149, where it is subnormal */
    double absolute;  /* where the truth is below 1/4 */
    uint64_t count, samples;
} result;

static double unit_of(float truth) {
    static double units[256];
    if (!units[1])
        for (int e = 0; e < 256; e++)
            units[e] = ldexp(1, (e ? e : 1) - 150);
    return units[fp3_bits_of(truth) >> 23 & 255];
}

static double limited(double x) { return fabs(x) <= 0x1p128 ? x : copysign(0x1p128, x); }

static void compare(const function *f, float x, float y, result *r) {
    const double truth = f->truth(x, f->n);
    r->count++;
    if (isnan(truth) || isnan(y)) {
        if (isnan(truth) != isnan(y))
            r->ulp = INFINITY, r->at = x;
        return;
    }
    const double off = fabs(limited(y) - limited(truth));
    if (fabs(truth) < 0x1p-126) {
        if (off > r->subnormal * 0x1p-149)
            r->subnormal = off * 0x1p149;
        return;
    }
    const double size = fmax(fabs(truth), f->least);
    const double ulp =
        off / (size < 0x1p128 ? unit_of((float)fmin(size, 0x1.fffffep127)) : 0x1p104);
    if (ulp > r->ulp && (f->most == 0 || size <= f->most))
        r->ulp = ulp, r->at = x;
    if (fabs(truth) < 0.25 && off > r->absolute)
        r->absolute = off;
}

static void look(const program *p, const function *f, const block x, int used, uint64_t number,
                 result *r) {
    const float *y = by_blocks(p, x);
    for (int i = 0; i < used; i++)
        compare(f, x[i], y[i], r);
    if (number % 64 == 0)
        for (int i = 0; i < used; i += 37, r->samples++) {
            uint32_t flags;
            const float same = by_execute(p, x[i], &flags);
            if (fp3_bits_of(same) != fp3_bits_of(y[i]) && !(isnan(same) && isnan(y[i]))) {
                fprintf(stderr, "%s(%a): %a by blocks, %a by fp3_execute\n", f->name, x[i], y[i],
                        same);
                exit(1);
            }
        }
}

/* Floats in their order as integers. */
static int64_t order_of(float x) {
    const uint32_t bits = fp3_bits_of(x);
    return bits >> 31 ? -(int64_t)(bits & 0x7fffffffu) : (int64_t)bits;
}

static float of_order(int64_t order) {
    return fp3_value_of(order < 0 ? (uint32_t)-order | 0x80000000u : (uint32_t)order);
}

static result every(const program *p, const function *f, int64_t step) {
    result r = {0};
    const int64_t last = order_of(f->to);
    int64_t at = order_of(f->from);
    for (uint64_t number = 0; at <= last; number++) {
        static block x;
        int used = 0;
        for (; used < BLOCK && at <= last; used++, at += step)
            x[used] = of_order(at);
        for (int i = used; i < BLOCK; i++)
            x[i] = 1;
        look(p, f, x, used, number, &r);
    }
    /* The ends, which a step may leave out. */
    block ends = {f->from, f->to, 0, 1, 0x1p-149f, 0x1p-126f};
    for (int i = 6; i < BLOCK; i++)
        ends[i] = i % 2 ? of_order(order_of(f->from) + i) : of_order(last - i);
    look(p, f, ends, 2, 0, &r);
    return r;
}

/* A number in [0, 1), of a sequence that fills it. */
static double fraction(uint64_t i, double step) { return fmod(0.5 + (double)i * step, 1.0); }

/* x^n for exponents of every size from 2^-12 to 2^24, a block for each, and x whose powers are
 * normal or nearly so. */
static result any_power(program *p, int64_t step) {
    result r = {0};
    const uint64_t blocks = (UINT64_C(1) << 22) / (uint64_t)step + 16;
    for (uint64_t number = 0; number < blocks; number++) {
        const double size = exp2(36 * fraction(number, 0.6180339887498949) - 12);
        function f = {.name = "x^n", .truth = pow, .n = number % 2 ? (float)size : -(float)size};
        block x;
        evaluate_known(p, f.n);
        fill_leaves(p);
        for (int i = 0; i < BLOCK; i++) {
            const double t = 300 * fraction(number * BLOCK + (uint64_t)i, 0.7548776662466927) - 150;
            x[i] = (float)exp2(fmax(-149, fmin(127.9, t / f.n)));
        }
        look(p, &f, x, BLOCK, number, &r);
    }
    return r;
}

static result measure(program *p, const function *f, int64_t step) {
    return isnan(f->n) ? any_power(p, step) : every(p, f, step);
}

int main(int argc, char **argv) {
    const int64_t step = argc > 1 ? atoll(argv[1]) : 1;
    for (size_t i = 0; i < sizeof functions / sizeof *functions; i++) {
        function of = functions[i], *f = &of;
        program p;
        if (argc > 2 && strcmp(argv[2], f->name))
            continue;
        if (argc > 4) {
            f->from = strtof(argv[3], NULL);
            f->to = strtof(argv[4], NULL);
        }
        make(&p, f->expression, f->n, "single_full");
        fill_leaves(&p);
        const result r = measure(&p, f, step < 1 ? 1 : step);
        printf("%-8s %2u instructions  %.3f ulp at %.9g  %.3g absolute below 1/4  %.2f subnormal "
               "units  %llu floats\n",
               f->name, own_instructions(f->expression), r.ulp, (double)r.at, r.absolute,
               r.subnormal, (unsigned long long)r.count);
        fflush(stdout);
        end(&p);
    }
    return 0;
}
