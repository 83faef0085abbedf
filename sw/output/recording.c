/* recording.c - a run in parts: after each, who failed in it is asked, and a snapshot is taken. */
#include <fp3/program.h>

#include "csv.h"
#include "hdf5.h"
#include "plan.h"
#include "plot.h"
#include "targets.h"

#include "base/host.h"
#include "engine/inside.h"
#include "scene/split.h"

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
    uint64_t at, next; /* steps: that are made, and at the end of the part that is run */
    uint64_t number;   /* of the next snapshot */
    fp3_cost cost;
    uint64_t (*counter)[FP3_COUNTER_COUNT];
    char *has_failed; /* of each object; NULL: none has */
};

fp3_recording_def fp3_recording_default(void) { return (fp3_recording_def){.steps = 1}; }

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

static fp3_status check(const fp3_recording_def *def, const fp3_engine *engine, fp3_error *error) {
    if (!def->path && !def->plot)
        return fp3_fail(error, FP3_E_ARGUMENT, "no file to record to");
    if (fp3_engine_groups(engine) != 1)
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "a recording is of one program: %zu groups have columns of their "
                        "own",
                        fp3_engine_groups(engine));
    if (def->times && def->every)
        return fp3_fail(error, FP3_E_ARGUMENT, "snapshots are at times or every so many steps");
    if (def->is_compressed && !(def->path && fp3_hdf5_is_named(def->path)))
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "%s: only HDF5 (a name that ends in .h5 or .hdf5) is compressed",
                        def->path ? def->path : def->plot);
    return def->steps <= UINT32_MAX
               ? FP3_OK
               : fp3_fail(error, FP3_E_ARGUMENT, "%" PRIu64 " steps: a run has 4294967295 at most",
                          def->steps);
}

static fp3_subject describe(const fp3_recording *r, const fp3_recording_def *def) {
    const fp3_program *program = r->source.program;
    fp3_engine *engine = r->source.engine;
    return (fp3_subject){.program = program,
                         .columns = &r->columns,
                         .around = &r->around,
                         .objects = r->source.objects,
                         .snapshots = fp3_plan_count(&r->plan),
                         .has_time = r->source.has_time,
                         .h = r->targets.times ? 0 : r->source.h,
                         .time_unit = program->model ? program->model->time_unit : "",
                         .engine = fp3_engine_name(engine),
                         .config = fp3_engine_config(engine)->name,
                         .is_compressed = def->is_compressed};
}

typedef fp3_status open_fn(const fp3_subject *subject, fp3_sink **sink, fp3_error *error);

static fp3_status add_sink(fp3_recording *r, const fp3_recording_def *def, const char *path,
                           open_fn *open, fp3_error *error) {
    const int i = r->sink_count;
    r->subjects[i] = describe(r, def);
    r->subjects[i].path = r->paths[i] = strdup(path);
    fp3_status status = r->paths[i] ? open(&r->subjects[i], &r->sinks[i], error)
                                    : fp3_fail(error, FP3_E_SYSTEM, "out of memory");
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
        status = add_sink(r, def, def->path,
                          fp3_hdf5_is_named(def->path) ? fp3_hdf5_open : fp3_csv_open, error);
    return status;
}

static uint64_t every_of(const fp3_recording_def *def) {
    if (def->every || def->times || !def->plot)
        return def->every;
    return def->steps / PICTURE_SNAPSHOTS + (def->steps % PICTURE_SNAPSHOTS != 0);
}

static fp3_status prepare(fp3_recording *r, const fp3_recording_def *def, fp3_error *error) {
    fp3_source *source = &r->source;
    const fp3_config *config = fp3_engine_config(source->engine);
    fp3_status status = fp3_source_find_h(source, error);
    if (!status)
        status = fp3_targets_make(source, def->times, def->time_count, &r->targets, error);
    r->attempts = def->steps;
    source->has_time |= r->targets.times != NULL; /* an image of adaptive steps has no h */
    if (!status && r->targets.times)
        status = fp3_plan_parts(r->targets.count, &r->plan, error);
    else if (!status)
        status = fp3_plan_make(source, def->steps, every_of(def), def->times, def->time_count,
                               &r->plan, error);
    if (!status)
        status = fp3_engine_check_count(source->engine, (uint32_t)def->steps);
    if (!status && !r->targets.times && fp3_plan_next(&r->plan, 0) < r->plan.steps)
        status = fp3_split_check(source->program, source->params, config->name, "snapshots", error);
    if (!status)
        status =
            fp3_columns_open(source->program, def->observed, def->observed_count, source->objects,
                             fp3_engine_has_lives(source->engine), &r->columns, error);
    if (!status)
        status = fp3_columns_begin(&r->columns, source, error);
    if (!status)
        status = fp3_around_find(source, &r->around, error);
    r->counter = calloc(fp3_config_schedulers(config), sizeof *r->counter);
    if (!status && !r->counter)
        status = fp3_fail(error, FP3_E_SYSTEM, "out of memory");
    return status;
}

