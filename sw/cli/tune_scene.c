/* SPDX-License-Identifier: Apache-2.0 */
/* tune_scene.c - see tune_scene.h. */
#include "tune_scene.h"

#include "base/file.h"
#include "base/path.h"
#include "files.h"
#include "json.h"
#include "lab/scene/scaled.h"

#include <inttypes.h>
#include <jansson.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A handler has no other way to tell. */
static volatile sig_atomic_t has_interrupt;

static void interrupt(int number) {
    has_interrupt = 1;
    signal(number, SIG_DFL);
}

static int stop(void *user) {
    (void)user;
    return has_interrupt;
}

static void say(void *user, const char *what) {
    fp3_tune_scene *w = user;
    fp3_progress_say(w->progress, "%s", what);
}

/* ---- what is said ---- */

static const fp3_scene_tune_row *best_of(const fp3_scene_tuning *t) {
    return t->best < t->row_count ? &t->rows[t->best] : NULL;
}

/* The one that kept the target for the longest time; of those, with the smallest error then. */
static const fp3_scene_tune_row *nearest_of(const fp3_scene_tuning *t) {
    const fp3_scene_tune_row *best = NULL;
    for (size_t i = 0; i < t->row_count; i++) {
        const fp3_scene_tune_row *r = &t->rows[i];
        if (isfinite(r->error) &&
            (!best || r->kept > best->kept || (r->kept == best->kept && r->error < best->error)))
            best = r;
    }
    return best;
}

static int is_last_of_its_kind(const fp3_scene_tuning *t, size_t i) {
    for (size_t k = i + 1; k < t->row_count; k++)
        if (t->rows[k].arithmetic == t->rows[i].arithmetic &&
            strcmp(t->rows[k].integrator, t->rows[i].integrator) == 0)
            return 0;
    return 1;
}

static void print_row(const fp3_scene_tuning *t, const fp3_scene_tune_row *r) {
    printf("%-20s %-13s %11.6g %9.2e %13.0f ", r->integrator,
           fp3_arithmetic_of(r->arithmetic)->name, r->h, r->error, r->cycles);
    if (r->ns > 0)
        printf("%11.0f  ", r->ns);
    else
        printf("%11s  ", "-");
    if (r == best_of(t))
        printf("%s", t->is_stopped ? "the cheapest so far" : "the cheapest");
    else if (r->is_met)
        printf("meets the target");
    else
        printf("above the target after step %" PRIu64, r->kept);
    printf("\n");
}

static void print_rows(const fp3_scene_tuning *t) {
    printf("%-20s %-13s %11s %9s %13s %11s\n", "integrator", "arithmetic", "h", "error", "cycles",
           "ns");
    for (size_t i = 0; i < t->row_count; i++)
        if (is_last_of_its_kind(t, i))
            print_row(t, &t->rows[i]);
    for (size_t i = 0; i < t->refusal_count; i++)
        printf("%-20s %-13s %11s %9s %13s %11s  %s\n", t->refusals[i].integrator,
               fp3_arithmetic_of(t->refusals[i].arithmetic)->name, "-", "-", "-", "-",
               t->refusals[i].why);
}

static void print_asked(const fp3_tune_scene *w, const fp3_scene_tuning *t) {
    printf("%-16s %s, %zu objects, %" PRIu64 " of its steps on %s, error at most %g; the sample "
           "(%" PRIu32 " scenes) must meet %g\n",
           "asked", w->def.path, t->objects, t->steps, t->config, w->def.tolerance, t->sample,
           t->target);
    if (t->known < t->steps)
        printf("%-16s errors are known up to step %" PRIu64 " of %" PRIu64 "%s%s\n", "solution",
               t->known, t->steps, t->solved.why[0] ? ": " : "", t->solved.why);
    if (t->known < t->steps && t->within < 0.09 * w->def.tolerance)
        printf("%-16s --within %g is near enough, and errors may be known for longer\n", "",
               w->def.tolerance / 10);
    printf("%-16s %s, %s, h = %.6g: ", "as it is", t->own.integrator,
           fp3_arithmetic_of(t->own.arithmetic)->name, t->own.h);
    printf("%.0f cycles and %.0f ns for an object, error %.2e\n", t->own.cycles, t->own.ns,
           t->own.error);
}

