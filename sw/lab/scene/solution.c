/* SPDX-License-Identifier: Apache-2.0 */
/* solution.c - a scene in steps that become shorter until two lengths agree. */
#include <fp3/scene_truth.h>

#include "base/host.h"
#include "motion.h"
#include "sight.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void fp3_scene_truth_set_default(fp3_scene_truth_def *def, size_t size) {
    (void)size;
    *def = (fp3_scene_truth_def){.within = 1e-6, .work = 1e10};
}

/* ---- rows ---- */

size_t fp3_scene_truth_width(const fp3_scene *scene) {
    size_t width = 0;
    for (size_t i = 0; i < scene->group_count; i++)
        if (scene->groups[i].program->model)
            width += scene->groups[i].objects * scene->groups[i].program->model->state_count;
    return width;
}

size_t fp3_scene_truth_place(const fp3_scene *scene, size_t group, const char *state,
                             size_t object) {
    size_t first = 0;
    for (size_t i = 0; i < group && i < scene->group_count; i++)
        if (scene->groups[i].program->model)
            first += scene->groups[i].objects * scene->groups[i].program->model->state_count;
    const fp3_model *m = group < scene->group_count ? scene->groups[group].program->model : NULL;
    const uint32_t s = m ? fp3_model_state(m, state) : FP3_NONE;
    return s == FP3_NONE || object >= scene->groups[group].objects
               ? SIZE_MAX
               : first + s * scene->groups[group].objects + object;
}

static void copy_row(const fp3_crowd *crowd, double *row) {
    for (uint32_t k = 0; k < crowd->group_count; k++) {
        const fp3_crowd_group *g = &crowd->groups[k];
        const size_t n = g->objects * g->model->state_count;
        memcpy(row, g->states, n * sizeof *row);
        row += n;
    }
}

/* Components of a vector are declared in one line. How long an object has been at rest is no place,
 * and nobody sleeps here: beside an infinite size it has no error. */
static void find_sizes(const fp3_model *m, size_t objects, size_t width, const double *states,
                       size_t count, double *sizes) {
    for (uint32_t s = 0; s < m->state_count; s++) {
        double most = 0;
        for (uint32_t o = 0; o < m->state_count; o++)
            for (size_t i = 0; m->states[o].line == m->states[s].line && i < objects; i++)
                for (size_t row = 0; row < count; row++)
                    most = fmax(most, fabs(states[row * width + o * objects + i]));
        if (fp3_model_state(m, FP3_NAME_REST) == s)
            most = INFINITY;
        for (size_t i = 0; i < objects; i++)
            sizes[s * objects + i] = most;
    }
}

void fp3_scene_sizes(const fp3_scene *scene, const double *states, size_t count, double *sizes) {
    const size_t width = fp3_scene_truth_width(scene);
    for (size_t i = 0; i < scene->group_count; i++) {
        const fp3_model *m = scene->groups[i].program->model;
        if (!m)
            continue;
        find_sizes(m, scene->groups[i].objects, width, states, count, sizes);
        states += scene->groups[i].objects * m->state_count;
        sizes += scene->groups[i].objects * m->state_count;
    }
}

/* ---- one length of step ---- */

typedef struct {
    const fp3_scene *scene;
    const fp3_integrator *instead; /* NULL: that of each group, and events at ends of steps */
    uint64_t parts;
    const uint64_t *steps;
    size_t count, width;
    const fp3_scene_truth_def *def; /* NULL: as long as it takes */
    double cost;                    /* so far */
    int is_stopped;                 /* by `tell` */
} task;

static fp3_status make_steps(task *t, fp3_crowd *crowd, fp3_motion *motion, double *states,
                             size_t *made, fp3_error *error) {
    fp3_status status = FP3_OK;
    const double before = t->cost;
    const uint64_t all = t->count ? t->steps[t->count - 1] * t->parts : 0;
    for (uint64_t n = 0;; n++) {
        for (; *made < t->count && t->steps[*made] * t->parts == n; ++*made)
            copy_row(crowd, states + *made * t->width);
        if (*made == t->count)
            return FP3_OK;
        status = t->instead ? fp3_motion_step_to_events(motion, n, t->parts, error)
                            : fp3_motion_step(motion, n, t->parts, error);
        if (status)
            return status;
        t->cost = before + (double)fp3_motion_cost(motion);
        if (t->def && t->cost > t->def->work)
            return fp3_fail(error, FP3_E_FAILED,
                            "it takes more than the %.3g numbers that may be computed",
                            t->def->work);
        t->is_stopped = t->def && t->def->tell && n % (all / 64 + 1) == 0 &&
                        t->def->tell(t->def->user, t->parts, (double)n / (double)all);
        if (t->is_stopped)
            return fp3_fail(error, FP3_E_FAILED, "it was stopped");
    }
}

