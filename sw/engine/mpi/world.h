/* SPDX-License-Identifier: Apache-2.0 */
/* world.h - inside fp3_mpi.so: the processes, the windows that they share, and what they keep. */
#ifndef FP3_MPI_WORLD_H
#define FP3_MPI_WORLD_H

#include "fp3_mpi.h"

#include <mpi.h>

/* Memory of this rank that the others of its node write to. Kept for the next plan: all ranks
 * together must make one, and end it. */
typedef struct fp3_window {
    struct fp3_window *next;
    MPI_Win win;
    char *base;
    uint64_t bytes; /* the same on all ranks */
    int is_used;
} fp3_window;

struct fp3_mpi {
    int rank, ranks;
    MPI_Comm node;  /* the ranks that share memory with this one */
    int *node_rank; /* the number of each rank there, or MPI_UNDEFINED */
    fp3_window *windows;
};

#endif