static void print_choice(const fp3_scene_tuning *t, const fp3_scene_tune_row *best) {
    printf("%-16s %s, %s, h = %.6g, %" PRIu64 " steps", "chosen", best->integrator,
           fp3_arithmetic_of(best->arithmetic)->name, best->h,
           t->known / best->joined * best->parts);
    if (t->skin >= 0)
        printf(", skin %g", t->skin);
    printf(": %.3f of the cycles", best->cycles / t->own.cycles);
    if (best->ns > 0 && t->own.ns > 0)
        printf(" and %.3f of the time", best->ns / t->own.ns);
    printf(", error %.2e\n", best->error);
    if (t->held_out)
        printf("%-16s error %.2e at most, in %" PRIu32 " scenes that the choice has not seen: %s\n",
               "held out", t->error_held_out, t->held_out, t->differ);
    if (t->rounds > 1)
        printf("%-16s %" PRIu32 ": cheaper choices did not hold, and the scenes that showed it "
               "joined the sample\n",
               "rounds", t->rounds);
}

static void print(const fp3_tune_scene *w, const fp3_scene_tuning *t) {
    print_rows(t);
    print_asked(w, t);
    if (best_of(t))
        print_choice(t, best_of(t));
}

static fp3_status judge(const fp3_tune_scene *w, const fp3_scene_tuning *t, fp3_error *error) {
    const fp3_scene_tune_row *nearest = nearest_of(t);
    if (t->is_stopped)
        return fp3_fail(error, FP3_E_FAILED, "stopped before the search was done: %s",
                        best_of(t) ? "no held-out scenes have judged the choice"
                        : t->own.is_met
                            ? "the scene as it is meets the target, and nothing cheaper has so far"
                            : "nothing has met the target so far");
    if (t->is_met)
        return FP3_OK;
    if (t->held_out)
        return fp3_fail(error, FP3_E_FAILED,
                        "the choice does not hold: in one of %" PRIu32
                        " held-out scenes its error is %.2e, above %g",
                        t->held_out, t->error_held_out, w->def.tolerance);
    if (!nearest)
        return fp3_fail(error, FP3_E_FAILED, "nothing meets the tolerance %g: every run went wrong",
                        w->def.tolerance);
    return fp3_fail(error, FP3_E_FAILED,
                    "nothing meets the tolerance %g over %" PRIu64 " steps: the longest that the "
                    "target is kept is up to step %" PRIu64 ", by %s, %s, h = %.6g",
                    w->def.tolerance, t->known, nearest->kept, nearest->integrator,
                    fp3_arithmetic_of(nearest->arithmetic)->name, nearest->h);
}

/* ---- files ---- */

static json_t *row_of(const fp3_scene_tune_row *r) {
    return json_pack("{s:s, s:s, s:o, s:I, s:I, s:o, s:I, s:o, s:o, s:b}", "integrator",
                     r->integrator, "arithmetic", fp3_arithmetic_of(r->arithmetic)->name, "h",
                     fp3_json_number(r->h), "parts", (json_int_t)r->parts, "joined",
                     (json_int_t)r->joined, "error", fp3_json_number(r->error), "kept",
                     (json_int_t)r->kept, "cycles", fp3_json_number(r->cycles), "ns",
                     fp3_json_number(r->ns > 0 ? r->ns : NAN), "met", r->is_met);
}

static json_t *rows_of(const fp3_scene_tuning *t) {
    json_t *rows = json_array();
    for (size_t i = 0; i < t->row_count; i++)
        json_array_append_new(rows, row_of(&t->rows[i]));
    return rows;
}

