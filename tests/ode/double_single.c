/* double_single.c - the compiler's arithmetic with pairs of floats, executed as the machine does.
 *
 *     double_single [N]     N random pairs of operands for each operation (default 40000), eight
 * times as many of floats
 *
 * Sums, differences and products of two floats against what they are exactly, over the whole range,
 * with ties, cancellation, subnormal numbers and both ends; operations on pairs against __float128,
 * with 113 bits, relative to the result; loose ones relative to the size of the result (loose.h).
 * Prints, for each, how many were checked, how many nodes it has, and its largest relative error in
 * units of u^2 = 2^-48.
 */
#include "executed_pairs.h"

#include <compiler/code/check.h>
#include <compiler/pairs/loose.h>

/* Any finite number; half of the time one that is near another, of few bits, or at an end. */
static float any(float near) {
    static const float ends[] = {0x1p-149f, 0x1p-126f, 0x1.fffffcp-127f, 0x1p-103f, 0x1p-102f,
                                 1,         0x1p115f,  0x1.fffffep115f,  0x1p126f,  FLT_MAX};
    const uint64_t kind = chance() % 16;
    if (kind < 3) /* a cancellation, or a tie */
        return (chance() & 1 ? -near : near) * (1 + (float)(chance() % 9) * FLT_EPSILON) *
               (chance() & 1 ? 1 : ldexpf(1, (int)(chance() % 60) - 30));
    if (kind == 3)
        return ends[chance() % (sizeof ends / sizeof *ends)];
    if (kind == 4)
        return ldexpf((float)(chance() % 4096), (int)(chance() % 200) - 130);
    if (kind == 5)
        return chance() & 1 ? 0.0f : -0.0f;
    const float x = fp3_value_of((uint32_t)chance());
    return isfinite(x) ? x : 0;
}

static float bounded(float x) { return isfinite(x) ? x : FLT_MAX; }

/* ---- floats ---- */

/* Whether s + e is a + b, of finite numbers: where quad has not all bits, nothing was rounded but
 * the smaller one away. */
static int is_sum(float a, float b, const float r[2]) {
    if ((quad)r[0] + (quad)r[1] != (quad)a + (quad)b)
        return 0;
    const float large = fabsf(a) < fabsf(b) ? b : a, small = fabsf(a) < fabsf(b) ? a : b;
    return fabsf(small) > fabsf(large) * 0x1p-60f || (r[0] == large && r[1] == small) ||
           (small == 0 && r[0] == large);
}

static void check_sum(operation *o, float a, float b, int is_difference) {
    const float words[2] = {a, b};
    float r[2];
    const volatile float wanted = is_difference ? a - b : a + b;
    execute(o, words, r, NULL);
    o->checked++;
    if (!isfinite(wanted)) { /* said, and no number */
        if (isfinite(r[0]) || !(flags_of(o, words) & FP3_FLAG_OVERFLOW))
            tell(o, words, 2, r);
    } else if (r[0] != wanted || (fmaxf(fabsf(a), fabsf(b)) < 0x1p127f
                                      ? !is_sum(a, is_difference ? -b : b, r)
                                      : !isnan(r[1]) && !is_sum(a, is_difference ? -b : b, r)))
        tell(o, words, 2, r);
}

/* A product is exact in double. */
static void check_product(operation *o, float a, float b) {
    const float words[2] = {a, b};
    float r[2];
    const volatile float wanted = a * b;
    const double exact = (double)a * (double)b, least = fabs(exact);
    execute(o, words, r, NULL);
    o->checked++;
    const double found = (double)r[0] + (double)r[1];
    if (!isfinite(wanted) || least >= 0x1.ffp127 || fmaxf(fabsf(a), fabsf(b)) >= 0x1p115f) {
        /* From 2^115 on a half may overflow, and so may the product of two that were rounded up:
         * then the result is said to be no number, else it is right. */
        const int is_said = (!isfinite(r[0]) || !isfinite(r[1])) &&
                            flags_of(o, words) & (FP3_FLAG_OVERFLOW | FP3_FLAG_INVALID);
        if (!is_said && !(isfinite(wanted) && fabs(found - exact) <= 0x1p-147))
            tell(o, words, 2, r);
    } else if (least >= 0x1p-102 ? found != exact || r[0] != wanted
                                 : fabs(found - exact) > 0x1p-147 || r[0] != wanted) {
        tell(o, words, 2, r);
    } else if (least < 0x1p-102)
        o->worst = fmax(o->worst, fabs(found - exact) / 0x1p-149);
}

