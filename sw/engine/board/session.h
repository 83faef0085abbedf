/* SPDX-License-Identifier: Apache-2.0 */
/* session.h - a run as a driver makes it: start, wait, ask how it ended. */
#ifndef FP3_SESSION_H
#define FP3_SESSION_H

#include "engine/common/backend.h"

/* As `run` of backend.h. */
fp3_status fp3_session_run(fp3_engine *engine, uint32_t steps, fp3_stats *stats);
/* Stops whatever runs, and waits for that; so that the memories are free. */
fp3_status fp3_session_stop(fp3_engine *engine);

#endif
