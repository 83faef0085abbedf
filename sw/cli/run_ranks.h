/* SPDX-License-Identifier: Apache-2.0 */
/* run_ranks.h - fp3 run started by mpirun: one of the processes of a cluster. */
#ifndef FP3_CLI_RUN_RANKS_H
#define FP3_CLI_RUN_RANKS_H

#include "arguments.h"
#include "engine/cluster/ranks.h"
#include "run_engine.h"

typedef struct {
    int is_one; /* no mpirun, or one process */
    fp3_ranks all;
    int speaks; /* where messages of a rank that does not speak go, or -1 */
    char *port; /* of this rank, or NULL */
} fp3_run_ranks;

/* Before arguments are read. Rank 0 speaks: what the others print goes nowhere. */
void fp3_run_ranks_first(fp3_run_ranks *ranks);
/* Starts MPI, if there are several. FP3_E_SYSTEM: it does not start, or sees others than were
 * started. */
fp3_status fp3_run_ranks_begin(fp3_run_ranks *ranks, fp3_error *error);
/* Compares the options of this table on all ranks, but for those in `own`, a list that ends with
 * NULL. Other arguments may differ. FP3_E_ARGUMENT, on all ranks: an option differs; error names
 * it. */
fp3_status fp3_run_ranks_agree(const fp3_run_ranks *ranks, const fp3_option *table, int argc,
                               char *const *argv, const char *const *own, fp3_error *error);
/* Of the ports on->port, with commas between them, that of this rank takes their place.
 * FP3_E_ARGUMENT: there is not one for each rank. */
fp3_status fp3_run_ranks_port(fp3_run_ranks *ranks, fp3_run_engine *on, fp3_error *error);
/* What each rank did, of an engine that is divided. */
void fp3_run_ranks_print(fp3_engine *engine);
/* Whether rank 0 has said how the command ended, so that this rank ends well. After a failure that
 * not all ranks have, it ends them all, with a message of this one: then it does not return. */
int fp3_run_ranks_end(fp3_run_ranks *ranks, const char *command, fp3_status status,
                      const fp3_error *error);

#endif
