/* measure.c - bench points MODEL.ode: error against run time of every way to solve a model, as JSON. */
#include "bench.h"
#include "commands.h"
#include "machines.h"

#include "base/file.h"
#include "bench/equations.h"
#include "bench/native.h"

#include <argp.h>
#include <gsl/gsl_version.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sundials/sundials_version.h>

#define NAMES_MOST 64

typedef struct {
    const char *model, *json, *problem, *integrators[NAMES_MOST + 1];
    unsigned integrator_count, variants, repeats;
    double patience;
    bench_options bench;
} options;

static const char *const flags[] = {"-O3", "-march=native", NULL};
static const char export[] =
    "int right_side(double t, const double *y, double *d, void *p) { slopes(t, y, p, d); return 0; "
    "}\n";

static fp3_status add_peers(bench_points *points, const bench_problem *problem, const options *o,
                            bench_slopes_fn *slopes, fp3_error *error) {
    fprintf(stderr, "%s: solvers in double\n", problem->model->name);
    const fp3_status status = bench_add_gsl(points, problem, &o->bench, slopes, error);
    return status ? status : bench_add_sundials(points, problem, &o->bench, slopes, error);
}

static fp3_status compile_slopes(const fp3_model *model, fp3_bench_native **native,
                                 bench_slopes_fn **slopes, fp3_error *error) {
    char *equations = NULL, *text = NULL;
    fp3_status status = fp3_bench_equations(model, FP3_BENCH_DOUBLE, &equations, error);
    if (!status && asprintf(&text, "%s%s", equations, export) < 0) {
        text = NULL;
        status = fp3_fail(error, FP3_E_SYSTEM, "out of memory");
    }
    if (!status)
        status = fp3_bench_native_open(text, flags, native, error);
    if (!status)
        status = fp3_bench_native_find(*native, "right_side", slopes, error);
    free(equations);
    free(text);
    return status;
}

static fp3_status write_result(const options *o, const bench_problem *problem,
                               const bench_points *points, fp3_error *error) {
    json_t *all =
        json_pack("{s:s, s:s, s:f, s:I, s:I, s:b, s:o, s:O}", "model", problem->model->name, "doc",
                  problem->model->doc, "span", problem->end, "states",
                  (json_int_t)problem->model->state_count, "variants",
                  (json_int_t)problem->variants, "has_events", problem->model->event_count > 0,
                  "points", bench_points_json(points), "left_out", points->left_out);
    char sundials[64] = "";
    SUNDIALSGetVersion(sundials, sizeof sundials);
    json_object_set_new(all, "versions",
                        json_pack("{s:s, s:s}", "GSL", gsl_version, "SUNDIALS", sundials));
    char *text = all ? json_dumps(all, JSON_INDENT(1) | JSON_REAL_PRECISION(9)) : NULL;
    const fp3_status status = text ? fp3_file_write(o->json, text, strlen(text), error)
                                   : fp3_fail(error, FP3_E_SYSTEM, "out of memory");
    free(text);
    json_decref(all);
    return status;
}

static fp3_status measure(const options *o, const bench_problem *problem, fp3_error *error) {
    bench_points points = {
        .left_out = json_array(), .patience = o->patience, .repeats = o->repeats};
    bench_machines *machines = NULL;
    fp3_bench_native *native = NULL;
    bench_slopes_fn *slopes = NULL;
    fp3_status status = bench_machines_open(&machines, error);
    if (!status)
        status = bench_add_engine(&points, problem, &o->bench, machines, error);
    if (!status)
        status = bench_add_loop(&points, problem, &o->bench, error);
    if (!status && problem->model->event_count) {
        const char *const peers[] = {"gsl", "sundials"};
        for (int i = 0; i < 2; i++)
            bench_points_leave_out(&points, &(bench_point){.engine = peers[i], .problem = problem},
                                   "the model has events, which it does not look for");
    } else if (!status) {
        status = compile_slopes(problem->model, &native, &slopes, error);
        if (!status)
            status = add_peers(&points, problem, o, slopes, error);
    }
    if (!status)
        status = bench_points_time(&points, error);
    if (!status)
        status = write_result(o, problem, &points, error);
    bench_points_close(&points);
    fp3_bench_native_close(&native);
    bench_machines_close(&machines);
    return status;
}

/* ---- a problem for others ---- */

static json_t *rows(const double *values, size_t count, size_t width) {
    json_t *all = json_array();
    for (size_t i = 0; i < count; i++) {
        json_t *row = json_array();
        for (size_t k = 0; k < width; k++)
            json_array_append_new(row, json_real(values[i * width + k]));
        json_array_append_new(all, row);
    }
    return all;
}

