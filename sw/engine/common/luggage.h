/* SPDX-License-Identifier: Apache-2.0 */
/* luggage.h - what objects and groups hold, while a load moves them to other places. */
#ifndef FP3_LUGGAGE_H
#define FP3_LUGGAGE_H

#include "backend.h"

/* Columns of all objects, a register each and then the status; constants of each group. {0} holds
 * nothing. */
typedef struct {
    uint32_t *objects, *constants;
} fp3_luggage;

/* Takes a copy from where objects are now. The caller frees it, also after a failure. */
fp3_status fp3_luggage_pack(fp3_engine *engine, fp3_luggage *luggage);
/* Writes it to where the objects are now. */
fp3_status fp3_luggage_unpack(fp3_engine *engine, fp3_luggage *luggage);
void fp3_luggage_free(fp3_luggage *luggage);

#endif
