/* function_values.c - functions of states on the hardware: the bits and flags of their operations
 * one by one, and the special cases of docs/compiler.md.
 *
 *     function_values ENGINE CONFIG
 */
#include "function.h"

#include <fp3/compile.h>
#include <fp3/engine.h>

/* OBJECTS: where there are several. More than contexts, so that not all are in one round. */
enum { ARGUMENTS = 320, OBJECTS = 32 };

#define RAISES (FP3_FLAG_INVALID | FP3_FLAG_OVERFLOW)

/* Of invalid and overflow, these are raised and no others. */
typedef struct {
    const char *expression;
    double n;
    float x, value;
    uint32_t flags;
} special;

#define SMALL 0x1p-127f                    /* a subnormal number */
#define NOT_0 "abs(x) < 1e-16 ? 1e-16 : x" /* what docs/models.md divides by */

static const special specials[] = {
    {"sqrt(x)", 0, 0, 0, 0},
    {"sqrt(x)", 0, -0.0f, -0.0f, 0},
    {"sqrt(x)", 0, 0x1p-149f, 0x1.dffffbp-86f, 0},
    {"sqrt(x)", 0, SMALL, 0x1.58p-64f, 0},
    {"sqrt(x)", 0, 0x1p-126f, 0x1p-63f, 0},
    {"sqrt(x)", 0, 0x1p126f, 0x1p63f, 0},
    {"sqrt(x)", 0, -0x1p-126f, NAN, FP3_FLAG_INVALID},
    {"sqrt(x)", 0, INFINITY, NAN, FP3_FLAG_INVALID},
    {"sqrt(x)", 0, NAN, NAN, 0},
    {"min(sqrt(x), 1)", 0, SMALL, 0x1.58p-64f, 0},
    {"x^0.5", 0, SMALL, 0x1.58p-64f, 0},
    {"x < 1 ? root : 1/root", 0, SMALL, 0x1.01p-64f, 0},
    {"x < 1 ? root : 1/root", 0, 0x1p-126f, 0x1p-63f, 0},
    {"x < 1 ? root : 1/root", 0, 0, 0, FP3_FLAG_INVALID},
    {"x < 1 ? root : 1/root", 0, -1, NAN, FP3_FLAG_INVALID},
    {"1/x", 0, 0, NAN, FP3_FLAG_INVALID},
    {"1/x", 0, SMALL, NAN, FP3_FLAG_INVALID},
    {"1/x", 0, -0x1p-126f, -0x1p126f, 0},
    {"1/x", 0, 0x1.fffffep127f, 0x1p-128f, 0},
    {"1/x", 0, -INFINITY, NAN, FP3_FLAG_INVALID},
    {"n/x", 0x1p-149, 0.25f, 0x1p-147f, 0},
    {"n/(x*x)", 1, 0x1p64f, NAN, RAISES},
    {"sin(x)", 0, 0, 0, 0},
    {"sin(x)", 0, -65536, NAN, RAISES},
    {"sin(x)", 0, INFINITY, NAN, FP3_FLAG_INVALID},
    {"sin(x)", 0, NAN, NAN, 0},
    {"cos(x)", 0, -0.0f, 1, 0},
    {"cos(x)", 0, 65536, NAN, RAISES},
    {"cos(x)", 0, -INFINITY, NAN, FP3_FLAG_INVALID},
    {"cos(x)", 0, NAN, NAN, 0},
    {"tan(x)", 0, 0, 0, 0},
    {"tan(x)", 0, 3e38f, NAN, RAISES},
    {"tan(x)", 0, INFINITY, NAN, FP3_FLAG_INVALID},
    {"tan(x)", 0, NAN, NAN, 0},
    {"atan(x)", 0, -0.0f, -0.0f, 0},
    {"atan(x)", 0, 3e38f, 0x1.921fb6p0f, 0},
    {"atan(x)", 0, INFINITY, NAN, FP3_FLAG_INVALID},
    {"atan(x)", 0, NAN, NAN, 0},
    {"asin(x)", 0, -0.0f, -0.0f, 0},
    {"asin(x)", 0, -1, -0x1.921fb6p0f, 0},
    {"asin(x)", 0, 0x1.000002p0f, NAN, RAISES},
    {"asin(x)", 0, -INFINITY, NAN, FP3_FLAG_INVALID},
    {"asin(x)", 0, NAN, NAN, 0},
    {"acos(x)", 0, 1, 0, 0},
    {"acos(x)", 0, -1, 0x1.921fb6p1f, 0},
    {"acos(x)", 0, -0x1.000002p0f, NAN, RAISES},
    {"acos(x)", 0, NAN, NAN, 0},
    {"atan2(x, x)", 0, -0.0f, 0, 0},
    {"atan2(x, x)", 0, -1, -0x1.2d97c8p1f, 0},
    {"atan2(x, x)", 0, 0x1p-149f, NAN, FP3_FLAG_INVALID},
    {"atan2(x, x)", 0, INFINITY, NAN, FP3_FLAG_INVALID},
    {"exp(x)", 0, 0, 1, 0},
    {"exp(x)", 0, -0.0f, 1, 0},
    {"exp(x)", 0, 88.72283f, 0x1.ffff08p127f, 0},
    {"exp(x)", 0, 88.73f, INFINITY, FP3_FLAG_OVERFLOW},
    {"exp(x)", 0, 1e30f, INFINITY, FP3_FLAG_OVERFLOW},
    {"exp(x)", 0, INFINITY, INFINITY, 0},
    {"exp(x)", 0, -103, 0x1p-149f, 0},
    {"exp(x)", 0, -104, 0, 0},
    {"exp(x)", 0, -3e38f, 0, 0},
    {"exp(x)", 0, -INFINITY, 0, 0},
    {"exp(x)", 0, NAN, NAN, 0},
    {"log(x)", 0, 1, 0, 0},
    {"log(x)", 0, 0, -INFINITY, 0},
    {"log(x)", 0, -0.0f, -INFINITY, 0},
    {"log(x)", 0, INFINITY, INFINITY, 0},
    {"log(x)", 0, 0x1p-149f, -0x1.9d1dap6f, 0},
    {"log(x)", 0, -1, NAN, FP3_FLAG_INVALID},
    {"log(x)", 0, -0x1p-149f, NAN, FP3_FLAG_INVALID},
    {"log(x)", 0, -3e38f, NAN, FP3_FLAG_INVALID},
    {"log(x)", 0, -INFINITY, NAN, FP3_FLAG_INVALID},
    {"log(x)", 0, NAN, NAN, 0},
    {"log2(x)", 0, 1, 0, 0},
    {"log2(x)", 0, 0.125f, -3, 0},
    {"log2(x)", 0, 0x1p127f, 127, 0},
    {"log2(x)", 0, 0x1p-149f, -149, 0},
    {"log2(x)", 0, 0x1p-126f, -126, 0},
    {"log2(x)", 0, 0x1.fffffep127f, 128, 0},
    {"log2(x)", 0, 0, -INFINITY, 0},
    {"log2(x)", 0, -0.0f, -INFINITY, 0},
    {"log2(x)", 0, INFINITY, INFINITY, 0},
    {"log2(x)", 0, -1, NAN, FP3_FLAG_INVALID},
    {"log2(x)", 0, -0x1p-149f, NAN, FP3_FLAG_INVALID},
    {"log2(x)", 0, -INFINITY, NAN, FP3_FLAG_INVALID},
    {"log2(x)", 0, NAN, NAN, 0},
    {"sinh(x)", 0, 0, 0, 0},
    {"sinh(x)", 0, 0x1p-20f, 0x1p-20f, 0},
    {"sinh(x)", 0, 90, INFINITY, FP3_FLAG_OVERFLOW},
    {"sinh(x)", 0, -90, -INFINITY, FP3_FLAG_OVERFLOW},
    {"sinh(x)", 0, INFINITY, INFINITY, 0},
    {"sinh(x)", 0, -INFINITY, -INFINITY, 0},
    {"sinh(x)", 0, NAN, NAN, 0},
    {"cosh(x)", 0, 0, 1, 0},
    {"cosh(x)", 0, 90, INFINITY, FP3_FLAG_OVERFLOW},
    {"cosh(x)", 0, -INFINITY, INFINITY, 0},
    {"cosh(x)", 0, NAN, NAN, 0},
    {"tanh(x)", 0, 0, 0, 0},
    {"tanh(x)", 0, 20, 1, 0},
    {"tanh(x)", 0, 3e38f, 1, 0},
    {"tanh(x)", 0, INFINITY, 1, 0},
    {"tanh(x)", 0, -INFINITY, -1, 0},
    {"tanh(x)", 0, NAN, NAN, 0},
    {"expm1(x)", 0, 0, 0, 0},
    {"expm1(x)", 0, 0x1p-149f, 0x1p-149f, 0},
    {"expm1(x)", 0, -1e-10f, -1e-10f, 0},
    {"expm1(x)", 0, 88.72283f, 0x1.ffff08p127f, 0},
    {"expm1(x)", 0, 88.73f, INFINITY, FP3_FLAG_OVERFLOW},
    {"expm1(x)", 0, 1e30f, INFINITY, FP3_FLAG_OVERFLOW},
    {"expm1(x)", 0, INFINITY, INFINITY, 0},
    {"expm1(x)", 0, -18, -1, 0},
    {"expm1(x)", 0, -INFINITY, -1, 0},
    {"expm1(x)", 0, NAN, NAN, 0},
    {"expm1(x)/x", 0, 0, NAN, FP3_FLAG_INVALID},
    {"x == 0 ? 1 : expm1(x)/x", 0, 0, 1, FP3_FLAG_INVALID},
    {"expm1(" NOT_0 ")/(" NOT_0 ")", 0, 0, 1, 0},
    {"expm1(" NOT_0 ")/(" NOT_0 ")", 0, 0x1p-149f, 1, 0},
    {"expm1(" NOT_0 ")/(" NOT_0 ")", 0, -20, 0x1.99999ap-5f, 0},
    {"log1p(x)", 0, 0, 0, 0},
    {"log1p(x)", 0, 0x1p-149f, 0x1p-149f, 0},
    {"log1p(x)", 0, -1e-10f, -1e-10f, 0},
    {"log1p(x)", 0, 0x1.fffffep127f, 0x1.62e43p6f, 0},
    {"log1p(x)", 0, INFINITY, INFINITY, 0},
    {"log1p(x)", 0, -1, -INFINITY, 0},
    {"log1p(x)", 0, -0x1.000002p0f, NAN, FP3_FLAG_INVALID},
    {"log1p(x)", 0, -3e38f, NAN, FP3_FLAG_INVALID},
    {"log1p(x)", 0, -INFINITY, NAN, FP3_FLAG_INVALID},
    {"log1p(x)", 0, NAN, NAN, 0},
    {"1/(1 + exp(-x))", 0, -100, NAN, RAISES},
    {"logistic(x)", 0, 0, 0.5f, 0},
    {"logistic(x)", 0, 100, 1, 0},
    {"logistic(x)", 0, INFINITY, 1, 0},
    {"logistic(x)", 0, -100, 0x1.bp-145f, 0},
    {"logistic(x)", 0, -104, 0, 0},
    {"logistic(x)", 0, -3e38f, 0, 0},
    {"logistic(x)", 0, -INFINITY, 0, 0},
    {"logistic(x)", 0, NAN, NAN, 0},
    {"x^(1/3)", 0, 1, 1, 0},
    {"x^(1/3)", 0, 0, 0, 0},
    {"x^(1/3)", 0, INFINITY, INFINITY, FP3_FLAG_OVERFLOW},
    {"x^(1/3)", 0, -8, NAN, FP3_FLAG_INVALID},
    {"x^(1/3)", 0, -INFINITY, NAN, FP3_FLAG_INVALID},
    {"x^(1/3)", 0, NAN, NAN, 0},
    {"x^-0.7", 0, 0, INFINITY, FP3_FLAG_OVERFLOW},
    {"x^-0.7", 0, INFINITY, 0, 0},
    {"x^9", 0, -2, -512, 0},
    {"x^9", 0, -INFINITY, -INFINITY, FP3_FLAG_OVERFLOW},
    {"x^10", 0, -2, 1024, 0},
    {"x^n", 3, -2, -8, 0},
    {"x^n", 2, -3e38f, INFINITY, FP3_FLAG_OVERFLOW},
    {"x^n", 2.5, -2, NAN, FP3_FLAG_INVALID},
    {"x^n", 2.5, 0, 0, 0},
    {"x^n", -2, 0, INFINITY, FP3_FLAG_OVERFLOW},
    {"x^n", 0, 0, 1, 0},
    {"x^n", 0, INFINITY, 1, 0},
    {"x^n", 0, -5, 1, 0},
    {"x^n", 1, 0x1p-149f, 0x1p-149f, 0},
    {"x^n", 1e300, 1, 1, 0},
    {"x^n", 1e300, 0x1.000002p0f, INFINITY, FP3_FLAG_OVERFLOW},
    {"x^n", -1e300, 0x1.000002p0f, 0, 0},
    {"x^n", 1e300, 0x1.fffffep-1f, 0, 0},
    {"1/x^1.5", 0, 4, 0.125f, 0},
    {"1/x^2.5", 0, 4, 0.03125f, 0},
};

