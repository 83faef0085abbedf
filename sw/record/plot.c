/* SPDX-License-Identifier: Apache-2.0 */
/* plot.c - see plot.h. */
#include "plot.h"

#include "base/file.h"
#include "figure.h"
#include "gnuplot.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#define POINTS_MOST 1000000u /* of all curves: more than a picture can show */

typedef struct {
    fp3_sink sink;
    fp3_figure figure;
    fp3_output *output;
    double *times, *values;
} plot;

/* ---- what is drawn ---- */

/* All, or as many as can be told apart, evenly from the first to the last. */
static void choose_objects(fp3_figure *f, size_t objects) {
    f->object_count = objects < FP3_CURVES_MOST ? objects : FP3_CURVES_MOST;
    for (size_t i = 0; i < f->object_count; i++)
        f->objects[i] = f->object_count > 1 ? i * (objects - 1) / (f->object_count - 1) : 0;
}

static fp3_status check(const fp3_subject *s, const fp3_figure *f, fp3_error *error) {
    const size_t names = s->columns->count, panels = fp3_figure_panels(f);
    const fp3_status status = fp3_gnuplot_check_picture(s->path, error);
    if (status)
        return status;
    if (panels > FP3_PANELS_MOST)
        return fp3_fail(
            error, FP3_E_ARGUMENT,
            "%s: a picture has room for %d panels over time, not for %zu: observe fewer names",
            s->path, FP3_PANELS_MOST, panels);
    if (s->snapshots > POINTS_MOST / (names * f->object_count))
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "%s: %" PRIu64 " snapshots of %zu names of %zu objects are too many to "
                        "draw: a picture has room for %u points",
                        s->path, s->snapshots, names, f->object_count, POINTS_MOST);
    return FP3_OK;
}

/* ---- gathering ---- */

static double value_of(const fp3_column *column, size_t i) {
    switch (column->kind) {
    case FP3_COLUMN_STATE:
        return (double)((const float *)column->values)[i];
    case FP3_COLUMN_SLEPT:
    case FP3_COLUMN_LIFE:
        return (double)((const uint32_t *)column->values)[i];
    case FP3_COLUMN_SUM:
    case FP3_COLUMN_COMPUTED:
        return ((const double *)column->values)[i];
    }
    return 0;
}

static fp3_status plot_put(fp3_sink *sink, const fp3_slice *block, fp3_error *error) {
    plot *self = (plot *)sink;
    const fp3_figure *f = &self->figure;
    const fp3_columns *columns = f->subject->columns;
    (void)error;
    self->times[block->number] = f->subject->has_time ? block->time : (double)block->step;
    for (size_t i = 0; i < f->object_count; i++) {
        if (f->objects[i] < block->first || f->objects[i] >= block->first + block->count)
            continue;
        for (size_t c = 0; c < columns->count; c++)
            self->values[(c * f->object_count + i) * f->points + block->number] =
                value_of(&columns->list[c], f->objects[i] - block->first);
    }
    return FP3_OK;
}

/* ---- drawing ---- */

static void write_script(const void *figure, FILE *script) { fp3_figure_write(figure, script); }

static fp3_status plot_publish(fp3_sink *sink, fp3_error *error) {
    plot *self = (plot *)sink;
    const fp3_status status =
        fp3_gnuplot_write(write_script, &self->figure, fp3_output_stream(self->output), error);
    return status ? status : fp3_output_publish(self->output, error);
}

/* ---- opening and closing ---- */

static void plot_close(fp3_sink *sink) {
    plot *self = (plot *)sink;
    fp3_output_close(&self->output);
    free(self->times);
    free(self->values);
    free(self);
}

static fp3_status start(plot *self, const fp3_subject *subject, fp3_error *error) {
    fp3_figure *f = &self->figure;
    f->subject = subject;
    choose_objects(f, subject->objects);
    fp3_status status = check(subject, f, error);
    if (status)
        return status;
    f->points = subject->snapshots;
    f->times = self->times = calloc(f->points, sizeof *self->times);
    f->values = self->values =
        calloc(subject->columns->count * f->object_count * f->points, sizeof *self->values);
    if (!f->times || !f->values)
        return fp3_no_memory(error);
    return fp3_output_open(subject->path, &self->output, error);
}

fp3_status fp3_plot_open(const fp3_subject *subject, fp3_sink **sink, fp3_error *error) {
    plot *self = calloc(1, sizeof *self);
    *sink = NULL;
    if (!self)
        return fp3_no_memory(error);
    self->sink = (fp3_sink){plot_put, plot_publish, plot_close};
    const fp3_status status = start(self, subject, error);
    if (status)
        plot_close(&self->sink);
    else
        *sink = &self->sink;
    return status;
}
