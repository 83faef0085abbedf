/* engine.c - programs of fp3 on its own engines: the points, and that all engines agree.
 *
 * Time steps are span/1, span/2, span/4, ...: all end at the same time, exactly. A short run of
 * the variants alone says which of them are worth a point.
 */
#include "engine.h"

#include "run.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define CONFIG "many_full" /* whose program the engines in software run */
#define CHECKED_STEPS 8    /* of the runs in which engines are compared */
#define RUNGS_WORSE 2      /* after so many without a smaller error nothing is left but rounding */
#define RUNGS_AFTER 10 /* beyond the first time step that solves it: 1,024 times as many steps */
#define SOLVED 0.1     /* ... if the error was once below this */
#define ERROR_MOST 0.5
#define SAMPLE_SECONDS 0.2 /* the run that finds the error takes no longer */
#define RUNGS_MOST 32

/* Those whose cycles are predicted, and that were placed: docs/results.md has their clocks. */
static const char *const hardware[] = {"many_full", "single_full", "many", "single",
                                       "lanes",     "uncut",       "paper"};
enum { HARDWARE = sizeof hardware / sizeof *hardware };

typedef struct {
    fp3_measure_points *points;
    const fp3_measure_problem *problem;
    const fp3_measure_options *options;
    fp3_measure_machines *machines;
    const char *name; /* of the integrator */
    const fp3_integrator *integrator;
    fp3_arithmetic arithmetic;
    fp3_compiled *compiled;     /* for CONFIG */
    int is_solved;              /* by some time step ... */
    unsigned first;             /* ... of which this is the largest: its rung */
    double *ends[RUNGS_MOST];   /* of the variants; NULL: not worth a point */
    double seconds[RUNGS_MOST]; /* that they took, alone */
    double *brief;              /* after CHECKED_STEPS steps */
} family;

#define ROOM(f) ((f)->problem->variants * (f)->problem->model->state_count + 1)

static double step_of(const fp3_measure_problem *p, unsigned rung) {
    return ldexp(p->end, -(int)rung);
}

/* ---- a timed run ---- */

/* Its ends are known from the sample. */
static fp3_status run(fp3_measure_point *point, double *seconds, fp3_error *error) {
    const fp3_measure_problem *p = point->problem;
    uint64_t cycles;
    double *ends = calloc(p->variants * p->model->state_count + 1, sizeof *ends);
    fp3_status status = ends ? fp3_measure_run_solve(point->self, p, point->h, point->steps, ends,
                                                     seconds, &cycles, error)
                             : fp3_fail(error, FP3_E_SYSTEM, "out of memory");
    if (!status)
        status = fp3_measure_run_compare(p, p->variants, ends, "a timed run", point->ends,
                                         "the run of the variants alone", error);
    free(ends);
    return status;
}

static void close_run(fp3_measure_point *point) { free(point->self); }

/* ---- agreement ---- */

/* CHECKED_STEPS steps of the largest time step that is worth a point. objects: 0: all contexts. */
static fp3_status brief(const family *f, const fp3_compiled *compiled, const char *name,
                        const char *config, uint64_t objects, double *ends, uint64_t *cycles,
                        fp3_error *error) {
    double seconds;
    fp3_measure_run r = {.compiled = compiled,
                         .machines = f->machines,
                         .is_flipped = f->options->is_flipped && !strcmp(name, f->options->engine)};
    fp3_status status =
        fp3_measure_machines_engine(f->machines, name, config, 1, objects, &r.engine, error);
    if (!status)
        status = fp3_measure_run_solve(&r, f->problem, step_of(f->problem, f->first), CHECKED_STEPS,
                                       ends, &seconds, cycles, error);
    return status;
}

/* Another engine ends with the bits of the one that is measured, in the cycles that are predicted. */
static fp3_status agree(const family *f, const fp3_compiled *compiled, const char *name,
                        const char *config, fp3_error *error) {
    const int is_rtl = !strcmp(name, "rtl");
    uint64_t cycles = 0;
    double *ends = calloc(ROOM(f), sizeof *ends);
    fp3_engine *engine = NULL;
    fp3_status status = ends ? brief(f, compiled, name, config, is_rtl ? 0 : f->problem->variants,
                                     ends, &cycles, error)
                             : fp3_fail(error, FP3_E_SYSTEM, "out of memory");
    if (!status)
        status = fp3_measure_machines_engine(f->machines, name, config, 1,
                                             is_rtl ? 0 : f->problem->variants, &engine, error);
    if (!status) {
        const size_t objects = fp3_engine_objects(engine);
        status = fp3_measure_run_compare(
            f->problem, objects < f->problem->variants ? objects : f->problem->variants, f->brief,
            f->options->engine, ends, name, error);
    }
    const uint64_t predicted = is_rtl ? fp3_compiled_cycles(compiled, CHECKED_STEPS) : 0;
    if (!status && predicted && predicted != cycles)
        status = fp3_fail(error, FP3_E_MISMATCH,
                          "%" PRIu64 " cycles are predicted on %s, and %" PRIu64 " measured",
                          predicted, config, cycles);
    free(ends);
    return status;
}

