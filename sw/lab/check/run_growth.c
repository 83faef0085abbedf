/* SPDX-License-Identifier: Apache-2.0 */
/* run_growth.c - see run_growth.h. */
#include "run_growth.h"

#include "lab/scene/spectrum.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MUCH 0x1p24     /* in a run that enlarges errors less, they stay below the digits of FP32 */
#define FEW 100         /* steps: only of small scenes, where a look takes some milliseconds */
#define SMALL_SCENE 256 /* objects */
#define LEAST 1e6       /* numbers, which take some milliseconds: what a look may compute */
#define SHARE 0.1       /* of the steps that objects have made: likewise */
#define SPARSE 1        /* neighbours: where an object has fewer in the end, objects fly apart */
#define MANY 65536      /* objects, which take long enough to be looked at once only */
#define MANY_STEPS 2048 /* unless the run takes long, too */

struct fp3_run_growth {
    const fp3_run_set *set;
    fp3_scene scene; /* of the set alone */
    fp3_spectrum *spectrum;
    fp3_growth found;
    int is_packed; /* where it was found */
};

static const fp3_program *program_of(const fp3_run_growth *of) {
    return of->set->parts[of->found.group].program;
}

static int is_looked_at(const fp3_run_set *set) {
    int sees = 0;
    for (size_t i = 0; i < set->count; i++) {
        const fp3_program *p = set->parts[i].program;
        if (!p->model || fp3_adaptive_is(p->image))
            return 0;
        sees |= p->sees_others;
    }
    return sees;
}

/* A program becomes a scene of one group. */
static void put_group(const fp3_run_set *set, size_t i, fp3_scene_group *group) {
    const fp3_run_part *part = &set->parts[i];
    *group =
        set->groups[i] ? *set->groups[i] : (fp3_scene_group){.gone = {FP3_FOREVER, FP3_FOREVER}};
    group->name = (char *)(uintptr_t)fp3_run_set_name(set, i);
    group->program = (fp3_program *)(uintptr_t)part->program;
    group->params = (fp3_params *)(uintptr_t)part->params;
    group->objects = part->objects;
}

static fp3_status open(fp3_run_growth *of, fp3_error *error) {
    const fp3_run_set *set = of->set;
    double work = LEAST;
    of->scene.groups = calloc(set->count + 1, sizeof *of->scene.groups);
    if (!of->scene.groups)
        return fp3_no_memory(error);
    of->scene.group_count = set->count;
    for (size_t i = 0; i < set->count; i++) {
        put_group(set, i, &of->scene.groups[i]);
        work += SHARE * (double)set->parts[i].objects * (double)set->parts[i].steps;
    }
    return fp3_spectrum_open(&of->scene, work, &of->spectrum, error);
}

fp3_status fp3_run_growth_open(const fp3_run_set *set, fp3_run_growth **of, fp3_error *error) {
    *of = NULL;
    if (!is_looked_at(set))
        return FP3_OK;
    fp3_run_growth *r = *of = calloc(1, sizeof *r);
    if (!r)
        return fp3_no_memory(error);
    r->set = set;
    r->found.factor = 1;
    const fp3_status status = open(r, error);
    if (status)
        fp3_run_growth_close(of);
    return status;
}

void fp3_run_growth_close(fp3_run_growth **of) {
    fp3_run_growth *r = *of;
    if (!r)
        return;
    fp3_spectrum_close(&r->spectrum);
    free(r->scene.groups);
    free(r);
    *of = NULL;
}

static fp3_status look(fp3_run_growth *of, double share, fp3_error *error) {
    const double steps = (double)of->set->parts[0].steps;
    fp3_growth found;
    const fp3_status status =
        fp3_spectrum_growth(of->spectrum, (uint64_t)(share * steps), &found, error);
    if (!status && found.factor > of->found.factor)
        of->found = found;
    return status;
}

/* A state that the engine does not have is no number, and keeps its start. */
static void put_column(const double *from, double *to, size_t count) {
    if (!isnan(from[0]))
        memcpy(to, from, count * sizeof *to);
}

fp3_status fp3_run_growth_look(fp3_run_growth *of, const double *const *columns, double share,
                               fp3_error *error) {
    for (size_t i = 0; of && i < of->set->count; i++) {
        fp3_crowd_group *g = &fp3_spectrum_crowd(of->spectrum)->groups[i];
        for (uint32_t s = 0; s < g->model->state_count; s++)
            put_column(columns[i] + s * g->objects, g->states + s * g->objects, g->objects);
    }
    return of ? look(of, share, error) : FP3_OK;
}

