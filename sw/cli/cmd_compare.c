/* SPDX-License-Identifier: Apache-2.0 */
/* cmd_compare.c - fp3 compare: integrators on a model, by order, floor, cycles and agreement; or a
 * scene beside its truth. */
#include "arguments.h"
#include "bench_scene.h"
#include "cli.h"
#include "compare_adaptive.h"
#include "compare_scene.h"
#include "files.h"
#include "json.h"
#include "lab/bench/variants.h"
#include "progress.h"

#include <fp3/convergence.h>
#include <fp3/engine.h>
#include <fp3/truth.h>
#include <inttypes.h>
#include <jansson.h>
#include <machine/config.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define INTEGRATORS_MAX 64
#define SHORT_RUN 3 /* steps of the runs that agreement and cycles are measured by */
#define LONG_RUN 11

/* One object, many, and sixteen contexts. */
static const char *const machines[] = {"many_full", "single_full", "sixteen"};
enum { MACHINES = sizeof machines / sizeof *machines };

/* The hardware is the first: its cycles are measured. */
enum { RTL, ISA, FAST, ENGINES };
static const char *const engine_names[ENGINES] = {"rtl", "isa", "fast"};

typedef struct {
    const char *model, *json;
    const char *integrators[INTEGRATORS_MAX];
    unsigned integrator_count;
    double span;
    uint64_t most_steps;
    int is_quick, has_errors, is_model, is_native;
    unsigned arithmetics; /* a set; 0: all */
    fp3_compare_adaptive_def adaptive;
    fp3_compare_scene scene;
    const char *not_for[2]; /* the last option that a form does not have, by its long name */
} options;

/* The forms, and which options each has. */
typedef enum { OF_MODEL = 1, OF_SCENE = 2 } form;

typedef struct {
    double cycles, bound, measured; /* per object-step */
    uint32_t instructions, operations;
} cost;

typedef struct {
    cost on[MACHINES];
    fp3_convergence c;
    unsigned order;
    uint64_t mismatches, compared;
    char failure[FP3_FAILURE_TEXT_SIZE]; /* how an object first failed on a machine; "": none */
} row;

typedef struct {
    const options *o;
    const fp3_model *model;
    fp3_ladder *ladder;
    fp3_engine *engines[MACHINES][ENGINES];
    json_t *rows, *left_out;
    unsigned wrong;         /* rows with mismatches */
    fp3_error failure;      /* of the first row in which objects failed */
    fp3_error no_reference; /* why there is no ladder; "": there is */
    fp3_progress *progress;
} comparison;

/* ---- agreement and cycles ---- */

static fp3_status open_engines(comparison *k, fp3_error *error) {
    fp3_status status = FP3_OK;
    for (int i = 0; !status && i < MACHINES * ENGINES; i++) {
        fp3_engine_def def = fp3_engine_default();
        fp3_engine *rtl = k->engines[i / ENGINES][RTL];
        def.config = machines[i / ENGINES];
        def.engine = engine_names[i % ENGINES];
        def.objects = rtl ? (uint32_t)fp3_engine_objects(rtl) : 0;
        def.is_interpreted = !k->o->is_native;
        def.error = error;
        status = fp3_engine_open(&def, &k->engines[i / ENGINES][i % ENGINES]);
    }
    return status;
}

static void close_engines(comparison *k) {
    for (int i = 0; i < MACHINES * ENGINES; i++)
        fp3_engine_close(&k->engines[i / ENGINES][i % ENGINES]);
}

static fp3_status note_failure(comparison *k, int machine, row *r) {
    fp3_engine *engine = k->engines[machine][ISA];
    fp3_failure failure;
    fp3_status status = fp3_engine_failure(engine, 0, fp3_engine_objects(engine), &failure);
    if (!status && failure.failed && !r->failure[0])
        fp3_engine_failure_text(engine, &failure, r->failure);
    return status;
}

static void count(row *r, float got, float wanted) {
    r->mismatches += memcmp(&got, &wanted, sizeof got) != 0;
    r->compared++;
}