static int check_floats(uint64_t count) {
    operation sum, difference, product;
    open_operation(&sum, "two_sum");
    open_operation(&difference, "two_difference");
    open_operation(&product, "two_product");
    product.unit = "units of 2^-149 below 2^-102";
    sum.made = fp3_two_sum(&sum.g, fp3_dag_variable(&sum.g, 0), fp3_dag_variable(&sum.g, 1));
    difference.made = fp3_two_difference(&difference.g, fp3_dag_variable(&difference.g, 0),
                                         fp3_dag_variable(&difference.g, 1));
    product.made = fp3_two_product(&product.g, fp3_dag_variable(&product.g, 0),
                                   fp3_dag_variable(&product.g, 1));
    for (uint64_t i = 0; i < count; i++) {
        const float a = bounded(any(1)), b = bounded(any(a));
        check_sum(&sum, a, b, 0);
        check_sum(&difference, a, b, 1);
        check_product(&product, a, i % 4 ? b : between(-140, -60));
        check_product(&product, between(-70, -30), between(-80, -30));
    }
    return end(&sum) | end(&difference) | end(&product);
}

/* ---- pairs ---- */

typedef fp3_pair binary(dag *g, fp3_pair x, fp3_pair y);
typedef fp3_pair unary(dag *g, fp3_pair x);
/* The relative error of a result. */
typedef quad error_fn(quad x, quad y, quad result);

static quad of_add(quad x, quad y, quad r) { return x + y == 0 ? r : (r - (x + y)) / (x + y); }
static quad of_sub(quad x, quad y, quad r) { return x - y == 0 ? r : (r - (x - y)) / (x - y); }
static quad of_mul(quad x, quad y, quad r) { return (r - x * y) / (x * y); }
static quad of_quotient(quad x, quad y, quad r) { return (r * y - x) / x; }
/* To the first order in an error of 2^-40. */
static quad of_root(quad x, quad y, quad r) { return (void)y, (r * r - x) / (2 * x); }
static quad of_inverse_root(quad x, quad y, quad r) { return (void)y, (1 - r * r * x) / -2; }

static int check_pairs(const char *name, binary *two, unary *one, error_fn *error, double bound,
                       int range, uint64_t count) {
    operation o;
    open_operation(&o, name);
    uint32_t v[4];
    for (uint32_t i = 0; i < 4; i++)
        v[i] = fp3_dag_variable(&o.g, i);
    const fp3_pair x = {v[0], v[1]}, y = {v[2], v[3]};
    o.made = two ? two(&o.g, x, y) : one(&o.g, x);
    for (uint64_t i = 0; i < count; i++) {
        float words[4], r[2];
        any_pair(words, -range, range);
        any_pair(words + 2, -range, range);
        if (!two)
            words[1] = words[0] < 0 ? -words[1] : words[1], words[0] = fabsf(words[0]);
        if (i % 4 == 1) { /* they cancel, to few bits or to many */
            words[2] = words[0] * (i % 8 == 1 ? -1 : 1);
            words[3] = words[1] * (1 + (float)(chance() % 5) * FLT_EPSILON * 0.5f);
        }
        execute(&o, words, r, NULL);
        o.checked++;
        const double found = fabs((double)error(sum_of(words), sum_of(words + 2), sum_of(r))) / U2;
        if (!(found <= bound) || (float)sum_of(r) != r[0])
            tell(&o, words, 4, r);
        o.worst = fmax(o.worst, found);
    }
    return end(&o);
}

/* ---- loose pairs ---- */

typedef fp3_loose loose_binary(dag *g, fp3_loose x, fp3_loose y);

/* A value of this size, of which anything up to all may have cancelled: its words and its spread of
 * `spread` u. */
