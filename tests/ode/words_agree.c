/* words_agree - models on all engines of a configuration: whether all words agree, and how far they
 * are off.
 *
 *     words_agree CONFIG INTEGRATOR STEPS FILE...
 *
 * Prints a line for each model: its name, the words that were compared, how many differ, and the
 * largest rounding error: the distance from the same method in double, relative to the largest
 * state of the object; or its name, "refused" and why. What the compiler's reference makes of it
 * counts as an engine, with the states as floats. The hardware takes the first 20 steps: it is
 * slow.
 */
#include "engine/common/inside.h"
#include "lab/bench/variants.h"

#include <fp3/truth.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { OBJECTS = 3, ROOM = 64, HARDWARE = 20 };
static const char *const engines[] = {"isa", "fast", "rtl"};

typedef struct {
    fp3_model *model;
    fp3_integrator *integrator;
    fp3_compiled *compiled;
    fp3_engine *engine[3];
    const char *config;
    uint64_t steps;
    uint64_t words, differing;
    double error;
} bench;

static void need(fp3_status status, const fp3_error *error) {
    if (!status)
        return;
    fprintf(stderr, "words_agree: %s\n", error->text);
    exit(1);
}

static void begin(bench *b, unsigned e) {
    fp3_error error = {0};
    fp3_engine_def def = fp3_engine_default();
    def.engine = engines[e];
    def.config = b->config;
    def.objects = OBJECTS;
    def.is_interpreted = 1;
    def.error = &error;
    need(fp3_engine_open(&def, &b->engine[e]), &error);
    need(fp3_bench_start(b->engine[e], b->compiled, b->model, b->model->step, OBJECTS, &error),
         &error);
}

/* A state of all objects, in words. */
static void compare_state(bench *b, unsigned how_many, uint32_t reg) {
    uint32_t word[3][OBJECTS];
    for (unsigned e = 0; e < how_many; e++)
        if (fp3_engine_read_words(b->engine[e], 0, OBJECTS, reg, word[e]))
            abort();
    for (unsigned e = 1; e < how_many; e++)
        b->differing += memcmp(word[e], word[0], sizeof word[0]) != 0;
    b->words += OBJECTS;
}

/* The first engines go on, and agree. */
static void run(bench *b, unsigned how_many, uint64_t steps) {
    const fp3_image *image = b->compiled->image;
    fp3_error error = {0};
    for (unsigned e = 0; e < how_many; e++)
        need(fp3_engine_run(b->engine[e], steps, NULL), &error);
    for (uint32_t i = 0; i < image->symbol_count; i++)
        if (image->symbols[i].symbol_class == FP3_SYMBOL_STATE)
            compare_state(b, how_many, image->symbols[i].index);
}

/* Against the reference, and the same method in double. */
static void compare_object(bench *b, size_t object) {
    double params[ROOM + 1], initial[ROOM + 1], exact[ROOM + 1], size = 0;
    float wanted[ROOM + 1];
    fp3_error error = {0};
    const fp3_model *m = b->model;
    fp3_bench_variant(m, object, params, initial);
    need(
        fp3_compiled_reference(b->compiled, params, initial, m->step, &b->steps, 1, wanted, &error),
        &error);
    need(fp3_compiled_exact(b->compiled, params, initial, m->step, &b->steps, 1, exact, &error),
         &error);
    for (uint32_t s = 0; s < m->state_count; s++)
        size = fmax(size, fabs(exact[s]));
    for (uint32_t s = 0; s < m->state_count; s++) {
        float got = 0;
        if (fp3_engine_get(b->engine[0], object, m->states[s].name, &got))
            abort();
        b->differing += memcmp(&got, &wanted[s], sizeof got) != 0;
        b->error = fmax(b->error, fabs((double)got - exact[s]) / size);
    }
}

static void run_model(bench *b, const char *path) {
    fp3_error error = {0};
    fp3_compile_def def = fp3_compile_default();
    char *report = NULL;
    def.config = b->config;
    need(fp3_model_load(path, &b->model, &report, &error), &error);
    b->words = b->differing = 0;
    b->error = 0;
    if (fp3_compile(b->model, b->integrator, &def, &b->compiled, &error)) {
        printf("%s refused %s\n", b->model->name, error.text);
    } else {
        const uint64_t first = b->steps < HARDWARE ? b->steps : HARDWARE;
        for (unsigned e = 0; e < 3; e++)
            begin(b, e);
        run(b, 3, first);
        if (b->steps > first)
            run(b, 2, b->steps - first);
        for (size_t object = 0; object < OBJECTS; object++)
            compare_object(b, object);
        printf("%s %" PRIu64 " words %" PRIu64 " differ %.3g\n", b->model->name, b->words,
               b->differing, b->error);
    }
    for (unsigned e = 0; e < 3; e++)
        fp3_engine_close(&b->engine[e]);
    fp3_compiled_free(&b->compiled);
    fp3_model_free(&b->model);
    free(report);
}

int main(int argc, char **argv) {
    fp3_error error = {0};
    bench b = {0};
    if (argc < 5) {
        fprintf(stderr, "usage: words_agree CONFIG INTEGRATOR STEPS FILE...\n");
        return 2;
    }
    b.config = argv[1];
    b.steps = strtoull(argv[3], NULL, 10);
    need(fp3_integrator_find(argv[2], &b.integrator, &error), &error);
    for (int i = 4; i < argc; i++)
        run_model(&b, argv[i]);
    fp3_integrator_free(&b.integrator);
    return 0;
}
