/* SPDX-License-Identifier: Apache-2.0 */
/* bench_scene.c - see bench_scene.h. */
#include "bench_scene.h"

#include "base/threads.h"
#include "cli.h"
#include "files.h"
#include "json.h"
#include "progress.h"

#include <fp3/scene.h>
#include <inttypes.h>
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { TURNS = 5 };
#define FRAME (1.0 / 60)
#define TURN_SECONDS 0.2
/* What the isa engine may take, and how much longer than engine fast with one thread it may need
 * for a step. */
#define ISA_SECONDS 2.0
#define ISA_SLOWER 400.0
#define FAILED_FLAGS (FP3_FLAG_INVALID | FP3_FLAG_OVERFLOW | FP3_FLAG_DIVIDE_BY_ZERO)

typedef struct {
    const char *engine;
    uint32_t threads;
    fp3_engine *handle;
    char how[64];   /* fp3_engine_how, without why */
    double seconds; /* the shortest turn; 0: none yet */
    uint64_t object_steps;
    uint32_t flags;
    size_t differ; /* words of states that the first one does not have */
    size_t astray; /* values of states that are not finite in the end */
} side;

int fp3_bench_is_scene(const char *path) {
    const size_t length = strlen(path);
    return length > 6 && !strcmp(path + length - 6, ".scene");
}

/* ---- one of them ---- */

static fp3_status open_side(const fp3_scene *scene, side *s, fp3_error *error) {
    fp3_engine_def def = fp3_scene_engine(scene);
    def.engine = s->engine;
    def.threads = s->threads;
    def.error = error;
    return fp3_engine_open(&def, &s->handle);
}

/* The scene's first steps. */
static fp3_status go(const fp3_scene *scene, uint64_t steps, side *s, fp3_stats *stats,
                     fp3_error *error) {
    const fp3_status status = fp3_scene_load(scene, s->handle, error);
    return status ? status : fp3_adaptive_run(s->handle, steps, stats);
}

static fp3_status turn(const fp3_scene *scene, uint64_t steps, side *s, fp3_error *error) {
    fp3_stats stats = {.flags = 0};
    const fp3_status status = go(scene, steps, s, &stats, error);
    if (!status && (s->seconds == 0 || stats.seconds < s->seconds))
        s->seconds = stats.seconds;
    s->object_steps = stats.object_steps;
    s->flags |= stats.flags;
    snprintf(s->how, sizeof s->how, "%s", fp3_engine_how(s->handle));
    char *const why = strstr(s->how, " (");
    if (why)
        *why = 0;
    return status;
}

/* ---- bits ---- */

/* Adds what one state of a group has to *s. */
static fp3_status compare_state(const fp3_scene_group *group, uint32_t reg, const side *first,
                                float *room, side *s) {
    float *const a = room, *const b = room + group->objects;
    fp3_status status = fp3_engine_read(first->handle, group->first, group->objects, reg, a);
    if (!status)
        status = fp3_engine_read(s->handle, group->first, group->objects, reg, b);
    for (size_t i = 0; !status && i < group->objects; i++) {
        s->differ += memcmp(&a[i], &b[i], sizeof *a) != 0;
        s->astray += !isfinite(b[i]);
    }
    return status;
}

/* All states of the scene. */
static fp3_status compare(const fp3_scene *scene, const side *first, side *s, fp3_error *error) {
    float *room = malloc(2 * scene->objects * sizeof *room);
    if (!room)
        return fp3_no_memory(error);
    fp3_status status = FP3_OK;
    s->differ = s->astray = 0;
    for (size_t g = 0; !status && g < scene->group_count; g++) {
        const fp3_image *image = scene->groups[g].program->image;
        for (uint32_t i = 0; !status && i < image->symbol_count; i++)
            if (image->symbols[i].symbol_class == FP3_SYMBOL_STATE)
                status = compare_state(&scene->groups[g], image->symbols[i].index, first, room, s);
    }
    free(room);
    return status;
}

/* As many of the steps as the isa engine makes in some seconds; *steps 0: not one, or the scene has
 * more objects than it holds. */
