/* SPDX-License-Identifier: Apache-2.0 */
/* checkpoint.c - writes a world of bodies to a file: a dataset for each field, in the envelope of
 * checkpoints (docs/checkpoints.md). */
#include "fields.h"

#include "base/file.h"
#include "base/host.h"
#include "record/envelope.h"
#include "record/library_hdf5.h"

#include <stdlib.h>
#include <string.h>

typedef struct {
    const fp3_hdf5_ops *calls;
    fp3_hdf5 *file;
    const char *path;
    int dataset;
} writer;

static fp3_status failed(const writer *w, fp3_error *error) {
    return fp3_hdf5_cannot_write(w->calls, w->file, w->path, error);
}

/* One field of all elements, side by side. */
static void gather(const fp3_kept_field *field, const char *elements, size_t size, uint32_t rows,
                   char *column) {
    const size_t bytes = fp3_field_size(field);
    for (uint32_t i = 0; i < rows; i++) {
        const char *from = elements + i * size + field->at;
        if (field->is_byte) {
            const uint32_t word = (uint8_t)*from;
            memcpy(column + i * bytes, &word, sizeof word);
        } else {
            memcpy(column + i * bytes, from, bytes);
        }
    }
}

static fp3_status put_field(writer *w, const fp3_kept_fields *of, const fp3_kept_field *field,
                            const void *elements, size_t size, uint32_t rows, fp3_error *error) {
    char name[FP3_FIELD_NAME];
    fp3_field_name(name, of, field);
    const fp3_hdf5_table table = {.name = name,
                                  .type = field->type,
                                  .rows = rows,
                                  .columns = field->count,
                                  .chunk_rows = rows,
                                  .chunk_columns = field->count};
    char *column = malloc((size_t)rows * fp3_field_size(field));
    if (!column)
        return fp3_no_memory(error);
    gather(field, elements, size, rows, column);
    const fp3_hdf5_part part = {.rows = rows, .columns = field->count, .data = column};
    const int result =
        w->calls->add(w->file, &table) || w->calls->write(w->file, w->dataset++, &part);
    free(column);
    return result ? failed(w, error) : FP3_OK;
}

/* Nothing is there of no elements. */
static fp3_status put(writer *w, const fp3_kept_fields *of, const void *elements, size_t size,
                      uint32_t rows, fp3_error *error) {
    fp3_status status = FP3_OK;
    for (size_t i = 0; !status && rows && i < of->count; i++)
        status = put_field(w, of, &of->fields[i], elements, size, rows, error);
    return status;
}

static fp3_status put_all(writer *w, fp3_bodies *bodies, fp3_error *error) {
    char laws[FP3_DIGEST_SIZE], hash[FP3_KEPT_HASH];
    fp3_status status = fp3_kept_laws(w->calls, bodies->laws, laws, error);
    fp3_kept_hash(bodies, hash);
    if (!status)
        status = put(w, &fp3_fields_of_world, bodies, sizeof *bodies, 1, error);
    for (int i = 0; !status && i < FP3_PARTS; i++) {
        const fp3_kept_part part = fp3_part_of(bodies, i);
        status = put(w, &fp3_fields_of[i], *part.array, part.size, *part.count, error);
    }
    if (status)
        return status;
    const int result = w->calls->text(w->file, -1, FP3_KEPT_WHAT, FP3_KEPT_FORM) |
                       w->calls->text(w->file, -1, "fp3_version", FP3_VERSION) |
                       w->calls->text(w->file, -1, "laws", laws) |
                       w->calls->text(w->file, -1, "hash", hash);
    return result || w->calls->flush(w->file) ? failed(w, error) : FP3_OK;
}

static fp3_status write_file(writer *w, fp3_bodies *bodies, fp3_output *output, fp3_error *error) {
    fp3_status status = fp3_output_begin(output, error);
    if (status)
        return status;
    w->file = w->calls->create(fp3_output_temporary(output), FP3_ENVELOPE_SIZE);
    if (!w->file)
        return fp3_no_memory(error);
    status = put_all(w, bodies, error);
    w->calls->close(w->file);
    if (!status)
        status =
            fp3_envelope_close(w->calls, fp3_output_stream(output), bodies->steps, w->path, error);
    return status ? status : fp3_output_publish(output, error);
}

fp3_status fp3_bodies_checkpoint(fp3_bodies *bodies, const char *path) {
    FP3_HOST;
    writer w = {.path = path};
    fp3_output *output = NULL;
    fp3_status status = bodies->space
                            ? fp3_fail(bodies->error, FP3_E_ARGUMENT,
                                       "%s: a checkpoint has bodies in a plane alone", path)
                            : fp3_library_hdf5(&w.calls, bodies->error);
    if (!status)
        status = fp3_output_open_again(path, &output, bodies->error);
    if (!status)
        status = write_file(&w, bodies, output, bodies->error);
    fp3_output_close(&output);
    return status;
}
