/* engine.c - what all engines share: configurations, names, every check of an argument. */
#include "backend.h"

#include "gen/registers.h"
#include "machine/operation.h"

#include "gen/registers.h"
#include <fp3/isa.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define COOKIE 0x46503346u

static const fp3_backend *const backends[] = {&fp3_backend_rtl, &fp3_backend_isa};

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
    return (fp3_engine_def){.engine = "rtl", .config = "single", .cookie = COOKIE};
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

static fp3_status count_objects(fp3_engine *engine) {
    const fp3_config *config = engine->config;
    const uint32_t columns = fp3_config_schedulers(config) * config->lanes;
    const uint32_t most = config->interleave ? fp3_placement_rows(config, 0) * columns : 1;
    const uint32_t full = config->contexts * columns;
    engine->objects = engine->def.objects ? engine->def.objects : full < most ? full : most;
    if (engine->objects > most || !most)
        return fp3_fail(engine->def.error, FP3_E_ARGUMENT,
                        "%" PRIu32 " objects: configuration '%s' has room for %" PRIu32 " %s",
                        engine->objects, config->name, most,
                        config->interleave ? "at most" : "object");
    return FP3_OK;
}

/* All objects in all schedulers, without a program. */
static fp3_status place_objects(fp3_engine *engine) {
    fp3_layout *layout = &engine->layout;
    fp3_status status = fp3_layout_make(engine->config, 1, layout, engine->def.error);
    if (status)
        return status;
    layout->groups[0].objects = engine->objects;
    layout->groups[0].program.slept = -1;
    return fp3_layout_place(layout, engine->config, engine->def.visit, engine->def.error);
}

static fp3_status make_room(fp3_engine *engine) {
    fp3_status status = count_objects(engine);
    if (!status)
        status = place_objects(engine);
    if (status)
        return status;
    engine->slept = calloc(engine->objects, sizeof *engine->slept);
    engine->counters = calloc(fp3_config_schedulers(engine->config), sizeof *engine->counters);
    return engine->slept && engine->counters
               ? FP3_OK
               : fp3_fail(engine->def.error, FP3_E_SYSTEM, "out of memory");
}

fp3_status fp3_engine_open(const fp3_engine_def *def, fp3_engine **engine) {
    *engine = NULL;
    if (def->cookie != COOKIE) /* then def->error may be anything, too */
        return FP3_E_ARGUMENT;

    const fp3_backend *backend = NULL;
    for (size_t i = 0; i < COUNT(backends); i++)
        if (def->engine && strcmp(backends[i]->name, def->engine) == 0)
            backend = backends[i];
    if (!backend)
        return fp3_fail(def->error, FP3_E_ARGUMENT, "no engine '%s': there are rtl and isa",
                        def->engine ? def->engine : "");
    const fp3_config *config = fp3_config_find(def->config);
    if (!config)
        return no_config(def);

    fp3_engine *made = calloc(1, sizeof *made);
    if (!made)
        return fp3_fail(def->error, FP3_E_SYSTEM, "out of memory");
    *made = (fp3_engine){.backend = backend, .config = config, .def = *def};
    fp3_status status = make_room(made);
    if (!status)
        status = backend->open(made);
    if (status)
        fp3_engine_close(&made);
    *engine = made;
    return status;
}

void fp3_engine_close(fp3_engine **engine) {
    fp3_engine *closing = *engine;
    if (!closing)
        return;
    closing->backend->close(closing);
    fp3_layout_free(&closing->layout);
    free(closing->slept);
    free(closing->counters);
    free(closing);
    *engine = NULL;
}

size_t fp3_engine_objects(const fp3_engine *engine) { return engine->objects; }

static const fp3_members *group_of(const fp3_engine *engine, size_t object) {
    return fp3_layout_group_of(&engine->layout, object);
}

/* The register of an object that tells whether it sleeps; -1: it never does. */
static int slept_of(const fp3_engine *engine, size_t object) {
    return group_of(engine, object)->program.slept;
}

int fp3_engine_is_awake(const fp3_engine *engine, size_t object) {
    return slept_of(engine, object) < 0 || engine->slept[object] == 0;
}

/* "", or where there are several groups "group N: ". */
typedef struct {
    char text[32];
} prefix;

