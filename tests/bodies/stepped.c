/* SPDX-License-Identifier: Apache-2.0 */
/* stepped.c - makes steps of a scene of bodies and prints fp3_bodies_hash: for machines that have
 * nothing but C.
 *
 *     stepped SCENE STEPS [ENGINE [CONFIG [WAY]]]
 *
 * SCENE is a file of tools/fp3bodies/by_fp3.py: the definitions of fp3/bodies.h as they are in
 * memory, which is the same on all machines here. ENGINE: "-" (default): laws are built in;
 * "native": "fast" with native code. CONFIG: "-" (default): that of fp3_bodies_default. WAY:
 *
 * - whole (default): everything is added in as few calls as there can be, and one call makes all
 *   steps;
 * - calls: a call for each body, shape, joint and step;
 * - restored: after half of the steps the world is saved, makes 5 steps more and goes back;
 * - far: other bodies fall, bounce and roll far away, behind all others, until half of the steps
 * are made; then they are removed;
 * - threadsN: as whole, by N threads;
 * - ranks: as whole, by all processes that mpirun has started; the first one prints;
 * - fileN: built-in laws make all steps but the last N; a checkpoint is written beside the scene,
 *   and what is opened from it makes the rest by ENGINE.
 */
#include "bodies/own.h"
#include "bodies/share.h"
#include "machine/cycles.h"
#include "machine/visit.h"

#include <fp3/bodies.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    double gravity[3], h;
    uint64_t dimensions, substeps, bodies, shapes, joints, chains;
} head;
typedef struct {
    uint64_t body;
    fp3_shape_def shape;
} attached;
typedef struct {
    uint64_t body, corners, is_loop;
    fp3_shape_def surface;
} chain;
typedef struct {
    fp3_bodies *world;
    uint64_t *handles;
    int by_calls;
    fp3_error error;
} scene;

static void must(scene *s, fp3_status status) {
    if (status) {
        fprintf(stderr, "stepped: %s\n", s->error.text);
        exit(1);
    }
}

/* The caller frees it. */
static void *take(FILE *file, size_t size, size_t count) {
    void *data = calloc(count + 1, size);
    if (!data || fread(data, size, count, file) != count) {
        fputs("stepped: the scene is cut off\n", stderr);
        exit(1);
    }
    return data;
}

static void add_bodies(scene *s, FILE *file, size_t count) {
    fp3_body_def *defs = take(file, sizeof *defs, count);
    const size_t each = s->by_calls || !count ? 1 : count;
    s->handles = calloc(count + 1, sizeof *s->handles);
    for (size_t i = 0; i < count; i += each)
        must(s, fp3_bodies_add(s->world, &defs[i], each, &s->handles[i]));
    free(defs);
}

/* Shapes that are alike and follow each other go into one call. */
static void attach(scene *s, FILE *file, size_t count) {
    attached *list = take(file, sizeof *list, count);
    uint64_t *handles = calloc(count + 1, sizeof *handles);
    for (size_t i = 0, same; i < count; i += same) {
        for (same = 0; i + same < count && (!same || !s->by_calls) &&
                       !memcmp(&list[i].shape, &list[i + same].shape, sizeof list[i].shape);
             same++)
            handles[same] = s->handles[list[i + same].body];
        must(s, fp3_bodies_attach(s->world, handles, same, &list[i].shape, NULL));
    }
    free(handles);
    free(list);
}

static void join(scene *s, FILE *file, size_t count) {
    fp3_joint_def *defs = take(file, sizeof *defs, count);
    uint64_t *joints = calloc(count + 1, sizeof *joints);
    const size_t each = s->by_calls || !count ? 1 : count;
    for (size_t i = 0; i < count; i++) {
        defs[i].a = s->handles[defs[i].a];
        defs[i].b = s->handles[defs[i].b];
    }
    for (size_t i = 0; i < count; i += each)
        must(s, fp3_bodies_join(s->world, &defs[i], each, joints));
    free(joints);
    free(defs);
}

static void add_chains(scene *s, FILE *file, size_t count) {
    for (size_t i = 0; i < count; i++) {
        chain *c = take(file, sizeof *c, 1);
        double *corners = take(file, 2 * sizeof *corners, c->corners);
        must(s, fp3_bodies_attach_chain(s->world, s->handles[c->body], corners, c->corners,
                                        (int)c->is_loop, &c->surface));
        free(corners);
        free(c);
    }
}

static fp3_bodies_def def_of(scene *s, const char *engine, const char *config) {
    fp3_bodies_def def = fp3_bodies_default();
    def.error = &s->error;
    def.may_compile = engine && !strcmp(engine, "native");
    def.engine = def.may_compile ? "fast" : engine;
    def.config = config;
    return def;
}

static void build(scene *s, FILE *file, const char *engine, const char *config, uint32_t threads) {
    fp3_bodies_def def = def_of(s, engine, config);
    def.threads = threads;
    head *h = take(file, sizeof *h, 1);
    memcpy(def.gravity, h->gravity, sizeof h->gravity);
    def.h = h->h;
    def.dimensions = (uint32_t)h->dimensions;
    def.substeps = (uint32_t)h->substeps;
    must(s, fp3_bodies_open(&def, &s->world));
    add_bodies(s, file, h->bodies);
    attach(s, file, h->shapes);
    add_chains(s, file, h->chains);
    join(s, file, h->joints);
    free(h);
}

