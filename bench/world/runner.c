/* runner.c - see runner.h. */
#include "runner.h"

#include "world/values_own.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

/* One thread is measured by what the processor gave it, several by the clock on the wall. */
static double seconds_of(const runner *r) {
    struct timespec now;
    clock_gettime(r->threads > 1 ? CLOCK_MONOTONIC : CLOCK_PROCESS_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* ---- columns ---- */

static fp3_status make_columns(runner *r, size_t objects, fp3_error *error) {
    r->now.objects = objects;
    float *all = calloc(7 * objects + 1, sizeof *all);
    r->memory[0] = all;
    if (!all)
        return fp3_no_memory(error);
    for (int c = 0; c < 3; c++) {
        r->now.x[c] = all + (size_t)c * objects;
        r->now.v[c] = all + (size_t)(3 + c) * objects;
    }
    r->now.weight = all + 6 * objects;
    return FP3_OK;
}

static fp3_status read_column(const runner *r, const char *name, float *to, fp3_error *error) {
    fp3_status status = FP3_OK;
    for (size_t i = 0; !status && i < r->scene->group_count; i++) {
        const fp3_scene_group *group = &r->scene->groups[i];
        const fp3_symbol *s = fp3_image_find(group->program->image, name, FP3_CLASSES_OBJECT);
        status = s ? fp3_engine_read(r->engine, group->first, group->objects, s->index,
                                     to + group->first)
                   : fp3_fail(error, FP3_E_ARGUMENT, "the scene's program has no '%s'", name);
    }
    return status;
}

static fp3_status read_states(runner *r, fp3_error *error) {
    static const char *const names[] = {"x_x", "x_y", "x_z", "v_x", "v_y", "v_z"};
    fp3_status status = FP3_OK;
    for (int k = 0; !status && k < 6; k++)
        status = read_column(r, names[k], k < 3 ? r->now.x[k] : r->now.v[k - 3], error);
    return status;
}

/* ---- the engine ---- */

fp3_status runner_open_fast(runner *r, const fp3_scene *scene, unsigned threads, fp3_error *error) {
    fp3_engine_def def = fp3_scene_engine(scene);
    def.engine = "fast";
    def.threads = threads;
    def.error = error;
    r->threads = threads;
    r->scene = scene;
    fp3_status status = make_columns(r, scene->objects, error);
    if (!status)
        status = fp3_engine_open(&def, &r->engine);
    return status ? status : fp3_scene_load(scene, r->engine, error);
}

/* ---- the loop ---- */

static fp3_status number_of(const fp3_scene_group *group, const char *name, double *number,
                            fp3_error *error) {
    const fp3_model *model = group->program->model;
    const uint32_t i = model ? fp3_model_param(model, name) : FP3_NONE;
    if (strcmp(name, "h") == 0 && model)
        *number = model->step;
    else if (i == FP3_NONE)
        return fp3_fail(error, FP3_E_ARGUMENT, "%s: the model has no param '%s'", group->path,
                        name);
    else
        *number = model->params[i].value;
    const fp3_status status = fp3_params_has(group->params, name)
                                  ? fp3_params_get(group->params, name, number, error)
                                  : FP3_OK;
    *number = (double)(float)*number;
    return status;
}

static fp3_status read_net(const fp3_scene_group *group, hand_world *w, fp3_error *error) {
    static const char *const names[] = {"g_x", "g_y", "g_z"};
    double m = 0, g = 0;
    fp3_status status = number_of(group, "m", &m, error);
    for (int c = 0; !status && c < 3; c++) {
        status = number_of(group, names[c], &g, error);
        w->pull[c] = (float)(m * g);
    }
    return status;
}

static fp3_status read_stars(const fp3_scene_group *group, hand_world *w, fp3_error *error) {
    double G = 0, soft = 0;
    fp3_status status = number_of(group, "G", &G, error);
    if (!status)
        status = number_of(group, "soft", &soft, error);
    w->gravity = (float)G;
    w->soft_square = (float)(soft * soft);
    return status;
}

static fp3_status read_balls(const fp3_scene_group *group, hand_world *w, fp3_error *error) {
    static const char *const names[] = {"R",   "stiff", "damp", "side", "roof",
                                        "g_x", "g_y",   "g_z",  "m"};
    double n[9] = {0};
    fp3_status status = FP3_OK;
    for (int i = 0; !status && i < 9; i++)
        status = number_of(group, names[i], &n[i], error);
    w->contact = (hand_contact){.radius = (float)n[0],
                                .stiff = (float)n[1],
                                .damp = (float)n[2],
                                .reach_square = (float)(2 * n[0] * (2 * n[0])),
                                .over_m = (float)(1 / n[8]),
                                .g = {(float)n[5], (float)n[6], (float)n[7]},
                                .wall = {(float)n[3], (float)n[4], (float)n[3]}};
    return status;
}

/* The column of a field, or one of the model's default. */
static float field_at(const fp3_model *model, const fp3_links *links, const char *name, size_t i) {
    for (size_t k = 0; k < links->field_count; k++)
        if (strcmp(links->names[k], name) == 0 && !isnan(links->fields[k][i]))
            return links->fields[k][i];
    for (uint32_t k = 0; k < model->field_count; k++)
        if (strcmp(model->fields[k].name, name) == 0)
            return (float)model->fields[k].value;
    return NAN;
}

/* An entry at each end of a link, in the order of the links. */
static fp3_status read_links(runner *r, const fp3_scene_group *group, fp3_error *error) {
    const fp3_linked *linked = group->params->linked;
    if (!linked || linked->next)
        return fp3_fail(error, FP3_E_ARGUMENT, "%s: expected links of one relation", group->path);
    const fp3_links *links = &linked->links;
    const size_t objects = r->now.objects;
    uint32_t *begin = r->memory[1] = calloc(objects + 2, sizeof *begin);
    uint32_t *other = r->memory[2] = malloc((2 * links->count + 1) * sizeof *other);
    float *k = r->memory[3] = malloc((4 * links->count + 1) * sizeof *k);
    if (!begin || !other || !k)
        return fp3_no_memory(error);
    float *rest = k + 2 * links->count;
    for (size_t i = 0; i < links->count; i++) {
        begin[links->a[i] + 2]++;
        begin[links->b[i] + 2]++;
    }
    for (size_t i = 2; i < objects + 2; i++)
        begin[i] += begin[i - 1];
    for (size_t i = 0; i < 2 * links->count; i++) {
        const uint32_t a = links->a[i / 2], b = links->b[i / 2];
        const uint32_t at = begin[(i % 2 ? b : a) + 1]++;
        other[at] = i % 2 ? a : b;
        k[at] = field_at(group->program->model, links, "k", i / 2);
        rest[at] = field_at(group->program->model, links, "rest", i / 2);
    }
    r->now.begin = begin;
    r->now.other = other;
    r->now.stiffness = k;
    r->now.rest = rest;
    return FP3_OK;
}

fp3_status runner_open_hand(runner *r, const fp3_scene *scene, const char *loop, fp3_error *error) {
    const hand_loop *found = hand_find(loop);
    double h = 0;
    if (!found)
        return fp3_fail(
            error, FP3_E_ARGUMENT,
            "no loop '%s' for this processor: there are net, stars and balls, for x86-64-v3 "
            "and x86-64-v4",
            loop);
    if (!found->is_exact())
        return fp3_fail(error, FP3_E_MISMATCH, "loop '%s': an estimate is not that of FP3", loop);
    const int is_net = !strcmp(loop, "net"), is_stars = !strcmp(loop, "stars");
    if (scene->group_count > (is_net || is_stars ? 1 : 2))
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "%s: loop '%s' has one kind of objects, balls have two", scene->path, loop);
    fp3_status status = runner_open_fast(r, scene, 1, error); /* where objects are at first */
    if (!status)
        status = read_states(r, error);
    if (!status && (is_net || is_stars))
        status = read_column(r, is_net ? "w" : "m", r->now.weight, error);
    if (!status)
        status = number_of(&scene->groups[0], "h", &h, error);
    r->now.h = (float)h;
    r->now.first_kind = scene->groups[0].objects;
    if (!status)
        status = is_net     ? read_net(&scene->groups[0], &r->now, error)
                 : is_stars ? read_stars(&scene->groups[0], &r->now, error)
                            : read_balls(&scene->groups[0], &r->now, error);
    if (!status && is_net)
        status = read_links(r, &scene->groups[0], error);
    fp3_engine_close(&r->engine);
    r->loop = found;
    if (!status && !(r->state = found->open(&r->now)))
        status = fp3_fail(error, FP3_E_SYSTEM,
                          "the loop by hand has no memory, or a ball is far from all others");
    return status;
}

void runner_close(runner *r) {
    if (r->state)
        r->loop->close(r->state);
    fp3_engine_close(&r->engine);
    for (int k = 0; k < 4; k++)
        free(r->memory[k]);
    *r = (runner){0};
}

/* ---- steps ---- */

fp3_status runner_go(runner *r, uint64_t steps, fp3_error *error) {
    fp3_status status = FP3_OK;
    const double begin = seconds_of(r);
    if (r->loop && !r->loop->run(r->state, steps))
        status = fp3_fail(error, FP3_E_PROGRAM,
                          "the loop by hand has no memory, or a ball is far from all others");
    else if (!r->loop)
        status = fp3_engine_run(r->engine, steps, NULL);
    const double seconds = seconds_of(r) - begin;
    if (r->seconds == 0 || seconds < r->seconds)
        r->seconds = seconds;
    return status;
}

fp3_status runner_read(runner *r, fp3_error *error) {
    if (!r->loop)
        return read_states(r, error);
    r->loop->read(r->state, &r->now);
    return FP3_OK;
}

size_t runner_differ(const runner *r, const runner *other) {
    size_t count = 0;
    for (size_t i = 0; i < r->now.objects; i++)
        for (int c = 0; c < 3; c++) {
            count += memcmp(&r->now.x[c][i], &other->now.x[c][i], sizeof(float)) != 0;
            count += memcmp(&r->now.v[c][i], &other->now.v[c][i], sizeof(float)) != 0;
        }
    return count;
}
