/* SPDX-License-Identifier: Apache-2.0 */
/* tune.c - see fp3/tune.h: candidates by candidate on what the choice has seen, then the held-out
 * sample. */
#include "search.h"
#include "sensitivity.h"

#include "base/definition.h"
#include "base/host.h"
#include "machine/format.h"
#include "machine/storage.h"
#include "world/values.h"

#include <fp3/compile.h>
#include <gsl/gsl_qrng.h>
#include <gsl/gsl_rng.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define SOBOL_MOST 40 /* dimensions that GSL's sequence has */
#define SEED 1
#define METHOD 30       /* an error so many targets large is not rounding */
#define DEAREST 1.6e7   /* cycles of an object in a run, at most; ... */
#define DEAREST_TIMES 8 /* ... or so many times those of rk4 */

/* In the order of rows: the first one is the baseline. */
typedef enum { FIXED, CUT, ADAPTIVE, KINDS } fp3_steps_kind;

typedef struct {
    const fp3_tune_def *def;
    const fp3_model *model;
    fp3_sample seen, unseen;
    fp3_meter meter, held;
    fp3_candidate *candidates; /* of rows, by the same number */
    gsl_rng *random;
    fp3_tuning *t;
    fp3_error *error;
} tuner;

void fp3_tune_set_default(fp3_tune_def *def, size_t size) {
    if (!fp3_definition_begin(def, size, sizeof *def))
        return;
    def->safety = 1.25;
    def->sample = 32;
    def->held_out = 64;
    def->rounds = 4;
}

static void say(const tuner *k, const char *what) {
    if (k->def->say)
        k->def->say(k->def->user, what);
}

/* ---- what is refused ---- */

static fp3_status check_machine(const fp3_tune_def *def, fp3_error *error) {
    const fp3_config *config;
    const fp3_status status = fp3_config_choose(def->config, &config, error);
    if (status)
        return status;
    if (fp3_config_schedulers(config) > 1)
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "configuration '%s' has several schedulers: expected a configuration with "
                        "one, whose cycles for an object are known beforehand",
                        config->name);
    /* Of records of 16 bits the last store rounds. */
    const double bits = fmin(config->fraction + 1, log2(fp3_storage_counts(config))),
                 unit = exp2(-bits), least = FP3_TUNE_LEAST * unit * 0x1p24;
    if (def->tolerance < least)
        return fp3_fail(error, def->tolerance >= FP3_TUNE_LEAST ? FP3_E_PROGRAM : FP3_E_ARGUMENT,
                        "the tolerance is %g: expected %.3g or more, because configuration '%s' "
                        "rounds by %.2g",
                        def->tolerance, least, config->name, unit);
    return FP3_OK;
}

static fp3_status check(const tuner *k) {
    const fp3_tune_def *def = k->def;
    if (!def->program->model)
        return fp3_fail(k->error, FP3_E_ARGUMENT,
                        "expected a model: no other program has integrators");
    const fp3_status alone = fp3_model_check_alone(k->model, k->error);
    if (alone)
        return alone;
    fp3_value_look look;
    for (size_t i = 0; fp3_values_look(def->params, i, &look); i++)
        if (look.objects)
            return fp3_fail(k->error, FP3_E_ARGUMENT,
                            "'%s' has a value of its own for each object: the tuner takes numbers "
                            "and ranges",
                            look.name);
    if (fp3_model_adapted(k->model) != FP3_NONE)
        return fp3_fail(k->error, FP3_E_ARGUMENT,
                        "expected a model with fixed steps: the tuner adapts the model itself");
    if (!(def->tolerance > 0 && def->tolerance < 1))
        return fp3_fail(k->error, FP3_E_ARGUMENT,
                        "the tolerance is %g: expected a number above 0 and below 1",
                        def->tolerance);
    if (!(def->safety >= 1 && isfinite(def->safety)) || !def->sample || !def->held_out ||
        !def->rounds)
        return fp3_fail(k->error, FP3_E_ARGUMENT, "expected a safety of at least 1, and objects");
    if (!(k->t->span > 0 && isfinite(k->t->span)))
        return fp3_fail(k->error, FP3_E_ARGUMENT, "the span is %g: expected a time above 0",
                        k->t->span);
    if (fp3_params_has(def->params, FP3_NAME_STEPS))
        return fp3_fail(k->error, FP3_E_ARGUMENT,
                        "'steps' has a value: a tuner's objects start at time 0");
    const double steps = k->t->span / k->model->step;
    if (!(steps >= 1 && steps < FP3_STEPS_LIMIT / 2))
        return fp3_fail(k->error, FP3_E_ARGUMENT,
                        "the span %g is %g of the model's steps: expected 1 to %d", k->t->span,
                        steps, FP3_STEPS_LIMIT / 2);
    return check_machine(def, k->error);
}

