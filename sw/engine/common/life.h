/* SPDX-License-Identifier: Apache-2.0 */
/* life.h - which objects live, and where a run is split because that changes.
 *
 * An object makes the steps born + 1 .. gone, counted from the load. From one change to the next a
 * run is a run of the backend, over those objects that live.
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

/* In another engine with as many objects, which has the same program. */
fp3_status fp3_life_copy(const fp3_engine *engine, fp3_engine *to);
/* From here on all objects live, always. */
void fp3_life_forget(fp3_engine *engine);

#endif
