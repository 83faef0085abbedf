/* engine.c - what all kinds of engine share: configurations, names, every check of an argument. */
#include "kind.h"

#include <configs.h>
#include <inttypes.h>
#include <isa.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define COOKIE 0x46503345u

static const fp3_config configs[] = {
#define X(name, doc, registers, contexts, program_words, bypass, writeback_stall, chain,           \
          subnormal, nearest, ...)                                                                 \
    {#name, registers, contexts, program_words, chain, subnormal, nearest},
    FP3_CONFIGS(X)
#undef X
};

static const fp3_engine_kind *const kinds[] = {&fp3_kind_rtl, &fp3_kind_model};

#define COUNT(array) (sizeof(array) / sizeof *(array))

const char *fp3_counter_name(fp3_counter counter) {
    static const char *const names[] = {
#define X(NAME, name, address) name,
        FP3_COUNTERS(X)
#undef X
    };
    return names[counter];
}

int fp3_counter_is_stall(fp3_counter counter) {
    return strncmp(fp3_counter_name(counter), "stall_", 6) == 0;
}

fp3_engine_def fp3_engine_default(void) {
    return (fp3_engine_def){.kind = "rtl", .config = "single", .cookie = COOKIE};
}

fp3_status fp3_engine_open(const fp3_engine_def *def, fp3_engine **engine) {
    *engine = NULL;
    if (def->cookie != COOKIE) /* then def->error may be anything, too */
        return FP3_E_ARGUMENT;

    const fp3_engine_kind *kind = NULL;
    for (size_t i = 0; i < COUNT(kinds); i++)
        if (def->kind && strcmp(kinds[i]->name, def->kind) == 0)
            kind = kinds[i];
    if (!kind)
        return fp3_fail(def->error, FP3_E_ARGUMENT, "no engine '%s': rtl and model are there",
                        def->kind ? def->kind : "");

    const fp3_config *config = NULL;
    for (size_t i = 0; i < COUNT(configs); i++)
        if (def->config && strcmp(configs[i].name, def->config) == 0)
            config = &configs[i];
    if (!config) {
        char names[256] = "";
        for (size_t i = 0; i < COUNT(configs); i++) {
            strncat(names, i ? ", " : "", sizeof names - strlen(names) - 1);
            strncat(names, configs[i].name, sizeof names - strlen(names) - 1);
        }
        return fp3_fail(def->error, FP3_E_ARGUMENT, "no configuration '%s': there are %s",
                        def->config ? def->config : "", names);
    }

    fp3_engine *made = calloc(1, sizeof *made);
    if (!made)
        return fp3_fail(def->error, FP3_E_SYSTEM, "out of memory");
    made->kind = kind;
    made->config = config;
    made->def = *def;
    fp3_status status = kind->open(made);
    if (status)
        fp3_engine_close(&made);
    *engine = made;
    return status;
}

void fp3_engine_close(fp3_engine **engine) {
    if (!*engine)
        return;
    (*engine)->kind->close(*engine);
    fp3_image_free(&(*engine)->image);
    free(*engine);
    *engine = NULL;
}

size_t fp3_engine_objects(const fp3_engine *engine) { return engine->config->contexts; }

fp3_status fp3_engine_illegal(fp3_engine *engine, uint32_t index, uint32_t word) {
    return fp3_fail(engine->def.error, FP3_E_PROGRAM,
                    "word %" PRIu32 " is 0x%08" PRIx32 ", no instruction of configuration '%s'",
                    index, word, engine->config->name);
}

fp3_status fp3_engine_limit(fp3_engine *engine) {
    return fp3_fail(engine->def.error, FP3_E_LIMIT, "stopped at the limit of %" PRIu64 " cycles",
                    engine->def.cycle_limit);
}

static int is_chain(uint32_t op) {
    enum { ADD, MUL, CHAIN };
    switch (op) {
#define X(NAME, code, mnemonic, operands, unit)                                                    \
    case code:                                                                                     \
        return unit == CHAIN;
        FP3_OPS(X)
#undef X
    }
    return 0;
}

fp3_status fp3_engine_load(fp3_engine *engine, const fp3_image *image) {
    const fp3_config *config = engine->config;
    const struct {
        const char *what;
        uint32_t needs, has;
    } rows[] = {{"object registers", image->registers, config->registers},
                {"shared constants", image->shared, config->registers},
                {"words of instruction memory", image->code_count, config->program_words}};
    for (size_t i = 0; i < COUNT(rows); i++)
        if (rows[i].needs > rows[i].has)
            return fp3_fail(engine->def.error, FP3_E_PROGRAM,
                            "the program needs %" PRIu32 " %s, configuration '%s' has %" PRIu32,
                            rows[i].needs, rows[i].what, config->name, rows[i].has);
    for (uint32_t i = 0; i < image->code_count && !config->chain; i++) {
        fp3_instruction instruction;
        if (!fp3_word_decode(image->code[i], &instruction, NULL) && is_chain(instruction.op))
            return fp3_fail(engine->def.error, FP3_E_PROGRAM,
                            "word %" PRIu32
                            " is a chained multiply-add, which configuration '%s' does not have",
                            i, config->name);
    }

    fp3_image *copy = NULL;
    fp3_status status = fp3_image_make(image, &copy, engine->def.error);
    if (!status)
        status = engine->kind->load(engine, copy);
    for (uint32_t i = 0; !status && i < copy->constant_count; i++)
        status =
            engine->kind->write_shared(engine, copy->constants[i].index, copy->constants[i].bits);
    if (status) {
        fp3_image_free(&copy);
        return status;
    }
    fp3_image_free(&engine->image);
    engine->image = copy;
    return FP3_OK;
}

