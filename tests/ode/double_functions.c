/* double_functions.c - functions of double-single against libm with long double.
 *
 *     double_functions [N]     N random arguments for each function (default 4000)
 *
 * Prints, for each, how many were checked, how many nodes it has, and its largest error in units of
 * u^2 = 2^-48: absolutely, relative to the result, or relative to what the row says.
 */
#include "executed_pairs.h"

#include <compiler/pairs/pair_functions.h>

typedef long double real; /* 64 bits: 2^16 times as fine */
typedef fp3_pair unary(dag *g, fp3_pair x);

/* What an error counts against. */
static real absolute(real x, real y) { return (void)x, (void)y, 1; }
static real relative(real x, real y) { return (void)x, y; }
static real logisticl(real x) { return 1 / (1 + expl(-x)); }

/* An error of the argument. */
static real steep(real x, real y) { return (void)x, 1 + y * y; }

typedef struct {
    const char *name;
    unary *made;
    real (*wanted)(real x);
    real (*unit)(real x, real y);
    double bound;    /* in u^2 */
    int least, most; /* exponents of the argument */
    double limit;    /* of its size */
    double middle;   /* what the argument is counted from */
} row;

/* The pair of a sum. */
static void to_pair(real x, float *words) {
    words[0] = (float)x;
    words[1] = (float)(x - (real)words[0]);
}

static real argument(const row *r, float *words) {
    do {
        any_pair(words, r->least, r->most);
        if (r->middle != 0)
            to_pair((real)r->middle + (real)words[0] + (real)words[1], words);
    } while (fabs((double)words[0]) > r->limit ||
             (words[0] < 0 && (r->made == fp3_pair_log || r->made == fp3_pair_log2)) ||
             (words[0] <= -1 && r->made == fp3_pair_log1p));
    return (real)words[0] + (real)words[1];
}

static void judge(operation *o, const row *r, const float *words, real x) {
    float result[2];
    execute(o, words, result, NULL);
    const real wanted = r->wanted(x), unit = r->unit(x, wanted);
    const double found =
        (double)(fabsl((real)result[0] + (real)result[1] - wanted) / fabsl(unit)) / U2;
    o->checked++;
    if (!(found <= r->bound) || result[0] + result[1] != result[0])
        tell(o, words, 2, result);
    o->worst = fmax(o->worst, found);
}

static int check(const row *r, uint64_t count) {
    operation o;
    open_operation(&o, r->name);
    o.made = r->made(&o.g, (fp3_pair){fp3_dag_variable(&o.g, 0), fp3_dag_variable(&o.g, 1)});
    for (uint64_t i = 0; i < count; i++) {
        float words[2];
        const real x = argument(r, words);
        judge(&o, r, words, x);
    }
    return end(&o);
}

static const row rows[] = {
    {"sin", fp3_pair_sin, sinl, absolute, 16, -20, 15, 0x1.fffffep15, 0},
    {"sin near 0", fp3_pair_sin, sinl, relative, 16, -60, 0, 1.57, 0},
    {"cos", fp3_pair_cos, cosl, absolute, 16, -20, 15, 0x1.fffffep15, 0},
    {"tan", fp3_pair_tan, tanl, steep, 16, -20, 14, 0x1.fffffep14, 0},
    {"tan near 0", fp3_pair_tan, tanl, relative, 16, -60, 0, 0.78, 0},
    {"exp", fp3_pair_exp, expl, relative, 16, -40, 6, 70, 0},
    {"exp of large x", fp3_pair_exp, expl, relative, 16, -20, 3, 88.7, 80},
    {"log", fp3_pair_log, logl, relative, 16, -100, 126, 3e38, 0},
    {"log near 1", fp3_pair_log, logl, relative, 16, -40, -2, 2, 1},
    {"log2", fp3_pair_log2, log2l, relative, 16, -100, 126, 3e38, 0},
    {"log2 near 1", fp3_pair_log2, log2l, relative, 16, -40, -2, 2, 1},
    {"sinh", fp3_pair_sinh, sinhl, relative, 16, -60, 6, 89.4, 0},
    {"cosh", fp3_pair_cosh, coshl, relative, 16, -60, 6, 89.4, 0},
    {"tanh", fp3_pair_tanh, tanhl, relative, 16, -60, 6, 128, 0},
    {"expm1", fp3_pair_expm1, expm1l, relative, 16, -60, 6, 88.7, 0},
    {"log1p", fp3_pair_log1p, log1pl, relative, 16, -60, 126, 3e38, 0},
    {"log1p near 0", fp3_pair_log1p, log1pl, relative, 16, -30, 0, 0.9999999, 0},
    {"log1p near -1", fp3_pair_log1p, log1pl, relative, 16, -23, -2, 2, -1},
    {"logistic", fp3_pair_logistic, logisticl, relative, 16, -60, 6, 70, 0},
    {"atan", fp3_pair_atan, atanl, relative, 16, -60, 126, 3e38, 0},
    {"asin", fp3_pair_asin, asinl, relative, 16, -60, -1, 0.9999999, 0},
    {"asin near 1", fp3_pair_asin, asinl, relative, 16, -24, -3, 0.9999999, 0.9},
    {"acos", fp3_pair_acos, acosl, absolute, 16, -20, -1, 0.9999999, 0},
    {"acos near 1", fp3_pair_acos, acosl, relative, 16, -24, -4, 0.99999999, 1},
};

