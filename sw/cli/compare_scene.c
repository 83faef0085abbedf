/* SPDX-License-Identifier: Apache-2.0 */
/* compare_scene.c - see compare_scene.h. */
#include "compare_scene.h"

#include "base/file.h"
#include "bench_files.h"
#include "files.h"
#include "json.h"
#include "lab/check/scene_invariants.h"
#include "lab/scene/scaled.h"
#include "progress.h"

#include <fp3/scene_truth.h>
#include <inttypes.h>
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { TIMES = 32 };
#define SHORT_RUN 1e6 /* object-steps */

/* Rows of the scene's states, one for each of the times. */
typedef struct {
    const fp3_compare_scene *what;
    const fp3_scene *scene;
    fp3_progress *progress;
    uint64_t steps[TIMES];
    size_t times, width;
    double *solution, *method, *engine, *sizes;
    double *engine_start; /* before the first step */
    fp3_scene_invariants *invariants;
    fp3_scene_invariant *changed; /* of each length of step three times as many: see CHANGES */
    fp3_scene_solved solved;
    fp3_error no_method, failure; /* text "": there is one; none failed */
    json_t *rows, *kept;          /* of states, and of invariants */
} comparison;

/* ---- the engine's states ---- */

/* The first failure of all runs is kept; rows are printed in each case. */
static fp3_status look_for_failures(comparison *c, fp3_engine *engine, uint64_t parts) {
    fp3_failure found;
    char text[FP3_FAILURE_TEXT_SIZE];
    if (c->failure.text[0])
        return FP3_OK;
    const fp3_status status = fp3_engine_failure(engine, 0, fp3_engine_objects(engine), &found);
    if (!status && found.failed) {
        fp3_engine_failure_text(engine, &found, text);
        fp3_fail(&c->failure, FP3_E_FAILED, "with h/%" PRIu64 ": %s; %zu of %zu objects failed",
                 parts, text, found.failed, fp3_engine_objects(engine));
    }
    return status;
}

static fp3_status run_engine(comparison *c, uint64_t parts, fp3_error *error) {
    fp3_scaled f;
    fp3_engine *engine = NULL;
    fp3_stats stats;
    fp3_status status = fp3_scaled_open(c->scene, parts, 1, &f, error);
    fp3_engine_def def = fp3_scene_engine(&f.scene);
    def.engine = "fast";
    def.error = error;
    /* What is made once in a short run takes longer than the run. */
    def.is_without_compiler =
        (double)c->scene->objects * (double)c->steps[c->times - 1] * (double)parts < SHORT_RUN;
    if (!status)
        status = fp3_engine_open(&def, &engine);
    if (!status)
        status = fp3_scene_load(&f.scene, engine, error);
    if (!status)
        status = fp3_scaled_row(&f.scene, engine, c->engine_start, error);
    for (size_t i = 0, made = 0; !status && i < c->times; made = c->steps[i++]) {
        fp3_progress_say(c->progress, "engine fast with h/%" PRIu64 ", step %" PRIu64, parts,
                         c->steps[i]);
        if (c->steps[i] > made)
            status = fp3_adaptive_run(engine, (c->steps[i] - made) * parts, &stats);
        if (!status && c->steps[i] > made)
            status = look_for_failures(c, engine, parts);
        if (!status)
            status = fp3_scaled_row(&f.scene, engine, c->engine + i * c->width, error);
    }
    fp3_engine_close(&engine);
    fp3_scaled_close(&f);
    return status;
}

/* ---- errors of a state ---- */

typedef struct {
    double rms, worst; /* as shares of its size */
    size_t object, time;
} deviation;

static deviation between(const comparison *c, const double *a, const double *b, size_t times,
                         size_t first, size_t objects) {
    deviation d = {.rms = times && objects ? 0 : NAN, .worst = times && objects ? 0 : NAN};
    for (size_t t = 0; t < times; t++)
        for (size_t i = 0; i < objects; i++) {
            const size_t at = t * c->width + first + i;
            const double way = fabs(a[at] - b[at]);
            const double share = way == 0 ? 0 : way / c->sizes[first + i];
            d.rms += share * share;
            if (!(share <= d.worst)) {
                d.worst = share;
                d.object = i;
                d.time = t;
            }
        }
    if (times && objects)
        d.rms = sqrt(d.rms / (double)(times * objects));
    return d;
}

