/* SPDX-License-Identifier: Apache-2.0 */
/* scene_tune.c - see fp3/scene_tune.h: combinations in the order of their cost, until one keeps the
 * tolerance in the scenes that it sees; then the scenes that are held out. */
#include "recast.h"
#include "scene_asked.h"
#include "turns.h"

#include "base/definition.h"
#include "base/host.h"

#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define FEWEST 16        /* steps of a combination, at least */
#define DEAREST 2e8      /* more cycles of a run are too many, unless ... */
#define DEAREST_TIMES 16 /* ... they are so many times those of the scene as it is at most */
#define FINEST 64        /* parts of a step of the scene, at most */
#define FINALISTS 5      /* whose time is measured ... */
#define FINAL_TIMES 3    /* ... if their cycles are so many times the fewest at most */
#define ROUNDS 4         /* of held-out scenes */

/* One of the combinations, by its cost. */
typedef struct {
    size_t choice;
    uint64_t parts, joined;
    double cycles; /* of all objects and steps */
} pair;

/* How far the last runs of a choice came. */
typedef struct {
    uint64_t kept[2];
    int has_met, is_done; /* it met the target; or rounding ends it sooner with each halving */
} progress;

typedef struct {
    const fp3_scene_tune_def *def;
    fp3_drawn *sample;
    size_t sample_count;
    fp3_drawn_times times;
    uint64_t steps;
    fp3_recast own, *choices;
    size_t choice_count;
    pair *pairs;
    size_t pair_count, next; /* that has not been looked at */
    progress *after;         /* of each choice */
    size_t *choice_of;       /* of each row */
    fp3_turns *turns;
    fp3_scene_tuning *t;
    fp3_error *error;
} tuner;

__attribute__((format(printf, 2, 3))) static void say(const tuner *k, const char *format, ...) {
    char text[160];
    va_list arguments;
    if (!k->def->say)
        return;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    k->def->say(k->def->user, text);
}

static int is_stopped(const tuner *k) {
    if (k->def->stop && k->def->stop(k->def->user))
        k->t->is_stopped = 1;
    return k->t->is_stopped;
}

/* ---- times and scenes ---- */

static void note_known(tuner *k, const fp3_drawn *d) {
    const uint64_t known = d->solved.known ? k->times.steps[d->solved.known - 1] : 0;
    if (known < k->t->known)
        k->t->known = known;
}

static fp3_status open_sample(tuner *k) {
    fp3_status status = FP3_OK;
    int moves = 0;
    for (uint32_t i = 0; !status && i < k->def->sample && !is_stopped(k); i++) {
        fp3_drawn *d = &k->sample[i];
        say(k, "the solution of scene %" PRIu32 " of %" PRIu32, i + 1, k->def->sample);
        if (i)
            status = fp3_drawn_open(k->def, i, &k->sample[0], d, k->error);
        k->sample_count = i + 1u;
        if (!status)
            status = fp3_drawn_solve(k->def, &k->times, d, k->error);
        if (status && is_stopped(k))
            return FP3_OK;
        note_known(k, d);
    }
    k->t->sample = (uint32_t)k->sample_count;
    k->t->solved = k->sample[0].solved;
    for (size_t i = 0; !status && !moves && !is_stopped(k) && i < k->sample_count; i++)
        status = fp3_drawn_moves(&k->sample[i], &moves, k->error);
    return status || moves || is_stopped(k)
               ? status
               : fp3_fail(k->error, FP3_E_ARGUMENT,
                          "%s: nothing ever moves, so each step would do: expected a start from "
                          "which something moves",
                          k->def->path);
}

/* ---- one run ---- */

/* Until the error is above the target. The row's error and `kept` become those of all scenes that
 * it has seen. */
static fp3_status look(tuner *k, fp3_recast_run *run, const fp3_drawn *d, double target,
                       double *states, fp3_scene_tune_row *row) {
    fp3_status status = FP3_OK;
    uint64_t made = 0, kept = 0;
    int has_looked = 0;
    for (size_t i = 0; i < d->solved.known && !is_stopped(k); i++) {
        const uint64_t step = k->times.steps[i];
        if (step > k->t->known)
            break;
        if (step % row->joined)
            continue;
        has_looked = 1;
        status = fp3_adaptive_run(run->engine, (step - made) / row->joined * row->parts, NULL);
        if (!status && k->turns && target == INFINITY && d == k->sample &&
            i % (d->solved.known / FP3_TURNS_LOOKS + 1) == 0)
            status = fp3_turns_look(k->turns, run->engine, k->error);
        if (!status)
            status = fp3_scaled_row(&run->scaled.scene, run->engine, states, k->error);
        if (status && status != FP3_E_FAILED)
            return status;
        const double error = status ? INFINITY : fp3_drawn_error(d, i, states);
        row->error = fmax(row->error, error);
        if (status || error > target)
            break;
        kept = made = step;
    }
    if (!has_looked && !is_stopped(k)) /* its steps are longer than errors are known */
        row->error = INFINITY;
    row->kept = kept < row->kept ? kept : row->kept;
    return FP3_OK;
}

