/* SPDX-License-Identifier: Apache-2.0 */
/* bench_plot.c - see bench_files.h: a panel for each model and unit, a curve for each way to run.
 */
#include "bench_files.h"

#include "record/family.h"

#include <stdlib.h>
#include <string.h>

enum {
    WIDTH = 960,
    TITLE = 34,
    PANEL = 470,
    ABOVE = 36,
    BELOW = 74,
    CURVES_MOST = 32,
    PANELS_MOST = 128
};
#define LEFT 0.09
#define RIGHT 0.77

/* Of curves that have one colour: the first, the second, ... */
static const struct {
    const char *dash;
    int mark;
} looks[] = {{"1", 7},  {"(8,4)", 4}, {"(2,3)", 9},  {"(8,3,2,3)", 12},
             {"1", 10}, {"(8,4)", 5}, {"(2,3)", 13}, {"(8,3,2,3)", 6}};
#define LOOKS (sizeof looks / sizeof *looks)

typedef struct {
    const char *name;
    const fp3_family *family;
    size_t look;
} curve;

typedef struct {
    const json_t *first[PANELS_MOST]; /* a point of each */
    size_t count;
    curve curves[CURVES_MOST]; /* of all panels: a curve looks the same in each */
    size_t curve_count;
} panels;

static const char *text_of(const json_t *point, const char *key) {
    return json_string_value(json_object_get(point, key));
}

static double number_of(const json_t *point, const char *key) {
    return json_real_value(json_object_get(point, key));
}

static int is_same(const json_t *a, const json_t *b, const char *key) {
    return a && b && !strcmp(text_of(a, key), text_of(b, key));
}

/* Same panel: model and unit. */
static int is_beside(const json_t *a, const json_t *b) {
    return is_same(a, b, "model") && is_same(a, b, "unit");
}

typedef struct {
    const char *path;
    const json_t *shown;
} drawing;

/* The axes have no room for 0. */
static int is_drawn(const json_t *point) {
    return number_of(point, "error") > 0 && number_of(point, "cost") > 0;
}

static size_t count_drawn(const json_t *shown) {
    json_t *point;
    size_t i, count = 0;
    json_array_foreach(shown, i, point) count += (size_t)is_drawn(point);
    return count;
}

/* The first point of each panel of this unit. */
static void find_panels(const drawing *p, const char *unit, panels *found) {
    json_t *point;
    size_t i;
    json_array_foreach(p->shown, i, point) {
        int is_new =
            is_drawn(point) && !strcmp(text_of(point, "unit"), unit) && found->count < PANELS_MOST;
        for (size_t j = 0; j < found->count && is_new; j++)
            is_new = !is_beside(found->first[j], point);
        if (is_new)
            found->first[found->count++] = point;
    }
}

static const curve *curve_of(const panels *all, const char *name) {
    size_t i = 0;
    while (i + 1 < all->curve_count && strcmp(all->curves[i].name, name) != 0)
        i++;
    return &all->curves[i];
}

static int compare(const void *a, const void *b) {
    return strcmp(((const curve *)a)->name, ((const curve *)b)->name);
}

/* Of all models, by their names: a curve looks the same in the picture of each, in whatever order
 * they were measured. */
static void find_curves(const drawing *p, panels *all) {
    json_t *point;
    size_t i;
    json_array_foreach(p->shown, i, point) {
        const char *name = text_of(point, "curve");
        const int is_new = !all->curve_count || strcmp(curve_of(all, name)->name, name) != 0;
        if (is_new && all->curve_count < CURVES_MOST)
            all->curves[all->curve_count++] =
                (curve){name, fp3_family_of_solver(text_of(point, "engine")), 0};
    }
    qsort(all->curves, all->curve_count, sizeof *all->curves, compare);
    for (i = 0; i < all->curve_count; i++)
        for (size_t k = 0; k < i; k++)
            all->curves[i].look += all->curves[k].family == all->curves[i].family;
}

/* A block of data for each curve of the panel. Returns how many there are. */
static size_t put_data(FILE *out, const drawing *p, const json_t *panel,
                       const json_t *first[CURVES_MOST]) {
    const json_t *before = NULL;
    json_t *point;
    size_t count = 0, i;
    fputs("$data << END\n", out);
    json_array_foreach(p->shown, i, point) {
        if (!is_beside(point, panel) || !is_drawn(point))
            continue;
        if (!is_same(before, point, "curve")) {
            if (count == CURVES_MOST)
                break;
            fputs(count ? "\n\n" : "", out);
            first[count++] = point;
        }
        before = point;
        fprintf(out, "%.9g %.9g\n", number_of(point, "cost"), number_of(point, "error"));
    }
    fputs("END\n", out);
    return count;
}

static void put_panel(FILE *out, const drawing *p, const panels *all, size_t number) {
    const json_t *panel = all->first[number], *first[CURVES_MOST];
    const double height = TITLE + (double)all->count * PANEL, top = TITLE + (double)number * PANEL;
    const int is_time = strcmp(text_of(panel, "unit"), "ns") == 0;
    const size_t count = put_data(out, p, panel, first);
    fprintf(out,
            "set tmargin at screen %.6f\nset bmargin at screen %.6f\n"
            "set title '%s: error against %s'\nset xlabel '%s'\nplot",
            1 - (top + ABOVE) / height, 1 - (top + PANEL - BELOW) / height, text_of(panel, "model"),
            is_time ? "time" : "cycles of hardware",
            is_time ? "time for one object, all steps [ns]"
                    : "cycles of hardware for one object, all steps");
    for (size_t i = 0; i < count; i++) {
        const curve *c = curve_of(all, text_of(first[i], "curve"));
        fprintf(out,
                "%s $data index %zu with linespoints lc rgb '%s' lw 1.5 dt %s pt %d ps 0.6 title "
                "'%s'",
                i ? "," : "", i, c->family->colour, looks[c->look % LOOKS].dash,
                looks[c->look % LOOKS].mark, c->name);
    }
    putc('\n', out);
}

static void write_script(const void *of, FILE *out) {
    const drawing *p = of;
    panels found = {.count = 0};
    find_curves(p, &found);
    find_panels(p, "ns", &found);
    find_panels(p, "cycles", &found);
    fp3_gnuplot_begin(out, p->path, WIDTH, TITLE + (int)found.count * PANEL, RIGHT);
    fp3_gnuplot_logarithmic(out);
    fprintf(
        out,
        "set ylabel 'error (relative, median of the objects)'\n"
        "set lmargin at screen %g\nset rmargin at screen %g\n"
        "set multiplot title 'Each curve: the points that are more accurate than all faster ones' "
        "noenhanced\n",
        LEFT, RIGHT);
    for (size_t i = 0; i < found.count; i++)
        put_panel(out, p, &found, i);
    fputs("unset multiplot\n", out);
}

fp3_status fp3_bench_plot(const char *path, const json_t *shown, fp3_error *error) {
    const drawing p = {path, shown};
    return count_drawn(shown)
               ? fp3_gnuplot_save(write_script, &p, path, error)
               : fp3_fail(error, FP3_E_FAILED, "%s: no point has an error: nothing to draw", path);
}
