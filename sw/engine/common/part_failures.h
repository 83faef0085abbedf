/* SPDX-License-Identifier: Apache-2.0 */
/* part_failures.h - who failed in a run that was made in parts, where the backend knows it of each
 * part. */
#ifndef FP3_PART_FAILURES_H
#define FP3_PART_FAILURES_H

#include "backend.h"

/* After a part that began so many steps after the run: engine->failures becomes those of all parts
 * so far. */
fp3_status fp3_part_failures_add(fp3_engine *engine, uint32_t began);

#endif