/* *made: how many rows there are, also after FP3_E_FAILED; the others are NaN. */
static fp3_status make_rows(task *t, double *states, size_t *made, fp3_error *error) {
    fp3_crowd crowd;
    fp3_motion *motion = NULL;
    *made = 0;
    fp3_status status = fp3_crowd_open(t->scene, &crowd, error);
    if (!status)
        status = fp3_sight_open(&crowd, error);
    if (!status)
        status = fp3_motion_open(&crowd, t->instead, &motion, error);
    if (!status)
        status = make_steps(t, &crowd, motion, states, made, error);
    for (size_t i = *made * t->width; i < t->count * t->width; i++)
        states[i] = NAN;
    fp3_motion_close(&motion);
    fp3_crowd_close(&crowd);
    return status;
}

static fp3_status check_steps(const uint64_t *steps, size_t count, uint64_t parts,
                              fp3_error *error) {
    for (size_t i = 0; i < count; i++)
        if ((i && steps[i] < steps[i - 1]) || steps[i] > (UINT64_MAX >> 8) / parts)
            return fp3_fail(error, FP3_E_ARGUMENT,
                            "step %" PRIu64 ": expected numbers of steps that ascend", steps[i]);
    return FP3_OK;
}

fp3_status fp3_scene_in_double(const fp3_scene *scene, uint64_t parts, const uint64_t *steps,
                               size_t count, double *states, fp3_error *error) {
    FP3_HOST;
    task t = {.scene = scene,
              .parts = parts ? parts : 1,
              .steps = steps,
              .count = count,
              .width = fp3_scene_truth_width(scene)};
    size_t made;
    const fp3_status status = check_steps(steps, count, t.parts, error);
    return status ? status : make_rows(&t, states, &made, error);
}

/* ---- until two agree ---- */

enum { LEVELS = 13, KEPT = 3, ORDERS = 4 };
/* Orders of the error in h that may be taken out (Richardson): 0 is none. What does not fall by
 * that order makes the extrapolations differ, and nothing of it is taken. */
static const unsigned orders[ORDERS] = {0, 1, 2, 4};

typedef struct {
    task t;
    double *rows[KEPT]; /* of the last lengths, the shortest first */
    double *made, *previous, *sizes;
    unsigned level;
} search;

/* From the rows of a length and those of twice that. */
static void extrapolate(const search *s, const double *fine, const double *coarse, unsigned order,
                        double *to) {
    const size_t n = s->t.count * s->t.width;
    const double factor = order ? 1 / (exp2(order) - 1) : 0;
    for (size_t i = 0; i < n; i++)
        to[i] = fine[i] + factor * (fine[i] - coarse[i]);
}

/* How many of these rows agree, by the sizes in them, and by how much they differ. */
static size_t agree_among(const search *s, size_t count, double *apart) {
    size_t row = 0;
    *apart = 0;
    fp3_scene_sizes(s->t.scene, s->made, count, s->sizes);
    for (; row < count; row++) {
        double most = 0;
        for (size_t i = 0; i < s->t.width; i++) {
            const double d =
                fabs(s->made[row * s->t.width + i] - s->previous[row * s->t.width + i]);
            const double share = d == 0 ? 0 : d / s->sizes[i];
            most = share <= most ? most : share; /* keeps a NaN */
        }
        if (!(most <= s->t.def->within))
            break;
        *apart = fmax(*apart, most);
    }
    return row;
}

/* A row that does not agree tells no size: an unstable method's may be beyond all bounds, beside
 * which everything agrees. */
static size_t agree(const search *s, double *apart) {
    size_t count = s->t.count, known = agree_among(s, count, apart);
    for (; known < count; known = agree_among(s, count, apart))
        count = known;
    return known;
}

/* What is best of the last lengths goes to the caller, if it is better than what he has. */
static void choose(search *s, double *states, fp3_scene_solved *solved) {
    for (unsigned k = 0; k < ORDERS; k++) {
        double apart;
        const unsigned order = orders[k], needed = order ? 3 : 2;
        if (s->level + 1 < needed)
            continue;
        extrapolate(s, s->rows[0], s->rows[1], order, s->made);
        extrapolate(s, s->rows[1], order ? s->rows[2] : s->rows[1], order, s->previous);
        const size_t known = agree(s, &apart);
        if (known < solved->known || (known == solved->known && known && apart >= solved->apart))
            continue;
        solved->known = known;
        solved->apart = apart;
        solved->parts = s->t.parts;
        solved->extrapolated = order;
        memcpy(states, s->made, known * s->t.width * sizeof *states);
    }
}

