/* engine_promises.c - what fp3/engine.h promises about bad input and the ends of a run.
 *
 *     engine_promises [--only PROMISE] [--engine ENGINE]
 *
 * Each promise is checked for every engine on every configuration that it is about.
 */
#include "gen/registers.h"
#include <engine/common/inside.h>
#include <fp3/image.h>
#include <fp3/isa.h>
#include <inttypes.h>
#include <machine/config.h>
#include <machine/format.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

typedef struct {
    fp3_engine_def def;
    fp3_error error;
    fp3_engine *engine;
    const fp3_config *config;
    uint32_t registers;
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

/* The engine, opened anew with what b->def says now. */
static fp3_status reopen(bench *b) {
    fp3_engine_close(&b->engine);
    return fp3_engine_open(&b->def, &b->engine);
}

/* The same; where words are no floats, sums of small numbers are off by a few units in the last
 * place. */
static int is_nearly(const bench *b, float value, float expected) {
    return value == expected || (!fp3_format_is_float(b->config) &&
                                 fabsf(value - expected) <= 4e-6f * fmaxf(1, fabsf(expected)));
}

/* How many objects have a register with this value. */
static size_t count_of(bench *b, size_t first, size_t count, const char *name, float expected) {
    size_t found = 0;
    for (size_t i = first; i < first + count; i++) {
        float value;
        found += !fp3_engine_get(b->engine, i, name, &value) && is_nearly(b, value, expected);
    }
    return found;
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
    def.engine = "abacus";
    EXPECT(fp3_engine_open(&def, &engine) == FP3_E_ARGUMENT && !engine && SAYS("abacus"));
    def = b->def;
    def.objects = UINT32_MAX;
    EXPECT(fp3_engine_open(&def, &engine) == FP3_E_ARGUMENT && !engine && SAYS("has room for"));
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
    static const float zero;
    float value = 1;
    fp3_object_status status;
    for (size_t object = 0; object < fp3_engine_objects(b->engine); object++) {
        for (uint32_t reg = 0; reg < b->registers; reg++)
            EXPECT(!fp3_engine_read(b->engine, object, 1, reg, &value) &&
                   memcmp(&value, &zero, sizeof zero) == 0);
        EXPECT(!fp3_engine_status(b->engine, object, 1, &status));
        EXPECT(status.flags == 0 && status.failed == 0 && status.slept == 0);
    }
    for (uint32_t reg = 0; reg < b->registers; reg++)
        EXPECT(!fp3_engine_read_shared(b->engine, reg, 1, &value) &&
               memcmp(&value, &zero, sizeof zero) == 0);
}

static void every_register_keeps_its_bits(bench *b) {
    for (uint32_t pass = 0; pass < 2; pass++)
        for (uint32_t reg = 0; reg < b->registers; reg++) {
            /* A signalling NaN, a subnormal number. */
            const uint32_t bits[2] = {0x7f800001u + reg, 0x80000000u + reg};
            uint32_t got[2];
            if (pass == 0) {
                EXPECT(!fp3_engine_write_words(b->engine, 0, 1, reg, &bits[0]));
                EXPECT(!fp3_engine_write_shared_words(b->engine, 0, reg, 1, &bits[1]));
            } else {
                EXPECT(!fp3_engine_read_words(b->engine, 0, 1, reg, &got[0]));
                EXPECT(!fp3_engine_read_shared_words(b->engine, 0, reg, 1, &got[1]));
                EXPECT(memcmp(got, bits, sizeof got) == 0);
            }
        }
}

/* So many times r0 = r0 + r1. */
static fp3_status load_sums(bench *b, uint32_t words) {
    uint32_t *code = calloc(words, sizeof *code);
    fp3_image draft = {.code = code, .code_count = words, .step = 0, .last = words}, *image = NULL;
    for (uint32_t i = 0; i < words; i++)
        code[i] = fp3_word_encode(&(fp3_instruction){.op = FP3_OP_ADD, .b = 1});
    fp3_status status = fp3_image_make(&draft, &image, NULL);
    if (!status)
        status = fp3_engine_load(b->engine, image);
    fp3_image_free(&image);
    free(code);
    return status;
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
    if (!b->config->chain)
        EXPECT(load(b, "step:\nadd r0, r0, r0\nmadd r0, r0, r0, r0\n") == FP3_E_PROGRAM &&
               SAYS("word 1 is a chained"));
    if (!b->config->sleep)
        EXPECT(load(b, "step:\nadd r0, r0, r0\nsleep r1, r0, r0\n") == FP3_E_PROGRAM &&
               SAYS("word 1 is an instruction for objects that sleep"));
    if (!b->config->interleave)
        EXPECT(load(b, "step:\nadd r0, r0, r0\nst r0\n") == FP3_E_PROGRAM &&
               SAYS("word 1 is an access to an object store"));
    if (strcmp(b->def.engine, "rtl")) /* words are in the host's memory */
        return;
    const uint32_t words = b->config->program_words + 1;
    uint32_t *code = calloc(words, sizeof *code);
    fp3_image draft = {.code = code, .code_count = words, .step = 0, .last = words}, *image = NULL;
    const fp3_status made = fp3_image_make(&draft, &image, NULL);
    const fp3_status status = made ? made : fp3_engine_load(b->engine, image);
    fp3_image_free(&image);
    free(code);
    EXPECT(status == FP3_E_PROGRAM && SAYS("words"));
    if (b->config->interleave)
        EXPECT(load_sums(b, b->config->program_words) == FP3_E_PROGRAM && SAYS("with its loads"));
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

/* counting with another word in place of its last. */
static fp3_status load_with(bench *b, uint32_t word) {
    fp3_image *good = assemble(counting), *bad = NULL;
    uint32_t code[2];
    fp3_image draft = *good;
    code[0] = good->code[0];
    code[1] = word;
    draft.code = code;
    fp3_status status = fp3_image_make(&draft, &bad, &b->error);
    if (!status)
        status = fp3_engine_load(b->engine, bad);
    fp3_image_free(&good);
    fp3_image_free(&bad);
    return status;
}

static void an_illegal_word_ends_the_run_there(bench *b) {
    EXPECT(!load_with(b, 0xffffffffu));
    fp3_stats stats;
    float x, y;
    EXPECT(!fp3_engine_set(b->engine, "x", 10) && !fp3_engine_set(b->engine, "y", 20));
    EXPECT(fp3_engine_run(b->engine, 4, &stats) == FP3_E_PROGRAM);
    EXPECT(SAYS("word 1") && SAYS("0xffffffff"));
    /* Interleaved, no visit came to its end. */
    EXPECT(!fp3_engine_get(b->engine, 0, "x", &x) && x == (b->config->interleave ? 10 : 14));
    EXPECT(!fp3_engine_get(b->engine, 0, "y", &y) && y == 20);
    EXPECT(b->config->interleave || stats.counter[FP3_COUNTER_RETIRED] == 4);
    EXPECT(stats.object_steps == 0);
    /* The engine is as good as before. */
    EXPECT(!load(b, counting) && !fp3_engine_run(b->engine, 1, NULL));
    EXPECT(!fp3_engine_get(b->engine, 0, "y", &y) && y == 100);
}

static void what_fast_cannot_execute_changes_nothing(bench *b) {
    float x;
    EXPECT(load_with(b, 0xffffffffu) == FP3_E_PROGRAM && SAYS("word 1 is no instruction"));
    EXPECT(fp3_engine_run(b->engine, 1, NULL) == FP3_E_ARGUMENT && SAYS("no program"));
    EXPECT(!load(b, counting) && !fp3_engine_set(b->engine, "x", 10));
    EXPECT(!fp3_engine_run(b->engine, 2, NULL));
    EXPECT(load_with(b, 0xffffffffu) == FP3_E_PROGRAM && SAYS("word 1 is no instruction"));
    EXPECT(!fp3_engine_run(b->engine, 3, NULL));
    EXPECT(!fp3_engine_get(b->engine, 0, "x", &x) && x == 15);
}

static void the_cycle_limit_stops_a_run(bench *b) {
    fp3_stats stats;
    float x, y;
    b->def.visit = 1; /* interleaved, x counts the visits that came to their end */
    EXPECT(!reopen(b));
    EXPECT(!load(b, counting) && !fp3_engine_set(b->engine, "x", 0) &&
           !fp3_engine_set(b->engine, "y", 0));
    EXPECT(fp3_engine_run(b->engine, UINT32_MAX, &stats) == FP3_E_LIMIT && SAYS("20000 cycles"));
    uint64_t steps = 0;
    for (size_t i = 0; i < fp3_engine_objects(b->engine); i++) {
        EXPECT(!fp3_engine_get(b->engine, i, "x", &x));
        EXPECT(!fp3_engine_get(b->engine, i, "y", &y));
        EXPECT(y == (b->config->interleave && x > 0 ? 100 : 0));
        steps += (uint64_t)x;
    }
    EXPECT(steps >= 100 && steps < 20100 * b->config->lanes * fp3_config_schedulers(b->config));
    EXPECT(b->config->interleave || steps == stats.counter[FP3_COUNTER_RETIRED]);
    EXPECT(stats.counter[FP3_COUNTER_CYCLES] >= 20000 && stats.counter[FP3_COUNTER_CYCLES] < 20400);
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
    EXPECT(stats.flags == (FP3_FLAG_OVERFLOW | FP3_FLAG_INEXACT));
    EXPECT(!fp3_engine_set(b->engine, "x", 2) && !fp3_engine_run(b->engine, 1, &stats) &&
           stats.flags == 0);
}

/* Whatever earlier runs raised, and however their registers came about. */
static void failures_are_those_of_the_last_run(bench *b) {
    const size_t objects = fp3_engine_objects(b->engine);
    char text[FP3_FAILURE_TEXT_SIZE];
    fp3_failure f;
    float x = 1;
    EXPECT(!load(b, ".state x y\n.param a\nstep:\nmul x, x, a\nlast:\nadd y, x, x\n"));
    EXPECT(fp3_engine_failure(b->engine, 0, 1, &f) == FP3_E_ARGUMENT && SAYS("no complete run"));
    EXPECT(!fp3_engine_set(b->engine, "x", 1) && !fp3_engine_set(b->engine, "a", 0x1p50f));
    EXPECT(!fp3_engine_run(b->engine, 2, NULL));
    EXPECT(!fp3_engine_failure(b->engine, 0, objects, &f) && f.failed == 0 && f.step == 0);
    /* From where the last run ended. */
    EXPECT(!fp3_engine_run(b->engine, 2, NULL));
    EXPECT(!fp3_engine_failure(b->engine, 0, objects, &f) && f.failed == objects && f.object == 0);
    EXPECT(f.step == 3 && !f.is_before && f.flags == FP3_FLAG_OVERFLOW);
    fp3_engine_failure_text(b->engine, &f, text);
    EXPECT(strcmp(text, "object 0 in step 3: overflow") == 0);
    /* Infinity, or the largest number, goes on, and that is said, too. */
    EXPECT(!fp3_engine_run(b->engine, 2, NULL) && !fp3_engine_failure(b->engine, 0, 1, &f));
    EXPECT(f.is_before && f.flags == 0 && f.state == 0 && !(f.value <= 3e38f));
    fp3_engine_failure_text(b->engine, &f, text);
    EXPECT(strcmp(text, b->config->finite
                            ? "object 0 before its first step: state x is 2^128 or more"
                            : "object 0 before its first step: state x is infinite") == 0);
    /* A state that is only stored is infinite, and this run leaves it so. */
    EXPECT(!fp3_engine_set(b->engine, "x", 0x1p127f) && !fp3_engine_set(b->engine, "a", 1));
    EXPECT(!fp3_engine_run(b->engine, 1, NULL) && !fp3_engine_run(b->engine, 0, NULL));
    EXPECT(!fp3_engine_failure(b->engine, 0, objects, &f) && f.failed == objects);
    EXPECT(f.is_before && f.flags == 0 && f.state == 1 && f.value > 3e38f);
    /* One object alone is well again: that is of the next run. */
    EXPECT(!fp3_engine_set(b->engine, "x", INFINITY) && !fp3_engine_set(b->engine, "y", 0));
    EXPECT(!fp3_engine_write(b->engine, objects - 1, 1, 0, &x));
    EXPECT(fp3_engine_failure(b->engine, 0, 1, &f) == FP3_E_ARGUMENT);
    EXPECT(!fp3_engine_run(b->engine, 1, NULL));
    EXPECT(!fp3_engine_failure(b->engine, objects - 1, 1, &f) && f.failed == 0);
    EXPECT(!fp3_engine_failure(b->engine, 0, objects, &f) && f.failed == objects - 1);
    EXPECT(fp3_engine_failure(b->engine, 1, objects, &f) == FP3_E_ARGUMENT && SAYS("object 1"));
    /* A constant that was written between two runs counts. */
    EXPECT(!load(b, ".state x\n.shared k\nstep:\nmul x, x, k\n"));
    EXPECT(!fp3_engine_set(b->engine, "x", 1) && !fp3_engine_set(b->engine, "k", 2));
    EXPECT(!fp3_engine_run(b->engine, 5, NULL) && !fp3_engine_set(b->engine, "k", 0x1p100f));
    EXPECT(!fp3_engine_run(b->engine, 5, NULL) && !fp3_engine_failure(b->engine, 0, 1, &f));
    EXPECT(f.failed == 1 && f.step == 7);
}

static void the_bus_log_has_every_transfer(bench *b) {
    char path[] = "fp3-bus-log-XXXXXX", line[64];
    const int file = mkstemp(path);
    EXPECT(file >= 0);
    close(file);
    b->def.bus_log = path;
    const fp3_status status = reopen(b);
    if (strcmp(b->def.engine, "rtl") == 0) {
        const fp3_status run = status || load(b, counting) || fp3_engine_run(b->engine, 1, NULL);
        FILE *in = fopen(path, "r");
        const char *read = in ? fgets(line, sizeof line, in) : NULL;
        if (in)
            fclose(in);
        b->def.bus_log = "/nonexistent/log";
        EXPECT(!run && read && strncmp(line, "r 00000000 465033", 17) == 0);
        EXPECT(reopen(b) == FP3_E_ARGUMENT && SAYS("/nonexistent/log"));
    } else {
        EXPECT(status == FP3_E_ARGUMENT && SAYS("has no bus"));
        b->def.bus_log = NULL;
        b->def.bus_waits = 1;
        EXPECT(reopen(b) == FP3_E_ARGUMENT && SAYS("bus_waits: engine"));
        b->def.bus_waits = 0;
    }
    remove(path);
}

/* ---- many objects ---- */

static void set_each(bench *b, uint32_t reg, float first, float more) {
    for (size_t i = 0; i < fp3_engine_objects(b->engine); i++) {
        const float value = first + more * (float)i;
        EXPECT(!fp3_engine_write(b->engine, i, 1, reg, &value));
    }
}

static void any_number_of_objects_is_moved(bench *b) {
    const uint32_t full = b->config->contexts * b->config->lanes * fp3_config_schedulers(b->config);
    const uint32_t counts[] = {1, 3, full - 1, full + 1, full + full / 3};
    for (size_t i = 0; i < sizeof counts / sizeof *counts && !b->failed; i++)
        for (uint32_t visit = 0; visit < 3 && !b->failed; visit++) {
            fp3_stats stats;
            b->def.objects = counts[i];
            b->def.visit = visit;
            EXPECT(!reopen(b) && fp3_engine_objects(b->engine) == counts[i]);
            EXPECT(!load(b, ".state x y\nstep:\nadd x, x, 1.0\nlast:\nadd y, x, x\n"));
            set_each(b, 0, 0, 1);
            EXPECT(!fp3_engine_run(b->engine, 5, &stats));
            EXPECT(stats.object_steps == 5u * counts[i]);
            for (uint32_t object = 0; object < counts[i]; object++)
                EXPECT(count_of(b, object, 1, "x", (float)object + 5) == 1 &&
                       count_of(b, object, 1, "y", 2 * ((float)object + 5)) == 1);
        }
}

static void more_objects_leave_room_for_fewer_registers(bench *b) {
    float value = 1;
    b->def.objects =
        b->config->store_words / 8 * b->config->lanes * fp3_config_schedulers(b->config);
    EXPECT(!reopen(b));
    EXPECT(fp3_engine_write(b->engine, 0, 1, 15, &value) == FP3_E_ARGUMENT &&
           SAYS("registers of each of"));
    EXPECT(load(b, "step:\nadd r9, r9, r9\n") == FP3_E_PROGRAM &&
           SAYS("16 words of the object store for each object") && SAYS("has room for"));
    EXPECT(!load(b, "step:\nadd r3, r3, 1.0\n"));
    const size_t last = b->def.objects - 1;
    EXPECT(!fp3_engine_write(b->engine, last, 1, 3, &value));
    EXPECT(!fp3_engine_read(b->engine, last, 1, 3, &value) && value == 1);
    b->def.objects++;
    EXPECT(reopen(b) == FP3_E_ARGUMENT && SAYS("has room for"));
}

static void the_counters_of_units_add_up(bench *b) {
    fp3_stats stats;
    uint64_t counter[FP3_COUNTER_COUNT], retired = 0, longest = 0;
    EXPECT(!load(b, counting) && !fp3_engine_run(b->engine, 3, &stats) && stats.schedulers > 0);
    for (uint32_t scheduler = 0; scheduler < stats.schedulers; scheduler++) {
        EXPECT(!fp3_engine_scheduler_counters(b->engine, scheduler, counter));
        retired += counter[FP3_COUNTER_RETIRED];
        if (counter[FP3_COUNTER_CYCLES] > longest)
            longest = counter[FP3_COUNTER_CYCLES];
    }
    EXPECT(retired > 0 && retired == stats.counter[FP3_COUNTER_RETIRED]);
    EXPECT(longest == stats.counter[FP3_COUNTER_CYCLES]);
    EXPECT(fp3_engine_scheduler_counters(b->engine, fp3_config_schedulers(b->config), counter) ==
           FP3_E_ARGUMENT);
}

/* x counts to goal and sleeps there; y follows in the last part, also of who falls asleep. */
static const char sleeper[] = ".state x y slept\n.param goal\n.temp d\n"
                              "step:\nadd x, x, 1.0\nsub d, goal, x\nsleep slept, d, 0.5\n"
                              "add x, x, 0.25\nlast:\nadd y, x, 100.0\n";

static uint32_t slept_of(bench *b, size_t object) {
    fp3_object_status status = {0};
    const fp3_status result = fp3_engine_status(b->engine, object, 1, &status);
    return result ? 12345 : status.slept;
}

/* Object i of the sleeper after this many steps; it sleeps in step i + 1. */
static void expect_sleeper(bench *b, size_t object, uint32_t steps) {
    const int sleeps = object < steps;
    const float x = sleeps ? (float)object + 1 + 0.25f * (float)object : 1.25f * (float)steps;
    EXPECT(count_of(b, object, 1, "x", x) == 1 && count_of(b, object, 1, "y", x + 100) == 1);
    EXPECT(slept_of(b, object) == (sleeps ? object + 1 : 0));
}

static void objects_sleep_when_they_say_so(bench *b) {
    for (b->def.visit = 0; b->def.visit < 4 && !b->failed; b->def.visit++) {
        fp3_stats stats;
        EXPECT(!reopen(b) && !load(b, sleeper));
        const size_t n = fp3_engine_objects(b->engine);
        EXPECT(n > 8);
        set_each(b, 3, 1, 1.25f);
        EXPECT(!fp3_engine_run(b->engine, 5, &stats));
        EXPECT(stats.object_steps == 1 + 2 + 3 + 4 + 5 * (n - 4));
        for (size_t i = 0; i < n && !b->failed; i++)
            expect_sleeper(b, i, 5);
        EXPECT(!fp3_engine_run(b->engine, 3, &stats));
        EXPECT(stats.object_steps == 1 + 2 + 3 + 3 * (n - 8));
        for (size_t i = 0; i < n && !b->failed; i++)
            expect_sleeper(b, i, 8);
    }
}

/* Nothing in the hardware remembers a run: not even which scheduler was granted a shared unit last.
 * Object 0 alone gives the first scheduler the last grants. */
static void a_repeated_run_takes_the_same_cycles(bench *b) {
    enum { SCHEDULERS = 8 };
    uint64_t first[SCHEDULERS][FP3_COUNTER_COUNT], again[FP3_COUNTER_COUNT];
    fp3_stats stats;
    EXPECT(!load(b, sleeper) && fp3_config_schedulers(b->config) <= SCHEDULERS);
    const size_t n = fp3_engine_objects(b->engine);
    set_each(b, 3, 5e4f, 0);
    EXPECT(!fp3_engine_run(b->engine, 3, &stats));
    for (uint32_t s = 0; s < stats.schedulers; s++)
        EXPECT(!fp3_engine_scheduler_counters(b->engine, s, first[s]));
    EXPECT(!fp3_engine_remove(b->engine, 1, n - 1) && !fp3_engine_run(b->engine, 1, &stats) &&
           !fp3_engine_wake(b->engine, 1, n - 1) && !fp3_engine_run(b->engine, 3, &stats));
    for (uint32_t s = 0; s < stats.schedulers; s++)
        EXPECT(!fp3_engine_scheduler_counters(b->engine, s, again) &&
               memcmp(first[s], again, sizeof again) == 0);
}

/* The fetch leaves out the steps that nobody is awake for. */
static void a_visit_ends_when_all_sleep(bench *b) {
    fp3_stats stats;
    EXPECT(!load(b, sleeper));
    set_each(b, 3, 1, 0);
    EXPECT(!fp3_engine_run(b->engine, 1000, &stats));
    EXPECT(stats.object_steps == fp3_engine_objects(b->engine));
    EXPECT(stats.counter[FP3_COUNTER_CYCLES] < 1000 + 10 * fp3_engine_objects(b->engine));
}

static void objects_are_woken_and_removed(bench *b) {
    fp3_stats stats;
    EXPECT(!load(b, sleeper));
    const size_t n = fp3_engine_objects(b->engine);
    set_each(b, 3, 1, 0);
    EXPECT(!fp3_engine_remove(b->engine, 2, 3) && slept_of(b, 2) == FP3_REMOVED);
    EXPECT(!fp3_engine_run(b->engine, 2, &stats) && stats.object_steps == n - 3);
    EXPECT(count_of(b, 2, 3, "x", 0) == 3 && count_of(b, 2, 3, "y", 0) == 3);
    EXPECT(count_of(b, 0, n, "x", 1) == n - 3 && slept_of(b, 0) == 1);
    /* All asleep: nothing to do. */
    EXPECT(!fp3_engine_run(b->engine, 1000000, &stats) && stats.object_steps == 0);
    EXPECT(stats.counter[FP3_COUNTER_CYCLES] < 100);
    set_each(b, 3, 2, 0);
    EXPECT(!fp3_engine_wake(b->engine, 1, 3) && slept_of(b, 1) == 0);
    EXPECT(!fp3_engine_run(b->engine, 2, &stats));
    /* 1 is at 1 and sleeps at once; 2 and 3 would reach 2 in their second step, but for 0.25. */
    EXPECT(count_of(b, 1, 1, "x", 2) == 1 && slept_of(b, 1) == 1000003);
    EXPECT(count_of(b, 2, 2, "x", 2.25f) == 2 && slept_of(b, 3) == 1000004);
    EXPECT(count_of(b, 4, 1, "x", 0) == 1 && stats.object_steps == 1 + 2 * 2);
    /* The sleep register is a register. */
    const float awake = 0;
    EXPECT(!fp3_engine_write(b->engine, 4, 1, 2, &awake));
    EXPECT(!fp3_engine_run(b->engine, 1, &stats) && stats.object_steps == 1 &&
           count_of(b, 4, 1, "x", 1.25f) == 1);
}

static void only_programs_with_a_sleep_have_sleepers(bench *b) {
    EXPECT(fp3_engine_wake(b->engine, 0, 1) == FP3_E_ARGUMENT && SAYS("no program"));
    EXPECT(!load(b, counting));
    EXPECT(fp3_engine_wake(b->engine, 0, 1) == FP3_E_PROGRAM && SAYS("no sleep"));
    EXPECT(fp3_engine_remove(b->engine, 0, 1) == FP3_E_PROGRAM && SAYS("no sleep"));
    fp3_object_status status = {1, 1, 1};
    EXPECT(!fp3_engine_status(b->engine, 0, 1, &status) && status.slept == 0);
    const size_t n = fp3_engine_objects(b->engine);
    EXPECT(fp3_engine_status(b->engine, n, 1, &status) == FP3_E_ARGUMENT && SAYS("object"));
    if (!b->config->status)
        EXPECT(fp3_engine_clear_status(b->engine, 0, 1) == FP3_E_ARGUMENT && SAYS("no status"));
}

/* Object i overflows in step i + 2, for i below 4. */
static void an_object_knows_when_it_failed(bench *b) {
    fp3_stats stats;
    fp3_object_status status[5];
    EXPECT(!load(b, ".state x\nstep:\nmul x, x, 2.0\nlast:\nadd x, x, 0.0\n"));
    const int is_finite = b->config->finite != 0; /* twice as far */
    for (size_t i = 0; i < 5; i++) {
        const float first = i < 4 ? ldexpf(1, 126 - (int)i + is_finite) : 1;
        EXPECT(!fp3_engine_write(b->engine, i, 1, 0, &first));
    }
    EXPECT(!fp3_engine_run(b->engine, 1, &stats) && stats.flags == 0);
    EXPECT(!fp3_engine_run(b->engine, 3, &stats) && stats.flags != 0);
    EXPECT(!fp3_engine_status(b->engine, 0, 5, status));
    const uint32_t overflow = FP3_FLAG_OVERFLOW | FP3_FLAG_INEXACT;
    for (uint32_t i = 0; i < 5; i++) {
        EXPECT(status[i].failed == (i < 3 ? i + 2 : 0));
        EXPECT(status[i].flags == (i < 3 ? overflow : 0));
    }
    EXPECT(!fp3_engine_clear_status(b->engine, 1, 4) && !fp3_engine_run(b->engine, 1, &stats));
    EXPECT(!fp3_engine_status(b->engine, 0, 5, status));
    /* An infinity stays one without an exception; the largest number overflows again. */
    EXPECT(status[0].failed == 2 && status[1].failed == (is_finite ? 5 : 0) &&
           status[3].failed == 5);
    EXPECT(status[0].flags == overflow && status[1].flags == (is_finite ? overflow : 0));
}

/* The host counts along, and asks again where it wrote, or where a run ended before its time. */
static const char stepping[] = ".state steps x\nstep:\nadd steps, steps, 1.0\nadd x, x, 1.0\n";

/* Whether the last message has this number. */
static int says_number(const bench *b, int64_t number) {
    char text[24];
    snprintf(text, sizeof text, "%" PRId64, number);
    return SAYS(text);
}

static void steps_are_counted_as_far_as_words_do(bench *b) {
    const size_t last = fp3_engine_objects(b->engine) - 1;
    const int64_t limit = fp3_format_counts(b->config);
    const int is_float = fp3_format_is_float(b->config);
    fp3_image *image = assemble(stepping);
    float n = (float)limit - 3, half = 0.5f, none = NAN, x;
    EXPECT(image && fp3_image_steps(image) == 0 && !fp3_engine_load(b->engine, image));
    EXPECT(fp3_engine_run(b->engine, (uint64_t)limit + 1, NULL) == FP3_E_ARGUMENT &&
           SAYS(limit == FP3_STEPS_LIMIT ? "FP32" : b->config->name));
    EXPECT(!fp3_engine_run(b->engine, 2, NULL) && !fp3_engine_write(b->engine, last, 1, 0, &n));
    EXPECT(fp3_engine_run(b->engine, 4, NULL) == FP3_E_ARGUMENT && says_number(b, limit - 3));
    EXPECT(!fp3_engine_run(b->engine, 1, NULL) && !fp3_engine_run(b->engine, 1, NULL));
    EXPECT(fp3_engine_run(b->engine, 2, NULL) == FP3_E_ARGUMENT && says_number(b, limit - 1));
    EXPECT(!fp3_engine_run(b->engine, 1, NULL) && !fp3_engine_run(b->engine, 0, NULL));
    EXPECT(fp3_engine_run(b->engine, 1, NULL) == FP3_E_ARGUMENT && says_number(b, limit));
    EXPECT(!fp3_engine_get(b->engine, last, "steps", &x) &&
           fabs((double)x - (double)limit) <= (is_float ? 0 : FP3_FORMAT_OFF));
    EXPECT(!fp3_engine_get(b->engine, last, "x", &x) && is_nearly(b, x, 5));
    EXPECT(!fp3_engine_load(b->engine, image)); /* registers stay */
    EXPECT(fp3_engine_run(b->engine, 1, NULL) == FP3_E_ARGUMENT && says_number(b, limit));
    EXPECT(!fp3_engine_write(b->engine, last, 1, 0, &half));
    EXPECT(fp3_engine_run(b->engine, 1, NULL) == FP3_E_ARGUMENT && SAYS("'steps' is 0.5"));
    EXPECT(!fp3_engine_write(b->engine, last, 1, 0, &none));
    EXPECT(fp3_engine_run(b->engine, 1, NULL) == FP3_E_ARGUMENT && SAYS("nan"));
    n = -(float)limit;
    EXPECT(!fp3_engine_set(b->engine, "steps", n) && !fp3_engine_run(b->engine, 1, NULL));
    EXPECT(!fp3_engine_get(b->engine, 0, "steps", &x) && is_nearly(b, x, n + 1));
    fp3_image_free(&image);
}

/* A run that the cycle limit ended. */
static void steps_are_counted_after_a_limit_too(bench *b) {
    fp3_image *image = assemble(stepping);
    b->def.cycle_limit = 1000;
    EXPECT(!reopen(b) && !fp3_engine_load(b->engine, image));
    const uint64_t steps = (uint64_t)fp3_format_counts(b->config) * 3 / 4; /* not twice */
    EXPECT(fp3_engine_run(b->engine, steps, NULL) == FP3_E_LIMIT);
    EXPECT(fp3_engine_run(b->engine, steps, NULL) == FP3_E_LIMIT);
    fp3_image_free(&image);
}

/* What a promise is about: all that it needs of a configuration (FLOAT: words that are binary32;
 * WHOLE: records that keep them), and whose it is: the fast engine has the host's memory for a
 * store, refuses illegal words, and counts no cycles. */
typedef enum { ANY, FLOAT = 1, WHOLE = 2, STORE = 4, SLEEP = 8, STATUS = 16 } about;
typedef enum { ALL, MACHINES, FAST } whose;

#define PROMISES(X)                                                                                \
    X(open_refuses_what_is_unknown, ANY, ALL)                                                      \
    X(nothing_runs_before_a_load, ANY, ALL)                                                        \
    X(registers_out_of_range_are_refused, ANY, ALL)                                                \
    X(registers_are_0_at_first, ANY, ALL)                                                          \
    X(every_register_keeps_its_bits, FLOAT | WHOLE, ALL)                                           \
    X(load_refuses_what_does_not_fit, ANY, ALL)                                                    \
    X(names_are_those_of_the_program, ANY, ALL)                                                    \
    X(an_illegal_word_ends_the_run_there, ANY, MACHINES)                                           \
    X(what_fast_cannot_execute_changes_nothing, ANY, FAST)                                         \
    X(the_cycle_limit_stops_a_run, ANY, MACHINES)                                                  \
    X(steps_are_counted_as_far_as_words_do, ANY, ALL)                                              \
    X(steps_are_counted_after_a_limit_too, ANY, MACHINES)                                          \
    X(no_steps_execute_nothing, ANY, ALL)                                                          \
    X(flags_are_those_of_the_last_run, WHOLE, ALL)                                                 \
    X(failures_are_those_of_the_last_run, WHOLE, ALL)                                              \
    X(the_bus_log_has_every_transfer, ANY, ALL)                                                    \
    X(the_counters_of_units_add_up, ANY, MACHINES)                                                 \
    X(only_programs_with_a_sleep_have_sleepers, ANY, ALL)                                          \
    X(any_number_of_objects_is_moved, STORE, ALL)                                                  \
    X(more_objects_leave_room_for_fewer_registers, STORE, MACHINES)                                \
    X(objects_sleep_when_they_say_so, FLOAT | SLEEP, ALL)                                          \
    X(a_repeated_run_takes_the_same_cycles, SLEEP, ALL)                                            \
    X(a_visit_ends_when_all_sleep, SLEEP, ALL)                                                     \
    X(objects_are_woken_and_removed, SLEEP, ALL)                                                   \
    X(an_object_knows_when_it_failed, WHOLE | STATUS, ALL)

typedef struct {
    const char *name;
    void (*check)(bench *);
    unsigned about; /* a sum of these */
    whose whose;
} promise;

static int concerns(const promise *p, const char *engine, const fp3_config *config) {
    const int is_fast = strcmp(engine, "fast") == 0;
    if (p->whose == (is_fast ? MACHINES : FAST))
        return 0;
    if (config->dual) /* the programs here mix sums and products; test_dual.py has others */
        return 0;
    const unsigned has = (fp3_format_is_float(config) ? FLOAT : 0) | (config->storage ? 0 : WHOLE) |
                         (config->interleave ? STORE : 0) | (config->sleep ? SLEEP : 0) |
                         (config->status ? STATUS : 0);
    return !(p->about & ~has);
}

/* Whether the promise is kept. */
static int check(const promise *p, const char *engine, const fp3_config *config,
                 const char *program) {
    bench b = {.config = config, .registers = config->registers};
    b.def = fp3_engine_default();
    b.def.engine = engine;
    b.def.config = config->name;
    b.def.cycle_limit = strcmp(engine, "fast") ? 20000 : 0;
    b.def.is_interpreted = 1;
    b.def.error = &b.error;
    if (fp3_engine_open(&b.def, &b.engine))
        b.failed = "the engine opens";
    else
        p->check(&b);
    fp3_engine_close(&b.engine);
    if (b.failed)
        printf("FAIL %s, %s, %s: line %d: expected %s\n  last message: '%s'\n  replay: "
               "%s --only %s --engine %s\n",
               p->name, engine, config->name, b.line, b.failed, b.error.text, program, p->name,
               engine);
    return !b.failed;
}

int main(int argc, char **argv) {
    static const promise promises[] = {
#define X(name, about, whose) {#name, name, about, whose},
        PROMISES(X)
#undef X
    };
    static const char *const engines[] = {"isa", "rtl", "fast"};
    const char *only = NULL, *only_engine = NULL;
    for (int i = 1; i + 1 < argc; i += 2) {
        only = strcmp(argv[i], "--only") == 0 ? argv[i + 1] : only;
        only_engine = strcmp(argv[i], "--engine") == 0 ? argv[i + 1] : only_engine;
    }
    unsigned checked = 0, failed = 0;
    for (size_t p = 0; p < sizeof promises / sizeof *promises; p++)
        for (uint32_t c = 0; c < fp3_config_count; c++)
            for (size_t k = 0; k < sizeof engines / sizeof *engines; k++) {
                if ((only && strcmp(only, promises[p].name) != 0) ||
                    (only_engine && strcmp(only_engine, engines[k]) != 0) ||
                    !concerns(&promises[p], engines[k], &fp3_configs[c]))
                    continue;
                checked++;
                failed += !check(&promises[p], engines[k], &fp3_configs[c], argv[0]);
            }
    printf("%u checked, %u failed\n", checked, failed);
    return failed || !checked;
}
