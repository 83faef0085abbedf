/* SPDX-License-Identifier: Apache-2.0 */
/* transfers.h - the list of transfers that makes all steps. */
#ifndef FP3_CHUNKS_TRANSFERS_H
#define FP3_CHUNKS_TRANSFERS_H

#include "maker.h"

/* Behind all else in memory. */
void fp3_chunks_put_transfers(fp3_chunks_maker *m, uint32_t steps);

#endif
