/* SPDX-License-Identifier: Apache-2.0 */
/* format.h - the forms of file that a recording is written in, by the endings of their names. */
#ifndef FP3_OUTPUT_FORMAT_H
#define FP3_OUTPUT_FORMAT_H

#include "sink.h"

typedef struct {
    const char *endings[2]; /* in letters of any case; none: any name */
    fp3_sink_open *open;
    int can_compress, has_hashes;
} fp3_format;

/* The table of format.c as a sentence. */
#define FP3_FORMATS "as HDF5 if its name ends in .h5 or .hdf5, else as CSV"

const fp3_format *fp3_format_of(const char *path);

#endif
