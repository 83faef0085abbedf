/* adaptive.c - see adaptive.h. An absolute error is the tolerance times the smallest scale of a state. */
#include "adaptive.h"

#include "run.h"

#include <fp3/adaptive.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define CONFIG "many_full" /* whose program the engines in software run */
#define ERROR_MOST 0.5
#define SAMPLE_SECONDS                                                                             \
    0.2 /* the run that finds the error takes no longer; the next may take ten times as many */
#define HARDWARE_MOST 3e5 /* instructions of a run under Verilator */
#define ARITHMETIC_LAST FP3_COMPENSATED

/* One integrator in one arithmetic. */
struct fp3_measure_adaptive {
    fp3_measure_adaptive *next;
    fp3_model *model; /* adapted; each run gives it its tolerance */
    double scale;     /* the smallest of a state */
    char name[];
};

typedef struct {
    fp3_measure_points *points;
    const fp3_measure_problem *problem;
    const fp3_measure_options *options;
    fp3_measure_machines *machines;
    fp3_measure_adaptive *own;
    const fp3_integrator *integrator;
    fp3_arithmetic arithmetic;
    fp3_compiled *compiled; /* for CONFIG */
    double tolerance;
    double *ends;    /* of the variants with it */
    double seconds;  /* that they took, alone */
    double attempts; /* of one of them, on average */
} family;

/* What a point runs. */
typedef struct {
    fp3_measure_run run;
    fp3_measure_adaptive *own;
} task;

static void set(fp3_model *model, const char *name, double value) {
    const uint32_t param = fp3_model_param(model, name);
    if (param != FP3_NONE)
        model->params[param].value = value;
}

static fp3_status solve(const fp3_measure_adaptive *own, const fp3_measure_run *r,
                        const fp3_measure_problem *p, double tolerance, uint64_t attempts,
                        double *ends, double *seconds, fp3_stats *stats, fp3_error *error) {
    set(own->model, "tolerance", tolerance);
    set(own->model, "absolute", tolerance * own->scale);
    set(own->model, "locate", tolerance * p->end);
    return fp3_measure_run_adaptive(r, p, attempts, ends, seconds, stats, error);
}

static uint64_t attempts_most(const family *f) { return 1ull << f->options->most_rungs; }

static size_t room(const fp3_measure_problem *p) {
    return (size_t)p->variants * p->model->state_count + 1;
}

/* ---- a timed run ---- */

/* Its ends are known from the sample. */
static fp3_status run(fp3_measure_point *point, double *seconds, fp3_error *error) {
    const fp3_measure_problem *p = point->problem;
    const task *t = point->self;
    fp3_stats stats;
    double *ends = calloc(room(p), sizeof *ends);
    fp3_status status = ends ? solve(t->own, &t->run, p, point->tolerance, FP3_ADAPTIVE_ATTEMPTS,
                                     ends, seconds, &stats, error)
                             : fp3_fail(error, FP3_E_SYSTEM, "out of memory");
    if (!status)
        status = fp3_measure_run_compare(p, p->variants, ends, "a timed run", point->ends,
                                         "the run of the variants alone", error);
    free(ends);
    return status;
}

static void close_run(fp3_measure_point *point) { free(point->self); }

/* ---- points ---- */

static fp3_measure_point blank(const family *f, const char *engine, const char *config) {
    return (fp3_measure_point){.engine = engine,
                               .integrator = f->own->name,
                               .arithmetic = fp3_arithmetic_of(f->arithmetic)->name,
                               .config = config,
                               .tolerance = f->tolerance,
                               .problem = f->problem};
}

static fp3_status add(const family *f, fp3_measure_point *point, fp3_error *error) {
    fp3_measure_point *added = fp3_measure_points_add(f->points, point);
    if (!added) {
        free(point->self);
        return fp3_fail(error, FP3_E_SYSTEM, "out of memory");
    }
    memcpy(added->ends, f->ends, (room(f->problem) - 1) * sizeof *added->ends);
    return FP3_OK;
}

static fp3_status add_software(const family *f, unsigned threads, fp3_error *error) {
    const double each = f->seconds / f->problem->variants;
    fp3_measure_point point = blank(f, f->options->engine, NULL);
    task *t = calloc(1, sizeof *t);
    if (!t)
        return fp3_fail(error, FP3_E_SYSTEM, "out of memory");
    *t = (task){{.compiled = f->compiled, .machines = f->machines, .adapted = f->own->model},
                f->own};
    point.run = run;
    point.close = close_run;
    point.self = t;
    point.threads = threads;
    point.objects = fp3_measure_run_objects(f->options, f->attempts, each, threads);
    point.expected = each;
    const fp3_status status = fp3_measure_machines_engine(
        f->machines, f->options->engine, CONFIG, threads, point.objects, &t->run.engine, error);
    if (status)
        free(t);
    return status ? status : add(f, &point, error);
}