static prefix prefix_of(size_t group, size_t count) {
    prefix p = {""};
    if (count > 1)
        snprintf(p.text, sizeof p.text, "group %zu: ", group);
    return p;
}

fp3_status fp3_engine_illegal(fp3_engine *engine, uint32_t group, uint32_t index) {
    const fp3_code *program = &engine->layout.groups[group].program;
    return fp3_fail(engine->def.error, FP3_E_PROGRAM,
                    "%sword %" PRIu32 " is 0x%08" PRIx32 ", no instruction of configuration '%s'",
                    prefix_of(group, engine->layout.count).text, index - program->in_front,
                    program->code[index], engine->config->name);
}

fp3_status fp3_engine_limit(fp3_engine *engine) {
    return fp3_fail(engine->def.error, FP3_E_LIMIT, "stopped at the limit of %" PRIu64 " cycles",
                    engine->def.cycle_limit);
}

/* ---- load ---- */

static fp3_status check_operations(fp3_engine *engine, const fp3_image *image) {
    for (uint32_t i = 0; i < image->code_count; i++) {
        fp3_instruction instruction;
        if (fp3_word_decode(image->code[i], &instruction, NULL))
            continue;
        const fp3_key key = fp3_operation_lacks(engine->config, instruction.op);
        if (key != FP3_KEY_NONE)
            return fp3_fail(engine->def.error, FP3_E_PROGRAM,
                            "word %" PRIu32 " is %s, which configuration '%s' does not have", i,
                            fp3_key_lack(key), engine->config->name);
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

/* What is there besides the image's words, and what an object needs of the store. */
static fp3_status check_visit(fp3_engine *engine, const fp3_visit *visit, size_t objects) {
    const fp3_config *config = engine->config;
    const uint32_t lanes = fp3_config_schedulers(config) * config->lanes;
    const uint64_t room = (uint64_t)fp3_placement_rows(config, visit->log2) * lanes;
    if (visit->code_count > config->program_words)
        return fp3_fail(engine->def.error, FP3_E_PROGRAM,
                        "the program needs %" PRIu32
                        " words of instruction memory with its loads and stores, configuration "
                        "'%s' has %" PRIu32,
                        visit->code_count, config->name, config->program_words);
    if (objects > room)
        return fp3_fail(engine->def.error, FP3_E_PROGRAM,
                        "the program needs %u words of the object store for each object: "
                        "configuration '%s' has room for %" PRIu64 " objects, not for %zu",
                        1u << visit->log2, config->name, room, objects);
    return FP3_OK;
}

static fp3_code program_of(const fp3_image *image, const fp3_visit *visit) {
    if (visit)
        return (fp3_code){visit->code, visit->code_count,     visit->step,
                          visit->last, visit->loads_in_front, visit->slept};
    return (fp3_code){image->code, image->code_count, image->step, image->last, 0, -1};
}

/* A copy of the image and, interleaved, what is made of it; checked, unless check is 0. */
static fp3_status prepare(fp3_engine *engine, const fp3_group *from, int check, fp3_members *to) {
    fp3_error *error = engine->def.error;
    fp3_status status = check ? check_image(engine, from->image) : FP3_OK;
    if (!status)
        status = fp3_image_make(from->image, &to->image, error);
    if (!status && engine->config->interleave)
        status = fp3_visit_make(to->image, &to->visit, error);
    if (!status && to->visit && check)
        status = check_visit(engine, to->visit, from->objects);
    if (status)
        return status;
    to->objects = (uint32_t)from->objects;
    to->program = program_of(to->image, to->visit);
    to->needs = to->visit && check ? to->visit->log2 : 0;
    return FP3_OK;
}

static fp3_status check_groups(fp3_engine *engine, const fp3_group *groups, size_t count) {
    fp3_error *error = engine->def.error;
    size_t objects = 0;
    if (count == 0)
        return fp3_fail(error, FP3_E_ARGUMENT, "no group of objects");
    for (size_t i = 0; i < count; i++) {
        if (groups[i].objects == 0)
            return fp3_fail(error, FP3_E_ARGUMENT, "group %zu has no objects", i);
        if (groups[i].objects > engine->objects - objects)
            return fp3_fail(error, FP3_E_ARGUMENT,
                            "groups of more objects than the %" PRIu32 " of the engine",
                            engine->objects);
        objects += groups[i].objects;
    }
    if (objects < engine->objects)
        return fp3_fail(error, FP3_E_ARGUMENT, "groups of %zu objects: the engine has %" PRIu32,
                        objects, engine->objects);
    const uint32_t schedulers = fp3_config_schedulers(engine->config);
    if (count > schedulers)
        return fp3_fail(
            error, FP3_E_PROGRAM,
            "%zu groups, each with a program of its own: configuration '%s' has %" PRIu32
            " scheduler%s",
            count, engine->config->name, schedulers, schedulers == 1 ? "" : "s");
    return FP3_OK;
}

/* Messages about a group begin with its number, where there are several. */
static fp3_status prepare_all(fp3_engine *engine, const fp3_group *groups, size_t count, int check,
                              fp3_layout *layout) {
    fp3_status status = fp3_layout_make(engine->config, (uint32_t)count, layout, engine->def.error);
    for (size_t i = 0; !status && i < count; i++) {
        status = prepare(engine, &groups[i], check, &layout->groups[i]);
        if (status && engine->def.error && count > 1) {
            const fp3_error why = *engine->def.error;
            fp3_fail(engine->def.error, status, "%s%s", prefix_of(i, count).text, why.text);
        }
    }
    if (!status)
        status = fp3_layout_place(layout, engine->config, engine->def.visit, engine->def.error);
    return status;
}

/* What objects and groups hold, while they move: registers and status of each object, constants of
 * each group. */
typedef struct {
    uint32_t *objects, *constants;
} luggage;

/* Words of an object: its registers, then its status. */
static size_t packed(const fp3_engine *engine) { return engine->config->registers + 1; }

static uint32_t visible(const fp3_engine *engine, const fp3_members *group) {
    const uint32_t words = 1u << group->log2;
    return words < engine->config->registers ? words : engine->config->registers;
}

/* Between the luggage and where things are now. */
static fp3_status move_objects(fp3_engine *engine, luggage *l, int is_write) {
    const fp3_backend *backend = engine->backend;
    fp3_status status = FP3_OK;
    for (size_t i = 0; !status && i < engine->objects; i++) {
        uint32_t *words = &l->objects[i * packed(engine)], *word = &words[packed(engine) - 1];
        const uint32_t registers = visible(engine, group_of(engine, i));
        for (uint32_t reg = 0; !status && reg < registers; reg++)
            status = is_write ? backend->write(engine, i, reg, words[reg])
                              : backend->read(engine, i, reg, &words[reg]);
        if (!status && engine->config->status)
            status = is_write ? backend->write_status(engine, i, *word)
                              : backend->read_status(engine, i, word);
    }
    return status;
}

static fp3_status move_constants(fp3_engine *engine, luggage *l, int is_write) {
    const fp3_backend *backend = engine->backend;
    const uint32_t count = engine->config->registers;
    fp3_status status = FP3_OK;
    for (uint32_t group = 0; !status && group < engine->layout.count; group++)
        for (uint32_t i = 0; !status && i < count; i++) {
            uint32_t *word = &l->constants[group * count + i];
            status = is_write ? backend->write_shared(engine, group, i, *word)
                              : backend->read_shared(engine, group, i, word);
        }
    return status;
}

static fp3_status move(fp3_engine *engine, luggage *l, int is_write) {
    fp3_status status = move_objects(engine, l, is_write);
    return status ? status : move_constants(engine, l, is_write);
}

static fp3_status pack(fp3_engine *engine, luggage *l) {
    const size_t constants =
        (size_t)fp3_config_schedulers(engine->config) * engine->config->registers;
    l->objects = calloc(engine->objects * packed(engine), sizeof *l->objects);
    l->constants = calloc(constants, sizeof *l->constants);
    if (!l->objects || !l->constants)
        return fp3_fail(engine->def.error, FP3_E_SYSTEM, "out of memory");
    return move(engine, l, 0);
}

static fp3_status write_constants(fp3_engine *engine, uint32_t group) {
    const fp3_image *image = engine->layout.groups[group].image;
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; !status && i < image->constant_count; i++)
        status = engine->backend->write_shared(engine, group, image->constants[i].index,
                                               image->constants[i].bits);
    return status;
}

/* From here on there is no way back. */
static fp3_status settle(fp3_engine *engine, fp3_layout *layout, luggage *l) {
    const fp3_layout old = engine->layout;
    engine->layout = *layout;
    *layout = old;
    engine->clock = 0;
    engine->is_slept_known = engine->is_listed = 0;
    engine->is_touched = 1;
    fp3_status status = engine->backend->load(engine);
    if (!status && l->objects)
        status = move(engine, l, 1);
    for (uint32_t i = 0; !status && i < engine->layout.count; i++)
        status = write_constants(engine, i);
    return status;
}

static fp3_status load(fp3_engine *engine, const fp3_group *groups, size_t count, int check) {
    fp3_layout layout = {0};
    luggage l = {0};
    fp3_status status = check_groups(engine, groups, count);
    if (!status)
        status = prepare_all(engine, groups, count, check, &layout);
    if (!status && engine->is_touched && !fp3_layout_is_same(&engine->layout, &layout))
        status = pack(engine, &l);
    if (!status)
        status = settle(engine, &layout, &l);
    fp3_layout_free(&layout);
    free(l.objects);
    free(l.constants);
    return status;
}

fp3_status fp3_engine_load_groups(fp3_engine *engine, const fp3_group *groups, size_t count) {
    return load(engine, groups, count, 1);
}

fp3_status fp3_engine_load(fp3_engine *engine, const fp3_image *image) {
    return load(engine, &(fp3_group){image, engine->objects}, 1, 1);
}

fp3_status fp3_engine_load_unchecked(fp3_engine *engine, const fp3_image *image) {
    return load(engine, &(fp3_group){image, engine->objects}, 1, 0);
}

size_t fp3_engine_groups(const fp3_engine *engine) { return engine->layout.count; }

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
    for (uint32_t i = 0; !status && i < engine->layout.count; i++) {
        const fp3_members *group = &engine->layout.groups[i];
        const int is_asked =
            first < (size_t)group->first + group->objects && first + count > group->first;
        if (is_asked && reg >> group->log2)
            status =
                fp3_fail(engine->def.error, FP3_E_ARGUMENT,
                         "register %" PRIu32 ": the store of configuration '%s' has room for %u "
                         "registers of each of %" PRIu32 " objects",
                         reg, engine->config->name, 1u << group->log2, group->objects);
    }
    return status;
}

