/* SPDX-License-Identifier: Apache-2.0 */
/* spectrum.c - see spectrum.h. */
#include "spectrum.h"

#include "asked.h"
#include "motion.h"
#include "packing.h"
#include "sight.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#define FIRST                                                                                      \
    4             /* the part of the work, one by this, in which objects are asked how they answer \
                   */
#define USUAL 8   /* neighbours, before they are counted */
#define WINDOW 8  /* steps: a disturbance that turns around has its largest size in each window */
#define STEPS 24  /* the last window ends here, the first one at half of it */
#define LONG 96   /* likewise, where it was found to grow */
#define GROWS 1.2 /* a step: what is some percent beyond a limit of stability grows so */
#define SHORTER 4 /* h/4 and h/16 tell what the method does from what the motion does */
#define SHORTEST 16
#define BISECTIONS                                                                                 \
    5 /* for a step that is short enough: less than SETTLES in a step may also be a swing */
#define SETTLES 1.1
#define MARGIN 0.95
#define TURNS 200    /* of the iteration for a largest eigenvalue */
#define PUSHES 0.5   /* of a disturbance that grows: more than this in its own direction */
#define NOTHING 1e-3 /* of what pushes: the iteration does not tell less */
#define SMALL 1e-10  /* a disturbance, relative to the size of states */
#define LARGER 30    /* by which growth may not change, or something jumps */
#define ALIKE 0.1

/* Numbers of a vector: of each group a column of each state, one after the other. */
struct fp3_spectrum {
    fp3_crowd crowd;
    fp3_motion *motion;
    fp3_integrator *instead[2]; /* of Stoermer's method and of linearly implicit ones */
    char *is_implicit;          /* of each group */
    uint32_t *set;              /* of each group: the first that it is tied to by what they see */
    int is_packed;
    double work;
    double *base, *at_base, *now, *turned, *scale;
    uint64_t step;
    double neighbours;
};

/* ---- vectors ---- */

typedef struct {
    const fp3_crowd_group *g;
    size_t group, first; /* of its numbers */
} part;

static size_t numbers(const fp3_crowd_group *g) { return g->objects * g->model->state_count; }

/* The next group, from {NULL}. */
static int next(const fp3_spectrum *of, part *p) {
    p->group = p->g ? p->group + 1 : 0;
    p->first += p->g ? numbers(p->g) : 0;
    p->g = p->group < of->crowd.group_count ? &of->crowd.groups[p->group] : NULL;
    return p->g != NULL;
}

static void take_states(const fp3_spectrum *of, double *to) {
    for (part p = {0}; next(of, &p);)
        memcpy(to + p.first, p.g->states, numbers(p.g) * sizeof *to);
}

static void put_states(const fp3_spectrum *of, const double *from) {
    for (part p = {0}; next(of, &p);)
        memcpy(p.g->states, from + p.first, numbers(p.g) * sizeof *from);
}

/* The same numbers each time. */
static void disturb(fp3_spectrum *of) {
    uint32_t random = 1;
    for (part p = {0}; next(of, &p);)
        for (size_t k = 0; k < numbers(p.g); k++) {
            random = random * 1664525u + 1013904223u;
            of->now[p.first + k] =
                fp3_crowd_moves(p.g, k % p.g->objects)
                    ? of->scale[p.first + k] * ((double)random / 2147483648.0 - 1)
                    : 0;
        }
}

/* Where a disturbance is largest, relative to the size of states. */
typedef struct {
    double size;
    size_t group, object;
} peak;

static peak peak_of(const fp3_spectrum *of, const double *by) {
    peak most = {0, 0, 0};
    for (part p = {0}; next(of, &p);)
        for (size_t k = 0; k < numbers(p.g); k++) {
            const double size = fabs(by[p.first + k]) / of->scale[p.first + k];
            if (size > most.size || isnan(size))
                most = (peak){size, p.group, k % p.g->objects};
        }
    return most;
}

static void find_scale(fp3_spectrum *of) {
    for (part p = {0}; next(of, &p);)
        for (uint32_t s = 0; s < p.g->model->state_count; s++) {
            const size_t first = p.first + s * p.g->objects;
            double most = 0;
            for (size_t i = 0; i < p.g->objects; i++)
                most = p.g->is_alive[i] ? fmax(most, fabs(of->base[first + i])) : most;
            for (size_t i = 0; i < p.g->objects; i++)
                of->scale[first + i] = most > 0 ? most : 1;
        }
}

