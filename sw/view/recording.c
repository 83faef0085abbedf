/* SPDX-License-Identifier: Apache-2.0 */
/* recording.c - see recording.h. */
#include "recording.h"

#include "reader.h"

#include "base/host.h"
#include "record/format.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* ---- loading ---- */

static fp3_status fill_made(const fp3_view_recording *r, fp3_view_column *column,
                            fp3_error *error) {
    const int is_time = !strcmp(column->name, "time");
    if (!(column->values = malloc(r->snapshots * r->objects * sizeof *column->values)))
        return fp3_no_memory(error);
    for (size_t n = 0; n < r->snapshots; n++)
        for (size_t i = 0; i < r->objects; i++)
            column->values[n * r->objects + i] = is_time ? (float)r->times[n] : (float)i;
    return FP3_OK;
}

fp3_status fp3_view_load(fp3_view_recording *r, uint64_t every, fp3_error *error) {
    FP3_HOST;
    fp3_status status = r->reader->load(r, every, error);
    for (size_t i = 0; !status && i < r->column_count; i++)
        if (r->columns[i].is_wanted && r->columns[i].is_made)
            status = fill_made(r, &r->columns[i], error);
    return status;
}

/* ---- opening and closing ---- */

/* Every HDF5 file of ours begins so. What comes through a pipe can be read only once, so it is
 * taken for CSV. */
static int is_hdf5(const char *path) {
    static const char mark[] = "\211HDF\r\n\032\n";
    char begin[sizeof mark - 1];
    struct stat found;
    const int is_file = strcmp(path, "-") && !stat(path, &found) && S_ISREG(found.st_mode);
    FILE *file = is_file ? fopen(path, "rb") : NULL;
    const int result =
        file && fread(begin, sizeof begin, 1, file) == 1 && !memcmp(begin, mark, sizeof begin);
    if (file)
        fclose(file);
    return result;
}

/* Texts that a file does not have are empty. */
static int fill_texts(fp3_view_recording *r) {
    char **texts[] = {&r->model,  &r->doc,           &r->integrator,
                      &r->engine, &r->configuration, &r->time_unit};
    int is_good = 1;
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++)
        is_good &= *texts[i] || (*texts[i] = strdup(""));
    return is_good;
}

fp3_status fp3_view_open(const char *path, fp3_view_recording **r, fp3_error *error) {
    FP3_HOST;
    fp3_view_recording *made = *r = calloc(1, sizeof *made);
    if (!made)
        return fp3_no_memory(error);
    made->path = path;
    fp3_status status = fp3_format_of(path)->is_hdf5 || is_hdf5(path)
                            ? fp3_view_hdf5_open(made, error)
                            : fp3_view_csv_open(made, error);
    if (!status && !fill_texts(made))
        status = fp3_no_memory(error);
    if (status)
        fp3_view_close(r);
    return status;
}

void fp3_view_close(fp3_view_recording **of) {
    fp3_view_recording *r = *of;
    if (!r)
        return;
    fp3_view_recorded_free(r);
    if (r->reader)
        r->reader->close(r->reader);
    free(r);
    *of = NULL;
}
