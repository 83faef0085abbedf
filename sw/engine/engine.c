/* SPDX-License-Identifier: Apache-2.0 */
/* engine.c - opens and closes engines of every backend. */
#include "engine/common/backend.h"
#include "engine/common/checks.h"
#include "engine/common/life.h"
#include "engine/common/origin.h"

#include "base/definition.h"
#include "gen/registers.h"
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

static const fp3_backend *const backends[] = {&fp3_backend_rtl, &fp3_backend_isa, &fp3_backend_fast,
                                              &fp3_backend_board};

#define COUNT(array) (sizeof(array) / sizeof *(array))

void fp3_engine_set_default(fp3_engine_def *def, size_t size) {
    if (!fp3_definition_begin(def, size, sizeof *def))
        return;
    def->engine = fp3_engine_usual(0);
    def->config = "single";
}

/* NULL with an error: there is none. */
static const fp3_backend *find(const char *name, fp3_error *error) {
    for (size_t i = 0; i < COUNT(backends); i++)
        if (name && strcmp(backends[i]->is.name, name) == 0)
            return backends[i];
    char all[80] = "";
    for (size_t i = 0; i < COUNT(backends); i++) {
        strcat(all, i == 0 ? "" : i + 1 < COUNT(backends) ? ", " : " and ");
        strcat(all, backends[i]->is.name);
    }
    fp3_fail(error, FP3_E_ARGUMENT, "no engine '%s': there are %s", name ? name : "", all);
    return NULL;
}

const fp3_engine_traits *fp3_engine_traits_of(const char *name, fp3_error *error) {
    const fp3_backend *backend = find(name, error);
    return backend ? &backend->is : NULL;
}

const char *fp3_engine_usual(int sees_others) {
    return sees_others ? fp3_backend_fast.is.name : fp3_backend_rtl.is.name;
}

static uint32_t room_of(const fp3_backend *backend, const fp3_config *config) {
    return backend->is_in_host && config->interleave ? FP3_HOST_OBJECTS
                                                     : fp3_placement_room(config);
}

size_t fp3_engine_room(const char *engine, const char *config) {
    const fp3_backend *backend = find(engine, NULL);
    const fp3_config *of = fp3_config_find(config);
    return backend && of ? room_of(backend, of) : 0;
}

fp3_status fp3_engine_agree(fp3_engine *engine, const void *words, size_t size) {
    return engine->backend->agree ? engine->backend->agree(engine, words, size) : FP3_OK;
}

const char *fp3_engine_how(const fp3_engine *engine) {
    return engine->backend->how ? engine->backend->how(engine) : "";
}

fp3_status fp3_engine_write_native(fp3_engine *engine, const char *path) {
    fp3_status status = fp3_engine_check_loaded(engine);
    if (!status && (!engine->backend->write_native || engine->layout.count != 1))
        status =
            fp3_fail(engine->def.error, FP3_E_ARGUMENT,
                     "native code is of engine 'fast' with one program, not of '%s' with %" PRIu32,
                     engine->backend->is.name, engine->layout.count);
    return status ? status : engine->backend->write_native(engine, path);
}

static fp3_status count_objects(fp3_engine *engine) {
    const fp3_config *config = engine->config;
    const uint32_t columns = fp3_config_schedulers(config) * config->lanes;
    const uint32_t most = room_of(engine->backend, config);
    const uint32_t full = config->contexts * columns;
    engine->objects = engine->def.objects ? engine->def.objects : full < most ? full : most;
    if (engine->objects > most || !most)
        return fp3_fail(engine->def.error, FP3_E_ARGUMENT,
                        "%" PRIu32 " objects: configuration '%s' has room for %" PRIu32 " %s",
                        engine->objects, config->name, most,
                        config->interleave ? "at most"
                                           : "object; 'many' and 'many_full' have room for more");
    return FP3_OK;
}

/* All objects in all schedulers, without a program. */
static fp3_status place_objects(fp3_engine *engine) {
    fp3_layout *layout = &engine->layout;
    fp3_status status = fp3_layout_make(engine->config, 1, layout, engine->def.error);
    if (status)
        return status;
    layout->groups[0].objects = layout->groups[0].rows = engine->objects;
    layout->groups[0].program.slept = layout->groups[0].counter = -1;
    return fp3_layout_place(layout, engine->config, engine->def.visit, engine->def.error);
}

static fp3_status check_seed(const fp3_engine *engine) {
    if (!engine->def.seed || engine->config->storage)
        return FP3_OK;
    return fp3_fail(engine->def.error, FP3_E_ARGUMENT,
                    "seed: configuration '%s' keeps records in 32 bits, so stores round nothing",
                    engine->config->name);
}

static fp3_status make_room(fp3_engine *engine) {
    fp3_status status = count_objects(engine);
    if (!status)
        status = place_objects(engine);
    if (status)
        return status;
    engine->sleepers.slept = calloc(engine->objects, sizeof *engine->sleepers.slept);
    engine->counters = calloc(fp3_config_schedulers(engine->config), sizeof *engine->counters);
    engine->sums = calloc(fp3_config_schedulers(engine->config), sizeof *engine->sums);
    status = fp3_origin_open(engine);
    if (status)
        return status;
    return engine->sleepers.slept && engine->counters && engine->sums
               ? FP3_OK
               : fp3_no_memory(engine->def.error);
}

