/* SPDX-License-Identifier: Apache-2.0 */
/* write.c - writes a checkpoint: HDF5 behind an envelope. */
#include "checkpoint.h"

#include "base/file.h"
#include "envelope.h"
#include "library_hdf5.h"

#include <fp3/image.h>
#include <stdlib.h>
#include <string.h>

#define CHUNK_WORDS (1u << 18) /* 1 MB */

typedef struct {
    const fp3_checkpoint_def *def;
    fp3_state *state;
    fp3_past *past;
    fp3_hdf5 *file;
    int dataset; /* of the words of the group that is looked at */
} writer;

static fp3_status failed(const writer *w, fp3_error *error) {
    return fp3_hdf5_cannot_write(w->state->calls, w->file, w->def->path, error);
}

/* ---- datasets ---- */

/* The number of the dataset is *dataset. */
static fp3_status add(writer *w, const char *name, uint64_t rows, uint64_t columns, int *dataset,
                      fp3_error *error) {
    const uint64_t width = columns ? columns : rows;
    const uint64_t chunk = width < CHUNK_WORDS ? width : CHUNK_WORDS;
    const uint64_t together = columns ? CHUNK_WORDS / columns : 0; /* short rows */
    const fp3_hdf5_table table = {.name = name,
                                  .type = FP3_HDF5_UINT32,
                                  .rows = rows,
                                  .columns = columns,
                                  .chunk_rows = !columns          ? chunk
                                                : together < 2    ? 1
                                                : together < rows ? together
                                                                  : rows,
                                  .chunk_columns = columns ? chunk : 0};
    if (w->state->calls->add(w->file, &table))
        return failed(w, error);
    *dataset = ++w->dataset;
    return FP3_OK;
}

static fp3_status put_list(writer *w, const char *name, const uint32_t *words, size_t count,
                           fp3_error *error) {
    const fp3_hdf5_part part = {.rows = count, .data = words};
    int dataset = 0;
    fp3_status status = count ? add(w, name, count, 0, &dataset, error) : FP3_OK;
    return !status && count && w->state->calls->write(w->file, dataset, &part) ? failed(w, error)
                                                                               : status;
}

static fp3_status put_of_group(writer *w, const char *what, uint32_t group, const uint32_t *words,
                               size_t count, fp3_error *error) {
    char name[FP3_CHECKPOINT_NAME];
    fp3_checkpoint_name(name, what, group);
    return put_list(w, name, words, count, error);
}

/* ---- a group ---- */

static fp3_status put_image(writer *w, uint32_t group, fp3_error *error) {
    uint32_t *words = NULL;
    size_t count = 0;
    fp3_status status =
        fp3_image_encode(w->state->layout->groups[group].image, &words, &count, error);
    if (!status)
        status = put_of_group(w, "image", group, words, count, error);
    free(words);
    return status;
}

static fp3_status put_constants(writer *w, uint32_t group, fp3_error *error) {
    const uint32_t count = fp3_engine_config(w->state->engine)->registers;
    uint32_t words[64];
    fp3_status status =
        fp3_engine_read_shared_of(w->state->engine, group, 0, count, (float *)(void *)words);
    return status ? status : put_of_group(w, "constants", group, words, count, error);
}

static fp3_status put_registers(writer *w, uint32_t group, fp3_error *error) {
    uint32_t list[64], count = 0;
    for (uint32_t reg = 0; reg < 64; reg++)
        if (w->state->kept[group] >> reg & 1)
            list[count++] = reg;
    return put_of_group(w, "registers", group, list, count, error);
}

/* All but the words of objects. */
static fp3_status put_group(writer *w, uint32_t group, fp3_error *error) {
    uint32_t failure[FP3_FAILURE_WORDS];
    fp3_failure_pack(&w->past->failures[group], failure);
    fp3_status status = put_image(w, group, error);
    if (!status)
        status = put_constants(w, group, error);
    if (!status)
        status = put_registers(w, group, error);
    return status ? status : put_of_group(w, "failure", group, failure, FP3_FAILURE_WORDS, error);
}

/* ---- words of objects ---- */

/* No dataset is there where no pair remembers. */
static fp3_status put_pairs(writer *w, const fp3_state_row *row, fp3_error *error) {
    const fp3_hdf5_part part = {.rows = row->pairs, .columns = row->each, .data = row->words};
    char name[FP3_CHECKPOINT_NAME];
    int dataset = 0;
    if (!row->pairs)
        return FP3_OK;
    fp3_checkpoint_list_name(name, row->group, row->reg);
    const fp3_status status = add(w, name, row->pairs, row->each, &dataset, error);
    return !status && w->state->calls->write(w->file, dataset, &part) ? failed(w, error) : status;
}