/* What one object ends with on one machine, on all engines, against the reference. */
static fp3_status compare_object(comparison *k, const fp3_compiled *c, int machine, size_t object,
                                 uint64_t steps, row *r, fp3_error *error) {
    const fp3_model *model = k->model;
    double params[64 + 1], initial[64 + 1];
    float wanted[64 + 1] = {0}, low[64 + 1] = {0};
    fp3_bench_variant(model, object, params, initial);
    fp3_status status = fp3_compiled_reference_pairs(c, params, initial, model->step, &steps, 1,
                                                     wanted, low, error);
    for (uint32_t s = 0; !status && s < model->state_count; s++) {
        if (!fp3_image_find(c->image, model->states[s].name, FP3_CLASS(FP3_SYMBOL_STATE)))
            continue;
        for (int i = 0; !status && i < ENGINES; i++) {
            float got = 0;
            status = fp3_engine_get(k->engines[machine][i], object, model->states[s].name, &got);
            count(r, got, wanted[s]);
            if (!status && fp3_compiled_low(c, s) >= 0) {
                status = fp3_engine_read(k->engines[machine][i], object, 1,
                                         (uint32_t)fp3_compiled_low(c, s), &got);
                count(r, got, low[s]);
            }
        }
    }
    return status;
}

static fp3_status run(comparison *k, const fp3_compiled *c, int machine, uint64_t steps,
                      uint64_t *cycles, row *r, fp3_error *error) {
    fp3_engine **engines = k->engines[machine];
    fp3_status status = FP3_OK;
    fp3_stats stats;
    for (int i = 0; !status && i < ENGINES; i++) {
        status = fp3_bench_start(engines[i], c, k->model, k->model->step,
                                 fp3_engine_objects(engines[i]), error);
        if (!status)
            status = fp3_engine_run(engines[i], steps, &stats);
        if (i == RTL && !status)
            *cycles = stats.counter[FP3_COUNTER_CYCLES];
    }
    for (size_t i = 0; !status && i < fp3_engine_objects(engines[RTL]); i++)
        status = compare_object(k, c, machine, i, steps, r, error);
    return status;
}

static fp3_status measure(comparison *k, const fp3_compiled *c, int machine, row *r,
                          fp3_error *error) {
    uint64_t brief = 0, lasting = 0;
    fp3_status status = run(k, c, machine, SHORT_RUN, &brief, r, error);
    if (!status)
        status = run(k, c, machine, LONG_RUN, &lasting, r, error);
    if (!status)
        status = note_failure(k, machine, r);
    if (status)
        return status;
    r->on[machine].measured = (double)(lasting - brief) / (LONG_RUN - SHORT_RUN) /
                              (double)fp3_engine_objects(k->engines[machine][RTL]);
    return FP3_OK;
}

/* ---- rows ---- */

static const fp3_convergence no_convergence = {
    .order = NAN, .method_order = NAN, .finest_order = NAN, .floor = NAN, .largest_floor = NAN};

static fp3_status make_row(comparison *k, const fp3_integrator *integrator,
                           fp3_arithmetic arithmetic, row *r, fp3_error *error) {
    fp3_status status = FP3_OK;
    *r = (row){.c = no_convergence};
    for (int i = 0; !status && i < MACHINES; i++) {
        fp3_compile_def def = fp3_compile_default();
        fp3_compiled *c = NULL;
        def.config = machines[i];
        def.arithmetic = arithmetic;
        status = fp3_compile(k->model, integrator, &def, &c, error);
        if (status)
            break;
        if (i == 0 && arithmetic == FP3_PLAIN && c->warning)
            printf("%-16s %-20s warning: %s\n", k->model->name, integrator->name, c->warning);
        r->on[i] = (cost){.cycles = c->cycles,
                          .bound = c->bound,
                          .instructions = c->instructions,
                          .operations = c->operations};
        r->order = c->order;
        if (i == 0 && k->ladder)
            status = fp3_converge(k->ladder, c, c->order, &r->c, error);
        if (!status && !k->o->is_quick)
            status = measure(k, c, i, r, error);
        fp3_compiled_free(&c);
    }
    return status;
}