static fp3_status run_one(tuner *k, const fp3_recast *choice, const fp3_drawn *d, double target,
                          fp3_scene_tune_row *row) {
    const fp3_recast_steps steps = {choice, row->parts, row->joined, -1};
    double *states = calloc(d->width + 1, sizeof *states);
    fp3_recast_run run = {.engine = NULL};
    fp3_status status = states ? FP3_OK : fp3_no_memory(k->error);
    if (!status)
        status = fp3_recast_begin(&steps, d->scene, k->steps, 0, &run, k->error);
    if (!status && choice == &k->own && !k->turns)
        status = fp3_turns_open(d->scene, &k->turns, k->error);
    if (!status)
        status = look(k, &run, d, target, states, row);
    fp3_recast_end(&run);
    free(states);
    return status;
}

/* In the scenes of the sample after the first, up to one in which it fails. */
static fp3_status run_sample(tuner *k, const fp3_recast *choice, double give_up,
                             fp3_scene_tune_row *row) {
    fp3_status status = FP3_OK;
    for (size_t i = 1; !status && i < k->sample_count && row->error <= give_up && !is_stopped(k);
         i++)
        status = run_one(k, choice, &k->sample[i], give_up, row);
    row->is_met = !status && !k->t->is_stopped && row->error <= k->t->target;
    return status;
}

static void name_row(fp3_scene_tune_row *row, const fp3_integrator *integrator,
                     fp3_arithmetic arithmetic, double h) {
    snprintf(row->integrator, sizeof row->integrator, "%s", integrator->name);
    row->arithmetic = arithmetic;
    row->h = h * (double)row->joined / (double)row->parts;
}

/* ---- combinations ---- */

static fp3_status refuse(tuner *k, const fp3_recast *c, const fp3_error *why) {
    fp3_scene_tune_refusal *more =
        realloc(k->t->refusals, (k->t->refusal_count + 1) * sizeof *more);
    if (!more)
        return fp3_no_memory(k->error);
    k->t->refusals = more;
    fp3_scene_tune_refusal *r = &more[k->t->refusal_count++];
    *r = (fp3_scene_tune_refusal){.arithmetic = c->arithmetic};
    snprintf(r->integrator, sizeof r->integrator, "%s", c->integrator->name);
    snprintf(r->why, sizeof r->why, "%.159s", why->text);
    return FP3_OK;
}

/* Those that the scene can have. */
static fp3_status compile_all(tuner *k) {
    size_t names = 0;
    fp3_status status = FP3_OK;
    while (fp3_integrator_name((unsigned)names))
        names++;
    k->choices = calloc(names * FP3_ARITHMETICS + 1, sizeof *k->choices);
    if (!k->choices)
        return fp3_no_memory(k->error);
    for (size_t i = 0; !status && i < names * FP3_ARITHMETICS && !is_stopped(k); i++) {
        fp3_recast *c = &k->choices[k->choice_count];
        fp3_error why;
        status = fp3_integrator_find(fp3_integrator_name((unsigned)(i / FP3_ARITHMETICS)),
                                     &c->integrator, k->error);
        c->arithmetic = (fp3_arithmetic)(i % FP3_ARITHMETICS);
        if (!status && !fp3_arithmetic_applies(c->arithmetic, c->integrator, 0)) {
            fp3_recast_free(c);
            continue;
        }
        if (!status)
            say(k, "compiling %s, %s", c->integrator->name, fp3_arithmetic_of(c->arithmetic)->name);
        const fp3_status is = status ? status : fp3_recast_compile(c, k->sample[0].scene, &why);
        if (!status && is) {
            status = is == FP3_E_PROGRAM || is == FP3_E_LIMIT
                         ? refuse(k, c, &why)
                         : fp3_fail(k->error, is, "%s", why.text);
            fp3_recast_free(c);
        } else {
            k->choice_count++;
        }
    }
    return status;
}

