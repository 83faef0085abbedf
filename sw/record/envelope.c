/* SPDX-License-Identifier: Apache-2.0 */
/* envelope.c - see envelope.h. */
#include "envelope.h"

#include "checkpoint.h"

#include "base/file.h"
#include "base/path.h"

#include <inttypes.h>
#include <string.h>
#include <unistd.h>

#define MAGIC "fp3 checkpoint "
#define VERSION 1
#define BLOCK 65536 /* bytes that are read at once */

/* What the block says. */
typedef struct {
    uint64_t step, bytes;
    fp3_digest digest;
} envelope;

static void print(const envelope *e, char block[FP3_ENVELOPE_SIZE]) {
    char digest[FP3_DIGEST_SIZE];
    fp3_digest_text(&e->digest, digest);
    memset(block, 0, FP3_ENVELOPE_SIZE);
    snprintf(block, FP3_ENVELOPE_SIZE, MAGIC "%d\nstep %" PRIu64 "\nbytes %" PRIu64 "\nsha256 %s\n",
             VERSION, e->step, e->bytes, digest);
}

/* From byte 512 on, to the end. */
static fp3_status add_up(const fp3_hdf5_ops *calls, int file, const char *path, envelope *e,
                         fp3_error *error) {
    char block[BLOCK];
    ssize_t count = 1;
    fp3_hdf5_sum *sum = calls->sum_begin();
    if (!sum)
        return fp3_fail(error, FP3_E_SYSTEM, "%s: out of memory", path);
    for (e->bytes = 0; count > 0; e->bytes += count > 0 ? (uint64_t)count : 0) {
        count = pread(file, block, sizeof block, (off_t)(FP3_ENVELOPE_SIZE + e->bytes));
        if (count > 0)
            calls->sum_add(sum, block, (size_t)count);
    }
    calls->sum_end(sum, e->digest.words);
    return count < 0 ? fp3_path_fail(error, path, "cannot read") : FP3_OK;
}

fp3_status fp3_envelope_close(const fp3_hdf5_ops *calls, FILE *file, uint64_t step,
                              const char *path, fp3_error *error) {
    char block[FP3_ENVELOPE_SIZE];
    envelope e = {.step = step};
    const fp3_status status = add_up(calls, fileno(file), path, &e, error);
    if (status)
        return status;
    print(&e, block);
    return pwrite(fileno(file), block, sizeof block, 0) == (ssize_t)sizeof block
               ? FP3_OK
               : fp3_path_fail(error, path, "cannot write");
}

static fp3_status check(const fp3_hdf5_ops *calls, FILE *file, const char *path, uint64_t *step,
                        fp3_error *error) {
    char block[FP3_ENVELOPE_SIZE + 1] = "", again[FP3_ENVELOPE_SIZE], digest[FP3_DIGEST_SIZE] = "";
    envelope told = {0}, found = {0};
    int version = 0;
    const ssize_t size = pread(fileno(file), block, FP3_ENVELOPE_SIZE, 0);
    if (size < 0)
        return fp3_path_fail(error, path, "cannot read");
    if (strncmp(block, MAGIC, strlen(MAGIC)))
        return fp3_fail(error, FP3_E_ARGUMENT, "%s: no checkpoint: it does not begin with '%s'",
                        path, MAGIC);
    if (sscanf(block, MAGIC "%d", &version) != 1 || version != VERSION)
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "%s: a checkpoint of version %d, and this fp3 reads version %d", path,
                        version, VERSION);
    const int fields =
        sscanf(block, MAGIC "%*d\nstep %" SCNu64 "\nbytes %" SCNu64 "\nsha256 %64s\n", &told.step,
               &told.bytes, digest);
    fp3_status status = add_up(calls, fileno(file), path, &found, error);
    if (status)
        return status;
    if (fields == 3 && found.bytes < told.bytes)
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "%s: cut off: %" PRIu64 " of %" PRIu64 " bytes are there", path,
                        found.bytes, told.bytes);
    found.step = told.step;
    print(&found, again);
    if (size < FP3_ENVELOPE_SIZE || memcmp(block, again, sizeof again))
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "%s: damaged: its contents do not have the SHA-256 in its head", path);
    *step = told.step;
    return FP3_OK;
}

fp3_status fp3_checkpoint_is(const char *path, int *is, fp3_error *error) {
    char begin[sizeof MAGIC - 1] = "";
    FILE *file;
    const fp3_status status = fp3_file_open(path, &file, error);
    *is =
        !status && fread(begin, sizeof begin, 1, file) == 1 && !memcmp(begin, MAGIC, sizeof begin);
    if (file)
        fclose(file);
    return status;
}

fp3_status fp3_envelope_open(const fp3_hdf5_ops *calls, const char *path, uint64_t *step,
                             fp3_error *error) {
    FILE *file;
    fp3_status status = fp3_file_open(path, &file, error);
    if (!status)
        status = check(calls, file, path, step, error);
    if (file)
        fclose(file);
    return status;
}