static int is_much(const fp3_run_growth *of) {
    return pow(of->found.factor, (double)of->set->parts[0].steps) >= MUCH;
}

void fp3_run_growth_text(const fp3_run_growth *of, char text[FP3_RUN_GROWTH_TEXT_SIZE]) {
    char shorter[64] = "", packed[FP3_NAME_SIZE + 64] = "";
    *text = '\0';
    if (!of || !is_much(of))
        return;
    const fp3_crowd_group *g = &fp3_spectrum_crowd(of->spectrum)->groups[of->found.group];
    if (of->found.stable > 0)
        snprintf(shorter, sizeof shorter, "; with h = %.2g it does not grow",
                 of->found.stable * g->h);
    if (of->is_packed)
        snprintf(packed, sizeof packed, " for equal objects side by side, each near the next");
    snprintf(text, FP3_RUN_GROWTH_TEXT_SIZE,
             "object %zu: the step is too long%s: a small error grows %.3g times in each step of "
             "h = %.3g by %s%s",
             of->set->parts[of->found.group].first + of->found.object, packed, of->found.factor,
             g->h, program_of(of)->integrator->name, shorter);
}

/* ---- after a run ---- */

static fp3_status read_end(const fp3_run_part *part, double *columns, fp3_error *error) {
    fp3_status status = FP3_OK;
    for (uint32_t s = 0; !status && s < part->program->model->state_count; s++)
        status = fp3_run_state_read(part->program, part->engine, s, part->first, part->objects,
                                    columns + s * part->objects, error);
    return status;
}

static fp3_status look_at_end(fp3_run_growth *of, fp3_error *error) {
    const size_t count = of->set->count;
    double **columns = calloc(count + 1, sizeof *columns);
    fp3_status status = columns ? FP3_OK : fp3_no_memory(error);
    for (size_t i = 0; !status && i < count; i++) {
        const fp3_run_part *part = &of->set->parts[i];
        columns[i] =
            calloc(part->objects * part->program->model->state_count + 1, sizeof **columns);
        status = columns[i] ? read_end(part, columns[i], error) : fp3_no_memory(error);
    }
    if (!status)
        status = fp3_run_growth_look(of, (const double *const *)columns, 1, error);
    for (size_t i = 0; columns && i < count; i++)
        free(columns[i]);
    free(columns);
    return status;
}

static size_t objects_of(const fp3_run_set *set) {
    size_t objects = 0;
    for (size_t i = 0; i < set->count; i++)
        objects += set->parts[i].objects;
    return objects;
}

static int is_quick(const fp3_run_set *set) {
    return objects_of(set) <= MANY || set->parts[0].steps >= MANY_STEPS;
}

/* Where objects that touched have flown apart, the end does not show it. */
static fp3_status look_at_run(fp3_run_growth *of, fp3_error *error) {
    const int is_all = is_quick(of->set);
    fp3_status status = is_all ? look(of, 0, error) : FP3_OK;
    if (status || of->found.factor > 1)
        return status;
    status = look_at_end(of, error);
    if (status || of->found.factor > 1 || !is_all ||
        !(fp3_spectrum_neighbours(of->spectrum) < SPARSE))
        return status;
    of->is_packed = 1;
    for (size_t i = 0; !status && i < of->set->count; i++)
        if (fp3_spectrum_pack(of->spectrum, i))
            status = look(of, 0, error);
    return status;
}

fp3_status fp3_run_growth_warn(const fp3_run_set *set, fp3_run_say_fn *say, const char *path,
                               size_t *warnings, fp3_error *error) {
    fp3_run_growth *of = NULL;
    char text[FP3_RUN_GROWTH_TEXT_SIZE];
    const int is_worth = set->parts[0].steps >= FEW || objects_of(set) <= SMALL_SCENE;
    fp3_status status = is_worth ? fp3_run_growth_open(set, &of, error) : FP3_OK;
    if (!status && of)
        status = look_at_run(of, error);
    if (!status) {
        fp3_run_growth_text(of, text);
        const fp3_scene_group *group = of ? set->groups[of->found.group] : NULL;
        if (*text)
            say(group ? group->path : path, text);
        *warnings += *text != '\0';
    }
    fp3_run_growth_close(&of);
    return status;
}
