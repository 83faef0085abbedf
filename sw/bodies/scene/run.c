/* SPDX-License-Identifier: Apache-2.0 */
/* run.c - see run.h. */
#include "run.h"

#include "kept.h"
#include "recorded.h"

#include "base/file.h"
#include "base/host.h"
#include "base/path.h"
#include "bodies/share.h"
#include "record/format.h"
#include "record/plan.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define PARTS 200 /* of a run, after which progress is told */

/* What bodies have; how many numbers in a plane and in space, 0: it is not there. */
typedef struct {
    const char *name, *unit, *doc;
    unsigned width[2];
    int is_usual;
} quantity;

static const quantity quantities[] = {
    {"x", "m", "where the body's origin is", {2, 3}, 1},
    {"angle", "1", "how far it is turned, anticlockwise", {1, 0}, 1},
    {"q", "1", "how it is turned, a quaternion", {0, 4}, 1},
    {"v", "m/s", "the speed of its centre of mass", {2, 3}, 1},
    {"w", "1/s", "its spin", {1, 0}, 1},
    {"spin", "1/s", "its spin, in the world's axes", {0, 3}, 1},
    {"force", "N", "what acts in the next step", {2, 3}, 0},
    {"torque", "N*m", "what turns it in the next step", {1, 3}, 0},
    {"mass", "kg", "its mass", {1, 1}, 0},
    {"inertia", "kg*m^2", "its inertia about the centre of mass", {1, 3}, 0},
    {"at_rest", "s", "for how long it has been slow; -1 while it sleeps", {1, 1}, 1}};
#define QUANTITIES (sizeof quantities / sizeof *quantities)

typedef struct {
    fp3_bodies_scene *scene;
    const fp3_bodies_run_def *def;
    fp3_bodies_tally *tally;
    fp3_columns columns;
    fp3_around around;
    fp3_bodies_tables tables;
    fp3_subject subject;
    fp3_sink *sink; /* NULL: no snapshots */
    fp3_plan plan;
    fp3_bodies_kept kept;
    fp3_output *contacts; /* NULL: they are not written */
    int has_contacts;     /* snapshots have them */
    int is_hashed;        /* snapshots have hashes, or are hashes alone */
    uint64_t number;      /* of the next snapshot */
    fp3_error *error;
} run;

/* The world's own message, with the path of the scene. */
static fp3_status failed(const run *u, fp3_status status) {
    return fp3_fail(u->error, status, "%s: %s", u->scene->path, u->scene->why.text);
}

/* ---- columns ---- */

static fp3_status add_column(run *u, const quantity *q, const char *end) {
    fp3_columns *columns = &u->columns;
    fp3_column *list = realloc(columns->list, (columns->count + 1) * sizeof *list);
    if (!list)
        return fp3_no_memory(u->error);
    columns->list = list;
    fp3_column *made = &list[columns->count++];
    *made = (fp3_column){.unit = q->unit, .doc = q->doc, .kind = FP3_COLUMN_COMPUTED};
    snprintf(made->name, sizeof made->name, "%s%s", q->name, end);
    for (size_t i = 0; i + 1 < columns->count; i++)
        if (!strcmp(list[i].name, made->name))
            return fp3_fail(u->error, FP3_E_ARGUMENT, "'%s' is observed twice", made->name);
    made->values = malloc(u->def->count * sizeof(double));
    return made->values ? FP3_OK : fp3_no_memory(u->error);
}

static unsigned width_of(const run *u, const quantity *q) {
    return q->width[u->scene->dimensions == 3];
}

/* "_x" of the first of two or three numbers, "_w" of the first of four. */
static const char *end_of(unsigned width, unsigned k) {
    static const char *const ends[] = {"_w", "_x", "_y", "_z"};
    return width == 1 ? "" : ends[width == 4 ? k : k + 1];
}

static fp3_status add_quantity(run *u, const quantity *q) {
    fp3_status status = FP3_OK;
    for (unsigned k = 0; !status && k < width_of(u, q); k++)
        status = add_column(u, q, end_of(width_of(u, q), k));
    return status;
}

/* A name that there is not is refused by the world, which suggests one. */
static fp3_status observe(run *u, const char *name) {
    for (size_t i = 0; i < QUANTITIES; i++) {
        const quantity *q = &quantities[i];
        const unsigned width = width_of(u, q);
        const size_t length = strlen(q->name);
        if (width && !strcmp(q->name, name))
            return add_quantity(u, q);
        for (unsigned k = 0; width > 1 && k < width; k++)
            if (!strncmp(q->name, name, length) && !strcmp(name + length, end_of(width, k)))
                return add_column(u, q, end_of(width, k));
    }
    double value[4];
    const fp3_status status = fp3_bodies_read(u->scene->bodies, name, u->scene->handles, 1, value);
    return fp3_fail(u->error, status ? status : FP3_E_ARGUMENT, "--observe: %s",
                    status ? u->scene->why.text : name);
}