/* ---- of two arguments ---- */

static uint32_t number_of(operation *o, double number) {
    return fp3_known_number(&o->known, number);
}

/* All quadrants, with sizes that are near and far from each other. */
static int check_atan2(uint64_t count) {
    operation o;
    open_operation(&o, "atan2");
    uint32_t v[4];
    for (uint32_t i = 0; i < 4; i++)
        v[i] = fp3_dag_variable(&o.g, i);
    o.made = fp3_pair_atan2(&o.g, (fp3_pair){v[0], v[1]}, (fp3_pair){v[2], v[3]});
    for (uint64_t i = 0; i < count; i++) {
        float words[4], result[2];
        any_pair(words, -30, 30);
        any_pair(words + 2, i % 2 ? -30 : ilogbf(words[0]) - 1, i % 2 ? 30 : ilogbf(words[0]) + 1);
        const real wanted =
            atan2l((real)words[0] + (real)words[1], (real)words[2] + (real)words[3]);
        execute(&o, words, result, NULL);
        const double found =
            (double)(fabsl((real)result[0] + (real)result[1] - wanted) / fabsl(wanted)) / U2;
        o.checked++;
        if (!(found <= 16))
            tell(&o, words, 4, result);
        o.worst = fmax(o.worst, found);
    }
    return end(&o);
}

/* Relative to 1 + |n log(x)|, which is how many times the error of the logarithm counts. */
static int check_power(const char *name, double n, uint64_t count) {
    operation o;
    open_operation(&o, name);
    o.made = fp3_pair_power(&o.g, (fp3_pair){fp3_dag_variable(&o.g, 0), fp3_dag_variable(&o.g, 1)},
                            number_of(&o, n));
    const double most = 70 / fabs(n);
    for (uint64_t i = 0; i < count; i++) {
        float words[2], result[2];
        any_pair(words, -99, 99);
        if (n != rint(n) && words[0] < 0)
            words[0] = -words[0], words[1] = -words[1];
        const real x = (real)words[0] + (real)words[1], log_x = logl(fabsl(x));
        if (fabsl(log_x) > (real)most)
            continue;
        const real wanted = powl(x, (real)n);
        execute(&o, words, result, NULL);
        const double found = (double)(fabsl((real)result[0] + (real)result[1] - wanted) /
                                      fabsl(wanted * (1 + fabsl((real)n * log_x)))) /
                             U2;
        o.checked++;
        if (!(found <= 16))
            tell(&o, words, 2, result);
        o.worst = fmax(o.worst, found);
    }
    return end(&o);
}

/* ---- ends of the range ---- */

typedef struct {
    unary *made;
    double x;      /* as two words */
    double wanted; /* NAN: no number */
    uint32_t flag; /* that is raised; 0: none of overflow and invalid */
} at_end;

