/* SPDX-License-Identifier: Apache-2.0 */
/* batch.c - see fp3/batch.h. */
#include "batch.h"

#include "batch_own.h"

#include "base/definition.h"
#include "base/host.h"
#include "compiler/start.h"
#include "engine/common/inside.h"

#include "machine/placement.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define CONFIG "many_full" /* of objects that do not see each other */

void fp3_batch_set_default(fp3_batch_def *def, size_t size) {
    if (!fp3_definition_begin(def, size, sizeof *def))
        return;
    def->objects = 1;
    def->engine = "fast";
    def->compile = fp3_compile_default();
    def->compile.config = NULL;
    def->compile.is_for_host = 1;
}

/* ---- open and close ---- */

static fp3_status open_program(const fp3_batch_def *def, fp3_batch *b) {
    fp3_program_def how = fp3_program_default();
    how.integrator = def->integrator;
    how.is_adaptive = def->adaptive != NULL;
    if (def->adaptive) {
        if (fp3_definition_check(def->adaptive, sizeof *def->adaptive, "fp3_adaptive_def",
                                 def->error))
            return FP3_E_ARGUMENT;
        how.adaptive = *def->adaptive;
    }
    how.compile = def->compile;
    how.alone = CONFIG;
    const int sources = (def->model != NULL) + (def->text != NULL) + (def->compiled != NULL);
    if (sources != 1)
        return fp3_fail(def->error, FP3_E_ARGUMENT,
                        "%d of model, text and compiled are given: expected one", sources);
    b->compiled = def->compiled;
    if (def->compiled) {
        const int sees_others = fp3_start_model(def->compiled)->relation_count > 0;
        b->image = def->compiled->image;
        b->config = def->compile.config ? def->compile.config : sees_others ? FP3_WORLD : CONFIG;
        return FP3_OK;
    }
    const fp3_status status =
        def->model ? fp3_program_open(def->model, &how, &b->program, NULL, def->error)
                   : fp3_program_read(def->text, def->text_size, "text", &how, &b->program, NULL,
                                      def->error);
    if (status)
        return status;
    b->compiled = b->program->compiled;
    b->image = b->program->image;
    b->config = how.compile.config ? how.compile.config : b->program->config;
    if (!b->config)
        b->config = CONFIG;
    return FP3_OK;
}

static fp3_status open_engine(const fp3_batch_def *def, fp3_batch *b) {
    fp3_engine_def how = fp3_engine_default();
    how.engine = def->engine;
    how.config = b->config;
    how.objects = (uint32_t)def->objects;
    how.threads = def->threads;
    how.native = def->native;
    how.is_interpreted = !def->may_compile && !def->native;
    how.is_without_compiler = !def->may_compile;
    how.tasks = def->tasks;
    how.tasks_user = def->tasks_user;
    how.allocator = def->allocator;
    how.error = def->error;
    const fp3_status status = fp3_engine_open(&how, &b->engine);
    return status ? status : fp3_engine_load(b->engine, b->image);
}

static fp3_status make(const fp3_batch_def *def, fp3_batch *b) {
    if (!def->objects || def->objects > UINT32_MAX)
        return fp3_fail(def->error, FP3_E_ARGUMENT, "%zu objects: expected 1 to %" PRIu32,
                        def->objects, FP3_HOST_OBJECTS);
    fp3_status status = open_program(def, b);
    if (!status)
        status = open_engine(def, b);
    if (status)
        return status;
    b->h = def->h != 0 ? def->h : b->compiled ? fp3_start_model(b->compiled)->step : 0;
    b->is_adaptive = fp3_adaptive_is(b->image);
    b->may_sleep = fp3_image_slept(b->image) >= 0;
    const fp3_fields_def all = {.engine = b->engine,
                                .objects = b->objects,
                                .image = b->image,
                                .compiled = b->compiled,
                                .h = b->h};
    status = fp3_fields_open(&all, &b->fields, def->error);
    b->relations = (fp3_relations){.to = all, .skin = def->skin > 0 ? def->skin : FP3_NEAR_SKIN};
    b->is_reach_new = 1;
    if (!status)
        status = fp3_births_open(b->objects, def->is_empty, &b->births, def->error);
    if (!status && def->is_empty)
        status = fp3_engine_can_bury(b->engine);
    if (!status)
        status = fp3_batch_tell_lives(b);
    if (!status)
        status = fp3_relations_load(&b->relations, def->error);
    return status || def->h == 0 ? status : fp3_batch_set(b, FP3_NAME_STEP, def->h);
}

