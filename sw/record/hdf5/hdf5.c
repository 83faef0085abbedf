/* SPDX-License-Identifier: Apache-2.0 */
/* hdf5.c - see fp3_hdf5.h. */
#include "inside.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define DEFLATE 4 /* of 9: above it files shrink by little, and take much longer */

/* ---- files ---- */

static const char *why(const fp3_hdf5 *f, int *number) {
    *number = f->number;
    return f->why;
}

static fp3_hdf5 *create(const char *path, uint64_t front) {
    fp3_hdf5 *f = fp3_hdf5_begin();
    if (!f)
        return NULL;
    const hid_t list = H5Pcreate(H5P_FILE_CREATE);
    const int is_placed =
        H5Pset_userblock(list, front) >= 0 && H5Pset_obj_track_times(list, 0) >= 0;
    f->file = is_placed ? H5Fcreate(path, H5F_ACC_TRUNC, list, H5P_DEFAULT) : -1;
    fp3_hdf5_check(f, f->file >= 0);
    H5Pclose(list);
    return f;
}

static void close_file(fp3_hdf5 *f) {
    for (int i = 0; i < f->count; i++)
        H5Dclose(f->datasets[i]);
    for (int i = 0; i < f->count; i++)
        free(f->names[i]);
    if (f->file >= 0)
        H5Fclose(f->file);
    free(f);
}

static int flush(fp3_hdf5 *f) {
    return fp3_hdf5_check(f, !f->has_failed && H5Fflush(f->file, H5F_SCOPE_GLOBAL) >= 0);
}

/* ---- datasets ---- */

static hid_t creation_of(const fp3_hdf5_table *t) {
    const hsize_t chunk[2] = {t->chunk_rows, t->chunk_columns};
    const hid_t list = H5Pcreate(H5P_DATASET_CREATE);
    H5Pset_chunk(list, t->columns ? 2 : 1, chunk);
    H5Pset_fill_time(list, H5D_FILL_TIME_NEVER); /* all is written */
    H5Pset_obj_track_times(list, 0);             /* equal runs write equal files */
    if (t->is_compressed) {
        H5Pset_shuffle(list);
        H5Pset_deflate(list, DEFLATE);
    }
    return list;
}

/* Chunks are written whole, so none is kept. */
static hid_t access_of(void) {
    const hid_t list = H5Pcreate(H5P_DATASET_ACCESS);
    H5Pset_chunk_cache(list, 0, 0, H5D_CHUNK_CACHE_W0_DEFAULT);
    return list;
}

static int add(fp3_hdf5 *f, const fp3_hdf5_table *t) {
    const hsize_t size[2] = {t->rows, t->columns};
    if (f->has_failed)
        return -1;
    if (f->count == DATASETS_MOST) {
        snprintf(f->why, sizeof f->why, "more than %d datasets", DATASETS_MOST);
        f->has_failed = 1;
        return -1;
    }
    const hid_t space = H5Screate_simple(t->columns ? 2 : 1, size, NULL);
    const hid_t creation = creation_of(t), access = access_of();
    const hid_t made = H5Dcreate2(f->file, t->name, fp3_hdf5_type_of(t->type), space, H5P_DEFAULT,
                                  creation, access);
    const int result = fp3_hdf5_check(f, made >= 0);
    if (!result) {
        f->types[f->count] = fp3_hdf5_type_of(t->type);
        f->datasets[f->count++] = made;
    }
    H5Pclose(access);
    H5Pclose(creation);
    H5Sclose(space);
    return result;
}

static int write_part(fp3_hdf5 *f, int dataset, const fp3_hdf5_part *part) {
    if (f->has_failed)
        return -1;
    const hsize_t from[2] = {part->row, part->column}, size[2] = {part->rows, part->columns};
    const hid_t id = f->datasets[dataset];
    const hid_t to = H5Dget_space(id), of = H5Screate_simple(part->columns ? 2 : 1, size, NULL);
    const int result = fp3_hdf5_check(
        f, H5Sselect_hyperslab(to, H5S_SELECT_SET, from, NULL, size, NULL) >= 0 &&
               H5Dwrite(id, f->types[dataset], of, to, H5P_DEFAULT, part->data) >= 0);
    H5Sclose(of);
    H5Sclose(to);
    return result;
}

/* ---- attributes ---- */

static int put_attribute(fp3_hdf5 *f, int dataset, const char *name, hid_t type,
                         const void *value) {
    if (f->has_failed)
        return -1;
    const hid_t of = dataset < 0 ? f->file : f->datasets[dataset];
    const hid_t space = H5Screate(H5S_SCALAR);
    const hid_t id = H5Acreate2(of, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
    const int result = fp3_hdf5_check(f, id >= 0 && H5Awrite(id, type, value) >= 0);
    if (id >= 0)
        H5Aclose(id);
    H5Sclose(space);
    return result;
}

/* Of any length, in UTF-8: h5py gives it as str. */
static int text(fp3_hdf5 *f, int dataset, const char *name, const char *value) {
    const hid_t type = H5Tcopy(H5T_C_S1);
    H5Tset_size(type, H5T_VARIABLE);
    H5Tset_cset(type, H5T_CSET_UTF8);
    const int result = put_attribute(f, dataset, name, type, &value);
    H5Tclose(type);
    return result;
}

static int number(fp3_hdf5 *f, int dataset, const char *name, fp3_hdf5_type type,
                  const void *value) {
    return put_attribute(f, dataset, name, fp3_hdf5_type_of(type), value);
}

__attribute__((visibility("default"))) const fp3_hdf5_ops fp3_hdf5_calls = {
    .version = FP3_HDF5_VERSION,
    .size = sizeof(fp3_hdf5_ops),
    .create = create,
    .add = add,
    .text = text,
    .number = number,
    .write = write_part,
    .flush = flush,
    .why = why,
    .close = close_file,
    .open = fp3_hdf5_read_open,
    .count = fp3_hdf5_read_count,
    .describe = fp3_hdf5_read_describe,
    .read = fp3_hdf5_read_part,
    .text_of = fp3_hdf5_read_text,
    .numbers = fp3_hdf5_read_numbers,
    .sum_begin = fp3_hdf5_sum_begin,
    .sum_add = fp3_hdf5_sum_add,
    .sum_end = fp3_hdf5_sum_end,
};