/* Steps over the span, and the error of each, up to where only noise is left. Of a run that fails
 * the error is null. */
static json_t *errors_of(const comparison *k, const row *r) {
    json_t *steps = json_array(), *errors = json_array(), *largest = json_array();
    unsigned count = k->ladder ? k->ladder->count : 0;
    while (count && isnan(r->c.noise[count - 1]))
        count--;
    for (unsigned i = 0; i < count; i++) {
        json_array_append_new(steps, json_integer((json_int_t)k->ladder->steps[i]));
        json_array_append_new(errors, fp3_json_number(r->c.error[i]));
        json_array_append_new(largest, fp3_json_number(r->c.largest[i]));
    }
    return json_pack("{s:o, s:o, s:o}", "steps", steps, "error", errors, "largest", largest);
}

static void put_row(comparison *k, const fp3_integrator *integrator, fp3_arithmetic arithmetic,
                    const row *r) {
    json_t *o = json_pack(
        "{s:s, s:s, s:s, s:I, s:I, s:o, s:o, s:I, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:I, s:I}",
        "model", k->model->name, "integrator", integrator->name, "arithmetic",
        fp3_arithmetic_of(arithmetic)->name, "operations", (json_int_t)r->on[0].operations,
        "instructions", (json_int_t)r->on[0].instructions, "cycles_per_object_step",
        fp3_json_number(r->on[0].cycles), "bound", fp3_json_number(r->on[0].bound), "order",
        (json_int_t)r->order, "measured_order", fp3_json_number(r->c.order), "method_order",
        fp3_json_number(r->c.method_order), "finest_order", fp3_json_number(r->c.finest_order),
        "floor", fp3_json_number(r->c.floor), "floor_h",
        fp3_json_number(k->ladder ? k->ladder->h[r->c.best] : NAN), "largest",
        fp3_json_number(r->c.largest_floor), "largest_h",
        fp3_json_number(k->ladder ? k->ladder->h[r->c.largest_best] : NAN), "mismatches",
        (json_int_t)r->mismatches, "compared", (json_int_t)r->compared);
    for (int i = 0; i < MACHINES; i++)
        json_object_set_new(o, machines[i],
                            json_pack("{s:I, s:o, s:o, s:o}", "instructions",
                                      (json_int_t)r->on[i].instructions, "predicted",
                                      fp3_json_number(r->on[i].cycles), "measured",
                                      fp3_json_number(r->on[i].measured), "bound",
                                      fp3_json_number(r->on[i].bound)));
    if (r->failure[0])
        json_object_set_new(o, "failed", json_string(r->failure));
    if (k->o->has_errors)
        json_object_set_new(o, "errors", errors_of(k, r));
    json_array_append_new(k->rows, o);
    fp3_progress_pause(k->progress);
    printf("%-16s %-20s %-13s %5" PRIu32 " %5" PRIu32
           " %8.2f %8.2f %8.2f %5u %8.2f %6.2f %6.2f %9.1e %9.1e %" PRIu64 " of %" PRIu64 "%s%s\n",
           k->model->name, integrator->name, fp3_arithmetic_of(arithmetic)->name,
           r->on[0].operations, r->on[0].instructions, r->on[0].cycles, r->on[1].cycles,
           r->on[1].bound, r->order, r->c.order, r->c.method_order, r->c.finest_order, r->c.floor,
           r->c.largest_floor, r->mismatches, r->compared, r->failure[0] ? "; failed: " : "",
           r->failure);
    fflush(stdout);
    fp3_progress_resume(k->progress);
}

static void leave_out(comparison *k, const char *integrator, fp3_arithmetic arithmetic,
                      const char *why) {
    json_array_append_new(k->left_out, json_pack("{s:s, s:s, s:s, s:s}", "model", k->model->name,
                                                 "integrator", integrator, "arithmetic",
                                                 fp3_arithmetic_of(arithmetic)->name, "why", why));
    fp3_progress_pause(k->progress);
    printf("%-16s %-20s %-13s left out: %s\n", k->model->name, integrator,
           fp3_arithmetic_of(arithmetic)->name, why);
    fflush(stdout);
    fp3_progress_resume(k->progress);
}