fp3_status fp3_batch_open(const fp3_batch_def *def, fp3_batch **batch) {
    FP3_HOST;
    *batch = NULL;
    if (fp3_definition_check(def, sizeof *def, "fp3_batch_def",
                             fp3_definition_error(def, def->error)))
        return FP3_E_ARGUMENT;
    fp3_batch *b = calloc(1, sizeof *b);
    if (!b)
        return fp3_no_memory(def->error);
    b->error = def->error;
    b->may_fail = def->may_fail;
    b->objects = def->objects;
    const fp3_status status = make(def, b);
    if (status)
        fp3_batch_close(&b);
    *batch = b;
    return status;
}

void fp3_batch_close(fp3_batch **batch) {
    fp3_batch *b = *batch;
    if (!b)
        return;
    fp3_fields_close(&b->fields);
    fp3_births_close(&b->births);
    fp3_met_free(&b->met);
    fp3_linked_free(&b->relations.linked);
    fp3_engine_close(&b->engine);
    fp3_program_close(&b->program);
    free(b);
    *batch = NULL;
}

size_t fp3_batch_objects(const fp3_batch *batch) { return batch ? batch->objects : 0; }
fp3_engine *fp3_batch_engine(fp3_batch *batch) { return batch ? batch->engine : NULL; }
const fp3_compiled *fp3_batch_compiled(const fp3_batch *batch) {
    return batch ? batch->compiled : NULL;
}

/* ---- values ---- */

fp3_status fp3_batch_set(fp3_batch *b, const char *name, double value) {
    FP3_HOST;
    if (!b)
        return FP3_E_ARGUMENT;
    const fp3_status status = fp3_fields_set(b->fields, name, value, b->error);
    b->is_reach_new = 1;
    if (status || strcmp(name, FP3_NAME_STEP) != 0)
        return status;
    b->before = fp3_batch_time(b);
    b->since = 0;
    b->h = value;
    return FP3_OK;
}

fp3_status fp3_batch_write(fp3_batch *b, const char *name, size_t first, size_t count,
                           const float *values) {
    FP3_HOST;
    if (!b)
        return FP3_E_ARGUMENT;
    return fp3_fields_write(b->fields, name, first, count, (fp3_numbers){.single = values},
                            b->error);
}

fp3_status fp3_batch_write_double(fp3_batch *b, const char *name, size_t first, size_t count,
                                  const double *values) {
    FP3_HOST;
    if (!b)
        return FP3_E_ARGUMENT;
    return fp3_fields_write(b->fields, name, first, count, (fp3_numbers){.wide = values}, b->error);
}

fp3_status fp3_batch_read(fp3_batch *b, const char *const *names, size_t name_count, size_t first,
                          size_t count, float *const *values) {
    FP3_HOST;
    if (!b)
        return FP3_E_ARGUMENT;
    fp3_status status = FP3_OK;
    for (size_t i = 0; !status && i < name_count; i++)
        status = fp3_fields_read(b->fields, names[i], first, count, values[i], NULL, b->error);
    return status;
}

fp3_status fp3_batch_read_double(fp3_batch *b, const char *const *names, size_t name_count,
                                 size_t first, size_t count, double *const *values) {
    FP3_HOST;
    if (!b)
        return FP3_E_ARGUMENT;
    fp3_status status = FP3_OK;
    for (size_t i = 0; !status && i < name_count; i++)
        status = fp3_fields_read(b->fields, names[i], first, count, NULL, values[i], b->error);
    return status;
}

