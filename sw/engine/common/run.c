/* SPDX-License-Identifier: Apache-2.0 */
/* run.c - a run: who is awake at its beginning, what it cost, how many steps were made. */
#include "checks.h"
#include "count.h"
#include "life.h"
#include "living.h"
#include "origin.h"
#include "part_failures.h"
#include "removed.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

/* Brings the host's copy of all sleep registers up to date. */
static fp3_status look_who_sleeps(fp3_engine *engine) {
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; !status && !engine->sleepers.is_known && i < engine->layout.count; i++) {
        const fp3_members *group = &engine->layout.groups[i];
        const uint32_t slept = (uint32_t)group->program.slept;
        if (group->program.slept >= 0)
            status = engine->backend->read(
                engine, (fp3_cells){FP3_CELLS_REGISTER, slept, group->first, group->objects},
                &engine->sleepers.slept[group->first]);
    }
    engine->sleepers.is_known = !status;
    return status;
}

static int may_leave_out(const fp3_engine *engine, const fp3_members *group) {
    return group->program.slept >= 0 || fp3_lives_vary(engine);
}

/* The host's own list, so that a run costs it as much as there are objects awake. */
static fp3_status list_own(fp3_engine *engine) {
    int is_any = 0;
    engine->sleepers.awake_count = 0;
    for (uint32_t i = 0; i < engine->layout.count; i++)
        is_any |= may_leave_out(engine, &engine->layout.groups[i]);
    if (is_any && !engine->sleepers.awake)
        engine->sleepers.awake = malloc(engine->objects * sizeof *engine->sleepers.awake);
    if (is_any && !engine->sleepers.awake)
        return fp3_no_memory(engine->def.error);
    for (uint32_t i = 0; i < engine->layout.count; i++) {
        const fp3_members *group = &engine->layout.groups[i];
        for (uint32_t n = 0; may_leave_out(engine, group) && n < group->objects; n++)
            if (fp3_engine_is_awake(engine, group->first + n))
                engine->sleepers.awake[engine->sleepers.awake_count++] = group->first + n;
    }
    return FP3_OK;
}

static fp3_status list_who_is_awake(fp3_engine *engine) {
    if (engine->sleepers.is_listed)
        return FP3_OK;
    fp3_status status = engine->config->interleave ? look_who_sleeps(engine) : FP3_OK;
    if (!status)
        status = fp3_living_settle(engine);
    if (!status)
        status = list_own(engine);
    if (!status && engine->config->interleave)
        status = engine->backend->list(engine);
    engine->sleepers.is_listed = !status;
    return status;
}

/* Those of a part of the run; schedulers count cycles side by side. */
static void add_counters(const fp3_engine *engine, fp3_stats *stats) {
    uint64_t cycles = 0;
    for (uint32_t scheduler = 0; scheduler < stats->schedulers; scheduler++) {
        const uint64_t *counter = engine->counters[scheduler];
        for (int i = 0; i < FP3_COUNTER_COUNT; i++)
            stats->counter[i] += i == FP3_COUNTER_CYCLES ? 0 : counter[i];
        cycles = counter[FP3_COUNTER_CYCLES] > cycles ? counter[FP3_COUNTER_CYCLES] : cycles;
    }
    stats->counter[FP3_COUNTER_CYCLES] += cycles;
}

/* How many objects of the list, from its place n on, follow each other in a group. */
static uint32_t neighbours(const fp3_engine *engine, uint32_t n) {
    const fp3_sleepers *s = &engine->sleepers;
    const fp3_members *group = fp3_layout_group_of(&engine->layout, s->awake[n]);
    const uint32_t left = group->first + group->objects - s->awake[n];
    uint32_t count = 1;
    while (count < left && n + count < s->awake_count && s->awake[n + count] == s->awake[n] + count)
        count++;
    return count;
}

/* What neighbours made; those who have not fallen asleep go to place *left of the list. */
static fp3_status count_some(fp3_engine *engine, uint32_t first, uint32_t count, uint32_t steps,
                             fp3_stats *stats, uint32_t *left) {
    const size_t number =
        (size_t)(fp3_layout_group_of(&engine->layout, first) - engine->layout.groups);
    fp3_members *group = &engine->layout.groups[number];
    const int slept = group->program.slept;
    uint32_t *now = engine->sleepers.slept;
    fp3_status status = FP3_OK;
    if (slept >= 0)
        status = engine->backend->read(
            engine, (fp3_cells){FP3_CELLS_REGISTER, (uint32_t)slept, first, count}, &now[first]);
    for (uint32_t i = first; !status && i < first + count; i++) {
        const int is_awake = slept < 0 || !now[i];
        const uint32_t made = is_awake ? steps : now[i] - engine->clock;
        group->steps += made;
        stats->object_steps += made;
        engine->sleepers.awake[*left] = i;
        *left += (uint32_t)is_awake;
    }
    return status;
}