static void turn(search *s) {
    double *last = s->rows[KEPT - 1];
    memmove(s->rows + 1, s->rows, (KEPT - 1) * sizeof *s->rows);
    s->rows[0] = last;
}

static fp3_status look(search *s, double *states, fp3_scene_solved *solved, fp3_error *error) {
    fp3_error why = {.text = ""};
    for (s->level = 0; s->level < LEVELS && solved->known < s->t.count; s->level++) {
        const double before = s->t.cost;
        size_t made;
        turn(s);
        s->t.parts = UINT64_C(1) << s->level;
        const fp3_status status = make_rows(&s->t, s->rows[0], &made, &why);
        if (status && status != FP3_E_FAILED)
            return fp3_fail(error, status, "%s", why.text);
        choose(s, states, solved);
        if (s->t.is_stopped)
            break;
        if (solved->known < s->t.count && s->t.cost + 2 * (s->t.cost - before) > s->t.def->work) {
            if (!status && !s->level)
                fp3_fail(&why, FP3_E_FAILED,
                         "steps shorter than the scene's take more than the %.3g numbers that may "
                         "be computed",
                         s->t.def->work);
            else if (!status)
                fp3_fail(&why, FP3_E_FAILED,
                         "steps of h/%" PRIu64 " and h/%" PRIu64
                         " differ by more than %g of the size, and shorter ones take more than the "
                         "%.3g numbers that may be computed",
                         s->t.parts, s->t.parts / 2, s->t.def->within, s->t.def->work);
            break;
        }
    }
    if (solved->known < s->t.count && !why.text[0])
        fp3_fail(&why, FP3_E_FAILED,
                 "steps of h/%" PRIu64 " and h/%" PRIu64 " differ by more than %g of the size",
                 s->t.parts, s->t.parts / 2, s->t.def->within);
    if (solved->known < s->t.count)
        snprintf(solved->why, sizeof solved->why, "%s", why.text);
    return FP3_OK;
}

/* A high order pays where nothing jumps and nothing happens at the ends of steps. */
static fp3_status find_method(const fp3_scene *scene, fp3_integrator **method, fp3_error *error) {
    int is_smooth = 1;
    for (size_t i = 0; i < scene->group_count; i++) {
        const fp3_model *m = scene->groups[i].program->model;
        if (m && fp3_model_is_map(m))
            return fp3_fail_at(error, FP3_E_PROGRAM, scene->path, (unsigned)scene->groups[i].line,
                               0,
                               "group '%s': projections alone move model '%s', so its steps have "
                               "no length, and there is no solution that shorter ones tend to",
                               scene->groups[i].name, m->name);
        is_smooth &= m && !m->event_count && !m->projection_count && !m->memory_count;
        for (uint32_t r = 0; m && r < m->relation_count; r++)
            is_smooth &= m->relations[r].kind != FP3_NEAR;
    }
    return fp3_integrator_find(is_smooth ? "rk8" : "rk4", method, error);
}

fp3_status fp3_scene_solution(const fp3_scene *scene, const fp3_scene_truth_def *def,
                              const uint64_t *steps, size_t count, double *states,
                              fp3_scene_solved *solved, fp3_error *error) {
    FP3_HOST;
    fp3_integrator *method = NULL;
    *solved = (fp3_scene_solved){.known = 0};
    fp3_status status = check_steps(steps, count, UINT64_C(1) << LEVELS, error);
    if (!status)
        status = find_method(scene, &method, error);
    if (status)
        return status;
    snprintf(solved->method, sizeof solved->method, "%s", method->name);
    search s = {.t = {.scene = scene,
                      .instead = method,
                      .steps = steps,
                      .count = count,
                      .width = fp3_scene_truth_width(scene),
                      .def = def}};
    const size_t numbers = count * s.t.width + 1;
    int is_room = 1;
    for (int k = 0; k < KEPT; k++)
        is_room &= (s.rows[k] = calloc(numbers, sizeof **s.rows)) != NULL;
    s.made = calloc(numbers, sizeof *s.made);
    s.previous = calloc(numbers, sizeof *s.previous);
    s.sizes = calloc(s.t.width + 1, sizeof *s.sizes);
    status = is_room && s.made && s.previous && s.sizes ? look(&s, states, solved, error)
                                                        : fp3_no_memory(error);
    for (size_t i = solved->known * s.t.width; !status && i < count * s.t.width; i++)
        states[i] = NAN;
    for (int k = 0; k < KEPT; k++)
        free(s.rows[k]);
    free(s.made);
    free(s.previous);
    free(s.sizes);
    fp3_integrator_free(&method);
    return status;
}