/* What only some engines have. */
static fp3_status check_bus(const fp3_engine_def *def, const fp3_backend *backend) {
    const int is_rtl = backend == &fp3_backend_rtl, is_board = backend == &fp3_backend_board;
    if (def->bus_log && !is_rtl && !is_board)
        return fp3_fail(def->error, FP3_E_ARGUMENT,
                        "bus log %s: engine '%s' has no bus; rtl and board have", def->bus_log,
                        def->engine);
    if (def->bus_waits && !is_rtl)
        return fp3_fail(def->error, FP3_E_ARGUMENT,
                        "bus_waits: engine '%s' has no such bus; rtl has", def->engine);
    if ((def->port || def->baud) && !is_board)
        return fp3_fail(def->error, FP3_E_ARGUMENT, "port: engine '%s' has none; board has",
                        def->engine);
    return FP3_OK;
}

fp3_status fp3_engine_check(const fp3_engine_def *def, const fp3_backend **found,
                            const fp3_config **config) {
    if (fp3_definition_check(def, sizeof *def, "fp3_engine_def",
                             fp3_definition_error(def, def->error)))
        return FP3_E_ARGUMENT;
    const fp3_backend *backend = find(def->engine, def->error);
    if (!backend)
        return FP3_E_ARGUMENT;
    *found = backend;
    fp3_status status = check_bus(def, backend);
    if (!status && def->native && !backend->write_native)
        status = fp3_fail(def->error, FP3_E_ARGUMENT,
                          "native %s: engine '%s' executes no native code; fast does", def->native,
                          def->engine);
    return status ? status : fp3_config_choose(def->config, config, def->error);
}

fp3_status fp3_engine_open(const fp3_engine_def *def, fp3_engine **engine) {
    const fp3_config *config = NULL;
    const fp3_backend *backend = NULL;
    *engine = NULL;
    const fp3_status status = fp3_engine_check(def, &backend, &config);
    return status ? status : fp3_engine_open_on(def, config, backend, NULL, engine);
}

fp3_status fp3_engine_open_as(const fp3_engine_def *def, const fp3_config *config,
                              fp3_engine **engine) {
    const fp3_backend *backend = find(def->engine, def->error);
    *engine = NULL;
    return backend ? fp3_engine_open_on(def, config, backend, NULL, engine) : FP3_E_ARGUMENT;
}

fp3_status fp3_engine_open_on(const fp3_engine_def *def, const fp3_config *config,
                              const fp3_backend *backend, void *self, fp3_engine **engine) {
    *engine = NULL;
    fp3_engine *made = calloc(1, sizeof *made);
    if (!made)
        return fp3_no_memory(def->error);
    *made = (fp3_engine){
        .backend = backend, .config = config, .own = *config, .def = *def, .self = self};
    if (backend->is_in_host && config->interleave)
        made->own.store_words = FP3_STORE_HOST;
    made->config = &made->own;
    fp3_status status = check_seed(made);
    if (!status)
        status = make_room(made);
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
    fp3_life_forget(closing);
    free(closing->sleepers.slept);
    free(closing->sleepers.awake);
    free(closing->counters);
    free(closing->sums);
    free(closing->failures.list);
    fp3_origin_close(closing);
    free(closing);
    *engine = NULL;
}

size_t fp3_engine_objects(const fp3_engine *engine) { return engine->objects; }

fp3_bus_use fp3_engine_bus(const fp3_engine *engine) { return engine->bus; }

size_t fp3_engine_groups(const fp3_engine *engine) { return engine->layout.count; }

/* ---- what the project itself asks ---- */

const char *fp3_engine_name(const fp3_engine *engine) { return engine->backend->is.name; }

int fp3_engine_is_divided(const fp3_engine *engine) { return engine->backend->is_divided; }

fp3_engine_def *fp3_engine_definition(fp3_engine *engine) { return &engine->def; }

void fp3_engine_hush(fp3_error *error) {
    if (error)
        *error = (fp3_error){.text = ""};
}

fp3_status fp3_engine_hear(fp3_engine *engine, fp3_status status, fp3_error *error) {
    const fp3_error *said = engine->def.error;
    if (!status || !error || *error->text)
        return status;
    if (!said)
        return fp3_fail(error, status, "refused by engine %s, whose definition has no error",
                        fp3_engine_name(engine));
    *error = *said;
    return status;
}

fp3_config *fp3_engine_config(fp3_engine *engine) { return &engine->own; }

const uint32_t *fp3_engine_rows(const fp3_engine *engine) {
    return engine->backend->rows ? engine->backend->rows(engine) : NULL;
}
const fp3_layout *fp3_engine_layout(const fp3_engine *engine) { return &engine->layout; }

uint32_t *fp3_engine_clock(fp3_engine *engine) { return &engine->clock; }

int fp3_engine_has_lives(const fp3_engine *engine) { return fp3_lives_vary(engine); }

const fp3_failed *fp3_engine_failures(const fp3_engine *engine, size_t *count) {
    *count = engine->failures.count;
    return engine->failures.list;
}
