/* SPDX-License-Identifier: Apache-2.0 */
/* together.h - inside fp3_mpi.so: what all ranks do at the same time; fp3_mpi.h describes each. */
#ifndef FP3_MPI_TOGETHER_H
#define FP3_MPI_TOGETHER_H

#include "world.h"

void fp3_mpi_gather(fp3_mpi *world, const void *own, const uint64_t *bytes, void *all);
uint64_t fp3_mpi_most(fp3_mpi *world, uint64_t own);
void fp3_mpi_add(fp3_mpi *world, uint64_t *sums, unsigned count);

#endif
