/* SPDX-License-Identifier: Apache-2.0 */
/* removed.h - which objects events have removed, as their states FP3_NAME_REMOVED say. */
#ifndef FP3_REMOVED_H
#define FP3_REMOVED_H

#include "backend.h"

/* Before a run, if it is not known, and after each of its parts: objects are asked. */
fp3_status fp3_removed_look(fp3_engine *engine);
/* A run begins. */
void fp3_removed_run(fp3_engine *engine);
/* Objects have these words of FP3_NAME_REMOVED: the host has written them. */
void fp3_removed_note(fp3_engine *engine, size_t first, size_t count, const uint32_t *words);

#endif
