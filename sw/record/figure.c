/* SPDX-License-Identifier: Apache-2.0 */
/* figure.c - see figure.h. */
#include "figure.h"

#include "gnuplot.h"
#include "planes.h"

#include <math.h>
#include <string.h>

/* Pixels. */
enum {
    WIDTH = 960,
    TITLE = 40,
    PANEL = 210,
    LABEL = 36,
    PLANE = 460,
    LEAST = 200,
    ABOVE = 8,
    BELOW = 28
};

/* Where data begin and end, as shares of the width: the legend is on the right. */
#define LEFT 0.14
#define RIGHT 0.82
#define MARKS_MOST 40 /* points that are drawn as such, and not lines alone */

static const char *const dashes[FP3_CURVES_MOST] = {
    "1", "(8,4)", "(2,3)", "(8,3,2,3)", "(14,4)", "(4,2)", "(14,3,2,3)", "(8,3,2,3,2,3)"};

/* Between single quotes gnuplot reads nothing; names and units have none. */
static void put_text(FILE *out, const char *text) { fprintf(out, "'%s'", text); }

static void put_label(FILE *out, const char *axis, const char *name, size_t length,
                      const char *unit) {
    char text[FP3_NAME_SIZE + FP3_UNIT_SIZE + 4];
    snprintf(text, sizeof text, *unit ? "%.*s [%s]" : "%.*s", (int)length, name, unit);
    fprintf(out, "set %slabel ", axis);
    put_text(out, text);
    putc('\n', out);
}

static void put_range(FILE *out, const char *axis, fp3_range r) {
    fprintf(out, "set %srange [%.17g:%.17g]\n", axis, r.from, r.to);
}

/* ---- data ---- */

static const double *curve(const fp3_figure *f, size_t name, size_t object) {
    return &f->values[(name * f->object_count + object) * f->points];
}

static void put_number(FILE *out, double value) {
    if (isfinite(value))
        fprintf(out, " %.17g", value);
    else
        fputs(" NaN", out);
}

/* A block for each object: the time, then each name. */
static void put_data(const fp3_figure *f, FILE *out) {
    fputs("$data << END\n", out);
    for (size_t object = 0; object < f->object_count; object++) {
        for (size_t i = 0; i < f->points; i++) {
            put_number(out, f->times[i]);
            for (size_t name = 0; name < f->subject->columns->count; name++)
                put_number(out, curve(f, name, object)[i]);
            putc('\n', out);
        }
        fputs("\n\n", out);
    }
    fputs("END\n", out);
}

/* ---- the layout: panels, then planes ---- */

/* Components of a vector share a panel where they are one object's; several objects have a panel
 * for each name. */
static size_t in_panel(const fp3_figure *f, size_t name) {
    return f->object_count == 1 ? fp3_planes_vector(f->subject, name) : 1;
}

size_t fp3_figure_panels(const fp3_figure *f) {
    size_t count = 0;
    for (size_t name = 0; name < f->subject->columns->count; name += in_panel(f, name))
        count++;
    return count;
}

typedef struct {
    size_t panels, planes;
    fp3_plane plane[FP3_PLANES_MOST];
    fp3_range over[FP3_PLANES_MOST], up[FP3_PLANES_MOST];
    int tall[FP3_PLANES_MOST]; /* pixels */
} layout;

/* The same range with its middle, `length` long at least. */
static fp3_range widened(fp3_range r, double length) {
    const double more = fmax(0, length - (r.to - r.from)) / 2;
    return (fp3_range){r.from - more, r.to + more};
}

static fp3_range range_of(const fp3_figure *f, const size_t *names, size_t count) {
    const size_t values = f->object_count * f->points;
    fp3_range r = fp3_range_of(curve(f, names[0], 0), values);
    for (size_t i = 1; i < count; i++)
        r = fp3_range_joined(r, fp3_range_of(curve(f, names[i], 0), values));
    return r;
}

/* With one scale a circle is round: the plane is as tall as its curves ask for, and what is left
 * over stays empty. */
static void fit(const fp3_figure *f, layout *l, size_t i) {
    const fp3_plane *p = &l->plane[i];
    fp3_range over = range_of(f, p->x, p->count), up = range_of(f, p->y, p->count);
    l->tall[i] = PLANE;
    if (p->has_one_scale) {
        const double wide = (RIGHT - LEFT) * WIDTH;
        const double tall = wide * ((up.to - up.from) / (over.to - over.from));
        l->tall[i] = (int)fmin(fmax(tall + ABOVE + BELOW, LEAST), PLANE);
        const double shape = wide / (l->tall[i] - ABOVE - BELOW);
        over = widened(over, (up.to - up.from) * shape);
        up = widened(up, (over.to - over.from) / shape);
    }
    l->over[i] = over;
    l->up[i] = up;
}

static void lay_out(const fp3_figure *f, layout *l) {
    *l = (layout){.panels = fp3_figure_panels(f)};
    l->planes = fp3_planes_find(f, l->plane);
    for (size_t i = 0; i < l->planes; i++)
        fit(f, l, i);
}

/* Pixels above the plane of this number; of their count: of all. */
static int top_of(const layout *l, size_t plane) {
    int top = TITLE + (int)l->panels * PANEL + LABEL;
    for (size_t i = 0; i < plane; i++)
        top += l->tall[i] + LABEL;
    return top;
}

/* From `top` pixels below the upper edge. */
static void place(const layout *l, FILE *out, int top, int height) {
    const double all = top_of(l, l->planes);
    fprintf(out, "set tmargin at screen %.6f\nset bmargin at screen %.6f\n",
            1 - (top + ABOVE) / all, 1 - (top + height - BELOW) / all);
}

