/* SPDX-License-Identifier: Apache-2.0 */
/* hdf5.c - a recording as HDF5: see sink.h. A chunk of about 1 MB is one piece of the file: it is
 * gathered here, then written whole, so that libhdf5 keeps none.
 */
#include "sink.h"

#include "base/file.h"
#include "library_hdf5.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#define CHUNK_BYTES (1u << 20)
#define CHUNKS_BYTES (48u << 20) /* of all columns together */

enum { STEP, TIME }; /* datasets; those of the columns follow, links, and the chain */

typedef struct {
    fp3_sink sink;
    const fp3_subject *subject;
    const fp3_hdf5_ops *calls;
    fp3_hdf5 *file;
    fp3_output *output;
    uint64_t rows;   /* snapshots of a chunk */
    uint64_t from;   /* the first snapshot of the chunk that is gathered */
    char **gathered; /* of each column; NULL: a block is a chunk */
    uint64_t *steps; /* of the snapshots of a chunk */
    double *times;
    fp3_digest *chain; /* likewise */
    int chain_dataset, extra_dataset;
    int has_time;
} hdf5;

static fp3_status failed(const hdf5 *self, fp3_error *error) {
    return fp3_hdf5_cannot_write(self->calls, self->file, self->subject->path, error);
}

/* ---- types and sizes ---- */

static fp3_hdf5_type type_of(const fp3_column *column) {
    static const fp3_hdf5_type types[] = {[FP3_COLUMN_STATE] = FP3_HDF5_FLOAT,
                                          [FP3_COLUMN_SLEPT] = FP3_HDF5_UINT32,
                                          [FP3_COLUMN_LIFE] = FP3_HDF5_UINT32,
                                          [FP3_COLUMN_SUM] = FP3_HDF5_DOUBLE,
                                          [FP3_COLUMN_COMPUTED] = FP3_HDF5_DOUBLE};
    return types[column->kind];
}

static size_t size_of(const fp3_column *column) {
    return fp3_column_is_wide(column) ? sizeof(double) : sizeof(float);
}

static int dataset_of(const hdf5 *self, size_t column) {
    return (int)column + (self->has_time ? TIME : STEP) + 1;
}

/* As many snapshots as a megabyte has room for, at least one. */
static uint64_t rows_of_chunk(const fp3_subject *s) {
    const size_t share = CHUNKS_BYTES / s->columns->count;
    const size_t bytes = share < CHUNK_BYTES ? share : CHUNK_BYTES;
    uint64_t rows = bytes / (sizeof(double) * s->columns->room);
    rows = rows < s->snapshots ? rows : s->snapshots;
    return rows && s->columns->room == s->objects ? rows : 1;
}

/* ---- what the file says of itself ---- */

static uint32_t crc_of(const fp3_image *image, fp3_status *status, fp3_error *error) {
    uint32_t *words = NULL, crc = 0;
    size_t count = 0;
    *status = fp3_image_encode(image, &words, &count, error);
    if (!*status)
        crc = words[count - 1];
    free(words);
    return crc;
}

static int put_text(const hdf5 *self, int dataset, const char *name, const char *value) {
    return *value ? self->calls->text(self->file, dataset, name, value) : 0;
}

static fp3_status describe_file(const hdf5 *self, fp3_error *error) {
    const fp3_subject *s = self->subject;
    const fp3_program *program = s->program;
    fp3_status status = FP3_OK;
    const uint32_t crc = program ? crc_of(program->image, &status, error) : 0;
    if (status)
        return status;
    int result = put_text(self, -1, "fp3_version", FP3_VERSION) |
                 put_text(self, -1, "engine", s->engine) |
                 put_text(self, -1, "configuration", s->config) |
                 put_text(self, -1, "command", s->command ? s->command : "");
    if (program)
        result |= self->calls->number(self->file, -1, "image_crc32", FP3_HDF5_UINT32, &crc);
    if (program && program->model)
        result |= put_text(self, -1, "model", program->model->name) |
                  put_text(self, -1, "description", program->model->doc) |
                  put_text(self, -1, "integrator", program->integrator->name);
    if (s->h > 0)
        result |= self->calls->number(self->file, -1, "h", FP3_HDF5_DOUBLE, &s->h);
    return result ? failed(self, error) : FP3_OK;
}

