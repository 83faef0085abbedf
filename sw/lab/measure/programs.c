/* SPDX-License-Identifier: Apache-2.0 */
/* programs.c - programs of fp3 on its own engines: the points, and that all engines agree.
 *
 * Fixed time steps are span/1, span/2, span/4, span/8, ..., rounded once: what that moves
 * the end is part of the error. With events they are also cut there. Adaptive ones have tolerances
 * 10^-2, 10^-3, ... A short run says which are worth a point.
 */
#include "programs.h"

#include "run.h"

#include <fp3/compile.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define CONFIG "many_full" /* unless another is asked for */
#define CHECKED_STEPS 8    /* of fixed ones, of the runs in which engines are compared */
#define CHECKED_OBJECTS 8  /* of the others, whose runs are whole, on isa */
#define RUNGS_WORSE 2      /* after so many without a smaller error nothing is left but rounding */
#define RUNGS_AFTER 10 /* beyond the first time step that solves it: 1,024 times as many steps */
#define SOLVED 0.1     /* ... if the error was once below this */
#define RUNGS_BEHIND 2 /* after so many in a row that are hopeless ... */
#define RUNGS_FAR 4    /* ... so far beyond that first time step: shorter ones win nothing */
#define ERROR_MOST 0.5
/* Instructions of such runs of a family on one configuration. A run is left out if another one on
 * the same configuration takes FAR times fewer. */
#define HARDWARE_MOST 3e5
#define FAR 4
#define CUTS_MOST 4096 /* attempts to find events, beside steps */
#define PACES_MOST 24

/* Those whose cycles are predicted, and that were placed: docs/results.md has their clocks. */
static const char *const hardware[] = {"many_full", "single_full", "many", "single",
                                       "lanes",     "uncut",       "paper"};
enum { HARDWARE = sizeof hardware / sizeof *hardware };
/* Cycles of adaptive steps and of those that are cut depend on the objects: a run is needed, of the
 * first two alone. */
enum { HARDWARE_ADAPTED = 2 };

/* Fixed steps, fixed ones that are cut at events, and those that objects choose. */
typedef enum { FIXED, CUT, ADAPTIVE, KINDS } steps_kind;

static const char *const suffixes[KINDS] = {"", " cut", " adaptive"};

/* One integrator in one arithmetic, with steps of one kind. */
typedef struct {
    fp3_measure_points *points;
    const fp3_measure_problem *problem;
    const fp3_measure_options *options;
    fp3_measure_machines *machines;
    const char *name; /* of the integrator */
    const fp3_integrator *integrator;
    fp3_arithmetic arithmetic;
    steps_kind kind;
    fp3_model *adapted;                /* NULL: steps are FIXED */
    const char *config;                /* whose program the engines in software run */
    fp3_compiled *compiled;            /* for it */
    fp3_measure_pace pace[PACES_MOST]; /* worth a point, the coarsest first */
    double *ends[PACES_MOST];          /* of the variants, with each */
    double seconds[PACES_MOST];        /* that they took, alone */
    unsigned count;
    fp3_measure_pace brief; /* of the runs in which engines are compared ... */
    double *brief_ends;     /* ... and its ends */
} family;

/* What a point runs. */
typedef struct {
    fp3_measure_run run;
    fp3_measure_pace pace;
} task;

static size_t room(const family *f) {
    return (size_t)f->problem->variants * f->problem->model->state_count + 1;
}

static fp3_status make_ends(const family *f, double **ends, fp3_error *error) {
    *ends = calloc(room(f), sizeof **ends);
    return *ends ? FP3_OK : fp3_no_memory(error);
}

static fp3_measure_run run_of(const family *f, const fp3_compiled *compiled) {
    return (fp3_measure_run){.compiled = compiled, .machines = f->machines, .adapted = f->adapted};
}

/* ---- points ---- */

