/* engine_promises.c - what fp3/engine.h promises about bad input and the ends of a run.
 *
 *     engine_promises [--only PROMISE]
 *
 * Each promise is checked for every kind of engine on every configuration.
 */
#include <configs.h>
#include <fp3/asm.h>
#include <fp3/engine.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

typedef struct {
    fp3_engine_def def;
    fp3_error error;
    fp3_engine *engine;
    uint32_t registers, program_words;
    int has_chain;
    const char *failed; /* the first expression that does not hold */
    int line;
} bench;

#define EXPECT(expression)                                                                         \
    do {                                                                                           \
        if (!(expression)) {                                                                       \
            b->failed = #expression;                                                               \
            b->line = __LINE__;                                                                    \
            return;                                                                                \
        }                                                                                          \
    } while (0)

#define SAYS(part) (strstr(b->error.text, part) != NULL)

static fp3_image *assemble(const char *source) {
    fp3_assembly *assembly = NULL;
    fp3_image *image = NULL;
    if (!fp3_assemble(source, strlen(source), "test", &assembly, NULL))
        fp3_image_make(assembly->image, &image, NULL);
    fp3_assembly_free(&assembly);
    return image;
}

static fp3_status load(bench *b, const char *source) {
    fp3_image *image = assemble(source);
    fp3_status status = image ? fp3_engine_load(b->engine, image)
                              : fp3_fail(&b->error, FP3_E_PROGRAM, "does not assemble");
    fp3_image_free(&image);
    return status;
}

/* x grows by 1 in each step, y is 100 afterwards. */
static const char counting[] = ".state x y\nstep:\nadd x, x, 1.0\nlast:\nadd y, -0.0, 100.0\n";

static void open_refuses_what_is_unknown(bench *b) {
    fp3_engine *engine = NULL;
    fp3_engine_def def = b->def;
    def.config = "nonesuch";
    EXPECT(fp3_engine_open(&def, &engine) == FP3_E_ARGUMENT && !engine);
    EXPECT(SAYS("nonesuch") && SAYS("single"));
    def = b->def;
    def.kind = "abacus";
    EXPECT(fp3_engine_open(&def, &engine) == FP3_E_ARGUMENT && !engine && SAYS("abacus"));
    memset(&def, 0, sizeof def);
    EXPECT(fp3_engine_open(&def, &engine) == FP3_E_ARGUMENT && !engine);
}

static void nothing_runs_before_a_load(bench *b) {
    float value;
    EXPECT(fp3_engine_run(b->engine, 1, NULL) == FP3_E_ARGUMENT && SAYS("no program"));
    EXPECT(fp3_engine_set(b->engine, "x", 1) == FP3_E_ARGUMENT && SAYS("no program"));
    EXPECT(fp3_engine_get(b->engine, 0, "x", &value) == FP3_E_ARGUMENT && SAYS("no program"));
}

static void registers_out_of_range_are_refused(bench *b) {
    const size_t objects = fp3_engine_objects(b->engine);
    float value = 1;
    EXPECT(fp3_engine_write(b->engine, 0, 1, b->registers, &value) == FP3_E_ARGUMENT &&
           SAYS("register"));
    EXPECT(fp3_engine_read(b->engine, 0, 1, UINT32_MAX, &value) == FP3_E_ARGUMENT &&
           SAYS("register"));
    EXPECT(fp3_engine_write(b->engine, objects, 1, 0, &value) == FP3_E_ARGUMENT && SAYS("object"));
    EXPECT(fp3_engine_read(b->engine, 0, objects + 1, 0, &value) == FP3_E_ARGUMENT &&
           SAYS("object"));
    EXPECT(fp3_engine_read(b->engine, SIZE_MAX, 2, 0, &value) == FP3_E_ARGUMENT);
    EXPECT(fp3_engine_write_shared(b->engine, b->registers, 1, &value) == FP3_E_ARGUMENT &&
           SAYS("shared"));
    EXPECT(fp3_engine_read_shared(b->engine, 0, b->registers + 1, &value) == FP3_E_ARGUMENT &&
           SAYS("shared"));
    EXPECT(value == 1);
}

