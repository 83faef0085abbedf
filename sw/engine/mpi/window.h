/* SPDX-License-Identifier: Apache-2.0 */
/* window.h - inside fp3_mpi.so: memory that the ranks of a node share. */
#ifndef FP3_MPI_WINDOW_H
#define FP3_MPI_WINDOW_H

#include "world.h"

/* A window of at least this size. All ranks together. NULL: out of memory. */
fp3_window *fp3_mpi_window_take(fp3_mpi *world, uint64_t bytes);
/* Where it is in the memory of another rank of the node. */
char *fp3_mpi_window_of(const fp3_mpi *world, const fp3_window *window, int rank);
/* Ends all of them: all ranks together. */
void fp3_mpi_windows_free(fp3_mpi *world);

#endif
