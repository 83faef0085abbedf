/* SPDX-License-Identifier: Apache-2.0 */
/* life.h - which objects live, and where a run is split because that changes.
 *
 * An object makes the steps born + 1 .. gone, counted from the load, but none while its state
 * FP3_NAME_REMOVED is not 0. From one change to the next a run is a run of the backend, over those
 * objects that live. Where a program may remove objects, each step is such a part: only the objects
 * know who has been removed.
 */
#ifndef FP3_LIFE_H
#define FP3_LIFE_H

#include "backend.h"

/* How many of the next `steps` steps an object makes if it does not sleep. */
uint32_t fp3_life_steps(const fp3_engine *engine, size_t object, uint32_t steps);
/* How many of these steps the same objects make; *is_any: there is one. steps is above 0. When
 * others live than in the last run, the objects are to be listed again. */
uint32_t fp3_life_part(fp3_engine *engine, uint32_t steps, int *is_any);

/* Whether an object may have made steps in the last run. */
int fp3_life_took_part(const fp3_engine *engine, size_t object);
/* After a load: from here on all objects live, always, but for those that programs remove.
 * FP3_E_SYSTEM: out of memory. */
fp3_status fp3_life_begin(fp3_engine *engine);

/* In another engine with as many objects, which has the same program. */
fp3_status fp3_life_copy(const fp3_engine *engine, fp3_engine *to);
/* Frees all. */
void fp3_life_forget(fp3_engine *engine);

#endif
