/* SPDX-License-Identifier: Apache-2.0 */
/* compare_adaptive.c - see compare_adaptive.h. */
#include "compare_adaptive.h"

#include "json.h"

#include "lab/bench/variants.h"

#include <fp3/engine.h>
#include <fp3/truth.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define RIVALS_MAX 64
#define RUNGS 48
#define FIRST_STEPS 16
#define SAMPLES 64 /* of the truth, for the size of each state */
#define VALUES 65  /* states or params of a model */

enum { SINGLE, MANY, MACHINES };
static const char *const machines[MACHINES] = {"single_full", "many_full"};
static const char *const engine_names[] = {"isa", "rtl", "fast"};
enum { ISA, RTL, FAST, ENGINES };

/* Fixed steps: errors by their number. */
typedef struct {
    char name[FP3_NAME_SIZE];
    double error[RUNGS], cycles[MACHINES][RUNGS];
} rival;

typedef struct {
    const fp3_compare_adaptive_def *def;
    const char *path;
    fp3_model *model;
    double span, params[VALUES], initial[VALUES], scale[VALUES], end[VALUES];
    rival rivals[RIVALS_MAX];
    unsigned rival_count;
    uint64_t steps[RUNGS];
    unsigned rungs;
    json_t *rows;
    uint64_t mismatches;
    fp3_error failure;
} comparison;

typedef struct {
    double error, cycles[MACHINES]; /* of an object */
    uint32_t accepted, rejected;
    uint64_t mismatches, compared;
    char failure[FP3_ADAPTIVE_TEXT_SIZE];
} row;

/* ---- the truth ---- */

static double distance(const comparison *k, const float *states) {
    double sum = 0;
    uint32_t n = 0;
    for (uint32_t s = 0; s < k->model->state_count; s++)
        if (k->scale[s] > 0) {
            const double d = ((double)states[s] - k->end[s]) / k->scale[s];
            sum += d * d;
            n++;
        }
    return sqrt(sum / (n ? n : 1));
}

static fp3_status find_truth(comparison *k, fp3_error *error) {
    const fp3_model *m = k->model;
    fp3_status status = FP3_OK;
    k->span = (float)(k->def->span != 0 ? k->def->span : m->span);
    fp3_bench_variant(m, 0, k->params, k->initial);
    for (uint32_t s = 0; s < m->state_count; s++)
        k->scale[s] = fabs(k->initial[s]);
    for (int i = 1; !status && i <= SAMPLES; i++) {
        status = fp3_model_truth(m, k->params, k->initial, k->span * i / SAMPLES, k->end, error);
        for (uint32_t s = 0; !status && s < m->state_count; s++)
            k->scale[s] = fmax(k->scale[s], fabs(k->end[s]));
    }
    return status;
}

/* ---- fixed steps ---- */

static fp3_status compile(const fp3_model *model, const fp3_integrator *integrator, int machine,
                          fp3_arithmetic arithmetic, fp3_compiled **compiled, fp3_error *error) {
    fp3_compile_def def = fp3_compile_default();
    def.config = machines[machine];
    def.arithmetic = arithmetic;
    return fp3_compile(model, integrator, &def, compiled, error);
}

static fp3_status climb(const comparison *k, const fp3_compiled *c, rival *r, fp3_error *error) {
    fp3_status status = FP3_OK;
    for (unsigned i = 0; !status && i < k->rungs; i++) {
        float states[VALUES] = {0};
        status = fp3_compiled_reference(c, k->params, k->initial, k->span / (double)k->steps[i],
                                        &k->steps[i], 1, states, error);
        r->error[i] = distance(k, states);
    }
    return status;
}

static fp3_status add_rival(comparison *k, const fp3_integrator *integrator,
                            fp3_arithmetic arithmetic, fp3_error *error) {
    rival *r = &k->rivals[k->rival_count];
    fp3_status status = FP3_OK;
    if (k->rival_count == RIVALS_MAX)
        return FP3_OK;
    strcpy(r->name, integrator->name);
    for (int machine = 0; !status && machine < MACHINES; machine++) {
        fp3_compiled *c = NULL;
        status = compile(k->model, integrator, machine, arithmetic, &c, error);
        if (!status && machine == 0)
            status = climb(k, c, r, error);
        for (unsigned i = 0; !status && i < k->rungs; i++)
            r->cycles[machine][i] = machine == SINGLE ? (double)fp3_compiled_cycles(c, k->steps[i])
                                                      : c->cycles * (double)k->steps[i];
        fp3_compiled_free(&c);
    }
    k->rival_count += !status;
    return status == FP3_E_PROGRAM ? FP3_OK : status; /* it does not fit the model */
}

