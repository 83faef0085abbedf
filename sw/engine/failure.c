/* SPDX-License-Identifier: Apache-2.0 */
/* failure.c - which objects failed in a run, found by making it again.
 *
 * The hardware's flags are of a whole run. Where a configuration keeps a status of each object,
 * that has the first step that failed, but not by which exception. All engines give the same bits,
 * so the isa engine makes the run again and watches.
 */
#include "engine/common/checks.h"
#include "engine/common/life.h"
#include "engine/common/origin.h"
#include "machine/ahead.h"
#include "machine/format.h"
#include "machine/live.h"

#include <fp3/isa.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- the end ---- */

#define COLUMN 512 /* objects whose states are looked at together */

static fp3_status look_at_state(fp3_engine *engine, const fp3_members *group, uint32_t reg,
                                fp3_watched *watched, int *is_any) {
    uint32_t words[COLUMN];
    fp3_status status = FP3_OK;
    for (uint32_t n = 0, now; !status && n < group->objects; n += now) {
        now = group->objects - n < COLUMN ? group->objects - n : COLUMN;
        status = fp3_engine_read_words(engine, fp3_members_begin(group) + n, now, reg, words);
        for (uint32_t i = 0; !status && i < now; i++)
            if (!fp3_watch_is_finite(words[i]) &&
                fp3_life_took_part(engine, fp3_members_begin(group) + n + i))
                *is_any = watched[fp3_members_begin(group) + n + i].is_astray = 1;
    }
    return status;
}

/* Whose states are not finite now. */
static fp3_status look_at_states(fp3_engine *engine, fp3_watched *watched, int *is_any) {
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; !status && i < engine->layout.count; i++) {
        const fp3_members *group = &engine->layout.groups[i];
        const uint64_t states = fp3_engine_states_of(group);
        for (uint32_t reg = 0; !status && reg < engine->config->registers; reg++)
            if (states >> reg & 1)
                status = look_at_state(engine, group, reg, watched, is_any);
    }
    return status;
}

/* ---- the run again ---- */

static fp3_status load_again(const fp3_engine *engine, fp3_engine *again) {
    const fp3_layout *layout = &engine->layout;
    fp3_group *groups = calloc(layout->count, sizeof *groups);
    if (!groups)
        return fp3_no_memory(engine->def.error);
    for (uint32_t i = 0; i < layout->count; i++)
        groups[i] =
            (fp3_group){.image = layout->groups[i].image,
                        .objects = layout->count == 1 ? engine->objects : layout->groups[i].rows,
                        .foreign = layout->groups[i].foreign,
                        .foreign_count = layout->groups[i].foreign_count};
    const fp3_status status = fp3_engine_load_again(again, groups, layout->count);
    free(groups);
    for (uint32_t i = 0; !status && i < layout->count; i++) {
        fp3_members *group = &again->layout.groups[i];
        fp3_members_use(group, layout->groups[i].from, layout->groups[i].objects);
        group->rows = layout->groups[i].rows;
    }
    fp3_engine_set_exchange(again, &engine->exchange);
    return status;
}

static fp3_status look_ahead(fp3_engine *again) {
    for (uint32_t i = 0; i < again->layout.count; i++) {
        fp3_members *group = &again->layout.groups[i];
        group->is_ahead = calloc(group->program.count, sizeof *group->is_ahead);
        if (!group->is_ahead)
            return fp3_no_memory(again->def.error);
        fp3_ahead_find(&group->program, fp3_engine_states_of(group), group->is_ahead);
        group->live = fp3_live_between(&group->program);
    }
    return FP3_OK;
}

/* Before any step: whose states are not finite. */
static void watch_start(const fp3_engine *engine, const fp3_members *group, fp3_watched *watched) {
    const fp3_origin *o = engine->origin;
    const uint64_t states = fp3_engine_states_of(group);
    for (uint32_t n = fp3_members_begin(group); n < fp3_members_end(group); n++) {
        uint32_t cells[FP3_BANK_OBJECT_COUNT] = {0};
        for (uint32_t reg = 0; reg < engine->config->registers; reg++)
            cells[reg] = o->registers[(size_t)reg * engine->objects + n];
        fp3_watch_states(&watched[n], 0, states & o->began[n], cells);
    }
}