/* The sleep register may be written: the host's copy and what a run begins with follow. */
static fp3_status write_cell(fp3_engine *engine, size_t object, uint32_t reg, uint32_t bits) {
    const int slept = slept_of(engine, object);
    if (slept >= 0 && reg == (uint32_t)slept) {
        engine->slept[object] = bits;
        engine->is_listed = 0;
    }
    engine->is_touched = 1;
    return engine->backend->write(engine, object, reg, bits);
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
        if (!(status = engine->backend->read(engine, first + i, reg, &bits)))
            memcpy(&values[i], &bits, sizeof bits);
    }
    return status;
}

static fp3_status check_shared(fp3_engine *engine, size_t group, uint32_t first, size_t count) {
    if (group >= engine->layout.count)
        return fp3_fail(engine->def.error, FP3_E_ARGUMENT, "group %zu: there are %" PRIu32, group,
                        engine->layout.count);
    return check_range(engine, "shared constant", first, count, engine->config->registers);
}

fp3_status fp3_engine_write_shared_of(fp3_engine *engine, size_t group, uint32_t first,
                                      size_t count, const float *values) {
    fp3_status status = check_shared(engine, group, first, count);
    for (uint32_t i = 0; !status && i < count; i++) {
        uint32_t bits;
        memcpy(&bits, &values[i], sizeof bits);
        engine->is_touched = 1;
        status = engine->backend->write_shared(engine, (uint32_t)group, first + i, bits);
    }
    return status;
}

