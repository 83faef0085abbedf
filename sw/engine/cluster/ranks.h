/* SPDX-License-Identifier: Apache-2.0 */
/* ranks.h - an engine whose objects are divided among the processes of a cluster.
 *
 * Every process makes the same calls in the same order, with the same arguments: each has the whole
 * scene in view and an engine of its own for its part of the objects. Reads give every process the
 * words of all. So what stands on an engine runs on a cluster as it is, if it decides nothing by
 * time or by chance.
 */
#ifndef FP3_CLUSTER_RANKS_H
#define FP3_CLUSTER_RANKS_H

#include "processes.h"

#include <fp3/engine.h>

/* fp3_engine_open for objects of all ranks together. FP3_E_ARGUMENT as there, and where the
 * definition asks for what one process alone can have: a trace, a bus log, retirements, a cycle
 * limit, native code, a seed. */
fp3_status fp3_engine_open_ranks(const fp3_engine_def *def, const fp3_ranks *ranks,
                                 fp3_engine **engine);

#endif