static int compare_pairs(const void *a, const void *b) {
    const pair *x = a, *y = b;
    if (x->cycles != y->cycles)
        return x->cycles < y->cycles ? -1 : 1;
    return x->choice < y->choice ? -1 : x->choice > y->choice;
}

static fp3_status list_pairs(tuner *k) {
    const double dearest = fmax(DEAREST, DEAREST_TIMES * k->t->own.cycles * (double)k->t->objects);
    uint64_t longest = fp3_drawn_power(k->steps, FEWEST);
    while (longest > 1 && longest * FEWEST > k->t->known)
        longest /= 2;
    enum { LENGTHS = 64 + 7 }; /* of joined steps, and of parts up to FINEST */
    k->pairs = calloc(k->choice_count * LENGTHS + 1, sizeof *k->pairs);
    k->after = calloc(k->choice_count + 1, sizeof *k->after);
    if (!k->pairs || !k->after)
        return fp3_no_memory(k->error);
    for (size_t i = 0; i < k->choice_count; i++) {
        const double step = fp3_turns_cycles(k->turns, k->choices[i].programs);
        for (pair p = {i, 1, longest, 0}; p.parts <= FINEST;) {
            p.cycles = step * (double)k->steps * (double)p.parts / (double)p.joined;
            if (p.cycles > dearest)
                break;
            k->pairs[k->pair_count++] = p;
            if (p.joined > 1)
                p.joined /= 2;
            else
                p.parts *= 2;
        }
    }
    qsort(k->pairs, k->pair_count, sizeof *k->pairs, compare_pairs);
    k->t->rows = calloc(k->pair_count + 1, sizeof *k->t->rows);
    k->choice_of = calloc(k->pair_count + 1, sizeof *k->choice_of);
    return k->t->rows && k->choice_of ? FP3_OK : fp3_no_memory(k->error);
}

/* is_whole: all steps at which scenes are looked at are among its own. */
static void note_progress(progress *after, const fp3_scene_tune_row *row, int is_whole) {
    after->has_met = row->is_met;
    after->is_done = row->is_met || (row->kept < after->kept[0] && after->kept[0] < after->kept[1]);
    after->kept[1] = after->kept[0];
    after->kept[0] = is_whole ? row->kept : 0;
}

static fp3_status try_pair(tuner *k, const pair *p) {
    fp3_scene_tuning *t = k->t;
    const fp3_recast *c = &k->choices[p->choice];
    fp3_scene_tune_row *row = &t->rows[t->row_count];
    *row = (fp3_scene_tune_row){.parts = p->parts,
                                .joined = p->joined,
                                .kept = t->known,
                                .cycles = p->cycles / (double)t->objects};
    name_row(row, c->integrator, c->arithmetic, t->own.h);
    say(k, "%s, %s, h = %.6g", row->integrator, fp3_arithmetic_of(c->arithmetic)->name, row->h);
    fp3_status status = run_one(k, c, &k->sample[0], t->target, row);
    if (!status && !is_stopped(k) && row->error <= t->target)
        status = run_sample(k, c, t->target, row);
    if (status || is_stopped(k))
        return status;
    note_progress(&k->after[p->choice], row, p->joined <= k->times.every);
    k->choice_of[t->row_count++] = p->choice;
    return status;
}

/* By the cycles alone the first that meets the target is the cheapest. What was tried before does
 * not meet it in more scenes. */
static fp3_status search(tuner *k) {
    fp3_scene_tuning *t = k->t;
    fp3_status status = FP3_OK;
    size_t met = 0;
    double fewest = INFINITY;
    const size_t wanted = k->def->cost == FP3_SCENE_COST_TIME ? FINALISTS : 1;
    for (size_t i = 0; i < k->choice_count; i++)
        k->after[i].is_done &= !k->after[i].has_met;
    t->best = SIZE_MAX;
    for (; !status && k->next < k->pair_count && met < wanted && !is_stopped(k); k->next++) {
        const pair *p = &k->pairs[k->next];
        if (p->cycles > FINAL_TIMES * fewest)
            break;
        if (k->after[p->choice].is_done)
            continue;
        status = try_pair(k, p);
        if (status || t->is_stopped || !t->rows[t->row_count - 1].is_met)
            continue;
        fewest = fmin(fewest, p->cycles);
        if (!met++)
            t->best = t->row_count - 1;
    }
    if (t->best > t->row_count)
        t->best = t->row_count;
    return status;
}