static void any_loose(float *words, double size, unsigned spread) {
    const int gone = chance() % 3 ? 0 : (int)(chance() % 60);
    words[0] = (float)ldexp(size * (chance() & 1 ? -1 : 1), -gone);
    const double most = size * spread * 0x1p-24;
    words[1] = (float)(most * ((double)(chance() % 0x2000001) * 0x1p-24 - 1) * (1 - 0x1p-23));
}

/* turned: of the operands in the other order, which has the same words. */
static void check_loose_once(operation *o, char kind, const unsigned spread[2],
                             const int is_less[2], fp3_pair turned, double bound) {
    float words[4], r[2], other[2];
    operation with = *o;
    with.made = turned;
    double size[2];
    for (int k = 0; k < 2; k++) {
        size[k] = fabs((double)between(-20, 20));
        any_loose(words + 2 * k, size[k], spread[k]);
    }
    if (chance() % 4 == 0) { /* they cancel */
        any_loose(words + 2, size[1] = size[0], spread[1]);
        words[2] = words[0] * (1 + (float)(chance() % 5) * FLT_EPSILON) * (chance() & 1 ? 1 : -1);
    }
    const quad x = (quad)words[0] + (is_less[0] ? -1 : 1) * (quad)words[1];
    const quad y = (quad)words[2] + (is_less[1] ? -1 : 1) * (quad)words[3];
    const quad exact = kind == '*' ? x * y : kind == '+' ? x + y : x - y;
    const double all = kind == '*' ? size[0] * size[1] : size[0] + size[1];
    execute(o, words, r, NULL);
    execute(&with, words, other, NULL);
    o->checked++;
    const double found = fabs((double)((sum_of(r) - exact) / all)) / U2;
    if (!(found <= bound) || (float)sum_of(r) != r[0] || r[0] != other[0] || r[1] != other[1])
        tell(o, words, 4, r);
    o->worst = fmax(o->worst, found);
}

/* Of operands with these spreads, whose second words are added or subtracted; the result is
 * renormalised, without an error. */
static int check_loose(const char *name, loose_binary *op, char kind, unsigned k, unsigned l,
                       uint64_t count) {
    const double product = k + l == 2 ? 8 : 2 + 4 * k + 4 * l + k * l;
    const double bound = kind == '*' ? product : k + l == 2 ? 3 : 2 + 3 * (k > l ? k : l);
    int is_bad = 0;
    for (unsigned signs = 0; signs < 4; signs++) {
        operation o;
        const unsigned spread[] = {k, l};
        const int is_less[] = {(int)(signs & 1), (int)(signs >> 1)};
        fp3_loose x[2];
        open_operation(&o, name);
        for (uint32_t i = 0; i < 2; i++)
            x[i] = (fp3_loose){{fp3_dag_variable(&o.g, 2 * i), fp3_dag_variable(&o.g, 2 * i + 1)},
                               is_less[i],
                               1,
                               spread[i]};
        const fp3_loose made = op(&o.g, x[0], x[1]);
        unsigned nodes = 0;
        for (uint32_t i = 0; i < o.g.count; i++)
            nodes += !fp3_dag_is_leaf(&o.g, i);
        o.made = fp3_loose_pair(&o.g, made);
        const fp3_pair turned = kind == '-' ? o.made : fp3_loose_pair(&o.g, op(&o.g, x[1], x[0]));
        is_bad |= made.spread > FP3_SPREAD_MOST;
        for (uint64_t i = 0; i < count / 4; i++)
            check_loose_once(&o, kind, spread, is_less, turned, bound);
        o.spent = nodes;
        is_bad |= end(&o);
    }
    return is_bad;
}

static int check_all_loose(uint64_t count) {
    int is_bad = 0;
    for (unsigned k = 1; k <= FP3_SPREAD_MOST; k += FP3_SPREAD_MOST - 1)
        for (unsigned l = 1; l <= FP3_SPREAD_MOST; l += FP3_SPREAD_MOST - 1) {
            char name[3][32];
            for (int i = 0; i < 3; i++)
                snprintf(name[i], sizeof name[i], k + l == 2 ? "%s" : "%s %u %u",
                         (const char *[]){"loose_add", "loose_sub", "loose_mul"}[i], k, l);
            is_bad |= check_loose(name[0], fp3_loose_add, '+', k, l, count);
            is_bad |= check_loose(name[1], fp3_loose_sub, '-', k, l, count);
            is_bad |= check_loose(name[2], fp3_loose_mul, '*', k, l, count);
        }
    return is_bad;
}

