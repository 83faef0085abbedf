/* accuracy.c - how far from the truth what the compiler makes of / sqrt sin cos is.
 *
 *     accuracy               prints, for each function, its largest error over its range
 *     accuracy CONFIG        of quotients and roots in the numbers of this configuration, in units
 * of their last place
 *
 * y' = f(x) by Euler's method with h = 1 from y = 0 is f(x), as 1 * f + 0 rounds nothing.
 */
#include <fp3/truth.h>

#include <machine/format.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define SAMPLES 262144
#define FEWER 32768 /* of numbers with fewer bits */

typedef struct {
    const char *name, *expression;
    double (*truth)(double x, double a);
    double from, to; /* of x: between them evenly, or, if logarithmic, in every binade alike */
    int is_logarithmic, is_absolute;
    int has_any_sign; /* of x and a; then a is logarithmic, too */
} function;

static double reciprocal(double x, double a) { return (void)a, 1 / x; }
static double quotient(double x, double a) { return a / x; }
static double large_quotient(double x, double a) { return a * 0x1p100 / x; }
static double root(double x, double a) { return (void)a, sqrt(x); }
static double inverse_root(double x, double a) { return (void)a, 1 / sqrt(x); }
static double over_root(double x, double a) { return a / sqrt(x); }
static double sine(double x, double a) { return (void)a, sin(x); }
static double cosine(double x, double a) { return (void)a, cos(x); }
static double tangent(double x, double a) { return (void)a, tan(x); }
static double arctangent(double x, double a) { return (void)a, atan(x); }
static double arcsine(double x, double a) { return (void)a, asin(x); }
static double arccosine(double x, double a) { return (void)a, acos(x); }

#define QUOTIENTS 7 /* the first of them: the others have constants */
static const function functions[] = {
    {"1/x", "1/x", reciprocal, 0x1p-100, 0x1p100, 1, 0, 0},
    {"a/x", "a/x", quotient, 0x1p-60, 0x1p60, 1, 0, 0},
    {"1/x:large", "1/x", reciprocal, 0x1p125, 0x1.fffffep127, 1, 0, 0},
    {"a/x:large", "a*2^100/x", large_quotient, 0x1p125, 0x1.fffffep127, 1, 0, 0},
    {"sqrt(x)", "sqrt(x)", root, 0x1p-100, 0x1p100, 1, 0, 0},
    {"1/sqrt(x)", "1/sqrt(x)", inverse_root, 0x1p-100, 0x1p100, 1, 0, 0},
    {"a/sqrt(x)", "a/sqrt(x)", over_root, 0x1p-60, 0x1p60, 1, 0, 0},
    {"sin(x)", "sin(x)", sine, -10, 10, 0, 1, 0},
    {"cos(x)", "cos(x)", cosine, -10, 10, 0, 1, 0},
    {"sin(x):far", "sin(x)", sine, -65535.99, 65535.99, 0, 1, 0},
    {"cos(x):far", "cos(x)", cosine, -65535.99, 65535.99, 0, 1, 0},
    {"tan(x)", "tan(x)", tangent, -1.57, 1.57, 0, 0, 0},
    {"tan(x):far", "tan(x)", tangent, -65535.99, 65535.99, 0, 0, 0},
    {"atan(x)", "atan(x)", arctangent, 0x1p-100, 0x1p127, 1, 0, 0},
    {"atan(x):-", "atan(x)", arctangent, -4, 4, 0, 0, 0},
    {"asin(x)", "asin(x)", arcsine, -1, 1, 0, 0, 0},
    {"acos(x)", "acos(x)", arccosine, -1, 1, 0, 0, 0},
    {"atan2(x,a)", "atan2(x, a)", atan2, 0x1p-4, 0x1p4, 1, 0, 1},
    {"atan2:wide", "atan2(x, a)", atan2, 0x1p-60, 0x1p60, 1, 0, 1},
};

static void fail(const char *what, const fp3_error *error) {
    fprintf(stderr, "%s: %s\n", what, error->text);
    exit(1);
}

static fp3_compiled *compile(const function *f, const fp3_config *config, fp3_model **model) {
    char source[512], *report = NULL;
    fp3_error error;
    fp3_integrator *euler = NULL;
    fp3_compiled *compiled = NULL;
    fp3_compile_def def = fp3_compile_default();
    def.config = config->name;
    snprintf(source, sizeof source,
             "state x = 1\nstate a = 1\nstate y = 0\nstep 1\nspan 1\nx' = 0\na' = 0\ny' = %s\n",
             f->expression);
    if (fp3_model_read(source, strlen(source), "accuracy", model, &report, &error) ||
        fp3_integrator_find("euler", &euler, &error) ||
        fp3_compile(*model, euler, &def, &compiled, &error))
        fail(f->name, &error);
    fp3_integrator_free(&euler);
    return compiled;
}

/* Of the last place. */
static double unit(const fp3_config *config, float x) {
    const int exponent = fabsf(x) < 0x1p-126f ? -126 : ilogbf(x);
    return ldexp(1, exponent - (int)config->fraction);
}

static double number(const fp3_config *config, double x) {
    uint32_t word;
    const char *wrong = fp3_format_word(config, (float)x, &word);
    return (double)fp3_format_value(config,
                                    wrong ? 0x7f7fffff : word); /* what is too large: the largest */
}

/* A number in [0, 1), evenly, of a sequence that fills it. */
static double fraction(unsigned i) { return fmod(0.5 + i * 0.6180339887498949, 1.0); }

static double worst_of(const function *f, const fp3_config *config) {
    fp3_model *model = NULL;
    fp3_compiled *compiled = compile(f, config, &model);
    fp3_error error;
    const unsigned samples = config->fraction < 23 ? FEWER : SAMPLES;
    const uint64_t one = 1;
    double worst = 0;
    for (unsigned i = 0; i < samples; i++) {
        const double u = (double)i / samples;
        /* volatile: gcc 12 -O2 was seen to leave the rounding out. */
        const double size =
            f->is_logarithmic ? f->from * pow(f->to / f->from, u) : f->from + (f->to - f->from) * u;
        const volatile float x = (float)size;
        const volatile float a =
            (float)(f->has_any_sign ? pow(f->to / f->from, fraction(i) - 0.5) : 1 + fraction(i));
        float states[3] = {0};
        const double signs[] = {f->has_any_sign && i & 1 ? -1 : 1,
                                f->has_any_sign && i & 2 ? -1 : 1};
        const double start[] = {signs[0] * number(config, (double)x),
                                signs[1] * number(config, (double)a), 0};
        if (fp3_compiled_reference(compiled, NULL, start, 1, &one, 1, states, &error))
            fail(f->name, &error);
        const double truth = f->truth(start[0], start[1]);
        const double off =
            fabs(states[2] - truth) / (f->is_absolute ? 1 : unit(config, (float)truth));
        if (!(off <= worst))
            worst = off;
    }
    fp3_compiled_free(&compiled);
    fp3_model_free(&model);
    return worst;
}

int main(int argc, char **argv) {
    const fp3_config *config = fp3_config_find(argc > 1 ? argv[1] : "single_full");
    const size_t count = argc > 1 ? QUOTIENTS : sizeof functions / sizeof *functions;
    for (size_t i = 0; config && i < count; i++)
        printf("%-10s %.4g %s\n", functions[i].name, worst_of(&functions[i], config),
               functions[i].is_absolute ? "absolute" : "ulp");
    return !config;
}