/* ---- time ---- */

/* The scene as it is, and those that met the target. */
static fp3_status measure(tuner *k) {
    fp3_scene_tuning *t = k->t;
    fp3_recast_steps list[FINALISTS + 1] = {{&k->own, 1, 1, -1}};
    size_t rows[FINALISTS + 1], count = 1;
    double ns[FINALISTS + 1];
    for (size_t i = 0; i < t->row_count; i++)
        if (t->rows[i].is_met && count <= FINALISTS) {
            rows[count] = i;
            list[count++] = (fp3_recast_steps){&k->choices[k->choice_of[i]], t->rows[i].parts,
                                               t->rows[i].joined, -1};
        }
    say(k, "the time of %zu of them", count);
    const fp3_status status =
        fp3_recast_time(k->def, list, count, k->sample[0].scene, k->steps, ns, k->error);
    t->own.ns = ns[0];
    for (size_t i = 1; !status && i < count; i++) {
        t->rows[rows[i]].ns = ns[i];
        if (k->def->cost == FP3_SCENE_COST_TIME && ns[i] > 0 && ns[i] < t->rows[t->best].ns)
            t->best = rows[i];
    }
    return status;
}

/* Changes no bit: only the time decides. */
static fp3_status find_skin(tuner *k) {
    static const double skins[] = {-1, 0.1, 0.2, 0.4, 0.6, 1};
    enum { SKINS = sizeof skins / sizeof *skins };
    fp3_scene_tune_row *best = &k->t->rows[k->t->best];
    fp3_recast_steps list[SKINS];
    double ns[SKINS];
    for (size_t i = 0; i < SKINS; i++)
        list[i] = (fp3_recast_steps){&k->choices[k->choice_of[k->t->best]], best->parts,
                                     best->joined, skins[i]};
    say(k, "skins of the lists");
    const fp3_status status =
        fp3_recast_time(k->def, list, SKINS, k->sample[0].scene, k->steps, ns, k->error);
    for (size_t i = 0; !status && i < SKINS; i++)
        if (ns[i] > 0 && (i == 0 || ns[i] < best->ns)) {
            best->ns = ns[i];
            k->t->skin = skins[i];
        }
    return status;
}

static fp3_status measure_all(tuner *k) {
    fp3_status status = measure(k);
    if (!status && k->def->cost == FP3_SCENE_COST_TIME && k->t->best < k->t->row_count &&
        fp3_recast_scene_has_near(k->sample[0].scene) && !is_stopped(k))
        status = find_skin(k);
    return status;
}

/* ---- the whole ---- */

/* The scene is one of the sample from then on, for the case that the choice does not hold. */
static fp3_status judge(tuner *k, uint64_t draw, fp3_scene_tune_row *row) {
    fp3_drawn *d = &k->sample[k->sample_count++];
    fp3_status status = fp3_drawn_open(k->def, draw, &k->sample[0], d, k->error);
    if (!status)
        status = fp3_drawn_solve(k->def, &k->times, d, k->error);
    if (!status && !is_stopped(k)) {
        note_known(k, d);
        fp3_drawn_differ(k->def, d, k->t->differ, sizeof k->t->differ);
        status = run_one(k, &k->choices[k->choice_of[k->t->best]], d, INFINITY, row);
        k->t->held_out += !is_stopped(k);
    }
    return status && is_stopped(k) ? FP3_OK : status;
}

static fp3_status hold_out(tuner *k) {
    fp3_scene_tuning *t = k->t;
    fp3_scene_tune_row row = t->rows[t->best];
    fp3_status status = FP3_OK;
    row.error = 0;
    t->held_out = 0;
    t->sample = (uint32_t)k->sample_count;
    for (uint32_t i = 0; !status && i < k->def->held_out && !is_stopped(k); i++) {
        say(k, "held-out scene %" PRIu32 " of %" PRIu32, i + 1, k->def->held_out);
        status = judge(k, k->sample_count, &row);
    }
    if (t->held_out)
        t->error_held_out = row.error;
    t->is_met = t->held_out == k->def->held_out && row.error <= k->def->tolerance;
    return status;
}

/* A choice that does not hold is none: those that it failed in are seen from then on. */
static fp3_status choose(tuner *k) {
    fp3_scene_tuning *t = k->t;
    fp3_status status = FP3_OK;
    while (!status && !t->is_met && t->rounds < ROUNDS && !is_stopped(k)) {
        t->rounds++;
        for (size_t i = 0; i < t->row_count; i++)
            t->rows[i].is_met = 0;
        status = search(k);
        if (!status && !is_stopped(k) && (t->best < t->row_count || t->rounds == 1))
            status = measure_all(k);
        if (status || is_stopped(k) || t->best == t->row_count)
            break;
        status = hold_out(k);
    }
    return status;
}