static fp3_status add_snapshots(const hdf5 *self, fp3_error *error) {
    const fp3_subject *s = self->subject;
    fp3_hdf5_table table = {.name = "step",
                            .type = FP3_HDF5_UINT64,
                            .rows = s->snapshots,
                            .chunk_rows = self->rows,
                            .is_compressed = s->is_compressed};
    int result = self->calls->add(self->file, &table);
    table.name = "time";
    table.type = FP3_HDF5_DOUBLE;
    if (!result && self->has_time)
        result = self->calls->add(self->file, &table) | put_text(self, TIME, "units", s->time_unit);
    return result ? failed(self, error) : FP3_OK;
}

static fp3_status add_column(const hdf5 *self, size_t i, fp3_error *error) {
    const fp3_subject *s = self->subject;
    const fp3_column *column = &s->columns->list[i];
    const fp3_hdf5_table table = {.name = column->name,
                                  .type = type_of(column),
                                  .rows = s->snapshots,
                                  .columns = s->objects,
                                  .chunk_rows = self->rows,
                                  .chunk_columns = s->columns->room,
                                  .is_compressed = s->is_compressed};
    const int dataset = dataset_of(self, i);
    int result = self->calls->add(self->file, &table);
    if (!result)
        result = put_text(self, dataset, "units", column->unit) |
                 put_text(self, dataset, "description", column->doc);
    return result ? failed(self, error) : FP3_OK;
}

/* ---- who sees whom ---- */

/* The state that is a position knows its velocity, so that readers can tell the two from each
 * other. */
static fp3_status name_velocity(const hdf5 *self, size_t i, fp3_error *error) {
    const fp3_program *program = self->subject->program;
    const fp3_model *model = program ? program->model : NULL;
    const uint32_t state =
        model ? fp3_model_state(model, self->subject->columns->list[i].name) : FP3_NONE;
    const uint32_t velocity = state == FP3_NONE ? FP3_NONE : model->states[state].velocity;
    return velocity != FP3_NONE &&
                   put_text(self, dataset_of(self, i), "velocity", model->states[velocity].name)
               ? failed(self, error)
               : FP3_OK;
}

/* No state has a name with a colon. */
static const char *colon(char text[2 * FP3_NAME_SIZE], const char *what, const char *relation) {
    snprintf(text, 2 * FP3_NAME_SIZE, "%s:%s", what, relation);
    return text;
}

static fp3_status write_links(const hdf5 *self, int dataset, const fp3_around_list *list,
                              fp3_error *error) {
    char name[2 * FP3_NAME_SIZE];
    const uint64_t most = CHUNK_BYTES / (2 * sizeof *list->pairs);
    const fp3_hdf5_table table = {.name = colon(name, "links", list->name),
                                  .type = FP3_HDF5_UINT32,
                                  .rows = list->count,
                                  .columns = 2,
                                  .chunk_rows = list->count < most ? list->count : most,
                                  .chunk_columns = 2,
                                  .is_compressed = self->subject->is_compressed};
    const fp3_hdf5_part part = {.rows = list->count, .columns = 2, .data = list->pairs};
    return self->calls->add(self->file, &table) || self->calls->write(self->file, dataset, &part)
               ? failed(self, error)
               : FP3_OK;
}

static fp3_status put_reach(const hdf5 *self, const fp3_around_list *list, fp3_error *error) {
    char name[2 * FP3_NAME_SIZE];
    int result = self->calls->number(self->file, -1, colon(name, "reach", list->name),
                                     FP3_HDF5_DOUBLE, &list->reach);
    result |= put_text(self, -1, colon(name, "position", list->name), list->position);
    return result ? failed(self, error) : FP3_OK;
}

static fp3_status describe_relations(hdf5 *self, fp3_error *error) {
    const fp3_around *around = self->subject->around;
    int dataset = dataset_of(self, self->subject->columns->count);
    fp3_status status = FP3_OK;
    for (size_t i = 0; !status && i < around->count; i++) {
        const fp3_around_list *list = &around->lists[i];
        if (list->reach > 0)
            status = put_reach(self, list, error);
        if (!status && list->count)
            status = write_links(self, dataset++, list, error);
    }
    self->chain_dataset = dataset;
    self->extra_dataset = dataset + self->subject->is_hashed;
    return status;
}