fp3_status fp3_engine_read_shared_of(fp3_engine *engine, size_t group, uint32_t first, size_t count,
                                     float *values) {
    fp3_status status = check_shared(engine, group, first, count);
    for (uint32_t i = 0; !status && i < count; i++) {
        uint32_t bits = 0;
        if (!(status = engine->backend->read_shared(engine, (uint32_t)group, first + i, &bits)))
            memcpy(&values[i], &bits, sizeof bits);
    }
    return status;
}

fp3_status fp3_engine_write_shared(fp3_engine *engine, uint32_t first, size_t count,
                                   const float *values) {
    fp3_status status = FP3_OK;
    for (size_t i = 0; !status && i < engine->layout.count; i++)
        status = fp3_engine_write_shared_of(engine, i, first, count, values);
    return status;
}

fp3_status fp3_engine_read_shared(fp3_engine *engine, uint32_t first, size_t count, float *values) {
    return fp3_engine_read_shared_of(engine, 0, first, count, values);
}

static fp3_status check_loaded(fp3_engine *engine) {
    return engine->layout.groups[0].image
               ? FP3_OK
               : fp3_fail(engine->def.error, FP3_E_ARGUMENT, "no program is loaded");
}

static fp3_status no_name(fp3_engine *engine, const char *name) {
    return fp3_fail(engine->def.error, FP3_E_ARGUMENT, "the program has no parameter '%s'", name);
}

