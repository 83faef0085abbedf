/* SPDX-License-Identifier: Apache-2.0 */
/* format.c - see format.h. */
#include "format.h"

#include <string.h>
#include <strings.h>

#define COMMA ,
static const fp3_format formats[] = {
    {{FP3_HDF5_ENDINGS(COMMA)}, fp3_hdf5_open, .is_hdf5 = 1},
    {{NULL}, fp3_csv_open, .is_hdf5 = 0},
};

const fp3_format *fp3_format_of(const char *path) {
    const char *dot = strrchr(path, '.');
    const fp3_format *format = formats;
    for (; format->endings[0]; format++)
        for (size_t i = 0; dot && i < sizeof format->endings / sizeof *format->endings; i++)
            if (format->endings[i] && !strcasecmp(dot, format->endings[i]))
                return format;
    return format;
}
