/* SPDX-License-Identifier: Apache-2.0 */
/* recording.c - a run in parts: after each, who failed in it is asked, and a snapshot or a
 * checkpoint is taken. */
#include <fp3/program.h>
#include <fp3/recording.h>

#include "checkpoints.h"
#include "expected.h"
#include "format.h"
#include "plan.h"
#include "plot.h"
#include "targets.h"

#include "base/definition.h"
#include "base/host.h"
#include "engine/common/inside.h"
#include "world/split.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#define SINKS_MOST 2           /* a file and a picture */
#define PICTURE_SNAPSHOTS 1000 /* of a picture, where nothing says how many */

struct fp3_recording {
    fp3_source source;
    fp3_columns columns;
    fp3_around around;
    fp3_plan plan;
    fp3_targets targets;
    uint64_t attempts;                /* adaptive steps: of a part, at most */
    fp3_subject subjects[SINKS_MOST]; /* the same but for the path */
    char *paths[SINKS_MOST];
    fp3_sink *sinks[SINKS_MOST];
    int sink_count;
    int has_snapshots, has_run;
    fp3_checkpoints checkpoints;
    fp3_expected *expected; /* or NULL */
    fp3_digest chain;       /* of the snapshots */
    uint64_t at, next;      /* steps: that are made, and at the end of the part that is run */
    uint64_t number;        /* of the next snapshot */
    fp3_cost cost;
    uint64_t (*counter)[FP3_COUNTER_COUNT];
    fp3_group_cost *groups;
};

void fp3_recording_set_default(fp3_recording_def *def, size_t size) {
    if (fp3_definition_begin(def, size, sizeof *def))
        def->steps = 1;
}

fp3_status fp3_recording_steps(const fp3_program *program, const fp3_params *params,
                               const double *times, size_t count, uint64_t *steps,
                               fp3_error *error) {
    FP3_HOST;
    fp3_source source = {.program = program, .params = params};
    fp3_status status = fp3_source_find_h(&source, error);
    *steps = 0;
    for (size_t i = 0; !status && i < count; i++)
        status = fp3_plan_step(&source, times[i], steps, error);
    return status;
}

/* ---- opening ---- */

static fp3_status check(const fp3_recording_def *def, fp3_error *error) {
    const int is_recorded = def->path || def->plot;
    if (!is_recorded && !def->checkpoint && !def->restart && !def->expected)
        return fp3_fail(error, FP3_E_ARGUMENT, "no file to record to");
    if (def->times && def->every)
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "snapshots are at times or after every N steps: "
                        "found both");
    if (def->is_compressed && !(def->path && fp3_format_of(def->path)->is_hdf5))
        return fp3_fail(
            error, FP3_E_ARGUMENT,
            "%s: only HDF5 (a name that ends in " FP3_HDF5_ENDINGS(" or ") ") is compressed",
            def->path ? def->path : def->plot);
    return def->steps <= UINT32_MAX
               ? FP3_OK
               : fp3_fail(error, FP3_E_ARGUMENT, "%" PRIu64 " steps: a run has 4294967295 at most",
                          def->steps);
}

/* Where a run is cut is the same on all ranks. */
static fp3_status agree(const fp3_recording_def *def, fp3_engine *engine) {
    const fp3_expected *expected = def->expected;
    const uint64_t cuts[] = {
        def->steps,  def->every,        def->checkpoint_every,         def->time_count,
        !!def->path, !!def->checkpoint, expected ? expected->count : 0};
    fp3_status status = fp3_engine_agree(engine, cuts, sizeof cuts);
    if (!status && def->times)
        status = fp3_engine_agree(engine, def->times, def->time_count * sizeof *def->times);
    if (!status && expected)
        status = fp3_engine_agree(engine, expected->list, expected->count * sizeof *expected->list);
    return status;
}

