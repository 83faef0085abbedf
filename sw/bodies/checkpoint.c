/* SPDX-License-Identifier: Apache-2.0 */
/* checkpoint.c - writes a world of bodies to a file: a dataset for each field, in the envelope of
 * checkpoints (docs/checkpoints.md). */
#include "fields.h"
#include "past.h"

#include "base/host.h"
#include "record/envelope.h"
#include "record/library_hdf5.h"

#include <stdlib.h>
#include <string.h>

typedef struct {
    const fp3_hdf5_ops *calls;
    fp3_hdf5 *file;
    const char *path;
    const fp3_bodies_past *past; /* or NULL */
    int dataset;
    fp3_error *error;
} writer;

static fp3_status failed(const writer *w) {
    return fp3_hdf5_cannot_write(w->calls, w->file, w->path, w->error);
}

/* One field of all elements, side by side. */
static fp3_status put_field(writer *w, const fp3_kept_list *of, const fp3_kept_field *field,
                            const void *elements, size_t size, uint32_t rows) {
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
        return fp3_no_memory(w->error);
    fp3_field_gather(field, elements, size, rows, column);
    const fp3_hdf5_part part = {.rows = rows, .columns = field->count, .data = column};
    const int result =
        w->calls->add(w->file, &table) || w->calls->write(w->file, w->dataset++, &part);
    free(column);
    return result ? failed(w) : FP3_OK;
}

/* Nothing is there of no elements. */
static fp3_status put_list(writer *w, fp3_bodies *bodies, const fp3_kept_list *list) {
    const fp3_kept_part part = fp3_kept_elements(bodies, list);
    const void *elements = part.array ? *part.array : bodies;
    const uint32_t rows = part.count ? *part.count : 1;
    fp3_status status = FP3_OK;
    for (size_t i = 0; !status && rows && i < list->count; i++)
        status = put_field(w, list, &list->fields[i], elements, part.size, rows);
    return status;
}

static int put_digest(const writer *w, const char *name, const fp3_digest *digest) {
    char text[FP3_DIGEST_SIZE];
    fp3_digest_text(digest, text);
    return w->calls->text(w->file, -1, name, text);
}

static int put_past(const writer *w) {
    const fp3_bodies_past *past = w->past;
    int result = 0;
    if (!past)
        return 0;
    for (int i = 0; i < FP3_STARTS; i++)
        result |= put_digest(w, fp3_start_names[i], &past->start[i]);
    result |= put_digest(w, "before", &past->before) | put_digest(w, "chain", &past->chain);
    return result | w->calls->text(w->file, -1, "command", past->command ? past->command : "");
}

static fp3_status put_all(writer *w, fp3_bodies *bodies) {
    char laws[FP3_DIGEST_SIZE], hash[FP3_KEPT_HASH];
    fp3_status status = fp3_kept_laws(w->calls, bodies, laws, w->error);
    fp3_kept_hash(bodies, hash);
    for (size_t i = 0; !status && i < fp3_kept_list_count; i++)
        if (fp3_list_is_of(&fp3_kept_lists[i], bodies->def.dimensions))
            status = put_list(w, bodies, &fp3_kept_lists[i]);
    if (status)
        return status;
    const int result = w->calls->text(w->file, -1, FP3_KEPT_WHAT, FP3_KEPT_FORM) |
                       w->calls->text(w->file, -1, "fp3_version", FP3_VERSION) |
                       w->calls->text(w->file, -1, "laws", laws) |
                       w->calls->text(w->file, -1, "hash", hash) | put_past(w);
    return result || w->calls->flush(w->file) ? failed(w) : FP3_OK;
}

static void tidy_patches(fp3_bodies *bodies, const fp3_touch2 *t) {
    for (uint32_t k = t->first_patch; k < t->first_patch + t->patch_room; k++) {
        fp3_patch3 *p = &bodies->space->patch[k];
        if (k >= t->first_patch + t->patches)
            *p = (fp3_patch3){0};
        for (uint32_t i = p->m.count; i < 4; i++)
            memset(&p->m.point[i], 0, sizeof p->m.point[i]);
    }
}

fp3_status fp3_kept_tidy(fp3_bodies *bodies) {
    const fp3_status status = bodies->space ? fp3_space_lay_patches(bodies) : FP3_OK;
    for (uint32_t k = 0; !status && k < bodies->touch_count; k++) {
        fp3_touch2 *t = &bodies->touch[k];
        for (uint32_t i = t->m.count; i < 2; i++)
            memset(&t->m.point[i], 0, sizeof t->m.point[i]);
        for (uint32_t i = t->found.count; i < 2; i++)
            memset(&t->found.point[i], 0, sizeof t->found.point[i]);
        if (bodies->space)
            tidy_patches(bodies, t);
    }
    return !status && bodies->space ? fp3_forms_number(bodies) : status;
}

static fp3_status write_file(writer *w, fp3_bodies *bodies, fp3_output *output) {
    fp3_status status = fp3_output_begin(output, w->error);
    if (status)
        return status;
    w->file = w->calls->create(fp3_output_temporary(output), FP3_ENVELOPE_SIZE);
    if (!w->file)
        return fp3_no_memory(w->error);
    status = fp3_kept_tidy(bodies);
    if (!status)
        status = put_all(w, bodies);
    if (bodies->space)
        fp3_forms_forget(bodies);
    w->calls->close(w->file);
    if (!status)
        status = fp3_envelope_close(w->calls, fp3_output_stream(output), bodies->steps, w->path,
                                    w->error);
    return status ? status : fp3_output_publish(output, w->error);
}

fp3_status fp3_bodies_keep(fp3_bodies *bodies, const char *path, fp3_output *output,
                           fp3_bodies_past *past) {
    writer w = {.path = path, .past = past, .error = bodies->error};
    fp3_digest hash;
    fp3_status status = fp3_library_hdf5(&w.calls, w.error);
    if (!status && past) {
        past->before = past->chain;
        status = fp3_bodies_sum(bodies, &hash, w.error);
        if (!status)
            status = fp3_chain_add(w.calls, &past->chain, &hash, w.error);
    }
    return status ? status : write_file(&w, bodies, output);
}

fp3_status fp3_bodies_checkpoint(fp3_bodies *bodies, const char *path) {
    FP3_HOST;
    fp3_output *output = NULL;
    fp3_status status = fp3_output_open_again(path, &output, bodies->error);
    if (!status)
        status = fp3_bodies_keep(bodies, path, output, NULL);
    fp3_output_close(&output);
    return status;
}
