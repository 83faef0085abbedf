/* SPDX-License-Identifier: Apache-2.0 */
/* sink.h - what a form of file provides to a recording. */
#ifndef FP3_OUTPUT_SINK_H
#define FP3_OUTPUT_SINK_H

#include "around.h"
#include "column.h"

#include "state.h"

/* A table of numbers that is the same for the whole run. */
typedef struct {
    const char *name; /* with a colon, which no value's has */
    enum { FP3_EXTRA_UINT32, FP3_EXTRA_DOUBLE } type;
    size_t rows, columns; /* 0 rows: it is left out */
    const void *data;
} fp3_extra;

/* What is recorded. */
typedef struct {
    const char *path;
    const fp3_program *program; /* NULL: no program's objects */
    const fp3_columns *columns;
    const fp3_around *around;
    const fp3_extra
        *extras; /* HDF5 alone has them; they are asked for when the file is published */
    size_t extra_count;
    size_t objects;
    uint64_t snapshots;
    int has_time;
    double h;                    /* 0: objects choose their steps */
    const char *time_unit;       /* "" where none is known */
    const char *engine, *config; /* names */
    const char *command;         /* or NULL */
    int is_compressed;
    int is_hashed;     /* snapshots have a chain of hashes: */
    fp3_digest before; /* what it was before the first one */
} fp3_subject;

typedef struct {
    uint64_t number; /* of the snapshot, from 0 */
    uint64_t step;   /* of the run */
    double time;
    size_t first, count;     /* objects, whose values the columns have */
    const fp3_digest *chain; /* up to this snapshot, where is_hashed */
} fp3_slice;

typedef struct fp3_sink fp3_sink;
struct fp3_sink {
    /* Blocks come in the order of snapshots, then of objects. */
    fp3_status (*put)(fp3_sink *sink, const fp3_slice *block, fp3_error *error);
    /* After the last block: the file gets its name. */
    fp3_status (*publish)(fp3_sink *sink, fp3_error *error);
    void (*close)(fp3_sink *sink);
};

/* The subject must outlive the sink; the caller closes it. */
typedef fp3_status fp3_sink_open(const fp3_subject *subject, fp3_sink **sink, fp3_error *error);
/* RFC 4180: a row for each object of each snapshot. */
fp3_sink_open fp3_csv_open;
/* A dataset [snapshot][object] for each name, with its unit. FP3_E_ARGUMENT: what is there is no
 * regular file; FP3_E_SYSTEM: fp3_hdf5.so is not there or does not fit. */
fp3_sink_open fp3_hdf5_open;

#endif