static fp3_status compare_integrator(comparison *k, const char *name, fp3_error *error) {
    fp3_integrator *integrator = NULL;
    fp3_status status = fp3_integrator_find(name, &integrator, error);
    for (int i = 0; !status && i < FP3_ARITHMETICS; i++) {
        const fp3_arithmetic arithmetic = (fp3_arithmetic)i;
        row r;
        fp3_error why;
        if (!fp3_arithmetic_applies(arithmetic, integrator, 0) ||
            (k->o->arithmetics && !(k->o->arithmetics >> i & 1)))
            continue;
        fp3_progress_say(k->progress, "%s, %s", name, fp3_arithmetic_of(arithmetic)->name);
        const fp3_status made = make_row(k, integrator, arithmetic, &r, &why);
        if (made == FP3_E_PROGRAM || made == FP3_E_LIMIT)
            leave_out(k, name, arithmetic, why.text);
        else if (made)
            status = fp3_fail(error, made, "%s", why.text);
        else {
            put_row(k, integrator, arithmetic, &r);
            k->wrong += r.mismatches != 0;
            if (r.failure[0] && !k->failure.text[0])
                fp3_fail(&k->failure, FP3_E_FAILED, "%s, %s: %s", name,
                         fp3_arithmetic_of(arithmetic)->name, r.failure);
        }
    }
    fp3_integrator_free(&integrator);
    return status;
}

static fp3_status write_json(const comparison *k, fp3_error *error) {
    json_t *all = json_pack("{s:O, s:O}", "rows", k->rows, "left_out", k->left_out);
    if (all && k->no_reference.text[0])
        json_object_set_new(all, "no_reference", json_string(k->no_reference.text));
    return fp3_json_write(k->o->json, all, 9, error);
}

/* Cycles and agreement need no reference; orders and errors do. */
static fp3_status open_ladder(comparison *k, fp3_error *error) {
    fp3_progress_say(k->progress, "the reference");
    const fp3_status status =
        fp3_ladder_open(k->model, k->o->span, k->o->most_steps, &k->ladder, error);
    if (status != FP3_E_ARGUMENT && status != FP3_E_MISMATCH)
        return status;
    k->no_reference = *error;
    fp3_progress_pause(k->progress);
    printf("%s: no reference, so no measured order and no error (nan): %s\n", k->model->name,
           error->text);
    fflush(stdout);
    fp3_progress_resume(k->progress);
    return FP3_OK;
}

/* What the rows themselves say, once all of them are there. */
static fp3_status judge(const comparison *k, fp3_error *error) {
    if (k->wrong)
        return fp3_fail(error, FP3_E_MISMATCH, "%u rows do not agree bit for bit", k->wrong);
    if (k->failure.text[0])
        return fp3_fail(error, FP3_E_FAILED, "%s", k->failure.text);
    if (k->no_reference.text[0])
        return fp3_fail(error, FP3_E_FAILED, "no reference: %s", k->no_reference.text);
    return FP3_OK;
}

static fp3_status compare_adaptive(const comparison *k, fp3_error *error) {
    const options *o = k->o;
    fp3_compare_adaptive_def def = o->adaptive;
    def.span = o->span;
    def.most_steps = o->most_steps;
    def.is_quick = o->is_quick;
    def.integrators = o->integrators;
    def.integrator_count = o->integrator_count;
    def.progress = k->progress;
    fp3_error why;
    const fp3_status status = fp3_compare_adaptive(&def, o->model, k->rows, &why);
    const int has_rows = !status || status == FP3_E_MISMATCH || status == FP3_E_FAILED;
    const fp3_status written = o->json && has_rows ? write_json(k, error) : FP3_OK;
    return status ? fp3_fail(error, status, "%s", why.text) : written;
}