fp3_status fp3_recording_open(const fp3_recording_def *def, const fp3_program *program,
                              const fp3_params *params, fp3_engine *engine,
                              fp3_recording **recording, fp3_error *error) {
    FP3_HOST;
    *recording = NULL;
    fp3_status status = check(def, engine, error);
    if (status)
        return status;
    fp3_recording *r = calloc(1, sizeof *r);
    if (!r)
        return fp3_fail(error, FP3_E_SYSTEM, "out of memory");
    r->source = (fp3_source){.program = program,
                             .params = params,
                             .engine = engine,
                             .objects = fp3_engine_objects(engine)};
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
    free(r->counter);
    free(r->has_failed);
    free(r);
}

/* ---- a snapshot ---- */

static fp3_status take_snapshot(fp3_recording *r, fp3_error *error) {
    const fp3_source *source = &r->source;
    fp3_slice block = {.number = r->number++, .step = r->at, .time = (double)r->at * source->h};
    if (r->targets.times)
        block.time = r->targets.times[r->at - 1];
    fp3_status status = FP3_OK;
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
static fp3_status note_failures(fp3_recording *r, const fp3_failure *of_part, fp3_error *error) {
    size_t count;
    const fp3_failed *list = fp3_engine_failures(r->source.engine, &count);
    fp3_failure *first = &r->cost.failure;
    size_t failed = first->failed;
    if (!r->has_failed && !(r->has_failed = calloc(r->source.objects, 1)))
        return fp3_fail(error, FP3_E_SYSTEM, "out of memory");
    for (size_t i = 0; i < count; i++) {
        char *has_failed = &r->has_failed[list[i].object];
        failed += !*has_failed;
        *has_failed = 1;
    }
    if (!first->failed)
        *first = *of_part;
    first->failed = failed;
    return FP3_OK;
}

static fp3_status look_for_failures(fp3_recording *r, fp3_error *error) {
    fp3_failure of_part = {0};
    fp3_status status = FP3_OK;
    if (r->cost.failure.failed < r->source.objects)
        status = fp3_engine_failure(r->source.engine, 0, r->source.objects, &of_part);
    return !status && of_part.failed ? note_failures(r, &of_part, error) : status;
}

/* To the next time; who does not get there is told when all is over. */
static fp3_status run_adaptive_part(fp3_recording *r) {
    fp3_stats part = {0};
    fp3_status status = fp3_targets_set(&r->targets, &r->source, (size_t)r->next - 1);
    if (!status)
        status = fp3_engine_advance(r->source.engine, r->attempts, &part);
    const fp3_status counted = add_counters(r, &part);
    return status ? status : counted;
}

static fp3_status run_part(fp3_recording *r, fp3_error *error) {
    if (r->targets.times)
        return run_adaptive_part(r);
    fp3_stats part;
    fp3_status status = fp3_engine_run(r->source.engine, r->next - r->at, &part);
    const fp3_status counted = add_counters(r, &part);
    if (!status)
        status = counted;
    if (!status)
        status = look_for_failures(r, error);
    return status;
}

static fp3_status run(fp3_recording *r, fp3_error *error) {
    fp3_status status = FP3_OK;
    if (fp3_plan_has(&r->plan, 0))
        status = take_snapshot(r, error);
    do { /* a run of no steps, too, so that its states are looked at */
        r->next = fp3_plan_next(&r->plan, r->at);
        if (!status)
            status = run_part(r, error);
        const uint64_t before = r->at;
        r->at = r->next;
        if (!status && r->at > before && fp3_plan_has(&r->plan, r->at))
            status = take_snapshot(r, error);
    } while (!status && r->at < r->plan.steps);
    for (int i = 0; !status && i < r->sink_count; i++)
        status = r->sinks[i]->publish(r->sinks[i], error);
    return status;
}

fp3_status fp3_recording_run(fp3_recording *r, fp3_cost *cost, fp3_error *error) {
    FP3_HOST;
    fp3_status status = r->number || r->at
                            ? fp3_fail(error, FP3_E_ARGUMENT, "a recording is of one run")
                            : run(r, error);
    r->cost.counter = (const uint64_t(*)[FP3_COUNTER_COUNT])r->counter;
    if (cost)
        *cost = r->cost;
    return status;
}

double fp3_recording_share(const fp3_recording *r, double share) {
    const double made = (double)r->at + share * (double)(r->next - r->at);
    return r->plan.steps ? made / (double)r->plan.steps : share;
}
