/* exact_division.c - the pass `exact-division` against the host's division and square root, bit for
 * bit.
 *
 *     exact_division [N [CONFIG]]     every Nth fraction (1: all), and as many random and hard
 * quotients
 *
 * y' = f(x, a) by Euler's method with h = 1 from y = -0 is f(x, a), as 1 * f + -0 rounds nothing.
 */
#include <fp3/compile.h>
#include <fp3/truth.h>

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    const char *expression;
    fp3_model *model;
    fp3_compiled *compiled;
    uint64_t checked, wrong;
} function;

static void fail(const char *what, const char *why) {
    fprintf(stderr, "%s: %s\n", what, why);
    exit(1);
}

static function make(const char *expression, const char *config) {
    function f = {.expression = expression};
    char source[256], *report = NULL;
    fp3_error error;
    fp3_integrator *euler = NULL;
    fp3_compile_def def = fp3_compile_default();
    def.config = config;
    def.passes |= FP3_PASS(FP3_PASS_EXACT_DIVISION);
    snprintf(source, sizeof source,
             "state x = 1\nstate a = 1\nstate y = 0\nstep 1\nspan 1\nx' = 0\na' = 0\ny' = %s\n",
             expression);
    if (fp3_model_read(source, strlen(source), expression, &f.model, &report, &error) ||
        fp3_integrator_find("euler", &euler, &error) ||
        fp3_compile(f.model, euler, &def, &f.compiled, &error))
        fail(expression, error.text);
    fp3_integrator_free(&euler);
    return f;
}

static void check(function *f, float x, float a, float wanted) {
    const uint64_t one = 1;
    float states[3];
    fp3_error error;
    if (fp3_compiled_reference(f->compiled, NULL, (double[]){x, a, -0.0}, 1, &one, 1, states,
                               &error))
        fail(f->expression, error.text);
    f->checked++;
    if (memcmp(&states[2], &wanted, sizeof wanted) && f->wrong++ < 5)
        printf("FAIL %s of x = %a, a = %a: %a, expected %a\n", f->expression, (double)x, (double)a,
               (double)states[2], (double)wanted);
}

static int end(function *f) {
    printf("%s: %" PRIu64 " checked, %" PRIu64 " wrong\n", f->expression, f->checked, f->wrong);
    fp3_compiled_free(&f->compiled);
    fp3_model_free(&f->model);
    return f->wrong != 0;
}

/* Marsaglia, Xorshift RNGs, Journal of Statistical Software 8 (2003). */
static uint64_t chance(void) {
    static uint64_t state = 88172645463325252u;
    state ^= state << 13;
    state ^= state >> 7;
    return state ^= state << 17;
}

static float any_normal(void) {
    const uint64_t bits = chance();
    const float fraction = 1 + (float)(bits & 0x7fffff) * 0x1p-23f;
    return ldexpf(bits >> 40 & 1 ? -fraction : fraction, (int)(bits >> 41) % 254 - 126);
}

static void check_quotient(function *f, float a, float b) {
    const volatile float wanted = a / b; /* volatile: rounded */
    if (isnormal(a) && isnormal(b) && isnormal(wanted))
        check(f, b, a, wanted);
}

/* a 2^k = m b + j for a small j, so that a/b is as near to m as can be, which has 25 bits: halfway
 * between two floats. */
static void check_hard(function *f) {
    const uint64_t b = 1u << 23 | (chance() & 0x7fffff) | 1;
    const int64_t j = (int64_t)(chance() % 8) - 4;
    uint64_t inverse = b;
    for (int i = 0; i < 5; i++)
        inverse *= 2 - b * inverse; /* Newton, modulo 2^64 */
    for (int k = 24; k <= 25; k++) {
        uint64_t m = (uint64_t)-j * inverse & ((UINT64_C(1) << k) - 1);
        m |= k == 24 ? 1u << 24 : 0;
        const uint64_t a = (m * b + (uint64_t)j) >> k;
        if (m >> 24 == 1 && m % 2 && a >> 23 == 1)
            check_quotient(f, ldexpf((float)a, (int)(chance() % 200) - 120),
                           ldexpf(chance() % 2 ? (float)b : -(float)b, (int)(chance() % 60) - 30));
    }
}

/* Near the square of a number halfway between two floats. */
static void check_hard_root(function *f) {
    const double half = 1 + (double)(2 * (chance() & 0xffffff) + 1) * 0x1p-24;
    const volatile float x = (float)(half * half);
    const volatile float wanted = sqrtf(x);
    check(f, x, 1, wanted);
}

int main(int argc, char **argv) {
    const uint32_t step = argc > 1 ? (uint32_t)atol(argv[1]) : 211;
    if (!step)
        fail("exact_division", "every Nth fraction, N from 1");
    const char *config = argc > 2 ? argv[2] : fp3_compile_default().config;
    function over = make("1/x", config), quotient = make("a/x", config),
             root = make("sqrt(x)", config);
    for (uint32_t i = 0; i < 1u << 24; i += step) {
        const volatile float x = 1 + (float)(i & 0x7fffff) * 0x1p-23f + (float)(i >> 23);
        const volatile float square_root = sqrtf(x), reciprocal = 1 / x;
        check(&root, x, 1, square_root);
        if (i < 1u << 23)
            check(&over, x, 1, reciprocal);
        check_quotient(&quotient, any_normal(), any_normal());
        check_hard(&quotient);
        check_hard_root(&root);
        const float size = fabsf(any_normal());
        const volatile float its_root = sqrtf(size), its_inverse = 1 / size;
        check(&root, size, 1, its_root);
        if (isnormal(its_inverse))
            check(&over, size, 1, its_inverse);
    }
    check(&root, 0, 1, 0);
    check(&root, 0x1p-149f, 1, 0x1.6a09e6p-75f);
    check(&quotient, 1, 0, 0);
    check(&quotient, 0x1p23f, 2.34e-38f, 0); /* no power of two: 2^-148 is nearest */
    return end(&over) + end(&quotient) + end(&root) > 0;
}