static fp3_status compare(comparison *k, fp3_error *error) {
    const options *o = k->o;
    if (o->adaptive.tolerance_count)
        return compare_adaptive(k, error);
    fp3_status status = open_ladder(k, error);
    if (!status && !o->is_quick)
        status = open_engines(k, error);
    if (!status)
        printf("%-16s %-20s %-13s %5s %5s %8s %8s %8s %5s %8s %6s %6s %9s %9s %s\n", "model",
               "integrator", "arithmetic", "ops", "instr", "many", "single", "bound", "order",
               "measured", "double", "finest", "floor", "largest", "mismatches");
    for (unsigned i = 0; !status && o->integrator_count && i < o->integrator_count; i++)
        status = compare_integrator(k, o->integrators[i], error);
    for (unsigned i = 0; !status && !o->integrator_count && fp3_integrator_name(i); i++)
        status = compare_integrator(k, fp3_integrator_name(i), error);
    if (!status && o->json)
        status = write_json(k, error);
    close_engines(k);
    fp3_ladder_close(&k->ladder);
    return status ? status : judge(k, error);
}

/* ---- the command ---- */

static void take_arithmetic(void *user, struct argp_state *state, char *text) {
    options *o = user;
    o->arithmetics |= 1u << fp3_arguments_arithmetic_named(state, text);
}

static void take_tolerance(void *user, struct argp_state *state, char *text) {
    options *o = user;
    fp3_compare_adaptive_read(&o->adaptive, state, text);
}

/* An option that only one form has. */
static void note_option(void *user, const fp3_option *option) {
    options *o = user;
    for (unsigned k = 0; k < 2; k++)
        if (option->forms && !(option->forms & 1u << k))
            o->not_for[k] = option->name;
}

static void end(void *user, struct argp_state *state) {
    options *o = user;
    if (!o->model)
        argp_error(state, "expected a model (*.ode) or a scene (*.scene)");
    const int is_scene = !o->is_model && fp3_bench_is_scene(o->model);
    if (o->not_for[is_scene])
        argp_error(state, "found --%s and '%s': it is of the other form, fp3 compare %s",
                   o->not_for[is_scene], o->model, is_scene ? "MODEL" : "SCENE");
    if (!is_scene) {
        fp3_arguments_model(state, o->model, o->is_model);
        return;
    }
    o->scene.path = o->model;
    o->scene.json = o->json;
}

static const fp3_option table[] = {
    {"model", 0, NULL, "MODEL is a model, whatever its name", FP3_FLAG(options, is_model),
     .forms = OF_MODEL},
    {"integrator", 'i', "NAME",
     "Compare this integrator, a built-in table or a file; may be repeated (default: all built-in "
     "tables)",
     FP3_LIST(options, integrators, integrator_count, INTEGRATORS_MAX), .is_repeated = 1,
     .forms = OF_MODEL},
    {"arithmetic", 0, "NAME",
     "Compare this arithmetic: plain, compensated, folded or double_single; may be repeated "
     "(default: all)",
     FP3_CALL(take_arithmetic), .is_repeated = 1, .forms = OF_MODEL},
    {"json", 0, "FILE", "Also write the rows as JSON", FP3_TEXT(options, json)},
    {"errors", 0, NULL, "With --json: also write the error at each time step",
     FP3_FLAG(options, has_errors), .forms = OF_MODEL},
    {"span", 0, "TIME", "Integrate from 0 to TIME (default: the model's span)",
     FP3_ABOVE_ZERO(options, span), .forms = OF_MODEL},
    {"most-steps", 0, "N", "The finest time step is span/N (default 131072)",
     FP3_NUMBER(options, most_steps, FP3_LOOKS, FP3_STEPS_MOST), .forms = OF_MODEL},
    {"quick", 0, NULL, "Run no hardware: predict cycles, and do not check that engines agree",
     FP3_FLAG(options, is_quick), .forms = OF_MODEL},
    {"tolerance", 0, "TOL1,TOL2,...",
     "Compare adaptive steps with these tolerances to the cheapest fixed steps that are as "
     "accurate (default integrators: rk4, rk6 and all with an error estimate)",
     FP3_CALL(take_tolerance), .forms = OF_MODEL},
    {"native", 0, NULL,
     "Let engine fast compile native code; for these runs it costs more than it saves",
     FP3_FLAG(options, is_native), .forms = OF_MODEL},
    {"config", 'c', "NAME", "With SCENE: compile for this configuration (default: the scene's)",
     FP3_TEXT(options, scene.config), .forms = OF_SCENE},
    {"steps", 'n', "N", "With SCENE: its first N steps (default: all)",
     FP3_NUMBER(options, scene.steps, 1, FP3_STEPS_LIMIT), .forms = OF_SCENE},
    {"halvings", 0, "N", "With SCENE: also run it with h/2 .. h/2^N (default: 2)",
     FP3_NUMBER(options, scene.halvings, 0, 10), .forms = OF_SCENE},
    {"within", 0, "SHARE",
     "With SCENE: two lengths of step have to agree within this share of a state's size, or there "
     "is no solution (default: 1e-6)",
     FP3_ABOVE_ZERO(options, scene.within), .forms = OF_SCENE},
    {"work", 0, "N",
     "With SCENE: compute at most N numbers for the solution, some 10^9 in a second (default: "
     "1e10)",
     FP3_ABOVE_ZERO(options, scene.work), .forms = OF_SCENE},
    {"states", 0, "FILE",
     "With SCENE: also write as CSV where the objects are at these times: by engine fast, by the "
     "method in double, and by the solution",
     FP3_TEXT(options, scene.states), .forms = OF_SCENE},
    {"csv", 0, "FILE", "With SCENE: also write the rows as CSV", FP3_TEXT(options, scene.csv),
     .forms = OF_SCENE},
    {0},
};