/* The equations in Python; of every variant params, start and end. */
static fp3_status write_problem(const options *o, const bench_problem *p, fp3_error *error) {
    char *equations = NULL, *text = NULL;
    fp3_status status = fp3_bench_equations(p->model, FP3_BENCH_PYTHON, &equations, error);
    if (status)
        return status;
    json_t *all = json_pack("{s:s, s:s, s:f, s:o, s:o, s:o, s:o}", "model", p->model->name,
                            "equations", equations, "span", p->end, "params",
                            rows(p->params, p->variants, p->model->param_count), "initial",
                            rows(p->initial, p->variants, p->model->state_count), "truth",
                            rows(p->truth, p->variants, p->model->state_count), "scale",
                            rows(p->scale, 1, p->model->state_count));
    text = all ? json_dumps(all, JSON_REAL_PRECISION(17)) : NULL;
    status = text ? fp3_file_write(o->problem, text, strlen(text), error)
                  : fp3_fail(error, FP3_E_SYSTEM, "out of memory");
    free(text);
    free(equations);
    json_decref(all);
    return status;
}

static fp3_status bench(const options *o, char **report, fp3_error *error) {
    fp3_model *model = NULL;
    bench_problem problem = {0};
    fp3_status status = fp3_model_load(o->model, &model, report, error);
    if (!status) {
        fprintf(stderr, "%s: the truth of %u objects\n", model->name, o->variants);
        status = bench_problem_open(model, o->variants, &problem, error);
    }
    if (!status)
        status = measure(o, &problem, error);
    if (!status && o->problem && !model->event_count)
        status = write_problem(o, &problem, error);
    bench_problem_close(&problem);
    fp3_model_free(&model);
    return status;
}

enum { KEY_JSON = 256, KEY_QUICK, KEY_FLIP, KEY_ENGINE, KEY_PROBLEM };

static const struct argp_option table[] = {
    {"json", KEY_JSON, "FILE", 0, "Where the points go", 0},
    {"engine", KEY_ENGINE, "NAME", 0, "Of fp3: fast (default) or isa", 0},
    {"integrator", 'i', "NAME", 0, "May be repeated (default: all)", 0},
    {"quick", KEY_QUICK, NULL, 0, "Few tolerances, few objects, three repeats", 0},
    {"problem", KEY_PROBLEM, "FILE", 0,
     "Where the equations go in Python, and of every object its start and its truth; a model with "
     "events has none",
     0},
    {"flip", KEY_FLIP, NULL, 0, "Turn a bit of what the engine gives, which must be noticed", 0},
    {0},
};

static void make_quick(options *o) {
    o->repeats = 3;
    o->patience = 0.2;
    o->bench.objects = 1024;
    o->bench.object_steps = 1 << 20;
    o->bench.most_rungs = 10;
    o->bench.digits_apart = 4;
}

static error_t parse(int key, char *text, struct argp_state *state) {
    options *o = state->input;
    switch (key) {
    case KEY_JSON:
        o->json = text;
        break;
    case KEY_ENGINE:
        o->bench.engine = text;
        break;
    case 'i':
        if (o->integrator_count == NAMES_MOST)
            argp_error(state, "found more than %d integrators", NAMES_MOST);
        o->integrators[o->integrator_count++] = text;
        o->bench.integrators = o->integrators;
        break;
    case KEY_QUICK:
        make_quick(o);
        break;
    case KEY_PROBLEM:
        o->problem = text;
        break;
    case KEY_FLIP:
        o->bench.is_flipped = 1;
        break;
    case ARGP_KEY_ARG:
        if (o->model)
            argp_error(state, "found '%s', expected one model", text);
        o->model = text;
        break;
    case ARGP_KEY_END:
        if (!o->model || !o->json)
            argp_error(state, "expected a model (*.ode) and --json");
        break;
    default:
        return ARGP_ERR_UNKNOWN;
    }
    return 0;
}

int bench_points_command(int argc, char **argv) {
    static const struct argp argp = {
        .options = table,
        .parser = parse,
        .args_doc = "MODEL",
        .doc = "Error against run time of MODEL (*.ode): fp3's engines and hardware, a plain C "
               "loop, GSL and SUNDIALS."};
    options o = {.variants = 64,
                 .repeats = 5,
                 .patience = 0.3,
                 .bench = {.engine = "fast",
                           .objects = 16384,
                           .object_steps = 1 << 21,
                           .most_rungs = 18,
                           .fewest_digits = 2,
                           .most_digits = 10,
                           .digits_apart = 1,
                           .has_threads = 1}};
    argp_parse(&argp, argc, argv, 0, NULL, &o);
    if (!strcmp(o.bench.engine, "isa")) {
        o.bench.objects = o.variants;
        o.bench.has_threads = 0;
    }
    fp3_error error = {""};
    char *report = NULL;
    const fp3_status status = bench(&o, &report, &error);
    if (status)
        fprintf(stderr, "bench points: %s\n", report ? report : error.text);
    free(report);
    return fp3_exit_code(status);
}
