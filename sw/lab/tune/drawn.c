/* SPDX-License-Identifier: Apache-2.0 */
/* drawn.c - see drawn.h. */
#include "drawn.h"

#include "lab/scene/crowd.h"
#include "world/kinds_steps.h"
#include "world/scene_read.h"
#include "world/values.h"

#include <gsl/gsl_rng.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define TIMES 1024       /* at least, if the number of steps allows it; at most twice that */
#define FEWEST 16        /* times of a solution that is very wide */
#define STILL 1e-9       /* of a state's size: no motion */
#define NUMBERS_MOST 4e6 /* of a solution: then fewer times */

/* ---- times ---- */

uint64_t fp3_drawn_power(uint64_t steps, uint64_t least) {
    uint64_t power = 1;
    while (steps % (2 * power) == 0 && steps / (2 * power) >= least)
        power *= 2;
    return power;
}

/* Steps are joined by powers of two that divide their number: looks are multiples of one. */
fp3_status fp3_drawn_times_find(uint64_t steps, size_t width, fp3_drawn_times *times,
                                fp3_error *error) {
    uint64_t every = fp3_drawn_power(steps, TIMES);
    const double most = fmin(2 * TIMES, fmax(FEWEST, NUMBERS_MOST / (double)width));
    if ((double)steps / (double)every > most)
        every *= (uint64_t)ceil((double)steps / (double)every / most);
    times->every = every;
    times->count = (size_t)((steps + every - 1) / every);
    times->steps = calloc(times->count + 1, sizeof *times->steps);
    if (!times->steps)
        return fp3_no_memory(error);
    for (size_t i = 0; i < times->count; i++)
        times->steps[i] = (i + 1) * every < steps ? (i + 1) * every : steps;
    return FP3_OK;
}

/* ---- other starts ---- */

/* Where the objects start: rows of a group, one for each state. The caller frees. */
static fp3_status find_starts(const fp3_scene *scene, double **starts, fp3_error *error) {
    fp3_crowd crowd;
    fp3_status status = fp3_crowd_open(scene, &crowd, error);
    *starts = status ? NULL : calloc(crowd.states + 1, sizeof **starts);
    double *to = *starts;
    if (!status && !to)
        status = fp3_no_memory(error);
    for (uint32_t k = 0; !status && k < crowd.group_count; k++) {
        const size_t n = crowd.groups[k].objects * crowd.groups[k].model->state_count;
        memcpy(to, crowd.groups[k].states, n * sizeof *to);
        to += n;
    }
    fp3_crowd_close(&crowd);
    return status;
}

/* FP32 numbers: a scene's error is not that of writing it. */
static fp3_status shift_group(const fp3_scene_group *group, double *starts, const double *sizes,
                              double around, gsl_rng *random, fp3_error *error) {
    const fp3_model *m = group->program->model;
    fp3_status status = FP3_OK;
    for (uint32_t s = 0; !status && s < m->state_count; s++) {
        double *column = starts + s * group->objects;
        const double size = sizes[s * group->objects];
        if (!(size > 0 && isfinite(size)))
            continue;
        for (size_t i = 0; i < group->objects; i++)
            column[i] = (float)(column[i] + around * size * (2 * gsl_rng_uniform(random) - 1));
        status = fp3_values_column(group->params, m->states[s].name, column, group->objects, NULL,
                                   0, error);
    }
    return status;
}

/* Groups that no seed has changed. */
static fp3_status shift(const fp3_scene_tune_def *def, fp3_drawn *d, double *starts,
                        const double *as_is, gsl_rng *random, fp3_error *error) {
    double *sizes = calloc(d->width + 1, sizeof *sizes);
    fp3_status status = sizes ? FP3_OK : fp3_no_memory(error);
    size_t first = 0;
    if (!status)
        fp3_scene_sizes(d->scene, starts, 1, sizes);
    for (size_t k = 0; !status && k < d->scene->group_count; k++) {
        const fp3_scene_group *group = &d->scene->groups[k];
        const size_t n = group->objects * group->program->model->state_count;
        if (memcmp(starts + first, as_is + first, n * sizeof *starts) != 0) {
            d->has_seeds = 1;
        } else if (!fp3_kinds_never_move(group->program->model)) {
            d->has_shifts = 1;
            status = shift_group(group, starts + first, sizes + first, def->around, random, error);
        }
        first += n;
    }
    free(sizes);
    return status;
}