/* What no object may have, in the words of a run: a shared param that is spread, a name that there
 * is not. */
static fp3_status check_values(const tuner *k) {
    int is_spread;
    float *values = calloc(k->def->program->compiled->input_count + 1u, sizeof *values);
    if (!values)
        return fp3_no_memory(k->error);
    const fp3_status status =
        fp3_program_inputs(k->def->program, k->def->params, 0, values, &is_spread, k->error);
    free(values);
    return status;
}

/* ---- samples ---- */

static fp3_status add(tuner *k, fp3_sample *sample, const double *shares) {
    return fp3_sample_add(sample, k->def->program, k->def->params, shares, k->error);
}

/* Both ends of all ranges, then a sequence that fills them evenly. */
static fp3_status draw_seen(tuner *k) {
    const uint32_t ranges = k->t->ranges, count = ranges ? k->def->sample : 1;
    gsl_qrng *sobol =
        ranges && ranges <= SOBOL_MOST ? gsl_qrng_alloc(gsl_qrng_sobol, ranges) : NULL;
    double *shares = calloc(ranges + 1u, sizeof *shares);
    fp3_status status = shares ? FP3_OK : fp3_no_memory(k->error);
    for (uint32_t i = 0; !status && i < count; i++) {
        for (uint32_t j = 0; j < ranges; j++)
            shares[j] = i < 2 ? i : gsl_rng_uniform(k->random);
        if (sobol && i >= 2)
            gsl_qrng_get(sobol, shares);
        status = add(k, &k->seen, shares);
    }
    free(shares);
    if (sobol)
        gsl_qrng_free(sobol);
    return status;
}

/* Independent of each other and of all before. */
static fp3_status draw_unseen(tuner *k) {
    const uint32_t ranges = k->t->ranges;
    double *shares = calloc(ranges + 1u, sizeof *shares);
    fp3_status status = shares ? FP3_OK : fp3_no_memory(k->error);
    fp3_sample_close(&k->unseen);
    fp3_sample_open(&k->unseen, k->model, k->t->span);
    for (uint32_t i = 0; !status && i < k->def->held_out; i++) {
        for (uint32_t j = 0; j < ranges; j++)
            shares[j] = gsl_rng_uniform(k->random);
        status = add(k, &k->unseen, shares);
    }
    free(shares);
    return status;
}

/* ---- candidates ---- */

static int apart_from_four(unsigned order) { return order > 4 ? (int)order - 4 : 4 - (int)order; }

/* Adaptive steps that stiffness does not shorten: they take few where others take very many. */
static int is_implicit(const fp3_candidate *c) {
    return c->is_adaptive && c->integrator->kind == FP3_ROSENBROCK;
}

static fp3_steps_kind kind_of(const fp3_candidate *c) {
    return c->is_adaptive ? ADAPTIVE : c->is_cut ? CUT : FIXED;
}

