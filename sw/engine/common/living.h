/* SPDX-License-Identifier: Apache-2.0 */
/* living.h - lists of neighbours without the objects that do not live.
 *
 * An object that does not live has no neighbours and is in nobody's list. Links are kept as the
 * host gave them, with what they remember: when both ends live, the link is there. Near objects
 * forget when one of them does not live.
 */
#ifndef FP3_LIVING_H
#define FP3_LIVING_H

#include "backend.h"

/* Before a run, or a part of one: lists are those of the objects that live now. Nothing is done
 * where the same objects live as before. FP3_E_SYSTEM: out of memory. */
fp3_status fp3_living_settle(fp3_engine *engine);
/* See fp3_engine_bury: only objects with stays[object], of the engine's only group, keep links, and
 * what pairs remember of each other. */
fp3_status fp3_living_forget(fp3_engine *engine, const uint8_t *stays);

#endif