static fp3_status choose_columns(run *u) {
    const fp3_recording_def *def = u->def->recording;
    fp3_status status = FP3_OK;
    u->columns.room = u->def->count;
    for (size_t i = 0; !status && i < def->observed_count; i++)
        if (!strcmp(def->observed[i], "contacts"))
            u->has_contacts = 1;
        else
            status = observe(u, def->observed[i]);
    const int is_usual = def->observed_count == (size_t)u->has_contacts;
    for (size_t i = 0; !status && is_usual && i < QUANTITIES; i++)
        if (quantities[i].is_usual)
            status = add_quantity(u, &quantities[i]);
    return status;
}

/* ---- opening ---- */

/* Stops are where hashes are expected. */
static fp3_status plan_expected(run *u, const fp3_expected *expected) {
    uint64_t *steps = calloc(expected->count, sizeof *steps);
    if (!steps)
        return fp3_no_memory(u->error);
    for (size_t i = 0; i < expected->count; i++)
        steps[i] = expected->list[i].step;
    const fp3_status status = fp3_plan_steps(steps, expected->count, &u->plan, u->error);
    free(steps);
    return status;
}

static fp3_status plan(run *u) {
    const fp3_recording_def *def = u->def->recording;
    if (def->expected)
        return plan_expected(u, def->expected);
    const fp3_source source = {.has_time = 1, .h = u->scene->h, .h_given = u->scene->h};
    return fp3_plan_make(&source, def->steps, def->every, def->times, def->time_count, &u->plan,
                         u->error);
}

static fp3_status open_sink(run *u) {
    const fp3_recording_def *def = u->def->recording;
    const fp3_format *format = fp3_format_of(def->path);
    fp3_status status = choose_columns(u);
    u->is_hashed = format->is_hdf5;
    if (!status && !format->is_hdf5 && (def->is_compressed || u->has_contacts))
        status = fp3_fail(u->error, FP3_E_ARGUMENT,
                          "%s: only HDF5 (a name that ends in " FP3_HDF5_ENDINGS(" or ") ") %s",
                          def->path, def->is_compressed ? "is compressed" : "has contacts");
    if (!status)
        status =
            fp3_bodies_tables_open(u->scene, u->def->first, u->def->count, &u->tables, u->error);
    u->subject = (fp3_subject){.path = def->path,
                               .columns = &u->columns,
                               .around = &u->around,
                               .extras = u->tables.extras,
                               .extra_count = FP3_BODIES_TABLES,
                               .objects = u->def->count,
                               .snapshots = fp3_plan_count(&u->plan, u->kept.begin),
                               .has_time = 1,
                               .h = u->scene->h,
                               .time_unit = "s",
                               .engine = u->scene->engine ? u->scene->engine : "built in",
                               .config = "",
                               .command = def->command,
                               .is_compressed = def->is_compressed,
                               .is_hashed = u->is_hashed,
                               .before = u->kept.chain};
    return status ? status : format->open(&u->subject, &u->sink, u->error);
}

static fp3_status open_contacts(run *u) {
    fp3_status status = fp3_output_open(u->def->contacts, &u->contacts, u->error);
    if (!status)
        fputs("step,time [s],change,a,b,x [m],y [m],z [m],normal_x,normal_y,normal_z,speed "
              "[m/s],impulse [N*s]\r\n",
              fp3_output_stream(u->contacts));
    return status;
}

/* ---- steps ---- */

static fp3_status take_snapshot(run *u, uint64_t step) {
    fp3_bodies *bodies = u->scene->bodies;
    const fp3_slice block = {.number = u->number++,
                             .step = step,
                             .time = (double)step * u->scene->h,
                             .count = u->def->count,
                             .chain = &u->kept.chain};
    fp3_status status =
        u->is_hashed ? fp3_bodies_kept_hash(&u->kept, u->scene, step, u->error) : FP3_OK;
    if (status || !u->sink)
        return status;
    for (size_t i = 0; !status && i < u->columns.count; i++)
        status = fp3_bodies_read(bodies, u->columns.list[i].name, u->scene->handles + u->def->first,
                                 u->def->count, u->columns.list[i].values);
    if (!status)
        status = fp3_bodies_tables_look(&u->tables, block.number, u->has_contacts);
    return status ? failed(u, status) : u->sink->put(u->sink, &block, u->error);
}

static void write_changes(const run *u, uint64_t step, fp3_contact_change change,
                          const fp3_contact *list, size_t count) {
    static const char *const names[] = {
        [FP3_CONTACT_BEGAN] = "began", [FP3_CONTACT_ENDED] = "ended", [FP3_CONTACT_HIT] = "hit"};
    FILE *out = fp3_output_stream(u->contacts);
    char a[FP3_NAME_SIZE + 24], b[FP3_NAME_SIZE + 24];
    for (size_t i = 0; i < count; i++) {
        const fp3_contact *c = &list[i];
        fp3_bodies_scene_name(u->scene, (uint32_t)c->body_a, a);
        fp3_bodies_scene_name(u->scene, (uint32_t)c->body_b, b);
        fprintf(out, "%" PRIu64 ",%.17g,%s,%s,%s,%.17g,%.17g,%.17g,%.9g,%.9g,%.9g,%.9g,%.9g\r\n",
                step, (double)step * u->scene->h, names[change], a, b, c->point[0], c->point[1],
                c->point[2], c->normal[0], c->normal[1], c->normal[2], c->speed, c->impulse);
    }
}