/* The cheapest that is no worse, of this name or (NULL) of all; NULL: there is none. */
static const rival *find_rival(const comparison *k, int machine, const char *name, double error,
                               unsigned *rung) {
    const rival *best = NULL;
    for (unsigned j = 0; j < k->rival_count; j++)
        for (unsigned i = 0; i < k->rungs; i++)
            if (k->rivals[j].error[i] <= error && (!name || !strcmp(name, k->rivals[j].name)) &&
                (!best || k->rivals[j].cycles[machine][i] < best->cycles[machine][*rung])) {
                best = &k->rivals[j];
                *rung = i;
            }
    return best;
}

/* ---- adaptive steps ---- */

static fp3_status adapt(const comparison *k, double tolerance, fp3_model **model,
                        fp3_error *error) {
    fp3_adaptive_def def = fp3_adaptive_default();
    char *report = NULL;
    def.tolerance = tolerance;
    def.until = k->span;
    fp3_status status = fp3_model_load(k->path, model, &report, error);
    free(report);
    return status ? status : fp3_model_adapt(*model, &def, error);
}

/* All states of the object against the equations, which make as many attempts. */
static fp3_status compare_object(const fp3_model *model, const fp3_compiled *c, fp3_engine *engine,
                                 size_t object, const fp3_adaptive_object *o, row *r,
                                 fp3_error *error) {
    double params[VALUES], initial[VALUES];
    float wanted[VALUES] = {0}, low[VALUES] = {0};
    const uint64_t attempts = (uint64_t)o->accepted + o->rejected;
    const uint32_t t = fp3_model_adapted(model);
    fp3_bench_variant(model, object, params, initial);
    fp3_status status = fp3_compiled_reference_pairs(c, params, initial, model->step, &attempts, 1,
                                                     wanted, low, error);
    for (uint32_t s = 0; !status && s < model->state_count; s++) {
        float got = 0;
        status = fp3_engine_get(engine, object, model->states[s].name, &got);
        r->mismatches += memcmp(&got, &wanted[s], sizeof got) != 0;
        r->compared++;
    }
    r->mismatches += memcmp(&o->t_low, &low[t], sizeof low[t]) != 0;
    r->compared++;
    return status;
}

static fp3_status look(const fp3_model *model, const fp3_compiled *c, fp3_engine *engine, row *r,
                       fp3_error *error) {
    fp3_status status = FP3_OK;
    for (size_t i = 0; !status && i < fp3_engine_objects(engine); i++) {
        fp3_adaptive_object o;
        status = fp3_adaptive_look(engine, i, &o);
        if (!status && !fp3_adaptive_is_over(o.end) && !r->failure[0])
            fp3_adaptive_text(i, &o, r->failure);
        if (!status)
            status = compare_object(model, c, engine, i, &o, r, error);
    }
    return status;
}

static fp3_status take(const comparison *k, fp3_engine *engine, row *r) {
    fp3_adaptive_object o;
    float states[VALUES] = {0};
    fp3_status status = fp3_adaptive_look(engine, 0, &o);
    for (uint32_t s = 0; !status && s < k->model->state_count; s++)
        status = fp3_engine_get(engine, 0, k->model->states[s].name, &states[s]);
    r->accepted = o.accepted;
    r->rejected = o.rejected;
    r->error = distance(k, states);
    return status;
}

static fp3_status run(const comparison *k, const fp3_model *model, const fp3_compiled *c,
                      int machine, int which, row *r, fp3_error *error) {
    fp3_engine_def def = fp3_engine_default();
    fp3_engine *engine = NULL;
    fp3_stats stats = {0};
    def.config = machines[machine];
    def.engine = engine_names[which];
    def.is_interpreted = 1;
    def.error = error;
    fp3_status status = fp3_engine_open(&def, &engine);
    if (!status)
        status = fp3_bench_start(engine, c, model, model->step, fp3_engine_objects(engine), error);
    if (!status)
        status = fp3_adaptive_run(engine, FP3_ADAPTIVE_ATTEMPTS, &stats);
    if (!status && machine == SINGLE && which == ISA)
        status = take(k, engine, r);
    if (!status && which == (k->def->is_quick ? ISA : RTL))
        r->cycles[machine] =
            (double)stats.counter[FP3_COUNTER_CYCLES] / (double)fp3_engine_objects(engine);
    if (!status)
        status = look(model, c, engine, r, error);
    fp3_engine_close(&engine);
    return status;
}

