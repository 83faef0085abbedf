/* SPDX-License-Identifier: Apache-2.0 */
/* divide.h - inside fp3_mpi.so: which rank gets which thing, as fp3_mpi.h describes it. */
#ifndef FP3_MPI_DIVIDE_H
#define FP3_MPI_DIVIDE_H

#include "world.h"

int fp3_mpi_divide(fp3_mpi *world, const fp3_mpi_graph *graph, uint32_t *whose);

#endif