static fp3_measure_point blank(const family *f, const char *engine, const char *config) {
    return (fp3_measure_point){.engine = engine,
                               .integrator = f->name,
                               .arithmetic = fp3_arithmetic_of(f->arithmetic)->name,
                               .config = config,
                               .problem = f->problem};
}

static void leave_out(const family *f, const char *engine, const char *config, double tolerance,
                      const char *why) {
    fp3_measure_point point = blank(f, engine, config);
    point.tolerance = tolerance;
    fp3_measure_points_leave_out(f->points, &point, why);
}

static fp3_status add(const family *f, fp3_measure_point *point, unsigned i, fp3_error *error) {
    point->tolerance = f->pace[i].tolerance;
    if (f->kind != ADAPTIVE) {
        point->h = f->pace[i].h;
        point->steps = f->pace[i].steps;
    }
    fp3_measure_point *added = fp3_measure_points_add(f->points, point);
    if (!added) {
        free(point->self);
        return fp3_no_memory(error);
    }
    memcpy(added->ends, f->ends[i], (room(f) - 1) * sizeof *added->ends);
    fp3_measure_problem_errors(f->problem, added->ends, &added->error_median, &added->error_worst);
    return FP3_OK;
}

/* What a pace asks of one object. */
static double work_of(const family *f, const fp3_measure_pace *pace) {
    return pace->made * f->compiled->instructions;
}

/* Its ends are known from the sample. */
static fp3_status run(fp3_measure_point *point, double *seconds, fp3_error *error) {
    const fp3_measure_problem *p = point->problem;
    const task *t = point->self;
    fp3_stats stats;
    double *ends = calloc(p->variants * p->model->state_count + 1, sizeof *ends);
    fp3_status status =
        ends ? fp3_measure_run_solve(&t->run, p, &t->pace, ends, seconds, &stats, error)
             : fp3_no_memory(error);
    if (!status)
        status = fp3_measure_run_compare(p, p->variants, ends, "a timed run", point->ends,
                                         "the run of the variants alone", error);
    free(ends);
    return status;
}

static void close_run(fp3_measure_point *point) { free(point->self); }

static fp3_status add_software(const family *f, unsigned i, unsigned threads, fp3_error *error) {
    fp3_measure_point point = blank(f, f->options->engine, NULL);
    task *t = calloc(1, sizeof *t);
    if (!t)
        return fp3_no_memory(error);
    *t = (task){run_of(f, f->compiled), f->pace[i]};
    point.run = run;
    point.close = close_run;
    point.self = t;
    point.threads = threads;
    point.work = work_of(f, &f->pace[i]);
    point.objects = fp3_measure_run_objects(f->options, f->pace[i].made,
                                            f->seconds[i] / f->problem->variants, threads);
    const fp3_status status = fp3_measure_machines_engine(
        f->machines, f->options->engine, f->config, threads, point.objects, &t->run.engine, error);
    if (status)
        free(t);
    return status ? status : add(f, &point, i, error);
}

/* ---- other engines, and hardware ---- */

/* One of them ends with the bits of the engine that is measured. *objects, *cycles: of its run. */
static fp3_status agree(const family *f, const fp3_compiled *compiled, const char *name,
                        const char *config, const fp3_measure_pace *pace, const double *wanted,
                        uint64_t *objects, uint64_t *cycles, fp3_error *error) {
    const size_t variants = f->problem->variants;
    double seconds, *ends;
    fp3_stats stats = {0};
    fp3_measure_run r = run_of(f, compiled);
    fp3_status status = make_ends(f, &ends, error);
    if (!status)
        status = fp3_measure_machines_engine(f->machines, name, config, 1,
                                             !strcmp(name, "rtl") ? 0
                                             : f->adapted         ? CHECKED_OBJECTS
                                                                  : variants,
                                             &r.engine, error);
    if (!status)
        status = fp3_measure_run_solve(&r, f->problem, pace, ends, &seconds, &stats, error);
    *objects = status ? 0 : fp3_engine_objects(r.engine);
    *cycles = stats.counter[FP3_COUNTER_CYCLES];
    if (!status)
        status = fp3_measure_run_compare(f->problem, *objects < variants ? *objects : variants,
                                         wanted, f->options->engine, ends, name, error);
    free(ends);
    return status;
}