static fp3_status write_again(const fp3_engine *engine, fp3_watched *watched, fp3_engine *again) {
    const uint32_t registers = engine->config->registers;
    const fp3_origin *o = engine->origin;
    fp3_status status = FP3_OK;
    for (uint32_t reg = 0; !status && reg < registers; reg++)
        status =
            again->backend->write(again, (fp3_cells){FP3_CELLS_REGISTER, reg, 0, again->objects},
                                  &o->registers[(size_t)reg * engine->objects]);
    for (uint32_t i = 0; !status && i < engine->layout.count; i++) {
        watch_start(engine, &engine->layout.groups[i], watched);
        status = again->backend->write(again, (fp3_cells){FP3_CELLS_CONSTANT, i, 0, registers},
                                       &o->constants[(size_t)i * registers]);
    }
    return status;
}

/* *flags: what that run raised, in all. */
static fp3_status run_again(fp3_engine *engine, fp3_watched *watched, uint32_t *flags) {
    fp3_stats stats = {0};
    fp3_config config = *engine->config;
    fp3_engine_def def = fp3_engine_default();
    fp3_engine *again = NULL;
    def.engine = "isa";
    def.objects = engine->objects;
    def.visit = engine->origin->visit;
    def.seed = engine->origin->seed;
    def.error = engine->def.error;
    config.flags = 1; /* the bits are the same with and without */
    fp3_status status = fp3_engine_open_as(&def, &config, &again);
    if (status)
        return status;
    status = load_again(engine, again);
    for (uint32_t i = 0; !status && i < engine->layout.count; i++)
        status = fp3_lists_copy(&engine->layout.groups[i].lists, engine->layout.groups[i].rows,
                                &again->layout.groups[i].lists, again->def.error);
    if (!status)
        status = fp3_origin_remember(engine, NULL, &again->layout, again->def.error);
    for (uint32_t i = 0; !status && again->backend->connect && i < again->layout.count; i++)
        status = again->backend->connect(again, &again->layout.groups[i], NULL);
    again->clock = engine->origin->clock;
    again->made = engine->origin->made;
    if (!status)
        status = fp3_life_copy(engine, again);
    if (!status)
        status = look_ahead(again);
    if (!status)
        status = write_again(engine, watched, again);
    again->watched = watched;
    if (!status)
        status = fp3_engine_run(again, engine->origin->steps, &stats);
    *flags = stats.flags;
    fp3_engine_close(&again);
    return status;
}

/* The repeated run failed as the first one did. flags: raised by it, some for steps that were not
 * made. */
static fp3_status check(fp3_engine *engine, const fp3_watched *watched, uint32_t flags) {
    int is_missed = engine->config->flags &&
                    (!(flags & FP3_FLAGS_GRAVE) != !(engine->origin->flags & FP3_FLAGS_GRAVE));
    for (uint32_t i = 0; i < engine->objects; i++)
        is_missed |= watched[i].is_astray && watched[i].strayed == FP3_NEVER;
    return is_missed ? fp3_fail(engine->def.error, FP3_E_MISMATCH,
                                "the isa engine does not fail as this run did")
                     : FP3_OK;
}

static fp3_status watch_again(fp3_engine *engine, fp3_watched *watched, int is_suspect) {
    uint32_t flags = 0;
    is_suspect |= (engine->origin->flags & FP3_FLAGS_GRAVE) != 0;
    for (uint32_t i = 0; i < engine->objects; i++)
        watched[i].raised = watched[i].strayed = FP3_NEVER;
    fp3_status status = look_at_states(engine, watched, &is_suspect);
    if (!status && is_suspect)
        status = run_again(engine, watched, &flags);
    if (!status && is_suspect)
        status = check(engine, watched, flags);
    return status;
}

fp3_status fp3_engine_suspect(fp3_engine *engine, int *is_suspect) {
    fp3_watched *watched = calloc(engine->objects, sizeof *watched);
    *is_suspect = (engine->origin->flags & FP3_FLAGS_GRAVE) != 0;
    const fp3_status status =
        watched ? look_at_states(engine, watched, is_suspect) : fp3_no_memory(engine->def.error);
    free(watched);
    return status;
}

int fp3_engine_may_have_failed(const fp3_engine *engine) {
    return !engine->config->flags ||
           engine->origin->flags & (FP3_FLAGS_GRAVE | FP3_FLAG_DIVIDE_BY_ZERO);
}

/* Without `flags` the states alone tell a failure. */
static int is_failed(const fp3_engine *engine, const fp3_watched *w) {
    return w->is_astray || (w->raised != FP3_NEVER && engine->config->flags);
}

static fp3_status find_again(fp3_engine *engine, int is_suspect, fp3_failed **failed,
                             size_t *count) {
    fp3_watched *watched = calloc(engine->objects, sizeof *watched);
    *failed = calloc(engine->objects, sizeof **failed);
    fp3_status status = watched && *failed ? watch_again(engine, watched, is_suspect)
                                           : fp3_no_memory(engine->def.error);
    *count = 0;
    for (uint32_t i = 0; !status && i < engine->objects; i++)
        if (is_failed(engine, &watched[i]))
            (*failed)[(*count)++] = (fp3_failed){i, watched[i]};
    free(watched);
    return status;
}