static void go_back(scene *s) {
    fp3_bodies_state *state = NULL;
    must(s, fp3_bodies_save(s->world, &state));
    must(s, fp3_bodies_step(s->world, 5));
    must(s, fp3_bodies_restore(s->world, state));
    fp3_bodies_state_free(&state);
}

#define FAR 24
static void add_far(scene *s, uint64_t far[FAR]) {
    const int is_space = s->world->space != NULL;
    for (int i = 0; i < FAR; i++) { /* a row of balls that stand, and balls and boxes on it */
        fp3_body_def body = fp3_body_default();
        fp3_shape_def shape = is_space ? fp3_shape_sphere(0.5) : fp3_shape_circle(0.5);
        if (i % 4 == 3)
            shape = is_space ? fp3_shape_box3(0.4, 0.4, 0.4, 0) : fp3_shape_box(0.4, 0.4, 0);
        shape.restitution = 0.6;
        shape.rolling = 0.1;
        body.type = i % 2 ? FP3_DYNAMIC : FP3_STATIC;
        body.x[0] = 2000 + 0.7 * (i / 2);
        body.x[1] = i % 2 ? 0.9 + 0.1 * i : 0;
        must(s, fp3_bodies_add(s->world, &body, 1, &far[i]));
        must(s, fp3_bodies_attach(s->world, &far[i], 1, &shape, NULL));
    }
}

static void from_file(scene *s, const char *path, const char *engine, const char *config) {
    char name[4096];
    fp3_bodies_def def = def_of(s, engine, config);
    snprintf(name, sizeof name, "%s.ck", path);
    must(s, fp3_bodies_checkpoint(s->world, name));
    fp3_bodies_close(&s->world);
    must(s, fp3_bodies_restart(&def, name, &s->world));
}

static void make_steps(scene *s, uint64_t count) {
    const uint64_t each = s->by_calls || !count ? 1 : count;
    for (uint64_t i = 0; i < count; i += each)
        must(s, fp3_bodies_step(s->world, each));
}

/* Cycles of a run, which always has so many objects, as they are foreseen. */
#define OBJECTS 64 /* as programs.c has them */
static uint64_t foreseen(const fp3_image *image, const fp3_config *config) {
    fp3_visit *visit = NULL;
    fp3_error error;
    if (fp3_visit_make(image, &visit, &error))
        return 0;
    const fp3_swept swept = {visit->decoded, visit->code_count, visit->step, visit->last, 1};
    const uint32_t lanes = config->lanes;
    const uint64_t cycles =
        fp3_cycles_interleaved(config, (OBJECTS + lanes - 1) / lanes, 1, &swept);
    fp3_visit_free(&visit);
    return cycles;
}

/* A line for each law of the hardware: its runs, contacts or joints and empty lanes in them,
 * cycles, those foreseen for a run, by 38 lanes, too, and words and cycles of the bus. */
static void print_use(const scene *s, const char *name) {
    const fp3_config *config = fp3_config_find(name ? name : "world");
    fp3_config wide = *config;
    fp3_laws_use use;
    wide.lanes = 38;
    for (uint32_t i = 0; fp3_laws_used(s->world->laws, i, &use); i++)
        printf("%s %" PRIu64 " %" PRIu64 " %" PRIu64 " %" PRIu64 " %" PRIu64 " %" PRIu64 " %" PRIu64
               "\n",
               use.name, use.runs, use.lanes, use.cycles, foreseen(use.image, config),
               foreseen(use.image, &wide), use.bus.transfers, use.bus.cycles);
}

int main(int argc, char **argv) {
    const char *engine = argc > 3 && strcmp(argv[3], "-") ? argv[3] : NULL,
               *config = argc > 4 && strcmp(argv[4], "-") ? argv[4] : NULL,
               *way = argc > 5 ? argv[5] : "whole";
    const uint64_t steps = argc > 2 ? strtoull(argv[2], NULL, 10) : 0;
    scene s = {.by_calls = !strcmp(way, "calls")};
    FILE *file = argc > 2 ? fopen(argv[1], "rb") : NULL;
    if (!file) {
        fputs("usage: stepped SCENE STEPS [ENGINE [CONFIG "
              "[whole|calls|restored|far|threadsN|ranks|fileN]]]\n",
              stderr);
        return 2;
    }
    const int has_file = !strncmp(way, "file", 4);
    const uint64_t last = has_file ? strtoull(way + 4, NULL, 10) : steps / 2;
    const uint32_t threads = strncmp(way, "threads", 7) ? 1 : (uint32_t)strtoul(way + 7, NULL, 10);
    build(&s, file, has_file ? NULL : engine, has_file ? NULL : config, threads);
    fclose(file);
    fp3_ranks ranks = {0};
    if (!strcmp(way, "ranks")) {
        must(&s, fp3_ranks_open(&ranks, &s.error));
        must(&s, fp3_share_begin(s.world, &ranks, steps));
    }
    uint64_t far[FAR];
    const int has_far = !strcmp(way, "far");
    if (has_far)
        add_far(&s, far);
    make_steps(&s, steps - last);
    if (has_far)
        must(&s, fp3_bodies_remove(s.world, far, FAR));
    if (!strcmp(way, "restored"))
        go_back(&s);
    if (has_file)
        from_file(&s, argv[1], engine, config);
    make_steps(&s, last);
    if (!ranks.rank)
        printf("%016" PRIx64 "\n", fp3_bodies_hash(s.world));
    if (engine && !strcmp(engine, "rtl"))
        print_use(&s, config);
    fp3_bodies_close(&s.world);
    free(s.handles);
    return ranks.count && ranks.calls->close(ranks.world, 0);
}
