/* engine.c - what all kinds of engine share: configurations, names, every check of an argument. */
#include "kind.h"

#include <inttypes.h>
#include <isa.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define COOKIE 0x46503346u
#define ROWS_MAX 65536u /* of a lane's list: the number of an object has 16 bits */
#define RECORD_LOG2 3u  /* of the words of the smallest record */

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

/* ---- open ---- */

static fp3_status no_config(const fp3_engine_def *def) {
    char names[512] = "";
    for (uint32_t i = 0; i < fp3_config_count; i++) {
        strncat(names, i ? ", " : "", sizeof names - strlen(names) - 1);
        strncat(names, fp3_configs[i].name, sizeof names - strlen(names) - 1);
    }
    return fp3_fail(def->error, FP3_E_ARGUMENT, "no configuration '%s': there are %s",
                    def->config ? def->config : "", names);
}

/* The smallest n with 1 << n >= count. */
static uint32_t log2_of(uint32_t count) {
    uint32_t n = 0;
    while (1u << n < count)
        n++;
    return n;
}

/* How many objects, and how many words of the store each gets: all that there is room for, up to
 * its registers, so that they stay where they are whatever is loaded. */
static fp3_status place_objects(fp3_engine *engine) {
    const fp3_config *config = engine->config;
    engine->columns = fp3_config_units(config) * config->lanes;
    const uint32_t records = config->store_words >> RECORD_LOG2;
    const uint32_t most =
        config->interleave ? (records < ROWS_MAX ? records : ROWS_MAX) * engine->columns : 1;
    const uint32_t full = config->contexts * engine->columns;
    engine->objects = engine->def.objects ? engine->def.objects : full < most ? full : most;
    if (engine->objects > most || !most)
        return fp3_fail(engine->def.error, FP3_E_ARGUMENT,
                        "%" PRIu32 " objects: configuration '%s' has room for %" PRIu32 " %s",
                        engine->objects, config->name, most,
                        config->interleave ? "at most" : "object");
    const uint32_t rows = (engine->objects + engine->columns - 1) / engine->columns;
    engine->log2 = log2_of(config->registers);
    if (engine->log2 < RECORD_LOG2)
        engine->log2 = RECORD_LOG2;
    while (config->interleave && rows << engine->log2 > config->store_words)
        engine->log2--;
    return FP3_OK;
}

static fp3_status make_room(fp3_engine *engine) {
    fp3_status status = place_objects(engine);
    if (status)
        return status;
    engine->slept = calloc(engine->objects, sizeof *engine->slept);
    engine->counters = calloc(fp3_config_units(engine->config), sizeof *engine->counters);
    return engine->slept && engine->counters
               ? FP3_OK
               : fp3_fail(engine->def.error, FP3_E_SYSTEM, "out of memory");
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
    const fp3_config *config = fp3_config_find(def->config);
    if (!config)
        return no_config(def);

    fp3_engine *made = calloc(1, sizeof *made);
    if (!made)
        return fp3_fail(def->error, FP3_E_SYSTEM, "out of memory");
    *made = (fp3_engine){.kind = kind, .config = config, .def = *def, .program = {.slept = -1}};
    fp3_status status = make_room(made);
    if (!status)
        status = kind->open(made);
    if (status)
        fp3_engine_close(&made);
    *engine = made;
    return status;
}

void fp3_engine_close(fp3_engine **engine) {
    fp3_engine *closing = *engine;
    if (!closing)
        return;
    closing->kind->close(closing);
    fp3_image_free(&closing->image);
    fp3_visit_free(&closing->visit);
    free(closing->slept);
    free(closing->counters);
    free(closing);
    *engine = NULL;
}

size_t fp3_engine_objects(const fp3_engine *engine) { return engine->objects; }

int fp3_engine_is_awake(const fp3_engine *engine, size_t object) {
    return engine->program.slept < 0 || engine->slept[object] == 0;
}

fp3_status fp3_engine_illegal(fp3_engine *engine, uint32_t index) {
    const fp3_program *program = &engine->program;
    return fp3_fail(engine->def.error, FP3_E_PROGRAM,
                    "word %" PRIu32 " is 0x%08" PRIx32 ", no instruction of configuration '%s'",
                    index - program->in_front, program->code[index], engine->config->name);
}

