/* SPDX-License-Identifier: Apache-2.0 */
/* fp3_hdf5.h - what fp3_hdf5.so provides: HDF5 files of tables, written and read, by libhdf5; and
 * SHA-256, by Nettle.
 *
 * It is a library of its own because libhdf5 brings 30 others along: linked with them, every start
 * of the command would take 14 ms longer, and a program could not be linked statically any more.
 */
#ifndef FP3_HDF5_H
#define FP3_HDF5_H

#include <stddef.h>
#include <stdint.h>

#define FP3_HDF5_VERSION 3u

typedef struct fp3_hdf5 fp3_hdf5;

typedef enum { FP3_HDF5_FLOAT, FP3_HDF5_DOUBLE, FP3_HDF5_UINT32, FP3_HDF5_UINT64 } fp3_hdf5_type;

/* A dataset of rows x columns numbers, or of rows, where columns is 0. */
typedef struct {
    const char *name;
    fp3_hdf5_type type;
    uint64_t rows, columns, chunk_rows, chunk_columns;
    int is_compressed;
} fp3_hdf5_table;

/* Part of a dataset: data has `rows` rows of `columns` numbers. */
typedef struct {
    uint64_t row, rows, column, columns;
    const void *data;
} fp3_hdf5_part;

/* A SHA-256 in the making. */
typedef struct fp3_hdf5_sum fp3_hdf5_sum;

typedef void fp3_hdf5_number_fn(void *user, const char *name, double value);

/* Calls give 0, or -1 after a failure, which `why` explains. dataset: a number that add gave, in
 * the order of the calls from 0; or -1: the file. */
typedef struct {
    uint32_t version, size;
    /* An existing file loses its contents. The first `front` bytes, 0 or a power of 2 from 512 on,
     * are left to the caller: HDF5 begins behind them. NULL: out of memory. After any other failure
     * the next call fails. */
    fp3_hdf5 *(*create)(const char *path, uint64_t front);
    int (*add)(fp3_hdf5 *file, const fp3_hdf5_table *table);
    int (*text)(fp3_hdf5 *file, int dataset, const char *name, const char *value);
    int (*number)(fp3_hdf5 *file, int dataset, const char *name, fp3_hdf5_type type,
                  const void *value);
    int (*write)(fp3_hdf5 *file, int dataset, const fp3_hdf5_part *part);
    int (*flush)(fp3_hdf5 *file);
    /* What the first failure was; *number: its errno, or 0 where there is none. */
    const char *(*why)(const fp3_hdf5 *file, int *number);
    void (*close)(fp3_hdf5 *file);

    /* Reading. An existing file, with the datasets of one or two dimensions of numbers that lie in
     * it, by name; others are left out. Links to other files are not followed. NULL and failures as
     * with create. */
    fp3_hdf5 *(*open)(const char *path);
    int (*count)(const fp3_hdf5 *file);
    /* name belongs to the file; chunks are not told. type: what has room for its numbers. */
    int (*describe)(fp3_hdf5 *file, int dataset, fp3_hdf5_table *table);
    /* Into data, as numbers of this type. */
    int (*read)(fp3_hdf5 *file, int dataset, fp3_hdf5_type type, const fp3_hdf5_part *part,
                void *data);
    /* An attribute; malloc'ed, or NULL if there is none. */
    char *(*text_of)(fp3_hdf5 *file, int dataset, const char *name);
    /* Tells the attributes of the file that are one number each. */
    int (*numbers)(fp3_hdf5 *file, fp3_hdf5_number_fn *tell, void *user);

    /* SHA-256 (FIPS 180-4). NULL: out of memory. */
    fp3_hdf5_sum *(*sum_begin)(void);
    void (*sum_add)(fp3_hdf5_sum *sum, const void *data, size_t size);
    /* The digest as the standard has it, eight words; frees the sum. */
    void (*sum_end)(fp3_hdf5_sum *sum, uint32_t digest[8]);
} fp3_hdf5_ops;

extern const fp3_hdf5_ops fp3_hdf5_calls;

#endif