enum { SPECIALS = sizeof specials / sizeof *specials };

typedef struct {
    const char *name, *config;
    program p;
    fp3_engine *engine;
    uint32_t objects, x, y; /* registers */
    unsigned checked, failed;
} bench;

/* ---- on the engine ---- */

static void open_engine(bench *b, const special *s) {
    fp3_error error;
    fp3_engine_def def = fp3_engine_default();
    float values[16];
    def.engine = b->name;
    def.config = b->config;
    def.objects = strcmp(b->config, "single_full") ? OBJECTS : 1;
    def.error = &error;
    make(&b->p, s->expression, s->n, b->config);
    const fp3_compiled *c = b->p.compiled;
    if (fp3_engine_open(&def, &b->engine) || fp3_engine_load(b->engine, c->image) ||
        c->input_count > 16 ||
        fp3_compiled_inputs(c, &s->n, (double[]){1, 0, 1}, 1, values, &error))
        fail(s->expression, error.text);
    b->objects = def.objects;
    b->x = fp3_image_find(c->image, "x", FP3_CLASSES_HOST)->index;
    b->y = fp3_image_find(c->image, "y", FP3_CLASSES_HOST)->index;
    for (uint32_t i = 0; i < c->input_count; i++) {
        const fp3_symbol *at = fp3_image_find(c->image, c->inputs[i].name, FP3_CLASSES_HOST);
        for (uint32_t object = 0; object < b->objects; object++)
            if (c->inputs[i].is_shared
                    ? fp3_engine_write_shared(b->engine, at->index, 1, &values[i])
                    : fp3_engine_write(b->engine, object, 1, at->index, &values[i]))
                fail(s->expression, error.text);
    }
}