static fp3_status count_steps(fp3_engine *engine, uint32_t steps, fp3_stats *stats) {
    fp3_status status = FP3_OK;
    uint32_t left = 0;
    for (uint32_t i = 0; i < engine->layout.count; i++) {
        fp3_members *group = &engine->layout.groups[i];
        if (may_leave_out(engine, group))
            continue;
        group->steps += (uint64_t)group->objects * steps;
        stats->object_steps += (uint64_t)group->objects * steps;
    }
    for (uint32_t n = 0, now; !status && n < engine->sleepers.awake_count; n += now) {
        now = neighbours(engine, n);
        status = count_some(engine, engine->sleepers.awake[n], now, steps, stats, &left);
    }
    engine->sleepers.awake_count = left;
    for (uint32_t i = 0; i < engine->layout.count; i++) { /* of those that live some slept */
        fp3_members *group = &engine->layout.groups[i];
        group->steps -= group->slept;
        stats->object_steps -= group->slept;
        group->slept = 0;
    }
    return status;
}

/* Each visit executes the first and the last part once. */
static double count_instructions(const fp3_engine *engine, uint32_t steps) {
    const uint32_t visit =
        engine->config->interleave && engine->def.visit ? engine->def.visit : steps;
    const double visits = steps <= visit ? steps != 0 : ceil((double)steps / visit);
    double sum = 0;
    for (uint32_t i = 0; i < engine->layout.count; i++) {
        const fp3_members *group = &engine->layout.groups[i];
        const fp3_code *p = &group->program;
        sum += group->objects *
               (visits * (p->step + p->count - p->last) + (double)steps * (p->last - p->step));
    }
    return sum;
}

void fp3_engine_tell(const fp3_engine *engine, uint64_t executed) {
    if (engine->def.progress && engine->expected > 0)
        engine->def.progress(engine->def.progress_user,
                             engine->told +
                                 engine->part * fmin(1, (double)executed / engine->expected));
}

/* ---- counters of schedulers: of a part of the run, and summed over its parts ----
 *
 * Reading them takes as long as a step of one object, so those that stay 0 are not read. */

static void forget_counters(fp3_engine *engine) {
    if (engine->backend->is_uncounted)
        return;
    memset(engine->counters, 0, fp3_config_schedulers(engine->config) * sizeof *engine->counters);
}

static void sum_counters(fp3_engine *engine) {
    for (uint32_t s = 0; s < fp3_config_schedulers(engine->config); s++)
        for (int i = 0; i < FP3_COUNTER_COUNT; i++)
            engine->sums[s][i] += engine->counters[s][i];
}

static void take_sums(fp3_engine *engine) {
    if (engine->backend->is_uncounted)
        return;
    const size_t size = fp3_config_schedulers(engine->config) * sizeof *engine->counters;
    memcpy(engine->counters, engine->sums, size);
    memset(engine->sums, 0, size);
}

/* Steps that the same objects make. After an early end it is unknown which objects slept, and the
 * lists are in pieces. */
static fp3_status run_part(fp3_engine *engine, uint32_t steps, fp3_stats *stats) {
    fp3_status status = list_who_is_awake(engine);
    if (status)
        return status;
    forget_counters(engine);
    engine->sleepers.is_known = engine->sleepers.is_listed = 0;
    engine->expected = count_instructions(engine, steps);
    status = engine->backend->run(engine, steps, stats);
    if (!engine->backend->is_uncounted) {
        add_counters(engine, stats);
        sum_counters(engine);
    }
    if (!status)
        status = count_steps(engine, steps, stats);
    if (!status)
        engine->sleepers.is_known = engine->sleepers.is_listed = 1;
    return status;
}

fp3_status fp3_engine_make_phase(fp3_engine *engine, uint32_t phase, fp3_stats *stats) {
    fp3_status status = list_who_is_awake(engine);
    if (status)
        return status;
    forget_counters(engine);
    engine->only = phase + 1;
    status = engine->backend->run(engine, 1, stats);
    engine->only = 0;
    return status;
}

/* Whether somebody may have failed in a part of n steps that nobody knows of yet. Where each step
 * is a part, all objects are asked in the first one, and then not before something is raised. */
static int is_suspect(const fp3_engine *engine, uint32_t made, const fp3_stats *stats) {
    const uint32_t leads_astray = FP3_FLAGS_GRAVE | FP3_FLAG_DIVIDE_BY_ZERO;
    return !engine->lives.removed || !made || engine->failures.count || !engine->config->flags ||
           stats->flags & leads_astray;
}