static void registers_are_0_at_first(bench *b) {
    for (uint32_t reg = 0; reg < b->registers; reg++) {
        float values[2] = {1, 1};
        static const float zeros[2];
        EXPECT(!fp3_engine_read(b->engine, 0, 1, reg, &values[0]) &&
               !fp3_engine_read_shared(b->engine, reg, 1, &values[1]));
        EXPECT(memcmp(values, zeros, sizeof zeros) == 0);
    }
}

static void every_register_keeps_its_bits(bench *b) {
    for (uint32_t pass = 0; pass < 2; pass++)
        for (uint32_t reg = 0; reg < b->registers; reg++) {
            /* A signalling NaN, a subnormal number. */
            const uint32_t bits[2] = {0x7f800001u + reg, 0x80000000u + reg};
            uint32_t got[2];
            float values[2];
            memcpy(values, bits, sizeof values);
            if (pass == 0) {
                EXPECT(!fp3_engine_write(b->engine, 0, 1, reg, &values[0]));
                EXPECT(!fp3_engine_write_shared(b->engine, reg, 1, &values[1]));
            } else {
                EXPECT(!fp3_engine_read(b->engine, 0, 1, reg, &values[0]));
                EXPECT(!fp3_engine_read_shared(b->engine, reg, 1, &values[1]));
                memcpy(got, values, sizeof got);
                EXPECT(memcmp(got, bits, sizeof got) == 0);
            }
        }
}

static void load_refuses_what_does_not_fit(bench *b) {
    fp3_stats stats;
    float x;
    EXPECT(!load(b, counting));
    if (b->registers < 64) {
        char source[64];
        snprintf(source, sizeof source, "step:\nadd r%" PRIu32 ", r0, r0\n", b->registers);
        EXPECT(load(b, source) == FP3_E_PROGRAM && SAYS("object registers"));
        snprintf(source, sizeof source, "step:\nadd r0, k%" PRIu32 ", r0\n", b->registers);
        EXPECT(load(b, source) == FP3_E_PROGRAM && SAYS("shared constants"));
    }
    if (!b->has_chain)
        EXPECT(load(b, "step:\nadd r0, r0, r0\nmadd r0, r0, r0, r0\n") == FP3_E_PROGRAM &&
               SAYS("word 1"));
    const uint32_t words = b->program_words + 1;
    uint32_t *code = calloc(words, sizeof *code);
    fp3_image draft = {.code = code, .code_count = words, .step = 0, .last = words}, *image = NULL;
    const fp3_status made = fp3_image_make(&draft, &image, NULL);
    const fp3_status status = made ? made : fp3_engine_load(b->engine, image);
    fp3_image_free(&image);
    free(code);
    EXPECT(status == FP3_E_PROGRAM && SAYS("words"));
    /* ... and leaves what was there. */
    EXPECT(!fp3_engine_set(b->engine, "x", 0) && !fp3_engine_run(b->engine, 3, &stats));
    EXPECT(!fp3_engine_get(b->engine, 0, "x", &x) && x == 3);
}

static void names_are_those_of_the_program(bench *b) {
    float value;
    EXPECT(
        !load(b, ".state x\n.temp t\n.shared h\n.const c 2.5\nstep:\nadd t, h, c\nadd x, x, t\n"));
    EXPECT(fp3_engine_set(b->engine, "y", 1) == FP3_E_ARGUMENT && SAYS("'y'"));
    EXPECT(fp3_engine_set(b->engine, "t", 1) == FP3_E_ARGUMENT && SAYS("'t'"));
    EXPECT(fp3_engine_set(b->engine, "c", 1) == FP3_E_ARGUMENT && SAYS("'c'"));
    EXPECT(fp3_engine_get(b->engine, fp3_engine_objects(b->engine), "x", &value) ==
               FP3_E_ARGUMENT &&
           SAYS("object"));
    EXPECT(!fp3_engine_set(b->engine, "x", 1) && !fp3_engine_set(b->engine, "h", 4));
    EXPECT(!fp3_engine_run(b->engine, 1, NULL));
    for (size_t i = 0; i < fp3_engine_objects(b->engine); i++)
        EXPECT(!fp3_engine_get(b->engine, i, "x", &value) && value == 7.5f);
    EXPECT(!fp3_engine_get(b->engine, 0, "c", &value) && value == 2.5f);
}