static fp3_status check_strided(const fp3_batch *b, size_t name_count, size_t first, size_t count,
                                size_t stride) {
    if (stride < name_count)
        return fp3_fail(b->error, FP3_E_ARGUMENT,
                        "stride %zu: expected at least %zu, one for each name", stride, name_count);
    return fp3_fields_check(b->fields, first, count, b->error);
}

/* Columns of a batch lie together, those of the caller apart. */
static fp3_status read_one(fp3_batch *b, const char *name, size_t first, size_t count,
                           float *values, size_t stride) {
    float *column = malloc((count + 1) * sizeof *column);
    fp3_status status = column
                            ? fp3_fields_read(b->fields, name, first, count, column, NULL, b->error)
                            : fp3_no_memory(b->error);
    for (size_t i = 0; !status && i < count; i++)
        values[i * stride] = column[i];
    free(column);
    return status;
}

static fp3_status write_one(fp3_batch *b, const char *name, size_t first, size_t count,
                            const float *values, size_t stride) {
    float *column = malloc((count + 1) * sizeof *column);
    fp3_status status = column ? FP3_OK : fp3_no_memory(b->error);
    for (size_t i = 0; !status && i < count; i++)
        column[i] = values[i * stride];
    if (!status)
        status = fp3_fields_write(b->fields, name, first, count, (fp3_numbers){.single = column},
                                  b->error);
    free(column);
    return status;
}

fp3_status fp3_batch_read_strided(fp3_batch *b, const char *const *names, size_t name_count,
                                  size_t first, size_t count, float *values, size_t stride) {
    FP3_HOST;
    if (!b)
        return FP3_E_ARGUMENT;
    fp3_status status = check_strided(b, name_count, first, count, stride);
    for (size_t i = 0; !status && i < name_count; i++)
        status = read_one(b, names[i], first, count, values + i, stride);
    return status;
}

fp3_status fp3_batch_write_strided(fp3_batch *b, const char *const *names, size_t name_count,
                                   size_t first, size_t count, const float *values, size_t stride) {
    FP3_HOST;
    if (!b)
        return FP3_E_ARGUMENT;
    fp3_status status = check_strided(b, name_count, first, count, stride);
    for (size_t i = 0; !status && i < name_count; i++)
        status = write_one(b, names[i], first, count, values + i, stride);
    return status;
}

fp3_status fp3_batch_column(fp3_batch *b, const char *name, const float **values) {
    FP3_HOST;
    if (!b)
        return FP3_E_ARGUMENT;
    return fp3_fields_column(b->fields, name, values, b->error);
}

fp3_status fp3_batch_write_rows(fp3_batch *b, size_t first, size_t count, const double *params,
                                const double *initial) {
    return fp3_fields_write_rows(b->fields, first, count, params, initial, b->error);
}

/* ---- steps ---- */

#define BLOCK 64 /* objects that are looked at together */

/* An object that has used up its attempts but may go on has not failed: the next step gives it new
 * attempts. */
static int has_failed(const fp3_adaptive_object *o) {
    const int may_go_on = o->end == FP3_ADAPTIVE_LIMITED && !o->state[0];
    return !may_go_on && !fp3_adaptive_is_over(o->end);
}

static fp3_status find_failed(const fp3_batch *b, fp3_failure *found,
                              char text[FP3_ADAPTIVE_TEXT_SIZE]) {
    fp3_status status = FP3_OK;
    for (size_t done = 0, now; !status && done < b->objects; done += now) {
        fp3_adaptive_object o[BLOCK];
        now = b->objects - done < BLOCK ? b->objects - done : BLOCK;
        status = fp3_adaptive_look_all(b->engine, done, now, o);
        for (size_t i = 0; !status && i < now; i++)
            if (b->births.lives[done + i] && has_failed(&o[i]) && !found->failed++) {
                found->object = done + i;
                found->step = o[i].accepted;
                fp3_adaptive_text(found->object, &o[i], text);
            }
    }
    return status;
}

