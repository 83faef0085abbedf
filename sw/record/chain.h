/* SPDX-License-Identifier: Apache-2.0 */
/* chain.h - the chain of hashes of a checkpoint or of a recording in HDF5. */
#ifndef FP3_OUTPUT_CHAIN_H
#define FP3_OUTPUT_CHAIN_H

#include "expected.h"

typedef struct {
    fp3_expected_link *list; /* ascending; of a checkpoint one */
    size_t count;
    char *command; /* the arguments of the run, one a line; "": unknown */
    int is_checkpoint;
} fp3_chain;

/* The caller frees *chain, after a failure too. FP3_E_ARGUMENT: the file is neither, or is damaged.
 */
fp3_status fp3_chain_read(const char *path, fp3_chain *chain, fp3_error *error);
/* Leaves {0}, which may be freed as well. */
void fp3_chain_free(fp3_chain *chain);

#endif