/* ---- hashes ---- */

static fp3_status add_chain(hdf5 *self, fp3_error *error) {
    const fp3_hdf5_table table = {.name = "hash:chain",
                                  .type = FP3_HDF5_UINT32,
                                  .rows = self->subject->snapshots,
                                  .columns = FP3_DIGEST_WORDS,
                                  .chunk_rows = self->rows,
                                  .chunk_columns = FP3_DIGEST_WORDS};
    char before[FP3_DIGEST_SIZE];
    fp3_digest_text(&self->subject->before, before);
    return put_text(self, -1, "hash:before", before) || self->calls->add(self->file, &table)
               ? failed(self, error)
               : FP3_OK;
}

/* ---- blocks ---- */

static fp3_status write_part(const hdf5 *self, int dataset, const fp3_hdf5_part *part,
                             fp3_error *error) {
    return self->calls->write(self->file, dataset, part) ? failed(self, error) : FP3_OK;
}

/* Snapshots from .. from+rows-1 of everything that is gathered. */
static fp3_status write_gathered(const hdf5 *self, uint64_t rows, fp3_error *error) {
    const fp3_columns *columns = self->subject->columns;
    fp3_hdf5_part part = {.row = self->from, .rows = rows, .data = self->steps};
    fp3_status status = write_part(self, STEP, &part, error);
    part.data = self->times;
    if (!status && self->has_time)
        status = write_part(self, TIME, &part, error);
    part.columns = FP3_DIGEST_WORDS;
    part.data = self->chain;
    if (!status && self->subject->is_hashed)
        status = write_part(self, self->chain_dataset, &part, error);
    part.columns = self->subject->objects;
    for (size_t i = 0; !status && self->gathered && i < columns->count; i++) {
        part.data = self->gathered[i];
        status = write_part(self, dataset_of(self, i), &part, error);
    }
    return status;
}

static void gather(const hdf5 *self, const fp3_slice *block) {
    const fp3_columns *columns = self->subject->columns;
    for (size_t i = 0; i < columns->count; i++) {
        const size_t bytes = block->count * size_of(&columns->list[i]);
        memcpy(self->gathered[i] + (block->number - self->from) * bytes, columns->list[i].values,
               bytes);
    }
}

static fp3_status write_block(const hdf5 *self, const fp3_slice *block, fp3_error *error) {
    const fp3_columns *columns = self->subject->columns;
    fp3_status status = FP3_OK;
    for (size_t i = 0; !status && i < columns->count; i++)
        status = write_part(self, dataset_of(self, i),
                            &(fp3_hdf5_part){.row = block->number,
                                             .rows = 1,
                                             .column = block->first,
                                             .columns = block->count,
                                             .data = columns->list[i].values},
                            error);
    return status;
}

static fp3_status hdf5_put(fp3_sink *sink, const fp3_slice *block, fp3_error *error) {
    hdf5 *self = (hdf5 *)sink;
    const uint64_t row = block->number - self->from;
    fp3_status status = FP3_OK;
    self->steps[row] = block->step;
    self->times[row] = block->time;
    if (self->subject->is_hashed)
        self->chain[row] = *block->chain;
    if (self->gathered)
        gather(self, block);
    else
        status = write_block(self, block, error);
    if (status || block->first + block->count < self->subject->objects)
        return status;
    if (row + 1 == self->rows || block->number + 1 == self->subject->snapshots) {
        status = write_gathered(self, row + 1, error);
        self->from = block->number + 1;
        fp3_output_begin_writing(self->output);
    }
    return status;
}

/* ---- tables beside the values ---- */