/* If no object lives, a run of 0 steps, which executes nothing. */
static fp3_status run_parts(fp3_engine *engine, uint32_t steps, fp3_stats *stats) {
    fp3_status status = FP3_OK;
    uint32_t made = 0;
    do {
        int is_any = 1;
        uint32_t n = steps ? fp3_life_part(engine, steps - made, &is_any) : 0;
        n = engine->backend->at_once && n > engine->backend->at_once ? engine->backend->at_once : n;
        engine->told = steps ? (double)made / steps : 0;
        engine->part = steps ? (double)n / steps : 1;
        status = run_part(engine, is_any ? n : 0, stats);
        const int knows_failures = engine->backend->failures && !engine->origin->registers;
        if (!status && n < steps && knows_failures && is_suspect(engine, made, stats))
            status = fp3_part_failures_add(engine, made);
        if (!status) {
            made += n;
            engine->clock += n;
            engine->made += n;
        }
        if (!status && is_any && n)
            status = fp3_removed_look(engine);
    } while (!status && made < steps);
    take_sums(engine);
    return status;
}

/* A limit is of one run of the backend. */
static fp3_status check_limit(fp3_engine *engine, uint32_t steps) {
    int is_any;
    if (!engine->def.cycle_limit || !steps || fp3_life_part(engine, steps, &is_any) == steps)
        return FP3_OK;
    return fp3_fail(engine->def.error, FP3_E_ARGUMENT,
                    "a cycle limit of %" PRIu64 ": births and ends of objects split the run, and "
                    "a limit applies to one run",
                    engine->def.cycle_limit);
}

static fp3_status run(fp3_engine *engine, uint32_t steps, fp3_stats *stats) {
    forget_counters(engine);
    for (uint32_t i = 0; i < engine->layout.count; i++)
        engine->layout.groups[i].steps = 0;
    fp3_status status = engine->lives.is_looked ? FP3_OK : fp3_removed_look(engine);
    if (!status)
        status = fp3_engine_check_count(engine, steps);
    if (!status)
        status = check_limit(engine, steps);
    if (!status)
        status = fp3_engine_check_neighbours(engine);
    if (!status)
        status = fp3_origin_begin(engine, steps);
    if (status)
        return status;
    const int was_counted = engine->is_counted;
    const uint64_t made = engine->made;
    engine->is_counted = 0;
    engine->is_touched = 1;
    engine->began = engine->clock;
    free(engine->failures.list);
    engine->failures.list = NULL;
    engine->failures.count = 0;
    fp3_removed_run(engine);
    status = run_parts(engine, steps, stats);
    fp3_origin_end(engine, !status, stats->flags);
    if (!status) {
        engine->is_counted = was_counted;
        fp3_engine_count(engine, steps);
    } else {
        engine->clock = engine->began;
        engine->made = made;
        engine->lives.change = 0;
        engine->lives.is_looked = 0;
        stats->object_steps = 0;
    }
    return status;
}

fp3_status fp3_engine_run(fp3_engine *engine, uint64_t steps, fp3_stats *stats) {
    fp3_stats own = {0};
    struct timespec begin, end;
    if (stats)
        *stats = own;
    fp3_status status = fp3_engine_check_loaded(engine);
    if (status)
        return status;
    if (steps > UINT32_MAX)
        return fp3_fail(engine->def.error, FP3_E_ARGUMENT,
                        "%" PRIu64 " steps: a run has 4294967295 at most", steps);
    if (!stats)
        return run(engine, (uint32_t)steps, &own);
    clock_gettime(CLOCK_MONOTONIC, &begin);
    status = run(engine, (uint32_t)steps, stats);
    clock_gettime(CLOCK_MONOTONIC, &end);
    stats->seconds =
        (double)(end.tv_sec - begin.tv_sec) + 1e-9 * (double)(end.tv_nsec - begin.tv_nsec);
    return status;
}

fp3_status fp3_engine_need_counters(const fp3_engine *engine, fp3_error *error) {
    if (!engine->backend->is.is_hardware || engine->config->counters)
        return FP3_OK;
    return fp3_fail(error, FP3_E_ARGUMENT, "configuration %s has no counters",
                    engine->config->name);
}

fp3_status fp3_engine_scheduler_counters(fp3_engine *engine, uint32_t scheduler,
                                         uint64_t counter[FP3_COUNTER_COUNT]) {
    const uint32_t schedulers = fp3_config_schedulers(engine->config);
    fp3_status status = fp3_engine_check_range(engine, "scheduler", scheduler, 1, schedulers);
    if (!status)
        status = fp3_engine_need_counters(engine, engine->def.error);
    if (!status)
        memcpy(counter, engine->counters[scheduler], sizeof engine->counters[scheduler]);
    return status;
}

uint64_t fp3_engine_group_steps(const fp3_engine *engine, size_t group) {
    return group < engine->layout.count ? engine->layout.groups[group].steps : 0;
}

fp3_status fp3_engine_scheduler_share(fp3_engine *engine, uint32_t scheduler,
                                      fp3_scheduler_share *share) {
    fp3_status status = fp3_engine_check_range(engine, "scheduler", scheduler, 1,
                                               fp3_config_schedulers(engine->config));
    if (!status)
        *share =
            (fp3_scheduler_share){engine->layout.duty[scheduler].group,
                                  fp3_layout_objects(&engine->layout, engine->config, scheduler)};
    return status;
}