/* Who did not live in the run has not failed in it, whatever is left of it. */
static void leave_out_the_dead(const fp3_engine *engine, fp3_failed *list, size_t *count) {
    size_t left = 0;
    for (size_t i = 0; i < *count; i++)
        if (fp3_life_took_part(engine, list[i].object))
            list[left++] = list[i];
    *count = left;
}

fp3_status fp3_engine_find_failures(fp3_engine *engine, int is_suspect) {
    fp3_failed **list = &engine->failures.list;
    size_t *count = &engine->failures.count;
    const fp3_status status = engine->origin->registers
                                  ? find_again(engine, is_suspect, list, count)
                                  : engine->backend->failures(engine, list, count);
    if (status) {
        free(engine->failures.list);
        engine->failures.list = NULL;
    } else {
        leave_out_the_dead(engine, *list, count);
    }
    return status;
}

/* ---- what the caller asks ---- */

static uint64_t when(const fp3_watched *w) {
    return w->is_astray && w->strayed < w->raised ? w->strayed : w->raised;
}

static fp3_failure tell(const fp3_engine *engine, const fp3_failed *which, size_t failed) {
    const fp3_watched *w = &which->watched;
    const int is_raised = w->raised == when(w);
    fp3_failure f = {.failed = failed,
                     .object = which->object,
                     .step = engine->origin->clock + (uint32_t)when(w),
                     .is_before = when(w) == 0,
                     .flags = is_raised ? w->flags : 0,
                     .partner = is_raised ? w->partner : 0,
                     .state = is_raised ? 0 : w->reg};
    f.value = is_raised ? 0 : fp3_format_value(engine->config, w->bits);
    return f;
}

fp3_status fp3_engine_failure(fp3_engine *engine, size_t first, size_t count,
                              fp3_failure *failure) {
    fp3_status status = fp3_engine_check_objects(engine, first, count);
    if (!status && !engine->origin->is_complete)
        status = fp3_fail(engine->def.error, FP3_E_ARGUMENT,
                          "no complete run since the last write or load");
    if (!status && !engine->failures.list)
        status = fp3_engine_find_failures(engine, 0);
    if (status)
        return status;
    const fp3_failed *earliest = NULL;
    size_t failed = 0;
    for (size_t i = 0; i < engine->failures.count; i++) {
        const fp3_failed *f = &engine->failures.list[i];
        if (f->object < first || f->object - first >= count)
            continue;
        failed++;
        if (!earliest || when(&f->watched) < when(&earliest->watched))
            earliest = f;
    }
    *failure = failed ? tell(engine, earliest, failed) : (fp3_failure){0};
    return FP3_OK;
}

static void say_what(const fp3_engine *engine, const fp3_failure *f, char *text, size_t size) {
    static const struct {
        uint32_t flag;
        const char *name;
    } grave[] = {{FP3_FLAG_INVALID, "invalid"}, {FP3_FLAG_OVERFLOW, "overflow"}};
    const fp3_members *group = fp3_layout_group_of(&engine->layout, f->object);
    const char *state = fp3_image_name(group->image, FP3_BANK_OBJECT_BASE + f->state);
    if (!f->flags)
        snprintf(text, size, "state %s is %s", state ? state : "?",
                 engine->config->finite ? "2^128 or more"
                 : f->value != f->value ? "NaN"
                                        : "infinite");
    for (size_t i = 0, used = 0; f->flags && i < sizeof grave / sizeof *grave; i++)
        if (f->flags & grave[i].flag)
            used += (size_t)snprintf(text + used, size - used, "%s%s", used ? " and " : "",
                                     grave[i].name);
    const size_t used = strlen(text);
    if (f->partner)
        snprintf(text + used, size - used, ", at the same place as object %" PRIu32,
                 f->partner - 1);
}

void fp3_engine_failure_text(const fp3_engine *engine, const fp3_failure *failure,
                             char text[FP3_FAILURE_TEXT_SIZE]) {
    char what[96] = "";
    say_what(engine, failure, what, sizeof what);
    if (failure->is_before)
        snprintf(text, FP3_FAILURE_TEXT_SIZE, "object %zu before its first step: %s",
                 failure->object, what);
    else
        snprintf(text, FP3_FAILURE_TEXT_SIZE, "object %zu in step %" PRIu32 ": %s", failure->object,
                 failure->step, what);
}