/* ---- which time steps ---- */

/* Fills ends of the rungs that are worth a point: those that solve it, up to one beyond the best. */
static fp3_status sample(family *f, fp3_error *error) {
    const fp3_measure_problem *p = f->problem;
    fp3_measure_run r = {.compiled = f->compiled, .machines = f->machines};
    double best = INFINITY, seconds = 0;
    unsigned worse = 0;
    uint64_t cycles;
    fp3_status status = fp3_measure_machines_engine(f->machines, f->options->engine, CONFIG, 1,
                                                    p->variants, &r.engine, error);
    for (unsigned k = 0;
         !status && k < f->options->most_rungs && worse < RUNGS_WORSE &&
         2 * seconds < SAMPLE_SECONDS && (!f->is_solved || k <= f->first + RUNGS_AFTER);
         k++) {
        double median = INFINITY, worst, *ends = calloc(ROOM(f), sizeof *ends);
        if (!ends)
            return fp3_fail(error, FP3_E_SYSTEM, "out of memory");
        status =
            fp3_measure_run_solve(&r, p, step_of(p, k), 1ull << k, ends, &seconds, &cycles, error);
        if (!status)
            fp3_measure_problem_errors(p, ends, &median, &worst);
        worse = median < best || best > SOLVED ? 0 : worse + 1;
        best = fmin(best, median);
        if (median < ERROR_MOST && worse < RUNGS_WORSE) {
            f->first = f->is_solved ? f->first : k;
            f->is_solved = 1;
            f->ends[k] = ends;
            f->seconds[k] = seconds;
        } else {
            free(ends);
        }
    }
    return status;
}

/* ---- points ---- */

static fp3_measure_point blank(const family *f, const char *engine, const char *config) {
    return (fp3_measure_point){.engine = engine,
                               .integrator = f->name,
                               .arithmetic = fp3_arithmetic_of(f->arithmetic)->name,
                               .config = config,
                               .problem = f->problem};
}

static fp3_status add(const family *f, fp3_measure_point *point, unsigned rung, fp3_error *error) {
    point->h = step_of(f->problem, rung);
    point->steps = 1ull << rung;
    fp3_measure_point *added = fp3_measure_points_add(f->points, point);
    if (!added) {
        free(point->self);
        return fp3_fail(error, FP3_E_SYSTEM, "out of memory");
    }
    memcpy(added->ends, f->ends[rung], (ROOM(f) - 1) * sizeof *added->ends);
    return FP3_OK;
}

static fp3_status add_software(const family *f, unsigned rung, unsigned threads, fp3_error *error) {
    fp3_measure_point point = blank(f, f->options->engine, NULL);
    fp3_measure_run *r = calloc(1, sizeof *r);
    if (!r)
        return fp3_fail(error, FP3_E_SYSTEM, "out of memory");
    *r = (fp3_measure_run){.compiled = f->compiled, .machines = f->machines};
    point.run = run;
    point.close = close_run;
    point.self = r;
    point.threads = threads;
    point.expected = f->seconds[rung] / f->problem->variants;
    point.objects =
        fp3_measure_run_objects(f->options, ldexp(1, (int)rung), point.expected, threads);
    const fp3_status status = fp3_measure_machines_engine(
        f->machines, f->options->engine, CONFIG, threads, point.objects, &r->engine, error);
    if (status)
        free(r);
    return status ? status : add(f, &point, rung, error);
}

/* What the hardware needs is known beforehand; a sample of it has been run. */
static fp3_status add_hardware(const family *f, const fp3_compiled *compiled, const char *config,
                               unsigned rung, fp3_error *error) {
    fp3_measure_point point = blank(f, "rtl", config);
    fp3_engine *engine = NULL;
    const fp3_status status =
        fp3_measure_machines_engine(f->machines, "rtl", config, 1, 0, &engine, error);
    if (status)
        return status;
    point.objects = fp3_engine_objects(engine);
    point.cycles = (double)fp3_compiled_cycles(compiled, 1ull << rung) / (double)point.objects;
    return add(f, &point, rung, error);
}

