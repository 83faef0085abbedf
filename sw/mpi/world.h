/* world.h - inside fp3_mpi.so: the processes, the windows that they share, and what each file provides. */
#ifndef FP3_MPI_WORLD_H
#define FP3_MPI_WORLD_H

#include "fp3_mpi.h"

#include <mpi.h>

/* Memory of this rank that the others of its node write to. Kept for the next plan: all ranks together must make one, and end it. */
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

uint64_t fp3_mpi_most(fp3_mpi *world, uint64_t own);

fp3_mpi_plan *fp3_mpi_plan_make(fp3_mpi *world, const uint32_t *send, const uint32_t *receive,
                                uint32_t *out, uint32_t *in);
void fp3_mpi_plan_begin(fp3_mpi_plan *plan);
void fp3_mpi_plan_end(fp3_mpi_plan *plan);
void fp3_mpi_plan_forget(fp3_mpi_plan *plan);

/* A window of at least this size. All ranks together. NULL: out of memory. */
fp3_window *fp3_mpi_window_take(fp3_mpi *world, uint64_t bytes);
/* Where it is in the memory of another rank of the node. */
char *fp3_mpi_window_of(const fp3_mpi *world, const fp3_window *window, int rank);
/* Ends all of them: all ranks together. */
void fp3_mpi_windows_free(fp3_mpi *world);

int fp3_mpi_divide(fp3_mpi *world, const fp3_mpi_graph *graph, uint32_t *whose);

#endif
