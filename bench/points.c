/* points.c - bench points MODEL.ode: error against run time of every way to solve a model, as JSON.
 */
#include "commands.h"
#include "sundials.h"

#include "base/file.h"
#include "lab/bench/equations.h"

#include <argp.h>
#include <gsl/gsl_version.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sundials/sundials_version.h>

#define NAMES_MOST 64

typedef struct {
    const char *model, *json, *problem, *engine, *integrators[NAMES_MOST + 1];
    unsigned integrator_count;
    int is_quick, is_flipped;
} options;

static void say(void *user, const char *what) {
    (void)user;
    fprintf(stderr, "%s\n", what);
}

static fp3_status write_json(const char *path, json_t *all, size_t digits, fp3_error *error) {
    char *text = all ? json_dumps(all, JSON_INDENT(1) | JSON_REAL_PRECISION(digits)) : NULL;
    const fp3_status status =
        text ? fp3_file_write(path, text, strlen(text), error) : fp3_no_memory(error);
    free(text);
    json_decref(all);
    return status;
}

static fp3_status write_result(const options *o, const fp3_measure *m, fp3_error *error) {
    json_t *all = fp3_measure_json(m);
    char sundials[64] = "";
    SUNDIALSGetVersion(sundials, sizeof sundials);
    json_object_set_new(all, "versions",
                        json_pack("{s:s, s:s}", "GSL", gsl_version, "SUNDIALS", sundials));
    return write_json(o->json, all, 9, error);
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
static fp3_status write_problem(const options *o, const fp3_measure_problem *p, fp3_error *error) {
    char *equations = NULL;
    const fp3_status status = fp3_bench_equations(p->model, FP3_BENCH_PYTHON, &equations, error);
    if (status)
        return status;
    json_t *all = json_pack("{s:s, s:s, s:f, s:o, s:o, s:o, s:o}", "model", p->model->name,
                            "equations", equations, "span", p->end, "params",
                            rows(p->params, p->variants, p->model->param_count), "initial",
                            rows(p->initial, p->variants, p->model->state_count), "truth",
                            rows(p->truth, p->variants, p->model->state_count), "scale",
                            rows(p->scale, 1, p->model->state_count));
    free(equations);
    return write_json(o->problem, all, 17, error);
}

static fp3_status bench(const options *o, char **report, fp3_error *error) {
    fp3_measure_options with = fp3_measure_default(o->engine, o->is_quick);
    with.integrators = o->integrator_count ? o->integrators : NULL;
    with.is_flipped = o->is_flipped;
    with.more = bench_add_sundials;
    with.more_name = "sundials";
    with.say = say;
    fp3_model *model = NULL;
    fp3_measure m = {0};
    fp3_status status = fp3_model_load(o->model, &model, report, error);
    if (!status)
        status = fp3_measure_model(model, &with, &m, error);
    if (!status)
        status = write_result(o, &m, error);
    if (!status && o->problem && !model->event_count)
        status = write_problem(o, &m.problem, error);
    fp3_measure_close(&m);
    fp3_model_free(&model);
    return status;
}

enum { KEY_JSON = 256, KEY_QUICK, KEY_FLIP, KEY_ENGINE, KEY_PROBLEM };

static const struct argp_option table[] = {
    {"json", KEY_JSON, "FILE", 0, "Where the points go", 0},
    {"engine", KEY_ENGINE, "NAME", 0, "Of fp3: fast (default) or isa", 0},
    {"integrator", 'i', "NAME", 0, "May be repeated (default: all)", 0},
    {"quick", KEY_QUICK, NULL, 0, "Few tolerances, few objects", 0},
    {"problem", KEY_PROBLEM, "FILE", 0,
     "Where the equations go in Python, and of every object its start and its truth; a model with "
     "events has none",
     0},
    {"flip", KEY_FLIP, NULL, 0, "Turn a bit of what the engine gives, which must be noticed", 0},
    {0},
};

static error_t parse(int key, char *text, struct argp_state *state) {
    options *o = state->input;
    switch (key) {
    case KEY_JSON:
        o->json = text;
        break;
    case KEY_ENGINE:
        o->engine = text;
        break;
    case 'i':
        if (o->integrator_count == NAMES_MOST)
            argp_error(state, "found more than %d integrators", NAMES_MOST);
        o->integrators[o->integrator_count++] = text;
        break;
    case KEY_QUICK:
        o->is_quick = 1;
        break;
    case KEY_PROBLEM:
        o->problem = text;
        break;
    case KEY_FLIP:
        o->is_flipped = 1;
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
    options o = {.engine = "fast"};
    argp_parse(&argp, argc, argv, 0, NULL, &o);
    fp3_error error = {.text = ""};
    char *report = NULL;
    const fp3_status status = bench(&o, &report, &error);
    if (status)
        fprintf(stderr, "bench points: %s\n", report ? report : error.text);
    free(report);
    return fp3_exit_code(status);
}
