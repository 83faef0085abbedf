/* SPDX-License-Identifier: Apache-2.0 */
/* machines.c - see machines.h. */
#include "machines.h"
#include "engine/common/inside.h"

#include <stdlib.h>
#include <string.h>

#define ENGINES_MOST 64

typedef struct {
    const char *name, *config;
    unsigned threads;
    uint64_t objects;
    fp3_engine *engine;
} machine;

typedef void release_fn(void *what);
typedef struct {
    void *what;
    release_fn *release;
} kept;

struct fp3_measure_machines {
    machine machine[ENGINES_MOST];
    unsigned count;
    kept *kept;
    size_t kept_count;
    int is_interpreted;
    fp3_error error;
};

fp3_status fp3_measure_machines_open(int is_interpreted, fp3_measure_machines **machines,
                                     fp3_error *error) {
    *machines = calloc(1, sizeof **machines);
    if (!*machines)
        return fp3_no_memory(error);
    (*machines)->is_interpreted = is_interpreted;
    return FP3_OK;
}

void fp3_measure_machines_close(fp3_measure_machines **machines) {
    fp3_measure_machines *m = *machines;
    if (!m)
        return;
    for (unsigned i = 0; i < m->count; i++)
        fp3_engine_close(&m->machine[i].engine);
    for (size_t i = 0; i < m->kept_count; i++)
        m->kept[i].release(m->kept[i].what);
    free(m->kept);
    free(m);
    *machines = NULL;
}

const fp3_error *fp3_measure_machines_error(const fp3_measure_machines *machines) {
    return &machines->error;
}

static int is_same(const machine *m, const char *name, const char *config, unsigned threads,
                   uint64_t objects) {
    return !strcmp(m->name, name) && !strcmp(m->config, config) && m->threads == threads &&
           m->objects == objects;
}

fp3_status fp3_measure_machines_engine(fp3_measure_machines *machines, const char *name,
                                       const char *config, unsigned threads, uint64_t objects,
                                       fp3_engine **engine, fp3_error *error) {
    for (unsigned i = 0; i < machines->count; i++)
        if (is_same(&machines->machine[i], name, config, threads, objects)) {
            *engine = machines->machine[i].engine;
            return FP3_OK;
        }
    if (machines->count == ENGINES_MOST)
        return fp3_fail(error, FP3_E_LIMIT, "more than %d engines", ENGINES_MOST);
    machine *m = &machines->machine[machines->count];
    *m = (machine){.name = name, .config = config, .threads = threads, .objects = objects};
    fp3_engine_def def = fp3_engine_default();
    def.engine = name;
    def.config = config;
    def.objects = (uint32_t)objects;
    def.threads = threads;
    def.is_interpreted = machines->is_interpreted;
    def.error = &machines->error;
    fp3_status status = fp3_engine_open(&def, &m->engine);
    if (!status) {
        status = fp3_engine_need_counters(m->engine, &machines->error);
        if (status)
            fp3_engine_close(&m->engine);
    }
    if (status)
        return fp3_fail(error, status, "%s", machines->error.text);
    machines->count++;
    *engine = m->engine;
    return FP3_OK;
}

static fp3_status keep(fp3_measure_machines *machines, void *what, release_fn *release,
                       fp3_error *error) {
    kept *more = realloc(machines->kept, (machines->kept_count + 1) * sizeof *machines->kept);
    if (!more) {
        release(what);
        return fp3_no_memory(error);
    }
    machines->kept = more;
    more[machines->kept_count++] = (kept){what, release};
    return FP3_OK;
}

static void release_model(void *model) { fp3_model_free(&(fp3_model *){model}); }
static void release_program(void *compiled) { fp3_compiled_free(&(fp3_compiled *){compiled}); }

fp3_status fp3_measure_machines_keep(fp3_measure_machines *machines, void *memory,
                                     fp3_error *error) {
    return keep(machines, memory, free, error);
}

fp3_status fp3_measure_machines_keep_model(fp3_measure_machines *machines, fp3_model *model,
                                           fp3_error *error) {
    return keep(machines, model, release_model, error);
}

fp3_status fp3_measure_machines_keep_program(fp3_measure_machines *machines, fp3_compiled *compiled,
                                             fp3_error *error) {
    return keep(machines, compiled, release_program, error);
}
