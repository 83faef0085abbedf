/* SPDX-License-Identifier: Apache-2.0 */
/* tune_plot.c - see tune_plot.h. Each candidate is a curve through its runs. A family of
 * integrators has a colour, an arithmetic a mark; the line says how steps are made, and an open
 * mark that their length is not h.
 */
#include "tune_plot.h"

#include "record/family.h"
#include "record/gnuplot.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { WIDTH = 960, HEIGHT = 620 };
#define LEFT 0.09
#define RIGHT 0.71
#define WORST 10.0 /* larger errors say no more than that a run went wrong */

typedef struct {
    const char *path;
    const fp3_tune_def *def;
    const fp3_tuning *t;
} picture;

typedef struct {
    const char *name, *dash;
} look;

/* fixed, cut, adaptive */
static const look steps[] = {
    {"fixed steps", "1"}, {"fixed, cut at events", "(2,3)"}, {"adaptive steps", "(8,4)"}};

static size_t steps_of(const fp3_tune_row *r) { return r->is_adaptive ? 2 : r->is_cut ? 1 : 0; }

/* Filled and open: squares, circles, triangles, diamonds. */
static int mark_of(fp3_arithmetic arithmetic, int is_open) {
    static const int filled[] = {7, 5, 9, 13};
    return filled[(size_t)arithmetic % (sizeof filled / sizeof *filled)] - is_open;
}

/* ---- data ---- */

static int is_drawn(const fp3_tune_look *l) {
    return l->error > 0 && l->error <= WORST && l->cycles > 0;
}

static size_t drawn(const fp3_tune_row *r) {
    size_t count = 0;
    for (uint32_t i = 0; i < r->looks; i++)
        count += (size_t)is_drawn(&r->look[i]);
    return count;
}

static int compare(const void *a, const void *b) {
    const fp3_tune_look *x = a, *y = b;
    return x->cycles != y->cycles ? (x->cycles > y->cycles) - (x->cycles < y->cycles)
                                  : (x->error > y->error) - (x->error < y->error);
}

/* The cheapest first. */
static void put_row(FILE *out, const fp3_tune_row *r) {
    fp3_tune_look sorted[FP3_TUNE_LOOKS_MOST];
    memcpy(sorted, r->look, sizeof sorted);
    qsort(sorted, r->looks, sizeof *sorted, compare);
    for (uint32_t i = 0; i < r->looks; i++)
        if (is_drawn(&sorted[i]))
            fprintf(out, "%.9g %.9g\n", sorted[i].cycles, sorted[i].error);
    fputs("\n\n", out);
}

static void put_data(FILE *out, const fp3_tuning *t) {
    fputs("$data << END\n", out);
    for (size_t i = 0; i < t->row_count; i++)
        if (drawn(&t->rows[i]))
            put_row(out, &t->rows[i]);
    fputs("END\n", out);
}

/* ---- the legend ---- */

static int has_family(const fp3_tuning *t, const fp3_family *family) {
    int has = 0;
    for (size_t i = 0; i < t->row_count; i++)
        has |= drawn(&t->rows[i]) && fp3_family_of_integrator(t->rows[i].integrator) == family;
    return has;
}

static int has_arithmetic(const fp3_tuning *t, fp3_arithmetic arithmetic) {
    int has = 0;
    for (size_t i = 0; i < t->row_count; i++)
        has |= drawn(&t->rows[i]) && t->rows[i].arithmetic == arithmetic;
    return has;
}

static int has_steps(const fp3_tuning *t, size_t kind) {
    int has = 0;
    for (size_t i = 0; i < t->row_count; i++)
        has |= drawn(&t->rows[i]) && steps_of(&t->rows[i]) == kind;
    return has;
}

static void put_legend(FILE *out, const fp3_tuning *t) {
    fp3_gnuplot_heading(out, "integrator");
    const fp3_family *family;
    for (size_t i = 0; (family = fp3_family_of_integrators(i)); i++)
        if (has_family(t, family))
            fprintf(out, ", keyentry with lines lc rgb '%s' lw 4 title '%s'", family->colour,
                    family->name);
    fp3_gnuplot_heading(out, " ");
    fp3_gnuplot_heading(out, "arithmetic");
    for (fp3_arithmetic a = 0; a < FP3_ARITHMETICS; a++)
        if (has_arithmetic(t, a))
            fprintf(out, ", keyentry with points pt %d ps 0.8 lc rgb '#000000' title '%s'",
                    mark_of(a, 0), fp3_arithmetic_of(a)->name);
    fp3_gnuplot_heading(out, " ");
    fp3_gnuplot_heading(out, "steps");
    for (size_t i = 0; i < sizeof steps / sizeof *steps; i++)
        if (has_steps(t, i))
            fprintf(out,
                    ", keyentry with linespoints pt %d ps 0.8 lc rgb '#000000' dt %s title '%s'",
                    mark_of(FP3_PLAIN, i > 0), steps[i].dash, steps[i].name);
}