/* The likely ones first: whatever follows is only looked at as far as it is cheaper. */
static int compare_candidates(const void *a, const void *b) {
    const fp3_candidate *x = a, *y = b;
    if (kind_of(x) != kind_of(y))
        return kind_of(x) < kind_of(y) ? -1 : 1;
    if (x->arithmetic != y->arithmetic)
        return x->arithmetic < y->arithmetic ? -1 : 1;
    if (is_implicit(x) != is_implicit(y))
        return is_implicit(y) - is_implicit(x);
    const int far = apart_from_four(x->integrator->order) - apart_from_four(y->integrator->order);
    if (far)
        return far;
    const int is_rk4 = strcmp(y->integrator->name, "rk4") == 0;
    return is_rk4 - (strcmp(x->integrator->name, "rk4") == 0);
}

/* Only events cut steps; then h is not known beforehand, and nothing can be folded into it. */
static int is_candidate(const tuner *k, const fp3_candidate *c) {
    if (c->is_cut && (!k->model->event_count || c->arithmetic == FP3_FOLDED ||
                      c->integrator->kind == FP3_STOERMER))
        return 0;
    return fp3_arithmetic_applies(c->arithmetic, c->integrator, c->is_adaptive);
}

static fp3_status list_candidates(tuner *k) {
    size_t names = 0, count = 0;
    fp3_status status = FP3_OK;
    while (fp3_integrator_name((unsigned)names))
        names++;
    const size_t each = names * FP3_ARITHMETICS, most = each * KINDS;
    k->candidates = calloc(most, sizeof *k->candidates);
    k->t->rows = calloc(most, sizeof *k->t->rows);
    if (!k->candidates || !k->t->rows)
        return fp3_no_memory(k->error);
    for (size_t i = 0; !status && i < most; i++) {
        fp3_candidate *c = &k->candidates[count];
        status = fp3_integrator_find(fp3_integrator_name((unsigned)(i % names)), &c->integrator,
                                     k->error);
        c->arithmetic = (fp3_arithmetic)(i / names % FP3_ARITHMETICS);
        c->is_adaptive = i / each == ADAPTIVE;
        c->is_cut = i / each == CUT;
        c->maxstep = k->def->maxstep;
        if (!status && !is_candidate(k, c))
            fp3_candidate_free(c);
        else
            count++;
    }
    k->t->row_count = k->t->best = count;
    qsort(k->candidates, count, sizeof *k->candidates, compare_candidates);
    return status;
}

static void name_row(const fp3_candidate *c, fp3_tune_row *row) {
    snprintf(row->integrator, sizeof row->integrator, "%s", c->integrator->name);
    row->arithmetic = c->arithmetic;
    row->is_adaptive = c->is_adaptive;
    row->is_cut = c->is_cut;
    row->lowest = row->error = INFINITY;
}

/* FP3_OK and no program: it cannot be compiled, and the row says why. */
static fp3_status compile(tuner *k, size_t i) {
    fp3_error why;
    fp3_candidate *c = &k->candidates[i];
    if (c->timed || c->is_refused)
        return FP3_OK;
    const fp3_status status = fp3_candidate_compile(c, k->model, k->def->config, &why);
    if (status == FP3_E_PROGRAM || status == FP3_E_LIMIT) {
        fp3_compiled_free(&c->timed);
        c->measured = NULL;
        c->is_refused = 1;
        snprintf(k->t->rows[i].why, sizeof k->t->rows[i].why, "%.159s", why.text);
        return FP3_OK;
    }
    return status ? fp3_fail(k->error, status, "%s", why.text) : FP3_OK;
}

/* The same integrator, plain, with the same kind of fixed steps. */
static const fp3_tune_row *plain_of(const tuner *k, size_t i) {
    const fp3_tune_row *rows = k->t->rows;
    size_t j = 0;
    while (rows[j].is_cut != rows[i].is_cut || strcmp(rows[j].integrator, rows[i].integrator) != 0)
        j++; /* plain ones come first */
    return &rows[j];
}

/* Where plain steps failed by far more than rounding, the method did: an arithmetic that rounds
 * less and costs more has fewer steps for the same cycles, and fails, too. */