static fp3_subject describe(const fp3_recording *r, const fp3_recording_def *def) {
    const fp3_program *program = r->source.program;
    fp3_engine *engine = r->source.engine;
    return (fp3_subject){.program = program,
                         .columns = &r->columns,
                         .around = &r->around,
                         .objects = r->source.objects,
                         .snapshots = fp3_plan_count(&r->plan, r->at),
                         .has_time = r->source.has_time,
                         .h = r->targets.times ? 0 : r->source.h,
                         .time_unit = program->model ? program->model->time_unit : "",
                         .engine = fp3_engine_name(engine),
                         .config = fp3_engine_config(engine)->name,
                         .command = def->command,
                         .is_compressed = def->is_compressed,
                         .is_hashed = r->checkpoints.is_there,
                         .before = r->chain};
}

static fp3_status add_sink(fp3_recording *r, const fp3_recording_def *def, const char *path,
                           fp3_sink_open *open, fp3_error *error) {
    const int i = r->sink_count;
    r->subjects[i] = describe(r, def);
    r->subjects[i].path = r->paths[i] = strdup(path);
    fp3_status status =
        r->paths[i] ? open(&r->subjects[i], &r->sinks[i], error) : fp3_no_memory(error);
    r->sink_count++;
    return status;
}

/* A picture may be refused, so it is the first. */
static fp3_status add_sinks(fp3_recording *r, const fp3_recording_def *def, fp3_error *error) {
    fp3_status status = FP3_OK;
    if (def->is_silent)
        return FP3_OK;
    if (def->plot)
        status = add_sink(r, def, def->plot, fp3_plot_open, error);
    if (!status && def->path)
        status = add_sink(r, def, def->path, fp3_format_of(def->path)->open, error);
    return status;
}

static uint64_t every_of(const fp3_recording_def *def) {
    if (def->every || def->times || !def->plot)
        return def->every;
    return def->steps / PICTURE_SNAPSHOTS + (def->steps % PICTURE_SNAPSHOTS != 0);
}

/* Of a recording. */
static fp3_status plan_snapshots(fp3_recording *r, const fp3_recording_def *def, fp3_error *error) {
    fp3_source *source = &r->source;
    fp3_status status = fp3_source_find_h(source, error);
    if (!status)
        status = fp3_targets_make(source, def->times, def->time_count, &r->targets, error);
    source->has_time |= r->targets.times != NULL; /* an image of adaptive steps has no h */
    if (!status && r->targets.times)
        return fp3_plan_parts(r->targets.count, &r->plan, error);
    return status ? status
                  : fp3_plan_make(source, def->steps, every_of(def), def->times, def->time_count,
                                  &r->plan, error);
}

static fp3_status plan_expected(fp3_recording *r, const fp3_expected *expected, fp3_error *error) {
    uint64_t *steps = calloc(expected->count, sizeof *steps);
    if (!steps)
        return fp3_no_memory(error);
    for (size_t i = 0; i < expected->count; i++)
        steps[i] = expected->list[i].step;
    const fp3_status status = fp3_plan_steps(steps, expected->count, &r->plan, error);
    free(steps);
    return status;
}

static fp3_status prepare_columns(fp3_recording *r, const fp3_recording_def *def,
                                  fp3_error *error) {
    const fp3_source *source = &r->source;
    fp3_status status =
        fp3_columns_open(source->program, def->observed, def->observed_count, source->objects,
                         fp3_engine_has_lives(source->engine), &r->columns, error);
    if (!status)
        status = fp3_columns_begin(&r->columns, source, error);
    return status ? status : fp3_around_find(source, &r->around, error);
}

/* Of a scene of several groups the caller has looked. */
static fp3_status check_split(const fp3_recording *r, fp3_error *error) {
    const fp3_source *source = &r->source;
    const uint64_t begin = fp3_checkpoints_begin(&r->checkpoints);
    const uint64_t end = fp3_plan_next(&r->plan, 0);
    const int by_snapshots = end < r->plan.steps;
    if (!source->program || r->targets.times ||
        (!by_snapshots && !begin && fp3_checkpoints_next(&r->checkpoints, 0, end) == end))
        return FP3_OK;
    return fp3_split_check(source->program, source->params, fp3_engine_config(source->engine)->name,
                           by_snapshots ? "snapshots" : "checkpoints", error);
}