/* ---- who is looked at ---- */

/* About how many numbers a look at one object of the group takes. */
static double work_of(const fp3_crowd *crowd, const fp3_crowd_group *g) {
    double seen = 0;
    for (uint32_t r = 0; r < g->model->relation_count; r++)
        seen += g->model->relations[r].kind == FP3_ALL
                    ? (double)crowd->groups[g->sights[r].group].objects
                    : USUAL;
    return (1 + seen) * (g->model->expr_count + 1);
}

/* Of many objects the first, or blocks at equal distances. */
static int is_of_some(size_t i, size_t objects, double most) {
    const size_t apart = (size_t)ceil(fmax(1, (double)objects / most));
    return most < FP3_ASKED_OBJECTS ? (double)i < most : i / FP3_ASKED_OBJECTS % apart == 0;
}

/* group: SIZE_MAX, or the one whose objects move, with those that it is tied to. */
static void begin(fp3_spectrum *of, uint64_t step, size_t group) {
    if (!of->is_packed)
        fp3_crowd_live(&of->crowd, step, 1);
    of->step = step;
    for (part p = {0}; next(of, &p);) {
        const double most = fmax(1, of->work / FIRST / work_of(&of->crowd, p.g));
        const int is_other = group != SIZE_MAX && of->set[p.group] != of->set[group];
        for (size_t i = 0; i < p.g->objects; i++)
            p.g->is_stopped[i] = (char)(is_other || !is_of_some(i, p.g->objects, most));
    }
    take_states(of, of->base);
    find_scale(of);
    fp3_sight_forget(&of->crowd);
}

static int by_size(const void *a, const void *b) {
    const double p = *(const double *)a, q = *(const double *)b;
    return (p < q) - (p > q);
}

/* How much an object answers. */
static double answer_of(const fp3_spectrum *of, const part *p, size_t i) {
    double most = 0;
    for (uint32_t s = 0; s < p->g->model->state_count; s++) {
        const size_t at = p->first + s * p->g->objects + i;
        const double size = fabs(of->turned[at]) / of->scale[at];
        most = size <= most ? most : size;
    }
    return most;
}

/* Stops who answers less than others, so that a share of the objects is left. */
static fp3_status keep_who_answers(const fp3_spectrum *of, double share, fp3_error *error) {
    size_t objects = 0, count = 0;
    for (part p = {0}; next(of, &p);)
        objects += p.g->objects;
    double *answers = calloc(objects + 1, sizeof *answers);
    if (!answers)
        return fp3_no_memory(error);
    for (part p = {0}; next(of, &p);)
        for (size_t i = 0; i < p.g->objects; i++)
            if (fp3_crowd_moves(p.g, i))
                answers[count++] = answer_of(of, &p, i);
    qsort(answers, count, sizeof *answers, by_size);
    const double least = answers[(size_t)(share * (double)count)];
    for (part p = {0}; next(of, &p);)
        for (size_t i = 0; i < p.g->objects; i++)
            p.g->is_stopped[i] |= (char)(answer_of(of, &p, i) < least);
    free(answers);
    return FP3_OK;
}

/* ---- what becomes of a disturbance ---- */

/* Asks for slopes, or for what a share of a step makes. */
typedef struct {
    double share; /* 0: slopes */
    double small;
} question;

static fp3_status answer(fp3_spectrum *of, question q, double *to, fp3_error *error) {
    if (q.share == 0)
        return fp3_motion_slopes(of->motion, (double)of->step, to, error);
    const fp3_status status = fp3_motion_flow(of->motion, (double)of->step, q.share, error);
    take_states(of, to);
    put_states(of, of->base);
    return status;
}

/* What `now` becomes, into `turned`. at_base is the answer at the undisturbed states. */
static fp3_status turn(fp3_spectrum *of, question q, fp3_error *error) {
    const double size = peak_of(of, of->now).size, share = size > 0 ? q.small / size : 0;
    for (part p = {0}; next(of, &p);)
        for (size_t k = 0; k < numbers(p.g); k++)
            p.g->states[k] += share * of->now[p.first + k];
    const fp3_status status = answer(of, q, of->turned, error);
    put_states(of, of->base);
    for (part p = {0}; next(of, &p);)
        for (size_t k = p.first; k < p.first + numbers(p.g); k++)
            of->turned[k] = share > 0 ? (of->turned[k] - of->at_base[k]) / share : 0;
    return status;
}