static void an_illegal_word_ends_the_run_there(bench *b) {
    fp3_image *good = assemble(counting), *bad = NULL;
    uint32_t code[2];
    fp3_image draft = *good;
    code[0] = good->code[0];
    code[1] = 0xffffffffu;
    draft.code = code;
    fp3_status status = fp3_image_make(&draft, &bad, NULL);
    if (!status)
        status = fp3_engine_load(b->engine, bad);
    fp3_image_free(&good);
    fp3_image_free(&bad);
    EXPECT(!status);

    fp3_stats stats;
    float x, y;
    EXPECT(!fp3_engine_set(b->engine, "x", 10) && !fp3_engine_set(b->engine, "y", 20));
    EXPECT(fp3_engine_run(b->engine, 4, &stats) == FP3_E_PROGRAM);
    EXPECT(SAYS("word 1") && SAYS("0xffffffff"));
    EXPECT(!fp3_engine_get(b->engine, 0, "x", &x) && x == 14);
    EXPECT(!fp3_engine_get(b->engine, 0, "y", &y) && y == 20);
    EXPECT(stats.counter[FP3_COUNTER_RETIRED] == 4 * fp3_engine_objects(b->engine) &&
           stats.object_steps == 0);
    /* The engine is as good as before. */
    EXPECT(!load(b, counting) && !fp3_engine_run(b->engine, 1, NULL));
    EXPECT(!fp3_engine_get(b->engine, 0, "y", &y) && y == 100);
}

static void the_cycle_limit_stops_a_run(bench *b) {
    fp3_stats stats;
    float x, y;
    EXPECT(!load(b, counting) && !fp3_engine_set(b->engine, "x", 0) &&
           !fp3_engine_set(b->engine, "y", 0));
    EXPECT(fp3_engine_run(b->engine, UINT32_MAX, &stats) == FP3_E_LIMIT && SAYS("20000 cycles"));
    /* Some steps were made, and what was counted as retired is in the registers. */
    uint64_t retired = 0;
    for (size_t i = 0; i < fp3_engine_objects(b->engine); i++) {
        EXPECT(!fp3_engine_get(b->engine, i, "x", &x));
        retired += (uint64_t)x;
    }
    EXPECT(retired >= 100 && retired < 20100 && retired == stats.counter[FP3_COUNTER_RETIRED]);
    EXPECT(!fp3_engine_get(b->engine, 0, "y", &y) && y == 0);
    EXPECT(stats.counter[FP3_COUNTER_CYCLES] >= 20000 && stats.counter[FP3_COUNTER_CYCLES] < 20100);
    EXPECT(stats.object_steps == 0);
    EXPECT(!fp3_engine_run(b->engine, 1, &stats) &&
           stats.object_steps == fp3_engine_objects(b->engine));
}

static void no_steps_execute_nothing(bench *b) {
    fp3_stats stats;
    float x, y;
    EXPECT(!load(b, counting) && !fp3_engine_set(b->engine, "x", 5) &&
           !fp3_engine_set(b->engine, "y", 6));
    EXPECT(!fp3_engine_run(b->engine, 0, &stats));
    EXPECT(stats.counter[FP3_COUNTER_CYCLES] == 0 && stats.object_steps == 0);
    EXPECT(!fp3_engine_get(b->engine, 0, "x", &x) && x == 5 &&
           !fp3_engine_get(b->engine, 0, "y", &y) && y == 6);
    EXPECT(fp3_engine_run(b->engine, (uint64_t)UINT32_MAX + 1, &stats) == FP3_E_ARGUMENT &&
           SAYS("4294967296"));
}

