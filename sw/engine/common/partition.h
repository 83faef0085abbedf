/* SPDX-License-Identifier: Apache-2.0 */
/* partition.h - which objects share a lane, so that few neighbours are in other lanes. */
#ifndef FP3_PARTITION_H
#define FP3_PARTITION_H

#include "inside.h"

/* Objects of the engine's first group in an order in which those that its links connect are close:
 * each lane takes those that follow the ones of the lane before. slot[i] is the place of object i
 * in that order. FP3_E_SYSTEM: out of memory. */
fp3_status fp3_partition_find(const fp3_engine *engine, uint32_t *slot);

#endif