static void close_engine(bench *b) {
    fp3_engine_close(&b->engine);
    end(&b->p);
}

/* y of each object for its x; flags are those of all. */
static void run(bench *b, const float *x, uint32_t count, float *y, uint32_t *flags) {
    const float minus_zero = -0.0f;
    fp3_stats stats;
    for (uint32_t i = 0; i < b->objects; i++)
        if (fp3_engine_write(b->engine, i, 1, b->x, &x[i < count ? i : 0]) ||
            fp3_engine_write(b->engine, i, 1, b->y, &minus_zero))
            fail(b->name, "no x written");
    if (fp3_engine_run(b->engine, 1, &stats))
        fail(b->name, "no run");
    *flags = stats.flags;
    for (uint32_t i = 0; i < count; i++)
        if (fp3_engine_read(b->engine, i, 1, b->y, &y[i]))
            fail(b->name, "no y read");
}

/* ---- what it should be ---- */

static int is_same(float a, float b) {
    return isnan(a) ? isnan(b) : fp3_bits_of(a) == fp3_bits_of(b);
}

static void complain(bench *b, const char *expression, float x, float y, uint32_t flags,
                     float wanted, uint32_t wanted_flags) {
    b->failed++;
    printf("FAIL %s %s %s of %.9g: %.9g flags %02x, expected %.9g flags %02x\n", b->name, b->config,
           expression, (double)x, (double)y, (unsigned)flags, (double)wanted,
           (unsigned)wanted_flags);
}

