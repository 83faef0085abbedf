/* processes.h - the processes of a cluster, which mpirun has started. */
#ifndef FP3_CLUSTER_PROCESSES_H
#define FP3_CLUSTER_PROCESSES_H

#include <fp3/status.h>
#include <mpi/fp3_mpi.h>

typedef struct {
    const fp3_mpi_ops *calls;
    fp3_mpi *world;
    unsigned rank, count;
} fp3_ranks;

/* Loads fp3_mpi.so and starts MPI. FP3_E_SYSTEM: there is none, or it does not start. */
fp3_status fp3_ranks_open(fp3_ranks *ranks, fp3_error *error);

#endif