static fp3_status make_room(fp3_recording *r, fp3_error *error) {
    const fp3_engine *engine = r->source.engine;
    r->counter =
        calloc(fp3_config_schedulers(fp3_engine_config(r->source.engine)), sizeof *r->counter);
    r->groups = calloc(fp3_engine_groups(engine), sizeof *r->groups);
    return r->counter && r->groups ? FP3_OK : fp3_no_memory(error);
}

/* Compute what needs the start values before the checkpoint overwrites them. */
static fp3_status prepare(fp3_recording *r, const fp3_recording_def *def, fp3_error *error) {
    r->attempts = def->steps;
    r->has_snapshots = def->path || def->plot;
    r->expected = def->expected;
    fp3_status status = fp3_checkpoints_open(def, r->source.engine, &r->checkpoints, error);
    if (!status)
        status = r->has_snapshots ? plan_snapshots(r, def, error)
                 : r->expected    ? plan_expected(r, r->expected, error)
                               : fp3_plan_make(&r->source, def->steps, 0, NULL, 0, &r->plan, error);
    if (!status)
        status = fp3_engine_check_count(r->source.engine, (uint32_t)def->steps);
    if (!status)
        status = check_split(r, error);
    if (!status && r->has_snapshots)
        status = prepare_columns(r, def, error);
    if (!status)
        status = make_room(r, error);
    if (!status)
        status = fp3_checkpoints_restore(&r->checkpoints, error);
    r->at = fp3_checkpoints_begin(&r->checkpoints);
    r->chain = r->checkpoints.past.chain;
    r->cost.stats.flags = r->checkpoints.past.flags;
    return status;
}

fp3_status fp3_recording_open(const fp3_recording_def *def, const fp3_program *program,
                              const fp3_params *params, fp3_engine *engine,
                              fp3_recording **recording, fp3_error *error) {
    FP3_HOST;
    *recording = NULL;
    fp3_status status = fp3_definition_check(def, sizeof *def, "fp3_recording_def", error);
    if (!status)
        status = check(def, error);
    if (!status && def->group >= fp3_engine_groups(engine))
        status = fp3_fail(error, FP3_E_ARGUMENT, "group %zu: the engine has %zu", def->group,
                          fp3_engine_groups(engine));
    if (!status)
        status = agree(def, engine);
    if (status)
        return status;
    fp3_recording *r = calloc(1, sizeof *r);
    if (!r)
        return fp3_no_memory(error);
    const fp3_members *group = &fp3_engine_layout(engine)->groups[def->group];
    r->source = (fp3_source){.program = program,
                             .params = params,
                             .engine = engine,
                             .group = def->group,
                             .first = group->first,
                             .objects = group->rows};
    status = prepare(r, def, error);
    if (!status)
        status = add_sinks(r, def, error);
    if (status)
        fp3_recording_close(&r);
    *recording = r;
    return status;
}

void fp3_recording_close(fp3_recording **recording) {
    fp3_recording *r = *recording;
    *recording = NULL;
    if (!r)
        return;
    for (int i = 0; i < r->sink_count; i++) {
        if (r->sinks[i])
            r->sinks[i]->close(r->sinks[i]);
        free(r->paths[i]);
    }
    fp3_columns_free(&r->columns);
    fp3_around_free(&r->around);
    fp3_plan_free(&r->plan);
    fp3_targets_free(&r->targets);
    fp3_checkpoints_close(&r->checkpoints);
    free(r->counter);
    free(r->groups);
    free(r);
}

/* ---- a snapshot ---- */

