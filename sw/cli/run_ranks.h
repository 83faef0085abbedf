/* run_ranks.h - fp3 run started by mpirun: one of the processes of a cluster. */
#ifndef FP3_CLI_RUN_RANKS_H
#define FP3_CLI_RUN_RANKS_H

#include "engine/ranks.h"

typedef struct {
    int is_one; /* no mpirun, or one process */
    fp3_ranks all;
    fp3_exchanged exchanged;
    int speaks; /* where messages of a rank that does not speak go, or -1 */
} fp3_run_ranks;

/* Rank 0 speaks: what the others print goes nowhere. */
fp3_status fp3_run_ranks_begin(fp3_run_ranks *ranks, fp3_error *error);
/* Whether rank 0 has said how the command ended, so that this rank ends well. After a failure that not all ranks have, it ends them all, with a
 * message of this one: then it does not return. */
int fp3_run_ranks_end(fp3_run_ranks *ranks, fp3_status status, const fp3_error *error);

#endif
