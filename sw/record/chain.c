/* SPDX-License-Identifier: Apache-2.0 */
/* chain.c - see chain.h. */
#include "chain.h"

#include "checkpoint.h"
#include "library_hdf5.h"

#include <stdlib.h>
#include <string.h>

static fp3_status make_room(fp3_chain *chain, size_t count, fp3_error *error) {
    chain->count = count;
    chain->list = calloc(count + 1, sizeof *chain->list);
    return chain->list ? FP3_OK : fp3_no_memory(error);
}

/* ---- a checkpoint ---- */

static fp3_status read_checkpoint(const char *path, fp3_chain *chain, fp3_error *error) {
    fp3_checkpoint *checkpoint = NULL;
    fp3_status status = fp3_checkpoint_open(path, &checkpoint, error);
    if (!status)
        status = make_room(chain, 1, error);
    if (!status) {
        fp3_expected_link *link = &chain->list[0];
        link->step = fp3_checkpoint_step(checkpoint);
        fp3_checkpoint_chain(checkpoint, &link->before, &link->chain);
        chain->command = strdup(fp3_checkpoint_command(checkpoint));
    }
    fp3_checkpoint_close(&checkpoint);
    return status || chain->command ? status : fp3_no_memory(error);
}

/* ---- a recording ---- */

typedef struct {
    const char *path;
    const fp3_hdf5_ops *calls;
    fp3_hdf5 *file;
    int step, chain; /* datasets; -1: there is none */
    uint64_t rows;
} recording;

static fp3_status failed(const recording *r, fp3_error *error) {
    return fp3_hdf5_cannot_read(r->calls, r->file, r->path, error);
}

static fp3_status find(recording *r, fp3_error *error) {
    const int count = r->calls->count(r->file);
    uint64_t links = 0;
    if (count < 0)
        return failed(r, error);
    for (int i = 0; i < count; i++) {
        fp3_hdf5_table table;
        if (r->calls->describe(r->file, i, &table))
            return failed(r, error);
        if (!strcmp(table.name, "step") && !table.columns) {
            r->step = i;
            r->rows = table.rows;
        } else if (!strcmp(table.name, "hash:chain") && table.columns == FP3_DIGEST_WORDS) {
            r->chain = i;
            links = table.rows;
        }
    }
    return r->step >= 0 && r->chain >= 0 && links == r->rows && r->rows
               ? FP3_OK
               : fp3_fail(error, FP3_E_ARGUMENT,
                          "%s: neither a checkpoint nor a recording with a chain of hashes",
                          r->path);
}

static fp3_status check_ascending(const recording *r, const fp3_chain *chain, fp3_error *error) {
    for (size_t i = 1; i < chain->count; i++)
        if (chain->list[i].step <= chain->list[i - 1].step)
            return fp3_fail(error, FP3_E_ARGUMENT, "%s: damaged: its steps do not ascend", r->path);
    return FP3_OK;
}

static fp3_status read_links(const recording *r, fp3_chain *chain, fp3_error *error) {
    const fp3_hdf5_part rows = {.rows = r->rows};
    const fp3_hdf5_part links = {.rows = r->rows, .columns = FP3_DIGEST_WORDS};
    uint64_t *steps = calloc(r->rows, sizeof *steps);
    fp3_digest *digests = calloc(r->rows, sizeof *digests);
    char *before = r->calls->text_of(r->file, -1, "hash:before");
    fp3_status status = steps && digests ? make_room(chain, r->rows, error) : fp3_no_memory(error);
    if (!status && (r->calls->read(r->file, r->step, FP3_HDF5_UINT64, &rows, steps) ||
                    r->calls->read(r->file, r->chain, FP3_HDF5_UINT32, &links, digests)))
        status = failed(r, error);
    if (!status && !fp3_digest_read(before, &chain->list[0].before))
        status = fp3_fail(error, FP3_E_ARGUMENT, "%s: damaged: no 'hash:before'", r->path);
    for (size_t i = 0; !status && i < chain->count; i++) {
        chain->list[i].step = steps[i];
        chain->list[i].chain = chain->list[i + 1].before = digests[i];
    }
    free(before);
    free(steps);
    free(digests);
    return status ? status : check_ascending(r, chain, error);
}

static fp3_status read_recording(const char *path, fp3_chain *chain, fp3_error *error) {
    recording r = {.path = path, .step = -1, .chain = -1};
    fp3_status status = fp3_library_hdf5(&r.calls, error);
    if (!status && !(r.file = r.calls->open(path)))
        status = fp3_no_memory(error);
    if (!status)
        status = find(&r, error);
    if (!status)
        status = read_links(&r, chain, error);
    if (!status)
        chain->command = r.calls->text_of(r.file, -1, "command");
    if (r.file)
        r.calls->close(r.file);
    if (!status && !chain->command && !(chain->command = strdup("")))
        status = fp3_no_memory(error);
    return status;
}

fp3_status fp3_chain_read(const char *path, fp3_chain *chain, fp3_error *error) {
    int is_checkpoint = 0;
    *chain = (fp3_chain){0};
    const fp3_status status = fp3_checkpoint_is(path, &is_checkpoint, error);
    chain->is_checkpoint = is_checkpoint;
    return status          ? status
           : is_checkpoint ? read_checkpoint(path, chain, error)
                           : read_recording(path, chain, error);
}

void fp3_chain_free(fp3_chain *chain) {
    free(chain->list);
    free(chain->command);
    *chain = (fp3_chain){0};
}