typedef struct {
    const fp3_scene_group *group;
    const fp3_quantity *state;
    uint64_t parts;
    double h, size;
    deviation rounding, method, whole;
} row;

static void put_row(comparison *c, const row *r) {
    json_array_append_new(
        c->rows,
        json_pack("{s:s, s:s, s:s, s:o, s:I, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:I, s:I}", "group",
                  r->group->name, "state", r->state->name, "unit", r->state->dimension, "h",
                  fp3_json_number(r->h), "parts", (json_int_t)r->parts, "size",
                  fp3_json_number(r->size), "fp32_rms", fp3_json_number(r->rounding.rms),
                  "fp32_worst", fp3_json_number(r->rounding.worst), "method_rms",
                  fp3_json_number(r->method.rms), "method_worst", fp3_json_number(r->method.worst),
                  "rms", fp3_json_number(r->whole.rms), "worst", fp3_json_number(r->whole.worst),
                  "worst_object", (json_int_t)r->whole.object, "worst_step",
                  (json_int_t)c->steps[r->whole.time]));
    fp3_progress_pause(c->progress);
    printf("%11.6g  %-12s  %-10s  %9.3g  %8.1e %8.1e  %8.1e %8.1e  %8.1e %8.1e", r->h,
           r->group->name, r->state->name, r->size, r->rounding.rms, r->rounding.worst,
           r->method.rms, r->method.worst, r->whole.rms, r->whole.worst);
    if (r->whole.worst > 0)
        printf("  %6zu %8" PRIu64, r->whole.object, c->steps[r->whole.time]);
    printf("\n");
    fp3_progress_resume(c->progress);
}

static void put_rows(comparison *c, uint64_t parts) {
    const size_t known = c->solved.known, both = c->no_method.text[0] ? 0 : c->times;
    size_t first = 0;
    for (size_t k = 0; k < c->scene->group_count; k++) {
        const fp3_scene_group *g = &c->scene->groups[k];
        for (uint32_t s = 0; s < g->program->model->state_count; s++, first += g->objects) {
            const row r = {
                .group = g,
                .state = &g->program->model->states[s],
                .parts = parts,
                .h = fp3_scaled_step(g) / (double)parts,
                .size = g->objects ? c->sizes[first] : 0,
                .rounding = between(c, c->engine, c->method, both, first, g->objects),
                .method = between(c, c->method, c->solution, both ? known : 0, first, g->objects),
                .whole = between(c, c->engine, c->solution, known, first, g->objects)};
            if (!isinf(r.size))
                put_row(c, &r);
        }
    }
}

/* ---- invariants ---- */

enum { BY_ENGINE, BY_METHOD, BY_SOLUTION, CHANGES };

static fp3_scene_invariant *changes_by(const comparison *c, uint32_t halving, int who) {
    return c->changed +
           ((size_t)halving * CHANGES + (size_t)who) * fp3_scene_invariants_count(c->invariants);
}

static fp3_status look_at_invariants(comparison *c, uint32_t halving, fp3_error *error) {
    const size_t both = c->no_method.text[0] ? 0 : c->times;
    fp3_progress_say(c->progress, "invariants with h/%" PRIu64, UINT64_C(1) << halving);
    fp3_status status =
        fp3_scene_invariants_look(c->invariants, c->engine_start, c->engine, c->times,
                                  changes_by(c, halving, BY_ENGINE), error);
    if (!status)
        status = fp3_scene_invariants_look(c->invariants, NULL, c->method, both,
                                           changes_by(c, halving, BY_METHOD), error);
    if (!status)
        status = fp3_scene_invariants_look(c->invariants, NULL, c->solution, c->solved.known,
                                           changes_by(c, halving, BY_SOLUTION), error);
    return status;
}