static fp3_status make_row(const comparison *k, const fp3_integrator *integrator,
                           fp3_arithmetic arithmetic, double tolerance, row *r, fp3_error *error) {
    fp3_model *model = NULL;
    *r = (row){.error = NAN};
    fp3_status status = adapt(k, tolerance, &model, error);
    for (int machine = 0; !status && machine < MACHINES; machine++) {
        fp3_compiled *c = NULL;
        status = compile(model, integrator, machine, arithmetic, &c, error);
        for (int i = 0; !status && i < (k->def->is_quick ? 1 : ENGINES); i++)
            status = run(k, model, c, machine, i, r, error);
        fp3_compiled_free(&c);
    }
    fp3_model_free(&model);
    return status;
}

/* ---- rows ---- */

static json_t *fixed_of(const comparison *k, int machine, const char *name, const row *r) {
    unsigned rung = 0;
    const rival *of = find_rival(k, machine, name, r->error, &rung);
    json_t *fixed = json_null();
    if (!name)
        printf(" | %-9s", of ? of->name : "none");
    if (of) {
        printf(" %7" PRIu64 " %6.1f", k->steps[rung],
               of->cycles[machine][rung] / r->cycles[machine]);
        fixed = json_pack("{s:s, s:I, s:o, s:o, s:o}", "integrator", of->name, "steps",
                          (json_int_t)k->steps[rung], "error", fp3_json_number(of->error[rung]),
                          "cycles", fp3_json_number(of->cycles[machine][rung]), "ratio",
                          fp3_json_number(of->cycles[machine][rung] / r->cycles[machine]));
    } else
        printf(" %7s %6s", "-", "-");
    return fixed;
}

/* The cheapest of all, then the integrator itself. */
static void put_fixed(const comparison *k, int machine, const char *name, const row *r, json_t *o) {
    char key[FP3_NAME_SIZE + 16];
    json_object_set_new(o, machines[machine], fp3_json_number(r->cycles[machine]));
    snprintf(key, sizeof key, "%s_fixed", machines[machine]);
    json_object_set_new(o, key, fixed_of(k, machine, NULL, r));
    snprintf(key, sizeof key, "%s_own", machines[machine]);
    json_object_set_new(o, key, fixed_of(k, machine, name, r));
}

static void put_row(comparison *k, const fp3_integrator *integrator, fp3_arithmetic arithmetic,
                    double tolerance, const row *r) {
    const char *name = fp3_arithmetic_of(arithmetic)->name;
    json_t *o =
        json_pack("{s:s, s:s, s:s, s:o, s:o, s:I, s:I, s:I, s:I}", "model", k->model->name,
                  "integrator", integrator->name, "arithmetic", name, "tolerance",
                  fp3_json_number(tolerance), "error", fp3_json_number(r->error), "accepted",
                  (json_int_t)r->accepted, "rejected", (json_int_t)r->rejected, "mismatches",
                  (json_int_t)r->mismatches, "compared", (json_int_t)r->compared);
    fp3_progress_pause(k->def->progress);
    printf("%-12s %-12s %-11s %8.1e %8.1e %7" PRIu32 " %7" PRIu32 " %9.0f %9.0f", k->model->name,
           integrator->name, name, tolerance, r->error, r->accepted, r->rejected, r->cycles[SINGLE],
           r->cycles[MANY]);
    for (int machine = 0; machine < MACHINES; machine++)
        put_fixed(k, machine, integrator->name, r, o);
    printf(" | %" PRIu64 " of %" PRIu64 "%s%s\n", r->mismatches, r->compared,
           r->failure[0] ? "; failed: " : "", r->failure);
    fflush(stdout);
    fp3_progress_resume(k->def->progress);
    if (r->failure[0])
        json_object_set_new(o, "failed", json_string(r->failure));
    json_array_append_new(k->rows, o);
    k->mismatches += r->mismatches;
    if (r->failure[0] && !k->failure.text[0])
        fp3_fail(&k->failure, FP3_E_FAILED, "%s: %s", integrator->name, r->failure);
}