/* *compiled is NULL, and the configuration is left out, if it cannot run that. */
static fp3_status compile(const family *f, const char *engine, const char *config,
                          fp3_compiled **compiled, fp3_error *error) {
    fp3_compile_def def = fp3_compile_default();
    def.config = config;
    def.arithmetic = f->arithmetic;
    *compiled = NULL;
    const fp3_status status = fp3_compile(f->adapted ? f->adapted : f->problem->model,
                                          f->integrator, &def, compiled, error);
    if (status == FP3_E_PROGRAM || status == FP3_E_LIMIT) {
        leave_out(f, engine, config, 0, error->text);
        return FP3_OK;
    }
    return status ? status : fp3_measure_machines_keep_program(f->machines, *compiled, error);
}

/* Of fixed steps a short run shows that cycles are what is predicted. */
static fp3_status add_predicted(const family *f, const fp3_compiled *compiled, const char *config,
                                fp3_error *error) {
    uint64_t objects = 0, cycles = 0;
    fp3_measure_point point = blank(f, "rtl", config);
    fp3_status status =
        agree(f, compiled, "rtl", config, &f->brief, f->brief_ends, &objects, &cycles, error);
    const uint64_t predicted = fp3_compiled_cycles(compiled, CHECKED_STEPS);
    if (!status && predicted && predicted != cycles)
        status = fp3_fail(error, FP3_E_MISMATCH,
                          "%" PRIu64 " cycles are predicted on %s, and %" PRIu64 " measured",
                          predicted, config, cycles);
    point.objects = objects;
    for (unsigned i = 0; !status && i < f->count; i++) {
        point.cycles =
            (double)fp3_compiled_cycles(compiled, f->pace[i].count) / (double)point.objects;
        status = add(f, &point, i, error);
    }
    return status;
}

/* Another is as accurate with far fewer cycles. `cycles`: about what a run takes for an object. */
static int is_far(const family *f, const char *config, unsigned i, double cycles) {
    double error, worst;
    fp3_measure_problem_errors(f->problem, f->ends[i], &error, &worst);
    for (size_t k = 0; k < f->points->count; k++) {
        const fp3_measure_point *q = &f->points->point[k];
        if (q->config && !strcmp(q->config, config) && FAR * q->cycles < cycles &&
            q->error_median <= error)
            return 1;
    }
    return 0;
}

/* Cycles of steps whose number depends on the object are measured, where that does not take too
 * long; the coarsest always, for the bits. */
static fp3_status add_measured(const family *f, const fp3_compiled *compiled, const char *config,
                               fp3_error *error) {
    fp3_engine *engine = NULL;
    double spent = 0;
    fp3_status status =
        fp3_measure_machines_engine(f->machines, "rtl", config, 1, 0, &engine, error);
    for (unsigned i = 0; !status && i < f->count; i++) {
        fp3_measure_point point = blank(f, "rtl", config);
        uint64_t cycles = 0;
        const double each = f->pace[i].made * compiled->instructions;
        const double all = each * (double)fp3_engine_objects(engine);
        if (spent + all > HARDWARE_MOST || (i && is_far(f, config, i, each)))
            continue;
        spent += all;
        status = agree(f, compiled, "rtl", config, &f->pace[i], f->ends[i], &point.objects, &cycles,
                       error);
        point.cycles = (double)cycles / (double)point.objects;
        if (!status)
            status = add(f, &point, i, error);
    }
    return status;
}

static fp3_status add_hardware(const family *f, const char *config, fp3_error *error) {
    fp3_compiled *compiled = f->compiled;
    const fp3_status status =
        strcmp(config, f->config) != 0 ? compile(f, "rtl", config, &compiled, error) : FP3_OK;
    if (status || !compiled)
        return status;
    return (f->adapted ? add_measured : add_predicted)(f, compiled, config, error);
}

