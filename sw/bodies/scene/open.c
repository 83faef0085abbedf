/* SPDX-License-Identifier: Apache-2.0 */
/* open.c - a scene of bodies is opened: its world, its bodies, its joints. */
#include "read.h"

#include "base/host.h"

#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

typedef struct {
    const char *name;
    size_t at;
} number;

static const number numbers[] = {{"h", offsetof(fp3_bodies_def, h)},
                                 {"size", offsetof(fp3_bodies_def, size)},
                                 {"push", offsetof(fp3_bodies_def, push)},
                                 {"bounce", offsetof(fp3_bodies_def, bounce)},
                                 {"rest_speed", offsetof(fp3_bodies_def, rest_speed)},
                                 {"rest_time", offsetof(fp3_bodies_def, rest_time)}};

/* What is read once. */
static fp3_status read_count(const fp3_reader *r, const char *name, uint64_t least, uint64_t most,
                             uint64_t *count) {
    const config_setting_t *at = config_setting_get_member(r->in->root, name);
    return at ? fp3_setting_count(r->in, at, name, least, most, count) : FP3_OK;
}

/* What replaces the file's engine is the caller's own mistake, if it is one: it has no line. */
static fp3_status open_world(fp3_reader *r, const char *engine, uint32_t threads) {
    const config_setting_t *root = r->in->root, *at = config_setting_get_member(root, "engine");
    fp3_bodies_scene *scene = r->scene;
    fp3_bodies_def def = fp3_bodies_default();
    uint64_t substeps = def.substeps, dimensions = 2;
    const char *name = engine;
    fp3_status status = at && !engine ? fp3_setting_text(r->in, at, "engine", &name) : FP3_OK;
    if (!status && name && !(scene->engine = strdup(name)))
        status = fp3_no_memory(r->in->error);
    if (!status && name && strcmp(name, "isa") && strcmp(name, "fast") && strcmp(name, "rtl"))
        return engine ? fp3_fail(r->in->error, FP3_E_ARGUMENT,
                                 "--engine: found '%s', expected isa, fast or rtl; without it the "
                                 "laws of bodies are built in",
                                 name)
                      : fp3_setting_wrong(r->in, at,
                                          "engine: found '%s', expected \"isa\", \"fast\" or "
                                          "\"rtl\"; without it the laws of bodies are built in",
                                          name);
    if (!status)
        status = read_count(r, "dimensions", 2, UINT32_MAX, &dimensions);
    if (!status && dimensions > 3)
        status = fp3_setting_expected(r->in, config_setting_get_member(root, "dimensions"),
                                      "dimensions", "2, a plane, or 3, space");
    r->dimensions = scene->dimensions = def.dimensions = (uint32_t)dimensions;
    if (!status)
        status = fp3_read_place(r, root, "gravity", def.gravity);
    for (size_t i = 0; !status && i < sizeof numbers / sizeof *numbers; i++)
        status = fp3_read_value(r, root, numbers[i].name,
                                (double *)(void *)((char *)&def + numbers[i].at));
    if (!status)
        status = read_count(r, "substeps", 1, FP3_SUBSTEPS, &substeps);
    if (status)
        return status;
    def.engine = scene->engine;
    def.threads = def.engine && !threads ? 1 : threads;
    def.substeps = (uint32_t)substeps;
    def.error = &scene->why;
    scene->def = def;
    scene->h = def.h;
    scene->substeps = def.substeps;
    status = fp3_bodies_open(&def, &scene->bodies);
    return status ? fp3_read_refused(r, root, "", status) : FP3_OK;
}

static fp3_status read_scene(fp3_reader *r, const char *engine, const uint32_t *seed,
                             uint32_t threads) {
    static const char *const names[] = {"dimensions", "steps",     "seed",     "engine", "gravity",
                                        "h",          "size",      "substeps", "push",   "bounce",
                                        "rest_speed", "rest_time", "bodies",   "joints", NULL};
    const config_setting_t *root = r->in->root;
    fp3_status status = fp3_setting_keys(r->in, root, "a scene of bodies", names);
    if (!status)
        status = read_count(r, "steps", 0, UINT32_MAX, &r->scene->steps);
    if (!status)
        status = read_count(r, "seed", 0, UINT32_MAX, &r->seed);
    r->seed = seed ? *seed : r->seed;
    if (!status)
        status = open_world(r, engine, threads);
    const config_setting_t *bodies = config_setting_get_member(root, "bodies");
    const config_setting_t *joints = config_setting_get_member(root, "joints");
    if (!status && !bodies)
        status = fp3_setting_wrong(r->in, root, "expected bodies = ( { ... }, ... )");
    if (!status)
        status = fp3_read_bodies(r, bodies);
    return !status && joints ? fp3_read_joints(r, joints) : status;
}

int fp3_bodies_scene_is(const char *path) {
    fp3_settings in = {0};
    fp3_error why;
    struct stat found;
    if (stat(path, &found) || !S_ISREG(found.st_mode))
        return 0;
    const int is = !fp3_settings_load(path, FP3_E_ARGUMENT, &in, &why) &&
                   config_setting_get_member(in.root, "bodies");
    fp3_settings_close(&in);
    return is;
}

fp3_status fp3_bodies_scene_open(const char *path, const char *engine, const uint32_t *seed,
                                 uint32_t threads, fp3_bodies_scene **scene, fp3_error *error) {
    FP3_HOST;
    fp3_settings in = {0};
    fp3_bodies_scene *made = calloc(1, sizeof *made);
    *scene = NULL;
    if (!made)
        return fp3_no_memory(error);
    fp3_reader r = {.in = &in, .scene = made};
    made->steps = 1;
    made->path = strdup(path);
    fp3_status status = made->path ? fp3_settings_load(made->path, FP3_E_ARGUMENT, &in, error)
                                   : fp3_no_memory(error);
    if (!status)
        status = read_scene(&r, engine, seed, threads);
    fp3_reader_close(&r);
    if (made->path)
        fp3_settings_close(&in);
    if (status)
        fp3_bodies_scene_close(&made);
    *scene = made;
    return status;
}
