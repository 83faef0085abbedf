/* SPDX-License-Identifier: Apache-2.0 */
/* envelope.h - the first 512 bytes of a checkpoint: a text that says how long the rest is, and its
 * SHA-256.
 *
 * So a file that is cut off, damaged or of something else never reaches libhdf5.
 */
#ifndef FP3_CHECKPOINT_ENVELOPE_H
#define FP3_CHECKPOINT_ENVELOPE_H

#include "record/hdf5/fp3_hdf5.h"

#include <fp3/status.h>
#include <stdio.h>

#define FP3_ENVELOPE_SIZE 512

/* Writes them into a file that is complete otherwise. path: for messages. */
fp3_status fp3_envelope_close(const fp3_hdf5_ops *calls, FILE *file, uint64_t step,
                              const char *path, fp3_error *error);
/* Reads the whole file. FP3_E_ARGUMENT: it is no checkpoint, one of another version, cut off, or
 * damaged. */
fp3_status fp3_envelope_open(const fp3_hdf5_ops *calls, const char *path, uint64_t *step,
                             fp3_error *error);

#endif