fp3_status fp3_engine_limit(fp3_engine *engine) {
    return fp3_fail(engine->def.error, FP3_E_LIMIT, "stopped at the limit of %" PRIu64 " cycles",
                    engine->def.cycle_limit);
}

/* ---- load ---- */

/* What the configuration lacks for an operation, or NULL. */
static const char *lacks(const fp3_config *config, uint32_t op) {
    switch (op) {
    case FP3_OP_MADD:
    case FP3_OP_MSUB:
        return config->chain ? NULL : "a chained multiply-add";
    case FP3_OP_ADDH:
    case FP3_OP_SUBH:
    case FP3_OP_ADDT:
    case FP3_OP_SUBT:
        return config->scale ? NULL : "an addition of half or twice";
    case FP3_OP_SLEEP:
    case FP3_OP_LDS:
        return config->sleep ? NULL : "an instruction for objects that sleep";
    case FP3_OP_LD:
    case FP3_OP_ST:
        return config->interleave ? NULL : "an access to an object store";
    default:
        return NULL;
    }
}

static fp3_status check_operations(fp3_engine *engine, const fp3_image *image) {
    for (uint32_t i = 0; i < image->code_count; i++) {
        fp3_instruction instruction;
        if (fp3_word_decode(image->code[i], &instruction, NULL))
            continue;
        const char *what = lacks(engine->config, instruction.op);
        if (what)
            return fp3_fail(engine->def.error, FP3_E_PROGRAM,
                            "word %" PRIu32 " is %s, which configuration '%s' does not have", i,
                            what, engine->config->name);
    }
    return FP3_OK;
}

static fp3_status check_image(fp3_engine *engine, const fp3_image *image) {
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
    return check_operations(engine, image);
}

/* What is there besides the image's words, and what the objects need of the store. */
static fp3_status check_visit(fp3_engine *engine, const fp3_visit *visit) {
    const fp3_config *config = engine->config;
    if (visit->code_count > config->program_words)
        return fp3_fail(engine->def.error, FP3_E_PROGRAM,
                        "the program needs %" PRIu32
                        " words of instruction memory with its loads and stores, configuration "
                        "'%s' has %" PRIu32,
                        visit->code_count, config->name, config->program_words);
    if (visit->log2 > engine->log2)
        return fp3_fail(engine->def.error, FP3_E_PROGRAM,
                        "the program needs %u words of the object store for each object: "
                        "configuration '%s' has room for %" PRIu32 " objects, not for %" PRIu32,
                        1u << visit->log2, config->name,
                        (config->store_words >> visit->log2) * engine->columns, engine->objects);
    return FP3_OK;
}

static fp3_program program_of(const fp3_image *image, const fp3_visit *visit) {
    if (visit)
        return (fp3_program){visit->code, visit->code_count,     visit->step,
                             visit->last, visit->loads_in_front, visit->slept};
    return (fp3_program){image->code, image->code_count, image->step, image->last, 0, -1};
}

/* A copy of the image and, interleaved, what is made of it; checked, unless check is 0. */
static fp3_status prepare(fp3_engine *engine, const fp3_image *image, int check, fp3_image **copy,
                          fp3_visit **visit) {
    fp3_status status = check ? check_image(engine, image) : FP3_OK;
    if (!status)
        status = fp3_image_make(image, copy, engine->def.error);
    if (!status && engine->config->interleave)
        status = fp3_visit_make(*copy, visit, engine->def.error);
    if (!status && *visit && check)
        status = check_visit(engine, *visit);
    return status;
}

static fp3_status load(fp3_engine *engine, const fp3_image *image, int check) {
    fp3_image *copy = NULL;
    fp3_visit *visit = NULL;
    fp3_status status = prepare(engine, image, check, &copy, &visit);
    if (status) {
        fp3_image_free(&copy);
        fp3_visit_free(&visit);
        return status;
    }
    fp3_image_free(&engine->image);
    fp3_visit_free(&engine->visit);
    engine->image = copy;
    engine->visit = visit;
    engine->program = program_of(copy, visit);
    engine->clock = 0;
    engine->is_slept_known = engine->is_listed = 0;
    status = engine->kind->load(engine);
    for (uint32_t i = 0; !status && i < copy->constant_count; i++)
        status =
            engine->kind->write_shared(engine, copy->constants[i].index, copy->constants[i].bits);
    return status;
}

