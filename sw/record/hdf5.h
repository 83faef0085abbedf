/* SPDX-License-Identifier: Apache-2.0 */
/* hdf5.h - a recording as HDF5: a dataset [snapshot][object] for each name, with its unit. */
#ifndef FP3_OUTPUT_HDF5_H
#define FP3_OUTPUT_HDF5_H

#include "sink.h"

/* Whether a name ends in .h5 or .hdf5, in letters of any case. */
int fp3_hdf5_is_named(const char *path);

/* The subject must outlive the sink; the caller closes it. FP3_E_ARGUMENT: what is there is no
 * regular file; FP3_E_SYSTEM: fp3_hdf5.so is not there or does not fit. */
fp3_status fp3_hdf5_open(const fp3_subject *subject, fp3_sink **sink, fp3_error *error);

#endif
