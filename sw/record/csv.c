/* SPDX-License-Identifier: Apache-2.0 */
/* csv.c - a recording as comma-separated values: see sink.h. */
#include "sink.h"

#include "base/file.h"
#include "base/host.h"
#include "base/number.h"
#include "base/path.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define BUFFER_BYTES (1u << 20)
#define NUMBER_BYTES 32 /* of a number and its comma */

typedef struct {
    fp3_sink sink;
    const fp3_subject *subject;
    fp3_output *output;
    char *row, *buffer;
} csv;

static fp3_status failed(const csv *self, fp3_error *error) {
    return fp3_path_fail(error, self->subject->path, "cannot write");
}

/* ---- the header ---- */

/* Units have no commas and no quotes. */
static void put_name(FILE *out, const char *name, const char *unit, const char *before) {
    fprintf(out, "%s%s", before, name);
    if (*unit)
        fprintf(out, " [%s]", unit);
}

static fp3_status put_header(const csv *self, fp3_error *error) {
    const fp3_subject *s = self->subject;
    FILE *out = fp3_output_stream(self->output);
    put_name(out, "step", "", "");
    if (s->has_time)
        put_name(out, "time", s->time_unit, ",");
    put_name(out, "object", "", ",");
    for (size_t i = 0; i < s->columns->count; i++)
        put_name(out, s->columns->list[i].name, s->columns->list[i].unit, ",");
    fputs("\r\n", out);
    return ferror(out) ? failed(self, error) : FP3_OK;
}

/* ---- rows ---- */

/* Enough digits for every float, or double; C would write the sign of a NaN. */
static char *put_number(char *at, double value, int digits) {
    if (isnan(value))
        return stpcpy(at, ",nan");
    return at + snprintf(at, NUMBER_BYTES, ",%.*g", digits, value);
}

static char *put_value(char *at, const fp3_column *column, size_t i) {
    switch (column->kind) {
    case FP3_COLUMN_STATE:
        return put_number(at, (double)((const float *)column->values)[i], 9);
    case FP3_COLUMN_SLEPT:
    case FP3_COLUMN_LIFE:
        return at + snprintf(at, NUMBER_BYTES, ",%" PRIu32, ((const uint32_t *)column->values)[i]);
    case FP3_COLUMN_SUM:
    case FP3_COLUMN_COMPUTED:
        return put_number(at, ((const double *)column->values)[i], 17);
    }
    return at;
}

static fp3_status csv_put(fp3_sink *sink, const fp3_slice *block, fp3_error *error) {
    csv *self = (csv *)sink;
    const fp3_columns *columns = self->subject->columns;
    FILE *out = fp3_output_stream(self->output);
    FP3_HOST;
    char *begin = self->row + snprintf(self->row, NUMBER_BYTES, "%" PRIu64, block->step);
    if (self->subject->has_time)
        begin = put_number(begin, block->time, 17);
    for (size_t i = 0; i < block->count && !ferror(out); i++) {
        char *at = begin + snprintf(begin, NUMBER_BYTES, ",%zu", block->first + i);
        for (size_t c = 0; c < columns->count; c++)
            at = put_value(at, &columns->list[c], i);
        at = stpcpy(at, "\r\n");
        fwrite(self->row, 1, (size_t)(at - self->row), out);
    }
    return ferror(out) ? failed(self, error) : FP3_OK;
}

/* ---- opening and closing ---- */

static fp3_status csv_publish(fp3_sink *sink, fp3_error *error) {
    return fp3_output_publish(((csv *)sink)->output, error);
}

static void csv_close(fp3_sink *sink) {
    csv *self = (csv *)sink;
    fp3_output_close(&self->output);
    free(self->row);
    free(self->buffer);
    free(self);
}

static fp3_status start(csv *self, fp3_error *error) {
    fp3_status status = fp3_output_open(self->subject->path, &self->output, error);
    self->row = malloc(NUMBER_BYTES * (self->subject->columns->count + 4));
    self->buffer = malloc(BUFFER_BYTES);
    if (!status && (!self->row || !self->buffer))
        status = fp3_no_memory(error);
    if (status)
        return status;
    setvbuf(fp3_output_stream(self->output), self->buffer, _IOFBF, BUFFER_BYTES);
    return put_header(self, error);
}

fp3_status fp3_csv_open(const fp3_subject *subject, fp3_sink **sink, fp3_error *error) {
    csv *self = calloc(1, sizeof *self);
    *sink = NULL;
    if (!self)
        return fp3_no_memory(error);
    self->sink = (fp3_sink){csv_put, csv_publish, csv_close};
    self->subject = subject;
    const fp3_status status = start(self, error);
    if (status)
        csv_close(&self->sink);
    else
        *sink = &self->sink;
    return status;
}