static int is_the_method(tuner *k, size_t i, double target) {
    const fp3_arithmetic how = k->candidates[i].arithmetic;
    const fp3_tune_row *plain = plain_of(k, i);
    if (k->candidates[i].is_adaptive || (how != FP3_COMPENSATED && how != FP3_DOUBLE_SINGLE) ||
        k->t->best == k->t->row_count || plain->is_met || plain->looks != 1 ||
        !(plain->error > METHOD * target))
        return 0;
    fp3_tune_row *row = &k->t->rows[i];
    row->steps = row->looks = 0;
    row->is_met = 0;
    row->lowest = row->error = INFINITY;
    snprintf(row->why, sizeof row->why, "skipped: the error of the method itself, plain, is %.1e",
             plain->error);
    return 1;
}

static fp3_status try_one(tuner *k, size_t i, double target) {
    const fp3_tuning *t = k->t;
    fp3_tune_row *row = &k->t->rows[i];
    const fp3_search search = {.sample = &k->seen,
                               .meter = &k->meter,
                               .config = k->def->config,
                               .target = target,
                               .first = t->baseline_steps,
                               .dearest = fmax(DEAREST, DEAREST_TIMES * t->baseline_cycles),
                               .cheaper =
                                   t->best < t->row_count ? t->rows[t->best].cycles : INFINITY};
    char text[80];
    snprintf(text, sizeof text, "%s, %s%s", row->integrator,
             fp3_arithmetic_of(row->arithmetic)->name,
             row->is_adaptive ? ", adaptive"
             : row->is_cut    ? ", cut at events"
                              : "");
    say(k, text);
    if (is_the_method(k, i, target))
        return FP3_OK;
    fp3_status status = compile(k, i);
    if (status || !k->candidates[i].timed)
        return status;
    status = (row->is_adaptive ? fp3_search_tolerance
                               : fp3_search_steps)(&search, &k->candidates[i], row, k->error);
    if (!status && row->is_met)
        k->t->best = i;
    return status;
}

static fp3_status try_all(tuner *k, fp3_steps_kind kind) {
    fp3_status status = FP3_OK;
    for (size_t i = 0; !status && i < k->t->row_count; i++)
        if (kind_of(&k->candidates[i]) == kind)
            status = try_one(k, i, k->t->target);
    return status;
}

/* Adaptive steps first: they find what a stiff model needs, and fixed ones that cost more are not
 * run. */
static fp3_status choose(tuner *k) {
    k->t->best = k->t->row_count;
    fp3_status status = try_all(k, ADAPTIVE);
    if (!status)
        status = try_all(k, CUT);
    return status ? status : try_all(k, FIXED);
}

/* ---- the whole ---- */

/* The first candidate is rk4, plain. */
static fp3_status measure_baseline(tuner *k) {
    const fp3_candidate *rk4 = &k->candidates[0];
    fp3_tuning *t = k->t;
    t->baseline_steps = (uint64_t)fmax(1, round(t->span / k->model->step));
    fp3_status status = compile(k, 0);
    if (!status && !rk4->timed)
        return fp3_fail(k->error, FP3_E_PROGRAM, "rk4, which costs are compared with: %s",
                        t->rows[0].why);
    if (status)
        return status;
    t->baseline_cycles = fp3_candidate_cycles(rk4, k->def->config, (double)t->baseline_steps);
    const fp3_stepping how = {.steps = t->baseline_steps};
    fp3_meter_found found;
    status = fp3_meter_read(&k->meter, &k->seen, rk4->measured, &how, &found, k->error);
    t->baseline_error = found.worst;
    return status;
}

static fp3_status measure_unseen(tuner *k, const fp3_tune_row *row, const fp3_compiled *compiled) {
    const fp3_stepping how = {row->steps, row->tolerance,  row->absolute,
                              INFINITY,   k->def->maxstep, row->is_cut};
    fp3_meter_found found;
    const fp3_status status =
        fp3_meter_read(&k->held, &k->unseen, compiled, &how, &found, k->error);
    k->t->error_held_out = found.worst;
    return status;
}