/* Another engine, which ends with the same bits; config: of which the program is. */
static fp3_status again(const family *f, const fp3_compiled *compiled, const char *name,
                        const char *config, uint64_t objects, fp3_measure_point *point,
                        fp3_error *error) {
    double seconds, *ends = calloc(room(f->problem), sizeof *ends);
    fp3_stats stats = {0};
    fp3_measure_run r = {.compiled = compiled, .machines = f->machines, .adapted = f->own->model};
    fp3_status status =
        ends ? fp3_measure_machines_engine(f->machines, name, config, 1, objects, &r.engine, error)
             : fp3_fail(error, FP3_E_SYSTEM, "out of memory");
    if (!status)
        status = solve(f->own, &r, f->problem, f->tolerance, attempts_most(f), ends, &seconds,
                       &stats, error);
    if (!status) {
        point->objects = fp3_engine_objects(r.engine);
        point->cycles = (double)stats.counter[FP3_COUNTER_CYCLES] / (double)point->objects;
        status = fp3_measure_run_compare(
            f->problem,
            point->objects < f->problem->variants ? point->objects : f->problem->variants, f->ends,
            f->options->engine, ends, name, error);
    }
    free(ends);
    return status;
}

/* *compiled is NULL, and the configuration is left out, if it cannot run that. */
static fp3_status compile(const family *f, const char *config, fp3_compiled **compiled,
                          fp3_error *error) {
    fp3_compile_def def = fp3_compile_default();
    def.config = config;
    def.arithmetic = f->arithmetic;
    *compiled = NULL;
    const fp3_status status = fp3_compile(f->own->model, f->integrator, &def, compiled, error);
    if (status == FP3_E_PROGRAM || status == FP3_E_LIMIT) {
        fp3_measure_point point = blank(f, "rtl", config);
        point.tolerance = 0;
        fp3_measure_points_leave_out(f->points, &point, error->text);
        return FP3_OK;
    }
    return status ? status : fp3_measure_machines_keep(f->machines, *compiled, error);
}

/* Cycles depend on the objects: they are measured, where that does not take too long. */
static fp3_status add_hardware(const family *f, const fp3_compiled *compiled, const char *config,
                               fp3_error *error) {
    fp3_measure_point point = blank(f, "rtl", config);
    fp3_engine *engine = NULL;
    fp3_status status =
        fp3_measure_machines_engine(f->machines, "rtl", config, 1, 0, &engine, error);
    if (status ||
        f->attempts * compiled->instructions * (double)fp3_engine_objects(engine) > HARDWARE_MOST)
        return status;
    status = again(f, compiled, "rtl", config, 0, &point, error);
    return status ? status : add(f, &point, error);
}

static fp3_status add_tolerance(const family *f, const fp3_compiled *single, int is_first,
                                fp3_error *error) {
    const long cores = sysconf(_SC_NPROCESSORS_ONLN);
    fp3_measure_point unused;
    fp3_status status = FP3_OK;
    if (is_first && strcmp(f->options->engine, "isa") != 0)
        status = again(f, f->compiled, "isa", CONFIG, f->problem->variants, &unused, error);
    if (!status)
        status = add_hardware(f, f->compiled, CONFIG, error);
    if (!status && single)
        status = add_hardware(f, single, "single_full", error);
    if (!status)
        status = add_software(f, 1, error);
    if (!status && cores > 1 && f->options->has_threads)
        status = add_software(f, (unsigned)cores, error);
    return status;
}

/* ---- which tolerances ---- */

/* FP3_E_LIMIT: an object did not end. FP3_E_ARGUMENT: the arithmetic has no such tolerance. */
static fp3_status sample(family *f, fp3_error *error) {
    fp3_measure_run r = {.compiled = f->compiled,
                         .machines = f->machines,
                         .adapted = f->own->model,
                         .is_flipped = f->options->is_flipped};
    fp3_stats stats = {0};
    fp3_status status = fp3_measure_machines_engine(f->machines, f->options->engine, CONFIG, 1,
                                                    f->problem->variants, &r.engine, error);
    if (!status)
        status = solve(f->own, &r, f->problem, f->tolerance, attempts_most(f), f->ends, &f->seconds,
                       &stats, error);
    if (!status)
        f->attempts = (double)stats.object_steps / f->problem->variants;
    return status;
}

