/* SPDX-License-Identifier: Apache-2.0 */
/* format.h - the forms of file that a recording is written in, by the endings of their names. */
#ifndef FP3_OUTPUT_FORMAT_H
#define FP3_OUTPUT_FORMAT_H

#include "sink.h"

typedef struct {
    const char *endings[2]; /* in letters of any case; none: any name */
    fp3_sink_open *open;
    int is_hdf5; /* can be compressed, and has hashes */
} fp3_format;

/* The endings of HDF5, with a separator between them. */
#define FP3_HDF5_ENDINGS(OR) ".h5" OR ".hdf5"
/* The table of format.c as a sentence. */
#define FP3_FORMATS "as HDF5 if its name ends in " FP3_HDF5_ENDINGS(" or ") ", else as CSV"

const fp3_format *fp3_format_of(const char *path);

#endif
