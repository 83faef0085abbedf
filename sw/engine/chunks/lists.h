/* SPDX-License-Identifier: Apache-2.0 */
/* lists.h - chunks as large as fit in the store, and the lists of their objects. */
#ifndef FP3_CHUNKS_LISTS_H
#define FP3_CHUNKS_LISTS_H

#include "maker.h"

/* m->lists and m->near say who sees whom. FP3_E_PROGRAM: an object has no room; FP3_E_SYSTEM: out
 * of memory. */
fp3_status fp3_chunks_cut(fp3_chunks_maker *m);
/* What memory has for a chunk's objects. */
void fp3_chunks_put_lists(fp3_chunks_maker *m, const fp3_piece *piece, fp3_chunk_data *data);

#endif