/* *compiled is NULL, and the configuration is left out, if it cannot run that. */
static fp3_status compile(const family *f, const char *engine, const char *config,
                          fp3_compiled **compiled, fp3_error *error) {
    fp3_compile_def def = fp3_compile_default();
    def.config = config;
    def.arithmetic = f->arithmetic;
    *compiled = NULL;
    const fp3_status status = fp3_compile(f->problem->model, f->integrator, &def, compiled, error);
    if (status == FP3_E_PROGRAM || status == FP3_E_LIMIT) {
        const fp3_measure_point point = blank(f, engine, config);
        fp3_measure_points_leave_out(f->points, &point, error->text);
        return FP3_OK;
    }
    return status ? status : fp3_measure_machines_keep(f->machines, *compiled, error);
}

static fp3_status add_configuration(const family *f, const char *config, fp3_error *error) {
    fp3_compiled *compiled;
    fp3_status status = compile(f, "rtl", config, &compiled, error);
    if (status || !compiled)
        return status;
    status = agree(f, compiled, "rtl", config, error);
    for (unsigned k = 0; !status && k < f->options->most_rungs; k++)
        if (f->ends[k])
            status = add_hardware(f, compiled, config, k, error);
    return status;
}

static fp3_status add_all(family *f, fp3_error *error) {
    const long cores = sysconf(_SC_NPROCESSORS_ONLN);
    uint64_t cycles;
    f->brief = calloc(ROOM(f), sizeof *f->brief);
    fp3_status status = f->brief ? brief(f, f->compiled, f->options->engine, CONFIG,
                                         f->problem->variants, f->brief, &cycles, error)
                                 : fp3_fail(error, FP3_E_SYSTEM, "out of memory");
    if (!status && strcmp(f->options->engine, "isa") != 0)
        status = agree(f, f->compiled, "isa", CONFIG, error);
    for (int i = 0; !status && i < HARDWARE; i++)
        status = add_configuration(f, hardware[i], error);
    for (unsigned k = 0; !status && k < f->options->most_rungs; k++) {
        if (f->ends[k])
            status = add_software(f, k, 1, error);
        if (f->ends[k] && !status && cores > 1 && f->options->has_threads)
            status = add_software(f, k, (unsigned)cores, error);
    }
    return status;
}

static fp3_status add_family(family *f, fp3_error *error) {
    fp3_status status = compile(f, f->options->engine, CONFIG, &f->compiled, error);
    if (status || !f->compiled)
        return status;
    status = sample(f, error);
    if (!status && f->is_solved)
        status = add_all(f, error);
    if (!status && !f->is_solved) {
        const fp3_measure_point point = blank(f, f->options->engine, NULL);
        fp3_measure_points_leave_out(f->points, &point, "no time step that was tried solves it");
    }
    for (unsigned k = 0; k < RUNGS_MOST; k++)
        free(f->ends[k]);
    free(f->brief);
    return status;
}

static fp3_status add_integrator(family *shared, const char *name, fp3_error *error) {
    fp3_integrator *integrator = NULL;
    fp3_status status = fp3_integrator_find(name, &integrator, error);
    for (int i = 0; !status && i < FP3_ARITHMETICS; i++) {
        family f = *shared;
        f.integrator = integrator;
        f.arithmetic = (fp3_arithmetic)i;
        f.name = name;
        if (!fp3_arithmetic_applies(f.arithmetic, integrator, 0))
            continue;
        fp3_measure_points_say(f.points, "%s: %s, %s", f.problem->model->name, name,
                               fp3_arithmetic_of(f.arithmetic)->name);
        status = add_family(&f, error);
        if (status) {
            const fp3_error why = *error;
            fp3_fail(error, status, "%s, %s: %s", name, fp3_arithmetic_of(f.arithmetic)->name,
                     why.text);
        }
    }
    fp3_integrator_free(&integrator);
    return status;
}

fp3_status fp3_measure_add_engine(fp3_measure_points *points, const fp3_measure_problem *problem,
                                  const fp3_measure_options *options,
                                  fp3_measure_machines *machines, fp3_error *error) {
    family shared = {
        .points = points, .problem = problem, .options = options, .machines = machines};
    fp3_status status = FP3_OK;
    const char *name;
    for (unsigned i = 0; !status && (name = options->integrators ? options->integrators[i]
                                                                 : fp3_integrator_name(i));
         i++)
        status = add_integrator(&shared, name, error);
    return status;
}