static fp3_status tell_adaptive(const fp3_batch *b) {
    fp3_failure found = {0};
    char text[FP3_ADAPTIVE_TEXT_SIZE];
    const fp3_status status = find_failed(b, &found, text);
    if (status || !found.failed)
        return status;
    return fp3_fail(b->error, FP3_E_FAILED, "%zu of %zu objects failed, first %s", found.failed,
                    b->births.living, text);
}

/* Values of a model are finite when a run begins. Without a flag that can end this, states are not
 * checked. */
static fp3_status tell_failures(fp3_batch *b) {
    fp3_failure found;
    char text[FP3_FAILURE_TEXT_SIZE];
    if (b->is_adaptive)
        return tell_adaptive(b);
    if (b->compiled && !b->is_suspect && !fp3_engine_may_have_failed(b->engine))
        return FP3_OK;
    const fp3_status status = fp3_batch_failure(b, &found, text);
    b->is_suspect = status || found.failed; /* a NaN stays one, and raises nothing */
    if (status || !found.failed)
        return status;
    return fp3_fail(b->error, FP3_E_FAILED, "%zu of %zu objects failed, first %s", found.failed,
                    b->births.living, text);
}

fp3_status fp3_batch_run(fp3_batch *b, uint64_t steps) {
    FP3_HOST;
    if (!b)
        return FP3_E_ARGUMENT;
    fp3_status status = fp3_fields_settle(b->fields, b->error);
    if (!status)
        status = fp3_batch_settle_reach(b);
    if (!status)
        status = fp3_relations_check(&b->relations, "fp3_batch_link gives them", b->error);
    if (!status && b->is_adaptive && b->may_sleep) /* `until` may be later now */
        status = fp3_engine_wake(b->engine, 0, b->objects);
    if (!status && b->births.living)
        status = b->is_adaptive ? fp3_adaptive_run(b->engine, steps, NULL)
                                : fp3_engine_run(b->engine, steps, NULL);
    if (status || !steps)
        return status;
    fp3_fields_moved(b->fields);
    b->since += steps;
    return b->may_fail || !b->births.living ? FP3_OK : tell_failures(b);
}

double fp3_batch_time(const fp3_batch *b) { return b ? b->before + (double)b->since * b->h : 0; }

fp3_status fp3_batch_restart(fp3_batch *b) {
    if (!b)
        return FP3_E_ARGUMENT;
    fp3_status status = fp3_engine_load(b->engine, b->image); /* all live, always */
    const fp3_status told = fp3_batch_tell_lives(b);
    status = status ? status : told;
    if (status)
        return status;
    fp3_fields_restart(b->fields);
    b->before = 0;
    b->since = 0;
    b->is_reach_new = 1;
    return fp3_relations_load(&b->relations, b->error);
}

fp3_status fp3_batch_failure(fp3_batch *b, fp3_failure *failure, char text[FP3_FAILURE_TEXT_SIZE]) {
    *failure = (fp3_failure){0};
    if (text)
        text[0] = '\0';
    if (!b)
        return FP3_E_ARGUMENT;
    if (b->is_adaptive) {
        char why[FP3_ADAPTIVE_TEXT_SIZE] = "";
        const fp3_status status = find_failed(b, failure, why);
        if (text)
            snprintf(text, FP3_FAILURE_TEXT_SIZE, "%.*s", FP3_FAILURE_TEXT_SIZE - 1, why);
        return status;
    }
    const fp3_status status =
        b->births.living ? fp3_engine_failure(b->engine, 0, b->objects, failure) : FP3_OK;
    if (!status && text && failure->failed)
        fp3_engine_failure_text(b->engine, failure, text);
    return status;
}
