/* figure.c - see figure.h. */
#include "figure.h"

#include "gnuplot.h"

#include <math.h>
#include <string.h>

/* Pixels. */
enum { WIDTH = 960, TITLE = 40, PANEL = 210, LABEL = 36, PHASE = 460, ABOVE = 8, BELOW = 28 };

#define LEFT 0.14 /* where data begin and end, as shares of the width: the legend is on the right */
#define RIGHT 0.82
#define MARGIN 0.05   /* of a range, above and below the data */
#define MARKS_MOST 40 /* points that are drawn as such, and not lines alone */

static const char *const dashes[FP3_CURVES_MOST] = {
    "1", "(8,4)", "(2,3)", "(8,3,2,3)", "(14,4)", "(4,2)", "(14,3,2,3)", "(8,3,2,3,2,3)"};

typedef struct {
    double from, to;
} range;

/* Between single quotes gnuplot reads nothing; names and units have none. */
static void put_text(FILE *out, const char *text) { fprintf(out, "'%s'", text); }

static void put_label(FILE *out, const char *axis, const char *name, const char *unit) {
    char text[FP3_NAME_SIZE + FP3_UNIT_SIZE + 4];
    snprintf(text, sizeof text, *unit ? "%s [%s]" : "%s", name, unit);
    fprintf(out, "set %slabel ", axis);
    put_text(out, text);
    putc('\n', out);
}

/* ---- ranges ---- */

/* Of what is finite; never empty, which gnuplot would refuse. */
static range range_of(const double *values, size_t count) {
    range r = {INFINITY, -INFINITY};
    for (size_t i = 0; i < count; i++) {
        if (!isfinite(values[i]))
            continue;
        r.from = fmin(r.from, values[i]);
        r.to = fmax(r.to, values[i]);
    }
    if (r.from > r.to)
        return (range){-1, 1};
    /* Halves, so that no difference is infinite. */
    double margin = 2 * MARGIN * (r.to / 2 - r.from / 2);
    if (!(margin > 1e-9 * fmax(fabs(r.from), fabs(r.to))))
        margin = fmax(fabs(r.to) * MARGIN, 1e-30);
    r = (range){r.from - margin, r.to + margin};
    return isfinite(r.from) && isfinite(r.to) ? r : (range){-8e307, 8e307};
}

static void put_range(FILE *out, const char *axis, range r) {
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

/* ---- panels ---- */

static int is_state(const fp3_column *column) {
    return column->kind == FP3_COLUMN_STATE || column->kind == FP3_COLUMN_SUM;
}

static int has_phase_plane(const fp3_figure *f) {
    const fp3_column *list = f->subject->columns->list;
    const size_t count = f->subject->columns->count;
    return (count == 2 || (count == 3 && list[2].kind == FP3_COLUMN_LIFE)) && is_state(&list[0]) &&
           is_state(&list[1]);
}

static int height_of(const fp3_figure *f) {
    const int panels = (int)f->subject->columns->count * PANEL;
    return TITLE + panels + LABEL + (has_phase_plane(f) ? PHASE + LABEL : 0);
}

/* From `top` pixels below the upper edge. */
static void place(const fp3_figure *f, FILE *out, int top, int height) {
    const double all = height_of(f);
    fprintf(out, "set tmargin at screen %.6f\nset bmargin at screen %.6f\n",
            1 - (top + ABOVE) / all, 1 - (top + height - BELOW) / all);
}

/* Columns x and y of the data; the legend names objects, or the only curve. */
static void put_curves(const fp3_figure *f, FILE *out, size_t x, size_t y, const char *colour,
                       const char *only) {
    fputs("plot", out);
    for (size_t i = 0; i < f->object_count; i++) {
        char title[48];
        snprintf(title, sizeof title, "object %zu", f->objects[i]);
        fprintf(out, "%s $data index %zu using %zu:%zu with %s lc rgb '%s' lw 1.5 dt %s title ",
                i ? "," : "", i, x + 1, y + 1,
                f->points <= MARKS_MOST ? "linespoints pt 7 ps 0.4" : "lines", colour, dashes[i]);
        put_text(out, f->object_count > 1 ? title : only);
    }
    putc('\n', out);
}

static void put_panel(const fp3_figure *f, FILE *out, size_t name) {
    const fp3_columns *columns = f->subject->columns;
    const fp3_column *column = &columns->list[name];
    place(f, out, TITLE + (int)name * PANEL, PANEL);
    put_range(out, "x", range_of(f->times, f->points));
    put_range(out, "y", range_of(curve(f, name, 0), f->object_count * f->points));
    put_label(out, "x",
              name + 1 < columns->count ? ""
              : f->subject->has_time    ? "time"
                                        : "step",
              name + 1 < columns->count ? "" : f->subject->time_unit);
    put_label(out, "y", column->name, column->unit);
    put_curves(f, out, 0, name + 1, fp3_gnuplot_colour(name), column->name);
}

static int is_velocity(const fp3_subject *s, size_t name, size_t of) {
    const fp3_model *model = s->program->model;
    const uint32_t state = model ? fp3_model_state(model, s->columns->list[of].name) : FP3_NONE;
    return state != FP3_NONE && model->states[state].velocity != FP3_NONE &&
           model->states[state].velocity == fp3_model_state(model, s->columns->list[name].name);
}

/* The same range with its middle, `length` long at least. */
static range widened(range r, double length) {
    const double more = fmax(0, length - (r.to - r.from)) / 2;
    return (range){r.from - more, r.to + more};
}

/* A position is to the right, its velocity upwards. Two coordinates have one scale: a circle is round. */
static void put_phase_plane(const fp3_figure *f, FILE *out) {
    const fp3_subject *s = f->subject;
    const fp3_column *list = s->columns->list;
    const size_t x = (size_t)is_velocity(s, 0, 1), y = 1 - x, count = f->object_count * f->points;
    range over = range_of(curve(f, x, 0), count), up = range_of(curve(f, y, 0), count);
    if (!strcmp(list[0].unit, list[1].unit) && !is_velocity(s, 0, 1) && !is_velocity(s, 1, 0)) {
        const double shape = (RIGHT - LEFT) * WIDTH / (PHASE - ABOVE - BELOW);
        over = widened(over, (up.to - up.from) * shape);
        up = widened(up, (over.to - over.from) / shape);
    }
    place(f, out, TITLE + (int)s->columns->count * PANEL + LABEL, PHASE);
    put_range(out, "x", over);
    put_range(out, "y", up);
    put_label(out, "x", list[x].name, list[x].unit);
    put_label(out, "y", list[y].name, list[y].unit);
    put_curves(f, out, x + 1, y + 1, fp3_gnuplot_colour(s->columns->count), "phase plane");
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
    putc('\n', out);
}

void fp3_figure_write(const fp3_figure *f, FILE *out) {
    fp3_gnuplot_begin(out, f->subject->path, WIDTH, height_of(f));
    fprintf(out,
            "set encoding utf8\nset grid lt 1 lc rgb '#dddddd'\nset format y '%%.8g'\n"
            "set key at screen %g, graph 1 left top Left reverse\n"
            "set lmargin at screen %g\nset rmargin at screen %g\n",
            RIGHT + 0.01, LEFT, RIGHT);
    put_data(f, out);
    put_title(f, out);
    for (size_t name = 0; name < f->subject->columns->count; name++)
        put_panel(f, out, name);
    if (has_phase_plane(f))
        put_phase_plane(f, out);
    fputs("unset multiplot\n", out);
}
