/* SPDX-License-Identifier: Apache-2.0 */
/* library_hdf5.c - see library_hdf5.h. */
#include "library_hdf5.h"

#include "base/path.h"
#include "engine/common/library.h"

#include <errno.h>
#include <string.h>

fp3_status fp3_library_hdf5(const fp3_hdf5_ops **calls, fp3_error *error) {
    void *library = NULL;
    *calls = NULL;
    const fp3_status status =
        fp3_library_load("fp3_hdf5.so", "library for HDF5 files", &library, NULL, error);
    if (status)
        return status;
    const fp3_hdf5_ops *found = fp3_library_symbol(library, "fp3_hdf5_calls");
    if (!found || found->version != FP3_HDF5_VERSION || found->size != sizeof *found)
        return fp3_fail(error, FP3_E_SYSTEM,
                        "fp3_hdf5.so does not fit this libfp3: both must come from one build");
    *calls = found;
    return FP3_OK;
}

fp3_status fp3_hdf5_cannot_write(const fp3_hdf5_ops *calls, const fp3_hdf5 *file, const char *path,
                                 fp3_error *error) {
    int number = 0;
    const char *why = calls->why(file, &number);
    if (!number)
        return fp3_fail(error, FP3_E_SYSTEM, "%s: cannot write: %s", path, why);
    errno = number;
    return fp3_path_fail(error, path, "cannot write");
}

fp3_status fp3_hdf5_cannot_read(const fp3_hdf5_ops *calls, const fp3_hdf5 *file, const char *path,
                                fp3_error *error) {
    int number = 0;
    const char *why = calls->why(file, &number);
    if (number)
        return fp3_fail(error, FP3_E_ARGUMENT, "%s: cannot read: %s", path, strerror(number));
    return fp3_fail(error, FP3_E_ARGUMENT, "%s: cannot read as HDF5: %s", path, why);
}