/* An fp3_state_fn. */
static fp3_status put_row(void *user, const fp3_state_row *row, fp3_error *error) {
    writer *w = user;
    if (!row->count)
        return put_pairs(w, row, error);
    const fp3_hdf5_part part = {
        .row = row->row, .rows = 1, .columns = row->count, .data = row->words};
    char name[FP3_CHECKPOINT_NAME];
    int dataset = w->dataset;
    fp3_status status = FP3_OK;
    fp3_checkpoint_name(name, "words", row->group);
    if (!row->row)
        status =
            add(w, name, fp3_state_registers(w->state, row->group), row->count, &dataset, error);
    return !status && w->state->calls->write(w->file, dataset, &part) ? failed(w, error) : status;
}

/* Ranks read together, whoever writes. */
static fp3_status put_status(writer *w, fp3_error *error) {
    const size_t objects = fp3_engine_objects(w->state->engine);
    if (!fp3_engine_config(w->state->engine)->status)
        return FP3_OK;
    fp3_status status = fp3_engine_read_status(w->state->engine, w->state->words);
    return status || !w->file ? status : put_list(w, "status", w->state->words, objects, error);
}

/* ---- attributes ---- */

static int put_digest(const writer *w, const char *name, const fp3_digest *digest) {
    char text[FP3_DIGEST_SIZE];
    fp3_digest_text(digest, text);
    return w->state->calls->text(w->file, -1, name, text);
}

static int put_number(const writer *w, const char *name, uint64_t value) {
    return w->state->calls->number(w->file, -1, name, FP3_HDF5_UINT64, &value);
}

static fp3_status describe(const writer *w, fp3_error *error) {
    const fp3_state *s = w->state;
    fp3_digest links, lives;
    fp3_status status = fp3_checkpoint_links(s, &links, error);
    if (!status)
        status = fp3_checkpoint_lives(s, &lives, error);
    if (status)
        return status;
    const int result =
        s->calls->text(w->file, -1, "fp3_version", FP3_VERSION) |
        s->calls->text(w->file, -1, "engine", fp3_engine_name(s->engine)) |
        s->calls->text(w->file, -1, "configuration", fp3_engine_config(s->engine)->name) |
        s->calls->text(w->file, -1, "command", w->def->command ? w->def->command : "") |
        put_number(w, "step", w->past->step) | put_number(w, "flags", w->past->flags) |
        put_number(w, "groups", s->layout->count) |
        put_number(w, "objects", fp3_engine_objects(s->engine)) |
        put_digest(w, "start", &w->past->start) | put_digest(w, "hash", &w->past->hash) |
        put_digest(w, "before", &w->past->before) | put_digest(w, "chain", &w->past->chain) |
        put_digest(w, "links", &links) | put_digest(w, "lifetimes", &lives);
    return result ? failed(w, error) : FP3_OK;
}

/* ---- the file ---- */

static fp3_status add_to_chain(const writer *w, fp3_error *error) {
    w->past->before = w->past->chain;
    return fp3_chain_add(w->state->calls, &w->past->chain, &w->past->hash, error);
}

static fp3_status put_all(writer *w, fp3_error *error) {
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; !status && i < w->state->layout->count; i++)
        status = put_group(w, i, error);
    if (!status)
        status =
            put_list(w, "failed", w->past->has_failed, fp3_engine_objects(w->state->engine), error);
    if (!status)
        status = fp3_state_look(w->state, w->past->step, put_row, w, &w->past->hash, error);
    if (!status)
        status = put_status(w, error);
    if (!status)
        status = add_to_chain(w, error);
    return status ? status : describe(w, error);
}

static fp3_status write_file(writer *w, fp3_output *output, fp3_error *error) {
    const fp3_hdf5_ops *calls = w->state->calls;
    w->dataset = -1;
    fp3_status status = fp3_output_begin(output, error);
    if (status)
        return status;
    w->file = calls->create(fp3_output_temporary(output), FP3_ENVELOPE_SIZE);
    if (!w->file)
        return fp3_no_memory(error);
    status = put_all(w, error);
    if (!status && calls->flush(w->file))
        status = failed(w, error);
    calls->close(w->file);
    if (!status)
        status = fp3_envelope_close(calls, fp3_output_stream(output), w->past->step, w->def->path,
                                    error);
    return status ? status : fp3_output_publish(output, error);
}

/* What the one that writes reads, the others read, too. */
static fp3_status look_only(writer *w, fp3_error *error) {
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; !status && i < w->state->layout->count; i++) {
        uint32_t words[64];
        status = fp3_engine_read_shared_of(w->state->engine, i, 0,
                                           fp3_engine_config(w->state->engine)->registers,
                                           (float *)(void *)words);
    }
    if (!status)
        status = fp3_state_hash(w->state, w->past->step, &w->past->hash, error);
    if (!status)
        status = put_status(w, error);
    return status ? status : add_to_chain(w, error);
}

fp3_status fp3_checkpoint_write(const fp3_checkpoint_def *def, fp3_state *state, fp3_past *past,
                                fp3_error *error) {
    writer w = {.def = def, .state = state, .past = past};
    return def->output ? write_file(&w, def->output, error) : look_only(&w, error);
}