/* Begins with a random disturbance, of fewer objects if all of them are too much work for so many
 * turns. */
static fp3_status start(fp3_spectrum *of, question q, double turns, fp3_error *error) {
    fp3_status status = answer(of, q, of->at_base, error);
    disturb(of);
    const uint64_t before = fp3_motion_cost(of->motion);
    if (!status)
        status = turn(of, q, error);
    const double needed = turns * (double)(fp3_motion_cost(of->motion) - before);
    if (status || needed <= of->work)
        return status;
    status = keep_who_answers(of, of->work / needed, error);
    if (!status)
        status = answer(of, q, of->at_base, error);
    disturb(of);
    return status;
}

/* ---- growth in steps ---- */

static void take_turned(fp3_spectrum *of, double factor) {
    for (part p = {0}; next(of, &p);)
        for (size_t k = p.first; k < p.first + numbers(p.g); k++)
            of->now[k] = of->turned[k] * factor;
}

/* By which factor a disturbance grows in a step of share, made `parts` times, in the mean over half
 * of these steps. It is made small again after each, so that it never overflows. */
static fp3_status grow(fp3_spectrum *of, question q, unsigned parts, unsigned steps, double *factor,
                       peak *at, fp3_error *error) {
    double sum = 0, early = -INFINITY, late = -INFINITY; /* logarithms */
    fp3_status status = answer(of, q, of->at_base, error);
    disturb(of);
    for (unsigned n = 1; !status && n <= steps; n++) {
        for (unsigned k = 0; !status && k < parts; k++) {
            status = turn(of, q, error);
            take_turned(of, 1);
        }
        *at = peak_of(of, of->now);
        if (!(at->size > 0) || !isfinite(at->size)) {
            *factor = at->size > 0 ? INFINITY : isnan(at->size) ? NAN : 0;
            return status;
        }
        sum += log(at->size);
        take_turned(of, 1 / at->size);
        if (n > steps / 2 - WINDOW && n <= steps / 2)
            early = fmax(early, sum);
        if (n > steps - WINDOW)
            late = fmax(late, sum);
    }
    *factor = exp((late - early) / (steps - steps / 2));
    return status;
}

/* Finds a step with which nothing grows: parts of this one are short enough. */
static fp3_status find_stable(fp3_spectrum *of, unsigned parts, double *stable, fp3_error *error) {
    double short_enough = 1.0 / parts, too_long = SHORTER * short_enough, factor;
    fp3_status status = FP3_OK;
    peak at;
    for (int i = 0; !status && i < BISECTIONS; i++) {
        const double half = (short_enough + too_long) / 2;
        status = grow(of, (question){half, SMALL}, 1, STEPS, &factor, &at, error);
        *(factor > SETTLES ? &too_long : &short_enough) = half;
    }
    *stable = MARGIN * short_enough;
    return status;
}

/* What grows with h, and not with shorter steps over the same time, is the method's. Where a larger
 * disturbance grows otherwise, a force jumps, and there is no such factor. */
static fp3_status judge(fp3_spectrum *of, fp3_growth *found, fp3_error *error) {
    double factor, other, shorter = INFINITY;
    unsigned parts = 1;
    peak at, unused;
    fp3_status status = grow(of, (question){1, SMALL}, 1, STEPS, &factor, &at, error);
    if (status || !(factor > GROWS))
        return status;
    status = grow(of, (question){1, LARGER * SMALL}, 1, LONG, &other, &at, error);
    if (status || !(fabs(other / factor - 1) <= ALIKE))
        return status;
    while (!status && parts < SHORTEST && !(shorter < 1 + (other - 1) / 2)) {
        parts *= SHORTER;
        status = grow(of, (question){1.0 / parts, SMALL}, parts, LONG, &shorter, &unused, error);
    }
    const int is_method = shorter < 1 + (other - 1) / 2;
    if (status || (!is_method && !(other > 2)))
        return status;
    *found = (fp3_growth){other, 0, at.group, at.object};
    return is_method ? find_stable(of, parts, &found->stable, error) : FP3_OK;
}

