/* SPDX-License-Identifier: Apache-2.0 */
/* inside.h - a file as its writer and its reader have it. */
#ifndef FP3_HDF5_INSIDE_H
#define FP3_HDF5_INSIDE_H

#include "fp3_hdf5.h"

#include <hdf5.h>

#define DATASETS_MOST 4096
#define WHY_SIZE 256

struct fp3_hdf5 {
    hid_t file;
    hid_t datasets[DATASETS_MOST];
    hid_t types[DATASETS_MOST];
    char *names[DATASETS_MOST]; /* of what is read */
    int count;
    int has_failed, number;
    char why[WHY_SIZE];
};

/* NULL: out of memory. */
fp3_hdf5 *fp3_hdf5_begin(void);
hid_t fp3_hdf5_type_of(fp3_hdf5_type type);
/* 0 if all is well, now and before; else -1, with the reason kept. */
int fp3_hdf5_check(fp3_hdf5 *f, int is_good);

/* As fp3_hdf5_ops has them. */
fp3_hdf5 *fp3_hdf5_read_open(const char *path);
int fp3_hdf5_read_count(const fp3_hdf5 *f);
int fp3_hdf5_read_describe(fp3_hdf5 *f, int dataset, fp3_hdf5_table *table);
int fp3_hdf5_read_part(fp3_hdf5 *f, int dataset, fp3_hdf5_type type, const fp3_hdf5_part *part,
                       void *data);
char *fp3_hdf5_read_text(fp3_hdf5 *f, int dataset, const char *name);
int fp3_hdf5_read_numbers(fp3_hdf5 *f, fp3_hdf5_number_fn *tell, void *user);
fp3_hdf5_sum *fp3_hdf5_sum_begin(void);
void fp3_hdf5_sum_add(fp3_hdf5_sum *sum, const void *data, size_t size);
void fp3_hdf5_sum_end(fp3_hdf5_sum *sum, uint32_t digest[8]);

#endif
