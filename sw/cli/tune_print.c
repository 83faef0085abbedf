/* SPDX-License-Identifier: Apache-2.0 */
/* tune_print.c - see tune_print.h. */
#include "tune_print.h"

#include "base/file.h"
#include "base/path.h"
#include "json.h"
#include "lab/tune/meter.h"

#include <inttypes.h>
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define TEXT_SIZE 32

int fp3_tune_print_has_ranges(const fp3_params *params) { return fp3_sample_ranges(params) > 0; }

/* ---- what is said ---- */

static const fp3_tune_row *best_of(const fp3_tuning *t) {
    return t->best < t->row_count ? &t->rows[t->best] : NULL;
}

/* The one with the smallest error; NULL: nothing was measured. */
static const fp3_tune_row *lowest_of(const fp3_tuning *t) {
    const fp3_tune_row *lowest = NULL;
    for (size_t i = 0; i < t->row_count; i++)
        if (isfinite(t->rows[i].lowest) && (!lowest || t->rows[i].lowest < lowest->lowest))
            lowest = &t->rows[i];
    return lowest;
}

/* "0.00123", "cut 0.00123", or "tol 1.5e-05" of adaptive steps. */
static const char *step_of(const fp3_tune_row *r, char text[TEXT_SIZE]) {
    if (r->is_adaptive)
        snprintf(text, TEXT_SIZE, "tol %.3g", r->tolerance);
    else if (r->is_cut)
        snprintf(text, TEXT_SIZE, "cut %.5g", (double)r->h);
    else
        snprintf(text, TEXT_SIZE, "%.9g", (double)r->h);
    return text;
}

static int is_tried(const fp3_tune_row *r) { return r->steps || r->tolerance > 0; }

static void print_rows(const fp3_tuning *t) {
    char text[TEXT_SIZE];
    printf("%-20s %-13s %9s %13s %9s %12s  %s\n", "integrator", "arithmetic", "steps", "h", "error",
           "cycles", "");
    for (size_t i = 0; i < t->row_count; i++) {
        const fp3_tune_row *r = &t->rows[i];
        if (is_tried(r))
            printf("%-20s %-13s %9.*f %13s %9.2e %12.1f  %s%s\n", r->integrator,
                   fp3_arithmetic_of(r->arithmetic)->name, r->is_adaptive || r->is_cut,
                   r->is_adaptive || r->is_cut ? r->attempts : (double)r->steps, step_of(r, text),
                   r->error, r->cycles, i == t->best ? "the cheapest: " : "", r->why);
        else
            printf("%-20s %-13s %9s %13s %9s %12s  %s%s\n", r->integrator,
                   fp3_arithmetic_of(r->arithmetic)->name, "-",
                   r->is_adaptive ? "tol -"
                   : r->is_cut    ? "cut -"
                                  : "-",
                   "-", "-", "", r->why);
    }
}

/* Where the errors are from. */
static void print_looks(const fp3_tune_row *best) {
    const uint64_t every = fp3_path_every(best->steps);
    printf("%-16s ", "errors");
    if (best->is_adaptive || best->is_cut)
        printf("the largest after each of the first %d attempts, then after each in a thousand\n",
               2 * FP3_TUNE_LOOKS - 1);
    else if (every == 1)
        printf("the largest after each step\n");
    else
        printf("the largest at %" PRIu64 " times of the span: after every %" PRIu64
               " steps, and the last\n",
               (best->steps + every - 1) / every, every);
}

static void print_choice(const fp3_tune_row *best, double baseline) {
    printf("%-16s %s, %s, ", "chosen", best->integrator, fp3_arithmetic_of(best->arithmetic)->name);
    if (best->is_adaptive)
        printf("adaptive steps, tolerance = %.9g, absolute = %.9g, %.1f attempts", best->tolerance,
               best->absolute, best->attempts);
    else if (best->is_cut)
        printf("h = %.9g, cut at events, %.1f attempts", (double)best->h, best->attempts);
    else
        printf("h = %.9g, %" PRIu64 " steps to %.9g", (double)best->h, best->steps,
               (double)best->h * (double)best->steps);
    printf(": %.1f cycles, %.3f of the baseline, error %.2e\n", best->cycles,
           best->cycles / baseline, best->error);
    print_looks(best);
}