static fp3_status set_symbol(fp3_engine *engine, uint32_t number, const fp3_symbol *symbol,
                             float value) {
    const fp3_members *group = &engine->layout.groups[number];
    fp3_status status = FP3_OK;
    if (symbol->symbol_class == FP3_SYMBOL_SHARED)
        return fp3_engine_write_shared_of(engine, number, symbol->index, 1, &value);
    for (size_t i = 0; !status && i < group->objects; i++)
        status = fp3_engine_write(engine, group->first + i, 1, symbol->index, &value);
    return status;
}

fp3_status fp3_engine_set(fp3_engine *engine, const char *name, float value) {
    int is_found = 0;
    fp3_status status = check_loaded(engine);
    for (uint32_t i = 0; !status && i < engine->layout.count; i++) {
        const fp3_symbol *symbol =
            fp3_image_find(engine->layout.groups[i].image, name, FP3_CLASSES_HOST);
        if (symbol)
            status = set_symbol(engine, i, symbol, value);
        is_found |= symbol != NULL;
    }
    return status || is_found ? status : no_name(engine, name);
}

fp3_status fp3_engine_get(fp3_engine *engine, size_t object, const char *name, float *value) {
    fp3_status status = check_loaded(engine);
    if (status)
        return status;
    const fp3_members *group = group_of(engine, object);
    const fp3_symbol *symbol =
        fp3_image_find(group->image, name, FP3_CLASSES_OBJECT | FP3_CLASSES_SHARED);
    if (!symbol)
        return no_name(engine, name);
    if (FP3_CLASS(symbol->symbol_class) & FP3_CLASSES_SHARED)
        return fp3_engine_read_shared_of(engine, (size_t)(group - engine->layout.groups),
                                         symbol->index, 1, value);
    return fp3_engine_read(engine, object, 1, symbol->index, value);
}

/* ---- run ---- */

/* Brings the host's copy of all sleep registers up to date. */
static fp3_status look_who_sleeps(fp3_engine *engine) {
    fp3_status status = FP3_OK;
    if (engine->is_slept_known)
        return FP3_OK;
    for (uint32_t i = 0; !status && i < engine->objects; i++) {
        const int slept = slept_of(engine, i);
        if (slept >= 0)
            status = engine->backend->read(engine, i, (uint32_t)slept, &engine->slept[i]);
    }
    engine->is_slept_known = !status;
    return status;
}

static fp3_status list_who_is_awake(fp3_engine *engine) {
    if (!engine->config->interleave || engine->is_listed)
        return FP3_OK;
    fp3_status status = look_who_sleeps(engine);
    if (!status)
        status = engine->backend->list(engine);
    engine->is_listed = !status;
    return status;
}

static void sum_counters(const fp3_engine *engine, fp3_stats *stats) {
    for (uint32_t scheduler = 0; scheduler < stats->schedulers; scheduler++)
        for (int i = 0; i < FP3_COUNTER_COUNT; i++) {
            const uint64_t n = engine->counters[scheduler][i];
            if (i != FP3_COUNTER_CYCLES)
                stats->counter[i] += n;
            else if (n > stats->counter[i])
                stats->counter[i] = n;
        }
}