/* ---- which time steps or tolerances ---- */

/* So many of the last fill the span: no shorter one is left over. */
static double up(double h, uint64_t steps, double end) {
    const float near = (float)h;
    return (double)near * (double)steps < end ? (double)nextafterf(near, INFINITY) : (double)near;
}

/* Work limits runs, and not time: so points do not depend on how fast the machine is, or engine
 * fast in an arithmetic. */
static double most_steps(const family *f) {
    const fp3_measure_options *o = f->options;
    const double step = (double)f->compiled->instructions * f->problem->variants;
    return fmin((double)fp3_measure_steps(o->most_rungs), ceil(o->most_work / step));
}

/* Number k of those that are tried; 0: there are no more. */
static int find_pace(const family *f, unsigned k, fp3_measure_pace *pace) {
    const fp3_measure_options *o = f->options;
    const unsigned digits = o->fewest_digits + k * o->digits_apart;
    const uint64_t steps = fp3_measure_steps(k), most = (uint64_t)most_steps(f);
    const double end = f->problem->end, h = end / (double)steps;
    if (f->kind == ADAPTIVE)
        *pace = (fp3_measure_pace){
            .h = f->problem->model->step, .tolerance = pow(10, -(double)digits), .count = most};
    else if (f->kind == CUT)
        *pace = (fp3_measure_pace){
            .h = up(h, steps, end), .steps = steps, .count = CUTS_MOST + 2 * steps};
    else
        *pace = (fp3_measure_pace){.h = h, .steps = steps, .count = steps};
    return f->kind == ADAPTIVE ? digits <= o->most_digits : steps < most;
}

/* Takes what it is given, or frees it. */
static void keep(family *f, const fp3_measure_pace *pace, double *ends, double seconds) {
    f->pace[f->count] = *pace;
    f->ends[f->count] = ends;
    f->seconds[f->count++] = seconds;
}

/* One run of the variants. *is_over: finer ones are not tried; *is_worth: it is kept. */
static fp3_status try_pace(family *f, const fp3_measure_run *r, fp3_measure_pace *pace,
                           double *ends, double *median, double *seconds, int *is_over,
                           fp3_error *error) {
    fp3_stats stats = {0};
    double worst;
    *median = INFINITY;
    fp3_status status = fp3_measure_run_solve(r, f->problem, pace, ends, seconds, &stats, error);
    *is_over = status != FP3_OK;
    if (f->kind == ADAPTIVE && status == FP3_E_ARGUMENT) /* the arithmetic has no such tolerance */
        return FP3_OK;
    if (f->adapted && status == FP3_E_LIMIT) {
        leave_out(f, f->options->engine, NULL, pace->tolerance,
                  "an object does not come to its end");
        *is_over = f->kind == ADAPTIVE; /* what is cut may, with shorter steps */
        return FP3_OK;
    }
    pace->made =
        f->adapted ? (double)stats.object_steps / f->problem->variants : (double)pace->count;
    if (!status)
        fp3_measure_problem_errors(f->problem, ends, median, &worst);
    return status;
}

/* Of the same arithmetic: others end where theirs has no more digits. */
static int is_hopeless(const family *f, const fp3_measure_pace *pace, double error) {
    const fp3_measure_point point = {.engine = f->options->engine,
                                     .arithmetic = fp3_arithmetic_of(f->arithmetic)->name,
                                     .threads = 1,
                                     .work = work_of(f, pace),
                                     .error_median = error};
    return fp3_measure_points_behind(f->points, &point, 1) > FP3_MEASURE_HOPELESS;
}