static fp3_status check_range(fp3_engine *engine, const char *what, size_t first, size_t count,
                              size_t has) {
    if (first <= has && count <= has - first)
        return FP3_OK;
    return fp3_fail(engine->def.error, FP3_E_ARGUMENT,
                    "%s %zu, count %zu: configuration '%s' has %zu", what, first, count,
                    engine->config->name, has);
}

static fp3_status check_cell(fp3_engine *engine, size_t first, size_t count, uint32_t reg) {
    fp3_status status = check_range(engine, "object", first, count, engine->config->contexts);
    return status ? status : check_range(engine, "register", reg, 1, engine->config->registers);
}

fp3_status fp3_engine_write(fp3_engine *engine, size_t first, size_t count, uint32_t reg,
                            const float *values) {
    fp3_status status = check_cell(engine, first, count, reg);
    for (size_t i = 0; !status && i < count; i++) {
        uint32_t bits;
        memcpy(&bits, &values[i], sizeof bits);
        status = engine->kind->write(engine, first + i, reg, bits);
    }
    return status;
}

fp3_status fp3_engine_read(fp3_engine *engine, size_t first, size_t count, uint32_t reg,
                           float *values) {
    fp3_status status = check_cell(engine, first, count, reg);
    for (size_t i = 0; !status && i < count; i++) {
        uint32_t bits = 0;
        if (!(status = engine->kind->read(engine, first + i, reg, &bits)))
            memcpy(&values[i], &bits, sizeof bits);
    }
    return status;
}

fp3_status fp3_engine_write_shared(fp3_engine *engine, uint32_t first, size_t count,
                                   const float *values) {
    fp3_status status =
        check_range(engine, "shared constant", first, count, engine->config->registers);
    for (uint32_t i = 0; !status && i < count; i++) {
        uint32_t bits;
        memcpy(&bits, &values[i], sizeof bits);
        status = engine->kind->write_shared(engine, first + i, bits);
    }
    return status;
}

fp3_status fp3_engine_read_shared(fp3_engine *engine, uint32_t first, size_t count, float *values) {
    fp3_status status =
        check_range(engine, "shared constant", first, count, engine->config->registers);
    for (uint32_t i = 0; !status && i < count; i++) {
        uint32_t bits = 0;
        if (!(status = engine->kind->read_shared(engine, first + i, &bits)))
            memcpy(&values[i], &bits, sizeof bits);
    }
    return status;
}

static fp3_status check_loaded(fp3_engine *engine) {
    return engine->image ? FP3_OK
                         : fp3_fail(engine->def.error, FP3_E_ARGUMENT, "no program is loaded");
}

static fp3_status find(fp3_engine *engine, const char *name, unsigned kinds_wanted,
                       const fp3_symbol **symbol) {
    fp3_status status = check_loaded(engine);
    if (status)
        return status;
    *symbol = fp3_image_find(engine->image, name, kinds_wanted);
    return *symbol ? FP3_OK
                   : fp3_fail(engine->def.error, FP3_E_ARGUMENT,
                              "the program has no parameter '%s'", name);
}

fp3_status fp3_engine_set(fp3_engine *engine, const char *name, float value) {
    const fp3_symbol *symbol;
    fp3_status status = find(engine, name, FP3_KINDS_HOST, &symbol);
    if (status)
        return status;
    if (symbol->kind == FP3_SYMBOL_SHARED)
        return fp3_engine_write_shared(engine, symbol->index, 1, &value);
    for (size_t i = 0; !status && i < engine->config->contexts; i++)
        status = fp3_engine_write(engine, i, 1, symbol->index, &value);
    return status;
}

fp3_status fp3_engine_get(fp3_engine *engine, size_t object, const char *name, float *value) {
    const fp3_symbol *symbol;
    fp3_status status = find(engine, name, FP3_KINDS_OBJECT | FP3_KINDS_SHARED, &symbol);
    if (status)
        return status;
    if (FP3_KIND(symbol->kind) & FP3_KINDS_SHARED)
        return fp3_engine_read_shared(engine, symbol->index, 1, value);
    return fp3_engine_read(engine, object, 1, symbol->index, value);
}

fp3_status fp3_engine_run(fp3_engine *engine, uint64_t steps, fp3_stats *stats) {
    fp3_stats own;
    if (!stats)
        stats = &own;
    *stats = (fp3_stats){0};
    fp3_status status = check_loaded(engine);
    if (status)
        return status;
    if (steps > UINT32_MAX)
        return fp3_fail(engine->def.error, FP3_E_ARGUMENT,
                        "%" PRIu64 " steps: a run has 4294967295 at most", steps);
    struct timespec begin, end;
    clock_gettime(CLOCK_MONOTONIC, &begin);
    status = engine->kind->run(engine, (uint32_t)steps, stats);
    clock_gettime(CLOCK_MONOTONIC, &end);
    stats->seconds =
        (double)(end.tv_sec - begin.tv_sec) + 1e-9 * (double)(end.tv_nsec - begin.tv_nsec);
    if (!status)
        stats->object_steps = steps * engine->config->contexts;
    return status;
}
