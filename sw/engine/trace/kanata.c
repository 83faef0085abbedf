/* SPDX-License-Identifier: Apache-2.0 */
/* kanata.c - the instructions that a log is made of, from the engine to the file. */
#include <fp3/trace.h>

#include "base/file.h"
#include "base/path.h"
#include "kanata_log.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

struct fp3_kanata {
    char *path;
    fp3_output *output;
    const fp3_config *config;
    fp3_image *image;
    fp3_traced *rows; /* as they end */
    size_t count, room;
    fp3_status status; /* the first thing that went wrong, and why */
    fp3_error error;
};

fp3_status fp3_kanata_open(const char *path, const char *config, const fp3_image *image,
                           fp3_kanata **kanata, fp3_error *error) {
    *kanata = NULL;
    const fp3_config *found = fp3_config_find(config);
    if (!found)
        return fp3_fail(error, FP3_E_ARGUMENT, "no configuration '%s'", config);
    fp3_kanata *k = calloc(1, sizeof *k);
    if (!k)
        return fp3_fail(error, FP3_E_SYSTEM, "%s: out of memory", path);
    k->config = found;
    k->path = strdup(path);
    fp3_status status = k->path ? fp3_image_make(image, &k->image, error)
                                : fp3_fail(error, FP3_E_SYSTEM, "%s: out of memory", path);
    if (!status)
        status = fp3_output_open(path, &k->output, error);
    if (!status && (fputs(FP3_KANATA_HEADER, fp3_output_stream(k->output)) < 0 ||
                    fflush(fp3_output_stream(k->output)))) /* told before the run, not after it */
        status = fp3_path_fail(error, path, "cannot write");
    if (status)
        fp3_kanata_free(&k);
    *kanata = k;
    return status;
}

void fp3_kanata_free(fp3_kanata **kanata) {
    fp3_kanata *k = *kanata;
    *kanata = NULL;
    if (!k)
        return;
    fp3_output_close(&k->output);
    fp3_image_free(&k->image);
    free(k->path);
    free(k->rows);
    free(k);
}

/* ---- what the engine tells ---- */

static fp3_status check(fp3_kanata *k, const fp3_traced *t) {
    if (k->count == FP3_KANATA_LIMIT)
        return fp3_fail(&k->error, FP3_E_ARGUMENT,
                        "%s: the run issued more than %u instructions: log fewer steps or objects",
                        k->path, FP3_KANATA_LIMIT);
    if (t->scheduler < fp3_config_schedulers(k->config) && t->context < k->config->contexts &&
        t->pc < FP3_IMAGE_CODE_LIMIT && t->issued < t->ended)
        return FP3_OK;
    return fp3_fail(&k->error, FP3_E_MISMATCH,
                    "%s: cycle %" PRIu64 ": word %" PRIu32 " of scheduler %" PRIu32
                    ", context %" PRIu32 ", issued in cycle %" PRIu64 ": out of range",
                    k->path, t->ended, t->pc, t->scheduler, t->context, t->issued);
}

static fp3_status make_room(fp3_kanata *k) {
    if (k->count < k->room)
        return FP3_OK;
    const size_t room = k->room ? 2 * k->room : 4096;
    fp3_traced *rows = realloc(k->rows, room * sizeof *rows);
    if (!rows)
        return fp3_fail(&k->error, FP3_E_SYSTEM, "%s: out of memory", k->path);
    k->rows = rows;
    k->room = room;
    return FP3_OK;
}

void fp3_kanata_trace(void *kanata, const fp3_traced *traced) {
    fp3_kanata *k = kanata;
    if (k->status || traced->lane != 0)
        return;
    k->status = check(k, traced);
    if (!k->status)
        k->status = make_room(k);
    if (!k->status)
        k->rows[k->count++] = *traced;
}

/* ---- the file ---- */

/* A scheduler issues one instruction in a cycle. */
static int by_issue(const void *one, const void *other) {
    const fp3_traced *a = one, *b = other;
    if (a->issued != b->issued)
        return a->issued < b->issued ? -1 : 1;
    return (a->scheduler > b->scheduler) - (a->scheduler < b->scheduler);
}

static fp3_status save(fp3_kanata *k) {
    const fp3_kanata_rows rows = {k->config, k->image, k->rows, k->count};
    fp3_error why;
    if (k->count)
        qsort(k->rows, k->count, sizeof *k->rows, by_issue);
    const fp3_status status = fp3_kanata_log(&rows, fp3_output_stream(k->output), &why);
    return status ? fp3_fail(&k->error, status, "%s: %s", k->path, why.text)
                  : fp3_output_publish(k->output, &k->error);
}

fp3_status fp3_kanata_close(fp3_kanata **kanata, fp3_error *error) {
    fp3_kanata *k = *kanata;
    if (!k)
        return FP3_OK;
    fp3_status status = k->status ? k->status : save(k);
    if (status)
        fp3_fail(error, status, "%s", k->error.text);
    fp3_kanata_free(kanata);
    return status;
}