fp3_status fp3_spectrum_growth(fp3_spectrum *of, uint64_t step, fp3_growth *found,
                               fp3_error *error) {
    *found = (fp3_growth){.factor = 1};
    begin(of, step, SIZE_MAX);
    for (part p = {0}; next(of, &p);)
        for (size_t i = 0; of->is_implicit[p.group] && i < p.g->objects; i++)
            p.g->is_stopped[i] = 1;
    fp3_status status = start(of, (question){1, SMALL}, STEPS, error);
    if (!status)
        of->neighbours = fp3_packing_neighbours(&of->crowd);
    return status ? status : judge(of, found, error);
}

/* ---- largest eigenvalues ---- */

static int is_position(const fp3_model *m, uint32_t state) {
    return m->states[state].velocity != FP3_NONE;
}

/* Leaves of a disturbance the part that is asked for: of springs positions, to which the slopes of
 * their velocities have turned. */
static void leave(const fp3_spectrum *of, int is_of_springs, double *by) {
    for (part p = {0}; next(of, &p);)
        for (uint32_t s = 0; s < p.g->model->state_count; s++) {
            double *to = by + p.first + s * p.g->objects;
            if (is_position(p.g->model, s) != is_of_springs)
                memset(to, 0, p.g->objects * sizeof *to);
        }
}

static void take_forces(const fp3_spectrum *of, double *by) {
    for (part p = {0}; next(of, &p);)
        for (uint32_t s = 0; s < p.g->model->state_count; s++)
            if (is_position(p.g->model, s))
                memcpy(by + p.first + s * p.g->objects,
                       by + p.first + p.g->model->states[s].velocity * p.g->objects,
                       p.g->objects * sizeof *by);
}

/* What power iteration leaves: by how much it grows in a turn, and its own share of that, which is
 * negative where it turns around. */
typedef struct {
    double factor, own;
} left_over;

static double product(const fp3_spectrum *of, const double *a, const double *b) {
    double sum = 0;
    for (part p = {0}; next(of, &p);)
        for (size_t k = p.first; k < p.first + numbers(p.g); k++)
            sum += a[k] * b[k];
    return sum;
}

/* Of the equations less `less` of the disturbance itself. The mean over the last quarter of the
 * turns. */
static fp3_status iterate(fp3_spectrum *of, int is_of_springs, double less, left_over *left,
                          peak *at, fp3_error *error) {
    const question q = {0, SMALL};
    double sum = 0, own = 0;
    *left = (left_over){0, 0};
    fp3_status status = start(of, q, TURNS, error);
    leave(of, is_of_springs, of->now);
    for (int n = 0; !status && n < TURNS; n++) {
        const double before = sqrt(product(of, of->now, of->now));
        status = turn(of, q, error);
        if (is_of_springs)
            take_forces(of, of->turned);
        leave(of, is_of_springs, of->turned);
        for (part p = {0}; next(of, &p);)
            for (size_t k = p.first; k < p.first + numbers(p.g); k++)
                of->turned[k] -= less * of->now[k];
        const double ratio = sqrt(product(of, of->turned, of->turned)) / before;
        if (!(ratio > 0) || !isfinite(ratio)) {
            left->factor = isfinite(ratio) || before == 0 ? 0 : ratio;
            return status;
        }
        own += n >= TURNS - TURNS / 4 ? product(of, of->now, of->turned) / (before * before) : 0;
        sum += n >= TURNS - TURNS / 4 ? log(ratio) : 0;
        take_turned(of, 1 / (ratio * before));
    }
    *left = (left_over){exp(sum / (TURNS / 4)), own / (TURNS / 4)};
    *at = peak_of(of, of->now);
    return status;
}

/* The largest of those that pull back. Where what pushes away is larger than that, this is added to
 * all, so that none pushes, and the one that pulls most is the largest. */
static fp3_status find_largest(fp3_spectrum *of, uint64_t step, size_t group, int is_of_springs,
                               double *largest, peak *at, fp3_error *error) {
    left_over left, shifted;
    begin(of, step, group);
    fp3_status status = iterate(of, is_of_springs, 0, &left, at, error);
    *largest = left.factor;
    if (status || !(left.own > PUSHES * left.factor))
        return status;
    begin(of, step, group);
    status = iterate(of, is_of_springs, left.factor, &shifted, at, error);
    /* Nothing is larger than what was largest: where a force jumps, it may seem so. */
    *largest = fmin(shifted.factor - left.factor, left.factor);
    *largest = *largest > NOTHING * left.factor ? *largest : 0;
    return status;
}

