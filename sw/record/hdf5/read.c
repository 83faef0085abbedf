/* SPDX-License-Identifier: Apache-2.0 */
/* read.c - the datasets of any file: their kinds, numbers and attributes. */
#include "inside.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- finding ---- */

/* Whether its numbers lie in this file. */
static int is_inside(hid_t dataset) {
    const hid_t list = H5Dget_create_plist(dataset);
    const int result = H5Pget_external_count(list) == 0 && H5Pget_layout(list) != H5D_VIRTUAL;
    H5Pclose(list);
    return result;
}

static int is_of_numbers(hid_t dataset) {
    const hid_t type = H5Dget_type(dataset), space = H5Dget_space(dataset);
    const H5T_class_t kind = H5Tget_class(type);
    const int dimensions = H5Sget_simple_extent_ndims(space);
    H5Sclose(space);
    H5Tclose(type);
    return (kind == H5T_FLOAT || kind == H5T_INTEGER) && (dimensions == 1 || dimensions == 2);
}

static herr_t note_dataset(hid_t group, const char *name, const H5L_info_t *link, void *user) {
    fp3_hdf5 *f = user;
    if (link->type != H5L_TYPE_HARD || f->count == DATASETS_MOST)
        return 0;
    const hid_t object = H5Oopen(group, name, H5P_DEFAULT);
    if (object < 0)
        return -1;
    char *copy = NULL;
    if (H5Iget_type(object) != H5I_DATASET || !is_of_numbers(object) || !is_inside(object) ||
        !(copy = strdup(name))) {
        H5Oclose(object);
        return 0;
    }
    f->names[f->count] = copy;
    f->datasets[f->count++] = object;
    return 0;
}

fp3_hdf5 *fp3_hdf5_read_open(const char *path) {
    fp3_hdf5 *f = fp3_hdf5_begin();
    if (!f)
        return NULL;
    f->file = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT);
    if (!fp3_hdf5_check(f, f->file >= 0))
        fp3_hdf5_check(f,
                       H5Literate(f->file, H5_INDEX_NAME, H5_ITER_INC, NULL, note_dataset, f) >= 0);
    return f;
}

int fp3_hdf5_read_count(const fp3_hdf5 *f) { return f->has_failed ? -1 : f->count; }

static fp3_hdf5_type type_for(hid_t dataset) {
    const hid_t type = H5Dget_type(dataset);
    const int is_float = H5Tget_class(type) == H5T_FLOAT;
    const size_t size = H5Tget_size(type);
    H5Tclose(type);
    if (is_float)
        return size > sizeof(float) ? FP3_HDF5_DOUBLE : FP3_HDF5_FLOAT;
    return size > sizeof(uint32_t) ? FP3_HDF5_UINT64 : FP3_HDF5_UINT32;
}

int fp3_hdf5_read_describe(fp3_hdf5 *f, int dataset, fp3_hdf5_table *table) {
    hsize_t size[2] = {0, 0};
    if (f->has_failed)
        return -1;
    const hid_t space = H5Dget_space(f->datasets[dataset]);
    const int result = fp3_hdf5_check(f, H5Sget_simple_extent_dims(space, size, NULL) >= 0);
    H5Sclose(space);
    *table = (fp3_hdf5_table){.name = f->names[dataset],
                              .type = type_for(f->datasets[dataset]),
                              .rows = size[0],
                              .columns = size[1]};
    return result;
}

/* ---- numbers ---- */

int fp3_hdf5_read_part(fp3_hdf5 *f, int dataset, fp3_hdf5_type type, const fp3_hdf5_part *part,
                       void *data) {
    if (f->has_failed)
        return -1;
    const hsize_t from[2] = {part->row, part->column}, size[2] = {part->rows, part->columns};
    const hid_t of = H5Dget_space(f->datasets[dataset]);
    const hid_t to = H5Screate_simple(part->columns ? 2 : 1, size, NULL);
    const int result =
        fp3_hdf5_check(f, H5Sselect_hyperslab(of, H5S_SELECT_SET, from, NULL, size, NULL) >= 0 &&
                              H5Dread(f->datasets[dataset], fp3_hdf5_type_of(type), to, of,
                                      H5P_DEFAULT, data) >= 0);
    H5Sclose(to);
    H5Sclose(of);
    return result;
}

/* ---- attributes ---- */

static hid_t open_attribute(const fp3_hdf5 *f, int dataset, const char *name) {
    const hid_t of = dataset < 0 ? f->file : f->datasets[dataset];
    if (f->has_failed || H5Aexists(of, name) <= 0)
        return -1;
    const hid_t attribute = H5Aopen(of, name, H5P_DEFAULT);
    const hid_t space = attribute < 0 ? -1 : H5Aget_space(attribute);
    const int is_one = space >= 0 && H5Sget_simple_extent_npoints(space) == 1;
    if (space >= 0)
        H5Sclose(space);
    if (attribute >= 0 && !is_one)
        H5Aclose(attribute);
    return is_one ? attribute : -1;
}

static char *read_variable(hid_t attribute, hid_t type) {
    char *text = NULL, *copy = NULL;
    if (H5Aread(attribute, type, &text) >= 0 && text) {
        copy = strdup(text);
        H5free_memory(text);
    }
    return copy;
}

static char *read_fixed(hid_t attribute, hid_t type) {
    char *text = calloc(H5Tget_size(type) + 1, 1);
    if (text && H5Aread(attribute, type, text) < 0) {
        free(text);
        text = NULL;
    }
    return text;
}

char *fp3_hdf5_read_text(fp3_hdf5 *f, int dataset, const char *name) {
    const hid_t attribute = open_attribute(f, dataset, name);
    char *text = NULL;
    if (attribute < 0)
        return NULL;
    const hid_t type = H5Aget_type(attribute);
    if (H5Tget_class(type) == H5T_STRING)
        text = H5Tis_variable_str(type) > 0 ? read_variable(attribute, type)
                                            : read_fixed(attribute, type);
    H5Tclose(type);
    H5Aclose(attribute);
    return text;
}

typedef struct {
    fp3_hdf5 *file;
    fp3_hdf5_number_fn *tell;
    void *user;
} teller;

static herr_t tell_number(hid_t of, const char *name, const H5A_info_t *info, void *user) {
    const teller *t = user;
    double value;
    (void)of;
    (void)info;
    const hid_t attribute = open_attribute(t->file, -1, name);
    if (attribute < 0)
        return 0;
    const hid_t type = H5Aget_type(attribute);
    const H5T_class_t kind = H5Tget_class(type);
    if ((kind == H5T_FLOAT || kind == H5T_INTEGER) &&
        H5Aread(attribute, H5T_NATIVE_DOUBLE, &value) >= 0)
        t->tell(t->user, name, value);
    H5Tclose(type);
    H5Aclose(attribute);
    return 0;
}

int fp3_hdf5_read_numbers(fp3_hdf5 *f, fp3_hdf5_number_fn *tell, void *user) {
    teller t = {f, tell, user};
    return fp3_hdf5_check(f, !f->has_failed && H5Aiterate2(f->file, H5_INDEX_NAME, H5_ITER_INC,
                                                           NULL, tell_number, &t) >= 0);
}