static fp3_status add_hash(fp3_recording *r, fp3_error *error) {
    fp3_checkpoints *c = &r->checkpoints;
    fp3_status status = fp3_checkpoints_hash(c, r->at, error);
    if (!status && r->expected)
        status = fp3_expected_compare(r->expected, c->state.calls, r->at, &c->hash, error);
    return status ? status : fp3_chain_add(c->state.calls, &r->chain, &c->hash, error);
}

static fp3_status take_snapshot(fp3_recording *r, fp3_error *error) {
    const fp3_source *source = &r->source;
    fp3_slice block = {.number = r->number++,
                       .step = r->at,
                       .time = (double)r->at * source->h,
                       .chain = &r->chain};
    if (r->targets.times)
        block.time = r->targets.times[r->at - 1];
    fp3_status status = r->checkpoints.is_there ? add_hash(r, error) : FP3_OK;
    if (!r->has_snapshots)
        return status;
    for (; !status && block.first < source->objects; block.first += block.count) {
        const size_t left = source->objects - block.first;
        block.count = left < r->columns.room ? left : r->columns.room;
        status = fp3_columns_read(&r->columns, source, r->at, block.first, block.count);
        for (int i = 0; !status && i < r->sink_count; i++)
            status = r->sinks[i]->put(r->sinks[i], &block, error);
    }
    return status;
}

/* ---- a part of the run ---- */

static fp3_status add_counters(fp3_recording *r, const fp3_stats *part) {
    fp3_stats *sum = &r->cost.stats;
    fp3_status status = FP3_OK;
    for (uint32_t s = 0; !status && s < part->schedulers; s++) {
        uint64_t counter[FP3_COUNTER_COUNT];
        if (part->schedulers == 1) /* an adaptive part may be several runs */
            memcpy(counter, part->counter, sizeof counter);
        else if (fp3_engine_need_counters(r->source.engine, NULL))
            memset(counter, 0, sizeof counter);
        else
            status = fp3_engine_scheduler_counters(r->source.engine, s, counter);
        for (int i = 0; !status && i < FP3_COUNTER_COUNT; i++)
            r->counter[s][i] += counter[i];
    }
    for (int i = 0; i < FP3_COUNTER_COUNT; i++)
        sum->counter[i] += part->counter[i];
    sum->schedulers += part->schedulers > sum->schedulers ? part->schedulers - sum->schedulers : 0;
    sum->object_steps += part->object_steps;
    sum->flags |= part->flags;
    sum->seconds += part->seconds;
    return status;
}

/* Counts each object once; those of the first part that has some tell which was first. */
static void note_failures(fp3_recording *r, size_t number, const fp3_failure *of_part) {
    size_t count;
    const fp3_members *group = &fp3_engine_layout(r->source.engine)->groups[number];
    const fp3_failed *list = fp3_engine_failures(r->source.engine, &count);
    fp3_failure *first = &r->checkpoints.past.failures[number];
    size_t failed = first->failed;
    for (size_t i = 0; i < count; i++) {
        uint32_t *has_failed = &r->checkpoints.past.has_failed[list[i].object];
        if (list[i].object - group->first >= group->objects)
            continue;
        failed += !*has_failed;
        *has_failed = 1;
    }
    if (!first->failed)
        *first = *of_part;
    first->failed = failed;
}

static fp3_status look_for_failures(fp3_recording *r) {
    const fp3_layout *layout = fp3_engine_layout(r->source.engine);
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; !status && i < layout->count; i++) {
        const fp3_members *group = &layout->groups[i];
        fp3_failure of_part = {0};
        if (r->checkpoints.past.failures[i].failed < group->objects)
            status = fp3_engine_failure(r->source.engine, group->first, group->objects, &of_part);
        if (!status && of_part.failed)
            note_failures(r, i, &of_part);
    }
    return status;
}

/* A state that is not finite before a step comes before what happens in it. */
static int is_earlier(const fp3_failure *a, const fp3_failure *b) {
    return a->step != b->step             ? a->step < b->step
           : a->is_before != b->is_before ? a->is_before
                                          : a->object < b->object;
}