/* If none of n independent objects is beyond, a share p of the range is with (1 - p)^n. */
static void print_held_out(const fp3_tuning *t) {
    if (!t->ranges) {
        printf("%-16s none: without ranges only one set of parameters was tried\n", "held out");
        return;
    }
    printf("%-16s error %.2e at most, over %" PRIu32 " objects that were not in the sample",
           "held out", t->error_held_out, t->held_out);
    if (t->rounds > 1)
        printf("; this is held-out sample %" PRIu32
               ": earlier samples failed and joined the sample",
               t->rounds);
    putchar('\n');
    if (t->is_met)
        printf("%-16s with 95 %% confidence, the error is above the tolerance on at most %.1f %% "
               "of the "
               "ranges\n",
               "safety", 100 * (1 - pow(0.05, 1.0 / t->held_out)));
}

void fp3_tune_print_all(const fp3_tune_print *out, const fp3_tune_def *def, const fp3_tuning *t) {
    const fp3_tune_row *best = best_of(t);
    print_rows(t);
    printf("%-16s %s from 0 to %.9g, error at most %g; the sample (%" PRIu32 " object%s, %" PRIu32
           " range%s) must meet %g\n",
           "asked", out->program, t->span, def->tolerance, t->sample, t->sample == 1 ? "" : "s",
           t->ranges, t->ranges == 1 ? "" : "s", t->target);
    printf("%-16s rk4, plain, %" PRIu64 " steps of the model's h: %.1f cycles, error %.2e\n",
           "baseline", t->baseline_steps, t->baseline_cycles, t->baseline_error);
    if (t->sensitive[0])
        printf("%-16s one unit in the last place of '%s' alone moves the result by %.2e\n",
               "sensitivity", t->sensitive, t->sensitivity);
    if (!best)
        return;
    print_choice(best, t->baseline_cycles);
    print_held_out(t);
}

fp3_status fp3_tune_print_judge(const fp3_tune_def *def, const fp3_tuning *t, fp3_error *error) {
    const fp3_tune_row *lowest = lowest_of(t);
    if (t->is_met)
        return FP3_OK;
    if (best_of(t))
        return fp3_fail(error, FP3_E_FAILED,
                        "the choice does not hold: in each of %" PRIu32
                        " held-out samples an object has a larger error than %g",
                        t->rounds, def->tolerance);
    if (!lowest)
        return fp3_fail(error, FP3_E_FAILED, "nothing meets the tolerance %g: every run went wrong",
                        def->tolerance);
    char sensitivity[FP3_NAME_SIZE + 80] = "";
    if (t->sensitivity > def->tolerance)
        snprintf(sensitivity, sizeof sensitivity,
                 "; one unit in the last place of '%s' alone moves the result by %.2e",
                 t->sensitive, t->sensitivity);
    return fp3_fail(error, FP3_E_FAILED,
                    "nothing meets the tolerance %g: the smallest error that was found is %.2e, by "
                    "%s, %s%s",
                    def->tolerance, lowest->lowest, lowest->integrator,
                    fp3_arithmetic_of(lowest->arithmetic)->name, sensitivity);
}

/* ---- files ---- */

/* Null where there is none: h of adaptive steps, a tolerance of fixed ones. */
static json_t *above_zero(double x) { return fp3_json_number(x > 0 ? x : NAN); }

static int put_sensitivity(json_t *o, const fp3_tuning *t) {
    return json_object_set_new(o, "sensitivity", fp3_json_number(t->sensitivity)) |
           json_object_set_new(o, "sensitive", json_string(t->sensitive));
}

static int put_steps(json_t *o, const fp3_tune_row *r) {
    return json_object_set_new(o, "steps", json_integer((json_int_t)(r ? r->steps : 0))) |
           json_object_set_new(o, "h", above_zero(r ? (double)r->h : 0)) |
           json_object_set_new(o, "adaptive_tolerance", above_zero(r ? r->tolerance : 0)) |
           json_object_set_new(o, "absolute", above_zero(r ? r->absolute : 0)) |
           json_object_set_new(o, "cut", json_boolean(r && r->is_cut)) |
           json_object_set_new(o, "attempts", above_zero(r ? r->attempts : 0));
}

/* Of each run of the sample what it cost, and its error. */
static json_t *looks(const fp3_tune_row *r) {
    json_t *list = json_array();
    for (uint32_t i = 0; i < r->looks; i++)
        json_array_append_new(list, json_pack("[o, o]", fp3_json_number(r->look[i].cycles),
                                              fp3_json_number(r->look[i].error)));
    return list;
}