static fp3_status add_tolerances(family *f, const fp3_compiled *single, fp3_error *error) {
    const fp3_measure_options *o = f->options;
    fp3_status status = FP3_OK;
    int is_any = 0;
    f->seconds = 0;
    for (unsigned d = o->fewest_digits;
         !status && d <= o->most_digits && f->seconds < SAMPLE_SECONDS; d += o->digits_apart) {
        double median, worst;
        f->tolerance = pow(10, -(double)d);
        status = sample(f, error);
        if (status == FP3_E_ARGUMENT)
            return FP3_OK;
        if (status == FP3_E_LIMIT) {
            const fp3_measure_point point = blank(f, o->engine, NULL);
            fp3_measure_points_leave_out(f->points, &point, "an object does not come to its end");
            return FP3_OK;
        }
        if (status)
            return status;
        fp3_measure_problem_errors(f->problem, f->ends, &median, &worst);
        if (median < ERROR_MOST) {
            status = add_tolerance(f, single, !is_any, error);
            is_any = 1;
        }
    }
    return status;
}

/* ---- all integrators ---- */

static double smallest_scale(const fp3_measure_problem *p) {
    double least = INFINITY;
    for (uint32_t i = 0; i < p->model->state_count; i++)
        least = p->scale[i] > 0 ? fmin(least, p->scale[i]) : least;
    return isfinite(least) ? least : 1;
}

/* *is_fit: 0: the model cannot have adaptive steps, and is left out. */
static fp3_status open_own(family *f, const char *name, fp3_measure_adaptive **list, int *is_fit,
                           fp3_error *error) {
    const fp3_adaptive_def def = {.tolerance = 1e-5, .until = f->problem->end};
    fp3_measure_adaptive *own = f->own = calloc(1, sizeof *own + strlen(name) + 16);
    if (!own)
        return fp3_fail(error, FP3_E_SYSTEM, "out of memory");
    own->next = *list;
    *list = own;
    own->scale = smallest_scale(f->problem);
    sprintf(own->name, "%s adaptive", name);
    fp3_status status = fp3_model_copy(f->problem->model, &own->model, error);
    if (!status)
        status = fp3_model_adapt(own->model, &def, error);
    *is_fit = !status;
    if (status != FP3_E_PROGRAM)
        return status;
    const fp3_measure_point point = blank(f, f->options->engine, NULL);
    fp3_measure_points_leave_out(f->points, &point, error->text);
    return FP3_OK;
}

static fp3_status add_family(family *f, const char *name, fp3_measure_adaptive **list,
                             fp3_error *error) {
    fp3_compiled *single = NULL;
    int is_fit = 0;
    fp3_status status = open_own(f, name, list, &is_fit, error);
    if (status || !is_fit)
        return status;
    fp3_measure_points_say(f->points, "%s: %s, %s", f->problem->model->name, f->own->name,
                           fp3_arithmetic_of(f->arithmetic)->name);
    f->ends = calloc(room(f->problem), sizeof *f->ends);
    status = f->ends ? compile(f, CONFIG, &f->compiled, error)
                     : fp3_fail(error, FP3_E_SYSTEM, "out of memory");
    if (!status && f->compiled)
        status = compile(f, "single_full", &single, error);
    if (!status && f->compiled)
        status = add_tolerances(f, single, error);
    free(f->ends);
    return status;
}

static fp3_status add_integrator(const family *shared, const char *name,
                                 fp3_measure_adaptive **list, fp3_error *error) {
    fp3_integrator *integrator = NULL;
    fp3_status status = fp3_integrator_find(name, &integrator, error);
    for (int i = 0; !status && integrator->embedded_order && i <= ARITHMETIC_LAST; i++) {
        family f = *shared;
        f.integrator = integrator;
        f.arithmetic = (fp3_arithmetic)i;
        status = add_family(&f, name, list, error);
        if (status) {
            const fp3_error why = *error;
            fp3_fail(error, status, "%s adaptive, %s: %s", name,
                     fp3_arithmetic_of(f.arithmetic)->name, why.text);
        }
    }
    fp3_integrator_free(&integrator);
    return status;
}

fp3_status fp3_measure_add_adaptive(fp3_measure_points *points, const fp3_measure_problem *problem,
                                    const fp3_measure_options *options,
                                    fp3_measure_machines *machines, fp3_measure_adaptive **adaptive,
                                    fp3_error *error) {
    const family shared = {
        .points = points, .problem = problem, .options = options, .machines = machines};
    fp3_status status = FP3_OK;
    const char *name;
    for (unsigned i = 0; !status && (name = options->integrators ? options->integrators[i]
                                                                 : fp3_integrator_name(i));
         i++)
        status = add_integrator(&shared, name, adaptive, error);
    return status;
}

void fp3_measure_adaptive_close(fp3_measure_adaptive **adaptive) {
    while (*adaptive) {
        fp3_measure_adaptive *next = (*adaptive)->next;
        fp3_model_free(&(*adaptive)->model);
        free(*adaptive);
        *adaptive = next;
    }
}