/* Steps that an object made; its copy of the sleep register has what it held before. */
static fp3_status count_steps_of(fp3_engine *engine, uint32_t object, uint32_t steps,
                                 uint64_t *made) {
    const int slept = slept_of(engine, object);
    uint32_t *now = &engine->slept[object];
    if (slept >= 0 && *now)
        return FP3_OK;
    fp3_status status =
        slept < 0 ? FP3_OK : engine->backend->read(engine, object, (uint32_t)slept, now);
    *made += slept >= 0 && *now ? *now - engine->clock : steps;
    return status;
}

static fp3_status count_steps(fp3_engine *engine, uint32_t steps, fp3_stats *stats) {
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; i < engine->layout.count; i++) {
        fp3_members *group = &engine->layout.groups[i];
        for (uint32_t n = 0; !status && n < group->objects; n++)
            status = count_steps_of(engine, group->first + n, steps, &group->steps);
        stats->object_steps += group->steps;
    }
    return status;
}

/* After an end before its time nobody knows who slept, and the lists are in pieces. */
static fp3_status run(fp3_engine *engine, uint32_t steps, fp3_stats *stats) {
    memset(engine->counters, 0, fp3_config_schedulers(engine->config) * sizeof *engine->counters);
    for (uint32_t i = 0; i < engine->layout.count; i++)
        engine->layout.groups[i].steps = 0;
    fp3_status status = list_who_is_awake(engine);
    if (status)
        return status;
    engine->is_slept_known = engine->is_listed = 0;
    engine->is_touched = 1;
    status = engine->backend->run(engine, steps, stats);
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

fp3_status fp3_engine_scheduler_counters(fp3_engine *engine, uint32_t scheduler,
                                         uint64_t counter[FP3_COUNTER_COUNT]) {
    const uint32_t schedulers = fp3_config_schedulers(engine->config);
    fp3_status status = check_range(engine, "scheduler", scheduler, 1, schedulers);
    if (!status)
        memcpy(counter, engine->counters[scheduler], sizeof engine->counters[scheduler]);
    return status;
}

uint64_t fp3_engine_group_steps(const fp3_engine *engine, size_t group) {
    return group < engine->layout.count ? engine->layout.groups[group].steps : 0;
}

fp3_status fp3_engine_scheduler_share(fp3_engine *engine, uint32_t scheduler,
                                      fp3_scheduler_share *place) {
    fp3_status status =
        check_range(engine, "scheduler", scheduler, 1, fp3_config_schedulers(engine->config));
    if (!status)
        *place =
            (fp3_scheduler_share){engine->layout.duty[scheduler].group,
                                  fp3_layout_objects(&engine->layout, engine->config, scheduler)};
    return status;
}

/* ---- the status of objects ---- */

static fp3_status read_status(fp3_engine *engine, size_t object, fp3_object_status *status) {
    uint32_t word = 0;
    fp3_status result =
        engine->config->status ? engine->backend->read_status(engine, object, &word) : FP3_OK;
    *status = (fp3_object_status){.flags = word & ((2u << FP3_STATUS_FLAGS_HI) - 1),
                                  .failed = word >> FP3_STATUS_STEP_LO};
    const int slept = slept_of(engine, object);
    if (!result && slept >= 0)
        result = engine->backend->read(engine, object, (uint32_t)slept, &status->slept);
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
        status = engine->backend->write_status(engine, first + i, 0);
    return status;
}

static fp3_status set_slept(fp3_engine *engine, size_t first, size_t count, uint32_t bits) {
    fp3_status status = check_loaded(engine);
    if (!status)
        status = check_objects(engine, first, count);
    for (size_t i = 0; !status && i < count; i++)
        if (slept_of(engine, first + i) < 0)
            status = fp3_fail(engine->def.error, FP3_E_PROGRAM,
                              "the program has no sleep: that of object %zu", first + i);
    for (size_t i = 0; !status && i < count; i++)
        status = write_cell(engine, first + i, (uint32_t)slept_of(engine, first + i), bits);
    return status;
}

fp3_status fp3_engine_wake(fp3_engine *engine, size_t first, size_t count) {
    return set_slept(engine, first, count, 0);
}

fp3_status fp3_engine_remove(fp3_engine *engine, size_t first, size_t count) {
    return set_slept(engine, first, count, FP3_REMOVED);
}
