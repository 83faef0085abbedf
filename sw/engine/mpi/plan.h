/* SPDX-License-Identifier: Apache-2.0 */
/* plan.h - inside fp3_mpi.so: an exchange that is made again and again, as fp3_mpi.h describes it.
 */
#ifndef FP3_MPI_PLAN_H
#define FP3_MPI_PLAN_H

#include "world.h"

fp3_mpi_plan *fp3_mpi_plan_make(fp3_mpi *world, const uint32_t *send, const uint32_t *receive,
                                uint32_t *out, uint32_t *in);
void fp3_mpi_plan_begin(fp3_mpi_plan *plan);
void fp3_mpi_plan_end(fp3_mpi_plan *plan);
void fp3_mpi_plan_forget(fp3_mpi_plan *plan);

#endif