static fp3_status differ(const fp3_scene_tune_def *def, uint64_t draw, const fp3_drawn *as_is,
                         fp3_drawn *d, fp3_error *error) {
    double *starts = NULL, *before = NULL;
    gsl_rng *random = gsl_rng_alloc(gsl_rng_mt19937);
    fp3_status status = random ? find_starts(d->scene, &starts, error) : fp3_no_memory(error);
    if (!status)
        status = find_starts(as_is->scene, &before, error);
    if (!status) {
        gsl_rng_set(random, (unsigned long)draw);
        status = shift(def, d, starts, before, random, error);
    }
    free(starts);
    free(before);
    gsl_rng_free(random);
    return status;
}

fp3_status fp3_drawn_open(const fp3_scene_tune_def *def, uint64_t draw, const fp3_drawn *as_is,
                          fp3_drawn *d, fp3_error *error) {
    *d = (fp3_drawn){.scene = NULL};
    fp3_status status = fp3_scene_open_drawn(def->path, def->config, draw, &d->scene, error);
    if (status)
        return status;
    d->width = fp3_scene_truth_width(d->scene);
    return draw ? differ(def, draw, as_is, d, error) : FP3_OK;
}

void fp3_drawn_close(fp3_drawn *d) {
    fp3_scene_close(&d->scene);
    free(d->solution);
    free(d->sizes);
    *d = (fp3_drawn){.scene = NULL};
}

void fp3_drawn_differ(const fp3_scene_tune_def *def, const fp3_drawn *d, char *text, size_t size) {
    char shifts[80] = "";
    if (d->has_shifts)
        snprintf(shifts, sizeof shifts, "starts within %g of their size%s", def->around,
                 d->has_seeds ? " where nothing is random" : "");
    snprintf(text, size, "%s%s%s", d->has_seeds ? "other seeds" : "",
             d->has_seeds && d->has_shifts ? ", and " : "", shifts);
}

/* ---- its solution ---- */

static int tell(void *user, uint64_t parts, double share) {
    const fp3_scene_tune_def *def = user;
    (void)parts;
    (void)share;
    return def->stop && def->stop(def->user);
}

fp3_status fp3_drawn_solve(const fp3_scene_tune_def *def, const fp3_drawn_times *times,
                           fp3_drawn *d, fp3_error *error) {
    fp3_scene_truth_def how = fp3_scene_truth_default();
    how.within = def->within;
    how.work = def->work;
    how.tell = tell;
    how.user = (void *)(uintptr_t)def;
    d->solution = calloc(times->count * d->width + 1, sizeof *d->solution);
    d->sizes = calloc(d->width + 1, sizeof *d->sizes);
    if (!d->solution || !d->sizes)
        return fp3_no_memory(error);
    const fp3_status status = fp3_scene_solution(d->scene, &how, times->steps, times->count,
                                                 d->solution, &d->solved, error);
    if (status)
        return status;
    if (!d->solved.known)
        return fp3_fail(error, FP3_E_FAILED,
                        "%s: no solution to measure errors against, not even at step %" PRIu64
                        ": %s",
                        def->path, times->steps[0], d->solved.why);
    fp3_scene_sizes(d->scene, d->solution, d->solved.known, d->sizes);
    return FP3_OK;
}

fp3_status fp3_drawn_moves(const fp3_drawn *d, int *moves, fp3_error *error) {
    double *starts = NULL;
    const fp3_status status = find_starts(d->scene, &starts, error);
    *moves = 0;
    for (size_t row = 0; !status && !*moves && row < d->solved.known; row++)
        for (size_t i = 0; i < d->width; i++)
            *moves |=
                fabs(d->solution[row * d->width + i] - starts[i]) > STILL * fmax(d->sizes[i], 0);
    free(starts);
    return status;
}

double fp3_drawn_error(const fp3_drawn *d, size_t time, const double *states) {
    const double *row = d->solution + time * d->width;
    double worst = 0;
    for (size_t i = 0; i < d->width; i++) {
        const double way = fabs(states[i] - row[i]), share = way == 0 ? 0 : way / d->sizes[i];
        if (!(share <= worst))
            worst = isnan(share) ? INFINITY : share;
    }
    return worst;
}