fp3_status fp3_spectrum_rates(fp3_spectrum *of, uint64_t step, size_t group, fp3_rates *found,
                              fp3_error *error) {
    peak springs = {0}, dampers = {0};
    *found = (fp3_rates){.stiffness = 0};
    fp3_status status = find_largest(of, step, group, 1, &found->stiffness, &springs, error);
    if (!status)
        status = find_largest(of, step, group, 0, &found->damping, &dampers, error);
    found->of_springs = springs.group;
    found->springs_object = springs.object;
    found->of_dampers = dampers.group;
    found->dampers_object = dampers.object;
    return status;
}

/* ---- packings ---- */

double fp3_spectrum_neighbours(const fp3_spectrum *of) { return of->neighbours; }

int fp3_spectrum_pack(fp3_spectrum *of, size_t group) {
    for (part p = {0}; next(of, &p);)
        memset(p.g->is_alive, 0, p.g->objects);
    of->is_packed = fp3_packing_make(&of->crowd.groups[group]);
    return of->is_packed;
}

/* ---- open and close ---- */

/* Ties groups that see each other. */
static void find_sets(fp3_spectrum *of) {
    const uint32_t count = of->crowd.group_count;
    for (uint32_t k = 0; k < count; k++)
        of->set[k] = k;
    for (uint32_t k = 0; k < count; k++)
        for (uint32_t r = 0; r < of->crowd.groups[k].model->relation_count; r++) {
            const uint32_t a = of->set[k], b = of->set[of->crowd.groups[k].sights[r].group],
                           least = a < b ? a : b;
            for (uint32_t n = 0; n < count; n++)
                of->set[n] = of->set[n] == a || of->set[n] == b ? least : of->set[n];
        }
}

/* A step of Stoermer's method is leapfrog's, seen at the positions. */
static fp3_status find_integrators(fp3_spectrum *of, fp3_error *error) {
    static const char *const names[2] = {"leapfrog", "euler"};
    fp3_status status = FP3_OK;
    for (int i = 0; !status && i < 2; i++)
        status = fp3_integrator_find(names[i], &of->instead[i], error);
    for (part p = {0}; !status && next(of, &p);) {
        fp3_crowd_group *g = &of->crowd.groups[p.group];
        of->is_implicit[p.group] = g->integrator->kind == FP3_ROSENBROCK;
        g->integrator = g->integrator->kind == FP3_STOERMER ? of->instead[0]
                        : of->is_implicit[p.group]          ? of->instead[1]
                                                            : g->integrator;
    }
    return status;
}

static fp3_status take_room(fp3_spectrum *of, fp3_error *error) {
    const size_t n = of->crowd.states;
    of->base = calloc(5 * n + 1, sizeof *of->base);
    of->is_implicit = calloc(of->crowd.group_count + 1u, 1);
    of->set = calloc(of->crowd.group_count + 1u, sizeof *of->set);
    if (!of->base || !of->is_implicit || !of->set)
        return fp3_no_memory(error);
    of->at_base = of->base + n;
    of->now = of->at_base + n;
    of->turned = of->now + n;
    of->scale = of->turned + n;
    find_sets(of);
    return FP3_OK;
}

fp3_status fp3_spectrum_open(const fp3_scene *scene, double work, fp3_spectrum **spectrum,
                             fp3_error *error) {
    fp3_spectrum *of = *spectrum = calloc(1, sizeof *of);
    if (!of)
        return fp3_no_memory(error);
    of->work = work;
    fp3_status status = fp3_crowd_open(scene, &of->crowd, error);
    if (!status)
        status = fp3_sight_open(&of->crowd, error);
    if (!status)
        status = take_room(of, error);
    if (!status)
        status = find_integrators(of, error);
    if (!status)
        status = fp3_motion_open(&of->crowd, NULL, &of->motion, error);
    if (status)
        fp3_spectrum_close(spectrum);
    return status;
}

void fp3_spectrum_close(fp3_spectrum **spectrum) {
    fp3_spectrum *of = *spectrum;
    if (!of)
        return;
    fp3_motion_close(&of->motion);
    fp3_crowd_close(&of->crowd);
    for (int i = 0; i < 2; i++)
        fp3_integrator_free(&of->instead[i]);
    free(of->base);
    free(of->is_implicit);
    free(of->set);
    free(of);
    *spectrum = NULL;
}

int fp3_spectrum_is_first(const fp3_spectrum *of, size_t group) { return of->set[group] == group; }

fp3_crowd *fp3_spectrum_crowd(fp3_spectrum *of) { return &of->crowd; }