fp3_status fp3_engine_load(fp3_engine *engine, const fp3_image *image) {
    return load(engine, image, 1);
}

fp3_status fp3_engine_load_unchecked(fp3_engine *engine, const fp3_image *image) {
    return load(engine, image, 0);
}

/* ---- registers ---- */

static fp3_status check_range(fp3_engine *engine, const char *what, size_t first, size_t count,
                              size_t has) {
    if (first <= has && count <= has - first)
        return FP3_OK;
    return fp3_fail(engine->def.error, FP3_E_ARGUMENT,
                    "%s %zu, count %zu: configuration '%s' has %zu", what, first, count,
                    engine->config->name, has);
}

static fp3_status check_objects(fp3_engine *engine, size_t first, size_t count) {
    if (first <= engine->objects && count <= engine->objects - first)
        return FP3_OK;
    return fp3_fail(engine->def.error, FP3_E_ARGUMENT,
                    "object %zu, count %zu: there are %" PRIu32 " objects", first, count,
                    engine->objects);
}

static fp3_status check_cell(fp3_engine *engine, size_t first, size_t count, uint32_t reg) {
    fp3_status status = check_objects(engine, first, count);
    if (!status)
        status = check_range(engine, "register", reg, 1, engine->config->registers);
    if (!status && reg >> engine->log2)
        status = fp3_fail(engine->def.error, FP3_E_ARGUMENT,
                          "register %" PRIu32 ": the store of configuration '%s' has room for %u "
                          "registers of each of %" PRIu32 " objects",
                          reg, engine->config->name, 1u << engine->log2, engine->objects);
    return status;
}

/* The sleep register may be written: the host's copy and what a run begins with follow. */
static fp3_status write_cell(fp3_engine *engine, size_t object, uint32_t reg, uint32_t bits) {
    if (engine->program.slept >= 0 && reg == (uint32_t)engine->program.slept) {
        engine->slept[object] = bits;
        engine->is_listed = 0;
    }
    return engine->kind->write(engine, object, reg, bits);
}

