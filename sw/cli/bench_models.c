/* SPDX-License-Identifier: Apache-2.0 */
/* bench_models.c - see bench_models.h. lab/measure/measure.h measures; here are the names and the
 * tables. */
#include "bench_models.h"

#include "bench_files.h"
#include "files.h"
#include "json.h"
#include "lab/measure/measure.h"
#include "progress.h"

#include <fp3/program.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PATH_SIZE 4096
/* A second of engine fast interpreting in its slowest arithmetic. */
#define WORK_WITHOUT_TIMES 1e8

/* ---- a table: of each way to run, what no faster point of it is as accurate as ---- */

/* Solvers of one library compete; so do the integrators on one engine or configuration. */
static int is_alike(const fp3_measure_point *a, const fp3_measure_point *b) {
    return !strcmp(a->engine, b->engine) && a->threads == b->threads &&
           !strcmp(a->config ? a->config : "", b->config ? b->config : "");
}

/* Nanoseconds; of hardware cycles. */
static double cost_of(const fp3_measure_point *p) {
    return p->repeats ? 1e9 * fp3_measure_median(p->seconds, p->repeats) / (double)p->objects
                      : p->cycles;
}

static int compare(const void *a, const void *b) {
    const fp3_measure_point *x = *(const fp3_measure_point *const *)a;
    const fp3_measure_point *y = *(const fp3_measure_point *const *)b;
    const double d = cost_of(x) - cost_of(y);
    return d != 0 ? (d > 0) - (d < 0)
                  : (x->error_median > y->error_median) - (x->error_median < y->error_median);
}

static void print_point(const fp3_measure_point *p) {
    char who[64], how[64], step[32];
    if (p->config)
        snprintf(who, sizeof who, "%s %s", p->engine, p->config);
    else
        snprintf(who, sizeof who, "%s, %u thread%s", p->engine, p->threads,
                 p->threads > 1 ? "s" : "");
    snprintf(how, sizeof how, "%s%s%s%s%s", p->method ? p->method : "",
             p->method && p->integrator ? ", " : "", p->integrator ? p->integrator : "",
             p->arithmetic ? ", " : "", p->arithmetic ? p->arithmetic : "");
    snprintf(step, sizeof step, "%s %.3g", p->h > 0 ? "h" : "tol", p->h > 0 ? p->h : p->tolerance);
    printf("%-20s %-34s %-12s %10.2e %10.2e", who, how, step, p->error_median, p->error_worst);
    if (p->repeats)
        printf(" %12.4g\n", cost_of(p));
    else
        printf(" %12s %12.6g\n", "", p->cycles);
}

/* The points that are like the first that is not done, the fastest first. Returns how many are
 * done. */
static size_t print_front(const fp3_measure_point **list, size_t count) {
    size_t like = 1;
    double best = INFINITY;
    for (size_t i = 1; i < count; i++)
        if (is_alike(list[0], list[i])) {
            const fp3_measure_point *p = list[i];
            list[i] = list[like];
            list[like++] = p;
        }
    qsort(list, like, sizeof *list, compare);
    for (size_t i = 0; i < like; i++)
        if (list[i]->error_median < best) {
            best = list[i]->error_median;
            print_point(list[i]);
        }
    return like;
}

static fp3_status print_table(const fp3_measure *m, fp3_error *error) {
    const fp3_measure_problem *p = &m->problem;
    const fp3_measure_point **list = calloc(m->points.count + 1, sizeof *list);
    if (!list)
        return fp3_no_memory(error);
    for (size_t i = 0; i < m->points.count; i++)
        list[i] = &m->points.point[i];
    printf("%s from 0 to %g, %u objects with different values. Each row is more accurate than all "
           "faster rows of its engine.\n"
           "error: relative, at the end: the median of the objects, and the worst. ns, cycles: all "
           "steps of one object.\n\n"
           "%-20s %-34s %-12s %10s %10s %12s %12s\n",
           p->model->name, p->end, p->variants, "engine", "how", "step", "error", "worst", "ns",
           "cycles");
    for (size_t i = 0; i < m->points.count;)
        i += print_front(list + i, m->points.count - i);
    puts("");
    fflush(stdout);
    free(list);
    return FP3_OK;
}

/* ---- all models ---- */

static void say(void *user, const char *what) { fp3_progress_say(user, "%s", what); }

static void find_model(const char *name, char *path) {
    const int is_path = strchr(name, '/') || fp3_program_is_named(name);
    snprintf(path, PATH_SIZE, is_path ? "%s" : "programs/%s.ode", name);
}

static void join(json_t *all, const json_t *one) {
    const char *const keys[] = {"problems", "points", "left_out"};
    for (size_t i = 0; i < sizeof keys / sizeof *keys; i++)
        json_array_extend(json_object_get(all, keys[i]), json_object_get(one, keys[i]));
}

static fp3_status measure(const fp3_bench_models *what, const char *name, fp3_progress *progress,
                          json_t *all, char **report, fp3_error *error) {
    char path[PATH_SIZE];
    fp3_measure_options with = fp3_measure_default("fast", what->is_quick);
    with.integrators = what->integrator_count ? what->integrators : NULL;
    with.config = what->config;
    if (what->has_no_times) {
        with.has_times = 0;
        with.most_work = WORK_WITHOUT_TIMES;
    }
    with.say = say;
    with.user = progress;
    fp3_model *model = NULL;
    fp3_measure m = {0};
    find_model(name, path);
    fp3_progress_resume(progress);
    fp3_status status = fp3_model_load(path, &model, report, error);
    if (!status)
        status = fp3_model_check_alone(model, error);
    if (!status)
        status = fp3_measure_model(model, &with, &m, error);
    fp3_progress_pause(progress);
    if (!status)
        status = print_table(&m, error);
    json_t *one = status ? NULL : fp3_measure_json(&m);
    join(all, one);
    json_decref(one);
    fp3_measure_close(&m);
    fp3_model_free(&model);
    return status;
}

static fp3_status check_files(const fp3_bench_models *what, fp3_error *error) {
    char path[FP3_BENCH_NAMES_MOST][PATH_SIZE];
    fp3_files files = {0};
    for (unsigned i = 0; i < what->model_count; i++) {
        find_model(what->models[i], path[i]);
        fp3_files_read(&files, "MODEL", path[i]);
    }
    fp3_files_write(&files, "--json", what->json);
    fp3_files_write(&files, "--csv", what->csv);
    return fp3_files_check(&files, error);
}

fp3_status fp3_bench_models_run(const fp3_bench_models *what, char **report, fp3_error *error) {
    fp3_status status = check_files(what, error);
    if (status)
        return status;
    json_t *all = json_pack("{s:[], s:[], s:[]}", "problems", "points", "left_out");
    fp3_progress *progress = fp3_progress_begin("bench", NULL);
    fp3_progress_pause(progress); /* tables are printed in between */
    for (unsigned i = 0; !status && i < what->model_count; i++)
        status = measure(what, what->models[i], progress, all, report, error);
    fp3_progress_end(&progress);
    if (!status && what->json)
        status = fp3_json_write(what->json, json_incref(all), 9, error);
    if (!status && what->csv)
        status = fp3_bench_csv(what->csv, json_object_get(all, "points"), error);
    json_decref(all);
    return status;
}