static fp3_status beside_isa(const fp3_scene *scene, side *first, uint64_t of, uint64_t *steps,
                             size_t *differ, fp3_error *error) {
    const double most = ISA_SECONDS / (ISA_SLOWER * first->seconds / (double)of);
    side isa = {.engine = "isa"};
    *steps = most < (double)of ? (uint64_t)most : of;
    if (scene->objects > fp3_engine_room("isa", scene->config))
        *steps = 0;
    if (!*steps)
        return FP3_OK;
    fp3_status status = open_side(scene, &isa, error);
    if (!status)
        status = fp3_scene_load(scene, isa.handle, error);
    /* Engine fast ran the program: only its records can be too large for the store. */
    if (status == FP3_E_PROGRAM) {
        *steps = 0;
        status = FP3_OK;
    }
    if (!status && *steps)
        status = fp3_adaptive_run(isa.handle, *steps, NULL);
    if (!status && *steps)
        status = go(scene, *steps, first, NULL, error);
    if (!status && *steps)
        status = compare(scene, first, &isa, error);
    *differ = isa.differ;
    fp3_engine_close(&isa.handle);
    return status;
}

/* ---- what is told ---- */

typedef struct {
    uint64_t steps;
    size_t differ;
} beside;

/* Not every object makes every step: some are born late, or fall asleep. */
static double ns_of(const side *s) { return 1e9 * s->seconds / (double)s->object_steps; }

static double frame_of(const side *s, uint64_t steps) { return FRAME * (double)steps / s->seconds; }

static json_t *row_of(const side *s, uint64_t steps) {
    return json_pack("{s:s, s:I, s:f, s:f, s:f, s:I}", "engine", s->how, "threads",
                     (json_int_t)s->threads, "ns_per_object_step", ns_of(s),
                     "million_object_steps_per_second", 1e3 / ns_of(s), "steps_in_a_frame",
                     frame_of(s, steps), "words_differing", (json_int_t)s->differ);
}

static void print_row(const side *s, uint64_t steps) {
    printf("%-22s  %7" PRIu32 "  %14.4g  %9.4g  %15.4g  %12zu\n", s->how, s->threads, ns_of(s),
           1e3 / ns_of(s), frame_of(s, steps), s->differ);
}

static void print_table(const fp3_scene *scene, uint64_t steps, const side *sides, size_t count,
                        const beside *isa) {
    printf("%s: %zu objects, %" PRIu64 " steps from the start\n\n", scene->path, scene->objects,
           steps);
    printf("%-22s  %7s  %14s  %9s  %15s  %12s\n", "engine fast", "threads", "ns/object-step",
           "million/s", "steps in 1/60 s", "words differ");
    for (size_t i = 0; i < count; i++)
        print_row(&sides[i], steps);
    if (isa->steps)
        printf("\nengine isa: %zu words differ after %" PRIu64 " steps\n", isa->differ, isa->steps);
    else
        printf("\nengine isa: not compared, the scene is too large for isa\n");
}

static fp3_status write_json(const char *path, const fp3_scene *scene, uint64_t steps,
                             const side *sides, size_t count, const beside *isa, fp3_error *error) {
    json_t *rows = json_array();
    for (size_t i = 0; i < count; i++)
        json_array_append_new(rows, row_of(&sides[i], steps));
    return fp3_json_write(
        path,
        json_pack("{s:s, s:I, s:I, s:o, s:{s:I, s:I}}", "scene", scene->path, "objects",
                  (json_int_t)scene->objects, "steps", (json_int_t)steps, "rows", rows, "isa",
                  "steps", (json_int_t)isa->steps, "words_differing", (json_int_t)isa->differ),
        9, error);
}

static fp3_status judge(const side *sides, size_t count, const beside *isa, fp3_error *error) {
    size_t differ = isa->differ;
    for (size_t i = 0; i < count; i++)
        differ += sides[i].differ;
    if (differ)
        return fp3_fail(error, FP3_E_MISMATCH, "%zu words differ", differ);
    if (sides[0].flags & FAILED_FLAGS || sides[0].astray)
        return fp3_fail(error, FP3_E_FAILED,
                        "an object failed in these steps; fp3 run --scene says which, and when");
    return FP3_OK;
}

/* ---- all of it ---- */

