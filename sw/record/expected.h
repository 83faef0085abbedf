/* SPDX-License-Identifier: Apache-2.0 */
/* expected.h - hashes that a run is to have: those of another run, which fp3 verify makes again. */
#ifndef FP3_OUTPUT_EXPECTED_H
#define FP3_OUTPUT_EXPECTED_H

#include "state.h"

typedef struct {
    uint64_t step;
    fp3_digest before, chain; /* up to the link before, and up to this one */
} fp3_expected_link;

typedef struct fp3_expected {
    const char *path;              /* the file that has them */
    const fp3_expected_link *list; /* ascending */
    size_t count;
    size_t agreed; /* how many the run has had so far */
} fp3_expected;

/* hash: that of the state after this step. FP3_E_MISMATCH: it makes another link. A step that is
 * not in the list is not compared. */
fp3_status fp3_expected_compare(fp3_expected *expected, const fp3_hdf5_ops *calls, uint64_t step,
                                const fp3_digest *hash, fp3_error *error);

#endif