/* Of all groups. */
static void add_up_failures(fp3_recording *r) {
    fp3_failure all = {0};
    for (size_t i = 0; i < fp3_engine_groups(r->source.engine); i++) {
        const fp3_failure *one = &r->checkpoints.past.failures[i];
        const size_t failed = all.failed + one->failed;
        r->groups[i].failure = *one;
        if (one->failed && (!all.failed || is_earlier(one, &all)))
            all = *one;
        all.failed = failed;
    }
    r->cost.failure = all;
}

/* To the next time; who does not get there is told when all is over. */
static fp3_status run_adaptive_part(fp3_recording *r) {
    fp3_stats part = {0};
    fp3_status status = fp3_targets_set(&r->targets, &r->source, (size_t)r->next - 1);
    if (!status)
        status = fp3_adaptive_run(r->source.engine, r->attempts, &part);
    const fp3_status counted = add_counters(r, &part);
    return status ? status : counted;
}

static fp3_status run_part(fp3_recording *r) {
    if (r->targets.times)
        return run_adaptive_part(r);
    fp3_stats part;
    fp3_status status = fp3_engine_run(r->source.engine, r->next - r->at, &part);
    const fp3_status counted = add_counters(r, &part);
    for (size_t i = 0; i < fp3_engine_groups(r->source.engine); i++)
        r->groups[i].object_steps += fp3_engine_group_steps(r->source.engine, i);
    if (!status)
        status = counted;
    return status ? status : look_for_failures(r);
}

/* What is due after the steps that are made. */
static fp3_status look(fp3_recording *r, int is_begin, fp3_error *error) {
    fp3_status status = FP3_OK;
    r->checkpoints.past.flags = r->cost.stats.flags;
    if ((r->has_snapshots || r->expected) && fp3_plan_has(&r->plan, r->at))
        status = take_snapshot(r, error);
    return status || is_begin ? status : fp3_checkpoints_take(&r->checkpoints, r->at, error);
}

static fp3_status run(fp3_recording *r, fp3_error *error) {
    fp3_status status = look(r, 1, error);
    do { /* a run of no steps, too, so that its states are looked at */
        r->next = fp3_checkpoints_next(&r->checkpoints, r->at, fp3_plan_next(&r->plan, r->at));
        if (!status)
            status = run_part(r);
        const uint64_t before = r->at;
        r->at = r->next;
        if (!status && r->at > before)
            status = look(r, 0, error);
    } while (!status && r->at < r->plan.steps);
    if (!status && !r->plan.steps)
        status = fp3_checkpoints_take(&r->checkpoints, 0, error);
    if (!status && r->checkpoints.is_there)
        status = fp3_checkpoints_hash(&r->checkpoints, r->at, error);
    for (int i = 0; !status && i < r->sink_count; i++)
        status = r->sinks[i]->publish(r->sinks[i], error);
    return status;
}

fp3_status fp3_recording_run(fp3_recording *r, fp3_cost *cost, fp3_error *error) {
    FP3_HOST;
    fp3_status status =
        r->has_run ? fp3_fail(error, FP3_E_ARGUMENT, "a recording is of one run") : run(r, error);
    r->has_run = 1;
    r->cost.counter = (const uint64_t(*)[FP3_COUNTER_COUNT])r->counter;
    r->cost.groups = r->groups;
    add_up_failures(r);
    if (!status && r->checkpoints.is_there) {
        fp3_digest_text(&r->checkpoints.hash, r->cost.hash);
        if (r->checkpoints.def.path)
            fp3_digest_text(&r->checkpoints.past.chain, r->cost.chain);
        else if (r->checkpoints.is_recorded)
            fp3_digest_text(&r->chain, r->cost.chain);
    }
    if (cost)
        *cost = r->cost;
    return status;
}

double fp3_recording_share(const fp3_recording *r, double share) {
    const double made = (double)r->at + share * (double)(r->next - r->at);
    return r->plan.steps ? made / (double)r->plan.steps : share;
}