/* Those that solve it, up to one beyond the best. */
static fp3_status sample(family *f, fp3_error *error) {
    fp3_measure_run r = run_of(f, f->compiled);
    double best = INFINITY, seconds = 0;
    unsigned worse = 0, behind = 0, first = UINT32_MAX - RUNGS_AFTER;
    int is_over = 0;
    fp3_measure_pace pace;
    r.is_flipped = f->adapted && f->options->is_flipped;
    fp3_status status = fp3_measure_machines_engine(f->machines, f->options->engine, f->config, 1,
                                                    f->problem->variants, &r.engine, error);
    for (unsigned k = 0; !status && !is_over && find_pace(f, k, &pace) && f->count < PACES_MOST;
         k++) {
        double median = INFINITY, *ends;
        if (worse >= RUNGS_WORSE || behind >= RUNGS_BEHIND || k > first + RUNGS_AFTER)
            break;
        status = make_ends(f, &ends, error);
        if (!status)
            status = try_pace(f, &r, &pace, ends, &median, &seconds, &is_over, error);
        worse = f->kind == ADAPTIVE || median < best || best > SOLVED ? 0 : worse + 1;
        best = fmin(best, median);
        if (status || is_over || !(median < ERROR_MOST) || worse >= RUNGS_WORSE) {
            free(ends);
            continue;
        }
        first = f->count ? first : k;
        keep(f, &pace, ends, seconds);
        behind = (f->kind == ADAPTIVE || k >= first + RUNGS_FAR) && is_hopeless(f, &pace, median)
                     ? behind + 1
                     : 0;
    }
    return status;
}

/* ---- all of it ---- */

/* Of fixed steps a few, of the largest that is worth a point; where objects have times of their
 * own, a run of some steps would be none: the shortest. (A ball that bounces wrongly may do so a
 * thousand times.) */
static fp3_status run_brief(family *f, fp3_error *error) {
    fp3_measure_run r = run_of(f, f->compiled);
    fp3_stats stats;
    double seconds;
    unsigned shortest = 0;
    for (unsigned i = 1; f->adapted && i < f->count; i++)
        shortest = f->pace[i].made < f->pace[shortest].made ? i : shortest;
    f->brief = f->pace[shortest];
    if (!f->adapted)
        f->brief.count = CHECKED_STEPS;
    r.is_flipped = f->options->is_flipped;
    fp3_status status = make_ends(f, &f->brief_ends, error);
    if (!status && f->adapted) {
        memcpy(f->brief_ends, f->ends[shortest], room(f) * sizeof *f->brief_ends);
        return FP3_OK;
    }
    if (!status)
        status = fp3_measure_machines_engine(f->machines, f->options->engine, f->config, 1,
                                             f->problem->variants, &r.engine, error);
    if (!status)
        status = fp3_measure_run_solve(&r, f->problem, &f->brief, f->brief_ends, &seconds, &stats,
                                       error);
    return status;
}

static fp3_status add_all(family *f, fp3_error *error) {
    const long cores = sysconf(_SC_NPROCESSORS_ONLN);
    uint64_t objects, cycles;
    fp3_status status = run_brief(f, error);
    if (!status && strcmp(f->options->engine, "isa") != 0)
        status = agree(f, f->compiled, "isa", f->config, &f->brief, f->brief_ends, &objects,
                       &cycles, error);
    if (!status && f->options->config)
        status = add_hardware(f, f->config, error);
    for (int i = 0;
         !status && !f->options->config && i < (f->adapted ? HARDWARE_ADAPTED : HARDWARE); i++)
        status = add_hardware(f, hardware[i], error);
    for (unsigned i = 0; !status && f->options->has_times && i < f->count; i++) {
        status = add_software(f, i, 1, error);
        if (!status && cores > 1 && f->options->has_threads)
            status = add_software(f, i, (unsigned)cores, error);
    }
    return status;
}