static fp3_status check_files(const options *o, fp3_error *error) {
    fp3_files files = {0};
    fp3_files_read(&files, "MODEL", o->model);
    for (unsigned i = 0; i < o->integrator_count; i++)
        fp3_files_read(&files, "--integrator", fp3_cli_integrator_file(o->integrators[i]));
    fp3_files_write(&files, "--json", o->json);
    return fp3_files_check(&files, error);
}

int fp3_cmd_compare(int argc, char **argv) {
    static const fp3_command command = {
        .options = table,
        FP3_WORD(options, model, "model"),
        .given = note_option,
        .end = end,
        .forms = "MODEL\nSCENE",
        .doc = "Compares integrators on MODEL (*.ode) in FP32. A row has the operations and "
               "instructions of a step, its cycles with many objects and with one, the order, the "
               "smallest error that any time step reaches (`floor`: relative, the root mean square "
               "over all states at 8 times; `largest`: that of the worst state, after each step or "
               "at 1,024 times and more, as for fp3 tune), and the words in which hardware, isa "
               "engine and equations differ. The exit code is 1 if any differ, 3 if objects failed "
               "or have no reference; rows are printed in each case.\v"
               "With SCENE (a path that ends in .scene), measures how far engine fast is from the "
               "truth of the scene, whose objects may see each other: what FP32 costs, beside the "
               "same steps in double; what the method costs, beside the solution; and both "
               "together. A row is of one state, with one time step. The exit code is 3 if "
               "objects failed, or if there is no solution up to the end, as of chaotic motion."};
    options o = {.most_steps = 131072, .scene = {.halvings = 2}};
    fp3_arguments_parse(&command, argc, argv, &o);
    fp3_error error;
    if (o.scene.path) {
        const fp3_status ended = fp3_compare_scene_run(&o.scene, &error);
        return fp3_cli_end("compare", ended, &error, NULL);
    }
    fp3_model *model = NULL;
    char *text = NULL;
    fp3_status status = check_files(&o, &error);
    if (!status)
        status = fp3_model_load(o.model, &model, &text, &error);
    if (!status)
        status = fp3_model_check_alone(model, &error);
    comparison k = {.o = &o, .model = model, .rows = json_array(), .left_out = json_array()};
    if (!status) {
        k.progress = fp3_progress_begin("compare", NULL);
        status = compare(&k, &error);
        fp3_progress_end(&k.progress);
    }
    const int exit_code = fp3_cli_end("compare", status, &error, text);
    json_decref(k.rows);
    json_decref(k.left_out);
    free(text);
    fp3_model_free(&model);
    return exit_code;
}