#define QUARTER 1.57079632679489662
static const at_end ends[] = {
    {fp3_pair_sin, 65536, NAN, FP3_FLAG_INVALID},
    {fp3_pair_sin, -1e30, NAN, FP3_FLAG_INVALID},
    {fp3_pair_sin, INFINITY, NAN, FP3_FLAG_INVALID},
    {fp3_pair_sin, NAN, NAN, 0},
    {fp3_pair_sin, 0, 0, 0},
    {fp3_pair_cos, 65536, NAN, FP3_FLAG_INVALID},
    {fp3_pair_cos, 0, 1, 0},
    {fp3_pair_tan, 32768, NAN, FP3_FLAG_INVALID},
    {fp3_pair_tan, 0, 0, 0},
    {fp3_pair_exp, 0, 1, 0},
    {fp3_pair_exp, 88.5, 2.72308782506811161e38, 0},
    {fp3_pair_exp, 88.73, INFINITY, FP3_FLAG_OVERFLOW},
    {fp3_pair_exp, 1e30, INFINITY, FP3_FLAG_OVERFLOW},
    {fp3_pair_exp, INFINITY, INFINITY, FP3_FLAG_OVERFLOW},
    {fp3_pair_exp, -95, 5.52108227702853273e-42, 0},
    {fp3_pair_exp, -200, 0, 0},
    {fp3_pair_exp, -INFINITY, 0, 0},
    {fp3_pair_exp, NAN, NAN, 0},
    {fp3_pair_log, 1, 0, 0},
    {fp3_pair_log, 0x1p-149, -103.278929903431851, 0},
    {fp3_pair_log, 0, -INFINITY, FP3_FLAG_INVALID},
    {fp3_pair_log, -1, NAN, FP3_FLAG_INVALID},
    {fp3_pair_log, INFINITY, INFINITY, FP3_FLAG_INVALID},
    {fp3_pair_log2, 1, 0, 0},
    {fp3_pair_log2, 0x1p-149, -149, 0},
    {fp3_pair_log2, 0x1p127, 127, 0},
    {fp3_pair_log2, 0, -INFINITY, FP3_FLAG_INVALID},
    {fp3_pair_log2, -1, NAN, FP3_FLAG_INVALID},
    {fp3_pair_log2, INFINITY, INFINITY, FP3_FLAG_INVALID},
    {fp3_pair_sinh, 1000, INFINITY, FP3_FLAG_OVERFLOW},
    {fp3_pair_sinh, -1000, -INFINITY, FP3_FLAG_OVERFLOW},
    {fp3_pair_sinh, -89, -2.24480640958717262e38, 0},
    {fp3_pair_cosh, -1000, INFINITY, FP3_FLAG_OVERFLOW},
    {fp3_pair_cosh, 0, 1, 0},
    {fp3_pair_tanh, 1e38, 1, 0},
    {fp3_pair_tanh, -INFINITY, -1, 0},
    {fp3_pair_expm1, 0, 0, 0},
    {fp3_pair_expm1, 0x1p-149, 0x1p-149, 0},
    {fp3_pair_expm1, 88.5, 2.72308782506811161e38, 0},
    {fp3_pair_expm1, 88.73, INFINITY, FP3_FLAG_OVERFLOW},
    {fp3_pair_expm1, INFINITY, INFINITY, FP3_FLAG_OVERFLOW},
    {fp3_pair_expm1, -INFINITY, -1, 0},
    {fp3_pair_expm1, NAN, NAN, 0},
    {fp3_pair_log1p, 0, 0, 0},
    {fp3_pair_log1p, 0x1p-149, 0x1p-149, 0},
    {fp3_pair_log1p, -1, -INFINITY, FP3_FLAG_INVALID},
    {fp3_pair_log1p, -1.5, NAN, FP3_FLAG_INVALID},
    {fp3_pair_log1p, INFINITY, INFINITY, FP3_FLAG_INVALID},
    {fp3_pair_logistic, 0, 0.5, 0},
    {fp3_pair_logistic, INFINITY, 1, 0},
    {fp3_pair_logistic, -95, 5.52108227702853273e-42, 0},
    {fp3_pair_logistic, -INFINITY, 0, 0},
    {fp3_pair_logistic, NAN, NAN, 0},
    {fp3_pair_atan, 3e38, QUARTER, 0},
    {fp3_pair_atan, -INFINITY, -QUARTER, 0},
    {fp3_pair_asin, 1, QUARTER, 0},
    {fp3_pair_asin, -1, -QUARTER, 0},
    {fp3_pair_asin, 1 + 0x1p-40, NAN, FP3_FLAG_INVALID},
    {fp3_pair_acos, 1, 0, 0},
    {fp3_pair_acos, -1, 2 * QUARTER, 0},
    {fp3_pair_acos, -1.5, NAN, FP3_FLAG_INVALID},
    {fp3_pair_root, 0, 0, 0},
    {fp3_pair_root, 0x1p-149, 0x1.67fffdp-85, 0},
    {fp3_pair_root, 0x1p-127, 0x1.68b68p-64, 0},
    {fp3_pair_root, 0x1p-126, 0x1p-63, 0},
    {fp3_pair_inverse_root, 0x1p-127, NAN, FP3_FLAG_INVALID},
};

