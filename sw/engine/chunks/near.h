/* SPDX-License-Identifier: Apache-2.0 */
/* near.h - near objects in chunks: hardware makes their lists of wide ones.
 *
 * A wide list has all that are nearer than the list reaches and twice what an object may roam. So
 * as long as no object has roamed farther than it may, the wide list has all that the list must
 * have. */
#ifndef FP3_CHUNKS_NEAR_H
#define FP3_CHUNKS_NEAR_H

#include "maker.h"

/* Who may come near whom: m->lists and, where there is a list of near objects, m->near. The caller
 * closes, also after a failure. FP3_E_ARGUMENT: roam is not above 0, or infinite; FP3_E_SYSTEM: out
 * of memory.
 */
fp3_status fp3_chunks_near_open(fp3_chunks_maker *m, double roam);
void fp3_chunks_near_close(fp3_chunks_maker *m);
/* Which words of a record the programs have; a record grows until there is one for each. */
void fp3_chunks_near_name(fp3_chunks_maker *m);
/* FP3_E_PROGRAM: there are too few constants. */
fp3_status fp3_chunks_near_set(fp3_chunks_maker *m, uint32_t *constants);
/* Programs, positions, and room for the words of wide lists. */
void fp3_chunks_near_put(fp3_chunks_maker *m);

#endif