static void put_invariant(comparison *c, uint32_t halving, size_t i) {
    const fp3_scene_invariant *engine = changes_by(c, halving, BY_ENGINE) + i;
    const double method = changes_by(c, halving, BY_METHOD)[i].change,
                 solution = changes_by(c, halving, BY_SOLUTION)[i].change;
    const fp3_scene_group *g = fp3_scene_invariants_group(c->invariants, i);
    const fp3_definition *of = fp3_scene_invariants_name(c->invariants, i);
    const uint64_t parts = UINT64_C(1) << halving, step = c->steps[engine->time];
    const double h = fp3_scaled_step(g ? g : &c->scene->groups[0]) / (double)parts;
    json_array_append_new(
        c->kept,
        json_pack("{s:s?, s:s, s:s, s:o, s:I, s:o, s:o, s:o, s:o, s:o, s:o, s:I}", "group",
                  g ? g->name : NULL, "invariant", of->name, "unit", of->unit, "h",
                  fp3_json_number(h), "parts", (json_int_t)parts, "first",
                  fp3_json_number(engine->first), "change", fp3_json_number(engine->change),
                  "relative", fp3_json_number(engine->relative), "method_change",
                  fp3_json_number(method), "solution_change", fp3_json_number(solution), "object",
                  g ? json_integer((json_int_t)engine->object) : json_null(), "step",
                  (json_int_t)step));
    printf("%11.6g  %-12s  %-10s  %13.6g  %9.1e  ", h, g ? g->name : "all objects", of->name,
           engine->first, engine->change);
    if (g)
        printf("%9s  %9.1e  %9.1e", "", method, solution);
    else
        printf("%9.1e  %9.1e  %9.1e", engine->relative, method, solution);
    if (engine->change != 0 && g)
        printf("  %6zu %8" PRIu64, engine->object, step);
    else if (engine->change != 0)
        printf("  %6s %8" PRIu64, "", step);
    putchar('\n');
}

static void put_invariants(comparison *c) {
    const size_t count = fp3_scene_invariants_count(c->invariants);
    if (!count)
        return;
    fp3_progress_pause(c->progress);
    printf(
        "\ninvariants: the largest change at these times, of the object that has changed most\n\n"
        "%11s  %-12s  %-10s  %13s  %20s  %9s  %9s  %6s %8s\n",
        "h", "group", "invariant", "first", "by the engine", "by method", "solution", "object",
        "step");
    for (uint32_t k = 0; k <= c->what->halvings; k++)
        for (size_t i = 0; i < count; i++)
            put_invariant(c, k, i);
    fp3_progress_resume(c->progress);
}

/* ---- all of it ---- */

static int tell(void *user, uint64_t parts, double share) {
    comparison *c = user;
    fp3_progress_say(c->progress, "the solution, with steps of h/%" PRIu64, parts);
    fp3_progress_share(c->progress, share);
    return 0;
}

static fp3_status solve(comparison *c, fp3_error *error) {
    fp3_scene_truth_def def = fp3_scene_truth_default();
    def.within = c->what->within > 0 ? c->what->within : def.within;
    def.work = c->what->work > 0 ? c->what->work : def.work;
    def.tell = tell;
    def.user = c;
    return fp3_scene_solution(c->scene, &def, c->steps, c->times, c->solution, &c->solved, error);
}

static void print_head(const comparison *c) {
    const fp3_scene_solved *s = &c->solved;
    printf("%s: %zu objects, %" PRIu64 " steps\n", c->scene->path, c->scene->objects,
           c->steps[c->times - 1]);
    if (s->known) {
        printf("solution: by %s, ", s->method);
        if (s->extrapolated)
            printf("extrapolated from h/%" PRIu64 " with order %u", s->parts, s->extrapolated);
        else
            printf("with h/%" PRIu64, s->parts);
        printf("; within %.1e up to step %" PRIu64 "\n", s->apart, c->steps[s->known - 1]);
    }
    if (s->why[0])
        printf("no solution %s step %" PRIu64 ": %s\n", s->known ? "after" : "at",
               c->steps[s->known ? s->known - 1 : 0], s->why);
    printf("errors as shares of the state's size, at %zu times: root mean square, and worst\n\n",
           c->times);
    printf("%11s  %-12s  %-10s  %9s  %17s  %17s  %17s  %6s %8s\n", "h", "group", "state", "size",
           "by FP32", "by the method", "together", "object", "step");
}