static fp3_status look_at_changes(run *u, uint64_t step) {
    fp3_status status = FP3_OK;
    for (fp3_contact_change change = FP3_CONTACT_BEGAN; !status && change <= FP3_CONTACT_HIT;
         change++) {
        const fp3_contact *list;
        size_t count;
        status = fp3_bodies_changes(u->scene->bodies, change, &list, &count);
        if (status)
            return failed(u, status);
        u->tally->changes[change] += count;
        if (u->contacts)
            write_changes(u, step, change, list, count);
    }
    return u->contacts && ferror(fp3_output_stream(u->contacts))
               ? fp3_path_fail(u->error, u->def->contacts, "cannot write")
               : status;
}

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static fp3_status step(run *u, uint64_t steps) {
    const double begin = now();
    const fp3_status status = fp3_bodies_step(u->scene->bodies, steps);
    u->tally->seconds += now() - begin;
    return status ? failed(u, status) : FP3_OK;
}

static int is_stop(const run *u, uint64_t step) {
    return (u->sink || u->is_hashed) && fp3_plan_has(&u->plan, step);
}

static fp3_status make_steps(run *u) {
    const uint64_t steps = u->def->recording->steps, begin = u->kept.begin;
    const uint64_t most = u->contacts ? 1 : steps / PARTS + 1;
    fp3_status status = is_stop(u, begin) ? take_snapshot(u, begin) : FP3_OK;
    u->tally->begin = u->tally->steps = begin;
    for (uint64_t at = begin; !status && at < steps;) {
        const uint64_t stop = u->sink || u->is_hashed ? fp3_plan_next(&u->plan, at) : steps;
        const uint64_t due = fp3_bodies_kept_next(&u->kept, at, stop);
        const uint64_t next = due - at < most ? due : at + most;
        status = step(u, next - at);
        at = next;
        if (!status)
            status = look_at_changes(u, at);
        if (!status && is_stop(u, at))
            status = take_snapshot(u, at);
        if (!status)
            status = fp3_bodies_kept_take(&u->kept, u->scene, at, u->error);
        u->tally->steps = at;
        if (u->def->progress)
            u->def->progress(u->def->user, (double)at / (double)steps);
    }
    return status || begin < steps || u->def->recording->restart
               ? status
               : fp3_bodies_kept_take(&u->kept, u->scene, begin, u->error);
}

static void tell_chain(run *u) {
    if (u->kept.output)
        fp3_digest_text(&u->kept.past.chain, u->tally->chain);
    else if (u->sink && u->is_hashed)
        fp3_digest_text(&u->kept.chain, u->tally->chain);
}

static fp3_status begin_ranks(const run *u) {
    const fp3_status status =
        fp3_share_begin(u->scene->bodies, u->def->ranks, u->def->recording->steps);
    return status ? failed(u, status) : FP3_OK;
}

static fp3_status publish(run *u) {
    fp3_status status = FP3_OK;
    if (u->sink) {
        fp3_bodies_tables_gather(&u->tables);
        status = u->sink->publish(u->sink, u->error);
    }
    return !status && u->contacts ? fp3_output_publish(u->contacts, u->error) : status;
}

fp3_status fp3_bodies_scene_run(fp3_bodies_scene *scene, const fp3_bodies_run_def *def,
                                fp3_bodies_tally *tally, fp3_error *error) {
    FP3_HOST;
    run u = {.scene = scene, .def = def, .tally = tally, .error = error};
    *tally = (fp3_bodies_tally){0};
    fp3_status status = fp3_bodies_kept_open(scene, def->recording, &u.kept, error);
    u.is_hashed = def->recording->expected != NULL;
    if (!status && def->ranks)
        status = begin_ranks(&u);
    if (!status)
        status = plan(&u);
    if (!status && def->recording->path && !def->recording->is_silent)
        status = open_sink(&u);
    if (!status && def->contacts && !def->recording->is_silent)
        status = open_contacts(&u);
    if (!status)
        status = make_steps(&u);
    if (!status)
        status = publish(&u);
    if (!status)
        tell_chain(&u);
    fp3_bodies_kept_close(&u.kept);
    if (u.sink)
        u.sink->close(u.sink);
    fp3_output_close(&u.contacts);
    fp3_columns_free(&u.columns);
    fp3_bodies_tables_close(&u.tables);
    fp3_plan_free(&u.plan);
    return status;
}