static fp3_status add_family(family *f, fp3_error *error) {
    fp3_measure_points_say(f->points, "%s: %s, %s", f->problem->model->name, f->name,
                           fp3_arithmetic_of(f->arithmetic)->name);
    fp3_status status = compile(f, f->options->engine, f->config, &f->compiled, error);
    if (status || !f->compiled)
        return status;
    status = sample(f, error);
    if (!status && f->count)
        status = add_all(f, error);
    if (!status && !f->count && f->kind != ADAPTIVE)
        leave_out(f, f->options->engine, NULL, 0, "no time step that was tried solves it");
    for (unsigned i = 0; i < f->count; i++)
        free(f->ends[i]);
    free(f->brief_ends);
    return status;
}

/* *adapted is NULL: the model cannot have such steps, and is left out. */
static fp3_status adapt(family *f, fp3_error *error) {
    fp3_adaptive_def def = fp3_adaptive_default();
    def.tolerance = f->kind == ADAPTIVE ? 1e-5 : 0;
    def.until = f->problem->end;
    char *name = malloc(strlen(f->name) + 16);
    fp3_model *model = NULL;
    fp3_status status =
        name ? fp3_measure_machines_keep(f->machines, name, error) : fp3_no_memory(error);
    if (status)
        return status;
    sprintf(name, "%s%s", f->name, suffixes[f->kind]);
    f->name = name;
    status = fp3_model_copy(f->problem->model, &model, error);
    if (!status)
        status = fp3_measure_machines_keep_model(f->machines, model, error);
    if (!status)
        status = fp3_model_adapt(model, &def, error);
    f->adapted = status ? NULL : model;
    if (status != FP3_E_PROGRAM)
        return status;
    leave_out(f, f->options->engine, NULL, 0, error->text);
    return FP3_OK;
}

/* With adaptive steps: plain and compensated; docs/command.md says so. h of what is cut is not
 * known beforehand: nothing is folded into it. */
static int is_measured(const fp3_model *model, fp3_arithmetic arithmetic,
                       const fp3_integrator *integrator, steps_kind kind) {
    if (kind == CUT &&
        (!model->event_count || arithmetic == FP3_FOLDED || integrator->kind == FP3_STOERMER))
        return 0;
    return fp3_arithmetic_applies(arithmetic, integrator, kind == ADAPTIVE) &&
           !(kind == ADAPTIVE && arithmetic == FP3_DOUBLE_SINGLE);
}

static fp3_status add_integrator(const family *shared, const char *name, steps_kind kind,
                                 fp3_error *error) {
    fp3_integrator *integrator = NULL;
    fp3_status status = fp3_integrator_find(name, &integrator, error);
    for (int i = 0; !status && i < FP3_ARITHMETICS; i++) {
        family f = *shared;
        f.integrator = integrator;
        f.arithmetic = (fp3_arithmetic)i;
        f.name = name;
        f.kind = kind;
        if (!is_measured(f.problem->model, f.arithmetic, integrator, kind))
            continue;
        if (kind != FIXED)
            status = adapt(&f, error);
        if (!status && (f.adapted || kind == FIXED))
            status = add_family(&f, error);
        if (status) {
            const fp3_error why = *error;
            fp3_fail(error, status, "%s, %s: %s", f.name, fp3_arithmetic_of(f.arithmetic)->name,
                     why.text);
        }
    }
    fp3_integrator_free(&integrator);
    return status;
}

fp3_status fp3_measure_add_programs(fp3_measure_points *points, const fp3_measure_problem *problem,
                                    const fp3_measure_options *options,
                                    fp3_measure_machines *machines, fp3_error *error) {
    const family shared = {.points = points,
                           .problem = problem,
                           .options = options,
                           .machines = machines,
                           .config = options->config ? options->config : CONFIG};
    fp3_status status = FP3_OK;
    const char *name;
    for (int kind = FIXED; kind < KINDS; kind++)
        for (unsigned i = 0; !status && (name = options->integrators ? options->integrators[i]
                                                                     : fp3_integrator_name(i));
             i++)
            status = add_integrator(&shared, name, (steps_kind)kind, error);
    return status;
}