fp3_status fp3_engine_write(fp3_engine *engine, size_t first, size_t count, uint32_t reg,
                            const float *values) {
    fp3_status status = check_cell(engine, first, count, reg);
    for (size_t i = 0; !status && i < count; i++) {
        uint32_t bits;
        memcpy(&bits, &values[i], sizeof bits);
        status = write_cell(engine, first + i, reg, bits);
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
    for (size_t i = 0; !status && i < engine->objects; i++)
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

/* ---- run ---- */

/* Brings the host's copy of all sleep registers up to date. */
static fp3_status look_who_sleeps(fp3_engine *engine) {
    fp3_status status = FP3_OK;
    if (engine->program.slept < 0 || engine->is_slept_known)
        return FP3_OK;
    for (uint32_t i = 0; !status && i < engine->objects; i++)
        status = engine->kind->read(engine, i, (uint32_t)engine->program.slept, &engine->slept[i]);
    engine->is_slept_known = !status;
    return status;
}

static fp3_status list_who_is_awake(fp3_engine *engine) {
    if (!engine->config->interleave || engine->is_listed)
        return FP3_OK;
    fp3_status status = look_who_sleeps(engine);
    if (!status)
        status = engine->kind->list(engine);
    engine->is_listed = !status;
    return status;
}

static void sum_counters(const fp3_engine *engine, fp3_stats *stats) {
    for (uint32_t unit = 0; unit < stats->units; unit++)
        for (int i = 0; i < FP3_COUNTER_COUNT; i++) {
            const uint64_t n = engine->counters[unit][i];
            if (i != FP3_COUNTER_CYCLES)
                stats->counter[i] += n;
            else if (n > stats->counter[i])
                stats->counter[i] = n;
        }
}

/* Steps that objects made; before has what their sleep registers held, and is the host's copy. */
static fp3_status count_steps(fp3_engine *engine, uint32_t steps, fp3_stats *stats) {
    if (engine->program.slept < 0) {
        stats->object_steps = (uint64_t)steps * engine->objects;
        return FP3_OK;
    }
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; !status && i < engine->objects; i++) {
        uint32_t *slept = &engine->slept[i];
        if (*slept)
            continue;
        status = engine->kind->read(engine, i, (uint32_t)engine->program.slept, slept);
        stats->object_steps += *slept ? *slept - engine->clock : steps;
    }
    return status;
}

/* After an end before its time nobody knows who slept, and the lists are in pieces. */
static fp3_status run(fp3_engine *engine, uint32_t steps, fp3_stats *stats) {
    memset(engine->counters, 0, fp3_config_units(engine->config) * sizeof *engine->counters);
    fp3_status status = list_who_is_awake(engine);
    if (status)
        return status;
    engine->is_slept_known = engine->is_listed = 0;
    status = engine->kind->run(engine, steps, stats);
    sum_counters(engine, stats);
    if (!status)
        status = count_steps(engine, steps, stats);
    if (!status) {
        engine->is_slept_known = engine->is_listed = 1;
        engine->clock += steps;
    }
    return status;
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
    status = run(engine, (uint32_t)steps, stats);
    clock_gettime(CLOCK_MONOTONIC, &end);
    stats->seconds =
        (double)(end.tv_sec - begin.tv_sec) + 1e-9 * (double)(end.tv_nsec - begin.tv_nsec);
    return status;
}

fp3_status fp3_engine_unit_counters(fp3_engine *engine, uint32_t unit,
                                    uint64_t counter[FP3_COUNTER_COUNT]) {
    const uint32_t units = fp3_config_units(engine->config);
    fp3_status status = check_range(engine, "unit", unit, 1, units);
    if (!status)
        memcpy(counter, engine->counters[unit], sizeof engine->counters[unit]);
    return status;
}

/* ---- the status of objects ---- */

static fp3_status read_status(fp3_engine *engine, size_t object, fp3_object_status *status) {
    uint32_t word = 0;
    fp3_status result =
        engine->config->status ? engine->kind->read_status(engine, object, &word) : FP3_OK;
    *status = (fp3_object_status){.flags = word & ((2u << FP3_STATUS_FLAGS_HI) - 1),
                                  .failed = word >> FP3_STATUS_STEP_LO};
    if (!result && engine->program.slept >= 0)
        result =
            engine->kind->read(engine, object, (uint32_t)engine->program.slept, &status->slept);
    return result;
}

fp3_status fp3_engine_status(fp3_engine *engine, size_t first, size_t count,
                             fp3_object_status *status) {
    fp3_status result = check_objects(engine, first, count);
    for (size_t i = 0; !result && i < count; i++)
        result = read_status(engine, first + i, &status[i]);
    return result;
}

fp3_status fp3_engine_clear_status(fp3_engine *engine, size_t first, size_t count) {
    fp3_status status = check_objects(engine, first, count);
    if (!status && !engine->config->status)
        status =
            fp3_fail(engine->def.error, FP3_E_ARGUMENT,
                     "configuration '%s' keeps no status of its objects", engine->config->name);
    for (size_t i = 0; !status && i < count; i++)
        status = engine->kind->write_status(engine, first + i, 0);
    return status;
}

static fp3_status set_slept(fp3_engine *engine, size_t first, size_t count, uint32_t bits) {
    fp3_status status = check_loaded(engine);
    if (!status)
        status = check_objects(engine, first, count);
    if (!status && engine->program.slept < 0)
        status = fp3_fail(engine->def.error, FP3_E_PROGRAM, "the program has no sleep");
    for (size_t i = 0; !status && i < count; i++)
        status = write_cell(engine, first + i, (uint32_t)engine->program.slept, bits);
    return status;
}

fp3_status fp3_engine_wake(fp3_engine *engine, size_t first, size_t count) {
    return set_slept(engine, first, count, 0);
}

fp3_status fp3_engine_remove(fp3_engine *engine, size_t first, size_t count) {
    return set_slept(engine, first, count, FP3_REMOVED);
}