static fp3_status write_extra(const hdf5 *self, int dataset, const fp3_extra *extra,
                              fp3_error *error) {
    const uint64_t most = CHUNK_BYTES / (sizeof(double) * extra->columns);
    const fp3_hdf5_table table = {.name = extra->name,
                                  .type = extra->type == FP3_EXTRA_UINT32 ? FP3_HDF5_UINT32
                                                                          : FP3_HDF5_DOUBLE,
                                  .rows = extra->rows,
                                  .columns = extra->columns,
                                  .chunk_rows = extra->rows < most ? extra->rows : most,
                                  .chunk_columns = extra->columns,
                                  .is_compressed = self->subject->is_compressed};
    const fp3_hdf5_part part = {
        .rows = extra->rows, .columns = extra->columns, .data = extra->data};
    return self->calls->add(self->file, &table) || self->calls->write(self->file, dataset, &part)
               ? failed(self, error)
               : FP3_OK;
}

static fp3_status write_extras(const hdf5 *self, fp3_error *error) {
    const fp3_subject *s = self->subject;
    int dataset = self->extra_dataset;
    fp3_status status = FP3_OK;
    for (size_t i = 0; !status && i < s->extra_count; i++)
        if (s->extras[i].rows)
            status = write_extra(self, dataset++, &s->extras[i], error);
    return status;
}

/* ---- opening and closing ---- */

static fp3_status hdf5_publish(fp3_sink *sink, fp3_error *error) {
    hdf5 *self = (hdf5 *)sink;
    const fp3_status status = write_extras(self, error);
    if (status)
        return status;
    if (self->calls->flush(self->file))
        return failed(self, error);
    self->calls->close(self->file);
    self->file = NULL;
    return fp3_output_publish(self->output, error);
}

static void hdf5_close(fp3_sink *sink) {
    hdf5 *self = (hdf5 *)sink;
    if (self->file)
        self->calls->close(self->file);
    fp3_output_close(&self->output);
    for (size_t i = 0; self->gathered && i < self->subject->columns->count; i++)
        free(self->gathered[i]);
    free(self->gathered);
    free(self->steps);
    free(self->times);
    free(self->chain);
    free(self);
}

static fp3_status make_room(hdf5 *self, fp3_error *error) {
    const fp3_columns *columns = self->subject->columns;
    int is_good = 1;
    self->rows = rows_of_chunk(self->subject);
    self->steps = calloc(self->rows, sizeof *self->steps);
    self->times = calloc(self->rows, sizeof *self->times);
    self->chain = calloc(self->rows, sizeof *self->chain);
    if (columns->room == self->subject->objects)
        self->gathered = calloc(columns->count, sizeof *self->gathered);
    for (size_t i = 0; self->gathered && i < columns->count; i++) {
        self->gathered[i] = malloc(self->rows * columns->room * size_of(&columns->list[i]));
        is_good &= self->gathered[i] != NULL;
    }
    return self->steps && self->times && self->chain && is_good ? FP3_OK : fp3_no_memory(error);
}

static fp3_status start(hdf5 *self, fp3_error *error) {
    const fp3_subject *s = self->subject;
    fp3_status status = fp3_output_open(s->path, &self->output, error);
    const char *path = status ? NULL : fp3_output_temporary(self->output);
    if (!status && !path)
        status = fp3_fail(error, FP3_E_ARGUMENT, "%s: HDF5 needs a regular file", s->path);
    if (!status)
        status = fp3_library_hdf5(&self->calls, error);
    if (!status)
        status = make_room(self, error);
    if (!status && !(self->file = self->calls->create(path, 0)))
        status = fp3_no_memory(error);
    if (!status)
        status = describe_file(self, error);
    if (!status)
        status = add_snapshots(self, error);
    for (size_t i = 0; !status && i < s->columns->count; i++)
        status = add_column(self, i, error);
    for (size_t i = 0; !status && i < s->columns->count; i++)
        status = name_velocity(self, i, error);
    if (!status)
        status = describe_relations(self, error);
    if (!status && s->is_hashed)
        status = add_chain(self, error);
    return status;
}

fp3_status fp3_hdf5_open(const fp3_subject *subject, fp3_sink **sink, fp3_error *error) {
    hdf5 *self = calloc(1, sizeof *self);
    *sink = NULL;
    if (!self)
        return fp3_no_memory(error);
    self->sink = (fp3_sink){hdf5_put, hdf5_publish, hdf5_close};
    self->subject = subject;
    self->has_time = subject->has_time;
    const fp3_status status = start(self, error);
    if (status)
        hdf5_close(&self->sink);
    else
        *sink = &self->sink;
    return status;
}