static void flags_are_those_of_the_last_run(bench *b) {
    fp3_stats stats;
    EXPECT(!load(b, ".state x\nstep:\nmul x, x, x\n"));
    EXPECT(!fp3_engine_set(b->engine, "x", 3e38f) && !fp3_engine_run(b->engine, 1, &stats));
    EXPECT(stats.flags == (1u << FP3_FLAGS_OVERFLOW_LO | 1u << FP3_FLAGS_INEXACT_LO));
    EXPECT(!fp3_engine_set(b->engine, "x", 2) && !fp3_engine_run(b->engine, 1, &stats) &&
           stats.flags == 0);
}

static void the_bus_log_has_every_transfer(bench *b) {
    char path[] = "fp3-bus-log-XXXXXX", line[64];
    const int file = mkstemp(path);
    EXPECT(file >= 0);
    close(file);
    fp3_engine_def def = b->def;
    def.bus_log = path;
    fp3_engine *engine = NULL;
    fp3_status status = fp3_engine_open(&def, &engine);
    fp3_engine_close(&engine);
    FILE *in = fopen(path, "r");
    const char *read = in ? fgets(line, sizeof line, in) : NULL;
    if (in)
        fclose(in);
    remove(path);
    EXPECT(!status);
    if (strcmp(def.kind, "rtl") == 0)
        EXPECT(read && strncmp(line, "r 0000 465033", 13) == 0);
    def.bus_log = "/nonexistent/log";
    if (strcmp(def.kind, "rtl") == 0)
        EXPECT(fp3_engine_open(&def, &engine) == FP3_E_SYSTEM && SAYS("/nonexistent/log"));
}

#define PROMISES(X)                                                                                \
    X(open_refuses_what_is_unknown)                                                                \
    X(nothing_runs_before_a_load)                                                                  \
    X(registers_out_of_range_are_refused)                                                          \
    X(registers_are_0_at_first)                                                                    \
    X(every_register_keeps_its_bits)                                                               \
    X(load_refuses_what_does_not_fit)                                                              \
    X(names_are_those_of_the_program)                                                              \
    X(an_illegal_word_ends_the_run_there)                                                          \
    X(the_cycle_limit_stops_a_run)                                                                 \
    X(no_steps_execute_nothing)                                                                    \
    X(flags_are_those_of_the_last_run)                                                             \
    X(the_bus_log_has_every_transfer)

int main(int argc, char **argv) {
    static const struct {
        const char *name;
        void (*check)(bench *);
    } promises[] = {
#define X(name) {#name, name},
        PROMISES(X)
#undef X
    };
    static const struct {
        const char *name;
        uint32_t registers, program_words;
        int has_chain;
    } configs[] = {
#define X(name, doc, registers, contexts, program_words, bypass, writeback_stall, chain, ...)      \
    {#name, registers, program_words, chain},
        FP3_CONFIGS(X)
#undef X
    };
    static const char *const kinds[] = {"model", "rtl"};
    const char *only = argc == 3 && strcmp(argv[1], "--only") == 0 ? argv[2] : NULL;
    unsigned checked = 0, failed = 0;
    for (size_t p = 0; p < sizeof promises / sizeof *promises; p++)
        for (size_t c = 0; c < sizeof configs / sizeof *configs; c++)
            for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++) {
                bench b = {.registers = configs[c].registers,
                           .program_words = configs[c].program_words,
                           .has_chain = configs[c].has_chain};
                if (only && strcmp(only, promises[p].name) != 0)
                    continue;
                b.def = fp3_engine_default();
                b.def.kind = kinds[k];
                b.def.config = configs[c].name;
                b.def.cycle_limit = 20000;
                b.def.error = &b.error;
                if (fp3_engine_open(&b.def, &b.engine))
                    b.failed = "the engine opens";
                else
                    promises[p].check(&b);
                fp3_engine_close(&b.engine);
                checked++;
                failed += b.failed != NULL;
                if (b.failed)
                    printf("FAIL %s, %s, %s: line %d: expected %s\n  last message: '%s'\n  replay: "
                           "%s --only %s\n",
                           promises[p].name, kinds[k], configs[c].name, b.line, b.failed,
                           b.error.text, argv[0], promises[p].name);
            }
    printf("%u checked, %u failed\n", checked, failed);
    return failed || !checked;
}