/* ---- curves ---- */

/* Columns x and y of the data, of one object. A curve is told by its object, else by its number;
 * alone it needs no name. */
static void put_curve(const fp3_figure *f, FILE *out, size_t object, size_t number, size_t x,
                      size_t y, const char *name, size_t length) {
    const int is_first = object == 0 && number == 0, is_one = f->object_count == 1;
    const size_t look = is_one ? number : object;
    fprintf(out, "%s $data index %zu using %zu:%zu with %s lc rgb '%s' lw 1.5 dt %s",
            is_first ? "plot" : ",", object, x, y,
            f->points <= MARKS_MOST ? "linespoints pt 7 ps 0.4" : "lines", fp3_gnuplot_colour(look),
            dashes[look % FP3_CURVES_MOST]);
    if (is_one && length)
        fprintf(out, " title '%.*s'", (int)length, name);
    else if (!is_one && number == 0)
        fprintf(out, " title 'object %zu'", f->objects[object]);
    else
        fputs(" notitle", out);
}

static void put_panel(const fp3_figure *f, const layout *l, FILE *out, size_t panel, size_t name) {
    const fp3_subject *s = f->subject;
    const fp3_column *c = &s->columns->list[name];
    const size_t count = in_panel(f, name);
    const size_t names[] = {name, name + 1, name + 2};
    const int is_last = panel + 1 == l->panels;
    const char *time = !is_last ? "" : s->has_time ? "time" : "step";
    const size_t prefix = count > 1 ? fp3_planes_prefix(c->name) : 0;
    place(l, out, TITLE + (int)panel * PANEL, PANEL);
    put_range(out, "x", fp3_range_of(f->times, f->points));
    put_range(out, "y", range_of(f, names, count));
    put_label(out, "x", time, strlen(time), is_last ? s->time_unit : "");
    put_label(out, "y", c->name, prefix ? prefix : count > 1 ? 0 : strlen(c->name), c->unit);
    for (size_t object = 0; object < f->object_count; object++)
        for (size_t i = 0; i < count; i++)
            put_curve(f, out, object, i, 1, name + i + 2, c[i].name,
                      count > 1 ? strlen(c[i].name) : 0);
    putc('\n', out);
}

/* ---- planes ---- */

/* Along an axis: the name, or of several vectors the component. */
static void put_axis(const fp3_figure *f, FILE *out, const char *axis, const size_t *names,
                     size_t count) {
    const fp3_column *c = &f->subject->columns->list[names[0]];
    const size_t length = strlen(c->name);
    put_label(out, axis, count > 1 ? c->name + length - 1 : c->name, count > 1 ? 1 : length,
              c->unit);
}

static void put_plane(const fp3_figure *f, const layout *l, FILE *out, size_t number) {
    const fp3_plane *p = &l->plane[number];
    place(l, out, top_of(l, number), l->tall[number]);
    put_range(out, "x", l->over[number]);
    put_range(out, "y", l->up[number]);
    put_axis(f, out, "x", p->x, p->count);
    put_axis(f, out, "y", p->y, p->count);
    for (size_t object = 0; object < f->object_count; object++)
        for (size_t i = 0; i < p->count; i++) {
            const char *name = f->subject->columns->list[p->x[i]].name;
            const char *alone = p->is_orbit ? "orbit" : "phase plane";
            put_curve(f, out, object, i, p->x[i] + 2, p->y[i] + 2, p->count > 1 ? name : alone,
                      p->count > 1 ? fp3_planes_prefix(name) : strlen(alone));
            fprintf(out,
                    ", $data index %zu using %zu:%zu every ::%zu with points pt 7 ps 0.8 lc rgb "
                    "'%s' notitle",
                    object, p->x[i] + 2, p->y[i] + 2, f->points - 1,
                    fp3_gnuplot_colour(f->object_count > 1 ? object : i));
        }
    putc('\n', out);
}

/* ---- the whole ---- */

static void put_title(const fp3_figure *f, FILE *out) {
    const fp3_program *program = f->subject->program;
    char text[512] = "";
    size_t used = 0;
    if (program->model)
        used = (size_t)snprintf(text, sizeof text, "%s, %s, ", program->model->name,
                                program->integrator->name);
    if (f->subject->h > 0)
        used += (size_t)snprintf(text + used, sizeof text - used, "h = %.9g%s%s, ", f->subject->h,
                                 *f->subject->time_unit ? " " : "", f->subject->time_unit);
    snprintf(text + used, sizeof text - used, "%zu of %zu object%s", f->object_count,
             f->subject->objects, f->subject->objects == 1 ? "" : "s");
    fputs("set multiplot title ", out);
    put_text(out, text);
    fputs(" noenhanced\n", out);
}

void fp3_figure_write(const fp3_figure *f, FILE *out) {
    layout l;
    lay_out(f, &l);
    fp3_gnuplot_begin(out, f->subject->path, WIDTH, top_of(&l, l.planes), RIGHT);
    fprintf(out, "set format y '%%.8g'\nset lmargin at screen %g\nset rmargin at screen %g\n", LEFT,
            RIGHT);
    put_data(f, out);
    put_title(f, out);
    size_t panel = 0;
    for (size_t name = 0; name < f->subject->columns->count; name += in_panel(f, name))
        put_panel(f, &l, out, panel++, name);
    for (size_t i = 0; i < l.planes; i++)
        put_plane(f, &l, out, i);
    fputs("unset multiplot\n", out);
}