static int is_right(const at_end *e, const float result[2], uint32_t flags) {
    const uint32_t told = flags & (FP3_FLAG_OVERFLOW | FP3_FLAG_INVALID);
    if (e->flag ? !(told & e->flag) : told != 0)
        return 0;
    if (!isfinite(e->wanted))
        return isnan(e->wanted) ? isnan(result[0]) || isnan(result[1]) : !isfinite(result[0]);
    return fabs((double)result[0] + (double)result[1] - e->wanted) <=
           fmax(fabs(e->wanted) * 0x1p-44, 0x1p-147);
}

static int check_ends(void) {
    unsigned wrong = 0;
    for (size_t i = 0; i < sizeof ends / sizeof *ends; i++) {
        operation o;
        open_operation(&o, "end");
        o.made =
            ends[i].made(&o.g, (fp3_pair){fp3_dag_variable(&o.g, 0), fp3_dag_variable(&o.g, 1)});
        float words[2], result[2];
        uint32_t flags = 0;
        to_pair((real)ends[i].x, words);
        if (!isfinite(words[0]))
            words[1] = 0;
        execute(&o, words, result, &flags);
        if (!is_right(&ends[i], result, flags)) {
            printf("FAIL end %zu: %a gives %a + %a, flags %u\n", i, ends[i].x, (double)result[0],
                   (double)result[1], flags);
            wrong++;
        }
        fp3_dag_close(&o.g);
        fp3_known_close(&o.known);
        fp3_model_free(&o.model);
    }
    printf("ends: %zu checked, %u wrong\n", sizeof ends / sizeof *ends, wrong);
    return wrong != 0;
}

static int check_powers_of_zero(void) {
    static const double exponents[] = {2.5, -1.7, 0}, wanted[] = {0, INFINITY, 1};
    unsigned wrong = 0;
    for (int i = 0; i < 3; i++) {
        operation o;
        open_operation(&o, "0^n");
        o.made =
            fp3_pair_power(&o.g, (fp3_pair){fp3_dag_variable(&o.g, 0), fp3_dag_variable(&o.g, 1)},
                           number_of(&o, exponents[i]));
        float result[2];
        execute(&o, (float[]){0, 0}, result, NULL);
        wrong += (double)result[0] != wanted[i] || result[1] != 0;
        fp3_dag_close(&o.g);
        fp3_known_close(&o.known);
        fp3_model_free(&o.model);
    }
    printf("0^n: 3 checked, %u wrong\n", wrong);
    return wrong != 0;
}

int main(int argc, char **argv) {
    const uint64_t count = argc > 1 ? strtoull(argv[1], NULL, 10) : 4000;
    int is_bad = 0;
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
        is_bad |= check(&rows[i], count);
    is_bad |= check_atan2(count) | check_power("x^0.3", 0.3, count) |
              check_power("x^-7.25", -7.25, count) | check_power("x^9", 9, count);
    return is_bad | check_ends() | check_powers_of_zero();
}
