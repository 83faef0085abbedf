/* host.c - what the library computes, reads and writes for a host with an arithmetic and a locale
 * of its own.
 *
 *     host PROGRAM [up|down|cut|flush|locale]
 *
 * PROGRAM is a model with the params m and T. Prints bits and texts, which are the same for each
 * kind of host, and ends with 1 if the host has not its own arithmetic and locale afterwards.
 */
#include <fenv.h>
#include <fp3/batch.h>
#include <fp3/program.h>
#include <fp3/truth.h>
#include <inttypes.h>
#include <locale.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <xmmintrin.h>

#define OBJECTS 3
#define FLUSH 0x8040u /* results and operands */
#define CHECK(call)                                                                                \
    do {                                                                                           \
        if (call) {                                                                                \
            printf("line %d: %s\n", __LINE__, error.text);                                         \
            exit(1);                                                                               \
        }                                                                                          \
    } while (0)

static fp3_error error;

static void show(const char *what, const void *bytes, size_t size) {
    printf("%s", what);
    for (size_t i = 0; i < size; i++)
        printf(" %02x", ((const unsigned char *)bytes)[i]);
    printf("\n");
}

static void use_program(const char *path, const char *engine_name) {
    fp3_program_def how = fp3_program_default();
    fp3_program *program = NULL;
    fp3_params *params = NULL;
    fp3_engine *engine = NULL;
    fp3_engine_def def = fp3_engine_default();
    how.compile.config = def.config = "many_full";
    def.engine = engine_name;
    def.objects = OBJECTS;
    def.is_interpreted = 1;
    def.error = &error;
    CHECK(fp3_program_open(path, &how, &program, NULL, &error));
    CHECK(fp3_params_make(&params, &error));
    CHECK(fp3_params_set(params, "T=1/3+0.1", &error));
    CHECK(fp3_params_spread(params, "m=0.1:0.7", &error));
    float values[64];
    int is_spread;
    for (int i = 0; i < OBJECTS; i++) {
        CHECK(fp3_program_inputs(program, params, i / 2.0, values, &is_spread, &error));
        show("inputs", values, program->compiled->input_count * sizeof *values);
    }
    CHECK(fp3_engine_open(&def, &engine));
    CHECK(fp3_program_load(program, params, engine, &error));
    CHECK(fp3_engine_run(engine, 50, NULL));
    CHECK(fp3_engine_read(engine, 0, OBJECTS, 0, values));
    show(engine_name, values, OBJECTS * sizeof *values);
    char *text = NULL;
    fp3_params *one = NULL;
    CHECK(fp3_params_make(&one, &error) || fp3_params_set(one, "m=0.1", &error));
    CHECK(fp3_program_values_text(program, one, &text, &error));
    printf("%s", text);
    free(text);
    fp3_params_free(&one);
    fp3_params_set(params, "T=1.5.5", &error);
    printf("%s\n", error.text);
    double truth[8] = {0};
    const fp3_model *model = program->model;
    double given[8], initial[8];
    for (uint32_t i = 0; i < model->param_count; i++)
        given[i] = model->params[i].value;
    for (uint32_t i = 0; i < model->state_count; i++)
        initial[i] = model->states[i].value;
    CHECK(fp3_model_truth(model, given, initial, 1.5, truth, &error));
    show("truth", truth, model->state_count * sizeof *truth);
    fp3_engine_close(&engine);
    fp3_params_free(&params);
    fp3_program_close(&program);
}

/* Of numbers that FP32 rounds, and of one that flushing would make 0. */
static void use_batch(void) {
    static const char model[] =
        "param k = 0.3\nparam s = 1\nstate v = 0.7\nstep 0.1\nv' = -k*v/s\n";
    const double k[OBJECTS] = {1.0 / 3, 0.1, 1e-40};
    fp3_batch_def def = fp3_batch_default();
    fp3_batch *batch = NULL;
    double v[OBJECTS] = {0};
    def.text = model;
    def.text_size = sizeof model - 1;
    def.objects = OBJECTS;
    def.error = &error;
    CHECK(fp3_batch_open(&def, &batch));
    CHECK(fp3_batch_write_double(batch, "k", 0, OBJECTS, k));
    CHECK(fp3_batch_set(batch, "s", 0.7) || fp3_batch_run(batch, 10));
    CHECK(fp3_batch_read_double(batch, (const char *[]){"k"}, 1, 0, OBJECTS, (double *[]){v}));
    show("k", v, sizeof v);
    CHECK(fp3_batch_read_double(batch, (const char *[]){"v"}, 1, 0, OBJECTS, (double *[]){v}));
    show("v", v, sizeof v);
    fp3_batch_close(&batch);
}

static int become(const char *host) {
    const struct {
        const char *name;
        int rounding;
    } roundings[] = {{"up", FE_UPWARD}, {"down", FE_DOWNWARD}, {"cut", FE_TOWARDZERO}};
    for (size_t i = 0; i < sizeof roundings / sizeof *roundings; i++)
        if (!strcmp(host, roundings[i].name))
            return fesetround(roundings[i].rounding) == 0;
    if (!strcmp(host, "flush"))
        _mm_setcsr(_mm_getcsr() | FLUSH);
    return strcmp(host, "locale") != 0 || setlocale(LC_ALL, "de_DE.UTF-8") != NULL;
}

int main(int argc, char **argv) {
    const char *host = argc > 2 ? argv[2] : "";
    if (argc < 2 || !become(host)) {
        printf("no such host\n");
        return 1;
    }
    const int rounding = fegetround();
    const unsigned flushing = _mm_getcsr() & FLUSH;
    char point[8];
    snprintf(point, sizeof point, "%.1f", 0.5);
    use_program(argv[1], "isa");
    use_program(argv[1], "fast");
    use_batch();
    char after[8];
    snprintf(after, sizeof after, "%.1f", 0.5);
    return rounding != fegetround() || flushing != (_mm_getcsr() & FLUSH) ||
           strcmp(point, after) != 0 || (!strcmp(host, "locale") && strcmp(point, "0,5") != 0);
}
