/* SPDX-License-Identifier: Apache-2.0 */
/* use.h - what each rank did: its cycles, its bus, what it sent to the others. */
#ifndef FP3_CLUSTER_USE_H
#define FP3_CLUSTER_USE_H

#include "processes.h"

/* Of every rank, in their order, for all of them: of an engine that is divided. The caller frees
 * *all. */
fp3_status fp3_ranks_use(fp3_engine *engine, fp3_rank_use **all, unsigned *count);

/* After a run, by all ranks together: its cycles, and the bus of all. */
void fp3_ranks_count_run(fp3_engine *engine);
void fp3_ranks_add_bus(fp3_bus_use *sum, const fp3_bus_use *more);

#endif
