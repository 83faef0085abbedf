/* SPDX-License-Identifier: Apache-2.0 */
/* processes.h - the processes of a cluster, which mpirun has started. */
#ifndef FP3_CLUSTER_PROCESSES_H
#define FP3_CLUSTER_PROCESSES_H

#include <engine/mpi/fp3_mpi.h>
#include <fp3/engine.h>

typedef struct {
    const fp3_mpi_ops *calls;
    fp3_mpi *world;
    unsigned rank, count;
} fp3_ranks;

/* What one rank has now, and what it did since the engine was opened. */
typedef struct {
    uint64_t objects, guests;
    uint64_t cycles;          /* of its runs */
    uint64_t sent;            /* bytes, to other ranks before phases */
    uint64_t times;           /* that words were exchanged */
    uint64_t exchange, steps; /* nanoseconds: of that, with the wait for slower ranks; of all steps,
                                 that among them */
    fp3_bus_use bus;          /* of its own engine */
} fp3_rank_use;

/* Loads fp3_mpi.so and starts MPI. FP3_E_SYSTEM: there is none, or it does not start. */
fp3_status fp3_ranks_open(fp3_ranks *ranks, fp3_error *error);

#endif