/* Calls what is to be done with each integrator. */
typedef fp3_status each_fn(comparison *k, const fp3_integrator *integrator,
                           fp3_arithmetic arithmetic, fp3_error *error);

static fp3_status compare_pair(comparison *k, const fp3_integrator *integrator,
                               fp3_arithmetic arithmetic, fp3_error *error) {
    fp3_status status = FP3_OK;
    for (unsigned i = 0; !status && integrator->embedded_order && i < k->def->tolerance_count;
         i++) {
        const double tolerance = k->def->tolerances[i];
        row r;
        fp3_progress_say(k->def->progress, "%s, %g", integrator->name, tolerance);
        status = make_row(k, integrator, arithmetic, tolerance, &r, error);
        if (!status)
            put_row(k, integrator, arithmetic, tolerance, &r);
    }
    return status;
}

static int is_default(const fp3_integrator *integrator) {
    return integrator->embedded_order || !strcmp(integrator->name, "rk4") ||
           !strcmp(integrator->name, "rk6");
}

static fp3_status for_each(comparison *k, each_fn *each, fp3_arithmetic arithmetic,
                           fp3_error *error) {
    const fp3_compare_adaptive_def *def = k->def;
    fp3_status status = FP3_OK;
    for (unsigned i = 0; !status; i++) {
        const char *name = !def->integrator_count      ? fp3_integrator_name(i)
                           : i < def->integrator_count ? def->integrators[i]
                                                       : NULL;
        fp3_integrator *integrator = NULL;
        if (!name)
            break;
        status = fp3_integrator_find(name, &integrator, error);
        if (!status && (def->integrator_count || is_default(integrator)))
            status = each(k, integrator, arithmetic, error);
        fp3_integrator_free(&integrator);
    }
    return status;
}

static fp3_status compare(comparison *k, fp3_error *error) {
    fp3_progress_say(k->def->progress, "the reference");
    fp3_status status = find_truth(k, error);
    for (double n = FIRST_STEPS; n <= (double)k->def->most_steps && k->rungs < RUNGS; n *= sqrt(2))
        k->steps[k->rungs++] = (uint64_t)round(n);
    if (!status)
        printf("%-12s %-12s %-11s %8s %8s %7s %7s %9s %9s | %-39s | %-39s | %s\n", "model",
               "integrator", "arithmetic", "toleran.", "error", "steps", "reject.", "single",
               "many", "single: fixed steps, ratio; its own", "many: fixed steps, ratio; its own",
               "mismatches");
    for (int i = FP3_PLAIN; !status && i <= FP3_COMPENSATED; i++) {
        k->rival_count = 0;
        fp3_progress_say(k->def->progress, "fixed steps");
        status = for_each(k, add_rival, (fp3_arithmetic)i, error);
        if (!status)
            status = for_each(k, compare_pair, (fp3_arithmetic)i, error);
    }
    if (!status && k->mismatches)
        status = fp3_fail(error, FP3_E_MISMATCH, "%" PRIu64 " words do not agree", k->mismatches);
    if (!status && k->failure.text[0])
        status = fp3_fail(error, FP3_E_FAILED, "%s", k->failure.text);
    return status;
}

void fp3_compare_adaptive_read(fp3_compare_adaptive_def *def, struct argp_state *state,
                               const char *text) {
    for (const char *at = text;; at++) {
        char *end = NULL;
        const double tolerance = strtod(at, &end);
        if (end == at || !(tolerance > 0 && tolerance <= 1) || (*end && *end != ','))
            argp_error(state, "--tolerance: found '%s', expected numbers above 0 up to 1", text);
        if (def->tolerance_count == FP3_TOLERANCES_MAX)
            argp_error(state, "--tolerance: found more than %d", FP3_TOLERANCES_MAX);
        def->tolerances[def->tolerance_count++] = tolerance;
        at = end;
        if (!*at)
            return;
    }
}

fp3_status fp3_compare_adaptive(const fp3_compare_adaptive_def *def, const char *path, json_t *rows,
                                fp3_error *error) {
    char *report = NULL;
    comparison *k = calloc(1, sizeof *k);
    if (!k)
        return fp3_no_memory(error);
    k->def = def;
    k->path = path;
    k->rows = rows;
    fp3_status status = fp3_model_load(path, &k->model, &report, error);
    if (!status)
        status = fp3_model_check_alone(k->model, error);
    if (!status)
        status = compare(k, error);
    free(report);
    fp3_model_free(&k->model);
    free(k);
    return status;
}