static fp3_status begin(tuner *k) {
    fp3_scene_tuning *t = k->t;
    fp3_drawn *as_is = &k->sample[0];
    fp3_status status = fp3_drawn_open(k->def, 0, NULL, as_is, k->error);
    k->sample_count = 1;
    if (!status)
        status = fp3_scene_tune_check(as_is->scene, k->error);
    if (status)
        return status;
    k->steps = k->def->steps ? k->def->steps : as_is->scene->steps;
    t->steps = t->known = k->steps;
    t->objects = as_is->scene->objects;
    snprintf(t->config, sizeof t->config, "%s", as_is->scene->config);
    if (!k->steps || !t->objects)
        return fp3_fail(k->error, FP3_E_ARGUMENT, "%s: expected objects and steps", k->def->path);
    status = fp3_drawn_times_find(k->steps, as_is->width, &k->times, k->error);
    if (!status)
        status = fp3_recast_take(&k->own, as_is->scene, k->error);
    if (!status)
        status = open_sample(k);
    return status;
}

/* The scene as it is: its error, and the lists by which cycles are predicted. */
static fp3_status measure_own(tuner *k) {
    fp3_scene_tuning *t = k->t;
    const fp3_program *program = fp3_recast_first(k->sample[0].scene);
    t->own = (fp3_scene_tune_row){.parts = 1, .joined = 1, .kept = t->known};
    name_row(&t->own, program->integrator, program->compiled->arithmetic,
             fp3_scaled_step(&k->sample[0].scene->groups[0]));
    say(k, "the scene as it is");
    fp3_status status = run_one(k, &k->own, &k->sample[0], INFINITY, &t->own);
    if (!status)
        status = run_sample(k, &k->own, INFINITY, &t->own);
    if (!status && k->turns && !t->is_stopped)
        t->own.cycles =
            fp3_turns_cycles(k->turns, k->own.programs) * (double)k->steps / (double)t->objects;
    return status;
}

static fp3_status tune(tuner *k) {
    fp3_status status = begin(k);
    if (!status && !is_stopped(k))
        status = measure_own(k);
    if (!status && !is_stopped(k))
        status = compile_all(k);
    if (!status && !is_stopped(k))
        status = list_pairs(k);
    if (!status && !is_stopped(k))
        status = choose(k);
    return status;
}

static void end(tuner *k) {
    for (size_t i = 0; i < k->sample_count; i++)
        fp3_drawn_close(&k->sample[i]);
    for (size_t i = 0; i < k->choice_count; i++)
        fp3_recast_free(&k->choices[i]);
    fp3_turns_free(&k->turns);
    fp3_recast_free(&k->own);
    free(k->sample);
    free(k->choices);
    free(k->pairs);
    free(k->after);
    free(k->choice_of);
    free(k->times.steps);
}

fp3_status fp3_scene_tune(const fp3_scene_tune_def *def, fp3_scene_tuning **tuning,
                          fp3_error *error) {
    FP3_HOST;
    *tuning = NULL;
    if (fp3_definition_check(def, sizeof *def, "fp3_scene_tune_def", error))
        return FP3_E_ARGUMENT;
    fp3_scene_tune_def own;
    fp3_status status = fp3_scene_tune_settle(def, &own, error);
    if (status)
        return status;
    *tuning = calloc(1, sizeof **tuning);
    tuner k = {.def = &own,
               .sample =
                   calloc(def->sample + ROUNDS * (size_t)def->held_out + 1u, sizeof *k.sample),
               .t = *tuning,
               .error = error};
    status = *tuning && k.sample ? FP3_OK : fp3_no_memory(error);
    if (!status) {
        k.t->error_held_out = NAN;
        k.t->skin = -1;
        k.t->within = own.within;
        k.t->target = def->tolerance / def->safety;
        status = tune(&k);
    }
    end(&k);
    if (status)
        fp3_scene_tuning_free(tuning);
    return status;
}

void fp3_scene_tuning_free(fp3_scene_tuning **tuning) {
    if (*tuning) {
        free((*tuning)->rows);
        free((*tuning)->refusals);
    }
    free(*tuning);
    *tuning = NULL;
}
