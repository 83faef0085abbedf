/* SPDX-License-Identifier: Apache-2.0 */
/* inside.c - see inside.h. */
#include "inside.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Nothing is left to do when the process ends: what is not closed by then has failed. */
fp3_hdf5 *fp3_hdf5_begin(void) {
    H5dont_atexit();
    H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
    return calloc(1, sizeof(fp3_hdf5));
}

hid_t fp3_hdf5_type_of(fp3_hdf5_type type) {
    switch (type) {
    case FP3_HDF5_FLOAT:
        return H5T_NATIVE_FLOAT;
    case FP3_HDF5_DOUBLE:
        return H5T_NATIVE_DOUBLE;
    case FP3_HDF5_UINT32:
        return H5T_NATIVE_UINT32;
    case FP3_HDF5_UINT64:
        return H5T_NATIVE_UINT64;
    }
    return -1;
}

/* From the innermost call outwards: the first has the reason, and one may have an errno in its
 * text. */
static herr_t note(unsigned depth, const H5E_error2_t *entry, void *user) {
    fp3_hdf5 *f = user;
    const char *number = strstr(entry->desc, "errno = ");
    if (depth == 0)
        snprintf(f->why, sizeof f->why, "%s", entry->desc);
    if (number && !f->number)
        f->number = atoi(number + strlen("errno = "));
    return 0;
}

int fp3_hdf5_check(fp3_hdf5 *f, int is_good) {
    if (is_good && !f->has_failed)
        return 0;
    if (!f->has_failed)
        H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, note, f);
    f->has_failed = 1;
    return -1;
}
