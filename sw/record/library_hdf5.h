/* SPDX-License-Identifier: Apache-2.0 */
/* library_hdf5.h - finds fp3_hdf5.so, which reads and writes HDF5 files and makes hashes. */
#ifndef FP3_LIBRARY_HDF5_H
#define FP3_LIBRARY_HDF5_H

#include "record/hdf5/fp3_hdf5.h"

#include <fp3/status.h>

/* It stays loaded. FP3_E_SYSTEM: there is none, or one of another build. */
fp3_status fp3_library_hdf5(const fp3_hdf5_ops **calls, fp3_error *error);

/* Why the last call failed, as an error of this file: FP3_E_SYSTEM, or what the errno says. */
fp3_status fp3_hdf5_cannot_write(const fp3_hdf5_ops *calls, const fp3_hdf5 *file, const char *path,
                                 fp3_error *error);
/* FP3_E_ARGUMENT. */
fp3_status fp3_hdf5_cannot_read(const fp3_hdf5_ops *calls, const fp3_hdf5 *file, const char *path,
                                fp3_error *error);

#endif