/* Nothing where there is no value. */
static void put_number(FILE *out, double x) {
    if (isnan(x))
        fputc(',', out);
    else
        fprintf(out, ",%.17g", x);
}

static void put_states(FILE *out, const comparison *c) {
    fprintf(out, "step,group,object,state,fp32,method,solution\r\n");
    for (size_t t = 0; t < c->times; t++) {
        size_t at = t * c->width;
        for (size_t k = 0; k < c->scene->group_count; k++) {
            const fp3_scene_group *g = &c->scene->groups[k];
            for (uint32_t s = 0; s < g->program->model->state_count; s++)
                for (size_t i = 0; i < g->objects; i++, at++) {
                    fprintf(out, "%" PRIu64 ",%s,%zu,%s", c->steps[t], g->name, i,
                            g->program->model->states[s].name);
                    put_number(out, c->engine[at]);
                    put_number(out, c->no_method.text[0] ? NAN : c->method[at]);
                    put_number(out, c->solution[at]);
                    fputs("\r\n", out);
                }
        }
    }
}

/* The states with the scene's own time step. */
static fp3_status write_states(const comparison *c, fp3_error *error) {
    fp3_output *output = NULL;
    fp3_status status = fp3_output_open(c->what->states, &output, error);
    if (status)
        return status;
    put_states(fp3_output_stream(output), c);
    status = fp3_output_publish(output, error);
    fp3_output_close(&output);
    return status;
}

static fp3_status compare_parts(comparison *c, uint32_t halving, fp3_error *error) {
    const uint64_t parts = UINT64_C(1) << halving;
    fp3_status status = run_engine(c, parts, error);
    if (status == FP3_E_FAILED) {
        c->failure = *error;
        return FP3_OK;
    }
    fp3_progress_say(c->progress, "the method in double, with steps of h/%" PRIu64, parts);
    if (!status && !c->no_method.text[0]) {
        status = fp3_scene_in_double(c->scene, parts, c->steps, c->times, c->method, error);
        if (status == FP3_E_PROGRAM || status == FP3_E_FAILED) {
            c->no_method = *error;
            status = FP3_OK;
        }
    }
    if (!status)
        put_rows(c, parts);
    if (!status)
        status = look_at_invariants(c, halving, error);
    return status || parts > 1 || !c->what->states ? status : write_states(c, error);
}

static fp3_status write_files(const comparison *c, fp3_error *error) {
    const fp3_scene_solved *s = &c->solved;
    fp3_status status = FP3_OK;
    if (c->what->csv)
        status = fp3_bench_csv(c->what->csv, c->rows, error);
    if (status || !c->what->json)
        return status;
    json_t *all = json_pack(
        "{s:s, s:I, s:I, s:{s:s, s:I, s:I, s:o, s:I, s:s}, s:s, s:O, s:O}", "scene", c->scene->path,
        "objects", (json_int_t)c->scene->objects, "steps", (json_int_t)c->steps[c->times - 1],
        "solution", "method", s->method, "parts", (json_int_t)s->parts, "extrapolated_order",
        (json_int_t)s->extrapolated, "apart", fp3_json_number(s->known ? s->apart : NAN),
        "known_until_step", (json_int_t)(s->known ? c->steps[s->known - 1] : 0), "why", s->why,
        "no_method", c->no_method.text, "rows", c->rows, "invariants", c->kept);
    return fp3_json_write(c->what->json, all, 9, error);
}

static fp3_status judge(const comparison *c, fp3_error *error) {
    if (c->failure.text[0])
        return fp3_fail(error, FP3_E_FAILED, "%s", c->failure.text);
    if (c->solved.known < c->times)
        return fp3_fail(error, FP3_E_FAILED, "%s: no solution %s step %" PRIu64 ": %s",
                        c->scene->path, c->solved.known ? "after" : "at",
                        c->steps[c->solved.known ? c->solved.known - 1 : 0], c->solved.why);
    return FP3_OK;
}

static fp3_status find_invariants(comparison *c, fp3_error *error) {
    fp3_status status = fp3_scene_invariants_open(c->scene, c->steps, &c->invariants, error);
    if (status)
        return status;
    c->changed = calloc(
        (c->what->halvings + 1u) * (size_t)CHANGES * fp3_scene_invariants_count(c->invariants) + 1,
        sizeof *c->changed);
    return c->changed ? FP3_OK : fp3_no_memory(error);
}