/* Value and flags where they can be told apart: one object. */
static void check_bits(bench *b, const special *s, const float *x, uint32_t count) {
    float y[ARGUMENTS];
    uint32_t flags, each, all = 0;
    run(b, x, count, y, &flags);
    for (uint32_t i = 0; i < b->objects; i++) {
        const float wanted = by_execute(&b->p, x[i < count ? i : 0], &each);
        all |= each;
        if (i < count && !is_same(y[i], wanted))
            complain(b, s->expression, x[i], y[i], flags, wanted, each);
    }
    b->checked += count;
    if (flags != all)
        complain(b, s->expression, x[0], y[0], flags, y[0], all);
}

static void check_special(bench *b, const special *s) {
    float y;
    uint32_t flags;
    run(b, &s->x, 1, &y, &flags);
    if (!is_same(y, s->value) || (flags & RAISES) != s->flags)
        complain(b, s->expression, s->x, y, flags, s->value, s->flags);
    b->checked++;
}

/* All exponents and signs with some fractions, and more where functions live. */
static void arguments(float x[ARGUMENTS]) {
    uint32_t chance = 12345;
    for (uint32_t i = 0; i < ARGUMENTS; i++) {
        chance = chance * 1664525u + 1013904223u;
        const uint32_t bits = (chance & 0x807fffffu) | ((i * 5 / 4) % 256) << 23;
        x[i] = i % 2 ? fp3_value_of(bits) : (float)((int)(chance >> 8) - 0x800000) * 0x1p-16f;
    }
}

int main(int argc, char **argv) {
    if (argc != 3)
        fail("function_values", "an engine and a configuration");
    bench b = {.name = argv[1], .config = argv[2]};
    float x[ARGUMENTS];
    /* One object in hardware takes long: every third, of both kinds. */
    const uint32_t stride = strcmp(b.name, "rtl") ? 1 : 3;
    arguments(x);
    for (int i = 0, is_open = 0; i < SPECIALS; i++) {
        const special *s = &specials[i], *before = i ? s - 1 : NULL;
        if (is_open && (strcmp(s->expression, before->expression) || s->n != before->n)) {
            close_engine(&b);
            is_open = 0;
        }
        if (!is_open) {
            open_engine(&b, s);
            const uint32_t step = b.objects == 1 ? stride : b.objects;
            is_open = 1;
            for (uint32_t at = 0; at < ARGUMENTS; at += step)
                check_bits(&b, s, x + at, b.objects);
        }
        check_special(&b, s);
    }
    close_engine(&b);
    printf("%u values, %u wrong\n", b.checked, b.failed);
    return b.failed != 0;
}