static json_t *tried(const fp3_tuning *t) {
    json_t *rows = json_array();
    for (size_t i = 0; i < t->row_count; i++) {
        const fp3_tune_row *r = &t->rows[i];
        json_t *o = json_pack("{s:s, s:s, s:b, s:o, s:o, s:o, s:s}", "integrator", r->integrator,
                              "arithmetic", fp3_arithmetic_of(r->arithmetic)->name, "adaptive",
                              r->is_adaptive, "error", fp3_json_number(r->error), "lowest",
                              fp3_json_number(r->lowest), "cycles", fp3_json_number(r->cycles),
                              "why", r->why);
        put_steps(o, r);
        json_object_set_new(o, "looks", looks(r));
        json_array_append_new(rows, o);
    }
    return rows;
}

static fp3_status write_json(const fp3_tune_print *out, const fp3_tune_def *def,
                             const fp3_tuning *t, fp3_error *error) {
    const fp3_tune_row *best = best_of(t), *lowest = lowest_of(t), *row = best ? best : lowest;
    json_t *all = json_pack(
        "{s:s, s:f, s:s, s:o, s:o, s:o, s:o, s:o, s:b, s:o, s:o, s:o, s:o, s:I, s:I, s:I, s:I, "
        "s:o}",
        "model", def->program->model->name, "tolerance", def->tolerance, "config", def->config,
        "integrator", row ? json_string(row->integrator) : json_null(), "arithmetic",
        row ? json_string(fp3_arithmetic_of(row->arithmetic)->name) : json_null(), "error",
        row ? fp3_json_number(best ? best->error : row->lowest) : json_null(), "error_held_out",
        fp3_json_number(t->error_held_out), "cost_ratio",
        best ? fp3_json_number(best->cycles / t->baseline_cycles) : json_null(), "met", t->is_met,
        "cycles", best ? fp3_json_number(best->cycles) : json_null(), "baseline_cycles",
        fp3_json_number(t->baseline_cycles), "baseline_error", fp3_json_number(t->baseline_error),
        "span", fp3_json_number(t->span), "ranges", (json_int_t)t->ranges, "sample",
        (json_int_t)t->sample, "held_out", (json_int_t)t->held_out, "rounds", (json_int_t)t->rounds,
        "tried", tried(t));
    if (all && (put_steps(all, best) || put_sensitivity(all, t) ||
                json_object_set_new(all, "arithmetics", fp3_tune_machines_json(out->machines)))) {
        json_decref(all);
        all = NULL;
    }
    return fp3_json_write(out->json, all, 9, error);
}

/* The model as seen from the folder of the scene, both behind all links. */
static char *name_from(const char *model, const char *scene) {
    const char *at = fp3_path_stream(scene, 1) >= 0 ? "./-" : scene;
    char *to = fp3_path_resolve(model), *from = fp3_path_resolve(at), *name = NULL;
    if (to && from) {
        size_t same = 0, up = 0;
        for (size_t i = 0; to[i] && to[i] == from[i]; i++)
            if (to[i] == '/')
                same = i + 1;
        for (const char *c = from + same; *c; c++)
            up += *c == '/';
        name = malloc(3 * up + strlen(to + same) + 1);
        if (name) {
            *name = '\0';
            while (up--)
                strcat(name, "../");
            strcat(name, to + same);
        }
    }
    free(to);
    free(from);
    return name;
}

static fp3_status write_scene(const fp3_tune_print *out, const fp3_tune_def *def,
                              const fp3_tuning *t, uint32_t objects, fp3_error *error) {
    char *text = NULL, *name = name_from(out->program, out->scene);
    fp3_status status = name ? fp3_tuning_scene(def, t, name, objects, &text, error)
                             : fp3_path_fail(error, out->scene, "cannot name the model from there");
    if (!status)
        status = fp3_file_write(out->scene, text, strlen(text), error);
    free(text);
    free(name);
    return status;
}

fp3_status fp3_tune_print_files(const fp3_tune_print *out, const fp3_tune_def *def,
                                const fp3_tuning *t, uint32_t objects, fp3_error *error) {
    fp3_status status = out->json ? write_json(out, def, t, error) : FP3_OK;
    if (!status && out->scene && t->is_met)
        status = write_scene(out, def, t, objects, error);
    return status;
}