/* ---- the whole ---- */

/* Whole decades, so that the bound goes from edge to edge. */
static void put_range(FILE *out, const fp3_tuning *t) {
    double least = t->baseline_cycles, most = least;
    for (size_t i = 0; i < t->row_count; i++)
        for (uint32_t k = 0; k < t->rows[i].looks; k++)
            if (is_drawn(&t->rows[i].look[k])) {
                least = fmin(least, t->rows[i].look[k].cycles);
                most = fmax(most, t->rows[i].look[k].cycles);
            }
    fprintf(out, "set xrange [%g:%g]\n", pow(10, floor(log10(least))), pow(10, ceil(log10(most))));
}

static void put_title(const picture *p, FILE *out) {
    const fp3_tuning *t = p->t;
    fprintf(out, "set title \"%s from 0 to %.9g: error against cost of all that was tried",
            p->def->program->model->name, t->span);
    if (t->best < t->row_count) {
        const fp3_tune_row *best = &t->rows[t->best];
        fprintf(out, "\\n%s: %s, %s, %s", t->is_met ? "chosen" : "chosen, and does not hold",
                best->integrator, fp3_arithmetic_of(best->arithmetic)->name,
                steps[steps_of(best)].name);
        fprintf(out, best->is_adaptive ? ", tolerance %.3g" : ", h = %.9g",
                best->is_adaptive ? best->tolerance : (double)best->h);
    }
    fputs("\"\n", out);
}

static void put_curves(FILE *out, const fp3_tuning *t) {
    size_t block = 0;
    for (size_t i = 0; i < t->row_count; i++) {
        const fp3_tune_row *r = &t->rows[i];
        if (drawn(r))
            fprintf(out,
                    "%s $data index %zu using 1:2 with linespoints lc rgb '%s' lw 1 dt %s pt %d "
                    "ps 0.6 notitle",
                    block ? "," : "", block, fp3_family_of_integrator(r->integrator)->colour,
                    steps[steps_of(r)].dash, mark_of(r->arithmetic, steps_of(r) > 0)),
                block++;
    }
}

static void put_point(FILE *out, double x, double y, const char *how, const char *title) {
    fprintf(out, ", '+' using (%.9g):(%.9g) every ::0::0 with points %s title '%s'", x, y, how,
            title);
}

static void put_bounds(const picture *p, FILE *out) {
    const fp3_tuning *t = p->t;
    fprintf(out,
            ", %.9g with lines lc rgb '#000000' lw 2 title 'tolerance %g'"
            ", %.9g with lines lc rgb '#000000' lw 1 dt (2,3) title 'the sample must meet %.3g'",
            p->def->tolerance, p->def->tolerance, t->target, t->target);
    if (isfinite(t->baseline_error) && t->baseline_error > 0 && t->baseline_error <= WORST)
        put_point(out, t->baseline_cycles, t->baseline_error, "pt 3 ps 1.2 lw 2 lc rgb '#000000'",
                  "rk4 with the step of the model");
    if (t->best < t->row_count)
        put_point(out, t->rows[t->best].cycles, t->rows[t->best].error,
                  "pt 6 ps 2.4 lw 2 lc rgb '#000000'", "chosen");
}

static void write_script(const void *user, FILE *out) {
    const picture *p = user;
    fp3_gnuplot_begin(out, p->path, WIDTH, HEIGHT, RIGHT);
    fp3_gnuplot_logarithmic(out);
    fprintf(out, "set lmargin at screen %g\nset rmargin at screen %g\nset samples 2\n", LEFT,
            RIGHT);
    put_title(p, out);
    fprintf(out,
            "set xlabel 'cycles of %s for one object, all steps'\n"
            "set ylabel 'largest error of a state, relative, of the worst object'\n",
            p->def->config);
    put_range(out, p->t);
    put_data(out, p->t);
    fputs("plot", out);
    put_curves(out, p->t);
    put_bounds(p, out);
    fp3_gnuplot_heading(out, " ");
    put_legend(out, p->t);
    putc('\n', out);
}

fp3_status fp3_tune_plot(const char *path, const fp3_tune_def *def, const fp3_tuning *t,
                         fp3_error *error) {
    const picture p = {path, def, t};
    size_t count = 0;
    for (size_t i = 0; i < t->row_count; i++)
        count += drawn(&t->rows[i]);
    return count ? fp3_gnuplot_save(write_script, &p, path, error)
                 : fp3_fail(error, FP3_E_FAILED, "%s: no run has an error to draw", path);
}