static fp3_status write_json(const fp3_tune_scene *w, const fp3_scene_tuning *t, fp3_error *error) {
    const fp3_scene_tune_row *best = best_of(t);
    json_t *all = json_pack(
        "{s:s, s:f, s:s, s:s, s:I, s:I, s:I, s:b, s:b, s:I, s:o, s:o, s:o, s:I, s:I, s:s, s:o, "
        "s:o}",
        "scene", w->def.path, "tolerance", w->def.tolerance, "config", t->config, "cost",
        w->def.cost == FP3_SCENE_COST_TIME ? "time" : "cycles", "objects", (json_int_t)t->objects,
        "steps", (json_int_t)t->steps, "known_until_step", (json_int_t)t->known, "met", t->is_met,
        "stopped", t->is_stopped, "rounds", (json_int_t)t->rounds, "choice",
        best ? row_of(best) : json_null(), "skin", fp3_json_number(t->skin >= 0 ? t->skin : NAN),
        "error_held_out", fp3_json_number(t->error_held_out), "sample", (json_int_t)t->sample,
        "held_out", (json_int_t)t->held_out, "differ", t->differ, "own", row_of(&t->own), "tried",
        rows_of(t));
    return fp3_json_write(w->json, all, 9, error);
}

static fp3_status write_scene(const fp3_tune_scene *w, const fp3_scene_tuning *t,
                              fp3_error *error) {
    char *text = NULL, *folder = strdup(fp3_path_stream(w->output, 1) >= 0 ? "./-" : w->output);
    fp3_status status = folder ? FP3_OK : fp3_no_memory(error);
    if (!status) {
        char *slash = strrchr(folder, '/');
        strcpy(slash ? slash + 1 : folder, ".");
        status = fp3_scene_tuning_text(&w->def, t, folder, &text, error);
    }
    if (!status)
        status = fp3_file_write(w->output, text, strlen(text), error);
    free(text);
    free(folder);
    return status;
}

static fp3_status check_files(const fp3_tune_scene *w, const fp3_scene *scene, fp3_error *error) {
    for (size_t i = 0; i < scene->group_count; i++) {
        const fp3_scene_group *group = &scene->groups[i];
        fp3_files files = {0};
        fp3_files_read(&files, "program", group->path);
        fp3_files_read(&files, "params", group->params_file);
        for (size_t k = 0; k < group->file_count; k++)
            fp3_files_read(&files, "points or links", group->files[k]);
        fp3_files_write(&files, "--output", w->output);
        fp3_files_write(&files, "--json", w->json);
        const fp3_status status = fp3_files_check(&files, error);
        if (status)
            return status;
    }
    return FP3_OK;
}

static fp3_status find_steps(fp3_tune_scene *w, const fp3_scene *scene, fp3_error *error) {
    const double steps = w->span / fp3_scaled_step(&scene->groups[0]);
    w->def.steps = (uint64_t)round(steps);
    return w->span == 0 || (w->def.steps && fabs(steps - round(steps)) < 1e-3)
               ? FP3_OK
               : fp3_fail(error, FP3_E_ARGUMENT,
                          "--span: found %g, which is %g of the scene's steps; expected a whole "
                          "number of them",
                          w->span, steps);
}

static fp3_status check(fp3_tune_scene *w, fp3_error *error) {
    fp3_scene *scene = NULL;
    fp3_status status = fp3_scene_open(w->def.path, w->def.config, &scene, error);
    if (!status)
        status = check_files(w, scene, error);
    if (!status)
        status = find_steps(w, scene, error);
    fp3_scene_close(&scene);
    return status;
}

fp3_status fp3_tune_scene_run(fp3_tune_scene *w, fp3_error *error) {
    fp3_scene_tuning *t = NULL;
    fp3_status status = check(w, error);
    if (status)
        return status;
    w->def.say = say;
    w->def.stop = stop;
    w->def.user = w;
    void (*const before)(int) = signal(SIGINT, interrupt);
    status = fp3_scene_tune(&w->def, &t, error);
    signal(SIGINT, before);
    fp3_progress_end(&w->progress);
    if (status)
        return status;
    print(w, t);
    if (w->json)
        status = write_json(w, t, error);
    if (!status && w->output && t->is_met)
        status = write_scene(w, t, error);
    if (!status)
        status = judge(w, t, error);
    fp3_scene_tuning_free(&t);
    return status;
}
