/* bench_files.c - see bench_files.h. */
#include "bench_files.h"

#include "base/file.h"
#include "base/host.h"
#include "output/gnuplot.h"
#include "text/number.h"

#include <string.h>

/* ---- the table ---- */

static void put_text(FILE *out, const char *text) {
    const int is_quoted = strpbrk(text, ",\"\r\n") != NULL;
    if (is_quoted)
        putc('"', out);
    for (; *text; text++) {
        if (*text == '"')
            putc('"', out);
        putc(*text, out);
    }
    if (is_quoted)
        putc('"', out);
}

/* Nothing where there is no value. */
static void put_value(FILE *out, const json_t *value) {
    if (json_is_string(value))
        put_text(out, json_string_value(value));
    else if (json_is_integer(value))
        fprintf(out, "%" JSON_INTEGER_FORMAT, json_integer_value(value));
    else if (json_is_real(value))
        fprintf(out, "%.9g", json_real_value(value));
}

static void put_table(FILE *out, const json_t *points) {
    const char *key;
    json_t *value, *point, *first = json_array_get(points, 0);
    size_t i;
    int is_next = 0;
    json_object_foreach(first, key, value) { fprintf(out, "%s%s", is_next++ ? "," : "", key); }
    fputs("\r\n", out);
    json_array_foreach(points, i, point) {
        is_next = 0;
        json_object_foreach(first, key, value) {
            fputs(is_next++ ? "," : "", out);
            put_value(out, json_object_get(point, key));
        }
        fputs("\r\n", out);
    }
}

fp3_status fp3_bench_csv(const char *path, const json_t *points, fp3_error *error) {
    fp3_output *output = NULL;
    fp3_status status = fp3_output_open(path, &output, error);
    if (status)
        return status;
    FP3_HOST;
    put_table(fp3_output_stream(output), points);
    status = fp3_output_publish(output, error);
    fp3_output_close(&output);
    return status;
}

/* ---- the picture: a panel for each model and unit, a curve for each way to run ---- */

enum {
    WIDTH = 960,
    TITLE = 40,
    PANEL = 440,
    BELOW = 64,
    ABOVE = 32,
    CURVES_MOST = 32,
    PANELS_MOST = 128
};
#define LEFT 0.1
#define RIGHT 0.77

typedef struct {
    const char *path;
    const json_t *shown;
} picture;

typedef struct {
    const json_t *first[PANELS_MOST]; /* a point of each */
    size_t count;
    const char *curves[CURVES_MOST];
    size_t curve_count;
} panels;

static const char *text_of(const json_t *point, const char *key) {
    return json_string_value(json_object_get(point, key));
}

static int is_same(const json_t *a, const json_t *b, const char *key) {
    return a && b && !strcmp(text_of(a, key), text_of(b, key));
}

/* Same panel: model and unit. */
static int is_beside(const json_t *a, const json_t *b) {
    return is_same(a, b, "model") && is_same(a, b, "unit");
}

/* The first point of each panel of this unit. */
static void find_panels(const json_t *shown, const char *unit, panels *found) {
    json_t *point;
    size_t i;
    json_array_foreach(shown, i, point) {
        int is_new = !strcmp(text_of(point, "unit"), unit) && found->count < PANELS_MOST;
        for (size_t j = 0; j < found->count && is_new; j++)
            is_new = !is_beside(found->first[j], point);
        if (is_new)
            found->first[found->count++] = point;
    }
}

/* Which of all curves it is: a curve has one colour in all panels. */
static size_t curve_of(panels *all, const char *name) {
    size_t i = 0;
    while (i < all->curve_count && strcmp(all->curves[i], name) != 0)
        i++;
    if (i == all->curve_count && i < CURVES_MOST)
        all->curves[all->curve_count++] = name;
    return i;
}

/* A block of data for each curve of the panel. Returns how many there are. */
static size_t put_data(FILE *out, const json_t *shown, const json_t *panel,
                       const char *curves[CURVES_MOST]) {
    const json_t *before = NULL;
    json_t *point;
    size_t count = 0, i;
    fputs("$data << END\n", out);
    json_array_foreach(shown, i, point) {
        if (!is_beside(point, panel))
            continue;
        if (!is_same(before, point, "curve")) {
            if (count == CURVES_MOST)
                break;
            fputs(count ? "\n\n" : "", out);
            curves[count++] = text_of(point, "curve");
        }
        before = point;
        fprintf(out, "%.9g %.9g\n", json_real_value(json_object_get(point, "cost")),
                json_real_value(json_object_get(point, "error")));
    }
    fputs("END\n", out);
    return count;
}

static void put_panel(FILE *out, const json_t *shown, panels *all, size_t number) {
    const json_t *panel = all->first[number];
    const double height = TITLE + (double)all->count * PANEL, top = TITLE + (double)number * PANEL;
    const int is_time = strcmp(text_of(panel, "unit"), "ns") == 0;
    const char *curves[CURVES_MOST];
    const size_t count = put_data(out, shown, panel, curves);
    fprintf(out,
            "set tmargin at screen %.6f\nset bmargin at screen %.6f\n"
            "set title '%s: error against %s'\nset xlabel '%s for one object, all steps'\nplot",
            1 - (top + ABOVE) / height, 1 - (top + PANEL - BELOW) / height, text_of(panel, "model"),
            is_time ? "time" : "cycles of hardware", text_of(panel, "unit"));
    for (size_t i = 0; i < count; i++) {
        const size_t curve = curve_of(all, curves[i]);
        fprintf(out,
                "%s $data index %zu with linespoints lc rgb '%s' lw 1.5 pt %zu ps 0.6 title '%s'",
                i ? "," : "", i, fp3_gnuplot_colour(curve), 4 + curve % 10, curves[i]);
    }
    putc('\n', out);
}

static void write_script(const void *user, FILE *out) {
    const picture *p = user;
    panels found = {.count = 0};
    find_panels(p->shown, "ns", &found);
    find_panels(p->shown, "cycles", &found);
    fp3_gnuplot_begin(out, p->path, WIDTH, TITLE + (int)found.count * PANEL);
    fprintf(out,
            "set encoding utf8\nset grid lt 1 lc rgb '#dddddd'\nset logscale xy\n"
            "set format '%%.0e'\nset ylabel 'error (relative, median of the objects)'\n"
            "set key at screen %g, graph 1 left top Left reverse\n"
            "set lmargin at screen %g\nset rmargin at screen %g\n"
            "set multiplot title 'Each curve: the points that no faster one is as accurate as'\n",
            RIGHT + 0.01, LEFT, RIGHT);
    for (size_t i = 0; i < found.count; i++)
        put_panel(out, p->shown, &found, i);
    fputs("unset multiplot\n", out);
}

fp3_status fp3_bench_plot_check(const char *path, fp3_error *error) {
    const fp3_status status = fp3_gnuplot_check_name(path, error);
    return status ? status : fp3_gnuplot_check(error);
}

fp3_status fp3_bench_plot(const char *path, const json_t *shown, fp3_error *error) {
    const picture p = {path, shown};
    fp3_output *output = NULL;
    if (!json_array_size(shown))
        return fp3_fail(error, FP3_E_FAILED, "%s: no point has an error: nothing to draw", path);
    fp3_status status = fp3_output_open(path, &output, error);
    if (!status)
        status = fp3_gnuplot_draw(write_script, &p, output, error);
    fp3_output_close(&output);
    return status;
}