/* As many of the scene's steps as take long enough to be timed. */
static fp3_status find_steps(const fp3_scene *scene, side *s, uint64_t *steps, fp3_error *error) {
    fp3_stats stats = {.flags = 0};
    fp3_status status = FP3_OK;
    for (*steps = 1; !status; *steps *= 2) {
        status = go(scene, *steps, s, &stats, error); /* the first makes the native code, too */
        if (*steps > 1 && stats.seconds > TURN_SECONDS)
            break;
        if (*steps >= scene->steps / 2) {
            *steps = scene->steps;
            break;
        }
    }
    return status;
}

/* *steps 0: what it finds. */
static fp3_status measure(const fp3_scene *scene, uint64_t *steps, unsigned turns, side *sides,
                          size_t count, fp3_progress *progress, fp3_error *error) {
    fp3_status status = FP3_OK;
    for (size_t i = 0; !status && i < count; i++)
        status = open_side(scene, &sides[i], error);
    if (!status && !*steps)
        status = find_steps(scene, &sides[0], steps, error);
    for (unsigned n = 0; !status && n < turns; n++) {
        fp3_progress_say(progress, "turn %u of %u", n + 1, turns);
        for (size_t i = 0; !status && i < count; i++)
            status = turn(scene, *steps, &sides[i], error);
    }
    if (!status && !sides[0].object_steps)
        status = fp3_fail(error, FP3_E_ARGUMENT, "%s: no object makes a step in the first %" PRIu64,
                          scene->path, *steps);
    for (size_t i = 0; !status && i < count; i++)
        status = compare(scene, &sides[0], &sides[i], error);
    return status;
}

static fp3_status check(const fp3_bench_scene *what, const fp3_scene *scene, fp3_error *error) {
    for (size_t i = 0; i < scene->group_count; i++) {
        const fp3_scene_group *group = &scene->groups[i];
        fp3_files files = {0};
        fp3_files_read_group(&files, group);
        fp3_files_write(&files, "--json", what->json);
        const fp3_status status = fp3_files_check(&files, error);
        if (status)
            return status;
        if (fp3_adaptive_is(group->program->image))
            return fp3_fail_at(error, FP3_E_ARGUMENT, scene->path, (unsigned)group->line, 0,
                               "adaptive steps: expected a scene of fixed steps, because adaptive "
                               "objects make different numbers of steps; fp3 bench MODEL "
                               "measures both");
    }
    return FP3_OK;
}

static fp3_status run(const fp3_bench_scene *what, const fp3_scene *scene, fp3_progress **progress,
                      fp3_error *error) {
    uint64_t steps = what->steps;
    const uint32_t processors = fp3_threads_processors();
    side sides[] = {{.engine = "fast", .threads = 1}, {.engine = "fast", .threads = processors}};
    const size_t count = processors > 1 ? 2 : 1;
    beside isa = {0, 0};
    fp3_status status =
        measure(scene, &steps, what->is_quick ? 1 : TURNS, sides, count, *progress, error);
    if (!status) {
        fp3_progress_say(*progress, "comparing with engine isa");
        status = beside_isa(scene, &sides[0], steps, &isa.steps, &isa.differ, error);
    }
    fp3_progress_end(progress);
    if (!status) {
        print_table(scene, steps, sides, count, &isa);
        if (what->json)
            status = write_json(what->json, scene, steps, sides, count, &isa, error);
    }
    if (!status)
        status = judge(sides, count, &isa, error);
    for (size_t i = 0; i < count; i++)
        fp3_engine_close(&sides[i].handle);
    return status;
}

fp3_status fp3_bench_scene_run(const fp3_bench_scene *what, fp3_error *error) {
    fp3_files files = {0};
    fp3_files_read(&files, "SCENE", what->path);
    fp3_files_write(&files, "--json", what->json);
    fp3_status status = fp3_files_check(&files, error);
    if (status)
        return status;
    fp3_progress *progress = fp3_progress_begin("bench", what->path);
    fp3_progress_say(progress, "reading and compiling");
    fp3_scene *scene = NULL;
    status = fp3_scene_open(what->path, what->config, &scene, error);
    if (!status)
        status = check(what, scene, error);
    if (!status)
        status = run(what, scene, &progress, error);
    fp3_progress_end(&progress);
    fp3_scene_close(&scene);
    return status;
}