/* What failed is seen from then on. */
static fp3_status hold_out(tuner *k) {
    const fp3_tune_row *best = &k->t->rows[k->t->best];
    say(k, "a held-out sample");
    fp3_status status = draw_unseen(k);
    if (!status)
        status = measure_unseen(k, best, k->candidates[k->t->best].measured);
    k->t->held_out = (uint32_t)k->unseen.count;
    k->t->is_met = !status && k->t->error_held_out <= k->def->tolerance;
    return status;
}

static fp3_status tune(tuner *k) {
    fp3_tuning *t = k->t;
    fp3_status status = FP3_OK;
    while (!status && !t->is_met && t->rounds < k->def->rounds) {
        t->rounds++;
        t->sample = (uint32_t)k->seen.count;
        t->target = k->def->tolerance / pow(k->def->safety, t->rounds);
        status = choose(k);
        if (status || t->best == t->row_count)
            return status;
        if (!t->ranges) {
            t->is_met = 1;
            return FP3_OK;
        }
        status = hold_out(k);
        if (!status && !t->is_met && t->rounds < k->def->rounds)
            status = fp3_sample_join(&k->seen, &k->unseen, k->error);
    }
    return status;
}

static fp3_status begin(tuner *k) {
    fp3_status status = check(k);
    if (!status)
        k->meter.config = k->held.config = fp3_meter_config(k->def->config);
    if (!status)
        status = check_values(k);
    if (!status)
        status = list_candidates(k);
    for (size_t i = 0; !status && i < k->t->row_count; i++)
        name_row(&k->candidates[i], &k->t->rows[i]);
    say(k, "the truth");
    if (!status)
        status = draw_seen(k);
    if (!status && !fp3_sample_moves(&k->seen))
        status = fp3_fail(k->error, FP3_E_ARGUMENT,
                          "no object of the sample ever moves, so each step would do: give other "
                          "starts, or ranges in which something moves");
    if (!status)
        status = fp3_sensitivity_find(&k->seen, k->def->config, k->t->sensitive, &k->t->sensitivity,
                                      k->error);
    return status ? status : measure_baseline(k);
}

static void end(tuner *k) {
    for (size_t i = 0; k->candidates && i < k->t->row_count; i++)
        fp3_candidate_free(&k->candidates[i]);
    free(k->candidates);
    fp3_sample_close(&k->seen);
    fp3_sample_close(&k->unseen);
    fp3_meter_close(&k->meter);
    fp3_meter_close(&k->held);
    gsl_rng_free(k->random);
}

fp3_status fp3_tune(const fp3_tune_def *def, fp3_tuning **tuning, fp3_error *error) {
    FP3_HOST;
    *tuning = NULL;
    if (fp3_definition_check(def, sizeof *def, "fp3_tune_def", error))
        return FP3_E_ARGUMENT;
    *tuning = calloc(1, sizeof **tuning);
    gsl_rng *random = gsl_rng_alloc(gsl_rng_mt19937);
    if (!*tuning || !random) {
        free(*tuning);
        *tuning = NULL;
        gsl_rng_free(random);
        return fp3_no_memory(error);
    }
    gsl_rng_set(random, SEED);
    tuner k = {
        .def = def, .model = def->program->model, .t = *tuning, .random = random, .error = error};
    k.t->error_held_out = NAN;
    k.t->span = def->span == 0 && k.model ? k.model->span : def->span;
    k.t->ranges = fp3_sample_ranges(def->params);
    fp3_sample_open(&k.seen, k.model, k.t->span);
    fp3_sample_open(&k.unseen, k.model, k.t->span);
    fp3_status status = begin(&k);
    if (!status)
        status = tune(&k);
    end(&k);
    if (status)
        fp3_tuning_free(tuning);
    return status;
}

void fp3_tuning_free(fp3_tuning **tuning) {
    if (*tuning)
        free((*tuning)->rows);
    free(*tuning);
    *tuning = NULL;
}