static int check_order(uint64_t count) {
    operation less, at_most;
    open_operation(&less, "less");
    open_operation(&at_most, "less_equal");
    for (int k = 0; k < 2; k++) {
        operation *o = k ? &at_most : &less;
        uint32_t v[4];
        for (uint32_t i = 0; i < 4; i++)
            v[i] = fp3_dag_variable(&o->g, i);
        o->made = (k ? fp3_pair_less_equal : fp3_pair_less)(&o->g, (fp3_pair){v[0], v[1]},
                                                            (fp3_pair){v[2], v[3]});
        for (uint64_t i = 0; i < count; i++) {
            float words[4], r[2];
            any_pair(words, -3, 3);
            any_pair(words + 2, -3, 3);
            if (i % 2)
                words[2] = words[0];
            if (i % 4 == 1)
                words[3] = words[1];
            const quad x = sum_of(words), y = sum_of(words + 2);
            execute(o, words, r, NULL);
            o->checked++;
            if (r[0] != (float)(k ? x <= y : x < y) || r[1] != 0)
                tell(o, words, 4, r);
        }
    }
    return end(&less) | end(&at_most);
}

/* ---- what is refused ---- */

/* A sum of two words whose error no float is, or is flushed: and then it says so. */
static int check_refused(float a, float b, int nearest, int subnormal, const char *message) {
    operation o;
    open_operation(&o, "refused");
    o.made = fp3_two_sum(&o.g, fp3_dag_variable(&o.g, 0), fp3_dag_variable(&o.g, 1));
    o.config =
        (fp3_config){.nearest = nearest, .subnormal = subnormal, .fraction = 23, .name = "other"};
    const float words[2] = {a, b};
    float r[2];
    fp3_error error = {0};
    const uint64_t callers = fp3_fpu_begin(nearest);
    execute(&o, words, r, NULL);
    fp3_fpu_set(callers);
    const int is_exact = (quad)r[0] + (quad)r[1] == (quad)a + (quad)b;
    const fp3_options options = {.config = &o.config, .arithmetic = FP3_DOUBLE_SINGLE};
    const fp3_fit fit = {0};
    const int is_told = fp3_check_arithmetic(&options, &fit, &error) == FP3_E_PROGRAM &&
                        strstr(error.text, message);
    printf("%s: %s\n", message,
           is_exact  ? "exact"
           : is_told ? "refused, not exact"
                     : "not refused");
    fp3_dag_close(&o.g);
    fp3_known_close(&o.known);
    fp3_model_free(&o.model);
    return is_exact || !is_told;
}

int main(int argc, char **argv) {
    const uint64_t count = argc > 1 ? strtoull(argv[1], NULL, 10) : 40000;
    int is_bad = check_floats(8 * count);
    is_bad |= check_pairs("add", fp3_pair_add, NULL, of_add, 3.1, 40, count);
    is_bad |= check_pairs("sub", fp3_pair_sub, NULL, of_sub, 3.1, 40, count);
    is_bad |= check_pairs("mul", fp3_pair_mul, NULL, of_mul, 5, 40, count);
    is_bad |= check_pairs("quotient", fp3_pair_quotient, NULL, of_quotient, 32, 30, count);
    is_bad |= check_pairs("root", NULL, fp3_pair_root, of_root, 16, 60, count);
    is_bad |=
        check_pairs("inverse_root", NULL, fp3_pair_inverse_root, of_inverse_root, 16, 30, count);
    is_bad |= check_all_loose(count);
    is_bad |= check_refused(1, -0x1p-100f, 0, 1, "double-single needs rounding to nearest");
    is_bad |= check_refused(0x1.8p-126f, -0x1p-126f, 1, 0, "double-single needs subnormal numbers");
    return is_bad | check_order(count / 4);
}