static fp3_status compare(comparison *c, fp3_error *error) {
    fp3_status status = solve(c, error);
    if (!status)
        status = find_invariants(c, error);
    if (status)
        return status;
    /* Without a solution, the scene's own steps tell the sizes. */
    if (!c->solved.known)
        status = fp3_scene_in_double(c->scene, 1, c->steps, c->times, c->method, error);
    if (status)
        return status;
    fp3_scene_sizes(c->scene, c->solved.known ? c->solution : c->method, c->times, c->sizes);
    fp3_progress_pause(c->progress);
    print_head(c);
    fp3_progress_resume(c->progress);
    for (uint32_t k = 0; !status && k <= c->what->halvings; k++)
        status = compare_parts(c, k, error);
    if (!status)
        put_invariants(c);
    if (!status && c->no_method.text[0])
        printf("\nnot known what of it FP32 costs: %s\n", c->no_method.text);
    if (!status)
        status = write_files(c, error);
    return status ? status : judge(c, error);
}

static fp3_status take_room(comparison *c, fp3_error *error) {
    const uint64_t all = c->what->steps ? c->what->steps : c->scene->steps;
    if (!all)
        return fp3_fail(error, FP3_E_ARGUMENT, "%s: found 'steps = 0', expected steps to compare",
                        c->what->path);
    c->times = all < TIMES ? all : TIMES;
    for (size_t i = 0; i < c->times; i++)
        c->steps[i] = all / c->times * (i + 1) + all % c->times * (i + 1) / c->times;
    c->width = fp3_scene_truth_width(c->scene);
    const size_t numbers = c->width * c->times + 1;
    c->solution = calloc(numbers, sizeof *c->solution);
    c->method = calloc(numbers, sizeof *c->method);
    c->engine = calloc(numbers, sizeof *c->engine);
    c->sizes = calloc(c->width + 1, sizeof *c->sizes);
    c->engine_start = calloc(c->width + 1, sizeof *c->engine_start);
    return c->solution && c->method && c->engine && c->sizes && c->engine_start
               ? FP3_OK
               : fp3_no_memory(error);
}

static fp3_status check(const fp3_compare_scene *what, const fp3_scene *scene, fp3_error *error) {
    for (size_t i = 0; i < scene->group_count; i++) {
        const fp3_scene_group *group = &scene->groups[i];
        fp3_files files = {0};
        fp3_files_read_group(&files, group);
        fp3_files_write(&files, "--json", what->json);
        fp3_files_write(&files, "--csv", what->csv);
        fp3_files_write(&files, "--states", what->states);
        const fp3_status status = fp3_files_check(&files, error);
        if (status)
            return status;
    }
    return FP3_OK;
}

fp3_status fp3_compare_scene_run(const fp3_compare_scene *what, fp3_error *error) {
    fp3_files files = {0};
    fp3_files_read(&files, "SCENE", what->path);
    fp3_files_write(&files, "--json", what->json);
    fp3_files_write(&files, "--csv", what->csv);
    fp3_files_write(&files, "--states", what->states);
    fp3_status status = fp3_files_check(&files, error);
    if (status)
        return status;
    fp3_scene *scene = NULL;
    comparison c = {.what = what, .rows = json_array(), .kept = json_array()};
    c.progress = fp3_progress_begin("compare", what->path);
    fp3_progress_say(c.progress, "reading and compiling");
    status = fp3_scene_open(what->path, what->config, &scene, error);
    c.scene = scene;
    if (!status)
        status = check(what, scene, error);
    if (!status)
        status = take_room(&c, error);
    if (!status)
        status = compare(&c, error);
    fp3_progress_end(&c.progress);
    json_decref(c.rows);
    json_decref(c.kept);
    fp3_scene_invariants_close(&c.invariants);
    free(c.changed);
    free(c.engine_start);
    free(c.solution);
    free(c.method);
    free(c.engine);
    free(c.sizes);
    fp3_scene_close(&scene);
    return status;
}
